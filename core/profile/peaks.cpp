#include "core/profile/peaks.h"

#include <algorithm>
#include <cmath>

#include "core/profile/lobe.h"
#include "core/profile/peaks_detail.h"
#include "core/profile/stripe_scan.h"

namespace seamwright {
namespace detail {
namespace {

constexpr double kPixelSigmas = 4.0;    // candidate pixel
constexpr double kPeakSigmas = 7.0;     // sum over the width of a peak, in its own standard deviations
constexpr double kFrameShare = 0.001;   // of the strength that stripes have in the frame
constexpr double kHotPixelWidth = 1.1;  // px; a single bright pixel has 1.0, the sharpest optics 1.2
constexpr double kSharpness = 0.3;      // (width at 1/2 - width at 3/4)/width at 1/2; 0.356 of a Gaussian

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

    // A run of one or two pixels with a higher one within two pixels belongs to that one, whatever lies
    // between (see walk); noise makes many of them where a flank falls through the threshold.
    static bool on_a_flank(const Line<Pixel>& pixels, const Run& run) {
        const int top = std::max(pixels[run.begin], pixels[run.end - 1]);
        for (const int i : {run.begin - 2, run.begin - 1, run.end, run.end + 1})
            if (i >= 0 && i < pixels.size && pixels[i] > top) return true;
        return false;
    }

    void run(const Run& run) {
        const Line<Pixel> whole_line = line(run.line);
        if (run.end - run.begin <= 2 && on_a_flank(whole_line, run)) return;
        const LineWindow<Pixel> pixels(whole_line, run);
        const LobeFinder<LineWindow<Pixel>> finder(pixels, options, image.full_scale());
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
            const Lobe seen = lobe;
            if (whole) keep(finder, run.line, scan.noise[tile], lobe);
            // What lies on either side of it in the run may hold lesser peaks.
            const int left_end = std::min(seen.left - 1, part.end),
                      right_begin = std::max(seen.right + 2, part.begin);
            if (left_end > part.begin && n < 16 && rises_again(pixels, seen.left, part.begin))
                open[n++] = {part.begin, left_end};
            if (right_begin < part.end && n < 16 && rises_again(pixels, seen.right, part.end - 1))
                open[n++] = {right_begin, part.end};
        }
    }

    void keep(const LobeFinder<LineWindow<Pixel>>& finder, int line_number, float noise, Lobe& lobe) {
        finder.measure(lobe, noise);
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
        double strength = energy * lobe.height() * finder.unimodality(lobe, noise);
        if (!lobe.clipped) strength *= std::clamp(lobe.sharpness / kSharpness, 0.02, 1.0);
        if (lobe.width < kHotPixelWidth) strength *= 0.1;
        const auto flags = static_cast<std::uint8_t>((lobe.clipped ? StripePeaks::kSaturated : 0) |
                                                     (lobe.truncated ? StripePeaks::kTruncated : 0));
        keeper.add(line_number, static_cast<float>(strength), static_cast<float>(position),
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
    rule.floor = image.full_scale() / 256.0 + 2.0;
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
