#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/elastic/modes.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastKappa = 1e-6;
constexpr double kLeastMode = 0.05;  // of kappa: variance that a mode starts with
// Of the loading and kappa: a step that changes them by less is the last.
constexpr double kSizeSettled = 1e-7;
constexpr double kInformationAsymmetry = 1e-9, kInformationNegative = 1e-7;  // of its largest entry
constexpr double kToldShare = 1e-6;  // of the direction that the rows tell best

// A row along the directions that the rows tell.
struct Told {
    VectorXd heard;  // M y
    MatrixXd m;
    double power = 0;  // y^T M y
    int rank = 0, part = 0;
};

struct Model {
    VectorXd mean;
    MatrixXd loading;  // C, a column a mode
    double kappa = 1;
};

// Distribution of z of a row: mean and covariance.
struct Latent {
    VectorXd mean;
    MatrixXd covariance;
};
Latent latent(const Told& row, const Model& model) {
    const Index j = model.loading.cols();
    const MatrixXd heavy = row.m * model.loading / model.kappa;
    MatrixXd a = model.loading.transpose() * heavy + MatrixXd::Identity(j, j);
    Latent out{VectorXd(j), MatrixXd(j, j)};
    if (j == 0) return out;
    out.covariance = a.ldlt().solve(MatrixXd::Identity(j, j));
    out.mean = out.covariance *
               (model.loading.transpose() * row.heard / model.kappa - heavy.transpose() * model.mean);
    return out;
}

// r^T M r of a deviation u from the row.
double squares(const Told& row, const VectorXd& u) {
    return std::max(0.0, row.power - 2 * u.dot(row.heard) + u.dot(row.m * u));
}

MatrixXd sum_of(std::span<const Told> rows) {
    MatrixXd sum = MatrixXd::Zero(rows.front().m.rows(), rows.front().m.cols());
    for (const Told& row : rows) sum += row.m;
    return sum;
}

// Start: principal components of the rows, whitened by their mean information.
Model start(std::span<const Told> rows, Index modes) {
    const double n = static_cast<double>(rows.size());
    const MatrixXd sum = sum_of(rows);
    VectorXd heard = VectorXd::Zero(sum.rows());
    for (const Told& row : rows) heard += row.heard;
    Model model;
    model.mean = sum.ldlt().solve(heard);
    const Eigen::LLT<MatrixXd> root((sum / n).eval());
    const Index r = sum.rows();
    MatrixXd scatter = MatrixXd::Zero(r, r);
    for (const Told& row : rows) {
        const VectorXd t = root.matrixL().solve(row.heard - row.m * model.mean);
        scatter += t * t.transpose() / n;
    }
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scatter);
    model.kappa = std::max(kLeastKappa,
                           r > modes ? eigen.eigenvalues().head(r - modes).mean() : eigen.eigenvalues()[0]);
    model.loading.resize(r, modes);
    for (Index k = 0; k < modes; ++k) {
        const double variance =
            std::max(eigen.eigenvalues()[r - 1 - k] - model.kappa, kLeastMode * model.kappa);
        model.loading.col(k) =
            std::sqrt(variance) * root.matrixU().solve(eigen.eigenvectors().col(r - 1 - k));
    }
    return model;
}

Model fit_model(std::span<const Told> rows, Index modes) {
    Model model = start(rows, modes);
    const Index r = model.mean.size();
    const double n = static_cast<double>(rows.size());
    int ranks = 0;
    for (const Told& row : rows) ranks += row.rank;
    const MatrixXd sum = sum_of(rows);
    constexpr int kMost = 200;
    double last = -1;
    for (int iteration = 0; iteration < kMost; ++iteration) {
        MatrixXd moments = MatrixXd::Zero(r * modes, r * modes), heard = MatrixXd::Zero(r, modes);
        VectorXd free = VectorXd::Zero(r);
        MatrixXd spread = MatrixXd::Zero(modes, modes);
        std::vector<Latent> z;
        for (const Told& row : rows) {
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
        double left = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const VectorXd u = model.loading * z[i].mean;
            free += rows[i].heard - rows[i].m * u;
            left += squares(rows[i], model.mean + u) +
                    (model.loading.transpose() * rows[i].m * model.loading * z[i].covariance).trace();
        }
        model.mean = sum.ldlt().solve(free);
        model.kappa =
            std::max(kLeastKappa, left / std::max(1.0, static_cast<double>(ranks - r * (1 + modes))));
        // Expanded parameters (Liu, Rubin and Wu 1998): z keeps unit variance, in a few steps instead of many.
        if (modes > 0) model.loading = (model.loading * spread.llt().matrixL().toDenseMatrix()).eval();
        const double size = model.loading.squaredNorm() + model.kappa;
        if (std::abs(size - last) < kSizeSettled * size) break;
        last = size;
    }
    return model;
}

// Log-likelihood of a row up to what does not depend on the model.
double likelihood(const Told& row, const Model& model) {
    const Index j = model.loading.cols();
    if (j == 0) return -0.5 * (squares(row, model.mean) / model.kappa + row.rank * std::log(model.kappa));
    const VectorXd w = (model.loading.transpose() * (row.heard - row.m * model.mean)) / model.kappa;
    const MatrixXd a =
        MatrixXd::Identity(j, j) + model.loading.transpose() * row.m * model.loading / model.kappa;
    const Eigen::LLT<MatrixXd> root(a);
    double log_determinant = 0;
    for (Index k = 0; k < j; ++k) log_determinant += 2 * std::log(root.matrixLLT()(k, k));
    return -0.5 * (squares(row, model.mean) / model.kappa - w.dot(root.solve(w)) + log_determinant +
                   row.rank * std::log(model.kappa));
}

// Of every part, when it is held out.
std::vector<double> held_out(std::span<const Told> rows, int parts, Index modes, int folds) {
    std::vector<double> out(static_cast<std::size_t>(parts), 0);
    for (int fold = 0; fold < folds; ++fold) {
        std::vector<Told> kept;
        for (const Told& row : rows)
            if (row.part % folds != fold) kept.push_back(row);
        const Model model = fit_model(kept, modes);
        for (const Told& row : rows)
            if (row.part % folds == fold) out[static_cast<std::size_t>(row.part)] += likelihood(row, model);
    }
    return out;
}

Expected<void> check_rows_of_shapes(std::span<const ElasticSpot> spots, std::span<const ElasticRow> rows) {
    const auto size = static_cast<Index>(3 * spots.size());
    if (rows.empty()) return input_error("there is no run to learn from", "modes", "measure parts first");
    std::set<std::string> ids;
    for (const ElasticRow& row : rows) {
        if (!ids.insert(row.id).second)
            return input_error(Text("{} is given twice", row.id), "modes", "give every run once");
        if (row.residual_mm.size() != size || row.information.rows() != size ||
            row.information.cols() != size || row.seen.size() != spots.size())
            return input_error("the row has another number of spots than are learnt", row.id);
        const bool seen_ok = std::ranges::all_of(row.seen, [](const auto& m) { return m.allFinite(); });
        if (!row.residual_mm.allFinite() || !row.information.allFinite() || !seen_ok)
            return input_error("the row holds a number that is not finite", row.id);
        const double scale = row.information.cwiseAbs().maxCoeff();
        const bool symmetric = (row.information - row.information.transpose()).cwiseAbs().maxCoeff() <=
                               kInformationAsymmetry * scale;
        if (row.rank < 1 || !symmetric ||
            Eigen::SelfAdjointEigenSolver<MatrixXd>(row.information, Eigen::EigenvaluesOnly)
                    .eigenvalues()
                    .minCoeff() < -kInformationNegative * scale)
            return input_error("the information of the row is none", row.id);
    }
    return {};
}

// Modes from the loading: singular vectors, scaled and signed.
void put_modes(const Model& model, const MatrixXd& basis, std::span<const Told> rows, int parts,
               ElasticModes& out) {
    const Index j = model.loading.cols();
    if (j == 0) {
        for (std::size_t n = 0; n < out.spots.size(); ++n)
            out.spots[n].common_mm = basis.middleRows<3>(3 * static_cast<Index>(n)) * model.mean;
        return;
    }
    const Eigen::JacobiSVD<MatrixXd> svd(basis * model.loading, Eigen::ComputeThinU | Eigen::ComputeThinV);
    MatrixXd shapes = svd.matrixU();
    VectorXd amplitude_of_z(j);
    for (Index k = 0; k < j; ++k) {
        double longest = 0;
        for (std::size_t n = 0; n < out.spots.size(); ++n)
            longest = std::max(longest, shapes.col(k).segment<3>(3 * static_cast<Index>(n)).norm());
        Index at = 0;
        shapes.col(k).cwiseAbs().maxCoeff(&at);
        const double sign = shapes(at, k) < 0 ? -1 : 1;
        amplitude_of_z[k] = svd.singularValues()[k] * longest * sign;
        shapes.col(k) *= sign / longest;
    }
    const MatrixXd mean_information = sum_of(rows) / static_cast<double>(rows.size());
    const MatrixXd inner = basis.transpose() * shapes;
    const MatrixXd heavy = mean_information * inner;
    const VectorXd mean = (inner.transpose() * heavy).ldlt().solve(heavy.transpose() * model.mean);
    const VectorXd common = basis * model.mean - shapes * mean;
    for (std::size_t n = 0; n < out.spots.size(); ++n)
        out.spots[n].common_mm = common.segment<3>(3 * static_cast<Index>(n));
    MatrixXd amplitudes(j, static_cast<Index>(rows.size()));
    double noise = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Latent z = latent(rows[i], model);
        amplitudes.col(static_cast<Index>(i)) =
            mean + amplitude_of_z.cwiseProduct(svd.matrixV().transpose() * z.mean);
        noise += z.covariance.trace() / (static_cast<double>(j) * static_cast<double>(rows.size()));
    }
    const double degrees = std::max(1, parts - 1);
    for (Index k = 0; k < j; ++k) {
        ElasticMode& mode = out.modes.emplace_back();
        for (std::size_t n = 0; n < out.spots.size(); ++n)
            mode.shape.push_back(shapes.col(k).segment<3>(3 * static_cast<Index>(n)));
        mode.mean_mm = mean[k];
        // The mean is known from as many parts.
        mode.variance_mm2 = amplitude_of_z[k] * amplitude_of_z[k] * (1 + 1.0 / parts);
        const double measured = mode.variance_mm2 * (1 + noise);
        mode.variance_low_mm2 = std::max(
            0.0, measured * degrees / chi_square_quantile(degrees, kBelowHigh95) - noise * mode.variance_mm2);
        mode.variance_high_mm2 = std::max(
            0.0, measured * degrees / chi_square_quantile(degrees, kBelowLow95) - noise * mode.variance_mm2);
        mode.lowest_mm = amplitudes.row(k).minCoeff();
        mode.highest_mm = amplitudes.row(k).maxCoeff();
    }
}

// The number by hold-out; its gains are kept in `out`.
int number_of_modes(std::span<const Told> rows, int most, const LearnOptions& options, ElasticModes& out) {
    const int folds = std::min(options.folds, out.parts);
    std::vector<double> before = held_out(rows, out.parts, 0, folds);
    int modes = 0;
    for (; modes < most; ++modes) {
        const std::vector<double> after = held_out(rows, out.parts, modes + 1, folds);
        double mean = 0, square = 0;
        for (std::size_t p = 0; p < after.size(); ++p) mean += (after[p] - before[p]) / out.parts;
        for (std::size_t p = 0; p < after.size(); ++p)
            square += (after[p] - before[p] - mean) * (after[p] - before[p] - mean) / (out.parts - 1);
        out.gain.push_back(mean);
        out.gain_sigma.push_back(std::sqrt(square / out.parts));
        const bool told =
            mean > options.gain_sigmas * out.gain_sigma.back() && mean * out.parts > options.least_gain;
        if (!told) break;
        before = after;
    }
    return modes;
}

}  // namespace

Expected<ElasticModes> learn_modes(std::span<const ElasticSpot> spots, std::span<const ElasticRow> rows,
                                   const LearnOptions& options) {
    SEAM_OK(check_rows_of_shapes(spots, rows));
    ElasticModes out;
    out.spots.assign(spots.begin(), spots.end());
    out.rows = static_cast<int>(rows.size());
    for (std::size_t n = 0; n < spots.size(); ++n) {
        out.spots[n].seen.setZero();
        for (const ElasticRow& row : rows)
            out.spots[n].seen += row.seen[n] / static_cast<double>(rows.size());
    }
    std::vector<std::string> parts;
    for (const ElasticRow& row : rows)
        if (std::ranges::find(parts, row.part_id) == parts.end()) parts.push_back(row.part_id);
    out.parts = static_cast<int>(parts.size());

    MatrixXd sum = MatrixXd::Zero(rows.front().information.rows(), rows.front().information.cols());
    for (const ElasticRow& row : rows) sum += row.information;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(sum);
    const double largest = eigen.eigenvalues().maxCoeff();
    const Index told = (eigen.eigenvalues().array() > kToldShare * largest).count();
    const MatrixXd basis = eigen.eigenvectors().rightCols(told);
    std::vector<Told> inner;
    for (const ElasticRow& row : rows) {
        Told& t = inner.emplace_back();
        const VectorXd heard = row.information * row.residual_mm;
        t.heard = basis.transpose() * heard;
        t.m = basis.transpose() * row.information * basis;
        t.power = row.residual_mm.dot(heard);
        t.rank = row.rank;
        t.part = static_cast<int>(std::ranges::find(parts, row.part_id) - parts.begin());
    }
    Model model;
    const int most = static_cast<int>(std::min<Index>({options.most_modes, told - 1, (out.parts - 2) / 2}));
    if (out.parts < options.fewest_parts || most < 1) {
        out.message =
            Text("{} parts are too few to learn from: at least {}", out.parts, options.fewest_parts);
        model.mean = VectorXd::Zero(told);
        model.loading.resize(told, 0);
        put_modes(model, basis, inner, out.parts, out);
        return out;
    }
    const int modes = number_of_modes(inner, most, options, out);
    model = fit_model(inner, modes);
    out.noise_factor = std::sqrt(model.kappa);
    put_modes(model, basis, inner, out.parts, out);
    out.message = modes == 0 ? Text("the parts are rigid as far as {} parts tell: no mode", out.parts)
                             : Text("{} modes from {} parts", modes, out.parts);
    return out;
}

}  // namespace seamwright
