#include "core/calibration/on_part/start.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

constexpr int kAttitudes = 400;
constexpr std::size_t kRefined = 12, kMost = 140;
constexpr double kPsi = 1.533751168755204288118041;  // super-Fibonacci spirals, beside sqrt(2)
constexpr double kWeightSquares = 9;                 // a weight is halved at three times the median distance
constexpr double kLeastMedian_mm2 = 1e-6;
constexpr double kUnit_mm = 50;                      // of the way along an edge, in the powers of its curve
constexpr double kNearFlange = 1e-6, kRidge = 1e-9;  // by ray: on the shift, on all unknowns
constexpr double kNowhere_mm2 = 1e12;                // squared distance that is not finite
// Thinned data: white noise in sigmas, curvature 1/mm, knots, loss.
constexpr double kRoughWhite = 3, kRoughCurvature = 0.01, kRoughKnot_mm = 25, kRoughRobust_mm = 0.3;
constexpr double kBegunApart_deg = 15, kApart_deg = 3;  // of attitudes, before and after they are solved

// A thinned sight with its pose at the start's latency.
struct Ray {
    Pose pose;
    Eigen::Vector3d point;
    std::size_t edge;
};

std::vector<Eigen::Matrix3d> attitudes() {
    std::vector<Eigen::Matrix3d> list;
    for (int i = 0; i < kAttitudes; ++i) {
        const double s = i + 0.5, r = std::sqrt(s / kAttitudes), q = std::sqrt(1 - s / kAttitudes);
        const double a = 2 * kPi * s / std::sqrt(2.0), b = 2 * kPi * s / kPsi;
        list.push_back(Eigen::Quaterniond(q * std::cos(b), r * std::sin(a), r * std::cos(a), q * std::sin(b))
                           .toRotationMatrix());
    }
    return list;
}

std::vector<Ray> rays_of(const Data& data, double latency) {
    std::size_t used = 0;
    for (const Sight& s : data.sights) used += s.used;
    const double every = std::max(1.0, static_cast<double>(used) / static_cast<double>(kMost));
    std::vector<Ray> rays;
    double next = 0;
    std::size_t k = 0;
    for (const Sight& s : data.sights) {
        if (!s.used) continue;
        if (static_cast<double>(k++) < next) continue;
        next += every;
        rays.push_back({data.motions[s.pass].at(s.time_s - latency), in_sensor(s.point), s.edge});
    }
    return rays;
}

Eigen::Vector3d direction_of(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(scatter);
    const Eigen::Vector3d d = eigen.eigenvectors().col(2);
    return d.allFinite() && d.norm() > 0.5 ? d : Eigen::Vector3d::UnitX();
}

struct Trial {
    Pose mounting = Pose::Identity();
    double cost = kInfinity;
};

class Shift {
  public:
    Shift(const std::vector<Ray>& rays, std::size_t edges) : rays_(rays), edges_(edges), middle_(edges) {
        std::vector<std::vector<Eigen::Vector3d>> flange(edges);
        for (const Ray& r : rays) flange[r.edge].push_back(r.pose.translation());
        for (std::size_t e = 0; e < edges; ++e) {
            first_.push_back(flange[e].empty() ? Eigen::Vector3d::UnitX() : direction_of(flange[e]));
            for (const auto& p : flange[e]) middle_[e] = p;
        }
    }

    Trial of(const Eigen::Matrix3d& turn) const {
        std::vector<Eigen::Vector3d> directions = first_;
        Eigen::Vector3d shift = Eigen::Vector3d::Zero();
        std::vector<double> weights(rays_.size(), 1);
        Trial trial;
        for (int round = 0; round < 3; ++round) {
            solve(turn, directions, weights, shift);
            double sum = 0;
            for (std::size_t k = 0; k < rays_.size(); ++k) sum += std::sqrt(residual2_[k]);
            trial.cost = sum;
            std::vector<double> off(residual2_);
            const double scale2 = kWeightSquares * std::max(kLeastMedian_mm2, median(off));
            for (std::size_t k = 0; k < rays_.size(); ++k) weights[k] = 1 / (1 + residual2_[k] / scale2);
            std::vector<std::vector<Eigen::Vector3d>> points(edges_);
            for (const Ray& r : rays_) points[r.edge].push_back(r.pose * (turn * r.point + shift));
            for (std::size_t e = 0; e < edges_; ++e)
                if (points[e].size() > 1) directions[e] = direction_of(points[e]);
        }
        trial.mounting = make_pose(turn, shift);
        return trial;
    }

  private:
    void solve(const Eigen::Matrix3d& turn, const std::vector<Eigen::Vector3d>& directions,
               const std::vector<double>& weights, Eigen::Vector3d& shift) const {
        const Eigen::Index n = 3 + 6 * static_cast<Eigen::Index>(edges_);
        normal_.setZero(n, n);
        right_.setZero(n);
        rows_.resize(rays_.size());
        for (std::size_t k = 0; k < rays_.size(); ++k) {
            const Ray& r = rays_[k];
            const Eigen::Vector3d& d = directions[r.edge];
            Row& row = rows_[k];
            Eigen::Matrix<double, 3, 2> across;
            across.col(0) = d.unitOrthogonal();
            across.col(1) = d.cross(across.col(0));
            const Eigen::Vector3d fixed =
                r.pose.linear() * (turn * r.point) + (r.pose.translation() - middle_[r.edge]);
            const double s = d.dot(fixed + r.pose.linear() * shift) / kUnit_mm;
            row.by_shift = across.transpose() * r.pose.linear();
            row.right = -across.transpose() * fixed;
            row.powers = {1, s, s * s};
            const double w = weights[k];
            normal_.topLeftCorner<3, 3>() += w * row.by_shift.transpose() * row.by_shift;
            right_.head<3>() += w * row.by_shift.transpose() * row.right;
            for (Eigen::Index axis = 0; axis < 2; ++axis) {
                const Eigen::Index at = 3 + 6 * static_cast<Eigen::Index>(r.edge) + 3 * axis;
                normal_.block<3, 3>(0, at) -= w * row.by_shift.row(axis).transpose() * row.powers.transpose();
                normal_.block<3, 3>(at, at) += w * row.powers * row.powers.transpose();
                right_.segment<3>(at) -= w * row.right(axis) * row.powers;
            }
        }
        normal_.bottomLeftCorner(n - 3, 3) = normal_.topRightCorner(3, n - 3).transpose();
        // Of a start alone: what these passes do not tell stays near the flange.
        normal_.diagonal().head<3>().array() += kNearFlange * static_cast<double>(rays_.size());
        normal_.diagonal().array() += kRidge * static_cast<double>(rays_.size());
        const Eigen::VectorXd x = Eigen::LDLT<Eigen::MatrixXd>(normal_).solve(right_);
        shift = x.head<3>();
        residual2_.resize(rays_.size());
        for (std::size_t k = 0; k < rays_.size(); ++k) {
            Eigen::Vector2d off = rows_[k].by_shift * shift - rows_[k].right;
            for (Eigen::Index axis = 0; axis < 2; ++axis)
                off(axis) -= rows_[k].powers.dot(
                    x.segment<3>(3 + 6 * static_cast<Eigen::Index>(rays_[k].edge) + 3 * axis));
            residual2_[k] = std::isfinite(off.squaredNorm()) ? off.squaredNorm() : kNowhere_mm2;
        }
    }

    struct Row {
        Eigen::Matrix<double, 2, 3> by_shift;
        Eigen::Vector2d right;
        Eigen::Vector3d powers;
    };
    const std::vector<Ray>& rays_;
    std::size_t edges_;
    std::vector<Eigen::Vector3d> middle_, first_;
    mutable Eigen::MatrixXd normal_;
    mutable Eigen::VectorXd right_;
    mutable std::vector<Row> rows_;
    mutable std::vector<double> residual2_;
};

// The same data with every n-th profile alone.
Data thinned(const Data& data) {
    Data thin = data;
    std::size_t used = 0;
    for (const Sight& s : data.sights) used += s.used;
    const std::size_t every = std::max<std::size_t>(1, used / kMost);
    std::size_t k = 0;
    for (Sight& s : thin.sights)
        if (s.used && k++ % every != 0) s.used = false;
    return thin;
}

}  // namespace

State start_at(const Data& data, const Pose& mounting, double latency_s, double knot_mm, int most) {
    State state;
    state.mounting = mounting;
    state.latency_s = latency_s;
    state.passes.assign(data.motions.size(), Vector6::Zero());
    for (std::size_t e = 0; e < data.edges; ++e) {
        std::vector<Eigen::Vector3d> points;
        for (const Sight& s : data.sights)
            if (s.used && s.edge == e) points.push_back(in_base(data, state, s));
        if (points.size() < 2) points = {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX()};
        state.edges.push_back(curve_through(points, knot_mm, most));
    }
    return state;
}

std::vector<State> starts(const Data& data) {
    const double latency = data.latency_s;
    const Data thin = thinned(data);
    const std::vector<Ray> rays = rays_of(data, latency);
    const Shift shift(rays, data.edges);
    std::vector<Trial> trials;
    for (const Eigen::Matrix3d& turn : attitudes()) trials.push_back(shift.of(turn));
    std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.cost < b.cost; });

    Variances rough;
    rough.white = kRoughWhite;
    rough.curvature.assign(data.edges, kRoughCurvature);
    struct Solved {
        State state;
        double cost;
    };
    std::vector<Solved> solved;
    std::vector<Pose> begun;
    for (const Trial& trial : trials) {
        if (begun.size() >= kRefined) break;
        if (std::any_of(begun.begin(), begun.end(), [&](const Pose& p) {
                return angle_rad(p, trial.mounting) < rad_from_deg(kBegunApart_deg);
            }))
            continue;
        begun.push_back(trial.mounting);
        State state = start_at(thin, trial.mounting, latency, kRoughKnot_mm, 4);
        const double cost = solve_state(thin, rough, {kRoughRobust_mm, false, 25}, state);
        if (std::isfinite(cost)) solved.push_back({std::move(state), cost});
    }
    std::sort(solved.begin(), solved.end(), [](const Solved& a, const Solved& b) { return a.cost < b.cost; });
    std::vector<State> apart;
    for (Solved& s : solved) {
        if (std::none_of(apart.begin(), apart.end(), [&](const State& other) {
                return angle_rad(other.mounting, s.state.mounting) < rad_from_deg(kApart_deg);
            }))
            apart.push_back(std::move(s.state));
        if (apart.size() == 4) break;
    }
    return apart;
}

}  // namespace seamwright::on_part
