#pragma once
// The uncertainty budget of a region (GUM, JCGM 100; methods in core/correction/budget/budget.h), measurand by measurand:
// the deviation across the bead at the region's worst path point (path_direction.h), and the six degrees of freedom.
// Beside it, where asked for, JCGM 101's Monte Carlo of the whole correction, both of its passes.
//
// One row a source and its owner: a sensor's feature noise, the spots' own sigma and references by sensor, the
// trigger and the arrivals by robot. u of a row is the root of the sum of its spots' shares; u(x) is the input's
// standard uncertainty (root mean square over the row's spots), the sensitivity is u / u(x). Rows are independent:
// the shares add up to 1.
//
// The nozzle, where one is calibrated, errs at the bead and not in D (projects/measure/nozzle.h): a row of normal and
// binormal alone, systematic.
//
// Type A: estimated from observations: the feature's covariance and the reference's, with the points that the feature
// rests on in the reference profile less kFitted as degrees of freedom (of fewer points it counts as stated); a hand-eye that was calibrated, whose residuals are so many that its degrees count
// as infinite. Type B: all that is stated. Effective degrees of freedom: Welch-Satterthwaite; k = t_95(nu).

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/correction/budget/budget.h"
#include "core/correction/budget/monte_carlo.h"
#include "projects/model/project.h"
#include "projects/proof/path_direction.h"

namespace seamwright {

inline constexpr int kFitted = 4;  // numbers that a feature is fitted with, at most
inline constexpr double kAgreement =
    0.05;  // of u: the 95 % limits of first order and Monte Carlo (JCGM 101, 8)
inline constexpr double kMostFailed = 0.01;  // of the trials; beyond, the rest says too little

struct BudgetRow {
    ErrorSource source = ErrorSource::feature;
    std::string owner;   // id of the sensor or of the robot
    double input_u = 0;  // u(x): mm; of scale and shear 1/1
    bool type_a = false;
    double degrees = std::numeric_limits<double>::infinity();
    double sensitivity = 0;  // u / u(x)
    double u = 0;            // as the measurand, one standard deviation
    double share = 0;        // of the variance, 0..1
    std::string spot_id;     // of a row of several spots: the one that contributes most
};

enum class Quantity { normal, binormal, x, y, z, a, b, c };
std::string_view to_string(Quantity quantity);
inline bool is_angle(Quantity quantity) {
    return quantity >= Quantity::a;
}

// Lengths mm, angles (KUKA A, B, C) degree.
struct MeasurandBudget {
    Quantity quantity = Quantity::normal;
    std::vector<BudgetRow> rows;  // in the order of ErrorSource
    double u = 0, u_random = 0, u_systematic = 0;
    double degrees = 0, k = 0, expanded = 0;  // nu_eff; U = k u, 95 %
    // Of estimate minus truth. `agrees`: its 95 % limits are -U and U within kAgreement.
    std::optional<MonteCarloFigure> drawn;
    bool agrees = true;
};

struct RegionBudget {
    std::string region_id;
    Displacement displacement;
    double required_sigma3_mm = 0;  // the project's
    // ok or under_determined; then `message` says why, and there is nothing else.
    CorrectionStatus status = CorrectionStatus::ok;
    Text message;
    std::string spot_id;  // the path point where normal or binormal is worst
    std::vector<MeasurandBudget> measurands;
    std::optional<MonteCarlo> drawn;  // its figures in the order of the measurands
    std::uint64_t seed = 0;
    std::vector<Text> remarks;  // what is not stated and therefore not in the budget
    double bead_u_mm() const;   // the larger of normal and binormal
    // Without Monte Carlo nothing speaks against it.
    bool first_order_holds() const;
};

struct BudgetOptions {
    Displacement displacement;
    bool monte_carlo = false;
    MonteCarloOptions drawing = {};
    std::uint64_t seed = 1;
};

// Error (input): no calibrated spot, a spot without reference, a displacement that is none, beyond the region's
// limits or along what it keeps fixed, what plan_region refuses; (usage, cancelled): stopped while drawing.
Expected<RegionBudget> region_budget(const Project& project, const Region& region,
                                     const BudgetOptions& options);

// One standard deviation of what a displacement D of the part moves the path point along the direction, as the
// correction states it: part to part, and the same in all parts. First order, rows of the budget summed.
struct StatedScatter {
    double random_mm = 0, systematic_mm = 0;
};
// At each of the displacements. Error (input): as region_budget; under-determined.
Expected<std::vector<StatedScatter>> stated_scatter(const Project& project, const Region& region,
                                                    const PathDirection& at,
                                                    std::span<const Displacement> displacements);

// Of the part as taught and as displaced by what is required (forecast.h), where the bead is least sure; displacements
// that the region cannot find are passed over. First order alone.
Expected<RegionBudget> worst_budget(const Project& project, const Region& region);

}  // namespace seamwright
