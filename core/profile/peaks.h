#pragma once
// Image to peaks: where the stripe crosses each image line.

#include "core/error.h"
#include "core/profile/stripe_image.h"

namespace seamwright {

enum class PeakMethod {
    centre_of_gravity,  // intensity-weighted mean above threshold; the fast one, exact on saturated plateaus
    gaussian,           // parabola through ln(grey) about the maximum; plateau middle where saturated
    steger              // ridge of the second derivative, smoothed by sigma
};

struct PeakOptions {
    ScanLines scan = ScanLines::columns;
    PeakMethod method = PeakMethod::centre_of_gravity;
    int per_line = 3;  // K candidates handed over, strongest first
    double threshold =
        0;  // grey value above background; 0 = automatic (background median and noise per frame)
    double min_width_px = 1.0, max_width_px = 80.0;
    double steger_sigma_px = 2.0;
};

// `peaks` keeps its capacity: no allocation after the first frame of a size. Refuses (Error): an empty image,
// a bit depth other than 8, 10, 12, 16, rows shorter than the width, options out of range.
Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks);

}  // namespace seamwright
