#pragma once
// What a set of sphere profiles determines, in words, and which pose to take next. Inner part of
// tcp_sphere.h.

#include <string>
#include <vector>

#include "core/calibration/sphere/tcp_sphere.h"
#include "core/calibration/sphere/tcp_sphere_solve.h"

namespace seamwright::tcp_sphere {

// Covariance factor (inverse information, to be multiplied by sigma^2) of the free parameters, by eigenvalues
// of the information on common scales: rotations on a lever of 100 mm about the working point, millimetres
// otherwise. weakest: largest standard deviation factor over all directions there (infinite when singular).
struct Determination {
    Matrix10 inverse = Matrix10::Zero();
    double weakest = 0;
    Vector10 weakest_direction = Vector10::Zero();  // in the scaled parameters (working point, 100 w, c, r)
};
Determination determination(const Matrix10& information, const Model& model,
                            const Eigen::Vector3d& working_point_sensor, bool radius_free);

// Sentences such as "all poses share one orientation about Y: rotate the flange about Y by 20 degrees or
// more". Empty when nothing in the poses explains a weak direction.
std::vector<Text> degenerate_pose_words(const std::vector<Section>& sections, const Model& model,
                                        bool radius_free);

// Greedy choice among views that keep the sphere in sight: turned by +-25 degrees about the sensor's axes and
// with the sphere a little to the side, nearer, or cut off its middle; each scored by the information of an
// arc of
// +-50 degrees with `points` points and noise sigma_mm.
std::vector<PoseProposal> propose_poses(const std::vector<Section>& sections, const Model& model,
                                        const Matrix10& information,
                                        const Eigen::Vector3d& working_point_sensor, bool radius_free,
                                        double sigma_mm, int count);

}  // namespace seamwright::tcp_sphere
