#pragma once
// What of a fixture has moved, from where its parts lay car after car.
//
// Model. Car k in carrier c lies at x_k = m_c + s(t_k) + v_k + e_k, a vector of 6 (mm, rad; work object): the carrier's own
// place, what has changed, the parts' scatter v with covariance V, alike in all carriers, and the measurement's error with
// its stated covariance S_k. S_k + V is W_k; V is what the differences of cars that follow each other in one carrier
// scatter by beyond S_k, so that a change is no scatter. Differences far off are left out of it, single cars that lie far
// off both neighbours of their carrier out of all.
//
// Changes. A step of one carrier after its car j, a step of all carriers at one time (cell), and a trend of either, linear in
// time. Each has generalised likelihood ratios T of what it would change (means weighted by W^-1): of any motion, with 6 degrees,
// and of what each element can do, with as many degrees m as it holds directions, which finds a small fault of an element sooner.
// T (nu - m + 1) / (u nu m) is F with m and nu - m + 1 degrees, nu those of V, u = (1 + r) / (1 - r) where the cars' lag-1
// correlation r (of the differences: it knows of no steps) is positive. The least probable one is taken, its change taken off, and
// again, until none is left beyond chance: its probability times the number of all that was tried (Bonferroni) has to be below
// DiagnosisOptions::alarm. A step of all carriers beats that of one by as many carriers as share it.
//
// Which element. Element e held in m directions moves the part by F_e a for a (mm) along them (fixture_patterns). With
// a ~ N(0, kMovedPrior^2) the change d has N(0, C + kMovedPrior^2 F F^T) under e, the same with all elements' F under "more
// than one"; the probabilities are these likelihoods, kAlone shared by the elements. Two elements cannot be told apart by
// n cars where the part's motions by them differ too little: told_apart.
//
// Limits. First order in the changes (tenths of a millimetre against metres); a fixture that holds the part in more than
// six directions gives way by least squares; a change younger than kFewestCars of a carrier is not looked for.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

inline constexpr std::size_t kFewestCars = 3;          // on either side of a step, of a carrier
inline constexpr std::size_t kFewestDifferences = 20;  // of cars in the same carrier, that V is learnt from
inline constexpr double kMovedPrior = 1.0;             // mm
inline constexpr double kAlone = 0.95;                 // that a change is of one element, beforehand

// How the part moves when an element gives way by 1 mm along its directions: one column each.
using Pattern = Eigen::Matrix<double, 6, Eigen::Dynamic>;
struct HoldingElement {
    Eigen::Vector3d at_mm = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> directions;  // unit
};
enum class FixtureStatus { ok, loose };
struct FixturePatterns {
    FixtureStatus status = FixtureStatus::ok;
    std::vector<Pattern> elements;
    // loose: how the part can move although it is held, (mm, rad), largest entry of 1 mm over the fixture's size.
    Vector6 free_motion = Vector6::Zero();
};
// n . (dt + dw x p) = what the element gives way by, for every direction n at its place p.
FixturePatterns fixture_patterns(std::span<const HoldingElement> elements);

struct CarLies {
    std::size_t carrier = 0;  // 0, 1, ...
    double day = 0;           // ascending over the cars
    Vector6 at = Vector6::Zero();
    Matrix6 covariance = Matrix6::Zero();  // of the measurement
};

struct DiagnosisOptions {
    double alarm = 1e-3;   // that a quiet production is called changed, each time that it is looked at
    std::size_t most = 5;  // changes
    // All carriers share what holds the part: a change of all is one of its elements. Else it is the cell's.
    bool one_fixture = false;
};

enum class Moved { carrier, cell };
enum class MovedBy { step, trend };

struct ElementMoved {
    std::size_t element = 0;
    double probability = 0;
    Eigen::VectorXd amount_mm, sigma_mm;  // along its directions: as the change alone says
};
struct Change {
    Moved what = Moved::carrier;
    MovedBy how = MovedBy::step;
    std::size_t carrier = 0;
    std::size_t first_car = 0;             // index of the first car after a step
    std::size_t earliest = 0, latest = 0;  // it may have been, 95 %
    Vector6 motion = Vector6::Zero();      // of a step; of a trend from its first to its last car
    Matrix6 covariance = Matrix6::Zero();
    double statistic = 0, probability = 1;  // of so much by chance, all that was tried together
    std::vector<ElementMoved> elements;     // most probable first; none: the cell's
    double several = 0;                     // probability that it is more than one
};

struct CarrierEffect {
    std::size_t cars = 0;
    Vector6 motion = Vector6::Zero();  // off the mean of all carriers, changes taken off
    Matrix6 covariance = Matrix6::Zero();
};

enum class DiagnosisStatus { ok, too_few };
struct Diagnosis {
    DiagnosisStatus status = DiagnosisStatus::ok;
    std::size_t cars = 0, odd_cars = 0, differences = 0;
    Matrix6 part_covariance = Matrix6::Zero();  // V
    Matrix6 car_covariance = Matrix6::Zero();   // V and the mean S
    double correlation = 0;                     // r
    std::vector<Change> changes;                // as they were found: the plainest first
    std::vector<CarrierEffect> carriers;
};
// Precondition: days ascend, carriers are below `carriers`, covariances are symmetric.
Diagnosis diagnose(std::span<const CarLies> cars, std::size_t carriers, std::span<const Pattern> patterns,
                   const DiagnosisOptions& options = {});

// How many cars before and after a fault of `amount_mm` of the one, along its worst direction, it takes to tell
// it from any fault of the other with 95 %; infinite: never. `car_covariance` is that of one car.
double cars_to_tell_apart(const Pattern& one, const Pattern& other, const Matrix6& car_covariance,
                          double amount_mm);

}  // namespace seamwright
