#include "projects/calibrate/session/guide.h"

#include "devices/simulated/cell.h"
#include "projects/calibrate/methods/example/target_views.h"
#include "projects/calibrate/session/shot.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

// Closer than this to a capture, a view counts as taken.
constexpr double kNearMm = 12, kNearDeg = 8;

const std::vector<TargetPlace>* views_of(const CalibrationMethod& method) {
    switch (method.capture) {
        case CaptureKind::sphere_profile:
            return &sphere_views();
        case CaptureKind::board_and_stripe:
        case CaptureKind::board_pose:
        case CaptureKind::board_points:
        case CaptureKind::board_chain:
        case CaptureKind::board_sights:
        case CaptureKind::board_view:
            return &plate_views();
        case CaptureKind::stripe_line:
            return &line_views();
        case CaptureKind::apex:
            return &apex_views();
        case CaptureKind::touch:
        case CaptureKind::files:
            break;
    }
    return nullptr;
}

// Solved, else as known.
std::optional<Pose> mounting(const CalibrationSession& session, const std::optional<Pose>& known) {
    const CalibrationSolution* solution = session.solution();
    // A solution that is not sound would lead away from the target.
    if (!solution || !serves(solution->verdict())) return known;
    if (const auto* sensor = std::get_if<SensorOnFlange>(&solution->found))
        return sensor->flange_from_sensor.pose;
    if (const auto* camera = std::get_if<CameraAndLaser>(&solution->found);
        camera && camera->flange_from_camera && camera->camera_from_laser)
        return camera->flange_from_camera->pose * *camera->camera_from_laser;
    return known;
}

const CalibrationCapture* first_with_pose(const CalibrationSession& session) {
    for (const SessionCapture& c : session.state().captures)
        if (c.taken->base_from_flange && !c.left_out) return c.taken.get();
    return nullptr;
}

bool taken(const CalibrationSession& session, const Pose& at) {
    for (const SessionCapture& c : session.state().captures)
        if (c.taken->base_from_flange && !c.left_out &&
            distance_mm(*c.taken->base_from_flange, at) < kNearMm &&
            angle_rad(*c.taken->base_from_flange, at) < rad_from_deg(kNearDeg))
            return true;
    return false;
}

}  // namespace

std::vector<NextPose> next_poses(const CalibrationSession& session,
                                 const std::optional<Pose>& flange_from_sensor) {
    const auto* views = views_of(session.method());
    const CalibrationCapture* first = first_with_pose(session);
    if (!views || !first) return {};
    const CalibrationSolution* solution = session.solution();
    std::vector<NextPose> proposed, poses;
    for (const PoseProposal& p : solution ? solution->proposals : std::vector<PoseProposal>())
        if (!taken(session, p.base_from_flange)) proposed.push_back({p.base_from_flange, true});
    const bool open = solution && solution->verdict() == Verdict::undetermined;
    if (const auto known = mounting(session, flange_from_sensor)) {
        const Pose& x = *known;
        // The first capture stands for the first view; the others follow from it.
        const Pose base_from_target =
            *first->base_from_flange * x * target_from_sensor(views->front()).inverse();
        for (const TargetPlace& view : *views) {
            const Pose pose = base_from_target * target_from_sensor(view) * x.inverse();
            if (!taken(session, pose)) poses.push_back({pose, false});
        }
    } else if (!open) {
        return {};
    }
    poses.insert(open ? poses.begin() : poses.end(), proposed.begin(), proposed.end());
    return poses;
}

std::optional<NextPose> next_pose(const CalibrationSession& session,
                                  const std::optional<Pose>& flange_from_sensor) {
    const auto poses = next_poses(session, flange_from_sensor);
    return poses.empty() ? std::nullopt : std::optional(poses.front());
}

std::optional<SimulatedStart> simulated_start(const CalibrationMethod& method,
                                              const nlohmann::json& cell_settings) {
    const auto* views = views_of(method);
    auto settings = parse_cell_settings(cell_settings);
    if (!views || !settings) return std::nullopt;
    return SimulatedStart{settings->base_from_target * target_from_sensor(views->front()) *
                              settings->flange_from_sensor.inverse(),
                          std::string(to_string(method.capture == CaptureKind::sphere_profile ? Scene::sphere
                                                : method.capture == CaptureKind::apex ? Scene::triangle
                                                                                      : Scene::plate))};
}

std::optional<Pose> next_place(const CalibrationSession& session, const Project& project) {
    if (const auto next = next_pose(session, known_mounting(session, project))) return next->base_from_flange;
    const SensorSetup* sensor = find_sensor(project, session.sensor_id());
    if (!session.state().captures.empty() || !sensor || !is_simulated_cell(sensor->driver))
        return std::nullopt;
    const auto start = simulated_start(session.method(), sensor->settings);
    return start ? std::optional(start->base_from_flange) : std::nullopt;
}

std::vector<std::string> to_keep_back(const CalibrationSession& session, int wanted) {
    std::vector<std::string> ids;
    const auto& captures = session.state().captures;
    for (auto it = captures.rbegin(); it != captures.rend(); ++it) {
        const int so_far = static_cast<int>(ids.size());
        if (session.verification_captures() + so_far >= wanted ||
            session.solving_captures() - so_far <= session.method().fewest)
            break;
        if (!it->verification && !it->left_out) ids.push_back(it->taken->id);
    }
    return ids;
}

std::optional<ViewMark> view_mark(const CalibrationSession& session, const Pose& flange_from_sensor,
                                  const Pose& base_from_flange) {
    const CalibrationCapture* first = first_with_pose(session);
    if (!first) return std::nullopt;
    const Eigen::Matrix3d x = mounting(session, flange_from_sensor)->linear();
    const Eigen::Matrix3d turned =
        (first->base_from_flange->linear() * x).transpose() * base_from_flange.linear() * x;
    const Eigen::Vector3d sight = turned.col(2);
    const Eigen::Vector3d axis(-sight.y(), sight.x(), 0);  // z turned into the sight line
    const double sine = axis.norm();
    const Eigen::Vector3d tilt =
        sine > 1e-12 ? Eigen::Vector3d(axis / sine * std::atan2(sine, sight.z())) : Eigen::Vector3d::Zero();
    const Eigen::Matrix3d about = rotation_exp(-tilt) * turned;
    ViewMark mark;
    mark.tilt_deg = tilt.head<2>() * (180 / kPi);
    mark.turn_deg = deg_from_rad(std::atan2(about(1, 0), about(0, 0)));
    return mark;
}

std::vector<ViewMark> view_marks(const CalibrationSession& session, const Pose& flange_from_sensor) {
    std::vector<ViewMark> marks;
    for (const SessionCapture& c : session.state().captures) {
        if (!c.taken->base_from_flange) continue;
        auto mark = view_mark(session, flange_from_sensor, *c.taken->base_from_flange);
        if (!mark) break;
        mark->id = c.taken->id;
        mark->used = !c.left_out && !c.verification;
        marks.push_back(*mark);
    }
    return marks;
}

}  // namespace seamwright
