#pragma once
// What a cyclic protocol (RSI, EGM) is to the corrector: packets in, corrections out, in its own coordinates.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/error.h"
#include "core/geometry/pose.h"
#include "devices/cyclic/ramp.h"
#include "devices/robot_link.h"

namespace seamwright {

struct CyclicPacket {
    std::uint64_t number = 0;             // IPOC, seqno
    std::array<char, 21> number_text{};   // as it came, where it goes back so; ends with 0
    std::uint64_t numbers_per_cycle = 1;  // IPOC counts milliseconds
    std::uint32_t time_ms = 0;            // of the controller's clock, where it goes back
    std::uint64_t number_wrap = 0;        // numbers begin anew at zero after this many; 0 = never
    // Answers that the robot counted as late: in a row until now (a run length, which falls to zero with the
    // first one in time), or all since its start. Nothing: it does not tell.
    std::optional<std::uint64_t> late;
    std::optional<Pose> programmed, actual;  // reference_from_tcp, mm
    const char* problem = nullptr;  // numbers that cannot be meant: it is answered, but measures nothing
    const char* missing = nullptr;  // without this element nothing can be corrected, or not be confirmed
    bool running = true;            // the controller takes corrections (EGM: states)
    bool ended = false;             // not running, because its program has ended the correction
    std::optional<bool> on_path;    // the application's path is under way, as its program tells
    RobotMode mode = RobotMode::unknown;
};

// A correction as the protocol tells it: RSI the six numbers of RKorr as shift and rotation vector, EGM the
// shift across the path.
struct CyclicTold {
    Eigen::Vector3d mm = Eigen::Vector3d::Zero(), turn_rad = Eigen::Vector3d::Zero();
    bool is_zero() const { return mm.isZero(0) && turn_rad.isZero(0); }
};

// One protocol. Called from one thread only; the answer lives until the next call.
class CyclicProtocol {
  public:
    virtual ~CyclicProtocol() = default;
    virtual Expected<CyclicPacket> parse(std::span<const std::byte> datagram) = 0;
    // Each packet that is not an old one, in order, before anything is asked of it.
    virtual void follow(const CyclicPacket&) {}
    // How the protocol tells that correction at packet.programmed. Nothing where it cannot be told there.
    virtual std::optional<CyclicTold> tell(const CyclicPacket& packet,
                                           const CyclicCorrection& correction) = 0;
    // The other way round, for a correction that the robot was found with.
    virtual CyclicCorrection correction_of(const CyclicPacket& packet, const CyclicTold& told) = 0;
    // What the robot shows of its correction: actual against programmed. Nothing where that cannot be known.
    virtual std::optional<CyclicTold> shown(const CyclicPacket& packet) = 0;
    // A way of the path (mm, rad, in the reference frame) in the coordinates of `shown`, where the actual
    // pose lags behind by it; zero where lag does not show.
    virtual CyclicTold motion_shown(const CyclicPacket& packet, const CyclicTold& motion) = 0;
    // The answer to that packet: the whole correction, or its difference to `held`, which the robot has.
    // `released`: the correction is confirmed, the application may run its path.
    virtual std::span<const std::byte> answer(const CyclicPacket& packet, const CyclicTold& told,
                                              const CyclicTold& held, bool released) = 0;
    virtual void new_session() {}
    // Differences are told: the robot adds them up.
    virtual bool incremental() const { return false; }
    // So many answers may be lost in a row without the robot telling. Each step is so much smaller that all
    // of them together stay within the limit of one cycle.
    virtual int unproven() const { return 0; }
    // `released` cannot be told. A robot that has to stop is not answered any more: its program notices by its
    // own time-out, and keeps what it has until it stands.
    virtual bool stops_unanswered() const { return false; }
    // A shift along the travel is made too. Where it is not, the tool is behind or before the moved place by that much.
    virtual bool shifts_along() const { return true; }
    virtual const char* why_not_told() const { return nullptr; }  // when tell() answers nothing
};

struct CyclicSettings {
    std::string listen = "127.0.0.1";
    std::uint16_t port = 0;
    std::string robot_address;  // empty: who comes first, until it is silent; not unless `listen` is loopback
    int cycle_ms = 4;
    RampLimits ramp;
    double max_translation_mm = 10, max_rotation_deg = 2;
    int max_late = 10;
    int session_gap_ms = 500;
    double max_path_speed_mm_s = 3000;
    double follow_tolerance_mm = 0.2, follow_tolerance_deg = 0.1;
    int follow_ms = 500;
};

}  // namespace seamwright
