#pragma once
// The frame of one object with known features, seen by one or several placed cameras (thesis 2.3, (2.24)):
//     min over X = world_from_object  sum v_ij |Q(a_j, X b_i) - p_ij|^2
// Q projects through the camera's own lens, v is the weight of a sight: the inverse of its variance relative to the
// others, 0 = not detected.
//
// No start is needed: from rotations all over SO(3) the features are moved onto the rays (translation in closed form for
// a rotation, rotation in closed form for the points nearest on the rays, in turn; Lu, Hager and Mjolsness 2000, here
// with rays of several origins), the best of them refined on pixels. So four cameras that see one feature each are
// enough.
//
// Noise: pixels independent, of variance sigma^2 / v, sigma found from the redundancy or stated; each camera's place by
// its covariance, which is propagated into X and not solved for. The covariance is widened by Student's factor, so that
// 1.96 of its sigmas hold 95 %. A sight that contradicts the others (F test) is named and left out.

#include <optional>

#include "core/calibration/bundle/placed_camera.h"

namespace seamwright {

// One feature of the object in one camera.
struct BundleSight {
    std::string feature;  // the same in every camera that sees it
    std::size_t camera = 0;
    Eigen::Vector3d object_mm = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double weight = 1;
};

struct BundleOptions {
    std::vector<std::string> exclude;  // cameras or features
    std::optional<double> sigma_px;  // of one coordinate of a sight of weight 1; absent: from the redundancy
    std::optional<Pose> start;       // decides between places that explain the sights equally
};

struct SightResidual {
    Eigen::Vector2d off_px = Eigen::Vector2d::Zero();  // projected - seen
    bool used = false, wrong = false;
};

struct BundleResult {
    bool determined = false;
    Pose world_from_object = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    double rms_px = 0;                  // weighted, per sight
    double sigma_px = 0;                // of a sight of weight 1
    double worst_mm = 0;                // largest sigma of a feature
    int features = 0;                   // different ones, solved with
    std::vector<SightResidual> sights;  // as given
    std::optional<Pose> rival;          // another place that explains the sights as well
    CalibrationReport report;           // one row a camera; held out: a tenth of the features at a time
};

// A poor or undetermined answer whose object or cameras fit in metres or inches says so.
//
// Error (input): cameras that are none, object and cameras all within 10 mm of their origins (metres), a sight of no
// camera or outside its image, weights negative or not finite, the same feature at two places of the object, an
// unknown id excluded. Verdict undetermined: fewer than three features, all on one line, two places that fit equally
// and no start. Poor: three sigma at a feature above 1 mm, noise above 1.5 px or beyond what was stated, one camera
// against the others. Usable: above 0.2 mm or 0.5 px, no redundancy.
Expected<BundleResult> locate_object(const std::vector<PlacedCamera>& cameras,
                                     const std::vector<BundleSight>& sights, const BundleOptions& options);

}  // namespace seamwright
