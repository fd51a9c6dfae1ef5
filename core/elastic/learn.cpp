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
constexpr double kUnexplained = 2;   // scatter over stated sigma: parts that are rigid do not show it

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

// Gain per part of the hold-out likelihood, and its standard error.
struct Gain {
    double mean = 0, sigma = 0;
};
Gain gain_of(const std::vector<double>& before, const std::vector<double>& after) {
    const auto parts = static_cast<double>(after.size());
    double mean = 0, square = 0;
    for (std::size_t p = 0; p < after.size(); ++p) mean += (after[p] - before[p]) / parts;
    for (std::size_t p = 0; p < after.size(); ++p)
        square += (after[p] - before[p] - mean) * (after[p] - before[p] - mean) / (parts - 1);
    return {mean, std::sqrt(square / parts)};
}

// The number by hold-out; its gains are kept in `out`. The smallest that no larger one gains on: of two strong modes the
// first alone may gain nothing, kappa holds the second one then.
int number_of_modes(std::span<const Told> rows, int most, const LearnOptions& options, ElasticModes& out) {
    const int folds = std::min(options.folds, out.parts);
    std::vector<std::vector<double>> likely;
    for (int modes = 0; modes <= most; ++modes) likely.push_back(held_out(rows, out.parts, modes, folds));
    const auto told = [&](std::size_t from, std::size_t to) {
        const Gain gain = gain_of(likely[from], likely[to]);
        return gain.mean > options.gain_sigmas * gain.sigma && gain.mean * out.parts > options.least_gain;
    };
    std::size_t modes = 0;
    for (std::size_t from = 0; from < likely.size(); ++from)
        for (std::size_t to = from + 1; to < likely.size() && modes == from; ++to)
            if (told(from, to)) modes = from + 1;
    for (std::size_t k = 0; k < likely.size() - 1 && k <= modes; ++k) {
        const Gain gain = gain_of(likely[k], likely[k + 1]);
        out.gain.push_back(gain.mean);
        out.gain_sigma.push_back(gain.sigma);
    }
    return static_cast<int>(modes);
}

// A foreign body at one spot of one part.
struct WrongSpot {
    std::size_t row = 0, spot = 0;
    double squares = 0;  // chi squared of two by the model of the other parts, over its limit
};
// The one that the model of the other parts, with all modes, contradicts most; over its limit when it is wrong.
WrongSpot wrong_spot(std::span<const Told> rows, const MatrixXd& basis, int parts, Index modes, int folds) {
    constexpr double kWrong = 40;  // of chi squared of two, the largest of thousands
    WrongSpot worst;
    for (int fold = 0; fold < folds; ++fold) {
        std::vector<Told> kept;
        for (const Told& row : rows)
            if (row.part % folds != fold) kept.push_back(row);
        const Model model = fit_model(kept, modes);
        // What is learnt from few parts predicts worse than its noise says.
        const double learnt = static_cast<double>(parts) * (folds - 1) / folds, numbers = 1.0 + modes;
        const double limit = kWrong * (1 + numbers / std::max(1.0, learnt - numbers));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].part % folds != fold) continue;
            const VectorXd off = rows[i].heard - rows[i].m * model.mean;
            const MatrixXd heavy = rows[i].m * model.loading / model.kappa;
            const MatrixXd inner = MatrixXd::Identity(modes, modes) + model.loading.transpose() * heavy;
            const MatrixXd gain = inner.ldlt().solve(heavy.transpose());
            const MatrixXd information = rows[i].m / model.kappa - heavy * gain;
            const VectorXd score =
                off / model.kappa - heavy * inner.ldlt().solve(model.loading.transpose() * off) / model.kappa;
            for (Index n = 0; n < basis.rows() / 3; ++n) {
                const MatrixXd here = basis.middleRows<3>(3 * n);
                const Eigen::Vector3d heard = here * score;
                const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(here * information *
                                                                           here.transpose());
                double squares = 0;
                for (int k = 0; k < 3; ++k) {
                    if (!(eigen.eigenvalues()[k] > kToldShare * eigen.eigenvalues()[2])) continue;
                    const double along = eigen.eigenvectors().col(k).dot(heard);
                    squares += along * along / eigen.eigenvalues()[k];
                }
                if (squares / limit > worst.squares)
                    worst = {i, static_cast<std::size_t>(n), squares / limit};
            }
        }
    }
    return worst;
}

// The row as if the spot had not been measured.
void leave_out(Told& row, const MatrixXd& basis, std::size_t spot) {
    const MatrixXd here = basis.middleRows<3>(3 * static_cast<Index>(spot));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(here * row.m * here.transpose());
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    int lost = 0;
    for (int k = 0; k < 3; ++k) {
        if (!(eigen.eigenvalues()[k] > kToldShare * eigen.eigenvalues()[2])) continue;
        inverse +=
            eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).transpose() / eigen.eigenvalues()[k];
        ++lost;
    }
    const Eigen::Vector3d heard = here * row.heard;
    const MatrixXd across = row.m * here.transpose() * inverse;
    row.power = std::max(0.0, row.power - heard.dot(inverse * heard));
    row.heard -= across * heard;
    row.m -= across * here * row.m;
    row.m = (0.5 * (row.m + row.m.transpose())).eval();
    row.rank -= lost;
}

// How many spots were left out. A body on one spot of one part would be taken for a mode, or for noise that hides them.
int leave_out_wrong_spots(std::vector<Told>& rows, const MatrixXd& basis, int parts, Index modes, int folds) {
    const std::size_t most = std::max<std::size_t>(1, rows.size() / 5);
    std::size_t left_out = 0;
    while (left_out < most) {
        const WrongSpot wrong = wrong_spot(rows, basis, parts, modes, folds);
        if (!(wrong.squares > 1) || rows[wrong.row].rank < 4) break;
        leave_out(rows[wrong.row], basis, wrong.spot);
        ++left_out;
    }
    return static_cast<int>(left_out);
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
    const int left_out =
        leave_out_wrong_spots(inner, basis, out.parts, most, std::min(options.folds, out.parts));
    const int modes = number_of_modes(inner, most, options, out);
    model = fit_model(inner, modes);
    out.noise_factor = std::sqrt(model.kappa);
    put_modes(model, basis, inner, out.parts, out);
    if (modes > 0)
        out.message = Text("{} modes from {} parts", modes, out.parts);
    else if (out.noise_factor > kUnexplained)
        out.message = Text(
            "no mode: {} parts scatter by {:.1f} times what their spots' sigmas say, and no shape "
            "explains it",
            out.parts, out.noise_factor);
    else
        out.message = Text("the parts are rigid as far as {} parts tell: no mode", out.parts);
    if (left_out > 0)
        out.message = joined(out.message, "; ",
                             Text("{} measures that the other parts contradict were left out", left_out));
    return out;
}

}  // namespace seamwright
