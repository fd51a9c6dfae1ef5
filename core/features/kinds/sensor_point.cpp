// Sensor point: a point that the sensor's own tools have measured, delivered as a profile of a few points.
//
// The profile says nothing of its noise: the covariance is the stated sigma of both coordinates, from the
// sensor's data sheet or from repeat measurements. Segments are not looked at: there is no contour.

#include <fmt/format.h>

#include <cmath>

#include "core/features/kinds/feature_kinds.h"

namespace seamwright {
namespace {

std::vector<ParameterInfo> sensor_point_parameters() {
    return {
        {"index", "", 0, 999, 0, 0, "Which of the sensor's points, from 0.", {}},
        {"sigma_mm", "mm", 0.0001, 100, 0.02, 4, "Noise of each coordinate (1 sigma).", {}},
    };
}

class SensorPoint final : public FeatureFinder {
  public:
    SensorPoint(std::size_t index, double sigma_mm) : index_(index), sigma_mm_(sigma_mm) {}
    Feature find(const Profile& profile) const override {
        Feature feature;
        if (index_ >= profile.size()) {
            feature.status = FeatureStatus::no_points;
            feature.message =
                Text("the sensor delivers {} points, number {} is meant", profile.size(), index_);
            return feature;
        }
        const Eigen::Vector2d point(profile.x_mm[index_], profile.z_mm[index_]);
        if (!point.allFinite()) {
            feature.message = "the sensor's own tool has found nothing";
            return feature;
        }
        feature.status = FeatureStatus::ok;
        feature.point_mm = point;
        feature.covariance_mm2 = sigma_mm_ * sigma_mm_ * Eigen::Matrix2d::Identity();
        feature.points_used = 1;
        return feature;
    }

  private:
    std::size_t index_;
    double sigma_mm_;
};

Expected<std::unique_ptr<FeatureFinder>> make_sensor_point(const FeatureRecipe& recipe) {
    const auto infos = sensor_point_parameters();
    return std::make_unique<SensorPoint>(
        static_cast<std::size_t>(std::lround(parameter(recipe.parameters, infos, "index"))),
        parameter(recipe.parameters, infos, "sigma_mm"));
}

}  // namespace

FeatureKind sensor_point_kind() {
    return {"sensor-point", "A point that the sensor's own tools have measured.", sensor_point_parameters(),
            &make_sensor_point};
}

}  // namespace seamwright
