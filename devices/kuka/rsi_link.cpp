// Seamwright's end of RSI.

#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "devices/kuka/rsi.h"
#include "devices/kuka/rsi_telegram.h"

namespace seamwright {
namespace {

struct RsiOptions {
    bool relative = false, tool = false;
    std::string sen_type = "ImFree";
    int decimals = 7;
};

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
        auto rob = parse_rsi_rob(datagram);
        if (!rob) return tl::unexpected(rob.error());
        CyclicPacket p;
        p.number = rob->ipoc;
        p.numbers_per_cycle = cycle_ms_;
        p.late = rob->delay.value_or(0);
        if ((rob->rist && !rob->rist->usable) || (rob->rsol && !rob->rsol->usable)) {
            p.problem = "the robot tells a position that it cannot have";
        } else {
            if (rob->rist) p.actual = pose_of(*rob->rist);
            if (rob->rsol) p.programmed = pose_of(*rob->rsol);
        }
        ipoc_ = rob->ipoc_text;
        return p;
    }

    std::span<const std::byte> answer(const CyclicPacket& packet,
                                      const CyclicCorrection& correction) override {
        Eigen::Vector3d offset = correction.offset_mm, turn = correction.turn_rad;
        if (options_.tool && packet.programmed) {
            const Eigen::Matrix3d tool_from_reference = packet.programmed->linear().transpose();
            offset = tool_from_reference * offset;
            turn = tool_from_reference * turn;
        }
        const KukaAbc abc = kuka_from_rotation(rotation_exp(turn));
        const std::array<double, 6> whole = {offset.x(), offset.y(), offset.z(),
                                             abc.a_deg,  abc.b_deg,  abc.c_deg};
        std::array<double, 6> told{};
        for (std::size_t k = 0; k < 6; ++k) {
            // In whole units of the last decimal: sums of those are exact.
            const double rounded = std::round(whole[k] * unit_);
            told[k] = (options_.relative ? rounded - sent_[k] : rounded) / unit_ + 0.0;
            sent_[k] = rounded;
        }
        const std::string_view text =
            write_rsi_sen(buffer_, options_.sen_type, told, options_.decimals, ipoc_.data());
        return std::as_bytes(std::span(text.data(), text.size()));
    }

    void new_session() override { sent_ = {}; }
    bool incremental() const override { return options_.relative; }

  private:
    const RsiOptions options_;
    const std::uint64_t cycle_ms_;
    const double unit_;
    std::array<char, 21> ipoc_{};
    std::array<double, 6> sent_{};  // in units of the last decimal
    std::array<char, 512> buffer_{};
};

Expected<std::string> one_of(const nlohmann::json& settings, const char* key,
                             std::initializer_list<const char*> known) {
    auto value = json_string_or(settings, key, *known.begin(), "");
    if (!value) return value;
    std::string all;
    for (const char* name : known) {
        if (*value == name) return value;
        all += (all.empty() ? "" : ", ") + std::string(name);
    }
    return input_error("\"" + *value + "\" is not known", key, "known are " + all);
}

}  // namespace

Expected<std::unique_ptr<RobotLink>> open_kuka_rsi(const nlohmann::json& settings, DeviceSession& session,
                                                   OpenRobot open_robot) {
    auto common =
        parse_cyclic_settings(settings, {"mode", "reference", "sen_type", "decimals"}, "kuka-rsi", 49152);
    if (!common) return tl::unexpected(common.error());
    common->brand = "KUKA";
    RsiOptions options;
    auto mode = one_of(settings, "mode", {"absolute", "relative"});
    if (!mode) return tl::unexpected(mode.error());
    options.relative = *mode == "relative";
    auto reference = one_of(settings, "reference", {"base", "tool"});
    if (!reference) return tl::unexpected(reference.error());
    options.tool = *reference == "tool";
    if (options.relative && options.tool)
        return input_error("relative corrections in the tool do not add up", "reference",
                           "use base, or absolute");
    auto type = json_string_or(settings, "sen_type", options.sen_type, "");
    if (!type) return tl::unexpected(type.error());
    if (type->empty() || type->size() > 64 || type->find_first_of("<>&\"'") != std::string::npos)
        return input_error("not a name that XML can hold", "sen_type");
    options.sen_type = *type;
    auto decimals = json_number_or(settings, "decimals", options.decimals, "");
    if (!decimals) return tl::unexpected(decimals.error());
    if (!(*decimals >= 1 && *decimals <= 9 && *decimals == std::floor(*decimals)))
        return input_error("not a whole number from 1 to 9", "decimals");
    options.decimals = static_cast<int>(*decimals);
    return CyclicLink::open(*common, std::make_unique<RsiProtocol>(options, common->server.cycle_ms),
                            open_robot, session);
}

}  // namespace seamwright
