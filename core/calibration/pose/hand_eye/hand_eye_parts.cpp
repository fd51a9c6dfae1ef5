#include "core/calibration/pose/hand_eye/hand_eye_parts.h"

#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright::hand_eye {

PairParts pair_parts(const Chain& chain, bool robot_outside, const RobotRepeatability& robot,
                     const Scales& scales, const Pose& x, const Pose& y) {
    PairParts all;
    const double lever = scales.rad / scales.mm;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        Eigen::Matrix<double, 6, 3> turned;  // by a turn of the flange
        if (robot_outside) {
            turned.topRows<3>() = -lever * skew(y.translation());
            turned.bottomRows<3>() = y.linear().transpose();
        } else {
            turned.topRows<3>() = -lever * chain.a[i].linear() * skew(x * chain.c[i].translation());
            turned.bottomRows<3>() = (x.linear() * chain.c[i].linear()).transpose();
        }
        Matrix6 stated = std::pow(robot.sigma_rad / scales.rad, 2) * turned * turned.transpose();
        stated.topLeftCorner<3, 3>().diagonal().array() += std::pow(robot.sigma_mm / scales.mm, 2);
        all.known.push_back(stated);
        std::array<Matrix6, kErrorKinds> part;
        part.fill(Matrix6::Zero());
        const Eigen::Vector3d sight =
            chain.a[i].linear() * x.linear() * chain.c[i].translation().normalized();
        part[1].topLeftCorner<3, 3>() = sight * sight.transpose();
        part[0].topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() - part[1].topLeftCorner<3, 3>();
        part[2](3, 3) = part[2](4, 4) = 1;
        part[3](5, 5) = 1;
        part[4] = turned * turned.transpose();
        all.parts.push_back(part);
    }
    return all;
}

PairLinear linear_pairs(const Chain& chain, const Pose& x, const Pose& y, const Scales& scales,
                        bool free_size) {
    const Linear at = linearise_pairs(chain, x, y, scales);
    PairLinear pairs;
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        pairs.residual.emplace_back(at.residuals.segment<6>(row));
        PairRows j = PairRows::Zero(6, free_size ? 13 : 12);
        j.leftCols<12>() = at.jacobian.middleRows<6>(row);
        if (free_size)
            j.col(12).head<3>() = chain.a[i].linear() * x.linear() * chain.c[i].translation() / scales.mm;
        pairs.jacobian.push_back(j);
        row += 6;
    }
    return pairs;
}

UnknownsSquare cover_of(const UnknownsSquare& information) {
    const Unknowns unit = information.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
    UnknownsSquare scaled = unit.asDiagonal() * information * unit.asDiagonal();
    scaled.diagonal().array() += kRidge;
    return unit.asDiagonal() * inverse_matrix(scaled) * unit.asDiagonal();
}

void move_by(const Unknowns& step, Chain& chain, Pose& x, Pose& y) {
    x = retract(x, step.head<6>());
    y = retract(y, step.segment<6>(6));
    if (step.size() > 12)
        for (Pose& c : chain.c) c.translation() *= 1 + step(12);
}

}  // namespace seamwright::hand_eye
