// seamwright double-head: two sensors that look at one place from two sides, merged into one profile; and the gap and
// flush in it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/cli/answers/result_json.h"
#include "app/cli/arguments/no_return_option.h"
#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "core/features/gap/gap_flush.h"
#include "core/panel/double_head.h"
#include "core/profile/filter.h"
#include "core/profile/units.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_measure.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct DoubleHeadArguments {
    std::string first, second, first_pose, second_pose, project, job, place, out, side;
    double first_sigma_mm = Head{}.sigma_mm, second_sigma_mm = Head{}.sigma_mm;
    DoubleHeadOptions options;
    std::optional<double> limit_mm;
    bool gap = false;
    FilterOptions filter;
    NoReturnOption invalid;
};

// Where the two heads stand, and how the gap is measured.
struct Heads {
    Head first, second;
    GapFlushSettings gauge;
};

// As a panel job's run has them: the frame midway between both, from the calibrations in use.
Expected<Heads> heads_of_place(DoubleHeadArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.project, FileAccess::read_only));
    SEAM_TRY(const auto project, file.load());
    const PanelJob* job = nullptr;
    for (const PanelJob& j : project.panel_jobs)
        if (j.id == a.job || (a.job.empty() && project.panel_jobs.size() == 1)) job = &j;
    if (!job)
        return input_error(a.job.empty() ? Text("the project has {} panel jobs", project.panel_jobs.size())
                                         : Text("there is no panel job \"{}\"", a.job),
                           a.project, "name one with --job");
    const auto place = std::find_if(job->places.begin(), job->places.end(),
                                    [&](const PanelPlace& p) { return p.id == a.place; });
    if (place == job->places.end())
        return input_error(Text("the panel job {} has no place \"{}\"", job->id, a.place), a.project);
    if (place->second_sensor_id.empty())
        return input_error(Text("place {} has one sensor and no double head", place->id), a.project,
                           "choose a place with two");
    const auto gripper_from = gripper_from_place(project, *place);
    if (!gripper_from)
        return input_error(Text("a sensor of place {} has no calibration", place->id), a.project,
                           "calibrate it first");
    Heads heads;
    heads.gauge = place->gauge;
    const auto head = [&](const std::string& id) {
        const SensorSetup* sensor = find_sensor(project, id);
        Head h;
        h.sensor_from_head = gripper_from->inverse() * calibration_of(project, id)->flange_from_sensor;
        if (sensor && sensor->filter.noise_mm > 0) h.sigma_mm = sensor->filter.noise_mm;
        return h;
    };
    heads.first = head(place->sensor_id);
    heads.second = head(place->second_sensor_id);
    a.options.disagreement_limit_mm = job->head_limit_mm;
    return heads;
}

Expected<Heads> heads_of(DoubleHeadArguments& a) {
    if (!a.project.empty()) {
        if (!a.first_pose.empty() || !a.second_pose.empty())
            return usage_error("the project says where the heads stand", "--project",
                               "give --project with --place, or poses");
        return heads_of_place(a);
    }
    if (a.second_pose.empty())
        return usage_error("where the second head stands is missing", "--second-pose",
                           "give sensor_from_head as a pose, or --project with --place");
    Heads heads;
    SEAM_TRY(heads.first.sensor_from_head, read_pose_argument(a.first_pose, "--first-pose"));
    SEAM_TRY(heads.second.sensor_from_head, read_pose_argument(a.second_pose, "--second-pose"));
    heads.first.sigma_mm = a.first_sigma_mm;
    heads.second.sigma_mm = a.second_sigma_mm;
    return heads;
}

Expected<Profile> read_head(const std::string& path, DoubleHeadArguments& a) {
    SEAM_TRY(auto profile, read_profile_csv(path));
    a.invalid.apply(profile, path);
    SEAM_OK(check_profile_millimetres(profile, path));
    if (!profile.filtered()) SEAM_OK(filter_profile(profile, a.filter));
    return profile;
}

void tell_gap(const GapFlush& g, Answer& answer) {
    answer.json["gap"] = {{"status", to_string(g.status)}, {"message", g.message}};
    if (g.status != GapFlushStatus::ok) {
        answer.text += fmt::format("gap: {}: {}\n", to_string(g.status), g.message);
        answer.exit_code = kExitVerdict;
        return;
    }
    answer.json["gap"].update({{"gap_mm", g.gap_mm},
                               {"flush_mm", g.flush_mm},
                               {"covariance", matrix_json(g.covariance)},
                               {"reference", vector_json(g.reference_point_mm)},
                               {"other", vector_json(g.other_point_mm)}});
    answer.text += fmt::format("gap {:.3f} +- {:.3f} mm, flush {:+.3f} +- {:.3f} mm\n", g.gap_mm,
                               std::sqrt(g.covariance(0, 0)), g.flush_mm, std::sqrt(g.covariance(1, 1)));
}

Expected<Answer> double_head(DoubleHeadArguments& a) {
    SEAM_TRY(auto heads, heads_of(a));
    if (a.limit_mm) a.options.disagreement_limit_mm = *a.limit_mm;
    SEAM_TRY(const auto first, read_head(a.first, a));
    SEAM_TRY(const auto second, read_head(a.second, a));
    SEAM_TRY(const auto merged, merge_heads(first, heads.first, second, heads.second, a.options));
    const auto points = std::ranges::count_if(merged.profile.z_mm, [](double z) { return std::isfinite(z); });
    Answer answer;
    answer.json = {{"status", to_string(merged.status)},
                   {"message", merged.message},
                   {"points", points},
                   {"overlap_mm", merged.overlap_mm},
                   {"shared_cells", merged.shared_cells},
                   {"disagreement_mm", merged.disagreement_mm},
                   {"offset_mm", merged.offset_mm},
                   {"offset_sigma_mm", merged.offset_sigma_mm},
                   {"limit_mm", a.options.disagreement_limit_mm}};
    answer.text =
        fmt::format("{}{}{}\n", to_string(merged.status), merged.message.empty() ? "" : ": ", merged.message);
    const bool ok = merged.status == DoubleHeadStatus::ok;
    if (ok || merged.status == DoubleHeadStatus::disagree)
        answer.text += fmt::format(
            "{} points, {:.2f} mm seen by both; the second stands {:+.4f} +- {:.4f} mm off the first, "
            "disagreement {:.4f} of {:g} mm\n",
            points, merged.overlap_mm, merged.offset_mm, merged.offset_sigma_mm, merged.disagreement_mm,
            a.options.disagreement_limit_mm);
    answer.exit_code = ok ? kExitOk : kExitVerdict;
    if (ok && !a.out.empty()) SEAM_OK(write_profile_csv(a.out, merged.profile));
    if (a.gap && ok) {
        if (!a.side.empty())
            heads.gauge.reference =
                a.side == "right" ? GapFlushSettings::Reference::right : GapFlushSettings::Reference::left;
        SEAM_OK(check(heads.gauge));
        tell_gap(GapFlushGauge(heads.gauge).measure(merged.profile), answer);
    }
    a.invalid.warn(answer);
    return answer;
}

}  // namespace

void add_double_head(CommandLine& line) {
    auto a = std::make_shared<DoubleHeadArguments>();
    CLI::App* command =
        line.add("double-head",
                 "Two sensors that look at one place from two sides, as one profile: where both see the same "
                 "surface their "
                 "points\nare averaged, and how far they disagree says whether their relation still holds "
                 "(exit code 1 beyond "
                 "the limit). With\n--gap the gap and flush in it. The heads stand where a panel job's place "
                 "has them, or where "
                 "poses say.",
                 "seamwright double-head a.csv b.csv --second-pose '{\"xyz\":[40,0,5],\"abc\":[0,30,0]}' "
                 "--out merged.csv\n"
                 "  seamwright double-head a.csv b.csv --project fender.seam --place P3 --gap --json -");
    command->add_option("first", a->first, "Profile of the first head, in its own frame")
        ->required()
        ->type_name("A.csv");
    command->add_option("second", a->second, "Of the second")->required()->type_name("B.csv");
    command
        ->add_option("--first-pose", a->first_pose,
                     "sensor_from_head: in the merged profile's frame (identity)")
        ->type_name("POSE|FILE");
    command->add_option("--second-pose", a->second_pose, "The same of the second head")
        ->type_name("POSE|FILE");
    auto* project =
        command->add_option("--project", a->project, "A project whose panel job has the double head")
            ->type_name("FILE.seam");
    command->add_option("--job", a->job, "Which panel job (the only one)")->needs(project)->type_name("ID");
    auto* place =
        command->add_option("--place", a->place, "Which place of it")->needs(project)->type_name("ID");
    project->needs(place);
    command->add_option("--out", a->out, "Where the merged profile goes")->type_name("OUT.csv");
    command->add_option("--first-sigma-mm", a->first_sigma_mm, "Of a point of the first head")
        ->capture_default_str();
    command->add_option("--second-sigma-mm", a->second_sigma_mm, "Of a point of the second head")
        ->capture_default_str();
    command->add_option("--limit-mm", a->limit_mm,
                        "Largest disagreement (default: the job's, or 0.15); below 1 mm");
    command
        ->add_option("--overlap-mm", a->options.minimum_overlap_mm,
                     "Less seen by both proves nothing about them")
        ->capture_default_str();
    auto* gap = command->add_flag("--gap", a->gap, "Gap and flush in the merged profile");
    command
        ->add_option("--reference", a->side,
                     "The side that they refer to: left or right (the place's, or left)")
        ->check(CLI::IsMember({"left", "right"}))
        ->needs(gap);
    a->invalid.add_to(command);
    line.on(command, [a] { return double_head(*a); });
}

}  // namespace seamwright::cli
