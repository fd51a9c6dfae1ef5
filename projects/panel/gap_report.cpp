#include "projects/panel/gap_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

std::string stretch_text(const GapCheck& c, const GapStretch& s) {
    const std::string between = c.where((s.from_mm + s.to_mm) / 2).english();
    std::string text = fmt::format("  {:7.1f} .. {:.1f} mm{}: ", s.from_mm, s.to_mm,
                                   between.empty() ? "" : " (" + between + ")");
    switch (s.verdict) {
        case GapVerdict::too_narrow:
            text += fmt::format("too narrow, {:.3f} mm", s.narrowest_mm);
            break;
        case GapVerdict::doubtful:
            text += fmt::format("doubtful, {:.3f} mm", s.narrowest_mm);
            break;
        case GapVerdict::closed:
            text += "closed";
            break;
        default:
            text += "not measured";
    }
    if (has_width(s.verdict))
        text += fmt::format(" (sigma {:.3f}) at {:.1f} mm", s.sigma_mm, s.at_mm);
    else if (!s.message.empty())
        text += ", " + s.message.english();
    return text + fmt::format("; work object X {:.1f} Y {:.1f} Z {:.1f}\n", s.place_mm.x(), s.place_mm.y(),
                              s.place_mm.z());
}

}  // namespace

std::string gap_text(const GapPass& pass, const GapCheck& c, const GapScanOptions& o) {
    const GapScan& scan = c.scan;
    std::string text = fmt::format("{}: {} of {} profiles measured along {:.1f} mm",
                                   scan.passes() ? "the nozzle passes" : "the nozzle does not pass",
                                   scan.measured, pass.frames, scan.length_mm);
    if (scan.measured > 0)
        text += fmt::format("; gap {:.3f} .. {:.3f} mm, cut up to {:.1f} degrees off square",
                            scan.narrowest_mm, scan.widest_mm, scan.largest_yaw_deg);
    text += fmt::format("\nneeded {:.3f} mm: nozzle {:g}, {:g} left on either side, with 3 sigma\n",
                        o.need_mm(), o.nozzle_mm, o.clearance_mm);
    if (pass.damaged + pass.without_pose + pass.without_profile > 0)
        text += fmt::format("{} frames damaged, {} without pose, {} without profile\n", pass.damaged,
                            pass.without_pose, pass.without_profile);
    for (const GapStretch& s : scan.stretches) text += stretch_text(c, s);
    return text;
}

std::string gap_csv(const GapScan& scan) {
    std::string text = "path_mm,verdict,width_mm,sigma_mm,flush_mm,yaw_deg,tilt_deg,x_mm,y_mm,z_mm\n";
    for (const GapPoint& p : scan.points) {
        text += fmt::format("{:.4f},{},", p.path_mm, to_string(p.verdict));
        text += has_width(p.verdict) ? fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},", p.width_mm,
                                                   p.sigma_mm, p.flush_mm, p.yaw_deg, p.tilt_deg)
                                     : ",,,,,";
        text += fmt::format("{:.4f},{:.4f},{:.4f}\n", p.middle_mm.x(), p.middle_mm.y(), p.middle_mm.z());
    }
    return text;
}

report::Page gap_page(const GapPass& pass, const GapCheck& c, const GapScanOptions& o,
                      const std::string& project) {
    report::Page page("Gap check: " + project);
    page.verdict(c.scan.passes() ? "ok" : "does not pass",
                 c.scan.passes() ? report::Tone::good : report::Tone::alarm,
                 c.scan.passes() ? "The nozzle passes everywhere." : "The nozzle does not pass everywhere.");
    page.paragraph(gap_text(pass, c, o));
    report::Plot width, flush, turn;
    width.title = "Gap width along the path";
    width.x_label = flush.x_label = turn.x_label = "path (mm)";
    width.y_label = "width (mm)";
    width.bands = {{o.need_mm(), std::max(c.scan.widest_mm, o.need_mm() + 0.5), "wide enough"}};
    const double floor = std::min(0.0, c.scan.narrowest_mm);
    width.y_min = floor;
    flush.title = "Flush along the path";
    flush.y_label = "flush (mm)";
    turn.title = "Orientation: cut against the gap, surface in the cut";
    turn.y_label = "angle (degree)";
    report::Series w{"width", {}, {}, report::Mark::line, report::colour::kBlue},
        low{"width - 3 sigma", {}, {}, report::Mark::dashed, report::colour::kGrey},
        bad{"does not pass", {}, {}, report::Mark::crosses, report::colour::kVermilion},
        step{"flush", {}, {}, report::Mark::line, report::colour::kBlue},
        yaw{"yaw", {}, {}, report::Mark::line, report::colour::kGreen},
        tilt{"tilt", {}, {}, report::Mark::dashed, report::colour::kPurple};
    for (const GapPoint& p : c.scan.points) {
        const bool there = has_width(p.verdict);
        const auto put = [&](report::Series& s, double v) {
            s.x.push_back(p.path_mm);
            s.y.push_back(there ? v : std::nan(""));
        };
        put(w, p.width_mm);
        put(low, std::max(floor, p.width_mm - 3 * p.sigma_mm));
        if (there && p.verdict != GapVerdict::passes) put(bad, p.width_mm);
        if (p.verdict == GapVerdict::closed) {
            bad.x.push_back(p.path_mm);
            bad.y.push_back(0);
        }
        put(step, p.flush_mm);
        put(yaw, p.yaw_deg);
        put(tilt, p.tilt_deg);
    }
    width.series = {w, low};
    if (!bad.x.empty()) width.series.push_back(bad);
    flush.series = {step};
    turn.series = {yaw, tilt};
    page.figure(report::svg(width));
    page.figures({report::svg(flush), report::svg(turn)});
    if (!c.scan.stretches.empty()) {
        report::Rows rows{{"verdict", "where", "from", "to", "narrowest", "sigma", "at"}};
        for (const GapStretch& s : c.scan.stretches) {
            const bool there = has_width(s.verdict);
            const auto shown = [&](double v, int decimals) {
                return there ? fmt::format("{:.{}f}", v, decimals) : std::string("-");
            };
            rows.push_back({std::string(to_string(s.verdict)), c.where((s.from_mm + s.to_mm) / 2).english(),
                            fmt::format("{:.1f}", s.from_mm), fmt::format("{:.1f}", s.to_mm),
                            shown(s.narrowest_mm, 3), shown(s.sigma_mm, 3), shown(s.at_mm, 1)});
        }
        page.table(rows, "Where the nozzle does not pass, mm along the path");
    }
    return page;
}

}  // namespace seamwright
