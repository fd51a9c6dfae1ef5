#pragma once
// The simulated cell of a panel job: a gripper that carries a panel and stripe sensors, before the opening of
// a body. Frames are rendered images (renderer.h), as those of the door's cell (cell.h).
//
// Shapes. The opening is a rectangle in a level sheet, the panel a sheet that fills it but for the gap, all
// edges folded down (radius kPanelFold_mm) to a flank 8 mm deep. In zero position both lie in the plane z =
// panel_z of the gripper frame, the panel's middle on the gripper's Z axis, and body and panel are in flush.
// Each can bend (door.h) over its own box.
//
// Motion. base_from_opening is where the gripper stands in zero position. With the flange at X the panel is
// seen slipped by "panel": P (gripper frame), the body at X^-1 * base_from_opening * B.
//
// Settings: gripper_cell_settings(), all optional; the sensors and the robot of one session share the cell and
// must be given the same, but for "head", which of the heads a sensor is. The heads left out are
// default_gripper_heads().

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "devices/simulated/cell.h"

namespace seamwright {

inline constexpr double kPanelWidth_mm = 1000, kPanelHeight_mm = 700, kPanelFold_mm = 1.5, kPanelZ_mm = -300;

// A place around the panel: origin in the middle of the gap, in flush with the sheets; X from panel to body,
// Y along the edge, Z away from the sheets.
struct GripperPlace {
    std::string id;  // "P1" .. "P8", two a side
    Pose gripper_from_place = Pose::Identity();
};
std::vector<GripperPlace> default_gripper_places();
// One sensor a place, "H1" .. "H8", at its place; at P1 and P5 a double head, "H1" and "H1b", tilted towards
// each other about the place's Y.
std::map<std::string, Pose> default_gripper_heads();

struct GripperCellSettings {
    CellSettings common;  // seed, optics, surface, noise, exposure, buffers, robot, serial
    std::map<std::string, Pose> heads = default_gripper_heads();
    Pose base_from_opening = Pose::Identity();
    double gap_mm = 4;
    PartState panel, body;
};
const SettingTable& gripper_cell_settings();
Expected<GripperCellSettings> parse_gripper_settings(const nlohmann::json& settings);

// Thread-safe.
class GripperCell {
  public:
    explicit GripperCell(const GripperCellSettings& settings);
    static Expected<std::shared_ptr<GripperCell>> open(const nlohmann::json& settings);

    const GripperCellSettings& settings() const { return settings_; }
    const SensorModel& sensor_model() const { return renderer_.model(); }
    // How far the panel stands off its zero relation to the body with the flange at `base_from_flange`:
    // body_from_panel, seen from the gripper. The identity when it fits.
    Pose relation(const Pose& base_from_flange) const;
    // The next panel and body.
    void set_parts(const PartState& panel, const PartState& body);

    void render(const std::string& head, const Pose& base_from_flange, std::uint64_t number, Frame& frame);

    // Robot, as of SimulatedCell.
    void move_to(const Pose& base_from_flange);
    std::optional<Pose> reported_flange() const;
    std::optional<Pose> true_flange() const;
    void start_moves(std::vector<MeasuringMove> moves);
    std::optional<TriggerEvent> next_trigger();
    RobotMode mode() const;
    void set_mode(RobotMode mode);
    Expected<Pose> read_frame(const std::string& name) const;
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame);

    // Sensors: a trigger exposes one head where the gripper stands.
    struct Exposed {
        std::string spot_id;
        Pose base_from_flange = Pose::Identity();
        std::uint64_t number = 0;  // over all heads
    };
    Expected<Exposed> expose(const std::string& spot_id);
    double exposure_us() const;
    void set_exposure_us(double value);

  private:
    Pose arrived(const Pose& commanded);  // precondition: locked

    const GripperCellSettings settings_;
    const TriangleMesh panel_mesh_, body_mesh_;  // zero position, gripper frame
    mutable std::mutex mutex_;
    std::mutex render_mutex_;  // renderer and tree; taken before mutex_
    StripeRenderer renderer_;
    MeshTree tree_;  // body, then panel
    PartState panel_, body_;
    Exposure exposure_;
    std::optional<Pose> commanded_, true_;
    std::deque<MeasuringMove> moves_;
    std::map<std::string, Pose> frames_;
    RobotMode mode_;
    std::uint64_t exposures_ = 0, arrivals_ = 0;
};

std::unique_ptr<ProfileSource> make_gripper_sensor(std::shared_ptr<GripperCell> cell,
                                                   const std::string& head);
std::unique_ptr<RobotLink> make_gripper_robot(std::shared_ptr<GripperCell> cell);
// The cell that the drivers of a session share.
Expected<std::shared_ptr<GripperCell>> shared_gripper_cell(const nlohmann::json& settings,
                                                           DeviceSession& session);
Expected<std::unique_ptr<ProfileSource>> open_gripper_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session);
Expected<std::unique_ptr<RobotLink>> open_gripper_robot(const nlohmann::json& settings,
                                                        DeviceSession& session);

}  // namespace seamwright
