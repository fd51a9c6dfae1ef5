#pragma once
// A RobotLink that corrects the running path instead of a frame on the controller.
//
// The application's path is taught in a frame base_from_frame. write_frame() stages the frame of the
// displaced part; the displacement of the path in base is B = written * taught^-1, and confirm(corrected)
// ramps it onto the path. The controller holds one displacement at a time: frames that are staged must agree
// on B. Until confirm(corrected) nothing is sent but zero; start_measuring() and every other verdict ramp
// back to zero and return when it is reached.
//
// Settings: cyclic_settings(), and the driver's own. Others than the first peer are refused and told until it is
// silent.
//
// identity, mode, start signal, measuring, triggers and moves are those of the measuring link. Without one
// the identity is the brand's alone, the mode what the cyclic packets tell, and measuring is refused.
//
// Limits are checked twice: when a frame is written (rotation of B, and its offset at the origin of the
// taught frame), and in every cycle at the programmed position. Alarms of corrector.h are told, once, by the
// next call whatever it is; the correction is being withdrawn by then.
//
// confirm(corrected) waits for a robot that is on its way from measuring to its path (at most confirm_timeout_ms), and
// returns when the robot has shown the whole correction. permission() is then `given`
// until its path moves, `running` while it does, which needs this link in every cycle, and `taken` when the
// path has come to its end. While it runs, who steers adds an offset (steer(), steering.h). After a new session the identity is asked again, of the measuring link and by the
// peer's address, before anything is written or confirmed.

#include <initializer_list>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include "devices/cyclic/server.h"
#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/robot_link.h"

namespace seamwright {

// How a link opens its measuring link: open_robot() of registry.h, which lies above this library.
using OpenRobot = Expected<std::unique_ptr<RobotLink>> (*)(const std::string& driver,
                                                           const nlohmann::json& settings,
                                                           DeviceSession& session);

struct CyclicLinkSettings {
    CyclicSettings server;
    std::string driver, brand;
    int timeout_ms = 1000, confirm_timeout_ms = 20000;
    std::map<std::string, Pose> taught;  // base_from_frame
    Pose base_from_reference = Pose::Identity(), flange_from_tcp = Pose::Identity();
    bool shifts_along = true;  // as the protocol says
    std::string measuring_driver;
    nlohmann::json measuring = nlohmann::json::object();
};
// Of both drivers, with what differs between them.
SettingTable cyclic_settings(std::uint16_t port, double max_rotation_deg);
// `table`: the whole driver's.
Expected<CyclicLinkSettings> parse_cyclic_settings(const nlohmann::json& settings, const SettingTable& table,
                                                   const std::string& driver);

class CyclicLink : public RobotLink, public SteeredLink {
  public:
    static Expected<std::unique_ptr<CyclicLink>> open(const CyclicLinkSettings& settings,
                                                      std::unique_ptr<CyclicProtocol> protocol,
                                                      OpenRobot open_robot, DeviceSession& session);
    ~CyclicLink() override;
    Expected<RobotIdentity> identity() override;
    Expected<RobotMode> mode() override;
    // The cyclic packets of some robots do not tell it.
    bool tells_mode() const override { return measuring_ && measuring_->tells_mode(); }
    bool permission_outlives_link() const override { return false; }
    Expected<Pose> base_from_flange() override;
    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override;
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override;
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override;
    Expected<Pose> read_frame(const std::string& name) override;
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override;
    Expected<void> confirm(PartVerdict verdict, const std::string& text) override;
    Expected<Permission> permission() override;
    bool can_move() const override { return measuring_ && measuring_->can_move(); }
    Expected<void> move_to(const Pose& base_from_flange) override;
    std::vector<Text> take_notices() override;
    void steer(std::shared_ptr<PathSteering> steering) override { server_->steer(std::move(steering)); }
    PathPhase path_phase() const override { return server_->state().path; }
    const Pose& base_from_reference() const override { return settings_.base_from_reference; }
    const Pose& flange_from_tcp() const override { return settings_.flange_from_tcp; }
    double cycle_s() const override { return settings_.server.cycle_ms / 1e3; }
    bool shifts_along() const override { return settings_.shifts_along; }

    const CyclicServer& server() const { return *server_; }

  private:
    CyclicLink(const CyclicLinkSettings& settings, std::unique_ptr<CyclicServer> server,
               std::unique_ptr<RobotLink> measuring);
    Expected<void> no_alarm();
    Expected<CyclicServer::State> fresh_state();
    Expected<CyclicServer::State> on_path(std::chrono::steady_clock::time_point until);
    Expected<void> apply();
    Expected<void> back_to_zero();
    Expected<void> same_robot();

    const CyclicLinkSettings settings_;
    std::unique_ptr<CyclicServer> server_;
    std::unique_ptr<RobotLink> measuring_;  // may be null
    std::map<std::string, Pose> written_;
    std::set<std::string>
        of_part_;  // written since a part was last decided on: another type's frames say nothing of this one
    bool decided_ = false;
    struct Identified {
        RobotIdentity identity;
        std::string address;
        std::uint64_t session = 0;
    };
    std::optional<Identified> identified_;  // what identity() answered last
    std::uint64_t strangers_told_ = 0;
};

}  // namespace seamwright
