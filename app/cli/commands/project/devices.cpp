// seamwright devices: the drivers, their settings, and a project's devices.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "devices/genicam/genicam.h"
#include "devices/line/line_link.h"
#include "devices/registry.h"
#include "projects/station/station.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

json settings_json(const SettingTable& table) {
    json list = json::array();
    for (const SettingInfo& s : table) {
        json one = {
            {"name", s.name}, {"kind", to_string(s.kind)}, {"default", s.otherwise}, {"help", s.help}};
        if (s.kind == SettingKind::number || s.kind == SettingKind::whole) {
            one["low"] = s.low;
            one["high"] = s.high;
        }
        if (!s.choices.empty()) one["choices"] = s.choices;
        if (!s.former.empty()) one["former"] = s.former;
        if (!s.fields.empty()) one["fields"] = settings_json(s.fields);
        list.push_back(std::move(one));
    }
    return list;
}

Expected<Answer> helped(const CLI::App& command, const std::string& driver) {
    Answer answer;
    if (driver.empty()) {
        answer.text = command.help("seamwright");
        return answer;
    }
    auto text = driver == "all" ? std::optional(settings_document()) : driver_text(driver);
    if (!text) {
        std::string known;
        for (const SensorDriver& d : sensor_drivers()) known += std::string(d.name) + ", ";
        for (const RobotDriver& d : robot_drivers())
            if (known.find(std::string(d.name) + ", ") == std::string::npos)
                known += std::string(d.name) + ", ";
        for (const LineProtocol& p : line_protocols()) known += std::string(p.name) + ", ";
        return usage_error(Text("there is no driver \"{}\"", driver), "--help",
                           Text("known are {}all", known));
    }
    answer.text = *text;
    answer.json = {{"status", "ok"}, {"driver", driver}, {"text", *text}};
    return answer;
}

}  // namespace

void add_devices(CommandLine& line) {
    auto file = std::make_shared<std::string>();
    auto help = std::make_shared<std::string>();
    CLI::App* command = line.add("devices",
                                 "The drivers there are, and with --search the cameras; with a project: its "
                                 "devices, identities and counters.",
                                 "seamwright devices door_left.seam --json -");
    command->set_help_flag();
    auto* asked =
        command->add_option("-h,--help", *help, "This message; with a driver's name, or all, the settings")
            ->expected(0, 1)
            ->type_name("[DRIVER|all]");
    command->add_option("file", *file, "Connect this project's devices")->type_name("FILE.seam");
    auto search = std::make_shared<bool>(false);
    command->add_flag("--search", *search,
                      "Ask all networks of this computer for cameras (GigE Vision broadcast)");
    line.on(command, [file, search, help, asked, command]() -> Expected<Answer> {
        if (asked->count() > 0) return helped(*command, *help);
        Answer answer;
        answer.json = {{"status", "ok"}, {"sensor_drivers", json::array()}, {"robot_drivers", json::array()}};
        answer.text = "sensor drivers\n";
        for (const SensorDriver& d : sensor_drivers()) {
            answer.json["sensor_drivers"].push_back(
                {{"name", d.name}, {"help", d.help}, {"settings", settings_json(d.settings())}});
            answer.text += fmt::format("  {:<12} {}\n", d.name, d.help);
        }
        answer.text += "robot drivers\n";
        for (const RobotDriver& d : robot_drivers()) {
            answer.json["robot_drivers"].push_back(
                {{"name", d.name}, {"help", d.help}, {"settings", settings_json(d.settings())}});
            answer.text += fmt::format("  {:<12} {}\n", d.name, d.help);
        }
        answer.json["line_protocols"] = json::array();
        answer.text += "line protocols\n";
        for (const LineProtocol& p : line_protocols()) {
            answer.json["line_protocols"].push_back(
                {{"name", p.name}, {"help", p.help}, {"settings", settings_json(p.settings())}});
            answer.text += fmt::format("  {:<13} {}\n", p.name, p.help);
        }
        if (*search) {
            answer.json["cameras"] = json::array();
            answer.text += "cameras found\n";
            for (const DiscoveredCamera& c : discover_cameras()) {
                answer.json["cameras"].push_back({{"vendor", c.vendor},
                                                  {"model", c.model},
                                                  {"serial", c.serial},
                                                  {"address", c.address},
                                                  {"protocol", c.protocol}});
                answer.text += fmt::format("  {} {} serial {} at {} ({})\n", c.vendor, c.model, c.serial,
                                           c.address, c.protocol);
            }
        }
        if (file->empty()) return answer;
        SEAM_TRY(auto station, Station::open(*file, FileAccess::read_only));
        SEAM_OK(station.connect());
        answer.json["sensors"] = json::array();
        answer.json["robots"] = json::array();
        for (const SensorSetup& s : station.project().sensors) {
            ProfileSource* sensor = station.sensor(s.id);
            const SensorIdentity id = sensor->identity();
            const SourceCounters c = sensor->counters();
            answer.json["sensors"].push_back({{"id", s.id},
                                              {"driver", s.driver},
                                              {"vendor", id.vendor},
                                              {"model", id.model},
                                              {"serial", id.serial},
                                              {"completed", c.completed},
                                              {"damaged", c.damaged},
                                              {"underrun", c.underrun},
                                              {"missing_packets", c.missing_packets},
                                              {"late", c.late},
                                              {"lost", c.lost},
                                              {"resent_packets", c.resent_packets},
                                              {"reconnects", c.reconnects}});
            answer.text += fmt::format("sensor {}: {} {} {} serial {}\n", s.id, s.driver, id.vendor, id.model,
                                       id.serial);
        }
        for (const RobotSetup& r : station.project().robots) {
            RobotLink* robot = station.robot(r.id);
            SEAM_TRY(auto id, robot->identity());
            SEAM_TRY(auto mode, robot->mode());
            answer.json["robots"].push_back({{"id", r.id},
                                             {"driver", r.driver},
                                             {"brand", id.brand},
                                             {"model", id.model},
                                             {"serial", id.serial},
                                             {"mode", to_string(mode)}});
            answer.text += fmt::format("robot {}: {} {} {} serial {}, mode {}\n", r.id, r.driver, id.brand,
                                       id.model, id.serial, to_string(mode));
        }
        return answer;
    });
}

}  // namespace seamwright::cli
