#pragma once
// Range images: what cameras deliver that find the stripe themselves. Each row is one profile. Pure
// functions.
//
// Coordinates follow the GenICam Standard Features Naming Convention (SFNC) 2.7, chapter Scan3dControl: of a
// Cartesian system A is x, B is y, C is z; a coordinate is raw * scale + offset in Scan3dDistanceUnit. Where
// the data holds no A (RectifiedC), x follows from the column: A's offset + column * A's scale. A format that
// holds A alone is taken for a range along A: it becomes the height. B is where the row lies along the
// travel and is not used: a profile is a cut at y = 0.

#include <cstddef>
#include <optional>
#include <span>

#include "core/error.h"
#include "core/profile/profile.h"
#include "devices/genicam/pixels/pixel_format.h"

namespace seamwright {

struct CoordinateScale {
    double scale_mm = 1, offset_mm = 0;  // mm a step, mm at zero
};
struct RangeMapping {
    CoordinateScale x, z;
    std::optional<double> invalid;  // raw value of "no return" in the height; NaN and infinite always are
    int first_column = 0;           // of the region on the sensor, for x from columns
};

// Row `row` of an image of `width` x `height` points into `profile` (its buffers are reused): x, z in mm, z
// NaN where there is no return. Grey formats of 8 and 16 bit are read as heights. Error (device): a packed
// format, a row outside, too few bytes.
Expected<void> range_row(const PixelFormat& format, std::span<const std::byte> payload, int width, int height,
                         int row, std::size_t row_padding, const RangeMapping& mapping, Profile& profile);

}  // namespace seamwright
