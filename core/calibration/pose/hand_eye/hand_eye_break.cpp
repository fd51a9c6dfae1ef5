#include "core/calibration/pose/hand_eye/hand_eye_break.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/acceptance/distributions.h"
#include "core/calibration/pose/hand_eye/hand_eye_parts.h"
#include "core/numbers.h"

namespace seamwright::hand_eye {
namespace {

constexpr std::size_t kFewestEachSide = 3, kFewestInAll = 8;
constexpr int kFreed = 6, kUnknowns = 12 + kFreed;
constexpr int kBreakRounds = 4;  // of variances and place in turn
// Which variance a row of a residual in the frame of the sight belongs to.
constexpr std::size_t kKinds = 4;
constexpr std::array<std::size_t, 6> kKindOf{0, 0, 1, 2, 2, 3};
// Standard deviations to begin with, those of hand_eye_few.cpp, and the rows that they count for.
constexpr std::array<double, kKinds> kStart{1, 1.6, 1.8, 1.2};
constexpr double kStartWeight = 2;
// Neighbouring poses of a robot err alike (correlated by 0.3): means over a stretch of poses then scatter by
// (1 + 0.3) / (1 - 0.3) times what independent ones do.
constexpr double kNeighboursAlike = 1.86;

using Rows = Eigen::Matrix<double, 6, kUnknowns>;
using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Vector18 = Eigen::Matrix<double, kUnknowns, 1>;
using Variances = std::array<double, kKinds>;

struct Fit {
    double squares = 0;
    Vector18 move = Vector18::Zero();
    Square cover = Square::Zero();
};

class OrderedPairs {
  public:
    OrderedPairs(const Chain& chain, const Pose& x, const Pose& y) {
        const Scales scales{1, 1 / shared_lever_mm(chain)};
        const PairLinear at = linear_pairs(chain, x, y, scales, false);
        for (std::size_t i = 0; i < chain.size(); ++i) {
            const Eigen::Vector3d sight =
                (chain.a[i].linear() * x.linear() * chain.c[i].translation()).normalized();
            const Eigen::Matrix3d along =
                Eigen::Quaterniond::FromTwoVectors(sight, Eigen::Vector3d::UnitZ()).toRotationMatrix();
            Matrix6 turn = Matrix6::Identity();
            turn.topLeftCorner<3, 3>() = along;
            rows_.emplace_back(turn * at.jacobian[i]);
            left_.emplace_back(turn * at.residual[i]);
        }
    }
    std::size_t size() const { return rows_.size(); }

    // With the break before pair `first`; without one where there is none.
    Fit fit(std::size_t first, const Variances& variance) const {
        Square information = Square::Zero();
        Vector18 pull = Vector18::Zero();
        Fit out;
        for (std::size_t i = 0; i < size(); ++i) {
            const Rows j = whitened(i, first, variance);
            const Vector6 e = weights(variance).cwiseProduct(left_[i]);
            information.noalias() += j.transpose() * j;
            pull.noalias() += j.transpose() * e;
            out.squares += e.squaredNorm();
        }
        const Vector18 unit = information.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
        Square scaled = unit.asDiagonal() * information * unit.asDiagonal();
        scaled.diagonal().array() += kRidge;
        out.cover = unit.asDiagonal() * Square(scaled.ldlt().solve(Square::Identity())) * unit.asDiagonal();
        out.move = -(out.cover * pull);
        out.squares += out.move.dot(pull);
        return out;
    }

    // Mean squares by kind over what the fit leaves of a row.
    Variances variances(const Fit& fit, std::size_t first, const Variances& before) const {
        Variances squares{}, rows{};
        for (std::size_t i = 0; i < size(); ++i) {
            const Rows j = whitened(i, first, before);
            const Vector6 e = weights(before).cwiseProduct(left_[i]) + j * fit.move;
            for (Eigen::Index r = 0; r < 6; ++r) {
                const std::size_t kind = kKindOf[static_cast<std::size_t>(r)];
                squares[kind] += e[r] * e[r] * before[kind];
                rows[kind] += 1 - j.row(r).dot(fit.cover * j.row(r).transpose());
            }
        }
        double all = 0;
        for (std::size_t k = 0; k < kKinds; ++k) all += squares[k] / (kStart[k] * kStart[k]);
        const double level = all / (6.0 * static_cast<double>(size()) - kUnknowns);
        Variances next{};
        for (std::size_t k = 0; k < kKinds; ++k)
            next[k] = std::max((squares[k] + kStartWeight * level * kStart[k] * kStart[k]) /
                                   (std::max(rows[k], 0.0) + kStartWeight),
                               kFloor_mm * kFloor_mm);
        return next;
    }

    // Of the target's place and turn by the change.
    void seen(const Fit& fit, Break& change, double lever) const {
        const Vector6 by = fit.move.tail<kFreed>();
        double squares = 0;
        for (std::size_t i = change.first; i < size(); ++i)
            squares += (rows_[i].topLeftCorner<3, 6>() * by).squaredNorm();
        change.mm = std::sqrt(squares / static_cast<double>(size() - change.first));
        change.rad = (rows_[change.first].bottomLeftCorner<3, 6>() * by).norm() / lever;
    }

  private:
    static Vector6 weights(const Variances& variance) {
        Vector6 w;
        for (Eigen::Index r = 0; r < 6; ++r)
            w[r] = 1 / std::sqrt(variance[kKindOf[static_cast<std::size_t>(r)]]);
        return w;
    }
    Rows whitened(std::size_t i, std::size_t first, const Variances& variance) const {
        Rows j = Rows::Zero();
        j.leftCols<12>() = weights(variance).asDiagonal() * rows_[i];
        if (i >= first) j.rightCols<kFreed>() = j.leftCols<kFreed>();
        return j;
    }

    std::vector<Eigen::Matrix<double, 6, 12>> rows_;
    std::vector<Vector6> left_;
};

}  // namespace

std::optional<Break> likeliest_break(const Chain& chain, const Pose& x, const Pose& y) {
    if (chain.size() < kFewestInAll) return std::nullopt;
    const OrderedPairs pairs(chain, x, y);
    Variances variance{};
    for (std::size_t k = 0; k < kKinds; ++k) variance[k] = kStart[k] * kStart[k];
    Break found;
    Fit best;
    for (int round = 0; round < kBreakRounds; ++round) {
        double least = kInfinity;
        for (std::size_t k = kFewestEachSide; k + kFewestEachSide <= pairs.size(); ++k) {
            const Fit fit = pairs.fit(k, variance);
            if (!(fit.squares < least)) continue;
            least = fit.squares;
            found.first = k;
            best = fit;
        }
        if (!std::isfinite(least)) return std::nullopt;
        if (round + 1 < kBreakRounds) variance = pairs.variances(best, found.first, variance);
    }
    const double freedom = 6.0 * static_cast<double>(pairs.size()) - kUnknowns;
    const double places = static_cast<double>(pairs.size() - 2 * kFewestEachSide + 1);
    const double fall = std::max(0.0, pairs.fit(pairs.size(), variance).squares - best.squares);
    // A floor under the variances says that less is no scatter.
    const double left = std::max(best.squares / freedom, 1.0);
    found.chance = std::min(1.0, places * f_upper(kFreed, freedom, fall / kFreed / left / kNeighboursAlike));
    pairs.seen(best, found, shared_lever_mm(chain));
    return found;
}

}  // namespace seamwright::hand_eye
