#pragma once
// Latency and jitter of the trigger, from passes over one contour at several speeds in both directions.
//
// What sees it. The sensor passes along the unit direction d = (sin A, cos A, 0) of its own frame, A = 0 being its Y
// as in a run. Exposed the way s too late it looks at another cut, and the feature stands at
//     p(s) = (x(s cos A) - s sin A,  z(s cos A)),
// x(y), z(y) the contour as a pass standing still showed it. The slope p'(0) is what a millimetre of travel does:
// 0 where a contour that stands still is passed along its own direction, and then nothing is seen; about sin A where
// that contour is crossed. s follows from the feature in least squares.
//
// Model, of pass i with the signed speed v_i along d, coming from the side h_i = +1 or -1,
//     s_i = s0 + b h_i + tau v_i + v_i delta_i + e_i
// tau the latency (positive: exposed after the instant that the controller tells, whose pose is taken off s), delta
// the jitter in time, b half of what the robot loses when it turns round, e what scatters while the robot stands at
// the end of such a pass: its arrival and the sensor's noise, of variance a, measured by passes that stop (v = 0).
// What scatters more in motion, in proportion to the speed, is jitter, whoever causes it. Least squares weighted by
// 1 / (a + v^2 var(delta)); the stopped passes enter as the mean of each side.
//
// var(delta) from the weighted squares' sum Q(var) = moving passes - 1 (Mandel and Paule 1970), its limits from
// Q(var*; a*) = chi^2 (the Q profile, Viechtbauer 2007) with a* the generalised pivot of a: exact for normal noise,
// wider than 95 % where the jitter is uniform. Latency by Student's t of as many degrees, the reversal, which the
// stopped passes tell, of theirs. The slope's own
// standard error is a scale of all of them and widens the limits by twice its share.

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/correction/correction.h"
#include "core/error.h"

namespace seamwright {

// How a pass sees its own travel.
struct TravelSight {
    double travel_deg = 0;                            // A
    bool x = true, z = true;                          // what the spot observes
    Eigen::Vector2d place = Eigen::Vector2d::Zero();  // p(0), mm
    ContourCurve curve;                               // x(y), z(y) less p(0)
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // p'(0), mm per mm; not observed: 0
    double slope_sigma = 0;                           // of its length

    Eigen::Vector2d at(double travel_mm) const;            // p(s), mm
    double travel_of(const Eigen::Vector2d& point) const;  // s, mm; not finite where the slope is 0
    // Well enough for a study: kLeastSlope or more, known to a tenth.
    bool sees() const;
};
inline constexpr double kLeastSlope = 0.05;

// `points`: the feature at each travel along Y, the robot standing. Error (input): fewer than 5 points (as
// fit_contour_curve), nothing observed, A beyond 90 degrees.
Expected<TravelSight> travel_sight(std::span<const TravelPoint> points, double travel_deg, bool x, bool z);

struct TriggerPass {
    double velocity_mm_s = 0;  // along d; 0: it stopped there
    bool backward = false;     // it came from the exit's side
    double travel_mm = 0;      // s
};

struct TriggerStudy {
    int moving = 0, standing = 0;
    std::vector<double> speeds_mm_s;  // ascending
    double latency_ms = 0;
    Interval latency_limits_ms;
    double jitter_ms = 0;  // standard deviation of delta
    Interval jitter_limits_ms;
    double reversal_mm = 0;  // b
    Interval reversal_limits_mm;
    double standing_mm = 0;  // standard deviation of e
    // Told from nothing; else only the upper limit says something.
    bool jitter_seen() const { return jitter_limits_ms.low > 0; }
    // Half width of uniform jitter at a speed: of the estimate where it is seen, else of the upper limit.
    double half_width_mm(double speed_mm_s) const;
};
inline constexpr std::size_t kTriggerSpeeds = 3;

// `slope_share`: standard error of the slope over the slope. Error (input): fewer than kTriggerSpeeds speeds, a speed
// without two passes each way, fewer than two stopped passes each way, values that are not finite.
Expected<TriggerStudy> trigger_study(std::span<const TriggerPass> passes, double slope_share);

}  // namespace seamwright
