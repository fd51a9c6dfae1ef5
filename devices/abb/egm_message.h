#pragma once
// The two messages of ABB's Externally Guided Motion (EGM) that path correction needs: protobuf, one message
// a UDP datagram. The wire is that of ABB's egm.proto (package abb.egm; V1.0 of RobotWare 6 and V1.1 of
// RobotWare 7 agree on every field used here); devices/abb/egm.proto is our own description of it.
// Millimetres; quaternions real part first. Unknown fields are let pass. Nothing here throws.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/geometry/pose.h"

namespace seamwright {

inline constexpr std::size_t kLargestEgmMessage = 8192;

enum class EgmMci { undefined, error, stopped, running };

struct EgmState {
    std::uint32_t seqno = 0, tm_ms = 0;
    std::optional<Pose> planned, measured;  // reference_from_tcp
    bool usable = true;  // positions finite and within 1e5 mm, quaternions of norm 1 within 1e-3
    bool motors_on = false, rapid_running = false;
    EgmMci mci = EgmMci::undefined;
};
// Refused: too long, no protobuf, no header or sequence number, a message type other than DATA, an incomplete
// position or quaternion.
Expected<EgmState> parse_egm_robot(std::span<const std::byte> datagram);
// Empty if the buffer is too small.
std::span<const std::byte> write_egm_robot(std::span<std::byte> buffer, const EgmState& state);

struct EgmPathCorrection {
    std::uint32_t seqno = 0, tm_ms = 0, age_ms = 0;
    Eigen::Vector3d pos_mm = Eigen::Vector3d::Zero();
};
Expected<EgmPathCorrection> parse_egm_path_correction(std::span<const std::byte> datagram);
std::span<const std::byte> write_egm_path_correction(std::span<std::byte> buffer,
                                                     const EgmPathCorrection& value);

// Rotation of the path coordinates in the reference frame (RAPID reference manual, CorrConn): x along the
// travel, y = z of the tool x x, z = x x y. Nothing where the tool points along the travel.
std::optional<Eigen::Matrix3d> reference_from_path(const Eigen::Vector3d& travel,
                                                   const Eigen::Vector3d& tool_z);

}  // namespace seamwright
