#pragma once
// A scan on its drawing: where the part stands.
//
// Coarse (a start, three picked pairs, or the search of coarse.h), then point to plane from coarse to fine (refine.h),
// then generalised least squares with a model of the part's deviation of form (form_model.h), whose covariance is the
// stated one: noise and form apart. Frames: the cloud's is `base`, the mesh's is `part`.
//
// Never "ok" at a wrong place. Every pose that the search found, and the found one turned by quarter, third and half
// turns about the part's axes, tilted and shifted along them, is refined too; a rival that ends elsewhere and explains
// the scan as well is a reason to refuse. As well: the scan's points that are nearer to the part with the one pose than
// with the other, by more than what form and noise are anyway, do not speak clearly for one. Elsewhere: outside of the
// stated region. With a start, rivals further from it than the start's own tolerance are out.
//
// A sheet that is drawn with its thickness has two faces that explain a scan of one of them alike. Each face's points
// are put on the opposite one and refined; only what is seen of the sheet's ends, or much of both faces, then speaks
// for the one: not the nuts and clamps that stand on it. They may have drawn the fit to the wrong face, where the
// misfit of a curved sheet passes for deviation of form: each face is asked whether the other lies in the region that
// it would state, and what a point is off anyway is the form of the face that has less. Where every point has its
// side - towards the sensor, else its normal, outwards - it lies on a face that looks there. Normals of undecided
// sign are noticed and not used; those that all look inwards are not.
//
// Refused: under_determined, directions that the seen surface leaves open, named; ambiguous; no_fit, where the scan is
// not of this part or starts too far away. Degenerate: planes, cylinders and spheres leave directions open; boxes and
// other symmetric parts are ambiguous without a start.
//
// The pose is that of the drawing in the robot's base in the sense of the form's model: mean displacement of the real
// surface from it zero over the part. The covariance holds nothing of the robot's and the sensor's own calibration,
// which moves all points of a scan together (methods 8).

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/cloud/surface.h"
#include "core/text.h"

namespace seamwright {

enum class FitStatus { ok, ambiguous, under_determined, no_fit, cancelled };
const char* to_string(FitStatus status);

struct FitOptions {
    double noise_mm = 0;  // of a point along the normal; 0: the cloud's own, or estimated from neighbours
    std::optional<Pose> start;                            // base_from_part, roughly
    double start_mm = 60, start_deg = 20;                 // how roughly
    std::vector<Eigen::Vector3d> pairs_part, pairs_base;  // picked; three or more are a start
    double share_needed = 0.5;                            // of the scan's points that must lie on the part
    double form_limit_mm = 0;    // largest median distance; 0: 1.5 % of the part's size
    double sigma_limit_mm = 10;  // a direction known worse (3 sigma, at the points' spread) counts as open
    std::uint64_t seed = 1;
    std::function<bool()> cancelled;
};

struct FitRival {
    Pose base_from_part = Pose::Identity();
    std::size_t for_best = 0, for_rival = 0;  // points that speak for the one and for the other
    bool told_apart = false;
    bool too_far_from_start = false;  // out by the start alone
    bool other_face = false;          // on the opposite faces of the part's sheets
};

struct SurfaceFit {
    FitStatus status = FitStatus::no_fit;
    Text reason;  // empty when ok
    Pose base_from_part = Pose::Identity();
    // Of base_from_part, tangent of pose.h (base's axes); covariance = noise + form. Zero unless status is ok or
    // ambiguous.
    Matrix6 covariance = Matrix6::Zero(), covariance_noise = Matrix6::Zero();
    std::vector<Text> unobservable;          // directions in the part's frame
    double noise_mm = 0;                     // of a point, given or estimated
    double form_mm = 0, form_length_mm = 0;  // standard deviation of the form, and how far it is alike
    double gate_mm = 0;                      // points further off are none of this part
    double share_on_part = 0;                // of the scan's points within the gate
    std::size_t points = 0, points_used = 0;
    bool from_start = false;
    std::vector<FitRival> rivals;  // that ended elsewhere, the nearest to being as good first; at most 5
};

// Error (input): fewer than 50 points, not finite, an empty surface, pairs on a line.
Expected<SurfaceFit> fit_surface(const Cloud& cloud, const Surface& surface, const FitOptions& options);

// What fit_surface refuses before it begins, pairs aside.
Expected<void> check_fit_input(const Cloud& cloud, const Surface& surface, const FitOptions& options);

}  // namespace seamwright
