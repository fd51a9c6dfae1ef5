// The robot sent somewhere, and moved by hand, on the Station's thread.

#include "widgets/shown_text.h"
#include "widgets/worker/station_worker.h"

namespace seamwright {

void StationWorker::go_to(const std::string& robot_id, const Pose& base_from_flange) {
    post(
        tr("Moving the robot"),
        [=, this](Station& station, const std::stop_token& cancelled) {
            const auto move = [&]() -> QString {
                RobotLink* robot = station.robot(robot_id);
                if (cancelled.stop_requested()) return tr("The robot was not moved: cancelled.");
                if (!robot) return tr("The robot is not connected.");
                auto moved = robot->move_to(base_from_flange);
                return moved ? QString() : shown_error(tr("The robot was not moved."), moved.error());
            };
            const QString trouble = move();
            if (!trouble.isEmpty() && !cancelled.stop_requested()) tell(&StationWorker::failed, trouble);
            publish(station);
            tell(&StationWorker::arrived, robot_id, trouble);
        },
        [=, this](const Error& why) {
            const QString trouble = shown_error(tr("The robot was not moved."), why);
            tell(&StationWorker::failed, trouble);
            tell(&StationWorker::arrived, robot_id, trouble);
        });
}

void StationWorker::jog(const std::string& robot_id, const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    if (busy_ || !queue_.empty()) return;
    jog_request_ = JogRequest{robot_id, base_from_flange};
    wake_.notify_all();
}

void StationWorker::stop_jog() {
    const std::lock_guard lock(mutex_);
    jog_request_.reset();
}

void StationWorker::move_by_hand(Station& station, const JogRequest& request) {
    RobotLink* robot = station.robot(request.robot_id);
    if (!robot)
        return tell(&StationWorker::jogged, request.robot_id, request.base_from_flange,
                    tr("The robot is not connected."));
    auto moved = robot->move_to(request.base_from_flange);
    const auto at = robot->base_from_flange();
    const QString trouble = !moved ? shown_error(tr("The robot was not moved."), moved.error())
                            : !at  ? shown_error(tr("The robot does not tell where it stands."), at.error())
                                   : QString();
    tell(&StationWorker::jogged, request.robot_id, at ? *at : request.base_from_flange, trouble);
}

}  // namespace seamwright
