#include "core/elastic/bead_shape.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace seamwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kLengths = 9, kHeights = 9;
constexpr double kLowestHeight = 0.05, kHighestHeight = 50;  // tau, mm per mm
constexpr double kOwnNoise = 1e-3;                           // of a shape at a spot, mm per mm
constexpr double kNegligible = 1e-3;                         // of the likelihood
constexpr double kTrendSingular = 1e-13;                     // reciprocal condition
constexpr double kSeenShare = 1e-6;  // of the direction that is seen best: less is not seen

double matern52(double x) {
    const double r = std::sqrt(5.0) * x;
    return (1 + r + r * r / 3) * std::exp(-r);
}

double distance(const BeadPlace& a, const BeadPlace& b, bool along_arc, const BeadArc& arc) {
    if (!along_arc) return (a.place_mm - b.place_mm).norm();
    const double d = std::abs(a.arc_mm - b.arc_mm);
    if (!(arc.closed_length_mm > 0)) return d;
    return arc.closed_length_mm / kPi * std::abs(std::sin(kPi * d / arc.closed_length_mm));
}

// One setting of the kernel, solved for every mode.
struct Kriging {
    bool along_arc = false;
    double length_mm = 1, height = 1, weight = 0;
    // Observations o = H f + noise with H the directions that are told.
    std::vector<Eigen::LDLT<MatrixXd>> covariance;  // K of a mode
    std::vector<MatrixXd> trend_gain;               // (T^T K^-1 T)^-1 T^T K^-1
    std::vector<MatrixXd> trend_covariance;
    std::vector<VectorXd> trend, rest;  // rho; K^-1 (o - T rho)
};

}  // namespace

struct BeadShape::Impl {
    std::vector<BeadPlace> spots;
    BeadArc arc;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double extent = 1;
    MatrixXd told;  // H, rows of unit length over the spots' coordinates
    std::vector<Index> row_spot;
    std::vector<VectorXd> seen;  // o of a mode
    std::vector<VectorXd> noise;
    std::vector<Kriging> settings;
    double arc_share = 0;

    Eigen::Matrix<double, 3, 6> motions(const Eigen::Vector3d& p) const {
        Eigen::Matrix<double, 3, 6> out;
        out << Eigen::Matrix3d::Identity(), -skew((p - middle) / extent);
        return out;
    }
    MatrixXd trend() const {
        MatrixXd all(3 * static_cast<Index>(spots.size()), 6);
        for (std::size_t n = 0; n < spots.size(); ++n)
            all.middleRows<3>(3 * static_cast<Index>(n)) = motions(spots[n].place_mm);
        return told * all;
    }
    // Columns of the trend that the spots tell apart.
    MatrixXd kernel(const Kriging& s) const {
        const Index rows = told.rows();
        MatrixXd k(rows, rows);
        for (Index a = 0; a < rows; ++a)
            for (Index b = a; b < rows; ++b) {
                const auto i = row_spot[static_cast<std::size_t>(a)],
                           j = row_spot[static_cast<std::size_t>(b)];
                const double d = distance(spots[static_cast<std::size_t>(i)],
                                          spots[static_cast<std::size_t>(j)], s.along_arc, arc);
                const double dot = told.row(a).segment<3>(3 * i).dot(told.row(b).segment<3>(3 * j));
                k(a, b) = k(b, a) = s.height * s.height * matern52(d / s.length_mm) * dot;
            }
        return k;
    }
    // Restricted log-likelihood over all modes; what at() needs is left in `s`.
    bool solve(Kriging& s, const MatrixXd& t, double& likelihood) const {
        const MatrixXd k = kernel(s);
        likelihood = 0;
        for (std::size_t m = 0; m < seen.size(); ++m) {
            MatrixXd noisy = k;
            noisy.diagonal() += noise[m];
            const Eigen::LDLT<MatrixXd>& root = s.covariance.emplace_back(noisy);
            if (root.info() != Eigen::Success || !root.isPositive()) return false;
            const MatrixXd heavy = root.solve(t);
            const MatrixXd inner = t.transpose() * heavy;
            const Eigen::LDLT<MatrixXd> inner_root(inner);
            if (inner_root.info() != Eigen::Success || inner_root.rcond() < kTrendSingular) return false;
            s.trend_covariance.push_back(inner_root.solve(MatrixXd::Identity(inner.rows(), inner.cols())));
            s.trend_gain.push_back(inner_root.solve(heavy.transpose()));
            s.trend.push_back(s.trend_gain.back() * seen[m]);
            const VectorXd off = seen[m] - t * s.trend.back();
            s.rest.push_back(root.solve(off));
            likelihood -= 0.5 * (root.vectorD().array().log().sum() +
                                 inner_root.vectorD().array().log().sum() + off.dot(s.rest.back()));
        }
        return std::isfinite(likelihood);
    }
};

Expected<BeadShape> BeadShape::make(const ElasticModes& modes, std::span<const BeadPlace> spots,
                                    const BeadArc& arc) {
    SEAM_OK(check_modes(modes));
    const Text where = "modes along the bead";
    if (spots.size() != modes.spots.size())
        return input_error("there must be a place for every spot of the modes", where);
    if (!std::isfinite(arc.closed_length_mm) || arc.closed_length_mm < 0)
        return input_error("the length of the bead is no positive number", where);
    auto impl = std::make_unique<Impl>();
    impl->spots.assign(spots.begin(), spots.end());
    impl->arc = arc;
    for (const BeadPlace& p : spots) {
        if (!p.place_mm.allFinite() || (arc.known && !std::isfinite(p.arc_mm)))
            return input_error("a spot's place on the bead is not finite", where);
        impl->middle += p.place_mm / static_cast<double>(spots.size());
    }
    double nearest = kInfinity, farthest = 0;
    for (std::size_t a = 0; a < spots.size(); ++a)
        for (std::size_t b = a + 1; b < spots.size(); ++b) {
            const double d = (spots[a].place_mm - spots[b].place_mm).norm();
            nearest = std::min(nearest, std::max(d, 1.0));
            farthest = std::max(farthest, d);
        }
    impl->extent = std::max(farthest, 1.0);

    // What the cuts tell at each spot, with its variance: the directions of `seen`.
    std::vector<std::pair<Eigen::Vector3d, double>> rows;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(modes.spots[n].seen);
        const double factor = modes.noise_factor * modes.spots[n].noise_factor;
        for (int i = 0; i < 3; ++i) {
            if (!(eigen.eigenvalues()[i] > kSeenShare * eigen.eigenvalues()[2])) continue;
            rows.emplace_back(eigen.eigenvectors().col(i), factor * factor / eigen.eigenvalues()[i]);
            impl->row_spot.push_back(static_cast<Index>(n));
        }
    }
    if (rows.size() < 7)
        return input_error("the spots are too few to tell a shape from a motion", where,
                           "learn with more spots");
    const auto count = static_cast<Index>(rows.size());
    impl->told = MatrixXd::Zero(count, 3 * static_cast<Index>(spots.size()));
    for (Index r = 0; r < count; ++r)
        impl->told.row(r).segment<3>(3 * impl->row_spot[static_cast<std::size_t>(r)]) =
            rows[static_cast<std::size_t>(r)].first.transpose();
    for (const ElasticMode& mode : modes.modes) {
        VectorXd shape(3 * static_cast<Index>(spots.size()));
        for (std::size_t n = 0; n < spots.size(); ++n)
            shape.segment<3>(3 * static_cast<Index>(n)) = mode.shape[n];
        impl->seen.push_back(impl->told * shape);
        VectorXd noise(count);
        const double times = std::max(1, modes.rows) * mode.variance_mm2;
        for (Index r = 0; r < count; ++r)
            noise[r] = kOwnNoise * kOwnNoise + rows[static_cast<std::size_t>(r)].second / times;
        impl->noise.push_back(noise);
    }

    const MatrixXd t = impl->trend();
    std::vector<double> likelihoods;
    for (int along = 0; along < (arc.known ? 2 : 1); ++along) {
        for (int l = 0; l < kLengths; ++l) {
            for (int h = 0; h < kHeights; ++h) {
                Kriging s;
                s.along_arc = along == 1;
                const double shortest = 0.5 * nearest, longest = 3 * impl->extent;
                s.length_mm = shortest * std::pow(longest / shortest, l / (kLengths - 1.0));
                s.height = kLowestHeight * std::pow(kHighestHeight / kLowestHeight, h / (kHeights - 1.0));
                double likelihood = 0;
                if (!impl->solve(s, t, likelihood)) continue;
                impl->settings.push_back(std::move(s));
                likelihoods.push_back(likelihood);
            }
        }
    }
    if (!modes.modes.empty() && likelihoods.empty())
        return input_error("the spots do not tell the modes from a motion", where, "learn with more spots");
    if (!likelihoods.empty()) {
        const double best = *std::ranges::max_element(likelihoods);
        double sum = 0;
        for (std::size_t i = 0; i < likelihoods.size(); ++i) {
            const double w = std::exp(likelihoods[i] - best);
            impl->settings[i].weight = w < kNegligible ? 0 : w;
            sum += impl->settings[i].weight;
        }
        std::erase_if(impl->settings, [](const Kriging& s) { return s.weight == 0; });
        for (Kriging& s : impl->settings) {
            s.weight /= sum;
            if (s.along_arc) impl->arc_share += s.weight;
        }
    }
    return BeadShape(std::move(impl));
}

std::vector<ShapeAt> BeadShape::at(const BeadPlace& place) const {
    const Impl& i = *impl_;
    std::vector<ShapeAt> out(i.seen.size());
    std::vector<Eigen::Matrix3d> square(i.seen.size(), Eigen::Matrix3d::Zero());
    const MatrixXd here = i.motions(place.place_mm);
    const MatrixXd t = i.trend();
    for (const Kriging& s : i.settings) {
        MatrixXd k(3, i.told.rows());
        for (Index r = 0; r < i.told.rows(); ++r) {
            const Index n = i.row_spot[static_cast<std::size_t>(r)];
            const double d = distance(place, i.spots[static_cast<std::size_t>(n)], s.along_arc, i.arc);
            k.col(r) =
                s.height * s.height * matern52(d / s.length_mm) * i.told.row(r).segment<3>(3 * n).transpose();
        }
        for (std::size_t m = 0; m < out.size(); ++m) {
            const Eigen::Vector3d mean = here * s.trend[m] + k * s.rest[m];
            const MatrixXd left = here - k * s.covariance[m].solve(t);
            const Eigen::Matrix3d covariance = s.height * s.height * Eigen::Matrix3d::Identity() -
                                               k * s.covariance[m].solve(MatrixXd(k.transpose())) +
                                               left * s.trend_covariance[m] * left.transpose();
            out[m].shape += s.weight * mean;
            out[m].covariance += s.weight * covariance;
            square[m] += s.weight * mean * mean.transpose();
        }
    }
    for (std::size_t m = 0; m < out.size(); ++m) {
        out[m].covariance += square[m] - out[m].shape * out[m].shape.transpose();
        out[m].covariance = (0.5 * (out[m].covariance + out[m].covariance.transpose())).eval();
    }
    return out;
}

double BeadShape::arc_share() const {
    return impl_->arc_share;
}
BeadShape::BeadShape(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BeadShape::BeadShape(BeadShape&&) noexcept = default;
BeadShape& BeadShape::operator=(BeadShape&&) noexcept = default;
BeadShape::~BeadShape() = default;

BeadPoint bead_point(const ElasticCorrection& correction, const BeadShape& shape, const BeadPlace& place) {
    const Pose& d = correction.correction.displacement.workobject_from_movedworkobject;
    const Eigen::Matrix3d r = d.linear();
    BeadPoint out;
    const std::size_t modes = correction.acted ? correction.amplitudes.size() : 0;
    MatrixXd j = MatrixXd::Zero(3, 6 + static_cast<Index>(modes));
    Eigen::Matrix3d between = Eigen::Matrix3d::Zero();
    if (modes > 0) {
        const std::vector<ShapeAt> at = shape.at(place);
        for (std::size_t k = 0; k < modes; ++k) {
            const double a = correction.amplitudes[k].value_mm, s = correction.amplitudes[k].sigma_mm;
            out.added_mm += a * at[k].shape;
            j.col(6 + static_cast<Index>(k)) = r * at[k].shape;
            between += (a * a + s * s) * (r * at[k].covariance * r.transpose());
        }
    }
    const Eigen::Vector3d bent = place.place_mm + out.added_mm;
    out.place_mm = d * bent;
    j.leftCols<3>().setIdentity();
    j.middleCols<3>(3) = -skew(r * bent);
    const MatrixXd covariance =
        modes > 0 ? correction.covariance : MatrixXd(correction.correction.covariance);
    out.covariance_mm2 = j * covariance * j.transpose() + between;
    return out;
}

}  // namespace seamwright
