#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projects/report/svg_plot.h"
#include "projects/statistics/statistics_page.h"

namespace seamwright {
namespace {

using report::Mark;
using report::Plot;
using report::Series;
namespace colour = report::colour;

constexpr std::size_t kShownPoints = 300;

Plot small_plot(const Characteristic& c, const Text& title, const Text& x_label, Language language) {
    Plot plot;
    plot.title = title.in(language);
    plot.x_label = x_label.in(language);
    plot.y_label = c.unit;
    plot.width_px = 400;
    plot.height_px = 250;
    return plot;
}

std::size_t first_shown(std::size_t size) {
    return size > kShownPoints ? size - kShownPoints : 0;
}

Series row_of(const Text& name, const std::vector<double>& y, Language language) {
    Series s{name.in(language), {}, {}, Mark::line, colour::kBlue};
    for (std::size_t i = first_shown(y.size()); i < y.size(); ++i) {
        s.x.push_back(static_cast<double>(i + 1));
        s.y.push_back(y[i]);
    }
    return s;
}

std::string shewhart_plot(const Characteristic& c, Language language) {
    const Stability& r = *c.chart;
    Plot plot = small_plot(c, r.size > 1 ? Text("Means of {}", r.size) : Text("Single values"),
                           r.size > 1 ? Text("subgroup") : Text("part"), language);
    plot.series = {row_of("value", r.means_mm, language)};
    Series alarms{Text("alarm").in(language), {}, {}, Mark::crosses, colour::kVermilion};
    for (const StabilityAlarm& a : r.alarms) {
        if (a.spread || a.subgroup < first_shown(r.means_mm.size())) continue;
        if (!alarms.x.empty() && alarms.x.back() == static_cast<double>(a.subgroup + 1)) continue;
        alarms.x.push_back(static_cast<double>(a.subgroup + 1));
        alarms.y.push_back(r.means_mm[a.subgroup]);
    }
    if (!alarms.x.empty()) plot.series.push_back(std::move(alarms));
    plot.bands = {{r.mean_chart.low, r.mean_chart.high, Text("control limits").in(language)}};
    return report::svg(plot);
}

std::string ewma_plot(const Characteristic& c, Language language) {
    Plot plot = small_plot(c, "EWMA", "part", language);
    plot.series = {row_of("EWMA", c.ewma->z, language)};
    for (const int side : {-1, 1}) {
        std::vector<double> limit;
        for (const double half : c.ewma->half_width) limit.push_back(c.summary.mean + side * half);
        Series s = row_of("limits", limit, language);
        s.mark = Mark::dashed;
        s.colour = colour::kAmber;
        if (side > 0) s.name.clear();  // once in the legend
        plot.series.push_back(std::move(s));
    }
    Series beyond{Text("alarm").in(language), {}, {}, Mark::crosses, colour::kVermilion};
    for (const std::size_t i : c.ewma->beyond) {
        if (i < first_shown(c.values.size())) continue;
        beyond.x.push_back(static_cast<double>(i + 1));
        beyond.y.push_back(c.ewma->z[i]);
    }
    if (!beyond.x.empty()) plot.series.push_back(std::move(beyond));
    return report::svg(plot);
}

// Means of values that follow each other where there are more than a plot can show.
std::string trend_plot(const Statistics& s, const Characteristic& c, Language language) {
    Plot plot = small_plot(c, "Over time", "days before the last part", language);
    const double last = s.production.runs[c.runs.back()].day;
    const std::size_t together = (c.values.size() + kShownPoints - 1) / kShownPoints;
    Series values{together > 1 ? Text("means of {}", together).in(language) : Text("value").in(language),
                  {},
                  {},
                  Mark::dots,
                  colour::kBlue};
    for (std::size_t i = 0; i < c.values.size(); i += together) {
        const std::size_t end = std::min(i + together, c.values.size());
        double x = 0, y = 0;
        for (std::size_t k = i; k < end; ++k) {
            x += (s.production.runs[c.runs[k]].day - last) / static_cast<double>(end - i);
            y += c.values[k] / static_cast<double>(end - i);
        }
        values.x.push_back(x);
        values.y.push_back(y);
    }
    plot.series = {std::move(values)};
    if (c.trend) {
        const Trend& t = *c.trend;
        plot.series.push_back({Text("trend").in(language),
                               {-t.span_days, 0},
                               {t.level - t.slope_per_day * t.span_days, t.level},
                               t.significant ? Mark::line : Mark::dashed,
                               colour::kVermilion});
    }
    return report::svg(plot);
}

}  // namespace

std::vector<std::string> statistics_plots(const Statistics& s, const Characteristic& c, Language language) {
    std::vector<std::string> plots;
    if (c.chart) plots.push_back(shewhart_plot(c, language));
    if (c.ewma) plots.push_back(ewma_plot(c, language));
    if (c.values.size() > 1) plots.push_back(trend_plot(s, c, language));
    return plots;
}

}  // namespace seamwright
