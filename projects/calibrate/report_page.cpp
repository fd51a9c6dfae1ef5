#include "projects/calibrate/report_page.h"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

using nlohmann::json;
using namespace report;

std::string cell(const json& value) {
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    if (value.is_string()) return value.get<std::string>();
    return value.is_null() ? "-" : value.dump();
}

void residual_plots(Page& page, const json& result) {
    const json poses = result.value("per_pose", json::array());
    for (const auto& [key, label] :
         {std::pair{"rms_mm", "residual (mm)"}, {"deg", "residual (deg)"}, {"rms_px", "residual (px)"}}) {
        Plot plot;
        plot.title = "Residual per pose";
        plot.y_label = label;
        Series used{"used", {}, {}, Mark::bars, colour::kBlue},
            left_out{"left out", {}, {}, Mark::bars, colour::kAmber};
        bool any = false;
        for (const json& pose : poses) {
            const double x = static_cast<double>(plot.categories.size());
            plot.categories.push_back(poses.size() > 16 ? fmt::format("{}", plot.categories.size() + 1)
                                                        : cell(pose["id"]));
            if (!pose.contains(key) || !pose[key].is_number()) continue;
            Series& series = pose.value("used", true) ? used : left_out;
            series.x.push_back(x);
            series.y.push_back(pose[key].get<double>());
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

std::string calibration_report(const std::string& method, const json& data, const json& result) {
    Page page("Calibration: " + method);
    const Verdict verdict = verdict_of(result);
    page.verdict(std::string(name_of(verdict)), tone_of(verdict), result.value("reason", ""));
    if (!result.value("cure", "").empty()) page.paragraph(result.value("cure", ""));
    for (const json& notice : result.value("notices", json::array())) page.paragraph(cell(notice));
    page.heading("Parameters");
    std::vector<std::vector<std::string>> rows = {{"name", "value", "sigma", "unit"}};
    for (const json& p : result.value("parameters", json::array()))
        rows.push_back({cell(p["name"]), cell(p["value"]), cell(p["sigma"]), cell(p["unit"])});
    page.table(rows);
    if (result.contains("correlations") && !result["correlations"].empty()) {
        rows = {{"first", "second", "correlation"}};
        for (const json& c : result["correlations"])
            rows.push_back({cell(c["first"]), cell(c["second"]), cell(c["correlation"])});
        page.table(rows, "Parameters that the data can hardly tell apart");
    }
    page.heading("Residuals");
    residual_plots(page, result);
    rows = {{"pose", "rms (mm)", "deg", "rms (px)", "used", "note"}};
    for (const json& p : result.value("per_pose", json::array()))
        rows.push_back({cell(p["id"]), cell(p["rms_mm"]), cell(p["deg"]), cell(p["rms_px"]),
                        p.value("used", true) ? "yes" : "no", p.value("note", "")});
    page.table(rows);
    if (result.contains("hold_out") && result["hold_out"].is_object()) {
        page.heading("Verification on poses not used");
        rows = {{"folds", "left out", "rms (mm)", "largest (mm)", "rms (deg)", "rms (px)"}, {}};
        for (const char* key : {"folds", "left_out", "rms_mm", "max_mm", "rms_deg", "rms_px"})
            rows[1].push_back(result["hold_out"].contains(key) ? cell(result["hold_out"][key]) : "-");
        page.table(rows);
    }
    page.heading("Geometry");
    coverage_plot(page, data);
    const auto usual = with_usual_poses(method, data);
    pose_plots(page, usual ? usual->data() : data, result);
    return page.html();
}

}  // namespace seamwright
