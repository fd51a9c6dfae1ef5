// Packings against bytes worked out by hand, and against an oracle that reads bit by bit.
#include "devices/genicam/pixels/pixel_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "devices/genicam/pixels/range_image.h"

namespace seamwright {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
    std::vector<std::byte> b;
    for (int v : values) b.push_back(static_cast<std::byte>(v));
    return b;
}

std::vector<int> unpacked(const char* name, const std::vector<std::byte>& packed, std::size_t count) {
    const PixelFormat* format = pixel_format_by_name(name);
    const std::size_t unit = format->bit_depth > 8 ? 2 : 1;
    std::vector<std::byte> out(count * unit + 16, std::byte{0xEE});
    unpack_pixels(*format, packed, count, out.data());
    for (std::size_t i = count * unit; i < out.size(); ++i) EXPECT_EQ(out[i], std::byte{0xEE}) << name;
    std::vector<int> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = std::to_integer<int>(out[i * unit]);
        if (unit == 2) values[i] |= std::to_integer<int>(out[2 * i + 1]) << 8;
    }
    return values;
}

TEST(PixelFormat, KnownBytes) {
    // 0x3FF, 0, 0x2AA, 0x155: worked out from PFNC's figure of Mono10p.
    EXPECT_EQ(unpacked("Mono10p", bytes({0xFF, 0x03, 0xA0, 0x6A, 0x55}), 4),
              (std::vector{0x3FF, 0, 0x2AA, 0x155}));
    EXPECT_EQ(unpacked("Mono12p", bytes({0xBC, 0xFA, 0xDE}), 2), (std::vector{0xABC, 0xDEF}));
    EXPECT_EQ(unpacked("Mono12Packed", bytes({0xAB, 0xFC, 0xDE}), 2), (std::vector{0xABC, 0xDEF}));
    EXPECT_EQ(unpacked("Mono10Packed", bytes({0xAA, 0x32, 0xC0}), 2), (std::vector{0x2AA, 0x303}));
    EXPECT_EQ(unpacked("Mono12Packed", bytes({0xAB, 0x0C}), 1), (std::vector{0xABC}));
    EXPECT_EQ(unpacked("Mono12", bytes({0xBC, 0x0A, 0xEF, 0x0D}), 2), (std::vector{0xABC, 0xDEF}));
    EXPECT_EQ(unpacked("Mono8", bytes({1, 255}), 2), (std::vector{1, 255}));
}

// Bit `k` of pixel `i`, where the standards put it.
int oracle_bit(const PixelFormat& f, const std::vector<std::byte>& packed, std::size_t i, int k) {
    std::size_t bit = 0;
    if (f.packing == Packing::lsb) {
        bit = i * static_cast<std::size_t>(f.bit_depth) + static_cast<std::size_t>(k);
    } else {
        const int low = f.bit_depth - 8;
        const std::size_t group = i / 2 * 24;
        const bool odd = i % 2 == 1;
        if (k >= low)
            bit = group + (odd ? 16 : 0) + static_cast<std::size_t>(k - low);
        else
            bit = group + 8 + (odd ? 4 : 0) + static_cast<std::size_t>(k);
    }
    return std::to_integer<int>(packed[bit / 8] >> (bit % 8)) & 1;
}

TEST(PixelFormat, OracleForEveryCount) {
    std::mt19937 random(7);
    for (const char* name : {"Mono10p", "Mono12p", "Mono10Packed", "Mono12Packed"}) {
        const PixelFormat& f = *pixel_format_by_name(name);
        for (std::size_t count = 1; count < 90; ++count) {
            std::vector<std::byte> packed((count * static_cast<std::size_t>(f.bits_per_pixel()) + 7) / 8);
            for (auto& b : packed) b = static_cast<std::byte>(random());
            const auto values = unpacked(name, packed, count);
            std::vector<std::byte> words(2 * count);
            for (std::size_t i = 0; i < count; ++i) {
                int expected = 0;
                for (int k = 0; k < f.bit_depth; ++k) expected |= oracle_bit(f, packed, i, k) << k;
                ASSERT_EQ(values[i], expected) << name << " pixel " << i << " of " << count;
                const auto word = static_cast<std::uint16_t>(values[i]);
                std::memcpy(words.data() + 2 * i, &word, 2);
            }
            std::vector<std::byte> again(packed.size());
            pack_pixels(f, words.data(), count, again.data());
            EXPECT_EQ(unpacked(name, again, count), values);
        }
    }
}

TEST(PixelFormat, ImagesWithPaddingAndTooFewBytes) {
    const PixelFormat& f = *pixel_format_by_name("Mono12p");
    std::vector<std::byte> pixels;
    // Three pixels a row: 36 bits, so 5 bytes, and one of padding.
    const auto payload = bytes({0x01, 0x20, 0x00, 0x03, 0x00, 0xEE, 0x04, 0x50, 0x00, 0x06, 0x00, 0xEE});
    const auto image = unpack_image(f, payload, 3, 2, 1, pixels);
    ASSERT_TRUE(image) << image.error().sentence();
    EXPECT_EQ(image->bit_depth, 12);
    EXPECT_EQ(image->row_bytes, 6U);
    EXPECT_EQ(std::to_integer<int>(pixels[0]), 1);
    EXPECT_EQ(std::to_integer<int>(pixels[2]), 2);
    EXPECT_EQ(std::to_integer<int>(pixels[4]), 3);
    EXPECT_EQ(std::to_integer<int>(pixels[6]), 4);
    EXPECT_EQ(std::to_integer<int>(pixels[10]), 6);
    EXPECT_FALSE(unpack_image(f, std::span(payload).first(7), 3, 2, 0, pixels));
    EXPECT_FALSE(unpack_image(f, payload, 0, 2, 0, pixels));
    EXPECT_FALSE(unpack_image(f, payload, 70000, 2, 0, pixels));
    EXPECT_FALSE(unpack_image(*pixel_format_by_name("Coord3D_C16"), payload, 2, 2, 0, pixels));
    EXPECT_EQ(pixel_format_by_name("YUV422_8"), nullptr);
    EXPECT_EQ(pixel_format_by_code(0x02100032), nullptr);
}

// A red line in white light: in the red difference it stands alone and in its place, in every colour format.
TEST(PixelFormat, ColourCamerasShowTheLaserInTheRedDifference) {
    constexpr int kWidth = 32, kHeight = 24;
    const auto red = [](int y) { return 90 * std::exp(-0.5 * std::pow((y - 11.3) / 2.0, 2)); };
    for (const char* name :
         {"RGB8", "BGR8", "RGB12", "BGR16", "BayerRG8", "BayerGR8", "BayerGB8", "BayerBG8", "BayerRG10",
          "BayerBG12", "BayerGR16", "BayerRG10p", "BayerGB12p", "BayerBG10Packed", "BayerGR12Packed"}) {
        SCOPED_TRACE(name);
        const PixelFormat* format = pixel_format_by_name(name);
        ASSERT_NE(format, nullptr);
        const std::string pattern =
            std::string(name).starts_with("Bayer") ? std::string(name).substr(5, 2) : "";
        const double white = 80;
        std::vector<std::byte> payload;
        const auto put = [&](double value) {
            const int v = static_cast<int>(value);
            payload.push_back(static_cast<std::byte>(v & 0xFF));
            if (format->bit_depth > 8) payload.push_back(static_cast<std::byte>(v >> 8));
        };
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                if (pattern.empty()) {
                    for (const char c : std::string(name).substr(0, 3)) put(white + (c == 'R' ? red(y) : 0));
                    continue;
                }
                // The mosaic's two rows, written out: the second row of RG is GB, of GR BG, of GB RG, of BG
                // GR.
                const std::string below = pattern == "RG"   ? "GB"
                                          : pattern == "GR" ? "BG"
                                          : pattern == "GB" ? "RG"
                                                            : "GR";
                const char c = (y % 2 ? below : pattern)[static_cast<std::size_t>(x % 2)];
                put(white + (c == 'R' ? red(y) : 0));
            }
        if (format->packing == Packing::lsb || format->packing == Packing::gige) {
            std::vector<std::byte> packed(image_bytes(*format, kWidth, kHeight));
            pack_pixels(*format, payload.data(), kWidth * kHeight, packed.data());
            payload = packed;
        }
        std::vector<std::byte> pixels;
        const auto image =
            unpack_image(*format, payload, kWidth, kHeight, 0, pixels, ImageChannel::red_difference);
        ASSERT_TRUE(image) << image.error().sentence();
        EXPECT_EQ(image->bit_depth, format->bit_depth);
        for (const int x : {8, 9, 15}) {
            double sum = 0, moment = 0;
            for (int y = 2; y < kHeight - 2; ++y) {
                const std::size_t at = static_cast<std::size_t>(y) * image->row_bytes +
                                       static_cast<std::size_t>(x * image->bytes_per_pixel());
                const double v =
                    std::to_integer<int>(pixels[at]) +
                    (image->bytes_per_pixel() == 2 ? std::to_integer<int>(pixels[at + 1]) << 8 : 0);
                sum += v, moment += v * y;
            }
            EXPECT_GT(sum, 300);
            EXPECT_NEAR(moment / sum, 11.3, 0.1) << x;
        }
        EXPECT_FALSE(unpack_image(*format, std::span(payload).first(100), kWidth, kHeight, 0, pixels));
    }
}

template <class T>
std::vector<std::byte> raw(std::initializer_list<T> values) {
    std::vector<std::byte> b(values.size() * sizeof(T));
    std::memcpy(b.data(), std::data(values), b.size());
    return b;
}

TEST(RangeImage, EveryLayout) {
    RangeMapping m;
    m.x = {0.5, 10};
    m.z = {0.01, -5};
    m.invalid = 0;
    Profile p;
    // Two points, second row: x raw 3, 4 -> 11.5, 12; z raw 700, 0 -> 2, none.
    const auto check = [&](const char* name, const std::vector<std::byte>& payload, bool own_x) {
        const auto done = range_row(*pixel_format_by_name(name), payload, 2, 2, 1, 0, m, p);
        ASSERT_TRUE(done) << done.error().sentence();
        ASSERT_EQ(p.size(), 2U) << name;
        EXPECT_DOUBLE_EQ(p.x_mm[0], own_x ? 11.5 : 10) << name;
        EXPECT_DOUBLE_EQ(p.x_mm[1], own_x ? 12 : 10.5) << name;
        EXPECT_NEAR(p.z_mm[0], 2, 1e-12) << name;
        EXPECT_TRUE(std::isnan(p.z_mm[1])) << name;
        EXPECT_FALSE(range_row(*pixel_format_by_name(name), std::span(payload).first(payload.size() - 1), 2,
                               2, 1, 0, m, p))
            << name;
    };
    using U = std::uint16_t;
    check("Coord3D_C16", raw<U>({1, 1, 700, 0}), false);
    check("Mono16", raw<U>({1, 1, 700, 0}), false);
    check("Coord3D_A16", raw<U>({1, 1, 700, 0}), false);
    check("Coord3D_C32f", raw<float>({1, 1, 700, 0}), false);
    check("Coord3D_AC16", raw<U>({1, 1, 1, 1, 3, 700, 4, 0}), true);
    check("Coord3D_AC16_Planar", raw<U>({1, 1, 3, 4, 1, 1, 700, 0}), true);
    check("Coord3D_AC32f", raw<float>({1, 1, 1, 1, 3, 700, 4, 0}), true);
    check("Coord3D_ABC16", raw<U>({1, 9, 1, 1, 9, 1, 3, 9, 700, 4, 9, 0}), true);
    check("Coord3D_ABC32f_Planar", raw<float>({1, 1, 3, 4, 9, 9, 9, 9, 1, 1, 700, 0}), true);
    m.z = {2, -48};
    check("Coord3D_C8", bytes({1, 1, 25, 0}), false);
    check("Coord3D_AC8_Planar", bytes({1, 1, 3, 4, 1, 1, 25, 0}), true);
    const auto nan = raw<float>({NAN, INFINITY});
    ASSERT_TRUE(range_row(*pixel_format_by_name("Coord3D_C32f"), nan, 2, 1, 0, 0, m, p));
    EXPECT_TRUE(std::isnan(p.z_mm[0]) && std::isnan(p.z_mm[1]));
    m.first_column = 100;
    ASSERT_TRUE(range_row(*pixel_format_by_name("Coord3D_C8"), bytes({9, 9}), 2, 1, 0, 0, m, p));
    EXPECT_DOUBLE_EQ(p.x_mm[0], 60);
    EXPECT_FALSE(range_row(*pixel_format_by_name("Mono12p"), bytes({9, 9, 9}), 2, 1, 0, 0, m, p));
    EXPECT_FALSE(range_row(*pixel_format_by_name("Coord3D_C8"), bytes({9, 9}), 2, 1, 1, 0, m, p));
}

}  // namespace
}  // namespace seamwright
