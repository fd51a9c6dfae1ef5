#pragma once
// What a person decides about the drift watch: edits of a project's value, undone like any other. None of them writes a file.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "projects/model/project.h"

namespace seamwright {

struct DriftSettings {
    std::vector<std::string> spot_ids = {};  // empty: as they are
    std::optional<int> every_parts = {};
    std::optional<double> every_minutes = {}, limit_mm = {}, pause_minutes = {};
};
// Makes the watch or changes it. Other spots: what was learnt is gone, and compensation is off. Error (input): what
// check_drift_watch() refuses, a number out of range; the project is as it was.
Expected<void> set_drift_watch(Project& project, const DriftSettings& settings);

// Learns the reference's place, scatter and warm-up from the newest `newest` points (0: all) that were measured as the last one
// was, and that are not set aside. Error (input): no watch, a step is not acknowledged, learn_drift()'s.
Expected<void> learn_drift_watch(Project& project, std::span<const DriftPoint> points, std::size_t newest,
                                 const std::string& now_utc);

// Error (input): no watch, it is so already, on: nothing is learnt, most_mm beyond 0 to kMostCompensatedMm, a step is not
// acknowledged.
inline constexpr double kMostCompensatedMm = 2;
Expected<void> switch_compensation(Project& project, std::span<const DriftPoint> points, bool on,
                                   DriftOf drifts, double most_mm, const std::string& now_utc);

// A person has looked: the points from the step to the newest are set aside, and production may go on. Where sensor or
// reference still stand elsewhere the next point stops it again. Error (input): no watch, nothing to acknowledge, no name.
Expected<SetAside> acknowledge_step(Project& project, std::span<const DriftPoint> points,
                                    const std::string& by, const std::string& text,
                                    const std::string& now_utc);

}  // namespace seamwright
