#include "core/calibration/on_part/variances.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

constexpr std::array kPass_mm = {0.002, 0.005, 0.01, 0.02, 0.035, 0.06, 0.1, 0.2, 0.4, 0.8};
constexpr std::array kCurvature = {kStraightEdge, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
constexpr double kUnseen = 1e-6;  // information of a coefficient that no profile sees: sigma 1 m
constexpr double kLoose = 1e-6;   // of the precision: q is a thousand times as large
constexpr double kRad_per_mm = 1.0 / kPassLever_mm;
constexpr double kClosed = 1e-6;        // information 1/mm^2 below which a direction takes no step: sigma 1 m
constexpr double kLeastOpen = 1e-12;    // of that information in a covariance: no direction is more open
constexpr double kLeastScale2 = 1e-12;  // of the white noise: no less, whatever is given

// Passes eliminated for one q.
struct Shared {
    Eigen::MatrixXd a;
    Eigen::VectorXd g;
    double rr = 0, log_det = 0;
};

double log_det(const Eigen::LLT<Matrix6>& llt) {
    return 2 * llt.matrixLLT().diagonal().array().log().sum();
}

Shared without_passes(const Blocks& blocks, const State& state, double mm, double rad,
                      std::optional<std::size_t> loose = std::nullopt) {
    Shared s{blocks.ss, blocks.sr, blocks.rr, 0};
    Vector6 bound;
    bound << Eigen::Vector3d::Constant(1 / (mm * mm)), Eigen::Vector3d::Constant(1 / (rad * rad));
    for (std::size_t p = 0; p < blocks.pp.size(); ++p) {
        if (blocks.rows[p] == 0) continue;
        const Vector6 precision = p == loose ? Vector6(kLoose * bound) : bound;
        const Vector6 pull = precision.cwiseProduct(state.passes[p]);
        const Eigen::LLT<Matrix6> llt(blocks.pp[p] + Matrix6(precision.asDiagonal()));
        const Vector6 g = blocks.pr[p] + pull;
        const Eigen::MatrixXd w = llt.solve(blocks.sp[p].transpose());
        s.a.noalias() -= blocks.sp[p] * w;
        s.g.noalias() -= w.transpose() * g;
        s.rr += pull.dot(state.passes[p]) - g.dot(llt.solve(g));
        s.log_det += log_det(llt) - precision.array().log().sum();
    }
    return s;
}

struct Marginal {
    Eigen::MatrixXd information, follow;  // the edges' step is -base - follow * step of the wanted
    Eigen::VectorXd gradient, base;
    double rr = 0, log_det = 0;
};

Marginal without_edges(const Shared& shared, const Blocks& blocks, const State& state,
                       const std::vector<Eigen::MatrixXd>& penalties, const std::vector<double>& curvature) {
    const Eigen::Index w = blocks.wanted, n = blocks.shared - w;
    Eigen::MatrixXd a = shared.a.bottomRightCorner(n, n);
    Eigen::VectorXd g = shared.g.tail(n);
    Marginal m;
    m.rr = shared.rr, m.log_det = shared.log_det;
    Eigen::Index at = 0;
    for (std::size_t e = 0; e < penalties.size(); ++e) {
        const Eigen::Index k = penalties[e].rows();
        const double precision = 1 / (curvature[e] * curvature[e]);
        for (Eigen::Index axis = 0; axis < 2; ++axis, at += k) {
            const auto c = state.edges[e].coefficients.segment(axis * k, k);
            const Eigen::VectorXd pull = precision * (penalties[e] * c);
            a.block(at, at, k, k) += precision * penalties[e];
            g.segment(at, k) += pull;
            m.rr += pull.dot(c);
            m.log_det -= static_cast<double>(k - 2) * std::log(precision);
        }
    }
    a.diagonal().array() += kUnseen;
    const Eigen::MatrixXd cross = shared.a.bottomLeftCorner(n, w);
    const Eigen::LLT<Eigen::MatrixXd> llt(a);
    if (llt.info() != Eigen::Success) {  // a part of an edge that no profile saw, and nothing to bind it
        m.rr = kInfinity;
        m.information = Eigen::MatrixXd::Zero(w, w);
        m.gradient = Eigen::VectorXd::Zero(w);
        m.follow = Eigen::MatrixXd::Zero(n, w);
        m.base = Eigen::VectorXd::Zero(n);
        return m;
    }
    const Eigen::MatrixXd solved = llt.solve(cross);
    m.information = shared.a.topLeftCorner(w, w) - cross.transpose() * solved;
    m.gradient = shared.g.head(w) - solved.transpose() * g;
    m.base = llt.solve(g);
    m.follow = solved;
    m.rr -= g.dot(m.base);
    m.log_det += 2 * llt.matrixLLT().diagonal().array().log().sum();
    return m;
}

struct Answer {
    double minus2 = kInfinity, scale2 = 1, rr = 0;
    Eigen::VectorXd step, edges;
    Eigen::MatrixXd covariance, information;
    Eigen::VectorXd gradient;
};

class Likelihood {
  public:
    Likelihood(const Blocks& blocks, const Data& data, const State& state, const Eigen::MatrixXd& view,
               bool scale_free, double least = 0)
        : blocks_(blocks),
          state_(state),
          view_(view),
          scale_free_(scale_free),
          least2_(std::max(kLeastScale2, least * least)) {
        for (const EdgeCurve& e : state.edges) {
            const Eigen::MatrixXd rows = curvature_rows(e);
            penalties_.push_back(rows.transpose() * rows);
        }
        prior_ = Eigen::MatrixXd::Zero(blocks.wanted, blocks.wanted);
        pull_ = Eigen::VectorXd::Zero(blocks.wanted);
        if (data.prior) {
            prior_.topLeftCorner<6, 6>() = inverse_matrix(data.prior->covariance);
            pull_.head<6>() =
                prior_.topLeftCorner<6, 6>() * difference(state.mounting, data.prior->flange_from_sensor);
            pull2_ = pull_.head<6>().dot(difference(state.mounting, data.prior->flange_from_sensor));
        }
    }

    void take_pass(double mm, double rad, std::optional<std::size_t> loose = std::nullopt) {
        shared_ = without_passes(blocks_, state_, mm, rad, loose);
    }

    Answer at(const std::vector<double>& curvature) const {
        const Marginal m = without_edges(shared_, blocks_, state_, penalties_, curvature);
        Answer answer;
        answer.information = m.information;
        answer.gradient = m.gradient;
        const Eigen::MatrixXd seen = view_.transpose() * (m.information + prior_) * view_;
        const Eigen::VectorXd g = view_.transpose() * (m.gradient + pull_);
        const SymmetricEigen eigen = symmetric_eigen(seen);
        Eigen::VectorXd step = Eigen::VectorXd::Zero(g.size());
        double rr = m.rr + pull2_, log_det = m.log_det;
        int determined = 0;
        for (Eigen::Index i = 0; i < g.size(); ++i) {
            const double value = eigen.values(i);
            log_det += std::log(std::max(value, kClosed));
            if (value < kClosed) continue;
            const double along = eigen.vectors.col(i).dot(g);
            step -= along / value * eigen.vectors.col(i);
            rr -= along * along / value;
            ++determined;
        }
        int rows = 0;
        for (const int r : blocks_.rows) rows += r;
        const double freedom = std::max(
            1.0, static_cast<double>(rows) - determined - 4.0 * static_cast<double>(penalties_.size()));
        answer.scale2 = scale_free_ ? std::max(rr / freedom, least2_) : 1;
        answer.minus2 = freedom * std::log(answer.scale2) + rr / answer.scale2 + log_det;
        answer.rr = rr;
        answer.step = view_ * step;
        answer.edges = -m.base - m.follow * answer.step;
        const Eigen::VectorXd inverse = eigen.values.cwiseMax(kLeastOpen).cwiseInverse();
        answer.covariance = view_ * eigen.vectors * (answer.scale2 * inverse).asDiagonal() *
                            eigen.vectors.transpose() * view_.transpose();
        return answer;
    }

  private:
    const Blocks& blocks_;
    const State& state_;
    Eigen::MatrixXd view_;
    bool scale_free_;
    double least2_;
    std::vector<Eigen::MatrixXd> penalties_;
    Eigen::MatrixXd prior_;
    Eigen::VectorXd pull_;
    double pull2_ = 0;
    Shared shared_;
};

// Of answers along one grid: what the mean over them adds to the likeliest one, and each one's weight.
struct Scatter {
    Eigen::VectorXd step;
    Eigen::MatrixXd covariance;
    std::vector<double> weights;
    std::size_t best = 0;
};
Scatter scatter_of(const std::vector<Answer>& answers) {
    Scatter s;
    for (std::size_t i = 1; i < answers.size(); ++i)
        if (answers[i].minus2 < answers[s.best].minus2) s.best = i;
    const Answer& best = answers[s.best];
    double sum = 0;
    for (const Answer& a : answers) {
        s.weights.push_back(std::isfinite(a.minus2) ? std::exp(-0.5 * (a.minus2 - best.minus2)) : 0);
        sum += s.weights.back();
    }
    s.step = Eigen::VectorXd::Zero(best.step.size());
    s.covariance = Eigen::MatrixXd::Zero(best.step.size(), best.step.size());
    for (double& w : s.weights) w /= sum;
    for (std::size_t i = 0; i < answers.size(); ++i)
        if (s.weights[i] > 0) s.step += s.weights[i] * (answers[i].step - best.step);
    for (std::size_t i = 0; i < answers.size(); ++i) {
        if (!(s.weights[i] > 0)) continue;
        const Eigen::VectorXd off = answers[i].step - best.step - s.step;
        s.covariance += s.weights[i] * (answers[i].covariance - best.covariance + off * off.transpose());
    }
    return s;
}

Scatter along_passes(Likelihood& likelihood, Variances& v) {
    std::vector<Answer> answers;
    for (const double mm : kPass_mm) {
        likelihood.take_pass(mm, mm * kRad_per_mm);
        answers.push_back(likelihood.at(v.curvature));
    }
    Scatter s = scatter_of(answers);
    v.pass_mm = kPass_mm.at(s.best);
    v.pass_rad = v.pass_mm * kRad_per_mm;
    likelihood.take_pass(v.pass_mm, v.pass_rad);
    return s;
}

Scatter along_edge(const Likelihood& likelihood, std::size_t edge, Variances& v) {
    std::vector<Answer> answers;
    for (const double curvature : kCurvature) {
        v.curvature[edge] = curvature;
        answers.push_back(likelihood.at(v.curvature));
    }
    Scatter s = scatter_of(answers);
    v.curvature[edge] = kCurvature.at(s.best);
    return s;
}

}  // namespace

Eigen::MatrixXd view_of(const State& state, const Eigen::Vector2d& working_point, Eigen::Index wanted) {
    Eigen::MatrixXd view = Eigen::MatrixXd::Zero(wanted, wanted);
    const Eigen::Matrix3d r = state.mounting.linear();
    view.topLeftCorner<3, 3>() = r;
    view.block<3, 3>(0, 3) = skew(r * in_sensor(working_point)) * r / kOnPartLever_mm;
    view.block<3, 3>(3, 3) = r / kOnPartLever_mm;
    if (wanted > 6) view(6, 6) = kOnPartOpen_s / kOnPartOpen_mm;
    return view;
}

Estimate estimate(const Blocks& blocks, const Data& data, const State& state, const Variances& from,
                  const Given& given) {
    Estimate e;
    e.variances = from;
    Variances& v = e.variances;
    Likelihood likelihood(blocks, data, state, given.view, given.scale_free, given.least);
    likelihood.take_pass(v.pass_mm, v.pass_rad);
    std::vector<Scatter> edges(state.edges.size());
    std::optional<Scatter> passes;
    for (int round = 0; round < 2; ++round) {
        for (std::size_t k = 0; k < edges.size(); ++k) edges[k] = along_edge(likelihood, k, v);
        if (!given.robot) passes = along_passes(likelihood, v);
    }
    const Answer best = likelihood.at(v.curvature);
    e.step = best.step;
    e.covariance = best.covariance;
    e.information = best.information / best.scale2;
    e.gradient = best.gradient / best.scale2;
    e.rr = best.rr / best.scale2;
    const auto add = [&](const Scatter& s) {
        e.step += s.step;
        e.covariance += s.covariance;
    };
    for (const Scatter& s : edges) {
        add(s);
        e.straight.push_back(s.weights[0] + s.weights[1]);
    }
    if (passes) add(*passes);
    v.white *= std::sqrt(best.scale2);
    return e;
}

Estimate at_variances(const Blocks& blocks, const Data& data, const State& state, const Variances& variances,
                      const Eigen::MatrixXd& view, std::optional<std::size_t> loose) {
    Likelihood likelihood(blocks, data, state, view, false);
    likelihood.take_pass(variances.pass_mm, variances.pass_rad, loose);
    const Answer answer = likelihood.at(variances.curvature);
    Estimate e;
    e.variances = variances;
    e.step = answer.step;
    e.covariance = answer.covariance;
    e.information = answer.information;
    e.gradient = answer.gradient;
    e.rr = answer.rr;
    e.edges = answer.edges;
    e.minus2 = answer.minus2;
    return e;
}

double neighbours_factor(const Blocks& blocks, const Data& data) {
    constexpr std::size_t kLags = 6;
    constexpr int kFewestNeighbours = 10;  // to tell a correlation
    const std::size_t n = blocks.sight_of.size();
    const double total = blocks.residuals.squaredNorm() / static_cast<double>(std::max<std::size_t>(1, n));
    double factor = 1;
    for (std::size_t lag = 1; lag <= kLags && total > 0; ++lag) {
        double sum = 0;
        int pairs = 0;
        for (std::size_t k = 0; k + lag < n; ++k) {
            if (data.sights[blocks.sight_of[k]].pass != data.sights[blocks.sight_of[k + lag]].pass) continue;
            sum += blocks.residuals.segment<2>(static_cast<Eigen::Index>(2 * k))
                       .dot(blocks.residuals.segment<2>(static_cast<Eigen::Index>(2 * (k + lag))));
            ++pairs;
        }
        if (pairs < kFewestNeighbours) break;
        const double correlation = sum / pairs / total;
        if (correlation < 2 / std::sqrt(2.0 * pairs)) break;
        factor += 2 * correlation;
    }
    return factor;
}

}  // namespace seamwright::on_part
