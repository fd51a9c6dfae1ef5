#include "projects/placing/expected_profile.h"

#include <algorithm>
#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "devices/simulated/scene/profile_cut.h"
#include "devices/simulated/scene/random.h"

namespace seamwright {
namespace {

constexpr double kTemplateReachMm = 22;  // about the landmark
constexpr std::size_t kFewestPoints = 60;
constexpr int kDraws = 3;
constexpr double kNearMm = 0.3;    // of the landmark: what is found farther away is something else
constexpr double kFarthestMm = 3;  // the end of a rounded sheet lies off its edge by its radius

Profile piece_about(const Profile& profile, const Eigen::Vector2d& landmark) {
    Profile piece;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (profile.segment[i] == kOutlier || !std::isfinite(profile.z_mm[i])) continue;
        if ((Eigen::Vector2d(profile.x_mm[i], profile.z_mm[i]) - landmark).norm() > kTemplateReachMm)
            continue;
        piece.x_mm.push_back(profile.x_mm[i]);
        piece.z_mm.push_back(profile.z_mm[i]);
        piece.segment.push_back(profile.segment[i]);
    }
    return piece;
}

std::vector<FeatureRecipe> recipes(const Profile& clean, const Eigen::Vector2d& landmark) {
    std::vector<FeatureRecipe> all;
    FeatureRecipe shape;
    shape.kind = "template";
    shape.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
    shape.template_profile = piece_about(clean, landmark);
    shape.template_reference_mm = landmark;
    if (shape.template_profile.size() >= kFewestPoints) all.push_back(shape);
    for (const double side : {0.0, 1.0}) {
        FeatureRecipe end;
        end.kind = "contour-end";
        end.parameters = {{"side", side}};
        all.push_back(end);
    }
    all.emplace_back().kind = "corner";
    return all;
}

double worst(const Eigen::Matrix2d& c) {
    const double mean = (c(0, 0) + c(1, 1)) / 2;
    return mean + std::hypot((c(0, 0) - c(1, 1)) / 2, c(0, 1));
}

}  // namespace

OpticsSettings optics_of(const Calibration& calibration, const OpticsSettings& otherwise) {
    OpticsSettings optics = otherwise;
    if (!calibration.model || calibration.model->table) return optics;
    const SensorModel& model = *calibration.model;
    const Eigen::Vector3d camera = model.camera_from_laser.inverse().translation();
    if (!(camera.z() > 1) || model.camera.width < 2) return optics;
    optics.stand_off_mm = camera.z();
    optics.triangulation_deg = deg_from_rad(std::atan2(std::hypot(camera.x(), camera.y()), camera.z()));
    const auto middle = model.to_pixel({0, 0});
    if (!middle) return optics;
    const auto left = model.to_laser({0, middle->y()});
    const auto right = model.to_laser({model.camera.width - 1.0, middle->y()});
    if (left && right) optics.field_mm = 2 * std::min(std::abs(left->x()), std::abs(right->x()));
    optics.width = std::clamp(model.camera.width, 64, 1280);
    return optics;
}

std::optional<ExpectedFeature> expected_feature(const MeshTree& part, const Pose& workobject_from_sensor,
                                                const OpticsSettings& optics, const FilterOptions& filter,
                                                double noise_mm, std::uint64_t seed,
                                                const Eigen::Vector2d& landmark_mm) {
    Profile cut;
    cut_profile(part, workobject_from_sensor, optics, cut);
    if (static_cast<std::size_t>(std::count_if(cut.z_mm.begin(), cut.z_mm.end(),
                                               [](double z) { return std::isfinite(z); })) < kFewestPoints)
        return std::nullopt;
    std::vector<Profile> noisy(kDraws, cut);
    for (int draw = 0; draw < kDraws; ++draw) {
        Profile& profile = noisy[static_cast<std::size_t>(draw)];
        Random random(seed, static_cast<std::uint64_t>(draw));
        add_noise(profile, noise_mm, random);
        if (!filter_profile(profile, filter)) return std::nullopt;
    }
    if (!filter_profile(cut, filter)) return std::nullopt;
    std::optional<ExpectedFeature> best;
    for (const FeatureRecipe& recipe : recipes(cut, landmark_mm)) {
        const auto finder = make_feature_finder(recipe);
        if (!finder) continue;
        const Feature clean = (*finder)->find(cut);
        if (clean.status != FeatureStatus::ok) continue;
        const double near = recipe.kind == "template" ? kNearMm : kFarthestMm;
        if ((clean.point_mm - landmark_mm).norm() > near) continue;
        std::vector<std::pair<double, std::size_t>> found;
        std::vector<Feature> features;
        for (const Profile& profile : noisy) {
            features.push_back((*finder)->find(profile));
            const Feature& f = features.back();
            if (f.status == FeatureStatus::ok && (f.point_mm - clean.point_mm).norm() < near)
                found.emplace_back(worst(f.covariance_mm2), features.size() - 1);
        }
        if (found.size() < noisy.size()) continue;  // not surely found
        std::sort(found.begin(), found.end());
        const auto [middling, draw] = found[found.size() / 2];
        if (!std::isfinite(middling) || (best && middling >= worst(best->covariance_mm2))) continue;
        best = ExpectedFeature{recipe, clean.point_mm, features[draw].covariance_mm2, noisy[draw]};
    }
    return best;
}

}  // namespace seamwright
