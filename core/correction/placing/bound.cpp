// The bound on every set of k (placing.h).

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/correction/placing/placing_impl.h"

namespace seamwright {
namespace {

constexpr int kSteps = 300;
constexpr double kEagerness = 12;  // of the weights to follow the worst directions

struct Weighed {
    double value = 0, worst = 0;             // sum w v, max v
    std::vector<Eigen::VectorXd> variances;  // a displacement each
    std::vector<double> gradient;            // by the candidates' weights
};

// phi_w and its gradient at `share`.
Weighed weigh(const SpotPlacing::Impl& p, int k, const std::vector<double>& share,
              const std::vector<Eigen::VectorXd>& w) {
    Weighed out;
    out.gradient.assign(share.size(), 0);
    for (std::size_t d = 0; d < p.at.size(); ++d) {
        const SpotPlacing::Impl::At& where = p.at[d];
        Eigen::MatrixXd m = where.prior;
        for (std::size_t c = 0; c < share.size(); ++c)
            if (share[c] > 0) m += k * share[c] * where.information[c];
        // Of all of M^-1 the columns of D's degrees.
        const Eigen::MatrixXd columns = m.llt().solve(Eigen::MatrixXd::Identity(p.size, p.dof));
        const Eigen::MatrixXd spread = where.bead * columns.transpose();  // a_i^T M^-1, a row each
        out.variances.push_back((spread.leftCols(p.dof)).cwiseProduct(where.bead).rowwise().sum());
        out.value += w[d].dot(out.variances.back());
        out.worst = std::max(out.worst, out.variances.back().maxCoeff());
        const Eigen::MatrixXd pull = spread.transpose() * w[d].asDiagonal() * spread;
        for (std::size_t c = 0; c < share.size(); ++c)
            out.gradient[c] -= k * where.information[c].cwiseProduct(pull).sum();
    }
    return out;
}

// The set of k places that the gradient likes best; returns the mean of its gradient.
double best_corner(const SpotPlacing::Impl& p, int k, const std::vector<double>& gradient,
                   std::vector<std::size_t>& corner) {
    std::map<int, std::size_t> best;
    for (std::size_t c = 0; c < gradient.size(); ++c) {
        const auto [it, first] = best.emplace(p.task.candidates[c].place, c);
        if (!first && gradient[c] < gradient[it->second]) it->second = c;
    }
    corner.clear();
    for (const auto& [place, c] : best) corner.push_back(c);
    std::sort(corner.begin(), corner.end(),
              [&](std::size_t a, std::size_t b) { return gradient[a] < gradient[b]; });
    corner.resize(std::min(corner.size(), static_cast<std::size_t>(k)));
    double sum = 0;
    for (const std::size_t c : corner) sum += gradient[c];
    return sum / k;
}

}  // namespace

double SpotPlacing::bound_mm(int k) const {
    const Impl& p = *impl_;
    const std::size_t n = p.task.candidates.size();
    std::vector<double> share(n, 1.0 / static_cast<double>(n));
    std::vector<Eigen::VectorXd> w, followed;
    const auto rows = static_cast<double>(p.at.size()) * static_cast<double>(p.at.front().bead.rows());
    for (const Impl::At& where : p.at) {
        w.emplace_back(Eigen::VectorXd::Constant(where.bead.rows(), 1 / rows));
        followed.emplace_back(Eigen::VectorXd::Zero(where.bead.rows()));
    }
    double bound = 0;
    std::vector<std::size_t> corner;
    for (int step = 0; step < kSteps; ++step) {
        const Weighed now = weigh(p, k, share, w);
        double here = 0;
        for (std::size_t c = 0; c < n; ++c) here += share[c] * now.gradient[c];
        bound = std::max(bound, now.value + best_corner(p, k, now.gradient, corner) - here);
        const double step_size = 2.0 / (step + 3);
        for (double& s : share) s *= 1 - step_size;
        for (const std::size_t c : corner) share[c] += step_size / k;
        // Weights follow the directions that have been worst so far, the later ones counting more.
        double sum = 0;
        for (std::size_t d = 0; d < w.size(); ++d)
            followed[d] += (step_size / 2) * (now.variances[d] / now.worst - followed[d]);
        double highest = 0;
        for (const Eigen::VectorXd& f : followed) highest = std::max(highest, f.maxCoeff());
        const double eager = kEagerness * std::sqrt(step + 1.0);
        for (std::size_t d = 0; d < w.size(); ++d) {
            w[d] = (eager * (followed[d].array() - highest)).exp();
            sum += w[d].sum();
        }
        for (Eigen::VectorXd& each : w) each /= sum;
    }
    return 3 * std::sqrt(bound);
}

}  // namespace seamwright
