#pragma once
// Values that stand for "no return". A sensor writes one and the same number (-9999, -32768, -99.999, 0,
// 9999.99) where it saw nothing; taken for heights they are a straight, dense contour with two ends.

#include <string>
#include <vector>

#include "core/profile/profile.h"
#include "core/text.h"

namespace seamwright {

struct NoReturnCode {
    double value = 0;
    int points = 0;
};

// The heights that are no heights, at most kMostNoReturnCodes. A code is one value to the last bit, in at
// least three points and in a pair of neighbours, where the other points carry noise (drawn contours have
// flats of one value; a code written like one may stand far off those too), and either
//     far off: farther than five times their spread (95 % of them) and 50 mm from the others, or
//     written like a code (0; all nines; a limit of 16 or 32 bits; with the decimal point anywhere) and in
//     runs too long for chance: with the share q of neighbours that agree among the other points, a run of L
//     has n q^(L - 1) < 1e-4 (unless the others lie about it in steps, as a coarse sensor's do); or alone, with no other point within 0.2 mm.
// Unit: as the profile. Not seen: a code among heights like it that stands in single points.
inline constexpr std::size_t kMostNoReturnCodes = 4;
// Allocates nothing where there is none, after the first profile of a size.
std::vector<NoReturnCode> find_no_return_codes(const Profile& profile);

// A limit of 32 bits or of a float, which no sensor's heights reach in any unit: -2147483648, 4294967295, 3.4e38, 1e10 and its powers
// up to 1e38 of either sign.
bool is_type_limit(double value);

// Makes NaN of the heights that equal one of `values`. Returns how many.
int erase_no_returns(Profile& profile, const std::vector<double>& values);

// Whether the profile lists its lines without return, so that its first and last line are the rims of the sensor's field: some
// are in it (three, or one at its rim: a few holes may be anything), or at least `fewest` lines lie evenly about x = 0 within
// one and a half pitches and three sigma of the noise, as a full field does; fewer do so by chance. False: nobody knows.
bool lists_every_line(const Profile& profile, double pitch_mm, double noise_mm, std::size_t fewest = 256);

// "213 points stand at z = -9999 ..." for a list that is not empty.
Text no_return_sentence(const std::vector<NoReturnCode>& codes);

}  // namespace seamwright
