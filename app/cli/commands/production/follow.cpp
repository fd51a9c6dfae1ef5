// seamwright follow: a run whose path is corrected while it runs, by a sensor before the tool.

#include <fmt/format.h>

#include <array>

#include "app/cli/answers/run_text.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "projects/ahead/follow.h"
#include "projects/ahead/simulated_seam.h"
#include "projects/model/part_types.h"
#include "projects/station/check.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct FollowArguments {
    std::string file, guide, part, type;
    bool teach = false, list = false;
    int hold_s = 60;
    FollowOptions follow;
    DrivenGapPass driven;
    SimulatedSeamOptions simulated;
    std::string simulate;
    std::array<double, 3> shift{1.2, -0.8, 0.9};
    double turn_deg = 0.2, bend_mm = 2, twist_mm = 0.5;
};

void tell_run(const RunProgress& p) {
    fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
}

json figures_json(const FollowedRun& f) {
    const SteeringFigures& s = f.figures;
    return {{"guide_mm", f.guide_mm},
            {"guide_hash", f.guide_hash},
            {"latency_ms", f.latency_ms},
            {"kept", s.stored},
            {"implausible", s.implausible},
            {"beyond_limit", s.beyond_limit},
            {"off_guide", s.off_guide},
            {"not_found", s.not_found},
            {"cycles", s.cycles},
            {"cycles_known", s.cycles_known},
            {"from_mm", s.from_mm},
            {"to_mm", s.to_mm},
            {"known_from_mm", s.known_from_mm},
            {"least_ahead_mm", s.least_ahead_mm},
            {"largest_offset_mm", s.largest_mm},
            {"largest_sigma_mm", s.largest_sigma_mm},
            {"largest_behind_mm", s.largest_behind_mm},
            {"smoothed_over_mm", 2 * s.half_width_mm},
            {"alarm", s.alarm ? json(s.alarm->english()) : json()}};
}

Answer answer_of(const FollowedRun& f) {
    const SteeringFigures& s = f.figures;
    Answer answer;
    answer.json = run_json(f.run);
    answer.json["online"] = figures_json(f);
    answer.text = run_text(f.run);
    if (s.cycles > 0)
        answer.text += fmt::format(
            "online: {} features ({} implausible), offset up to {:.3f} mm (sigma {:.4f}), {:.3f} mm behind "
            "at most, "
            "sensor {:.1f} mm ahead at least\n",
            s.stored, s.implausible, s.largest_mm, s.largest_sigma_mm, s.largest_behind_mm, s.least_ahead_mm);
    answer.exit_code = run_exit_code(f.run);
    return answer;
}

Expected<Answer> teach(FollowArguments& a) {
    SEAM_TRY(auto station, open_station(a.file));
    const Project& project = station.project();
    if (a.follow.spot_id.empty() && !a.driven.spot_ids.empty()) a.follow.spot_id = a.driven.spot_ids.front();
    if (a.follow.spot_id.empty())
        return usage_error("it is not known which spot's feature finds the contour", a.file,
                           "name it: --spot ID");
    SEAM_OK(station.connect());
    a.driven.cancel = stop_on_signal();
    a.driven.sensor_id = a.follow.sensor_id;
    a.driven.progress = [](const RunProgress& p) {
        if (p.done == p.total || p.done % 50 == 0) fmt::print(stderr, "{}\n", p.text);
    };
    FollowedPass followed;
    followed.sensor_id = a.follow.sensor_id;
    followed.step_mm = a.driven.step_mm;
    followed.cancel = a.driven.cancel;
    followed.progress = a.driven.progress;
    SEAM_TRY(const auto pass,
             a.driven.spot_ids.empty() ? followed_pass(station, followed) : gap_pass(station, a.driven));
    SEAM_TRY(const auto guide, taught_guide(project, a.follow.spot_id, pass));
    SEAM_TRY(const auto curve, GuideCurve::make(guide));
    const std::string csv = guide_csv(guide);
    SEAM_OK(write_text_file(a.guide, csv));
    SEAM_TRY(const auto kept,
             station.file().keep_guide(std::filesystem::path(a.guide).filename().string(), csv));
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"guide", a.guide},
                   {"guide_hash", kept.hash},
                   {"points", guide.size()},
                   {"length_mm", curve.length_mm()},
                   {"profiles", pass.frames},
                   {"travel_sigma_mm", pass.travel_sigma_mm}};
    answer.text = fmt::format("the contour over {:.1f} mm, {} points from {} profiles: {}\n",
                              curve.length_mm(), guide.size(), pass.frames, a.guide);
    return answer;
}

Expected<Answer> follow(FollowArguments& a) {
    SEAM_TRY(auto station, open_station(a.file, Deed::push));
    SEAM_TRY(auto guide, find_guide(station.file(), a.guide));
    a.follow.guide_csv = std::move(guide.csv);
    a.follow.guide_name = std::move(guide.name);
    SEAM_TRY(const auto type, called_type(station.project(), a.type));
    if (auto refused = refuse_unsafe(station, motion_findings(of_type(station.project(), type), true)))
        return *refused;
    RunOptions options;
    options.part_id = a.part;
    options.part_type = type;
    options.hold = std::chrono::seconds(a.hold_s);
    options.cancel = stop_on_signal();
    options.progress = tell_run;
    SEAM_OK(station.connect({.cancel = options.cancel, .progress = [](const Text& text) {
                                 fmt::print(stderr, "waiting: {}\n", text);
                             }}));
    SEAM_TRY(const auto followed, follow_run(station, options, a.follow));
    return answer_of(followed);
}

// Those that the project keeps, with their tables.
Expected<Answer> list_guides(const FollowArguments& a) {
    SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const auto guides, file.guides());
    Answer answer;
    answer.json = {{"status", "ok"}, {"guides", json::array()}};
    for (const StoredGuide& g : guides) {
        SEAM_TRY(const auto points, parse_guide(g.csv, g.name));
        SEAM_TRY(const auto curve, GuideCurve::make(points));
        answer.json["guides"].push_back({{"name", g.name},
                                         {"utc", g.utc},
                                         {"hash", g.hash},
                                         {"points", points.size()},
                                         {"length_mm", curve.length_mm()},
                                         {"csv", g.csv}});
        answer.text += fmt::format("{:<24}  {}  {:>6} points {:9.1f} mm  {}\n", g.name, g.utc, points.size(),
                                   curve.length_mm(), g.hash.substr(0, 16));
    }
    if (guides.empty()) answer.text = "no guide is kept\n";
    return answer;
}

json way_json(const SeamWay& w) {
    return {{"mean_mm", w.error.mean}, {"three_sigma_mm", w.error.three_sigma}, {"worst_mm", w.worst_mm}};
}

Expected<Answer> simulate(FollowArguments& a) {
    a.simulated.driver = a.simulate;
    SEAM_TRY(auto seam, SimulatedSeam::make(a.simulated, a.file));
    PartState part;
    part.bend = {a.bend_mm, a.twist_mm};
    // About the middle of the door, so that the turn is no shift.
    const Eigen::Vector3d middle(500, 375, 0);
    const Eigen::Matrix3d turn = rotation_exp({0, 0, rad_from_deg(a.turn_deg)});
    part.workobject_from_movedworkobject =
        make_pose(turn, middle - turn * middle + Eigen::Vector3d(a.shift[0], a.shift[1], a.shift[2]));
    seam->cell().set_part(part);
    FollowOptions options = seam->follow();
    options.limit_mm = a.follow.limit_mm;
    options.line = a.follow.line;
    RunOptions run;
    run.part_id = a.part.empty() ? "simulated" : a.part;
    run.hold = std::chrono::seconds(a.hold_s);
    run.cancel = stop_on_signal();
    run.progress = tell_run;
    SEAM_TRY(const auto followed, follow_run(seam->station(), run, options));
    Answer answer = answer_of(followed);
    if (followed.figures.cycles == 0) return answer;
    const SeamErrors e = judge_seam(*seam, followed.base_from_moved);
    answer.json["simulated"] = {
        {"controller", a.simulate},
        {"cycle_ms", a.simulated.cycle_ms},
        {"speed_mm_s", a.simulated.speed_mm_s},
        {"look_ahead_mm", a.simulated.look_ahead_mm},
        {"cell", seam->cell().describe()},
        {"travelled_mm", e.travelled_mm},
        {"cycles", e.cycles},
        {"error",
         {{"without", way_json(e.without)}, {"frame", way_json(e.frame)}, {"online", way_json(e.online)}}}};
    const auto row = [](const char* name, const SeamWay& w) {
        return fmt::format("  {:<22}{:9.3f}{:12.3f}{:9.3f}\n", name, w.error.mean, w.error.three_sigma,
                           w.worst_mm);
    };
    answer.text += fmt::format(
        "simulated ({}, a packet every {} ms, {:g} mm/s, sensor {:g} mm ahead, seed {}, camera noise and "
        "arrivals of {:g} "
        "mm; part bent by {:g} mm): error of the bead across the path and in height against the simulated "
        "truth, mm\n",
        a.simulate, a.simulated.cycle_ms, a.simulated.speed_mm_s, a.simulated.look_ahead_mm, a.simulated.seed,
        seam->cell().settings().robot.repeatability_mm, a.bend_mm);
    answer.text += fmt::format("  {:<22}{:>9}{:>12}{:>9}\n", "", "mean", "3 sigma", "worst");
    answer.text +=
        row("without correction", e.without) + row("offline frame alone", e.frame) + row("online", e.online);
    return answer;
}

Expected<Answer> start(FollowArguments& a) {
    if (a.list) return list_guides(a);
    if (!a.simulate.empty()) return simulate(a);
    if (a.guide.empty())
        return usage_error("there is no guide", a.file,
                           "give the contour as taught: --guide GUIDE.csv (--teach makes it)");
    return a.teach ? teach(a) : follow(a);
}

}  // namespace

void add_follow(CommandLine& line) {
    auto a = std::make_shared<FollowArguments>();
    CLI::App* command =
        line.add("follow",
                 "A push run whose path is corrected while it runs: a sensor that rides before the tool "
                 "measures the contour, and "
                 "what\nthe pushed frame has not found is added in every cycle (RSI, EGM) when the tool "
                 "comes there, by path length. "
                 "The\nguide is the contour as taught; --teach makes it, over the taught part: straight "
                 "along --spots, or following "
                 "a robot\nthat is moved by its own program. Loss of the sensor or of the contour, an offset "
                 "beyond the limit and "
                 "lost packets\nlead the correction back and stop the path: exit 3. --simulate shows it on "
                 "the simulated cell, against "
                 "the truth.",
                 "seamwright follow door_left.seam --teach --spot T2 --guide top.csv\n"
                 "  seamwright follow door_left.seam --region top --guide top.csv --limit-mm 2 --json -\n"
                 "  seamwright follow try.seam --simulate kuka-rsi --cycle-ms 12 --bend-mm 2");
    command->add_option("file", a->file, "The project; with --simulate it is made")
        ->required()
        ->type_name("FILE.seam");
    command
        ->add_option(
            "--guide", a->guide,
            "The contour as taught: poses in the work object, Z up; or one that the project keeps, by name "
            "or hash")
        ->type_name("GUIDE.csv");
    auto* teach = command->add_flag("--teach", a->teach, "Make the guide from a pass over the taught part");
    command
        ->add_flag("--guides", a->list,
                   "List the guides that the project keeps of its runs; with --json with their tables")
        ->excludes(teach);
    command->add_option("--spots", a->driven.spot_ids, "Spots that the robot goes along to teach, in order")
        ->delimiter(',')
        ->type_name("S1,S2,...")
        ->needs(teach);
    command
        ->add_option("--step-mm", a->driven.step_mm, "Of the sensor, from profile to profile of the teaching")
        ->check(CLI::Range(0.05, 20.0))
        ->capture_default_str();
    command->add_option("--region", a->follow.region_id, "Whose path runs, when there are several")
        ->type_name("ID");
    command->add_option("--spot", a->follow.spot_id, "Whose feature finds the contour (the region's first)")
        ->type_name("ID");
    command->add_option("--sensor", a->follow.sensor_id, "The one before the tool (that of the spot)")
        ->type_name("ID");
    command->add_option("--part", a->part, "Name of the part")->type_name("ID");
    command->add_option("--type", a->type, "Its type")->type_name("ID");
    command->add_option("--hold-s", a->hold_s, "How long the path may take to begin")
        ->check(CLI::Range(0, 86400))
        ->capture_default_str();
    command->add_option("--limit-mm", a->follow.limit_mm, "Of the online offset; more is an alarm")
        ->check(CLI::Range(0.01, 1000.0))
        ->capture_default_str();
    command
        ->add_option("--most-gap-mm", a->follow.line.most_gap_mm,
                     "Of the path without a feature; more is an alarm")
        ->check(CLI::Range(1.0, 200.0))
        ->capture_default_str();
    command
        ->add_option("--wanted-sigma-mm", a->follow.line.wanted_sigma_mm,
                     "Of the offset, which the smoothing is for")
        ->check(CLI::Range(0.001, 1.0))
        ->capture_default_str();
    command
        ->add_option_function<double>(
            "--latency-ms", [a](double v) { a->follow.latency_ms = v; },
            "From trigger to exposure, where no measure-trigger has told it")
        ->type_name("MS");
    auto* simulate =
        command->add_option("--simulate", a->simulate, "On the simulated cell, with this controller");
    simulate->check(CLI::IsMember({"kuka-rsi", "abb-egm"}))->excludes(teach);
    const auto only = [&](CLI::Option* option) { option->needs(simulate)->capture_default_str(); };
    only(command->add_option("--cycle-ms", a->simulated.cycle_ms, "RSI: 4 or 12; EGM: multiples of 4")
             ->check(CLI::Range(4, 48)));
    only(command->add_option("--seed", a->simulated.seed, "Of the noise"));
    only(command->add_option("--speed-mm-s", a->simulated.speed_mm_s, "Of the tool")
             ->check(CLI::Range(5.0, 200.0)));
    only(command->add_option("--look-ahead-mm", a->simulated.look_ahead_mm, "Of the sensor")
             ->check(CLI::Range(10.0, 100.0)));
    only(command->add_option("--shift-mm", a->shift, "Of the part, work object")->delimiter(','));
    only(command->add_option("--turn-deg", a->turn_deg, "Of the part about Z, at the door's middle"));
    only(command->add_option("--bend-mm", a->bend_mm, "Of the part at its latch side"));
    only(command->add_option("--twist-mm", a->twist_mm, "Of the part"));
    add_sign_in(command);
    line.on(command, [a] { return start(*a); });
}

}  // namespace seamwright::cli
