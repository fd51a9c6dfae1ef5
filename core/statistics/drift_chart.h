#pragma once
// Whether a fixed reference still stands where it was learnt, and if not, whether it wandered or was knocked.
//
// A point is the reference measured once: m directions x_d [mm], its deviation from the learnt mean with the learnt
// warm-up taken off. Noise: independent, normal, sigma_d learnt with nu degrees of freedom, which is why every limit below
// is Student's. Of points that follow each other alike the rates do not hold.
//
// Jump. The newest point lies off BOTH the learnt mean and the line through the kDriftBefore points before it:
//     |x_d - prediction_d| > t_nu(1 - step_chance / 2m) sigma_d sqrt(1 + v),   v the prediction's variance / sigma^2
// A drift carries the line along, so it makes no jump; of 30 points learnt 12 sigma are seen at their first point, 7 every other time.
// Change. Over the newest kDriftWindow points two shapes of the last n = 2 ... 40 points, n on a grid, are fitted with a free
// level before (at least kDriftBefore points): a step and a ramp. The largest |amplitude| / sigma counts against t at
// drift_chance over the number of trials (Bonferroni), so at most that share of quiet points starts an alarm. A ramp of
// a third of sigma a point is named within 20 points.
// Step or drift. All shapes g_n,L(i) = min(i, L) / L, i = 1 ... n, are fitted: L = 1 is a step, L >= 8 a drift, whether it
// goes on (n <= L) or has come to rest. A drift is told where it explains more by kDriftTold in the sum of u_d^2 (likelihood
// 20 : 1), a step by kStepTold (400 : 1, since it stops a line) and where its amplitude is significant at step_chance too and
// still stands: the mean of the newest kStepStands points lies nearer to it than to the level before, as what wandered away and
// came back within the window does not; else
// the change is `unclear`, as one of three sigma is for long.
// Level: EWMA (ewma.h, lambda kDriftLambda) with the lag of a named drift added.
//     slope (1 - lambda) / lambda
// Nelson's rules 1 to 8 (stability.h) per direction, by the learnt sigma; completed by the newest point. A quiet direction
// shows one of rules 1, 2, 5 and 6 every 90th point or so (Champ and Woodall 1987: 91.75 with 8 instead of 9 on a side): they
// ask for a look and stop nothing.

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace seamwright {

inline constexpr int kDriftLearnPoints = 20;
inline constexpr std::size_t kDriftWindow = 60, kDriftBefore = 8;
inline constexpr std::size_t kStepStands = 4;
inline constexpr double kDriftTold = 6, kStepTold = 12, kDriftLambda = 0.3;

enum class DriftVerdict {
    learning,  // nothing is learnt yet
    fine,
    watch,        // a pattern, a drift within the limit, or a change that nobody can tell yet
    recalibrate,  // it stands beyond the limit
    step          // knocked: production stops until a person has looked
};
std::string_view to_string(DriftVerdict verdict);
enum class DriftChange { none, unclear, drift, step };
std::string_view to_string(DriftChange change);

struct DriftChannel {
    double sigma_mm = 0;         // of one point, learnt
    double stated_sigma_mm = 0;  // as measurements state it; 0: none
};

struct DriftChartOptions {
    double limit_mm = 0.1;  // of the level; beyond: recalibrate
    double degrees = 19;    // of the learnt sigmas
    double step_chance = 1e-5, drift_chance = 1e-4;
};

struct DriftRule {
    std::size_t direction = 0;
    int rule = 0;
    bool stated = false;  // rule 1 by three times the stated sigma
};

struct DriftJudgement {
    DriftVerdict verdict = DriftVerdict::fine;
    DriftChange change = DriftChange::none;
    bool jump = false;                             // the step was seen at its first point
    std::size_t direction = 0;                     // that shows the change most
    std::size_t changed = 0;                       // points since it began, the newest one included
    double size_mm = 0;                            // of the change
    double slope_mm = 0;                           // a point; 0: it has come to rest
    std::vector<double> level_mm, level_sigma_mm;  // by direction
    std::vector<DriftRule> rules;                  // completed by the newest point
};

// `points`: rows of as many values as there are channels, oldest first, those of the learning included; the newest is judged.
// Error (input): no point, no channel, rows of another length, not finite, a sigma not above 0, chances beyond (0, 0.1].
Expected<DriftJudgement> judge_drift(std::span<const std::vector<double>> points,
                                     std::span<const DriftChannel> channels,
                                     const DriftChartOptions& options = {});

// --- learning

// A point with the thermal past that it was measured in.
struct DriftLearning {
    std::vector<double> values_mm;
    double running_s = 0;  // since the cell went to work
    double pause_s = -1;   // that it stood before; below 0: for long
};

// How much of the warm-up is still to come, 0 to 1: (1 - exp(-pause / tau)) exp(-running / tau), the cell having been warm
// before the pause. 0 where tau is 0.
double cold_share(double running_s, double pause_s, double time_constant_s);

// x_d = mean_d + cold_share warm_up_d. The curve is kept where the likelihood asks for it at 99.9 %, and only one whose
// end was seen (running three time constants).
struct LearntDriftChart {
    std::vector<double> mean_mm, sigma_mm, warm_up_mm;
    double degrees = 0;
    double time_constant_s = 0;  // 0: no warm-up
};
// Error (input): fewer than kDriftLearnPoints, unequal lengths, not finite; values that still wander at the end, or a step
// among them. Values without scatter: sigma 1 um.
Expected<LearntDriftChart> learn_drift(std::span<const DriftLearning> points);

}  // namespace seamwright
