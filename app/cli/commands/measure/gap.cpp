// seamwright gap: where a nozzle would not pass, from a pass along the gap.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/cli/command.h"
#include "app/cli/recording.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "projects/panel/gap_report.h"
#include "projects/reuse/simulated_truth.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct GapArguments {
    std::string file, capture, record, out, report;
    RecordedGapPass recorded;
    DrivenGapPass driven;
    bool simulated = false;
    std::shared_ptr<Recorder> recorder;
    std::uint64_t seed = 1;
    std::string reference = "left";
    std::map<std::string, double> values;  // every parameter, by name
};

json vector_of(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}
json number_if(bool there, double value) {
    return there ? json(value) : json();
}

json stretch_json(const GapCheck& c, const GapStretch& s) {
    const bool width = has_width(s.verdict);
    return {{"verdict", to_string(s.verdict)},
            {"from_mm", s.from_mm},
            {"to_mm", s.to_mm},
            {"where", c.where((s.from_mm + s.to_mm) / 2)},
            {"profiles", s.sections},
            {"narrowest_mm", number_if(width, s.narrowest_mm)},
            {"sigma_mm", number_if(width, s.sigma_mm)},
            {"at_mm", number_if(width, s.at_mm)},
            {"workobject_mm", vector_of(s.place_mm)},
            {"reason", s.message}};
}

json point_json(const GapPoint& p) {
    const bool width = has_width(p.verdict);
    return {{"path_mm", p.path_mm},
            {"verdict", to_string(p.verdict)},
            {"width_mm", number_if(width, p.width_mm)},
            {"sigma_mm", number_if(width, p.sigma_mm)},
            {"flush_mm", number_if(width, p.flush_mm)},
            {"yaw_deg", number_if(width, p.yaw_deg)},
            {"tilt_deg", number_if(width, p.tilt_deg)},
            {"workobject_mm", vector_of(p.middle_mm)},
            {"across", width ? vector_of(p.across) : json()},
            {"along", width ? vector_of(p.along) : json()},
            {"reason", p.message}};
}

json check_json(const GapPass& pass, const GapCheck& c, const GapScanOptions& o) {
    json stretches = json::array(), points = json::array(), spots = json::array();
    for (const GapStretch& s : c.scan.stretches) stretches.push_back(stretch_json(c, s));
    for (const GapPoint& p : c.scan.points) points.push_back(point_json(p));
    for (const auto& [id, path] : c.spots) spots.push_back({{"id", id}, {"path_mm", path}});
    const bool any = c.scan.measured > 0;
    return {{"status", c.scan.passes() ? "ok" : "does_not_pass"},
            {"sensor", pass.sensor_id},
            {"nozzle_mm", o.nozzle_mm},
            {"clearance_mm", o.clearance_mm},
            {"need_mm", o.need_mm()},
            {"frames", pass.frames},
            {"damaged", pass.damaged},
            {"without_pose", pass.without_pose},
            {"without_profile", pass.without_profile},
            {"measured", c.scan.measured},
            {"length_mm", c.scan.length_mm},
            {"narrowest_mm", number_if(any, c.scan.narrowest_mm)},
            {"widest_mm", number_if(any, c.scan.widest_mm)},
            {"largest_yaw_deg", number_if(any, c.scan.largest_yaw_deg)},
            {"spots", spots},
            {"stretches", stretches},
            {"points", points}};
}

// The pass, with the project it was made with.
Expected<std::pair<Project, GapPass>> pass_of(GapArguments& a) {
    if (a.simulated) {
        SEAM_TRY(auto project,
                 simulated_gap_project({{"seed", a.seed}}, default_gap_stations(),
                                       std::filesystem::path(a.file).replace_extension(".ply")));
        if (a.driven.spot_ids.empty() && a.capture.empty())
            for (const Spot& spot : project.spots) a.driven.spot_ids.push_back(spot.id);
        SEAM_OK(ProjectFile::create(a.file, project));
    }
    if (!a.capture.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(auto project, file.load());
        SEAM_TRY(auto capture, CaptureReader::open(a.capture));
        SEAM_TRY(auto pass, gap_pass(project, capture, a.recorded));
        return std::pair{std::move(project), std::move(pass)};
    }
    if (a.driven.spot_ids.empty())
        return usage_error("there is no pass to check", a.file,
                           "give a recorded one with --capture, or the spots to go along with --spots");
    SEAM_TRY(auto station, Station::open(a.file));
    SEAM_TRY(auto recorder, open_recorder(a.record, {.images = true}));
    a.recorder = recorder;
    station.record_to(a.recorder);
    SEAM_OK(station.connect());
    a.driven.cancel = stop_on_signal();
    a.driven.progress = [](const RunProgress& p) {
        if (p.done == p.total || p.done % 50 == 0) fmt::print(stderr, "[{}/{}]\n", p.done, p.total);
    };
    SEAM_TRY(auto pass, gap_pass(station, a.driven));
    return std::pair{station.project(), std::move(pass)};
}

Expected<Answer> check(GapArguments& a) {
    GapScanOptions defaults;
    defaults.gauge.reference =
        a.reference == "left" ? GapFlushSettings::Reference::left : GapFlushSettings::Reference::right;
    SEAM_TRY(const auto options, with_values(defaults, a.values));
    SEAM_TRY(auto made, pass_of(a));
    const auto& [project, pass] = made;
    SEAM_TRY(auto found, check_gap(project, pass, options));
    if (!a.out.empty()) SEAM_OK(write_text_file(a.out, gap_csv(found.scan)));
    if (!a.report.empty())
        if (auto written = write_text_file(a.report, gap_page(pass, found, options, project.name).html());
            !written)
            return tl::unexpected(written.error());
    Answer answer{check_json(pass, found, options), gap_text(pass, found, options),
                  found.scan.passes() ? kExitOk : kExitVerdict};
    SEAM_OK(tell_recording(a.recorder.get(), a.record, answer));
    return answer;
}

}  // namespace

void add_gap(CommandLine& line) {
    auto a = std::make_shared<GapArguments>();
    CLI::App* command = line.add(
        "gap",
        "Width, flush and orientation of a gap along a pass, and the places where the nozzle would not pass, "
        "named\nbefore the application runs. The pass is a capture (`seamwright record` while the robot "
        "travels along the\ncontour), or the robot goes straight from spot to spot, step by step: keep its "
        "way clear. Exit 1 where the\nnozzle does not pass: too narrow, doubtful (within 3 sigma), closed, "
        "or "
        "not measured.",
        "seamwright gap door_left.seam --capture pass.seam --nozzle-mm 3 --clearance-mm 0.5 --report "
        "gap.html\n"
        "  seamwright gap door_left.seam --spots T1,T2,T3 --nozzle-mm 3 --out gap.csv\n"
        "  seamwright gap try.seam --simulated --nozzle-mm 3");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    auto* capture = command->add_option("--capture", a->capture, "A recorded pass: profiles and robot poses");
    capture->type_name("PASS.seam");
    auto* spots =
        command->add_option("--spots", a->driven.spot_ids, "Spots that the robot goes along, in order");
    spots->delimiter(',')->type_name("S1,S2,...")->excludes(capture);
    command->add_option("--step-mm", a->driven.step_mm, "Of the robot, from profile to profile")
        ->check(CLI::Range(0.05, 100.0))
        ->capture_default_str()
        ->excludes(capture);
    command->add_option("--record", a->record, "Keep the pass, to be checked again with --capture")
        ->type_name("PASS.seam")
        ->excludes(capture);
    for (const ParameterInfo& info : gap_scan_parameters()) {
        std::string flag = "--" + info.name;
        std::replace(flag.begin(), flag.end(), '_', '-');
        auto* option = command->add_option_function<double>(
            flag, [a, name = info.name](double value) { a->values[name] = value; },
            fmt::format("{} {:g} to {:g} {}", info.help, info.minimum, info.maximum, info.unit));
        if (info.name == "nozzle_mm")
            option->required();
        else
            option->default_str(fmt::format("{:g}", info.default_value));
    }
    command->add_option("--reference", a->reference, "The side whose surface gives the directions")
        ->check(CLI::IsMember({"left", "right"}))
        ->capture_default_str();
    command->add_option("--sensor", a->recorded.sensor_id, "Which one, when the capture has several")
        ->needs(capture)
        ->type_name("ID");
    command->add_option("--robot", a->recorded.robot_id, "Whose poses, when the capture has several")
        ->needs(capture)
        ->type_name("ID");
    command->add_option("--out", a->out, "One row a profile")->type_name("FILE.csv");
    command->add_option("--report", a->report, "HTML with curves of width, flush and orientation")
        ->type_name("FILE.html");
    auto* simulated =
        command->add_flag("--simulated", a->simulated,
                          "Make FILE.seam first: the simulated cell before two sheets whose gap "
                          "narrows and closes");
    simulated->excludes(capture);
    command->add_option("--seed", a->seed, "With --simulated: every random number follows from it")
        ->needs(simulated);
    line.on(command, [a] { return check(*a); });
}

}  // namespace seamwright::cli
