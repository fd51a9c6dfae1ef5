#include "core/profile/stripe/peaks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/profile/stripe/lobe.h"
#include "core/profile/stripe/lobe_group.h"
#include "core/profile/stripe/peaks_detail.h"
#include "core/profile/stripe/stripe_scan.h"

namespace seamwright {
namespace detail {
namespace {

constexpr double kPixelSigmas = 4.0;  // candidate pixel
constexpr double kPeakSigmas = 7.0;   // sum over the width of a peak, in its own standard deviations
constexpr double kSumMargin = 0.75;   // of that sum, for a background that is darker than the tile's
constexpr double kPeakHeight = 0.75;  // of a candidate pixel's: over the peak's own background
// What a candidate pixel has at least: of full scale, and grey values.
constexpr double kFloorShare = 1 / 256.0, kFloorGrey = 2;
constexpr double kWidest_px = 1e6;
constexpr double kFrameShare = 0.001;  // of the strength that stripes have in the frame

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
    Kernel kernel;
    LobeGroup group;
    Run members[kGroupLanes];  // of the group

    Line<Pixel> line(int number) const {
        const auto row = static_cast<std::ptrdiff_t>(image.row_bytes);
        if (options.scan == ScanLines::columns)
            return {image.pixels + static_cast<std::ptrdiff_t>(sizeof(Pixel)) * number, row, image.height};
        return {image.pixels + row * number, static_cast<std::ptrdiff_t>(sizeof(Pixel)), image.width};
    }

    // A run of one or two pixels with a higher one within two pixels belongs to that one, whatever lies
    // between (see walk); noise makes many of them where a flank falls through the threshold.
    static bool on_a_flank(const Line<Pixel>& pixels, const Run& run) {
        const int top = std::max(pixels[run.begin], pixels[run.end - 1]);
        for (const int i : {run.begin - 2, run.begin - 1, run.end, run.end + 1})
            if (i >= 0 && i < pixels.size && pixels[i] > top) return true;
        return false;
    }

    // Whether a run of one or two pixels is too weak for a peak: its stretch at half height above the tile's
    // background holds less than what a peak needs, with a margin for a background that is darker there.
    // Noise alone makes hundreds of such runs in a frame.
    bool too_weak(const Line<Pixel>& pixels, const Run& run) const {
        if (options.threshold > 0) return false;
        const int tile = tile_of(run.line, {run.begin, run.end});
        const float base = scan.background[tile];
        const float half =
            0.5f * (base + static_cast<float>(std::max(pixels[run.begin], pixels[run.end - 1])));
        int begin = run.begin, end = run.end;
        while (begin > 0 && run.begin - begin < 4 && static_cast<float>(pixels[begin - 1]) >= half) --begin;
        while (end < pixels.size && end - run.end < 4 && static_cast<float>(pixels[end]) >= half) ++end;
        float energy = 0;
        for (int i = begin; i < end; ++i) energy += static_cast<float>(pixels[i]) - base;
        const float needed = static_cast<float>(kSumMargin * kPeakSigmas) * scan.noise[tile];
        return energy < 0 || energy * energy < needed * needed * static_cast<float>(end - begin);
    }

    struct Interval {
        int begin, end;
    };

    void run(const Run& run) {
        const LineWindow<Pixel> pixels(line(run.line), run);
        const Interval whole{run.begin, run.end};
        pieces(pixels, run.line, &whole, 1);
    }

    // The lobes of these pieces of a run, the strongest of each first.
    void pieces(const LineWindow<Pixel>& pixels, int line_number, const Interval* given, int count) {
        const LobeFinder<LineWindow<Pixel>> finder(pixels, options, image.full_scale());
        Interval open[16];
        int n = 0;
        for (; n < count; ++n) open[n] = given[n];
        while (n > 0) {
            const Interval part = open[--n];
            const int tile = tile_of(line_number, part);
            Lobe lobe;
            const bool whole = finder.stretch(part.begin, part.end, scan.background[tile], lobe);
            const Lobe seen = lobe;
            if (whole) keep(finder, line_number, scan.noise[tile], lobe);
            // What lies on either side of it in the run may hold lesser peaks.
            const int left_end = std::min(seen.left - 1, part.end),
                      right_begin = std::max(seen.right + 2, part.begin);
            if (left_end > part.begin && n < 16 && rises_again(pixels, seen.left, part.begin))
                open[n++] = {part.begin, left_end};
            if (right_begin < part.end && n < 16 && rises_again(pixels, seen.right, part.end - 1))
                open[n++] = {right_begin, part.end};
        }
    }

    int tile_of(int line_number, const Interval& part) const {
        const int middle = (part.begin + part.end - 1) / 2;
        return options.scan == ScanLines::columns ? scan.tile_of(line_number, middle)
                                                  : scan.tile_of(middle, line_number);
    }

    // Runs of one batch: short ones inside the image eight at a time, the others one by one.
    void batch(const std::vector<Run>& runs) {
        const int size = options.scan == ScanLines::columns ? image.height : image.width;
        int n = 0;
        for (const Run& run : runs) {
            const int length = run.end - run.begin;
            if (length <= 2) {
                const Line<Pixel> pixels = line(run.line);
                if (on_a_flank(pixels, run) || too_weak(pixels, run)) continue;
            }
            if (kernel == Kernel::careful || length > kGroupRun || run.begin < kGroupMargin ||
                run.end + kGroupMargin > size) {
                this->run(run);
                continue;
            }
            members[n++] = run;
            if (n == kGroupLanes) {
                measure_members(n);
                n = 0;
            }
        }
        if (n > 0) measure_members(n);
    }

    void measure_members(int count) {
        int longest = 0;
        for (int k = 0; k < count; ++k) longest = std::max(longest, members[k].end - members[k].begin);
        group.rows = longest + 2 * kGroupMargin;
        std::array<const std::byte*, kGroupLanes> from;
        bool inside = true;
        const int size = line(0).size;
        for (int k = 0; k < kGroupLanes; ++k) {
            const Run& run = members[k < count ? k : 0];  // lanes to spare repeat the first
            const int tile = tile_of(run.line, {run.begin, run.end});
            group.length[k] = run.end - run.begin;
            group.background[k] = scan.background[tile];
            group.noise[k] = scan.noise[tile];
            group.least_height[k] = static_cast<float>(least_height(scan.noise[tile]));
            const Line<Pixel> pixels = line(run.line);
            const int first = run.begin - kGroupMargin;
            from[k] = pixels.first + first * pixels.step;
            inside &= first + group.rows <= size;
        }
        if (inside) {
            fill_group(from, line(0).step, std::make_index_sequence<kGroupLanes>());
        } else {
            for (int k = 0; k < kGroupLanes; ++k) {
                const Run& run = members[k < count ? k : 0];
                const Line<Pixel> pixels = line(run.line);
                for (int r = 0; r < group.rows; ++r) {
                    const int i = run.begin - kGroupMargin + r;
                    group.pixels[r][k] = i < size ? static_cast<std::uint16_t>(pixels[i]) : 0;
                }
            }
        }
        measure_group(group, kernel);
        for (int k = 0; k < count; ++k) {
            const Run& run = members[k];
            const std::int32_t outcome = group.outcome[k];
            if (outcome & kCareful) {
                this->run(run);
                continue;
            }
            if (outcome & kPeak) keep_member(k);
            if (outcome & (kLeftMore | kRightMore)) {
                const int first = run.begin - kGroupMargin;
                Interval rest[2];
                int n = 0;
                if (outcome & kLeftMore) rest[n++] = {run.begin, first + group.left[k] - 1};
                if (outcome & kRightMore) rest[n++] = {first + group.right[k] + 2, run.end};
                pieces(LineWindow<Pixel>(line(run.line), run), run.line, rest, n);
            }
        }
    }

    template <std::size_t... k>
    void fill_group(std::array<const std::byte*, kGroupLanes> from, std::ptrdiff_t step,
                    std::index_sequence<k...>) {
        std::ptrdiff_t at = 0;
        for (int r = 0; r < group.rows; ++r, at += step)
            ((group.pixels[r][k] = *reinterpret_cast<const Pixel*>(from[k] + at)), ...);
    }

    void keep_member(int k) {
        const Run& run = members[k];
        const int first = run.begin - kGroupMargin;
        double position = first + static_cast<double>(group.position[k]);
        if (options.method != PeakMethod::centre_of_gravity) {
            Lobe lobe;
            lobe.top = static_cast<int>(group.top[k]);
            lobe.top_first = first + group.top_first[k];
            lobe.top_last = first + group.top_last[k];
            lobe.left = first + group.half_from[k];
            lobe.right = first + group.half_to[k];
            lobe.base = group.base[k];
            lobe.slope = group.slope[k];
            lobe.half_left = first + static_cast<double>(group.half_left[k]);
            lobe.half_right = first + static_cast<double>(group.half_right[k]);
            lobe.width = lobe.half_right - lobe.half_left;
            lobe.middle = 0.5 * (lobe.half_left + lobe.half_right);
            const LineWindow<Pixel> pixels(line(run.line), run);
            const LobeFinder<LineWindow<Pixel>> finder(pixels, options, image.full_scale());
            position = options.method == PeakMethod::gaussian ? finder.gaussian(lobe) : finder.steger(lobe);
        }
        keeper.add(run.line, group.strength[k], static_cast<float>(position), group.top[k],
                   group.half_right[k] - group.half_left[k], 0);
    }

    double least_height(float noise) const {
        return rule.of(noise) * (options.threshold > 0 ? 1.0 : kPeakHeight);
    }

    void keep(const LobeFinder<LineWindow<Pixel>>& finder, int line_number, float noise, Lobe& lobe) {
        finder.measure(lobe, noise);
        if (lobe.height() < least_height(noise)) return;
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
        double strength = energy * lobe.height() * finder.unimodality(lobe, noise);
        if (!lobe.clipped) strength *= std::clamp(lobe.sharpness / kSharpness, kLeastSharp, 1.0);
        if (lobe.width < kHotPixelWidth) strength *= kHotPixelStrength;
        const auto flags = static_cast<std::uint8_t>((lobe.clipped ? StripePeaks::kSaturated : 0) |
                                                     (lobe.truncated ? StripePeaks::kTruncated : 0));
        keeper.add(line_number, static_cast<float>(strength), static_cast<float>(position),
                   static_cast<float>(lobe.top), static_cast<float>(lobe.width), flags);
    }
};

template <class Pixel>
void extract(const StripeImage& image, const PeakOptions& options, const ThresholdRule& rule, Kernel kernel,
             Workspace& work, StripePeaks& peaks) {
    Extraction<Pixel> extraction{image,  options, rule, work.scan, Keeper(peaks, work.strength),
                                 kernel, {},      {}};
    extraction.group.least_sigmas = options.threshold > 0 ? 0.0f : static_cast<float>(kPeakSigmas);
    extraction.group.min_width = static_cast<float>(options.min_width_px);
    extraction.group.max_width = static_cast<float>(options.max_width_px);
    extraction.group.full_scale = static_cast<float>(image.full_scale());
    extraction.group.centre_of_gravity = options.method == PeakMethod::centre_of_gravity;
    scan_runs(
        image, options.scan, rule, kernel, work.scan,
        [](void* context, const std::vector<Run>& runs) {
            static_cast<Extraction<Pixel>*>(context)->batch(runs);
        },
        &extraction);
}

// Leaves out what is weak beside the stripe of this frame: the upper quartile of the lines' strongest
// peaks.
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
        return input_error(Text("the bit depth {} is not supported", image.bit_depth), "image.bit_depth",
                           "deliver 8, 10, 12 or 16 bit");
    const auto bytes = static_cast<std::size_t>(image.bytes_per_pixel());
    if (image.row_bytes < static_cast<std::size_t>(image.width) * bytes)
        return input_error(Text("a row of {} bytes is shorter than {} pixels", image.row_bytes, image.width),
                           "image.row_bytes", "give the distance between rows in bytes");
    if (bytes == 2 && (image.row_bytes % 2 || reinterpret_cast<std::uintptr_t>(image.pixels) % 2))
        return input_error("the 16-bit rows begin at odd addresses", "image.row_bytes",
                           "align the rows to 2 bytes");
    const auto in = [](double value, double low, double high) { return value >= low && value <= high; };
    if (options.per_line < 1 || options.per_line > 64)
        return input_error("the number of peaks a line is out of range", "per_line", "give 1 to 64");
    if (!in(options.threshold, 0, image.full_scale()))
        return input_error("the threshold is out of range", "threshold",
                           Text("give 0 (automatic) to {} grey values", image.full_scale()));
    if (!in(options.min_width_px, 0, kWidest_px) ||
        !in(options.max_width_px, options.min_width_px, kWidest_px))
        return input_error("the widths are out of range", "min_width_px, max_width_px",
                           "give 0 <= min <= max");
    if (!in(options.steger_sigma_px, 0.5, 20))
        return input_error("the smoothing is out of range", "steger_sigma_px", "give 0.5 to 20");
    return {};
}

}  // namespace

Expected<void> find_peaks(const StripeImage& image, const PeakOptions& options, StripePeaks& peaks,
                          Kernel kernel) {
    SEAM_OK(check(image, options));
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
    rule.floor = image.full_scale() * kFloorShare + kFloorGrey;
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
        SEAM_OK(find_peaks(image, options, peaks));
        for (int i = 1; i < peaks.lines; ++i) {
            if (!peaks.count[i - 1] || !peaks.count[i]) continue;
            // A stripe flatter than 45 degrees moves less than a pixel a line; noise of its position is
            // allowed for.
            constexpr double kFlat_px = 1.5;
            if (std::abs(peaks.position_px[i] - peaks.position_px[i - 1]) < kFlat_px)
                ++score[scan == ScanLines::rows];
        }
    }
    return score[1] > score[0] ? ScanLines::rows : ScanLines::columns;
}

}  // namespace seamwright
