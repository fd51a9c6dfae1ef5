// seamwright run: the Station from the command line.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "app/cli/answers/result_json.h"
#include "app/cli/answers/run_text.h"
#include "app/cli/command.h"
#include "app/cli/commands/production/watch_outputs.h"
#include "app/cli/recording.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "projects/line/line_control.h"
#include "projects/model/part_types.h"
#include "projects/station/check.h"
#include "projects/station/station.h"
#include "projects/station/watch.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct RunArguments {
    std::string file, part, type, paint;
    bool push = false, dry_run = false, keep_images = false, watch = false;
    int hold_s = static_cast<int>(kHold.count() / 1000);
    std::string log, record;
    std::int64_t parts = 0, keep_runs = 0;
    double start_expiry_s = 10;
    WatchOutputArguments outputs;
};

// One line on the screen: rewritten in place at a terminal, one a change elsewhere.
void print_status(const WatchEvent& e) {
    const WatchCounts& c = e.counts;
    const std::string line =
        fmt::format("{} | parts {} corrected {} refused {} failed {} alarms {} outages {} | {}",
                    to_string(e.state), c.parts, c.corrected, c.refused, c.failed, c.alarms, c.lost, e.text);
    if (isatty(fileno(stderr)))
        fmt::print(stderr, "\r\x1b[K{}", line);
    else if (!std::holds_alternative<watched::SpotDone>(e.happening))
        fmt::print(stderr, "{} {}\n", e.utc, line);
    std::fflush(stderr);
}

json counts_json(const WatchCounts& c) {
    return {{"parts", c.parts},   {"corrected", c.corrected}, {"refused", c.refused}, {"failed", c.failed},
            {"alarms", c.alarms}, {"outages", c.lost},        {"missed", c.missed}};
}

struct HappeningJson {
    json operator()(const watched::Connected&) const { return json::object(); }
    json operator()(const watched::Back&) const { return json::object(); }
    json operator()(const watched::RobotNotice&) const { return json::object(); }
    json operator()(const watched::LineNotice&) const { return json::object(); }
    json operator()(const watched::ProjectNotice&) const { return json::object(); }
    json operator()(const watched::Stopped&) const { return json::object(); }
    json operator()(const watched::Lost& lost) const { return {{"device", lost.device}}; }
    json operator()(const watched::Start& start) const {
        json out = {{"part", start.part_id}};
        if (!start.type_id.empty()) out["type"] = start.type_id;
        return out;
    }
    json operator()(const watched::Missed& missed) const { return {{"part", missed.part_id}}; }
    json operator()(const watched::SpotDone& spot) const {
        return {{"done", spot.done}, {"total", spot.total}};
    }
    json operator()(const watched::RunDone& run) const {
        json regions = json::array();
        for (const RegionRecord& region : run.record->regions)
            regions.push_back({{"id", region.region_id},
                               {"passed", region.gate_passed},
                               {"push", to_string(region.push.status)},
                               {"release", to_string(region.push.release)},
                               {"refusals", region.refusals}});
        json out = {{"part", run.record->part_id},
                    {"run", run.record->number},
                    {"status", to_string(run.record->status)},
                    {"seconds", run.seconds},
                    {"regions", std::move(regions)}};
        if (!run.record->type_id.empty()) out["type"] = run.record->type_id;
        if (run.drift.watched)
            out["drift"] = {{"verdict", to_string(run.drift.verdict)},
                            {"text", run.drift.text},
                            {"stopped", run.drift.stopped},
                            {"due", run.drift.due},
                            {"compensated", run.drift.acting.compensated}};
        return out;
    }
};

json event_json(const WatchEvent& e) {
    json line = {{"utc", e.utc},   {"level", to_string(e.level)}, {"event", name_of(e.happening)},
                 {"text", e.text}, {"state", to_string(e.state)}, {"counts", counts_json(e.counts)}};
    line.update(std::visit(HappeningJson{}, e.happening));
    return line;
}

// One JSON object a line, 10 MiB a file, five files kept.
Expected<std::shared_ptr<spdlog::logger>> open_log(const std::string& file) {
    if (file.empty()) return std::shared_ptr<spdlog::logger>();
    SEAM_OK(check_replaceable(file));
    // It is written on, and rotated away: that must not happen to another kind of file. A pipe or terminal is not read.
    std::error_code none;
    if (std::filesystem::is_regular_file(file, none)) {
        std::ifstream before(file, std::ios::binary);
        const int first = before.peek();
        if (first != std::ifstream::traits_type::eof() && first != '{')
            return input_error("is no log: its first line is no JSON object", file,
                               "give the name of another file");
    }
    try {
        auto sink = std::make_shared<spdlog::sinks::rotating_file_sink_st>(file, 10u << 20, 5);
        sink->set_pattern("%v");
        auto logger = std::make_shared<spdlog::logger>("watch", std::move(sink));
        logger->flush_on(spdlog::level::info);
        return logger;
    } catch (const spdlog::spdlog_ex& e) {
        return file_error(Text("the log cannot be written: {}", e.what()), file);
    }
}

std::string host_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

// What the commissioning checklist asks for: this project has run without a screen.
Expected<void> keep_headless_proof(Station& station, const RunRecord& run) {
    const HeadlessRun proof{run.number, run.part_id, run.push, host_name()};
    SEAM_OK(station.file().append_evidence({0, {}, 0, proof}, of_type(station.project(), run.type_id)));
    return {};
}

// Of a project with part types the watching runs those that are sound, and refuses the parts of the others.
std::vector<Error> findings_of_watching(const Project& project, const RunArguments& a) {
    if (project.part_types.empty()) return motion_findings(project, a.push);
    std::vector<Error> findings;
    for (const PartType& type : project.part_types)
        if (auto sound = runnable_type(project, type.id, a.push); !sound) findings.push_back(sound.error());
    if (findings.size() == project.part_types.size()) return findings;
    for (const Error& finding : findings)
        fmt::print(stderr, "its parts will be refused: {}\n", finding.sentence());
    return {};
}

Expected<Answer> watch_project(const RunArguments& a) {
    SEAM_TRY(auto log, open_log(a.log));
    SEAM_TRY(auto station, open_station(a.file, a.push ? std::optional(Deed::push) : std::nullopt));
    if (a.keep_runs > 0) SEAM_OK(station.file().may(Deed::remove));
    if (!a.type.empty()) SEAM_OK(called_type(station.project(), a.type));
    if (auto refused = refuse_unsafe(station, findings_of_watching(station.project(), a))) return *refused;
    WatchOptions options;
    options.part_type = a.type;
    options.paint = a.paint;
    options.push = a.push;
    options.keep_images = a.keep_images;
    options.parts = a.parts;
    options.keep_runs = a.keep_runs;
    options.start_expiry = std::chrono::milliseconds(std::llround(1000 * a.start_expiry_s));
    options.cancel = stop_on_signal();
    SEAM_TRY(auto recorder, open_recorder(a.record, {.images = true}));
    station.record_to(recorder);
    SEAM_TRY(auto outputs, WatchOutputs::open(a.outputs, station, a.push));
    SEAM_TRY(auto line, LineControl::open(station.project()));
    for (const std::string& link : line.described()) fmt::print(stderr, "{}\n", link);
    options.line = line.watch_line();
    options.alive = [&] {
        outputs.alive();
        line.alive();
    };
    std::set<std::string> proven;  // types
    Expected<void> proof;
    options.tell = [&](const WatchEvent& e) {
        print_status(e);
        outputs.tell(e);
        line.take(e);
        if (log) log->info(event_json(e).dump(-1, ' ', false, json::error_handler_t::replace));
        // The first good part of a type proves it; one a part would only fill the file.
        const auto* run = std::get_if<watched::RunDone>(&e.happening);
        if (!run || run->record->status != RunStatus::ok || !proven.insert(run->record->type_id).second)
            return;
        if (auto kept = keep_headless_proof(station, *run->record); !kept) proof = kept;
    };
    auto counts = watch(station, options);
    outputs.finish();
    if (isatty(fileno(stderr))) fmt::print(stderr, "\n");
    if (!counts) return tl::unexpected(counts.error());
    if (!proof) return tl::unexpected(proof.error());
    Answer answer;
    answer.json = counts_json(*counts);
    answer.json["status"] = "stopped";
    answer.text =
        fmt::format("{} parts: {} corrected, {} refused, {} failed, {} alarms, {} outages\n", counts->parts,
                    counts->corrected, counts->refused, counts->failed, counts->alarms, counts->lost);
    station.disconnect();
    SEAM_OK(tell_recording(recorder.get(), a.record, answer));
    return answer;
}

Expected<Answer> run(const RunArguments& a) {
    SEAM_TRY(auto station, open_station(a.file, a.push ? std::optional(Deed::push) : std::nullopt));
    SEAM_TRY(const auto type, called_type(station.project(), a.type));
    if (auto refused = refuse_unsafe(station, motion_findings(of_type(station.project(), type), a.push)))
        return *refused;
    SEAM_TRY(auto recorder, open_recorder(a.record, {.images = true}));
    station.record_to(recorder);
    RunOptions options;
    options.part_id = a.part;
    options.part_type = type;
    options.paint = a.paint;
    options.push = a.push;
    options.keep_images = a.keep_images;
    options.hold = std::chrono::seconds(a.hold_s);
    options.cancel = stop_on_signal();
    const Patience patience{.cancel = options.cancel,
                            .progress = [](const Text& text) { fmt::print(stderr, "waiting: {}\n", text); }};
    SEAM_OK(station.connect(patience));
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    SEAM_TRY(auto record, station.run(options));
    // A proof that the file does not take is no reason to call a part failed whose application runs.
    if (record.status == RunStatus::ok)
        if (auto kept = keep_headless_proof(station, record); !kept) {
            if (!record.push) return tl::unexpected(kept.error());
            fmt::print(stderr, "the headless run is not kept as evidence: {}\n", kept.error().sentence());
        }
    Answer answer;
    answer.json = run_json(record);
    answer.text = run_text(record);
    answer.exit_code = run_exit_code(record);
    station.disconnect();
    SEAM_OK(tell_recording(recorder.get(), a.record, answer));
    return answer;
}

}  // namespace

void add_run(CommandLine& line) {
    auto a = std::make_shared<RunArguments>();
    CLI::App* command =
        line.add("run", "Measure a part on the project's devices, correct, and push when told to.",
                 "seamwright run door_left.seam --part CAR-0815 --push");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    auto* part = command->add_option("--part", a->part, "Name of the part in front of the robot");
    command
        ->add_option(
            "--type", a->type,
            "Its type, by id or number, in a project with part types; with --watch where neither robot "
            "nor line says one")
        ->type_name("ID");
    command
        ->add_option("--paint", a->paint,
                     "Its colour, as `expose --paint` names it; with --watch where the line says none")
        ->type_name("NAME");
    auto* push =
        command->add_flag("--push", a->push, "Write the corrected frames, if the safety gate passes them");
    command->add_flag("--dry-run", a->dry_run, "Everything but writing (the default)")->excludes(push);
    auto* hold = command
                     ->add_option("--hold", a->hold_s,
                                  "With --push: seconds for the application to begin; the link is held until "
                                  "then, else nothing is released (exit 1). 0: not waited for")
                     ->needs(push)
                     ->check(CLI::Range(0, 86400))
                     ->capture_default_str();
    command->add_flag("--keep-images", a->keep_images, "Keep the raw images with the run");
    command->add_option("--record", a->record, "Every frame, trigger and pose of the session into a capture")
        ->type_name("FILE");
    auto* watching =
        command->add_flag("--watch", a->watch,
                          "Car after car: wait for the robot's start signal, measure, tell the robot, "
                          "wait again; ends at SIGINT or SIGTERM");
    command->add_option("--parts", a->parts, "With --watch: end after so many parts")
        ->needs(watching)
        ->check(CLI::PositiveNumber);
    command->add_option("--keep", a->keep_runs, "With --watch: keep only so many runs in the project")
        ->needs(watching)
        ->check(CLI::PositiveNumber);
    command
        ->add_option("--start-expiry", a->start_expiry_s,
                     "With --watch: refuse a call that may be older, after an outage; another part may stand "
                     "there by then")
        ->needs(watching)
        ->check(CLI::Range(0.1, 3600.0))
        ->type_name("SECONDS")
        ->capture_default_str();
    command->add_option("--log", a->log, "With --watch: one JSON object an event, rotated at 10 MiB")
        ->needs(watching)
        ->type_name("FILE");
    add_watch_outputs(command, watching, a->outputs);
    part->excludes(watching);
    hold->excludes(watching);
    line.on(command, [a] { return a->watch ? watch_project(*a) : run(*a); });
}

}  // namespace seamwright::cli
