#pragma once
// A feature: the one point of a profile that a spot measures, with its covariance.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "core/profile/profile.h"
#include "core/text.h"

namespace seamwright {

enum class FeatureStatus {
    ok,
    no_points,       // fewer usable points in the search window than the kind needs
    not_found,       // points are there, the shape is not (no jump, no corner, match rejected)
    ambiguous,       // two places fit about equally well
    ill_conditioned  // found, but a direction is undetermined (parallel lines, arc too short): covariance is
                     // huge there
};
std::string_view to_string(FeatureStatus status);

// point (x, z) in the sensor frame; covariance of (x, z) in mm^2, from the points' noise as estimated from
// their own residuals. phi_rad only for kinds that measure a direction (template, corner): turn from +x
// towards +z.
struct Feature {
    FeatureStatus status = FeatureStatus::not_found;
    Eigen::Vector2d point_mm = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    Eigen::Matrix2d covariance_mm2 = Eigen::Matrix2d::Zero();
    std::optional<double> phi_rad;
    double rms_mm = 0;  // residual of the points that the feature rests on
    int points_used = 0;
    Text message;                            // empty when ok, else why, in plain words
    std::vector<Eigen::Vector2d> rivals_mm;  // ambiguous: the places between which nothing decides
};

// What is taught at a spot. `kind` names an entry of the registry (kinds/feature_registry.h).
struct FeatureRecipe {
    std::string kind = "contour-end";  // contour-end | corner | circle | extremum | template | sensor-point
    ParameterValues parameters;        // as described by the kind
    Profile template_profile;          // kind template only: the taught piece of contour
    Eigen::Vector2d template_reference_mm =
        Eigen::Vector2d::Zero();  // its landmark, need not lie on the contour
};

// A recipe made ready (template reduced, settings checked). find() allocates nothing after its first calls:
// its buffers live in the finder. Hence one thread per finder; several threads make a finder each from the
// same recipe.
class FeatureFinder {
  public:
    virtual ~FeatureFinder() = default;
    // `profile` must be filtered (segments marked).
    virtual Feature find(const Profile& profile) const = 0;
};

// A row of the registry (kinds/feature_registry.h).
struct FeatureKind {
    std::string_view name;
    std::string_view help;
    std::vector<ParameterInfo> parameters;
    Expected<std::unique_ptr<FeatureFinder>> (*make)(const FeatureRecipe&);
};

}  // namespace seamwright
