#pragma once
// A fit as JSON and as a page with its deviation map.

#include <nlohmann/json.hpp>
#include <string>

#include "core/cloud/deviation.h"
#include "core/cloud/fit.h"
#include "projects/report/html.h"

namespace seamwright {

struct FitReport {
    std::string scan, part;  // where they came from
    SurfaceFit fit;
    DeviationMap deviation;  // of `cloud`; empty where there is no fit
    // Of a fit to edges: their ids, and then points are ends of the sheet, `cloud` below is those, and the deviation is along
    // the sheet.
    std::vector<std::string> edges;
    double normal_rms_mm = 0, spacing_mm = 0;
    bool to_edges() const { return !edges.empty(); }
};

// The contract's fields. covariance and sigma are null where the pose is not determined.
nlohmann::json fit_json(const FitReport& report);
std::string fit_text(const FitReport& report);

// `cloud` in base.
report::Page fit_page(const FitReport& report, const Cloud& cloud, const Surface& surface, Language language);
// Mean deviation of cells over the part's two longer axes (the drawing's), with the scale of colours beside it: blue
// inside, white none, red outside.
std::string deviation_svg(const FitReport& report, const Cloud& cloud, const Surface& surface,
                          Language language);

}  // namespace seamwright
