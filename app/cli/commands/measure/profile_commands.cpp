// seamwright filter, feature, match, align: what can be asked of profiles in CSV files.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "app/cli/answers/result_json.h"
#include "app/cli/arguments/feature_setting.h"
#include "app/cli/arguments/filter_options.h"
#include "app/cli/arguments/no_return_option.h"
#include "app/cli/command.h"
#include "app/cli/commands/measure/contour_spot.h"
#include "app/cli/commands/project/pass.h"
#include "app/cli/sign_in.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "core/profile/units.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/file/project_file.h"
#include "projects/station/teach.h"

namespace seamwright::cli {
namespace {

// --unit: what the numbers of the file are in. Empty: millimetres, unless they look otherwise.
double mm_of(const std::string& unit) {
    return mm_of_unit(unit).value_or(1);
}
void convert_to_mm(Profile& profile, const std::string& unit) {
    for (auto* column : {&profile.x_mm, &profile.z_mm})
        for (double& value : *column) value *= mm_of(unit);
}
Expected<void> check_unit(const Profile& profile, const std::string& file, const std::string& unit) {
    if (!unit.empty()) return {};
    auto ok = check_profile_millimetres(profile, file);
    if (!ok) ok.error().mend = Text("{}, or say what they are in with --unit", ok.error().mend);
    return ok;
}
void add_unit(CLI::App* command, std::string& unit) {
    command
        ->add_option("--unit", unit,
                     "What lengths in the profiles are in: mm (as the header says), m, um or in (inches)")
        ->check(CLI::IsMember(std::vector<std::string>(std::begin(kFileUnits), std::end(kFileUnits))));
}

// A pass by the middle one of its profiles: one that lost its stripe looks like anything.
Expected<void> check_unit(const std::vector<TravelProfile>& pass, const std::string& file,
                          const std::string& unit) {
    std::vector<std::pair<double, const Profile*>> suspected;  // by their span
    std::size_t judged = 0;
    for (const TravelProfile& p : pass) {
        const ProfileScale scale = profile_scale(p.profile);
        judged += std::isfinite(scale.span) ? 1 : 0;
        if (!scale.suspected.empty()) suspected.emplace_back(scale.span, &p.profile);
    }
    if (2 * suspected.size() <= judged) return {};
    std::sort(suspected.begin(), suspected.end());
    return check_unit(*suspected[suspected.size() / 2].second, file, unit);
}

Expected<Profile> read_in_unit(const std::string& file, const std::string& unit, NoReturnOption& invalid) {
    auto profile = read_profile_csv(file);
    if (!profile) return profile;
    invalid.apply(*profile, file);
    SEAM_OK(check_unit(*profile, file, unit));
    convert_to_mm(*profile, unit);
    return profile;
}

// A profile as it comes from a sensor is filtered first; one that carries its segments is taken at its word.
Expected<Profile> read_filtered(const std::string& file, const std::string& unit, NoReturnOption& invalid,
                                const FilterOptions& options) {
    auto profile = read_in_unit(file, unit, invalid);
    if (!profile) return profile;
    if (!profile->filtered()) SEAM_OK(filter_profile(*profile, options));
    return profile;
}

Expected<Answer> filter(const std::string& in, const std::string& out, const std::string& unit,
                        NoReturnOption& invalid, const FilterOptions& options) {
    SEAM_TRY(auto profile, read_in_unit(in, unit, invalid));
    SEAM_OK(filter_profile(profile, options));
    SEAM_OK(write_profile_csv(out, profile));
    int accepted = 0, outliers = 0, missing = 0;
    std::int32_t segments = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (std::isnan(profile.z_mm[i]))
            ++missing;
        else if (profile.segment[i] == kOutlier)
            ++outliers;
        else
            ++accepted;
        segments = std::max(segments, profile.segment[i] + 1);
    }
    Answer answer;
    answer.json = {{"status", "ok"},       {"points", profile.size()}, {"accepted", accepted},
                   {"outliers", outliers}, {"no_return", missing},     {"segments", segments}};
    answer.text = fmt::format("{} points: {} accepted in {} segments, {} outliers, {} without return\n",
                              profile.size(), accepted, segments, outliers, missing);
    invalid.warn(answer);
    return answer;
}

// Every parameter of every kind is a flag of its own: window_left_mm -> --window-left-mm.
std::string flag(const std::string& parameter) {
    std::string name = "--" + parameter;
    std::replace(name.begin(), name.end(), '_', '-');
    return name;
}

struct FeatureArguments {
    std::string file, kind = "contour-end", template_file, unit;
    std::vector<double> reference;
    std::map<std::string, std::string> values;
    FilterOptions filter;
    NoReturnOption invalid;
};

Expected<Answer> feature(FeatureArguments& a) {
    SEAM_TRY(auto kind, find_feature_kind(a.kind));
    FeatureRecipe recipe;
    recipe.kind = a.kind;
    for (const auto& [name, text] : a.values) {
        if (text.empty()) continue;
        SEAM_TRY(auto value, feature_setting(*kind, name, text));
        recipe.parameters[name] = value;
    }
    if (a.kind == "template") {
        if (a.template_file.empty())
            return usage_error("the kind \"template\" needs --template T.csv", "--template");
        SEAM_TRY(auto contour, read_filtered(a.template_file, a.unit, a.invalid, a.filter));
        recipe.template_profile = std::move(contour);
        if (a.reference.size() == 2) recipe.template_reference_mm = {a.reference[0], a.reference[1]};
    } else if (!a.template_file.empty()) {
        return usage_error("only the kind \"template\" takes a template", "--template");
    }
    SEAM_TRY(auto finder, make_feature_finder(recipe));
    SEAM_TRY(auto profile, read_filtered(a.file, a.unit, a.invalid, a.filter));
    const Feature found = finder->find(profile);
    Answer answer;
    answer.json = feature_json(found);
    answer.text = feature_text(found);
    a.invalid.warn(answer);
    answer.exit_code = found.status == FeatureStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

struct MatchArguments {
    std::string template_file, scene_file, unit;
    std::vector<double> window;  // mm, mm, deg
    std::vector<double> reference;
    FilterOptions filter;
    NoReturnOption invalid;
};

Expected<Answer> match(MatchArguments& a) {
    SEAM_TRY(auto contour, read_filtered(a.template_file, a.unit, a.invalid, a.filter));
    SEAM_TRY(auto scene, read_filtered(a.scene_file, a.unit, a.invalid, a.filter));
    const Eigen::Vector2d reference =
        a.reference.size() == 2 ? Eigen::Vector2d(a.reference[0], a.reference[1]) : middle_of(contour);
    SEAM_TRY(auto matcher, ContourMatcher::make(contour, reference));
    SearchWindow window;
    if (!a.window.empty()) {
        if (!(a.window[0] > 0 && a.window[1] > 0 && a.window[2] >= 0 && a.window[2] <= 180))
            return usage_error("the window must be positive (mm, mm) and 0 to 180 degrees", "--window");
        window.dx_mm = a.window[0];
        window.dz_mm = a.window[1];
        window.phi_rad = rad_from_deg(a.window[2]);
    }
    // Whoever gives a window in the scene's coordinates or about the landmark means the same contour.
    window.pivot = SearchPivot::reference_or_origin;
    const Registration found = matcher.match(scene, window);
    Answer answer;
    answer.json = registration_json(found);
    answer.text = registration_text(found);
    a.invalid.warn(answer);
    answer.exit_code = found.status == RegistrationStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

struct AlignArguments {
    std::string file, unit, project, spot, live_spot;
    bool live = false;
    std::optional<double> jitter_mm, tolerance_mm, window_mm;
    std::vector<double> reference;
    NoReturnOption invalid;
};

// As the desk judges: jitter, travel and reference point are the spot's, unless told.
Expected<AlignmentOptions> alignment_options(const AlignArguments& a) {
    AlignmentOptions options;
    if (a.project.empty() != a.spot.empty())
        return usage_error("a spot is one of a project: give both", "--project, --spot");
    if (!a.project.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.project, FileAccess::read_only));
        SEAM_TRY(auto project, file.load());
        const auto spot = std::find_if(project.spots.begin(), project.spots.end(),
                                       [&](const Spot& s) { return s.id == a.spot; });
        if (spot == project.spots.end())
            return input_error(Text("the project has no spot \"{}\"", a.spot), "--spot");
        options = alignment_options(*spot);
    }
    if (a.jitter_mm) options.jitter_mm = *a.jitter_mm;
    if (a.tolerance_mm) options.tolerance_mm = *a.tolerance_mm;
    if (a.window_mm) options.window_mm = *a.window_mm;
    if (a.reference.size() == 2) options.reference_mm = Eigen::Vector2d(a.reference[0], a.reference[1]);
    return options;
}

// On the devices of a project, whose spot stands behind its file.
Expected<Answer> align_live(const AlignArguments& a) {
    if (a.live_spot.empty()) return usage_error("no spot is named", "--live", "give FILE.seam SPOT --live");
    if (!a.project.empty() || !a.spot.empty())
        return usage_error("the spot stands behind its project", "--project, --spot",
                           "give FILE.seam SPOT --live");
    LivePass pass;
    pass.file = a.file;
    pass.spot = a.live_spot;
    pass.jitter_mm = a.jitter_mm;
    pass.tolerance_mm = a.tolerance_mm;
    pass.window_mm = a.window_mm;
    if (a.reference.size() == 2) pass.reference_mm = Eigen::Vector2d(a.reference[0], a.reference[1]);
    return pass_on_devices(pass, PassDeed::record);
}

Expected<Answer> align(AlignArguments& a) {
    if (a.live) return align_live(a);
    if (!a.live_spot.empty())
        return usage_error(Text("\"{}\" is one file too many", a.live_spot), "align",
                           "a spot is passed with --live; of a recorded pass it is --spot");
    const std::string &file = a.file, &unit = a.unit;
    SEAM_TRY(auto options, alignment_options(a));
    SEAM_TRY(auto pass, read_align_csv(file));
    for (TravelProfile& p : pass) a.invalid.apply(p.profile, file);
    SEAM_OK(check_unit(pass, file, unit));
    for (TravelProfile& p : pass) {
        convert_to_mm(p.profile, unit);
        p.travel_mm *= mm_of(unit);
    }
    for (TravelProfile& p : pass) SEAM_OK(filter_profile(p.profile, FilterOptions{}));
    SEAM_TRY(auto result, check_alignment(pass, options));
    Answer answer;
    answer.json = alignment_json(result);
    answer.text = alignment_text(result);
    a.invalid.warn(answer);
    answer.exit_code = result.status == AlignmentStatus::frozen ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_filter(CommandLine& line) {
    struct Arguments {
        std::string in, out, unit;
        FilterOptions options;
        NoReturnOption invalid;
    };
    auto a = std::make_shared<Arguments>();
    CLI::App* command =
        line.add("filter", "Mark outliers and segments of a profile.",
                 "seamwright filter profile.csv --out filtered.csv\n"
                 "  adds the columns valid (1/0) and segment (0.., -1 for outliers and missing returns)");
    command->add_option("in", a->in, "Profile: x_mm,z_mm[,intensity]")->required()->type_name("IN.csv");
    command->add_option("--out", a->out, "Where the marked profile goes")->required()->type_name("OUT.csv");
    add_unit(command, a->unit);
    a->invalid.add_to(command);
    add_filter_options(command, a->options);
    line.on(command, [a] { return filter(a->in, a->out, a->unit, a->invalid, a->options); });
}

void add_feature(CommandLine& line) {
    auto a = std::make_shared<FeatureArguments>();
    CLI::App* command = line.add(
        "feature", "Find the feature of a profile: point and covariance.",
        "seamwright feature profile.csv --kind contour-end --side right --json -\n"
        "  seamwright feature profile.csv --kind template --template taught.csv --reference 12.5,3.0");
    command->add_option("in", a->file, "Profile; filtered here unless it carries segments")
        ->required()
        ->type_name("IN.csv");
    std::string kinds;
    for (const FeatureKind& k : feature_kinds())
        kinds += fmt::format("{}{}", kinds.empty() ? "" : " | ", k.name);
    command->add_option("--kind", a->kind, kinds)->capture_default_str();
    command->add_option("--template", a->template_file, "Kind template: the taught piece of contour")
        ->type_name("T.csv");
    command->add_option("--reference", a->reference, "Kind template: its reference point x,z in mm")
        ->delimiter(',')
        ->expected(2);
    std::map<std::string, std::string> help;
    for (const FeatureKind& k : feature_kinds())
        for (const ParameterInfo& p : k.parameters) {
            std::string& text = help[p.name];
            if (text.empty()) text = p.help;
            text += fmt::format(" [{}]", k.name);
        }
    for (const auto& [name, text] : help) command->add_option(flag(name), a->values[name], text);
    add_unit(command, a->unit);
    a->invalid.add_to(command);
    add_filter_options(command, a->filter);
    line.on(command, [a] { return feature(*a); });
}

void add_match(CommandLine& line) {
    auto a = std::make_shared<MatchArguments>();
    CLI::App* command =
        line.add("match", "Find a taught piece of contour in a profile.",
                 "seamwright match --template taught.csv --scene profile.csv --window 10,10,15 --json -");
    command->add_option("--template", a->template_file, "The taught piece of contour")
        ->required()
        ->type_name("T.csv");
    command->add_option("--scene", a->scene_file, "The profile to search")->required()->type_name("S.csv");
    command
        ->add_option("--window", a->window,
                     "Search window dx,dz,dphi (+- mm, mm, deg) about the taught place")
        ->delimiter(',')
        ->expected(3);
    command
        ->add_option("--reference", a->reference,
                     "Landmark x,z of the window in mm (default: the template's middle)")
        ->delimiter(',')
        ->expected(2);
    add_unit(command, a->unit);
    a->invalid.add_to(command);
    add_filter_options(command, a->filter);
    line.on(command, [a] { return match(*a); });
}

void add_align(CommandLine& line) {
    auto a = std::make_shared<AlignArguments>();
    CLI::App* command = line.add("align", "Does the contour stand still while the robot passes the spot?",
                                 "seamwright align pass.csv --jitter-mm 5 --json -\n"
                                 "  seamwright align pass.csv --project cell.seam --spot S1\n"
                                 "  seamwright align cell.seam S1 --live\n"
                                 "  pass.csv: travel_mm,profile_index,x_mm,z_mm");
    command->add_option("in", a->file, "The recorded pass; with --live the project")
        ->required()
        ->type_name("SEQ.csv|FILE.seam");
    command->add_option("live-spot", a->live_spot, "With --live: the spot that is passed")->type_name("SPOT");
    command->add_flag("--live", a->live,
                      "On the project's devices: the robot passes the spot, nothing is kept (see `pass`)");
    add_sign_in(command);
    command->add_option("--project", a->project, "Project whose spot says jitter, travel and reference point")
        ->type_name("P.seam");
    command->add_option("--spot", a->spot, "Spot of the project that was passed")->type_name("ID");
    command
        ->add_option("--reference", a->reference,
                     "Point x,z in mm whose drift counts (default: the spot's, or the middle of the profile)")
        ->delimiter(',')
        ->expected(2);
    command->add_option("--jitter-mm", a->jitter_mm,
                        "Half width of the trigger jitter (default: the spot's, or 5)");
    command->add_option("--tolerance-mm", a->tolerance_mm, "Error that the jitter may cause (default: 0.05)");
    command->add_option("--window-mm", a->window_mm,
                        "Travel that is judged, +- mm (default: the spot's entry and exit, or 20)");
    add_unit(command, a->unit);
    a->invalid.add_to(command);
    line.on(command, [a] { return align(*a); });
}

}  // namespace seamwright::cli
