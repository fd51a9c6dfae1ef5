#pragma once
// Image to peaks: where the stripe crosses each image line.
//
// A peak is a lobe of grey values that stands out from the light around it: it reaches half its height above
// its local background on one connected stretch of the line (a gap of one pixel, as speckle makes it, does
// not divide it). Two maxima whose valley stays above half of the lower one's height are one peak.
//
// Threshold. `threshold` is the height a peak needs above its background, in grey values. 0 chooses it for
// every part of the image: background and noise are measured on the frame itself in tiles of 32 x 32 pixels,
// without the stripe (see stripe_scan.h), a pixel becomes a candidate at 4 sigma and a peak needs 7 sigma in
// the sum over its width; peaks below 0.1 % of the strength that stripes have in this frame are left out. So
// neither uneven light nor a chessboard moves it. Pure noise gives a peak on less than one line in two
// hundred.
//
// Strength, which orders the peaks of a line, is the energy of the peak: the sum of grey values above
// background between the half-height points, times the height. What is no single hump counts less (speckled
// reflections), and so do an unsaturated flat top (a white square) and a single hot pixel.
//
// Positions. Even or sloping background is subtracted as a straight line through the levels on both sides;
// where it steps, only what stands above both sides counts. With noise of standard deviation s per pixel,
// amplitude A and a Gaussian stripe of standard deviation w (px) no estimator is better than (Cramer-Rao) s/A
// * sqrt(2 w/sqrt(pi)). Efficiency is bound/variance with shot and read noise, w = 1..4 px; "saturated" is a
// plateau of 16 to 50 px.
//   centre_of_gravity  mean weighted by grey value above background and a smooth window of the stripe's own
//   size that
//                      stands at the mean itself. Efficiency 0.90-1.0, saturated 0.17-0.35.
//   gaussian           least-squares parabola through ln(grey - background) with weights from the fitted
//   curve (three
//                      rounds), clipped pixels left out: where saturated, the flanks alone decide. Efficiency
//                      0.78-0.86, saturated 0.6-0.75: the choice for overexposed stripes.
//   steger             zero of the first derivative of the line smoothed by a Gaussian of `steger_sigma_px`,
//   widened
//                      to half width/sqrt(3) on wide stripes (Steger 1998), so that a plateau has one ridge.
//                      Efficiency 0.66-1.0 (best where w = sigma), saturated 0.2-0.35.
// Bias is below 0.01 px for w >= 0.8 px, at every phase of the pixel grid.

#include "core/error.h"
#include "core/profile/stripe/stripe_image.h"

namespace seamwright {

enum class PeakMethod {
    centre_of_gravity,  // intensity-weighted mean in a window of the stripe's size; the fast one
    gaussian,           // parabola through ln(grey) about the maximum; flanks only where saturated
    steger              // ridge of the smoothed line
};

struct PeakOptions {
    ScanLines scan = ScanLines::columns;
    PeakMethod method = PeakMethod::centre_of_gravity;
    int per_line = 3;      // K candidates handed over, strongest first; 1..64
    double threshold = 0;  // grey value above background; 0 = automatic (background and noise per frame)
    double min_width_px = 1.0, max_width_px = 80.0;  // full width at half height
    double steger_sigma_px = 2.0;                    // 0.5..20
};

// `peaks` keeps its capacity: no allocation after the first frame of a size (working memory is kept per
// thread). Refuses (Error): an empty image, a bit depth other than 8, 10, 12, 16, rows shorter than the
// width, 16-bit rows at odd addresses, options out of range.
Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks);

// Across which lines the stripe runs: the direction in which more neighbouring lines have their strongest
// peaks side by side. Equal (45 degrees, no stripe): columns.
Expected<ScanLines> guess_scan_lines(const StripeImage& image);

}  // namespace seamwright
