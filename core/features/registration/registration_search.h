#pragma once
// The first half of the registration: where could the template be? (methods.md 2; thesis 3.2.1, 3.2.2)
//
// Both contours are reduced (3.21). Every pose of the search window is then rated coarsely: for a turn and a
// shift along x each reduced template point votes for the heights at which the scene's polygon would meet it.
// The best few poses start an EM-ICP each. The thesis starts one EM-ICP from the identity, which finds 10 mm
// and 15 degrees in most scenes only.
//
// All poses here map the template's centred coordinates to the scene's coordinates minus the template's
// origin: the shift is then the motion of the template's centroid, whatever the distance to the frame's
// origin.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "core/features/contour/contour_model.h"
#include "core/features/contour/contour_noise.h"
#include "core/features/registration/registration.h"
#include "core/features/registration/sheet_ends.h"

namespace seamwright {

struct CentredPose {
    double dx = 0, dz = 0, phi = 0, cosine = 1, sine = 0;
    CentredPose() = default;
    CentredPose(double dx_mm, double dz_mm, double phi_rad)
        : dx(dx_mm), dz(dz_mm), phi(phi_rad), cosine(std::cos(phi_rad)), sine(std::sin(phi_rad)) {}
    Eigen::Vector2d operator*(const Eigen::Vector2d& p) const {
        return {cosine * p.x() - sine * p.y() + dx, sine * p.x() + cosine * p.y() + dz};
    }
};

// A contour as a few weighted points: Ramer-Douglas-Peucker, then no edge longer than `spacing`. Weights are
// the lengths that the points stand for, at least half a spacing for the polygon's corners: they carry the
// shape.
struct ReducedContour {
    std::vector<double> x, z, weight;
    void clear();
};

// The scene made ready once per match.
struct SceneContour {
    std::vector<double> x, z;  // usable points, relative to the template's origin
    ContourPitch pitch;
    double sigma_mm = 0;
    ReducedContour reduced;  // sorted by x
    std::vector<JumpEnd> jumps;
    // Heights of the scene's polygon over a grid along x, up to kHeights each (overhangs, several layers).
    static constexpr int kHeights = 4;
    double grid_origin = 0, grid_step = 1;
    std::vector<std::uint8_t> grid_count;
    std::vector<float> grid_z;

    // Non-finite points, points marked as outliers and points farther than `reach` from `centre` (both
    // relative to `origin`, along x or z) are left out. Points in no order at all are sorted by x first.
    void gather(const Profile& scene, const Eigen::Vector2d& origin, const Eigen::Vector2d& centre,
                double reach);
    // Polygon, reduced points and height grid. Points without neighbours in the profile (spikes, clutter) are
    // left out of it, not of the finish.
    void reduce(double tolerance, double spacing);

  private:
    void add_polygon_edge(double x0, double z0, double x1, double z1);
    std::vector<double> scratch_, run_x_, run_z_;
    void take_solid(const std::vector<double>& px, const std::vector<double>& pz);
    void leave_out_mixed();              // points that stand in a step (ContourPitch::mixed)
    std::vector<double> all_x_, all_z_;  // of the whole profile
    std::vector<double> solid_x_, solid_z_;
    std::vector<std::array<double, 2>> mixed_;
    std::vector<int> kept_;
    std::vector<std::array<double, 3>> sorted_;
};

// Where the template's centroid may go at a given turn.
struct MotionBox {
    double x0, x1, z0, z1;
    bool contains(double dx, double dz, double margin) const {
        return dx >= x0 - margin && dx <= x1 + margin && dz >= z0 - margin && dz <= z1 + margin;
    }
};
MotionBox motion_box(const SearchWindow& window, const Eigen::Vector2d& origin,
                     const Eigen::Vector2d& reference, double phi);

struct SearchCandidate {
    CentredPose pose;
    double score = 0;  // weight of the reduced template points that meet the scene, 0..1
};

class RegistrationSearch {
  public:
    void prepare(const ContourModel& contour);  // reduces the template
    double step_mm() const { return step_; }
    double reduction_tolerance_mm() const { return tolerance_; }
    const ReducedContour& reduced() const { return reduced_; }

    // Fills `candidates`, best first, at most `most`, each after its EM-ICP.
    void find(const SceneContour& scene, const SearchWindow& window, const Eigen::Vector2d& origin,
              const Eigen::Vector2d& reference, int most, std::vector<SearchCandidate>& candidates);

    // Rates poses along the one-parameter motion in which the pose is least determined (a screw in the
    // template's frame: a slide for a straight contour, a turn about the centre for an arc) and returns the
    // best few.
    void find_along(const SceneContour& scene, const CentredPose& pose, const Eigen::Vector3d& body_twist,
                    double reach, double step, double tolerance, const SearchWindow& window,
                    const Eigen::Vector2d& origin, const Eigen::Vector2d& reference, int most,
                    std::vector<SearchCandidate>& candidates);

    // Share (0..1) of the reduced template that lies within `tolerance` of the scene's polygon in z,
    // tapering.
    double rate(const SceneContour& scene, const CentredPose& pose, double tolerance) const;

  private:
    void expectation_maximisation(const SceneContour& scene, CentredPose& pose) const;

    ReducedContour reduced_;
    double weight_sum_ = 1, step_ = 1, half_extent_ = 1, tolerance_ = 0.1;
    std::vector<double> turned_x_, turned_z_;
    std::vector<double> histogram_;
    std::vector<SearchCandidate> rated_;
};

// pose followed by the motion exp(amount * twist) in the template's own frame; twist = (vx, vz, turn).
CentredPose moved_along(const CentredPose& pose, const Eigen::Vector3d& body_twist, double amount);

}  // namespace seamwright
