// The three lines of 80 bytes, by bytes written out here.

#include "devices/abb/rapid_message.h"

#include <gtest/gtest.h>

#include <cmath>

namespace seamwright::abb {
namespace {

std::string line(const std::string& text) {
    return text + std::string(79 - text.size(), ' ') + "\n";
}

TEST(RapidMessage, IsThreeLinesOfEightyBytes) {
    Message m{17, "WRITE", {"wobjDoor"}, {}, {}};
    set_pose_lines(m, make_pose(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                                {1250.25, -3.5, 0}));
    EXPECT_EQ(message_bytes(m), line("17 WRITE wobjDoor") + line("1250.2500 -3.5000 0.0000") +
                                    line("0.70710678 0.00000000 0.00000000 0.70710678"));
}

TEST(RapidMessage, ReadsWhatAControllerSends) {
    const auto m = parse_message(line("0 TRIGGER 3 3 S3") + line("1000.1250 0 -20.5") + line("0 0 1 0"), "c");
    ASSERT_TRUE(m) << m.error().sentence();
    EXPECT_EQ(m->number, 0u);
    EXPECT_EQ(m->word, "TRIGGER");
    EXPECT_EQ(m->fields, (std::vector<std::string>{"3", "3", "S3"}));
    const auto pose = parse_pose_lines(*m, "c");
    ASSERT_TRUE(pose) << pose.error().sentence();
    EXPECT_TRUE(pose->translation().isApprox(Eigen::Vector3d(1000.125, 0, -20.5)));
    EXPECT_NEAR(pose->linear()(0, 0), -1, 1e-12);
    EXPECT_NEAR(pose->linear()(1, 1), 1, 1e-12);
}

TEST(RapidMessage, RefusesWhatIsNone) {
    const std::string blank = line("");
    for (const std::string& first : {std::string(""), std::string("X MODE"), std::string("5"),
                                     std::string("-1 MODE"), std::string("8388608 MODE")})
        EXPECT_FALSE(parse_message(line(first) + blank + blank, "c")) << first;
    EXPECT_FALSE(parse_message(line("1 MODE") + blank, "c"));
    std::string no_feed = line("1 MODE") + blank + blank;
    no_feed[79] = ' ';
    EXPECT_FALSE(parse_message(no_feed, "c"));
    std::string control = line("1 MODE") + blank + blank;
    control[20] = '\0';
    EXPECT_FALSE(parse_message(control, "c"));
    EXPECT_TRUE(parse_message(line("8388607 MODE") + blank + blank, "c"));
}

TEST(RapidMessage, RefusesPosesThatNoRobotCanMean) {
    const auto pose = [](const char* position, const char* rotation) {
        return parse_pose_lines({1, "POSE", {}, position, rotation}, "c").has_value();
    };
    EXPECT_TRUE(pose("1 2 3", "1 0 0 0"));
    EXPECT_FALSE(pose("1 2", "1 0 0 0"));
    EXPECT_FALSE(pose("1 2 3 4", "1 0 0 0"));
    EXPECT_FALSE(pose("nan 2 3", "1 0 0 0"));
    EXPECT_FALSE(pose("1 inf 3", "1 0 0 0"));
    EXPECT_FALSE(pose("1 2 3x", "1 0 0 0"));
    EXPECT_FALSE(pose("1000000000 2 3", "1 0 0 0"));
    EXPECT_FALSE(pose("1 2 3", "0.9 0 0 0"));
    EXPECT_FALSE(pose("1 2 3", "0 0 0 0"));
    EXPECT_FALSE(pose("1 2 3", "1 0 0"));
}

TEST(RapidMessage, KnowsIdentifiers) {
    EXPECT_TRUE(is_rapid_identifier("wobj_Door1"));
    EXPECT_TRUE(is_rapid_identifier(std::string(32, 'a')));
    EXPECT_FALSE(is_rapid_identifier(std::string(33, 'a')));
    EXPECT_FALSE(is_rapid_identifier("1door"));
    EXPECT_FALSE(is_rapid_identifier("door-1"));
    EXPECT_FALSE(is_rapid_identifier(""));
}

}  // namespace
}  // namespace seamwright::abb
