#include "core/features/registration.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/features/contour_model.h"
#include "core/features/registration_search.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr int kFewestPoints = 5;
constexpr int kFewestOnWall = 5;
// Stated sigma of an undetermined motion, in mm at the template's farther parts.
constexpr double kUndetermined_mm = 1e3;
// The template counts as found when at least this share of its length has a partner...
constexpr double kSmallestShare = 0.5;
// ... and at least this share of what fixes its least determined direction.
constexpr double kSmallestInformationShare = 0.04;
// Slopes below this (rms, radian) say nothing about where along the contour we are.
constexpr double kStraight_rad = 2e-3;
// Poses whose ratings differ by less fit about equally well.
constexpr double kRatingNoise = 0.02;
// Coarse ratings worse by this are not followed up.
constexpr double kHopeless = 0.2;

struct Match {
    int scene = 0;
    ContourModel::Foot foot;
};

// The same jump in template and scene: says where along the upper surface we are, within a pitch of each.
struct JumpMatch {
    Eigen::Vector3d row;
    double residual, variance;
};

// One linearisation of the finish.
struct Normal {
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

}  // namespace

struct ContourMatcher::Impl {
    ContourModel model;
    RegistrationSearch search;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    Eigen::Matrix3d template_information = Eigen::Matrix3d::Zero();  // per mm of contour, template frame
    std::vector<double> arc;                                         // [edges] length before the edge
    std::vector<JumpEnd> jumps;

    // Buffers that live as long as the matcher: after the first calls nothing is allocated.
    mutable RegistrationSearch finder;
    mutable SceneContour scene;
    mutable std::vector<SearchCandidate> candidates, along;
    mutable std::vector<Match> matches;
    mutable std::vector<JumpMatch> jump_matches;
    mutable std::vector<int> wall_hits;                  // [edges]
    mutable std::vector<Eigen::Vector3d> wall_gradient;  // [edges]
    mutable std::vector<double> sizes;
    mutable std::vector<std::uint8_t> covered;
    mutable std::vector<std::array<Eigen::Vector3d, 3>> influence;
    mutable int iterations = 0;
    mutable int bins = 1;  // of the contour's length, in `covered` (which has one more at either end)

    struct Finish {
        CentredPose pose;
        double gate = 0;  // final
        double sigma = 0;
    };
    struct Rating {
        CentredPose pose;
        double gate = 0, score = -1, share = 0;
        int on = 0, off = 0;  // scene points near the template that lie on it, that do not
    };

    // No gate grows beyond this: noise that large hides any shape of the template's size.
    double gate_limit() const { return std::max(0.02 * model.extent_mm(), 0.1); }
    double smallest_gate() const {
        return std::min(4 * std::hypot(model.sigma_mm(), scene.sigma_mm), gate_limit());
    }
    double largest_final_gate() const {
        return std::min(std::max(0.25, 1.5 * smallest_gate()), gate_limit());
    }

    int bin_of(std::size_t edge, double u) const {
        const auto& e = model.edges()[edge];
        const double s = arc[edge] + e.half + std::clamp(u, -e.half, e.half);
        return 1 + std::clamp(static_cast<int>(s / model.length_mm() * bins), 0, bins - 1);
    }
    void collect(const CentredPose& pose, double gate, int stride) const;
    // A flank so steep that neighbours on it lie far apart: its points are on it, so its place is known.
    bool sampled_wall(std::size_t edge) const {
        const auto& e = model.edges()[edge];
        for (const int other : {e.previous, e.next})
            if (other >= 0 && model.edges()[other].wall &&
                std::abs(e.tx * model.edges()[other].tx + e.tz * model.edges()[other].tz) > 0.98)
                return true;
        return false;
    }
    void drop_sparse_walls() const;
    void collect_jumps(const CentredPose& pose, double gate) const;
    Finish finish(const CentredPose& start, double gate, int stride, int most_iterations) const;
    Rating rate(const Finish& finish, int stride) const;
    Eigen::Vector3d weakest_twist(const CentredPose& pose, double& share) const;
    Registration conclude(const Finish& finish, const SearchWindow* window) const;
    double apart_mm(const CentredPose& a, const CentredPose& b) const;
};

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

// A tilted wall is seen as a row of neighbouring points. Single points on it are clutter, and would fix what
// nothing fixes.
void ContourMatcher::Impl::drop_sparse_walls() const {
    if (jumps.empty()) return;
    wall_hits.assign(model.edges().size(), 0);
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const int edge = matches[i].foot.edge;
        if (!model.edges()[edge].wall) continue;
        const bool neighbours =
            i > 0 && matches[i - 1].foot.edge == edge && matches[i - 1].scene + 1 == matches[i].scene;
        wall_hits[edge] += neighbours ? kFewestOnWall : 1;
    }
    std::erase_if(matches, [&](const Match& m) {
        return model.edges()[m.foot.edge].wall && wall_hits[m.foot.edge] < kFewestOnWall;
    });
}

void ContourMatcher::Impl::collect_jumps(const CentredPose& pose, double gate) const {
    jump_matches.clear();
    for (const JumpEnd& t : jumps) {
        double best = std::numeric_limits<double>::infinity();
        JumpMatch match{};
        for (const JumpEnd& s : scene.jumps) {
            if (s.height < 0.5 * t.height || s.height > 2 * t.height) continue;
            const double ex = s.x - pose.dx, ez = s.z - pose.dz;
            const double qx = pose.cosine * ex + pose.sine * ez - t.x,
                         qz = -pose.sine * ex + pose.cosine * ez - t.z;
            const double outwards = (pose.cosine * s.tx + pose.sine * s.tz) * t.tx +
                                    (-pose.sine * s.tx + pose.cosine * s.tz) * t.tz;
            if (outwards < 0.7) continue;
            const double outside = qx * t.tx + qz * t.tz, across = qz * t.tx - qx * t.tz;
            if (std::abs(outside) > gate + 2 * (s.pitch + t.pitch) ||
                std::abs(across) > gate + 0.5 * t.height)
                continue;
            const double d = std::hypot(outside, across);
            if (d >= best) continue;
            best = d;
            // Moving the template's point (x, z) by (vx, vz) and a turn w: residual falls by t . (v + w (-z,
            // x)).
            match.row = {-t.tx, -t.tz, -(-t.tx * t.z + t.tz * t.x)};
            match.residual = outside;
            match.variance = (s.pitch * s.pitch + t.pitch * t.pitch) / 12 + scene.sigma_mm * scene.sigma_mm +
                             model.sigma_mm() * model.sigma_mm();
        }
        if (best < std::numeric_limits<double>::infinity()) jump_matches.push_back(match);
    }
}

namespace {

// Row of the Jacobian of the residual in the template's frame: shift along x, shift along z, turn about the
// template's centroid, all of the template in the scene.
struct Row {
    Eigen::Vector3d across, along;
};
inline Row row_of(const ContourModel::Edge& edge, double u) {
    const double bend = edge.curvature * u;
    const double norm = 1 / std::sqrt(1 + bend * bend);
    const double tx = (edge.tx - bend * edge.tz) * norm, tz = (edge.tz + bend * edge.tx) * norm;
    const double qx = edge.cx + u * edge.tx, qz = edge.cz + u * edge.tz;
    // normal (-tz, tx); turning moves the curve's point q by (-qz, qx) per radian.
    return {{tz, -tx, -(tz * qz + tx * qx)}, {-tx, -tz, -(-tx * qz + tz * qx)}};
}

Eigen::Vector3d solve_truncated(const Normal& normal, double length) {
    // Millimetre and radian are made alike by the template's length; directions without information stay put.
    const Eigen::Vector3d scale(1, 1, 1 / length);
    const Eigen::Matrix3d h = scale.asDiagonal() * normal.hessian * scale.asDiagonal();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(h);
    const double smallest = 1e-7 * eigen.eigenvalues()[2];
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    const Eigen::Vector3d g = scale.cwiseProduct(normal.gradient);
    for (int k = 0; k < 3; ++k)
        if (eigen.eigenvalues()[k] > smallest)
            step -=
                eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(g) / eigen.eigenvalues()[k]);
    return scale.cwiseProduct(step);
}

}  // namespace

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
        if (matches.size() < static_cast<std::size_t>(kFewestPoints)) break;
        sizes.clear();
        for (const Match& m : matches) sizes.push_back(std::abs(m.foot.residual));
        if (!settled) {
            const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
            std::nth_element(sizes.begin(), middle, sizes.end());
            result.sigma = kMadToSigma * *middle;
        }
        // Biweight while the gate closes; then every partner counts alike, which is what the covariance
        // assumes.
        Normal normal;
        double weight_sum = 0;
        const double over = 1 / (current * current);
        for (const Match& m : matches) {
            const Row row = row_of(model.edges()[m.foot.edge], m.foot.u);
            double w = 1;
            if (!settled) {
                w = 1 - m.foot.residual * m.foot.residual * over;
                w = w > 0 ? w * w : 0;
            }
            weight_sum += w;
            normal.hessian.noalias() += w * row.across * row.across.transpose();
            normal.gradient += w * m.foot.residual * row.across;
        }
        if (!(weight_sum > 0)) break;
        if (!jumps.empty()) {
            collect_jumps(result.pose, current);
            const double variance = std::max(result.sigma * result.sigma, 1e-10);
            for (const JumpMatch& j : jump_matches) {
                normal.hessian.noalias() += variance / j.variance * j.row * j.row.transpose();
                normal.gradient += variance / j.variance * j.residual * j.row;
            }
        }
        Eigen::Vector3d step = solve_truncated(normal, half);
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

ContourMatcher::Impl::Rating ContourMatcher::Impl::rate(const Finish& found, int stride) const {
    Rating rating;
    rating.pose = found.pose;
    rating.gate = std::clamp(found.gate, smallest_gate(), std::max(smallest_gate(), largest_final_gate()));
    // Scene points near the template that do not lie on it speak against the pose as missing partners do.
    const double capture = std::max(3 * rating.gate, std::min(2.0, 0.08 * model.extent_mm()));
    const double bin = 1.5 * std::max(model.pitch().distance, stride * scene.pitch.distance);
    bins = static_cast<int>(std::min(model.length_mm() / bin, 1e5)) + 1;
    covered.assign(static_cast<std::size_t>(bins) + 2, 0);
    collect(rating.pose, capture, stride);
    int &on = rating.on, &off = rating.off;
    for (const Match& m : matches) {
        const auto& edge = model.edges()[m.foot.edge];
        if (std::abs(m.foot.residual) > rating.gate) {
            ++off;
            continue;
        }
        ++on;
        if (edge.wall) continue;
        const int b = bin_of(static_cast<std::size_t>(m.foot.edge), m.foot.u);
        covered[b - 1] = covered[b] = covered[b + 1] = 1;
    }
    int marked = 0;
    for (int b = 1; b <= bins; ++b) marked += covered[b];
    rating.share = double(marked) / bins;
    rating.score = rating.share - (on + off > 0 ? 0.5 * off / double(on + off) : 0.5);
    return rating;
}

// Least determined motion in the template's frame, from the template alone, scaled to move its farthest parts
// by one millimetre per unit. `share`: its information beside that of the best determined one.
Eigen::Vector3d ContourMatcher::Impl::weakest_twist(const CentredPose&, double& share) const {
    const double half = 0.5 * model.extent_mm();
    const Eigen::Vector3d scale(1, 1, 1 / half);
    const Eigen::Matrix3d h = scale.asDiagonal() * template_information * scale.asDiagonal();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(h);
    share = eigen.eigenvalues()[2] > 0 ? eigen.eigenvalues()[0] / eigen.eigenvalues()[2] : 0;
    return scale.cwiseProduct(eigen.eigenvectors().col(0));
}

double ContourMatcher::Impl::apart_mm(const CentredPose& a, const CentredPose& b) const {
    double most = 0;
    for (const double x : {model.lower().x(), model.upper().x()})
        for (const double z : {model.lower().y(), model.upper().y()})
            most = std::max(most, (a * Eigen::Vector2d(x, z) - b * Eigen::Vector2d(x, z)).norm());
    return most;
}

Registration ContourMatcher::Impl::conclude(const Finish& found, const SearchWindow* window) const {
    Registration result;
    const Rating rating = rate(found, 1);
    const CentredPose& pose = found.pose;
    const Eigen::Vector2d& o = model.origin();
    const Eigen::Vector2d turned(pose.cosine * o.x() - pose.sine * o.y(),
                                 pose.sine * o.x() + pose.cosine * o.y());
    result.scene_from_template = {pose.dx + o.x() - turned.x(), pose.dz + o.y() - turned.y(), pose.phi};
    result.inlier_share = rating.share;
    result.iterations = iterations;

    collect(pose, rating.gate, 1);
    drop_sparse_walls();
    const auto n = static_cast<double>(matches.size());
    result.inliers = static_cast<int>(matches.size());
    if (matches.size() < static_cast<std::size_t>(kFewestPoints)) {
        result.status = RegistrationStatus::no_match;
        return result;
    }
    // Linearisation, in the template's frame: shift (x, z), turn about the centroid.
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), tilt = Eigen::Matrix3d::Zero();
    double rss = 0;
    // Noise across the contour as a function of its inclination: variance = level + slope * nz^2. A
    // triangulation sensor is noisy in z at given x, so a steep flank is quieter across than a flat; a drawn
    // contour may be noisy alike in all directions. Level and slope come from a regression of the squared
    // residuals.
    double s1 = 0, s2 = 0, sr = 0;
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const double nz2 = edge.tx * edge.tx, r2 = m.foot.residual * m.foot.residual;
        s1 += nz2;
        s2 += nz2 * nz2;
        sr += nz2 * r2;
        rss += r2;
    }
    const double mean_nz2 = s1 / n, spread_nz2 = s2 / n - mean_nz2 * mean_nz2;
    const double mean_r2 = rss / n;
    double noise_slope = spread_nz2 > 1e-3 ? (sr / n - mean_nz2 * mean_r2) / spread_nz2 : 0;
    noise_slope = std::clamp(noise_slope, 0.0, mean_nz2 > 0 ? mean_r2 / mean_nz2 : 0.0);
    const double noise_level = mean_r2 - noise_slope * mean_nz2;
    // Relative to the mean; the template, recorded with the same kind of sensor, is taken to behave alike.
    const auto relative = [&](const ContourModel::Edge& edge) {
        return mean_r2 > 0 ? std::max((noise_level + noise_slope * edge.tx * edge.tx) / mean_r2, 0.02) : 1.0;
    };

    const double template_variance = model.sigma_mm() * model.sigma_mm();
    // How every template point's noise enters the gradient: polynomials over windows of points, as difference
    // arrays.
    const int points = static_cast<int>(model.x().size());
    influence.assign(static_cast<std::size_t>(points) + 1,
                     {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    const double middle = 0.5 * points;
    double value_variance = 0, relative_sum = 0;
    Eigen::Matrix3d gradient_covariance = Eigen::Matrix3d::Zero();
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const Row row = row_of(edge, m.foot.u);
        const double level = relative(edge);
        information.noalias() += row.across * row.across.transpose();
        gradient_covariance.noalias() += level * row.across * row.across.transpose();
        relative_sum += level;
        const ContourModel::Weights w = model.weights(edge, m.foot.u);
        tilt.noalias() += w.slope_variance * level * row.along * row.along.transpose();
        value_variance += w.value_variance * level;
        // a0 + a1 (k - c) + a2 (k - c)^2 as a polynomial in k - middle.
        const double c = edge.centre - middle;
        const double size = std::sqrt(level);
        const std::array<double, 3> poly{w.a0 - w.a1 * c + w.a2 * c * c, w.a1 - 2 * w.a2 * c, w.a2};
        for (int j = 0; j < 3; ++j) {
            influence[edge.first][j] += size * poly[j] * row.across;
            influence[edge.first + edge.count][j] -= size * poly[j] * row.across;
        }
    }
    result.rms_mm = std::sqrt(mean_r2);
    result.noise_mm = std::max(std::hypot(scene.sigma_mm, model.sigma_mm()), 0.1 * model.pitch().distance);
    collect_jumps(pose, rating.gate);
    // residual^2 = scene noise^2 + template noise^2 * (variance of its fitted value)
    const double scene_variance =
        std::max(rss / std::max(1.0, n - 3) - template_variance * value_variance / n, 0.05 * mean_r2);
    gradient_covariance *= scene_variance * n / relative_sum;
    std::array<Eigen::Vector3d, 3> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                       Eigen::Vector3d::Zero()};
    for (int k = 0; k < points; ++k) {
        for (int j = 0; j < 3; ++j) sum[j] += influence[k][j];
        const double t = k - middle;
        const Eigen::Vector3d g = sum[0] + t * sum[1] + t * t * sum[2];
        gradient_covariance.noalias() += template_variance * g * g.transpose();
    }

    for (const JumpMatch& j : jump_matches) {
        const double weight = std::max(found.sigma * found.sigma, 1e-10) / j.variance;
        information.noalias() += weight * j.row * j.row.transpose();
        gradient_covariance.noalias() += weight * weight * j.variance * j.row * j.row.transpose();
    }
    // A wall's place in the template is known to a pitch, alike for all scene points on it.
    wall_gradient.assign(model.edges().size(), Eigen::Vector3d::Zero());
    for (const Match& m : matches)
        if (model.edges()[m.foot.edge].wall)
            wall_gradient[m.foot.edge] += row_of(model.edges()[m.foot.edge], m.foot.u).across;
    for (std::size_t e = 0; e < model.edges().size(); ++e)
        if (model.edges()[e].wall && !sampled_wall(e))
            gradient_covariance.noalias() += model.pitch().along_x * model.pitch().along_x / 12 *
                                             wall_gradient[e] * wall_gradient[e].transpose();

    // Directions that only the template's own noise seems to fix are not fixed: take its share out.
    tilt *= template_variance;
    const double half = 0.5 * model.extent_mm();
    const Eigen::Vector3d scale(1, 1, 1 / half);
    const Eigen::Matrix3d scaled = scale.asDiagonal() * information * scale.asDiagonal();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled);
    const Eigen::Vector3d weak = scale.cwiseProduct(eigen.eigenvectors().col(0));
    const double seen = eigen.eigenvalues()[0];
    const double false_part = weak.dot(tilt * weak);
    const bool sliding = seen < n * kStraight_rad * kStraight_rad || seen < 8 * false_part;

    const Eigen::Matrix2d r =
        (Eigen::Matrix2d() << pose.cosine, -pose.sine, pose.sine, pose.cosine).finished();
    Eigen::Matrix3d to_scene = Eigen::Matrix3d::Identity();
    to_scene.topLeftCorner<2, 2>() = r;
    // d = centroid motion + o - R o, so a turn moves d by -(dR/dphi) o.
    to_scene(0, 2) = turned.y();
    to_scene(1, 2) = -turned.x();

    // How much of what fixes the weakest direction was met: says whether the shape was found or only its
    // straights.
    double met = 0, expected = 0;
    for (std::size_t e = 0; e < model.edges().size(); ++e) {
        const ContourModel::Edge& edge = model.edges()[e];
        if (edge.wall) continue;
        const double part = std::pow(row_of(edge, 0).across.dot(weak), 2) * 2 * edge.half;
        expected += part;
        if (covered[bin_of(e, 0)]) met += part;
    }
    const double information_share = expected > 0 ? met / expected : 0;

    Eigen::Matrix3d usable = information - tilt;
    Eigen::Matrix3d covariance;
    {
        const Eigen::Matrix3d s = scale.asDiagonal() * usable * scale.asDiagonal();
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> e(s);
        // An undetermined direction gets a very large variance, finite so that callers can keep computing.
        const double least = 1e-9 * std::max(e.eigenvalues()[2], 1e-12);
        const Eigen::Vector3d inverse = e.eigenvalues().cwiseMax(least).cwiseInverse();
        const Eigen::Matrix3d inv = scale.asDiagonal() *
                                    (e.eigenvectors() * inverse.asDiagonal() * e.eigenvectors().transpose()) *
                                    scale.asDiagonal();
        covariance = inv * gradient_covariance * inv;
    }
    result.covariance = to_scene * covariance * to_scene.transpose();

    // Random points: as many beside the template as on it, and residuals that fill the gate evenly (0.58 of
    // it).
    const bool scatter = rating.off > 1.5 * rating.on || result.rms_mm > 0.45 * rating.gate;
    if (rating.share < kSmallestShare || scatter) {
        result.status = RegistrationStatus::no_match;
    } else if (sliding) {
        result.status = RegistrationStatus::sliding;
        result.covariance +=
            kUndetermined_mm * kUndetermined_mm * (to_scene * weak) * (to_scene * weak).transpose();
        Eigen::Vector2d q = reference - o;
        Eigen::Vector2d motion(weak.x() - weak.z() * q.y(), weak.y() + weak.z() * q.x());
        if (!(motion.norm() > 0.1 * weak.head<2>().norm() + 0.1 * std::abs(weak.z()) * half))
            motion = weak.head<2>();
        motion = r * motion;
        result.sliding_direction =
            motion.norm() > 0 ? Eigen::Vector2d(motion.normalized()) : Eigen::Vector2d(1, 0);
    } else if (information_share < kSmallestInformationShare) {
        result.status = RegistrationStatus::no_match;
    } else {
        result.status = RegistrationStatus::ok;
    }
    if (window && result.status == RegistrationStatus::ok) {
        const MotionBox box = motion_box(*window, o, reference, pose.phi);
        const double margin = 0.1 * std::max(window->dx_mm, window->dz_mm) + 0.5;
        if (!box.contains(pose.dx, pose.dz, margin) || std::abs(pose.phi) > 1.1 * window->phi_rad + 0.01)
            result.status = RegistrationStatus::no_match;
    }
    return result;
}

ContourMatcher::ContourMatcher(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ContourMatcher::ContourMatcher(ContourMatcher&&) noexcept = default;
ContourMatcher& ContourMatcher::operator=(ContourMatcher&&) noexcept = default;
ContourMatcher::~ContourMatcher() = default;

Expected<ContourMatcher> ContourMatcher::make(const Profile& contour, const Eigen::Vector2d& reference_mm) {
    if (contour.x_mm.size() != contour.z_mm.size())
        return input_error("the template has unequal numbers of x and z", "template");
    if (!reference_mm.allFinite())
        return input_error("the template's reference point is not finite", "template",
                           "give two numbers in mm");
    auto impl = std::make_unique<Impl>();
    impl->model.build(contour);
    if (impl->model.x().size() < static_cast<std::size_t>(kFewestPoints))
        return input_error("the template has fewer than 5 usable points", "template",
                           "take a longer piece of contour");
    if (!impl->model.usable())
        return input_error("the template has no extent: its points do not form a contour", "template",
                           "take a piece of contour some millimetres long");
    impl->reference = reference_mm;
    impl->search.prepare(impl->model);
    double length = 0;
    for (const auto& edge : impl->model.edges()) {
        impl->arc.push_back(length);
        if (edge.wall) continue;
        const Row row = row_of(edge, 0);
        impl->template_information += 2 * edge.half * row.across * row.across.transpose();
        length += 2 * edge.half;
    }
    if (!(length > 0))
        return input_error("the template has no connected piece of contour", "template",
                           "take points in sensor order");
    impl->template_information /= length;
    const auto& tx = impl->model.x();
    const auto& tz = impl->model.z();
    for (std::size_t e = 0; e < impl->model.edges().size(); ++e) {
        const auto& edge = impl->model.edges()[e];
        if (!edge.wall || impl->sampled_wall(e)) continue;
        const bool rising = tz[edge.point + 1] > tz[edge.point];
        impl->jumps.push_back(jump_end(tx, tz, rising ? edge.point : edge.point + 1,
                                       rising ? edge.point + 1 : edge.point, 0,
                                       static_cast<int>(tx.size()) - 1));
    }
    impl->finder = impl->search;
    return ContourMatcher(std::move(impl));
}

Registration ContourMatcher::match(const Profile& scene, const SearchWindow& window) const {
    const Impl& m = *impl_;
    m.iterations = 0;
    Registration result;
    if (!std::isfinite(window.dx_mm) || !std::isfinite(window.dz_mm) || !std::isfinite(window.phi_rad) ||
        !window.centre_mm.allFinite())
        return result;
    // What the template cannot reach is no part of the search: a stray point a kilometre off costs nothing.
    const double arm =
        std::max((m.reference - m.model.origin()).norm(),
                 window.pivot == SearchPivot::reference_or_origin ? m.model.origin().norm() : 0.0);
    const double turn = std::min(1.1 * std::abs(window.phi_rad) + 0.02, 3.2);
    const double reach = m.model.extent_mm() + window.centre_mm.norm() +
                         1.2 * std::hypot(window.dx_mm, window.dz_mm) +
                         2 * arm * std::sin(0.5 * std::min(turn, 3.1)) + 3;
    m.scene.gather(scene, m.model.origin(), Eigen::Vector2d::Zero(), reach);
    if (m.scene.x.size() < static_cast<std::size_t>(kFewestPoints)) {
        result.status = RegistrationStatus::no_points;
        return result;
    }
    m.scene.reduce(
        std::max(m.search.reduction_tolerance_mm(), std::min(3 * m.scene.sigma_mm, m.search.step_mm())),
        m.search.step_mm());
    constexpr int kStarts = 8, kFinished = 3, kAlong = 4;
    m.finder.find(m.scene, window, m.model.origin(), m.reference, kStarts, m.candidates);
    const int stride = std::max(1, static_cast<int>(m.scene.x.size()) / 250);
    const int rating_stride = std::max(1, static_cast<int>(m.scene.x.size()) / 500);
    const double start_gate = 1.2 * m.search.step_mm();
    Impl::Rating best, second;
    auto consider = [&](const CentredPose& start, double gate) {
        // What lies within the basin of the best one would end there.
        if (best.score >= 0 && m.apart_mm(best.pose, start) < 0.7 * m.search.step_mm()) return;
        const Impl::Finish f = m.finish(start, gate, stride, 20);
        const Impl::Rating r = m.rate(f, rating_stride);
        const MotionBox box = motion_box(window, m.model.origin(), m.reference, r.pose.phi);
        if (!box.contains(r.pose.dx, r.pose.dz, 0.1 * std::max(window.dx_mm, window.dz_mm) + 0.5) ||
            std::abs(r.pose.phi) > 1.1 * window.phi_rad + 0.01)
            return;
        const double apart = std::max(m.search.step_mm(), 3 * r.gate);
        const bool same = best.score >= 0 && m.apart_mm(best.pose, r.pose) < apart;
        if (r.score > best.score) {
            if (!same) second = best;
            best = r;
        } else if (!same && r.score > second.score) {
            second = r;
        }
    };
    for (std::size_t i = 0; i < m.candidates.size() && i < static_cast<std::size_t>(kFinished); ++i)
        consider(m.candidates[i].pose, start_gate);
    if (best.score < 0) {
        result.status = RegistrationStatus::no_match;
        result.iterations = m.iterations;
        return result;
    }
    // A small shape on a long straight: the straight is met everywhere, so look along it for the shape.
    double share = 1;
    const Eigen::Vector3d twist = m.weakest_twist(best.pose, share);
    if (share < 0.15) {
        const double step = 0.25 * m.search.step_mm();
        const double along_reach = 2.5 * std::max(window.dx_mm, window.dz_mm);
        const double tolerance = std::max(0.3 * m.search.step_mm(), best.gate);
        m.finder.find_along(m.scene, best.pose, twist, along_reach, step, tolerance, window, m.model.origin(),
                            m.reference, kAlong, m.along);
        // Far fewer partners than here, shape and all: not worth a finish.
        const double here = m.finder.rate(m.scene, best.pose, tolerance);
        for (const SearchCandidate& c : m.along)
            if (c.score > here - kHopeless) consider(c.pose, start_gate);
    }
    const Impl::Finish f = m.finish(best.pose, std::max(2 * best.gate, m.smallest_gate()), 1, 30);
    result = m.conclude(f, &window);
    if (result.status == RegistrationStatus::ok && second.score > best.score - 2 * kRatingNoise) {
        // Both to their end and rated alike: a start that was merely on its way is no second place.
        Impl::Finish other = m.finish(second.pose, start_gate, 1, 40);
        other.gate = f.gate;
        const double score = m.rate(other, 1).score;
        if (m.apart_mm(other.pose, f.pose) > std::max(m.search.step_mm(), 3 * f.gate) &&
            score > m.rate(f, 1).score - kRatingNoise)
            result.status = RegistrationStatus::ambiguous;
    }
    return result;
}

Registration ContourMatcher::refine(const Profile& scene, const PlanarMotion& start) const {
    const Impl& m = *impl_;
    m.iterations = 0;
    Registration result;
    const Eigen::Vector2d d = start * m.model.origin() - m.model.origin();
    if (!d.allFinite() || !std::isfinite(start.phi_rad)) return result;
    m.scene.gather(scene, m.model.origin(), d, m.model.extent_mm() + 3);
    if (m.scene.x.size() < static_cast<std::size_t>(kFewestPoints)) {
        result.status = RegistrationStatus::no_points;
        return result;
    }
    const Impl::Finish f = m.finish(CentredPose(d.x(), d.y(), start.phi_rad), 1.5, 1, 40);
    return m.conclude(f, nullptr);
}

Eigen::Vector2d PlanarMotion::operator*(const Eigen::Vector2d& p) const {
    const double c = std::cos(phi_rad), s = std::sin(phi_rad);
    return {c * p.x() - s * p.y() + dx_mm, s * p.x() + c * p.y() + dz_mm};
}

std::string_view to_string(RegistrationStatus status) {
    switch (status) {
        case RegistrationStatus::ok:
            return "ok";
        case RegistrationStatus::no_points:
            return "no_points";
        case RegistrationStatus::no_match:
            return "no_match";
        case RegistrationStatus::ambiguous:
            return "ambiguous";
        case RegistrationStatus::sliding:
            return "sliding";
    }
    return "no_match";
}

}  // namespace seamwright
