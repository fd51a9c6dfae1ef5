#pragma once
// The lobe measurement of lobe.h for eight narrow stripes at once, one in each lane of a SIMD register.
//
// Each lane holds the window of one run: kGroupMargin pixels before it, the run, kGroupMargin pixels after
// it. All walks along the line become loops over the rows of the windows with a mask per lane, so that no
// branch depends on a single grey value. The steps are those of LobeFinder (stretch, find_top, outline,
// find_background, centre_of_gravity, energy, unimodality) in single precision; a test compares the two.
// What the lanes do not cover is left to LobeFinder (kCareful): stripes of more than kBroad px, saturated or
// flat tops, a background with a step, runs that touch a higher lobe, and what reaches out of the window.
//
// The AVX2 and the portable kernel are one source and do the same operations in the same order (AVX2 alone
// brings no fused multiply-add): their results are identical.

#include <cstdint>

#include "core/profile/stripe/stripe_scan.h"

namespace seamwright::detail {

inline constexpr int kGroupLanes = 8;
inline constexpr int kGroupMargin = 16;  // px beside the run: flank, then kFootPixels of background
inline constexpr int kGroupRun = 40;     // px; longer runs are measured one at a time
inline constexpr int kGroupRows = kGroupRun + 2 * kGroupMargin;

// Bits of LobeGroup::outcome.
inline constexpr std::int32_t kCareful = 1;    // measure this run with LobeFinder instead
inline constexpr std::int32_t kPeak = 2;       // the results of the lane are a peak
inline constexpr std::int32_t kLeftMore = 4;   // pixels of the run before `left` rise again
inline constexpr std::int32_t kRightMore = 8;  // pixels of the run behind `right` rise again

// Positions are rows of the window; a lane's row 0 is the pixel kGroupMargin before its run.
struct alignas(32) LobeGroup {
    // Asked.
    int rows = 0;                                   // of the longest window, <= kGroupRows
    std::uint16_t pixels[kGroupRows][kGroupLanes];  // grey values; row-wise, one column a lane
    std::int32_t length[kGroupLanes];               // of the run, px
    float background[kGroupLanes], noise[kGroupLanes];
    float least_height[kGroupLanes];  // of a peak above its background
    float least_sigmas = 0;           // of a peak's energy; 0: none asked
    float min_width = 0, max_width = 0, full_scale = 0;
    bool centre_of_gravity = true;  // else `position` is the middle of the half-height points

    // Found. What is not kPeak has only `outcome`, and without kCareful the stretch `left`..`right`.
    std::int32_t outcome[kGroupLanes];
    std::int32_t left[kGroupLanes], right[kGroupLanes];  // outermost pixels at half height above `background`
    std::int32_t half_from[kGroupLanes], half_to[kGroupLanes];  // the same above the measured background
    std::int32_t top_first[kGroupLanes], top_last[kGroupLanes];
    float top[kGroupLanes], base[kGroupLanes], slope[kGroupLanes];
    float half_left[kGroupLanes], half_right[kGroupLanes];
    float position[kGroupLanes], strength[kGroupLanes];
};

void measure_group(LobeGroup& group, Kernel kernel);

}  // namespace seamwright::detail
