#include "devices/exchange/tables/profile_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "devices/exchange/files.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using ::testing::HasSubstr;

std::string profile_error(std::string_view text) {
    const auto profile = parse_profile_csv(text, "in.csv");
    return profile ? "accepted" : profile.error().sentence();
}

TEST(ProfileCsv, ReadsThePlainForm) {
    const auto p = parse_profile_csv("x_mm,z_mm\n-1.5,2e1\n0,\n,\n2,NaN\nnan,3\n1,0.25\n", "in.csv");
    ASSERT_TRUE(p) << p.error().sentence();
    ASSERT_EQ(p->size(), 6U);
    EXPECT_EQ(p->x_mm[0], -1.5);
    EXPECT_EQ(p->z_mm[0], 20);
    for (int i : {1, 2, 3, 4}) EXPECT_TRUE(std::isnan(p->z_mm[static_cast<std::size_t>(i)])) << i;
    EXPECT_EQ(p->x_mm[1], 0);
    EXPECT_EQ(p->z_mm[5], 0.25);
    EXPECT_TRUE(p->intensity.empty());
    EXPECT_FALSE(p->filtered());
}

TEST(ProfileCsv, ReadsWhatOtherProgramsWrite) {
    const auto p = parse_profile_csv(
        "\xEF\xBB\xBFindex, \"x_mm\" ,intensity,z_mm\r\n7, +1.25 ,200,\" 3 \"\r\n8,2,,4\r\n\r\n", "in.csv");
    ASSERT_TRUE(p) << p.error().sentence();
    ASSERT_EQ(p->size(), 2U);
    EXPECT_EQ(p->x_mm[0], 1.25);
    EXPECT_EQ(p->z_mm[0], 3);
    EXPECT_EQ(p->intensity[0], 200);
    EXPECT_EQ(p->intensity[1], 0);
    EXPECT_EQ(p->z_mm[1], 4);
}

TEST(ProfileCsv, FilteredProfilesComeBackExactly) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> u(-100, 100);
    Profile p;
    for (int i = 0; i < 500; ++i) {
        const bool hole = i % 7 == 0;
        p.x_mm.push_back(u(rng));
        p.z_mm.push_back(hole ? std::numeric_limits<double>::quiet_NaN()
                              : u(rng) * std::pow(10, u(rng) / 50));
        p.intensity.push_back(static_cast<float>(u(rng)));
        p.segment.push_back(hole ? kOutlier : i / 100);
    }
    const auto back = parse_profile_csv(profile_csv(p), "again");
    ASSERT_TRUE(back) << back.error().sentence();
    EXPECT_EQ(back->x_mm, p.x_mm);
    EXPECT_EQ(back->intensity, p.intensity);
    EXPECT_EQ(back->segment, p.segment);
    for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_TRUE(back->z_mm[i] == p.z_mm[i] || (std::isnan(back->z_mm[i]) && std::isnan(p.z_mm[i])));
    }
    EXPECT_THAT(profile_csv(p), HasSubstr("x_mm,z_mm,intensity,valid,segment\n"));
    const auto only_valid = parse_profile_csv("x_mm,z_mm,valid\n0,0,1\n1,0,0\n", "v");
    ASSERT_TRUE(only_valid);
    EXPECT_EQ(only_valid->segment, (std::vector<std::int32_t>{0, kOutlier}));
}

TEST(ProfileCsv, RefusesWithASentenceThatNamesTheLine) {
    EXPECT_THAT(profile_error(""), HasSubstr("empty"));
    EXPECT_THAT(profile_error("\n\n"), HasSubstr("empty"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n"), HasSubstr("no points"));
    EXPECT_THAT(profile_error("1,2\n3,4\n"), HasSubstr("no column x_mm"));
    EXPECT_THAT(profile_error("x_mm,y_mm\n1,2\n"), HasSubstr("no column z_mm"));
    EXPECT_THAT(profile_error("x_mm,z_mm,x_mm\n1,2,3\n"), HasSubstr("named twice"));
    EXPECT_THAT(profile_error("x_mm;z_mm\n1,5;2,5\n"), HasSubstr("semicolons"));
    EXPECT_THAT(profile_error("x_mm\tz_mm\n1\t2\n"), HasSubstr("tabs"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n1,5;2,5\n"), HasSubstr("line 2"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n1;5\n"), HasSubstr("decimal points"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n1,5,2,5\n"), HasSubstr("decimal commas"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,0\n1\n"), HasSubstr("line 3"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,0\n\n1,1\n"), HasSubstr("blank"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,inf\n"), HasSubstr("infinite"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,1e999\n"), HasSubstr("does not fit"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,1e7\n"), HasSubstr("beyond 1 km"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,0x10\n"), HasSubstr("no number"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,1 2\n"), HasSubstr("no number"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,--1\n"), HasSubstr("no number"));
    EXPECT_THAT(profile_error("x_mm,z_mm\n0,+\n"), HasSubstr("no number"));
    EXPECT_THAT(profile_error(std::string_view("x_mm,z_mm\n0,1\0\n", 15)), HasSubstr("no number"));
    EXPECT_THAT(profile_error("\xFF\xFEx\0_\0"), HasSubstr("UTF-16"));
    EXPECT_THAT(profile_error("x_mm,z_mm,valid\n0,0,2\n"), HasSubstr("0 or 1"));
    EXPECT_THAT(profile_error("x_mm,z_mm,segment\n0,0,1.5\n"), HasSubstr("whole number"));
    EXPECT_THAT(profile_error("x_mm,z_mm,segment\n0,,1\n"), HasSubstr("without return"));
    EXPECT_THAT(profile_error("x_mm,z_mm,valid,segment\n0,0,0,3\n"), HasSubstr("contradicts"));
    EXPECT_THAT(profile_error(std::string(3 << 20, ',')), HasSubstr("no column x_mm"));
}

TEST(ProfileCsv, NoPrefixOfAValidTextIsRead) {
    // Truncation must never turn into silently other numbers except at the end of a line's last field.
    const std::string text = "x_mm,z_mm,intensity\n-12.5,3.25,200\n13.5,-4.75,100\n";
    const auto whole = parse_profile_csv(text, "t");
    ASSERT_TRUE(whole);
    for (std::size_t n = 0; n < text.size(); ++n) {
        const auto part = parse_profile_csv(std::string_view(text).substr(0, n), "t");
        if (!part) continue;
        for (std::size_t i = 0; i < part->size(); ++i) {
            EXPECT_EQ(part->x_mm[i], whole->x_mm[i]) << n;
            EXPECT_EQ(part->z_mm[i], whole->z_mm[i]) << n;
        }
    }
}

TEST(ProfileCsv, RandomBytesNeitherCrashNorPass) {
    std::mt19937 rng(5);
    const std::string alphabet =
        "x_mm,z_mm\n\r0123456789.-+e;\t\"\0\xFF"
        "nainf";
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text = trial % 2 ? "x_mm,z_mm\n" : "";
        const std::size_t length = rng() % 80;
        for (std::size_t i = 0; i < length; ++i) text += alphabet[rng() % alphabet.size()];
        const auto p = parse_profile_csv(text, "random");
        if (!p) {
            EXPECT_FALSE(p.error().what.empty());
            continue;
        }
        ASSERT_EQ(p->x_mm.size(), p->z_mm.size());
        for (double z : p->z_mm) EXPECT_FALSE(std::isinf(z));
    }
}

TEST(AlignCsv, RoundTripAndOrder) {
    std::vector<TravelProfile> pass;
    for (int k = 0; k < 5; ++k) {
        TravelProfile t;
        t.travel_mm = 2.5 * k - 5;
        for (int i = 0; i < 4; ++i) {
            t.profile.x_mm.push_back(i);
            t.profile.z_mm.push_back(i == 2 ? std::nan("") : k + 0.1 * i);
        }
        pass.push_back(t);
    }
    pass.push_back({10, {}});  // nothing was seen there
    const auto back = parse_align_csv(align_csv(pass), "pass.csv");
    ASSERT_TRUE(back) << back.error().sentence();
    ASSERT_EQ(back->size(), pass.size());
    EXPECT_EQ(back->back().travel_mm, 10);
    for (std::size_t k = 0; k + 1 < pass.size(); ++k) {
        EXPECT_EQ((*back)[k].travel_mm, pass[k].travel_mm);
        EXPECT_EQ((*back)[k].profile.x_mm, pass[k].profile.x_mm);
        EXPECT_EQ((*back)[k].profile.z_mm[3], pass[k].profile.z_mm[3]);
        EXPECT_TRUE(std::isnan((*back)[k].profile.z_mm[2]));
    }
}

TEST(AlignCsv, RefusesContradictions) {
    const auto error = [](std::string_view rows) {
        const auto p = parse_align_csv("travel_mm,profile_index,x_mm,z_mm\n" + std::string(rows), "a.csv");
        return p ? "accepted" : p.error().sentence();
    };
    EXPECT_THAT(error(""), HasSubstr("no profiles"));
    EXPECT_THAT(error("0,0,1,1\n1,1,1,1\n0,0,2,2\n"), HasSubstr("comes back"));
    EXPECT_THAT(error("0,0,1,1\n1,0,1,1\n"), HasSubstr("changes within"));
    EXPECT_THAT(error(",0,1,1\n"), HasSubstr("missing"));
    EXPECT_THAT(error("0,-1,1,1\n"), HasSubstr("whole number"));
    EXPECT_THAT(error("0,0.5,1,1\n"), HasSubstr("whole number"));
    EXPECT_THAT(error("0,,1,1\n"), HasSubstr("whole number"));
}

TEST(Files, LimitFolderMissingAndAtomicWrite) {
    const TemporaryFolder folder;
    EXPECT_EQ(read_text_file(folder.path()).error().kind, ErrorKind::file);
    EXPECT_EQ(read_text_file(folder.path() / "none").error().kind, ErrorKind::file);
    const auto file = folder.write("a.txt", std::string(1000, 'a'));
    EXPECT_TRUE(read_text_file(file, 1000));
    EXPECT_THAT(read_text_file(file, 999).error().what, HasSubstr("longer"));
    ASSERT_TRUE(write_text_file(file, "new"));
    EXPECT_EQ(*read_text_file(file), "new");
    EXPECT_FALSE(write_text_file(folder.path() / "missing" / "a.txt", "x"));
    EXPECT_FALSE(write_text_file(folder.path(), "x"));
    EXPECT_FALSE(write_text_file("/dev/full/x", "x"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
        << "temporary files left";
    EXPECT_EQ(read_text_file("/dev/zero", 100000).error().kind, ErrorKind::file) << "endless device";
}

}  // namespace
}  // namespace seamwright
