// seamwright fleet: the results of many stations in one PostgreSQL database.

#include "app/cli/commands/production/fleet.h"

#include <fmt/format.h>
#include <unistd.h>

#include <thread>

#include "app/cli/command.h"
#include "app/cli/commands/production/watch_outputs.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/capture/capture.h"
#include "projects/file/project_file.h"
#include "projects/fleet/fleet_board.h"
#include "projects/fleet/fleet_schema.h"
#include "projects/fleet/message.h"
#include "projects/fleet/publish.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

constexpr const char* kUrl = "postgresql://USER@HOST/DATABASE";
constexpr const char* kUrlHelp =
    "The fleet's database; its password better in PGPASSWORD, PGPASSFILE or ~/.pgpass than here, where "
    "everybody on "
    "the computer can read it";

Expected<Answer> init(const std::string& to) {
    SEAM_TRY(const auto target, FleetTarget::from(to));
    SEAM_TRY(const auto done, init_fleet(target));
    Answer answer;
    answer.json = {
        {"status", "ok"}, {"to", target.name()}, {"before", done.before}, {"version", done.version}};
    answer.text =
        done.before == done.version
            ? fmt::format("{}: the schema is there already, version {}\n", target.name(), done.version)
            : fmt::format("{}: schema of version {} made\n", target.name(), done.version);
    return answer;
}

struct PublishArguments {
    std::string file, to, station;
};

Expected<Answer> publish(const PublishArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file));
    SEAM_TRY(const auto address, fleet_address(file, a.to, a.station));
    const FleetTarget& target = address.target;
    PublishOptions options;
    options.station = address.station;
    options.cancel = stop_on_signal();
    if (isatty(fileno(stderr)))
        options.progress = [](std::int64_t published, std::int64_t queued) {
            fmt::print(stderr, "\r\x1b[K{} of {}{}", published, queued, published >= queued ? "\n" : "");
        };
    SEAM_TRY(const auto done, publish_file(file, target, options));
    Answer answer;
    answer.json = {{"status", done.waiting > 0 ? "waiting" : "ok"},
                   {"to", target.name()},
                   {"station", done.station},
                   {"published", done.runs},
                   {"waiting", done.waiting},
                   {"refused", json::array()}};
    answer.text =
        fmt::format("station {}: {} runs published, {} waiting\n", done.station, done.runs, done.waiting);
    for (const auto& [run, error] : done.refused) {
        answer.json["refused"].push_back({{"run", run}, {"reason", error.sentence()}});
        answer.text += fmt::format("run {} is not published: {}\n", run, error.sentence());
    }
    answer.exit_code = done.waiting > 0 ? kExitVerdict : kExitOk;
    return answer;
}

struct NameArguments {
    std::string file, to, station;
    bool remove = false;
};

// Named in the project, so that nothing has to say it again.
Expected<Answer> name_fleet(const NameArguments& a) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    if (a.remove) {
        project.fleet.reset();
    } else if (!a.to.empty() || !a.station.empty()) {
        FleetLink link = project.fleet.value_or(FleetLink{});
        if (!a.to.empty()) {
            SEAM_TRY(const auto target, FleetTarget::from(a.to));
            if (target.holds_password())
                return usage_error("a project is no place for a password, its file is copied", "--to",
                                   "leave it out and write it into ~/.pgpass");
            link.address = a.to;
        }
        if (link.address.empty()) return usage_error("the project names no fleet", a.file, "give --to URL");
        if (!a.station.empty()) {
            SEAM_OK(check_station_name(a.station));
            link.station = a.station;
        }
        project.fleet = link;
    }
    SEAM_OK(file.save(project));
    const FleetLink link = project.fleet.value_or(FleetLink{});
    Answer answer;
    answer.json = {{"status", "ok"}, {"to", link.address}, {"station", link.station}};
    answer.text = project.fleet ? fmt::format("{} as {}\n", link.address,
                                              link.station.empty() ? project.name : link.station)
                                : "the project names no fleet\n";
    return answer;
}

struct StatusArguments {
    std::string to, serve, token, language = "en";
};

constexpr const char* kProgram = "Seamwright " SEAMWRIGHT_VERSION;
constexpr std::chrono::seconds kAskedEvery{5};

// Until SIGINT or SIGTERM.
Expected<Answer> serve(const StatusArguments& a, const FleetTarget& target) {
    SEAM_TRY(auto token, read_status_token(a.token));
    const FleetBoard board(target, kProgram, kAskedEvery);
    const Language language = *language_from(a.language);
    SEAM_TRY(auto server,
             StatusServer::start(
                 {{"/api/state", json_page([&board] { return fleet_json(board.view()); })},
                  {"/api/parts", json_page([&board] { return fleet_parts_json(board.view()); })},
                  {"/metrics", {kMetricsPage, [&board] { return fleet_metrics(board.view()); }}},
                  {"/", {kHtmlPage, [&board, language] { return fleet_page(board.view(), language); }}}},
                 {a.serve, token, language}));
    fmt::print(stderr, "status page: http://{}:{}/\n", a.serve.substr(0, a.serve.rfind(':')), server.port());
    const auto stop = stop_on_signal();
    while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    Answer answer;
    answer.json = {{"status", "stopped"}};
    answer.text = "stopped\n";
    return answer;
}

Expected<Answer> status(const StatusArguments& a) {
    SEAM_TRY(const auto target, FleetTarget::from(a.to));
    if (!a.serve.empty()) return serve(a, target);
    constexpr int kParts = 20;
    FleetView view;
    view.fleet = target.name();
    SEAM_TRY(view.standing, fleet_standing(target, kParts));
    view.asked_utc = utc_now();
    Answer answer;
    answer.json = fleet_json(view);
    answer.json["status"] = "ok";
    answer.json["parts"] = fleet_parts_json(view);
    for (const FleetStation& s : view.standing.stations) {
        const FleetPart last = s.last.value_or(FleetPart{});
        answer.text += fmt::format("{:<24} {:>9} parts {:>9} ok {:>7} refused   {} {} {}\n", s.name, s.parts,
                                   s.ok, s.refused, last.utc.substr(0, 19), last.status, last.part);
    }
    if (view.standing.stations.empty()) answer.text = "no station has published yet\n";
    return answer;
}

}  // namespace

CLI::Option* add_fleet_option(CLI::App* command, const std::string& name, std::string& url,
                              const std::string& help) {
    return command->add_option(name, url, help.empty() ? kUrlHelp : help)->type_name(kUrl);
}

CLI::Option* add_project_fleet_option(CLI::App* command, std::string& url, const std::string& help) {
    return add_fleet_option(command, "--fleet", url, help)->expected(0, 1);
}

Expected<FleetAddress> fleet_address(const ProjectFile& file, const std::string& url,
                                     const std::string& station) {
    SEAM_TRY(const auto project, file.load());
    const FleetLink named = project.fleet.value_or(FleetLink{});
    if (url.empty() && named.address.empty())
        return usage_error("the project names no fleet", file.path().string(),
                           "give the URL, or name it: seamwright fleet set FILE.seam --to URL");
    SEAM_TRY(auto target, FleetTarget::from(url.empty() ? named.address : url));
    return FleetAddress{std::move(target), station.empty() ? named.station : station};
}

void add_fleet(CommandLine& line) {
    CLI::App* group =
        line.group("fleet", "Results of many stations in one PostgreSQL database.",
                   "seamwright fleet init --to postgresql://seam@db.plant/fleet\n  seamwright fleet publish "
                   "door.seam --to postgresql://seam@db.plant/fleet --station 'line 2, left'");
    auto url = std::make_shared<std::string>();
    CLI::App* make =
        line.add(*group, "init",
                 "Make the tables (schema \"seamwright\") or bring them up to date; a current one stays.",
                 "seamwright fleet init --to postgresql://seam@db.plant/fleet");
    add_fleet_option(make, "--to", *url)->required();
    line.on(make, [url] { return init(*url); });

    auto a = std::make_shared<PublishArguments>();
    CLI::App* send = line.add(
        *group, "publish",
        "Every finished run that the database does not have: once, whatever is interrupted; what it does not "
        "take stays "
        "queued in the project. Exit 1: something waits.",
        "seamwright fleet publish door.seam --to postgresql://seam@db.plant/fleet --station 'line 2, left'");
    send->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_fleet_option(send, "--to", a->to, "The fleet's database; else the one that the project names");
    send->add_option("--station", a->station,
                     "Its name in the fleet; else what `fleet set` says, or the project's")
        ->type_name("NAME");
    line.on(send, [a] { return publish(*a); });

    auto named = std::make_shared<NameArguments>();
    CLI::App* name = line.add(
        *group, "set",
        "Name the fleet in the project, for `fleet publish`, `run --watch --fleet` and `service --fleet` "
        "without a URL. Its password "
        "never: PGPASSWORD, PGPASSFILE or ~/.pgpass. Alone it shows what the project names.",
        "seamwright fleet set door.seam --to postgresql://seam@db.plant/fleet --station 'line 2, left'");
    name->add_option("file", named->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(name);
    auto* to = add_fleet_option(name, "--to", named->to, "The fleet's database, without a password");
    auto* station =
        name->add_option("--station", named->station, "This station's name in the fleet; else the project's")
            ->type_name("NAME");
    name->add_flag("--remove", named->remove, "The project names none any more")
        ->excludes(to)
        ->excludes(station);
    line.on(name, [named] { return name_fleet(*named); });

    auto at = std::make_shared<StatusArguments>();
    CLI::App* show = line.add(
        *group, "status",
        "The stations, their counts and last parts; with --serve as a page, until SIGINT or SIGTERM.",
        "seamwright fleet status --to postgresql://seam@db.plant/fleet --serve 127.0.0.1:8090");
    add_fleet_option(show, "--to", at->to)->required();
    auto* address =
        show->add_option(
                "--serve", at->serve,
                "A read-only page of all stations at this address; also /api/state, /api/parts (JSON), "
                "/metrics (Prometheus)")
            ->type_name("127.0.0.1:8090");
    show->add_option(
            "--status-token", at->token,
            "A file with the token that the page asks for; needed where its address is not of this computer")
        ->needs(address)
        ->type_name("FILE");
    show->add_option("--language", at->language, "en or de, of the page")
        ->needs(address)
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(show, [at] { return status(*at); });
}

}  // namespace seamwright::cli
