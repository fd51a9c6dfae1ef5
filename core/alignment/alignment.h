#pragma once
// The frozen contour (methods.md 4; thesis 5.2.1, footnote 5): does the contour stand still while the robot
// passes the spot?
//
// Every profile of the pass is registered to one of them, the nearest to travel 0 to which the pass as a
// whole registers (a noisy profile or one with a ghost in it does not do), giving the shift dx(y), dz(y) of
// the spot's reference point and the turn dphi(y) against travel y. Polynomials of the lowest order that the
// data ask for (1..3, F test) are fitted robustly; their slopes at y = 0 are the misalignment, their bend the
// local radius, what registration and fits leave over is shape change. What counts is the reference point:
// an end of the contour that it lies on is followed by the last 10 mm of its own piece alone (contour_ends.h), which tells of the
// straightest sheet too; elsewhere the unbroken piece of the profile with it and what lies within 8 and 4 mm of it are followed as
// well, and the one that surely moves otherwise and drifts farthest is taken. An end at the rim of what the pass ever sees is none:
// that may be the field of view.
//
// Noise model: independent, equal noise of the registered shifts from profile to profile, estimated from the
// fits' residuals; the trigger profile's own noise is common to all and only moves the constant, so it takes
// no part in the fit.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/correction/correction.h"
#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

// One profile of the pass, at `travel_mm` along the sensor's +Y; 0 = trigger position.
struct TravelProfile {
    double travel_mm = 0;
    Profile profile;
};

struct AlignmentOptions {
    double jitter_mm = 5.0;      // half width of the trigger jitter
    double tolerance_mm = 0.05;  // error that the jitter may cause at most
    double window_mm = 20.0;     // profiles beyond this travel are not judged
    // The point whose drift counts, sensor frame (x, z). Absent: the centroid of the trigger profile.
    std::optional<Eigen::Vector2d> reference_mm;
};

enum class AlignmentStatus {
    frozen,    // the jitter causes at most the tolerance
    drifting,  // it causes more; `cure` says which rotation mends it
    // Stands still as a whole, but within the jitter the profile changes its shape, the contour stands off in places (a
    // notch, a wave), or is not found.
    shape_changes,
    not_enough_profiles,  // fewer than 5 usable profiles within the window, or less than 1 mm of travel
    // What is seen does not tell frozen from drifting: the drift's sigma is too large, or the pass leaves out much of the jitter.
    undetermined
};
std::string_view to_string(AlignmentStatus status);

// Registration of each profile to that of the trigger position: motion of the reference point and turn (from
// +x towards +z). `ok` false: not usable (NaN travel, no points, no match, outside the window).
struct TravelOffset {
    double travel_mm = 0, dx_mm = 0, dz_mm = 0, dphi_deg = 0, rms_mm = 0;
    bool ok = false;
};

struct AlignmentResult {
    AlignmentStatus status = AlignmentStatus::not_enough_profiles;
    // Angles of the slopes, signed like them: yaw = atan(dx/dy), pitch = atan(dz/dy). The contour runs along
    // (dx/dy, 1, dz/dy) in the sensor frame. Roll: turn of the profile (dphi, +x towards +z) over the
    // jitter's half width, i.e. twist.
    double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
    double dx_mm_per_mm = 0, dz_mm_per_mm = 0;
    // Infinite for a direction along which the profile slides on itself (straight line). Of such a line that is tilted a little
    // the other one holds what travel up to 6 degrees off along it would add. An end that steps by its points, and the noise of
    // the profile that the others are registered to, are in them: 95 % of the true angles lie within 1.96 sigma.
    double sigma_yaw_deg = 0, sigma_pitch_deg = 0;
    // Rotation of the sensor, together with its travel, that lets the contour stand still: right-handed about
    // the sensor's own Z first, then about its turned X, both through the reference point so that it stays in
    // view. About Z: -yaw; about X: pitch (times the cosine of yaw
    // in the tangent).
    double cure_about_z_deg = 0, cure_about_x_deg = 0;
    double radius_mm = std::numeric_limits<double>::infinity();  // of the contour's curvature; infinity when
                                                                 // straight within noise (3 sigma)
    double expected_error_mm = 0;        // largest shift within the jitter, from slope and curvature
    double expected_error_sigma_mm = 0;  // infinite where a direction is not seen
    // The largest of what within the jitter is no rigid motion along the fits, beyond noise: rms that remains after
    // registration; steady growth of one piece of the contour against another, or of a break in it (a gap); how far the
    // piece with the reference point moves otherwise than the whole; offsets that the fits leave, of three neighbours alike, or
    // scattered (two sigma) beyond five times what the registration states.
    double shape_change_mm = 0;
    bool sliding = false;               // the profile is a straight line: only the drift across it is seen
    ContourCurve curve;                 // of the reference point, for the correction, see correction.h
    std::vector<TravelOffset> offsets;  // in the order given
    Text cure;                          // what to do, in whole sentences; empty when frozen
};

// Refuses (Error): an empty pass, x and z of different length, options that are not positive and finite.
// Order and duplicates of travel do not matter.
Expected<AlignmentResult> check_alignment(std::span<const TravelProfile> pass,
                                          const AlignmentOptions& options);

}  // namespace seamwright
