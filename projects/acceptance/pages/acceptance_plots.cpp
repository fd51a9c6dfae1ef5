#include <algorithm>
#include <cmath>
#include <map>

#include "projects/acceptance/pages/acceptance_page_detail.h"
#include "projects/report/svg_plot.h"

namespace seamwright {

namespace {

using report::Mark;
using report::Plot;
using report::Series;
namespace colour = report::colour;

}  // namespace

std::string run_chart(const AcceptanceWriter& w) {
    const Type1& r = *w.a.type1;
    Plot plot;
    plot.title = w.t("Run chart");
    plot.x_label = w.t("number of the value");
    plot.y_label = "mm";
    plot.width_px = 400;
    plot.height_px = 250;
    Series values{w.t("value"), {}, {}, Mark::dots, colour::kBlue},
        reference{w.t("reference"), {}, {}, Mark::line, colour::kGreen},
        mean{w.t("mean"), {}, {}, Mark::dashed, colour::kVermilion};
    const double half = w.a.settings.share * w.a.settings.tolerance_mm / 2;
    for (const StudyValue& v : w.a.type1_values) {
        values.x.push_back(static_cast<double>(values.x.size() + 1));
        values.y.push_back(v.value_mm);
    }
    for (Series* s : {&reference, &mean}) {
        s->x = {1, static_cast<double>(r.n)};
        s->y.assign(2, s == &mean ? r.mean_mm : r.reference_mm);
    }
    plot.bands = {{r.reference_mm - half, r.reference_mm + half, w.t("share of the tolerance")}};
    plot.series = {reference, mean, values};
    return report::svg(plot);
}

// Classes of the values' own width (Freedman and Diaconis) before the limits of the tolerance.
std::string histogram(const AcceptanceWriter& w) {
    const Type1& r = *w.a.type1;
    std::vector<double> values;
    for (const StudyValue& v : w.a.type1_values) values.push_back(v.value_mm);
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    const double low = values.front(), span = values.back() - low;
    const double width =
        2 * (values[3 * (n - 1) / 4] - values[(n - 1) / 4]) / std::cbrt(static_cast<double>(n));
    const int classes = width > 0 ? std::clamp(static_cast<int>(std::ceil(span / width)), 5, 40) : 5;
    std::vector<double> share(static_cast<std::size_t>(classes));
    for (const double v : values) {
        const int k = static_cast<int>((v - low) / span * classes);
        share[static_cast<std::size_t>(std::clamp(k, 0, classes - 1))] += 100.0 / static_cast<double>(n);
    }
    Plot plot;
    plot.title = w.t("Histogram over the tolerance");
    plot.x_label = w.t("value (mm)");
    plot.y_label = w.t("share (%)");
    plot.width_px = 400;
    plot.height_px = 250;
    Series bars{w.t("share"), {low}, {0}, Mark::area, colour::kBlue},
        limits{w.t("limits"), {}, {}, Mark::dashed, colour::kVermilion},
        reference{w.t("reference"), {}, {}, Mark::line, colour::kGreen};
    for (int k = 0; k < classes; ++k) {
        for (const int edge : {k, k + 1}) {
            bars.x.push_back(low + edge * span / classes);
            bars.y.push_back(share[static_cast<std::size_t>(k)]);
        }
    }
    bars.x.push_back(low + span);
    bars.y.push_back(0);
    const double top = *std::max_element(share.begin(), share.end());
    limits.x = {w.lower(), w.lower(), std::nan(""), w.upper(), w.upper()};
    limits.y = {0, top, std::nan(""), 0, top};
    reference.x.assign(2, r.reference_mm);
    reference.y = {0, top};
    plot.series = {bars, limits, reference};
    return report::svg(plot);
}

std::vector<std::string> parts_plots(const AcceptanceWriter& w) {
    std::vector<std::string> parts;
    Series dots{w.t("value"), {}, {}, Mark::dots, colour::kBlue},
        means{w.t("mean of the part"), {}, {}, Mark::crosses, colour::kVermilion};
    std::map<std::string, std::pair<double, int>> sums;
    for (const StudyValue& v : w.a.type3_values) {
        auto at = std::find(parts.begin(), parts.end(), v.part);
        if (at == parts.end()) at = parts.insert(parts.end(), v.part);
        dots.x.push_back(static_cast<double>(at - parts.begin()));
        dots.y.push_back(v.value_mm);
        sums[v.part].first += v.value_mm;
        ++sums[v.part].second;
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
        means.x.push_back(static_cast<double>(k));
        means.y.push_back(sums[parts[k]].first / sums[parts[k]].second);
    }
    Series deviations{w.t("value minus the part's mean"), {}, {}, Mark::dots, colour::kBlue};
    deviations.x = dots.x;
    for (const StudyValue& v : w.a.type3_values)
        deviations.y.push_back(v.value_mm - sums[v.part].first / sums[v.part].second);
    Plot plot;
    plot.x_label = w.t("part");
    plot.y_label = "mm";
    plot.width_px = 400;
    plot.height_px = 250;
    const std::size_t every = std::max<std::size_t>(1, (parts.size() + 11) / 12);
    for (std::size_t k = 0; k < parts.size(); ++k)
        plot.categories.push_back(k % every ? std::string() : parts[k]);
    plot.title = w.t("Values by part");
    plot.series = {dots, means};
    const std::string both = report::svg(plot);
    plot.title = w.t("About the part's mean");
    plot.series = {deviations};
    return {both, report::svg(plot)};
}

std::string control_chart(const AcceptanceWriter& w, const Stability& r, bool spread) {
    Plot plot;
    plot.title = spread ? w.t("Standard deviations") : w.t("Means");
    plot.x_label = w.t("subgroup");
    plot.y_label = "mm";
    plot.width_px = 400;
    plot.height_px = 250;
    const std::vector<double>& y = spread ? r.s_mm : r.means_mm;
    const Interval& limits = spread ? r.s_chart : r.mean_chart;
    Series line{w.t("value"), {}, y, Mark::line, colour::kBlue},
        alarms{w.t("alarm"), {}, {}, Mark::crosses, colour::kVermilion};
    for (std::size_t i = 0; i < y.size(); ++i) line.x.push_back(static_cast<double>(i + 1));
    for (const StabilityAlarm& alarm : r.alarms) {
        if (alarm.spread != spread) continue;
        alarms.x.push_back(static_cast<double>(alarm.subgroup + 1));
        alarms.y.push_back(y[alarm.subgroup]);
    }
    plot.bands = {{limits.low, limits.high, w.t("control limits")}};
    plot.series = {line};
    if (!alarms.x.empty()) plot.series.push_back(alarms);
    return report::svg(plot);
}

}  // namespace seamwright
