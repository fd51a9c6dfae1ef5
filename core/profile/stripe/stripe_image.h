#pragma once
// A camera frame that shows a laser stripe, as the sensor delivers it.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace seamwright {

// A view, never an owner: the pixels belong to the driver's buffer. Grey values are unsigned; depths of 10,
// 12 and 16 bit stand right-aligned in 16-bit little-endian words, 8 bit in bytes.
struct StripeImage {
    const std::byte* pixels = nullptr;
    int width = 0, height = 0;  // px
    std::size_t row_bytes = 0;  // distance between rows, >= width * bytes per pixel
    int bit_depth = 8;          // 8, 10, 12 or 16
    int bytes_per_pixel() const { return bit_depth > 8 ? 2 : 1; }
    int full_scale() const { return (1 << bit_depth) - 1; }  // the value of a saturated pixel
    bool empty() const { return !pixels || width <= 0 || height <= 0; }
};

// Along which image lines the stripe is cut: one cut per column (stripe runs left to right) or per row.
enum class ScanLines { columns, rows };

// Peaks of all lines, strongest first within a line, at most `per_line` of them. Flat arrays of lines *
// per_line, so that a buffer is allocated once and reused frame after frame. Pixel centres lie on whole
// numbers: pixel (0,0) covers -0.5..0.5.
struct StripePeaks {
    ScanLines scan = ScanLines::columns;
    int lines = 0, per_line = 1;
    std::vector<std::uint8_t> count;  // [lines] peaks found on the line
    std::vector<float> position_px;   // [lines * per_line] sub-pixel position along the line
    std::vector<float> intensity;     // grey value at the peak, 0..full_scale
    std::vector<float> width_px;  // full width at half maximum; of a saturated stripe its plateau and flanks
    std::vector<std::uint8_t> flags;  // kSaturated | kTruncated
    static constexpr std::uint8_t kSaturated =
        1;  // top cut off at the sensor's full scale (or at a flat plateau)
    static constexpr std::uint8_t kTruncated =
        2;  // runs out of the image: the position is that of the visible part
    int index(int line, int peak) const { return line * per_line + peak; }
};

}  // namespace seamwright
