#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/features/registration/registration_kernel.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr int kFewestOnWall = 5;
constexpr double kSeenOfWall = 0.5;  // of its height
constexpr int kFewestOfSlope = 4;    // points
constexpr double kMostBare = 0.2;    // of the partners
constexpr double kInsideWall = 0.9;  // of half its height
constexpr double kSameWay = 0.7;     // cosine between the directions of two ends
constexpr double kSurelySeen = 0.1;  // of what is known of the best direction: more than waves can feign

}  // namespace

bool ContourMatcher::Impl::waves_alone(const Eigen::Vector3d& twist, double seen, double weight_sum) const {
    // Points on the same fitted piece share its slope's error.
    const double per_window = model.pitch().along_x / scene.pitch.along_x;
    double waves = 0, scatter = 0;
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const double part = m.weight * slope_doubt[static_cast<std::size_t>(m.foot.edge)] *
                            std::pow(registration_row(edge, m.foot.u).along.dot(twist), 2);
        waves += part;
        scatter += 2 * part * part * std::max(1.0, edge.count * per_window);
    }
    return seen - waves < weight_sum * kStraight_rad * kStraight_rad + 4 * std::sqrt(scatter) + 0.5 * waves;
}

Eigen::Vector3d ContourMatcher::Impl::solved(const Linearised& normal) const {
    // Millimetre and radian are made alike by the template's length; directions without information stay put.
    const Eigen::Vector3d scale(1, 1, 2 / model.extent_mm());
    Eigen::Matrix3d h = scale.asDiagonal() * normal.hessian * scale.asDiagonal();
    Eigen::Vector3d g = scale.cwiseProduct(normal.gradient);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(h);
    // So does the one along which the waves of the template's own noise would have a flat slide.
    const Eigen::Vector3d least = eigen.eigenvectors().col(0);
    const bool open = eigen.eigenvalues()[0] < kSurelySeen * eigen.eigenvalues()[2] &&
                      waves_alone(scale.cwiseProduct(least), eigen.eigenvalues()[0], normal.weight_sum);
    if (open) {
        const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - least * least.transpose();
        h = rest * h * rest;
        g = rest * g;
    }
    if (!jumps.empty()) {
        h += scale.asDiagonal() * normal.ends_hessian * scale.asDiagonal();
        g += scale.cwiseProduct(normal.ends_gradient);
    }
    if (open || !jumps.empty()) eigen.compute(h);
    const double smallest = 1e-7 * eigen.eigenvalues()[2];
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
        if (eigen.eigenvalues()[k] > smallest)
            step -=
                eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(g) / eigen.eigenvalues()[k]);
    return scale.cwiseProduct(step);
}

void ContourMatcher::Impl::collect(const CentredPose& pose, double gate, int stride) const {
    matches.clear();
    const double x0 = model.lower().x() - gate, x1 = model.upper().x() + gate;
    const double z0 = model.lower().y() - gate, z1 = model.upper().y() + gate;
    for (std::size_t i = 0; i < scene.x.size(); i += static_cast<std::size_t>(stride)) {
        const double ex = scene.x[i] - pose.dx, ez = scene.z[i] - pose.dz;
        const double qx = pose.cosine * ex + pose.sine * ez, qz = -pose.sine * ex + pose.cosine * ez;
        if (qx < x0 || qx > x1 || qz < z0 || qz > z1) continue;
        const ContourModel::Foot foot = model.nearest(qx, qz, gate);
        if (foot.edge >= 0) matches.push_back({static_cast<int>(i), foot});
    }
}

// A tilted wall is seen as a row of neighbouring points over much of its height. Single points on it are clutter, and a
// row about one of its ends is the sheet that begins there, whose end the line of sight decides: both would fix what
// nothing fixes.
void ContourMatcher::Impl::drop_sparse_walls() const {
    if (std::none_of(jumps.begin(), jumps.end(), [](const JumpEnd& j) { return j.tells(); })) return;
    wall_hits.assign(model.edges().size(), 0);
    wall_seen.assign(model.edges().size(),
                     {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const int edge = matches[i].foot.edge;
        if (!model.edges()[edge].wall) continue;
        // The two sheets' own ends lie at a wall's ends whether it is seen or not.
        if (std::abs(matches[i].foot.u) > kInsideWall * model.edges()[edge].half &&
            !sampled_wall(static_cast<std::size_t>(edge)))
            continue;
        const bool neighbours =
            i > 0 && matches[i - 1].foot.edge == edge && matches[i - 1].scene + 1 == matches[i].scene;
        wall_hits[edge] += neighbours ? kFewestOnWall : 1;
        auto& [low, high] = wall_seen[static_cast<std::size_t>(edge)];
        low = std::min(low, matches[i].foot.u), high = std::max(high, matches[i].foot.u);
    }
    // Between two points of which no wider piece is known the slope is not: a bend within a pitch, or a point that stood
    // in a step.
    const auto bare = std::count_if(matches.begin(), matches.end(), [&](const Match& m) {
        return model.edges()[m.foot.edge].count < kFewestOfSlope;
    });
    const bool leave_out_bare = bare < kMostBare * static_cast<double>(matches.size());
    std::erase_if(matches, [&](const Match& m) {
        const auto& edge = model.edges()[m.foot.edge];
        if (!edge.wall) return leave_out_bare && edge.count < kFewestOfSlope;
        const auto& [low, high] = wall_seen[static_cast<std::size_t>(m.foot.edge)];
        return wall_hits[m.foot.edge] < kFewestOnWall ||
               (high - low < kSeenOfWall * 2 * edge.half &&
                !sampled_wall(static_cast<std::size_t>(m.foot.edge)));
    });
}

std::optional<ContourMatcher::Impl::MetEnd> ContourMatcher::Impl::met_edge(const JumpEnd& t, const JumpEnd& s,
                                                                           const CentredPose& pose) const {
    const double ex = s.x - pose.dx, ez = s.z - pose.dz;
    const double qx = pose.cosine * ex + pose.sine * ez - t.x, qz = -pose.sine * ex + pose.cosine * ez - t.z;
    const double outwards =
        (pose.cosine * s.tx + pose.sine * s.tz) * t.tx + (-pose.sine * s.tx + pose.cosine * s.tz) * t.tz;
    if (outwards < kSameWay) return std::nullopt;
    // Where z grows away from the sensor, the end is where its shadow falls, which a turn moves along it.
    const double shadow = t.of_gap ? 0 : 0.5 * t.height * pose.sine;
    return MetEnd{
        qx * t.tx + qz * t.tz,
        qz * t.tx - qx * t.tz,
        2 * (s.pitch + t.pitch),
        // Moving the template's point (x, z) by (vx, vz) and a turn w: residual falls by t . (v + w (-z, x)).
        {-t.tx, -t.tz, -(-t.tx * t.z + t.tz * t.x)},
        (s.pitch * s.pitch + t.pitch * t.pitch) / 12 + (s.open - t.open) * (s.open - t.open) / 4 +
            shadow * shadow};
}

std::optional<ContourMatcher::Impl::MetEnd> ContourMatcher::Impl::met_outline(const SheetOutline& t,
                                                                              const SheetOutline& s,
                                                                              const CentredPose& pose) const {
    using Nearer = SheetOutline::Nearer;
    // As taught: what bends in the scene may be another surface, a reflection's.
    const Nearer nearer = t.nearer;
    if (nearer == Nearer::unknown || (s.nearer != Nearer::unknown && s.nearer != nearer)) return std::nullopt;
    if (s.upwards != t.upwards || pose.cosine < kSameWay) return std::nullopt;
    const SheetOutline::Side &a = nearer == Nearer::upper ? t.upper : t.lower,
                             &b = nearer == Nearer::upper ? s.upper : s.lower;
    // Along the scene's x, seen from the template.
    const double tx = pose.cosine, tz = -pose.sine;
    const double ex = s.x - pose.dx, ez = b.z - pose.dz;
    const double qx = pose.cosine * ex + pose.sine * ez - t.x, qz = -pose.sine * ex + pose.cosine * ez - a.z;
    // The outline of a round surface goes over it as it turns; it lies below the last point by about a drop, and of a circle
    // the drop squared is twice radius and pitch.
    const double over = 0.5 * a.drop * a.drop / std::max(t.pitch, 1e-9) * (1 - pose.cosine),
                 below = a.drop * pose.sine;
    return MetEnd{qx * tx + qz * tz,
                  qz * tx - qx * tz,
                  2 * (s.open + t.open) + a.drop + b.drop,
                  {-tx, -tz, -(-tx * a.z + tz * t.x)},
                  (s.open * s.open + t.open * t.open) / 12 + over * over + below * below};
}

void ContourMatcher::Impl::collect_jumps(const CentredPose& pose, double gate) const {
    jump_matches.clear();
    const double noise = scene.sigma_mm * scene.sigma_mm + model.sigma_mm() * model.sigma_mm();
    for (std::size_t number = 0; number < jumps.size(); ++number) {
        const JumpEnd& t = jumps[number];
        double best = std::numeric_limits<double>::infinity();
        JumpMatch match{};
        for (const JumpEnd& s : scene.jumps) {
            if (s.of_gap != t.of_gap || s.height < 0.5 * t.height || s.height > 2 * t.height) continue;
            auto met = t.of_gap ? std::nullopt : met_outline(t.outline, s.outline, pose);
            if (!met && t.is_edge && s.is_edge) met = met_edge(t, s, pose);
            if (!met || std::abs(met->outside) > gate + met->reach ||
                std::abs(met->across) > gate + 0.5 * t.height)
                continue;
            const double d = std::hypot(met->outside, met->across);
            if (d >= best) continue;
            best = d;
            match = {static_cast<int>(number), met->row, met->outside, met->variance + noise};
        }
        if (best < std::numeric_limits<double>::infinity()) jump_matches.push_back(match);
    }
}

ContourMatcher::Impl::Finish ContourMatcher::Impl::finish(const CentredPose& start, double gate, int stride,
                                                          int most_iterations) const {
    Finish result;
    result.pose = start;
    const double floor = smallest_gate(), cap = largest_final_gate();
    const double half = 0.5 * model.extent_mm();
    double current = gate;
    bool settled = false;  // the gate is final
    double last_step = std::numeric_limits<double>::infinity();
    int growing = 0;
    for (int it = 0; it < most_iterations; ++it) {
        ++iterations;
        collect(result.pose, current, stride);
        if (settled && stride == 1) drop_sparse_walls();
        if (matches.size() < static_cast<std::size_t>(kFewestRegistrationPoints)) break;
        sizes.clear();
        for (const Match& m : matches) sizes.push_back(std::abs(m.foot.residual));
        if (!settled) {
            const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
            std::nth_element(sizes.begin(), middle, sizes.end());
            result.sigma = kMadToSigma * *middle;
        }
        // Biweight while the gate closes; then every partner counts alike, which is what the covariance
        // assumes.
        Linearised normal;
        const double over = 1 / (current * current);
        for (Match& m : matches) {
            const RegistrationRow row = registration_row(model.edges()[m.foot.edge], m.foot.u);
            double w = 1;
            if (!settled) {
                w = 1 - m.foot.residual * m.foot.residual * over;
                w = w > 0 ? w * w : 0;
            }
            m.weight = w;
            normal.weight_sum += w;
            normal.hessian.noalias() += w * row.across * row.across.transpose();
            normal.gradient += w * m.foot.residual * row.across;
        }
        if (!(normal.weight_sum > 0)) break;
        if (!jumps.empty()) {
            collect_jumps(result.pose, current);
            const double variance = std::max(result.sigma * result.sigma, 1e-10);
            for (const JumpMatch& j : jump_matches) {
                normal.ends_hessian.noalias() += variance / j.variance * j.row * j.row.transpose();
                normal.ends_gradient += variance / j.variance * j.residual * j.row;
            }
        }
        Eigen::Vector3d step = solved(normal);
        // The turn's Jacobian is taken at the curve's point in the template's frame; shifts are turned to the
        // scene.
        double size = std::hypot(step.x(), step.y()) + std::abs(step.z()) * half;
        if (!std::isfinite(size)) break;
        const double most = std::max(current, 0.05);
        if (size > most) {
            step *= most / size;
            size = most;
        }
        const CentredPose& p = result.pose;
        result.pose = CentredPose(p.dx + p.cosine * step.x() - p.sine * step.y(),
                                  p.dz + p.sine * step.x() + p.cosine * step.y(), p.phi + step.z());
        if (settled) {
            // Partners change with every step, so the last digits may go round in a circle: stop when steps
            // are far below the noise of the result or no longer shrink.
            const double noise = result.sigma / std::sqrt(double(matches.size()));
            if (size < std::max((stride > 1 ? 0.2 : 0.02) * noise, 1e-9)) break;
            growing = size >= last_step ? growing + 1 : 0;
            if (growing >= 3) break;
            last_step = size;
        } else {
            const double target = std::clamp(4 * result.sigma, floor, std::max(floor, cap));
            const double next = std::max(target, 0.5 * current);
            settled = next >= 0.98 * current || (next == target && size < 0.5 * target);
            if (next < current) current = next;
        }
    }
    result.gate = current;
    return result;
}

}  // namespace seamwright
