#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "devices/exchange/pose_json.h"
#include "projects/report/svg_plot.h"
#include "projects/scan/fit_report.h"

namespace seamwright {
namespace {

// Blue over white to red, -1 .. 1; told from one another by readers who do not see red from green too.
std::string colour_of(double share) {
    const double t = std::clamp(share, -1.0, 1.0);
    const auto mix = [&](int full) {
        return static_cast<int>(std::lround(255 + std::abs(t) * (full - 255)));
    };
    return t < 0 ? fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(90), mix(178))
                 : fmt::format("#{:02x}{:02x}{:02x}", mix(200), mix(50), mix(0));
}

struct CellMean {
    double sum = 0;
    std::size_t count = 0;
};

std::string number(double value, int decimals) {
    return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string deviation_svg(const FitReport& report, const Cloud& cloud, const Surface& surface,
                          Language language) {
    // Seen along the drawing's shortest axis.
    const Eigen::Vector3d sizes = surface.box().sizes();
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int a, int b) { return sizes[a] > sizes[b]; });
    const int across = order[0], up = order[1];
    const double cell = std::max(sizes[across] / 110, 1e-6);
    const Pose part_from_base = report.fit.base_from_part.inverse();
    std::map<std::pair<int, int>, CellMean> cells;
    for (std::size_t i = 0; i < cloud.size() && i < report.deviation.signed_mm.size(); ++i) {
        if (!std::isfinite(report.deviation.signed_mm[i])) continue;
        const Eigen::Vector3d p = part_from_base * cloud.points[i] - surface.box().min();
        CellMean& c = cells[{static_cast<int>(std::floor(p[across] / cell)),
                             static_cast<int>(std::floor(p[up] / cell))}];
        c.sum += static_cast<double>(report.deviation.signed_mm[i]);
        ++c.count;
    }
    double reach = 0.01;
    for (const auto& [key, c] : cells)
        reach = std::max(reach, std::abs(c.sum / static_cast<double>(c.count)));
    const double px = 6, left = 46, top = 28;
    const double width = px * 110, height = px * std::ceil(sizes[up] / cell + 1);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" "
        "font-family=\"sans-serif\" "
        "font-size=\"12\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
        "fill=\"#f3f4f6\"/>",
        width + left + 110, height + top + 34, width + left + 110, left, top, width + px, height);
    for (const auto& [key, c] : cells)
        svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>",
                           left + px * key.first, top + height - px * (key.second + 1), px + 0.2, px + 0.2,
                           colour_of(c.sum / static_cast<double>(c.count) / reach));
    const double bar = left + width + 2 * px + 8;
    constexpr int kSteps = 40;
    for (int k = 0; k < kSteps; ++k)
        svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"{:.1f}\" fill=\"{}\"/>",
                           bar, top + height * k / kSteps, height / kSteps + 0.3,
                           colour_of(1 - 2.0 * k / (kSteps - 1)));
    for (int k = 0; k <= 4; ++k)
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{:+.2f}</text>", bar + 18,
                           top + height * k / 4 + 4, reach * (1 - k / 2.0));
    const Eigen::Vector3d worst = report.deviation.worst_part_mm - surface.box().min();
    svg += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"7\" fill=\"none\" stroke=\"#111\" stroke-width=\"1.5\"/>"
        "<text x=\"{2:.1f}\" y=\"16\">{3}</text><text x=\"{2:.1f}\" y=\"{4:.1f}\">{5} (mm)</text>"
        "<text x=\"6\" y=\"{6:.1f}\">{7}</text></svg>",
        left + px * worst[across] / cell, top + height - px * worst[up] / cell, left,
        report::escape(
            (report.to_edges()
                 ? Text("end of the sheet, mm: red beyond the drawing's edge, blue short of it; circle: "
                        "worst place")
                 : Text("deviation, mm: red outside, blue inside the drawing; circle: worst place"))
                .in(language)),
        top + height + 20, "XYZ"[across], top + height / 2, "XYZ"[up]);
    return svg;
}

namespace {

report::Plot histogram_plot(const DeviationMap& d, Language language) {
    report::Plot plot;
    plot.title = Text("Histogram of the deviations").in(language);
    plot.x_label = Text("deviation (mm)").in(language);
    plot.y_label = Text("points").in(language);
    report::Series bars;
    bars.mark = report::Mark::bars;
    for (const HistogramBin& b : d.histogram) {
        bars.x.push_back((b.from_mm + b.to_mm) / 2);
        bars.y.push_back(static_cast<double>(b.count));
    }
    plot.series.push_back(bars);
    return plot;
}

report::Rows pose_rows(const SurfaceFit& fit, Language language) {
    const nlohmann::json pose = pose_json(fit.base_from_part);
    const Vector6 all = fit.covariance.diagonal().cwiseMax(0).cwiseSqrt(),
                  noise = fit.covariance_noise.diagonal().cwiseMax(0).cwiseSqrt();
    const bool known = fit.status == FitStatus::ok || fit.status == FitStatus::ambiguous;
    const auto said = [&](const Text& t) { return t.in(language); };
    report::Rows rows{{"", said("value"), said("sigma"), said("of it noise"), said("of it form")}};
    constexpr const char* kNames[] = {"X (mm)", "Y (mm)", "Z (mm)", "A (deg)", "B (deg)", "C (deg)"};
    for (int k = 0; k < 6; ++k) {
        const int tangent = k < 3 ? k : 8 - k;  // A turns about Z
        const double value = k < 3 ? pose["xyz"][static_cast<std::size_t>(k)].get<double>()
                                   : pose["abc"][static_cast<std::size_t>(k - 3)].get<double>();
        const auto shown = [&](double sigma) {
            return known ? number(k < 3 ? sigma : deg_from_rad(sigma), k < 3 ? 3 : 4) : std::string("-");
        };
        const double form =
            std::sqrt(std::max(0.0, all[tangent] * all[tangent] - noise[tangent] * noise[tangent]));
        rows.push_back({kNames[k], number(value, k < 3 ? 3 : 4), shown(all[tangent]), shown(noise[tangent]),
                        shown(form)});
    }
    return rows;
}

}  // namespace

report::Page fit_page(const FitReport& report, const Cloud& cloud, const Surface& surface,
                      Language language) {
    const SurfaceFit& fit = report.fit;
    const auto said = [&](const Text& t) { return t.in(language); };
    report::Page page(
        said(report.to_edges() ? Text("Scan on an edge of the drawing") : Text("Scan on the drawing")),
        std::string(code_of(language)));
    page.heading(
        said(report.to_edges() ? Text("Scan on an edge of the drawing") : Text("Scan on the drawing")), 1);
    page.paragraph(said(Text("Scan {}, part {}.", report.scan, report.part)));
    page.verdict(to_string(fit.status),
                 fit.status == FitStatus::ok ? report::Tone::good : report::Tone::alarm, said(fit.reason));
    if (fit.status == FitStatus::no_fit || fit.status == FitStatus::cancelled) return page;
    page.table(pose_rows(fit, language), said("The part in the robot's base (base_from_workobject)"));
    for (const Text& open : fit.unobservable) page.paragraph(said(Text("Left open: {}", open)));
    const DeviationMap& d = report.deviation;
    report::Rows rows{{said("Deviation of the part from its drawing"), "mm"},
                      {"rms", number(d.rms_mm, 3)},
                      {said("mean"), number(d.mean_mm, 3)},
                      {"3 sigma", number(d.three_sigma_mm, 3)},
                      {said("worst place"), number(d.worst_mm, 3)}};
    if (report.to_edges()) rows.push_back({said("rms out of the sheet"), number(report.normal_rms_mm, 3)});
    page.table(rows);
    if (report.to_edges())
        page.paragraph(said(
            Text("Worst at ({:.1f}, {:.1f}, {:.1f}) of the part. {:.0f} % of the edge ({}) were seen, {:.0f} "
                 "% of the sheet's "
                 "{} ends lie on it.",
                 d.worst_part_mm.x(), d.worst_part_mm.y(), d.worst_part_mm.z(), 100 * d.share_seen,
                 fmt::format("{}", fmt::join(report.edges, ", ")), 100 * fit.share_on_part, fit.points)));
    else
        page.paragraph(
            said(Text("Worst at ({:.1f}, {:.1f}, {:.1f}) of the part. {:.0f} % of its surface were seen, "
                      "{:.0f} % of the "
                      "scan's {} points lie on it.",
                      d.worst_part_mm.x(), d.worst_part_mm.y(), d.worst_part_mm.z(), 100 * d.share_seen,
                      100 * fit.share_on_part, fit.points)));
    page.figure(deviation_svg(report, cloud, surface, language), said("Mean deviation by place"));
    page.figure(report::svg(histogram_plot(d, language)));
    return page;
}

}  // namespace seamwright
