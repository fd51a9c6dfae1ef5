#include "devices/abb/egm_protocol.h"

#include <algorithm>
#include <array>

#include "devices/abb/egm_message.h"

namespace seamwright {
namespace {

constexpr double kStandsMm = 1e-3;            // between two packets
constexpr std::uint64_t kForgetsTravel = 25;  // packets

class EgmProtocol final : public CyclicProtocol {
  public:
    explicit EgmProtocol(const EgmOptions& options) : options_(options) {}

    Expected<CyclicPacket> parse(std::span<const std::byte> datagram) override {
        SEAM_TRY(auto s, parse_egm_robot(datagram));
        CyclicPacket p;
        p.number = s.seqno;
        p.number_wrap = std::uint64_t{1} << 32;
        p.time_ms = s.tm_ms;
        p.missing = !s.planned    ? "planned Cartesian pose (EGM for joints alone cannot correct a path)"
                    : !s.measured ? "measured Cartesian pose (feedBack)"
                                  : nullptr;
        if (!s.usable) {
            p.problem = "the robot tells a position that it cannot have";
            p.missing = nullptr;
        } else {
            p.programmed = s.planned;
            p.actual = s.measured;
        }
        p.running = s.motors_on && s.rapid_running && s.mci == EgmMci::running;
        p.ended = s.motors_on && s.rapid_running && s.mci == EgmMci::stopped;
        if (s.mci == EgmMci::error)
            p.mode = RobotMode::fault;
        else if (!s.motors_on || !s.rapid_running)
            p.mode = RobotMode::stopped;
        return p;
    }

    void follow(const CyclicPacket& packet) override {
        if (packet.programmed && !packet.problem) follow_path(packet.number, *packet.programmed);
    }

    std::optional<CyclicTold> tell(const CyclicPacket& packet, const CyclicCorrection& c) override {
        const auto path = path_at(packet);
        if (!path) return std::nullopt;
        return CyclicTold{across(packet, *path, c.offset_mm), Eigen::Vector3d::Zero()};
    }

    CyclicCorrection correction_of(const CyclicPacket& packet, const CyclicTold& told) override {
        const auto path = path_at(packet);
        if (!path) return {};
        return {options_.sensor_frame ? Eigen::Vector3d(reference_from_sensor(packet) * told.mm)
                                      : Eigen::Vector3d(*path * told.mm),
                Eigen::Vector3d::Zero()};
    }

    std::optional<CyclicTold> shown(const CyclicPacket& packet) override {
        if (!packet.programmed || !packet.actual) return std::nullopt;
        const auto path = path_at(packet);
        if (!path) {
            // Where the robot is as planned it is not shifted, whatever way the path goes.
            const double off = (packet.actual->translation() - packet.programmed->translation()).norm();
            return off < kStandsMm ? std::optional<CyclicTold>(CyclicTold{}) : std::nullopt;
        }
        return CyclicTold{
            across(packet, *path, packet.actual->translation() - packet.programmed->translation()),
            Eigen::Vector3d::Zero()};
    }

    // What lies across the path of a lag is seen on a curve.
    CyclicTold motion_shown(const CyclicPacket& packet, const CyclicTold& motion) override {
        const auto path = path_at(packet);
        if (!path) return {};
        return {across(packet, *path, motion.mm), Eigen::Vector3d::Zero()};
    }

    std::span<const std::byte> answer(const CyclicPacket& packet, const CyclicTold& told, const CyclicTold&,
                                      bool) override {
        return write_egm_path_correction(buffer_, {++seqno_, packet.time_ms, 1, told.mm});
    }

    void new_session() override { points_ = std::min(points_, 1); }
    int unproven() const override { return 3; }
    bool stops_unanswered() const override { return true; }
    bool shifts_along() const override { return false; }
    const char* why_not_told() const override {
        return has_travel_ ? nullptr : "the robot stands, and EGM corrects only a path that moves";
    }

  private:
    std::optional<Eigen::Matrix3d> path_at(const CyclicPacket& packet) const {
        if (!has_travel_ || !packet.programmed) return std::nullopt;
        return reference_from_path(travel_, packet.programmed->linear().col(2));
    }

    Eigen::Matrix3d reference_from_sensor(const CyclicPacket& packet) const {
        return packet.programmed->linear() * options_.tcp_from_sensor.linear();
    }

    // The part of an offset (reference frame) that a path correction can make, as it is told.
    Eigen::Vector3d across(const CyclicPacket& packet, const Eigen::Matrix3d& path,
                           const Eigen::Vector3d& offset) const {
        Eigen::Vector3d part = path.transpose() * offset;
        part.x() = 0;
        if (options_.sensor_frame) return reference_from_sensor(packet).transpose() * (path * part);
        return part;
    }

    // Direction of travel at the newest of the planned points: of the parabola through three points one cycle
    // apart, else of the last two.
    void follow_path(std::uint64_t number, const Pose& pose) {
        const Eigen::Vector3d p = pose.translation();
        if (points_ > 0 && (p - p_[0]).norm() < kStandsMm) {
            points_ = 1;  // standing: the direction stays
            number_ = number;
            p_[0] = p;
            return;
        }
        if (points_ > 0 && number != number_ + 1) {
            points_ = 1;
            // On a curve the direction of long ago is none.
            has_travel_ = has_travel_ && number - number_ <= kForgetsTravel;
            if (!has_travel_) points_ = 0;
        }
        p_[2] = p_[1];
        p_[1] = p_[0];
        p_[0] = p;
        points_ = std::min(points_ + 1, 3);
        number_ = number;
        if (points_ < 2) return;
        travel_ = p_[0] - p_[1];
        has_travel_ = true;
        if (points_ == 3) {
            const Eigen::Vector3d a = p_[0] - p_[1], b = p_[1] - p_[2];
            // At a corner the parabola would overshoot.
            if (a.dot(b) > 0.99 * a.norm() * b.norm()) travel_ = 1.5 * a - 0.5 * b;
        }
    }

    const EgmOptions options_;
    std::uint32_t seqno_ = 0;
    std::uint64_t number_ = 0;
    int points_ = 0;
    std::array<Eigen::Vector3d, 3> p_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                      Eigen::Vector3d::Zero()};
    Eigen::Vector3d travel_ = Eigen::Vector3d::Zero();
    bool has_travel_ = false;
    std::array<std::byte, 256> buffer_{};
};

}  // namespace

std::unique_ptr<CyclicProtocol> make_egm_protocol(const EgmOptions& options) {
    return std::make_unique<EgmProtocol>(options);
}

}  // namespace seamwright
