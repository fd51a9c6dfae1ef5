#pragma once
// The acceptance as JSON (the contract's fields) and as text. Lengths are millimetres; a pair [low, high] under
// "limits" is the 95 % confidence of the index of that name, "mean_chart" and "s_chart" of stability are control
// limits.

#include <nlohmann/json.hpp>
#include <string>

#include "projects/acceptance/study/live_study.h"
#include "projects/acceptance/study/studies.h"

namespace seamwright {

nlohmann::json acceptance_json(const Acceptance& acceptance);

// What is predicted of the studies: {"type1_s","bias_u","cg","ev","grr_percent_tolerance"}.
nlohmann::json forecast_json(const StudyForecast& forecast, const AcceptanceSettings& settings);
// A kept offset, and how far a study that is made run by run has come.
nlohmann::json offset_json(const KeptOffset& kept);
nlohmann::json study_progress_json(const StudyProgress& progress);

}  // namespace seamwright
