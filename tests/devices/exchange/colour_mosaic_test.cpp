// Raw pictures of colour cameras told from grey ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "devices/exchange/image_file.h"

namespace seamwright {
namespace {

struct Drawn {
    std::vector<std::byte> pixels;
    StripeImage image;
};

struct Scene {
    double degrees = 0, width_px = 2, ambient = 0, noise = 3;
    double red = 1, green = 0.12, blue = 0.05;  // of the laser, by what the filters let through
};

// A stripe of that direction, as a sensor behind a filter sees it whose first pixel is of that row and column of R G / G B; grey:
// with no filter.
Drawn draw(const Scene& scene, bool grey, int first_row = 0, int first_column = 0, int bits = 8) {
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, scene.noise);
    Drawn d;
    const int rows = 121, columns = 161;  // odd: the last ones have no partner
    d.image.width = columns, d.image.height = rows, d.image.bit_depth = bits;
    const auto bytes = static_cast<std::size_t>(d.image.bytes_per_pixel());
    d.image.row_bytes = columns * bytes;
    d.pixels.resize(rows * d.image.row_bytes);
    d.image.pixels = d.pixels.data();
    const double direction = scene.degrees * std::numbers::pi / 180, scale = bits > 8 ? 16 : 1;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double beside = (c - 80.3) * std::sin(direction) - (r - 60.2) * std::cos(direction);
            const double laser = 220 * std::exp(-0.5 * beside * beside / (scene.width_px * scene.width_px));
            const bool lower = (r + first_row) % 2, right = (c + first_column) % 2;
            double value = laser + scene.ambient;
            if (!grey && !lower && !right) value = scene.red * laser + 0.6 * scene.ambient;
            if (!grey && lower != right) value = scene.green * laser + scene.ambient;
            if (!grey && lower && right) value = scene.blue * laser + 0.7 * scene.ambient;
            const auto word = static_cast<int>(std::clamp(value + noise(random), 0.0, 255.0) * scale);
            const auto at =
                static_cast<std::size_t>(r) * d.image.row_bytes + static_cast<std::size_t>(c) * bytes;
            d.pixels[at] = static_cast<std::byte>(word & 255);
            if (bits > 8) d.pixels[at + 1] = static_cast<std::byte>(word >> 8);
        }
    return d;
}

TEST(ColourMosaic, ALasersStripeBehindColourFiltersIsOneAndWithoutThemNone) {
    for (const double degrees : {0.0, 3.0, 10.0, 30.0, 44.0, 45.0, 60.0, 90.0, 120.0, 135.0})
        for (const double width_px : {1.2, 4.0})
            for (const double ambient : {0.0, 5.0, 30.0})
                for (const int bits : {8, 12}) {
                    Scene scene{degrees, width_px, ambient};
                    EXPECT_FALSE(is_colour_mosaic(draw(scene, true, 0, 0, bits).image))
                        << degrees << " " << width_px << " " << ambient;
                    for (const int first : {0, 1, 2, 3})
                        EXPECT_TRUE(is_colour_mosaic(draw(scene, false, first / 2, first % 2, bits).image))
                            << degrees << " " << width_px << " " << ambient << " " << first;
                    scene.red = 0.03, scene.green = 0.3, scene.blue = 1;
                    EXPECT_TRUE(is_colour_mosaic(draw(scene, false, 0, 0, bits).image)) << "blue laser";
                }
}

TEST(ColourMosaic, NoiseAndPicturesWithoutAnythingAreNone) {
    EXPECT_FALSE(is_colour_mosaic({}));
    Scene dark{0, 2, 30, 12};
    dark.red = dark.green = dark.blue = 0;
    Drawn flat = draw(dark, true);
    EXPECT_FALSE(is_colour_mosaic(flat.image));
    std::fill(flat.pixels.begin(), flat.pixels.end(), std::byte{80});
    EXPECT_FALSE(is_colour_mosaic(flat.image));
    flat.image.height = 1;
    EXPECT_FALSE(is_colour_mosaic(flat.image));
}

// Stripes and boards of real cameras, in grey (../shared/data).
TEST(ColourMosaic, RealPicturesInGreyAreNone) {
    int seen = 0;
    std::error_code missing;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SEAMWRIGHT_DATA_FOLDER, missing)) {
        if (entry.path().extension() != ".png") continue;
        Frame frame;
        ASSERT_TRUE(read_image_file(entry.path(), frame)) << entry.path();
        EXPECT_FALSE(is_colour_mosaic(frame.image)) << entry.path();
        ++seen;
    }
    if (seen == 0) GTEST_SKIP() << "no pictures in " << SEAMWRIGHT_DATA_FOLDER;
}

TEST(ColourMosaic, TheChoiceOfTheChannelNamesIt) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "mosaic_choice.png";
    const Drawn raw = draw({10, 2, 20}, false), grey = draw({10, 2, 20}, true);
    ASSERT_TRUE(write_image_file(file, raw.image));
    auto choice = choose_channel(file);
    ASSERT_TRUE(choice);
    EXPECT_TRUE(choice->mosaic);
    EXPECT_FALSE(choice->colour);
    ASSERT_TRUE(write_image_file(file, grey.image));
    choice = choose_channel(file);
    ASSERT_TRUE(choice);
    EXPECT_FALSE(choice->mosaic);
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace seamwright
