#pragma once
// Are the poses of a poor calibration written in another convention? The calibration is solved with the numbers
// read in every way they can be meant (core/geometry/pose_convention.h), and a way is named only when it is the
// only one that explains the data.
//
// Each reading r leaves a residual variance s_r^2 of nu_r degrees of freedom. The one that is right has s^2
// distributed as sigma^2 chi^2_nu / nu, so another one is far better by chance only with the probability of
//     s_r^2 / s_best^2 > F_{1 - alpha/K}(nu_r, nu_best),    alpha = 0.001,
// K readings tried (Bonferroni). Both come from the same measured data, which correlates them and makes chance
// rarer still. So nothing about the size of the noise is assumed, and the fewer poses, the more it takes.
//     named         the best solution fits as well as the method promises, and every other reading's s^2 is beyond
//                   that limit of the best's
//     as_given      the reading as given is good (nothing else is tried), or it fits and none is far better
//     cannot_tell   readings that give the same poses on these data, or none beyond chance of another (both are
//                   named); or no reading fits, which a wrong radius, moved targets and noise leave
//
// What no residual shows: a tool (or a frame of the base) that was active in every pose. It goes whole into the
// place of the sensor (of the target), and the fit is as good.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/verdict.h"
#include "core/geometry/pose_convention.h"

namespace seamwright {

// One list of poses as it was written, for example base_from_flange of every observation.
struct WrittenPoses {
    std::string name;
    std::vector<PoseNumbers> numbers;
    PoseConvention as_given;
};

// How well one solution explains the poses as they were read.
struct ConventionFit {
    double variance = 0;  // s^2, in a unit that is the same for every reading, with a floor: exact data tie
    double freedom = 1;   // nu
    double residual_mm = 0;  // rms, for the person
    bool fits =
        false;  // as well as the method promises where nothing is wrong; never of an undetermined answer
    Verdict verdict = Verdict::undetermined;
};
// Poses by list, in the lists' order. nullopt: nothing was found, or the poses are refused.
using PoseFit = std::function<std::optional<ConventionFit>(const std::vector<std::vector<Pose>>&)>;

struct PoseReading {
    std::vector<PoseConvention> conventions;  // by list
    std::optional<ConventionFit> fit;
};
// Those lists alone that are not read as given: "base_from_flange read as Euler angles ..."; all of them when
// none or every one is.
Text words_of(const PoseReading& reading, std::span<const WrittenPoses> lists);

enum class ConventionFinding { named, as_given, cannot_tell };
std::string_view name_of(ConventionFinding finding);

struct DetectedConvention {
    ConventionFinding finding = ConventionFinding::cannot_tell;
    int tried = 0;                      // readings, those that give equal poses counted each
    PoseReading as_given;               // without fit: these numbers cannot be read so
    std::optional<PoseReading> best;    // the smallest variance among those that fit, else of all
    std::optional<PoseReading> second;  // the next, or the one that gives the same poses as the best
    bool equal_poses = false;           // of best and second
    double ratio = 0, limit = 0;        // second's variance over the best's, and F above
    Text sentence;
};

// `screen`, where there is one, is a quick fit whose variance ranks the readings; `fit` then solves as given and the
// few best, which alone may be named. One list is read otherwise at a time, then all of them alike (whose unit and direction then stay as given: they
// scale and exchange what is looked for, and fit as well). Deterministic.
DetectedConvention detect_convention(std::span<const WrittenPoses> lists, const PoseFit& fit,
                                     const PoseFit& screen = {});

}  // namespace seamwright
