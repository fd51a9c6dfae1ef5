// Bytes written by hand from the tables of the vendor's manual.

#include "devices/gocator/gdp_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace seamwright::gdp {
namespace {

using testing::HasSubstr;

std::string bytes(std::initializer_list<int> list) {
    std::string out;
    for (const int b : list) out.push_back(static_cast<char>(b));
    return out;
}

TEST(GdpMessage, CommandsAndReplies) {
    EXPECT_EQ(command_bytes(Command::start), bytes({6, 0, 0, 0, 0x0d, 0x10}));
    EXPECT_EQ(command_bytes(Command::trigger), bytes({6, 0, 0, 0, 0x10, 0x45}));
    EXPECT_EQ(command_bytes(Command::ping, bytes({1, 2})), bytes({8, 0, 0, 0, 0x0e, 0x10, 1, 2}));
    // Two replies and the beginning of a third.
    std::string stream = bytes({10, 0, 0, 0, 0x01, 0x10, 1,    0,    0,    0,           //
                                12, 0, 0, 0, 0x11, 0x45, 0x18, 0xfc, 0xff, 0xff, 4, 7,  //
                                10, 0, 0});
    auto reply = take_reply(stream);
    ASSERT_TRUE(reply && *reply);
    EXPECT_EQ((*reply)->command, 0x1001);
    EXPECT_EQ((*reply)->status, kDone);
    reply = take_reply(stream);
    ASSERT_TRUE(reply && *reply);
    EXPECT_EQ((*reply)->status, -1000);
    EXPECT_EQ((*reply)->answer, bytes({4, 7}));
    reply = take_reply(stream);
    ASSERT_TRUE(reply);
    EXPECT_FALSE(*reply);
    EXPECT_EQ(stream.size(), 3u);
}

TEST(GdpMessage, SizesThatNoMessageHas) {
    for (const std::string& head : {bytes({0, 0, 0, 0}), bytes({5, 0, 0, 0}), bytes({0xff, 0xff, 0xff, 0xff}),
                                    bytes({'H', 'T', 'T', 'P'})}) {
        std::string stream = head + std::string(20, 'x');
        const auto message = take_message(stream);
        ASSERT_FALSE(message);
        EXPECT_THAT(message.error().sentence(), HasSubstr("are those of a Gocator"));
    }
}

TEST(GdpMessage, Stamp) {
    std::string content = bytes({1,    0,    0,    0,    56,   0,    0,    0,  // one of 56 bytes
                                 5,    1,    0,    0,    0,    0,    0,    0,  // frame 261
                                 0x40, 0x42, 0x0f, 0,    0,    0,    0,    0,  // 1,000,000 us
                                 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff});
    content += std::string(16, '\0') + bytes({0x39, 0x30, 0, 0}) + std::string(12, '\0');
    const auto stamps = parse_stamps(content);
    ASSERT_TRUE(stamps) << stamps.error().sentence();
    ASSERT_EQ(stamps->size(), 1u);
    EXPECT_EQ(stamps->front().frame, 261u);
    EXPECT_EQ(stamps->front().timestamp_us, 1000000u);
    EXPECT_EQ(stamps->front().encoder, -1);
    EXPECT_EQ(stamps->front().serial, 12345u);
    EXPECT_EQ(parse_stamps(stamps_content(*stamps))->front().frame, 261u);
    content.pop_back();
    EXPECT_FALSE(parse_stamps(content));
}

// Attributes of 32 bytes: count 1, width 3, x 20 um, z 1 um, offsets -10 mm and 50 mm, source bottom.
std::string head(int attribute_bytes) {
    std::string out = bytes({attribute_bytes,
                             0,
                             1,
                             0,
                             0,
                             0,
                             3,
                             0,
                             0,
                             0,  //
                             0x20,
                             0x4e,
                             0,
                             0,
                             0xe8,
                             0x03,
                             0,
                             0,  // 20000 nm, 1000 nm
                             0xf0,
                             0xd8,
                             0xff,
                             0xff,
                             0x50,
                             0xc3,
                             0,
                             0,
                             1});  // -10000 um, 50000 um, bottom
    out.resize(2 + static_cast<std::size_t>(attribute_bytes), '\x7f');
    return out;
}

TEST(GdpMessage, UniformProfile) {
    for (const int attributes : {32, 40}) {  // older and newer firmware
        const auto read =
            parse_profiles(Type::uniform, head(attributes) + bytes({100, 0, 0x00, 0x80, 0x9c, 0xff}));
        ASSERT_TRUE(read) << read.error().sentence();
        EXPECT_EQ(read->source, 1);
        ASSERT_EQ(read->profiles.size(), 1u);
        const Profile& p = read->profiles[0];
        ASSERT_EQ(p.size(), 3u);
        EXPECT_NEAR(p.x_mm[0], -10, 1e-12);
        EXPECT_NEAR(p.x_mm[2], -9.96, 1e-12);
        EXPECT_NEAR(p.z_mm[0], 50.1, 1e-12);
        EXPECT_TRUE(std::isnan(p.z_mm[1]));
        EXPECT_NEAR(p.z_mm[2], 49.9, 1e-12);
    }
}

TEST(GdpMessage, PointProfile) {
    const auto read = parse_profiles(
        Type::points, head(32) + bytes({1, 0, 2, 0, 0x00, 0x80, 0x00, 0x80, 0xff, 0xff, 0xfe, 0xff}));
    ASSERT_TRUE(read) << read.error().sentence();
    const Profile& p = read->profiles[0];
    ASSERT_EQ(p.size(), 3u);
    EXPECT_NEAR(p.x_mm[0], -9.98, 1e-12);
    EXPECT_NEAR(p.z_mm[0], 50.002, 1e-12);
    EXPECT_TRUE(std::isnan(p.x_mm[1]) && std::isnan(p.z_mm[1]));
    EXPECT_NEAR(p.x_mm[2], -10.02, 1e-12);
    EXPECT_NEAR(p.z_mm[2], 49.998, 1e-12);
}

TEST(GdpMessage, Intensities) {
    std::string content = bytes({24, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0x20, 0x4e, 0, 0, 0, 0, 0, 0, 2});
    content.resize(2 + 24, '\0');
    const auto read = parse_intensities(content + bytes({0, 255}));
    ASSERT_TRUE(read) << read.error().sentence();
    EXPECT_EQ(read->source, 2);
    EXPECT_EQ(read->rows.at(0), (std::vector<float>{0, 1}));
}

TEST(GdpMessage, CountsThatOverflowAreRefused) {
    std::string content = head(32) + bytes({1, 0, 2, 0, 3, 0});
    for (int i = 2; i < 10; ++i)
        content[static_cast<std::size_t>(i)] = '\xff';  // 2^32-1 arrays of 2^32-1 points
    EXPECT_FALSE(parse_profiles(Type::uniform, content));
    EXPECT_FALSE(parse_profiles(Type::uniform, head(32) + bytes({1, 0, 2, 0, 3})));  // a byte too few
    EXPECT_FALSE(parse_profiles(Type::points, head(32) + bytes({1, 0, 2, 0, 3, 0})));
    EXPECT_FALSE(parse_profiles(Type::uniform, head(31)));
    EXPECT_FALSE(parse_profiles(Type::uniform, ""));
}

// 16 MiB that say 16 million profiles of no point: each would cost some hundred bytes here.
TEST(GdpMessage, EmptyProfilesAreBounded) {
    for (const int count_byte : {0x00, 0x01}) {  // 4096 and 4097 and a little
        std::string content = head(32);
        content[2] = static_cast<char>(count_byte), content[3] = 0x10, content[4] = content[5] = 0;
        content[6] = 0;  // width
        content.resize(kLongestMessage - 6);
        const bool all = count_byte == 0;
        EXPECT_EQ(parse_profiles(Type::points, content).has_value(), all);
        EXPECT_EQ(parse_profiles(Type::uniform, content).has_value(), all);
        EXPECT_EQ(parse_intensities(content).has_value(), all);
    }
    std::string content = head(32);
    content[2] = content[3] = 0, content[4] = static_cast<char>(0xf0), content[6] = 0;  // 15 728 640
    content.resize(kLongestMessage - 6);
    const auto read = parse_profiles(Type::points, content);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().sentence().find("15728640 profiles"), std::string::npos);
}

TEST(GdpMessage, SystemInfoOfBothLayouts) {
    std::string info = bytes({0x39, 0x30, 0, 0, 192, 168, 1, 10}) + "Gocator2330";
    info.resize(40, '\0');
    info += bytes({4, 6, 5, 1, 1, 0, 0, 0, 0, 0, 0, 0});
    for (const auto& [command, answer] :
         {std::pair{Command::system_info_v1, info}, std::pair{Command::system_info, bytes({52, 0}) + info}}) {
        const auto read = parse_system_info(command, answer);
        ASSERT_TRUE(read);
        EXPECT_EQ(read->model, "Gocator2330");
        EXPECT_EQ(read->serial, "12345");
        EXPECT_EQ(read->state, 1);
    }
    EXPECT_FALSE(parse_system_info(Command::system_info, info.substr(0, 20)));
}

TEST(GdpMessage, PointsSurviveTheWireWithinHalfAMicrometre) {
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> place(-30, 30);
    Profile p;
    for (int i = 0; i < 500; ++i) {
        p.x_mm.push_back(i % 7 ? place(rng) : std::nan(""));
        p.z_mm.push_back(300 + place(rng));
    }
    const auto again = parse_profiles(Type::points, points_content(p));
    ASSERT_TRUE(again);
    for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_EQ(std::isnan(again->profiles[0].z_mm[i]), i % 7 == 0);
        if (i % 7 == 0) continue;
        EXPECT_NEAR(again->profiles[0].x_mm[i], p.x_mm[i], 0.000501);
        EXPECT_NEAR(again->profiles[0].z_mm[i], p.z_mm[i], 0.000501);
    }
}

}  // namespace
}  // namespace seamwright::gdp
