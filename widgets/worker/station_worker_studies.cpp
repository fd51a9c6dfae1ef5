// Studies, confirmations and passes along a gap on the Station's thread.

#include "projects/acceptance/simulated_parts.h"
#include "widgets/shown_text.h"
#include "widgets/worker/station_worker.h"

namespace seamwright {
namespace {

// Nobody at a window has typed an option.
Error without_option(Error error) {
    if (error.where.english().starts_with("--")) error.where.clear();
    return error;
}

}  // namespace

bool StationWorker::ask(const std::stop_token& cancelled, const std::function<void()>& question) {
    {
        const std::lock_guard lock(mutex_);
        if (cancelled.stop_requested()) return false;
        push_answer_.reset();
    }
    question();
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [&] { return push_answer_.has_value(); });
    return *push_answer_;
}

void StationWorker::measure_study(const LiveStudyOptions& asked) {
    post(tr("Study"), [=, this](Station& station, const std::stop_token& cancelled) {
        LiveStudyOptions options = asked;
        options.cancel = cancelled;
        options.progress = progress_sink();
        options.measured = [this](const RunRecord& run) {
            tell(&StationWorker::measured, std::make_shared<const RunRecord>(run));
        };
        Expected<void> put;
        Expected<StudyProgress> progress;
        {
            const bool simulated = !options.parts.empty() && SimulatedParts::possible(station.project());
            if (simulated) feed_.detach();  // each part opens the devices anew
            SimulatedParts parts(station);
            options.place = [&](const std::string& part, int rehang) {
                if (simulated) {
                    put = parts.put(part, rehang);
                    return put.has_value();
                }
                return ask(cancelled, [&] {
                    tell(&StationWorker::place_study_part, QString::fromStdString(part), rehang);
                });
            };
            progress = seamwright::measure_study(station, options);
        }
        attach_feed(station);
        if (!put)
            return tell(&StationWorker::failed, shown_error(tr("The part was not put in."), put.error()));
        if (!progress)
            return tell(&StationWorker::failed,
                        shown_error(tr("The study was not measured."), without_option(progress.error())));
        tell(&StationWorker::proven);
        tell(&StationWorker::studied, std::make_shared<const StudyProgress>(std::move(*progress)));
    });
}

void StationWorker::measure_robot(const MeasureRobotOptions& asked) {
    post(tr("Robot's repeatability"), [=, this](Station& station, const std::stop_token& cancelled) {
        MeasureRobotOptions options = asked;
        options.keep = false;  // the document keeps it, as an edit that can be undone
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto robot = seamwright::measure_robot(station, options);
        if (!robot)
            return tell(&StationWorker::failed,
                        shown_error(tr("The robot was not measured."), robot.error()));
        tell(&StationWorker::robot_studied, std::make_shared<const MeasuredRobot>(std::move(*robot)));
    });
}

void StationWorker::measure_trigger(const MeasureTriggerOptions& asked) {
    post(tr("Latency and jitter of the trigger"), [=, this](Station& station,
                                                            const std::stop_token& cancelled) {
        MeasureTriggerOptions options = asked;
        options.keep = false;
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto trigger = seamwright::measure_trigger(station, options);
        if (!trigger)
            return tell(&StationWorker::failed,
                        shown_error(tr("The trigger was not measured."), trigger.error()));
        if (!trigger->study) return tell(&StationWorker::failed, shown(trigger->unseen));
        tell(&StationWorker::trigger_studied, std::make_shared<const MeasuredTrigger>(std::move(*trigger)));
    });
}

void StationWorker::confirm(const std::string& spot_id) {
    post(tr("Confirming"), [=, this](Station& station, const std::stop_token& cancelled) {
        ConfirmOptions options;
        options.spot_ids = {spot_id};
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto found = confirm_spots(station, options);
        if (!found)
            tell(&StationWorker::failed, shown_error(tr("The spot was not confirmed."), found.error()));
        else
            tell(&StationWorker::confirmed, std::make_shared<const Confirmation>(std::move(*found)));
    });
}

void StationWorker::record_to(const std::shared_ptr<Recorder>& recorder) {
    post(tr("Recording"), [=, this](Station& station, const std::stop_token&) {
        const bool anew = recorder || station.connected();
        station.record_to(recorder);
        if (anew) connect_devices();
    });
}

void StationWorker::drive_gap(const DrivenGapPass& asked) {
    post(tr("Along the gap"), [=, this](Station& station, const std::stop_token& cancelled) {
        DrivenGapPass options = asked;
        options.cancel = cancelled;
        options.progress = progress_sink();
        auto pass = gap_pass(station, options);
        if (!pass)
            return tell(&StationWorker::failed, shown_error(tr("The gap was not measured."), pass.error()));
        tell(&StationWorker::gap_passed, std::make_shared<const GapPass>(std::move(*pass)));
    });
}

void StationWorker::read_gap(const std::filesystem::path& capture, const RecordedGapPass& options) {
    post(tr("Reading the recording"), [=, this](Station& station, const std::stop_token&) {
        auto reader = CaptureReader::open(capture);
        auto pass = reader ? gap_pass(station.project(), *reader, options)
                           : Expected<GapPass>(tl::unexpected(reader.error()));
        if (!pass)
            return tell(&StationWorker::failed, shown_error(tr("The gap was not measured."), pass.error()));
        tell(&StationWorker::gap_passed, std::make_shared<const GapPass>(std::move(*pass)));
    });
}

}  // namespace seamwright
