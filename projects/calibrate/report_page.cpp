#include "projects/calibrate/report_page.h"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

using nlohmann::json;
using namespace report;

std::string cell(double value) {
    return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

void residual_plots(Page& page, const CalibrationReport& report) {
    constexpr std::size_t kNamedBars = 16;
    for (const auto& [part, label] : {std::pair{&PoseResidual::rms_mm, "residual (mm)"},
                                      {&PoseResidual::deg, "residual (deg)"},
                                      {&PoseResidual::rms_px, "residual (px)"}}) {
        Plot plot;
        plot.title = "Residual per pose";
        plot.y_label = label;
        Series used{"used", {}, {}, Mark::bars, colour::kBlue},
            left_out{"left out", {}, {}, Mark::bars, colour::kAmber};
        bool any = false;
        for (const PoseResidual& pose : report.poses) {
            const double x = static_cast<double>(plot.categories.size());
            plot.categories.push_back(
                report.poses.size() > kNamedBars ? fmt::format("{}", plot.categories.size() + 1) : pose.id);
            if (!std::isfinite(pose.*part)) continue;
            Series& series = pose.used ? used : left_out;
            series.x.push_back(x);
            series.y.push_back(pose.*part);
            any = true;
        }
        if (!any) continue;
        plot.series = {used, left_out};
        page.figure(svg(plot));
    }
}

// Every pixel position in the data, whatever the method calls it.
void collect_pixels(const json& node, Series& out) {
    if (node.is_object()) {
        for (const auto& item : node.items()) {
            if (item.key() == "pixel" && item.value().is_array() && item.value().size() == 2 &&
                item.value()[0].is_number()) {
                out.x.push_back(item.value()[0].get<double>());
                out.y.push_back(item.value()[1].get<double>());
            } else {
                collect_pixels(item.value(), out);
            }
        }
    } else if (node.is_array()) {
        for (const json& child : node) collect_pixels(child, out);
    }
}

void coverage_plot(Page& page, const json& data) {
    Series pixels{"", {}, {}, Mark::dots, colour::kBlue};
    collect_pixels(data, pixels);
    if (data.contains("lines") && data["lines"].is_array())
        for (const json& line : data["lines"])
            for (const json& p : line)
                if (p.is_array() && p.size() == 2 && p[0].is_number())
                    pixels.x.push_back(p[0]), pixels.y.push_back(p[1]);
    if (pixels.x.empty()) return;
    Plot plot;
    plot.title = "Coverage of the field of view";
    plot.x_label = "u (px)";
    plot.y_label = "v (px)";
    plot.equal_scale = true;
    plot.height_px = 420;
    plot.series = {pixels};
    page.figure(svg(plot), "Where nothing was seen, the solution extrapolates.");
}

void collect_poses(const json& node, const char* key, std::vector<Pose>& out) {
    if (node.is_object()) {
        for (const auto& item : node.items()) {
            if (item.key() == key) {
                if (auto pose = parse_pose(item.value(), key)) out.push_back(*pose);
            } else {
                collect_poses(item.value(), key, out);
            }
        }
    } else if (node.is_array()) {
        for (const json& child : node) collect_poses(child, key, out);
    }
}

void pose_plots(Page& page, const json& data, const json& result) {
    for (const char* key : {"base_from_flange", "camera_from_target"}) {
        std::vector<Pose> poses;
        collect_poses(data, key, poses);
        if (poses.empty()) collect_poses(result, key, poses);
        if (poses.size() < 2) continue;
        Plot places, turns;
        places.title = fmt::format("{}: positions", key);
        places.x_label = "X (mm)";
        places.y_label = "Y (mm)";
        places.equal_scale = true;
        turns.title = fmt::format("{}: orientations", key);
        turns.x_label = "rotation vector from the first, about X (deg)";
        turns.y_label = "about Y and Z (deg)";
        places.width_px = turns.width_px = 480;
        Series xy{"", {}, {}, Mark::dots, colour::kBlue},
            y{"about Y", {}, {}, Mark::dots, colour::kVermilion},
            z{"about Z", {}, {}, Mark::crosses, colour::kGreen};
        for (const Pose& pose : poses) {
            xy.x.push_back(pose.translation().x());
            xy.y.push_back(pose.translation().y());
            const Eigen::Vector3d w =
                rotation_log(poses.front().linear().transpose() * pose.linear()) * (180 / kPi);
            y.x.push_back(w.x()), y.y.push_back(w.y());
            z.x.push_back(w.x()), z.y.push_back(w.z());
        }
        places.series = {xy};
        turns.series = {y, z};
        page.figures({svg(places), svg(turns)}, "Orientations must turn about at least two axes.");
    }
}

}  // namespace

std::string calibration_report(const CalibrationMethod& method, const json& data,
                               const CalibrationSolution& solution) {
    const CalibrationReport& report = solution.report;
    Page page("Calibration: " + method.id);
    page.verdict(std::string(name_of(solution.verdict())), tone_of(solution.verdict()),
                 report.judgement.reason.english());
    if (!report.judgement.cure.empty()) page.paragraph(report.judgement.cure.english());
    for (const Text& notice : solution.notices) page.paragraph(notice.english());
    page.heading("Parameters");
    std::vector<std::vector<std::string>> rows = {{"name", "value", "sigma", "unit"}};
    for (const auto& p : report.parameters) rows.push_back({p.name, cell(p.value), cell(p.sigma), p.unit});
    page.table(rows);
    if (!report.correlations.empty()) {
        rows = {{"first", "second", "correlation"}};
        for (const auto& c : report.correlations) rows.push_back({c.first, c.second, cell(c.correlation)});
        page.table(rows, "Parameters that the data can hardly tell apart");
    }
    page.heading("Residuals");
    residual_plots(page, report);
    rows = {{"pose", "rms (mm)", "deg", "rms (px)", "used", "note"}};
    for (const auto& p : report.poses)
        rows.push_back(
            {p.id, cell(p.rms_mm), cell(p.deg), cell(p.rms_px), p.used ? "yes" : "no", p.note.english()});
    page.table(rows);
    if (method.keeps_back) {
        const HoldOut& h = report.hold_out;
        page.heading("Verification on poses not used");
        page.table({{"folds", "left out", "rms (mm)", "largest (mm)", "rms (deg)", "rms (px)"},
                    {std::to_string(h.folds), std::to_string(h.left_out), cell(h.rms_mm), cell(h.max_mm),
                     cell(h.rms_deg), cell(h.rms_px)}});
    }
    page.heading("Geometry");
    coverage_plot(page, data);
    const auto usual = with_usual_poses(method.poses, data);
    pose_plots(page, usual ? usual->data() : data, solution.document);
    return page.html();
}

}  // namespace seamwright
