#include "devices/simulated/cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "devices/exchange/pose_json.h"
#include "devices/host_time.h"
#include "devices/simulated/scene/mesh_file.h"

namespace seamwright {
namespace {

// Random streams of a cell's seed.
enum Stream : std::uint64_t { kArrival = 1, kJitter = 2, kFrame = 3, kSurface = 4, kDamage = 5 };
std::uint64_t stream_seed(std::uint64_t seed, Stream stream, std::uint64_t number) {
    return hash64(hash64(seed, stream), number);
}

// A share of a small motion: of its translation and of its rotation vector.
Pose part_of_pose(const Pose& whole, double share) {
    Pose part = Pose::Identity();
    const Eigen::AngleAxisd turn(whole.linear());
    part.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
    part.translation() = share * whole.translation();
    return part;
}

}  // namespace

SimulatedCell::SimulatedCell(const CellSettings& settings, TriangleMesh part)
    : settings_(settings),
      undisplaced_(std::move(part)),
      renderer_(settings.optics, settings.surface, settings.noise),
      tree_(std::make_shared<MeshTree>(undisplaced_)),
      scene_(settings.scene),
      exposure_(settings.exposure),
      frames_(settings.robot.frames),
      mode_(settings.robot.mode) {
    set_part(settings.part);
}

Expected<std::shared_ptr<SimulatedCell>> SimulatedCell::open(const CellSettings& settings) {
    TriangleMesh mesh;
    if (settings.mesh.empty()) {
        mesh = door_mesh();
    } else {
        SEAM_TRY(auto loaded, load_mesh(settings.mesh, settings.mesh_unit));
        mesh = std::move(loaded);
    }
    return std::shared_ptr<SimulatedCell>(new SimulatedCell(settings, std::move(mesh)));
}

Expected<std::shared_ptr<SimulatedCell>> SimulatedCell::open(const nlohmann::json& settings) {
    SEAM_TRY(const auto parsed, parse_cell_settings(settings));
    return open(parsed);
}

Expected<Pose> simulated_home(const nlohmann::json& settings) {
    SEAM_TRY(const auto cell, SimulatedCell::open(settings));
    const CellSettings& s = cell->settings();
    if (s.scene != Scene::part) return s.base_from_target * s.flange_from_sensor.inverse();
    if (s.mesh.empty()) return cell->flange_for(default_door_spots().front().workobject_from_sensor);
    const Eigen::AlignedBox3d box = cell->part_mesh().box();
    Eigen::Vector3d above = box.center();
    above.z() = box.max().z();
    return cell->flange_for(make_pose(Eigen::Matrix3d::Identity(), above));
}

PartState SimulatedCell::part() const {
    const std::lock_guard lock(mutex_);
    return part_;
}

Eigen::Vector3d SimulatedCell::displaced(const Eigen::Vector3d& point) const {
    const PartState state = part();
    Eigen::Vector3d p = point;
    p.z() += bend_at(state.bend, undisplaced_.box(), point);
    return state.workobject_from_movedworkobject * p;
}

Pose SimulatedCell::flange_for(const Pose& workobject_from_sensor) const {
    return settings_.base_from_workobject * workobject_from_sensor * settings_.flange_from_sensor.inverse();
}

nlohmann::json SimulatedCell::describe() const {
    const PartState state = part();
    const auto& s = settings_;
    return {{"seed", s.seed},
            {"part", s.mesh.empty() ? nlohmann::json("procedural door") : nlohmann::json(s.mesh)},
            {"displacement", pose_json(state.workobject_from_movedworkobject)},
            {"bend_mm", state.bend.bend_mm},
            {"twist_mm", state.bend.twist_mm},
            {"sensor",
             {{"width_px", s.optics.width},
              {"height_px", s.optics.height},
              {"bit_depth", s.optics.bit_depth},
              {"field_mm", s.optics.field_mm},
              {"stand_off_mm", s.optics.stand_off_mm},
              {"triangulation_deg", s.optics.triangulation_deg},
              {"exposure_us", parameter("exposure_us")},
              {"gain_db", parameter("gain_db")}}},
            {"noise",
             {{"shot", s.noise.shot},
              {"read_electrons", s.noise.read_electrons},
              {"full_well_electrons", kFullWellElectrons},
              {"speckle_contrast", s.noise.speckle},
              {"stray_probability", s.noise.stray_probability},
              {"second_bounce", s.surface.mirror},
              {"dark_share", s.surface.dark_share}}},
            {"robot",
             {{"repeatability_sigma_mm", s.robot.repeatability_mm},
              {"repeatability_sigma_deg", s.robot.repeatability_deg},
              {"trigger_jitter_half_width_mm_at_100_mm_s", s.robot.trigger_jitter_mm},
              {"trigger_latency_ms", s.robot.trigger_latency_ms}}}};
}

void SimulatedCell::set_part(const PartState& part) {
    const std::lock_guard render_lock(render_mutex_);
    const std::lock_guard lock(mutex_);
    const bool bent = part.bend.bend_mm != part_.bend.bend_mm || part.bend.twist_mm != part_.bend.twist_mm;
    part_ = part;
    if (!bent) return;
    const auto box = undisplaced_.box();
    std::vector<Eigen::Vector3d> vertices = undisplaced_.vertices;
    for (auto& v : vertices) v.z() += bend_at(part.bend, box, v);
    tree_->move_vertices(std::move(vertices));
}

void SimulatedCell::set_scene(Scene scene) {
    const std::lock_guard lock(mutex_);
    scene_ = scene;
}

void SimulatedCell::render(const Pose& base_from_flange, std::uint64_t frame_seed, Frame& frame,
                           std::vector<StripeSample>* truth, const std::optional<Pose>& sensor_from_drifted) {
    const std::lock_guard render_lock(render_mutex_);
    Scene scene;
    Pose base_from_part;
    Exposure exposure;
    Pose drifted;
    {
        const std::lock_guard lock(mutex_);
        scene = scene_;
        exposure = exposure_;
        drifted = sensor_from_drifted ? *sensor_from_drifted : drifted_sensor();
        base_from_part = scene == Scene::part
                             ? settings_.base_from_workobject * part_.workobject_from_movedworkobject
                             : settings_.base_from_target;
    }
    PlatePattern board;
    std::shared_ptr<MeshTree> tree = tree_;
    if (scene != Scene::part) {
        if (!target_ || target_scene_ != scene) {
            const auto& b = settings_.board;
            if (scene == Scene::sphere) {
                target_ = std::make_shared<MeshTree>(sphere_mesh(settings_.sphere_radius_mm));
            } else if (scene == Scene::plate) {
                target_ = std::make_shared<MeshTree>(
                    plate_mesh(b.pitch_mm * (b.columns + 3), b.pitch_mm * (b.rows + 3)));
            } else {
                target_ = std::make_shared<MeshTree>(triangle_body_mesh());
            }
            target_scene_ = scene;
        }
        tree = target_;
        if (scene == Scene::plate) board = settings_.board;
    }
    exposure.seed = stream_seed(settings_.seed, kFrame, frame_seed);
    const Pose part_from_sensor =
        base_from_part.inverse() * base_from_flange * settings_.flange_from_sensor * drifted;
    frame.pixels.resize(renderer_.image_bytes());
    renderer_.render(*tree, part_from_sensor, exposure, stream_seed(settings_.seed, kSurface, 0),
                     frame.pixels, truth, board);
    const auto& o = renderer_.optics();
    const auto row = static_cast<std::size_t>(o.width) * (o.bit_depth > 8 ? 2 : 1);
    frame.image = {frame.pixels.data(), o.width, o.height, row, o.bit_depth};
    if (settings_.damaged_probability > 0) {
        Random random(stream_seed(settings_.seed, kDamage, frame_seed));
        if (random.uniform() < settings_.damaged_probability) {  // packets of the frame's end got lost
            const auto whole_rows = static_cast<std::size_t>(random.uniform(0, o.height));
            std::fill(frame.pixels.begin() + static_cast<std::ptrdiff_t>(whole_rows * row),
                      frame.pixels.end(), std::byte{0});
            frame.status = FrameStatus::incomplete;
        }
    }
}

Pose SimulatedCell::arrived(const Pose& commanded) {
    Random random(stream_seed(settings_.seed, kArrival, arrivals_++));
    Vector6 scatter;
    scatter << settings_.robot.repeatability_mm * random.normal3(),
        rad_from_deg(settings_.robot.repeatability_deg) * random.normal3();
    return retract(part_of_pose(settings_.drift.robot, drifted_share()) * commanded, scatter);
}

void SimulatedCell::part_begins() {
    const std::int64_t now = host_now_ns();
    if (++parts_ == 1) first_part_ns_ = now;
    if (parts_ == std::max<std::uint64_t>(1, settings_.drift.from_part)) drift_ns_ = now;
}

double SimulatedCell::drifted_share() const {
    const CellDrift& d = settings_.drift;
    const std::uint64_t first = std::max<std::uint64_t>(1, d.from_part);
    if (parts_ < first || (d.time_constant_parts <= 0 && d.time_constant_s <= 0)) return 0;
    double share = 1;
    if (d.time_constant_parts > 0)
        share *= std::exp(-static_cast<double>(parts_ - first) / d.time_constant_parts);
    if (d.time_constant_s > 0)
        share *= std::exp(-1e-9 * static_cast<double>(host_now_ns() - drift_ns_) / d.time_constant_s);
    return 1 - share;
}

Pose SimulatedCell::drifted_sensor() const {
    const CellDrift& d = settings_.drift;
    const bool bumped =
        !mended_ && ((d.bump_at_part > 0 && parts_ >= d.bump_at_part) ||
                     (d.bump_at_s > 0 && parts_ > 0 &&
                      1e-9 * static_cast<double>(host_now_ns() - first_part_ns_) >= d.bump_at_s));
    const Pose drifted = part_of_pose(d.sensor, drifted_share());
    return bumped ? drifted * d.bump : drifted;
}

std::uint64_t SimulatedCell::parts() const {
    const std::lock_guard lock(mutex_);
    return parts_;
}

Pose SimulatedCell::sensor_from_drifted() const {
    const std::lock_guard lock(mutex_);
    return drifted_sensor();
}

Pose SimulatedCell::base_from_drifted() const {
    const std::lock_guard lock(mutex_);
    return part_of_pose(settings_.drift.robot, drifted_share());
}

void SimulatedCell::mend_bump() {
    const std::lock_guard lock(mutex_);
    mended_ = true;
}

void SimulatedCell::move_to(const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    commanded_ = base_from_flange;
    true_ = arrived(base_from_flange);
}

std::optional<Pose> SimulatedCell::reported_flange() const {
    const std::lock_guard lock(mutex_);
    return commanded_;
}

std::optional<Pose> SimulatedCell::true_flange() const {
    const std::lock_guard lock(mutex_);
    return true_;
}

void SimulatedCell::start_moves(std::vector<MeasuringMove> moves) {
    const std::lock_guard lock(mutex_);
    part_begins();
    moves_.assign(std::make_move_iterator(moves.begin()), std::make_move_iterator(moves.end()));
}

void SimulatedCell::store_program(std::vector<MeasuringMove> moves) {
    const std::lock_guard lock(mutex_);
    program_ = std::move(moves);
}

std::vector<MeasuringMove> SimulatedCell::program() const {
    const std::lock_guard lock(mutex_);
    return program_;
}

Expected<void> SimulatedCell::start_program() {
    const std::lock_guard lock(mutex_);
    if (mode_ == RobotMode::stopped || mode_ == RobotMode::fault)
        return device_error("the robot is stopped", "simulated robot", "start it on its controller");
    if (program_.empty())
        return device_error("the controller holds no measuring program", "simulated robot",
                            "load the program that was generated from the project");
    part_begins();
    moves_.assign(program_.begin(), program_.end());
    return {};
}

std::optional<TriggerEvent> SimulatedCell::next_trigger() {
    const std::lock_guard lock(mutex_);
    if (moves_.empty()) return std::nullopt;
    const MeasuringMove move = moves_.front();
    moves_.pop_front();
    commanded_ = move.trigger;
    Pose at = arrived(move.trigger);
    const Eigen::Vector3d way = move.exit.translation() - move.entry.translation();
    if (!move.stop_at_trigger && way.norm() > 1e-6)
        at.translation() += trigger_error(way.normalized() * move.speed_mm_s);
    true_ = at;
    if (armed_) expose(move.spot_id, at);
    return TriggerEvent{move.spot_id, host_now_ns(), move.trigger};
}

Eigen::Vector3d SimulatedCell::trigger_error(const Eigen::Vector3d& velocity_mm_s) {
    const double speed = velocity_mm_s.norm();
    if (speed < 1e-6) return Eigen::Vector3d::Zero();
    Random random(stream_seed(settings_.seed, kJitter, arrivals_));
    const double half = settings_.robot.trigger_jitter_mm * speed / 100;
    return velocity_mm_s / speed * random.uniform(-half, half) +
           velocity_mm_s * (1e-3 * settings_.robot.trigger_latency_ms);
}

void SimulatedCell::follow(const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    commanded_ = true_ = base_from_flange;
}

void SimulatedCell::fire(const Pose& base_from_flange, const Eigen::Vector3d& velocity_mm_s) {
    const std::lock_guard lock(mutex_);
    const auto nearest = std::min_element(
        program_.begin(), program_.end(), [&](const MeasuringMove& a, const MeasuringMove& b) {
            return distance_mm(a.trigger, base_from_flange) < distance_mm(b.trigger, base_from_flange);
        });
    // A program that is executed begins with its first spot.
    if (nearest == program_.begin() && nearest != program_.end()) part_begins();
    commanded_ = base_from_flange;
    Pose at = arrived(base_from_flange);
    at.translation() += trigger_error(velocity_mm_s);
    true_ = at;
    if (armed_) expose(nearest == program_.end() ? "" : nearest->spot_id, at);
}

RobotMode SimulatedCell::mode() const {
    const std::lock_guard lock(mutex_);
    return mode_;
}

void SimulatedCell::set_mode(RobotMode mode) {
    const std::lock_guard lock(mutex_);
    mode_ = mode;
}

Expected<Pose> SimulatedCell::read_frame(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto it = frames_.find(name);
    if (it == frames_.end()) {
        return device_error(Text("the controller has no frame \"{}\"", name), "simulated robot",
                            "give it in the settings under robot.frames");
    }
    return it->second;
}

Expected<void> SimulatedCell::write_frame(const std::string& name, const Pose& base_from_frame) {
    const std::lock_guard lock(mutex_);
    const auto it = frames_.find(name);
    if (it == frames_.end()) {
        return device_error(Text("the controller has no frame \"{}\"", name), "simulated robot",
                            "give it in the settings under robot.frames");
    }
    if (!base_from_frame.matrix().allFinite())
        return device_error("the frame is not finite", "simulated robot");
    it->second = base_from_frame;
    return {};
}

void SimulatedCell::arm(bool armed) {
    const std::lock_guard lock(mutex_);
    armed_ = armed;
    waiting_.clear();
}

void SimulatedCell::expose(const std::string& spot_id, const Pose& base_from_flange) {
    const std::uint64_t number = exposures_++;
    if (waiting_.size() >= static_cast<std::size_t>(settings_.buffers)) {
        ++lost_;
        return;
    }
    waiting_.push_back({spot_id, base_from_flange, number, host_now_ns(), drifted_sensor()});
}

Expected<void> SimulatedCell::software_trigger(const std::string& spot_id) {
    const std::lock_guard lock(mutex_);
    if (!armed_) return device_error("the sensor is not started", "simulated sensor");
    if (!spot_id.empty()) {
        for (const Waiting& w : waiting_) {
            if (w.spot_id == spot_id) return {};
        }
    }
    if (!true_)
        return device_error("the robot has not moved anywhere yet", "simulated sensor",
                            "move the robot first");
    expose(spot_id, *true_);
    return {};
}

std::optional<SimulatedCell::Waiting> SimulatedCell::take_exposure() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    Waiting w = std::move(waiting_.front());
    waiting_.pop_front();
    return w;
}

std::uint64_t SimulatedCell::lost_exposures() const {
    const std::lock_guard lock(mutex_);
    return lost_;
}

double SimulatedCell::parameter(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    if (name == "laser") return exposure_.laser_on ? 1 : 0;
    if (name == "scene") return static_cast<double>(scene_);
    return name == "gain_db" ? exposure_.gain_db : exposure_.exposure_us;
}

void SimulatedCell::set_parameter(const std::string& name, double value) {
    const std::lock_guard lock(mutex_);
    if (name == "laser")
        exposure_.laser_on = value != 0;
    else if (name == "scene")
        scene_ = static_cast<Scene>(static_cast<int>(value));
    else
        (name == "gain_db" ? exposure_.gain_db : exposure_.exposure_us) = value;
}

}  // namespace seamwright
