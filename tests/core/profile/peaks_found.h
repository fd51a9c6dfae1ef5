#pragma once
// Peaks of a drawn frame, by every method.

#include <gtest/gtest.h>

#include "core/profile/stripe/peaks.h"
#include "tests/core/profile/stripe_frames.h"

namespace seamwright::testing {

inline constexpr PeakMethod kMethods[] = {PeakMethod::centre_of_gravity, PeakMethod::gaussian,
                                          PeakMethod::steger};
inline const char* name_of(PeakMethod method) {
    return method == PeakMethod::centre_of_gravity ? "centre of gravity"
           : method == PeakMethod::gaussian        ? "gaussian"
                                                   : "steger";
}

inline StripePeaks found_in(const Frame& frame, const PeakOptions& options = {}) {
    StripePeaks peaks;
    const auto ok = find_peaks(frame.image(), options, peaks);
    EXPECT_TRUE(ok) << (ok ? "" : ok.error().sentence());
    return peaks;
}

}  // namespace seamwright::testing
