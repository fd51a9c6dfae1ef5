#pragma once
// Rigid registration of one contour in another (methods.md 2; thesis 3.2): the kernel of template matching,
// of the frozen contour and of drift checks.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

// Maps template coordinates to scene coordinates: p_scene = R(phi) p_template + (dx, dz); phi from +x towards
// +z.
struct PlanarMotion {
    double dx_mm = 0, dz_mm = 0, phi_rad = 0;
    Eigen::Vector2d operator*(const Eigen::Vector2d& p) const;
};

enum class RegistrationStatus {
    ok,
    no_points,
    no_match,
    ambiguous,
    sliding,  // a direction is undetermined: straight line
    other_shape  // placed by the rest of it: where more than a quarter of the template belongs is another contour
};
std::string_view to_string(RegistrationStatus status);

struct Registration {
    RegistrationStatus status = RegistrationStatus::no_match;
    PlanarMotion scene_from_template;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();         // of (dx, dz, phi): mm^2, mm rad, rad^2
    Eigen::Vector2d sliding_direction = Eigen::Vector2d::Zero();  // unit, in the scene; only for `sliding`
    double rms_mm = 0;
    // What rms_mm would be of noise alone, by the differences of neighbours in both; at least a tenth of the
    // template's pitch, which a curve through its points may be off.
    double noise_mm = 0;
    double inlier_share = 0;  // share of template points with a partner in the scene
    // Of the template's length the share at whose x the scene shows a surface elsewhere, not none: that has another
    // shape, or something lies before it. Looked for where the inlier share is below 0.85, else 0.
    double replaced_share = 0;
    int inliers = 0;  // scene points that the pose rests on
    int iterations = 0;
};

// What the window's shift is the motion of. Far from the frame's origin a turn alone moves the contour a lot
// (26 mm at 15 degrees and 100 mm), so "10 mm and 15 degrees off" means two different places.
enum class SearchPivot {
    reference,           // the landmark moves by at most dx, dz, while the contour turns about it
    reference_or_origin  // or the sensor's origin does, i.e. the motion's own (dx, dz): for motions of
                         // unknown making
};

// Where a scene point lies beside the template: at which part of its length (0..1), how far across it (mm,
// towards the left of the template's order).
struct ContourDeviation {
    double along = 0, across_mm = 0;
};

// How far from its taught place the template is looked for. The search reaches a little over the rim, so that
// a motion just on it is found; what is found farther out is `no_match`.
struct SearchWindow {
    double dx_mm = 10, dz_mm = 10, phi_rad = 0.2618;      // +-
    Eigen::Vector2d centre_mm = Eigen::Vector2d::Zero();  // expected motion of the template's reference
    SearchPivot pivot = SearchPivot::reference;
};

// A template made ready: reduced by Ramer-Douglas-Peucker, line directions and index precomputed.
// match(): EM-ICP on the reduced sets for the start, then a robust trimmed point-to-line finish on all points
// with a windowed search along x. Allocates nothing after its first calls: the buffers live in the matcher,
// hence one thread per matcher (make it again for another thread).
class ContourMatcher {
  public:
    // Refuses templates with fewer than 5 points or without extent. `reference_mm` is the landmark of the
    // search window.
    static Expected<ContourMatcher> make(const Profile& contour, const Eigen::Vector2d& reference_mm);
    ContourMatcher(ContourMatcher&&) noexcept;
    ContourMatcher& operator=(ContourMatcher&&) noexcept;
    ~ContourMatcher();
    // Scene points marked as outliers are left out. Full search.
    Registration match(const Profile& scene, const SearchWindow& window) const;
    // Only the finish, from a start within about a millimetre: consecutive profiles, tracking.
    Registration refine(const Profile& scene, const PlanarMotion& start) const;
    // Of every scene point within `reach_mm` of the template at the given pose, on straights and bends (not
    // on walls).
    void deviations(const Profile& scene, const PlanarMotion& scene_from_template, double reach_mm,
                    std::vector<ContourDeviation>& out) const;

  private:
    struct Impl;
    explicit ContourMatcher(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
