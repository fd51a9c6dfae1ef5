#include "app/cli/commands/calibrate/calibrate_live.h"
#include "app/cli/sign_in.h"

#include <fmt/format.h>

#include "app/cli/arguments/feature_setting.h"
#include "app/cli/signal_watch.h"
#include "projects/calibrate/live.h"
#include "projects/calibrate/session/answer.h"

namespace seamwright::cli {
namespace {

Expected<std::map<std::string, double>> settings_of(const CalibrationMethod& method,
                                                    const std::vector<std::string>& given) {
    std::map<std::string, double> values;
    for (const std::string& one : given) {
        const std::size_t equals = one.find('=');
        if (equals == std::string::npos) return usage_error(Text("\"{}\" is not NAME=VALUE", one), "--set");
        const std::string name = one.substr(0, equals);
        const auto known = std::find_if(method.settings.begin(), method.settings.end(),
                                        [&](const MethodSetting& s) { return s.info.name == name; });
        if (known == method.settings.end())
            return usage_error(Text("there is no setting \"{}\"", name), "--set");
        SEAM_TRY(auto value, setting_value(known->info, one.substr(equals + 1)));
        values[name] = value;
    }
    return values;
}

std::string verified_text(const Verification& v) {
    if (v.poses == 0 && !v.repeats.empty())
        return fmt::format(
            "not verified: {} stands where {} was taken, which is solved with; move the robot\n",
            v.repeats.front().first, v.repeats.front().second);
    if (v.poses == 0) return "";
    std::string parts;
    for (const auto& [worst, limit, unit] : {std::tuple{v.worst_mm, v.limit_mm, "mm"},
                                             {v.worst_deg, v.limit_deg, "deg"},
                                             {v.worst_px, v.limit_px, "px"}})
        if (std::isfinite(worst)) parts += fmt::format(", {:.3f} {} of {:.3f} allowed", worst, unit, limit);
    return fmt::format("{} by {} pose(s) kept back{}\n", v.confirmed ? "confirmed" : "not confirmed", v.poses,
                       parts);
}

}  // namespace

void add_live_options(CLI::App& command, const CalibrationMethod& method, LiveCalibrationArguments& a) {
    std::string names;
    for (const MethodSetting& s : method.settings) names += (names.empty() ? "" : ", ") + s.info.name;
    // Without it the others would be passed over without a word.
    CLI::Option* live =
        command
            .add_flag(
                "--live", a.live,
                "The data are a project: capture with its sensor, where its robot stands still; what was "
                "captured is kept beside the project and resumed")
            ->group("From devices");
    command.add_option("--robot", a.robot, "The project's robot that carries the sensor (its only one)")
        ->needs(live)
        ->group("From devices");
    if (!names.empty())
        command.add_option("--set", a.settings, "Setting of the target, NAME=VALUE, of " + names)
            ->type_name("NAME=VALUE")
            ->allow_extra_args(false)
            ->needs(live)
            ->group("From devices");
    command
        .add_option("--captures", a.captures,
                    fmt::format("How many to solve with ({}; at least {})", method.advised, method.fewest))
        ->check(CLI::Range(method.fewest, 1000))
        ->needs(live)
        ->group("From devices");
    if (method.keeps_back)
        command.add_option("--verification", a.verification, "How many more to verify the answer with (1)")
            ->check(CLI::Range(0, 100))
            ->needs(live)
            ->group("From devices");
    command.add_option("--patience-s", a.patience_s, "How long the robot's next stand is waited for (300)")
        ->check(CLI::Range(1.0, 86400.0))
        ->needs(live)
        ->group("From devices");
    command.add_flag("--anew", a.anew, "Begin over; what was captured before is put aside")
        ->needs(live)
        ->group("From devices");
    if (method.use == AnswerUse::sensor)
        command.add_flag("--use", a.use, "Put the calibration to use when it is verified")
            ->needs(live)
            ->group("From devices");
}

Expected<Answer> calibrate_on_devices(const CalibrationMethod& method, const std::string& file,
                                      const std::string& sensor, const LiveCalibrationArguments& a) {
    if (sensor.empty()) return usage_error("say which of the project's sensors", "--sensor");
    SEAM_TRY(auto settings, settings_of(method, a.settings));
    SEAM_TRY(auto station, open_station(file, Deed::teach));
    SEAM_OK(station.connect());
    LiveCalibrationOptions options;
    options.sensor_id = sensor;
    options.robot_id = a.robot;
    options.settings = std::move(settings);
    options.captures = a.captures;
    options.verification = a.verification;
    options.anew = a.anew;
    options.use = a.use;
    options.patience = std::chrono::milliseconds(static_cast<long>(1000 * a.patience_s));
    options.said = [](const Text& text) { fmt::print(stderr, "{}\n", text.english()); };
    options.cancel = stop_on_signal();
    SEAM_TRY(auto live, calibrate_live(station, method, options));
    Answer answer;
    answer.json = live.solution.document;
    answer.json["captures"] = live.captures;
    answer.json["verification"] = verification_json(live.verification);
    answer.json["stored_as"] = live.stored;
    answer.json["used"] = live.used;
    const bool serves_all =
        serves(live.solution.verdict()) && (!method.keeps_back || live.verification.confirmed);
    answer.exit_code = serves_all ? kExitOk : kExitVerdict;
    answer.text = verified_text(live.verification);
    for (const std::string& id : live.stored)
        answer.text += fmt::format("stored in {} as {}{}\n", file, id, live.used ? ", in use" : "");
    if (live.stored.empty() && method.use != AnswerUse::check)
        answer.text +=
            serves(live.solution.verdict())
                ? "not stored: the answer is not verified; take more captures with the same command\n"
                : "not stored: see reason and cure; more captures with the same command, or --anew\n";
    return answer;
}

}  // namespace seamwright::cli
