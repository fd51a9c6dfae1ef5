#include "core/calibration/table/lookup_table_calibration.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "core/calibration/camera/camera.h"
#include "core/calibration/pose_set.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"
#include "core/profile/units.h"

namespace seamwright {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMostNodes = 16'000'000;
constexpr std::size_t kMostPairs = 100'000;
constexpr Index kMostKnots = 120;
constexpr int kHighestDegree = 5;
constexpr double kHarmless_px = 0.25;  // a pair this close is not wrong, however exact the others are

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Spread across the main direction relative to along it; 0: all on one line.
double flatness(const std::vector<Vector2d>& points) {
    Vector2d mean = Vector2d::Zero();
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    Matrix2d scatter = Matrix2d::Zero();
    for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
    const Vector2d l = Eigen::SelfAdjointEigenSolver<Matrix2d>().computeDirect(scatter).eigenvalues();
    return l(1) > 0 ? std::sqrt(std::max(0.0, l(0)) / l(1)) : 0;
}

// Convex hull (Andrew's monotone chain), counter-clockwise in (u, v), without repeated points.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> p) {
    std::sort(p.begin(), p.end(), [](const Vector2d& a, const Vector2d& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    p.erase(std::unique(p.begin(), p.end()), p.end());
    if (p.size() < 3) return p;
    std::vector<Vector2d> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t base = hull.size();
        for (const auto& q : p) {
            while (hull.size() >= base + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], q - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(q);
        }
        hull.pop_back();
        std::reverse(p.begin(), p.end());
    }
    return hull;
}

double area_of(const std::vector<Vector2d>& hull) {
    double twice = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) twice += cross(hull[i], hull[(i + 1) % hull.size()]);
    return 0.5 * twice;
}

// How far a point lies outside the hull; below 0 inside.
double outside(const std::vector<Vector2d>& hull, const Vector2d& p) {
    double most = -kInfinity;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        most = std::max(most, -cross(edge, p - hull[i]) / edge.norm());
    }
    return most;
}

struct Samples {
    std::vector<Vector2d> pixel, laser;
};

Samples chosen(const std::vector<LaserPair>& pairs, const std::vector<char>& used) {
    Samples s;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (used[i]) {
            s.pixel.push_back(pairs[i].pixel);
            s.laser.push_back(pairs[i].laser_mm);
        }
    return s;
}

Vector2d through(const Eigen::Matrix3d& h, const Vector2d& p) {
    return (h * p.homogeneous()).hnormalized();
}

// Pixel to laser, least median of squares and concentration on the better half; nullopt: none.
std::optional<Eigen::Matrix3d> robust_homography(const Samples& s) {
    const std::size_t n = s.pixel.size();
    std::mt19937 random(20260101);
    std::vector<std::size_t> judges(n);
    std::iota(judges.begin(), judges.end(), 0);
    std::shuffle(judges.begin(), judges.end(), random);
    if (judges.size() > 1000) judges.resize(1000);
    std::vector<double> error(judges.size());
    const auto middle = static_cast<std::ptrdiff_t>(judges.size() / 2);
    const auto median_of = [&](const Eigen::Matrix3d& h) {
        for (std::size_t k = 0; k < judges.size(); ++k) {
            const double e = (through(h, s.pixel[judges[k]]) - s.laser[judges[k]]).squaredNorm();
            error[k] = std::isfinite(e) ? e : kInfinity;
        }
        std::nth_element(error.begin(), error.begin() + middle, error.end());
        return error[static_cast<std::size_t>(middle)];
    };
    std::optional<Eigen::Matrix3d> best;
    double best_median = kInfinity;
    const auto offer = [&](const std::optional<Eigen::Matrix3d>& h) {
        if (!h) return;
        const double m = median_of(*h);
        if (m < best_median) best_median = m, best = h;
    };
    offer(homography_dlt(s.pixel, s.laser));
    std::uniform_int_distribution<std::size_t> any(0, n - 1);
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<Vector2d> from, to;
        for (int k = 0; k < 4; ++k) {
            const std::size_t i = any(random);
            from.push_back(s.pixel[i]);
            to.push_back(s.laser[i]);
        }
        offer(homography_dlt(from, to));
    }
    for (int round = 0; best && round < 5; ++round) {
        std::vector<Vector2d> from, to;
        for (std::size_t i = 0; i < n; ++i)
            if ((through(*best, s.pixel[i]) - s.laser[i]).squaredNorm() <= best_median) {
                from.push_back(s.pixel[i]);
                to.push_back(s.laser[i]);
            }
        const double before = best_median;
        offer(homography_dlt(from, to));
        if (!(best_median < before)) break;
    }
    return best;
}

// The smooth map of the header and its statistics.
class SmoothMap {
  public:
    // Degrees to choose from. False: too few samples, or a horizon between them.
    bool fit(const Samples& s, int least_degree, int most_degree);

    Vector2d at(const Vector2d& pixel) const {
        const Eigen::Vector3d q = h_ * corrected(pixel).homogeneous();
        if (!(q.z() * side_ > 0)) return {kNaN, kNaN};
        return q.hnormalized();
    }
    // d(x, z)/d(u, v), mm per px.
    Matrix2d slope(const Vector2d& p) const {
        constexpr double h = 0.5;
        Matrix2d j;
        j.col(0) = (at(p + Vector2d(h, 0)) - at(p - Vector2d(h, 0))) / (2 * h);
        j.col(1) = (at(p + Vector2d(0, h)) - at(p - Vector2d(0, h))) / (2 * h);
        return j;
    }
    // d(x, z)/d(corrected pixel): carries noise() into the laser plane.
    Matrix2d homography_slope(const Vector2d& pixel) const {
        const Eigen::Vector3d q = h_ * corrected(pixel).homogeneous();
        const Vector2d xz = q.hnormalized();
        return (h_.topLeftCorner<2, 2>() - xz * h_.block<1, 2>(2, 0)) / q.z();
    }
    // How far a pair lies from the map, in corrected px; NaN beyond the horizon.
    Vector2d miss(const Vector2d& pixel, const Vector2d& laser) const {
        const Eigen::Vector3d q = inverse_ * laser.homogeneous();
        if (!(q.z() * inverse_side_ > 0)) return {kNaN, kNaN};
        return q.hnormalized() - corrected(pixel);
    }
    // Row whose products are the covariance of the map between two places, in units of noise().
    VectorXd spread_row(const Vector2d& p) const {
        const Vector2d c = (p - mean_) / scale_;
        const VectorXd r =
            r_.transpose().triangularView<Eigen::Lower>().solve(monomials(c, degree_).transpose());
        VectorXd out(r.size() + shrink_.size());
        out.head(r.size()) = r;
        if (shrink_.size() > 0)
            out.tail(shrink_.size()) =
                ((kernel(c) * rotate_).transpose() - cross_.transpose() * r).cwiseProduct(shrink_);
        return out;
    }
    const Matrix2d& noise() const { return noise_; }  // covariance of a pair's miss(), px^2
    // Residual over sqrt(1 - leverage) as a square in units of the noise, and the leave-one-out error in px.
    double studentised(std::size_t i, const Matrix2d& noise_inverse) const {
        const auto k = static_cast<Index>(i);
        const Vector2d e = residual_.row(k).transpose();
        return e.dot(noise_inverse * e) / std::max(1 - leverage_(k), 1e-9);
    }
    Vector2d left_out_error(std::size_t i) const {
        const auto k = static_cast<Index>(i);
        return residual_.row(k).transpose() / std::max(1 - leverage_(k), 1e-9);
    }
    int degree() const { return degree_; }
    double effective() const { return effective_; }
    double freedom() const { return static_cast<double>(residual_.rows()) - effective_; }

  private:
    Vector2d mean_ = Vector2d::Zero();
    double scale_ = 1, side_ = 1, inverse_side_ = 1;
    Eigen::Matrix3d h_ = Eigen::Matrix3d::Identity(), inverse_ = Eigen::Matrix3d::Identity();
    int degree_ = 0;
    std::vector<Vector2d> knots_;
    MatrixXd poly_, bend_;         // coefficients of u and v
    MatrixXd r_, cross_, rotate_;  // of spread_row()
    VectorXd shrink_;
    MatrixXd residual_;
    VectorXd leverage_;
    Matrix2d noise_ = Matrix2d::Zero();
    double effective_ = 0;

    static Index terms(int degree) { return (degree + 1) * (degree + 2) / 2; }
    static Eigen::RowVectorXd monomials(const Vector2d& c, int degree) {
        Eigen::RowVectorXd row(terms(degree));
        Index at = 0;
        for (int total = 0; total <= degree; ++total)
            for (int k = 0; k <= total; ++k) {
                double value = 1;
                for (int i = 0; i < total - k; ++i) value *= c.x();
                for (int i = 0; i < k; ++i) value *= c.y();
                row(at++) = value;
            }
        return row;
    }
    static double bending(double square) { return square > 0 ? 0.5 * square * std::log(square) : 0; }
    Eigen::RowVectorXd kernel(const Vector2d& c) const {
        Eigen::RowVectorXd row(static_cast<Index>(knots_.size()));
        for (std::size_t j = 0; j < knots_.size(); ++j)
            row(static_cast<Index>(j)) = bending((c - knots_[j]).squaredNorm());
        return row;
    }
    Vector2d corrected(const Vector2d& pixel) const {
        const Vector2d c = (pixel - mean_) / scale_;
        Vector2d out = pixel + (monomials(c, degree_) * poly_).transpose();
        if (!knots_.empty()) out += (kernel(c) * bend_).transpose();
        return out;
    }
    void choose_knots(const std::vector<Vector2d>& places);
};

// Farthest-point sampling: knots as even as the samples allow.
void SmoothMap::choose_knots(const std::vector<Vector2d>& places) {
    knots_.clear();
    const auto wanted = std::min<std::size_t>(kMostKnots, places.size() / 4);
    if (places.size() < 24) return;
    std::vector<double> nearest(places.size(), kInfinity);
    std::size_t next = 0;
    while (knots_.size() < wanted) {
        knots_.push_back(places[next]);
        double most = -1;
        for (std::size_t i = 0; i < places.size(); ++i) {
            nearest[i] = std::min(nearest[i], (places[i] - knots_.back()).squaredNorm());
            if (nearest[i] > most) most = nearest[i], next = i;
        }
        if (!(most > 1e-8)) break;
    }
    if (knots_.size() < 6) knots_.clear();
}

bool SmoothMap::fit(const Samples& s, int least_degree, int most_degree) {
    const auto n = static_cast<Index>(s.pixel.size());
    const auto h = homography_dlt(s.pixel, s.laser);
    if (!h) return false;
    h_ = *h;
    mean_.setZero();
    for (const auto& p : s.pixel) mean_ += p / static_cast<double>(n);
    scale_ = 0;
    for (const auto& p : s.pixel) scale_ = std::max(scale_, (p - mean_).norm());
    if (!(scale_ > 0)) return false;
    inverse_ = h_.inverse();
    if (!inverse_.allFinite()) return false;
    side_ = (h_ * mean_.homogeneous()).z() > 0 ? 1 : -1;
    inverse_side_ = (inverse_ * through(h_, mean_).homogeneous()).z() > 0 ? 1 : -1;
    std::vector<Vector2d> places;
    MatrixXd y(n, 2);
    for (Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Eigen::Vector3d q = inverse_ * s.laser[k].homogeneous();
        if (!(q.z() * inverse_side_ > 0)) return false;
        y.row(i) = (q.hnormalized() - s.pixel[k]).transpose();
        places.push_back((s.pixel[k] - mean_) / scale_);
    }
    if (!y.allFinite()) return false;
    choose_knots(places);

    // Kernel columns free of what a plane can say (the spline's null space), scaled to a unit penalty.
    MatrixXd columns, transform;
    if (!knots_.empty()) {
        const auto m = static_cast<Index>(knots_.size());
        MatrixXd affine(m, 3), penalty(m, m);
        for (Index i = 0; i < m; ++i) {
            affine.row(i) = monomials(knots_[static_cast<std::size_t>(i)], 1);
            penalty.row(i) = kernel(knots_[static_cast<std::size_t>(i)]);
        }
        const Eigen::HouseholderQR<MatrixXd> qr(affine);
        const MatrixXd q = qr.householderQ() * MatrixXd::Identity(m, m);
        const MatrixXd free = q.rightCols(m - 3);
        const SymmetricEigen eigen = symmetric_eigen(free.transpose() * penalty * free);
        const double least = 1e-10 * eigen.values(m - 4);
        if (!(least > 0)) return false;
        transform =
            free * eigen.vectors * eigen.values.cwiseMax(least).cwiseSqrt().cwiseInverse().asDiagonal();
        MatrixXd kernels(n, m);
        for (Index i = 0; i < n; ++i) kernels.row(i) = kernel(places[static_cast<std::size_t>(i)]);
        columns = kernels * transform;
    }

    // Every lens bends to the third degree: a lower one saves noise only where samples are few.
    if (n >= 40) least_degree = std::max(least_degree, std::min(3, most_degree));
    double best = kInfinity;
    for (int degree = least_degree; degree <= most_degree; ++degree) {
        const Index m = terms(degree);
        if (degree > 1 && static_cast<double>(m) > 0.6 * static_cast<double>(n)) break;
        MatrixXd p(n, m);
        for (Index i = 0; i < n; ++i) p.row(i) = monomials(places[static_cast<std::size_t>(i)], degree);
        const Eigen::HouseholderQR<MatrixXd> qr(p);
        const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, m);
        const MatrixXd r = qr.matrixQR().topRows(m).triangularView<Eigen::Upper>();
        if (!(r.diagonal().cwiseAbs().minCoeff() > 1e-9 * r.diagonal().cwiseAbs().maxCoeff())) break;
        const MatrixXd qy = q.transpose() * y;
        const MatrixXd flat = y - q * qy;
        const VectorXd own = q.rowwise().squaredNorm();
        MatrixXd modes, scores, mixed;
        VectorXd power;
        MatrixXd vectors;
        if (columns.size() > 0) {
            mixed = q.transpose() * columns;
            modes = columns - q * mixed;
            const SymmetricEigen eigen = symmetric_eigen(modes.transpose() * modes);
            power = eigen.values.cwiseMax(0);
            vectors = eigen.vectors;
            modes = modes * vectors;
            scores = modes.transpose() * flat;
        }
        const MatrixXd squares = modes.cwiseAbs2();
        const double top = power.size() > 0 ? power.maxCoeff() : 0;
        // From no spline at all to one that follows the samples.
        for (int step = -1; step <= (power.size() > 0 ? 22 : -1); ++step) {
            VectorXd inverse = VectorXd::Zero(power.size());
            if (step >= 0) inverse = (power.array() + top * std::pow(10.0, 1 - 0.5 * step)).inverse();
            MatrixXd residual = flat;
            VectorXd leverage = own;
            double effective = static_cast<double>(m);
            if (step >= 0) {
                residual -= modes * (inverse.asDiagonal() * scores);
                leverage += squares * inverse;
                effective += power.dot(inverse);
            }
            if (!(effective < 0.8 * static_cast<double>(n))) break;
            double error = 0;
            for (Index i = 0; i < n; ++i) {
                const double rest = std::max(1 - leverage(i), 1e-6);
                error += residual.row(i).squaredNorm() / (rest * rest);
            }
            if (!(error < best)) continue;
            best = error;
            degree_ = degree;
            effective_ = effective;
            residual_ = residual;
            leverage_ = leverage;
            r_ = r;
            MatrixXd right = qy;
            if (step >= 0) {
                const MatrixXd g = inverse.asDiagonal() * scores;
                bend_ = transform * (vectors * g);
                right -= mixed * (vectors * g);
                rotate_ = transform * vectors;
                cross_ = mixed * vectors;
                shrink_ = inverse.cwiseSqrt();
            } else {
                shrink_.resize(0);
                bend_ = MatrixXd::Zero(static_cast<Index>(knots_.size()), 2);
            }
            poly_ = r.triangularView<Eigen::Upper>().solve(right);
        }
    }
    if (!std::isfinite(best)) return false;
    if (shrink_.size() == 0) knots_.clear();
    noise_ = residual_.transpose() * residual_ / std::max(1.0, freedom());
    return poly_.allFinite() && noise_.allFinite();
}

// Limit of F(2, freedom) that the largest of n passes with probability 0.001; exact for two numbers.
double largest_limit(double n, double freedom) {
    return 0.5 * freedom * (std::pow(0.001 / n, -2 / freedom) - 1);
}

Matrix2d invertible(Matrix2d m) {
    m += (1e-12 * m.trace() + 1e-30) * Matrix2d::Identity();
    return m.inverse();
}

// Names the wrong pairs and leaves them out; the map of the others. False: no map.
bool fit_without_wrong(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed,
                       std::vector<char>& used, SmoothMap& map) {
    // What lies far from a robust homography; the lens may bend by several times the median.
    const Samples all = chosen(pairs, allowed);
    const auto rough = robust_homography(all);
    if (!rough) return false;
    const Eigen::Matrix3d back_to_pixel = rough->inverse();
    std::vector<double> error;
    for (std::size_t i = 0; i < all.pixel.size(); ++i) {
        const double e = (through(back_to_pixel, all.laser[i]) - all.pixel[i]).norm();
        error.push_back(std::isfinite(e) ? e : kInfinity);
    }
    std::vector<double> sorted = error;
    std::sort(sorted.begin(), sorted.end());
    const double limit = std::max(12 * sorted[sorted.size() / 2], kHarmless_px);
    used = allowed;
    for (std::size_t i = 0, k = 0; i < pairs.size(); ++i)
        if (allowed[i] && error[k++] > limit) used[i] = 0;

    for (int round = 0; round < 4; ++round) {
        for (int pass = 0; pass < 200; ++pass) {
            const Samples s = chosen(pairs, used);
            if (s.pixel.size() < 6) return false;
            const bool first = pass == 0;
            if (!map.fit(s, first ? 1 : map.degree(), first ? kHighestDegree : map.degree())) return false;
            const double n = static_cast<double>(s.pixel.size()), freedom = map.freedom();
            if (freedom < 4) break;
            const Matrix2d inverse = invertible(map.noise());
            std::vector<double> square;
            for (std::size_t i = 0; i < s.pixel.size(); ++i) square.push_back(map.studentised(i, inverse));
            std::vector<double> order = square;
            std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2),
                             order.end());
            // The median of chi-squared with two degrees of freedom is 2 ln 2; many wrong pairs blow up the
            // noise but not the median.
            const double robust =
                n < 20 ? 1 : std::clamp(order[order.size() / 2] / (2 * std::log(2.0)), 1e-9, 1.0);
            std::vector<double> f(square.size());
            double worst = 0;
            for (std::size_t i = 0; i < f.size(); ++i) {
                const double deleted = square[i] < 2 * freedom
                                           ? square[i] * (freedom - 1) / (2 * freedom - square[i])
                                           : kInfinity;
                f[i] = std::max(std::min(deleted, 1e12), square[i] / (2 * robust));
                if (!(f[i] > largest_limit(n, freedom - 1))) f[i] = 0;
                if (f[i] > 0 && map.left_out_error(i).norm() < kHarmless_px) f[i] = 0;
                worst = std::max(worst, f[i]);
            }
            if (!(worst > 0)) break;
            for (std::size_t i = 0, k = 0; i < pairs.size(); ++i)
                if (used[i]) used[i] = !(f[k++] > 0.25 * worst);
        }
        // A pair that the clean map predicts was wronged by its wrong neighbours.
        bool back = false;
        const double n = static_cast<double>(std::count(used.begin(), used.end(), 1));
        const Matrix2d inverse = invertible(map.noise());
        for (std::size_t i = 0; round < 3 && i < pairs.size(); ++i) {
            if (!allowed[i] || used[i]) continue;
            const Vector2d e = map.miss(pairs[i].pixel, pairs[i].laser_mm);
            if (!e.allFinite()) continue;
            const double variance = 1 + map.spread_row(pairs[i].pixel).squaredNorm();
            if (e.dot(inverse * e) / variance / 2 < largest_limit(n, std::max(1.0, map.freedom() - 1)) ||
                e.norm() < kHarmless_px)
                used[i] = 1, back = true;
        }
        if (!back) break;
    }
    const Samples s = chosen(pairs, used);
    return s.pixel.size() >= 6 && map.fit(s, 1, kHighestDegree);
}

// Where samples support the map.
struct Support {
    std::vector<Vector2d> hull;
    double spacing = 0;  // px, as if the samples stood on a square grid

    explicit Support(const std::vector<Vector2d>& pixel) : hull(convex_hull(pixel)) {
        spacing = std::sqrt(std::max(0.0, area_of(hull)) / static_cast<double>(pixel.size()));
    }
};

double table_error_mm(const SmoothMap& map, const Vector2d& corner, double step) {
    const Vector2d a = map.at(corner), b = map.at(corner + Vector2d(step, 0)),
                   c = map.at(corner + Vector2d(0, step)), d = map.at(corner + Vector2d(step, step));
    return (0.25 * (a + b + c + d) - map.at(corner + Vector2d(step, step) / 2)).norm();
}

LookupTable build_table(const SmoothMap& map, const Support& support, const std::vector<Vector2d>& pixel,
                        int width, int height, double step, int& folded) {
    LookupTable t;
    t.step_u = t.step_v = step;
    t.columns = std::max(2, static_cast<int>(std::ceil((width - 1) / step)) + 1);
    t.rows = std::max(2, static_cast<int>(std::ceil((height - 1) / step)) + 1);
    const auto nodes = static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    t.x_mm.assign(nodes, kNaN);
    t.z_mm.assign(nodes, kNaN);
    const auto index = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) +
               static_cast<std::size_t>(i);
    };
    std::vector<char> near(nodes, 0);
    const double reach = std::max(2 * support.spacing, 0.75 * step);
    for (const auto& p : pixel)
        for (int j = std::max(0, static_cast<int>(std::ceil((p.y() - reach) / step)));
             j <= std::min(t.rows - 1, static_cast<int>(std::floor((p.y() + reach) / step))); ++j)
            for (int i = std::max(0, static_cast<int>(std::ceil((p.x() - reach) / step)));
                 i <= std::min(t.columns - 1, static_cast<int>(std::floor((p.x() + reach) / step))); ++i)
                if (std::hypot(i * step - p.x(), j * step - p.y()) <= reach) near[index(i, j)] = 1;
    const double margin = 0.5 * std::min(step, support.spacing) + 1e-9;
    for (int j = 0; j < t.rows; ++j)
        for (int i = 0; i < t.columns; ++i) {
            const Vector2d p(i * step, j * step);
            if (!near[index(i, j)] || outside(support.hull, p) > margin) continue;
            const Vector2d xz = map.at(p);
            if (!xz.allFinite()) continue;
            t.x_mm[index(i, j)] = xz.x();
            t.z_mm[index(i, j)] = xz.y();
        }
    // A map that folds over has cells of the other orientation.
    std::vector<std::pair<std::size_t, double>> turn;
    int left = 0, right = 0;
    for (int j = 0; j + 1 < t.rows; ++j)
        for (int i = 0; i + 1 < t.columns; ++i) {
            const auto at = [&](int a, int b) {
                return Vector2d(t.x_mm[index(i + a, j + b)], t.z_mm[index(i + a, j + b)]);
            };
            const double c = cross(at(1, 1) - at(0, 0), at(0, 1) - at(1, 0));
            if (!std::isfinite(c)) continue;
            (c > 0 ? left : right) += 1;
            turn.emplace_back(index(i, j), c);
        }
    folded = std::min(left, right);
    for (const auto& [n, c] : turn)
        if ((c > 0) != (left >= right))
            for (const std::size_t k : {n, n + 1, n + static_cast<std::size_t>(t.columns),
                                        n + static_cast<std::size_t>(t.columns) + 1})
                t.x_mm[k] = t.z_mm[k] = kNaN;
    return t;
}

// Predicts each fold from the others, with the degree of the whole.
HoldOut leave_out(const std::vector<LaserPair>& pairs, const std::vector<char>& used,
                  const SmoothMap& whole) {
    HoldOut out;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (used[i]) order.push_back(i);
    if (order.size() < 12) return out;
    // Shuffled: the pairs may come row by row, and a fold must not be a column of a grid.
    std::mt19937 random(7);
    std::shuffle(order.begin(), order.end(), random);
    const std::size_t folds = order.size() > 5000 ? 5 : 10;
    double mm = 0, px = 0, most = 0;
    int counted = 0;
    for (std::size_t fold = 0; fold < folds; ++fold) {
        std::vector<char> rest = used;
        std::vector<std::size_t> tested;
        for (std::size_t k = fold; k < order.size(); k += folds) {
            rest[order[k]] = 0;
            tested.push_back(order[k]);
        }
        const Samples s = chosen(pairs, rest);
        SmoothMap map;
        if (!map.fit(s, std::min(whole.degree(), 2), whole.degree())) continue;
        const Support support(s.pixel);
        ++out.folds;
        out.left_out = std::max(out.left_out, static_cast<int>(tested.size()));
        for (const std::size_t i : tested) {
            if (outside(support.hull, pairs[i].pixel) > 0) continue;
            const Vector2d e = map.at(pairs[i].pixel) - pairs[i].laser_mm;
            const Vector2d p = whole.slope(pairs[i].pixel).inverse() * e;
            if (!e.allFinite() || !p.allFinite()) continue;
            mm += e.squaredNorm();
            px += p.squaredNorm();
            most = std::max(most, e.norm());
            ++counted;
        }
    }
    if (counted == 0) return {};
    out.rms_mm = std::sqrt(mm / counted);
    out.rms_px = std::sqrt(px / counted);
    out.max_mm = most;
    return out;
}

// Table at the middle of the samples and at four nodes towards the corners.
void describe(const SmoothMap& map, const LookupTable& t, const Vector2d& middle, CalibrationReport& report) {
    std::vector<Vector2d> places;
    const auto pick = [&](const auto& cost) {
        double least = kInfinity;
        Vector2d at(kNaN, kNaN);
        for (int j = 0; j < t.rows; ++j)
            for (int i = 0; i < t.columns; ++i) {
                const auto n = static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) +
                               static_cast<std::size_t>(i);
                if (std::isnan(t.x_mm[n])) continue;
                const Vector2d p(i * t.step_u, j * t.step_v);
                const double c = cost(p);
                if (c < least) least = c, at = p;
            }
        if (at.allFinite() && std::find(places.begin(), places.end(), at) == places.end())
            places.push_back(at);
    };
    pick([&](const Vector2d& p) { return (p - middle).squaredNorm(); });
    for (const Vector2d& corner : {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)})
        pick([&](const Vector2d& p) { return -(p - middle).dot(corner); });
    const auto m = static_cast<Index>(places.size());
    std::vector<VectorXd> rows;
    std::vector<Matrix2d> slopes;
    for (const auto& p : places) {
        rows.push_back(map.spread_row(p));
        slopes.push_back(map.homography_slope(p));
        const Vector2d xz = map.at(p);
        report.parameters.push_back({fmt::format("x({:g},{:g})", p.x(), p.y()), xz.x(), "mm", 0});
        report.parameters.push_back({fmt::format("z({:g},{:g})", p.x(), p.y()), xz.y(), "mm", 0});
    }
    report.covariance.resize(2 * m, 2 * m);
    for (Index a = 0; a < m; ++a)
        for (Index b = 0; b < m; ++b)
            report.covariance.block<2, 2>(2 * a, 2 * b) =
                rows[static_cast<std::size_t>(a)].dot(rows[static_cast<std::size_t>(b)]) *
                slopes[static_cast<std::size_t>(a)] * map.noise() *
                slopes[static_cast<std::size_t>(b)].transpose();
    finish_statistics(report);
}

}  // namespace

std::optional<Vector2d> pixel_in_table(const LookupTable& t, const Vector2d& xz,
                                       std::optional<Vector2d> start) {
    const auto nodes =
        static_cast<std::size_t>(std::max(0, t.columns)) * static_cast<std::size_t>(std::max(0, t.rows));
    if (t.columns < 2 || t.rows < 2 || t.x_mm.size() != nodes || t.z_mm.size() != nodes || !xz.allFinite())
        return std::nullopt;
    const auto node = [&](int i, int j) {
        const auto n =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) + static_cast<std::size_t>(i);
        return Vector2d(t.x_mm[n], t.z_mm[n]);
    };
    // In units of nodes.
    const auto search = [&](Vector2d p) -> std::optional<Vector2d> {
        for (int iteration = 0; iteration < 60 && p.allFinite(); ++iteration) {
            p.x() = std::clamp(p.x(), 0.0, t.columns - 1.0);
            p.y() = std::clamp(p.y(), 0.0, t.rows - 1.0);
            const int i = std::min(static_cast<int>(p.x()), t.columns - 2),
                      j = std::min(static_cast<int>(p.y()), t.rows - 2);
            const double a = p.x() - i, b = p.y() - j;
            const Vector2d n00 = node(i, j), n10 = node(i + 1, j), n01 = node(i, j + 1),
                           n11 = node(i + 1, j + 1);
            const Vector2d value = (1 - b) * ((1 - a) * n00 + a * n10) + b * ((1 - a) * n01 + a * n11);
            Matrix2d slope;
            slope.col(0) = (1 - b) * (n10 - n00) + b * (n11 - n01);
            slope.col(1) = (1 - a) * (n01 - n00) + a * (n11 - n10);
            const Vector2d step = slope.inverse() * (xz - value);
            if (!step.allFinite()) return std::nullopt;
            if (step.norm() < 1e-10) return Vector2d(t.u0 + p.x() * t.step_u, t.v0 + p.y() * t.step_v);
            p += step * std::min(1.0, 4 / step.norm());
        }
        return std::nullopt;
    };
    if (start)
        if (const auto found = search({(start->x() - t.u0) / t.step_u, (start->y() - t.v0) / t.step_v}))
            return found;
    double least = kInfinity;
    Vector2d nearest(kNaN, kNaN);
    for (int j = 0; j < t.rows; ++j)
        for (int i = 0; i < t.columns; ++i) {
            const double d = (node(i, j) - xz).squaredNorm();
            if (d < least) least = d, nearest = {i, j};
        }
    if (!nearest.allFinite()) return std::nullopt;
    // The nearest node may stand at the edge of a hole: begin in each of its cells.
    for (const Vector2d& side :
         {Vector2d(0.01, 0.01), Vector2d(-0.01, 0.01), Vector2d(0.01, -0.01), Vector2d(-0.01, -0.01)})
        if (const auto found = search(nearest + side)) return found;
    return std::nullopt;
}

Expected<LookupTableResult> calibrate_lookup_table(int width, int height, const std::vector<LaserPair>& pairs,
                                                   const LookupTableOptions& options) {
    if (width < 16 || height < 16 || width > 100000 || height > 100000)
        return input_error(Text("an image of {}x{} pixels is not possible", width, height), "size",
                           "give [width, height] in pixels");
    const double fine = options.step_px;
    if (fine != 0 &&
        (!(fine > 0) || !std::isfinite(fine) || fine > std::max(width, height) ||
         (std::ceil((width - 1) / fine) + 1) * (std::ceil((height - 1) / fine) + 1) > kMostNodes))
        return input_error(Text("a step of {} px is not possible for {}x{} pixels", fine, width, height),
                           "step_px", "give e.g. 8");
    if (pairs.size() > kMostPairs)
        return input_error(Text("{} pairs are too many", pairs.size()), "pairs",
                           "thin them out to 100000 or fewer");
    std::vector<std::string> ids;
    for (const auto& p : pairs) ids.push_back(p.id);
    if (auto ok = check_ids(ids, options.exclude, "pairs"); !ok) return tl::unexpected(ok.error());
    LookupTableResult result;
    auto& report = result.report;
    std::vector<std::string> excluded = options.exclude;
    std::sort(excluded.begin(), excluded.end());
    std::vector<char> allowed(pairs.size(), 1);
    double extent = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto& p = pairs[i];
        const std::string where = "pairs[" + p.id + "]";
        if (!p.pixel.allFinite() || !p.laser_mm.allFinite() || p.laser_mm.norm() > 1e6)
            return input_error("the pair is not made of finite numbers", where, "leave it out");
        if (p.pixel.x() < -1 || p.pixel.y() < -1 || p.pixel.x() > width || p.pixel.y() > height)
            return input_error(Text("the pixel ({:.1f}, {:.1f}) lies outside the image of {}x{}", p.pixel.x(),
                                    p.pixel.y(), width, height),
                               where, "check the size and the order [u, v]");
        allowed[i] = !std::binary_search(excluded.begin(), excluded.end(), p.id);
        report.poses.emplace_back();
        report.poses.back().id = p.id;
        report.poses.back().used = allowed[i];
        if (!allowed[i]) report.poses.back().note = "excluded";
        extent = std::max(extent, (p.laser_mm - pairs[0].laser_mm).norm());
    }
    const auto count = std::count(allowed.begin(), allowed.end(), 1);
    if (count < 6)
        return input_error(Text("{} pairs are too few, at least 6 are needed", count), "pairs",
                           "measure 25 or more positions over the whole field of view");
    if (auto ok = check_span_millimetres(extent, "pairs"); !ok) return tl::unexpected(ok.error());

    const char* spread = "measure 25 or more positions over the whole field of view, near and far";
    const auto undetermined = [&](Text reason) {
        result.table = {};
        report.parameters.clear();
        report.covariance.resize(0, 0);
        report.correlations.clear();
        report.judgement = {Verdict::undetermined, std::move(reason), spread};
        return result;
    };
    const Samples all = chosen(pairs, allowed);
    if (!(flatness(all.pixel) > 0.01)) return undetermined("the pixels lie on one line of the image");
    if (!(flatness(all.laser) > 0.01)) return undetermined("the targets lie on one line of the laser plane");
    if (count < 9) return undetermined(Text("{} pairs cannot tell a wrong one from the others", count));
    SmoothMap map;
    std::vector<char> used;
    if (!fit_without_wrong(pairs, allowed, used, map))
        return undetermined("no smooth map explains the pairs");
    const Samples s = chosen(pairs, used);
    const auto n = static_cast<double>(s.pixel.size());
    if (3 * n < 2 * static_cast<double>(count))
        return undetermined(Text("the largest set of pairs that agree has {} of {}", s.pixel.size(), count));
    if (!(flatness(s.pixel) > 0.01) || !(flatness(s.laser) > 0.01))
        return undetermined("the pairs that agree lie on one line");
    const Support support(s.pixel);

    double square_px = 0, square_mm = 0;
    for (const auto& p : s.pixel) {
        const Matrix2d plane = map.homography_slope(p) * map.noise() * map.homography_slope(p).transpose();
        const Matrix2d inverse = map.slope(p).inverse();
        square_px += 0.5 * (inverse * plane * inverse.transpose()).trace() / n;
        square_mm += plane.trace() / n;
    }
    result.noise_px = std::sqrt(square_px);
    result.noise_mm = std::sqrt(square_mm);
    result.degree = map.degree();
    result.effective_parameters = map.effective();

    const auto interpolation = [&](double step) {
        double sum = 0;
        int cells = 0;
        const auto stride = std::max<std::size_t>(1, s.pixel.size() / 400);
        for (std::size_t i = 0; i < s.pixel.size(); i += stride) {
            const double e = table_error_mm(map, s.pixel[i] - Vector2d(step, step) / 2, step);
            if (std::isfinite(e)) sum += e * e, ++cells;
        }
        return cells ? std::sqrt(sum / cells) : 0.0;
    };
    double step = fine;
    if (step == 0) {
        for (const double candidate : {32.0, 16.0, 8.0, 4.0, 2.0}) {
            if (step > 0 && (width / candidate) * (height / candidate) > 400000) break;
            step = candidate;
            if (candidate <= 0.5 * support.spacing &&
                interpolation(candidate) <= std::max(0.2 * result.noise_mm, 1e-6))
                break;
        }
    }
    result.interpolation_mm = interpolation(step);
    int folded = 0;
    result.table = build_table(map, support, s.pixel, width, height, step, folded);
    const LookupTable& table = result.table;
    std::size_t filled = 0, rows = 0;
    double variance = 0, worst_variance = 0;
    const auto stride = std::max<std::size_t>(1, table.x_mm.size() / 4000);
    for (std::size_t k = 0; k < table.x_mm.size(); ++k) {
        if (std::isnan(table.x_mm[k])) {
            ++result.holes;
            continue;
        }
        if (filled++ % stride != 0) continue;
        const Vector2d p(static_cast<double>(k % static_cast<std::size_t>(table.columns)) * step,
                         static_cast<double>(k / static_cast<std::size_t>(table.columns)) * step);
        const Matrix2d carry = map.homography_slope(p);
        const double v = map.spread_row(p).squaredNorm() * (carry * map.noise() * carry.transpose()).trace();
        variance += v;
        worst_variance = std::max(worst_variance, v);
        ++rows;
    }
    result.covered_share = static_cast<double>(filled) / static_cast<double>(table.x_mm.size());
    if (rows > 0) {
        result.map_sigma_mm = std::sqrt(variance / static_cast<double>(rows));
        result.map_sigma_worst_mm = std::sqrt(worst_variance);
    }

    double forward = 0, backward = 0;
    int supported = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        auto& pose = report.poses[i];
        pose.used = used[i];
        const auto xz = table.at(pairs[i].pixel);
        const Vector2d e = (xz ? *xz : map.at(pairs[i].pixel)) - pairs[i].laser_mm;
        if (e.allFinite()) {
            pose.rms_mm = e.norm();
            const double px = (map.slope(pairs[i].pixel).inverse() * e).norm();
            if (std::isfinite(px)) pose.rms_px = px;
        }
        if (allowed[i] && !used[i]) {
            pose.note = "contradicts the pairs around it and was left out";
            continue;
        }
        if (!used[i]) continue;
        // The noise of an edge pair may have it land just outside the table's cells.
        const auto back = pixel_in_table(table, pairs[i].laser_mm, pairs[i].pixel);
        if (!xz) {
            ++result.unsupported_pairs;
            pose.note = "beside a hole of the table";
            continue;
        }
        forward += e.squaredNorm();
        result.forward_max_mm = std::max(result.forward_max_mm, e.norm());
        ++supported;
        if (!back) continue;
        const double px = (*back - pairs[i].pixel).norm();
        pose.rms_px = px;
        backward += px * px;
        result.backward_max_px = std::max(result.backward_max_px, px);
    }
    if (supported == 0) return undetermined("the pairs are too far apart to fill one cell of the table");
    result.forward_rms_mm = std::sqrt(forward / supported);
    result.backward_rms_px = std::sqrt(backward / supported);
    report.hold_out = leave_out(pairs, used, map);
    Vector2d middle = Vector2d::Zero();
    for (const auto& p : s.pixel) middle += p / n;
    describe(map, table, middle, report);

    Text wrong;
    int wrong_count = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (allowed[i] && !used[i] && ++wrong_count <= 8) wrong = joined(wrong, ", ", pairs[i].id);
    if (wrong_count > 8) wrong = Text("{} and {} more", wrong, wrong_count - 8);
    const double hold_px = report.hold_out.rms_px / std::sqrt(2.0);  // per coordinate, as noise_px
    if (result.noise_px > 3 || hold_px > 3)
        report.judgement = {
            Verdict::poor,
            Text("the pairs fit to {:.1f} px only",
                 std::isfinite(hold_px) ? std::max(hold_px, result.noise_px) : result.noise_px),
            "check that pixels and laser points belong together"};
    else if (folded > 0)
        report.judgement = {Verdict::poor, Text("the map folds over in {} cells", folded),
                            "measure more positions there, or check the pairs nearby"};
    else if (wrong_count > 0)
        report.judgement = {Verdict::usable,
                            wrong_count == 1
                                ? Text("the pair {} contradicts the others and was left out", wrong)
                                : Text("the pairs {} contradict the others and were left out", wrong),
                            "measure again there"};
    else if (n < 25)
        report.judgement = {Verdict::usable, Text("{:.0f} pairs are few", n), spread};
    else if (result.covered_share < 0.5)
        report.judgement = {Verdict::usable,
                            Text("the table covers {:.0f} % of the image", 100 * result.covered_share),
                            "measure positions in the rest of the image, if the sensor is to see there"};
    else if (hold_px > std::max(1.6 * result.noise_px, 0.05))
        report.judgement = {Verdict::usable,
                            Text("between the pairs the map is off by {:.2f} px, at them by {:.2f}", hold_px,
                                 result.noise_px),
                            "measure positions closer together"};
    else
        report.judgement = {
            Verdict::good,
            Text("{:.0f} pairs fit to {:.3f} mm ({:.2f} px), the map is known to "
                 "{:.3f} mm over {:.0f} % of the image",
                 n, result.forward_rms_mm, result.noise_px, result.map_sigma_mm, 100 * result.covered_share),
            ""};
    return result;
}

}  // namespace seamwright
