#include "projects/reuse/mirror.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "core/number_text.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

Eigen::Matrix3d reflection(const Eigen::Vector3d& normal) {
    return Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
}

// S T K for a reflection K through the origin of the frame on the right.
Pose reflected(const MirrorPlane& plane, const Pose& pose, const Eigen::Matrix3d& right) {
    return make_pose(reflection(plane.normal) * pose.linear() * right,
                     mirrored_point(plane, pose.translation()));
}

bool along_axis(const Eigen::Vector3d& normal) {
    return normal.cwiseAbs().maxCoeff() > 1 - 1e-12;
}

bool alike(const FreeDof& free, int first) {
    const auto i = static_cast<std::size_t>(first);
    return free[i] == free[i + 1] && free[i] == free[i + 2];
}

void swap_choice(FeatureRecipe& recipe, const char* name, int a, int b) {
    const FeatureKind* kind = feature_kind(recipe.kind);
    const int value = static_cast<int>(std::lround(parameter(recipe.parameters, kind->parameters, name)));
    if (value == a) recipe.parameters[name] = b;
    if (value == b) recipe.parameters[name] = a;
}

void negate_range(FeatureRecipe& recipe, const char* from, const char* to) {
    if (!recipe.parameters.count(from) && !recipe.parameters.count(to)) return;  // the defaults are symmetric
    const FeatureKind* kind = feature_kind(recipe.kind);
    const double a = parameter(recipe.parameters, kind->parameters, from);
    const double b = parameter(recipe.parameters, kind->parameters, to);
    recipe.parameters[from] = -b;
    recipe.parameters[to] = -a;
}

template <class T>
void reverse(std::vector<T>& values) {
    std::reverse(values.begin(), values.end());
}

}  // namespace

Expected<MirrorPlane> parse_mirror_plane(const std::string& text, double offset_mm) {
    MirrorPlane plane;
    plane.offset_mm = offset_mm;
    if (text == "x" || text == "y" || text == "z") {
        plane.normal = Eigen::Vector3d::Unit(text[0] - 'x');
        return plane;
    }
    Eigen::Vector3d n = Eigen::Vector3d::Zero();
    std::string_view rest(text);
    bool understood = std::count(text.begin(), text.end(), ',') == 2;
    for (int i = 0; i < 3 && understood; ++i) {
        const auto end = std::min(rest.find(','), rest.size());
        const std::string_view part = rest.substr(0, end);
        const auto from = part.find_first_not_of(' '), to = part.find_last_not_of(' ');
        const auto number = from == std::string_view::npos
                                ? std::nullopt
                                : number_from<double>(part.substr(from, to - from + 1));
        understood = number.has_value();
        n[i] = number.value_or(0);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    if (!understood || !n.allFinite() || n.norm() < 1e-9)
        return input_error("the mirror plane is not understood", text,
                           "give x, y, z or a normal such as 0.1,1,0");
    plane.normal = n.normalized();
    return plane;
}

Eigen::Vector3d mirrored_point(const MirrorPlane& plane, const Eigen::Vector3d& p) {
    return p - 2 * plane.normal * (plane.normal.dot(p) - plane.offset_mm);
}

Pose mirrored_displacement(const MirrorPlane& plane, const Pose& displacement) {
    const Eigen::Matrix3d r = reflection(plane.normal);
    return make_pose(r * displacement.linear() * r, r * displacement.translation());
}

Matrix6 mirrored_covariance(const MirrorPlane& plane, const Matrix6& covariance) {
    const Eigen::Matrix3d r = reflection(plane.normal);
    Matrix6 j = Matrix6::Zero();
    j.topLeftCorner<3, 3>() = r;
    j.bottomRightCorner<3, 3>() = -r;
    return j * covariance * j.transpose();
}

Profile mirrored_profile(const Profile& profile) {
    Profile out = profile;
    reverse(out.x_mm);
    reverse(out.z_mm);
    reverse(out.intensity);
    reverse(out.segment);
    for (double& x : out.x_mm) x = -x;
    std::int32_t last = kOutlier;
    for (const std::int32_t s : out.segment) last = std::max(last, s);
    for (std::int32_t& s : out.segment)
        if (s != kOutlier) s = last - s;
    return out;
}

Expected<FeatureRecipe> mirrored_recipe(const FeatureRecipe& recipe) {
    const FeatureKind* kind = feature_kind(recipe.kind);
    if (!kind) return input_error("the feature kind is not known", recipe.kind, "choose a known one");
    FeatureRecipe out = recipe;
    if (recipe.kind != "template") negate_range(out, "window_x_min_mm", "window_x_max_mm");
    if (recipe.kind == "contour-end") {
        swap_choice(out, "side", 0, 1);
        negate_range(out, "field_x_min_mm", "field_x_max_mm");
    } else if (recipe.kind == "extremum") {
        swap_choice(out, "which", 2, 3);
    } else if (recipe.kind == "corner") {
        negate_range(out, "left_from_mm", "right_to_mm");
        negate_range(out, "left_to_mm", "right_from_mm");
        swap_choice(out, "which", 3, 4);
    } else if (recipe.kind == "template") {
        out.template_profile = mirrored_profile(recipe.template_profile);
        out.template_reference_mm.x() = -recipe.template_reference_mm.x();
    } else if (recipe.kind != "circle") {  // a circle looks the same from both sides
        return input_error("how this feature kind is mirrored is not known", recipe.kind,
                           "teach the spot with another kind");
    }
    return out;
}

Expected<Project> mirrored_project(const Project& project, const MirrorPlane& plane) {
    if (!plane.normal.allFinite() || std::abs(plane.normal.norm() - 1) > 1e-9 ||
        !std::isfinite(plane.offset_mm))
        return input_error("the mirror plane has no unit normal", "plane", "give x, y, z or a normal");
    if (!project.panel_jobs.empty())
        return input_error("a gripper with its sensors has no mirror image that is only taught differently",
                           Text("panel job {}", project.panel_jobs.front().id),
                           "teach the panel job of the other side; mirror the project without it");
    Project out = project;
    if (out.fleet) out.fleet->station.clear();  // the other door's, not this one's
    const Eigen::Matrix3d sensor_mirror = Eigen::Vector3d(-1, 1, 1).asDiagonal();

    out.part.base_from_workobject =
        project.part.base_from_workobject * reflected(plane, Pose::Identity(), reflection(plane.normal));

    for (Spot& spot : out.spots) {
        const Calibration* calibration = calibration_of(project, spot);
        if (!calibration)
            return input_error("the sensor has no calibration in use, its pose on the part is unknown",
                               Text("spot {}", spot.id), "calibrate the sensor first");
        const auto mirror_flange = [&](Pose& base_from_flange) {
            const Pose workobject_from_sensor = project.part.base_from_workobject.inverse() *
                                                base_from_flange * calibration->flange_from_sensor;
            base_from_flange = project.part.base_from_workobject *
                               reflected(plane, workobject_from_sensor, sensor_mirror) *
                               calibration->flange_from_sensor.inverse();
        };
        mirror_flange(spot.base_from_flange);
        for (Pose& via : spot.via) mirror_flange(via);
        auto recipe = mirrored_recipe(spot.feature);
        if (!recipe) {
            Error error = recipe.error();
            error.within(Text("spot {}", spot.id));
            return tl::unexpected(std::move(error));
        }
        spot.feature = std::move(*recipe);
        spot.reference_mm.x() = -spot.reference_mm.x();
        spot.reference_profile = mirrored_profile(spot.reference_profile);
        if (spot.drawn) spot.drawn->reference_mm.x() = -spot.drawn->reference_mm.x();
        if (spot.curve) spot.curve->x_coefficients = -spot.curve->x_coefficients;
    }

    out.elastic.clear();  // the other part's; this one's are learnt from its own runs
    for (Region& region : out.regions) {
        region.offsets.clear();  // found on the other part
        region.offset_switches.clear();
        if (!along_axis(plane.normal) && !(alike(region.free, 0) && alike(region.free, 3)))
            return input_error("an oblique plane mixes its free and fixed degrees of freedom",
                               Text("region {}", region.id),
                               "mirror about x, y or z, or free all translations and rotations");
        const Pose workobject_from_frame =
            project.part.base_from_workobject.inverse() * region.base_from_frame;
        region.base_from_frame = project.part.base_from_workobject *
                                 reflected(plane, workobject_from_frame, reflection(plane.normal));
    }

    if (!out.part.mesh_ply.empty()) {
        SEAM_TRY(auto mesh, mesh_from_ply(out.part.mesh_ply, "the part of " + project.name));
        for (Eigen::Vector3d& vertex : mesh.vertices) vertex = reflection(plane.normal) * vertex;
        for (Eigen::Vector3i& triangle : mesh.triangles)
            std::swap(triangle[1], triangle[2]);  // outside stays outside
        out.part.mesh_ply = ply_bytes(mesh);
        out.part.mesh_source = fmt::format("{} (mirrored)", project.part.mesh_source);
    }
    return out;
}

}  // namespace seamwright
