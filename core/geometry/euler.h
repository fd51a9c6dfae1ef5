#pragma once
// Three angles as a rotation, in each of the 24 ways that are in use: twelve orders of axes, each about the
// turned (intrinsic) or about the fixed (extrinsic) axes. The angles stand in the order in which they turn.
//     intrinsic i-j'-k''   R = R_i(a) R_j(b) R_k(c)
//     extrinsic i-j-k      R = R_k(c) R_j(b) R_i(a)
// The brands' own notations (notation.h) are three of them: KUKA zyx intrinsic, FANUC xyz extrinsic, zyz
// intrinsic.

#include <array>
#include <optional>
#include <string_view>

#include "core/geometry/pose.h"

namespace seamwright {

enum class EulerOrder { xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz };
enum class EulerTurns { intrinsic, extrinsic };

struct EulerConvention {
    EulerOrder order = EulerOrder::zyx;
    EulerTurns turns = EulerTurns::intrinsic;
    bool operator==(const EulerConvention&) const = default;
};
std::array<EulerConvention, 24> euler_conventions();
std::string_view name_of(EulerOrder order);  // "zyx"
std::string_view name_of(EulerTurns turns);  // "intrinsic"
std::optional<EulerOrder> euler_order_named(std::string_view name);

Eigen::Matrix3d rotation_from_euler(const EulerConvention& convention, const Eigen::Vector3d& angles_rad);
// Inverse to rounding. Three different axes: the middle angle in [-90, 90] degrees; the first axis again at the
// end: in [0, 180]. At gimbal lock (its end) the rotation is kept, the outer of the two turns about one axis
// takes the whole of it and the other is 0.
Eigen::Vector3d euler_from_rotation(const EulerConvention& convention, const Eigen::Matrix3d& rotation);

}  // namespace seamwright
