#include "core/geometry/euler.h"

#include <cmath>

namespace seamwright {
namespace {

// Below this cosine (sine where the first axis comes again) the two outer axes are parallel to within rounding
// and only their sum is known.
constexpr double kLock = 1e-9;

constexpr std::string_view kOrders[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx",
                                        "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};

struct Axes {
    int i, j, k;    // of the intrinsic turns; k the third axis, also where i comes again
    bool repeated;  // i-j-i
    double parity;  // +1: i, j, k is cyclic
};

Axes axes_of(const EulerConvention& convention) {
    const std::string_view name = name_of(convention.order);
    const bool extrinsic = convention.turns == EulerTurns::extrinsic;
    const int first = name[extrinsic ? 2 : 0] - 'x', second = name[1] - 'x';
    const int third = 3 - first - second;
    return {first, second, third, name[0] == name[2], (first + 1) % 3 == second ? 1.0 : -1.0};
}

Eigen::Matrix3d turn(int axis, double rad) {
    return Eigen::AngleAxisd(rad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

}  // namespace

std::array<EulerConvention, 24> euler_conventions() {
    std::array<EulerConvention, 24> all;
    for (std::size_t n = 0; n < all.size(); ++n)
        all[n] = {static_cast<EulerOrder>(n % 12), n < 12 ? EulerTurns::intrinsic : EulerTurns::extrinsic};
    return all;
}

std::string_view name_of(EulerOrder order) {
    return kOrders[static_cast<std::size_t>(order)];
}
std::string_view name_of(EulerTurns turns) {
    return turns == EulerTurns::intrinsic ? "intrinsic" : "extrinsic";
}
std::optional<EulerOrder> euler_order_named(std::string_view name) {
    for (std::size_t n = 0; n < std::size(kOrders); ++n)
        if (kOrders[n] == name) return static_cast<EulerOrder>(n);
    return std::nullopt;
}

Eigen::Matrix3d rotation_from_euler(const EulerConvention& convention, const Eigen::Vector3d& angles_rad) {
    const Axes x = axes_of(convention);
    const bool extrinsic = convention.turns == EulerTurns::extrinsic;
    return turn(x.i, angles_rad[extrinsic ? 2 : 0]) * turn(x.j, angles_rad[1]) *
           turn(x.repeated ? x.i : x.k, angles_rad[extrinsic ? 0 : 2]);
}

Eigen::Vector3d euler_from_rotation(const EulerConvention& convention, const Eigen::Matrix3d& r) {
    const auto [i, j, k, repeated, e] = axes_of(convention);
    Eigen::Vector3d angles;  // of the intrinsic turns
    if (repeated) {
        const double sin_b = std::hypot(r(j, i), r(k, i));
        angles[1] = std::atan2(sin_b, r(i, i));
        // At 0 or 180 degrees column j is (cos a, e sin a) in the axes j and k.
        if (sin_b < kLock)
            angles[0] = std::atan2(e * r(k, j), r(j, j)), angles[2] = 0;
        else
            angles[0] = std::atan2(r(j, i), -e * r(k, i)), angles[2] = std::atan2(r(i, j), e * r(i, k));
    } else {
        const double cos_b = std::hypot(r(k, k), r(j, k));
        angles[1] = std::atan2(e * r(i, k), cos_b);
        if (cos_b < kLock)
            angles[0] = std::atan2(e * r(k, j), r(j, j)), angles[2] = 0;
        else
            angles[0] = std::atan2(-e * r(j, k), r(k, k)), angles[2] = std::atan2(-e * r(i, j), r(i, i));
    }
    return convention.turns == EulerTurns::extrinsic ? Eigen::Vector3d(angles.reverse()) : angles;
}

}  // namespace seamwright
