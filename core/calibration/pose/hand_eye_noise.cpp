#include "core/calibration/pose/hand_eye_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/calibration/numbers.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::hand_eye {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Rows = Eigen::Matrix<double, 6, 12>;

constexpr std::size_t kFewestForFive = 6;  // pairs
constexpr int kSteps = 25;                 // of the variances, each round
// The robot's turn is told from the camera's by its lever alone: it starts small.
constexpr double kRobotStart = 0.1;
// A variance begins as the isotropic one, and that counts for a tenth of a residual: none comes out as nothing where few
// pairs speak of it.
constexpr double kPriorWeight = 0.1;
constexpr double kPriorLog = 3;  // sigma of a variance's logarithm, before the pairs
constexpr double kFewestFreedom = 3;
constexpr double kLeastLeft = 0.02;        // of the isotropic variance, beside a stated robot
constexpr double kLeastTrace = 1e-12;      // of what the pairs say of a variance: guards the quotient
constexpr double kVarianceSettled = 1e-3;  // of a variance's logarithm: a smaller change ends the round
constexpr double kNoScatter = 1e-300;      // of a variance that is sure: guards the quotient
constexpr double kMostFreedom = 1e6;

// All in units of the isotropic scales.
class PairNoise {
  public:
    PairNoise(const Chain& chain, bool robot_outside, const RobotRepeatability& robot, const Scales& scales)
        : chain_(chain), robot_outside_(robot_outside), robot_(robot), scales_(scales) {
        const std::size_t kinds = chain.used_count() < kFewestForFive ? 2 : 5;
        variance_.assign(kinds, 1);
    }

    Weighed run(Pose x, Pose y) {
        for (int round = 0; round < 3; ++round) {
            at_ = linearise_pairs(chain_, x, y, scales_);
            shape(x, y);
            if (round == 0) begin();
            for (int step = 0; step < kSteps; ++step) {
                weigh();
                if (!next_variances()) break;
            }
            weigh();
            Vector12 pull = Vector12::Zero();
            for (std::size_t i = 0; i < count(); ++i) pull += weighted_[i].transpose() * residual(i);
            const Vector12 move = -(cover_ * pull);
            if (!move.allFinite()) break;
            x = retract(x, move.head<6>());
            y = retract(y, move.tail<6>());
        }
        at_ = linearise_pairs(chain_, x, y, scales_);
        weigh();
        return {x, y, stated()};
    }

  private:
    // What the stated robot leaves of the isotropic variance for the others to begin with.
    void begin() {
        double mm = 0, rad = 0;
        for (const Matrix6& k : known_) {
            mm += k.topLeftCorner<3, 3>().trace() / 3 / static_cast<double>(known_.size());
            rad += k.bottomRightCorner<3, 3>().trace() / 3 / static_cast<double>(known_.size());
        }
        const double left_mm = std::max(1 - mm, kLeastLeft), left_rad = std::max(1 - rad, kLeastLeft);
        if (variance_.size() == 2)
            start_ = {left_mm, left_rad};
        else
            start_ = {left_mm, left_mm, left_rad, left_rad, kRobotStart * std::min(left_mm, left_rad)};
        variance_ = start_;
    }
    std::size_t count() const { return chain_.used_count(); }
    Rows jacobian(std::size_t i) const {
        return at_.jacobian.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    }
    Vector6 residual(std::size_t i) const {
        return at_.residuals.segment<6>(static_cast<Eigen::Index>(6 * i));
    }

    // The parts of each pair's covariance, and what of it is known.
    void shape(const Pose& x, const Pose& y) {
        parts_.clear();
        known_.clear();
        const double lever = scales_.rad / scales_.mm;
        for (std::size_t i = 0; i < chain_.size(); ++i) {
            if (!chain_.used[i]) continue;
            std::vector<Matrix6> part(variance_.size(), Matrix6::Zero());
            Eigen::Matrix<double, 6, 3> turned;  // by a turn of the flange
            if (robot_outside_) {
                turned.topRows<3>() = -lever * skew(y.translation());
                turned.bottomRows<3>() = y.linear().transpose();
            } else {
                turned.topRows<3>() = -lever * chain_.a[i].linear() * skew(x * chain_.c[i].translation());
                turned.bottomRows<3>() = (x.linear() * chain_.c[i].linear()).transpose();
            }
            Matrix6 stated = std::pow(robot_.sigma_rad / scales_.rad, 2) * turned * turned.transpose();
            stated.topLeftCorner<3, 3>().diagonal().array() += std::pow(robot_.sigma_mm / scales_.mm, 2);
            known_.push_back(stated);
            if (variance_.size() == 2) {
                part[0].topLeftCorner<3, 3>().setIdentity();
                part[1].bottomRightCorner<3, 3>().setIdentity();
            } else {
                const Eigen::Vector3d sight =
                    chain_.a[i].linear() * x.linear() * chain_.c[i].translation().normalized();
                part[1].topLeftCorner<3, 3>() = sight * sight.transpose();
                part[0].topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() - part[1].topLeftCorner<3, 3>();
                part[2](3, 3) = part[2](4, 4) = 1;
                part[3](5, 5) = 1;
                part[4] = turned * turned.transpose();
            }
            parts_.push_back(std::move(part));
        }
    }

    // S_i^-1, S_i^-1 J_i and the covariance of X and Y.
    void weigh() {
        inverse_.resize(count());
        weighted_.resize(count());
        Matrix12 information = Matrix12::Zero();
        for (std::size_t i = 0; i < count(); ++i) {
            Matrix6 s = known_[i];
            for (std::size_t k = 0; k < variance_.size(); ++k) s += variance_[k] * parts_[i][k];
            inverse_[i] = s.inverse();
            weighted_[i] = inverse_[i] * jacobian(i);
            information.noalias() += jacobian(i).transpose() * weighted_[i];
        }
        const Vector12 unit = information.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
        cover_ = unit.asDiagonal() *
                 inverse_matrix(Matrix12(unit.asDiagonal() * information * unit.asDiagonal()) +
                                kRidge * Matrix12::Identity()) *
                 unit.asDiagonal();
    }

    // v_k <- v_k sqrt(r' P V_k P r / tr(P V_k)), with the prior beside; false where they stand still.
    bool next_variances() {
        Vector12 pull = Vector12::Zero();
        for (std::size_t i = 0; i < count(); ++i) pull += weighted_[i].transpose() * residual(i);
        const Vector12 move = cover_ * pull;
        std::vector<double> squares(variance_.size(), 0), trace(variance_.size(), 0);
        for (std::size_t i = 0; i < count(); ++i) {
            const Vector6 left = inverse_[i] * (residual(i) - jacobian(i) * move);
            const Matrix6 p = inverse_[i] - weighted_[i] * cover_ * weighted_[i].transpose();
            for (std::size_t k = 0; k < variance_.size(); ++k) {
                squares[k] += left.dot(parts_[i][k] * left);
                trace[k] += p.cwiseProduct(parts_[i][k]).sum();
            }
        }
        double change = 0;
        for (std::size_t k = 0; k < variance_.size(); ++k) {
            const double next =
                std::sqrt((variance_[k] * variance_[k] * squares[k] + kPriorWeight * start_[k]) /
                          std::max(trace[k] + kPriorWeight / variance_[k], kLeastTrace));
            change = std::max(change, std::abs(std::log(next / variance_[k])));
            variance_[k] = next;
        }
        return change > kVarianceSettled;
    }

    Matrix12 stated() const {
        const auto kinds = static_cast<Eigen::Index>(variance_.size());
        std::vector<Matrix12> p(variance_.size(), Matrix12::Zero());  // less than nothing: dI/dv = -p
        std::vector<std::vector<Matrix12>> q(variance_.size(),
                                             std::vector<Matrix12>(variance_.size(), Matrix12::Zero()));
        Eigen::MatrixXd known = Eigen::MatrixXd::Zero(kinds, kinds);
        for (std::size_t i = 0; i < count(); ++i) {
            std::vector<Rows> moved;
            std::vector<Matrix6> share;
            for (const Matrix6& part : parts_[i]) {
                share.push_back(inverse_[i] * part);
                moved.push_back(part * weighted_[i]);
            }
            for (std::size_t k = 0; k < variance_.size(); ++k) {
                p[k].noalias() += weighted_[i].transpose() * moved[k];
                for (std::size_t l = 0; l < variance_.size(); ++l) {
                    q[k][l].noalias() += moved[k].transpose() * inverse_[i] * moved[l];
                    known(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) +=
                        0.5 * share[k].cwiseProduct(share[l].transpose()).sum();
                }
            }
        }
        for (std::size_t k = 0; k < variance_.size(); ++k)
            for (std::size_t l = 0; l < variance_.size(); ++l)
                known(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) +=
                    -cover_.cwiseProduct(q[k][l]).sum() +
                    0.5 * (cover_ * p[k]).cwiseProduct((cover_ * p[l]).transpose()).sum();
        for (std::size_t k = 0; k < variance_.size(); ++k)
            known(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) +=
                std::pow(variance_[k] * kPriorLog, -2);
        const Eigen::MatrixXd unsure = inverse_matrix(known);
        Matrix12 more = Matrix12::Zero();
        for (std::size_t k = 0; k < variance_.size(); ++k)
            for (std::size_t l = 0; l < variance_.size(); ++l)
                more += unsure(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) *
                        (q[k][l] - p[k] * cover_ * p[l]);
        const Matrix12 adjusted = cover_ + 2 * cover_ * (0.5 * (more + more.transpose())) * cover_;
        Vector12 student;
        for (Eigen::Index n = 0; n < 12; ++n) {
            Eigen::VectorXd slope(kinds);
            for (std::size_t k = 0; k < variance_.size(); ++k)
                slope(static_cast<Eigen::Index>(k)) = cover_.col(n).dot(p[k] * cover_.col(n));
            const double scatter = slope.dot(unsure * slope);
            const double freedom = 2 * std::pow(cover_(n, n), 2) / std::max(scatter, kNoScatter);
            student(n) =
                student_quantile(kUpper95, std::clamp(freedom, kFewestFreedom, kMostFreedom)) / kNormal95;
        }
        return student.asDiagonal() * adjusted * student.asDiagonal();
    }

    const Chain& chain_;
    bool robot_outside_;
    RobotRepeatability robot_;
    Scales scales_;
    std::vector<double> variance_, start_;
    Linear at_;
    std::vector<std::vector<Matrix6>> parts_;
    std::vector<Matrix6> known_;
    std::vector<Matrix6> inverse_;
    std::vector<Rows> weighted_;
    Matrix12 cover_ = Matrix12::Zero();
};

}  // namespace

Weighed weigh(const Chain& chain, bool robot_outside, const RobotRepeatability& robot, const Pose& x,
              const Pose& y, const Scales& scales) {
    return PairNoise(chain, robot_outside, robot, scales).run(x, y);
}

}  // namespace seamwright::hand_eye
