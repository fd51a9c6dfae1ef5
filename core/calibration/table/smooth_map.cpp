#include "core/calibration/table/smooth_map.h"

#include <Eigen/QR>

#include "core/calibration/camera/camera.h"
#include "core/calibration/numbers.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::lookup_table {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {
constexpr Index kMostKnots = 120;
constexpr std::size_t kFewestForSpline = 24;  // samples
constexpr Index kManySamples = 40;            // from here on degrees below three only bend the map
constexpr double kMostTerms =
    0.67;  // a term of the polynomial for fewer than this many samples each fits noise
constexpr double kMostFreedom = 0.8;     // of the samples, with the spline
constexpr int kStiffnessSteps = 22;      // half a decade each
constexpr double kSmallestBend = 1e-10;  // of the largest: the penalty's null space by rounding
constexpr double kLeastRank = 1e-9;      // of the polynomial's triangle
constexpr double kLeastWeight = 0.01;    // of the best candidate's
constexpr double kSameKnot2 = 1e-8;  // squared distance in the map's own coordinates, up to which two are one
constexpr double kLeastLeftOut = 1e-6;   // kLeastRest, where candidates are compared
constexpr double kNoError_px2 = 1e-300;  // guards the ratio of exact candidates
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
    if (places.size() < kFewestForSpline) return;
    std::vector<double> nearest(places.size(), kInfinity);
    std::size_t next = 0;
    while (knots_.size() < wanted) {
        knots_.push_back(places[next]);
        double most = -1;
        for (std::size_t i = 0; i < places.size(); ++i) {
            nearest[i] = std::min(nearest[i], (places[i] - knots_.back()).squaredNorm());
            if (nearest[i] > most) most = nearest[i], next = i;
        }
        if (!(most > kSameKnot2)) break;
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

// Every step of stiffness at the last of degrees_ is a candidate, as long as the pairs do not speak against it.
void SmoothMap::try_stiffnesses(const Modes& m, const MatrixXd& transform) {
    const Index n = m.flat.rows();
    for (int step = -1; step <= m.last_step(); ++step) {
        const VectorXd inverse = m.inverse_at(step);
        Candidate c;
        c.degree = degrees_.size() - 1;
        c.residual = m.flat;
        c.leverage = m.own;
        c.effective = static_cast<double>(m.q.cols());
        if (step >= 0) {
            c.residual -= m.modes * (inverse.asDiagonal() * m.scores);
            c.leverage += m.squares * inverse;
            c.effective += m.power.dot(inverse);
        }
        if (!(c.effective < kMostFreedom * static_cast<double>(n))) break;
        for (Index i = 0; i < n; ++i) {
            const double rest = std::max(1 - c.leverage(i), kLeastLeftOut);
            c.error += c.residual.row(i).squaredNorm() / (rest * rest);
        }
        if (!std::isfinite(c.error) || !(weight_of(c, n) >= kLeastWeight)) continue;
        least_error_ = std::min(least_error_, c.error);
        MatrixXd right = m.qy;
        if (step >= 0) {
            const MatrixXd g = inverse.asDiagonal() * m.scores;
            c.bend = transform * (m.vectors * g);
            right -= m.mixed * (m.vectors * g);
            c.shrink = inverse.cwiseSqrt();
        } else {
            c.bend = MatrixXd::Zero(static_cast<Index>(knots_.size()), 2);
        }
        c.poly = m.r.triangularView<Eigen::Upper>().solve(right);
        candidates_.push_back(std::move(c));
        std::erase_if(candidates_, [&](const Candidate& k) { return weight_of(k, n) < kLeastWeight; });
    }
}

// Beside the best so far: what each predicts of pairs it has not seen, as the likelihood of two numbers a pair, which are
// half as many as they seem: left-out errors of neighbours go together.
double SmoothMap::weight_of(const Candidate& c, Index pairs) const {
    const double error = std::max(c.error, kNoError_px2);
    return error <= least_error_ ? 1 : std::pow(least_error_ / error, 0.5 * static_cast<double>(pairs));
}

// The mean of the candidates by their weights.
void SmoothMap::average() {
    const Index pairs = candidates_.front().residual.rows();
    const double n = static_cast<double>(pairs);
    const auto best =
        std::min_element(candidates_.begin(), candidates_.end(),
                         [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
    degree_ = degrees_[best->degree].degree;
    for (Candidate& c : candidates_) c.weight = weight_of(c, pairs);
    double all = 0;
    for (const Candidate& c : candidates_) all += c.weight;
    const auto knots = static_cast<Index>(knots_.size());
    poly_ = MatrixXd::Zero(terms(degrees_.back().degree), 2);
    bend_ = MatrixXd::Zero(knots, 2);
    residual_ = MatrixXd::Zero(pairs, 2);
    leverage_ = VectorXd::Zero(pairs);
    noise_.setZero();
    effective_ = 0;
    for (Candidate& c : candidates_) {
        c.weight /= all;
        poly_.topRows(c.poly.rows()) += c.weight * c.poly;
        bend_ += c.weight * c.bend;
        residual_ += c.weight * c.residual;
        leverage_ += c.weight * c.leverage;
        effective_ += c.weight * c.effective;
        noise_ += c.weight / std::max(1.0, n - c.effective) * (c.residual.transpose() * c.residual);
    }
    student_ = student_quantile(kUpper95, std::max(1.0, 2 * freedom())) / normal_quantile(kUpper95);
    for (Candidate& c : candidates_) c.residual.resize(0, 0), c.leverage.resize(0);
}

void SmoothMap::state_places(const Samples& s, double sigma_mm) {
    if (!(sigma_mm > 0)) return;
    double stated = 0;
    for (const Vector2d& p : s.pixel)
        stated += sigma_mm * sigma_mm * homography_slope(p).inverse().squaredNorm() /
                  static_cast<double>(s.pixel.size());
    if (!(stated > student_ * student_ * noise_.trace())) return;
    student_ = 1;
    if (noise_.trace() > 0)
        noise_ *= stated / noise_.trace();
    else
        noise_ = stated / 2 * Eigen::Matrix2d::Identity();
}

void SmoothMap::set_rows(const Samples& s, const StageRows& rows) {
    constexpr std::size_t kMostNumbers = 4'000'000;
    by_rows_ = {};
    row_sigma_mm_.resize(0);
    const std::size_t all = rows[0].size() + rows[1].size();
    if (all == 0 || all * s.pixel.size() > kMostNumbers) return;
    for (MatrixXd& by : by_rows_)
        by = MatrixXd::Zero(static_cast<Index>(s.pixel.size()), static_cast<Index>(all));
    rows_of_x_ = static_cast<Index>(rows[0].size());
    Index column = 0;
    for (Index axis = 0; axis < 2; ++axis)
        for (const auto& row : rows[static_cast<std::size_t>(axis)]) {
            for (const std::size_t i : row) {
                const Eigen::Vector3d q = inverse_ * s.laser[i].homogeneous();
                const Vector2d moves =
                    (inverse_.block<2, 1>(0, axis) - q.hnormalized() * inverse_(2, axis)) / q.z();
                by_rows_[0](static_cast<Index>(i), column) = moves.x();
                by_rows_[1](static_cast<Index>(i), column) = moves.y();
            }
            ++column;
        }
}

void SmoothMap::state_rows(const std::array<double, 2>& sigma_mm) {
    const Index all = by_rows_[0].cols();
    row_sigma_mm_.resize(0);
    if (all == 0 || !(std::max(sigma_mm[0], sigma_mm[1]) > 0)) return;
    row_sigma_mm_.resize(all);
    row_sigma_mm_.head(rows_of_x_).setConstant(sigma_mm[0]);
    row_sigma_mm_.tail(all - rows_of_x_).setConstant(sigma_mm[1]);
}

SmoothMap::Known SmoothMap::known(const Vector2d& pixel) const {
    const Vector2d c = (pixel - mean_) / scale_;
    const Eigen::RowVectorXd powers = monomials(c, degrees_.back().degree), kernels = kernel(c);
    const Vector2d mean = (powers * poly_ + kernels * bend_).transpose();
    Known known;
    known.apart.resize(2, static_cast<Index>(candidates_.size()));
    std::vector<VectorXd> flat(degrees_.size()),
        bent(degrees_.size());  // each degree's, made when first asked for
    Index length = 0;
    for (const Candidate& k : candidates_) length += k.poly.rows() + k.shrink.size();
    known.row.resize(length);
    Index at = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate& k = candidates_[i];
        const Degree& d = degrees_[k.degree];
        const double root = std::sqrt(k.weight);
        VectorXd& row = flat[k.degree];
        if (row.size() == 0)
            row =
                d.r.transpose().triangularView<Eigen::Lower>().solve(powers.head(k.poly.rows()).transpose());
        known.row.segment(at, row.size()) = root * row;
        at += row.size();
        if (k.shrink.size() > 0) {
            VectorXd& modes = bent[k.degree];
            if (modes.size() == 0) modes = (kernels * d.rotate).transpose() - d.cross.transpose() * row;
            known.row.segment(at, modes.size()) = root * modes.cwiseProduct(k.shrink);
            at += modes.size();
        }
        known.apart.col(static_cast<Index>(i)) =
            root * ((powers.head(k.poly.rows()) * k.poly + kernels * k.bend).transpose() - mean);
    }
    known.row *= student_;
    if (row_sigma_mm_.size() > 0) {
        Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(2, row_sigma_mm_.size());
        for (const Candidate& k : candidates_) {
            const Degree& d = degrees_[k.degree];
            for (Index axis = 0; axis < 2; ++axis) {
                const auto a = static_cast<std::size_t>(axis);
                moved.row(axis) += k.weight * flat[k.degree].transpose() * d.flat_rows[a];
                if (k.shrink.size() > 0)
                    moved.row(axis) += k.weight *
                                       bent[k.degree].cwiseProduct(k.shrink.cwiseAbs2()).transpose() *
                                       d.bent_rows[a];
            }
        }
        const Index at_rows = known.apart.cols();
        known.apart.conservativeResize(2, at_rows + moved.cols());
        known.apart.rightCols(moved.cols()) = moved * row_sigma_mm_.asDiagonal();
    }
    return known;
}

bool SmoothMap::fit(const Samples& s, int least_degree, int most_degree, const StageRows& rows) {
    const auto n = static_cast<Index>(s.pixel.size());
    std::vector<Vector2d> places;
    MatrixXd y, columns, transform;
    if (!set_frame(s, places, y)) return false;
    choose_knots(places);
    set_rows(s, rows);
    if (!spline_columns(places, columns, transform)) return false;

    // Every lens bends to the third degree: a lower one saves noise only where samples are few.
    if (n >= kManySamples) least_degree = std::max(least_degree, std::min(3, most_degree));
    degrees_.clear(), candidates_.clear();
    least_error_ = kInfinity;
    for (int degree = least_degree; degree <= most_degree; ++degree) {
        const Index m = terms(degree);
        if (degree > 1 && static_cast<double>(m) > kMostTerms * static_cast<double>(n)) break;
        MatrixXd p(n, m);
        for (Index i = 0; i < n; ++i) p.row(i) = monomials(places[static_cast<std::size_t>(i)], degree);
        const Eigen::HouseholderQR<MatrixXd> qr(p);
        const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, m);
        const MatrixXd r = qr.matrixQR().topRows(m).triangularView<Eigen::Upper>();
        if (!(r.diagonal().cwiseAbs().minCoeff() > kLeastRank * r.diagonal().cwiseAbs().maxCoeff())) break;
        const Modes modes(q, r, y, columns);
        degrees_.push_back({degree, r, {}, {}, {}, {}});
        for (std::size_t axis = 0; axis < 2 && by_rows_[axis].cols() > 0; ++axis) {
            degrees_.back().flat_rows[axis] = q.transpose() * by_rows_[axis];
            if (columns.size() > 0)
                degrees_.back().bent_rows[axis] = modes.modes.transpose() * by_rows_[axis];
        }
        if (columns.size() > 0) {
            degrees_.back().cross = modes.mixed * modes.vectors;
            degrees_.back().rotate = transform * modes.vectors;
        }
        try_stiffnesses(modes, transform);
    }
    if (candidates_.empty()) return false;
    average();
    return poly_.allFinite() && noise_.allFinite();
}

}  // namespace seamwright::lookup_table
