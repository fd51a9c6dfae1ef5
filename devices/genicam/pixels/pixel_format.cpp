#include "devices/genicam/pixels/pixel_format.h"

#include <fmt/format.h>

#include <algorithm>

#include "devices/genicam/pixels/colour.h"

namespace seamwright {

const std::vector<PixelFormat>& pixel_formats() {
    using enum Packing;
    static const std::vector<PixelFormat> formats = {
        {"Mono8", 0x01080001, bytes, 8, "", false},
        {"Mono10", 0x01100003, words, 10, "", false},
        {"Mono10Packed", 0x010C0004, gige, 10, "", false},
        {"Mono10p", 0x010A0046, lsb, 10, "", false},
        {"Mono12", 0x01100005, words, 12, "", false},
        {"Mono12Packed", 0x010C0006, gige, 12, "", false},
        {"Mono12p", 0x010C0047, lsb, 12, "", false},
        {"Mono14", 0x01100025, words, 14, "", false},
        {"Mono16", 0x01100007, words, 16, "", false},
        {"BayerGR8", 0x01080008, bytes, 8, "", false, "GR"},
        {"BayerRG8", 0x01080009, bytes, 8, "", false, "RG"},
        {"BayerGB8", 0x0108000A, bytes, 8, "", false, "GB"},
        {"BayerBG8", 0x0108000B, bytes, 8, "", false, "BG"},
        {"BayerGR10", 0x0110000C, words, 10, "", false, "GR"},
        {"BayerRG10", 0x0110000D, words, 10, "", false, "RG"},
        {"BayerGB10", 0x0110000E, words, 10, "", false, "GB"},
        {"BayerBG10", 0x0110000F, words, 10, "", false, "BG"},
        {"BayerGR12", 0x01100010, words, 12, "", false, "GR"},
        {"BayerRG12", 0x01100011, words, 12, "", false, "RG"},
        {"BayerGB12", 0x01100012, words, 12, "", false, "GB"},
        {"BayerBG12", 0x01100013, words, 12, "", false, "BG"},
        {"BayerGR10Packed", 0x010C0026, gige, 10, "", false, "GR"},
        {"BayerRG10Packed", 0x010C0027, gige, 10, "", false, "RG"},
        {"BayerGB10Packed", 0x010C0028, gige, 10, "", false, "GB"},
        {"BayerBG10Packed", 0x010C0029, gige, 10, "", false, "BG"},
        {"BayerGR12Packed", 0x010C002A, gige, 12, "", false, "GR"},
        {"BayerRG12Packed", 0x010C002B, gige, 12, "", false, "RG"},
        {"BayerGB12Packed", 0x010C002C, gige, 12, "", false, "GB"},
        {"BayerBG12Packed", 0x010C002D, gige, 12, "", false, "BG"},
        {"BayerGR16", 0x0110002E, words, 16, "", false, "GR"},
        {"BayerRG16", 0x0110002F, words, 16, "", false, "RG"},
        {"BayerGB16", 0x01100030, words, 16, "", false, "GB"},
        {"BayerBG16", 0x01100031, words, 16, "", false, "BG"},
        {"BayerBG10p", 0x010A0052, lsb, 10, "", false, "BG"},
        {"BayerBG12p", 0x010C0053, lsb, 12, "", false, "BG"},
        {"BayerGB10p", 0x010A0054, lsb, 10, "", false, "GB"},
        {"BayerGB12p", 0x010C0055, lsb, 12, "", false, "GB"},
        {"BayerGR10p", 0x010A0056, lsb, 10, "", false, "GR"},
        {"BayerGR12p", 0x010C0057, lsb, 12, "", false, "GR"},
        {"BayerRG10p", 0x010A0058, lsb, 10, "", false, "RG"},
        {"BayerRG12p", 0x010C0059, lsb, 12, "", false, "RG"},
        {"RGB8", 0x02180014, bytes, 8, "", false, "RGB"},
        {"BGR8", 0x02180015, bytes, 8, "", false, "BGR"},
        {"RGB10", 0x02300018, words, 10, "", false, "RGB"},
        {"BGR10", 0x02300019, words, 10, "", false, "BGR"},
        {"RGB12", 0x0230001A, words, 12, "", false, "RGB"},
        {"BGR12", 0x0230001B, words, 12, "", false, "BGR"},
        {"RGB16", 0x02300033, words, 16, "", false, "RGB"},
        {"BGR16", 0x0230004B, words, 16, "", false, "BGR"},
        {"Coord3D_A8", 0x010800AF, bytes, 8, "A", false},
        {"Coord3D_A16", 0x011000B6, words, 16, "A", false},
        {"Coord3D_A32f", 0x012000BD, floats, 32, "A", false},
        {"Coord3D_C8", 0x010800B1, bytes, 8, "C", false},
        {"Coord3D_C16", 0x011000B8, words, 16, "C", false},
        {"Coord3D_C32f", 0x012000BF, floats, 32, "C", false},
        {"Coord3D_AC8", 0x021000B4, bytes, 8, "AC", false},
        {"Coord3D_AC8_Planar", 0x021000B5, bytes, 8, "AC", true},
        {"Coord3D_AC16", 0x022000BB, words, 16, "AC", false},
        {"Coord3D_AC16_Planar", 0x022000BC, words, 16, "AC", true},
        {"Coord3D_AC32f", 0x024000C2, floats, 32, "AC", false},
        {"Coord3D_AC32f_Planar", 0x024000C3, floats, 32, "AC", true},
        {"Coord3D_ABC8", 0x021800B2, bytes, 8, "ABC", false},
        {"Coord3D_ABC8_Planar", 0x021800B3, bytes, 8, "ABC", true},
        {"Coord3D_ABC16", 0x023000B9, words, 16, "ABC", false},
        {"Coord3D_ABC16_Planar", 0x023000BA, words, 16, "ABC", true},
        {"Coord3D_ABC32f", 0x026000C0, floats, 32, "ABC", false},
        {"Coord3D_ABC32f_Planar", 0x026000C1, floats, 32, "ABC", true},
    };
    return formats;
}

const PixelFormat* pixel_format_by_code(std::uint32_t code) {
    const auto& all = pixel_formats();
    const auto it =
        std::find_if(all.begin(), all.end(), [code](const PixelFormat& f) { return f.code == code; });
    return it == all.end() ? nullptr : &*it;
}

const PixelFormat* pixel_format_by_name(std::string_view name) {
    const auto& all = pixel_formats();
    const auto it =
        std::find_if(all.begin(), all.end(), [name](const PixelFormat& f) { return f.name == name; });
    return it == all.end() ? nullptr : &*it;
}

std::size_t image_bytes(const PixelFormat& format, int width, int height, std::size_t row_padding) {
    if (width <= 0 || height <= 0) return 0;
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    const auto bits = static_cast<std::size_t>(format.bits_per_pixel());
    if (row_padding == 0) return (w * h * bits + 7) / 8;
    return ((w * bits + 7) / 8 + row_padding) * h;
}

Expected<StripeImage> unpack_image(const PixelFormat& format, std::span<const std::byte> payload, int width,
                                   int height, std::size_t row_padding, std::vector<std::byte>& pixels,
                                   ImageChannel channel) {
    const std::string where(format.name);
    if (format.is_range()) return device_error("holds coordinates, no grey values", where);
    if (width <= 0 || height <= 0 || width > 65536 || height > 65536) {
        return device_error(Text("an image of {} x {} pixels cannot be", width, height), where);
    }
    const std::size_t need = image_bytes(format, width, height, row_padding);
    // The last row may come without its padding.
    if (payload.size() + row_padding < need) {
        return device_error(
            Text("{} x {} pixels need {} bytes, only {} came", width, height, need, payload.size()), where);
    }
    if (!format.colour.empty())
        return unpack_colour(format, payload, width, height, row_padding, channel, pixels);
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
    const std::size_t row_out = w * (format.bit_depth > 8 ? 2 : 1);
    if (pixels.size() < row_out * h) pixels.resize(row_out * h);
    if (row_padding == 0) {
        unpack_pixels(format, payload, w * h, pixels.data());
    } else {
        const std::size_t row = (w * static_cast<std::size_t>(format.bits_per_pixel()) + 7) / 8;
        for (std::size_t y = 0; y < h; ++y)
            unpack_pixels(format, payload.subspan(y * (row + row_padding), row), w,
                          pixels.data() + y * row_out);
    }
    return StripeImage{pixels.data(), width, height, row_out, format.bit_depth};
}

std::string join_names(std::span<const std::string> names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return list;
}

}  // namespace seamwright
