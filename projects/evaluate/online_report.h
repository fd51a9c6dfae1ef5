#pragma once
// The study of online correction in the evaluation's report.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "projects/evaluate/online.h"

namespace seamwright::evaluation {

// What was simulated, and what the table's columns say.
std::string online_caption(const OnlineExperiment& o);
// One row a way, headed.
std::vector<std::vector<std::string>> online_table(const OnlineExperiment& o);
// Which ways must not be driven and what cures them: those that err without an alarm.
std::string online_verdict(const OnlineExperiment& o);
nlohmann::json online_json(const OnlineExperiment& o);

// SVG: error along the contour of the first part; 3 sigma against delay.
std::string online_curve(const OnlineExperiment& o, bool bent);
std::string online_speeds(const OnlineExperiment& o);

}  // namespace seamwright::evaluation
