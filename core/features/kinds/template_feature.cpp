// Template: the taught piece of contour is found again in the profile and carries its reference point along
// (methods.md 2). The reference need not lie on the contour; its covariance is that of the registration
// carried to it, so it grows with the distance from the contour.

#include <Eigen/Core>
#include <cmath>

#include "core/features/kinds/feature_kinds.h"
#include "core/features/registration/registration.h"
#include "core/geometry/pose.h"

namespace seamwright {
namespace {

// A reflection that runs beside the contour for a good part of it, brighter than it, is followed by the
// filter and can carry the template along, millimetres off: then part of the template has no partner, and the
// rest misfits by a multiple of the noise. Either alone is common (a part seen in part, a part of another
// shape).
constexpr double kWholeShare = 0.8, kMostMisfit = 4;

std::vector<ParameterInfo> template_parameters() {
    return {
        {"window_dx_mm", "mm", 0, 1000, 10, 2, "How far along x the contour may have moved, +-."},
        {"window_dz_mm", "mm", 0, 1000, 10, 2, "How far along z the contour may have moved, +-."},
        {"window_dphi_deg", "deg", 0, 180, 15, 1, "How far the contour may have turned, +-."},
        {"minimum_share", "", 0, 1, 0.5, 2, "Share of the template that must be seen."},
    };
}

class TemplateFeature final : public FeatureFinder {
  public:
    TemplateFeature(ContourMatcher matcher, const SearchWindow& window, const Eigen::Vector2d& reference,
                    double share)
        : matcher_(std::move(matcher)), window_(window), reference_(reference), minimum_share_(share) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        const Registration r = matcher_.match(profile, window_);
        feature.rms_mm = r.rms_mm;
        feature.points_used = r.inliers;
        switch (r.status) {
            case RegistrationStatus::ok:
                feature.status = FeatureStatus::ok;
                break;
            case RegistrationStatus::no_points:
                feature.status = FeatureStatus::no_points;
                feature.message = "too few points for the template";
                return feature;
            case RegistrationStatus::no_match:
                feature.status = FeatureStatus::not_found;
                feature.message = "the template is not in the profile, or not within the search window";
                return feature;
            case RegistrationStatus::ambiguous:
                feature.status = FeatureStatus::ambiguous;
                feature.message = "the template fits at two places about equally well";
                break;
            case RegistrationStatus::sliding:
                feature.status = FeatureStatus::ill_conditioned;
                feature.message = "the contour may slide along itself: the template needs an edge or a bend";
                break;
            case RegistrationStatus::other_shape:
                feature.status = FeatureStatus::not_found;
                feature.message = "where a part of the template belongs stands another contour";
                return feature;
        }
        if (feature.status == FeatureStatus::ok && r.inlier_share < minimum_share_) {
            feature.status = FeatureStatus::not_found;
            feature.message = "less of the template is seen than required";
            return feature;
        }
        if (feature.status == FeatureStatus::ok && r.inlier_share < kWholeShare &&
            r.rms_mm > kMostMisfit * r.noise_mm) {
            feature.status = FeatureStatus::not_found;
            feature.message = "the template is seen in part only, and that has another shape: a reflection?";
            return feature;
        }
        feature.point_mm = r.scene_from_template * reference_;
        feature.phi_rad = r.scene_from_template.phi_rad;
        const Eigen::Vector2d arm =
            feature.point_mm - Eigen::Vector2d(r.scene_from_template.dx_mm, r.scene_from_template.dz_mm);
        Eigen::Matrix<double, 2, 3> j;
        j << 1, 0, -arm.y(), 0, 1, arm.x();
        feature.covariance_mm2 = j * r.covariance * j.transpose();
        return feature;
    }

  private:
    ContourMatcher matcher_;
    SearchWindow window_;
    Eigen::Vector2d reference_;
    double minimum_share_;
};

Expected<std::unique_ptr<FeatureFinder>> make_template(const FeatureRecipe& recipe) {
    SEAM_TRY(auto matcher, ContourMatcher::make(recipe.template_profile, recipe.template_reference_mm));
    return std::make_unique<TemplateFeature>(
        std::move(matcher), template_window(recipe.parameters), recipe.template_reference_mm,
        parameter(recipe.parameters, template_parameters(), "minimum_share"));
}

}  // namespace

SearchWindow template_window(const ParameterValues& values) {
    const auto infos = template_parameters();
    SearchWindow window;
    window.dx_mm = parameter(values, infos, "window_dx_mm");
    window.dz_mm = parameter(values, infos, "window_dz_mm");
    window.phi_rad = rad_from_deg(parameter(values, infos, "window_dphi_deg"));
    return window;
}

FeatureKind template_kind() {
    return {"template", "A taught piece of contour found again; it carries its reference point along.",
            template_parameters(), &make_template};
}

}  // namespace seamwright
