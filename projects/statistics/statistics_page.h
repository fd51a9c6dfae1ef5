#pragma once
// The statistics as JSON, as a page (HTML, PDF, text), as tables for a workbook, as characteristics for Q-DAS.

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "devices/quality/qdas.h"
#include "devices/quality/workbook.h"
#include "projects/report/html.h"
#include "projects/statistics/statistics.h"

namespace seamwright {

nlohmann::json statistics_json(const Statistics& statistics);
report::Page statistics_page(const Statistics& statistics, Language language, const std::string& program);
// Summary, refusals, and a sheet of the values of each region, a run a line.
Workbook statistics_workbook(const Statistics& statistics, Language language);
// Those with limits on both sides: Q-DAS knows no others.
std::vector<QdasStudy> statistics_qdas(const Statistics& statistics);

// For the page: single values or subgroups with their control limits, the EWMA, the values over time with the line
// through them. The newest of long rows.
std::vector<std::string> statistics_plots(const Statistics& statistics, const Characteristic& c,
                                          Language language);

}  // namespace seamwright
