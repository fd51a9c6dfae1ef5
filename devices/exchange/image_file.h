#pragma once
// Camera images as files.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/profile/stripe/stripe_image.h"
#include "devices/frame.h"

namespace seamwright {

// What becomes of colour. `grey`: the luminance weights (equal channels keep their value exactly), in which a
// red laser all but drowns in white light; `red_difference`: R - (G + B) / 2, not below 0, in which white
// light is gone.
enum class ImageChannel { grey, red, green, blue, red_difference };
std::string_view to_string(ImageChannel channel);  // "red-difference"
std::optional<ImageChannel> image_channel(std::string_view word);

// PNG, BMP, TIFF, PGM/PPM or JPEG (lossy: smears a stripe) of 8 or 16 bit into `frame.pixels` and
// `frame.image`, rows packed, colour as `channel` says. `bit_depth` 0 takes the container's 8 or 16; 10 or 12
// says that the words of a 16 bit file hold only so many bits, right-aligned (a larger value is then an
// Error). Error (file): missing, unreadable, truncated, not an image, floating point, more than kMostImagePixels
// (image_codecs.h). Of a failed read the frame keeps no image.
Expected<void> read_image_file(const std::filesystem::path& path, Frame& frame, int bit_depth = 0,
                               ImageChannel channel = ImageChannel::grey);

// Which channel shows a stripe, for images whose laser has a colour: that in which a thin bright line goes on
// from image line to image line and stands highest above the rest of the picture. Grey for pictures without
// colour.
struct ChannelChoice {
    ImageChannel channel = ImageChannel::grey;
    bool colour = false;    // the picture has colour at all
    bool mosaic = false;    // one channel, and the raw one of a colour camera (is_colour_mosaic())
    double share = 0;       // of the image lines on which that line goes on
    double share_grey = 0;  // the same in grey
};
Expected<ChannelChoice> choose_channel(const std::filesystem::path& path, int bit_depth = 0);

// Whether neighbouring pixels stand behind filters of other colours (Bayer), where a stripe of one colour jumps from pixel to
// pixel. In blocks of 2 x 2 pixels a b / c d, m = a - b - c + d is that of the diagonals, and r the block's range. A lens draws
// next to nothing of m that goes on from block to block, a mosaic the same everywhere: sum of m of two neighbours over the sum of
// r^2 is above 0.12. On real grey pictures of stripes and boards it is -0.02 to 0.00, on drawn stripes of any direction and 1.2
// pixels of width and more at most 0.03; under a red laser's filter 0.25 to 0.97 (thinner than 2.4 pixels down to 0). A scene that
// is grey to the camera shows none, and needs none.
bool is_colour_mosaic(const StripeImage& image);
Text mosaic_warning();

// `on` minus `off`, not below 0: two pictures of one place, the laser on and off. Error (input): other sizes
// or depths. `on` owns its pixels.
Expected<void> subtract_image(Frame& on, const Frame& off);

// Lossless, format by extension (.png, .tiff, .pgm, .bmp for 8 bit). Atomic as write_text_file().
Expected<void> write_image_file(const std::filesystem::path& path, const StripeImage& image);

}  // namespace seamwright
