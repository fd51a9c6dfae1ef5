// Bytes as the RTDE guide gives them, written out by hand.

#include "devices/ur/rtde_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "devices/ur/module.h"

namespace seamwright {
namespace {

using namespace rtde;
using testing::HasSubstr;

std::string bytes(std::initializer_list<int> values) {
    std::string out;
    for (const int v : values) out.push_back(static_cast<char>(v));
    return out;
}

TEST(RtdeMessage, BytesAreThoseOfTheGuide) {
    EXPECT_EQ(package_bytes({Type::protocol_version, version_payload(2)}), bytes({0, 5, 'V', 0, 2}));
    EXPECT_EQ(package_bytes({Type::start, {}}), bytes({0, 3, 'S'}));
    // 125 Hz = 0x405F400000000000
    EXPECT_EQ(package_bytes({Type::setup_outputs, outputs_request({"timestamp"}, 2, 125)}),
              bytes({0, 20, 'O', 0x40, 0x5f, 0x40, 0, 0, 0, 0, 0}) + "timestamp");
    EXPECT_EQ(outputs_request({"timestamp", "robot_mode"}, 1, 125), "timestamp,robot_mode");
    EXPECT_EQ(inputs_request({"input_int_register_24", "input_double_register_24"}),
              "input_int_register_24,input_double_register_24");

    const auto recipe = recipe_of(bytes({7}) + "DOUBLE,INT32,BOOL,VECTOR6D", {"a", "b", "c", "d"}, true);
    ASSERT_TRUE(recipe) << recipe.error().sentence();
    EXPECT_EQ(recipe->id, 7);
    // 1.5 = 3FF8..., -2 = FFFFFFFE
    std::string payload = bytes({7, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xfe, 1});
    for (int i = 0; i < 6; ++i) payload += bytes({0x40, 0, 0, 0, 0, 0, 0, 0});  // 2.0
    const auto values = values_of(payload, *recipe);
    ASSERT_TRUE(values) << values.error().sentence();
    EXPECT_EQ(std::get<double>((*values)[0]), 1.5);
    EXPECT_EQ(std::get<std::int32_t>((*values)[1]), -2);
    EXPECT_TRUE(std::get<bool>((*values)[2]));
    EXPECT_EQ((std::get<std::array<double, 6>>((*values)[3])), (std::array<double, 6>{2, 2, 2, 2, 2, 2}));
    EXPECT_EQ(data_payload(*recipe, *values), payload);
}

TEST(RtdeMessage, TextsOfBothVersions) {
    EXPECT_EQ(text_of(bytes({5}) + "Hello" + bytes({4}) + "RTDE" + bytes({1}), 2), "Hello");
    EXPECT_EQ(text_of(bytes({1}) + "Hello", 1), "Hello");
    EXPECT_EQ(text_of("", 2), "");
    EXPECT_EQ(text_of(bytes({200}) + "a\nb", 2), "a?b");
}

TEST(RtdeMessage, AStreamIsCutIntoPackagesWhereverItIsBroken) {
    std::string whole;
    for (int i = 0; i < 50; ++i)
        whole += package_bytes({Type::data, std::string(static_cast<std::size_t>(i), 'x')});
    std::mt19937 random(3);
    std::string stream;
    std::size_t taken = 0;
    for (std::size_t at = 0; at < whole.size();) {
        const std::size_t n = std::min<std::size_t>(1 + random() % 40, whole.size() - at);
        stream += whole.substr(at, n);
        at += n;
        for (;;) {
            auto package = take_package(stream);
            ASSERT_TRUE(package);
            if (!*package) break;
            EXPECT_EQ((*package)->payload.size(), taken++);
        }
    }
    EXPECT_EQ(taken, 50U);
    EXPECT_TRUE(stream.empty());
}

TEST(RtdeMessage, WhatIsNoRtdeIsRefusedInWords) {
    for (const std::string& wrong : {bytes({0, 2, 'U'}), bytes({0x7f, 0xff, 'U'}), bytes({0, 5, 'x', 1, 2}),
                                     std::string("GET / HTTP/1.0\r\n")}) {
        std::string stream = wrong;
        const auto package = take_package(stream);
        ASSERT_FALSE(package) << wrong;
        EXPECT_THAT(package.error().sentence(), HasSubstr("RTDE"));
    }
    EXPECT_FALSE(version_of("x"));
    EXPECT_FALSE(accepted_of(bytes({2})));
    EXPECT_FALSE(accepted_of(""));
    const std::vector<std::string> names = {"a", "b"};
    EXPECT_THAT(recipe_of(bytes({0}) + "NOT_FOUND,INT32", names, true).error().sentence(),
                HasSubstr("does not know a"));
    EXPECT_THAT(recipe_of(bytes({0}) + "INT32,IN_USE", names, true).error().sentence(),
                HasSubstr("another program already writes b"));
    EXPECT_THAT(recipe_of(bytes({1}) + "INT32", names, true).error().sentence(), HasSubstr("1 types for 2"));
    EXPECT_THAT(recipe_of(bytes({1}) + "INT32,INT32,INT32", names, true).error().sentence(),
                HasSubstr("3 types for 2"));
    EXPECT_THAT(recipe_of(bytes({1}) + "INT32,FLOAT", names, true).error().sentence(), HasSubstr("FLOAT"));
    EXPECT_FALSE(recipe_of("", names, true));
    const Recipe recipe{3, true, {"a"}, {Kind::boolean}};
    EXPECT_FALSE(values_of(bytes({3, 2}), recipe)) << "neither true nor false";
    EXPECT_FALSE(values_of(bytes({4, 1}), recipe)) << "another recipe";
    EXPECT_FALSE(values_of(bytes({3}), recipe));
    EXPECT_FALSE(values_of(bytes({3, 1, 1}), recipe));
}

TEST(UrModule, PartIdsTravelInRegisters) {
    for (const char* id : {"", "A", "CAR-0815", "0123456789abcdef", "~ !#~"})
        EXPECT_EQ(ur::part_from_registers(ur::part_registers(id)), id);
    EXPECT_EQ(ur::part_from_registers(ur::part_registers("0123456789abcdefTOO LONG")), "0123456789abcdef");
    EXPECT_EQ(ur::part_from_registers(ur::part_registers("a\"b\\c\xc3\xa4")), "abc");
    for (const std::int32_t hostile : {-1, 2147483647, -2147483647 - 1})
        EXPECT_LE(ur::part_from_registers({hostile, hostile, hostile, hostile}).size(), 16U);
}

TEST(UrModule, NumbersOfNamesAndSignatures) {
    EXPECT_EQ(ur::frame_number(""), static_cast<std::int32_t>(0x811c9dc5));  // FNV-1a's published values
    EXPECT_EQ(ur::frame_number("a"), static_cast<std::int32_t>(0xe40c292c));
    EXPECT_EQ(ur::frame_number("foobar"), static_cast<std::int32_t>(0xbf9cf968));
    EXPECT_EQ(ur::signature_numbers("SW-00000001ffffffff"), std::pair(1, -1));
}

TEST(UrModule, PosesAreMetresAndRotationVectors) {
    const Pose pose = make_pose(rotation_exp({0.1, -0.2, 2.9}), {1234.5, -0.25, 6000});
    const auto wire = ur::ur_pose(pose);
    EXPECT_NEAR(wire[0], 1.2345, 1e-12);
    EXPECT_NEAR(wire[5], 2.9, 1e-12);
    EXPECT_LT(distance_mm(*ur::pose_from_ur(wire, "w"), pose), 1e-9);
    for (const double wrong : {1e6, -101.0, std::nan(""), HUGE_VAL})
        for (std::size_t i = 0; i < 6; ++i) {
            auto bad = wire;
            bad[i] = wrong;
            ASSERT_FALSE(ur::pose_from_ur(bad, "w"));
            EXPECT_THAT(ur::pose_from_ur(bad, "w").error().sentence(), HasSubstr("no position of a robot"));
        }
}

}  // namespace
}  // namespace seamwright
