#pragma once
// Whether a sensor resolves what a recipe needs, at this stand-off, before anything is taught with it.
//
// What it has: the pitch of its points along the contour, the step of its depth (a sensor that counts in steps of 10
// micrometre cannot place a point better, however quiet it is), the noise of a point, the share of lines without a
// return. From a profile of the contour or of anything like it, or from camera and laser plane at a place.
//
// What it needs follows from the recipe found in that very profile, and from the sigma that its reference point may have:
//     pitch     an end of a contour lies anywhere within a pitch: pitch / sqrt(12) <= sigma. A template's straight pieces
//               must hold three points: pitch <= L / 3, where nine tenths of its length lie on pieces of L or more.
//     points    that the feature rests on: kFewestPoints
//     depth     step / sqrt(12) <= sigma / 2
//     height    a template or corner stands out of it: height of the contour >= 6 noise
//     sigma     of the point as the finder states it, the shares of pitch and step with it, <= sigma
// Pitch and noise of a triangulating sensor grow with the distance and with its square: the cure is to come nearer, or a
// sensor of a narrower field.
//
// Noise model: normal, the same for x and z; of a profile contour_noise (contour_noise.h). Where that says that the points were
// measured f lines of the grid apart, pitch is f lines.

#include <optional>

#include "core/features/feature.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

struct SensorNumbers {
    double pitch_mm = 0;       // median distance of neighbours along the contour
    double depth_step_mm = 0;  // 0: no step is seen
    double noise_mm = 0;       // of a point, one axis
    double missing_share = 0;  // of the lines between the first and the last that returned
};
// Of a filtered profile. Error (input): fewer than 20 points of one contour.
Expected<SensorNumbers> sensor_numbers(const Profile& profile);
// Of a camera and its laser plane where a point stands (sensor frame, x and z), with the noise of a peak in pixels.
// nullopt: outside its view.
std::optional<SensorNumbers> sensor_numbers(const SensorModel& model, const Eigen::Vector2d& at_mm,
                                            double peak_noise_px = 0.1);

enum class ResolutionVerdict { resolves, marginal, does_not_resolve, not_found };
std::string_view name_of(ResolutionVerdict verdict);

struct ResolutionItem {
    std::string name;  // "pitch", "points", "depth_step", "height", "sigma", "missing"
    double has = 0, needs = 0;
    bool at_least = false;  // has >= needs is good; else has <= needs
    std::string unit;
    bool ok() const { return at_least ? has >= needs : has <= needs; }
    // Within 25 % of what is needed.
    bool close() const { return at_least ? has < 1.25 * needs : has > 0.8 * needs; }
};

struct ResolutionCheck {
    ResolutionVerdict verdict = ResolutionVerdict::not_found;
    SensorNumbers sensor;
    Feature feature;      // as found
    double sigma_mm = 0;  // of the reference point, pitch and step with it
    double reach = 0;  // how much nearer the sensor must come, 1 = as it stands; only where that is the cure
    std::vector<ResolutionItem> items;
    Text reason, cure;
};
// `profile`: filtered. `numbers`: absent: from the profile. Error (input): a recipe that is none, sigma that is not
// positive, too few points.
Expected<ResolutionCheck> check_resolution(const Profile& profile, const FeatureRecipe& recipe,
                                           double sigma_mm, const std::optional<SensorNumbers>& numbers = {});

}  // namespace seamwright
