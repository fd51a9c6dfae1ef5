#include "core/profile/peaks.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/profile/peaks_detail.h"
#include "core/profile/stripe_scan.h"

namespace seamwright {
namespace detail {
namespace {

constexpr double kPixelSigmas = 4.0;  // candidate pixel
constexpr double kPeakSigmas = 7.0;   // sum over the width of a peak, in its own standard deviations
constexpr double kFrameShare = 0.01;  // of the strength that stripes have in the frame
constexpr double kCut = 0.25;         // of the height, for the centre of gravity
constexpr double kSharpness = 0.3;    // (width at 1/2 - width at 3/4)/width at 1/2; 0.356 of a Gaussian
constexpr int kFootPixels = 5;        // background level on each side
constexpr int kFitRounds = 3;

// One image line. Grey values at stride `step`.
template <class Pixel>
struct Line {
    const std::byte* first;
    std::ptrdiff_t step;  // bytes
    int size;
    int operator[](int i) const { return *reinterpret_cast<const Pixel*>(first + i * step); }
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
    double sharpness = 0;
    bool clipped = false, truncated = false;
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

// Median of kFootPixels pixels beginning at `from` in direction `step`; false where they are outside the
// line.
template <class L>
bool foot_level(const L& line, int from, int step, double& level) {
    int values[kFootPixels];
    int n = 0;
    for (int i = from; n < kFootPixels && i >= 0 && i < line.size; i += step) values[n++] = line[i];
    if (n < 2) return false;
    std::sort(values, values + n);
    level = n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
    return true;
}

template <class L>
class LobeFinder {
  public:
    LobeFinder(const L& line, const PeakOptions& options, int full_scale)
        : line_(line), options_(options), full_scale_(full_scale) {}

    // The stretch at half height about the highest pixel of [begin, end). Returns false when that pixel
    // belongs to a higher lobe beside it, or the lobe is too wide; `left` and `right` are then what has been
    // looked at.
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

    // Background line, half-height crossings, clipping, and the cut of the centre of gravity.
    void measure(Lobe& lobe) const {
        find_top(lobe);
        lobe.half_left = crossing(line_, lobe.left, -1, 0.5 * (lobe.top + lobe.base));
        lobe.half_right = crossing(line_, lobe.right, 1, 0.5 * (lobe.top + lobe.base));
        lobe.width = lobe.half_right - lobe.half_left;
        double three_quarters = width_at(lobe, 0.75);
        // Half the flanks between 1/2 and 3/4 height is 0.42 standard deviations of a Gaussian; five times
        // that outside the half-height point is 3.3 standard deviations from the middle, also of a clipped
        // one.
        const int out = static_cast<int>(std::ceil(2.5 * std::max(0.0, lobe.width - three_quarters))) + 1;
        double low_left = 0, low_right = 0;
        const bool has_left = foot_level(line_, lobe.left - out, -1, low_left);
        const bool has_right = foot_level(line_, lobe.right + out, 1, low_right);
        if (!has_left && !has_right) low_left = low_right = lobe.base;
        if (!has_left) low_left = low_right;
        if (!has_right) low_right = low_left;
        const double low = std::min({low_left, low_right, static_cast<double>(lobe.top)});
        const double high = std::min(std::max(low_left, low_right), static_cast<double>(lobe.top));
        lobe.middle = 0.5 * (lobe.half_left + lobe.half_right);
        if (high - low <= 0.25 * (lobe.top - low)) {
            // Light that varies evenly across the stripe.
            lobe.base = 0.5 * (low + high);
            const double span = (lobe.right + out + 2) - (lobe.left - out - 2);
            lobe.slope = has_left && has_right ? (low_right - low_left) / span : 0.0;
            lobe.cut = kCut * (lobe.top - lobe.base);
        } else {
            // A step, or a neighbour on one side: the cut stays above it.
            lobe.base = low;
            lobe.cut = std::max(kCut * (lobe.top - low), high + 0.15 * (lobe.top - high) - low);
        }
        const double half = 0.5 * (lobe.top + lobe.base);
        const int limit = line_.size;
        const int from = std::clamp(static_cast<int>(std::lround(lobe.middle)), lobe.left, lobe.right);
        int left = from, right = from;
        if (line_[from] >= half && walk(line_, from, -1, half, lobe.top, limit, left) &&
            walk(line_, from, 1, half, lobe.top, limit, right)) {
            lobe.left = left;
            lobe.right = right;
            lobe.half_left = crossing(line_, left, -1, half);
            lobe.half_right = crossing(line_, right, 1, half);
            lobe.width = lobe.half_right - lobe.half_left;
            three_quarters = width_at(lobe, 0.75);
        }
        lobe.sharpness = lobe.width > 0 ? std::max(0.0, lobe.width - three_quarters) / lobe.width : 0.0;
        lobe.truncated = lobe.left == 0 || lobe.right == line_.size - 1;
    }

    double centre_of_gravity(const Lobe& lobe) const {
        const auto above = [&](int i) { return line_[i] - lobe.base_at(i) - lobe.cut; };
        int left = lobe.top_first, right = lobe.top_last;
        while (left > 0 && (above(left - 1) > 0 || (left > 1 && left > lobe.left && above(left - 2) > 0)))
            --left;
        while (
            right + 1 < line_.size &&
            (above(right + 1) > 0 || (right + 2 < line_.size && right < lobe.right && above(right + 2) > 0)))
            ++right;
        double sum = 0, moment = 0;
        for (int i = left; i <= right; ++i) {
            const double weight = std::max(0.0, above(i));
            sum += weight;
            moment += weight * (i - left);
        }
        return sum > 0 ? left + moment / sum : lobe.middle;
    }

    // Weighted parabola through the logarithm; falls back to the middle of the half-height points.
    double gaussian(const Lobe& lobe) const {
        const double scale = std::max(lobe.height(), 1e-9);
        const double floor = (lobe.clipped ? 0.1 : 0.2) * scale;
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
                if (lobe.clipped && line_[i] >= lobe.top) continue;
                const double y = (line_[i] - lobe.base_at(i)) / scale;
                if (y < 0.02) continue;
                const double x = (i - centre) / unit;
                const double model = round == 0 ? y : std::exp(std::min(a + b * x + c * x * x, 6.0));
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
            if (!(std::abs(det) > 1e-12 * s[0] * s[0] * s[0])) return found;
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
        const double sigma = std::max(options_.steger_sigma_px, 0.5 * lobe.width / std::sqrt(3.0));
        const int reach = static_cast<int>(std::ceil(4 * sigma));
        double low = lobe.half_left, high = lobe.half_right, x = lobe.middle;
        for (int step = 0; step < 12; ++step) {
            const int centre = static_cast<int>(std::lround(x));
            double first = 0, second = 0;
            for (int k = -reach; k <= reach; ++k) {
                const int i = std::clamp(centre + k, 0, line_.size - 1);
                const double u = (centre + k - x) / sigma;
                const double weight = std::exp(-0.5 * u * u), value = line_[i] - lobe.base_at(i);
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
            if (moved < 1e-4) break;
        }
        return x;
    }

    // Sum of grey values above background between the half-height points.
    double energy(const Lobe& lobe) const {
        double sum = 0;
        for (int i = lobe.left; i <= lobe.right; ++i) sum += line_[i] - lobe.base_at(i);
        return sum;
    }

  private:
    // Pixels of the top value; three side by side, or full scale, are a plateau cut off by the sensor.
    void find_top(Lobe& lobe) const {
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
        lobe.clipped = lobe.top >= full_scale_ || longest >= 3;
    }

    double width_at(const Lobe& lobe, double share) const {
        const double level = lobe.base + share * lobe.height();
        int left = lobe.left, right = lobe.right;
        while (left < lobe.top_first && line_[left] < level) ++left;
        while (right > lobe.top_last && line_[right] < level) --right;
        return crossing(line_, right, 1, level) - crossing(line_, left, -1, level);
    }

    // A narrow stripe on a bright square: the square reaches half height too. Its level becomes the
    // background.
    bool raise_from_pedestal(Lobe& lobe) const {
        for (int round = 0; round < 2; ++round) {
            find_top(lobe);
            const double wide = lobe.right - lobe.left + 1;
            const double narrow = width_at(lobe, 0.75);
            if (wide <= 10 || narrow >= 0.35 * wide || lobe.height() < 4) break;
            // Level of the pedestal: mean of its pixels outside three times the core.
            const double centre = 0.5 * (lobe.top_first + lobe.top_last);
            double sum = 0;
            int n = 0;
            for (int i = lobe.left; i <= lobe.right; ++i)
                if (std::abs(i - centre) > 1.5 * narrow + 1) sum += line_[i], ++n;
            if (n < 3) break;
            const double level = sum / n, half = 0.5 * (lobe.top + level);
            int left = lobe.top_first, right = lobe.top_last;
            if (!walk(line_, lobe.top_first, -1, half, lobe.top, line_.size, left) ||
                !walk(line_, lobe.top_last, 1, half, lobe.top, line_.size, right))
                break;
            const double core = crossing(line_, right, 1, half) - crossing(line_, left, -1, half);
            if (core < 2) break;  // a grain of speckle on a wide stripe
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

// Keeps the K strongest peaks of each line in order.
class Keeper {
  public:
    Keeper(StripePeaks& peaks, std::vector<float>& strength) : peaks_(peaks), strength_(strength) {}
    void add(int line, float strength, float position, float intensity, float width, std::uint8_t flags) {
        const int first = line * peaks_.per_line;
        int n = peaks_.count[line];
        if (n == peaks_.per_line) {
            if (strength <= strength_[first + n - 1]) return;
            --n;
        }
        int at = n;
        for (; at > 0 && strength_[first + at - 1] < strength; --at) move(first + at - 1, first + at);
        strength_[first + at] = strength;
        peaks_.position_px[first + at] = position;
        peaks_.intensity[first + at] = intensity;
        peaks_.width_px[first + at] = width;
        peaks_.flags[first + at] = flags;
        peaks_.count[line] = static_cast<std::uint8_t>(n + 1);
    }

  private:
    void move(int from, int to) {
        strength_[to] = strength_[from];
        peaks_.position_px[to] = peaks_.position_px[from];
        peaks_.intensity[to] = peaks_.intensity[from];
        peaks_.width_px[to] = peaks_.width_px[from];
        peaks_.flags[to] = peaks_.flags[from];
    }
    StripePeaks& peaks_;
    std::vector<float>& strength_;
};

struct Workspace {
    StripeScan scan;
    std::vector<float> strength, best;
};

template <class Pixel>
struct Extraction {
    const StripeImage& image;
    const PeakOptions& options;
    const ThresholdRule& rule;
    const StripeScan& scan;
    Keeper keeper;

    Line<Pixel> line(int number) const {
        const auto row = static_cast<std::ptrdiff_t>(image.row_bytes);
        if (options.scan == ScanLines::columns)
            return {image.pixels + static_cast<std::ptrdiff_t>(sizeof(Pixel)) * number, row, image.height};
        return {image.pixels + row * number, static_cast<std::ptrdiff_t>(sizeof(Pixel)), image.width};
    }

    void run(const Run& run) {
        const Line<Pixel> pixels = line(run.line);
        const LobeFinder<Line<Pixel>> finder(pixels, options, image.full_scale());
        struct Interval {
            int begin, end;
        };
        Interval open[16];
        int n = 0;
        open[n++] = {run.begin, run.end};
        while (n > 0) {
            const Interval part = open[--n];
            const int middle = (part.begin + part.end - 1) / 2;
            const int tile = options.scan == ScanLines::columns ? scan.tile_of(run.line, middle)
                                                                : scan.tile_of(middle, run.line);
            Lobe lobe;
            const bool whole = finder.stretch(part.begin, part.end, scan.background[tile], lobe);
            // What lies on either side of it in the run may hold lesser peaks.
            const int left_end = std::min(lobe.left - 1, part.end),
                      right_begin = std::max(lobe.right + 2, part.begin);
            if (whole) keep(finder, run.line, scan.noise[tile], lobe);
            if (left_end > part.begin && n < 16) open[n++] = {part.begin, left_end};
            if (right_begin < part.end && n < 16) open[n++] = {right_begin, part.end};
        }
    }

    void keep(const LobeFinder<Line<Pixel>>& finder, int line_number, float noise, Lobe& lobe) {
        finder.measure(lobe);
        if (lobe.height() < rule.of(noise) * (options.threshold > 0 ? 1.0 : 0.75)) return;
        if (!(lobe.width >= options.min_width_px && lobe.width <= options.max_width_px)) return;
        const double energy = finder.energy(lobe);
        const double pixels = lobe.right - lobe.left + 1;
        if (!(energy > 0)) return;
        if (options.threshold <= 0 && energy < kPeakSigmas * noise * std::sqrt(pixels)) return;
        double position = 0;
        switch (options.method) {
            case PeakMethod::centre_of_gravity:
                position = finder.centre_of_gravity(lobe);
                break;
            case PeakMethod::gaussian:
                position = finder.gaussian(lobe);
                break;
            case PeakMethod::steger:
                position = finder.steger(lobe);
                break;
        }
        const double shape = lobe.clipped ? 1.0 : std::clamp(lobe.sharpness / kSharpness, 0.02, 1.0);
        const auto flags = static_cast<std::uint8_t>((lobe.clipped ? StripePeaks::kSaturated : 0) |
                                                     (lobe.truncated ? StripePeaks::kTruncated : 0));
        keeper.add(line_number, static_cast<float>(energy * shape), static_cast<float>(position),
                   static_cast<float>(lobe.top), static_cast<float>(lobe.width), flags);
    }
};

template <class Pixel>
void extract(const StripeImage& image, const PeakOptions& options, const ThresholdRule& rule, Kernel kernel,
             Workspace& work, StripePeaks& peaks) {
    Extraction<Pixel> extraction{image, options, rule, work.scan, Keeper(peaks, work.strength)};
    scan_runs(
        image, options.scan, rule, kernel, work.scan,
        [](void* context, const std::vector<Run>& runs) {
            auto& self = *static_cast<Extraction<Pixel>*>(context);
            for (const Run& run : runs) self.run(run);
        },
        &extraction);
}

// Leaves out what is weak beside the stripe of this frame: the upper quartile of the lines' strongest peaks.
void drop_weak(Workspace& work, StripePeaks& peaks) {
    work.best.clear();
    for (int line = 0; line < peaks.lines; ++line)
        if (peaks.count[line] > 0) work.best.push_back(work.strength[peaks.index(line, 0)]);
    if (work.best.empty()) return;
    const auto quartile = work.best.begin() + static_cast<std::ptrdiff_t>(work.best.size() * 3 / 4);
    std::nth_element(work.best.begin(), quartile, work.best.end());
    const auto least = static_cast<float>(kFrameShare * *quartile);
    for (int line = 0; line < peaks.lines; ++line)
        while (peaks.count[line] > 0 && work.strength[peaks.index(line, peaks.count[line] - 1)] < least)
            --peaks.count[line];
}

Expected<void> check(const StripeImage& image, const PeakOptions& options) {
    if (image.empty())
        return input_error("the image is empty", "image", "give a frame with at least one pixel");
    if (image.bit_depth != 8 && image.bit_depth != 10 && image.bit_depth != 12 && image.bit_depth != 16)
        return input_error("the bit depth " + std::to_string(image.bit_depth) + " is not supported",
                           "image.bit_depth", "deliver 8, 10, 12 or 16 bit");
    const auto bytes = static_cast<std::size_t>(image.bytes_per_pixel());
    if (image.row_bytes < static_cast<std::size_t>(image.width) * bytes)
        return input_error("a row of " + std::to_string(image.row_bytes) + " bytes is shorter than " +
                               std::to_string(image.width) + " pixels",
                           "image.row_bytes", "give the distance between rows in bytes");
    if (bytes == 2 && (image.row_bytes % 2 || reinterpret_cast<std::uintptr_t>(image.pixels) % 2))
        return input_error("the 16-bit rows begin at odd addresses", "image.row_bytes",
                           "align the rows to 2 bytes");
    const auto in = [](double value, double low, double high) { return value >= low && value <= high; };
    if (options.per_line < 1 || options.per_line > 64)
        return input_error("the number of peaks a line is out of range", "per_line", "give 1 to 64");
    if (!in(options.threshold, 0, image.full_scale()))
        return input_error("the threshold is out of range", "threshold",
                           "give 0 (automatic) to " + std::to_string(image.full_scale()) + " grey values");
    if (!in(options.min_width_px, 0, 1e6) || !in(options.max_width_px, options.min_width_px, 1e6))
        return input_error("the widths are out of range", "min_width_px, max_width_px",
                           "give 0 <= min <= max");
    if (!in(options.steger_sigma_px, 0.5, 20))
        return input_error("the smoothing is out of range", "steger_sigma_px", "give 0.5 to 20");
    return {};
}

}  // namespace

Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks,
                          Kernel kernel) {
    if (auto ok = check(image, options); !ok) return ok;
    thread_local Workspace work;
    peaks.scan = options.scan;
    peaks.lines = options.scan == ScanLines::columns ? image.width : image.height;
    peaks.per_line = options.per_line;
    const auto lines = static_cast<std::size_t>(peaks.lines),
               slots = lines * static_cast<std::size_t>(options.per_line);
    peaks.count.assign(lines, 0);
    peaks.position_px.resize(slots);
    peaks.intensity.resize(slots);
    peaks.width_px.resize(slots);
    peaks.flags.resize(slots);
    work.strength.resize(slots);
    work.best.reserve(lines);

    ThresholdRule rule;
    rule.fixed = options.threshold;
    rule.noise_factor = kPixelSigmas;
    rule.floor = image.full_scale() / 256.0 + 1.0;
    measure_background(image, options.scan, options.max_width_px, kernel, work.scan);
    if (image.bytes_per_pixel() == 1) {
        extract<std::uint8_t>(image, options, rule, kernel, work, peaks);
    } else {
        extract<std::uint16_t>(image, options, rule, kernel, work, peaks);
    }
    if (options.threshold <= 0) drop_weak(work, peaks);
    return {};
}

}  // namespace detail

Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks) {
    return detail::find_peaks(image, options, peaks, detail::Kernel::best);
}

Expected<ScanLines> guess_scan_lines(const StripeImage& image) {
    double score[2] = {0, 0};
    StripePeaks peaks;
    for (const ScanLines scan : {ScanLines::columns, ScanLines::rows}) {
        PeakOptions options;
        options.scan = scan;
        options.per_line = 1;
        if (auto ok = find_peaks(image, options, peaks); !ok) return tl::unexpected(ok.error());
        for (int i = 1; i < peaks.lines; ++i) {
            if (!peaks.count[i - 1] || !peaks.count[i]) continue;
            // A stripe flatter than 45 degrees moves less than a pixel a line; noise of its position is
            // allowed for.
            if (std::abs(peaks.position_px[i] - peaks.position_px[i - 1]) < 1.5)
                ++score[scan == ScanLines::rows];
        }
    }
    return score[1] > score[0] ? ScanLines::rows : ScanLines::columns;
}

}  // namespace seamwright
