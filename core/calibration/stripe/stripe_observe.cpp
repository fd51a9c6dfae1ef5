// Plate and stripe of one frame.

#include <algorithm>
#include <array>

#include "core/calibration/stripe/stripe_camera.h"
#include "core/profile/stripe/peaks.h"

namespace seamwright {
namespace {

std::uint32_t grey(const StripeImage& image, int x, int y) {
    const auto* row = image.pixels + static_cast<std::size_t>(y) * image.row_bytes;
    if (image.bytes_per_pixel() == 1) return std::to_integer<std::uint32_t>(row[x]);
    return std::to_integer<std::uint32_t>(row[2 * x]) | std::to_integer<std::uint32_t>(row[2 * x + 1]) << 8;
}

// Half way between background and the stripe's plateau, so that halo and speckle beside a saturated stripe do
// not shift its middle. The plateau is the level of the brightest 0.3 % of the pixels: a stripe across the
// frame covers more.
constexpr double kPlateauQuantile = 0.997;

double half_level(const StripeImage& image) {
    std::vector<std::uint32_t> histogram(static_cast<std::size_t>(image.full_scale()) + 1, 0);
    std::size_t count = 0;
    for (int y = 0; y < image.height; y += 2)
        for (int x = 0; x < image.width; x += 2) {
            ++histogram[std::min<std::size_t>(grey(image, x, y), histogram.size() - 1)];
            ++count;
        }
    const auto quantile = [&](double q) {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < histogram.size(); ++i)
            if (static_cast<double>(sum += histogram[i]) > q * static_cast<double>(count))
                return static_cast<double>(i);
        return static_cast<double>(histogram.size() - 1);
    };
    const double background = quantile(0.5), plateau = quantile(kPlateauQuantile);
    return 0.5 * (plateau - background);
}

std::vector<Eigen::Vector2d> peaks_of(const StripeImage& image, ScanLines scan, double threshold) {
    // Of a stripe: in pixels, or of the longer side of the image where that is more.
    constexpr double kWidest_px = 80.0, kWidest = 0.08;
    PeakOptions options;
    options.scan = scan;
    options.per_line = 3;
    options.threshold = threshold;
    options.min_width_px = 2;
    options.max_width_px = std::max(kWidest_px, kWidest * std::max(image.width, image.height));
    StripePeaks peaks;
    std::vector<Eigen::Vector2d> out;
    if (!find_peaks(image, options, peaks)) return out;
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.count[static_cast<std::size_t>(line)]; ++k) {
            const auto i = static_cast<std::size_t>(peaks.index(line, k));
            const double position = peaks.position_px[i];
            // A stripe that runs out of the image has no middle there.
            const double reach = 0.5 * peaks.width_px[i] + 2;
            const double end = (scan == ScanLines::rows ? image.width : image.height) - 1;
            if (position < reach || position > end - reach) continue;
            out.emplace_back(scan == ScanLines::rows ? Eigen::Vector2d(position, line)
                                                     : Eigen::Vector2d(line, position));
        }
    return out;
}

}  // namespace

StripeObservation observe(const StripeFrame& frame, const BoardSpec& spec) {
    StripeObservation out;
    out.id = frame.id;
    out.width = frame.image.width;
    out.height = frame.image.height;
    out.base_from_flange = frame.base_from_flange;
    if (frame.image.empty()) return out;
    BoardSearch search = find_board(frame.image, spec);
    out.board = std::move(search.board);
    out.miss = search.miss;
    constexpr double kStandsOut = 0.02;  // of full scale
    const double threshold = half_level(frame.image);
    if (threshold < kStandsOut * frame.image.full_scale())
        return out;  // nothing stands out of the background
    // A stripe gives about one peak on each line that crosses it; cut along it, it gives few and wide ones.
    const auto rows = peaks_of(frame.image, ScanLines::rows, threshold);
    const auto columns = peaks_of(frame.image, ScanLines::columns, threshold);
    out.scan = rows.size() >= columns.size() ? ScanLines::rows : ScanLines::columns;
    out.stripe = out.scan == ScanLines::rows ? rows : columns;
    return out;
}

}  // namespace seamwright
