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

namespace {
void read_part(SettingsReader& p, PartState& part) {
    p.only({"displacement", "bend_mm", "twist_mm"});
    p.pose("displacement", part.workobject_from_movedworkobject);
    p.number("bend_mm", part.bend.bend_mm, -50, 50);
    p.number("twist_mm", part.bend.twist_mm, -50, 50);
}
}  // namespace

Expected<PartState> parse_part_state(const nlohmann::json& json) {
    PartState part;
    SettingsReader f(json, "part");
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

Expected<CellSettings> parse_cell_settings(const nlohmann::json& json) {
    CellSettings s = default_cell_settings();
    SettingsReader f(json, "settings");
    f.only({"seed", "scene", "mesh", "mesh_unit", "base_from_workobject", "base_from_target",
            "flange_from_sensor", "part", "optics", "surface", "noise", "exposure_us", "gain_db",
            "damaged_probability", "buffers", "robot", "sphere_radius_mm", "board", "serial"});
    f.whole("seed", s.seed, 0, 9e15);
    std::string scene(to_string(s.scene));
    f.text("scene", scene);
    if (!f.failed()) {
        const auto it =
            std::find_if(kScenes.begin(), kScenes.end(), [&](Scene k) { return to_string(k) == scene; });
        if (it == kScenes.end()) {
            return input_error(Text("\"{}\" is no scene", scene), "settings.scene",
                               "give part, sphere, plate or triangle");
        }
        s.scene = *it;
    }
    f.text("mesh", s.mesh);
    f.text("mesh_unit", s.mesh_unit);
    f.pose("base_from_workobject", s.base_from_workobject);
    f.pose("base_from_target", s.base_from_target);
    f.pose("flange_from_sensor", s.flange_from_sensor);
    f.object("part", [&](SettingsReader& p) { read_part(p, s.part); });
    f.object("optics", [&](SettingsReader& o) {
        o.only({"width", "height", "bit_depth", "stand_off_mm", "triangulation_deg", "field_mm", "k1", "k2",
                "p1", "p2", "k3", "laser_width_mm", "fan_deg", "blur_px", "blooming"});
        o.whole("width", s.optics.width, 64, 8192);
        o.whole("height", s.optics.height, 64, 8192);
        o.whole("bit_depth", s.optics.bit_depth, 8, 16);
        o.number("stand_off_mm", s.optics.stand_off_mm, 20, 2000);
        o.number("triangulation_deg", s.optics.triangulation_deg, 5, 70);
        o.number("field_mm", s.optics.field_mm, 5, 2000);
        o.number("k1", s.optics.k1, -1, 1);
        o.number("k2", s.optics.k2, -1, 1);
        o.number("p1", s.optics.p1, -0.1, 0.1);
        o.number("p2", s.optics.p2, -0.1, 0.1);
        o.number("k3", s.optics.k3, -1, 1);
        o.number("laser_width_mm", s.optics.laser_width_mm, 0.001, 5);
        o.number("fan_deg", s.optics.fan_deg, 1, 120);
        o.number("blur_px", s.optics.blur_px, 0.3, 5);
        o.number("blooming", s.optics.blooming, 0, 1);
        const int depth = s.optics.bit_depth;
        if (!o.failed() && depth != 8 && depth != 10 && depth != 12 && depth != 16) {
            o.keep(input_error("must be 8, 10, 12 or 16", o.path("bit_depth")));
        }
    });
    f.object("surface", [&](SettingsReader& o) {
        o.only({"albedo", "gloss", "shininess", "dark_share", "dark_albedo", "dark_size_mm", "mirror"});
        o.number("albedo", s.surface.albedo, 0, 1);
        o.number("gloss", s.surface.gloss, 0, 10);
        o.number("shininess", s.surface.shininess, 1, 1000);
        o.number("dark_share", s.surface.dark_share, 0, 1);
        o.number("dark_albedo", s.surface.dark_albedo, 0, 1);
        o.number("dark_size_mm", s.surface.dark_size_mm, 0.1, 1000);
        o.number("mirror", s.surface.mirror, 0, 5);
    });
    f.object("noise", [&](SettingsReader& o) {
        o.only({"shot", "read_electrons", "speckle", "ambient_electrons_per_ms", "stray_probability"});
        o.truth("shot", s.noise.shot);
        o.number("read_electrons", s.noise.read_electrons, 0, 5000);
        o.number("speckle", s.noise.speckle, 0, 0.5);
        o.number("ambient_electrons_per_ms", s.noise.ambient_electrons_per_ms, 0, 1e6);
        o.number("stray_probability", s.noise.stray_probability, 0, 1);
    });
    f.number("exposure_us", s.exposure.exposure_us, 1, 1e6);
    f.number("gain_db", s.exposure.gain_db, 0, 48);
    f.number("damaged_probability", s.damaged_probability, 0, 1);
    f.whole("buffers", s.buffers, 2, 1024);
    f.number("sphere_radius_mm", s.sphere_radius_mm, 1, 500);
    f.text("serial", s.serial);
    f.object("board", [&](SettingsReader& o) {
        o.only({"columns", "rows", "pitch_mm"});
        o.whole("columns", s.board.columns, 2, 50);
        o.whole("rows", s.board.rows, 2, 50);
        o.number("pitch_mm", s.board.pitch_mm, 0.5, 200);
    });
    f.object("robot", [&](SettingsReader& o) {
        o.only({"repeatability_mm", "repeatability_deg", "trigger_jitter_mm", "mode", "frames"});
        o.number("repeatability_mm", s.robot.repeatability_mm, 0, 10);
        o.number("repeatability_deg", s.robot.repeatability_deg, 0, 5);
        o.number("trigger_jitter_mm", s.robot.trigger_jitter_mm, 0, 50);
        std::string mode(to_string(s.robot.mode));
        o.text("mode", mode);
        if (const auto known = robot_mode_from_string(mode)) {
            s.robot.mode = *known;
        } else {
            o.keep(input_error(Text("\"{}\" is no mode", mode), o.path("mode"), "give e.g. \"automatic\""));
        }
        o.object("frames", [&](SettingsReader& frames) {
            for (const auto& [name, value] : frames.json().items())
                frames.pose(name.c_str(), s.robot.frames[name]);
        });
    });
    if (f.failed()) return tl::unexpected(f.error());
    return s;
}

}  // namespace seamwright
