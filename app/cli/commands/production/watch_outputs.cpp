#include "app/cli/commands/production/watch_outputs.h"

#include <fmt/format.h>

#include "app/cli/commands/production/fleet.h"
#include "app/cli/commands/production/service_manager.h"
#include "devices/capture/capture.h"
#include "devices/exchange/files.h"

namespace seamwright::cli {
namespace {

constexpr const char* kProgram = "Seamwright " SEAMWRIGHT_VERSION;

Expected<std::unique_ptr<ShiftReports>> open_reports(const WatchOutputArguments& a,
                                                     const std::filesystem::path& file) {
    if (a.report_every.empty()) return std::unique_ptr<ShiftReports>();
    ShiftReportOptions options;
    SEAM_TRY(auto every, seconds_argument(a.report_every, "--report-every"));
    options.every_s = every;
    // Hours and minutes as a time of some day.
    const auto first = utc_seconds("1970-01-01T" + a.report_from + ":00Z");
    if (!first || a.report_from.size() != 5)
        return usage_error(Text("\"{}\" is no time of the day", a.report_from), "--report-from",
                           "write 06:00");
    options.first_s = *first;
    options.file = file;
    options.folder = a.report_to;
    options.language = *language_from(a.language);
    options.program = kProgram;
    options.written = [](const std::filesystem::path& path) {
        fmt::print(stderr, "{} report {}\n", utc_now(), path.string());
    };
    options.failed = [](const Error& error) {
        fmt::print(stderr, "{} no report: {}\n", utc_now(), error.sentence());
    };
    return std::make_unique<ShiftReports>(std::move(options));
}

// Longer than a connection takes to be refused, far shorter than a service manager waits.
constexpr std::chrono::milliseconds kLastPublishing{8000};

Expected<std::unique_ptr<FleetPublisher>> open_fleet(const WatchOutputArguments& a, ProjectFile& file) {
    if (!a.into_fleet || a.into_fleet->count() == 0) return std::unique_ptr<FleetPublisher>();
    SEAM_TRY(const auto address, fleet_address(file, a.fleet, a.station));
    PublisherOptions options;
    options.station = address.station;
    options.told = [](const Text& text) { fmt::print(stderr, "{} fleet: {}\n", utc_now(), text); };
    return FleetPublisher::start(file, address.target, std::move(options));
}

}  // namespace

Expected<std::string> read_status_token(const std::string& path) {
    if (path.empty()) return std::string();
    SEAM_TRY(auto text, read_text_file(path));
    std::string token = text.substr(0, text.find('\n'));
    while (!token.empty() && (token.back() == '\r' || token.back() == ' ')) token.pop_back();
    if (token.empty())
        return usage_error("the first line of the file is empty", path, "write the token into it");
    return token;
}

void add_watch_outputs(CLI::App* command, CLI::Option* watching, WatchOutputArguments& a) {
    auto* to = command
                   ->add_option("--to", a.report_to,
                                "With --report-every: the folder that the reports are written to")
                   ->type_name("DIR");
    auto* every =
        command
            ->add_option("--report-every", a.report_every,
                         "With --watch: statistics of every such span of time as HTML and JSON, 8h for "
                         "a shift")
            ->needs(watching)
            ->needs(to);
    to->needs(every);
    command->add_option("--report-from", a.report_from, "Local time at which a shift begins")
        ->needs(every)
        ->capture_default_str();
    auto* status = command
                       ->add_option("--status", a.status,
                                    "With --watch: a read-only page of what happens, at this address; also "
                                    "/api/state, /api/parts, /api/alarms (JSON), /metrics (Prometheus)")
                       ->needs(watching)
                       ->type_name("127.0.0.1:8080");
    command
        ->add_option(
            "--status-token", a.status_token,
            "A file with the token that the status page asks for; needed where its address is not of "
            "this computer")
        ->needs(status)
        ->type_name("FILE");
    a.into_fleet =
        add_project_fleet_option(
            command, a.fleet,
            "With --watch: every part into the fleet's database, in the background; what it "
            "does not take waits in the project (`fleet publish`). Without a URL, as the last word, the "
            "fleet that the project names (`fleet set`)")
            ->needs(watching);
    command
        ->add_option("--station", a.station,
                     "With --fleet: the name of this station; else what `fleet set` says, or the project's")
        ->needs(a.into_fleet)
        ->type_name("NAME");
    command->add_option("--report-language", a.language, "en or de, of reports and status page")
        ->needs(watching)
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
}

Expected<WatchOutputs> WatchOutputs::open(const WatchOutputArguments& a, Station& station, bool push) {
    WatchOutputs out;
    if (!a.status.empty()) {
        SEAM_TRY(auto token, read_status_token(a.status_token));
        out.board_ = std::make_unique<StatusBoard>(station.project().name, kProgram, push);
        SEAM_TRY(auto server,
                 StatusServer::start(*out.board_, {a.status, token, *language_from(a.language)}));
        out.server_ = std::make_unique<StatusServer>(std::move(server));
        fmt::print(stderr, "status page: http://{}:{}/\n", a.status.substr(0, a.status.rfind(':')),
                   out.server_->port());
    }
    SEAM_TRY(auto reports, open_reports(a, station.file().path()));
    out.reports_ = std::move(reports);
    SEAM_TRY(out.fleet_, open_fleet(a, station.file()));
    return out;
}

void WatchOutputs::tell(const WatchEvent& event) {
    if (board_) board_->take(event);
    if (fleet_) tell_fleet(event);
    if (std::holds_alternative<watched::SpotDone>(event.happening)) return;
    std::string line = event.text.english();
    for (char& c : line)
        if (c == '\n') c = ' ';  // one assignment a line
    tell_service_manager("STATUS=" + line);
    if (std::holds_alternative<watched::Stopped>(event.happening)) tell_service_manager("STOPPING=1");
}

void WatchOutputs::tell_fleet(const WatchEvent& event) {
    fleet_->measuring(event.state == WatchState::measuring);
    if (const auto* run = std::get_if<watched::RunDone>(&event.happening))
        tell_failed(fleet_->part_done(run->record->number));
}

void WatchOutputs::tell_failed(const Expected<void>& done) {
    const std::string sentence = done ? std::string() : done.error().sentence();
    if (!sentence.empty() && sentence != fleet_failed_)
        fmt::print(stderr, "{} fleet: {}\n", utc_now(), sentence);
    fleet_failed_ = sentence;
}

void WatchOutputs::finish() {
    if (!fleet_) return;
    if (const auto left = fleet_->finish(kLastPublishing); left > 0)
        fmt::print(stderr, "{} fleet: {} runs wait in the project\n", utc_now(), left);
}

void WatchOutputs::alive() {
    if (fleet_) tell_failed(fleet_->idle());
    const auto now = std::chrono::steady_clock::now();
    if (told_ == std::chrono::steady_clock::time_point{}) tell_service_manager("READY=1");
    if (now - told_ < std::chrono::seconds(1)) return;
    told_ = now;
    tell_service_manager("WATCHDOG=1");
}

}  // namespace seamwright::cli
