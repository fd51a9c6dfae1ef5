#include "devices/kuka/rsi_protocol.h"

#include <cmath>
#include <utility>

#include "core/geometry/notation.h"
#include "devices/kuka/rsi_telegram.h"

namespace seamwright {
namespace {

Pose pose_of(const RsiFrame& f) {
    return make_pose(rotation_from_kuka({f.xyzabc[3], f.xyzabc[4], f.xyzabc[5]}),
                     {f.xyzabc[0], f.xyzabc[1], f.xyzabc[2]});
}

class RsiProtocol final : public CyclicProtocol {
  public:
    RsiProtocol(RsiOptions options, int cycle_ms)
        : options_(std::move(options)),
          cycle_ms_(static_cast<std::uint64_t>(cycle_ms)),
          unit_(std::pow(10.0, options_.decimals)) {}

    Expected<CyclicPacket> parse(std::span<const std::byte> datagram) override {
        SEAM_TRY(auto rob, parse_rsi_rob(datagram));
        CyclicPacket p;
        p.number = rob.ipoc;
        p.number_text = rob.ipoc_text;
        p.numbers_per_cycle = cycle_ms_;
        p.late = rob.delay;
        p.on_path = rob.on_path;
        p.missing = !rob.rist    ? "RIst (DEF_RIst in the ETHERNET configuration)"
                    : !rob.rsol  ? "RSol (DEF_RSol in the ETHERNET configuration)"
                    : !rob.delay ? "Delay (DEF_Delay in the ETHERNET configuration)"
                                 : nullptr;
        if ((rob.rist && !rob.rist->usable) || (rob.rsol && !rob.rsol->usable)) {
            p.problem = "the robot tells a position that it cannot have";
        } else {
            if (rob.rist) p.actual = pose_of(*rob.rist);
            if (rob.rsol) p.programmed = pose_of(*rob.rsol);
        }
        return p;
    }

    std::optional<CyclicTold> tell(const CyclicPacket& packet, const CyclicCorrection& c) override {
        return in_told_frame(packet, {c.offset_mm, c.turn_rad});
    }

    CyclicCorrection correction_of(const CyclicPacket& packet, const CyclicTold& told) override {
        if (!options_.tool || !packet.programmed) return {told.mm, told.turn_rad};
        const Eigen::Matrix3d& r = packet.programmed->linear();
        return {r * told.mm, r * told.turn_rad};
    }

    std::optional<CyclicTold> shown(const CyclicPacket& packet) override {
        if (!packet.programmed || !packet.actual) return std::nullopt;
        return in_told_frame(
            packet, {packet.actual->translation() - packet.programmed->translation(),
                     rotation_log(packet.actual->linear() * packet.programmed->linear().transpose())});
    }

    CyclicTold motion_shown(const CyclicPacket& packet, const CyclicTold& motion) override {
        return in_told_frame(packet, motion);
    }

    std::span<const std::byte> answer(const CyclicPacket& packet, const CyclicTold& told,
                                      const CyclicTold& held, bool released) override {
        const std::array<double, 6> whole = units(told);
        const std::array<double, 6> has = options_.relative ? units(held) : std::array<double, 6>{};
        std::array<double, 6> rkorr{};
        // In whole units of the last decimal: sums of those are exact. Adding 0 makes no "-0.000".
        for (std::size_t k = 0; k < 6; ++k) rkorr[k] = (whole[k] - has[k]) / unit_ + 0.0;
        const std::string_view text = write_rsi_sen(buffer_, options_.sen_type, rkorr, options_.decimals,
                                                    packet.number_text.data(), released);
        return std::as_bytes(std::span(text.data(), text.size()));
    }

    bool incremental() const override { return options_.relative; }

  private:
    CyclicTold in_told_frame(const CyclicPacket& packet, const CyclicTold& t) const {
        if (!options_.tool || !packet.programmed) return t;
        const Eigen::Matrix3d tool_from_reference = packet.programmed->linear().transpose();
        return {tool_from_reference * t.mm, tool_from_reference * t.turn_rad};
    }

    std::array<double, 6> units(const CyclicTold& t) const {
        const KukaAbc abc = kuka_from_rotation(rotation_exp(t.turn_rad));
        std::array<double, 6> whole = {t.mm.x(), t.mm.y(), t.mm.z(), abc.a_deg, abc.b_deg, abc.c_deg};
        for (double& x : whole) x = std::round(x * unit_);
        return whole;
    }

    const RsiOptions options_;
    const std::uint64_t cycle_ms_;
    const double unit_;
    std::array<char, 512> buffer_{};
};

}  // namespace

std::unique_ptr<CyclicProtocol> make_rsi_protocol(const RsiOptions& options, int cycle_ms) {
    return std::make_unique<RsiProtocol>(options, cycle_ms);
}

}  // namespace seamwright
