#include "devices/exchange/tables/profile_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <bit>
#include <cstring>

#include "core/profile/units.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

// A contour of 60 points: 12 mm wide, a step of 2 mm.
double x_of(int i) {
    return -6 + 0.2 * i;
}
double z_of(int i) {
    return (i < 30 ? 100.0 : 98.0) + 0.01 * ((i * 7) % 5);
}
std::string number(double v, char decimal) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", v);
    std::string s = text;
    if (decimal == ',') s[s.find('.')] = ',';
    return s;
}
std::string rows(const std::string& separator, char decimal = '.', const std::string& before = "",
                 const std::string& after = "") {
    std::string text;
    for (int i = 0; i < 60; ++i)
        text += before + number(x_of(i), decimal) + separator + number(z_of(i), decimal) + after + "\n";
    return text;
}
void expect_contour(const std::string& bytes, const ProfileLayout& layout = {}, double tolerance = 1e-4) {
    const auto read = parse_profiles(bytes, "in.dat", layout);
    ASSERT_TRUE(read) << read.error().sentence() << "\n" << bytes.substr(0, 80);
    ASSERT_EQ(read->profiles.size(), 1u) << read->understood;
    const Profile& p = read->profiles[0].profile;
    ASSERT_EQ(p.size(), 60u) << read->understood;
    for (int i = 0; i < 60; ++i) {
        EXPECT_NEAR(p.x_mm[static_cast<std::size_t>(i)], x_of(i), tolerance) << read->understood;
        EXPECT_NEAR(p.z_mm[static_cast<std::size_t>(i)], z_of(i), tolerance) << read->understood;
    }
    EXPECT_FALSE(read->understood.empty());
}
void expect_no_profile(const std::string& bytes, const std::string& words, const ProfileLayout& layout = {}) {
    const auto read = parse_profiles(bytes, "in.dat", layout);
    ASSERT_FALSE(read) << read->understood << "\n" << bytes.substr(0, 80);
    EXPECT_THAT(read.error().sentence(), HasSubstr(words));
    EXPECT_EQ(read.error().sentence().find('\n'), std::string::npos);
}

TEST(ProfileLayout, TextOfManyHands) {
    expect_contour("x_mm,z_mm\n" + rows(","));
    expect_contour("X,Z\n" + rows(","));
    expect_contour("x;z\n" + rows(";"));
    expect_contour("x;z\r\n" + rows(";", ','));
    expect_contour(rows(","));
    expect_contour(rows("\t"));
    expect_contour(rows(" "));
    expect_contour(rows(" ", ','));
    expect_contour(rows("\t", ','));
    expect_contour(rows("   ", '.', "  "));
    expect_contour("\xEF\xBB\xBF\"X\";\"Z\"\n" + rows(";"));
    expect_contour("X [mm];Z [mm];\n" + rows(";", ',', "", ";"));
    expect_contour("# x z\n" + rows(" "));
    expect_contour("X [mm] Z [mm]\n" + rows(" "));
    expect_contour("X;Z\n[mm];[mm]\n" + rows(";"));
    expect_contour("Sensor: LJ-V7080\nSerial;12345\nExposure 0.5 ms\n\nPosition;Height\n" + rows(";", ','));
    expect_contour("z,x\n" + [] {
        std::string text;
        for (int i = 0; i < 60; ++i) text += number(z_of(i), '.') + "," + number(x_of(i), '.') + "\n";
        return text;
    }());
    expect_contour("Index;X;Y;Z;Intensity\n" + [] {
        std::string text;
        for (int i = 0; i < 60; ++i)
            text += std::to_string(i) + ";" + number(x_of(i), '.') + ";0;" + number(z_of(i), '.') + ";77\n";
        return text;
    }());
    expect_contour(rows(" 0.0 "));  // x y z, y holds still
    expect_contour("a,b\n" + rows(","), {"", "1,2", {}});
    expect_contour("a,b\n" + rows(","), {"", "a,b", {}});
}

TEST(ProfileLayout, UnitsOfTheHeaderAndOfThePerson) {
    std::string um = "X [\xC2\xB5m];Z [um]\n", inches = "x,z\n", mixed = "x_mm;z_um\n";
    for (int i = 0; i < 60; ++i) {
        um += number(x_of(i) * 1e3, '.') + ";" + number(z_of(i) * 1e3, '.') + "\n";
        mixed += number(x_of(i), '.') + ";" + number(z_of(i) * 1e3, '.') + "\n";
        char text[64];
        std::snprintf(text, sizeof text, "%.8f,%.8f\n", x_of(i) / 25.4, z_of(i) / 25.4);
        inches += text;
    }
    expect_contour(um);
    expect_contour(mixed);
    expect_contour(inches, {"in", "", {}});
    expect_no_profile("x,z\n1,2\n", "no unit", {"furlong", "", {}});
    expect_no_profile("x,z\n1e12,2\n1,2\n", "line 2");
}

TEST(ProfileLayout, SeveralProfilesOfOneFile) {
    std::string indexed = "Profile;X;Z\n", own = "profile,x_mm,z_mm\n", blocks, cloud;
    for (int p = 3; p < 7; ++p) {
        for (int i = 0; i < 60; ++i) {
            indexed += std::to_string(p) + ";" + number(x_of(i), '.') + ";" + number(z_of(i) + p, '.') + "\n";
            own += std::to_string(p) + "," + number(x_of(i), '.') + "," + number(z_of(i) + p, '.') + "\n";
            blocks += number(x_of(i), '.') + " " + number(z_of(i) + p, '.') + "\n";
            cloud +=
                number(x_of(i), '.') + " " + number(0.5 * p, '.') + " " + number(z_of(i) + p, '.') + "\n";
        }
        blocks += "\n# next\n";
    }
    for (const std::string& text : {indexed, own, blocks, cloud}) {
        const auto read = parse_profiles(text, "pass.txt", {});
        ASSERT_TRUE(read) << read.error().sentence();
        ASSERT_EQ(read->profiles.size(), 4u) << read->understood;
        for (std::size_t p = 0; p < 4; ++p) {
            EXPECT_EQ(read->profiles[p].profile.size(), 60u);
            EXPECT_NEAR(read->profiles[p].profile.z_mm[0], z_of(0) + 3 + static_cast<double>(p), 1e-4);
        }
    }
    EXPECT_EQ(parse_profiles(indexed, "", {})->profiles[0].number, 3);
    expect_no_profile(indexed + "3;0;0\n", "comes back");
}

std::string npy(const std::string& descr, const std::string& shape, const std::string& data,
                bool fortran = false) {
    std::string header = "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") +
                         ", 'shape': " + shape + ", }";
    while ((10 + header.size() + 1) % 64) header += ' ';
    header += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size() & 0xFF);
    bytes += static_cast<char>(header.size() >> 8);
    return bytes + header + data;
}
template <class T>
std::string raw(T value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

TEST(ProfileLayout, NumPyArrays) {
    std::string f8, f4, columns, xs, zs, three;
    for (int i = 0; i < 60; ++i) {
        f8.append(raw(x_of(i))).append(raw(z_of(i)));
        f4.append(raw(static_cast<float>(x_of(i)))).append(raw(static_cast<float>(z_of(i))));
        xs += raw(x_of(i));
        zs += raw(z_of(i));
        three.append(raw(x_of(i))).append(raw(0.0)).append(raw(z_of(i)));
    }
    expect_contour(npy("<f8", "(60, 2)", f8));
    expect_contour(npy("<f4", "(60, 2)", f4), {}, 1e-3);
    expect_contour(npy("<f8", "(2, 60)", xs + zs));
    expect_contour(npy("<f8", "(60, 2)", xs + zs, true));
    expect_contour(npy("<f8", "(60, 3)", three));
    const auto stack = parse_profiles(npy("<f8", "(2, 30, 2)", f8), "a.npy", {});
    ASSERT_TRUE(stack) << stack.error().sentence();
    EXPECT_EQ(stack->profiles.size(), 2u);
    expect_no_profile(npy("<f8", "(60, 2)", f8.substr(0, 900)), "cut short");
    expect_no_profile(npy("<f8", "(999999999999, 99999999999)", f8), "cut short");
    expect_no_profile(npy("<f8", "(60,)", xs), "1 dimension");
    expect_no_profile(npy(">f8", "(60, 2)", f8), "big-endian");
    expect_no_profile(npy("|O", "(60, 2)", f8), "no plain numbers");
    expect_no_profile(npy("<f8", "(60, 2)", f8).substr(0, 30), "cut short");
    expect_no_profile("\x93NUMPY", "cut short");
}

TEST(ProfileLayout, PlyAndPcd) {
    const std::string ply_head =
        "ply\nformat ascii 1.0\ncomment x\nelement vertex 60\nproperty float x\nproperty float y\nproperty "
        "float "
        "z\nend_header\n";
    const std::string pcd_head =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
        "60\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 60\nDATA ";
    std::string binary;
    for (int i = 0; i < 60; ++i)
        binary += raw(static_cast<float>(x_of(i))) + raw(0.0F) + raw(static_cast<float>(z_of(i)));
    std::string binary_head = ply_head;
    binary_head.replace(binary_head.find("ascii"), 5, "binary_little_endian");
    expect_contour(ply_head + rows(" 0 "));
    expect_contour(binary_head + binary, {}, 1e-3);
    expect_contour(pcd_head + "ascii\n" + rows(" 0 "));
    expect_contour(pcd_head + "binary\n" + binary, {}, 1e-3);
    expect_no_profile(ply_head + rows(" 0 ").substr(0, 300), "");
    expect_no_profile(binary_head + binary.substr(0, 100), "cut short");
    expect_no_profile(pcd_head + "binary\n" + binary.substr(0, 100), "cut short");
    expect_no_profile(pcd_head + "binary_compressed\n" + binary, "DATA ascii");
    expect_no_profile(ply_head.substr(0, ply_head.find("end_header")), "cut short");
    expect_no_profile("ply\nformat binary_big_endian 1.0\n", "line 2");
    expect_no_profile("ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
                      "more than");
    expect_no_profile("VERSION 0.7\nFIELDS x y z\nSIZE 4 4\n", "line 3");
}

TEST(ProfileLayout, WhatCannotBeKnownIsAskedAndWhatIsBrokenNamesItsLine) {
    expect_no_profile("", "empty");
    expect_no_profile("  \n\n", "empty");
    expect_no_profile("nothing here\nat all\n", "no line holds");
    expect_no_profile("x,z\n1.5,2\n3.5,abc\n", "line 3");
    expect_no_profile("x;z\n1;2\n3;4;5\n3;4\n", "line 3");
    expect_no_profile("1,5,2,5\n1,6,2,5\n1,7,2,6\n", "decimal commas");
    expect_no_profile("1.5 2.5 3.5 4.5\n1.6 2.5 3.6 4.6\n", "--columns-xz");
    expect_no_profile("time,x\n1.0,2.5\n2.0,2.5\n", "names no column z");
    expect_no_profile("a,b\n1.5,2.5\n", "names no column x");
    expect_no_profile("a,b\n1.5,2.5\n", "no column \"c\"", {"", "a,c", {}});
    expect_no_profile("a,b\n1.5,2.5\n", "two columns", {"", "a", {}});
    expect_no_profile(std::string("\xFF\xFEx\0,\0", 6), "UTF-16");
    expect_no_profile(std::string(100, '\0'), "no text");
    expect_no_profile("x;z\n1;nan\n2;\n", "no point");
    expect_no_profile("x;z\ninf;1\n", "");
}

// One suspicion, whatever the sensor; real sensors' fields are not suspected.
TEST(ProfileScale, UnitsAreSuspectedFromRangePitchAndNoise) {
    const auto contour = [](double width, int points, double unit, double noise) {
        Profile p;
        unsigned state = 12345;
        for (int i = 0; i < points; ++i) {
            state = state * 1664525U + 1013904223U;
            const double dither = noise * (static_cast<double>(state >> 8) / (1 << 24) - 0.5) * 3.46;
            const double x = (i - points / 2.0) * width / points;
            p.x_mm.push_back(x / unit);
            p.z_mm.push_back(((i < points / 2 ? 0 : 0.05 * width) + dither) / unit);
        }
        return p;
    };
    struct Sensor {
        double width;
        int points;
        double noise;
    };
    for (const Sensor& s :
         {Sensor{7.5, 3200, 0.0005}, Sensor{10, 640, 0.002}, Sensor{25, 1280, 0.005}, Sensor{60, 320, 0.05},
          Sensor{120, 2048, 0.05}, Sensor{600, 1280, 0.3}, Sensor{1500, 1000, 0.5}}) {
        EXPECT_EQ(profile_scale(contour(s.width, s.points, 1, s.noise)).suspected, "") << s.width;
        EXPECT_NE(profile_scale(contour(s.width, s.points, 1000, s.noise)).suspected, "") << s.width << " m";
        EXPECT_NE(profile_scale(contour(s.width, s.points, 1e-3, s.noise)).suspected, "") << s.width << " um";
    }
    for (const Sensor& s : {Sensor{25, 1280, 0.005}, Sensor{60, 320, 0.05}, Sensor{60, 1200, 0.05},
                            Sensor{120, 1200, 0.05}, Sensor{80, 800, 0.02}})
        EXPECT_NE(profile_scale(contour(s.width, s.points, 25.4, s.noise)).suspected, "") << s.width << " in";
}

TEST(ProfileLayout, HeightsThatStandForNoReturnAreNone) {
    ProfileLayout layout;
    layout.invalid = {12.5, -1};
    for (const char* text : {"X;Z\n0;1\n1;12.5\n2;-1\n3;2\n", "x_mm,z_mm\n0,1\n1,12.5\n2,-1\n3,2\n"}) {
        const auto read = parse_profiles(text, "scan.csv", layout);
        ASSERT_TRUE(read) << read.error().sentence();
        const auto& z = read->profiles[0].profile.z_mm;
        ASSERT_EQ(z.size(), 4u);
        EXPECT_EQ(z[0], 1);
        EXPECT_TRUE(std::isnan(z[1]) && std::isnan(z[2]));
        EXPECT_EQ(z[3], 2);
    }
    for (const char* text : {"X;Z\n0;-1\n1;12.5\n2;-1\n", "x_mm,z_mm\n0,-1\n1,12.5\n2,-1\n"})
        EXPECT_FALSE(parse_profiles(text, "scan.csv", layout));
}

// A title is copied from the sentence to --columns-xz.
TEST(ProfileLayout, TitlesOfOtherScriptsAreShownAsTheyAreAndFound) {
    const std::string text =
        "\xE6\xA8\xAA(mm),\xE5\xB9\x85(mm),\xE9\xAB\x98\xE3\x81\x95(mm)\n-1.5,7.0,3.5\n-0.5,7.0,3.6\n0.5,7.1,"
        "3.7\n";
    const std::string x = "\xE6\xA8\xAA(mm)", z = "\xE9\xAB\x98\xE3\x81\x95(mm)";
    expect_no_profile(text, x);
    expect_no_profile(text, z);
    for (const std::string& columns : {x + "," + z, std::string("\xE6\xA8\xAA,\xE9\xAB\x98\xE3\x81\x95")}) {
        const auto read = parse_profiles(text, "in.dat", {"", columns, {}});
        ASSERT_TRUE(read) << read.error().sentence();
        EXPECT_DOUBLE_EQ(read->profiles[0].profile.z_mm[1], 3.6);
    }
    expect_no_profile(text, "there is no column",
                      {"", x + ",\xE6\xB7\xB1", {}});  // a sign that is in no title
    expect_no_profile("\x89\xA1(mm),\x8D\x82(mm)\n1.5,2.5\n2.5,2.5\n3.5,2.5\n",
                      "?"
                      "?(mm)",
                      {"", "nowhere,1", {}});
}

}  // namespace
}  // namespace seamwright
