#pragma once
// Points of a scan, and what is done to them before they are compared with a part.
//
// All lengths are millimetres, all points of one cloud in one frame (the robot's base, or the work object). Noise
// model: each point errs by `sigma_mm` along the surface's normal, independently of the others; what neighbouring
// points have in common (the part's form, the robot's path) is no noise and is estimated by fit.h.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/pose.h"
#include "core/profile/profile.h"

namespace seamwright {

struct Cloud {
    std::vector<Eigen::Vector3d> points;   // mm, finite
    std::vector<Eigen::Vector3f> normals;  // empty or one a point: unit, or zero where none is known
    std::vector<Eigen::Vector3f> towards;  // empty or one a point: unit, to the sensor that saw it
    std::vector<float> sigma_mm;           // empty or one a point; 0: not stated

    std::size_t size() const { return points.size(); }
    bool empty() const { return points.empty(); }
    bool has_normals() const { return !points.empty() && normals.size() == points.size(); }
    bool has_towards() const { return !points.empty() && towards.size() == points.size(); }
    bool has_sigma() const { return !points.empty() && sigma_mm.size() == points.size(); }
    Eigen::AlignedBox3d box() const;
};

// Every point, normal and direction through `to_from`.
void transform(Cloud& cloud, const Pose& to_from);
// The points at `index`, in that order.
Cloud picked(const Cloud& cloud, const std::vector<std::size_t>& index);
// Appends `more`; a column that either of them lacks is empty afterwards.
void append(Cloud& cloud, const Cloud& more);

// The returns of a profile, base_from_sensor * (x, 0, z), seen along the sensor's Z. Points without return and, of
// a filtered profile, its outliers are left out. sigma_mm 0: not stated.
void append_profile(Cloud& cloud, const Profile& profile, const Pose& base_from_sensor, double sigma_mm = 0);

// One point a cell of a grid of cubes: the mean of what lies in it, sigma that of a mean of independent points; two where it
// was seen from opposite sides (towards). In the order of the cells' first points. cell_mm > 0.
// `counts`: of how many points each is the mean.
Cloud voxel_grid(const Cloud& cloud, double cell_mm, std::vector<std::uint32_t>* counts = nullptr);
// The same with the smallest cell of a halving series that leaves at most `most` points; the cloud itself where it
// has no more.
Cloud thinned(const Cloud& cloud, std::size_t most, std::vector<std::uint32_t>* counts = nullptr);

// Statistical outliers (Rusu, Semantic 3D Object Maps, 2010; PCL's filter): a point whose mean distance to its
// `neighbours` nearest exceeds the cloud's mean of it by `ratio` standard deviations. True: keep. A cloud of fewer
// than neighbours + 1 points is kept whole.
std::vector<char> statistical_inliers(const Cloud& cloud, int neighbours = 12, double ratio = 3);

// Normals from the plane through each point's `neighbours` nearest; towards the sensor where `towards` is known,
// else of undecided sign. Zero where the neighbours lie on a line.
void estimate_normals(Cloud& cloud, int neighbours = 16);

// Median distance from a point to its nearest neighbour, from at most 2000 points; 0 for fewer than two.
double spacing_mm(const Cloud& cloud);

}  // namespace seamwright
