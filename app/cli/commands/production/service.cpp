// seamwright service: a cell that runs by itself, as a unit of systemd.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "app/cli/commands/production/fleet.h"
#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file.h"
#include "projects/fleet/target.h"

namespace seamwright::cli {
namespace {

struct ServiceArguments {
    std::string file, out, user, identity, password_file, status, status_token, report_every, report_from,
        report_to, fleet, station;
    bool push = false;
    CLI::Option* into_fleet = nullptr;  // --fleet, which may be given without a URL
    std::int64_t keep = 0;
};

// As systemd.syntax(7) quotes a word of ExecStart.
Expected<std::string> quoted(const std::string& word) {
    std::string out = "\"";
    for (const char c : word) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            return usage_error("a control character cannot stand in a unit", word,
                               "give the file another name");
        if (c == '"' || c == '\\') out += '\\';
        if (c == '%' || c == '$') out += c;
        out += c;
    }
    return out + "\"";
}

Expected<std::string> unit_text(const ServiceArguments& a, const std::filesystem::path& program) {
    std::error_code error;
    const auto absolute = [&](const std::string& path) {
        return std::filesystem::absolute(path, error).lexically_normal().string();
    };
    std::vector<std::string> words{program.string(), "run", absolute(a.file), "--watch",
                                   a.push ? "--push" : "--dry-run"};
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) words.insert(words.end(), {option, value});
    };
    add("--user", a.identity);
    add("--password-file", a.password_file.empty() ? "" : absolute(a.password_file));
    add("--keep", a.keep > 0 ? std::to_string(a.keep) : "");
    add("--status", a.status);
    add("--status-token", a.status_token.empty() ? "" : absolute(a.status_token));
    add("--report-every", a.report_every);
    add("--report-from", a.report_from);
    add("--to", a.report_to.empty() ? "" : absolute(a.report_to));
    add("--fleet", a.fleet);
    if (a.fleet.empty() && a.into_fleet->count() > 0) words.emplace_back("--fleet");
    add("--station", a.station);
    std::string line;
    for (const std::string& word : words) {
        auto text = quoted(word);
        if (!text) return text;
        line += (line.empty() ? "" : " ") + *text;
    }
    for (const char c : a.user)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-' && c != '.')
            return usage_error(Text("\"{}\" is no user's name", a.user), "--user");
    std::string description = std::filesystem::path(a.file).filename().string();
    std::string escaped;
    for (const char c : description) escaped += c == '%' ? "%%" : std::string(1, c);
    return fmt::format(
        "[Unit]\n"
        "Description=Seamwright: {}\n"
        "Wants=network-online.target\n"
        "After=network-online.target\n"
        "StartLimitIntervalSec=0\n\n"
        "[Service]\n"
        "Type=notify\n"
        "ExecStart={}\n"
        "Restart=always\n"
        "RestartSec=1\n"
        "# Bad input is not mended by trying again.\n"
        "RestartPreventExitStatus=2\n"
        "# Told every second while it waits or measures; a robot's way from spot to spot is shorter than "
        "this.\n"
        "WatchdogSec=120\n"
        "TimeoutStopSec=120\n"
        "{}"
        "NoNewPrivileges=yes\n"
        "ProtectSystem=full\n"
        "PrivateTmp=yes\n\n"
        "[Install]\n"
        "WantedBy=multi-user.target\n",
        escaped, line, a.user.empty() ? "" : "User=" + a.user + "\n");
}

// Everybody on the computer reads units.
Expected<void> check_fleet(const std::string& url) {
    if (url.empty()) return {};
    SEAM_TRY(const auto target, FleetTarget::from(url));
    if (target.holds_password())
        return usage_error("a unit is no place for a password, everybody can read it", "--fleet",
                           "leave it out and write it into ~/.pgpass of the unit's user");
    return {};
}

Expected<Answer> service_command(const ServiceArguments& a) {
    SEAM_OK(check_fleet(a.fleet));
    SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
    if (a.into_fleet->count() > 0) SEAM_OK(fleet_address(file, a.fleet, a.station).map([](const auto&) {}));
    SEAM_TRY(const auto users, file.users());
    if (a.push && !users.empty() && a.identity.empty())
        return usage_error("the project has users, and the service pushes as none of them", a.file,
                           "give --identity NAME --password-file FILE of a user of the role service");
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error)
        return file_error(Text("where this program lies is not known: {}", system_text(error)),
                          "/proc/self/exe");
    SEAM_TRY(auto text, unit_text(a, program));
    Answer answer;
    answer.json = {{"status", "ok"}, {"unit", text}};
    answer.text = text;
    if (!a.out.empty()) {
        SEAM_OK(write_text_file(a.out, text));
        answer.json["file"] = a.out;
        answer.text = a.out + " written; then: systemctl daemon-reload && systemctl enable --now " +
                      std::filesystem::path(a.out).filename().string() + "\n";
    }
    return answer;
}

}  // namespace

void add_service(CommandLine& line) {
    auto a = std::make_shared<ServiceArguments>();
    CLI::App* command = line.add("service",
                                 "A unit for systemd that runs a project for ever: started with the "
                                 "computer, again within 1 s when it "
                                 "ends or is killed, and killed when it hangs (watchdog).",
                                 "seamwright service door_left.seam --push --status 127.0.0.1:8080 --out "
                                 "/etc/systemd/system/door_left.service");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("--out", a->out, "The unit's file; else it is printed")->type_name("FILE.service");
    command->add_flag("--push", a->push, "As of run: write the corrected frames");
    command->add_option("--user", a->user, "Whose rights it runs with; none: root's");
    auto* identity = command
                         ->add_option("--identity", a->identity,
                                      "As which user of the project it pushes: one of the role service")
                         ->type_name("NAME");
    auto* password = command
                         ->add_option("--password-file", a->password_file,
                                      "His password, readable by the unit's user alone")
                         ->needs(identity)
                         ->type_name("FILE");
    identity->needs(password);
    command->add_option("--keep", a->keep, "As of run: keep only so many runs")->check(CLI::PositiveNumber);
    auto* status = command->add_option("--status", a->status, "As of run: address of the status page");
    command->add_option("--status-token", a->status_token, "As of run")->needs(status)->type_name("FILE");
    auto* to =
        command->add_option("--to", a->report_to, "As of run: folder of the reports")->type_name("DIR");
    auto* every =
        command->add_option("--report-every", a->report_every, "As of run: a report of every 8h")->needs(to);
    to->needs(every);
    command->add_option("--report-from", a->report_from, "As of run: when a shift begins")->needs(every);
    a->into_fleet = add_project_fleet_option(command, a->fleet,
                                             "As of run: the fleet's database, without its password; without "
                                             "a URL the fleet that the project names");
    command->add_option("--station", a->station, "As of run: the station's name")
        ->needs(a->into_fleet)
        ->type_name("NAME");
    line.on(command, [a] { return service_command(*a); });
}

}  // namespace seamwright::cli
