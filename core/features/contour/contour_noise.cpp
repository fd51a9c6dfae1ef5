#include "core/features/contour/contour_noise.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/numbers.h"
#include "core/profile/z_quantum.h"

namespace seamwright {
namespace {

// Of points `apart` lines apart, about every `stride`-th point.
double difference_noise_mm(std::span<const double> x, std::span<const double> z, std::vector<double>& scratch,
                           std::size_t apart, std::size_t stride = 1) {
    // Where the noise is of the size of the pitch, the direction of a chord of four points is noise too: the
    // chord is then taken as long as twelve sigma.
    constexpr std::size_t kLongest = 96;
    const std::size_t n = x.size();
    const std::size_t one = apart, two = 2 * apart;
    std::size_t reach = two;
    double sigma = 0;
    for (int pass = 0; pass < 3; ++pass) {
        scratch.clear();
        for (std::size_t i = two; i + two < n; i += stride) {
            const std::size_t a = i > reach ? i - reach : 0, b = std::min(i + reach, n - 1);
            const double tx = x[b] - x[a], tz = z[b] - z[a];
            const double length = std::hypot(tx, tz);
            if (!(length > 0)) continue;
            const double fx = x[i + two] - 4 * x[i + one] + 6 * x[i] - 4 * x[i - one] + x[i - two];
            const double fz = z[i + two] - 4 * z[i + one] + 6 * z[i] - 4 * z[i - one] + z[i - two];
            scratch.push_back(std::abs(fz * tx - fx * tz) / length);
        }
        if (scratch.size() < 8) return sigma;
        sigma = kMadToSigma * median(scratch) / std::sqrt(70.0);
        scratch.clear();
        for (std::size_t i = 0; i + 2 * reach < n; i += stride)
            scratch.push_back(std::hypot(x[i + 2 * reach] - x[i], z[i + 2 * reach] - z[i]));
        const double chord = median(scratch);
        if (chord >= 12 * sigma || 2 * reach >= std::min(kLongest, n / 4)) break;
        reach = std::min({static_cast<std::size_t>(std::ceil(12 * sigma / chord * double(reach))),
                          kLongest / 2, std::max<std::size_t>(2, n / 8)});
    }
    return sigma;
}

// Steps of x that differ by no more than rounding, in the median: missing lines do not count.
bool even(std::span<const double> x, std::vector<double>& scratch) {
    constexpr double kRounding = 1e-4;  // of a step
    scratch.clear();
    for (std::size_t i = 2; i < x.size(); ++i) scratch.push_back(std::abs(x[i - 2] - 2 * x[i - 1] + x[i]));
    const double uneven = median(scratch);
    scratch.clear();
    for (std::size_t i = 1; i < x.size(); ++i) scratch.push_back(std::abs(x[i] - x[i - 1]));
    return uneven < kRounding * median(scratch);
}

// The noise of points three lines apart over that of neighbours: what a linear interpolation from points 0.7, 0.85, 1,
// 1.3, 1.6 and 2 lines apart makes of independent noise is 1.1, 1.2, 1.5, 2.5, 3.5 and 5.6.
constexpr std::size_t kNoiseApart = 3;
constexpr double kNoNoise = 1e-3;       // steps: less is rounding and shape
constexpr double kRunsByCorners = 1.2;  // thirteen points see a corner, five as neighbours
constexpr double kRunsByChance = 6;     // over sqrt(points): three sigma of that quotient
constexpr double kRunsSeen = 0.1;       // above that it counts whole
constexpr double kMeasuredApart = 0.75, kMeasuredRise = 0.65;

// Second differences of independent noise, and of any mean of it, are normal: their median is 0.53 of their quantile of 0.8. On
// lines drawn between points 1.4, 1.7, 1.9 and 2.5 lines apart it is 0.46, 0.43, 0.41 and 0.28 of it (of a median of three
// lines 0.44): the line that holds no point is straight.
constexpr double kDrawnNot = 0.527, kDrawnUpper = 0.8, kDrawnWidth = 0.04;
constexpr double kDrawnByChance = 0.8;  // over sqrt(n): one and a half sigma
// Lines on either side that are all there: where some are missing, a mean is of fewer.
constexpr std::size_t kDrawnBeside = 4;
constexpr double kAllThere = 1.06;  // of their length

// Likeness.
constexpr std::size_t kLikenessPoints = 100;  // fewer know none
constexpr std::size_t kLikenessMost = 1000;   // more are not looked at
constexpr double kLevel = 1.35;               // so far: they scatter
// V above a level that is none, of a mean of many lines; more is shape.
constexpr double kRisen = 3, kRisenMost = 8;
constexpr double kLeastSquare = 1e-300;   // divided by
constexpr std::size_t kNear = 7;          // lags at which a level is looked for first
constexpr std::size_t kLevelPoints = 10;  // a profile has so many times the farthest lag
constexpr double kShared = 4;  // points of a profile for one of a fit that knows its likeness as well
constexpr double kLikenessNoise = 1e-4;  // steps: less is rounding and shape
constexpr std::size_t kFewestResiduals = 8, kMostLags = 12;
constexpr double kByChance = 1.5;   // over sqrt(n)
constexpr double kStandsOut = 2.5;  // the same, of the profile alone
constexpr double kMostGivenBack = 0.5;
constexpr double kAsMany = 4;

double drawn_lines(std::span<const double> x, std::span<const double> z, double rounding_mm,
                   std::vector<double>& scratch) {
    scratch.clear();
    for (std::size_t i = 1; i < x.size(); ++i) scratch.push_back(std::abs(x[i] - x[i - 1]));
    const double step = median(scratch);
    scratch.clear();
    for (std::size_t i = kDrawnBeside; i + kDrawnBeside < x.size(); ++i)
        if (std::abs(x[i + kDrawnBeside] - x[i - kDrawnBeside]) < kAllThere * 2 * kDrawnBeside * step)
            scratch.push_back(std::abs(z[i - 1] - 2 * z[i] + z[i + 1]));
    if (scratch.size() < kLikenessPoints) return 0;
    const auto upper = scratch.begin() + static_cast<std::ptrdiff_t>(kDrawnUpper * double(scratch.size()));
    std::nth_element(scratch.begin(), upper, scratch.end());
    const double high = *upper, middle = median(scratch);
    if (!(high > 2 * rounding_mm)) return 0;
    const double least = kDrawnNot - kDrawnByChance / std::sqrt(double(scratch.size()));
    return std::clamp((least - middle / high) / kDrawnWidth, 0.0, 1.0);
}

}  // namespace

ContourNoise contour_noise(std::span<const double> x, std::span<const double> z,
                           std::vector<double>& scratch) {
    ContourNoise noise;
    noise.rounding_mm = z_rounding_mm(x, z);
    noise.point_mm = std::max(difference_noise_mm(x, z, scratch, 1), z_quantum_mm(x, z) / std::sqrt(12.0));
    if (!(noise.point_mm > 0) || !even(x, scratch)) return noise;
    const double step = std::abs(x.back() - x.front()) / double(x.size() - 1);
    const double apart = difference_noise_mm(x, z, scratch, kNoiseApart), runs = apart / noise.point_mm;
    const double least = kRunsByCorners + kRunsByChance / std::sqrt(double(x.size()));
    if (apart < kNoNoise * step || runs < least) return noise;
    const double seen = std::min((runs - least) / kRunsSeen, 1.0);
    noise.measured_apart = seen * (kMeasuredApart + kMeasuredRise * std::log(runs));
    noise.point_mm = apart;
    noise.drawn = drawn_lines(x, z, noise.rounding_mm, scratch);
    return noise;
}

double ContourNoise::shared_rounding_mm2(double rms_mm) const {
    return std::max(rounding_mm * rounding_mm / 12 - rms_mm * rms_mm, 0.0);
}

double contour_noise_mm(std::span<const double> x, std::span<const double> z, std::vector<double>& scratch) {
    return contour_noise(x, z, scratch).point_mm;
}

ProfileNoise profile_noise(std::span<const double> x, std::span<const double> z, std::vector<double>& scratch,
                           SharedOver over) {
    ProfileNoise like;
    static_cast<ContourNoise&>(like) = contour_noise(x, z, scratch);
    if (x.size() < kLikenessPoints) return like;
    constexpr std::size_t kFar = ProfileNoise::kLags + 1, kMost = kFar + kFar / 2;
    const std::size_t farthest = std::min(kMost, x.size() / kLevelPoints);
    const std::size_t stride = std::max<std::size_t>(x.size() / kLikenessMost, 1);
    std::array<double, kMost + 1> v{};
    std::size_t told = 0;
    const auto tell = [&](std::size_t upto) {  // most profiles stand still at once
        for (; told < upto; ++told)
            v[told + 1] = std::pow(difference_noise_mm(x, z, scratch, told + 1, stride), 2);
    };
    const double step = std::abs(x.back() - x.front()) / double(x.size() - 1);
    // The first lag from which on V stands still.
    std::size_t level = 1;
    const auto still = [&](std::size_t s, std::size_t apart) {
        tell(s + 2 * apart);
        return v[s + 2 * apart] < kLevel * v[s] && v[s + apart] < kLevel * v[s];
    };
    while (level < kNear && !still(level, 1)) ++level;
    const bool near = still(level, 1);
    std::size_t apart = 1;
    if (!near && over == SharedOver::few) return like;
    if (over == SharedOver::many) {
        const std::size_t later = near ? std::min(3 * level, farthest) : farthest;
        tell(later);
        const double rise =
            *std::max_element(v.begin() + std::ptrdiff_t(level), v.begin() + std::ptrdiff_t(later) + 1) /
            std::max(v[level], kLeastSquare);
        if (!near || rise > kRisen) {
            std::size_t far = near ? 2 * level : level + 1;
            const auto quarter = [&] { return far / 4; };
            const auto within = [&] { return far <= kFar && far + 2 * quarter() <= farthest; };
            while (within() && !still(far, quarter())) ++far;
            if (within() && v[far] < kRisenMost * v[level]) {
                apart = quarter();
                level = far;
            } else if (rise < kRisenMost) {  // too few points to see where it ends
                apart = 0;
                level = later;
            } else if (!near) {
                return like;
            }
        }
    }
    const double whole = (v[level] + v[level + apart] + v[level + 2 * apart]) / 3;
    if (!(whole > std::pow(kLikenessNoise * step, 2))) return like;
    like.points = double(x.size()) / double(stride) / kShared;
    like.alone_mm = std::sqrt(whole);
    const auto r = [&](std::size_t lag) {
        return lag <= level && lag <= like.r.size() ? like.r[lag - 1] : 0.0;
    };
    for (std::size_t s = std::min(level, like.r.size()); s >= 1; --s) {
        const double known = 1 + (56 * r(2 * s) - 16 * r(3 * s) + 2 * r(4 * s)) / 70;
        like.r[s - 1] = std::clamp((known - v[s] / whole) * 70 / 112, 0.0, 1.0);
    }
    return like;
}

double ProfileNoise::apart() const {
    double c = 1;
    for (const double at_lag : r) {
        if (!(at_lag * std::sqrt(points) > kStandsOut)) break;
        c += 2 * at_lag;
    }
    return c;
}

double alike_widening(std::span<const double> residuals, int unknowns, const ProfileNoise& profile) {
    const std::size_t count = residuals.size();
    if (count <= std::size_t(unknowns) || (count < kFewestResiduals && !(profile.points > 0))) return 1;
    const auto n = static_cast<double>(count);
    double square = 0;
    for (const double e : residuals) square += e * e;
    if (!(square > 0)) return 1;
    const double given_back = std::min(unknowns * profile.apart() / n, kMostGivenBack);
    double own = 1, both = 1;
    bool own_goes_on = count >= kFewestResiduals, both_goes_on = profile.points > 0;
    for (std::size_t lag = 1; lag <= profile.r.size() && (own_goes_on || both_goes_on); ++lag) {
        own_goes_on = own_goes_on && lag <= kMostLags;
        double r = 0;
        if (lag <= count / 4) {
            double product = 0;
            for (std::size_t i = 0; i + lag < count; ++i) product += residuals[i] * residuals[i + lag];
            r = product / double(count - lag) / (square / n) + given_back;
        } else {
            own_goes_on = false;
        }
        own_goes_on = own_goes_on && r > kByChance / std::sqrt(n);
        if (own_goes_on) own += 2 * std::min(r, 1.0);
        const double weight = lag <= count / 4 ? n : 0;
        const double known = lag <= profile.r.size() ? profile.r[lag - 1] : 0;
        const double mean = (weight * r + profile.points * known) / (weight + profile.points);
        both_goes_on =
            both_goes_on && lag <= profile.r.size() && mean > kByChance / std::sqrt(weight + profile.points);
        if (both_goes_on) both += 2 * std::min(mean, 1.0);
    }
    const double c = std::min(std::max(own, both), std::max(n / unknowns, 1.0));
    return c * (n - unknowns) / (n - unknowns * std::min(c, std::max(n / (2.0 * unknowns), 1.0)));
}

PooledSigma pooled_sigma(double sigma_mm, int freedom, const ProfileNoise& profile) {
    const double own = std::max(freedom, 1);
    if (!(profile.point_mm > 0)) return {sigma_mm, own > 4 ? own / (own - 2) : 2.0};
    const double all = own + kAsMany;
    const double pooled =
        std::sqrt((own * sigma_mm * sigma_mm + kAsMany * profile.point_mm * profile.point_mm) / all);
    return {std::max(sigma_mm, pooled), std::min(own > 4 ? own / (own - 2) : 2.0, all / (all - 2))};
}

}  // namespace seamwright
