#include "core/calibration/on_part/on_part.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/numbers.h"
#include "core/calibration/on_part/idle_latency.h"
#include "core/calibration/on_part/judge.h"
#include "core/calibration/on_part/start.h"
#include "core/calibration/pose_set.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace on_part;

constexpr double kNoise_mm = 0.03;  // of a point whose covariance is not known; its scale is estimated
constexpr std::size_t kFewestProfiles = 4;
constexpr double kLatest_s = 1e12, kFarthestEdge_mm = 1e4;
constexpr double kLeastVariance_mm2 = 1e-12, kMostVariance_mm2 = 1e4;  // of a point, where it is known
constexpr double kSingular = 1e-12;  // eigenvalue of a prior scaled to unit diagonal, up to that
constexpr double kIsotropic = 1e-4;  // of a covariance's trace, added: no point is exact in one direction
constexpr double kLowerCost = 1e-6;  // by which a rival must be lower to take its place

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

// The data alone are asked first: beside a prior that no longer holds, a moved sensor would look like noise.
std::optional<OnPartResult> after_bump(const Data& data, const Names& names, const OnPartOptions& options) {
    const State old = start_at(data, options.prior->flange_from_sensor, options.latency_s.value_or(0), 8, 12);
    Data without = data;
    without.prior.reset();
    OnPartOptions alone = options;
    alone.prior.reset();
    const Refined near = refine(without, old, options.robot);
    if (!near.solved) return std::nullopt;
    const BumpTest test = bump_of(near, *options.prior, near.state.mounting);
    OnPartResult result;
    if (test.moved) {
        std::vector<State> begun = starts(without);
        begun.insert(begun.begin(), near.state);
        const auto found = find(without, begun, alone);
        if (!found) return std::nullopt;
        result = judge(found->refined, without, names, found->rivals, alone);
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
