// seamwright new, info, check, export, mirror: project files.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "app/cli/answers/result_json.h"
#include "app/cli/command.h"
#include "app/cli/recording.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file.h"
#include "projects/model/part_types.h"
#include "projects/proof/checklist.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/mirror.h"
#include "projects/station/check.h"
#include "projects/station/station.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

Expected<Answer> new_project(const std::string& path, const std::string& name) {
    Project project;
    project.name = name.empty() ? fs::path(path).stem().string() : name;
    SEAM_OK(ProjectFile::create(path, project));
    Answer answer;
    answer.json = {{"status", "ok"}, {"file", path}, {"name", project.name}};
    answer.text = fmt::format("{} created\n", path);
    return answer;
}

Expected<Answer> info(const std::string& path) {
    if (seam_file_kind(path) == SeamFile::capture) return capture_info(path);
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto runs, file.runs());
    json list = json::array();
    std::string text = fmt::format("{}: {}\n", path, project.name);
    auto lines = [&](const char* title, const auto& items, auto describe) {
        text += fmt::format("{} {}\n", items.size(), title);
        for (const auto& item : items) text += "  " + describe(item) + "\n";
    };
    lines("sensors", project.sensors, [](const SensorSetup& s) {
        return fmt::format("{}  {} {} {}", s.id, s.driver, s.identity.model, s.identity.serial);
    });
    lines("robots", project.robots, [](const RobotSetup& r) {
        return fmt::format("{}  {} {} {}", r.id, r.driver, r.identity.model, r.identity.serial);
    });
    lines("calibrations", project.calibrations, [](const Calibration& c) {
        return fmt::format("{}  {} of sensor {}, {}, {}", c.id, c.method, c.sensor_id, c.created_utc,
                           name_of(c.verdict));
    });
    lines("spots", project.spots, [](const Spot& s) {
        const Text state =
            s.drawn ? Text("{} ({}, edge {})", name_of(s.reference_state), s.drawn->name, s.drawn->edge)
                    : name_of(s.reference_state);
        return fmt::format("{}  {} with sensor {}{}{}", s.id, s.feature.kind, s.sensor_id,
                           s.enabled ? "" : ", switched off",
                           s.reference_profile.size() > 0 ? ", " + state.english() : "");
    });
    if (!project.part_types.empty())
        lines("part types", project.part_types, [&](const PartType& type) {
            const Project one = of_type(project, type.id);
            return fmt::format("{}{}: {} spots, {} regions", name_of(type),
                               type.number ? fmt::format(", number {}", type.number) : "", one.spots.size(),
                               one.regions.size());
        });
    json unconfirmed = json::array();
    for (const Spot& s : project.spots)
        if (s.reference_state == ReferenceState::from_drawing) unconfirmed.push_back(s.id);
    lines("regions", project.regions, [&](const Region& r) {
        const auto open = unconfirmed_spots(project, r);
        return fmt::format("{}  {} spots, frame {}{}", r.id, r.spot_ids.size(), r.frame_name,
                           open.empty() ? "" : fmt::format(", {} not confirmed", open.size()));
    });
    text += fmt::format("{} runs\n", runs.size());
    for (const RunSummary& r : runs) {
        text += fmt::format("  {}  part {}{}  {}  {}  {}\n", r.number, r.part_id,
                            r.type_id.empty() ? "" : " of type " + r.type_id, r.started_utc,
                            r.push ? "push" : "dry run", to_string(r.status));
        list.push_back({{"number", r.number},
                        {"part", r.part_id},
                        {"started_utc", r.started_utc},
                        {"push", r.push},
                        {"status", to_string(r.status)},
                        {"message", r.message},
                        {"spots", r.spots},
                        {"captures", r.captures}});
        if (!r.type_id.empty()) list.back()["type"] = r.type_id;
    }
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"name", project.name},
                   {"sensors", project.sensors.size()},
                   {"robots", project.robots.size()},
                   {"calibrations", project.calibrations.size()},
                   {"spots", project.spots.size()},
                   {"regions", project.regions.size()},
                   {"part_types", project.part_types.size()},
                   {"unconfirmed_spots", unconfirmed},
                   {"runs", list},
                   {"project", export_project(project)}};
    answer.text = text;
    return answer;
}

struct CheckArguments {
    std::string file, language = "en";
    bool commissioned = false, connect = false;
};

// Who answers now, for the checklist.
Expected<void> ask_devices(const std::string& path, Facts& facts) {
    SEAM_TRY(auto station, Station::open(path, FileAccess::read_only));
    facts.sensors.emplace();
    facts.robots.emplace();
    if (auto connected = station.connect(); !connected) {
        fmt::print(stderr, "{}\n", connected.error().sentence());
        return {};  // nobody answers: the checklist says so
    }
    for (const SensorSetup& s : station.project().sensors) facts.sensors->push_back({s.id, true, {}});
    for (const RobotSetup& r : station.project().robots) {
        auto mode = station.robot(r.id)->mode();
        facts.robots->push_back({r.id, true, mode ? std::string() : mode.error().sentence()});
    }
    return {};
}

json checklist_json(const std::vector<CheckItem>& items) {
    json list = json::array();
    for (const CheckItem& item : items) {
        json evidence = json::array();
        for (const Text& line : item.evidence) evidence.push_back(line.in(Language::english));
        list.push_back({{"step", to_string(item.step)},
                        {"status", to_string(item.status)},
                        {"finding", item.why.in(Language::english)},
                        {"evidence", evidence}});
    }
    return list;
}

// 0 sound; 1 findings of plausibility (with --commissioned: an open step); 3 the file itself is damaged.
Expected<Answer> check_project(const CheckArguments& a) {
    const std::string& path = a.file;
    if (seam_file_kind(path) == SeamFile::capture) return capture_check(path);
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    Answer answer;
    json integrity = json::array(), plausibility = json::array();
    for (const Error& e : file.check()) integrity.push_back(e.sentence());
    SEAM_TRY(auto project, file.load());
    for (const Error& e : check(project)) plausibility.push_back(e.sentence());
    Facts facts;
    SEAM_OK(gather(file, facts));
    if (a.connect) SEAM_OK(ask_devices(path, facts));
    const std::vector<CheckItem> items = checklist(project, facts);
    const bool commissioned =
        std::all_of(items.begin(), items.end(), [](const CheckItem& item) { return item.done(); });
    const bool findings = !plausibility.empty() || (a.commissioned && !commissioned);
    answer.exit_code = !integrity.empty() ? kExitDevice : findings ? kExitVerdict : kExitOk;
    answer.json = {{"status", answer.exit_code == kExitOk ? "ok"
                              : integrity.empty()         ? "findings"
                                                          : "damaged"},
                   {"integrity", integrity},
                   {"plausibility", plausibility},
                   {"commissioned", commissioned},
                   {"checklist", checklist_json(items)}};
    answer.text = integrity.empty() ? "integrity ok\n" : "the file is damaged\n";
    for (const auto& s : integrity) answer.text += "  " + s.get<std::string>() + "\n";
    answer.text += plausibility.empty() ? "plausible\n" : "findings\n";
    for (const auto& s : plausibility) answer.text += "  " + s.get<std::string>() + "\n";
    const Language language = *language_from(a.language);
    answer.text += Text("Commissioning").in(language) + "\n";
    for (const CheckItem& item : items) {
        answer.text +=
            fmt::format("  {} {}: {}. {}\n", item.done() ? "[x]" : "[ ]", name_of(item.step).in(language),
                        name_of(item.status).in(language), item.why.in(language));
        for (const Text& line : item.evidence) answer.text += "        " + line.in(language) + "\n";
    }
    return answer;
}

struct ExportArguments {
    std::string file, out, profiles, format = "csv";
    std::int64_t run = 0;
    bool taught_profiles = false;
};

Expected<Answer> export_command(const ExportArguments& a) {
    if (a.out.empty() && a.profiles.empty())
        return usage_error("nothing to export", "export", "give --out FILE.json, --profiles DIR, or both");
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    Answer answer;
    answer.json = {{"status", "ok"}};
    if (!a.out.empty()) {
        SEAM_TRY(auto document, export_file(file, a.taught_profiles));
        SEAM_OK(write_text_file(a.out, document.dump(2) + "\n"));
        answer.json["file"] = a.out;
        answer.text += a.out + " written\n";
    }
    if (!a.profiles.empty()) {
        std::int64_t run = a.run;
        if (run == 0) {
            SEAM_TRY(auto runs, file.runs());
            if (runs.empty())
                return input_error("the project has no run whose profiles could be exported", a.file);
            run = runs.back().number;
        }
        const ProfileFormat format = a.format == "ply"   ? ProfileFormat::ply
                                     : a.format == "pcd" ? ProfileFormat::pcd
                                                         : ProfileFormat::csv;
        SEAM_TRY(auto written, export_profiles(file, run, format, a.profiles));
        answer.json["run"] = run;
        answer.json["profiles"] = json::array();
        for (const fs::path& p : written) answer.json["profiles"].push_back(p.string());
        answer.text += fmt::format("{} profiles of run {} written to {}\n", written.size(), run, a.profiles);
    }
    return answer;
}

struct MirrorArguments {
    std::string file, plane, out;
    double offset_mm = 0;
    bool replace = false;
};

Expected<Answer> mirror_command(const MirrorArguments& a) {
    SEAM_TRY(auto plane, parse_mirror_plane(a.plane, a.offset_mm));
    std::error_code ignored;
    if (fs::equivalent(a.file, a.out, ignored))
        return usage_error("the mirrored project would replace the one it is made from", a.out,
                           "give another file to --out");
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto mirrored, mirrored_project(project, plane));
    mirrored.name = fs::path(a.out).stem().string();
    SEAM_OK(ProjectFile::create(a.out, mirrored, a.replace));
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"file", a.out},
                   {"normal", vector_json(plane.normal)},
                   {"offset_mm", plane.offset_mm},
                   {"spots", mirrored.spots.size()},
                   {"regions", mirrored.regions.size()}};
    answer.text = fmt::format("{} created: {} spots and {} regions mirrored; runs and events stay with {}\n",
                              a.out, mirrored.spots.size(), mirrored.regions.size(), a.file);
    return answer;
}

}  // namespace

void add_project_commands(CommandLine& line) {
    {
        auto path = std::make_shared<std::string>(), name = std::make_shared<std::string>();
        CLI::App* command =
            line.add("new", "Create an empty project.", "seamwright new door_left.seam --name \"Door left\"");
        command->add_option("file", *path, "The project to create")->required()->type_name("FILE.seam");
        command->add_option("--name", *name, "Its name (default: the file's)");
        line.on(command, [path, name] { return new_project(*path, *name); });
    }
    {
        auto path = std::make_shared<std::string>();
        CLI::App* command =
            line.add("info", "Summarise a project or a recorded capture.", "seamwright info door_left.seam");
        command->add_option("file", *path, "The project")->required()->type_name("FILE.seam");
        line.on(command, [path] { return info(*path); });
    }
    {
        auto a = std::make_shared<CheckArguments>();
        CLI::App* command = line.add(
            "check", "Integrity of the file, plausibility of the project, and what is open in commissioning.",
            "seamwright check door_left.seam      (exit 1: findings, 3: damaged)\n"
            "  seamwright check door_left.seam --commissioned --connect");
        command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
        command->add_flag("--commissioned", a->commissioned,
                          "An open step of commissioning is a finding too");
        command->add_flag("--connect", a->connect, "Ask the devices; else those count that answered last");
        command->add_option("--language", a->language, "Of the checklist, en or de")
            ->check(CLI::IsMember({"en", "de"}))
            ->capture_default_str();
        line.on(command, [a] { return check_project(*a); });
    }
    {
        auto a = std::make_shared<ExportArguments>();
        CLI::App* command =
            line.add("export", "The project as JSON without blobs; the profiles of a run as files.",
                     "seamwright export door_left.seam --out door_left.json\n"
                     "  seamwright export door_left.seam --profiles profiles --format ply --run 3");
        command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
        command->add_option("--out", a->out, "Project, runs and events as JSON")->type_name("FILE.json");
        command->add_flag(
            "--with-taught", a->taught_profiles,
            "In the JSON, the spots' reference profiles and templates too: import gives a project that runs");
        command
            ->add_option("--profiles", a->profiles,
                         "Folder for the run's profiles, one file a spot; of a panel's run one a sensor, "
                         "before and after the motion")
            ->type_name("DIR");
        command->add_option("--format", a->format, "csv: sensor frame; ply, pcd: points in base")
            ->check(CLI::IsMember({"csv", "ply", "pcd"}))
            ->capture_default_str();
        command->add_option("--run", a->run, "Which run (default: the last)");
        line.on(command, [a] { return export_command(*a); });
    }
    {
        auto a = std::make_shared<MirrorArguments>();
        CLI::App* command = line.add("mirror", "A project for the mirrored part (left door, right door).",
                                     "seamwright mirror door_left.seam --plane y --out door_right.seam");
        command->add_option("file", a->file, "The project to mirror; it is not changed")
            ->required()
            ->type_name("FILE.seam");
        command
            ->add_option(
                "--plane", a->plane,
                "Plane of the work object: the axis whose sign changes (x, y, z), or its normal NX,NY,NZ")
            ->required();
        command
            ->add_option("--offset-mm", a->offset_mm, "Distance of the plane from the work object's origin")
            ->capture_default_str();
        command->add_option("--out", a->out, "The project to create")->required()->type_name("OTHER.seam");
        command->add_flag("--replace", a->replace, "Replace an existing project file");
        line.on(command, [a] { return mirror_command(*a); });
    }
}

}  // namespace seamwright::cli
