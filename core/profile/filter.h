#pragma once
// Stripe tracking, filtering and segmentation by a geometric Brownian motion of the point spacing with a MAP update
// (methods.md 1; thesis 3.1).

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

struct FilterOptions {
    double noise_mm = 0;         // sn, standard deviation of a measured spacing; 0 = estimated from the profile itself
    double band_sigmas = 3.0;    // acceptance band in predicted standard deviations
    int lookahead = 3;           // n: a later point within n returns -> outliers in between, else a new segment
    double average = 0.15;       // alpha of the moving averages of drift and variance (3.20)
    double initial_sigma = 0.15; // sigma of ln spacing at the start of a segment
    int min_segment_points = 3;  // shorter pieces are outliers
};

// MAP estimate of a spacing (3.6)-(3.7): argmax over s > 0 of
//   -(s_meas - s)^2/(2 sn^2) - ln s - (ln(s/s_0) - (mu - sigma^2/2) i)^2/(2 sigma^2 i).
// Closed form of the thesis (corrected d6) followed by a fixed number of safeguarded Newton steps: constant time, relative error below 1e-6.
double map_spacing(double s_meas, double s_0, double mu, double sigma, double sn, int i = 1);

// Marks `profile.segment`: 0.. for accepted points, kOutlier for outliers and missing returns.
Expected<void> filter_profile(Profile& profile, const FilterOptions& options);

// Chooses one candidate per line (the most probable under the model), then as above. `profile` gets one point a line.
Expected<void> track_stripe(const ProfileCandidates& candidates, const FilterOptions& options, Profile& profile);

}  // namespace seamwright
