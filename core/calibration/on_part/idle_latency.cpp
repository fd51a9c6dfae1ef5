#include "core/calibration/on_part/idle_latency.h"

#include <algorithm>

#include "core/calibration/on_part/advice.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright::on_part {
namespace {

// -2 log of the restricted likelihood there, the latency as it stands.
double minus2_at(const Refined& r, const Variances& v, const State& state) {
    Data data = r.data;
    data.latency_free = false;
    data.latency_s = state.latency_s;
    const Blocks blocks = linearised(data, v, state);
    if (blocks.ss.size() == 0) return kInfinity;
    return at_variances(blocks, data, state, v, view_of(state, r.working_point, blocks.wanted)).minus2;
}

bool may_be_straight(const Refined& r) {
    constexpr double kCurved = 0.999;
    Variances straight = r.variances;
    straight.curvature.assign(straight.curvature.size(), kStraightEdge);
    State state = r.state;
    for (EdgeCurve& edge : state.edges) edge.coefficients.setZero();
    if (!std::isfinite(solve_state(r.data, straight, {}, state))) return false;
    const double limit = chi_squared_quantile(kCurved, 1 + static_cast<double>(r.data.edges));
    return minus2_at(r, straight, state) - minus2_at(r, r.variances, r.state) < limit;
}

Open open_of(const Refined& r) {
    const Eigen::MatrixXd back =
        inverse_matrix(view_of(r.state, r.working_point, r.estimate.covariance.rows()));
    return open_directions(back * r.estimate.covariance * back.transpose());
}

}  // namespace

Refined without_idle_latency(const Data& data, const Refined& refined,
                             const std::optional<RobotRepeatability>& robot) {
    if (!data.latency_free) return refined;
    Refined r = refined;
    bool straight = false;
    if (std::any_of(r.variances.curvature.begin(), r.variances.curvature.end(),
                    [](double kappa) { return kappa > kStraightEdge; }) &&
        may_be_straight(r)) {
        State begin = r.state;
        begin.latency_s = data.latency_s;
        Refined other = refine(data, begin, robot, true);
        if (other.solved) r = std::move(other), straight = true;
    }
    const Open open = open_of(r);
    if (open.mounting || !open.latency) return r;
    Data held = data;
    held.latency_free = false;
    State begin = r.state;
    begin.latency_s = data.latency_s;
    Refined idle = refine(held, begin, robot, straight);
    if (!idle.solved) return r;
    const double variance = r.estimate.covariance(6, 6);
    if (variance > 0) {
        const Vector6 moves = kOnPartOpen_s * r.estimate.covariance.col(6).head<6>() / variance;
        idle.estimate.covariance.topLeftCorner<6, 6>() += moves * moves.transpose();
    }
    idle.idle_latency = true;
    return idle;
}

}  // namespace seamwright::on_part
