#pragma once
// The budget as it is read: one chapter a region, its tables by measurand, a bar per contribution, Monte Carlo beside
// the first order; in English or German.

#include <span>
#include <string>

#include "projects/proof/budget.h"
#include "projects/report/html.h"

namespace seamwright {

struct BudgetPageOptions {
    Language language = Language::english;
    std::string file;     // the project's
    std::string now_utc;  // ISO 8601; empty: the clock's
    std::string program;  // "Seamwright 0.1.0"
};

report::Page budget_page(std::span<const RegionBudget> budgets, const BudgetPageOptions& options);

Text name_of(ErrorSource source);
Text name_of(Quantity quantity);

}  // namespace seamwright
