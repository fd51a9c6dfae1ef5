// seamwright teach: a spot with pose, feature, template and reference, from the sensor as it stands there or from profiles
// in files, as the desk's Teach page does.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/answers/result_json.h"
#include "app/cli/arguments/feature_setting.h"
#include "app/cli/arguments/no_return_option.h"
#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "core/profile/filter.h"
#include "core/profile/taught_profile.h"
#include "core/profile/units.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/measure/fields.h"
#include "projects/station/teach.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct TeachArguments {
    std::string file, spot, sensor, robot, pose, kind;
    std::vector<std::string> profiles, set, fields;
    std::vector<double> window, reference;
    int repeats = TeachOptions{}.repeats;
    bool take_pose = false, live = false;
    NoReturnOption invalid;
};

// The spot as the arguments want it, before it is measured; `fresh` says whether the project had it.
struct Draft {
    Spot spot;
    bool fresh = false;
};

Expected<std::string> device_of(const std::string& asked, const auto& setups, const char* option) {
    if (asked.empty() && !setups.empty()) return setups.front().id;  // as the desk's new spots
    for (const auto& s : setups)
        if (s.id == asked) return asked;
    return usage_error(asked.empty() ? Text("a spot needs a sensor and a robot")
                                     : Text("\"{}\" is not in the project", asked),
                       option, "see `seamwright info`");
}

std::pair<std::string, std::string> assignment(const std::string& text) {
    const std::size_t equals = text.find('=');
    return equals == std::string::npos ? std::pair{text, std::string()}
                                       : std::pair{text.substr(0, equals), text.substr(equals + 1)};
}

Expected<Draft> draft_of(const Project& project, const TeachArguments& a) {
    Draft draft;
    if (const Spot* known = find_spot(project, a.spot)) {
        draft.spot = *known;
        if (!a.sensor.empty()) {
            SEAM_TRY(draft.spot.sensor_id, device_of(a.sensor, project.sensors, "--sensor"));
        }
        if (!a.robot.empty()) {
            SEAM_TRY(draft.spot.robot_id, device_of(a.robot, project.robots, "--robot"));
        }
    } else {
        draft.fresh = true;
        draft.spot.id = a.spot;
        SEAM_TRY(draft.spot.sensor_id, device_of(a.sensor, project.sensors, "--sensor"));
        SEAM_TRY(draft.spot.robot_id, device_of(a.robot, project.robots, "--robot"));
    }
    Spot& s = draft.spot;
    if (!a.pose.empty()) {
        SEAM_TRY(s.base_from_flange, read_pose_argument(a.pose, "--pose"));
    }
    if (!a.kind.empty() && a.kind != s.feature.kind) {
        SEAM_OK(find_feature_kind(a.kind));
        s.feature.kind = a.kind;
        s.feature.parameters.clear();
    }
    SEAM_TRY(const auto kind, find_feature_kind(s.feature.kind));
    for (const std::string& one : a.set) {
        SEAM_TRY(auto setting, feature_setting(*kind, one));
        s.feature.parameters[setting.first] = setting.second;
    }
    for (const std::string& one : a.fields) {
        const auto [name, text] = assignment(one);
        const auto& fields = spot_fields();
        const auto field = std::find_if(fields.begin(), fields.end(),
                                        [&, n = name](const Field<Spot>& f) { return f.info.name == n; });
        if (field == fields.end()) {
            std::string known;
            for (const Field<Spot>& f : fields) known += (known.empty() ? "" : ", ") + f.info.name;
            return usage_error(Text("a spot has no field \"{}\"", name), "--field",
                               Text("known are: {}", known));
        }
        SEAM_TRY(const double value, setting_value(field->info, text));
        SEAM_OK(set_field(s, name, value));
    }
    if (s.feature.kind != "template" && !a.window.empty())
        return usage_error("only the kind \"template\" takes a piece of the contour", "--window");
    if (s.feature.kind == "template" && a.window.empty() && s.feature.template_profile.size() == 0)
        return usage_error("the template is missing", Text("spot {}", s.id),
                           "say with --window which piece of the contour it is");
    if (!a.window.empty() && !(a.window[0] < a.window[2] && a.window[1] < a.window[3]))
        return usage_error("the window is empty", "--window", "give X0,Z0,X1,Z1 with X0 < X1 and Z0 < Z1");
    return draft;
}

Eigen::AlignedBox2d window_of(const TeachArguments& a) {
    return {Eigen::Vector2d(a.window[0], a.window[1]), Eigen::Vector2d(a.window[2], a.window[3])};
}

// The template out of the picture, with its landmark.
Expected<void> take_piece(const TeachArguments& a, const Profile& picture, Spot& s) {
    if (!a.window.empty()) {
        SEAM_TRY(s, with_template(s, picture, window_of(a)));
    }
    if (s.feature.kind == "template" && a.reference.size() == 2)
        s.feature.template_reference_mm = {a.reference[0], a.reference[1]};
    return {};
}

// What the sensor sees at the spot, whatever feature it is meant for: the mean of a few pictures, so that the template
// is quieter than one.
Expected<Profile> picture_at(Station& station, const Spot& spot, const std::stop_token& cancel) {
    Spot any = spot;
    any.feature = {};  // a kind that needs nothing; what it finds does not count
    std::vector<Profile> seen;
    const Standing stand{spot.base_from_flange, 2 * kTaughtAnArrival};
    SEAM_OK(measure_standing(station, any, {&stand, 1}, cancel, {},
                             [&](std::size_t, const SpotMeasurer& measurer, const SpotMeasurement&) {
                                 if (measurer.profile().size() > 0) seen.push_back(measurer.profile());
                             }));
    if (seen.empty())
        return input_error("no profile was seen", Text("spot {}", spot.id),
                           "look at the live picture: light, stand-off, calibration");
    return mean_profile(seen);
}

Expected<TaughtSpot> teach_live(Station& station, const TeachArguments& a, Draft& draft) {
    SEAM_OK(station.connect());
    Spot& s = draft.spot;
    if (a.take_pose || (draft.fresh && a.pose.empty())) {
        RobotLink* robot = station.robot(s.robot_id);
        if (!robot)
            return device_error("the robot is not connected", Text("robot {}", s.robot_id), "connect it");
        SEAM_TRY(s.base_from_flange, robot->base_from_flange());
    }
    TeachOptions options;
    options.repeats = a.repeats;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    Profile picture;
    if (!a.window.empty()) {
        SEAM_TRY(picture, picture_at(station, s, options.cancel));
    }
    SEAM_OK(take_piece(a, picture, s));
    auto taught = teach_spot(station, s, options);
    station.disconnect();
    return taught;
}

// Profiles as files hold them, as if the sensor had delivered them at the spot's pose.
Expected<TaughtSpot> teach_from_files(const Project& project, TeachArguments& a, Draft& draft) {
    Spot& s = draft.spot;
    const SensorSetup* sensor = find_sensor(project, s.sensor_id);
    std::vector<Profile> profiles;
    for (const std::string& path : a.profiles) {
        SEAM_TRY(auto profile, read_profile_csv(path));
        a.invalid.apply(profile, path);
        SEAM_OK(check_profile_millimetres(profile, path));
        if (!profile.filtered()) SEAM_OK(filter_profile(profile, sensor ? sensor->filter : FilterOptions{}));
        profiles.push_back(std::move(profile));
    }
    SEAM_OK(take_piece(a, mean_profile(profiles), s));
    Project with = project;
    const auto known = std::find_if(with.spots.begin(), with.spots.end(),
                                    [&](const Spot& other) { return other.id == s.id; });
    known == with.spots.end() ? with.spots.push_back(s) : void(*known = s);
    SEAM_TRY(auto measurer, SpotMeasurer::make(with, s.id));
    std::vector<SpotMeasurement> measurements;
    std::vector<Profile> seen;
    for (const Profile& profile : profiles) {
        Frame frame;
        frame.status = FrameStatus::ok;
        frame.profile = profile;
        measurements.push_back(measurer.measure(frame));
        seen.push_back(measurer.profile());
    }
    return taught_from(s, std::move(measurements), seen, 1);
}

json told_json(const TaughtSpot& taught, bool fresh) {
    const Spot& s = taught.spot;
    return {{"status", "taught"},
            {"spot", s.id},
            {"new", fresh},
            {"sensor", s.sensor_id},
            {"robot", s.robot_id},
            {"base_from_flange", pose_json(s.base_from_flange)},
            {"kind", s.feature.kind},
            {"parameters", s.feature.parameters},
            {"template_points", s.feature.template_profile.size()},
            {"reference", vector_json(s.reference_mm)},
            {"spread_mm", vector_json(taught.spread_mm)},
            {"measurements", taught.measurements.size()},
            {"left_out", taught.left_out},
            {"arrivals", s.reference_arrivals},
            {"profile_points", s.reference_profile.size()}};
}

Expected<Answer> teach_command(TeachArguments& a) {
    if (!a.profiles.empty() && (a.live || a.take_pose))
        return usage_error("profiles from files and from the sensor", a.file, "give --profile, or --live");
    SEAM_TRY(auto station, open_station(a.file, Deed::teach));
    SEAM_TRY(auto draft, draft_of(station.project(), a));
    SEAM_OK(validate_fields(draft.spot));
    const bool from_files = !a.profiles.empty();
    SEAM_TRY(const auto taught,
             from_files ? teach_from_files(station.project(), a, draft) : teach_live(station, a, draft));
    Project project = station.project();
    if (draft.fresh) {
        project.spots.push_back(taught.spot);
    } else {
        for (Spot& s : project.spots) {
            if (s.id != taught.spot.id) continue;
            // What it was measured with first, then what was measured.
            const Spot prepared = with_reference_of(s, draft.spot);
            SEAM_TRY(s, with_taught(prepared, taught));
        }
    }
    SEAM_OK(station.edit(project));
    Answer answer;
    answer.json = told_json(taught, draft.fresh);
    answer.text = fmt::format(
        "spot {}{}: reference x {:.3f}  z {:.3f} mm, spread x {:.4f}  z {:.4f} mm over {} measurements, {} "
        "left "
        "out\n",
        taught.spot.id, draft.fresh ? " (new)" : "", taught.spot.reference_mm.x(),
        taught.spot.reference_mm.z(), taught.spread_mm.x(), taught.spread_mm.y(), taught.measurements.size(),
        taught.left_out);
    if (draft.fresh) answer.text += "it belongs to no region yet\n";
    a.invalid.warn(answer);
    return answer;
}

}  // namespace

void add_teach(CommandLine& line) {
    auto a = std::make_shared<TeachArguments>();
    CLI::App* command = line.add(
        "teach",
        "Teach a spot: its pose, its feature, its template and its reference, measured by the sensor at the "
        "spot "
        "(several\narrivals, as in a run) or taken from profiles in files. A spot that the project does not "
        "have is "
        "new, at the robot's\npresent pose unless --pose says another. Weights, limits and noise stay as "
        "they are; the "
        "curve of an earlier pass\nis gone, see `pass`.",
        "seamwright teach door_left.seam S9 --live --kind contour-end --set side=right\n"
        "  seamwright teach door_left.seam S9 --live --kind template --window=-15,-8,20,8 --reference 3.2,0\n"
        "  seamwright teach door_left.seam S9 --profile a.csv --profile b.csv --pose pose.json --kind "
        "corner\n"
        "  seamwright teach door_left.seam S1 --repeats 9 --field jitter_mm=2");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("spot", a->spot, "The spot's name")->required()->type_name("SPOT");
    add_sign_in(command);
    command->add_flag("--live", a->live, "By the project's devices (the default)");
    command->add_option("--profile", a->profiles, "By this profile, taken at the spot; may be repeated")
        ->type_name("FILE.csv");
    command->add_option("--sensor", a->sensor, "Which sensor looks at it (a new spot: the first one)")
        ->type_name("ID");
    command->add_option("--robot", a->robot, "Which robot carries it (a new spot: the first one)")
        ->type_name("ID");
    auto* pose =
        command->add_option("--pose", a->pose, "base_from_flange at the trigger")->type_name("POSE|FILE");
    command->add_flag("--take-pose", a->take_pose, "The pose where the robot stands")->excludes(pose);
    command->add_option("--kind", a->kind, "The feature: contour-end, corner, template, ... as in `feature`");
    command->add_option("--set", a->set, "A setting of the feature; may be repeated")
        ->type_name("NAME=VALUE");
    command
        ->add_option("--window", a->window,
                     "Kind template: the piece of contour inside becomes the template (sensor, mm)")
        ->delimiter(',')
        ->expected(4)
        ->type_name("X0,Z0,X1,Z1");
    command
        ->add_option("--reference", a->reference,
                     "Kind template: its landmark; need not lie on the contour (else the piece's middle)")
        ->delimiter(',')
        ->expected(2)
        ->type_name("X,Z");
    command->add_option("--repeats", a->repeats, "Arrivals from the entry, two measurements each")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--field", a->fields,
                     "A field of the spot: jitter_mm, entry_mm, sigma_mm, ...; may be repeated")
        ->type_name("NAME=VALUE");
    a->invalid.add_to(command);
    line.on(command, [a] { return teach_command(*a); });
}

}  // namespace seamwright::cli
