// The robot's part of a stripe camera's calibration: which way round boards were read, hand-eye's start, lengths against the
// robot's motion, what its poses err by.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/numbers.h"
#include "core/calibration/pose/hand_eye.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/calibration/stripe/stripe_camera_solver.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::detail {
namespace {

// What robots can be, whatever the residuals say: sigmas from .. to.
constexpr double kBestRobot_mm = 0.05, kWorstRobot_mm = 5.0, kBestRobot_deg = 0.01, kWorstRobot_deg = 1;
constexpr double kLeastRobotFreedom = 3.0;

// (R_a - I) t_x = s R_x t_b - t_a over relative motions, with the length scale s of the board free: s far
// from 1 means that pitch and robot do not speak of the same millimetre.
Expected<void> check_scale(const std::vector<Pose>& a, const std::vector<Pose>& b, const Eigen::Matrix3d& rx,
                           double pitch_mm) {
    Eigen::Matrix4d ata = Eigen::Matrix4d::Zero();
    Eigen::Vector4d atb = Eigen::Vector4d::Zero();
    Eigen::Matrix3d ata1 = Eigen::Matrix3d::Zero();
    double btb = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = i + 1; j < a.size(); ++j) {
            const Pose fa = a[j].inverse() * a[i], fb = b[j] * b[i].inverse();
            Eigen::Matrix<double, 3, 4> m;
            m.leftCols<3>() = fa.linear() - Eigen::Matrix3d::Identity();
            m.col(3) = -rx * fb.translation();
            const Eigen::Vector3d r = -fa.translation();
            ata += m.transpose() * m;
            atb += m.transpose() * r;
            ata1 += m.leftCols<3>().transpose() * m.leftCols<3>();
            btb += r.squaredNorm();
        }
    const LeastSquares solved = least_squares(ata, atb);
    if (solved.rank < 4) return {};
    const Eigen::Vector4d x = solved.x;
    const double s = x(3);
    const double free_cost = std::max(0.0, btb - atb.dot(x));
    Eigen::Vector4d unit;
    unit << solve_symmetric(ata1, atb.head<3>() - ata.block<3, 1>(0, 3)), 1;
    const double unit_cost = btb - 2 * atb.dot(unit) + unit.dot(ata * unit);
    constexpr double kWrongPitch = 0.06;  // relative
    constexpr double kMisfitLeft = 0.3;   // of the misfit: what a free scale must bring it below
    constexpr double kMetres = 300;       // times: beyond, one of the two is in metres
    if (!(s > 0) || std::abs(s - 1) < kWrongPitch || free_cost > kMisfitLeft * unit_cost) return {};
    if (s > kMetres || s < 1 / kMetres)
        return input_error(Text("the robot's motion is {:.0f} times the board's: metres were "
                                "given where millimetres were meant",
                                s > 1 ? s : 1 / s),
                           "poses", "give both in millimetres");
    return input_error(Text("by the robot's motion the pitch of the board is {:.2f} mm, not {:.2f} mm",
                            s * pitch_mm, pitch_mm),
                       "pitch_mm", "measure the board");
}

// Those that hand-eye used, and those that fit its answer as these do: beside a wrong one a good one looks wrong at first.
std::vector<bool> fitting(const HandEyeResult& start, const std::vector<Pose>& a,
                          const std::vector<Pose>& b) {
    constexpr double kAsTheOthers = 3;  // times the worst of those used
    std::vector<double> mm, rad;
    std::vector<bool> fits;
    double worst_mm = 0, worst_rad = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Pose target = a[i] * start.x * b[i];
        mm.push_back(distance_mm(target, start.y));
        rad.push_back(angle_rad(target, start.y));
        fits.push_back(start.report.poses[i].used);
        if (fits.back()) {
            worst_mm = std::max(worst_mm, mm.back());
            worst_rad = std::max(worst_rad, rad.back());
        }
    }
    for (std::size_t i = 0; i < a.size(); ++i)
        if (mm[i] < kAsTheOthers * worst_mm && rad[i] < kAsTheOthers * worst_rad) fits[i] = true;
    return fits;
}

}  // namespace

// Hand-eye start; settles which way round a symmetric board was read; checks lengths against the robot's
// motion.
Expected<void> StripeCameraSolver::start_robot() {
    std::vector<std::size_t> with;
    for (std::size_t k = 0; k < count(); ++k)
        if (bundle_.base_from_flange[k]) with.push_back(k);
    if (with.size() < 3) return {};
    double turn = 0;
    for (const auto k : with)
        turn = std::max(turn, angle_rad(*bundle_.base_from_flange[k], *bundle_.base_from_flange[with[0]]));
    constexpr double kLeastTurn_deg = 2;
    if (turn < rad_from_deg(kLeastTurn_deg)) {
        robot_note_ = "the robot turned by less than 2 degrees";
        return {};
    }
    resolve_symmetry(with);
    std::vector<HandEyePair> pairs;
    std::vector<Pose> a, b;
    for (const auto k : with) {
        a.push_back(*bundle_.base_from_flange[k]);
        b.push_back(state_.camera_from_target[k]);
        pairs.push_back({data_.views[k].id, a.back(), b.back()});
    }
    SEAM_OK(check_millimetres(a, "base_from_flange"));
    auto start = calibrate_hand_eye(Mount::eye_in_hand, pairs);
    if (!start) {
        robot_note_ = start.error().what;
        return {};
    }
    if (start->reversed) {
        robot_note_ = "the robot's poses fit with their direction reversed";
        robot_cure_ = "give base_from_flange, the flange's pose in the robot's base, not its inverse";
        return {};
    }
    if (start->status != HandEyeStatus::ok) {
        robot_note_ = start->degenerate.empty() ? Text("the robot's poses do not determine it")
                                                : start->degenerate.front();
        return {};
    }
    // A wrong pose would stretch the robot's motion against the board's.
    const std::vector<bool> fits = fitting(*start, a, b);
    std::vector<Pose> fitting_a, fitting_b;
    for (std::size_t i = 0; i < with.size(); ++i)
        if (fits[i]) {
            fitting_a.push_back(a[i]);
            fitting_b.push_back(b[i]);
        }
    SEAM_OK(check_scale(fitting_a, fitting_b, start->x.linear(), spec_.pitch_mm));
    state_.flange_from_camera = start->x;
    state_.base_from_target = start->y;
    for (std::size_t i = 0; i < with.size(); ++i)
        if (!fits[i]) {
            bundle_.base_from_flange[with[i]].reset();
            result_.frames[view_frame_[with[i]]].note =
                "its robot pose contradicts the others and was left out";
        }
    return {};
}

// A half (or quarter) turn of the board changes its pose by a turn about its normal. Relative rotations
// of board and flange must have equal angles: the readings are flipped view by view until the
// disagreement is least.
void StripeCameraSolver::resolve_symmetry(const std::vector<std::size_t>& with) {
    int symmetry = 1;
    for (const auto k : with) symmetry = std::max(symmetry, observations_[view_frame_[k]].board->symmetry);
    if (symmetry == 1) return;
    const int step = symmetry == 4 ? 1 : 2;
    std::vector<int> turns(with.size(), 0);
    std::vector<std::vector<Eigen::Matrix3d>> rotation(with.size());
    for (std::size_t i = 0; i < with.size(); ++i)
        for (int t = 0; t < 4; t += step)
            rotation[i].push_back(
                state_.camera_from_target[with[i]].linear() *
                Eigen::AngleAxisd(t * kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix());
    constexpr double kMostDisagreement_rad2 = 0.25;  // a wrong pose counts no more than that
    constexpr double kBetter_rad2 = 1e-12;           // by which a reading must be better: rounding is not
    const auto angle = [](const Eigen::Matrix3d& m) { return rotation_log(m).norm(); };
    const auto pair_cost = [&](std::size_t i, std::size_t j, int ti, int tj) {
        const Eigen::Matrix3d fa = bundle_.base_from_flange[with[i]]->linear().transpose() *
                                   bundle_.base_from_flange[with[j]]->linear();
        const Eigen::Matrix3d fb =
            rotation[i][static_cast<std::size_t>(ti)] * rotation[j][static_cast<std::size_t>(tj)].transpose();
        const double d = angle(fa) - angle(fb);
        return std::min(d * d, kMostDisagreement_rad2);
    };
    // Against the first view, then sweeps of single flips.
    const int kinds = static_cast<int>(rotation[0].size());
    for (int sweep = 0; sweep < 6; ++sweep) {
        bool changed = false;
        for (std::size_t i = 1; i < with.size(); ++i) {
            int best = turns[i];
            double best_cost = std::numeric_limits<double>::infinity();
            for (int t = 0; t < kinds; ++t) {
                double c = 0;
                for (std::size_t j = 0; j < with.size(); ++j)
                    if (j != i && (sweep > 0 || j < i)) c += pair_cost(i, j, t, turns[j]);
                if (c < best_cost - kBetter_rad2) best_cost = c, best = t;
            }
            changed |= best != turns[i];
            turns[i] = best;
        }
        if (sweep > 0 && !changed) break;
    }
    for (std::size_t i = 0; i < with.size(); ++i) {
        if (!turns[i]) continue;
        const auto k = with[i];
        const auto other = turned(*observations_[view_frame_[k]].board, spec_, turns[i] * step);
        data_.views[k].object_mm = other.object_mm;
        result_.frames[view_frame_[k]].note = Text("board read {} degrees round", 90 * turns[i] * step);
        if (const auto located =
                locate_target(camera_of(state_.intrinsics, data_.width, data_.height), data_.views[k]))
            state_.camera_from_target[k] = located->camera_from_target;
    }
}

// With the plate's shape solved the residuals are small enough to tell a pitch that is 6 % wrong.
Expected<void> StripeCameraSolver::check_scale_again() const {
    if (!has_robot()) return {};
    std::vector<Pose> a, b;
    for (std::size_t k = 0; k < count(); ++k)
        if (bundle_.base_from_flange[k]) {
            a.push_back(*bundle_.base_from_flange[k]);
            b.push_back(state_.camera_from_target[k]);
        }
    return check_scale(a, b, state_.flange_from_camera->linear(), spec_.pitch_mm);
}

double StripeCameraSolver::robot_views() const {
    double n = 0;
    for (const auto& b : bundle_.base_from_flange) n += b.has_value();
    return n;
}

double StripeCameraSolver::robot_freedom() const {
    return std::max(kLeastRobotFreedom, 3 * robot_views() - 6);
}

// The robot's sigmas come from few poses: value +- 1.96 sigma of what rests on them holds 95 %. Not where they are
// stated.
double StripeCameraSolver::robot_student() const {
    return robot_as_stated_ ? 1 : student_quantile(kUpper95, robot_freedom()) / kNormal95;
}

// Stated ones where the residuals are not beyond chance against them.
void StripeCameraSolver::estimate_robot_sigmas(const PlateBundleFit& fit) {
    const double n = robot_views();
    const double left = std::sqrt(3 * n / robot_freedom());
    bundle_.robot_sigma_mm =
        std::clamp(left * fit.robot_rms_mm / std::sqrt(3.0), kBestRobot_mm, kWorstRobot_mm);
    bundle_.robot_sigma_rad = std::clamp(left * fit.robot_rms_rad / std::sqrt(3.0),
                                         rad_from_deg(kBestRobot_deg), rad_from_deg(kWorstRobot_deg));
    const RobotRepeatability& stated = options_.robot;
    // Of a residual an axis; the best that robots can be is never against what is stated.
    const auto contradicts = [&](double found, double said, double best) {
        return found > best &&
               contradicts_stated(robot_freedom() * std::pow(found / said, 2), robot_freedom());
    };
    const bool given = stated.sigma_mm > 0 && stated.sigma_rad > 0;
    result_.robot_contradicts =
        given && (contradicts(bundle_.robot_sigma_mm, stated.sigma_mm, kBestRobot_mm) ||
                  contradicts(bundle_.robot_sigma_rad, stated.sigma_rad, rad_from_deg(kBestRobot_deg)));
    robot_as_stated_ = given && !result_.robot_contradicts;
    if (robot_as_stated_) {
        bundle_.robot_sigma_mm = stated.sigma_mm;
        bundle_.robot_sigma_rad = stated.sigma_rad;
    } else {
        bundle_.robot_sigma_mm = std::max(bundle_.robot_sigma_mm, stated.sigma_mm);
        bundle_.robot_sigma_rad = std::max(bundle_.robot_sigma_rad, stated.sigma_rad);
    }
}

// What the robot's motion says of the plate's size, by each view alone under the camera found.
void StripeCameraSolver::measure_size() {
    std::vector<HandEyePair> pairs;
    for (std::size_t k = 0; k < count(); ++k) {
        if (!bundle_.base_from_flange[k]) continue;
        CameraPoints view = data_.views[k];
        for (auto& x : view.object_mm) x = state_.shape.apply(x);
        if (const auto at = locate_target(result_.camera, view))
            pairs.push_back({view.id, *bundle_.base_from_flange[k], at->camera_from_target});
    }
    const auto hand_eye = calibrate_hand_eye(Mount::eye_in_hand, pairs, {}, options_.robot);
    if (!hand_eye) return;
    result_.target_size = hand_eye->target_size;
    result_.target_size_sigma = std::hypot(hand_eye->target_size_sigma, sigma_focal_px() / focal_px());
}

}  // namespace seamwright::detail
