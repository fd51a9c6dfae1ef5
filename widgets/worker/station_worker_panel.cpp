// Panels in their gripper on the Station's thread.

#include "projects/measure/measure.h"
#include "projects/panel/panel_profiles.h"
#include "projects/panel/panel_servo.h"
#include "projects/panel/panel_station.h"
#include "widgets/shown_text.h"
#include "widgets/worker/station_worker.h"

namespace seamwright {

void StationWorker::fit_panel(const PanelOrder& order) {
    post(order.servo  ? tr("Servoing the panel")
         : order.push ? tr("Fitting the panel")
                      : tr("Measuring the panel"),
         [=, this](Station& station, const std::stop_token& cancelled) {
             RunOptions options;
             options.part_id = order.part_id;
             options.push = order.push;
             options.cancel = cancelled;
             options.progress = progress_sink();
             if (order.push)
                 options.confirm_push = [&](const RunRecord& judged) {
                     return ask(cancelled, [&] {
                         tell(&StationWorker::confirm_panel, std::make_shared<const RunRecord>(judged));
                     });
                 };
             const PanelMoved moved = [this](const PanelRecord& so_far, int moves) {
                 tell(&StationWorker::panel_moved, std::make_shared<const PanelRecord>(so_far), moves);
             };
             auto run = order.servo ? servo_panel(station, order.job_id, device_servoing(), options, moved)
                                    : run_panel(station, order.job_id, options);
             if (!run)
                 return tell(&StationWorker::failed,
                             shown_error(tr("The panel was not measured."), run.error()));
             auto panel = with_profiles(station.project(), std::move(*run));
             if (!panel)
                 return tell(&StationWorker::failed,
                             shown_error(tr("The panel was not measured."), panel.error()));
             tell(&StationWorker::panel_measured, std::make_shared<const MeasuredPanel>(std::move(*panel)));
         });
}

void StationWorker::learn_panel(const std::string& job_id) {
    post(tr("Learning the sensitivity"), [=, this](Station& station, const std::stop_token& cancelled) {
        RunOptions options;
        options.cancel = cancelled;
        options.progress = progress_sink();
        const PanelMoved moved = [this](const PanelRecord& so_far, int moves) {
            tell(&StationWorker::panel_moved, std::make_shared<const PanelRecord>(so_far), moves);
        };
        auto learnt = seamwright::learn_panel(station, job_id, device_servoing(), options, moved);
        if (!learnt)
            return tell(&StationWorker::failed,
                        shown_error(tr("The sensitivity was not learnt."), learnt.error()));
        tell(&StationWorker::panel_learnt, std::make_shared<const LearntPanel>(std::move(*learnt)));
    });
}

void StationWorker::teach_panel(const std::string& job_id, int repeats) {
    post(tr("Teaching the panel"), [=, this](Station& station, const std::stop_token& cancelled) {
        TeachOptions options;
        options.repeats = repeats;
        options.cancel = cancelled;
        options.progress = progress_sink();
        const auto taught = [&]() -> Expected<PanelJob> {
            const PanelJob* job = find_panel_job(station.project(), job_id);
            if (!job)
                return input_error(Text("there is no panel job \"{}\"", job_id),
                                   station.file().path().string());
            return seamwright::teach_panel(station, *job, options);
        }();
        if (!taught)
            return tell(&StationWorker::failed, shown_error(tr("The panel was not taught."), taught.error()));
        tell(&StationWorker::panel_taught, std::make_shared<const PanelJob>(*taught));
    });
}

}  // namespace seamwright
