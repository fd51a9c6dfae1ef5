// Tables of other hands that were read wrongly, or could not be read: what is in the file comes out, or is asked for.
#include "devices/exchange/tables/profile_layout.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace seamwright {
namespace {

using testing::HasSubstr;

// `row` of x = -3 .. 2.9 and z, 60 of them.
template <class OneRow>
std::string rows(const OneRow& row, int count = 60) {
    std::string text;
    for (int i = 0; i < count; ++i) text += row(-3 + 0.1 * i, 60 + 0.01 * ((i * 7) % 5)) + "\n";
    return text;
}
std::string plain(int from = 0) {
    std::string text;
    for (int i = from; i < 60; ++i) text += fmt::format("{:.4f};{:.4f}\n", -3 + 0.1 * i, 60.0);
    return text;
}
void expect_read(const std::string& text, const std::string& understood = "",
                 const ProfileLayout& layout = {}, std::size_t points = 60) {
    const auto read = parse_profiles(text, "in.csv", layout);
    ASSERT_TRUE(read) << read.error().sentence() << "\n" << text.substr(0, 80);
    ASSERT_EQ(read->profiles.size(), 1u) << read->understood;
    const Profile& p = read->profiles.front().profile;
    ASSERT_EQ(p.size(), points) << text.substr(0, 80);
    EXPECT_NEAR(p.x_mm.front(), -3, 1e-6) << text.substr(0, 80);
    EXPECT_NEAR(p.x_mm.back(), 2.9, 1e-6);
    EXPECT_NEAR(p.z_mm.back(), 60, 0.05);
    EXPECT_THAT(read->understood, HasSubstr(understood));
}
void expect_asked(const std::string& text, const std::string& words, const ProfileLayout& layout = {}) {
    const auto read = parse_profiles(text, "in.csv", layout);
    ASSERT_FALSE(read) << read->understood << "\n" << text.substr(0, 80);
    EXPECT_THAT(read.error().sentence(), HasSubstr(words));
}

TEST(ForeignProfiles, RowsWithoutReturnBeforeTheFirstNumbersAreRows) {
    for (const char* none :
         {"---", "***", "#N/A", "N/A", "nan", "inf", "-inf", "1.#QNAN", "-1.#IND", "null", ""}) {
        std::string text = "Z;X\n";
        for (int i = 0; i < 10; ++i) text += fmt::format("{};{:.4f}\n", none, -3 + 0.1 * i);
        for (int i = 10; i < 60; ++i) text += fmt::format("60.0;{:.4f}\n", -3 + 0.1 * i);
        expect_read(text, "header in line 1: x = \"X\", z = \"Z\"");
    }
    const auto lost = parse_profiles("X;Z\n---;---\n" + plain(), "in.csv", {});
    ASSERT_TRUE(lost) << lost.error().sentence();
    EXPECT_EQ(lost->profiles.front().profile.size(), 61u);
    EXPECT_THAT(lost->understood, HasSubstr("header in line 1"));
    // U+2212
    expect_read("x;z\n" + rows([](double x, double z) {
                    return fmt::format("{}{:.4f};{:.4f}", x < 0 ? "\xE2\x88\x92" : "", std::abs(x), z);
                }));
    expect_asked("x;z\n-3.0;1.2.3\n-2.9;60\n" + plain(2), "line 2: \"1.2.3\" is no number");
    expect_read("Serial;12345\nX;Z\n" + plain());
}

TEST(ForeignProfiles, UnitsOfHeadersAreKnownOrAskedFor) {
    const auto scaled = [](double mm) {
        return rows([&](double x, double z) { return fmt::format("{:.9f};{:.9f}", x / mm, z / mm); });
    };
    expect_read("X [cm];Z [cm]\n" + scaled(10));
    expect_read("X [nm];Z [nm]\n" + scaled(1e-6));
    expect_read("X [mil];Z [mil]\n" + scaled(0.0254));
    expect_read("X [\xB5m];Z [\xB5m]\n" + scaled(1e-3));
    expect_read("X,Z,I\n\xC2\xB5m,\xC2\xB5m,a.u.\n" +
                rows([](double x, double z) { return fmt::format("{:.1f},{:.1f},5", x * 1e3, z * 1e3); }));
    for (const char* columns : {"", "X [px],Z [px]", "1,2"}) {
        expect_asked("X [px];Z [px]\n" + plain(), "the unit \"px\" of the column \"X [px]\" is not known",
                     {"", columns, {}});
        expect_read("X [px];Z [px]\n" + plain(), "", {"mm", columns, {}});
    }
}

TEST(ForeignProfiles, SeveralProfilesOfAFileAreToldApartOrAskedFor) {
    const auto two = [](const std::string& header, const auto& row) {
        std::string text = header;
        for (int p = 0; p < 2; ++p) text += rows([&](double x, double z) { return row(p, x, z); });
        return text;
    };
    for (const char* title : {"frame_id", "Profil-Nr.", "scan id", "Encoder", "timestamp"}) {
        const auto read = parse_profiles(
            two(fmt::format("{};X;Z\n", title),
                [](int p, double x, double z) { return fmt::format("{};{:.4f};{:.4f}", 7 + p, x, z); }),
            "in.csv", {});
        ASSERT_TRUE(read) << read.error().sentence();
        EXPECT_EQ(read->profiles.size(), 2u) << title;
    }
    const auto bare = [](int, double x, double z) { return fmt::format("{:.4f} {:.4f}", x, z); };
    expect_asked(two("", bare), "in.csv, line 61: x starts over");
    const auto downward = [](int, double x, double z) { return fmt::format("{:.4f} {:.4f}", -x, z); };
    expect_asked(two("x z\n", downward), "in.csv, line 62: x starts over");
    // Two heads side by side that overlap, and points in no order, are one profile.
    EXPECT_TRUE(parse_profiles(
        two("x z\n", [](int p, double x, double z) { return fmt::format("{:.4f} {:.4f}", x + 5 * p, z); }),
        "in.csv", {}));
}

TEST(ForeignProfiles, AColumnNamedTwiceIsAskedFor) {
    const std::string text = "X;Z;X;Z\n" + rows([](double x, double z) {
                                 return fmt::format("{0:.3f};{1:.3f};{0:.3f};{1:.3f}", x, z);
                             });
    expect_asked(text, "the header names \"X\" twice");
    expect_asked(text, "the header names \"X\" twice", {"", "X,Z", {}});
    expect_read(text, "", {"", "1,4", {}});
    expect_asked(text, "one column for x and z", {"", "2,2", {}});
}

TEST(ForeignProfiles, ThousandsThatMayBeDecimalsAreAskedFor) {
    const auto grouped = [](int v) {
        return std::abs(v) < 1000 ? std::to_string(v) : fmt::format("{}.{:03}", v / 1000, std::abs(v) % 1000);
    };
    const auto row = [&](double x, double) {
        return grouped(static_cast<int>(std::lround(x * 1000))) + ";60.012";
    };
    expect_asked("X;Z\n" + rows(row), "\"-3.000\" may have decimals or be thousands");
    // Three decimals throughout are decimals, beside codes too.
    expect_read("X;Z\n" + rows([](double x, double z) { return fmt::format("{:.3f};{:.3f}", x, z); }));
    expect_read("X;Z\n-3.000;-999\n-2.900;0\n" +
                    rows([](double x, double z) { return fmt::format("{:.3f};{:.3f}", x, z); }).substr(28),
                "", {}, 60);
}

TEST(ForeignProfiles, WordsAmongTheNumbersAndOtherSeparatorsAreRead) {
    expect_read("Time;Status;X;Z\n" +
                    rows([](double x, double z) { return fmt::format("14:22:05;OK;{:.4f};{:.4f}", x, z); }),
                "2 columns of words passed over");
    expect_read("X,Z,Time\n" + rows([](double x, double z) {
                    return fmt::format("{:.4f},{:.4f},2024-03-12T10:11:12", x, z);
                }));
    expect_read("x|z\n" + rows([](double x, double z) { return fmt::format("{:.4f}|{:.4f}", x, z); }),
                "bars");
    const auto comma = [](double x, double z) {
        std::string text = fmt::format("\"{:.4f}\"|\"{:.4f}\"", x, z);
        for (char& c : text) c = c == '.' ? ',' : c == '|' ? ',' : c;
        return text;
    };
    expect_read("X,Z\n" + rows(comma), "decimal comma");
    std::string old = "X,Z\n" + rows([](double x, double z) { return fmt::format("{:.4f},{:.4f}", x, z); });
    for (char& c : old) c = c == '\n' ? '\r' : c;
    expect_read(old);
    expect_read(rows([](double x, double z) { return fmt::format("{:.5f}D+00 {:.6f}D+01", x, z / 10); }));
    expect_read("x;z\n" + rows([](double x, double z) {
                    const int um = static_cast<int>(std::lround(std::abs(x) * 1000));
                    return fmt::format("{}{}\xC2\xA0{:03},0;{:.0f}\xC2\xA0{:03}", x < -1e-9 ? "-" : "",
                                       um / 1000, um % 1000, std::floor(z), 0);
                }),
                "", {"um", "", {}});
    expect_asked("X;Z\na1;b\n", "no line holds");
    expect_asked("X;Z\n02.Mrz;9\n", "line 2: \"02.Mrz\" is no number");
}

TEST(ForeignProfiles, LimitsAndCodesBeyondAKilometreAreNoReturn) {
    for (const char* header : {"X;Z\n", "x_mm,z_mm\n"})
        for (const char* code : {"-2147483648", "3.40282347E+38", "-1e10", "7654321"}) {
            std::string text = header + plain();
            const std::string line = "-3.0000;60.0000";
            text.replace(text.find(line), line.size(), std::string("-3.0;") + code);
            if (*header == 'x') std::replace(text.begin(), text.end(), ';', ',');
            const bool told = std::string(code) == "7654321";
            if (told) expect_asked(text, "beyond 1 km");
            const auto read = parse_profiles(
                text, "in.csv", {"", "", told ? std::vector<double>{7654321} : std::vector<double>{}});
            ASSERT_TRUE(read) << read.error().sentence();
            EXPECT_TRUE(std::isnan(read->profiles.front().profile.z_mm.front())) << code;
        }
}

TEST(ForeignProfiles, OneProfileARowIsNamed) {
    std::string line = "0.5", named = "Y\\X";
    for (int i = 0; i < 40; ++i)
        line += fmt::format(",{:.3f}", 1 + 0.01 * i), named += fmt::format(",{:.3f}", 0.1 * i);
    expect_asked(line + "\n" + line + "\n", "one profile per row is not read");
    expect_asked(named + "\n" + line + "\n" + line + "\n", "one profile per row is not read");
}

}  // namespace
}  // namespace seamwright
