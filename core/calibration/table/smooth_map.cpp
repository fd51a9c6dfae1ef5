#include "core/calibration/table/smooth_map.h"

#include <Eigen/QR>

#include "core/calibration/camera/camera.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::lookup_table {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {
constexpr Index kMostKnots = 120;
constexpr Index kManySamples = 40;  // from here on degrees below three only bend the map
constexpr double kMostTerms =
    0.6;  // a term of the polynomial for fewer than this many samples each fits noise
constexpr double kMostFreedom = 0.8;     // of the samples, with the spline
constexpr int kStiffnessSteps = 22;      // half a decade each
constexpr double kSmallestBend = 1e-10;  // of the largest: the penalty's null space by rounding
constexpr double kLeastRank = 1e-9;      // of the polynomial's triangle
}  // namespace

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

// Homography and scale; the samples' places in the map's own coordinates and what the homography leaves, in px.
bool SmoothMap::set_frame(const Samples& s, std::vector<Vector2d>& places, MatrixXd& y) {
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
    y.resize(n, 2);
    for (Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Eigen::Vector3d q = inverse_ * s.laser[k].homogeneous();
        if (!(q.z() * inverse_side_ > 0)) return false;
        y.row(i) = (q.hnormalized() - s.pixel[k]).transpose();
        places.push_back((s.pixel[k] - mean_) / scale_);
    }
    return y.allFinite();
}

// Kernel columns at the places, free of what a plane can say (the spline's null space), scaled to a unit penalty:
// kernels * transform. Empty without knots. False: the knots do not carry a spline.
bool SmoothMap::spline_columns(const std::vector<Vector2d>& places, MatrixXd& columns,
                               MatrixXd& transform) const {
    if (knots_.empty()) return true;
    const auto m = static_cast<Index>(knots_.size());
    const auto n = static_cast<Index>(places.size());
    MatrixXd affine(m, 3), penalty(m, m);
    for (Index i = 0; i < m; ++i) {
        affine.row(i) = monomials(knots_[static_cast<std::size_t>(i)], 1);
        penalty.row(i) = kernel(knots_[static_cast<std::size_t>(i)]);
    }
    const Eigen::HouseholderQR<MatrixXd> qr(affine);
    const MatrixXd q = qr.householderQ() * MatrixXd::Identity(m, m);
    const MatrixXd free = q.rightCols(m - 3);
    const SymmetricEigen eigen = symmetric_eigen(free.transpose() * penalty * free);
    const double least = kSmallestBend * eigen.values(m - 4);
    if (!(least > 0)) return false;
    transform = free * eigen.vectors * eigen.values.cwiseMax(least).cwiseSqrt().cwiseInverse().asDiagonal();
    MatrixXd kernels(n, m);
    for (Index i = 0; i < n; ++i) kernels.row(i) = kernel(places[static_cast<std::size_t>(i)]);
    columns = kernels * transform;
    return true;
}

// The spline's part of one degree: what the polynomial leaves of it, in modes that do not disturb one another.
struct SmoothMap::Modes {
    MatrixXd q, r, qy, flat;  // of the polynomial: basis, triangle, coefficients, what it leaves of y
    MatrixXd mixed, vectors, modes, scores, squares;
    VectorXd own, power;  // leverage of the polynomial; of each mode

    Modes(const MatrixXd& basis, const MatrixXd& triangle, const MatrixXd& y, const MatrixXd& columns)
        : q(basis), r(triangle), qy(q.transpose() * y), flat(y - q * qy), own(q.rowwise().squaredNorm()) {
        if (columns.size() == 0) return;
        mixed = q.transpose() * columns;
        modes = columns - q * mixed;
        const SymmetricEigen eigen = symmetric_eigen(modes.transpose() * modes);
        power = eigen.values.cwiseMax(0);
        vectors = eigen.vectors;
        modes = modes * vectors;
        scores = modes.transpose() * flat;
        squares = modes.cwiseAbs2();
    }
    // What step's spline keeps of each mode: from no spline at all (-1) to one that follows the samples.
    int last_step() const { return power.size() > 0 ? kStiffnessSteps : -1; }
    VectorXd inverse_at(int step) const {
        if (step < 0) return VectorXd::Zero(power.size());
        return (power.array() + power.maxCoeff() * std::pow(10.0, 1 - 0.5 * step)).inverse();
    }
};

// The steps of stiffness at one degree; keeps the one with the least leave-one-out error below `best`.
void SmoothMap::try_stiffnesses(const Modes& m, int degree, const MatrixXd& transform, double& best) {
    const Index n = m.flat.rows();
    for (int step = -1; step <= m.last_step(); ++step) {
        const VectorXd inverse = m.inverse_at(step);
        MatrixXd residual = m.flat;
        VectorXd leverage = m.own;
        double effective = static_cast<double>(m.q.cols());
        if (step >= 0) {
            residual -= m.modes * (inverse.asDiagonal() * m.scores);
            leverage += m.squares * inverse;
            effective += m.power.dot(inverse);
        }
        if (!(effective < kMostFreedom * static_cast<double>(n))) break;
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
        r_ = m.r;
        MatrixXd right = m.qy;
        if (step >= 0) {
            const MatrixXd g = inverse.asDiagonal() * m.scores;
            bend_ = transform * (m.vectors * g);
            right -= m.mixed * (m.vectors * g);
            rotate_ = transform * m.vectors;
            cross_ = m.mixed * m.vectors;
            shrink_ = inverse.cwiseSqrt();
        } else {
            shrink_.resize(0);
            bend_ = MatrixXd::Zero(static_cast<Index>(knots_.size()), 2);
        }
        poly_ = m.r.triangularView<Eigen::Upper>().solve(right);
    }
}

bool SmoothMap::fit(const Samples& s, int least_degree, int most_degree) {
    const auto n = static_cast<Index>(s.pixel.size());
    std::vector<Vector2d> places;
    MatrixXd y, columns, transform;
    if (!set_frame(s, places, y)) return false;
    choose_knots(places);
    if (!spline_columns(places, columns, transform)) return false;

    // Every lens bends to the third degree: a lower one saves noise only where samples are few.
    if (n >= kManySamples) least_degree = std::max(least_degree, std::min(3, most_degree));
    double best = kInfinity;
    for (int degree = least_degree; degree <= most_degree; ++degree) {
        const Index m = terms(degree);
        if (degree > 1 && static_cast<double>(m) > kMostTerms * static_cast<double>(n)) break;
        MatrixXd p(n, m);
        for (Index i = 0; i < n; ++i) p.row(i) = monomials(places[static_cast<std::size_t>(i)], degree);
        const Eigen::HouseholderQR<MatrixXd> qr(p);
        const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, m);
        const MatrixXd r = qr.matrixQR().topRows(m).triangularView<Eigen::Upper>();
        if (!(r.diagonal().cwiseAbs().minCoeff() > kLeastRank * r.diagonal().cwiseAbs().maxCoeff())) break;
        try_stiffnesses(Modes(q, r, y, columns), degree, transform, best);
    }
    if (!std::isfinite(best)) return false;
    if (shrink_.size() == 0) knots_.clear();
    noise_ = residual_.transpose() * residual_ / std::max(1.0, freedom());
    return poly_.allFinite() && noise_.allFinite();
}

}  // namespace seamwright::lookup_table
