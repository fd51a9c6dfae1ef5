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

// Of the usable points.
Eigen::Vector2d centroid(const Profile& p);

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

// Where in every profile that end of the contour stands, or that side of a break, on which the reference point lies (within 1.5
// mm): off its place by the registration, in the reference's frame; nothing where it is not seen. Empty: none is as near.
// An end is the last point of a contour, which steps by whole points where the edge moves by less: by up to `grain_mm`.
struct EndOffsets {
    std::vector<std::optional<Eigen::Vector2d>> off;
    double grain_mm = 0;
    bool broken = false;  // the contour has more ends than its two
};
EndOffsets end_offsets(const Reference& reference, std::span<const TravelProfile> pass,
                       const std::vector<std::size_t>& order, const Eigen::Vector2d& point);

// How much the pieces of the contour grow or sink against each other within the jitter, beyond their noise.
double growth_mm(const Reference& reference, std::span<const TravelProfile> pass,
                 const Eigen::Vector2d& point, double jitter_mm);

// How much the two sides of a break in the contour (a gap, a sheet over another) part within the jitter, beyond their noise:
// the most over its breaks.
double parting_mm(const Reference& reference, std::span<const TravelProfile> pass,
                  const Eigen::Vector2d& point, double jitter_mm);

}  // namespace seamwright::alignment
