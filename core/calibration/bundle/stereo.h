#pragma once
// Points that two placed cameras see: each lies in the middle of the common perpendicular of its two rays (thesis 2.3).
//
// Noise: pixels independent, of one sigma a coordinate, stated or found from how far the rays pass each other (one number
// a point); each camera's place by its covariance. Both are propagated into the points, widened by Student's factor where
// sigma was found, so that 1.96 of a point's sigmas hold 95 %. What the rays do not show is an error along them: a wrong
// scale or a wrong distance leaves them meeting. Therefore the answer is good only where known points confirm it.

#include <array>
#include <optional>

#include "core/calibration/bundle/placed_camera.h"

namespace seamwright {

// The rays' distance there is `gap_mm`, with the sign of the first ray's side. nullopt: parallel rays, a ray that is not
// finite, a point behind a camera.
struct RayMeeting {
    Eigen::Vector3d world_mm = Eigen::Vector3d::Zero();
    double gap_mm = 0;
    double angle_rad = 0;  // between the rays
};
std::optional<RayMeeting> meet_rays(const PlacedCamera& first, const Eigen::Vector2d& first_pixel,
                                    const PlacedCamera& second, const Eigen::Vector2d& second_pixel);

struct StereoSight {
    std::string id;
    Eigen::Vector2d first_px = Eigen::Vector2d::Zero(), second_px = Eigen::Vector2d::Zero();
    std::optional<Eigen::Vector3d> known_mm;  // world; checks the answer and takes no part in it
};

struct StereoOptions {
    std::vector<std::string> exclude;
    std::optional<double> sigma_px;  // of one coordinate; absent: from the gaps
};

struct StereoPoint {
    std::string id;
    bool met = false;  // the rays meet before both cameras
    Eigen::Vector3d world_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double gap_mm = 0, gap_px = 0;  // gap_px: over what a pixel of noise makes of it
    double angle_deg = 0;
    std::optional<double> off_mm;  // from where it is known to be
};

struct StereoResult {
    std::vector<StereoPoint> points;  // as given
    double baseline_mm = 0;
    double sigma_px = 0;
    double gap_rms_mm = 0;
    double worst_mm = 0;      // largest sigma of a point
    double smallest_deg = 0;  // angle of two rays
    int known = 0;
    CalibrationReport report;  // one row a point; held out: the known points
};

// Error (input): cameras that are none or stand in one place, no points, ids missing or twice, pixels outside their
// image. Verdict undetermined: no rays meet. Poor: known points missed beyond chance, rays that pass each other to one
// pattern (a camera stands elsewhere), three sigma of a point above 1 mm, noise above 1.5 px. Usable: above 0.2 mm or 0.5
// px, no known point. A point whose rays pass each other beyond chance is two points: named and left out.
Expected<StereoResult> intersect(const PlacedCamera& first, const PlacedCamera& second,
                                 const std::vector<StereoSight>& sights, const StereoOptions& options);

}  // namespace seamwright
