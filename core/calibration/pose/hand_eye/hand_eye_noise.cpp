#include "core/calibration/pose/hand_eye/hand_eye_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/calibration/numbers.h"
#include "core/calibration/pose/hand_eye/hand_eye_few.h"
#include "core/calibration/pose/hand_eye/hand_eye_parts.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::hand_eye {
namespace {

constexpr std::size_t kFewestForVariances = 10;  // pairs
constexpr int kSteps = 25;                       // of the variances, each round
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
    PairNoise(const Chain& chain, bool robot_outside, const RobotRepeatability& robot, const Scales& scales,
              bool free_size)
        : chain_(chain),
          robot_outside_(robot_outside),
          robot_(robot),
          scales_(scales),
          free_size_(free_size) {
        variance_.assign(kErrorKinds, 1);
    }

    Weighed run(Pose x, Pose y) {
        Weighed found;
        for (int round = 0; round < 3; ++round) {
            at_ = linear_pairs(chain_, x, y, scales_, free_size_);
            errors_ = pair_parts(chain_, robot_outside_, robot_, scales_, x, y);
            if (round == 0) begin();
            for (int step = 0; step < kSteps; ++step) {
                weigh();
                if (!next_variances()) break;
            }
            weigh();
            const Unknowns move = -(cover_ * pull());
            if (!move.allFinite()) break;
            move_by(move, chain_, x, y);
            if (free_size_) found.size *= 1 + move(12);
        }
        at_ = linear_pairs(chain_, x, y, scales_, free_size_);
        weigh();
        found.x = x;
        found.y = y;
        found.covariance = stated();
        return found;
    }

  private:
    // What the stated robot leaves of the isotropic variance for the others to begin with.
    void begin() {
        double mm = 0, rad = 0;
        for (const Matrix6& k : errors_.known) {
            mm += k.topLeftCorner<3, 3>().trace() / 3 / static_cast<double>(count());
            rad += k.bottomRightCorner<3, 3>().trace() / 3 / static_cast<double>(count());
        }
        const double left_mm = std::max(1 - mm, kLeastLeft), left_rad = std::max(1 - rad, kLeastLeft);
        start_ = {left_mm, left_mm, left_rad, left_rad, kRobotStart * std::min(left_mm, left_rad)};
        variance_ = start_;
    }
    std::size_t count() const { return at_.residual.size(); }
    const PairRows& jacobian(std::size_t i) const { return at_.jacobian[i]; }
    const Vector6& residual(std::size_t i) const { return at_.residual[i]; }
    Eigen::Index unknowns() const { return free_size_ ? 13 : 12; }
    Unknowns pull() const {
        Unknowns sum = Unknowns::Zero(unknowns());
        for (std::size_t i = 0; i < count(); ++i) sum += weighted_[i].transpose() * residual(i);
        return sum;
    }

    // S_i^-1, S_i^-1 J_i and the covariance of X and Y.
    void weigh() {
        inverse_.resize(count());
        weighted_.resize(count());
        UnknownsSquare information = UnknownsSquare::Zero(unknowns(), unknowns());
        for (std::size_t i = 0; i < count(); ++i) {
            Matrix6 s = errors_.known[i];
            for (std::size_t k = 0; k < kErrorKinds; ++k) s += variance_[k] * errors_.parts[i][k];
            inverse_[i] = s.inverse();
            weighted_[i] = inverse_[i] * jacobian(i);
            information.noalias() += jacobian(i).transpose() * weighted_[i];
        }
        cover_ = cover_of(information);
    }

    // v_k <- v_k sqrt(r' P V_k P r / tr(P V_k)), with the prior beside; false where they stand still.
    bool next_variances() {
        const Unknowns move = cover_ * pull();
        std::vector<double> squares(variance_.size(), 0), trace(variance_.size(), 0);
        for (std::size_t i = 0; i < count(); ++i) {
            const Vector6 left = inverse_[i] * (residual(i) - jacobian(i) * move);
            const Matrix6 p = inverse_[i] - weighted_[i] * cover_ * weighted_[i].transpose();
            for (std::size_t k = 0; k < variance_.size(); ++k) {
                squares[k] += left.dot(errors_.parts[i][k] * left);
                trace[k] += p.cwiseProduct(errors_.parts[i][k]).sum();
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

    UnknownsSquare stated() const {
        const auto kinds = static_cast<Eigen::Index>(variance_.size());
        std::vector<UnknownsSquare> p(
            variance_.size(), UnknownsSquare::Zero(unknowns(), unknowns()));  // less than nothing: dI/dv = -p
        std::vector<std::vector<UnknownsSquare>> q(
            variance_.size(),
            std::vector<UnknownsSquare>(variance_.size(), UnknownsSquare::Zero(unknowns(), unknowns())));
        Eigen::MatrixXd known = Eigen::MatrixXd::Zero(kinds, kinds);
        for (std::size_t i = 0; i < count(); ++i) {
            std::vector<PairRows> moved;
            std::vector<Matrix6> share;
            for (const Matrix6& part : errors_.parts[i]) {
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
        UnknownsSquare more = UnknownsSquare::Zero(unknowns(), unknowns());
        for (std::size_t k = 0; k < variance_.size(); ++k)
            for (std::size_t l = 0; l < variance_.size(); ++l)
                more += unsure(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) *
                        (q[k][l] - p[k] * cover_ * p[l]);
        const UnknownsSquare adjusted = cover_ + 2 * cover_ * (0.5 * (more + more.transpose())) * cover_;
        Unknowns student(unknowns());
        for (Eigen::Index n = 0; n < unknowns(); ++n) {
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

    Chain chain_;
    bool robot_outside_;
    RobotRepeatability robot_;
    Scales scales_;
    bool free_size_;
    std::vector<double> variance_, start_;
    PairLinear at_;
    PairParts errors_;
    std::vector<Matrix6> inverse_;
    std::vector<PairRows> weighted_;
    UnknownsSquare cover_;
};

}  // namespace

Weighed weigh(const Chain& chain, bool robot_outside, const RobotRepeatability& robot, const Pose& x,
              const Pose& y, const Scales& scales, bool free_size) {
    if (chain.used_count() < kFewestForVariances)
        return weigh_few(chain, robot_outside, robot, x, y, free_size);
    return PairNoise(chain, robot_outside, robot, scales, free_size).run(x, y);
}

}  // namespace seamwright::hand_eye
