#pragma once
// What a sensor will see of the drawing: the profile before there is metal, and the feature that it holds.
//
// The cut of the drawing with the laser plane, ray by ray from the laser, hidden where something stands before the laser
// or before the camera (devices/simulated/scene/profile_cut.h). Noise of the points: independent and normal in x and z.
// Not in it: reflections, dark surfaces, what the drawing leaves out.

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/features/feature.h"
#include "core/profile/filter.h"
#include "devices/simulated/scene/mesh.h"
#include "devices/simulated/scene/renderer.h"
#include "projects/model/project.h"

namespace seamwright {

// How a sensor looks: stand-off, angle of triangulation and field where the laser's middle is, from its calibration's camera
// and laser plane; what a calibration without camera does not say stays as it is in `otherwise`.
OpticsSettings optics_of(const Calibration& calibration, const OpticsSettings& otherwise);

struct ExpectedFeature {
    FeatureRecipe recipe;
    Eigen::Vector2d point_mm;        // sensor frame
    Eigen::Matrix2d covariance_mm2;  // as the recipe's kind states it, of the profile below
    Profile profile;                 // filtered, with the noise of the sensor
};
// Of the kinds template, corner and contour-end the one that knows the landmark (sensor frame, x and z) best; nullopt: none
// finds it. Several profiles with noise are drawn, the one of middling covariance is given. Deterministic.
std::optional<ExpectedFeature> expected_feature(const MeshTree& part, const Pose& workobject_from_sensor,
                                                const OpticsSettings& optics, const FilterOptions& filter,
                                                double noise_mm, std::uint64_t seed,
                                                const Eigen::Vector2d& landmark_mm);

}  // namespace seamwright
