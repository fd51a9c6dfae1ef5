#pragma once
// Online correction, simulated, against the offline method on the same parts.
//
// The robot runs once round the door's contour at constant speed. A sensor rides `look_ahead_mm` before the
// tool and measures the contour `rate_hz` times a second against a pass over the taught part; what it
// measured is there `delay_ms` after the exposure. Every cycle (RSI, EGM) the tool takes the correction,
// across the contour and in height, of the place where it will be when the correction acts, from the delay line of
// core/correction/ahead/delay_line.h with a half width of `smooth_mm`. The correction keeps the limits of
// devices/cyclic/trail.h, and the robot follows it with a lag of first order, whose time constant is reckoned
// with. It is limited to `limit_mm`; a part that asks for more raises an alarm and does not count.
//
// Offline: the 12 spots measured once (experiment 3), four regions, the path corrected point by point
// (core/correction/path/path_blend.h), laid without any further sensor.
//
// Error of both: from the tool's point to the nearest point of the displaced, bent part's true contour,
// across the contour and in height, every 2 mm of the path, robot repeatability included. The first
// kRunInMm of the online path bring the correction onto the path and are not counted: a closed contour is run
// into before its start.

#include <string>
#include <vector>

#include "core/evaluation/statistics.h"
#include "devices/cyclic/ramp.h"
#include "projects/evaluate/cell.h"

namespace seamwright::evaluation {

struct OnlineWay {
    bool online = true;
    double speed_mm_s = 100, delay_ms = 40;
    double look_ahead_mm = 30, rate_hz = 100, cycle_ms = 4, lag_ms = 12, smooth_mm = 4, limit_mm = 10;
    RampLimits limits;
    // What is known when the tool needs it: the look-ahead outlasts delay, cycle, lag and smoothing.
    bool in_time() const;
};

struct OnlineResult {
    OnlineWay way;
    bool bent = false;
    int parts = 0, alarms = 0;
    Summary error;        // across and height pooled, all parts
    double sigma_mm = 0;  // of one coordinate, as stated by the covariances; rms along the path
    double behind_share =
        0;                // of the cycles in which the ramp was further than kBehindMm from what was known
    double worst_mm = 0;  // length of (across, height)
    std::vector<double> arc_mm, length_mm;  // of the first part: error along the path
};

struct OnlineExperiment {
    double contour_mm = 0, bend_mm = 0, twist_mm = 0;
    double shift_mm = 0, turn_deg = 0;  // of the parts, uniform per axis
    std::vector<OnlineResult> results;
};

inline constexpr double kRunInMm = 300, kBehindMm = 0.05;

// Error: a spot or the pass cannot be taught.
Expected<OnlineExperiment> online_experiment(const EvaluationSettings& settings,
                                             std::atomic<std::size_t>& profiles);

}  // namespace seamwright::evaluation
