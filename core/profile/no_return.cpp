#include "core/profile/no_return.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

constexpr int kFewestEmpty = 3;
constexpr double kEvenPitches = 1.5, kEvenSigma = 3;  // within which a field's rims lie evenly about x = 0

constexpr int kFewestPoints = 3;
constexpr double kFarSpreads = 5, kFar_mm = 50, kAlone_mm = 0.2;
constexpr double kByChance = 1e-4, kAround = 0.2;
constexpr double kDrawn_mm = 1e-5;  // second differences of a contour that carries no noise
constexpr double kNoisyShare = 0.25;
constexpr double kWrittenExactly = 1e-9;  // of the value
constexpr double kSpreadShare = 0.95;     // of the points that lie within the spread

// 0, 9.., 32767, 32768, 65535 and the limits of 32 bits, with the decimal point anywhere.
bool written_like_a_code(double value) {
    double v = std::abs(value);
    if (v == 0) return true;
    for (int shift = 0; shift <= 6; ++shift, v *= 10) {
        const double whole = std::round(v);
        if (std::abs(v - whole) > kWrittenExactly * v) continue;
        for (const double code : {32767., 32768., 65535., 2147483647., 2147483648.})
            if (whole == code) return true;
        double nines = 99;
        while (nines < whole) nines = 10 * nines + 9;
        if (whole == nines) return true;
    }
    return false;
}

struct Repeated {
    double value;
    int points, longest;
};

// Values that look like a code or stand far from the point before: of two neighbours and more, or of single points that
// stand far from both of theirs.
void repeated_values(const Profile& profile, const std::vector<std::size_t>& seen,
                     std::vector<Repeated>& found) {
    found.clear();
    constexpr std::size_t kMost = 16;
    const auto z = [&](std::size_t k) { return profile.z_mm[seen[k]]; };
    thread_local std::vector<double> sorted;
    sorted.clear();
    for (const std::size_t k : seen) sorted.push_back(profile.z_mm[k]);
    std::sort(sorted.begin(), sorted.end());
    const auto points_at = [&](double value) {
        const auto [from, to] = std::equal_range(sorted.begin(), sorted.end(), value);
        return static_cast<int>(to - from);
    };
    for (std::size_t k = 0; k < seen.size();) {
        std::size_t end = k + 1;
        while (end < seen.size() && z(end) == z(k)) ++end;
        const std::size_t first = k;
        k = end;
        const double value = z(first);
        const bool before = first == 0 || std::abs(z(first - 1) - value) > kFar_mm;
        const bool after = end == seen.size() || std::abs(z(end) - value) > kFar_mm;
        const bool alone = end - first < 2;
        if (alone && !(before && after && points_at(value) >= kFewestPoints)) continue;
        const bool far = (first > 0 && before) || (end < seen.size() && after);
        if (!far && !written_like_a_code(value)) continue;
        const int length = static_cast<int>(end - first);
        const auto at =
            std::find_if(found.begin(), found.end(), [&](const Repeated& r) { return r.value == value; });
        if (at != found.end())
            at->longest = std::max(at->longest, length);
        else if (found.size() < kMost)
            found.push_back({value, 0, length});
    }
    for (Repeated& r : found) r.points = points_at(r.value);
}

// What the points beside the suspect are like.
struct Others {
    int points = 0;
    double middle = 0, spread = 0, nearest = std::numeric_limits<double>::infinity();
    double agreeing = 0;  // share of neighbours with the same value
    bool noisy = false;
    double around = 0;  // share within three times the nearest one's distance: a coarse sensor's own steps
};
Others others(const Profile& profile, const std::vector<std::size_t>& seen, double value,
              const std::vector<NoReturnCode>& known) {
    std::vector<double> z;
    for (const std::size_t k : seen) {
        const double h = profile.z_mm[k];
        if (h != value &&
            std::none_of(known.begin(), known.end(), [&](const NoReturnCode& c) { return c.value == h; }))
            z.push_back(h);
    }
    Others o;
    o.points = static_cast<int>(z.size());
    if (z.size() < 8) return o;
    double agree = 0, rough = 0;
    for (std::size_t k = 1; k < z.size(); ++k) agree += z[k] == z[k - 1];
    for (std::size_t k = 2; k < z.size(); ++k) rough += std::abs(z[k] - 2 * z[k - 1] + z[k - 2]) > kDrawn_mm;
    o.agreeing = agree / double(z.size() - 1);
    o.noisy = rough > kNoisyShare * double(z.size() - 2);
    for (const double h : z) o.nearest = std::min(o.nearest, std::abs(h - value));
    for (const double h : z) o.around += std::abs(h - value) <= 3 * o.nearest;
    o.around /= double(z.size());
    const auto quantile = [&](double share) {
        const auto at = z.begin() + std::ptrdiff_t(share * double(z.size() - 1));
        std::nth_element(z.begin(), at, z.end());
        return *at;
    };
    o.middle = quantile(0.5);
    for (double& h : z) h = std::abs(h - o.middle);
    o.spread = quantile(kSpreadShare);
    return o;
}

}  // namespace

std::vector<NoReturnCode> find_no_return_codes(const Profile& profile) {
    std::vector<NoReturnCode> codes;
    thread_local std::vector<std::size_t> seen;
    thread_local std::vector<Repeated> suspects;
    seen.clear();
    for (std::size_t k = 0; k < std::min(profile.x_mm.size(), profile.z_mm.size()); ++k)
        if (std::isfinite(profile.z_mm[k])) seen.push_back(k);
    // The farthest first, so that the others' spread is that of heights.
    repeated_values(profile, seen, suspects);
    std::sort(suspects.begin(), suspects.end(),
              [](const Repeated& a, const Repeated& b) { return std::abs(a.value) > std::abs(b.value); });
    for (const Repeated& r : suspects) {
        if (r.points < kFewestPoints || codes.size() == kMostNoReturnCodes) continue;
        const Others o = others(profile, seen, r.value, codes);
        if (o.points < 8) continue;
        const bool far = std::abs(r.value - o.middle) > kFarSpreads * o.spread + kFar_mm;
        const double chance = double(seen.size()) * std::pow(o.agreeing, r.longest - 1);
        const bool run = r.longest >= kFewestPoints && chance < kByChance && o.around < kAround;
        const bool like = written_like_a_code(r.value) && (run || o.nearest > kAlone_mm);
        if ((far && (o.noisy || written_like_a_code(r.value))) || (o.noisy && like))
            codes.push_back({r.value, r.points});
    }
    return codes;
}

bool is_type_limit(double value) {
    const double v = std::abs(value);
    if (v == 2147483647 || v == 2147483648 || v == 4294967295 || v == 4294967296) return true;
    if (std::abs(v / std::numeric_limits<float>::max() - 1) < 1e-2) return true;
    return v >= 1e10 && v < 1e39 && std::abs(v / std::pow(10, std::round(std::log10(v))) - 1) < 1e-9;
}

int erase_no_returns(Profile& profile, const std::vector<double>& values) {
    int erased = 0;
    for (std::size_t k = 0; k < profile.z_mm.size(); ++k)
        if (std::find(values.begin(), values.end(), profile.z_mm[k]) != values.end()) {
            profile.z_mm[k] = std::numeric_limits<double>::quiet_NaN();
            if (k < profile.segment.size()) profile.segment[k] = kOutlier;
            ++erased;
        }
    return erased;
}

Text no_return_sentence(const std::vector<NoReturnCode>& codes) {
    Text counts;
    for (const NoReturnCode& c : codes)
        counts = joined(counts, ", ", Text("{} points stand at z = {}", c.points, c.value));
    return Text("{}: taken for lines without return", counts);
}

bool lists_every_line(const Profile& profile, double pitch_mm, double noise_mm, std::size_t fewest) {
    const std::size_t lines = std::min(profile.x_mm.size(), profile.z_mm.size());
    const auto empty = [&](std::size_t k) {
        return !std::isfinite(profile.x_mm[k]) || !std::isfinite(profile.z_mm[k]);
    };
    if (lines == 0) return false;
    int count = 0;
    for (std::size_t k = 0; k < lines; ++k) count += empty(k);
    if (count >= kFewestEmpty || empty(0) || empty(lines - 1)) return true;
    return lines >= fewest && std::abs(profile.x_mm[0] + profile.x_mm[lines - 1]) <=
                                  kEvenPitches * pitch_mm + kEvenSigma * noise_mm;
}

}  // namespace seamwright
