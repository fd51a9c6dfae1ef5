#include "core/calibration/nozzle/nozzle.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/calibration/nozzle/next_touch.h"
#include "core/calibration/nozzle/place_doubt.h"
#include "core/calibration/nozzle/radius_doubt.h"
#include "core/calibration/nozzle/wrong_touches.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace nozzle;

constexpr double kGoodTip_mm = 0.3, kUsableTip_mm = 1.0;  // three sigma along the worst direction
constexpr double kLeastFreedom = 3;                       // below, little checks the touches
constexpr double kFarthest_mm = 1e5;
constexpr double kMostPlaceVariance_mm2 = 1e6;
constexpr double kCovarianceSlack_mm2 = 1e-9;                         // besides kCovarianceSlack
constexpr double kSmallestSphere_mm = 0.1, kLargestSphere_mm = 1000;  // radius
constexpr double kSmallestSigma_mm = 1e-4, kLargestSigma_mm = 10;     // of a touch
constexpr double kDeviationTold = 0.99;  // of chi squared: the programmed tip is another one

Expected<void> check_target(const NozzleTarget& target, const NozzleOptions& options) {
    if (!target.place_mm.allFinite() || target.place_mm.cwiseAbs().maxCoeff() > kFarthest_mm)
        return input_error("the target's place is not a finite place within 100 m", "target",
                           "give [x, y, z] in millimetres in the robot's base");
    const Eigen::Matrix3d& s = target.covariance_mm2;
    const bool finite = s.allFinite() && s.cwiseAbs().maxCoeff() < kMostPlaceVariance_mm2;
    const bool symmetric = finite && (s - s.transpose()).cwiseAbs().maxCoeff() <=
                                         kCovarianceSlack_mm2 + kCovarianceSlack * s.norm();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        finite ? s : Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::EigenvaluesOnly);
    if (!symmetric ||
        eigen.eigenvalues()[0] < -kCovarianceSlack_mm2 - kCovarianceSlack * eigen.eigenvalues()[2])
        return input_error(
            "the covariance of the target's place is none (not symmetric, or a negative variance)", "target",
            "give it in square millimetres as the sensor's measurement states it");
    if (target.radius_mm &&
        !(*target.radius_mm >= kSmallestSphere_mm && *target.radius_mm <= kLargestSphere_mm))
        return input_error("the sphere's radius is not between 0.1 and 1000 mm", "target",
                           "give it in millimetres as its certificate says");
    if (target.radius_sigma_mm && !(*target.radius_sigma_mm >= 0 && *target.radius_sigma_mm < 100))
        return input_error("the sigma of the radius is no sigma", "target",
                           "give it in millimetres, 0 or more");
    if (!(options.tip_radius_mm >= 0 && options.tip_radius_mm < 100))
        return input_error("the radius of the tip's ball is not between 0 and 100 mm", "tip_radius_mm",
                           "give it in millimetres, 0 for a sharp tip");
    if (options.tip_radius_mm > 0 && !target.radius_mm)
        return input_error("a ball at the tip does not come onto a point", "tip_radius_mm",
                           "touch a sphere with it, or use a sharp tip");
    return {};
}

Expected<void> check_noise(const NozzleOptions& options) {
    if (options.sigma_mm &&
        !(*options.sigma_mm >= kSmallestSigma_mm && *options.sigma_mm <= kLargestSigma_mm))
        return input_error("the sigma of a touch is not between 0.0001 and 10 mm", "sigma_mm",
                           "give it in millimetres, or leave it out: the scatter tells it");
    SEAM_OK(check_repeatability(options.robot));
    if (options.programmed) SEAM_OK(check_rigid({*options.programmed}, {"tool"}, "programmed"));
    return {};
}

// Marks who takes part: not the excluded, and of equal poses the first.
Expected<std::vector<std::size_t>> chosen(const std::vector<NozzleTouch>& touches,
                                          const NozzleOptions& options, CalibrationReport& report) {
    std::vector<std::string> ids;
    std::vector<Pose> poses;
    for (const NozzleTouch& t : touches) {
        ids.push_back(t.id);
        poses.push_back(t.base_from_flange);
    }
    SEAM_OK(check_ids(ids, options.exclude, "touches"));
    SEAM_OK(check_rigid(poses, ids, "base_from_flange of"));
    SEAM_OK(check_millimetres(poses, "touches"));
    for (std::size_t i = 0; i < poses.size(); ++i)
        if (poses[i].translation().cwiseAbs().maxCoeff() > kFarthest_mm)
            return input_error("the flange is more than 100 m from the robot's base",
                               Text("touch '{}'", ids[i]), "give millimetres");
    std::vector<std::size_t> used;
    std::vector<Pose> before;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < touches.size(); ++i) {
        PoseResidual& p = report.poses.emplace_back();
        p.id = ids[i];
        if (std::find(options.exclude.begin(), options.exclude.end(), ids[i]) != options.exclude.end()) {
            p.used = false;
            p.excluded = true;
            p.note = "excluded by the user";
            continue;
        }
        before.push_back(poses[i]);
        names.push_back(ids[i]);
        const int same = first_equal_pose(before).back();
        if (same + 1 < static_cast<int>(before.size())) {
            p.used = false;
            p.note = Text("the same pose as '{}'", names[static_cast<std::size_t>(same)]);
            continue;
        }
        used.push_back(i);
    }
    return used;
}

TouchSet set_of(const std::vector<NozzleTouch>& touches, const std::vector<std::size_t>& used,
                const NozzleTarget& target, const NozzleOptions& options) {
    TouchSet set;
    for (const std::size_t i : used) set.poses.push_back(touches[i].base_from_flange);
    set.sphere = target.radius_mm.has_value();
    set.place_mm = target.place_mm;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(target.covariance_mm2);
    set.half = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
    set.rho_mm = target.radius_mm.value_or(0) + options.tip_radius_mm;
    set.spread_mm = set.sphere ? target.radius_sigma_mm.value_or(kUnstatedRadius * set.rho_mm) : 0;
    set.spread_stated = target.radius_sigma_mm.has_value();
    set.robot_mm = options.robot.sigma_mm;
    set.robot_rad = options.robot.sigma_rad;
    set.sigma_mm = options.sigma_mm;
    if (options.programmed) set.near = options.programmed->translation();
    return set;
}

void put_residuals(const std::vector<NozzleTouch>& touches, const WrongTouches& found, NozzleResult& result) {
    const auto of = [&](std::size_t i) {
        return residual(found.set, touches[i].base_from_flange, found.fit.state).norm();
    };
    double sum = 0;
    for (std::size_t i = 0; i < touches.size(); ++i) result.report.poses[i].rms_mm = of(i);
    for (const std::size_t i : found.kept) sum += of(i) * of(i);
    result.rms_mm = std::sqrt(sum / static_cast<double>(found.kept.size()));
}

// Each touch against the tip of the others.
HoldOut hold_out(const WrongTouches& found) {
    HoldOut out;
    double sum = 0, largest = 0;
    for (std::size_t i = 0; i < found.set.poses.size(); ++i) {
        const TouchFit rest = fit_touches(found.set.without(i), found.fit.variance);
        if (!rest.solved || !rest.determined() || rest.other) continue;
        const double miss = residual(found.set, found.set.poses[i], rest.state).norm();
        sum += miss * miss;
        largest = std::max(largest, miss);
        ++out.folds;
    }
    if (out.folds == 0) return out;
    out.left_out = 1;
    out.rms_mm = std::sqrt(sum / out.folds);
    out.max_mm = largest;
    return out;
}

void state_tip(const TouchSet& set, const TouchFit& fit, const NozzleOptions& options, NozzleResult& result) {
    const double student =
        fit.estimated ? student_quantile(kUpper95, std::max(1.0, fit.freedom)) / kNormal95 : 1;
    const Eigen::Vector3d tip = fit.state.head<3>();
    const Eigen::Matrix3d turn = options.programmed ? Eigen::Matrix3d(options.programmed->linear())
                                                    : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    result.flange_from_nozzle = make_pose(turn, tip);
    result.covariance_random = student * student * fit.random;
    result.covariance_systematic = fit.systematic;
    result.covariance = result.covariance_random + result.covariance_systematic;
    result.sigma_mm = std::sqrt(fit.variance);
    result.freedom = fit.freedom;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(result.covariance, Eigen::EigenvaluesOnly);
    result.worst_sigma_mm = std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
    constexpr const char* kNames = "xyz";
    for (int i = 0; i < 3; ++i)
        result.report.parameters.push_back({std::string(1, kNames[i]), tip[i], "mm", 0});
    state_covariance(result.report, result.covariance);
    if (options.programmed) {
        NozzleDeviation d;
        d.mm = tip - options.programmed->translation();
        d.chi_squared = d.mm.dot(result.covariance.ldlt().solve(d.mm));
        d.limit = chi_squared_quantile(kDeviationTold, 3);
        d.beyond_chance = !(d.chi_squared <= d.limit);
        result.deviation = d;
    }
    if (set.sphere && orientation_spread(set.poses).spread_rad[0] < rad_from_deg(kNoSpread_deg))
        result.notices.emplace_back(
            "every touch has the same orientation of the flange: an error of the sphere's place goes into "
            "the "
            "tip whole; turn the flange between touches");
}

Text names_of(const std::vector<std::size_t>& list, const std::vector<NozzleTouch>& touches) {
    std::vector<Text> names;
    for (const std::size_t i : list) names.emplace_back(touches[i].id);
    Text all;
    for (const Text& name : names) all = joined(all, ", ", name);
    return all;
}

// Where touches were left out, leaving them out would explain it as well.
Judgement of_other_place(const OtherPlace& place, const std::vector<NozzleTouch>& touches,
                         const WrongTouches& found) {
    const Eigen::Vector3d& off = place.off_mm;
    const Text where(
        "by the touches the target stands {:.2f} mm from its given place, by {:.2f}, {:.2f}, {:.2f} mm in X, "
        "Y, "
        "Z of the base, more than its sigma allows",
        off.norm(), off.x(), off.y(), off.z());
    const Text again = "measure the target's place again and touch it where it stands then";
    if (found.wrong.empty()) return {Verdict::poor, where, again};
    const Text names = names_of(found.wrong, touches);
    return {Verdict::poor, joined(where, "; ", Text("or these touches slipped: {}", names)),
            joined(again, "; ", Text("or repeat {}", names))};
}

void judge(const std::vector<NozzleTouch>& touches, const WrongTouches& found,
           const std::optional<OtherPlace>& place, NozzleResult& result) {
    const TouchFit& fit = found.fit;
    const double three = 3 * result.worst_sigma_mm;
    const bool contradict = !fit.estimated && contradicts_stated(fit.misfit, fit.freedom);
    const Text figures("three sigma of the tip {:.3f} mm, the touches scatter by {:.3f} mm", three,
                       result.rms_mm);
    const Text next = next_touch(found.set, fit);
    const auto radius = other_radius(found.set, fit);
    Judgement& j = result.report.judgement;
    if (place && !(radius && place->radius_as_well))
        j = of_other_place(*place, touches, found);
    else if (!found.either.empty())
        j = {Verdict::poor,
             Text("one of the touches {} slipped, and nothing tells which", names_of(found.either, touches)),
             joined("repeat them", "; ", next)};
    else if (radius)
        j = {Verdict::poor,
             Text("by the touches the sphere's radius and that of the tip's ball are {:.2f} mm together, not "
                  "{:.2f} mm",
                  *radius, found.set.rho_mm),
             "check the sphere's radius, and state the ball of a measuring pin as tip_radius_mm"};
    else if (contradict)
        j = {
            Verdict::poor,
            Text("the touches scatter by {:.3f} mm, more than their sigma of {:.3f} mm allows", result.rms_mm,
                 result.sigma_mm),
            "check that the target has not moved and the tip is tight, or state the sigma that a hand keeps"};
    else if (three > kUsableTip_mm || result.sigma_mm > kUsableTip_mm)
        j = {Verdict::poor, figures, next};
    else if (three > kGoodTip_mm || fit.freedom < kLeastFreedom)
        j = {Verdict::usable,
             fit.freedom < kLeastFreedom ? Text("few touches leave little to check with; {}", figures)
                                         : figures,
             next};
    else
        j = {Verdict::good, figures, ""};
    if (j.verdict != Verdict::good) result.advice = {next};
}

void say_undetermined(const WrongTouches& found, bool unsure, NozzleResult& result) {
    result.open = unsure ? std::vector<Text>{"how surely the tip was brought to the target"}
                         : open_directions(found.fit);
    Text open;
    for (const Text& one : result.open) open = joined(open, ", ", one);
    const Text next = next_touch(found.set, found.fit);
    result.advice = {next};
    result.report.judgement = {Verdict::undetermined,
                               Text("{} touches leave open: {}", found.kept.size(), open),
                               unsure ? joined("state sigma_mm of a touch", "; ", next) : next};
}

}  // namespace

std::string_view name_of(NozzleStatus status) {
    return status == NozzleStatus::ok ? "ok" : "undetermined";
}

Expected<NozzleResult> calibrate_nozzle(const std::vector<NozzleTouch>& touches, const NozzleTarget& target,
                                        const NozzleOptions& options) {
    NozzleResult result;
    if (touches.empty())
        return input_error("there is no touch", "touches", "touch the target at four or more places");
    SEAM_OK(check_target(target, options));
    SEAM_OK(check_noise(options));
    SEAM_TRY(const auto used, chosen(touches, options, result.report));
    if (used.empty()) return input_error("every touch is excluded", "touches", "keep four or more");
    const TouchSet whole = set_of(touches, used, target, options);
    WrongTouches found = without_wrong_touches(whole, options.thorough ? used.size() / 4 : 0);
    for (auto* list : {&found.kept, &found.wrong, &found.either})
        for (std::size_t& i : *list) i = used[i];
    if (!found.fit.solved || !found.fit.determined() || found.fit.other) {
        say_undetermined(found, false, result);
        return result;
    }
    if (!options.sigma_mm && !found.fit.estimated) {
        say_undetermined(found, true, result);
        return result;
    }
    result.status = NozzleStatus::ok;
    state_tip(found.set, found.fit, options, result);
    put_residuals(touches, found, result);
    const auto place = options.thorough ? other_place(whole, found) : std::nullopt;
    for (const std::size_t i : found.wrong) {
        PoseResidual& p = result.report.poses[i];
        p.used = false;
        p.note = place ? Text(
                             "contradicts the other touches by {:.2f} mm, or the target stands "
                             "elsewhere",
                             p.rms_mm)
                       : Text("slipped: contradicts the other touches by {:.2f} mm", p.rms_mm);
    }
    if (!found.wrong.empty())
        result.notices.push_back(
            Text("not used, contradicting the others: {}", left_out(result.report.poses)));
    for (const std::size_t i : found.either) {
        result.report.poses[i].contradicts = true;
        result.report.poses[i].note = "this or another one slipped";
    }
    if (options.thorough) result.report.hold_out = hold_out(found);
    judge(touches, found, place, result);
    return result;
}

}  // namespace seamwright
