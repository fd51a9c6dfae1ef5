#pragma once
// The simulated cell: a part, a laser-stripe sensor on a robot's flange, and what makes them imperfect.
// Frames are rendered images (renderer.h) and measured by the same code as real ones; nothing takes a profile
// from the mesh.
//
// Settings: simulated_cell_settings(), all optional. Sensor and robot of one session share the cell and must be
// given the same.

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/random.h"
#include "devices/simulated/scene/renderer.h"

namespace seamwright {

enum class Scene { part, sphere, plate, triangle };
std::string_view to_string(Scene scene);
std::optional<Scene> scene_from_string(std::string_view text);

struct PartState {
    Pose workobject_from_movedworkobject = Pose::Identity();  // D of methods.md 3
    PartBend bend;
};

struct RobotSettings {
    double repeatability_mm = 0.03, repeatability_deg = 0.002, trigger_jitter_mm = 1.5;
    double trigger_latency_ms = 0;  // from the instant that the controller tells to the exposure
    RobotMode mode = RobotMode::automatic;
    std::map<std::string, Pose> frames;  // base_from_frame by name
};

// What goes wrong with the cell by and by, and at once. A time constant in parts counts measuring programs, one in seconds the
// time since the first part that drifts; with both 0 nothing drifts.
struct CellDrift {
    Pose sensor = Pose::Identity();  // sensor_from_drifted, when all of it has come
    Pose robot = Pose::Identity();   // base_from_drifted: where the robot stands instead
    double time_constant_parts = 0, time_constant_s = 0;
    std::uint64_t from_part = 0;     // parts before it see nothing of the drift
    Pose bump = Pose::Identity();    // sensor_from_bumped
    std::uint64_t bump_at_part = 0;  // from this part on; 0: never
    double bump_at_s = 0;            // or so long after the first part; 0: never
};

struct CellSettings {
    std::uint64_t seed = 1;
    Scene scene = Scene::part;
    std::string mesh, mesh_unit;
    Pose base_from_workobject = Pose::Identity(), base_from_target = Pose::Identity(),
         flange_from_sensor = Pose::Identity();
    PartState part;
    OpticsSettings optics;
    SurfaceSettings surface;
    NoiseSettings noise;
    Exposure exposure;  // seed unused
    double damaged_probability = 0;
    int buffers = 8;
    RobotSettings robot;
    double sphere_radius_mm = 25;
    PlatePattern board{7, 6, 10, 0.1};
    std::string serial = "SIM-1";
    CellDrift drift;
};
CellSettings default_cell_settings();
// Refuses unknown fields, wrong types and values out of range, with the field's path.
const SettingTable& simulated_cell_settings();
Expected<CellSettings> parse_cell_settings(const nlohmann::json& settings);

// The settings' "part" alone: {"displacement": POSE, "bend_mm", "twist_mm"}.
Expected<PartState> parse_part_state(const nlohmann::json& part);

// Thread-safe. Poses are base_from_flange unless named otherwise.
class SimulatedCell {
  public:
    static Expected<std::shared_ptr<SimulatedCell>> open(const CellSettings& settings);
    static Expected<std::shared_ptr<SimulatedCell>> open(const nlohmann::json& settings);

    // The truth, for tests, for a project that starts calibrated, and for judging corrections.
    const CellSettings& settings() const { return settings_; }
    const SensorModel& sensor_model() const { return renderer_.model(); }
    const Pose& flange_from_sensor() const { return settings_.flange_from_sensor; }
    const Pose& base_from_workobject() const { return settings_.base_from_workobject; }
    const TriangleMesh& part_mesh() const { return undisplaced_; }  // neither bent nor displaced, work object
    PartState part() const;
    Eigen::Vector3d displaced(
        const Eigen::Vector3d& point_workobject_mm) const;  // bent, then moved by D; work object
    // Where the flange must stand for the sensor to stand at workobject_from_sensor of the undisplaced part.
    Pose flange_for(const Pose& workobject_from_sensor) const;
    nlohmann::json describe() const;  // noise, jitter, repeatability, seed, part: for reports

    // The next part in the fixture; the scene before the sensor.
    void set_part(const PartState& part);
    // Parts that the robot has begun, from 1.
    std::uint64_t parts() const;
    // What drift and bump have made of the sensor and the robot by now.
    Pose sensor_from_drifted() const;
    Pose base_from_drifted() const;
    // Somebody puts the sensor back: the bump is gone.
    void mend_bump();
    void set_scene(Scene scene);

    // Renders what the sensor sees with the flange exactly there. `frame.pixels` grows once.
    // `sensor_from_drifted`: where the sensor stands by then; absent: now.
    void render(const Pose& base_from_flange, std::uint64_t frame_seed, Frame& frame,
                std::vector<StripeSample>* truth = nullptr,
                const std::optional<Pose>& sensor_from_drifted = std::nullopt);

    // Robot. Arrivals scatter by the repeatability; what the controller reports is where it was sent.
    void move_to(const Pose& base_from_flange);
    std::optional<Pose> reported_flange() const;
    std::optional<Pose> true_flange() const;
    void start_moves(std::vector<MeasuringMove> moves);
    // For a robot program that is executed (arm.h): where the robot is sent at this instant, without scatter.
    void follow(const Pose& base_from_flange);
    // The sensor's trigger input rises while the robot passes there: with the scatter of an arrival, and with
    // latency and jitter along `velocity_mm_s` (base; zero = standing). The spot is the one of the stored program
    // whose trigger lies nearest.
    void fire(const Pose& base_from_flange, const Eigen::Vector3d& velocity_mm_s);
    // The measuring program as stored on a controller, and its start. Error (device) when the robot is
    // stopped or holds no program.
    void store_program(std::vector<MeasuringMove> moves);
    std::vector<MeasuringMove> program() const;
    Expected<void> start_program();
    // Passes the next spot and fires the sensor there; nullopt when the program has ended.
    std::optional<TriggerEvent> next_trigger();
    RobotMode mode() const;
    void set_mode(RobotMode mode);
    Expected<Pose> read_frame(const std::string& name) const;
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame);

    // Sensor. An exposure waits here until the sensor delivers it.
    struct Waiting {
        std::string spot_id;
        Pose base_from_flange = Pose::Identity();  // true
        std::uint64_t number = 0;
        std::int64_t time_ns = 0;
        Pose sensor_from_drifted = Pose::Identity();  // at the exposure
    };
    void arm(bool armed);  // hardware triggers count only while armed
    // Exposes at the present pose, unless the robot's trigger for this spot still waits: that is the same
    // exposure.
    Expected<void> software_trigger(const std::string& spot_id);
    std::optional<Waiting> take_exposure();
    std::uint64_t lost_exposures() const;  // more waiting than buffers
    double parameter(const std::string& name) const;
    void set_parameter(const std::string& name, double value);

  private:
    SimulatedCell(const CellSettings& settings, TriangleMesh part);
    Pose arrived(const Pose& commanded);  // precondition: locked
    void part_begins();                   // precondition: locked
    double drifted_share() const;         // 0 to 1; precondition: locked
    Pose drifted_sensor() const;          // precondition: locked
    // Latency and jitter of the trigger at that velocity. Precondition: locked.
    Eigen::Vector3d trigger_error(const Eigen::Vector3d& velocity_mm_s);
    void expose(const std::string& spot_id, const Pose& base_from_flange);

    const CellSettings settings_;
    const TriangleMesh undisplaced_;
    mutable std::mutex mutex_;  // robot, triggers, part
    std::mutex render_mutex_;   // renderer and trees; taken before mutex_ where both are needed
    StripeRenderer renderer_;
    std::shared_ptr<MeshTree> tree_;    // the part, bent
    std::shared_ptr<MeshTree> target_;  // of the scene, made when first asked for
    Scene target_scene_ = Scene::part;
    PartState part_;
    Scene scene_;
    Exposure exposure_;
    std::optional<Pose> commanded_, true_;
    std::vector<MeasuringMove> program_;
    std::deque<MeasuringMove> moves_;
    std::deque<Waiting> waiting_;
    bool armed_ = false, mended_ = false;
    std::uint64_t parts_ = 0;
    std::int64_t first_part_ns_ = 0, drift_ns_ = 0;
    std::uint64_t exposures_ = 0, arrivals_ = 0, lost_ = 0;
    std::map<std::string, Pose> frames_;
    RobotMode mode_;
};

// Where the flange of such a cell's robot stands before anything is taught: the sensor looks at the part, or at the target
// that stands there.
Expected<Pose> simulated_home(const nlohmann::json& settings);

// Devices on a cell that is already there.
std::unique_ptr<ProfileSource> make_simulated_sensor(std::shared_ptr<SimulatedCell> cell);
std::unique_ptr<RobotLink> make_simulated_robot(std::shared_ptr<SimulatedCell> cell);

// The registry's forms: the session's cell is made from `settings` by the first and must agree for the
// second.
Expected<std::shared_ptr<SimulatedCell>> shared_cell(const nlohmann::json& settings, DeviceSession& session);
Expected<std::unique_ptr<ProfileSource>> open_simulated_sensor(const nlohmann::json& settings,
                                                               DeviceSession& session);
Expected<std::unique_ptr<RobotLink>> open_simulated_robot(const nlohmann::json& settings,
                                                          DeviceSession& session);

}  // namespace seamwright
