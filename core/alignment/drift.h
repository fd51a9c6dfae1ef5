#pragma once
// How the contour moves along the travel: the inside of check_alignment between registration and verdict (not for others).

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/alignment/pass_registration.h"
#include "core/correction/contour_fit.h"

namespace seamwright::alignment {

inline constexpr double kShortestTravel_mm = 1.0;

// Profiles within the window, the trigger's neighbours first.
std::vector<std::size_t> outwards_from_trigger(std::span<const TravelProfile> pass, double window_mm);

// How the contour moves in the profile along the travel.
struct Drift {
    std::vector<double> travel_mm, dx_mm, dz_mm, dphi_deg;
    PolynomialFit x, z, phi;
    double from = 0, to = 0;  // travel that was seen, the trigger included
    Eigen::Vector2d along = Eigen::Vector2d::Zero();
    Eigen::Vector2d grain_mm =
        Eigen::Vector2d::Zero();  // by which x and z step, where they are those of a last point

    void add(const TravelOffset& offset);
    // False: too little was seen.
    bool fit();
    // The farthest that the contour stands off within the jitter; after a turn that takes `share` of the slopes away.
    double farthest(double jitter_mm, double share = 0) const;
};

// What the polynomials leave of the motion within the jitter, and where: a notch, a weld nugget, a wave. One profile alone is a
// profile gone wrong, so the middle of three neighbours counts; and what exceeds the noise, which is told by neighbours: beside
// noise alone a line between two of them misses the one between by as much as the fit does.
struct StandOff {
    double most_mm = 0, at_mm = 0;
};
StandOff left_over(const Drift& drift, double jitter_mm);

// How far, two sigma, the contour stands now here and now there from profile to profile within the jitter, which no travel
// explains (a ripple shorter than the steps tell, a sensor that shakes); 0 where the registration's own noise does.
double scatter_beyond(const Reference& best, const Drift& drift, double jitter_mm);

// What counts is the drift where the reference point is. The whole contour's motion is another one where the profile is broken
// (a gap, a rim over a frame), where a part of it stands still (a swage beside an edge that runs off), and where a part grows:
// so the unbroken piece with the point, what is near it, and the end that it lies on are followed as well, and the one that
// differs and drifts farthest is taken. A field of view that cuts the contour makes an end that drifts against it, never farther.
// Answers by how much it differs within the jitter.
double follow_point(const Reference& best, std::span<const TravelProfile> pass,
                    const AlignmentOptions& options, Drift& drift, std::vector<TravelOffset>& offsets);

}  // namespace seamwright::alignment
