#pragma once
// A profile straight from the mesh: what a perfect extraction of a perfect image would give, plus noise per
// point. The fast way to thousands of profiles; frames (renderer.h) are the slow and complete one.
//
// One laser ray per image column, evenly spread over the field of view at the sensor's origin; a ray's point
// is its first hit, when the camera sees it too, else no return. Noise: independent and normal in x and z.
// Not modelled: reflections, speckle, blooming, dark surface.

#include "core/profile/profile.h"
#include "devices/simulated/scene/mesh.h"
#include "devices/simulated/scene/random.h"
#include "devices/simulated/scene/renderer.h"

namespace seamwright {

// Without noise. `optics.width` points, field_mm, stand_off_mm and triangulation_deg are used. Thread-safe.
void cut_profile(const MeshTree& part, const Pose& part_from_sensor, const OpticsSettings& optics,
                 Profile& profile);
void add_noise(Profile& profile, double sigma_mm, Random& random);

}  // namespace seamwright
