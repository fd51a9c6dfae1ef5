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
}

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

}  // namespace seamwright::lookup_table
