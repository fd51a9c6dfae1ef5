// Codes for "no return" among heights, and heights that only look like one.

#include "core/profile/no_return.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/profile/filter.h"

namespace seamwright {
namespace {

// A sheet from -30 to `end`, then nothing: every line says `code` there.
Profile sheet(double code, double end, double height, double slope, double noise, double quantum,
              unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Profile p;
    for (int i = 0; i < 640; ++i) {
        const double x = -30 + 60. / 640 * (i + 0.5);
        double z = height + slope * x + noise * normal(random);
        if (quantum > 0) z = quantum * std::round(z / quantum);
        const bool lost = x > end || (i % 97) < 2;
        p.x_mm.push_back(x);
        p.z_mm.push_back(lost ? code : z);
    }
    return p;
}

TEST(NoReturn, TheUsualCodesAreSeenWhateverTheHeights) {
    unsigned seed = 1;
    for (const double code : {-9999., -32768., -99.999, 0., 9999.99, -32.768, 99999.})
        for (const double height : {-60., -5., 0.3, 40.})
            for (const double slope : {0., 0.02, -0.3})
                for (const double noise : {0.01, 0.1})
                    for (const double quantum : {0., 0.01}) {
                        Profile p = sheet(code, 12, height, slope, noise, quantum, seed++);
                        const auto codes = find_no_return_codes(p);
                        ASSERT_EQ(codes.size(), 1U)
                            << code << " " << height << " " << slope << " " << noise << " " << quantum;
                        EXPECT_EQ(codes[0].value, code);
                        EXPECT_GT(codes[0].points, 190);
                        Profile filtered = p;
                        ASSERT_TRUE(filter_profile(filtered, {}));
                        for (std::size_t k = 0; k < p.size(); ++k)
                            ASSERT_EQ(std::isnan(filtered.z_mm[k]), p.z_mm[k] == code) << k;
                        EXPECT_FALSE(no_return_sentence(codes).empty());
                        EXPECT_EQ(erase_no_returns(p, {code}), codes[0].points);
                        EXPECT_TRUE(find_no_return_codes(p).empty());
                    }
}

// Each lost line alone between two that are seen; beside spikes, which are none.
TEST(NoReturn, LinesThatAreLostOneByOne) {
    for (const double code : {-9999., -32768., -99.999, 9999.99, 99999.})
        for (const double noise : {0.01, 0.1}) {
            Profile p = sheet(std::nan(""), 12, 5, 0.02, noise, 0, 3);
            for (std::size_t k = 5; k < p.size(); k += 33) p.z_mm[k] = code;
            for (std::size_t k = 10; k < p.size(); k += 20) p.z_mm[k] = 60 + 3.1 * double(k);
            const auto codes = find_no_return_codes(p);
            ASSERT_EQ(codes.size(), 1U) << code;
            EXPECT_EQ(codes[0].value, code);
        }
}

TEST(NoReturn, HeightsAreNoCodes) {
    const double none = std::nan("");
    for (unsigned seed = 1; seed < 200; ++seed) {
        // Noise, coarse steps of the sensor, a sheet at zero, a deep step: nothing stands for a lost line.
        const double quantum = seed % 3 == 0 ? 0.05 : seed % 3 == 1 ? 0.01 : 0;
        Profile p = sheet(none, 12, seed % 2 ? 0 : 20, seed % 5 ? 0.01 : 0, 0.02, quantum, seed);
        if (seed % 4 == 0)
            for (std::size_t k = 300; k < p.size(); ++k) p.z_mm[k] -= 120;
        EXPECT_TRUE(find_no_return_codes(p).empty()) << seed;
    }
    Profile drawn;  // two flats without noise, one of them at zero
    for (int i = 0; i < 400; ++i) drawn.x_mm.push_back(0.1 * i), drawn.z_mm.push_back(i < 200 ? 0 : 5);
    EXPECT_TRUE(find_no_return_codes(drawn).empty());
}

TEST(ListsEveryLine, ByItsEmptyLinesOrByAFieldThatLiesEvenly) {
    const auto grid = [](int lines, double from) {
        Profile p;
        for (int i = 0; i < lines; ++i) {
            p.x_mm.push_back(from + 0.1 * i);
            p.z_mm.push_back(0);
        }
        return p;
    };
    const double none = std::nan("");
    EXPECT_FALSE(lists_every_line({}, 0.1, 0.01));
    EXPECT_TRUE(lists_every_line(grid(301, -15), 0.1, 0.01));
    EXPECT_TRUE(lists_every_line(grid(301, -14.93), 0.1, 0.01)) << "within one and a half pitches";
    EXPECT_FALSE(lists_every_line(grid(301, -14.8), 0.1, 0.01));
    EXPECT_FALSE(lists_every_line(grid(101, -5), 0.1, 0.01)) << "a short one does by chance";
    EXPECT_TRUE(lists_every_line(grid(101, -5), 0.1, 0.01, 64));
    Profile p = grid(301, -10);
    p.z_mm[100] = p.z_mm[101] = none;
    EXPECT_FALSE(lists_every_line(p, 0.1, 0.01)) << "two holes may be anything";
    p.z_mm[200] = none;
    EXPECT_TRUE(lists_every_line(p, 0.1, 0.01));
    Profile rim = grid(301, -10);
    rim.x_mm.back() = rim.z_mm.back() = none;
    EXPECT_TRUE(lists_every_line(rim, 0.1, 0.01));
}

}  // namespace
}  // namespace seamwright
