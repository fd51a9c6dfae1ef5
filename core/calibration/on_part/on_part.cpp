#include "core/calibration/on_part/on_part.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/numbers.h"
#include "core/calibration/on_part/idle_latency.h"
#include "core/calibration/on_part/judge.h"
#include "core/calibration/on_part/start.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace on_part;

constexpr double kNoise_mm = 0.03;  // of a point whose covariance is not known; its scale is estimated
constexpr std::size_t kFewestProfiles = 4;
constexpr double kLatest_s = 1e12, kFarthestEdge_mm = 1e4;
constexpr double kLeastVariance_mm2 = 1e-12, kMostVariance_mm2 = 1e4;  // of a point, where it is known
constexpr double kSingular = 1e-12;   // eigenvalue of a prior scaled to unit diagonal, up to that
constexpr double kIsotropic = 1e-4;   // of a covariance's trace, added: no point is exact in one direction
constexpr double kLowerCost = 1e-6;   // by which a rival must be lower to take its place
constexpr int kFewestDirections = 3;  // of six: with less the sensor may be anywhere and would not show
constexpr double kMoved = 0.99, kMovedSide = 0.995;  // of chi squared; of one side of a normal
constexpr double kSpeaksAgainst = 0.999;             // of chi squared: then the usual robot is given up
// One of those that are asked where none is stated.
const RobotRepeatability kUsualRobot{0.05, 0.05 / kPassLever_mm};
constexpr double kBlow_mm = 20, kBlow_rad = 0.1;  // sigma of what a blow may do

Text place(const EdgePass& pass) {
    return Text("pass '{}'", pass.id);
}

Expected<void> check_pass(const EdgePass& pass) {
    if (pass.profiles.empty())
        return input_error("there is no profile", place(pass), "leave out a pass without profiles");
    std::vector<Pose> poses;
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < pass.profiles.size(); ++i) {
        const EdgeProfile& p = pass.profiles[i];
        poses.push_back(p.base_from_flange);
        ids.push_back(std::to_string(i));
        if (!std::isfinite(p.time_s) || std::abs(p.time_s) > kLatest_s)
            return input_error(Text("the time of profile {} is no time", i), place(pass), "give seconds");
        if (!p.point_mm.allFinite() || p.point_mm.norm() > kFarthestEdge_mm)
            return input_error(Text("the point of profile {} is none within 10 m", i), place(pass),
                               "leave out profiles that saw no edge");
        if (!p.covariance_mm2.allFinite() ||
            (p.covariance_mm2 - p.covariance_mm2.transpose()).norm() >
                kCovarianceSlack * p.covariance_mm2.norm() ||
            p.covariance_mm2.determinant() < 0 || p.covariance_mm2.trace() < 0 ||
            p.covariance_mm2.norm() > kMostVariance_mm2 ||
            (p.covariance_mm2.norm() > 0 && !(p.covariance_mm2.trace() > kLeastVariance_mm2)))
            return input_error(Text("the covariance of profile {} is none", i), place(pass),
                               "give a symmetric 2 x 2 matrix in mm^2, or none");
        if (i > 0 && !(p.time_s > pass.profiles[i - 1].time_s))
            return input_error(Text("the time of profile {} does not come after the one before", i),
                               place(pass), "give the profiles in the order of their times");
    }
    return check_rigid(poses, ids, place(pass));
}

Expected<void> check_passes(const std::vector<EdgePass>& passes, const OnPartOptions& options) {
    if (passes.empty())
        return input_error("there is no pass", "passes", "give passes over an edge of the part");
    std::vector<std::string> ids;
    std::vector<Pose> poses;
    for (const EdgePass& pass : passes) ids.push_back(pass.id);
    SEAM_OK(check_ids(ids, options.exclude, "passes"));
    for (const EdgePass& pass : passes) {
        if (pass.edge.empty())
            return input_error("the edge has no name", place(pass), "name the edge that it follows");
        SEAM_OK(check_pass(pass));
        for (const EdgeProfile& p : pass.profiles) poses.push_back(p.base_from_flange);
    }
    SEAM_OK(check_millimetres(poses, "passes"));
    if (options.latency_s && !(std::abs(*options.latency_s) <= 1))
        return input_error("the latency is beyond one second", "latency", "give it in seconds");
    if (options.robot) {
        SEAM_OK(check_repeatability(*options.robot));
        // What is stated replaces the estimate, so a turn that is left out would count as exact.
        if (!(options.robot->sigma_mm > 0 && options.robot->sigma_rad > 0))
            return input_error("the robot's repeatability is stated in part", "robot",
                               "give sigma_mm and sigma_deg, both above zero");
    }
    if (options.prior) {
        SEAM_OK(pose_from_matrix(options.prior->flange_from_sensor.matrix(), "prior"));
        const Matrix6& c = options.prior->covariance;
        const Vector6 diagonal = c.diagonal();
        if (!c.allFinite() || !(diagonal.minCoeff() > 0) ||
            (c - c.transpose()).norm() > kCovarianceSlack * c.norm())
            return input_error("the covariance is none", "prior",
                               "give a symmetric 6 x 6 matrix, mm and rad, positive definite");
        const Vector6 scale = diagonal.cwiseSqrt().cwiseInverse();
        if (!(symmetric_eigen(scale.asDiagonal() * c * scale.asDiagonal()).values(0) > kSingular))
            return input_error("the covariance is not positive definite", "prior",
                               "give a symmetric 6 x 6 matrix, mm and rad, positive definite");
    }
    return {};
}

Data data_of(const std::vector<EdgePass>& passes, const OnPartOptions& options, Names& names) {
    Data data;
    data.latency_free = !options.latency_s;
    data.latency_s = options.latency_s.value_or(0);
    data.prior = options.prior;
    const auto excluded = [&](const EdgePass& pass) {
        return std::find(options.exclude.begin(), options.exclude.end(), pass.id) != options.exclude.end();
    };
    // Edges that only excluded passes follow come last and are none of the problem's.
    for (const bool out : {false, true}) {
        for (const EdgePass& pass : passes)
            if (excluded(pass) == out &&
                std::find(names.edges.begin(), names.edges.end(), pass.edge) == names.edges.end())
                names.edges.push_back(pass.edge);
        if (!out) data.edges = names.edges.size();
    }
    for (const EdgePass& pass : passes) {
        const auto known = std::find(names.edges.begin(), names.edges.end(), pass.edge);
        const auto edge = static_cast<std::size_t>(known - names.edges.begin());
        names.passes.push_back(pass.id);
        names.excluded.push_back(excluded(pass));
        std::vector<double> times;
        std::vector<Pose> poses;
        for (std::size_t i = 0; i < pass.profiles.size(); ++i) {
            const EdgeProfile& p = pass.profiles[i];
            times.push_back(p.time_s);
            poses.push_back(p.base_from_flange);
            Sight s{data.motions.size(),   edge, i, p.time_s, p.point_mm, p.covariance_mm2,
                    !names.excluded.back()};
            if (!(s.covariance.trace() > 0))
                s.covariance = kNoise_mm * kNoise_mm * Eigen::Matrix2d::Identity();
            s.covariance.diagonal().array() += kIsotropic * s.covariance.trace();
            data.sights.push_back(s);
        }
        data.motions.emplace_back(std::move(times), std::move(poses));
    }
    return data;
}

// The sensor mirrored at the plane across the edge: what one straight edge under one attitude cannot tell apart.
State mirrored(const Refined& r) {
    const Sight* middle = nullptr;
    for (const Sight& s : r.data.sights)
        if (s.used && s.edge == 0) middle = &s;
    State state = r.state;
    if (!middle) return state;
    const Eigen::Vector3d d =
        r.data.motions[middle->pass].at(middle->time_s).linear().transpose() * r.state.edges[0].axes.col(0);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - 2 * d * d.transpose();
    const Eigen::Matrix3d turn = across * r.state.mounting.linear() * Eigen::Vector3d(1, -1, 1).asDiagonal();
    const Eigen::Vector3d m = in_sensor(r.working_point);
    state.mounting = make_pose(turn, r.state.mounting * m - turn * m);
    return state;
}

std::vector<Rival> rivals_of(const Refined& best, const std::vector<State>& others) {
    std::vector<Rival> list;
    for (const State& other : others) list.push_back(rival(best, other));
    list.push_back(rival(best, mirrored(best)));
    std::sort(list.begin(), list.end(), [](const Rival& a, const Rival& b) { return a.cost < b.cost; });
    return list;
}

// From every start; then from a rival that fits better, if there is one.
struct Found {
    Refined refined;
    std::vector<Rival> rivals;
};
std::optional<Found> find(const Data& data, const std::vector<State>& begun, const OnPartOptions& options) {
    Found found;
    std::size_t from = 0;
    for (; from < begun.size(); ++from) {
        found.refined = refine(data, begun[from], options.robot);
        if (found.refined.solved) break;
    }
    if (!found.refined.solved) return std::nullopt;
    std::vector<State> others = begun;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(from));
    for (int round = 0; round < 3; ++round) {
        found.rivals = rivals_of(found.refined, others);
        if (found.rivals.empty() || !(found.rivals.front().cost < found.refined.cost - kLowerCost)) break;
        Refined better = refine(data, found.rivals.front().state, options.robot);
        if (!better.solved) break;
        others.push_back(found.refined.state);
        found.refined = std::move(better);
    }
    if (Refined real = without_idle_latency(data, found.refined, options.robot);
        real.data.latency_free != data.latency_free || real.cost != found.refined.cost) {
        found.refined = std::move(real);
        found.rivals = rivals_of(found.refined, others);
    }
    return found;
}

// -2 log of the restricted likelihood of the common profiles where an answer stands, by its own variances.
double minus2_of(const Refined& r, const Data& common) {
    Data data = common;
    data.latency_free = false;
    data.latency_s = r.state.latency_s;
    State state = r.state;
    if (!std::isfinite(solve_state(data, r.variances, {}, state))) return kInfinity;
    const Blocks blocks = linearised(data, r.variances, state);
    if (blocks.ss.size() == 0) return kInfinity;
    const double rows = 2 * static_cast<double>(blocks.sight_of.size());
    return at_variances(blocks, data, state, r.variances, view_of(state, r.working_point, blocks.wanted))
               .minus2 +
           2 * rows * std::log(r.variances.white);
}

// The likeliest answer that a blow's reach of the old place holds. One solution alone may run off along what is open, a
// latency that nothing shows above all, and take its own misfit for the robot's; so it is held as well, and the old place
// itself is one of those that are asked.
std::optional<Refined> near_old(const Data& data, const State& old, const OnPartOptions& options) {
    Data blown = data;
    blown.prior->covariance.diagonal().head<3>().array() += kBlow_mm * kBlow_mm;
    blown.prior->covariance.diagonal().tail<3>().array() += kBlow_rad * kBlow_rad;
    std::vector<Refined> tried;
    std::vector<double> ahead;
    const auto take = [&](Refined r, double ahead_by = 0) {
        r.data.prior = blown.prior;
        if (r.solved) tried.push_back(std::move(r)), ahead.push_back(ahead_by);
    };
    const auto take_free = [&](const Data& from) {
        if (const Refined r = refine(from, old, options.robot); r.solved)
            take(without_idle_latency(from, r, options.robot));
    };
    Data held = blown;
    held.latency_free = false;
    take(refine(held, old, options.robot, true));
    take(refine(held, old, options.robot));
    if (!options.robot) take(refine(held, old, kUsualRobot, true), chi_squared_quantile(kSpeaksAgainst, 1));
    take_free(data);
    if (data.latency_free) take_free(blown);
    Data common = blown;
    for (const Refined& r : tried)
        for (std::size_t i = 0; i < common.sights.size(); ++i)
            if (!r.data.sights[i].used) common.sights[i].used = false;
    const Refined* best = nullptr;
    double least = kInfinity;
    for (std::size_t i = 0; i < tried.size(); ++i)
        if (const double minus2 = minus2_of(tried[i], common) - ahead[i]; minus2 < least)
            least = minus2, best = &tried[i];
    if (!best) return std::nullopt;
    return *best;
}

// Gain of the squares when the prior is given up, for the same profiles at the same variances.
double gain_without(const Refined& near, const MountingPrior& prior) {
    Data data = near.data;
    data.prior = prior;
    State at_prior = near.state;
    const double with = solve_state(data, near.variances, {}, at_prior);
    data.prior = near.data.prior;
    State state = near.state;
    const double without = std::min(solve_state(data, near.variances, {}, state),
                                    solve_state(data, near.variances, {}, at_prior));
    return std::isfinite(without) && std::isfinite(with) ? (with - without) / near.neighbours : 0;
}

// The data are asked first: beside a prior that no longer holds, a moved sensor would look like noise.
std::optional<OnPartResult> after_bump(const Data& data, const Names& names, const OnPartOptions& options) {
    const State old = start_at(data, options.prior->flange_from_sensor, options.latency_s.value_or(0), 8, 12);
    Data without = data;
    without.prior.reset();
    OnPartOptions alone = options;
    alone.prior.reset();
    const auto found_near = near_old(data, old, options);
    if (!found_near) return std::nullopt;
    const Refined& near = *found_near;
    BumpTest test = bump_of(near, *options.prior, near.state.mounting);
    // What is weakly determined is far from linear: both ways of asking must say so.
    test.chi_squared = std::min(test.chi_squared, gain_without(near, *options.prior));
    test.limit = chi_squared_quantile(kMoved, 6);
    if (!options.robot) {  // the passes' own errors are known from few passes alone
        const double freedom =
            4.0 * static_cast<double>(data.motions.size()) - 7 - 4.0 * static_cast<double>(data.edges);
        const double wider =
            student_quantile(kMovedSide, std::max(2.0, freedom)) / normal_quantile(kMovedSide);
        test.limit *= wider * wider;
    }
    test.moved = test.directions > 0 && test.chi_squared > test.limit;
    OnPartResult result;
    if (test.moved) {
        std::vector<State> begun = starts(without);
        begun.insert(begun.begin(), near.state);
        const auto found = find(without, begun, alone);
        result = found ? judge(found->refined, without, names, found->rivals, alone)
                       : refused(names, OnPartStatus::undetermined,
                                 "the sensor has moved, and these passes do not tell where it is now",
                                 "make passes from more attitudes, leaning about all three axes");
    } else if (test.directions < kFewestDirections) {
        result = refused(names, OnPartStatus::undetermined,
                         "these passes cannot tell whether the sensor has moved",
                         "make passes from more attitudes, leaning about all three axes");
    } else {
        const Refined both = refine(data, old, options.robot);
        if (!both.solved) return std::nullopt;
        result = judge(without_idle_latency(data, both, options.robot), data, names, {}, options);
    }
    result.bump = test;
    if (result.status == OnPartStatus::ok) {
        const Eigen::Vector3d m = in_sensor(result.working_point_mm);
        result.bump->shift_mm =
            (result.flange_from_sensor * m - options.prior->flange_from_sensor * m).norm();
        result.bump->turn_deg =
            deg_from_rad(angle_rad(result.flange_from_sensor, options.prior->flange_from_sensor));
    }
    return result;
}

}  // namespace

std::string_view name_of(OnPartStatus status) {
    switch (status) {
        case OnPartStatus::ok:
            return "ok";
        case OnPartStatus::undetermined:
            return "undetermined";
        case OnPartStatus::not_converged:
            return "not_converged";
    }
    return "undetermined";
}

Expected<OnPartResult> calibrate_on_part(const std::vector<EdgePass>& passes, const OnPartOptions& options) {
    SEAM_OK(check_passes(passes, options));
    Names names;
    const Data data = data_of(passes, options, names);
    std::vector<std::size_t> profiles(passes.size());
    std::size_t all = 0;
    for (const Sight& s : data.sights) all += s.used;
    if (all < kFewestProfiles * 4)
        return refused(names, OnPartStatus::undetermined, Text("{} profiles are too few to solve from", all),
                       "make passes of ten profiles and more, from several attitudes");
    const auto none = [&] {
        return refused(names, OnPartStatus::not_converged, "the passes do not lie on one smooth edge each",
                       "check that passes of different edges name different ones, that the part stands "
                       "still, and which way round the robot's poses are written (base from flange)");
    };
    if (!options.prior) {
        const auto found = find(data, starts(data), options);
        return found ? judge(found->refined, data, names, found->rivals, options) : none();
    }
    return after_bump(data, names, options).value_or(none());
}

}  // namespace seamwright
