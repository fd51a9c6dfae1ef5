// What is answered: what the solution measures of every frame, its parameters, and the verdict.

#include <algorithm>
#include <limits>
#include <memory>

#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/camera/corner_noise.h"
#include "core/calibration/pose/hand_eye.h"
#include "core/calibration/problem.h"
#include "core/calibration/statistics.h"
#include "core/calibration/stripe/stripe_camera_solver.h"
#include "core/calibration/stripe/stripe_scale.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright::detail {
namespace {

constexpr double kLeastNoise_px = 0.02;                         // no corners are read better
constexpr std::size_t kFewFrames = 6;                           // fewer are little to check with
constexpr double kGoodWorking_mm = 0.5, kPoorWorking_mm = 3.0;  // three sigma
constexpr const char* kMoreFrames =
    "take more frames with the plate tilted to both sides, nearer and farther";

// y = normal of the laser plane, z in the plane towards the camera, origin where the optical axis meets
// the plane (or the plane's point nearest to the camera when the axis runs along it).
Pose sensor_frame(const LaserPlane& plane) {
    constexpr double kAxisMeets = 0.05;   // sine between optical axis and plane: less runs along it
    constexpr double kAxisAcross = 1e-6;  // of -Z in the plane: with less, -Y takes its place
    const Eigen::Vector3d n = plane.normal;
    Eigen::Vector3d origin = -plane.offset_mm * n;
    if (std::abs(n.z()) > kAxisMeets && -plane.offset_mm / n.z() > 0)
        origin = {0, 0, -plane.offset_mm / n.z()};
    Eigen::Vector3d z = -Eigen::Vector3d::UnitZ();
    z -= z.dot(n) * n;
    if (z.norm() < kAxisAcross) z = -Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitY().dot(n) * n;
    z.normalize();
    Eigen::Matrix3d r;
    r.col(1) = n;
    r.col(2) = z;
    r.col(0) = n.cross(z);
    return make_pose(r, origin);
}

}  // namespace

void StripeCameraSolver::measure() {
    result_.camera = camera_of(state_.intrinsics, data_.width, data_.height);
    result_.freedom = model_.freedom;
    result_.shape_freedom = model_.shape;
    result_.shape = state_.shape;
    result_.rms_px = fit_.corner_rms_px;
    result_.sigma_px = bundle_.corner_sigma_px;
    result_.flange_from_camera = state_.flange_from_camera;
    result_.base_from_target = state_.base_from_target;
    result_.plane = state_.plane;
    measure_corners();
    if (has_robot()) measure_robot();
    if (!state_.plane) return;
    measure_stripes();
    measure_plane();
    measure_working_point();
}

void StripeCameraSolver::measure_corners() {
    for (std::size_t k = 0; k < count(); ++k) {
        auto& f = result_.frames[view_frame_[k]];
        f.camera_from_target = state_.camera_from_target[k];
        CameraPoints bent = data_.views[k];
        for (auto& x : bent.object_mm) x = state_.shape.apply(x);
        f.corner_rms_px = std::sqrt(squares_px2(state_.intrinsics, f.camera_from_target, bent) /
                                    static_cast<double>(bent.pixel.size()));
    }
}

// Where each frame puts the plate in the robot's base, and how far these places spread.
void StripeCameraSolver::measure_robot() {
    std::vector<Eigen::Vector3d> origins;
    for (std::size_t k = 0; k < count(); ++k) {
        const auto& at = observations_[view_frame_[k]].base_from_flange;
        if (!at) continue;
        auto& f = result_.frames[view_frame_[k]];
        const Pose target = *at * *state_.flange_from_camera * f.camera_from_target;
        f.robot_used = bundle_.base_from_flange[k].has_value();
        f.robot_mm = distance_mm(target, *state_.base_from_target);
        f.robot_deg = deg_from_rad(angle_rad(target, *state_.base_from_target));
        if (f.robot_used) origins.push_back(target.translation());
    }
    if (origins.empty()) return;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& o : origins) mean += o / static_cast<double>(origins.size());
    for (const auto& o : origins) {
        result_.target_spread_mm += (o - mean).squaredNorm() / static_cast<double>(origins.size());
        result_.target_spread_max_mm = std::max(result_.target_spread_max_mm, (o - mean).norm());
    }
    result_.target_spread_mm = std::sqrt(result_.target_spread_mm);
    if (fit_.covariance.size() && fit_.hand_eye_at >= 0)
        result_.flange_from_camera_covariance =
            robot_student() * robot_student() *
            fit_.covariance.block<6, 6>(fit_.hand_eye_at, fit_.hand_eye_at);
}

// How far the rows of each stripe lie off the plane.
void StripeCameraSolver::measure_stripes() {
    int rows = 0, on = 0, rows_all = 0, on_all = 0;
    double square = 0;
    std::size_t points_used = 0;
    for (std::size_t k = 0; k < count(); ++k) {
        if (choice_[k] >= lines_[k].size()) continue;
        auto& f = result_.frames[view_frame_[k]];
        const auto& line = lines_[k][choice_[k]];
        f.stripe_used = bundle_.stripe_used[k];
        f.rows_on_board = static_cast<int>(line.on.size()) + line.missed;
        for (const auto i : line.on) {
            const auto& pixel = observations_[view_frame_[k]].stripe[i];
            const auto met =
                meet_plate(result_.camera, pixel, f.camera_from_target, state_.shape, bundle_.stripe_on_bow);
            if (!met) continue;
            const double e = state_.plane->normal.dot(*met) + state_.plane->offset_mm;
            f.stripe.push_back(pixel);
            f.off_plane_mm.push_back(e);
            f.rows_on_plane += std::abs(e) < kOnPlaneMm;
            if (f.stripe_used) square += e * e, ++points_used;
        }
        if (std::vector<double> off = f.off_plane_mm; !off.empty()) f.median_off_plane_mm = median(off);
        rows_all += f.rows_on_board, on_all += f.rows_on_plane;
        if (f.stripe_used)
            rows += f.rows_on_board, on += f.rows_on_plane;
        else
            f.note = Text("its stripe lies {:.1f} mm off the plane of the other frames and was left out",
                          std::abs(f.median_off_plane_mm));
    }
    result_.on_plane_share = rows ? static_cast<double>(on) / rows : 0;
    result_.on_plane_share_all = rows_all ? static_cast<double>(on_all) / rows_all : 0;
    result_.plane_rms_mm = points_used ? std::sqrt(square / static_cast<double>(points_used)) : 0;
}

void StripeCameraSolver::measure_plane() {
    result_.plane_distance_mm = std::abs(state_.plane->offset_mm);
    result_.camera_from_laser = sensor_frame(*state_.plane);
    if (!fit_.covariance.size()) return;
    const Eigen::Index p = fit_.plane_at;
    result_.plane_sigma_deg =
        deg_from_rad(std::sqrt(std::max(fit_.covariance(p, p), fit_.covariance(p + 1, p + 1))));
    result_.plane_sigma_mm = std::sqrt(fit_.covariance(p + 2, p + 2));
    const Eigen::Index n = fit_.basis.cols();
    Eigen::MatrixXd covariance(n + 3, n + 3);
    covariance << fit_.covariance.topLeftCorner(n, n), fit_.covariance.block(0, p, n, 3),
        fit_.covariance.block(p, 0, 3, n), fit_.covariance.block(p, p, 3, 3);
    result_.scale = stripe_scale(state_.intrinsics, result_.camera.width, result_.camera.height,
                                 *state_.plane, fit_.basis, covariance, sensor_frame);
}

// Where the ray through the middle of the working range meets the laser plane, by all that is solved for together.
void StripeCameraSolver::measure_working_point() {
    if (!fit_.covariance.size()) return;
    const Eigen::Index n = fit_.basis.cols();
    const Eigen::Vector2d pixel = result_.camera.project(result_.camera_from_laser.translation());
    const Pose flange = state_.flange_from_camera.value_or(Pose::Identity());
    const std::unique_ptr<ceres::Manifold> manifold(plane_manifold());
    const auto point = [&](Eigen::Index column, double step) -> Eigen::Vector3d {
        Intrinsics k = state_.intrinsics;
        Vector6 moved = Vector6::Zero();
        Eigen::Vector3d turned = Eigen::Vector3d::Zero();
        if (column < n)
            k += step * fit_.basis.col(column);
        else if (column < n + 3)
            turned(column - n) = step;
        else
            moved(column - n - 3) = step;
        Eigen::Vector4d at, plane;
        at << state_.plane->normal, state_.plane->offset_mm;
        manifold->Plus(at.data(), turned.data(), plane.data());
        const Eigen::Vector3d ray = camera_of(k, data_.width, data_.height).undistort(pixel).homogeneous();
        return retract(flange, moved) * (ray * (-plane[3] / plane.head<3>().dot(ray)));
    };
    std::vector<Eigen::Index> from;
    for (Eigen::Index i = 0; i < n; ++i) from.push_back(i);
    for (Eigen::Index i = 0; i < 3; ++i) from.push_back(fit_.plane_at + i);
    for (Eigen::Index i = 0; has_robot() && fit_.hand_eye_at >= 0 && i < 6; ++i)
        from.push_back(fit_.hand_eye_at + i);
    const auto columns = static_cast<Eigen::Index>(from.size());
    Eigen::MatrixXd slope(3, columns), covariance(columns, columns);
    for (Eigen::Index i = 0; i < columns; ++i)
        for (Eigen::Index j = 0; j < columns; ++j)
            covariance(i, j) =
                fit_.covariance(from[static_cast<std::size_t>(i)], from[static_cast<std::size_t>(j)]) *
                (i < n + 3 ? 1 : robot_student()) * (j < n + 3 ? 1 : robot_student());
    for (Eigen::Index i = 0; i < columns; ++i) {
        constexpr double kStepShare = 1e-3;  // of the sigma
        const double h = kStepShare * std::sqrt(std::max(0.0, covariance(i, i)));
        slope.col(i) = Eigen::Vector3d::Zero();
        if (h > 0) slope.col(i) = (point(i, h) - point(i, -h)) / (2 * h);
    }
    const Eigen::Matrix3d cover = slope * covariance * slope.transpose();
    if (cover.allFinite())
        result_.working_sigma_mm = std::sqrt(std::max(0.0, symmetric_eigen(cover).values(2)));
}

void StripeCameraSolver::list_parameters() {
    auto& report = result_.report;
    static constexpr std::array<const char*, 9> units{"px", "px", "px", "px", "1", "1", "1", "1", "1"};
    const Eigen::Index n_k = fit_.basis.cols();
    Eigen::Index total = 9 + (fit_.shape_at >= 0 ? (model_.shape == ShapeFreedom::bowed ? 5 : 2) : 0) +
                         (fit_.hand_eye_at >= 0 ? 6 : 0) + (fit_.plane_at >= 0 ? 3 : 0);
    Eigen::MatrixXd select = Eigen::MatrixXd::Zero(total, fit_.normal.gg.rows());
    for (Eigen::Index i = 0; i < 9; ++i)
        report.parameters.push_back({kIntrinsicNames[static_cast<std::size_t>(i)], state_.intrinsics(i),
                                     units[static_cast<std::size_t>(i)], 0});
    select.topLeftCorner(9, n_k) = fit_.basis;
    Eigen::Index row = 9;
    std::pair<Eigen::Index, Eigen::Index> hand_eye_rows{0, 0};
    const auto add = [&](const char* name, double value, const char* unit, Eigen::Index column,
                         double scale = 1) {
        report.parameters.push_back({name, value * scale, unit, 0});
        select(row++, column) = scale;
    };
    if (fit_.shape_at >= 0) {
        add("plate_stretch", state_.shape.stretch, "1", fit_.shape_at);
        add("plate_shear", state_.shape.shear, "1", fit_.shape_at + 1);
        if (model_.shape == ShapeFreedom::bowed) {
            add("plate_bow_xx", state_.shape.bow_mm(0), "mm", fit_.shape_at + 2);
            add("plate_bow_xy", state_.shape.bow_mm(1), "mm", fit_.shape_at + 3);
            add("plate_bow_yy", state_.shape.bow_mm(2), "mm", fit_.shape_at + 4);
        }
    }
    if (fit_.hand_eye_at >= 0) {
        const Pose& x = *state_.flange_from_camera;
        const Eigen::Vector3d w = rotation_log(x.linear());
        static constexpr std::array<const char*, 3> t{"flange_from_camera.x", "flange_from_camera.y",
                                                      "flange_from_camera.z"};
        static constexpr std::array<const char*, 3> r{"flange_from_camera.rx", "flange_from_camera.ry",
                                                      "flange_from_camera.rz"};
        for (Eigen::Index i = 0; i < 3; ++i)
            add(t[static_cast<std::size_t>(i)], x.translation()(i), "mm", fit_.hand_eye_at + i);
        for (Eigen::Index i = 0; i < 3; ++i)
            add(r[static_cast<std::size_t>(i)], w(i), "deg", fit_.hand_eye_at + 3 + i, deg_from_rad(1));
        hand_eye_rows = {row - 6, row};
    }
    if (fit_.plane_at >= 0) {
        add("laser_plane.tilt_1", 0, "deg", fit_.plane_at, deg_from_rad(1));
        add("laser_plane.tilt_2", 0, "deg", fit_.plane_at + 1, deg_from_rad(1));
        add("laser_plane.distance", result_.plane_distance_mm, "mm", fit_.plane_at + 2);
    }
    if (fit_.covariance.size()) {
        Eigen::VectorXd times = Eigen::VectorXd::Ones(total);
        for (Eigen::Index i = hand_eye_rows.first; i < hand_eye_rows.second; ++i) times(i) = robot_student();
        report.covariance =
            times.asDiagonal() * select * fit_.covariance * select.transpose() * times.asDiagonal();
        finish_statistics(report);
    }
}

void StripeCameraSolver::list_poses() {
    for (const auto& f : result_.frames) {
        PoseResidual p;
        p.id = f.id;
        p.used = f.used;
        p.note = f.note;
        if (f.used) p.rms_px = f.corner_rms_px;
        if (f.robot_used || f.robot_mm > 0) p.rms_mm = f.robot_mm, p.deg = f.robot_deg;
        p.contradicts = f.used && !f.robot_used && f.robot_mm > 0;
        result_.report.poses.push_back(std::move(p));
    }
}

double StripeCameraSolver::focal_px() const {
    return 0.5 * (result_.camera.fx + result_.camera.fy);
}

double StripeCameraSolver::sigma_focal_px() const {
    return fit_.covariance.size() ? result_.report.parameters[0].sigma
                                  : std::numeric_limits<double>::infinity();
}

std::ptrdiff_t StripeCameraSolver::stripes_used() const {
    return std::count_if(result_.frames.begin(), result_.frames.end(),
                         [](const auto& x) { return x.stripe_used; });
}

// Frames whose stripe contradicts the plane of the others, by id.
std::string StripeCameraSolver::frames_off_plane() const {
    std::string off;
    for (const auto& x : result_.frames)
        if (x.used && !x.stripe_used && !x.stripe.empty()) off += (off.empty() ? "" : ", ") + x.id;
    return off;
}

Judgement StripeCameraSolver::verdict() const {
    if (move_)
        return {Verdict::poor,
                Text("the laser or the camera moved between {} and {}: their stripes before and after lie "
                     "{:.2f} mm "
                     "apart",
                     move_->last_before, move_->first_after, move_->apart_mm),
                "hold laser and camera firmly together and take all frames again"};
    if (auto judged = undetermined()) return *judged;
    // Beyond what corners are read to, the model does not explain them.
    const double misfit = result_.sigma_px / std::max(corner_noise_px(data_.views), kLeastNoise_px);
    if (auto judged = poor(misfit)) return *judged;
    if (auto judged = usable(misfit)) return *judged;
    return good();
}

std::optional<Judgement> StripeCameraSolver::undetermined() const {
    constexpr double kOpenPlane_deg = 2;  // sigma, beyond
    if (!fit_.covariance.size() || sigma_focal_px() > kOpenFocal * focal_px())
        return Judgement{Verdict::undetermined,
                         Text("the frames do not determine the focal length (sigma {:.0f} of {:.0f} px)",
                              sigma_focal_px(), focal_px()),
                         "tilt the plate by 20 to 40 degrees in several directions"};
    if (!result_.plane)
        return Judgement{Verdict::undetermined, "fewer than two frames show a stripe on the plate",
                         "place the plate so that the stripe crosses it in every frame"};
    if (stripes_used() < 3 || result_.plane_sigma_deg > kOpenPlane_deg)
        return Judgement{Verdict::undetermined,
                         Text("the stripes of {} frames do not fix the laser plane (sigma {:.1f} degrees)",
                              stripes_used(), result_.plane_sigma_deg),
                         "add frames with the plate nearer, farther and tilted"};
    return std::nullopt;
}

Text StripeCameraSolver::working_words() const {
    return Text("three sigma at the working point are {:.2f} mm", 3 * result_.working_sigma_mm);
}

double StripeCameraSolver::mean_distance_mm() const {
    double sum = 0;
    for (const Pose& p : state_.camera_from_target) sum += p.translation().norm();
    return sum / static_cast<double>(count());
}

Text StripeCameraSolver::corners_misfit(double misfit) const {
    return Text("the corners fit to {:.2f} px, {:.0f} times as far off as they are read", result_.rms_px,
                misfit);
}

std::optional<Judgement> StripeCameraSolver::poor(double misfit) const {
    constexpr double kPoorShare = 0.8;    // of the stripe rows on the plane, below
    constexpr double kPoorMisfit = 5;     // times the corners' own noise, beyond
    constexpr double kPoorSpread_mm = 3;  // of the plate's origin in the robot's base, beyond
    if (result_.on_plane_share < kPoorShare || result_.rms_px > kPoorCorners_px)
        return Judgement{Verdict::poor,
                         Text("only {:.0f} % of the stripe rows lie within 0.5 mm of one plane, corners "
                              "fit to {:.2f} px",
                              100 * result_.on_plane_share, result_.rms_px),
                         "check focus, that plate, laser and camera are held firmly, and the board's size"};
    if (misfit > kPoorMisfit)
        return Judgement{Verdict::poor, corners_misfit(misfit),
                         "check that the plate is flat and firm, and the lens in focus"};
    const auto stripes = stripes_used();
    const auto with_stripe = std::count_if(result_.frames.begin(), result_.frames.end(),
                                           [](const auto& x) { return x.used && !x.stripe.empty(); });
    if (2 * stripes <= with_stripe)
        return Judgement{Verdict::poor,
                         Text("the stripes of {} of {} frames contradict the plane of the others ({})",
                              with_stripe - stripes, with_stripe, frames_off_plane()),
                         "hold laser and camera firmly together and take all frames again"};
    if (wrong_target_size(result_.target_size, result_.target_size_sigma, mean_distance_mm()))
        return wrong_size_judgement(result_.target_size);
    if (result_.working_sigma_mm > kPoorWorking_mm / 3)
        return Judgement{Verdict::poor, working_words(), kMoreFrames};
    if (result_.flange_from_camera && result_.target_spread_mm > kPoorSpread_mm)
        return Judgement{
            Verdict::poor,
            Text("the plate's origin spreads by {:.1f} mm in the robot's base", result_.target_spread_mm),
            "check that poses and images belong together and that the plate did not move"};
    return std::nullopt;
}

std::optional<Judgement> StripeCameraSolver::usable(double misfit) const {
    constexpr double kUsableMisfit = 3;    // times the corners' own noise, beyond
    constexpr double kUsableFocal = 0.01;  // sigma of the focal length over itself, beyond
    constexpr double kUsableShare = 0.95;  // of the stripe rows on the plane, below
    if (const std::string off = frames_off_plane(); !off.empty())
        return Judgement{
            Verdict::usable,
            Text("the stripe of {} lies off the plane that the other {} frames share", off, stripes_used()),
            "check that laser and camera sit firmly, and take these frames again"};
    if (misfit > kUsableMisfit)
        return Judgement{Verdict::usable, corners_misfit(misfit),
                         "check that the plate is flat and firm, and the lens in focus"};
    if (sigma_focal_px() > kUsableFocal * focal_px())
        return Judgement{
            Verdict::usable,
            Text("the focal length is known to {:.1f} % only", 100 * sigma_focal_px() / focal_px()),
            "add frames with the plate tilted by 20 to 40 degrees"};
    if (result_.on_plane_share < kUsableShare)
        return Judgement{
            Verdict::usable,
            Text("{:.0f} % of the stripe rows lie within 0.5 mm of one plane", 100 * result_.on_plane_share),
            "use a flatter plate or less exposure"};
    if (!result_.flange_from_camera && !robot_note_.empty())
        return Judgement{Verdict::usable, Text("no hand-eye: {}", robot_note_), robot_cure_};
    if (count() < kFewFrames)
        return Judgement{Verdict::usable, Text("only {} frames, little to check with", count()), kMoreFrames};
    if (result_.working_sigma_mm > kGoodWorking_mm / 3)
        return Judgement{Verdict::usable, working_words(), kMoreFrames};
    if (result_.robot_contradicts)
        return Judgement{
            Verdict::usable,
            Text("the robot's poses scatter by {:.2f} mm and {:.3f} degrees an axis, more than its "
                 "stated repeatability",
                 bundle_.robot_sigma_mm, deg_from_rad(bundle_.robot_sigma_rad)),
            "check the stated repeatability, and that the robot stood still"};
    return std::nullopt;
}

Judgement StripeCameraSolver::good() const {
    Text reason("{} frames, corners {:.2f} px, {:.1f} % of the stripe on one plane", count(), result_.rms_px,
                100 * result_.on_plane_share);
    if (model_.shape != ShapeFreedom::rigid)
        reason = Text("{}; the plate is stretched by {:.2f} % and sheared by {:.2f} %, which was solved for",
                      reason, 100 * state_.shape.stretch, 100 * state_.shape.shear);
    return {Verdict::good, reason, ""};
}

}  // namespace seamwright::detail
