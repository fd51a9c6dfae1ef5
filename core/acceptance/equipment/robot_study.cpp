#include "core/acceptance/equipment/robot_study.h"

#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/pose.h"

namespace seamwright {
namespace {

// A component, or a direction, that the spots see this much weaker than the best is not seen.
constexpr double kUnseen = 0.1;

// Of one spot, in the coordinates that it observes.
struct Scatter {
    Eigen::MatrixXd sees;          // k x 3
    Eigen::MatrixXd means, noise;  // covariances: of the returns' means; of one profile
    double degrees = 0, noise_degrees = 0;
    double share = 1;  // of `noise` that is in `means`
    Eigen::MatrixXd arrival() const { return means - share * noise; }
};

Eigen::MatrixXd root_of_scatter(const Eigen::MatrixXd& covariance) {
    const SymmetricEigen e = symmetric_eigen(covariance);
    return e.vectors * e.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd without_negative(const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd root = root_of_scatter(covariance);
    return root * root.transpose();
}

// Unit directions spread evenly, of 2 or 3 dimensions.
Eigen::MatrixXd even_directions(Eigen::Index dimensions) {
    if (dimensions == 1) return Eigen::MatrixXd::Ones(1, 1);
    const Eigen::Index count = dimensions == 2 ? 64 : 400;
    Eigen::MatrixXd u(dimensions, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        if (dimensions == 2) {
            u.col(i) << std::cos(2 * kPi * at), std::sin(2 * kPi * at);
        } else {  // Fibonacci's lattice
            const double h = 1 - 2 * at, turn = kPi * (1 + std::sqrt(5.0)) * static_cast<double>(i);
            const double radius = std::sqrt(1 - h * h);
            u.col(i) << radius * std::cos(turn), radius * std::sin(turn), h;
        }
    }
    return u;
}

// Symmetric 3 x 3 as six numbers whose length is the Frobenius norm, and back.
constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
double weight_of(int pair) {
    return pair < 3 ? 1 : std::sqrt(2.0);
}
Eigen::Matrix3d symmetric_from(const Eigen::VectorXd& six) {
    Eigen::Matrix3d c;
    for (int p = 0; p < 6; ++p)
        c(kPairs[p][0], kPairs[p][1]) = c(kPairs[p][1], kPairs[p][0]) = six[p] / weight_of(p);
    return c;
}

// From the spots' arrival covariances to C.
class Together {
  public:
    explicit Together(const std::vector<Scatter>& spots) {
        Eigen::Index rows = 0;
        for (const Scatter& s : spots) rows += s.sees.rows() * (s.sees.rows() + 1) / 2;
        Eigen::MatrixXd m(rows, 6);
        Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
        Eigen::Index row = 0;
        for (const Scatter& s : spots) {
            directions += s.sees.transpose() * s.sees;
            for (Eigen::Index i = 0; i < s.sees.rows(); ++i)
                for (Eigen::Index j = i; j < s.sees.rows(); ++j, ++row)
                    for (int p = 0; p < 6; ++p) {
                        const int a = kPairs[p][0], b = kPairs[p][1];
                        const double both = a == b
                                                ? s.sees(i, a) * s.sees(j, a)
                                                : s.sees(i, a) * s.sees(j, b) + s.sees(i, b) * s.sees(j, a);
                        m(row, p) = both / weight_of(p) * (i == j ? 1 : std::sqrt(2.0));
                    }
        }
        const SingularValues svd = singular_values(m);
        Eigen::VectorXd inverse = Eigen::VectorXd::Zero(svd.values.size());
        for (Eigen::Index i = 0; i < inverse.size(); ++i)
            if (svd.values[i] > kUnseen * svd.values[0]) {
                inverse[i] = 1 / svd.values[i];
                ++seen;
            }
        pseudo_inverse_ = svd.v.leftCols(inverse.size()) * inverse.asDiagonal() * svd.u.transpose();
        isotropic_ = m.leftCols(3).rowwise().sum();
        trace_ = directions.trace();
        const SymmetricEigen e = symmetric_eigen(directions);
        for (Eigen::Index i = 0; i < 3; ++i)
            if (e.values[i] < kUnseen * e.values[2]) unseen.emplace_back(e.vectors.col(i));
    }

    // Linear in the arrivals; may be negative in some direction.
    Eigen::Matrix3d covariance(const std::vector<Eigen::MatrixXd>& arrivals) const {
        Eigen::VectorXd s(pseudo_inverse_.cols());
        double variance = 0;
        Eigen::Index row = 0;
        for (const Eigen::MatrixXd& c : arrivals) {
            variance += c.trace();
            for (Eigen::Index i = 0; i < c.rows(); ++i)
                for (Eigen::Index j = i; j < c.rows(); ++j)
                    s[row++] = c(i, j) * (i == j ? 1 : std::sqrt(2.0));
        }
        variance /= trace_;
        Eigen::VectorXd six = pseudo_inverse_ * (s - variance * isotropic_);
        six.head(3).array() += variance;
        return symmetric_from(six);
    }

    // Of tr(h C) by each spot's arrivals, whose sizes count alone.
    std::vector<Eigen::MatrixXd> gradients(const Eigen::Matrix3d& h,
                                           const std::vector<Eigen::MatrixXd>& arrivals) const {
        std::vector<Eigen::MatrixXd> unit, out;
        for (const Eigen::MatrixXd& c : arrivals) unit.push_back(Eigen::MatrixXd::Zero(c.rows(), c.cols()));
        out = unit;
        for (std::size_t i = 0; i < unit.size(); ++i)
            for (Eigen::Index a = 0; a < unit[i].rows(); ++a)
                for (Eigen::Index b = a; b < unit[i].rows(); ++b) {
                    unit[i](a, b) = unit[i](b, a) = a == b ? 1 : 0.5;
                    out[i](a, b) = out[i](b, a) = (h * covariance(unit)).trace();
                    unit[i](a, b) = unit[i](b, a) = 0;
                }
        return out;
    }

    int seen = 0;
    std::vector<Eigen::Vector3d> unseen;

  private:
    Eigen::MatrixXd pseudo_inverse_;
    Eigen::VectorXd isotropic_;  // what C = I gives
    double trace_ = 0;
};

// Gradient of RP^2, which is homogeneous: RP^2(c) = tr(gradient c). A little off singular covariances, where it has
// none.
Eigen::MatrixXd gradient_of_rp2(const Eigen::MatrixXd& covariance) {
    const Eigen::Index k = covariance.rows();
    constexpr double kOffSingular = 0.01;  // of the trace
    const double trace = covariance.trace();
    const Eigen::MatrixXd c =
        trace > 0 ? Eigen::MatrixXd(covariance / trace +
                                    kOffSingular / static_cast<double>(k) * Eigen::MatrixXd::Identity(k, k))
                  : Eigen::MatrixXd::Identity(k, k);
    constexpr double kStep = 1e-4;
    Eigen::MatrixXd g(k, k);
    for (Eigen::Index i = 0; i < k; ++i)
        for (Eigen::Index j = i; j < k; ++j) {
            Eigen::MatrixXd up = c, down = c;
            up(i, j) += kStep, down(i, j) -= kStep;
            if (i != j) up(j, i) += kStep, down(j, i) -= kStep;
            const double slope =
                (std::pow(repeatability_of(up), 2) - std::pow(repeatability_of(down), 2)) / (2 * kStep);
            g(i, j) = g(j, i) = i == j ? slope : slope / 2;
        }
    return g;
}

// Limits of sqrt(sum of tr(G_k (S_k - N_k share))), G_k a gradient a spot.
Interval root_limits(const std::vector<Scatter>& spots, const std::vector<Eigen::MatrixXd>& gradients,
                     bool with_noise = false) {
    MeanSquare all{0, 0}, off{0, 0};
    double spread = 0, noise_spread = 0;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const Scatter& s = spots[i];
        const Eigen::MatrixXd of_means = gradients[i] * s.means, of_noise = s.share * gradients[i] * s.noise;
        all.value += of_means.trace();
        spread += (of_means * of_means).trace() / s.degrees;
        off.value += of_noise.trace();
        noise_spread += (of_noise * of_noise).trace() / s.noise_degrees;
    }
    if (!(all.value > 0) || !(spread > 0)) return {0, 0};
    all.degrees = all.value * all.value / spread;
    std::vector<OtherPivots> others{{0, 1}};
    if (!with_noise && off.value > 0 && noise_spread > 0) {
        others.clear();
        off.degrees = off.value * off.value / noise_spread;
        for (const double pivot : pivots(off, 50)) others.push_back({pivot, 1});
    }
    const Interval squares = generalised_limits(all, others);
    return {std::sqrt(squares.low), std::sqrt(squares.high)};
}

Expected<Scatter> scatter_of(const SpotReturns& spot) {
    const Text where("spot {}", spot.spot_id);
    std::vector<int> axes;
    if (spot.x) axes.push_back(0);
    if (spot.z) axes.push_back(1);
    Scatter s;
    const auto k = static_cast<Eigen::Index>(axes.size());
    s.sees.resize(k, 3);
    for (Eigen::Index i = 0; i < k; ++i) s.sees.row(i) = spot.sees.row(axes[static_cast<std::size_t>(i)]);
    if (k == 0 || !s.sees.allFinite() || s.sees.norm() < kUnseen)
        return input_error("it does not see where the robot stands", where,
                           "take a spot that observes x or z");
    const auto n = static_cast<Eigen::Index>(spot.returns.size());
    if (n < kLeastReturns)
        return input_error(Text("{} returns", n), where, Text("make at least {}", kLeastReturns));
    Eigen::MatrixXd means(k, n);
    s.noise = Eigen::MatrixXd::Zero(k, k);
    s.share = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
        const auto& profiles = spot.returns[static_cast<std::size_t>(j)];
        if (profiles.empty()) return input_error("a return has no profile", where);
        const auto m = static_cast<double>(profiles.size());
        Eigen::MatrixXd points(k, static_cast<Eigen::Index>(profiles.size()));
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            for (Eigen::Index a = 0; a < k; ++a)
                points(a, i) = profiles[static_cast<std::size_t>(i)][axes[static_cast<std::size_t>(a)]];
        if (!points.allFinite()) return input_error("a value is not finite", where);
        means.col(j) = points.rowwise().mean();
        points.colwise() -= means.col(j).eval();
        s.noise += points * points.transpose();
        s.noise_degrees += m - 1;
        s.share += 1 / m / static_cast<double>(n);
    }
    if (s.noise_degrees < 1)
        return input_error("one profile a return does not tell the sensor's noise from the robot", where,
                           "take two or more");
    s.noise /= s.noise_degrees;
    const double size = means.cwiseAbs().maxCoeff();
    means.colwise() -= means.rowwise().mean().eval();
    if (means.cwiseAbs().maxCoeff() <= kRoundedScatter * std::max(1.0, size))
        return input_error("all returns are equal, so they tell nothing of the scatter", where,
                           "look at the same place with a finer sensor");
    s.degrees = static_cast<double>(n - 1);
    s.means = means * means.transpose() / s.degrees;
    return s;
}

AxisScatter axis_of(const Scatter& s, Eigen::Index i) {
    Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(s.means.rows(), s.means.rows());
    gradient(i, i) = 1;
    return {std::sqrt(std::max(0.0, s.arrival()(i, i))), root_limits({s}, {gradient})};
}

}  // namespace

double repeatability_of(const Eigen::MatrixXd& covariance) {
    static const Eigen::MatrixXd kEven[3] = {even_directions(1), even_directions(2), even_directions(3)};
    // Mean length of a standard normal vector.
    static const double kLength[3] = {std::sqrt(2 / kPi), std::sqrt(kPi / 2), 2 * std::sqrt(2 / kPi)};
    const Eigen::Index k = covariance.rows();
    const Eigen::MatrixXd& u = kEven[k - 1];
    const double mean =
        kLength[k - 1] * (u.cwiseProduct(covariance * u)).colwise().sum().cwiseMax(0).cwiseSqrt().mean();
    return mean + 3 * std::sqrt(std::max(0.0, covariance.trace() - mean * mean));
}

double repeatability_of_positions(const Eigen::MatrixXd& positions) {
    const Eigen::VectorXd l =
        (positions.colwise() - positions.rowwise().mean().eval()).colwise().norm().transpose();
    const Moments m = moments({l.data(), static_cast<std::size_t>(l.size())});
    return m.mean + 3 * m.s;
}

Expected<RobotStudy> robot_study(std::span<const SpotReturns> spots) {
    if (spots.empty()) return input_error("no spot was returned to", "robot study");
    std::vector<Scatter> scatters;
    for (const SpotReturns& spot : spots) {
        SEAM_TRY(auto s, scatter_of(spot));
        scatters.push_back(std::move(s));
    }
    const Together together(scatters);
    RobotStudy study;
    study.seen = together.seen;
    study.unseen = together.unseen;
    std::vector<Eigen::MatrixXd> arrivals;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const Scatter& s = scatters[i];
        SpotRepeatability& r = study.spots.emplace_back();
        r.spot_id = spots[i].spot_id;
        r.x = spots[i].x;
        r.z = spots[i].z;
        r.returns = static_cast<int>(spots[i].returns.size());
        Eigen::MatrixXd means(s.sees.rows(), r.returns);
        for (int j = 0; j < r.returns; ++j) {
            Eigen::Vector2d sum = Eigen::Vector2d::Zero();
            const auto& profiles = spots[i].returns[static_cast<std::size_t>(j)];
            for (const Eigen::Vector2d& p : profiles) sum += p / static_cast<double>(profiles.size());
            r.profiles += static_cast<int>(profiles.size());
            if (r.x) means(0, j) = sum.x();
            if (r.z) means(means.rows() - 1, j) = sum.y();
        }
        if (r.x) r.arrival_x = axis_of(s, 0), r.noise_mm.x() = std::sqrt(s.noise(0, 0));
        const Eigen::Index last = s.sees.rows() - 1;
        if (r.z) r.arrival_z = axis_of(s, last), r.noise_mm.y() = std::sqrt(s.noise(last, last));
        r.rp_measured_mm = repeatability_of_positions(means);
        arrivals.push_back(s.arrival());
        const Eigen::MatrixXd arrival = without_negative(s.arrival());
        r.rp_mm = repeatability_of(arrival);
        r.rp_limits_mm = root_limits({s}, {gradient_of_rp2(arrival)});
        r.rp_measured_limits_mm = root_limits({s}, {gradient_of_rp2(s.means)}, true);
    }
    study.covariance_mm2 = without_negative(together.covariance(arrivals));
    study.rp_mm = repeatability_of(study.covariance_mm2);
    // Of tr(h C), h symmetric.
    const auto limits = [&](const Eigen::Matrix3d& h) {
        return root_limits(scatters, together.gradients(h, arrivals));
    };
    for (int a = 0; a < 3; ++a) {
        study.axes[a].sigma_mm = std::sqrt(study.covariance_mm2(a, a));
        study.axes[a].limits_mm = limits(Eigen::Vector3d::Unit(a).asDiagonal());
    }
    study.rp_limits_mm = limits(gradient_of_rp2(study.covariance_mm2));
    return study;
}

}  // namespace seamwright
