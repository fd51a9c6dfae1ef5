#pragma once
// The careful half of the extraction: one lobe of grey values on one image line, its background, shape and
// position. The theory stands in peaks.h.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/profile/stripe/peaks.h"
#include "core/profile/stripe/stripe_scan.h"

namespace seamwright::detail {

inline constexpr int kWindowSteps = 4;      // Newton steps of the centre of gravity, at most
inline constexpr double kBroad = 10;        // px; what is narrower is no square
inline constexpr int kFootPixels = 8;       // background level on each side
inline constexpr double kValleySigmas = 5;  // a valley of light beside a peak is deeper than that
inline constexpr int kFitRounds = 3;
inline constexpr double kHotPixelWidth = 1.1;  // px; a single bright pixel has 1.0, the sharpest optics 1.2
inline constexpr double kSharpness = 0.3;  // (width at 1/2 - width at 3/4)/width at 1/2; 0.356 of a Gaussian
inline constexpr double kMeanDifference = 1.128;  // of two Gaussian samples, in standard deviations

inline constexpr double kNarrowAt = 0.75;  // of the height: down to where the lobe narrows from its half
// Of the height: a background that moved more is measured by another outline; one that moved less stands.
inline constexpr double kMovedMuch = 0.01, kStands = 0.03;
inline constexpr double kOnBackground = 0.1;     // of the height: a flank that ends so low shows no valley
inline constexpr double kDeepValley = 0.25;      // of what the top stands above it
inline constexpr double kBackgroundStep = 0.25;  // of what the top stands above the lower of its two sides
// Narrowings from half height to the end of a flank. Half the narrowing from 1/2 to 3/4 of the height is 0.42 standard
// deviations of a Gaussian; five times that outside the half-height point is 3.3 standard deviations from the middle,
// and on the flanks of a clipped one as far down.
inline constexpr double kFlankEnds = 2.5;
inline constexpr double kUnbounded = 1e9;  // px, of a reach
// The window of the centre of gravity beyond half the width: narrowings, and px.
inline constexpr double kWindowNarrowings = 2.15, kWindowMore = 0.25;
inline constexpr double kMostMove = 0.25;                             // of the width, in one of its steps
inline constexpr double kLeastMove = 0.02;                            // px; the next step would be below 1e-3
inline constexpr double kLeastSharp = 0.02, kHotPixelStrength = 0.1;  // of a peak's strength that is left

// One image line. Grey values at stride `step`.
template <class Pixel>
struct Line {
    const std::byte* first;
    std::ptrdiff_t step;  // bytes
    int size;
    int operator[](int i) const { return *reinterpret_cast<const Pixel*>(first + i * step); }
};

// The part of a line about a run, copied once: a column's pixels lie a row apart, and their cache lines
// evict each other.
template <class Pixel>
class LineWindow {
  public:
    LineWindow(const Line<Pixel>& line, const Run& run) : size(line.size), line_(line) {
        const int length = run.end - run.begin;
        // Shortest runs are most often noise on a flank; should one need more, the line itself answers.
        const int margin = length > 2 ? kMargin + length / 4 : 4;
        first_ = std::max(0, run.begin - margin);
        count_ = std::min({line.size, run.end + margin, first_ + kCapacity}) - first_;
        for (int i = 0; i < count_; ++i) grey_[i] = line[first_ + i];
    }
    int operator[](int i) const {
        const int at = i - first_;
        return static_cast<unsigned>(at) < static_cast<unsigned>(count_) ? grey_[at] : line_[i];
    }
    const int size;

  private:
    static constexpr int kMargin = 14, kCapacity = 192;
    Line<Pixel> line_;
    int first_, count_;
    int grey_[kCapacity];
};

// A lobe and all that is measured on it. Positions in px along the line, levels in grey values.
struct Lobe {
    int top = 0;                      // highest grey value
    int top_first = 0, top_last = 0;  // first and last pixel of that value
    int left = 0, right = 0;          // outermost pixels at or above half height
    double base = 0, slope = 0;       // background at `middle`, grey per px
    double middle = 0;
    double cut = 0;                                   // grey value above `base`
    double half_left = 0, half_right = 0, width = 0;  // sub-pixel crossings
    double narrowing = 0;                             // width at 1/2 minus width at 3/4 of the height
    double reach = 0;                                 // how far from `middle` the light is its own
    double sharpness = 0;
    bool flat = false;     // the top pixels carry no position
    bool clipped = false;  // cut off by the sensor
    bool truncated = false;
    double height() const { return top - base; }
    double base_at(double x) const { return base + slope * (x - middle); }
};

// Where the line crosses `level` between pixel `inside` (at or above) and its outer neighbour in direction
// `step`.
template <class L>
double crossing(const L& line, int inside, int step, double level) {
    const int outside = inside + step;
    if (outside < 0 || outside >= line.size) return inside + 0.5 * step;
    const double in = line[inside], out = line[outside];
    if (!(in > out)) return inside + 0.5 * step;
    return inside + step * std::clamp((in - level) / (in - out), 0.0, 1.0);
}

// Walks from `from` in direction `step` while pixels are at or above `level` (one pixel below is bridged);
// `last` becomes the last such pixel. False where a pixel above `highest` comes (the lobe belongs to that
// one), or where the way is longer than `limit`.
template <class L>
bool walk(const L& line, int from, int step, double level, int highest, int limit, int& last) {
    last = from;
    for (int moved = 0; moved <= limit; ++moved) {
        int next = last + step;
        if (next < 0 || next >= line.size) return true;
        if (line[next] < level) {
            next += step;
            if (next < 0 || next >= line.size || line[next] < level) return true;
        }
        if (line[next] > highest) return false;
        last = next;
    }
    return false;
}

// Mean of kFootPixels pixels beginning at `from` in direction `step`, without the highest and the lowest;
// false where fewer than three of them are on the line.
template <class L>
bool foot_level(const L& line, int from, int step, double& level) {
    const int inside = step > 0 ? line.size - from : from + 1;
    const int n = from < 0 || from >= line.size ? 0 : std::min(kFootPixels, inside);
    if (n < 3) return false;
    int sum = 0, low = line[from], high = low;
    for (int k = 0; k < n; ++k) {
        const int grey = line[from + step * k];
        sum += grey;
        low = std::min(low, grey);
        high = std::max(high, grey);
    }
    level = static_cast<double>(sum - low - high) / (n - 2);
    return true;
}

// Whether the way from pixel `from` to `to`, in either direction, is more than a falling flank.
template <class L>
bool rises_again(const L& line, int from, int to) {
    const int step = to < from ? -1 : 1;
    for (int i = from; i != to; i += step)
        if (line[i + step] > line[i]) return true;
    return false;
}

template <class L>
class LobeFinder {
  public:
    LobeFinder(const L& line, const PeakOptions& options, int full_scale)
        : line_(line), options_(options), full_scale_(full_scale) {}

    // The stretch at half height about the highest pixel of [begin, end). Returns false when that pixel
    // belongs to a higher lobe beside it, or the lobe is too wide; `left` and `right` are then what has
    // been looked at.
    bool stretch(int begin, int end, double background, Lobe& lobe) const {
        int at = begin;
        for (int i = begin + 1; i < end; ++i)
            if (line_[i] > line_[at]) at = i;
        lobe.top = line_[at];
        lobe.base = background;
        lobe.slope = 0;
        const int limit = static_cast<int>(options_.max_width_px) * 2 + 8;
        const double half = 0.5 * (lobe.top + background);
        // Of equal tops in one lobe the leftmost speaks for it.
        const bool left = walk(line_, at, -1, half, lobe.top - 1, limit, lobe.left);
        const bool right = walk(line_, at, 1, half, lobe.top, limit, lobe.right);
        if (!left || !right) return false;
        return raise_from_pedestal(lobe);
    }

    // Clipping, background, half-height crossings. The background is measured where the flanks end, and the
    // flanks above the background: a second round when the first moved it.
    void measure(Lobe& lobe, double noise) const {
        find_top(lobe);
        outline(lobe);
        for (int round = 0; round < 2; ++round) {
            const double before = lobe.base;
            find_background(lobe, noise);
            const double moved = std::abs(lobe.base - before);
            if (moved > kMovedMuch * lobe.height()) {
                extend(lobe);
                outline(lobe);
            }
            if (moved < kStands * lobe.height()) break;
        }
        lobe.sharpness = lobe.width > kBroad ? sharpness(lobe) : lobe.narrowing / lobe.width;
        lobe.truncated = lobe.left == 0 || lobe.right == line_.size - 1;
    }

    // Mean of positions weighted by grey value above background and a smooth window that ends where the
    // stripe does, (1 - (d/R)^2)^2; the window stands at the mean itself, which Newton steps find. A hard
    // cut would add up to 0.05 px of bias that follows the phase of the pixel grid.
    double centre_of_gravity(const Lobe& lobe) const {
        const double reach = std::max(
            std::min(0.5 * lobe.width + kWindowNarrowings * lobe.narrowing + kWindowMore, lobe.reach),
            0.5 * lobe.width + 0.5);
        int first = std::max(0, static_cast<int>(std::ceil(lobe.middle - reach)) - 1);
        int last = std::min(line_.size - 1, static_cast<int>(std::floor(lobe.middle + reach)) + 1);
        if (lobe.cut > 0) {
            int left = lobe.top_first, right = lobe.top_last;
            while (left > first && (above_cut(lobe, left - 1) > 0 || (left > lobe.left && left - 1 > first)))
                --left;
            while (right < last &&
                   (above_cut(lobe, right + 1) > 0 || (right < lobe.right && right + 1 < last)))
                ++right;
            first = left;
            last = right;
        }
        // Grey values once, then the steps on four pixels at a time; positions from the middle pixel keep
        // float exact enough.
        using Four = float __attribute__((vector_size(16)));
        constexpr int kCapacity = 256;
        alignas(16) float grey[kCapacity + 4], place[kCapacity + 4];
        const int stride = 1 + (last - first) / kCapacity;  // stripes beyond the capacity are sampled
        const int origin = static_cast<int>(std::lround(lobe.middle));
        int n = 0;
        for (int i = first; i <= last; i += stride, ++n) {
            const double above = above_cut(lobe, i);
            grey[n] = static_cast<float>(lobe.cut > 0 ? std::max(0.0, above) : above);
            place[n] = static_cast<float>(i - origin);
        }
        for (; n % 4; ++n) grey[n] = place[n] = 0;
        double x = lobe.middle;  // of the half-height points
        const auto scale = static_cast<float>(1 / reach);
        for (int step = 0; step < kWindowSteps; ++step) {
            const auto at = static_cast<float>(x - origin);
            Four force = {}, stiffness = {};
            for (int k = 0; k < n; k += 4) {
                Four u, g;
                std::memcpy(&u, place + k, sizeof u);
                std::memcpy(&g, grey + k, sizeof g);
                u = (u - at) * scale;
                const Four square = u * u;
                Four inside = 1.0f - square;
                inside = inside > 0.0f ? inside : Four{};
                g *= inside;
                force += g * inside * u;
                stiffness += g * (1.0f - 5.0f * square);
            }
            const double stiff = double(stiffness[0]) + stiffness[1] + stiffness[2] + stiffness[3];
            const double pull = double(force[0]) + force[1] + force[2] + force[3];
            if (!(stiff > 0)) return lobe.middle;
            const double move = reach * pull / stiff;
            x += std::clamp(move, -kMostMove * lobe.width, kMostMove * lobe.width);
            if (std::abs(move) < kLeastMove) break;
        }
        return std::abs(x - lobe.middle) <= 0.5 * lobe.width ? x : lobe.middle;
    }

    // Weighted parabola through the logarithm; falls back to the middle of the half-height points.
    double gaussian(const Lobe& lobe) const {
        constexpr double kLeastHeight = 1e-9;
        // Of the height: where the pixels of a lobe end, and the darkest that count.
        constexpr double kFlatFloor = 0.1, kFloor = 0.2, kDarkest = 0.02;
        constexpr double kMostLog = 6;  // of the model: more than the top by e^6 is none
        constexpr double kSingular = 1e-12;
        const double scale = std::max(lobe.height(), kLeastHeight);
        const double floor = (lobe.flat ? kFlatFloor : kFloor) * scale;
        const double centre = lobe.middle;
        int left = lobe.left, right = lobe.right;
        while (left > 0 && line_[left - 1] - lobe.base_at(left - 1) > floor) --left;
        while (right + 1 < line_.size && line_[right + 1] - lobe.base_at(right + 1) > floor) ++right;
        double a = 0, b = 0, c = 0;  // ln y = a + b x + c x^2, x from `centre`
        double found = centre;
        const double unit = std::max(1.0, 0.5 * lobe.width);
        for (int round = 0; round < kFitRounds; ++round) {
            double s[5] = {}, t[3] = {};
            int used = 0;
            for (int i = left; i <= right; ++i) {
                if (lobe.flat && line_[i] >= lobe.top) continue;
                const double y = (line_[i] - lobe.base_at(i)) / scale;
                if (y < kDarkest) continue;
                const double x = (i - centre) / unit;
                const double model = round == 0 ? y : std::exp(std::min(a + b * x + c * x * x, kMostLog));
                const double w = model * model, l = std::log(y);
                double p = w;
                for (int k = 0; k < 5; ++k, p *= x) {
                    s[k] += p;
                    if (k < 3) t[k] += p * l;
                }
                ++used;
            }
            if (used < 3) return found;
            // Normal equations of the parabola by Cramer's rule.
            const double det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[2] * s[3]) +
                               s[2] * (s[1] * s[3] - s[2] * s[2]);
            if (!(std::abs(det) > kSingular * s[0] * s[0] * s[0])) return found;
            a = (t[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (t[1] * s[4] - t[2] * s[3]) +
                 s[2] * (t[1] * s[3] - t[2] * s[2])) /
                det;
            b = (s[0] * (t[1] * s[4] - s[3] * t[2]) - t[0] * (s[1] * s[4] - s[2] * s[3]) +
                 s[2] * (s[1] * t[2] - s[2] * t[1])) /
                det;
            c = (s[0] * (s[2] * t[2] - s[3] * t[1]) - s[1] * (s[1] * t[2] - s[2] * t[1]) +
                 t[0] * (s[1] * s[3] - s[2] * s[2])) /
                det;
            if (!(c < 0)) return found;
            const double offset = -b / (2 * c) * unit;
            if (!(std::abs(offset) <= 0.5 * lobe.width)) return found;
            found = centre + offset;
        }
        return found;
    }

    // Zero of the first derivative of the smoothed line, by safeguarded Newton steps.
    double steger(const Lobe& lobe) const {
        constexpr double kSettled_px = 1e-4;
        const double sigma = std::max(options_.steger_sigma_px, 0.5 * lobe.width / std::sqrt(3.0));
        const int reach = static_cast<int>(std::ceil(4 * sigma));
        double low = lobe.half_left, high = lobe.half_right, x = lobe.middle;
        for (int step = 0; step < 12; ++step) {
            const int centre = static_cast<int>(std::lround(x));
            double first = 0, second = 0;
            for (int k = -reach; k <= reach; ++k) {
                const int i = std::clamp(centre + k, 0, line_.size - 1);
                const double u = (centre + k - x) / sigma;
                const double above = line_[i] - lobe.base_at(i);
                const double weight = std::exp(-0.5 * u * u),
                             value = lobe.cut > 0 ? std::max(0.0, above) : above;
                first += value * weight * u;             // d/dx of the smoothed line, times sigma
                second += value * weight * (u * u - 1);  // second derivative, times sigma^2
            }
            if (first > 0) {
                low = x;
            } else {
                high = x;
            }
            double next = second < 0 ? x - sigma * first / second : 0.5 * (low + high);
            if (!(next > low && next < high)) next = 0.5 * (low + high);
            const double moved = std::abs(next - x);
            x = next;
            if (moved < kSettled_px) break;
        }
        return x;
    }

    // Sum of grey values above background between the half-height points.
    double energy(const Lobe& lobe) const {
        double sum = 0;
        for (int i = lobe.left; i <= lobe.right; ++i) sum += line_[i] - lobe.base_at(i);
        return sum;
    }

    // 1 for a single hump between the half-height points; what rises and falls again in between (beyond
    // what noise of this standard deviation does) lowers it.
    double unimodality(const Lobe& lobe, double noise) const {
        const double half = 0.5 * lobe.height();
        double path = 2 * lobe.top - line_[lobe.left] - line_[lobe.right];
        double variation = 0;
        for (int i = lobe.left + 1; i <= lobe.right; ++i) variation += std::abs(line_[i] - line_[i - 1]);
        const double excess = variation - path - kMeanDifference * noise * (lobe.right - lobe.left);
        return excess > 0 ? half / (half + excess) : 1.0;
    }

  private:
    double above_cut(const Lobe& lobe, int i) const { return line_[i] - lobe.base_at(i) - lobe.cut; }

    // Half-height stretch about the top.
    void extend(Lobe& lobe) const {
        const double half = 0.5 * (lobe.top + lobe.base);
        walk(line_, lobe.top_first, -1, half, lobe.top, line_.size, lobe.left);
        walk(line_, lobe.top_last, 1, half, lobe.top, line_.size, lobe.right);
    }

    // Crossings of half height at the ends of the stretch, and how it narrows towards three quarters.
    void outline(Lobe& lobe) const {
        const double half = 0.5 * (lobe.top + lobe.base);
        lobe.half_left = crossing(line_, lobe.left, -1, half);
        lobe.half_right = crossing(line_, lobe.right, 1, half);
        lobe.width = lobe.half_right - lobe.half_left;
        lobe.middle = 0.5 * (lobe.half_left + lobe.half_right);
        lobe.narrowing = std::max(0.0, lobe.width - width_at(lobe, kNarrowAt, lobe.top));
    }

    // Light beyond one flank (`edge` its outermost pixel at half height). Where it rises again before the
    // flank has run out, for a neighbouring peak or a brighter surface, the valley is the background and
    // `reach` ends there.
    bool beyond_flank(const Lobe& lobe, int edge, int step, int out, double noise, double& level,
                      double& reach) const {
        const bool found = foot_level(line_, edge + step * out, step, level);
        // Where the flank ends on the background there is no valley to look for.
        if (found && level - lobe.base < std::min(kOnBackground * lobe.height(), 2 * noise)) return true;
        int valley = edge, lowest = line_[edge];
        for (int k = 1; k <= out + kFootPixels / 2; ++k) {
            const int i = edge + step * k;
            if (i < 0 || i >= line_.size) break;
            if (line_[i] < lowest) {
                lowest = line_[i];
                valley = i;
            }
        }
        if (found && level - lowest > std::max(kDeepValley * (lobe.top - lowest), kValleySigmas * noise)) {
            level = lowest;
            reach = std::min(reach, std::abs(valley - lobe.middle));
        }
        return found;
    }

    void find_background(Lobe& lobe, double noise) const {
        const int out = static_cast<int>(std::ceil(kFlankEnds * lobe.narrowing)) + 1;
        double low_left = 0, low_right = 0;
        lobe.reach = kUnbounded;
        const bool has_left = beyond_flank(lobe, lobe.left, -1, out, noise, low_left, lobe.reach);
        const bool has_right = beyond_flank(lobe, lobe.right, 1, out, noise, low_right, lobe.reach);
        if (!has_left && !has_right) low_left = low_right = lobe.base;
        if (!has_left) low_left = low_right;
        if (!has_right) low_right = low_left;
        const double low = std::min({low_left, low_right, static_cast<double>(lobe.top)});
        const double high = std::min(std::max(low_left, low_right), static_cast<double>(lobe.top));
        if (high - low <= kBackgroundStep * (lobe.top - low)) {
            // Light that varies evenly across the stripe.
            lobe.base = 0.5 * (low + high);
            lobe.slope = has_left && has_right && lobe.reach > line_.size
                             ? (low_right - low_left) / (lobe.right - lobe.left + 2 * out + kFootPixels - 1)
                             : 0.0;
            lobe.cut = 0;
        } else {
            // A step of the background, or another peak on one side: only what stands above both counts.
            constexpr double kAboveBoth = 0.15;  // of the height
            lobe.base = high;
            lobe.slope = 0;
            lobe.cut = kAboveBoth * (lobe.top - high);
        }
    }

    // Pixels of the top value. Some sensors clip below full scale: a plateau of one value over most of the
    // width.
    void find_top(Lobe& lobe) const {
        constexpr double kClipsFrom = 0.7;  // of full scale
        lobe.top_first = lobe.top_last = -1;
        int run = 0, longest = 0;
        for (int i = lobe.left; i <= lobe.right; ++i) {
            const bool on_top = line_[i] >= lobe.top;
            if (on_top) {
                if (lobe.top_first < 0) lobe.top_first = i;
                lobe.top_last = i;
            }
            run = on_top ? run + 1 : 0;
            longest = std::max(longest, run);
        }
        lobe.flat = lobe.top >= full_scale_ || longest >= 3;
        lobe.clipped = lobe.top >= full_scale_ || (longest >= 4 && 2 * longest >= lobe.right - lobe.left &&
                                                   lobe.top > kClipsFrom * full_scale_);
    }

    // Outermost width at a share of the height from background to `top`.
    double width_at(const Lobe& lobe, double share, double top) const {
        const double level = lobe.base + share * (top - lobe.base);
        int left = lobe.left, right = lobe.right;
        while (left < lobe.top_first && line_[left] < level) ++left;
        while (right > lobe.top_last && line_[right] < level) --right;
        return crossing(line_, right, 1, level) - crossing(line_, left, -1, level);
    }

    // How much the lobe narrows from half to three quarters of its height, relative to the former. The
    // height is that of the middle half of the lobe, which noise moves less than its highest pixel.
    double sharpness(const Lobe& lobe) const {
        if (!(lobe.width > 0)) return 0;
        const int quarter = (lobe.right - lobe.left) / 4;
        double sum = 0;
        for (int i = lobe.left + quarter; i <= lobe.right - quarter; ++i) sum += line_[i];
        const double level = sum / (lobe.right - lobe.left - 2 * quarter + 1);
        return std::max(0.0, width_at(lobe, 0.5, level) - width_at(lobe, kNarrowAt, level)) / lobe.width;
    }

    // A narrow stripe on a bright square: the square reaches half height too. Its level, the median of the
    // stretch, becomes the background when what stands above it is narrow, but wider than a grain of
    // speckle.
    bool raise_from_pedestal(Lobe& lobe) const {
        constexpr int kSamples = 64;
        constexpr double kNarrowCore = 0.25;  // of the square
        for (int round = 0; round < 2; ++round) {
            const int wide = lobe.right - lobe.left + 1;
            if (wide <= 10 || lobe.height() < 4) break;
            find_top(lobe);
            int sample[kSamples];
            const int n = std::min(wide, kSamples);
            for (int i = 0; i < n; ++i) sample[i] = line_[lobe.left + i * wide / n];
            std::nth_element(sample, sample + n / 2, sample + n);
            const double level = sample[n / 2], half = 0.5 * (lobe.top + level);
            int left = 0, right = 0;
            walk(line_, lobe.top_first, -1, half, lobe.top, line_.size, left);
            walk(line_, lobe.top_last, 1, half, lobe.top, line_.size, right);
            const double core = crossing(line_, right, 1, half) - crossing(line_, left, -1, half);
            if (core < 2 || core > kNarrowCore * wide) break;
            lobe.left = left;
            lobe.right = right;
            lobe.base = level;
        }
        return lobe.right - lobe.left + 1 <= options_.max_width_px + 1;
    }

    const L& line_;
    const PeakOptions& options_;
    int full_scale_;
};

}  // namespace seamwright::detail
