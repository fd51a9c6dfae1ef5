// Seamwright's end of EGM path correction.

#include <array>
#include <cmath>
#include <utility>

#include "devices/abb/egm.h"
#include "devices/abb/egm_message.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {
namespace {

class EgmProtocol final : public CyclicProtocol {
  public:
    EgmProtocol(bool sensor_frame, const Pose& tcp_from_sensor, double step_mm)
        : sensor_frame_(sensor_frame), tcp_from_sensor_(tcp_from_sensor), step_mm_(step_mm) {}

    Expected<CyclicPacket> parse(std::span<const std::byte> datagram) override {
        auto s = parse_egm_robot(datagram);
        if (!s) return tl::unexpected(s.error());
        CyclicPacket p;
        p.number = s->seqno;
        tm_ms_ = s->tm_ms;
        if (!s->usable) {
            p.problem = "the robot tells a position that it cannot have";
        } else {
            p.programmed = s->planned;
            p.actual = s->measured;
        }
        p.running = s->motors_on && s->rapid_running && s->mci == EgmMci::running;
        if (s->mci == EgmMci::error)
            p.mode = RobotMode::fault;
        else if (!s->motors_on || !s->rapid_running)
            p.mode = RobotMode::stopped;
        return p;
    }

    std::span<const std::byte> answer(const CyclicPacket& packet,
                                      const CyclicCorrection& correction) override {
        if (packet.programmed && !packet.problem) follow(packet.number, *packet.programmed);
        Eigen::Vector3d told = Eigen::Vector3d::Zero();
        settled_ = true;
        if (packet.programmed && has_travel_) {
            if (const auto path = reference_from_path(travel_, packet.programmed->linear().col(2))) {
                Eigen::Vector2d wanted = (path->transpose() * correction.offset_mm).tail<2>();
                const Eigen::Vector2d step = wanted - across_;
                if (step.norm() > step_mm_) {
                    wanted = across_ + step * (step_mm_ / step.norm());
                    settled_ = false;
                }
                across_ = wanted;
                told = {0, across_.x(), across_.y()};
                if (sensor_frame_) {
                    told = (packet.programmed->linear() * tcp_from_sensor_.linear()).transpose() *
                           (*path * told);
                }
            }
        }
        return write_egm_path_correction(buffer_, {++seqno_, tm_ms_, 1, told});
    }

    void new_session() override {
        points_ = 0;
        has_travel_ = false;
        across_.setZero();
    }
    bool settled() const override { return settled_; }

  private:
    // Direction of travel at the newest of the planned points: of the parabola through three points one cycle
    // apart, else of the last two.
    void follow(std::uint64_t number, const Pose& pose) {
        const Eigen::Vector3d p = pose.translation();
        if (points_ > 0 && (p - p_[0]).norm() < 1e-3) {
            points_ = 1;  // standing: the direction stays
            number_ = number;
            p_[0] = p;
            return;
        }
        if (points_ > 0 && number != number_ + 1) points_ = 1;
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

    const bool sensor_frame_;
    const Pose tcp_from_sensor_;
    const double step_mm_;
    std::uint32_t seqno_ = 0, tm_ms_ = 0;
    std::uint64_t number_ = 0;
    int points_ = 0;
    std::array<Eigen::Vector3d, 3> p_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                      Eigen::Vector3d::Zero()};
    Eigen::Vector3d travel_ = Eigen::Vector3d::Zero();
    bool has_travel_ = false, settled_ = true;
    Eigen::Vector2d across_ = Eigen::Vector2d::Zero();
    std::array<std::byte, 256> buffer_{};
};

}  // namespace

Expected<std::unique_ptr<RobotLink>> open_abb_egm(const nlohmann::json& settings, DeviceSession& session,
                                                  OpenRobot open_robot) {
    nlohmann::json with_defaults = settings;
    if (settings.is_object() && !settings.contains("max_rotation_deg"))
        with_defaults["max_rotation_deg"] = 0.5;
    auto common = parse_cyclic_settings(with_defaults, {"frame", "tcp_from_sensor"}, "abb-egm", 6510);
    if (!common) return tl::unexpected(common.error());
    common->brand = "ABB";
    auto frame = json_string_or(settings, "frame", "path", "");
    if (!frame) return tl::unexpected(frame.error());
    if (*frame != "path" && *frame != "sensor")
        return input_error("\"" + *frame + "\" is not known", "frame", "known are path, sensor");
    Pose tcp_from_sensor = Pose::Identity();
    if (settings.contains("tcp_from_sensor")) {
        auto pose = parse_pose(settings["tcp_from_sensor"], "tcp_from_sensor");
        if (!pose) return tl::unexpected(pose.error());
        tcp_from_sensor = *pose;
    }
    const double step_mm = common->server.ramp.speed_mm_s * common->server.cycle_ms / 1e3;
    return CyclicLink::open(*common,
                            std::make_unique<EgmProtocol>(*frame == "sensor", tcp_from_sensor, step_mm),
                            open_robot, session);
}

}  // namespace seamwright
