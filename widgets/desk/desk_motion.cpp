// Motions from the desk.

#include <algorithm>

#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "widgets/desk/desk.h"

namespace seamwright {

bool Desk::can_move(const std::string& robot_id) const {
    return state_->connected &&
           std::any_of(state_->robots.begin(), state_->robots.end(),
                       [&](const RobotState& r) { return r.id == robot_id && r.can_move; });
}

bool Desk::attended(const std::string& robot_id) const {
    const RobotSetup* robot = find_robot(project_, robot_id);
    return robot && (is_simulated_cell(robot->driver) || attended_.contains(robot_id));
}

void Desk::attend(const std::string& robot_id, bool somebody_stands_beside) {
    if (attended_.contains(robot_id) == somebody_stands_beside) return;
    if (somebody_stands_beside)
        attended_.insert(robot_id);
    else
        attended_.erase(robot_id);
    emit attended_changed();
}

bool Desk::go_to(const std::string& robot_id, const Pose& base_from_flange) {
    if (!can_move(robot_id)) return false;
    if (!attended(robot_id)) {
        emit attendance_wanted(robot_id);
        return false;
    }
    worker_.go_to(robot_id, base_from_flange);
    return true;
}

void Desk::note_pose(const std::string& robot_id, const Pose& base_from_flange) {
    auto state = std::make_shared<StationState>(*state_);
    for (RobotState& r : state->robots)
        if (r.id == robot_id) r.base_from_flange = base_from_flange;
    state_ = std::move(state);
    emit station_changed();
}

}  // namespace seamwright
