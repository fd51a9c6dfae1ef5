// seamwright line: the PLCs and brokers of a project, and the table that they are programmed by.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "devices/exchange/json_fields.h"
#include "devices/line/register_map.h"
#include "projects/file/project_file.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

json register_json(const LineRegister& r) {
    return {{"address", r.address}, {"words", r.words},         {"type", to_string(r.type)},
            {"name", r.name},       {"writable", r.writable()}, {"help", r.help}};
}

json codes_json(const std::vector<LineCode>& codes) {
    json list = json::array();
    for (const LineCode& c : codes)
        list.push_back({{"number", c.number}, {"name", c.name}, {"help", c.help}});
    return list;
}

Answer registers() {
    Answer answer;
    answer.text = line_document();
    answer.json = {{"status", "ok"},
                   {"protocol_version", kLineProtocolVersion},
                   {"word_order", "high word first"},
                   {"registers", json::array()},
                   {"region_registers",
                    {{"first", kRegionWords},
                     {"stride", kRegionStride},
                     {"most", kLineRegions},
                     {"registers", json::array()}}},
                   {"results", codes_json(line_results())},
                   {"alarms", codes_json(line_alarms())}};
    for (const LineRegister& r : line_registers()) answer.json["registers"].push_back(register_json(r));
    for (const LineRegister& r : line_region_registers())
        answer.json["region_registers"]["registers"].push_back(register_json(r));
    return answer;
}

Answer shown(const Project& project) {
    Answer answer;
    answer.json = {{"status", "ok"}, {"line", json::array()}};
    for (const LineSetup& l : project.line) {
        answer.json["line"].push_back({{"id", l.id},
                                       {"protocol", l.protocol},
                                       {"enabled", l.enabled},
                                       {"part_types", l.part_types},
                                       {"settings", l.settings}});
        answer.text += fmt::format("{:<10} {:<14} {:<4} {}\n", l.id, l.protocol, l.enabled ? "on" : "off",
                                   l.settings.dump());
    }
    if (project.line.empty()) answer.text = "the project names no line\n";
    return answer;
}

struct SetArguments {
    std::string file, id, protocol, settings;
    std::vector<int> types;
    bool on = false, off = false, remove = false;
};

Expected<void> change(Project& project, const SetArguments& a, bool types_given) {
    auto found =
        std::find_if(project.line.begin(), project.line.end(), [&](const auto& l) { return l.id == a.id; });
    if (a.remove) {
        if (found == project.line.end())
            return usage_error(Text("there is no link \"{}\" to a line", a.id), a.file);
        project.line.erase(found);
        return {};
    }
    if (found == project.line.end()) {
        if (a.protocol.empty())
            return usage_error("say the protocol of a new link", "--protocol",
                               "seamwright devices lists them");
        project.line.emplace_back();
        found = project.line.end() - 1;
        found->id = a.id;
    }
    if (!a.protocol.empty()) found->protocol = a.protocol;
    if (!a.settings.empty()) {
        SEAM_TRY(found->settings, parse_json(a.settings, "--settings"));
    }
    if (types_given) found->part_types = a.types;
    if (a.on || a.off) found->enabled = a.on;
    const LineProtocol* protocol = line_protocol(found->protocol);
    if (!protocol) return open_line(found->protocol, {}, "").map([](const auto&) {});
    return check_settings(found->settings, "--settings", protocol->settings());
}

Expected<Answer> set(const SetArguments& a, bool types_given) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    SEAM_OK(change(project, a, types_given));
    SEAM_OK(file.save(project));
    return shown(project);
}

void add_set(CommandLine& line, CLI::App& group) {
    auto a = std::make_shared<SetArguments>();
    CLI::App* command =
        line.add(group, "set", "Name a PLC or a broker in the project, or change it; run --watch serves it.",
                 "seamwright line set door.seam plc --protocol modbus-server --settings "
                 "'{\"port\": 1502, \"start\": \"line\"}'");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command->add_option("id", a->id, "Its name")->required();
    std::string known;
    for (const LineProtocol& p : line_protocols())
        known += (known.empty() ? "" : " | ") + std::string(p.name);
    command->add_option("--protocol", a->protocol, known);
    command
        ->add_option("--settings", a->settings,
                     "All of them as JSON; `seamwright devices --help modbus-server` shows what there is")
        ->type_name("JSON");
    auto* types = command->add_option("--part-types", a->types, "Only these are measured: 1,2; without: all")
                      ->delimiter(',')
                      ->check(CLI::Range(0, 65535));
    auto* on = command->add_flag("--on", a->on, "Serve it");
    auto* off = command->add_flag("--off", a->off, "Do not")->excludes(on);
    auto* remove = command->add_flag("--remove", a->remove, "Forget it");
    remove->excludes(on)->excludes(off);
    line.on(command, [a, types] { return set(*a, types->count() > 0); });
}

}  // namespace

void add_line(CommandLine& line) {
    CLI::App* group = line.group("line", "PLCs (Modbus TCP) and brokers (MQTT) beside the station.",
                                 "seamwright line registers\n  seamwright line show door.seam");
    CLI::App* table =
        line.add(*group, "registers",
                 "Registers, handshake, codes and topics, for who programs the other side (Markdown).",
                 "seamwright line registers --json -");
    line.on(table, []() -> Expected<Answer> { return registers(); });
    auto file = std::make_shared<std::string>();
    CLI::App* show = line.add(*group, "show", "What the project names.", "seamwright line show door.seam");
    show->add_option("file", *file, "The project")->required()->type_name("FILE.seam");
    line.on(show, [file]() -> Expected<Answer> {
        SEAM_TRY(auto opened, ProjectFile::open(*file, FileAccess::read_only));
        SEAM_TRY(auto project, opened.load());
        return shown(project);
    });
    add_set(line, *group);
}

}  // namespace seamwright::cli
