#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/elastic/shape_model.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using elastic::fit_model;
using elastic::Latent;
using elastic::ShapeModel;
using elastic::ShapeRow;
using elastic::Told;

constexpr double kInformationAsymmetry = 1e-9, kInformationNegative = 1e-7;  // of its largest entry
// Of what the rows tell best: less, as of a third direction that parts turned by a tenth of a degree show, is untold.
constexpr double kToldShare = 1e-4;
constexpr double kUnexplained = 2;  // scatter over stated sigma: parts that are rigid do not show it

std::vector<ShapeRow> without_fold(std::span<const ShapeRow> rows, int fold, int folds) {
    std::vector<ShapeRow> out;
    std::ranges::copy_if(rows, std::back_inserter(out),
                         [&](const ShapeRow& row) { return row.part() % folds != fold; });
    return out;
}

// Of every part, when it is held out.
std::vector<double> held_out(std::span<const ShapeRow> rows, int parts, Index modes, int folds) {
    std::vector<double> out(static_cast<std::size_t>(parts), 0);
    for (int fold = 0; fold < folds; ++fold) {
        const ShapeModel model = fit_model(without_fold(rows, fold, folds), modes);
        for (const ShapeRow& row : rows)
            if (row.part() % folds == fold)
                out[static_cast<std::size_t>(row.part())] += likelihood(row, model);
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
        if (row.residual_mm.size() != size || row.seen.size() != spots.size() || row.motions.rows() != size ||
            row.shared < 0 || row.shared > row.motions.cols())
            return input_error("the row has another number of spots than are learnt", row.id);
        const bool seen_ok = std::ranges::all_of(row.seen, [](const auto& m) { return m.allFinite(); });
        if (!row.residual_mm.allFinite() || !row.motions.allFinite() || !seen_ok)
            return input_error("the row holds a number that is not finite", row.id);
        const bool information = std::ranges::all_of(row.seen, [](const Eigen::Matrix3d& l) {
            const double scale = l.cwiseAbs().maxCoeff();
            return (l - l.transpose()).cwiseAbs().maxCoeff() <= kInformationAsymmetry * scale &&
                   Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(l, Eigen::EigenvaluesOnly)
                           .eigenvalues()[0] >= -kInformationNegative * scale;
        });
        if (!information) return input_error("the information of the row is none", row.id);
        const ShapeRow told(row, MatrixXd(size, 0), 0);
        if (told.rank() < 1 || !told.regular())
            return input_error("the measured spots are too few to tell a shape from a motion", row.id,
                               "leave the run out");
    }
    return {};
}

// Modes from the loading: singular vectors, scaled and signed.
void put_modes(const ShapeModel& model, const MatrixXd& basis, std::span<const ShapeRow> rows, int parts,
               ElasticModes& out) {
    out.noise_factor = model.noise_factor;
    for (std::size_t n = 0; n < out.spots.size(); ++n)
        out.spots[n].noise_factor = std::sqrt(model.kappa[static_cast<Index>(n)]) / model.noise_factor;
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
    std::vector<Told> told;
    MatrixXd mean_information = MatrixXd::Zero(basis.cols(), basis.cols());
    for (const ShapeRow& row : rows) {
        told.push_back(row.told(model.kappa));
        mean_information += told.back().m / static_cast<double>(rows.size());
    }
    const MatrixXd inner = basis.transpose() * shapes;
    const MatrixXd heavy = mean_information * inner;
    const VectorXd mean = (inner.transpose() * heavy).ldlt().solve(heavy.transpose() * model.mean);
    const VectorXd common = basis * model.mean - shapes * mean;
    for (std::size_t n = 0; n < out.spots.size(); ++n)
        out.spots[n].common_mm = common.segment<3>(3 * static_cast<Index>(n));
    MatrixXd amplitudes(j, static_cast<Index>(rows.size()));
    double noise = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Latent z = latent(told[i], model);
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
int number_of_modes(std::span<const ShapeRow> rows, int most, const LearnOptions& options,
                    ElasticModes& out) {
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
WrongSpot wrong_spot(std::span<const ShapeRow> rows, const MatrixXd& basis, int parts, Index modes,
                     int folds) {
    constexpr double kWrong = 40;  // of chi squared of two, the largest of thousands
    WrongSpot worst;
    for (int fold = 0; fold < folds; ++fold) {
        const ShapeModel model = fit_model(without_fold(rows, fold, folds), modes);
        // What is learnt from few parts predicts worse than its noise says.
        const double learnt = static_cast<double>(parts) * (folds - 1) / folds, numbers = 1.0 + modes;
        const double limit = kWrong * (1 + numbers / std::max(1.0, learnt - numbers));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].part() % folds != fold) continue;
            const Told row = rows[i].told(model.kappa);
            const VectorXd off = row.heard - row.m * model.mean;
            const MatrixXd heavy = row.m * model.loading;
            const MatrixXd inner = MatrixXd::Identity(modes, modes) + model.loading.transpose() * heavy;
            const MatrixXd gain = inner.ldlt().solve(heavy.transpose());
            const MatrixXd information = row.m - heavy * gain;
            const VectorXd score = off - heavy * inner.ldlt().solve(model.loading.transpose() * off);
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

// How many spots were left out. A body on one spot of one part would be taken for a mode, or for noise that hides them.
int leave_out_wrong_spots(std::vector<ShapeRow>& rows, const MatrixXd& basis, int parts, Index modes,
                          int folds) {
    const std::size_t most = std::max<std::size_t>(1, rows.size() / 5);
    std::size_t left_out = 0;
    while (left_out < most) {
        const WrongSpot wrong = wrong_spot(rows, basis, parts, modes, folds);
        if (!(wrong.squares > 1)) break;
        ShapeRow without = rows[wrong.row];
        without.leave_out(wrong.spot);
        if (without.rank() < 1 || !without.regular()) break;
        rows[wrong.row] = std::move(without);
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

    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(elastic::stated_information(rows));
    const double largest = eigen.eigenvalues().maxCoeff();
    const Index told = (eigen.eigenvalues().array() > kToldShare * largest).count();
    const MatrixXd basis = eigen.eigenvectors().rightCols(told);
    std::vector<ShapeRow> inner;
    for (const ElasticRow& row : rows)
        inner.emplace_back(row, basis,
                           static_cast<int>(std::ranges::find(parts, row.part_id) - parts.begin()));
    const int most = static_cast<int>(std::min<Index>({options.most_modes, told - 1, (out.parts - 2) / 2}));
    if (out.parts < options.fewest_parts || most < 1) {
        out.message =
            Text("{} parts are too few to learn from: at least {}", out.parts, options.fewest_parts);
        return out;
    }
    const int left_out =
        leave_out_wrong_spots(inner, basis, out.parts, most, std::min(options.folds, out.parts));
    const int modes = number_of_modes(inner, most, options, out);
    put_modes(fit_model(inner, modes), basis, inner, out.parts, out);
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
