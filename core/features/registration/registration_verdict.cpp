#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/features/registration/registration_kernel.h"

namespace seamwright {
namespace {

// Stated sigma of an undetermined motion, in mm at the template's farther parts.
constexpr double kUndetermined_mm = 1e3;
// The template counts as found when at least this share of its length that can be seen has a partner, and that of all...
constexpr double kSmallestShare = 0.5, kLeastOfAll = 0.3;
// ... and at least this share of what fixes each of its directions.
constexpr double kSmallestInformationShare = 0.35;

// What else is there in the template's place is asked below this share, and this much of it is another contour.
constexpr double kMuchSeen = 0.85, kMostReplaced = 0.25;

// Slopes worth fewer points than this may be chance.
constexpr double kFewPoints = 10;
// So many points, were they alike, at least tell of a direction.
constexpr double kFewestTelling = 3;
// Of a search step: ends that are known less well (a shadow that a turn moves) hold no place.
constexpr double kEndsTell = 0.6;

// Noise of neighbours is alike: interpolation onto a grid, a sensor's own smoothing, speckle. A lag counts as long as it and all
// below it stand out of chance.
constexpr int kMostLags = 12;
constexpr double kAlikeByChance = 1;  // over sqrt(pairs)
constexpr std::size_t kFewestPairs = 20;

// Random points: as many beside the template as on it, and residuals that fill the gate evenly (0.58 of it).
constexpr double kBesideTemplate = 1.5, kFillsGate = 0.45;

}  // namespace

ContourMatcher::Impl::AcrossNoise ContourMatcher::Impl::across_noise() const {
    constexpr double kLeastSpread = 1e-3;  // of the inclinations, to tell a slope
    const auto n = static_cast<double>(matches.size());
    double s1 = 0, s2 = 0, sr = 0, rss = 0;
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const double nz2 = edge.tx * edge.tx, r2 = m.foot.residual * m.foot.residual;
        s1 += nz2;
        s2 += nz2 * nz2;
        sr += nz2 * r2;
        rss += r2;
    }
    const double mean_nz2 = s1 / n, spread_nz2 = s2 / n - mean_nz2 * mean_nz2;
    AcrossNoise noise;
    noise.mean_square = rss / n;
    noise.slope = spread_nz2 > kLeastSpread ? (sr / n - mean_nz2 * noise.mean_square) / spread_nz2 : 0;
    // Not below a tenth of the mean on the flattest and on the steepest.
    constexpr double kLeastShare = 0.1;
    const double most = mean_nz2 > 0 ? noise.mean_square / mean_nz2 : 0;
    noise.slope =
        std::clamp(noise.slope, -(1 - kLeastShare) * noise.mean_square / std::max(1 - mean_nz2, 0.1), most);
    noise.level = noise.mean_square - noise.slope * mean_nz2;
    return noise;
}

ContourMatcher::Impl::NormalEquations ContourMatcher::Impl::normal_equations(const AcrossNoise& noise,
                                                                             const Finish& finish,
                                                                             double gate) const {
    const auto n = static_cast<double>(matches.size());
    const double template_variance = model.sigma_mm() * model.sigma_mm();
    // How every template point's noise enters the gradient: polynomials over windows of points, as difference
    // arrays.
    const auto points = static_cast<double>(model.x().size());
    influence.assign(model.x().size() + 1,
                     {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    const double middle = 0.5 * points;
    double value_variance = 0, relative_sum = 0;
    NormalEquations normal;
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const RegistrationRow row = registration_row(edge, m.foot.u);
        const double level = noise.relative(edge);
        normal.information.noalias() += row.across * row.across.transpose();
        normal.gradient.noalias() += level * row.across * row.across.transpose();
        relative_sum += level;
        const ContourModel::Weights w = model.weights(edge, m.foot.u);
        normal.tilt.noalias() += w.slope_variance * level * row.along * row.along.transpose();
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
    collect_jumps(finish.pose, gate);
    // residual^2 = scene noise^2 + template noise^2 * (variance of its fitted value)
    constexpr double kLeastOfScene = 0.05;
    const double rss = noise.mean_square * n;
    const double scene_variance =
        std::max(rss / std::max(1.0, n - 3) - template_variance * value_variance / n,
                 kLeastOfScene * noise.mean_square);
    normal.gradient *= scene_variance * n / relative_sum;
    add_template_noise(normal);
    const double widening = correlation(noise, scene_variance);
    normal.gradient *= widening;
    add_jumps_and_walls(normal, finish.sigma);
    // Directions that only the template's own noise seems to fix are not fixed.
    normal.tilt *= widening * template_variance;
    return normal;
}

double ContourMatcher::Impl::correlation(const AcrossNoise& noise, double scene_variance) const {
    const double template_variance = model.sigma_mm() * model.sigma_mm();
    // What two partners share of the template's noise: both feet are fitted to some of the same points.
    const auto shared = [&](const Match& m, const Match& other) {
        const ContourModel::Edge &a = model.edges()[m.foot.edge], &b = model.edges()[other.foot.edge];
        const ContourModel::Weights v = model.weights(a, m.foot.u), w = model.weights(b, other.foot.u);
        double sum = 0;
        for (int k = std::max(a.first, b.first); k < std::min(a.first + a.count, b.first + b.count); ++k) {
            const double s = k - a.centre, t = k - b.centre;
            sum += (v.a0 + s * (v.a1 + s * v.a2)) * (w.a0 + t * (w.a1 + t * w.a2));
        }
        return template_variance * sum;
    };
    double widening = 1;
    for (int lag = 1; lag <= kMostLags; ++lag) {
        double product = 0;
        std::size_t pairs = 0, ahead = 0;
        for (const Match& m : matches) {
            while (ahead < matches.size() && matches[ahead].scene < m.scene + lag) ++ahead;
            if (ahead == matches.size()) break;
            const Match& other = matches[ahead];
            if (other.scene != m.scene + lag) continue;
            const double size = std::sqrt(noise.relative(model.edges()[m.foot.edge]) *
                                          noise.relative(model.edges()[other.foot.edge]));
            product += m.foot.residual * other.foot.residual / size - shared(m, other);
            ++pairs;
        }
        if (pairs < kFewestPairs) break;
        const auto n = static_cast<double>(pairs);
        // The fit takes about three unknowns' share out of every lag.
        const double r = product / (n * scene_variance) + 3 * widening / n;
        if (!(r > kAlikeByChance / std::sqrt(n))) break;
        widening += 2 * std::min(r, 1.0);
    }
    return widening;
}

void ContourMatcher::Impl::add_template_noise(NormalEquations& normal) const {
    const double template_variance = model.sigma_mm() * model.sigma_mm();
    const double middle = 0.5 * static_cast<double>(model.x().size());
    std::array<Eigen::Vector3d, 3> sum{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                       Eigen::Vector3d::Zero()};
    for (std::size_t k = 0; k < model.x().size(); ++k) {
        for (int j = 0; j < 3; ++j) sum[j] += influence[k][j];
        const double t = static_cast<double>(k) - middle;
        const Eigen::Vector3d g = sum[0] + t * sum[1] + t * t * sum[2];
        normal.gradient.noalias() += template_variance * g * g.transpose();
    }
}

void ContourMatcher::Impl::add_jumps_and_walls(NormalEquations& normal, double sigma) const {
    for (const JumpMatch& j : jump_matches) {
        const double weight = std::max(sigma * sigma, 1e-10) / j.variance;
        normal.information.noalias() += weight * j.row * j.row.transpose();
        normal.gradient.noalias() += weight * weight * j.variance * j.row * j.row.transpose();
    }
    // A wall's place in the template is known to a pitch, alike for all scene points on it.
    wall_gradient.assign(model.edges().size(), Eigen::Vector3d::Zero());
    for (const Match& m : matches)
        if (model.edges()[m.foot.edge].wall)
            wall_gradient[m.foot.edge] += registration_row(model.edges()[m.foot.edge], m.foot.u).across;
    const double pitch_variance = model.pitch().along_x * model.pitch().along_x / 12;
    for (std::size_t e = 0; e < model.edges().size(); ++e)
        if (model.edges()[e].wall && !sampled_wall(e))
            normal.gradient.noalias() += pitch_variance * wall_gradient[e] * wall_gradient[e].transpose();
}

// Where the slopes leave the motion along the twist open, ends of sheets that both have hold it, each to a pitch.
ContourMatcher::Impl::Held ContourMatcher::Impl::held_by_ends(const Eigen::Vector3d& twist) const {
    double told = 0, pull = 0;
    for (const JumpMatch& j : jump_matches) {
        const double share = j.row.dot(twist);
        told += share * share / j.variance;
        pull -= share * j.residual / j.variance;
    }
    Held place;
    if (!(told * std::pow(kEndsTell * search.step_mm(), 2) > 1)) return place;
    place.held = true;
    place.shift = std::clamp(pull / told, -search.step_mm(), search.step_mm());
    place.variance = 1 / told;
    return place;
}

bool ContourMatcher::Impl::smooth_instead(const CentredPose& pose) const {
    constexpr double kStandsOut = 5;  // twice the sigmas that tell the template from the parabola
    const auto n = static_cast<Eigen::Index>(matches.size());
    if (n < kFewestRegistrationPoints) return false;
    Eigen::Matrix2Xd feet(2, n), points(2, n);
    Eigen::VectorXd residuals(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const Match& m = matches[static_cast<std::size_t>(k)];
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const auto at = static_cast<std::size_t>(m.scene);
        const double ex = scene.x[at] - pose.dx, ez = scene.z[at] - pose.dz;
        feet.col(k) << edge.cx + m.foot.u * edge.tx, edge.cz + m.foot.u * edge.tz;
        points.col(k) << pose.cosine * ex + pose.sine * ez, -pose.sine * ex + pose.cosine * ez;
        residuals[k] = m.foot.residual;
    }
    const Eigen::Vector2d middle = feet.rowwise().mean();
    feet.colwise() -= middle;
    points.colwise() -= middle;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(Eigen::Matrix2d(feet * feet.transpose()));
    const double length = std::sqrt(eigen.eigenvalues()[1] / static_cast<double>(n));
    if (!(length > 0)) return false;
    // What a parabola along the template's longer axis leaves.
    const auto left = [&](const Eigen::Matrix2Xd& p) -> Eigen::VectorXd {
        const Eigen::ArrayXd t = p.transpose() * eigen.eigenvectors().col(1) / length;
        const Eigen::VectorXd height = p.transpose() * eigen.eigenvectors().col(0);
        Eigen::MatrixX3d a(n, 3);
        a << Eigen::ArrayXd::Ones(n), t, t.square();
        return height - a * (a.transpose() * a).ldlt().solve(a.transpose() * height);
    };
    const Eigen::VectorXd of_feet = left(feet), of_points = left(points);
    // With r the residuals, d the template's form over its parabola and w the waves that its noise adds to d: the points
    // leave (r + d)^2. Where the template is right, r is noise - w, else it is noise - d; the middle of the two is w^2.
    const double windows = fit_variance * static_cast<double>(n),
                 waves = windows * model.sigma_mm() * model.sigma_mm();
    if (residuals.squaredNorm() - of_points.squaredNorm() <= waves) return false;
    const double variance = of_points.squaredNorm() / static_cast<double>(n),
                 form = of_feet.squaredNorm() - waves;
    return form >
           kStandsOut * std::sqrt((form + waves) * variance + 2 * waves * waves / std::max(windows, 1.0));
}

ContourMatcher::Impl::SceneSlope ContourMatcher::Impl::scene_slope(int at, int reach) const {
    constexpr double kNeighbours = 5;  // pitches
    const double near = kNeighbours * scene.pitch.distance;
    const auto neighbours = [&](int a, int b) {
        const double dx = scene.x[static_cast<std::size_t>(b)] - scene.x[static_cast<std::size_t>(a)],
                     dz = scene.z[static_cast<std::size_t>(b)] - scene.z[static_cast<std::size_t>(a)];
        return dx * dx + dz * dz < near * near;
    };
    const int last = static_cast<int>(scene.x.size()) - 1;
    int from = at, to = at;
    while (from > 0 && from > at - reach && neighbours(from - 1, from)) --from;
    while (to < last && to < at + reach && neighbours(to, to + 1)) ++to;
    SceneSlope slope;
    slope.count = to - from + 1;
    if (slope.count < 3) return slope;
    double ax = 0, az = 0;
    for (int i = from; i <= to; ++i) {
        const double k = i - 0.5 * (from + to);
        ax += k * scene.x[static_cast<std::size_t>(i)];
        az += k * scene.z[static_cast<std::size_t>(i)];
    }
    const double spread = slope.count * (double(slope.count) * slope.count - 1) / 12;
    const double advance = std::sqrt(ax * ax + az * az) / spread;
    if (!(advance > 0)) return slope;
    slope.tx = ax / spread / advance;
    slope.tz = az / spread / advance;
    slope.variance = 1 / (spread * advance * advance);
    return slope;
}

ContourMatcher::Impl::Weakest ContourMatcher::Impl::weakest(const CentredPose& pose,
                                                            const AcrossNoise& noise) const {
    // So many points of the scene to a slope that noise turns it by less than about a seventh.
    constexpr double kSureSlope = 500;
    const double grain = scene.sigma_mm / std::max(scene.pitch.along_x, 1e-9);
    const int reach =
        std::clamp(static_cast<int>(std::ceil(0.5 * std::cbrt(kSureSlope * grain * grain))), 2, 20);
    crossed.clear();
    Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
    for (const Match& m : matches) {
        const ContourModel::Edge& edge = model.edges()[m.foot.edge];
        const RegistrationRow row = registration_row(edge, m.foot.u);
        SceneSlope slope = scene_slope(m.scene, reach);
        Crossed c{row.across, Eigen::Vector3d::Zero(), row.along, 0, 1};
        if (slope.variance > 0) {
            double tx = pose.cosine * slope.tx + pose.sine * slope.tz,
                   tz = -pose.sine * slope.tx + pose.cosine * slope.tz;
            if (tx * edge.tx + tz * edge.tz < 0) tx = -tx, tz = -tz;
            const double qx = edge.cx + m.foot.u * edge.tx, qz = edge.cz + m.foot.u * edge.tz;
            c.of_scene = {tz, -tx, -(tz * qz + tx * qx)};
            c.scene_doubt = noise.mean_square * noise.relative(edge) * slope.variance * scene.pitch.alike();
            c.count = slope.count;
        }
        common += 0.5 * (c.of_template * c.of_scene.transpose() + c.of_scene * c.of_template.transpose());
        crossed.push_back(c);
    }
    const Eigen::Vector3d scale(1, 1, 2 / model.extent_mm());
    const Eigen::Matrix3d scaled = scale.asDiagonal() * common * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled);
    Weakest weak;
    weak.scaled = eigen.eigenvectors().col(0);
    weak.twist = scale.cwiseProduct(weak.scaled);
    weak.seen = eigen.eigenvalues()[0];
    // Points on the same fitted piece share its slope's error, in the template as in the scene.
    const double per_window = model.pitch().along_x / scene.pitch.along_x;
    double scatter = 0, told2 = 0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        const Crossed& c = crossed[i];
        const ContourModel::Edge& edge = model.edges()[matches[i].foot.edge];
        const double along2 = std::pow(c.along.dot(weak.twist), 2);
        const double t = c.of_template.dot(weak.twist), s = c.of_scene.dot(weak.twist);
        const double of_template = slope_doubt[static_cast<std::size_t>(matches[i].foot.edge)] * along2;
        const double of_scene = c.scene_doubt * along2;
        told2 += t * s * t * s;
        scatter += s * s * of_template * std::max(1.0, edge.count * per_window) +
                   t * t * of_scene * std::max(1.0, double(c.count));
    }
    // One point on the foot of a flank is no flank.
    const bool lonely = weak.seen * weak.seen < kFewestTelling * told2;
    weak.unsure = lonely || weak.seen < static_cast<double>(matches.size()) * kStraight_rad * kStraight_rad +
                                            4 * std::sqrt(scatter);
    return weak;
}

ContourMatcher::Impl::Weakest ContourMatcher::Impl::weakest_at(const Finish& found) const {
    collect(found.pose, found.gate, 1);
    drop_sparse_walls();
    return matches.size() < static_cast<std::size_t>(kFewestRegistrationPoints)
               ? Weakest{}
               : weakest(found.pose, across_noise());
}

Eigen::Matrix3d ContourMatcher::Impl::twist_covariance(const NormalEquations& normal, const Weakest& weak,
                                                       const Held& apart) const {
    const Eigen::Vector3d scale(1, 1, 2 / model.extent_mm());
    const Eigen::Matrix3d usable = normal.information - normal.tilt;
    // Held by the points, not by the slopes: the rest is solved without this direction.
    const Eigen::Matrix3d rest =
        Eigen::Matrix3d::Identity() -
        (apart.held ? 1.0 : 0.0) * Eigen::Matrix3d(weak.scaled * weak.scaled.transpose());
    const Eigen::Matrix3d s = rest * scale.asDiagonal() * usable * scale.asDiagonal() * rest;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> e(s);
    // An undetermined direction gets a very large variance, finite so that callers can keep computing.
    const double least = 1e-9 * std::max(e.eigenvalues()[2], 1e-12);
    const Eigen::Vector3d inverse = e.eigenvalues().cwiseMax(least).cwiseInverse();
    const Eigen::Matrix3d inv = scale.asDiagonal() *
                                (e.eigenvectors() * inverse.asDiagonal() * e.eigenvectors().transpose()) *
                                scale.asDiagonal();
    const Eigen::Matrix3d solved = scale.asDiagonal() * rest * scale.cwiseInverse().asDiagonal() * inv;
    Eigen::Matrix3d covariance = solved * normal.gradient * solved.transpose();
    if (apart.held) covariance += apart.variance * weak.twist * weak.twist.transpose();
    return covariance;
}

double ContourMatcher::Impl::misfit_variance() const {
    constexpr std::size_t kBlock = 10;
    constexpr double kStandsOut = 3.5;  // sigma of its scatter by chance
    const double alike = std::max(scene.pitch.alike(), model.pitch().alike());
    const double of_scene = scene.sigma_mm * scene.sigma_mm * alike,
                 of_template = model.sigma_mm() * model.sigma_mm() * alike;
    const auto many = static_cast<std::size_t>(std::ceil(kBlock * alike));
    double beyond = 0, scatter = 0;
    int blocks = 0;
    for (std::size_t first = 0; first + many <= matches.size(); first += many) {
        double sum = 0, curve = 0;
        for (std::size_t i = first; i < first + many; ++i) {
            const Match& m = matches[i];
            sum += m.foot.residual;
            curve += model.weights(model.edges()[m.foot.edge], m.foot.u).value_variance;
        }
        const auto n = static_cast<double>(many);
        const double by_chance = of_scene / n + of_template * curve / n;
        beyond += sum * sum / (n * n) - by_chance;
        scatter += 2 * by_chance * by_chance;
        ++blocks;
    }
    return beyond > kStandsOut * std::sqrt(scatter) ? beyond / blocks : 0;
}

Registration ContourMatcher::Impl::conclude(const Finish& found, const Support& rating, double sigma) const {
    Registration result;
    CentredPose pose = found.pose;
    const Eigen::Vector2d& o = model.origin();
    const auto set_pose = [&] {
        const Eigen::Vector2d turned(pose.cosine * o.x() - pose.sine * o.y(),
                                     pose.sine * o.x() + pose.cosine * o.y());
        result.scene_from_template = {pose.dx + o.x() - turned.x(), pose.dz + o.y() - turned.y(), pose.phi};
        return turned;
    };
    set_pose();
    result.inlier_share = rating.share;
    if (rating.share < kMuchSeen) result.replaced_share = replaced(found, sigma);
    result.iterations = iterations;
    collect(pose, rating.gate, 1);
    drop_sparse_walls();
    result.inliers = static_cast<int>(matches.size());
    if (matches.size() < static_cast<std::size_t>(kFewestRegistrationPoints)) {
        result.status = RegistrationStatus::no_match;
        return result;
    }
    const AcrossNoise noise = across_noise();
    result.rms_mm = std::sqrt(noise.mean_square);
    result.noise_mm = std::max(std::hypot(scene.sigma_mm, model.sigma_mm()), 0.1 * model.pitch().distance);
    const NormalEquations normal = normal_equations(noise, found, rating.gate);
    const Weakest weak = weakest(pose, noise);

    // Where the slopes leave it open, what the points say about a small motion along the direction decides.
    const bool open = weak.unsure || !directions[0].determined;
    const Held ends = held_by_ends(weak.twist);
    // What turned away with the pose is not missing.
    const TurnedAway away = turned_away(pose);
    Support visible = rating;
    visible.missing = std::max(0.0, rating.missing - away.cost);
    const bool thin = !ends.held && weak.seen < kFewPoints;
    Held place;
    if (open || thin) {
        place = ends.held ? ends : held(found, rating, sigma, weak.twist, telling_difference(visible));
        // What holds a place there is mostly where surfaces end, in either contour no better known than its last points.
        if (!ends.held)
            place.variance += scene.sigma_mm * scene.sigma_mm + model.sigma_mm() * model.sigma_mm() +
                              model.pitch().along_x * model.pitch().along_x / 12;
    }
    const bool sliding = (open || thin) && !place.held;
    place.held = place.held && open;
    if (place.held) {
        pose = moved_along(pose, weak.twist, place.shift);
    } else if (ends.held && !open) {
        // The finish takes the waves of the template's own noise for slopes and may rest in one of them, off the ends that
        // know better: slopes count here for what they tell beyond that noise.
        const double told = 1 / ends.variance,
                     slopes = weak.seen / std::max(found.sigma * found.sigma, 1e-10);
        pose = moved_along(pose, weak.twist, ends.shift * told / (told + std::max(slopes, 0.0)));
    }
    if (open || thin || ends.held) {  // held() has looked elsewhere, or the pose was moved
        collect(pose, rating.gate, 1);
        drop_sparse_walls();
    }
    const bool smooth = smooth_instead(pose);
    const Eigen::Vector2d turned = set_pose();
    const Eigen::Matrix2d r =
        (Eigen::Matrix2d() << pose.cosine, -pose.sine, pose.sine, pose.cosine).finished();
    Eigen::Matrix3d to_scene = Eigen::Matrix3d::Identity();
    to_scene.topLeftCorner<2, 2>() = r;
    // d = centroid motion + o - R o, so a turn moves d by -(dR/dphi) o.
    to_scene(0, 2) = turned.y();
    to_scene(1, 2) = -turned.x();
    result.covariance = to_scene * twist_covariance(normal, weak, place) * to_scene.transpose();
    result.covariance.topLeftCorner<2, 2>().diagonal().array() += misfit_variance();

    const bool scatter = rating.off > kBesideTemplate * rating.on || result.rms_mm > kFillsGate * rating.gate;
    // What fixes a direction must be there, or it is not known in it, however well the rest fits. Where most
    // of it is hidden, what is left must hold the direction.
    int unmet = 0, least = 0;
    for (int k = 0; k < 3; ++k) {
        if (rating.informed[k] >= kSmallestInformationShare) continue;
        if (held(found, rating, sigma, directions[k].twist, telling_difference(rating)).held) continue;
        ++unmet;
        if (rating.informed[k] < rating.informed[least]) least = k;
    }
    const double enough = std::max(kSmallestShare * (1 - away.share), kLeastOfAll);
    if (rating.share < enough || scatter || unmet > 1) {
        result.status = RegistrationStatus::no_match;
    } else if (sliding || smooth || unmet > 0) {
        result.status = RegistrationStatus::sliding;
        const Eigen::Vector3d free = sliding || smooth ? weak.twist : directions[least].twist;
        result.covariance +=
            kUndetermined_mm * kUndetermined_mm * (to_scene * free) * (to_scene * free).transpose();
        const Eigen::Vector2d q = reference - o;
        Eigen::Vector2d motion(free.x() - free.z() * q.y(), free.y() + free.z() * q.x());
        const double half = 0.5 * model.extent_mm();
        if (!(motion.norm() > 0.1 * free.head<2>().norm() + 0.1 * std::abs(free.z()) * half))
            motion = free.head<2>();
        motion = r * motion;
        result.sliding_direction =
            motion.norm() > 0 ? Eigen::Vector2d(motion.normalized()) : Eigen::Vector2d(1, 0);
    } else {
        result.status =
            result.replaced_share > kMostReplaced ? RegistrationStatus::other_shape : RegistrationStatus::ok;
    }
    return result;
}

}  // namespace seamwright
