// seamwright stripe: how a sensor's frames become profiles, peaks and stripe model, shown and set.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/arguments/feature_setting.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "projects/file/project_file.h"
#include "projects/measure/fields.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct StripeArguments {
    std::string file, sensor;
    std::vector<std::string> set;
    bool defaults = false;
};

const Field<SensorSetup>* field_named(std::string_view name) {
    const auto& fields = sensor_fields();
    const auto at =
        std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.info.name == name; });
    return at == fields.end() ? nullptr : &*at;
}

// All of them or none: what two say together is judged at the end.
Expected<void> set(SensorSetup& sensor, const StripeArguments& a) {
    if (a.defaults) {
        sensor.peaks = {};
        sensor.filter = {};
    }
    for (const std::string& one : a.set) {
        const std::size_t equals = one.find('=');
        if (equals == std::string::npos || equals == 0)
            return usage_error(Text("\"{}\" sets nothing", one), "--set",
                               "write NAME=VALUE: peak_method=gaussian");
        const std::string name = one.substr(0, equals);
        const Field<SensorSetup>* field = field_named(name);
        if (!field) {
            std::string known;
            for (const auto& f : sensor_fields()) known += (known.empty() ? "" : ", ") + f.info.name;
            return usage_error(Text("a sensor has no field \"{}\"", name), "--set",
                               Text("known are: {}", known));
        }
        SEAM_TRY(const double value, setting_value(field->info, one.substr(equals + 1)));
        SEAM_OK(set_field(sensor, name, value));
    }
    return validate_fields(sensor);
}

json value_json(const Field<SensorSetup>& f, const SensorSetup& sensor) {
    const double value = f.get(sensor);
    if (f.info.choices.empty()) return value;
    return f.info.choices[static_cast<std::size_t>(value)];
}

Expected<Answer> stripe_command(const StripeArguments& a) {
    const bool edits = a.defaults || !a.set.empty();
    SEAM_TRY(auto file, edits ? open_to_edit(a.file) : ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    const auto sensor = std::find_if(project.sensors.begin(), project.sensors.end(),
                                     [&](const SensorSetup& s) { return s.id == a.sensor; });
    if (sensor == project.sensors.end())
        return input_error(Text("the project has no sensor \"{}\"", a.sensor), a.file,
                           "see `seamwright info`");
    const SensorSetup before = *sensor;
    if (edits) {
        SEAM_OK(set(*sensor, a));
        SEAM_OK(file.save(project));
    }
    Answer answer;
    answer.json = {{"status", edits ? "set" : "ok"},
                   {"sensor", a.sensor},
                   {"settings", json::object()},
                   {"changed", json::array()}};
    for (const auto& f : sensor_fields()) {
        const json value = value_json(f, *sensor);
        const bool changed = value != value_json(f, before);
        answer.json["settings"][f.info.name] = value;
        if (changed) answer.json["changed"].push_back(f.info.name);
        const std::string shown =
            value.is_string() ? value.get<std::string>()
                              : fmt::format("{:.{}f} {}", value.get<double>(), f.info.decimals, f.info.unit);
        answer.text +=
            fmt::format("{:<20} {:<20} {}{}\n", f.info.name, shown, f.info.help, changed ? "  *" : "");
    }
    if (!answer.json["changed"].empty())
        answer.text += "what was proven with the settings before is stale: see `seamwright check`\n";
    return answer;
}

}  // namespace

void add_stripe(CommandLine& line) {
    auto a = std::make_shared<StripeArguments>();
    CLI::App* command =
        line.add("stripe",
                 "How a sensor's frames become profiles: the peaks in the image and the stripe model that "
                 "filters, as the "
                 "fields of\nthe desk's Cell page. Without --set they are shown.",
                 "seamwright stripe door_left.seam A\n"
                 "  seamwright stripe door_left.seam A --set peak_method=gaussian --set per_line=4\n"
                 "  seamwright stripe door_left.seam A --set as_delivered=yes\n"
                 "  seamwright stripe door_left.seam A --defaults");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("sensor", a->sensor, "The sensor")->required()->type_name("SENSOR");
    add_sign_in(command);
    command->add_option("--set", a->set, "A setting; may be repeated, all are taken or none")
        ->type_name("NAME=VALUE");
    command->add_flag("--defaults", a->defaults, "All of them as a new sensor has them, before --set");
    line.on(command, [a] { return stripe_command(*a); });
}

}  // namespace seamwright::cli
