#include <fmt/format.h>

#include <array>

#include "core/geometry/notation.h"
#include "devices/exchange/settings.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

constexpr std::array kScenes = {Scene::part, Scene::sphere, Scene::plate, Scene::triangle};

}  // namespace

std::string_view to_string(Scene scene) {
    switch (scene) {
        case Scene::part:
            return "part";
        case Scene::sphere:
            return "sphere";
        case Scene::plate:
            return "plate";
        case Scene::triangle:
            return "triangle";
    }
    return "part";
}

std::optional<Scene> scene_from_string(std::string_view text) {
    for (const Scene scene : kScenes)
        if (to_string(scene) == text) return scene;
    return std::nullopt;
}

namespace {

SettingTable part_table() {
    return {entry::pose("displacement", "workobject_from_movedworkobject"),
            entry::number("bend_mm", 0, -50, 50, "bow in the middle"),
            entry::number("twist_mm", 0, -50, 50, "of one end against the other")};
}

void read_part(SettingsReader& p, PartState& part) {
    p.pose("displacement", part.workobject_from_movedworkobject);
    p.number("bend_mm", part.bend.bend_mm);
    p.number("twist_mm", part.bend.twist_mm);
}

}  // namespace

Expected<PartState> parse_part_state(const nlohmann::json& json) {
    PartState part;
    static const SettingTable table = part_table();
    SettingsReader f(json, "part", table);
    read_part(f, part);
    if (f.failed()) return tl::unexpected(f.error());
    return part;
}

CellSettings default_cell_settings() {
    CellSettings s;
    s.base_from_workobject = make_pose(rotation_from_kuka({12, -4, 3}), {900, -450, 500});
    s.base_from_target = make_pose(rotation_from_kuka({-20, 2, -3}), {700, 600, 450});
    s.flange_from_sensor = make_pose(rotation_from_kuka({8, 3, 178}), {30, -20, 450});
    return s;
}

const SettingTable& simulated_cell_settings() {
    using namespace entry;
    static const SettingTable table = [] {
        const CellSettings d = default_cell_settings();
        return SettingTable{
            whole("seed", d.seed, 0, 9e15,
                  "every random number follows from it and from the count of exposures and moves"),
            choice("scene", {"part", "sphere", "plate", "triangle"},
                   "what stands before the sensor; the targets stand at base_from_target"),
            text("mesh", "", "STL, PLY or OBJ in the work object frame instead of the door"),
            text("mesh_unit", "", "of the mesh: mm or m; else suspected from its size"),
            pose("base_from_workobject", "where the part is taught"),
            pose("base_from_target", "where the targets stand"),
            pose("flange_from_sensor", "true hand-eye"),
            object("part", part_table(), "how the part lies"),
            object(
                "optics",
                {whole("width", d.optics.width, 64, 8192, "columns of the image"),
                 whole("height", d.optics.height, 64, 8192, "rows of the image"),
                 whole("bit_depth", d.optics.bit_depth, 8, 16, "8, 10, 12 or 16"),
                 number("stand_off_mm", d.optics.stand_off_mm, 20, 2000, "working distance"),
                 number("triangulation_deg", d.optics.triangulation_deg, 5, 70, "between camera and laser"),
                 number("field_mm", d.optics.field_mm, 5, 2000, "width of the view at the stand-off"),
                 number("k1", d.optics.k1, -1, 1, "distortion"),
                 number("k2", d.optics.k2, -1, 1, "distortion"),
                 number("p1", d.optics.p1, -0.1, 0.1, "distortion"),
                 number("p2", d.optics.p2, -0.1, 0.1, "distortion"),
                 number("k3", d.optics.k3, -1, 1, "distortion"),
                 number("laser_width_mm", d.optics.laser_width_mm, 0.001, 5, "of the stripe"),
                 number("fan_deg", d.optics.fan_deg, 1, 120, "opening of the laser"),
                 number("blur_px", d.optics.blur_px, 0.3, 5, "sigma"),
                 number("blooming", d.optics.blooming, 0, 1, "share of light beyond saturation")},
                "camera and laser"),
            object("surface",
                   {number("albedo", d.surface.albedo, 0, 1, "diffuse"),
                    number("gloss", d.surface.gloss, 0, 10, "specular"),
                    number("shininess", d.surface.shininess, 1, 1000, "exponent of the gloss"),
                    number("dark_share", d.surface.dark_share, 0, 1, "share of the surface in dark patches"),
                    number("dark_albedo", d.surface.dark_albedo, 0, 1, "of the patches"),
                    number("dark_size_mm", d.surface.dark_size_mm, 0.1, 1000, "of the patches"),
                    number("mirror", d.surface.mirror, 0, 5, "brightness of reflected stripes")},
                   "of the part"),
            object("noise",
                   {yes_no("shot", d.noise.shot, "of the light"),
                    number("read_electrons", d.noise.read_electrons, 0, 5000, "sigma"),
                    number("speckle", d.noise.speckle, 0, 0.5, "contrast"),
                    number("ambient_electrons_per_ms", d.noise.ambient_electrons_per_ms, 0, 1e6, "daylight"),
                    number("stray_probability", d.noise.stray_probability, 0, 1,
                           "of a stray reflection in a frame")},
                   "of the camera"),
            number("exposure_us", d.exposure.exposure_us, 1, 1e6, "exposure time"),
            number("gain_db", d.exposure.gain_db, 0, 48, "gain"),
            number("damaged_probability", d.damaged_probability, 0, 1, "of a frame that arrives damaged"),
            whole("buffers", d.buffers, 2, 1024, "frames that may be handed out"),
            number("sphere_radius_mm", d.sphere_radius_mm, 1, 500, "of the target"),
            text("serial", d.serial, "of sensor and robot"),
            object("board",
                   {whole("columns", d.board.columns, 2, 50, "inner corners"),
                    whole("rows", d.board.rows, 2, 50, "inner corners"),
                    number("pitch_mm", d.board.pitch_mm, 0.5, 200, "between corners")},
                   "chessboard of the scene plate"),
            object(
                "drift",
                {pose("sensor", "what the sensor on the wrist moves by when the cell is warm, sensor frame"),
                 pose("robot", "what the robot moves by when the cell is warm, base"),
                 number("time_constant_parts", d.drift.time_constant_parts, 0, 1e6,
                        "of the warm-up, in parts; 0: not by parts"),
                 number("time_constant_s", d.drift.time_constant_s, 0, 1e6,
                        "of the warm-up, in seconds; 0: not by time"),
                 whole("from_part", d.drift.from_part, 0, 9e15, "parts before this one see nothing of it"),
                 pose("bump", "what the sensor is knocked by, sensor frame"),
                 whole("bump_at_part", d.drift.bump_at_part, 0, 9e15, "knocked before this part; 0: never"),
                 number("bump_at_s", d.drift.bump_at_s, 0, 1e6,
                        "knocked so long after the first part; 0: never")},
                "warm-up and a knock; without a time constant nothing drifts"),
            object("robot",
                   {number("repeatability_mm", d.robot.repeatability_mm, 0, 10,
                           "one sigma per axis, anew at every arrival"),
                    number("repeatability_deg", d.robot.repeatability_deg, 0, 5,
                           "one sigma per axis, anew at every arrival"),
                    number("trigger_jitter_mm", d.robot.trigger_jitter_mm, 0, 50,
                           "half width, uniform, at 100 mm/s; grows with the speed"),
                    number("trigger_latency_ms", d.robot.trigger_latency_ms, 0, 1000,
                           "from the instant that the controller tells to the exposure"),
                    text("mode", std::string(to_string(d.robot.mode)),
                         "operating mode: automatic, external, ..."),
                    object("frames", {}, "NAME: POSE base_from_frame")},
                   "what makes it imperfect")};
    }();
    return table;
}

Expected<CellSettings> parse_cell_settings(const nlohmann::json& json) {
    CellSettings s = default_cell_settings();
    SettingsReader f(json, "settings", simulated_cell_settings());
    f.whole("seed", s.seed);
    std::string scene(to_string(s.scene));
    f.text("scene", scene);
    for (const Scene known : kScenes)
        if (to_string(known) == scene) s.scene = known;
    f.text("mesh", s.mesh);
    f.text("mesh_unit", s.mesh_unit);
    f.pose("base_from_workobject", s.base_from_workobject);
    f.pose("base_from_target", s.base_from_target);
    f.pose("flange_from_sensor", s.flange_from_sensor);
    f.object("part", [&](SettingsReader& p) { read_part(p, s.part); });
    f.object("optics", [&](SettingsReader& o) {
        o.whole("width", s.optics.width);
        o.whole("height", s.optics.height);
        o.whole("bit_depth", s.optics.bit_depth);
        o.number("stand_off_mm", s.optics.stand_off_mm);
        o.number("triangulation_deg", s.optics.triangulation_deg);
        o.number("field_mm", s.optics.field_mm);
        o.number("k1", s.optics.k1);
        o.number("k2", s.optics.k2);
        o.number("p1", s.optics.p1);
        o.number("p2", s.optics.p2);
        o.number("k3", s.optics.k3);
        o.number("laser_width_mm", s.optics.laser_width_mm);
        o.number("fan_deg", s.optics.fan_deg);
        o.number("blur_px", s.optics.blur_px);
        o.number("blooming", s.optics.blooming);
        const int depth = s.optics.bit_depth;
        if (!o.failed() && depth != 8 && depth != 10 && depth != 12 && depth != 16) {
            o.keep(input_error("must be 8, 10, 12 or 16", o.path("bit_depth")));
        }
    });
    f.object("surface", [&](SettingsReader& o) {
        o.number("albedo", s.surface.albedo);
        o.number("gloss", s.surface.gloss);
        o.number("shininess", s.surface.shininess);
        o.number("dark_share", s.surface.dark_share);
        o.number("dark_albedo", s.surface.dark_albedo);
        o.number("dark_size_mm", s.surface.dark_size_mm);
        o.number("mirror", s.surface.mirror);
    });
    f.object("noise", [&](SettingsReader& o) {
        o.truth("shot", s.noise.shot);
        o.number("read_electrons", s.noise.read_electrons);
        o.number("speckle", s.noise.speckle);
        o.number("ambient_electrons_per_ms", s.noise.ambient_electrons_per_ms);
        o.number("stray_probability", s.noise.stray_probability);
    });
    f.number("exposure_us", s.exposure.exposure_us);
    f.number("gain_db", s.exposure.gain_db);
    f.number("damaged_probability", s.damaged_probability);
    f.whole("buffers", s.buffers);
    f.number("sphere_radius_mm", s.sphere_radius_mm);
    f.text("serial", s.serial);
    f.object("board", [&](SettingsReader& o) {
        o.whole("columns", s.board.columns);
        o.whole("rows", s.board.rows);
        o.number("pitch_mm", s.board.pitch_mm);
    });
    f.object("drift", [&](SettingsReader& o) {
        o.pose("sensor", s.drift.sensor);
        o.pose("robot", s.drift.robot);
        o.number("time_constant_parts", s.drift.time_constant_parts);
        o.number("time_constant_s", s.drift.time_constant_s);
        o.whole("from_part", s.drift.from_part);
        o.pose("bump", s.drift.bump);
        o.whole("bump_at_part", s.drift.bump_at_part);
        o.number("bump_at_s", s.drift.bump_at_s);
    });
    f.object("robot", [&](SettingsReader& o) {
        o.number("repeatability_mm", s.robot.repeatability_mm);
        o.number("repeatability_deg", s.robot.repeatability_deg);
        o.number("trigger_jitter_mm", s.robot.trigger_jitter_mm);
        o.number("trigger_latency_ms", s.robot.trigger_latency_ms);
        std::string mode(to_string(s.robot.mode));
        o.text("mode", mode);
        if (const auto known = robot_mode_from_string(mode)) {
            s.robot.mode = *known;
        } else {
            o.keep(input_error(Text("\"{}\" is no mode", mode), o.path("mode"), "give e.g. \"automatic\""));
        }
        o.poses("frames", s.robot.frames);
    });
    if (f.failed()) return tl::unexpected(f.error());
    return s;
}

}  // namespace seamwright
