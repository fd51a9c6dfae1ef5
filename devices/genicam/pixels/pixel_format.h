#pragma once
// Pixel formats of GenICam cameras, and how their bytes become grey values. Pure functions on bytes.
//
// Names, codes and packings: GenICam Pixel Format Naming Convention (PFNC) 2.4, and GigE Vision 2.0 chapter
// 26 for its own "Packed" formats. Words of 16 and 32 bit are little-endian.
//     Mono10p, Mono12p (PFNC)   a stream of bits, first pixel in the lowest bits of the first byte
//     Mono10Packed (GigE)       2 pixels in 3 bytes: p0[9:2] | p1[1:0] << 4 + p0[1:0] | p1[9:2]
//     Mono12Packed (GigE)       2 pixels in 3 bytes: p0[11:4] | p1[3:0] << 4 + p0[3:0] | p1[11:4]
// A packed image is one stream: its rows begin where the row before ended, inside a byte even, unless the
// camera pads rows.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/profile/stripe/stripe_image.h"
#include "devices/exchange/image_file.h"

namespace seamwright {

enum class Packing { bytes, words, floats, lsb, gige };  // 8 bit, 16 bit words, 32 bit float, PFNC p, GigE

struct PixelFormat {
    std::string_view name;   // PFNC: "Mono12p", "Coord3D_AC16_Planar"
    std::uint32_t code = 0;  // bits 16..23: bits of a pixel
    Packing packing = Packing::bytes;
    int bit_depth = 8;  // of a component
    // Coordinates of a point, in the order of the data ("AC"); empty: a grey value.
    std::string_view coordinates;
    bool planar = false;  // coordinates one after another, each a whole image
    // "RGB", "BGR": components of a pixel; "RG", "GR", "GB", "BG": the first two of a Bayer mosaic. Empty:
    // grey.
    std::string_view colour = {};
    int bits_per_pixel() const { return static_cast<int>((code >> 16) & 0xFF); }
    bool is_range() const { return !coordinates.empty(); }
};
const std::vector<PixelFormat>& pixel_formats();  // all that can be read
const PixelFormat* pixel_format_by_code(std::uint32_t code);
// Also the older names of GigE Vision 1 ("Mono10Packed" is one and the same).
const PixelFormat* pixel_format_by_name(std::string_view name);

// Bytes that an image takes; `row_padding` bytes follow each row (rows then begin at whole bytes). 0 for
// sizes that are not positive.
std::size_t image_bytes(const PixelFormat& format, int width, int height, std::size_t row_padding = 0);

// The values of `count` pixels (of RGB: components), of a mosaic as they lie. Preconditions (asserted): no range format;
// `packed` holds them all.
// To bytes for 8 bit, else to 16-bit words.
void unpack_pixels(const PixelFormat& format, std::span<const std::byte> packed, std::size_t count,
                   std::byte* out);
// The other way, for cameras that are served and for tests.
void pack_pixels(const PixelFormat& format, const std::byte* pixels, std::size_t count, std::byte* out);

// The image in `pixels` (grown when too small), ready for extraction. Error (device): a range format, sizes
// that are not positive or beyond 65536, too few bytes. Of colour the `channel` (colour.h).
Expected<StripeImage> unpack_image(const PixelFormat& format, std::span<const std::byte> payload, int width,
                                   int height, std::size_t row_padding, std::vector<std::byte>& pixels,
                                   ImageChannel channel = ImageChannel::grey);

// "Mono8, RGB8": what a camera offers, for sentences.
std::string join_names(std::span<const std::string> names);

}  // namespace seamwright
