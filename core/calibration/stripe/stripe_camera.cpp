#include "core/calibration/stripe/stripe_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/camera/corner_noise.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose/hand_eye.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/calibration/stripe/stripe_line.h"
#include "core/calibration/stripe/stripe_plane.h"
#include "core/calibration/stripe/stripe_scale.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kOnPlaneMm = 0.5;
constexpr double kStartCorner_px = 0.3;  // sigma of the corners until the residuals tell it
// What corners and robots can be, whatever the residuals say: sigmas from .. to.
constexpr double kBestCorner_px = 0.01, kWorstCorner_px = 3.0;
constexpr double kBestRobot_mm = 0.05, kWorstRobot_mm = 5.0, kBestRobot_deg = 0.01, kWorstRobot_deg = 1;
constexpr double kLeastCornerFreedom = 10.0, kLeastRobotFreedom = 3.0;
constexpr double kStatedHolds = 0.99;    // of chi squared: residuals up to it are chance
constexpr double kLeastNoise_px = 0.02;  // no corners are read better

struct LadderStep {
    CameraFreedom freedom;
    ShapeFreedom shape;
};

// From simple to rich. With a free stretch of the plate the two focal lengths stay one: they are hard to tell
// apart.
const std::vector<LadderStep>& model_ladder() {
    static const std::vector<LadderStep> ladder{
        {{false, false, 1, false}, ShapeFreedom::rigid},   {{false, true, 1, false}, ShapeFreedom::rigid},
        {{true, true, 2, false}, ShapeFreedom::rigid},     {{false, false, 1, false}, ShapeFreedom::in_plane},
        {{false, true, 1, false}, ShapeFreedom::in_plane}, {{false, false, 1, false}, ShapeFreedom::bowed},
        {{false, true, 1, false}, ShapeFreedom::bowed},    {{false, true, 2, false}, ShapeFreedom::bowed},
        {{false, true, 3, true}, ShapeFreedom::bowed},
    };
    return ladder;
}

class Solver {
  public:
    Solver(const std::vector<StripeObservation>& observations, const BoardSpec& spec,
           const StripeCameraOptions& options)
        : observations_(observations), spec_(spec), options_(options) {}

    Expected<StripeCameraResult> run() {
        SEAM_OK(collect());
        SEAM_OK(start());
        choose_model();
        refine_without_stripe();
        SEAM_OK(check_scale_again());
        locate_stripes();
        refine_with_stripe();
        measure();
        judge();
        return std::move(result_);
    }

  private:
    std::size_t count() const { return data_.views.size(); }
    bool has_robot() const { return state_.flange_from_camera.has_value(); }

    Expected<void> collect() {
        std::set<std::string> ids;
        for (const auto& o : observations_) {
            if (!ids.insert(o.id).second)
                return input_error(Text("the frame id '{}' occurs twice", o.id), o.id, "name frames apart");
            if (o.width != observations_.front().width || o.height != observations_.front().height)
                return input_error(
                    Text("the images have different sizes ({}x{} and {}x{})", observations_.front().width,
                         observations_.front().height, o.width, o.height),
                    o.id, "give frames of one camera at one resolution");
        }
        for (const auto& e : options_.exclude)
            if (!ids.count(e))
                return input_error(Text("there is no frame '{}' to exclude", e), "exclude",
                                   "name a frame of the set");
        if (observations_.empty())
            return input_error("there is no frame", "images", "give at least 5 frames that show the plate");
        data_.width = observations_.front().width;
        data_.height = observations_.front().height;
        for (std::size_t i = 0; i < observations_.size(); ++i) {
            const auto& o = observations_[i];
            StripeFrameResult f;
            f.id = o.id;
            f.board_found = o.board.has_value();
            result_.boards_found += f.board_found;
            const bool excluded = std::count(options_.exclude.begin(), options_.exclude.end(), o.id) > 0;
            if (excluded)
                f.note = "excluded";
            else if (!f.board_found)
                f.note = o.miss.counted || o.miss.several ? why_missed(spec_, o.miss) : "no board found";
            else if (const int twin = same_as_earlier(*o.board); twin >= 0)
                f.note = Text("the same image as {}", observations_[static_cast<std::size_t>(twin)].id);
            else {
                view_frame_.push_back(i);
                data_.views.push_back({o.id, o.board->object_mm, o.board->pixel});
                f.used = true;
            }
            result_.frames.push_back(std::move(f));
        }
        if (result_.boards_found == 0) {
            for (const auto& o : observations_)
                if (o.miss.counted || o.miss.several)
                    return input_error(why_missed(spec_, o.miss), "board", cure_of(o.miss));
            return input_error(Text("no board of {}x{} points was found in any of {} images", spec_.columns,
                                    spec_.rows, observations_.size()),
                               "board", "check the number of inner corners, the light and the focus");
        }
        if (count() < 3)
            return input_error(
                Text("only {} different frames show the board, at least 3 are needed", count()), "images",
                "take 8 or more frames with the plate tilted in different directions");
        return {};
    }

    int same_as_earlier(const FoundBoard& board) const {
        for (const auto i : view_frame_) {
            const auto& other = *observations_[i].board;
            if (other.pixel.size() != board.pixel.size()) continue;
            double worst = 0;
            for (std::size_t k = 0; k < board.pixel.size(); ++k)
                worst = std::max(worst, (board.pixel[k] - other.pixel[k]).norm());
            if (worst < kSamePicture_px) return static_cast<int>(i);
        }
        return -1;
    }

    Expected<void> start() {
        const auto first = start_camera(data_);
        if (!first)
            return input_error("no camera explains the boards", "images",
                               "check the number of inner corners");
        state_.intrinsics = first->intrinsics;
        state_.camera_from_target = first->camera_from_target;
        state_.shape.middle_mm = {0.5 * (spec_.columns - 1) * spec_.pitch_mm,
                                  0.5 * (spec_.rows - 1) * spec_.pitch_mm};
        state_.shape.half_mm = 0.5 * (std::max(spec_.columns, spec_.rows) - 1) * spec_.pitch_mm;
        bundle_.data = &data_;
        bundle_.view_used.assign(count(), 1);
        bundle_.base_from_flange.assign(count(), std::nullopt);
        for (std::size_t k = 0; k < count(); ++k)
            bundle_.base_from_flange[k] = observations_[view_frame_[k]].base_from_flange;
        bundle_.corner_sigma_px = kStartCorner_px;
        // A model that a person names is meant as it stands.
        bundle_.hold_exactly = options_.freedom.has_value();
        return start_robot();
    }

    // Hand-eye start; settles which way round a symmetric board was read; checks lengths against the robot's
    // motion.
    Expected<void> start_robot() {
        std::vector<std::size_t> with;
        for (std::size_t k = 0; k < count(); ++k)
            if (bundle_.base_from_flange[k]) with.push_back(k);
        if (with.size() < 3) return {};
        double turn = 0;
        for (const auto k : with)
            turn =
                std::max(turn, angle_rad(*bundle_.base_from_flange[k], *bundle_.base_from_flange[with[0]]));
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
        if (start->status != HandEyeStatus::ok) {
            robot_note_ = start->degenerate.empty() ? Text("the robot's poses do not determine it")
                                                    : start->degenerate.front();
            return {};
        }
        SEAM_OK(check_scale(a, b, start->x.linear()));
        state_.flange_from_camera = start->x;
        state_.base_from_target = start->y;
        for (std::size_t i = 0; i < with.size(); ++i)
            if (!start->report.poses[i].used) {
                bundle_.base_from_flange[with[i]].reset();
                result_.frames[view_frame_[with[i]]].note =
                    "its robot pose contradicts the others and was left out";
            }
        return {};
    }

    // A half (or quarter) turn of the board changes its pose by a turn about its normal. Relative rotations
    // of board and flange must have equal angles: the readings are flipped view by view until the
    // disagreement is least.
    void resolve_symmetry(const std::vector<std::size_t>& with) {
        int symmetry = 1;
        for (const auto k : with)
            symmetry = std::max(symmetry, observations_[view_frame_[k]].board->symmetry);
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
            const Eigen::Matrix3d fb = rotation[i][static_cast<std::size_t>(ti)] *
                                       rotation[j][static_cast<std::size_t>(tj)].transpose();
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

    // (R_a - I) t_x = s R_x t_b - t_a over relative motions, with the length scale s of the board free: s far
    // from 1 means that pitch and robot do not speak of the same millimetre.
    Expected<void> check_scale(const std::vector<Pose>& a, const std::vector<Pose>& b,
                               const Eigen::Matrix3d& rx) const {
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
                                s * spec_.pitch_mm, spec_.pitch_mm),
                           "pitch_mm", "measure the board");
    }

    // With the plate's shape solved the residuals are small enough to tell a pitch that is 6 % wrong.
    Expected<void> check_scale_again() const {
        if (!has_robot()) return {};
        std::vector<Pose> a, b;
        for (std::size_t k = 0; k < count(); ++k)
            if (bundle_.base_from_flange[k]) {
                a.push_back(*bundle_.base_from_flange[k]);
                b.push_back(state_.camera_from_target[k]);
            }
        return check_scale(a, b, state_.flange_from_camera->linear());
    }

    // Mean squared corner error of each view, predicted by the others.
    std::vector<double> cross_validate(const LadderStep& model) {
        PlateBundle p = bundle_;
        p.freedom = model.freedom;
        p.shape = model.shape;
        const auto all = solve_plate_bundle(p, state_);
        std::vector<double> error(count(), std::numeric_limits<double>::infinity());
        if (!std::isfinite(all.cost)) return error;
        for (std::size_t k = 0; k < count(); ++k) {
            p.view_used.assign(count(), 1);
            p.view_used[k] = 0;
            const auto rest = solve_plate_bundle(p, all.state);
            CameraPoints view = data_.views[k];
            for (auto& x : view.object_mm) x = rest.state.shape.apply(x);
            if (const auto t =
                    locate_target(camera_of(rest.state.intrinsics, data_.width, data_.height), view))
                error[k] = t->rms_px * t->rms_px;
        }
        return error;
    }

    // The simplest model whose predictions are not worse than the best model's by more than one standard
    // error.
    void choose_model() {
        std::size_t chosen = 0;
        if (options_.freedom || options_.shape) {
            model_ = {options_.freedom.value_or(CameraFreedom{false, true, 1, false}),
                      options_.shape.value_or(ShapeFreedom::rigid)};
        } else if (count() < 5) {
            model_ = model_ladder().front();
        } else {
            const auto& ladder = model_ladder();
            std::vector<std::vector<double>> errors;
            std::vector<double> mean;
            for (const auto& m : ladder) {
                errors.push_back(cross_validate(m));
                mean.push_back(std::accumulate(errors.back().begin(), errors.back().end(), 0.0) /
                               static_cast<double>(count()));
            }
            const auto best =
                static_cast<std::size_t>(std::min_element(mean.begin(), mean.end()) - mean.begin());
            chosen = best;
            for (std::size_t m = 0; m < best; ++m) {
                if (!std::isfinite(mean[m])) continue;
                const double gap = mean[m] - mean[best];
                double variance = 0;
                for (std::size_t k = 0; k < count(); ++k) {
                    const double d = errors[m][k] - errors[best][k] - gap;
                    variance += d * d;
                }
                const double n = static_cast<double>(count());
                if (gap < std::sqrt(variance / (n * (n - 1)))) {
                    chosen = m;
                    break;
                }
            }
            model_ = ladder[chosen];
            result_.report.hold_out.folds = static_cast<int>(count());
            result_.report.hold_out.left_out = 1;
            result_.report.hold_out.rms_px = std::sqrt(mean[chosen]);
        }
        bundle_.freedom = model_.freedom;
        bundle_.shape = model_.shape;
    }

    double robot_views() const {
        double n = 0;
        for (const auto& b : bundle_.base_from_flange) n += b.has_value();
        return n;
    }
    double robot_freedom() const { return std::max(kLeastRobotFreedom, 3 * robot_views() - 6); }
    // The robot's sigmas come from few poses: value +- 1.96 sigma of what rests on them holds 95 %. Not where they are
    // stated.
    double robot_student() const {
        return robot_as_stated_ ? 1 : student_quantile(kUpper95, robot_freedom()) / kNormal95;
    }

    // Sigmas from the residuals, within what robots and corners can be.
    void estimate_sigmas(const PlateBundleFit& fit) {
        const double free = 2.0 * static_cast<double>(fit.corners) - 6.0 * static_cast<double>(count()) -
                            static_cast<double>(fit.normal.gg.rows());
        bundle_.corner_sigma_px = std::clamp(std::sqrt(fit.corner_cost / std::max(free, kLeastCornerFreedom)),
                                             kBestCorner_px, kWorstCorner_px);
        if (!has_robot()) return;
        const double n = robot_views();
        const double left = std::sqrt(3 * n / robot_freedom());
        bundle_.robot_sigma_mm =
            std::clamp(left * fit.robot_rms_mm / std::sqrt(3.0), kBestRobot_mm, kWorstRobot_mm);
        bundle_.robot_sigma_rad = std::clamp(left * fit.robot_rms_rad / std::sqrt(3.0),
                                             rad_from_deg(kBestRobot_deg), rad_from_deg(kWorstRobot_deg));
        const RobotRepeatability& stated = options_.robot;
        const double chance =
            std::sqrt(chi_squared_quantile(kStatedHolds, robot_freedom()) / robot_freedom());
        robot_as_stated_ =
            stated.sigma_mm > 0 && stated.sigma_rad > 0 &&
            bundle_.robot_sigma_mm <= std::max(chance * stated.sigma_mm, kBestRobot_mm) &&
            bundle_.robot_sigma_rad <= std::max(chance * stated.sigma_rad, rad_from_deg(kBestRobot_deg));
        if (robot_as_stated_) {
            bundle_.robot_sigma_mm = stated.sigma_mm;
            bundle_.robot_sigma_rad = stated.sigma_rad;
        } else {
            bundle_.robot_sigma_mm = std::max(bundle_.robot_sigma_mm, stated.sigma_mm);
            bundle_.robot_sigma_rad = std::max(bundle_.robot_sigma_rad, stated.sigma_rad);
        }
    }

    void refine_without_stripe() {
        for (int i = 0; i < 4; ++i) {
            fit_ = solve_plate_bundle(bundle_, state_);
            state_ = fit_.state;
            estimate_sigmas(fit_);
        }
    }

    // Stripes of the plate: on every frame the line that agrees with the plane of the others, else the
    // longest one.
    void locate_stripes() {
        const CameraModel camera = camera_of(state_.intrinsics, data_.width, data_.height);
        const double f = 0.5 * (camera.fx + camera.fy);
        // Of the straight line that a stripe's points lie on; points of a second line that takes the first one's place.
        constexpr double kStripeWithin_px = 6;
        constexpr std::size_t kFewestOnOther = 100;
        lines_.assign(count(), {});
        for (std::size_t k = 0; k < count(); ++k) {
            const auto& o = observations_[view_frame_[k]];
            std::vector<Eigen::Vector2d> straight;
            std::vector<int> line;
            for (const auto& p : o.stripe) {
                straight.push_back(f * camera.undistort(p));
                line.push_back(static_cast<int>(std::lround(o.scan == ScanLines::rows ? p.y() : p.x())));
            }
            lines_[k] = detail::stripe_lines(straight, line, kStripeWithin_px, 2);
        }
        choice_.assign(count(), 0);
        detail::StripePoints points(count());
        for (std::size_t k = 0; k < count(); ++k) points[k] = points_of(k, 0, true);
        auto consensus = detail::consensus_plane(points, kOnPlaneMm);
        if (!consensus) return;
        for (std::size_t k = 0; k < count(); ++k)
            if (!consensus->frames[k] && lines_[k].size() > 1) {
                const auto other = points_of(k, 1, true);
                if (lines_[k][1].on.size() > kFewestOnOther &&
                    detail::median_off_plane(consensus->plane, other) < kOnPlaneMm) {
                    choice_[k] = 1;
                    points[k] = other;
                }
            }
    }

    std::vector<Eigen::Vector3d> points_of(std::size_t k, std::size_t choice, bool on_bow) const {
        std::vector<Eigen::Vector3d> out;
        if (choice >= lines_[k].size()) return out;
        const CameraModel camera = camera_of(state_.intrinsics, data_.width, data_.height);
        for (const auto i : lines_[k][choice].on)
            if (const auto p = meet_plate(camera, observations_[view_frame_[k]].stripe[i],
                                          state_.camera_from_target[k], state_.shape, on_bow))
                out.push_back(*p);
        return out;
    }

    // Joint solution with the stripes, on the bowed surface and on its tangent plane; the better one stays.
    void refine_with_stripe() {
        bundle_.stripe.assign(count(), {});
        for (std::size_t k = 0; k < count(); ++k)
            if (choice_[k] < lines_[k].size()) {
                const auto& on = lines_[k][choice_[k]].on;
                const std::size_t step = std::max<std::size_t>(1, on.size() / 40);
                for (std::size_t i = step / 2; i < on.size(); i += step)
                    bundle_.stripe[k].push_back(observations_[view_frame_[k]].stripe[on[i]]);
            }
        const PlateBundleState before = state_;
        std::optional<PlateBundleFit> best;
        for (const bool on_bow : {false, true}) {
            if (on_bow && model_.shape != ShapeFreedom::bowed) continue;
            state_ = before;
            bundle_.stripe_on_bow = on_bow;
            std::optional<PlateBundleFit> fit;
            std::vector<char> last;
            for (int round = 0; round < 4; ++round) {
                detail::StripePoints points(count());
                for (std::size_t k = 0; k < count(); ++k) points[k] = points_of(k, choice_[k], on_bow);
                const auto consensus = detail::consensus_plane(points, kOnPlaneMm);
                if (!consensus) break;
                if (round > 0 && consensus->frames == last) break;
                last = consensus->frames;
                if (std::count(last.begin(), last.end(), 1) < 2) break;
                state_.plane = consensus->plane;
                bundle_.stripe_used = last;
                fit = solve_plate_bundle(bundle_, state_);
                state_ = fit->state;
            }
            if (!fit) continue;
            const auto frames = std::count(bundle_.stripe_used.begin(), bundle_.stripe_used.end(), 1);
            const auto best_frames = best ? std::count(best_used_.begin(), best_used_.end(), 1) : 0;
            if (!best || frames > best_frames || (frames == best_frames && fit->cost < best->cost)) {
                best = fit;
                best_used_ = bundle_.stripe_used;
                best_on_bow_ = on_bow;
            }
        }
        state_ = before;
        if (!best) return;
        fit_ = *best;
        state_ = fit_.state;
        bundle_.stripe_used = best_used_;
        bundle_.stripe_on_bow = best_on_bow_;
        if (state_.plane->normal.z() < 0) {
            state_.plane->normal = -state_.plane->normal;
            state_.plane->offset_mm = -state_.plane->offset_mm;
        }
    }

    void measure() {
        result_.camera = camera_of(state_.intrinsics, data_.width, data_.height);
        result_.freedom = model_.freedom;
        result_.shape_freedom = model_.shape;
        result_.shape = state_.shape;
        result_.rms_px = fit_.corner_rms_px;
        result_.sigma_px = bundle_.corner_sigma_px;
        result_.flange_from_camera = state_.flange_from_camera;
        result_.base_from_target = state_.base_from_target;
        result_.plane = state_.plane;
        std::vector<Eigen::Vector3d> origins;
        std::vector<std::size_t> robot_frames;
        int rows = 0, on = 0, rows_all = 0, on_all = 0;
        double square = 0;
        std::size_t points_used = 0;
        for (std::size_t k = 0; k < count(); ++k) {
            auto& f = result_.frames[view_frame_[k]];
            f.camera_from_target = state_.camera_from_target[k];
            CameraPoints bent = data_.views[k];
            for (auto& x : bent.object_mm) x = state_.shape.apply(x);
            f.corner_rms_px = std::sqrt(squares_px2(state_.intrinsics, f.camera_from_target, bent) /
                                        static_cast<double>(bent.pixel.size()));
            if (const auto& at = observations_[view_frame_[k]].base_from_flange; has_robot() && at) {
                const Pose target = *at * *state_.flange_from_camera * f.camera_from_target;
                f.robot_used = bundle_.base_from_flange[k].has_value();
                f.robot_mm = distance_mm(target, *state_.base_from_target);
                f.robot_deg = deg_from_rad(angle_rad(target, *state_.base_from_target));
                if (f.robot_used) origins.push_back(target.translation());
            }
            if (!state_.plane || choice_[k] >= lines_[k].size()) continue;
            const auto& line = lines_[k][choice_[k]];
            f.stripe_used = bundle_.stripe_used[k];
            f.rows_on_board = static_cast<int>(line.on.size()) + line.missed;
            for (const auto i : line.on) {
                const auto& pixel = observations_[view_frame_[k]].stripe[i];
                const auto met = meet_plate(result_.camera, pixel, f.camera_from_target, state_.shape,
                                            bundle_.stripe_on_bow);
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
        if (state_.plane) {
            result_.plane_distance_mm = std::abs(state_.plane->offset_mm);
            result_.camera_from_laser = sensor_frame(*state_.plane);
            if (fit_.covariance.size()) {
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
        }
        if (!origins.empty()) {
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
    }

    // y = normal of the laser plane, z in the plane towards the camera, origin where the optical axis meets
    // the plane (or the plane's point nearest to the camera when the axis runs along it).
    static Pose sensor_frame(const LaserPlane& plane) {
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

    void judge() {
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
            for (Eigen::Index i = hand_eye_rows.first; i < hand_eye_rows.second; ++i)
                times(i) = robot_student();
            report.covariance =
                times.asDiagonal() * select * fit_.covariance * select.transpose() * times.asDiagonal();
            finish_statistics(report);
        }
        for (const auto& f : result_.frames) {
            PoseResidual p;
            p.id = f.id;
            p.used = f.used;
            p.note = f.note;
            if (f.used) p.rms_px = f.corner_rms_px;
            if (f.robot_used || f.robot_mm > 0) p.rms_mm = f.robot_mm, p.deg = f.robot_deg;
            p.contradicts = f.used && !f.robot_used && f.robot_mm > 0;
            report.poses.push_back(std::move(p));
        }
        report.judgement = verdict();
    }

    Judgement verdict() const {
        constexpr double kUsableFocal = 0.01;  // sigma of the focal length over itself, beyond
        constexpr double kOpenPlane_deg = 2;   // sigma, beyond
        constexpr double kPoorShare = 0.8, kUsableShare = 0.95;  // of the stripe rows on the plane, below
        constexpr double kPoorMisfit = 5, kUsableMisfit = 3;     // times the corners' own noise, beyond
        constexpr double kPoorSpread_mm = 3;  // of the plate's origin in the robot's base, beyond
        const double f = 0.5 * (result_.camera.fx + result_.camera.fy);
        const double sigma_f = fit_.covariance.size() ? result_.report.parameters[0].sigma
                                                      : std::numeric_limits<double>::infinity();
        const auto stripes = std::count_if(result_.frames.begin(), result_.frames.end(),
                                           [](const auto& x) { return x.stripe_used; });
        std::string off;
        for (const auto& x : result_.frames)
            if (x.used && !x.stripe_used && !x.stripe.empty()) off += (off.empty() ? "" : ", ") + x.id;
        if (!fit_.covariance.size() || sigma_f > kOpenFocal * f)
            return {
                Verdict::undetermined,
                Text("the frames do not determine the focal length (sigma {:.0f} of {:.0f} px)", sigma_f, f),
                "tilt the plate by 20 to 40 degrees in several directions"};
        if (!result_.plane)
            return {Verdict::undetermined, "fewer than two frames show a stripe on the plate",
                    "place the plate so that the stripe crosses it in every frame"};
        if (stripes < 3 || result_.plane_sigma_deg > kOpenPlane_deg)
            return {Verdict::undetermined,
                    Text("the stripes of {} frames do not fix the laser plane (sigma {:.1f} degrees)",
                         stripes, result_.plane_sigma_deg),
                    "add frames with the plate nearer, farther and tilted"};
        if (result_.on_plane_share < kPoorShare || result_.rms_px > kPoorCorners_px)
            return {Verdict::poor,
                    Text("only {:.0f} % of the stripe rows lie within 0.5 mm of one plane, corners "
                         "fit to {:.2f} px",
                         100 * result_.on_plane_share, result_.rms_px),
                    "check focus, that plate, laser and camera are held firmly, and the board's size"};
        // Beyond what corners are read to, the model does not explain them.
        const double noise = std::max(detail::corner_noise_px(data_.views), kLeastNoise_px);
        const double misfit = result_.sigma_px / noise;
        const auto misfits = [&] {
            return Text("the corners fit to {:.2f} px, {:.0f} times as far off as they are read",
                        result_.rms_px, misfit);
        };
        if (misfit > kPoorMisfit)
            return {Verdict::poor, misfits(), "check that the plate is flat and firm, and the lens in focus"};
        const auto with_stripe = std::count_if(result_.frames.begin(), result_.frames.end(),
                                               [](const auto& x) { return x.used && !x.stripe.empty(); });
        if (2 * stripes <= with_stripe)
            return {Verdict::poor,
                    Text("the stripes of {} of {} frames contradict the plane of the others ({})",
                         with_stripe - stripes, with_stripe, off),
                    "hold laser and camera firmly together and take all frames again"};
        if (result_.flange_from_camera && result_.target_spread_mm > kPoorSpread_mm)
            return {
                Verdict::poor,
                Text("the plate's origin spreads by {:.1f} mm in the robot's base", result_.target_spread_mm),
                "check that poses and images belong together and that the plate did not move"};
        if (!off.empty())
            return {Verdict::usable,
                    Text("the stripe of {} lies off the plane that the other {} frames share", off, stripes),
                    "check that laser and camera sit firmly, and take these frames again"};
        if (misfit > kUsableMisfit)
            return {Verdict::usable, misfits(),
                    "check that the plate is flat and firm, and the lens in focus"};
        if (sigma_f > kUsableFocal * f)
            return {Verdict::usable, Text("the focal length is known to {:.1f} % only", 100 * sigma_f / f),
                    "add frames with the plate tilted by 20 to 40 degrees"};
        if (result_.on_plane_share < kUsableShare)
            return {Verdict::usable,
                    Text("{:.0f} % of the stripe rows lie within 0.5 mm of one plane",
                         100 * result_.on_plane_share),
                    "use a flatter plate or less exposure"};
        if (!result_.flange_from_camera && !robot_note_.empty())
            return {Verdict::usable, Text("no hand-eye: {}", robot_note_),
                    "turn the robot about two axes by 20 degrees or more"};
        Text reason("{} frames, corners {:.2f} px, {:.1f} % of the stripe on one plane", count(),
                    result_.rms_px, 100 * result_.on_plane_share);
        if (model_.shape != ShapeFreedom::rigid)
            reason =
                Text("{}; the plate is stretched by {:.2f} % and sheared by {:.2f} %, which was solved for",
                     reason, 100 * state_.shape.stretch, 100 * state_.shape.shear);
        return {Verdict::good, reason, ""};
    }

    const std::vector<StripeObservation>& observations_;
    const BoardSpec& spec_;
    const StripeCameraOptions& options_;
    StripeCameraResult result_;
    CameraData data_;
    std::vector<std::size_t> view_frame_;  // frame of each view
    PlateBundle bundle_;
    PlateBundleState state_;
    PlateBundleFit fit_;
    LadderStep model_;
    std::vector<std::vector<detail::PlateStripe>> lines_;  // per view
    std::vector<std::size_t> choice_;
    std::vector<char> best_used_;
    bool best_on_bow_ = false;
    Text robot_note_;
    bool robot_as_stated_ = false;
};

}  // namespace

Expected<StripeCameraResult> calibrate_stripe_camera(const std::vector<StripeObservation>& observations,
                                                     const BoardSpec& spec,
                                                     const StripeCameraOptions& options) {
    SEAM_OK(validate(spec));
    return Solver(observations, spec, options).run();
}

}  // namespace seamwright
