#include "devices/simulated/gripper_cell.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "devices/exchange/settings.h"
#include "devices/host_time.h"

namespace seamwright {
namespace {

constexpr double kFlankDepth_mm = 8, kSheet_mm = 60;  // of sheet beside the edge: more than a sensor sees
constexpr double kHeadTilt_deg = 20;

enum GripperStream : std::uint64_t { kGripperArrival = 1, kGripperFrame = 2, kGripperSurface = 3 };
std::uint64_t gripper_seed(std::uint64_t seed, GripperStream stream, std::uint64_t number) {
    return hash64(hash64(seed, stream), number);
}

struct SectionPoint {
    double inboard_mm, height_mm;  // from the edge into the sheet; over the sheet
};
// The sheet's edge, from the foot of the flank over the fold to the sheet.
std::vector<SectionPoint> section() {
    constexpr int kFacets = 48;
    std::vector<SectionPoint> out{{0, -kFlankDepth_mm}};
    for (int k = 0; k <= kFacets; ++k) {
        const double a = kPi / 2 * k / kFacets;
        out.push_back({kPanelFold_mm * (1 - std::cos(a)), kPanelFold_mm * (std::sin(a) - 1)});
    }
    out.push_back({kSheet_mm, 0});
    return out;
}

struct Side {
    Eigen::Vector3d middle, outward;  // of the gap
    double length_mm;
};
std::vector<Side> sides() {
    return {{{kPanelWidth_mm / 2, 0, kPanelZ_mm}, Eigen::Vector3d::UnitX(), kPanelHeight_mm},
            {{0, kPanelHeight_mm / 2, kPanelZ_mm}, Eigen::Vector3d::UnitY(), kPanelWidth_mm},
            {{-kPanelWidth_mm / 2, 0, kPanelZ_mm}, -Eigen::Vector3d::UnitX(), kPanelHeight_mm},
            {{0, -kPanelHeight_mm / 2, kPanelZ_mm}, -Eigen::Vector3d::UnitY(), kPanelWidth_mm}};
}

// The folded edges of all four sides; `into` -1: the panel, inside of the gap; +1: the body around it.
TriangleMesh edges_mesh(double gap_mm, double into) {
    constexpr int kSteps = 20;  // along a side, for bending
    const auto cross = section();
    const int rows = static_cast<int>(cross.size());
    TriangleMesh mesh;
    for (const Side& side : sides()) {
        const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(side.outward);
        const int first = static_cast<int>(mesh.vertices.size());
        for (int i = 0; i <= kSteps; ++i)
            for (const SectionPoint& c : cross)
                mesh.vertices.push_back(side.middle +
                                        along * side.length_mm * (static_cast<double>(i) / kSteps - 0.5) +
                                        side.outward * into * (gap_mm / 2 + c.inboard_mm) +
                                        Eigen::Vector3d::UnitZ() * c.height_mm);
        const auto at = [&](int i, int row) { return first + i * rows + row; };
        for (int i = 0; i < kSteps; ++i)
            for (int r = 0; r + 1 < rows; ++r) {
                mesh.triangles.emplace_back(at(i, r), at(i + 1, r), at(i, r + 1));
                mesh.triangles.emplace_back(at(i + 1, r), at(i + 1, r + 1), at(i, r + 1));
            }
    }
    return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh out = a;
    const auto shift = Eigen::Vector3i::Constant(static_cast<int>(a.vertices.size()));
    out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const Eigen::Vector3i& t : b.triangles) out.triangles.push_back(t + shift);
    return out;
}

void place(const TriangleMesh& mesh, const PartBend& bend, const Pose& pose,
           std::vector<Eigen::Vector3d>& out) {
    const auto box = mesh.box();
    for (Eigen::Vector3d v : mesh.vertices) {
        v.z() += bend_at(bend, box, v);
        out.push_back(pose * v);
    }
}

}  // namespace

std::vector<GripperPlace> default_gripper_places() {
    std::vector<GripperPlace> places;
    for (const Side& side : sides()) {
        const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(side.outward);
        for (const double share : {-0.32, 0.28}) {
            Eigen::Matrix3d axes;
            axes << side.outward, along, Eigen::Vector3d::UnitZ();
            places.push_back({fmt::format("P{}", places.size() + 1),
                              make_pose(axes, side.middle + share * side.length_mm * along)});
        }
    }
    return places;
}

std::map<std::string, Pose> default_gripper_heads() {
    std::map<std::string, Pose> heads;
    int n = 0;
    for (const GripperPlace& place : default_gripper_places()) {
        const std::string name = fmt::format("H{}", ++n);
        const bool twin = n == 1 || n == 5;
        const auto tilted = [&](double deg) {
            return place.gripper_from_place *
                   make_pose(rotation_exp({0, rad_from_deg(deg), 0}), Eigen::Vector3d::Zero());
        };
        heads[name] = twin ? tilted(kHeadTilt_deg) : place.gripper_from_place;
        if (twin) heads[name + "b"] = tilted(-kHeadTilt_deg);
    }
    return heads;
}

const SettingTable& gripper_cell_settings() {
    using namespace entry;
    static const SettingTable table = [] {
        SettingTable own = {
            text("head", "", "of the gripper's sensors; this one's"),
            object("heads", {}, "NAME: POSE flange_from_sensor"),
            pose("base_from_opening", "where the body's opening stands"),
            number("gap_mm", GripperCellSettings().gap_mm, 0.5, 20, "between panel and body as designed"),
        };
        // What the door's cell has too; of another default where this cell is another one.
        for (SettingInfo s : simulated_cell_settings()) {
            if (s.name == "part") {
                for (const char* name : {"panel", "body"}) {
                    s.name = name;
                    own.push_back(s);
                }
                continue;
            }
            const auto otherwise = [&](const char* field, double value) {
                for (SettingInfo& f : s.fields)
                    if (f.name == field) f.otherwise = value;
            };
            otherwise("field_mm", 70);
            otherwise("dark_share", 0);
            otherwise("mirror", 0);
            otherwise("stray_probability", 0);
            for (const char* shared : {"seed", "optics", "surface", "noise", "exposure_us", "gain_db",
                                       "buffers", "robot", "serial"})
                if (s.name == shared) own.push_back(s);
        }
        return own;
    }();
    return table;
}

Expected<GripperCellSettings> parse_gripper_settings(const nlohmann::json& json) {
    GripperCellSettings s;
    SettingsReader f(json, "settings", gripper_cell_settings());
    if (f.failed()) return tl::unexpected(f.error());
    // What the door's cell has too is read as there, over this cell's own defaults.
    nlohmann::json common = {{"optics", {{"field_mm", 70}}},
                             {"surface", {{"dark_share", 0}, {"mirror", 0}}},
                             {"noise", {{"stray_probability", 0}}}};
    for (const char* key :
         {"seed", "optics", "surface", "noise", "exposure_us", "gain_db", "buffers", "robot", "serial"})
        if (json.contains(key)) {
            if (json.at(key).is_object() && common.contains(key))
                common[key].update(json.at(key));
            else
                common[key] = json.at(key);
        }
    SEAM_TRY(auto parsed, parse_cell_settings(common));
    s.common = std::move(parsed);
    s.base_from_opening = make_pose(rotation_exp({0.2, -0.1, 0.7}), {1400, -300, 900});
    f.pose("base_from_opening", s.base_from_opening);
    f.number("gap_mm", s.gap_mm);
    for (const auto& [key, part] : {std::pair{"panel", &s.panel}, {"body", &s.body}})
        if (json.contains(key)) {
            SEAM_TRY(auto state, parse_part_state(json.at(key)));
            *part = state;
        }
    if (json.contains("heads")) {
        s.heads.clear();
        f.poses("heads", s.heads);
    }
    std::string head;
    f.text("head", head);
    if (f.failed()) return tl::unexpected(f.error());
    if (!head.empty() && !s.heads.count(head))
        return input_error(Text("the gripper has no head \"{}\"", head), "settings.head",
                           "name one of settings.heads");
    return s;
}

GripperCell::GripperCell(const GripperCellSettings& settings)
    : settings_(settings),
      panel_mesh_(edges_mesh(settings.gap_mm, -1)),
      body_mesh_(edges_mesh(settings.gap_mm, 1)),
      renderer_(settings.common.optics, settings.common.surface, settings.common.noise),
      tree_(joined(body_mesh_, panel_mesh_)),
      panel_(settings.panel),
      body_(settings.body),
      exposure_(settings.common.exposure),
      frames_(settings.common.robot.frames),
      mode_(settings.common.robot.mode) {}

Expected<std::shared_ptr<GripperCell>> GripperCell::open(const nlohmann::json& settings) {
    SEAM_TRY(const auto parsed, parse_gripper_settings(settings));
    return std::make_shared<GripperCell>(parsed);
}

Pose GripperCell::relation(const Pose& base_from_flange) const {
    const std::lock_guard lock(mutex_);
    const Pose body =
        base_from_flange.inverse() * settings_.base_from_opening * body_.workobject_from_movedworkobject;
    return body.inverse() * panel_.workobject_from_movedworkobject;
}

void GripperCell::set_parts(const PartState& panel, const PartState& body) {
    const std::lock_guard lock(mutex_);
    panel_ = panel;
    body_ = body;
}

void GripperCell::render(const std::string& head, const Pose& base_from_flange, std::uint64_t number,
                         Frame& frame) {
    const std::lock_guard render_lock(render_mutex_);
    PartState panel, body;
    Exposure exposure;
    {
        const std::lock_guard lock(mutex_);
        panel = panel_;
        body = body_;
        exposure = exposure_;
    }
    std::vector<Eigen::Vector3d> vertices;
    place(body_mesh_, body.bend,
          base_from_flange.inverse() * settings_.base_from_opening * body.workobject_from_movedworkobject,
          vertices);
    place(panel_mesh_, panel.bend, panel.workobject_from_movedworkobject, vertices);
    tree_.move_vertices(std::move(vertices));
    exposure.seed = gripper_seed(settings_.common.seed, kGripperFrame, number);
    frame.pixels.resize(renderer_.image_bytes());
    renderer_.render(tree_, settings_.heads.at(head), exposure,
                     gripper_seed(settings_.common.seed, kGripperSurface, 0), frame.pixels);
    const auto& o = renderer_.optics();
    frame.image = {frame.pixels.data(), o.width, o.height,
                   static_cast<std::size_t>(o.width) * (o.bit_depth > 8 ? 2 : 1), o.bit_depth};
}

Pose GripperCell::arrived(const Pose& commanded) {
    Random random(gripper_seed(settings_.common.seed, kGripperArrival, arrivals_++));
    Vector6 scatter;
    scatter << settings_.common.robot.repeatability_mm * random.normal3(),
        rad_from_deg(settings_.common.robot.repeatability_deg) * random.normal3();
    return retract(commanded, scatter);
}

void GripperCell::move_to(const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    commanded_ = base_from_flange;
    true_ = arrived(base_from_flange);
}

std::optional<Pose> GripperCell::reported_flange() const {
    const std::lock_guard lock(mutex_);
    return commanded_;
}

std::optional<Pose> GripperCell::true_flange() const {
    const std::lock_guard lock(mutex_);
    return true_;
}

void GripperCell::start_moves(std::vector<MeasuringMove> moves) {
    const std::lock_guard lock(mutex_);
    moves_.assign(std::make_move_iterator(moves.begin()), std::make_move_iterator(moves.end()));
}

std::optional<TriggerEvent> GripperCell::next_trigger() {
    const std::lock_guard lock(mutex_);
    if (moves_.empty()) return std::nullopt;
    const MeasuringMove move = moves_.front();
    moves_.pop_front();
    commanded_ = move.trigger;
    true_ = arrived(move.trigger);
    return TriggerEvent{move.spot_id, host_now_ns(), move.trigger};
}

RobotMode GripperCell::mode() const {
    const std::lock_guard lock(mutex_);
    return mode_;
}

void GripperCell::set_mode(RobotMode mode) {
    const std::lock_guard lock(mutex_);
    mode_ = mode;
}

Expected<Pose> GripperCell::read_frame(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto it = frames_.find(name);
    if (it == frames_.end())
        return device_error(Text("the controller has no frame \"{}\"", name), "simulated gripper",
                            "give it in the settings under robot.frames");
    return it->second;
}

Expected<void> GripperCell::write_frame(const std::string& name, const Pose& base_from_frame) {
    if (!base_from_frame.matrix().allFinite())
        return device_error("the frame is not finite", "simulated gripper");
    SEAM_OK(read_frame(name));
    const std::lock_guard lock(mutex_);
    frames_[name] = base_from_frame;
    return {};
}

Expected<GripperCell::Exposed> GripperCell::expose(const std::string& spot_id) {
    const std::lock_guard lock(mutex_);
    if (!true_)
        return device_error("the robot has not moved anywhere yet", "simulated gripper",
                            "move the robot first");
    return Exposed{spot_id, *true_, exposures_++};
}

double GripperCell::exposure_us() const {
    const std::lock_guard lock(mutex_);
    return exposure_.exposure_us;
}

void GripperCell::set_exposure_us(double value) {
    const std::lock_guard lock(mutex_);
    exposure_.exposure_us = value;
}

}  // namespace seamwright
