// A guided calibration looks at the live picture, and captures by itself where the robot stands still.

#include <algorithm>
#include <cmath>
#include <utility>

#include "projects/calibrate/session/shot.h"
#include "projects/measure/measure.h"
#include "widgets/desk/calibration_desk.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

constexpr double kStillSeconds = 0.5, kStillMm = 0.02, kStillDeg = 0.005;
// Of the radius: so near to each other lie the circles of one sphere in two frames one after the other, the robot being
// jogged.
constexpr double kSameCircle = 0.25, kSameRadius = 0.1;
// Nearer than this to a capture nothing is captured by itself.
constexpr double kNewMm = 3, kNewDeg = 1;

}  // namespace

void CalibrationDesk::set_automatic(bool on) {
    automatic_ = on;
    stillness_ = 0;
    emit still_changed();
}

void CalibrationDesk::set_looking(bool on) {
    looking_ = on;
    if (on) look();
}

bool CalibrationDesk::switches_laser() const {
    for (const SensorState& s : desk_.station().sensors)
        if (s.id == session_->sensor_id())
            return std::any_of(s.parameters.begin(), s.parameters.end(),
                               [](const ParameterInfo& p) { return p.name == "laser"; });
    return false;
}

// The newest live frame through the same function that captures, so that what is outlined is what will be
// taken.
void CalibrationDesk::look() {
    if (!session_ || !looking_ || look_pending_ || session_->method().capture == CaptureKind::files ||
        session_->method().capture == CaptureKind::touch)
        return;
    const SensorSetup* sensor = find_sensor(desk_.project(), session_->sensor_id());
    const auto snapshot = desk_.live().latest(session_->sensor_id());
    if (!sensor || !snapshot || !snapshot->frame || snapshot->number == looked_number_) return;
    looked_number_ = snapshot->number;
    look_pending_ = true;
    // Where the robot stands does not matter to a target that is only looked for.
    std::optional<Pose> at = robot_pose();
    if (!at && session_->method().robot) at = Pose::Identity();
    std::optional<Calibration> used;
    if (base()) used = *base();
    auto settings = capture_settings();
    post([this, frame = snapshot->frame, used, at, sensor = *sensor, method = &session_->method(),
          settings = settings ? *settings : session_->state().settings,
          generation = generation_](const std::stop_token&) {
        auto live = std::make_shared<LiveTarget>();
        live->frame = frame;
        auto taken = capture_shot(*method, settings, sensor, used ? &*used : nullptr, *frame, nullptr, at);
        if (taken) {
            live->seen = true;
            live->picture = entry_picture(*method, taken->settings, taken->capture.entry);
        } else {
            live->words = shown_error(taken.error());
        }
        QMetaObject::invokeMethod(this, [this, live, generation] {
            look_pending_ = false;
            if (generation != generation_) return;
            // A chance likeness does not stay from frame to frame.
            const auto before = std::exchange(circle_, live->picture.circle);
            if (circle_ && !(before && (*before - *circle_).head<2>().norm() < kSameCircle * before->z() &&
                             std::abs(before->z() - circle_->z()) < kSameRadius * before->z())) {
                live->seen = false;
                live->words = tr("A circle, but not yet twice at the same place: hold the sensor still.");
            }
            live_ = std::move(*live);
            emit looked();
        });
    });
}

void CalibrationDesk::watch_robot() {
    if (!session_ || !automatic_) return;
    const std::optional<Pose> at = robot_pose();
    if (!at) {
        last_pose_.reset();
        stillness_ = 0;
        return emit still_changed();
    }
    const bool moved = !last_pose_ || distance_mm(*at, *last_pose_) > kStillMm ||
                       angle_rad(*at, *last_pose_) > rad_from_deg(kStillDeg);
    last_pose_ = at;
    if (moved) still_since_.start();
    const bool known = std::any_of(
        session_->state().captures.begin(), session_->state().captures.end(), [&](const SessionCapture& c) {
            return c.taken->base_from_flange && distance_mm(*c.taken->base_from_flange, *at) < kNewMm &&
                   angle_rad(*c.taken->base_from_flange, *at) < rad_from_deg(kNewDeg);
        });
    stillness_ = known || moved
                     ? 0
                     : std::min(1.0, static_cast<double>(still_since_.elapsed()) / (1000 * kStillSeconds));
    emit still_changed();
    // A board is looked for with the laser off when it is captured; all other targets must be seen before.
    const bool seen = live_.seen || shows_board(session_->method().capture);
    if (stillness_ >= 1 && seen && !busy() && !desk_.worker().busy()) {
        still_since_.start();
        capture(false);
    }
}

}  // namespace seamwright
