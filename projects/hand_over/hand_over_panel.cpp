#include <algorithm>
#include <optional>

#include "projects/file/project_json.h"
#include "projects/hand_over/hand_over_detail.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_measure.h"

namespace seamwright {
namespace {

using report::Rows;
using report::Tone;

struct LastPanel {
    RunRecord run;
    Project setup;
};

// The newest run of each job that measured its panel, in the order of the project's jobs.
Expected<std::vector<std::optional<LastPanel>>> last_panels(const ProjectFile& file,
                                                            const std::vector<PanelJob>& jobs) {
    std::vector<std::optional<LastPanel>> last(jobs.size());
    SEAM_TRY(auto runs, file.runs());
    std::size_t missing = jobs.size();
    for (auto summary = runs.rbegin(); summary != runs.rend() && missing > 0; ++summary) {
        if (summary->spots > 0) continue;  // no panel's
        SEAM_TRY(auto run, file.load_run(summary->number, false));
        if (!run.panel || run.panel->before.empty()) continue;
        for (std::size_t k = 0; k < jobs.size(); ++k) {
            if (last[k] || jobs[k].id != run.panel->job_id) continue;
            SEAM_TRY(auto setup, file.load_run_setup(summary->number));
            last[k] = LastPanel{run, std::move(setup)};
            --missing;
        }
    }
    return last;
}

// What a panel's measurement rests on is as it was.
bool holds(const PanelJob& job, const Project& now, const PanelJob& then_job, const Project& then) {
    if (to_json_document(job, {false}) != to_json_document(then_job, {false})) return false;
    for (const PanelPlace& place : job.places)
        for (const std::string& id : {place.sensor_id, place.second_sensor_id}) {
            const Calibration *a = calibration_of(now, id), *b = calibration_of(then, id);
            if (!a != !b || (a && (a->id != b->id || a->created_utc != b->created_utc))) return false;
        }
    return true;
}

void taught_table(HandOverWriter& w, const PanelJob& job) {
    w.page.table(
        {{w.t("Robot"), w.t("Frame on the controller"), w.t("Translation mm"), w.t("Rotation °"),
          w.t("1 sigma mm"), w.t("1 sigma °"), w.t("Gap ± mm"), w.t("Flush ± mm"), w.t("Double head mm")},
         {job.robot_id, job.frame_name, fmt::format("{}", job.limits.translation_mm),
          fmt::format("{}", job.limits.rotation_deg), w.number(job.sigma_limit_mm, 3),
          w.number(job.sigma_limit_deg, 4), w.number(job.gap_tolerance_mm, 3),
          w.number(job.flush_tolerance_mm, 3), w.number(job.head_limit_mm, 3)}},
        w.t("Limits of the motion, tolerances of gap and flush against taught"));
    Rows rows{{w.t("Place"), w.t("Sensor"), w.t("Required"), w.t("Gap mm"), w.t("Flush mm"),
               w.t("Surface of the body °"), w.t("1 sigma mm")}};
    for (const PanelPlace& p : job.places) {
        const bool taught = p.reference_profile.size() > 0;
        rows.push_back({p.enabled ? p.id : w.t("{} (off)", p.id),
                        p.second_sensor_id.empty() ? p.sensor_id : p.sensor_id + " + " + p.second_sensor_id,
                        p.required ? w.t("yes") : w.t("no"), taught ? w.number(p.gap_mm, 3) : "-",
                        taught ? w.number(p.flush_mm, 3) : "-", taught ? w.number(p.surface_deg, 2) : "-",
                        w.number(p.sigma_mm, 3)});
    }
    w.page.table(rows, w.t("Taught in the panel's zero position"));
}

void last_panel_table(HandOverWriter& w, const LastPanel& last, const PanelJob& job) {
    const PanelRecord& panel = *last.run.panel;
    Rows rows{{w.t("Place"), w.t("Gap before mm"), w.t("Flush before mm"), w.t("Best fit leaves gap mm"),
               w.t("Best fit leaves flush mm"), w.t("Gap after mm"), w.t("Flush after mm"),
               w.t("Gap off taught mm"), w.t("Flush off taught mm"), w.t("State")}};
    for (const PanelPlace& place : job.places) {
        const auto of = [&](const std::vector<PanelMeasurement>& all) -> const PanelMeasurement* {
            const auto it = std::find_if(all.begin(), all.end(),
                                         [&](const PanelMeasurement& m) { return m.place_id == place.id; });
            return it != all.end() && it->status == SpotStatus::measured ? &*it : nullptr;
        };
        const PanelMeasurement *before = of(panel.before), *after = of(panel.after);
        const PanelSpotResult* fit = nullptr;
        if (panel.fit)
            for (const PanelSpotResult& s : panel.fit->spots)
                if (s.id == place.id) fit = &s;
        if (!before && !after && !place.enabled) continue;
        const auto if_any = [&](const auto* from, double value) { return from ? w.number(value, 3) : "-"; };
        std::string state = w.t("not measured");
        if (after)
            state = beyond_tolerance(job, {after, 1}).empty() ? w.t("in tolerance") : w.t("out of tolerance");
        else if (before && panel.after.empty())
            state = w.t("not moved");
        rows.push_back({place.id, if_any(before, before ? before->gap_mm : 0),
                        if_any(before, before ? before->flush_mm : 0),
                        if_any(fit, fit ? fit->remaining.gap_mm : 0),
                        if_any(fit, fit ? fit->remaining.flush_mm : 0),
                        if_any(after, after ? after->gap_mm : 0), if_any(after, after ? after->flush_mm : 0),
                        if_any(after, after ? after->gap_mm - place.gap_mm : 0),
                        if_any(after, after ? after->flush_mm - place.flush_mm : 0), state});
    }
    w.page.table(rows, w.t("Gap and flush of the last panel, before and after its motion"));
}

void one_job(HandOverWriter& w, const PanelJob& job, const std::optional<LastPanel>& last) {
    w.page.heading(w.t("Panel job {}", job.id), 3);
    taught_table(w, job);
    if (!last) {
        w.page.verdict(w.t("not proven"), Tone::attention, w.t("no panel was measured"));
        return;
    }
    const RunRecord& run = last->run;
    const PanelRecord& panel = *run.panel;
    // Judged by what was taught then.
    const PanelJob* then = find_panel_job(last->setup, job.id);
    if (!then || !holds(job, w.project, *then, last->setup))
        w.page.verdict(w.t("stale"), Tone::attention,
                       w.t("the project was changed since {}", w.time_of(run.started_utc)));
    switch (panel.verdict) {
        case PanelVerdict::in_tolerance:
            w.page.verdict(w.t("in tolerance"), Tone::good, run.message.in(w.options.language));
            break;
        case PanelVerdict::out_of_tolerance:
            w.page.verdict(w.t("out of tolerance"), Tone::alarm, run.message.in(w.options.language));
            break;
        case PanelVerdict::not_verified:
            w.page.verdict(w.t("not proven"), Tone::attention, run.message.in(w.options.language));
            break;
    }
    w.page.paragraph(
        run.push
            ? w.t("Run {} of panel {} on {}, moved.", run.number, run.part_id, w.time_of(run.started_utc))
            : w.t("Run {} of panel {} on {}, dry run.", run.number, run.part_id, w.time_of(run.started_utc)));
    if (panel.fit) {
        const Pose& g = panel.fit->gripper_motion;
        w.page.paragraph(w.t(
            "Motion of the gripper: {} mm, {}°. Residual of the best fit {} mm rms, 1 sigma "
            "at the places {} mm.",
            w.number(g.translation().norm(), 3), w.number(deg_from_rad(angle_rad(g, Pose::Identity())), 4),
            w.number(panel.fit->rms_mm, 3), w.number(panel.fit->sigma_at_spots_mm, 3)));
    }
    last_panel_table(w, *last, then ? *then : job);
    for (const Text& reason : panel.refusals) w.page.paragraph(reason.in(w.options.language));
}

}  // namespace

Expected<void> panels_chapter(HandOverWriter& w, const ProjectFile& file) {
    if (w.project.panel_jobs.empty()) return {};
    SEAM_TRY(auto last, last_panels(file, w.project.panel_jobs));
    w.page.heading(w.t("Panels"));
    for (std::size_t k = 0; k < last.size(); ++k) one_job(w, w.project.panel_jobs[k], last[k]);
    return {};
}

}  // namespace seamwright
