#pragma once
// The studies of robot and trigger as they are read: JSON, and chapters of a page in English or German.

#include <nlohmann/json.hpp>

#include "projects/acceptance/equipment/measure_robot.h"
#include "projects/acceptance/equipment/measure_trigger.h"
#include "projects/report/html.h"

namespace seamwright {

// Millimetres and milliseconds; [low, high] under "limits" is the 95 % confidence of the figure of that name.
//   robot: {"status":"ok","robot","rp","limits":{"rp"},"axes":[{"axis","sigma","limits"}],"components_measured",
//           "assumed":[direction],"arrival_covariance":[36],"spots":[{"id","returns","profiles","rp","rp_measured",
//           "arrival":{"x","z"},"noise":{"x","z"},"limits"}],"replaced_covariance","source"}
//   trigger: {"status":"ok|not_seen","spot","slope","latency_ms","jitter_ms","jitter_seen","reversal","standing",
//           "limits","speeds_mm_s","passes","standing_passes","jitter_mm":{spot},"replaced_latency_ms",
//           "replaced_jitter_mm","source"}
nlohmann::json robot_study_json(const MeasuredRobot& measured);
nlohmann::json trigger_study_json(const MeasuredTrigger& measured);

void add_chapter(report::Page& page, Language language, const MeasuredRobot& measured, int level = 2);
void add_chapter(report::Page& page, Language language, const MeasuredTrigger& measured, int level = 2);

}  // namespace seamwright
