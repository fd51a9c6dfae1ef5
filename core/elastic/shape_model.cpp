#include "core/elastic/shape_model.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace seamwright::elastic {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastKappa = 1e-6;
constexpr double kLeastMode = 0.05;  // of kappa: variance that a mode starts with
// Of the loading's size, and of each factor: a step that changes them by less is the last.
constexpr double kSizeSettled = 1e-5, kFactorSettled = 3e-3;
constexpr double kToldShare = 1e-6;   // of the direction that a spot tells best
constexpr double kSingular = 1e-14;   // reciprocal condition of the motions
constexpr double kDrawn = 2;          // coordinates: what all spots weigh in the factor of one
constexpr double kMostFitted = 0.75;  // of the degrees: what mean and loading may be said to take

VectorXd stated(std::size_t spots) {
    return VectorXd::Ones(static_cast<Index>(spots));
}

}  // namespace

ShapeRow::ShapeRow(const ElasticRow& row, const MatrixXd& basis, int part)
    : spots_(row.seen.size()),
      told_(basis.cols()),
      motions_(row.motions.cols()),
      shared_(row.shared),
      part_(part) {
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const Eigen::Matrix3d& l = row.seen[n];
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(l, Eigen::EigenvaluesOnly);
        const double most = eigen.eigenvalues()[2];
        if (!(most > 0)) continue;
        Spot& s = spots_[n];
        s.observed = static_cast<int>((eigen.eigenvalues().array() > kToldShare * most).count());
        const auto at = 3 * static_cast<Index>(n);
        const MatrixXd here = basis.middleRows<3>(at), moves = row.motions.middleRows<3>(at);
        const Eigen::Vector3d y = row.residual_mm.segment<3>(at);
        s.shape = here.transpose() * l * here;
        s.across = here.transpose() * l * moves;
        s.motion = moves.transpose() * l * moves;
        s.heard = here.transpose() * (l * y);
        s.still = moves.transpose() * (l * y);
        s.power = y.dot(l * y);
    }
}

int ShapeRow::rank() const {
    int observed = 0;
    for (const Spot& s : spots_) observed += s.observed;
    return observed - static_cast<int>(motions_) + shared_;
}

bool ShapeRow::regular() const {
    MatrixXd a = MatrixXd::Zero(motions_, motions_);
    for (const Spot& s : spots_)
        if (s.observed > 0) a += s.motion;
    a.diagonal().tail(shared_).array() += 1;
    const Eigen::LDLT<MatrixXd> factorised(a);
    return factorised.info() == Eigen::Success && factorised.isPositive() && factorised.rcond() > kSingular;
}

Told ShapeRow::told(const VectorXd& kappa) const {
    Told out{MatrixXd::Zero(told_, told_), VectorXd::Zero(told_), 0, {}, VectorXd::Zero(motions_), {}, 0};
    MatrixXd across = MatrixXd::Zero(told_, motions_), a = MatrixXd::Zero(motions_, motions_);
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const Spot& s = spots_[n];
        if (s.observed == 0) continue;
        const double own = kappa[static_cast<Index>(n)], w = 1 / own;
        out.m += w * s.shape;
        out.heard += w * s.heard;
        out.power += w * s.power;
        across += w * s.across;
        a += w * s.motion;
        out.still += w * s.still;
        out.log_determinant += s.observed * std::log(own);
    }
    a.diagonal().tail(shared_).array() += 1;
    const Eigen::LDLT<MatrixXd> factorised(a);
    out.log_determinant += factorised.vectorD().array().max(std::numeric_limits<double>::min()).log().sum();
    out.spread = factorised.solve(MatrixXd::Identity(motions_, motions_));
    out.gain = out.spread * across.transpose();
    out.m -= across * out.gain;
    out.m = (0.5 * (out.m + out.m.transpose())).eval();
    const VectorXd motion = out.spread * out.still;
    out.heard -= across * motion;
    out.power = std::max(0.0, out.power - out.still.dot(motion));
    out.still = motion;
    return out;
}

void ShapeRow::add_squares(const Told& told, const VectorXd& u, const MatrixXd& loading,
                           const MatrixXd& covariance, VectorXd& squares) const {
    const VectorXd motion = told.still - told.gain * u;
    const MatrixXd moves = told.gain * loading;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const Spot& s = spots_[n];
        if (s.observed == 0) continue;
        double sum = s.power - 2 * u.dot(s.heard) + u.dot(s.shape * u) +
                     motion.dot(s.motion * motion - 2 * (s.still - s.across.transpose() * u));
        sum += told.spread.cwiseProduct(s.motion).sum();
        if (loading.cols() > 0) {
            const MatrixXd cross = loading.transpose() * s.across * moves;
            const MatrixXd spread = loading.transpose() * s.shape * loading - cross - cross.transpose() +
                                    moves.transpose() * s.motion * moves;
            sum += covariance.cwiseProduct(spread).sum();
        }
        squares[static_cast<Index>(n)] += std::max(0.0, sum);
    }
}

namespace {

std::vector<Told> told_of(std::span<const ShapeRow> rows, const VectorXd& kappa) {
    std::vector<Told> out;
    out.reserve(rows.size());
    for (const ShapeRow& row : rows) out.push_back(row.told(kappa));
    return out;
}

MatrixXd sum_of(std::span<const Told> rows) {
    MatrixXd sum = MatrixXd::Zero(rows.front().m.rows(), rows.front().m.cols());
    for (const Told& row : rows) sum += row.m;
    return sum;
}

// Start: principal components of the rows, whitened by their mean information, one factor for all spots.
ShapeModel start(std::span<const Told> rows, Index modes, Index spots) {
    const double n = static_cast<double>(rows.size());
    const MatrixXd sum = sum_of(rows);
    VectorXd heard = VectorXd::Zero(sum.rows());
    for (const Told& row : rows) heard += row.heard;
    ShapeModel model;
    model.mean = sum.ldlt().solve(heard);
    const Eigen::LLT<MatrixXd> root((sum / n).eval());
    const Index r = sum.rows();
    MatrixXd scatter = MatrixXd::Zero(r, r);
    for (const Told& row : rows) {
        const VectorXd t = root.matrixL().solve(row.heard - row.m * model.mean);
        scatter += t * t.transpose() / n;
    }
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scatter);
    const double kappa = std::max(
        kLeastKappa, r > modes ? eigen.eigenvalues().head(r - modes).mean() : eigen.eigenvalues()[0]);
    model.kappa = VectorXd::Constant(spots, kappa);
    model.loading.resize(r, modes);
    for (Index k = 0; k < modes; ++k) {
        const double variance = std::max(eigen.eigenvalues()[r - 1 - k] - kappa, kLeastMode * kappa);
        model.loading.col(k) =
            std::sqrt(variance) * root.matrixU().solve(eigen.eigenvectors().col(r - 1 - k));
    }
    return model;
}

// The degrees of the rows: coordinates of each spot, and what is left of them all without the motions.
struct Degrees {
    VectorXd of_spot;
    double all = 0, told = 0;
};
Degrees degrees_of(std::span<const ShapeRow> rows, Index spots) {
    Degrees out{VectorXd::Zero(spots), 0, 0};
    for (const ShapeRow& row : rows) {
        for (Index n = 0; n < spots; ++n) out.of_spot[n] += row.observed(static_cast<std::size_t>(n));
        out.told += row.rank();
    }
    out.all = out.of_spot.sum();
    return out;
}

// New factors from what is expected of the noise. `fitted`: degrees that mean and loading take, borne by all alike.
void put_factors(const VectorXd& squares, const Degrees& degrees, double fitted, ShapeModel& model) {
    const double taken = std::min(fitted, kMostFitted * degrees.told);
    const VectorXd noise = squares + model.kappa.cwiseProduct(degrees.of_spot) * (taken / degrees.all);
    const double common = noise.sum() / degrees.all;
    model.noise_factor = std::sqrt(std::max(kLeastKappa, common));
    for (Index n = 0; n < noise.size(); ++n)
        model.kappa[n] = std::max(kLeastKappa, (noise[n] + kDrawn * common) / (degrees.of_spot[n] + kDrawn));
}

}  // namespace

MatrixXd stated_information(std::span<const ElasticRow> rows) {
    const Index size = rows.front().residual_mm.size();
    const MatrixXd all = MatrixXd::Identity(size, size);
    MatrixXd sum = MatrixXd::Zero(size, size);
    for (const ElasticRow& row : rows) sum += ShapeRow(row, all, 0).told(stated(row.seen.size())).m;
    return sum;
}

ShapeModel fit_model(std::span<const ShapeRow> rows, Index modes) {
    const Index spots = rows.front().spots();
    std::vector<Told> told = told_of(rows, VectorXd::Ones(spots));
    ShapeModel model = start(told, modes, spots);
    const Index r = model.mean.size();
    const double n = static_cast<double>(rows.size());
    const Degrees degrees = degrees_of(rows, spots);
    const auto fitted = static_cast<double>(r * (1 + modes));
    constexpr int kMost = 200;
    double last = -1;
    for (int iteration = 0; iteration < kMost; ++iteration) {
        told = told_of(rows, model.kappa);
        MatrixXd moments = MatrixXd::Zero(r * modes, r * modes), heard = MatrixXd::Zero(r, modes);
        VectorXd free = VectorXd::Zero(r);
        MatrixXd spread = MatrixXd::Zero(modes, modes);
        std::vector<Latent> z;
        for (const Told& row : told) {
            z.push_back(latent(row, model));
            const Latent& l = z.back();
            const MatrixXd second = l.covariance + l.mean * l.mean.transpose();
            spread += second / n;
            for (Index a = 0; a < modes; ++a)
                for (Index b = 0; b < modes; ++b) moments.block(r * a, r * b, r, r) += second(a, b) * row.m;
            heard += (row.heard - row.m * model.mean) * l.mean.transpose();
        }
        if (modes > 0) {
            const VectorXd solved =
                moments.ldlt().solve(Eigen::Map<const VectorXd>(heard.data(), heard.size()));
            model.loading = Eigen::Map<const MatrixXd>(solved.data(), r, modes);
        }
        VectorXd squares = VectorXd::Zero(spots);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const VectorXd u = model.loading * z[i].mean;
            free += told[i].heard - told[i].m * u;
            rows[i].add_squares(told[i], model.mean + u, model.loading, z[i].covariance, squares);
        }
        model.mean = sum_of(told).ldlt().solve(free);
        const VectorXd before = model.kappa;
        put_factors(squares, degrees, fitted, model);
        // Expanded parameters (Liu, Rubin and Wu 1998): z keeps unit variance, in a few steps instead of many.
        if (modes > 0) model.loading = (model.loading * spread.llt().matrixL().toDenseMatrix()).eval();
        const double size = model.loading.squaredNorm() + model.kappa.sum();
        const double change = (model.kappa.array() / before.array() - 1).abs().maxCoeff();
        if (std::abs(size - last) < kSizeSettled * size && change < kFactorSettled) break;
        last = size;
    }
    return model;
}

Latent latent(const Told& row, const ShapeModel& model) {
    const Index j = model.loading.cols();
    const MatrixXd heavy = row.m * model.loading;
    const MatrixXd a = model.loading.transpose() * heavy + MatrixXd::Identity(j, j);
    Latent out{VectorXd(j), MatrixXd(j, j)};
    if (j == 0) return out;
    out.covariance = a.ldlt().solve(MatrixXd::Identity(j, j));
    out.mean = out.covariance * (model.loading.transpose() * row.heard - heavy.transpose() * model.mean);
    return out;
}

double likelihood(const ShapeRow& of, const ShapeModel& model) {
    const Told row = of.told(model.kappa);
    const Index j = model.loading.cols();
    const VectorXd off = row.heard - row.m * model.mean;
    const double squares =
        std::max(0.0, row.power - 2 * model.mean.dot(row.heard) + model.mean.dot(row.m * model.mean));
    double twice = squares + row.log_determinant;
    if (j > 0) {
        const VectorXd w = model.loading.transpose() * off;
        const Eigen::LLT<MatrixXd> root(
            (MatrixXd::Identity(j, j) + model.loading.transpose() * row.m * model.loading).eval());
        for (Index k = 0; k < j; ++k) twice += 2 * std::log(root.matrixLLT()(k, k));
        twice -= w.dot(root.solve(w));
    }
    return -0.5 * twice;
}

}  // namespace seamwright::elastic
