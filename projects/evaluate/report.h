#pragma once
// The evaluation as text, JSON and an HTML page (projects/report).

#include <nlohmann/json.hpp>
#include <string>

#include "projects/evaluate/experiments.h"

namespace seamwright::evaluation {

std::string evaluation_text(const EvaluationResult& result);
nlohmann::json evaluation_json(const EvaluationResult& result);
std::string evaluation_html(const EvaluationResult& result);

// What the method promises, what was found, and whether that is kept; only of what was run.
struct EvaluationCheck {
    std::string promise, found;
    bool kept = false;
};
std::vector<EvaluationCheck> evaluation_checks(const EvaluationResult& result);

}  // namespace seamwright::evaluation
