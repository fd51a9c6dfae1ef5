#include "devices/controllers/ur/script/kinematics.h"

#include <Eigen/LU>
#include <cmath>

namespace seamwright::urscript {
namespace {

struct Link {
    double a_mm, d_mm, alpha;
};
constexpr double kHalf = 1.5707963267948966;
constexpr std::array<Link, 6> kLinks = {{{0, 180.7, kHalf},
                                         {-612.7, 0, 0},
                                         {-571.55, 0, 0},
                                         {0, 174.15, kHalf},
                                         {0, 119.85, -kHalf},
                                         {0, 116.55, 0}}};

Pose link_pose(const Link& link, double q) {
    const double c = std::cos(q), s = std::sin(q), ca = std::cos(link.alpha), sa = std::sin(link.alpha);
    Eigen::Matrix3d r;
    r << c, -s * ca, s * sa, s, c * ca, -c * sa, 0, sa, ca;
    return make_pose(r, {link.a_mm * c, link.a_mm * s, link.d_mm});
}

}  // namespace

Pose base_from_flange(const Joints& q) {
    Pose pose = Pose::Identity();
    for (std::size_t i = 0; i < 6; ++i) pose = pose * link_pose(kLinks[i], q[i]);
    return pose;
}

Joints joints_towards(const Pose& wanted, Joints q, int steps) {
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    constexpr double kMetre = 1e-3, kDamping = 1e-3;
    for (int step = 0; step < steps; ++step) {
        std::array<Pose, 7> chain;
        chain[0] = Pose::Identity();
        for (std::size_t i = 0; i < 6; ++i) chain[i + 1] = chain[i] * link_pose(kLinks[i], q[i]);
        const Eigen::Vector3d at = chain[6].translation();
        const Eigen::AngleAxisd turn(wanted.linear() * chain[6].linear().transpose());
        Eigen::Matrix<double, 6, 1> off;
        off << kMetre * (wanted.translation() - at), turn.angle() * turn.axis();
        if (off.norm() < 1e-10) break;
        Matrix6 jacobian;
        for (std::size_t i = 0; i < 6; ++i) {
            const Eigen::Vector3d axis = chain[i].linear().col(2);
            jacobian.col(static_cast<Eigen::Index>(i)) << kMetre * axis.cross(at - chain[i].translation()),
                axis;
        }
        const Matrix6 normal = jacobian.transpose() * jacobian +
                               kDamping * std::min(1.0, off.squaredNorm()) * Matrix6::Identity();
        const Eigen::Matrix<double, 6, 1> change = normal.partialPivLu().solve(jacobian.transpose() * off);
        const double scale = std::min(1.0, 0.3 / std::max(change.cwiseAbs().maxCoeff(), 1e-12));
        for (std::size_t i = 0; i < 6; ++i) {
            q[i] += scale * change[static_cast<Eigen::Index>(i)];
            if (!std::isfinite(q[i])) return {0, -kHalf, kHalf, 0, kHalf, 0};
            q[i] = std::remainder(q[i], 4 * kHalf);
        }
    }
    return q;
}

}  // namespace seamwright::urscript
