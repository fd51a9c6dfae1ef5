#pragma once
// What the places' geometry says of a panel job's sensitivity (panel_job.h), beside the learnt one: what is far off it was
// learnt with a panel that slipped, or the sensors stand elsewhere than calibrated.
//
// A motion of the gripper's frame by (v, w) in its own axes carries panel and sensors; the body's point p comes by
// -(v + w x p) to them. Gap and flush answer linearly, as gap_and_flush() has them, about the taught state.
// First order; exact for straight edges.

#include <array>
#include <string>
#include <vector>

#include "projects/model/project.h"

namespace seamwright {

// Rows as PanelSensitivity::rows, of the enabled places. Error: a place without calibration.
Expected<std::vector<std::array<double, 6>>> computed_sensitivity(const Project& project,
                                                                  const PanelJob& job);

// Answers to the learning steps, mm.
struct SensitivityComparison {
    double off_share = 0;   // rms of the difference over rms of the computed answers
    double largest_mm = 0;  // largest difference of a value's answer to one step
    std::string place;      // where that is
    bool flush = false;     // of its flush, else of its gap
};
// Noise alone leaves 2 % or so; beyond this share something is not as it was.
inline constexpr double kSensitivityShare = 0.15;
// Error: none is learnt, or of other places; as computed_sensitivity().
Expected<SensitivityComparison> compare_sensitivity(const Project& project, const PanelJob& job);

}  // namespace seamwright
