#pragma once
// Camera images as files.

#include <filesystem>

#include "core/error.h"
#include "core/profile/stripe_image.h"
#include "devices/frame.h"

namespace seamwright {

// PNG, BMP, TIFF, PGM/PPM or JPEG (lossy: smears a stripe) of 8 or 16 bit into `frame.pixels` and
// `frame.image`, rows packed. Colour becomes grey by the luminance weights (equal channels keep their value
// exactly). `bit_depth` 0 takes the container's 8 or 16; 10 or 12 says that the words of a 16 bit file hold
// only so many bits, right-aligned (a larger value is then an Error). Error (file): missing, unreadable,
// truncated, not an image, floating point, larger than 2^28 pixels. Of a failed read the frame keeps no
// image.
Expected<void> read_image_file(const std::filesystem::path& path, Frame& frame, int bit_depth = 0);

// Lossless, format by extension (.png, .tiff, .pgm, .bmp for 8 bit). Atomic as write_text_file().
Expected<void> write_image_file(const std::filesystem::path& path, const StripeImage& image);

}  // namespace seamwright
