#pragma once
// Colour cameras: RGB, BGR and Bayer mosaics to the one channel that is extracted. Between the pixels of its
// colour a Bayer value is the mean of the nearest ones of that colour, so that a line keeps its place; the
// outermost rows and columns are those beside them.

#include <span>
#include <vector>

#include "core/error.h"
#include "devices/exchange/image_file.h"
#include "devices/genicam/pixels/pixel_format.h"

namespace seamwright {

// As unpack_image() of pixel_format.h, for formats with `colour`. Error (device): a mosaic of less than 3 x 3
// pixels. Preconditions (asserted): such a format, a payload that holds the image.
Expected<StripeImage> unpack_colour(const PixelFormat& format, std::span<const std::byte> payload, int width,
                                    int height, std::size_t row_padding, ImageChannel channel,
                                    std::vector<std::byte>& pixels);

}  // namespace seamwright
