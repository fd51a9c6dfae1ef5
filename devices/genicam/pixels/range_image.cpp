#include "devices/genicam/pixels/range_image.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace seamwright {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class Raw>
double load(const std::byte* at) {
    Raw raw;
    std::memcpy(&raw, at, sizeof raw);
    return static_cast<double>(raw);
}

// `x` and `z`: the row's first raw value of each (x null: from the column); `step` bytes between two points.
template <class Raw>
void read_row(const std::byte* x, const std::byte* z, std::size_t step, std::size_t width,
              const RangeMapping& m, Profile& profile) {
    const double invalid = m.invalid.value_or(kNone);  // NaN equals nothing
    for (std::size_t i = 0; i < width; ++i) {
        const double raw_x = x ? load<Raw>(x + i * step) : static_cast<double>(i) + m.first_column;
        const double raw_z = load<Raw>(z + i * step);
        profile.x_mm[i] = raw_x * m.x.scale_mm + m.x.offset_mm;
        profile.z_mm[i] = raw_z == invalid || !std::isfinite(raw_z) || !std::isfinite(raw_x)
                              ? kNone
                              : raw_z * m.z.scale_mm + m.z.offset_mm;
    }
}

}  // namespace

Expected<void> range_row(const PixelFormat& format, std::span<const std::byte> payload, int width, int height,
                         int row, std::size_t row_padding, const RangeMapping& mapping, Profile& profile) {
    const std::string where(format.name);
    if (!format.colour.empty()) return device_error("holds colour, no coordinates", where);
    if (format.packing == Packing::lsb || format.packing == Packing::gige)
        return device_error("packed values are not read as a range image", where,
                            "set a pixel format of 8, 16 or 32 bit");
    if (width <= 0 || height <= 0 || width > 65536 || height > 65536 || row < 0 || row >= height)
        return device_error(Text("there is no row {} in {} x {} points", row, width, height), where);
    const std::size_t unit = format.packing == Packing::bytes ? 1 : format.packing == Packing::words ? 2 : 4;
    const std::size_t axes = format.is_range() ? format.coordinates.size() : 1;
    const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height),
               r = static_cast<std::size_t>(row);
    const std::size_t step = format.planar ? unit : unit * axes;
    const std::size_t row_bytes = w * step + row_padding, plane = row_bytes * h;
    const std::size_t need = (format.planar ? plane * axes : plane) - row_padding;
    if (payload.size() < need) {
        return device_error(
            Text("{} x {} points need {} bytes, only {} came", width, height, need, payload.size()), where);
    }
    const auto at = [&](std::size_t axis) {
        return payload.data() + r * row_bytes + (format.planar ? axis * plane : axis * unit);
    };
    const std::byte* x = axes > 1 ? at(0) : nullptr;  // A comes first wherever there are several
    const std::byte* z = at(axes - 1);
    profile.intensity.clear();
    profile.segment.clear();
    profile.x_mm.resize(w);
    profile.z_mm.resize(w);
    if (format.packing == Packing::bytes)
        read_row<std::uint8_t>(x, z, step, w, mapping, profile);
    else if (format.packing == Packing::words)
        read_row<std::uint16_t>(x, z, step, w, mapping, profile);
    else
        read_row<float>(x, z, step, w, mapping, profile);
    return {};
}

}  // namespace seamwright
