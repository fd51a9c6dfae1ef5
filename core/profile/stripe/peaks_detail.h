#pragma once
// Extraction with a chosen kernel, for the test that both give the same.

#include "core/profile/stripe/peaks.h"
#include "core/profile/stripe/stripe_scan.h"

namespace seamwright::detail {
Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks,
                          Kernel kernel);
}  // namespace seamwright::detail
