#pragma once
// The profiles of a pass registered to one of them: the inside of check_alignment (not for others).

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/features/registration/registration.h"

namespace seamwright::alignment {

inline constexpr int kFewestProfiles = 5;

struct Registered {
    Eigen::Vector2d shift = Eigen::Vector2d::Zero();
    double phi = 0, rms = 0, share = 0;
    double sigma_mm = 0;                               // of the shift's larger axis, by the registration
    Eigen::Vector2d slides = Eigen::Vector2d::Zero();  // direction, zero when the profile has a shape
    bool ok = false;
};

// A profile as the one that the others are registered to.
struct Reference {
    std::size_t index = 0;
    ContourMatcher matcher;
    std::vector<Registered> found;
    double quality = 0;  // profiles that register, by the share that they show; half for those that slide
    bool good = false;   // most do, and with most of the contour
};

// Neither lost nor left out by the filter.
bool usable(const Profile& p, std::size_t i);
// Of the usable points.
Eigen::Vector2d centroid(const Profile& p);

// The motion as taken over, i.e. without what a straight line creeps along itself.
PlanarMotion motion_of(const Registered& r, const Eigen::Vector2d& reference);
// Of a straight line through the values, where it is beyond its noise; else 0.
double sure_slope(const std::vector<double>& travel, const std::vector<double>& value);
// What lies farther from the contour is no part of it.
inline constexpr double kReach_mm = 2.0;

// The nearest to travel 0 that has about as many points and about as little noise as the pass usually shows,
// and to which most of the pass registers. Where none is good, the best of a few.
std::optional<Reference> choose_reference(std::span<const TravelProfile> pass,
                                          const std::vector<std::size_t>& order,
                                          const std::optional<Eigen::Vector2d>& point);

// The same, of that piece of the reference's profile alone that is unbroken and nearest to the point or, with `within_mm` finite,
// of what lies so near to it.
// Nothing where that is the whole profile, or too short, straight, or not found in most of the pass.
std::optional<Reference> register_piece(const Reference& reference, std::span<const TravelProfile> pass,
                                        const std::vector<std::size_t>& order, const Eigen::Vector2d& point,
                                        double within_mm);

// How much the pieces of the contour grow or sink against each other within the jitter, beyond their noise.
double growth_mm(const Reference& reference, std::span<const TravelProfile> pass,
                 const Eigen::Vector2d& point, double jitter_mm);

}  // namespace seamwright::alignment
