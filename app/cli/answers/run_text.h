#pragma once
// A run as JSON, as a table for people and as an exit code.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "projects/model/run.h"
#include "projects/station/station.h"

namespace seamwright::cli {

// 0 ok; 3 a device or a push went wrong; 1 everything else.
int run_exit_code(const RunRecord& run);
// The answer in place of a run that must not begin, by its findings (motion_findings), which become an event
// of the project. Nothing when there are none.
std::optional<Answer> refuse_unsafe(Station& station, const std::vector<Error>& findings);
// 0 ok; 3 a device or a push went wrong; 1 everything else.
int run_exit_code(const RunRecord& run);
// The answer of a run that does not begin: the findings, which are an event of the project; nothing without
// one.
std::optional<Answer> refuse_unsafe(Station& station, const std::vector<Error>& findings);
nlohmann::json run_json(const RunRecord& run);
std::string run_text(const RunRecord& run);

}  // namespace seamwright::cli
