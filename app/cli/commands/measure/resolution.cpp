// seamwright resolution: whether the sensor resolves what a recipe needs, before anything is taught with it.

#include "core/features/resolution/resolution.h"

#include <fmt/format.h>

#include "app/cli/arguments/feature_setting.h"
#include "app/cli/command.h"
#include "core/profile/filter.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ResolutionArguments {
    std::string file, spot, kind = "contour-end", profile, template_file;
    std::vector<double> reference;
    std::vector<std::string> set;
    std::optional<double> sigma_mm;
};

constexpr double kOrdinarySigma_mm = 0.05;

struct Question {
    Profile profile;
    FeatureRecipe recipe;
    double sigma_mm = kOrdinarySigma_mm;
    std::optional<SensorNumbers> there;  // by the calibration, where the spot's reference stands
};

Expected<Profile> filtered_csv(const std::string& file) {
    SEAM_TRY(auto profile, read_profile_csv(file));
    if (profile.segment.empty()) SEAM_OK(filter_profile(profile, {}));
    return profile;
}

// The spot's recipe in its reference profile, measured or cut from the drawing, or in another one.
Expected<Question> of_spot(const ResolutionArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const auto project, file.load());
    const Spot* spot = find_spot(project, a.spot);
    if (!spot) return input_error(Text("there is no spot \"{}\"", a.spot), a.file, "see `seamwright info`");
    Question q;
    q.recipe = spot->feature;
    q.sigma_mm = spot->sigma_mm;
    q.profile = spot->reference_profile;
    if (!a.profile.empty()) {
        SEAM_TRY(q.profile, filtered_csv(a.profile));
    }
    if (q.profile.x_mm.empty())
        return input_error(Text("spot {} has no profile yet", a.spot), a.file,
                           "give one with --profile, or propose the spot from the drawing");
    if (q.profile.segment.empty()) SEAM_OK(filter_profile(q.profile, {}));
    if (const Calibration* c = calibration_of(project, *spot); c && c->model)
        q.there = sensor_numbers(*c->model, {spot->reference_mm.x(), spot->reference_mm.z()});
    return q;
}

Expected<Question> of_profile(const ResolutionArguments& a) {
    Question q;
    SEAM_TRY(q.profile, filtered_csv(a.file));
    SEAM_TRY(const auto kind, find_feature_kind(a.kind));
    q.recipe.kind = a.kind;
    for (const std::string& one : a.set) {
        SEAM_TRY(const auto setting, feature_setting(*kind, one));
        q.recipe.parameters[setting.first] = setting.second;
    }
    if (!a.template_file.empty()) {
        SEAM_TRY(q.recipe.template_profile, filtered_csv(a.template_file));
        if (a.reference.size() == 2) q.recipe.template_reference_mm = {a.reference[0], a.reference[1]};
    }
    return q;
}

json numbers_json(const SensorNumbers& n) {
    return {{"pitch_mm", n.pitch_mm},
            {"depth_step_mm", n.depth_step_mm},
            {"noise_mm", n.noise_mm},
            {"missing_share", n.missing_share}};
}

Expected<Answer> resolution(const ResolutionArguments& a) {
    SEAM_TRY(auto q, a.spot.empty() ? of_profile(a) : of_spot(a));
    if (a.sigma_mm) q.sigma_mm = *a.sigma_mm;
    SEAM_TRY(const auto check, check_resolution(q.profile, q.recipe, q.sigma_mm));
    Answer answer;
    json items = json::array();
    answer.text = fmt::format("{}: {}\n", name_of(check.verdict), check.reason.english());
    if (!check.cure.empty()) answer.text += "cure: " + check.cure.english() + "\n";
    for (const ResolutionItem& item : check.items) {
        items.push_back({{"name", item.name},
                         {"has", item.has},
                         {"needs", item.needs},
                         {"at_least", item.at_least},
                         {"unit", item.unit},
                         {"ok", item.ok()}});
        answer.text += fmt::format("  {:<12} has {:9.4f}   needs {} {:9.4f} {:<3} {}\n", item.name, item.has,
                                   item.at_least ? "at least" : "at most ", item.needs, item.unit,
                                   item.ok() ? "" : "not enough");
    }
    answer.json = {{"status", name_of(check.verdict)},
                   {"reason", check.reason.english()},
                   {"cure", check.cure.english()},
                   {"kind", q.recipe.kind},
                   {"sigma_mm", check.sigma_mm},
                   {"sigma_needed_mm", q.sigma_mm},
                   {"sensor", numbers_json(check.sensor)},
                   {"by_calibration", q.there ? numbers_json(*q.there) : json()},
                   {"items", items}};
    if (q.there)
        answer.text += fmt::format(
            "by its calibration, where the reference stands: pitch {:.4f} mm, noise {:.4f} mm of a "
            "tenth of a pixel\n",
            q.there->pitch_mm, q.there->noise_mm);
    const bool good =
        check.verdict == ResolutionVerdict::resolves || check.verdict == ResolutionVerdict::marginal;
    answer.exit_code = good ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_resolution(CommandLine& line) {
    auto a = std::make_shared<ResolutionArguments>();
    CLI::App* command =
        line.add("resolution",
                 "Whether the sensor resolves what a recipe needs at this stand-off, before anything is "
                 "taught: pitch of its "
                 "points, step of\nits depth, noise and missing points against what the feature and the "
                 "sigma asked of its "
                 "reference point need. Of a profile,\nor of a project's spot: its reference profile, "
                 "measured or cut from the "
                 "drawing.",
                 "seamwright resolution profile.csv --kind contour-end --set side=right --sigma-mm 0.05\n"
                 "  seamwright resolution door_left.seam --spot S1 --json -\n"
                 "  seamwright resolution door_left.seam --spot S1 --profile today.csv");
    command->add_option("file", a->file, "A profile, or a project")
        ->required()
        ->type_name("IN.csv|FILE.seam");
    command->add_option("--spot", a->spot, "The project's spot whose recipe it is");
    command->add_option("--profile", a->profile, "With --spot: another profile than its reference")
        ->type_name("IN.csv");
    command->add_option("--kind", a->kind, "Of a profile: the kind of feature")->capture_default_str();
    command->add_option("--set", a->set, "Its settings; may be repeated")->type_name("NAME=VALUE");
    command->add_option("--template", a->template_file, "Kind template: the taught piece of contour")
        ->type_name("T.csv");
    command->add_option("--reference", a->reference, "Kind template: its reference point x,z in mm")
        ->delimiter(',')
        ->expected(2);
    command->add_option("--sigma-mm", a->sigma_mm,
                        "What the reference point may err by (default: the spot's, else 0.05)");
    line.on(command, [a] { return resolution(*a); });
}

}  // namespace seamwright::cli
