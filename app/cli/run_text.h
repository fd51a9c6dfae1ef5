#pragma once
// A run as JSON and as a table for people.

#include <nlohmann/json.hpp>
#include <string>

#include "projects/run.h"

namespace seamwright::cli {

nlohmann::json run_json(const RunRecord& run);
std::string run_text(const RunRecord& run);

}  // namespace seamwright::cli
