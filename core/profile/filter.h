#pragma once
// Stripe tracking, filtering and segmentation by a geometric Brownian motion of the point spacing with a MAP
// update (methods.md 1; thesis 3.1).
//
// The thesis decides by the spacing alone, which has no direction. Here the spacing process stays the core
// (it says how far the contour has gone, (3.4), how sure that is, (3.5), and is updated by MAP, (3.7));
// beside it stands the direction of the contour, a running straight line whose direction may turn a little at
// every step, and the measuring noise across it. A point is accepted when it lies in the predicted band of
// both. Which points are outliers and where a segment starts is decided by the cheapest explanation of the
// whole profile: an outlier costs as much as a point at the rim of the band, a sharp edge of the contour
// costs about two outliers, a new segment more than `lookahead` of them. The cheapest explanation is found in
// one pass (dynamic programming, linear in the number of points), and checked in a second one from the other
// end wherever the first was not plain, so that a point near an edge or a jump is judged from its own side.
// Where more than `lookahead` points in a row are left out, a sharp edge costs half: a burst no longer explains
// them, and a small groove or ridge has three edges.
//
// Noise model: independent noise of x and z per point, normal, the same over the profile; its standard
// deviations are taken from the median of the second differences unless given. A spacing may be smaller than
// the noise. What cannot be told apart: an outlier nearer than band_sigmas to the contour; a step smaller
// than about six sigma or, between differently inclined pieces, one that a sharp edge explains; a piece
// shorter than min_segment_points.

#include <span>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

struct FilterOptions {
    double noise_mm =
        0;  // standard deviation of a measured coordinate; 0 = estimated from the profile itself
    double band_sigmas = 4.0;  // acceptance band in predicted standard deviations
    int lookahead = 3;         // n: a later point within n returns -> outliers in between, else a new segment
    double average = 0.15;     // alpha of the moving averages of drift and variance (3.20)
    double initial_sigma = 0.15;  // sigma of ln spacing at the start of a segment
    int min_segment_points =
        4;  // shorter pieces are outliers; more than lookahead, or a burst would be a segment
    // A finished profile counts as it was delivered: every return, as one segment. For sensors that filter by themselves.
    // The candidates of an image are chosen by the model all the same.
    bool as_delivered = false;
};

// MAP estimate of a spacing (3.6)-(3.7): argmax over s > 0 of
//   -(s_meas - s)^2/(2 sn^2) - ln s - (ln(s/s_0) - (mu - sigma^2/2) i)^2/(2 sigma^2 i).
// Closed form of the thesis (corrected d6) followed by a bounded number of safeguarded Newton steps: constant
// time, relative error below 1e-6. Where the density has two maxima (a measurement far above the prediction)
// the higher one. All in one length unit; s_meas may be zero or negative (noise larger than the spacing).
// Degenerate: sn = 0 gives s_meas, sigma = 0 or s_meas not finite gives the maximum of the prediction alone,
// s_0 <= 0 gives max(s_meas, 0).
double map_spacing(double s_meas, double s_0, double mu, double sigma, double sn, int i = 1);

// The thesis's approximation alone, (3.15)-(3.19) with the corrected d6 = ln(s_0) + 0.5: ln replaced by a
// quadratic about s_0, good within about +-50 % of it. NaN where the quadratic equation has no usable root.
double map_spacing_closed_form(double s_meas, double s_0, double mu, double sigma, double sn, int i = 1);

// Refuses (Error) options out of range; filter_profile and track_stripe begin with it.
Expected<void> check(const FilterOptions& options);

// Marks `profile.segment`: 0.. in order for accepted points, kOutlier for outliers and missing returns. A
// missing return (NaN, infinite or absurd coordinate; a code for it, no_return.h, becomes NaN) is a line without a point: the spacing to the next one
// grows with it. Refuses (Error): arrays of different length, options out of range. An empty profile is no
// error. Linear time; no allocation after the first profile of a size (the working memory belongs to the
// calling thread).
Expected<void> filter_profile(Profile& profile, const FilterOptions& options);

// Chooses one candidate per line (the most probable sequence under the model: dynamic programming over lines,
// time linear in lines and quadratic in per_line), then as above. A reflection is told from the stripe by
// beginning or ending where the stripe goes on, by standing far off, and by another brightness than lines
// with one candidate have nearby; the strongest candidate of a line has no advantage. `profile` gets one
// point a line: the chosen candidate; the strongest, marked kOutlier, where none belongs to the stripe; NaN
// where the line has none. The unit may be millimetre or pixel. The order of candidates within a line does
// not matter; a missing `intensity` means equal ones.
// `known` (empty, or one a slot): what is known of a candidate from elsewhere: 1 it lies on the contour, -1 it is a
// reflection, 0 nothing.
Expected<void> track_stripe(const ProfileCandidates& candidates, const FilterOptions& options,
                            Profile& profile, std::span<const signed char> known = {});

}  // namespace seamwright
