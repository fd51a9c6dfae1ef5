#include "core/calibration/pose/hand_eye.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/calibration/pose/hand_eye/hand_eye_judge.h"
#include "core/calibration/pose/hand_eye/hand_eye_noise.h"
#include "core/calibration/pose/hand_eye/hand_eye_solve.h"
#include "core/calibration/pose/hand_eye/hand_eye_start.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace hand_eye;

using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr double kUndetermined_mm = 20.0, kUndetermined_rad = 0.05;
constexpr double kShortestLever_mm = 50.0;  // that angles are weighed by in a start
// A start is looked for in subsets where some pair is off by so many times the middle one, and more than rounding.
constexpr double kGrossTimes = 3, kRounding_mm = 1e-9;
constexpr double kWrongTold = 0.9999;  // of chi squared: a pair beyond contradicts the others
// Pairs beyond any doubt: their square in robust sigmas, and either distance from the others.
constexpr double kNoDoubt = 400, kNoDoubt_mm = 0.1, kNoDoubt_rad = 1e-3;
constexpr std::array kRobustScales{100.0, 30.0, 30.0};  // Geman and McClure, one after the other
constexpr double kCopy_mm = 1e-6, kCopy_rad = 1e-9;     // pairs nearer to each other than that are copies
constexpr double kSizeAsked_mm = 30;  // rms beyond which no wrong size of the target is the cause
constexpr std::size_t kFewestForSize = 4, kFewestBesideRobot = 3;  // stands; where the robot is stated
constexpr double kSizeKnown =
    0.01;  // one sigma of a target's size before the pairs, where they are too few to test it
constexpr double kSizeSettled = 1e-5;
constexpr double kOtherMountFits = 0.2;  // of the rms: what the other mount must fit better than

// Sum of absolute residuals with angles on the lever of the camera's distance: one number for all closed
// forms.
double absolute_cost(const Chain& chain, const Pose& x, const Pose& y, double lever) {
    double sum = 0;
    for (size_t i = 0; i < chain.size(); ++i)
        if (chain.used[i])
            sum +=
                std::hypot(residual_mm(chain, i, x, y).norm(), lever * residual_rad(chain, i, x, y).norm());
    return sum;
}

Chain subset(const Chain& chain, const std::vector<size_t>& pick) {
    Chain part;
    for (const size_t i : pick) {
        part.a.push_back(chain.a[i]);
        part.c.push_back(chain.c[i]);
        part.used.push_back(true);
    }
    return part;
}

struct Began {
    Closed closed;
    double cost = kInfinity;
};

Began best_start(const Chain& chain) {
    std::vector<size_t> used;
    double lever = 0;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        used.push_back(i);
        lever += chain.c[i].translation().norm();
    }
    lever = std::max(kShortestLever_mm, lever / static_cast<double>(used.size()));
    Began best;
    const auto consider = [&](const std::vector<size_t>& pick) {
        const Chain part = subset(chain, pick);
        for (const auto& closed : closed_forms(part.a, part.c)) {
            const double cost = absolute_cost(chain, closed.x, closed.y, lever);
            if (cost < best.cost) best = {closed, cost};
        }
    };
    consider(used);
    // Subsets pay when some pair is grossly wrong: a mean residual that the median does not know.
    const size_t few = 4;
    if (used.size() <= few) return best;
    std::vector<double> each;
    for (const size_t i : used)
        each.push_back(std::hypot(residual_mm(chain, i, best.closed.x, best.closed.y).norm(),
                                  lever * residual_rad(chain, i, best.closed.x, best.closed.y).norm()));
    const double middle = median(each);
    if (*std::max_element(each.begin(), each.end()) < kGrossTimes * middle + kRounding_mm) return best;
    std::mt19937 random(11u);
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<size_t> pick = used;
        for (size_t k = 0; k < few; ++k) std::swap(pick[k], pick[k + random() % (pick.size() - k)]);
        pick.resize(few);
        consider(pick);
    }
    return best;
}

std::vector<Text> degenerate_words(const std::vector<Pose>& base_from_flange) {
    const auto spread = orientation_spread(base_from_flange);
    if (spread.spread_rad[0] < rad_from_deg(kNoSpread_deg))
        return {
            "all poses share one orientation: rotate the flange about two of its axes by 20 degrees or more"};
    if (spread.spread_rad[1] < rad_from_deg(kNoSpread_deg))
        return {Text(
            "the poses turn about the flange's {} axis only: rotate about another axis by 20 degrees or more",
            axis_name(spread.axes.col(0)))};
    return {};
}

Expected<void> check_input(const std::vector<HandEyePair>& pairs, const std::vector<std::string>& exclude,
                           std::vector<bool>& used) {
    std::vector<std::string> ids;
    std::vector<Pose> robot, camera, kept;
    for (const auto& pair : pairs) {
        ids.push_back(pair.id);
        robot.push_back(pair.base_from_flange);
        camera.push_back(pair.camera_from_target);
    }
    SEAM_OK(check_ids(ids, exclude, "pairs"));
    SEAM_OK(check_rigid(robot, ids, "base_from_flange of"));
    SEAM_OK(check_rigid(camera, ids, "camera_from_target of"));
    SEAM_OK(check_millimetres(robot, "base_from_flange of the pairs"));
    SEAM_OK(check_millimetres(camera, "camera_from_target of the pairs"));
    used.assign(pairs.size(), true);
    for (size_t i = 0; i < pairs.size(); ++i) {
        if (std::find(exclude.begin(), exclude.end(), ids[i]) != exclude.end())
            used[i] = false;
        else
            kept.push_back(robot[i]);
    }
    for (size_t i = 0; i < pairs.size(); ++i)
        for (size_t k = 0; k < i; ++k)
            if (used[i] && used[k] && distance_mm(robot[i], robot[k]) < kCopy_mm &&
                angle_rad(robot[i], robot[k]) < kCopy_rad && distance_mm(camera[i], camera[k]) < kCopy_mm &&
                angle_rad(camera[i], camera[k]) < kCopy_rad)
                return input_error(Text("'{}' and '{}' are the same pair", ids[k], ids[i]), "pairs",
                                   "leave the copy out");
    const auto first = first_equal_pose(kept);
    int distinct = 0;
    for (size_t i = 0; i < first.size(); ++i) distinct += first[i] == static_cast<int>(i) ? 1 : 0;
    if (distinct < kHandEyeFewestPairs)
        return input_error(
            kept.size() < static_cast<size_t>(kHandEyeFewestPairs)
                ? Text("{} pairs are too few", kept.size())
                : Text("only {} of the {} robot poses differ from one another", distinct, kept.size()),
            "pairs", Text("give at least {} different poses, better eight or more", kHandEyeFewestPairs));
    return {};
}

Chain chain_of(Mount mount, const std::vector<HandEyePair>& pairs, const std::vector<bool>& used) {
    Chain chain;
    chain.used = used;
    for (const auto& pair : pairs) {
        chain.a.push_back(mount == Mount::eye_in_hand ? pair.base_from_flange
                                                      : pair.base_from_flange.inverse());
        chain.c.push_back(pair.camera_from_target);
    }
    return chain;
}

// A wrong pair is far outside what the others say: leave the worst out, solve again, as long as enough
// remain.
void leave_out_wrong_pairs(Chain& chain, Pose& x, Pose& y, Scales& scales) {
    const size_t start_count = chain.used_count();
    while (chain.used_count() > 5 && chain.used_count() * 3 > start_count * 2) {
        size_t worst = chain.size();
        double worst_square = 0;
        for (size_t i = 0; i < chain.size(); ++i) {
            if (!chain.used[i]) continue;
            const double q = pair_square(chain, i, x, y, scales);
            if (q > worst_square) {
                worst_square = q;
                worst = i;
            }
        }
        // Solve without it and judge it by what the others then say of it.
        Chain without = chain;
        without.used[worst] = false;
        Pose x_without = x, y_without = y;
        const Scales scales_without = solve(without, x_without, y_without, scales);
        const double n = static_cast<double>(without.used_count());
        const double redundancy = 6 * n - 12;
        const double f = pair_square(without, worst, x_without, y_without, scales_without) / 6;
        const double limit = (chi_squared_quantile(kWrongTold, 6) / 6) * (1 + 12 / redundancy) * (1 + 6 / n);
        if (f < limit) return;
        chain = without;
        x = x_without;
        y = y_without;
        scales = scales_without;
    }
}

void state_rms(const Chain& chain, const Pose& x, const Pose& y, HandEyeResult& result) {
    double squares_mm = 0, squares_rad = 0;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        squares_mm += residual_mm(chain, i, x, y).squaredNorm();
        squares_rad += residual_rad(chain, i, x, y).squaredNorm();
    }
    const double n = static_cast<double>(chain.used_count());
    result.rms_mm = std::sqrt(squares_mm / n);
    result.rms_deg = deg_from_rad(std::sqrt(squares_rad / n));
}

// Of the size, what the pairs leave open of kSizeKnown: in X and Y, which are of size 1.
Matrix12 cover_of_size(const Weighed& sized) {
    const double told = sized.covariance(12, 12), known = kSizeKnown * kSizeKnown;
    const Vector12 slope = sized.covariance.col(12).head<12>() / told;
    const double share = known / (known + told), off = share * (sized.size - 1);
    return (share * told + off * off) * slope * slope.transpose();
}

// The pairs used, those of one stand of the robot as one, seen from its first; `which`: the pair that this is.
Chain one_a_stand(const Chain& chain, const std::vector<Pose>& base_from_flange, const Pose& x,
                  std::vector<size_t>& which) {
    Chain used, stands;
    std::vector<size_t> pair;
    std::vector<Pose> flanges;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        used.a.push_back(chain.a[i]);
        used.c.push_back(chain.c[i]);
        pair.push_back(i);
        flanges.push_back(base_from_flange[i]);
    }
    const auto first = first_equal_pose(flanges);
    for (size_t i = 0; i < used.size(); ++i) {
        if (first[i] != static_cast<int>(i)) continue;
        Vector6 sum = Vector6::Zero();
        double count = 0;
        for (size_t k = i; k < used.size(); ++k) {
            if (first[k] != static_cast<int>(i)) continue;
            // A_i X C' = A_k X C_k
            sum += difference(x.inverse() * used.a[i].inverse() * used.a[k] * x * used.c[k], used.c[i]);
            ++count;
        }
        stands.a.push_back(used.a[i]);
        stands.c.push_back(retract(used.c[i], sum / count));
        stands.used.push_back(true);
        which.push_back(pair[i]);
    }
    return stands;
}

// What the target's size wants to be, with all else.
Weighed with_size(Chain chain, bool robot_outside, const RobotRepeatability& robot, Pose x, Pose y,
                  Scales scales) {
    double size = 1;
    Weighed w;
    for (int round = 0; round < 4; ++round) {
        // On the way there the robot may count as unknown: that is quicker, of few pairs by far.
        w = weigh(chain, robot_outside, {}, x, y, scales, true);
        if (!std::isfinite(w.size) || !(w.size > 0)) break;
        size *= w.size;
        const bool settled = std::abs(w.size - 1) < kSizeSettled;
        for (Pose& c : chain.c) c.translation() *= w.size;
        x = w.x;
        y = w.y;
        w.size = size;
        if (settled) break;
        scales = solve(chain, x, y, scales);
    }
    if (!robot.stated()) return w;
    w = weigh(chain, robot_outside, robot, x, y, scales, true);
    w.size *= size;
    return w;
}

HoldOut verify(const Chain& chain, const Pose& x, const Pose& y, const Scales& scales) {
    HoldOut result;
    if (chain.used_count() < 4) return result;
    double squares_t = 0, squares_r = 0;
    Chain rest = chain;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        rest.used[i] = false;
        Pose rx = x, ry = y;
        refine(rest, rx, ry, scales, kInfinity, 20);
        rest.used[i] = true;
        const double t = residual_mm(chain, i, rx, ry).norm(), r = residual_rad(chain, i, rx, ry).norm();
        squares_t += t * t;
        squares_r += r * r;
        result.max_mm = std::isnan(result.max_mm) ? t : std::max(result.max_mm, t);
        ++result.folds;
    }
    result.left_out = 1;
    result.rms_mm = std::sqrt(squares_t / result.folds);
    result.rms_deg = deg_from_rad(std::sqrt(squares_r / result.folds));
    return result;
}

// The usual mistake of a first set-up: one direction reversed. A^-1 Y C^-1 = X says the same as A X C = Y, so
// the other mount, and camera_from_target inverted, cannot be told apart.
Text likely_mistake(Mount mount, const std::vector<HandEyePair>& pairs, const std::vector<bool>& used,
                    double rms_mm) {
    const Mount other = mount == Mount::eye_in_hand ? Mount::eye_to_hand : Mount::eye_in_hand;
    const Chain chain = chain_of(other, pairs, used);
    const Closed start = best_start(chain).closed;
    double squares = 0;
    for (size_t i = 0; i < chain.size(); ++i)
        if (used[i]) squares += residual_mm(chain, i, start.x, start.y).squaredNorm();
    if (!(std::sqrt(squares / static_cast<double>(chain.used_count())) < kOtherMountFits * rms_mm)) return {};
    return Text(
        "the pairs fit as {}, or with camera_from_target inverted: the mount or the direction of one list "
        "seems wrong",
        name_of(other));
}

}  // namespace

std::string_view name_of(Mount mount) {
    return mount == Mount::eye_in_hand ? "eye_in_hand" : "eye_to_hand";
}

std::optional<Mount> mount_named(std::string_view name) {
    if (name == "eye_in_hand") return Mount::eye_in_hand;
    if (name == "eye_to_hand") return Mount::eye_to_hand;
    return std::nullopt;
}

std::string_view name_of(HandEyeStatus status) {
    return status == HandEyeStatus::ok ? "ok" : "undetermined";
}

Expected<HandEyeResult> calibrate_hand_eye(Mount mount, const std::vector<HandEyePair>& pairs,
                                           const std::vector<std::string>& exclude,
                                           const RobotRepeatability& robot) {
    std::vector<bool> used;
    SEAM_OK(check_input(pairs, exclude, used));
    SEAM_OK(check_repeatability(robot));
    Chain chain = chain_of(mount, pairs, used);
    const std::vector<bool> wanted = used;

    HandEyeResult result;
    auto& report = result.report;
    const Began began = best_start(chain);
    result.start = began.closed.name;
    Pose x = began.closed.x, y = began.closed.y;
    if (!std::isfinite(began.cost)) {
        x = y = Pose::Identity();
        result.start = "none";
    }
    // Robust first, so that a wrong pair cannot pull the least squares before it is seen.
    Scales scales = scales_from_medians(chain, x, y);
    for (const double k : kRobustScales) {
        refine(chain, x, y, scales, k, 30);
        scales = scales_from_medians(chain, x, y);
    }
    if (chain.used_count() > 5) {
        // Pairs beyond any doubt go at once.
        std::vector<double> squares;
        for (size_t i = 0; i < chain.size(); ++i)
            squares.push_back(chain.used[i] ? pair_square(chain, i, x, y, scales) : 0);
        Chain fewer = chain;
        for (size_t i = 0; i < chain.size(); ++i)
            if (squares[i] > kNoDoubt && (residual_mm(chain, i, x, y).norm() > kNoDoubt_mm ||
                                          residual_rad(chain, i, x, y).norm() > kNoDoubt_rad))
                fewer.used[i] = false;
        if (fewer.used_count() >= 5 && fewer.used_count() * 3 > chain.used_count() * 2) chain = fewer;
    }
    scales = solve(chain, x, y, scales);
    leave_out_wrong_pairs(chain, x, y, scales);

    std::vector<Pose> flanges;
    for (size_t i = 0; i < pairs.size(); ++i)
        if (chain.used[i]) flanges.push_back(pairs[i].base_from_flange);
    result.degenerate = degenerate_words(flanges);
    const Determination known = determination(chain, x, y, scales);
    report.poses.resize(pairs.size());
    for (size_t i = 0; i < pairs.size(); ++i) {
        auto& pose = report.poses[i];
        pose.id = pairs[i].id;
        pose.used = chain.used[i];
        pose.excluded = !wanted[i];
        if (pose.excluded) {
            pose.note = "excluded by the user";
        } else if (!chain.used[i]) {
            pose.note = "contradicts what the other pairs agree on: wrong robot pose or wrong target pose";
        }
    }
    if (const std::string wrong = left_out(report.poses); !wrong.empty())
        result.notices.push_back(Text("not used, contradicting the others: {}", wrong));

    const double n = static_cast<double>(chain.used_count());
    state_rms(chain, x, y, result);
    result.sigma_mm = scales.mm;
    result.sigma_deg = deg_from_rad(scales.rad);
    result.pairs_used = static_cast<int>(n);

    if (!(known.worst_mm < kUndetermined_mm) || !(known.worst_rad < kUndetermined_rad)) {
        result.status = HandEyeStatus::undetermined;
        report.judgement = {Verdict::undetermined, "",
                            "take more poses, rotated about two axes of the flange by 20 degrees or more"};
        if (!result.degenerate.empty()) {
            report.judgement.reason = result.degenerate.front();
            return result;
        }
        report.judgement.reason = Text("the pairs leave the camera open to {:.3g} mm and {:.3g} degrees",
                                       known.worst_mm, deg_from_rad(known.worst_rad));
        double squares = 0;
        for (size_t i = 0; i < pairs.size(); ++i)
            if (wanted[i]) squares += residual_mm(chain, i, x, y).squaredNorm();
        const Text mistake =
            likely_mistake(mount, pairs, wanted, std::sqrt(squares / static_cast<double>(pairs.size())));
        if (!mistake.empty()) report.judgement.cure = mistake;
        result.reversed = !mistake.empty();
        return result;
    }

    result.status = HandEyeStatus::ok;
    std::vector<Pose> every_flange;
    for (const auto& pair : pairs) every_flange.push_back(pair.base_from_flange);
    const bool outside = mount == Mount::eye_to_hand;
    std::vector<size_t> of_stand;
    const Chain stands = one_a_stand(chain, every_flange, x, of_stand);
    if (stands.size() < chain.used_count()) scales = solve(stands, x, y, scales);
    const Weighed weighed = weigh(stands, outside, robot, x, y, scales);
    x = result.x = weighed.x;
    y = result.y = weighed.y;
    state_rms(chain, x, y, result);
    for (size_t i = 0; i < pairs.size(); ++i) {
        report.poses[i].rms_mm = residual_mm(chain, i, x, y).norm();
        report.poses[i].deg = deg_from_rad(residual_rad(chain, i, x, y).norm());
    }
    Matrix12 covariance = weighed.covariance;
    report.hold_out = verify(stands, x, y, scales);
    HandEyeEvidence evidence;
    evidence.stands = static_cast<int>(stands.size());
    evidence.robot_stated = robot.stated();
    for (const Pose& c : stands.c)
        evidence.reach_mm += c.translation().norm() / static_cast<double>(stands.size());
    const bool few = stands.size() < kFewestForSize;
    if (stands.size() >= (robot.stated() ? kFewestBesideRobot : kFewestForSize) &&
        result.rms_mm < kSizeAsked_mm) {
        const Weighed sized = with_size(stands, outside, robot, x, y, scales);
        result.target_size = sized.size;
        result.target_size_sigma = std::sqrt(sized.covariance(12, 12));
        if (few) {
            covariance += cover_of_size(sized);
        } else if (size_is_off(result.target_size, result.target_size_sigma)) {
            Vector12 moved;
            moved << difference(sized.x, x), difference(sized.y, y);
            covariance += moved * moved.transpose();
        }
    }
    if (result.rms_mm < kSizeAsked_mm) {
        evidence.bump = likeliest_break(stands, x, y);
        if (evidence.bump) evidence.bumped_at = pairs[of_stand[evidence.bump->first]].id;
    }
    result.covariance_x = covariance.topLeftCorner<6, 6>();
    result.covariance_y = covariance.bottomRightCorner<6, 6>();
    add_pose(report, x);
    add_pose(report, y, "target_");
    state_covariance(report, covariance);
    const std::size_t notices = result.notices.size();
    report.judgement = judge_hand_eye(evidence, result);
    if (report.judgement.verdict == Verdict::poor) {
        result.notices.resize(notices);
        evidence.mistake = likely_mistake(mount, pairs, wanted, result.rms_mm);
        result.reversed = !evidence.mistake.empty();
        report.judgement = judge_hand_eye(evidence, result);
    }
    return result;
}

}  // namespace seamwright
