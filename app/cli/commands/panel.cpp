// seamwright panel: the gripper's motion that brings the panel into the body as taught.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "app/cli/result_json.h"
#include "core/panel/panel_fit.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct Job {
    std::vector<PanelSpot> spots;
    PanelOptions options;
};

Expected<PanelSide> read_side(const json& spot, const std::string& key, const std::string& path) {
    auto side = json_field(spot, key, path);
    if (!side) return tl::unexpected(side.error());
    const std::string where = json_path(path, key);
    if (auto known = only_fields(**side, {"reference", "measured"}, where); !known)
        return tl::unexpected(known.error());
    auto reference = json_vector3(**side, "reference", where);
    if (!reference) return tl::unexpected(reference.error());
    auto measured = json_vector3(**side, "measured", where);
    if (!measured) return tl::unexpected(measured.error());
    return PanelSide{*reference, *measured};
}

Expected<PanelSpot> read_spot(const json& spot, const std::string& path) {
    if (auto known = only_fields(
            spot, {"id", "gripper_from_sensor", "panel", "body", "weights", "sigma_mm", "surface_deg"}, path);
        !known)
        return tl::unexpected(known.error());
    PanelSpot s;
    auto id = json_string(spot, "id", path);
    if (!id) return tl::unexpected(id.error());
    s.id = *id;
    auto pose = json_field(spot, "gripper_from_sensor", path);
    if (!pose) return tl::unexpected(pose.error());
    auto parsed = parse_pose(**pose, json_path(path, "gripper_from_sensor"));
    if (!parsed) return tl::unexpected(parsed.error());
    s.gripper_from_sensor = *parsed;
    auto panel = read_side(spot, "panel", path);
    if (!panel) return tl::unexpected(panel.error());
    s.panel = *panel;
    auto body = read_side(spot, "body", path);
    if (!body) return tl::unexpected(body.error());
    s.body = *body;
    if (spot.contains("weights")) {
        auto weights = json_vector3(spot, "weights", path);
        if (!weights) return tl::unexpected(weights.error());
        s.weights = *weights;
    }
    auto sigma = json_number_or(spot, "sigma_mm", s.sigma_mm, path);
    if (!sigma) return tl::unexpected(sigma.error());
    s.sigma_mm = *sigma;
    auto surface = json_number_or(spot, "surface_deg", 0, path);
    if (!surface) return tl::unexpected(surface.error());
    s.surface_rad = rad_from_deg(*surface);
    return s;
}

Expected<Job> read_job(const std::string& file) {
    auto text = read_text_file(file);
    if (!text) return tl::unexpected(text.error());
    auto document = parse_json(*text, file);
    if (!document) return tl::unexpected(document.error());
    if (auto known = only_fields(*document, {"spots", "limits"}, ""); !known)
        return tl::unexpected(known.error());
    auto spots = json_array(*document, "spots", "");
    if (!spots) return tl::unexpected(spots.error());
    Job job;
    for (std::size_t i = 0; i < (*spots)->size(); ++i) {
        auto spot = read_spot((**spots)[i], json_path("spots", i));
        if (!spot) return tl::unexpected(spot.error());
        job.spots.push_back(std::move(*spot));
    }
    if (document->contains("limits") && !(*document)["limits"].is_null()) {
        const json& limits = (*document)["limits"];
        if (auto known = only_fields(limits, {"translation_mm", "rotation_deg"}, "limits"); !known)
            return tl::unexpected(known.error());
        CorrectionLimits& to = job.options.limits;
        auto translation = json_number_or(limits, "translation_mm", to.translation_mm, "limits");
        if (!translation) return tl::unexpected(translation.error());
        auto rotation = json_number_or(limits, "rotation_deg", to.rotation_deg, "limits");
        if (!rotation) return tl::unexpected(rotation.error());
        to = {*translation, *rotation};
    }
    return job;
}

json value_json(const GapFlushValue& v) {
    return {{"gap_mm", v.gap_mm}, {"flush_mm", v.flush_mm}};
}

json fit_json(const PanelFit& fit) {
    json spots = json::array();
    for (const PanelSpotResult& s : fit.spots)
        spots.push_back({{"id", s.id},
                         {"gap_mm", s.remaining.gap_mm},
                         {"flush_mm", s.remaining.flush_mm},
                         {"residual_mm", vector_json(s.residual_mm)},
                         {"taught", value_json(s.taught)},
                         {"before", value_json(s.before)},
                         {"panel_used", s.panel_used},
                         {"body_used", s.body_used}});
    return {
        {"status", to_string(fit.status)},
        {"gripper_motion", pose_json(fit.gripper_motion)},
        {"single_step", pose_json(fit.single_step)},
        {"sigma", {{"xyz_mm", vector_json(fit.sigma_xyz_mm)}, {"abc_deg", vector_json(fit.sigma_abc_deg)}}},
        {"covariance", matrix_json(fit.covariance)},
        {"rms_mm", fit.rms_mm},
        {"panel", correction_json(fit.panel)},
        {"body", correction_json(fit.body)},
        {"spots", spots},
        {"unobservable", fit.unobservable},
        {"message", fit.message}};
}

std::string fit_text(const PanelFit& fit) {
    std::string text =
        fmt::format("{}{}{}\n", to_string(fit.status), fit.message.empty() ? "" : ": ", fit.message);
    for (const std::string& direction : fit.unobservable) text += "unobservable: " + direction + "\n";
    if (fit.status == CorrectionStatus::under_determined) return text;
    text += "G      " + pose_text(fit.gripper_motion) + "\n";
    text += fmt::format("sigma  X {:.3f}  Y {:.3f}  Z {:.3f} mm   A {:.4f}  B {:.4f}  C {:.4f} deg\n",
                        fit.sigma_xyz_mm.x(), fit.sigma_xyz_mm.y(), fit.sigma_xyz_mm.z(),
                        fit.sigma_abc_deg.x(), fit.sigma_abc_deg.y(), fit.sigma_abc_deg.z());
    text += fmt::format("left off after the motion, rms {:.4f} mm:\n", fit.rms_mm);
    for (const PanelSpotResult& s : fit.spots)
        text +=
            fmt::format("  {:<12} gap {:+8.4f}   flush {:+8.4f} mm   (as measured {:+8.4f}, {:+8.4f}){}{}\n",
                        s.id, s.remaining.gap_mm, s.remaining.flush_mm, s.before.gap_mm, s.before.flush_mm,
                        s.panel_used ? "" : "   panel left out: contradicts the others",
                        s.body_used ? "" : "   body left out: contradicts the others");
    return text;
}

Expected<Answer> panel(const std::string& file) {
    auto job = read_job(file);
    if (!job) return tl::unexpected(job.error());
    auto fit = fit_panel(job->spots, job->options);
    if (!fit) return tl::unexpected(fit.error());
    Answer answer;
    answer.json = fit_json(*fit);
    answer.text = fit_text(*fit);
    answer.exit_code = fit->status == CorrectionStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_panel(CommandLine& line) {
    CLI::App* command = line.add(
        "panel",
        "Motion of the gripper that brings the panel into the body as taught, in a single step.\n"
        "\"gripper_motion\" is G: base_from_gripper_new = base_from_gripper_old * G (in the gripper's own "
        "frame).\n"
        "G minimises the deviation of panel from body at the spots (4.29); \"single_step\" is B * P^-1 of "
        "the\n"
        "separate fits of body and panel; they agree when nothing is deformed.\n"
        "Per spot, what is left off after the motion, now minus taught: residual_mm = panel relative to body "
        "in the\n"
        "sensor frame; gap_mm > 0 = too wide (along the surface); flush_mm > 0 = the panel stands too proud "
        "of "
        "the body\n"
        "(across it). The body is the reference side; surface_deg (default 0) turns its surface from +x "
        "towards +z.",
        "seamwright panel job.json --json -\n"
        "  job.json: "
        "{\"spots\":[{\"id\":\"S1\",\"gripper_from_sensor\":{\"xyz\":[500,0,900],\"abc\":[0,0,0]},\n"
        "             \"panel\":{\"reference\":[0,0,0],\"measured\":[0.3,0,0.1]},\n"
        "             \"body\":{\"reference\":[4,0,0],\"measured\":[4.2,0,-0.1]},\n"
        "             \"weights\":[1,0,1],\"sigma_mm\":0.05}, ...],\n"
        "             \"limits\":{\"translation_mm\":25,\"rotation_deg\":3}}");
    auto file = std::make_shared<std::string>();
    command->add_option("job", *file, "The job (JSON)")->required()->type_name("JOB.json");
    line.on(command, [file] { return panel(*file); });
}

}  // namespace seamwright::cli
