// The written URScript against the project and against what the link believes of the registers.

#include "devices/ur/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <regex>
#include <sstream>

#include "devices/ur/module.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

ProgramRequest request(int spots = 3) {
    ProgramRequest r;
    r.project = "door left";
    for (int i = 1; i <= spots; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i);
        m.trigger = make_pose(rotation_exp({0.3 * i, -0.5, 1.1}), {1000.1234 + i, -250.5, 700});
        m.entry = m.exit = m.trigger;
        m.entry.translation().x() -= 20;
        m.exit.translation().x() += 20;
        m.speed_mm_s = 100;
        m.stop_at_trigger = i == 2;
        r.moves.push_back(m);
    }
    r.frames = {{"left", "BASE_left", make_pose(rotation_exp({0.1, 0.2, 0.3}), {900, -450, 500})},
                {"top", "BASE_top", make_pose(rotation_exp({-0.1, 0.2, 3.1}), {901, -451, 501})}};
    return r;
}

std::string script_of(const ProgramRequest& r) {
    auto files = write_ur_program(r);
    EXPECT_TRUE(files) << files.error().sentence();
    EXPECT_EQ(files->size(), 1U);
    EXPECT_EQ(files->front().name, "seamwright.script");
    return files->front().text;
}

// "p[x, y, z, rx, ry, rz]" by Rodrigues' formula of Eigen, not by the writer's own code.
std::vector<Pose> poses_in(const std::string& text) {
    std::vector<Pose> poses;
    const std::regex number(
        R"(p\[([-0-9.e]+), ([-0-9.e]+), ([-0-9.e]+), ([-0-9.e]+), ([-0-9.e]+), ([-0-9.e]+)\])");
    for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
        double v[6];
        for (int i = 0; i < 6; ++i) v[i] = std::stod((*at)[i + 1]);
        const Eigen::Vector3d r(v[3], v[4], v[5]);
        const double angle = r.norm();
        poses.push_back(make_pose(
            angle > 0 ? Eigen::AngleAxisd(angle, r / angle).toRotationMatrix() : Eigen::Matrix3d::Identity(),
            {1000 * v[0], 1000 * v[1], 1000 * v[2]}));
    }
    return poses;
}

std::string line_with(const std::string& text, const std::string& what) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        if (line.find(what) != std::string::npos) return line;
    return {};
}

TEST(UrProgram, EverySpotIsPassedWhereTheProjectHasIt) {
    const ProgramRequest r = request();
    const std::string text = script_of(r);
    for (int i = 1; i <= 3; ++i) {
        const std::string line = line_with(text, "    sw_pass(" + std::to_string(i) + ", ");
        const auto poses = poses_in(line);
        ASSERT_EQ(poses.size(), 3U) << line;
        const MeasuringMove& m = r.moves[static_cast<std::size_t>(i - 1)];
        const Pose* wanted[] = {&m.entry, &m.trigger, &m.exit};
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LT(distance_mm(poses[k], *wanted[k]), 2e-4);
            EXPECT_LT(angle_rad(poses[k], *wanted[k]), 1e-7);
        }
        EXPECT_THAT(line,
                    testing::EndsWith(i == 2 ? ", 0.1000, 0.00200, True)" : ", 0.1000, 0.00200, False)"));
    }
    const auto frames = poses_in(line_with(text, "global sw_frames"));
    ASSERT_EQ(frames.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(distance_mm(frames[i], r.frames[i].base_from_frame), 2e-4);
    EXPECT_THAT(line_with(text, "global sw_names"),
                HasSubstr(std::to_string(ur::frame_number("BASE_left")) + ", " +
                          std::to_string(ur::frame_number("BASE_top"))));
    const auto [high, low] = ur::signature_numbers(program_signature(r.moves));
    EXPECT_THAT(text, HasSubstr("sw_signature_high = " + std::to_string(high) + "\n"));
    EXPECT_THAT(text, HasSubstr("sw_signature_low = " + std::to_string(low) + "\n"));
    EXPECT_THAT(
        text, HasSubstr("# sw_activate(sw_BASE_top): region top, frame BASE_top\nglobal sw_BASE_top = 2\n"));
    EXPECT_EQ(text.find('@'), text.find("@ABC")) << "only the alphabet holds that sign";
}

TEST(UrProgram, RegistersAreThoseOfTheLink) {
    ProgramRequest r = request();
    r.settings = {{"first_register", 26}, {"trigger_output", 3}, {"port", 30004}};
    const std::string text = script_of(r);
    const std::map<std::string, int> expected = {{"sw_first", 26},
                                                 {"sw_trigger_out", 3},
                                                 {"sw_r_module", ur::kModule},
                                                 {"sw_r_answered", ur::kAnswered},
                                                 {"sw_r_status", ur::kStatus},
                                                 {"sw_r_signature_high", ur::kSignatureHigh},
                                                 {"sw_r_signature_low", ur::kSignatureLow},
                                                 {"sw_r_fired", ur::kFired},
                                                 {"sw_r_call", ur::kCall},
                                                 {"sw_r_part", ur::kPart},
                                                 {"sw_r_state", ur::kState},
                                                 {"sw_r_number", ur::kNumber},
                                                 {"sw_r_command", ur::kCommand},
                                                 {"sw_r_argument", ur::kArgument},
                                                 {"sw_r_high", ur::kHigh},
                                                 {"sw_r_low", ur::kLow},
                                                 {"sw_r_session", ur::kSession},
                                                 {"sw_r_beat", ur::kBeat}};
    for (const auto& [name, value] : expected)
        EXPECT_EQ(line_with(text, "global " + name + " = "),
                  "global " + name + " = " + std::to_string(value));
    EXPECT_THAT(text, HasSubstr("sw_write(sw_r_module, " + std::to_string(ur::kModuleVersion) + ")"));
    EXPECT_THAT(text, HasSubstr("global sw_alphabet = \"" + std::string(ur::part_alphabet()) + "\"\n"));
}

// Blocks of URScript open with def, thread, while, if and close with end.
TEST(UrProgram, BlocksAreClosed) {
    std::istringstream in(script_of(request(64)));
    int depth = 0, line_number = 0;
    for (std::string line; std::getline(in, line);) {
        ++line_number;
        const std::size_t at = line.find_first_not_of(' ');
        if (at == std::string::npos || line[at] == '#') continue;
        const std::string word = line.substr(at);
        const bool opens = word.starts_with("def ") || word.starts_with("thread ") ||
                           word.starts_with("while ") || word.starts_with("if ");
        const bool middle = word.starts_with("elif ") || word == "else:";
        EXPECT_EQ(opens || middle, line.back() == ':') << line_number << ": " << line;
        if (word == "end") --depth;
        EXPECT_EQ(at, 2U * static_cast<std::size_t>(depth - (middle ? 1 : 0))) << line_number << ": " << line;
        if (opens) ++depth;
        ASSERT_GE(depth, 0);
    }
    EXPECT_EQ(depth, 0);
}

TEST(UrProgram, WhatTheModuleCannotHoldIsRefused) {
    EXPECT_FALSE(write_ur_program(request(65)));
    ProgramRequest r = request();
    r.moves[1].speed_mm_s = 2500;
    EXPECT_THAT(write_ur_program(r).error().sentence(), HasSubstr("spot S2"));
    r = request();
    r.moves[0].exit.translation().y() = std::nan("");
    EXPECT_FALSE(write_ur_program(r));
    r = request();
    r.frames[1].name = "BASE_left";
    EXPECT_THAT(write_ur_program(r).error().sentence(), HasSubstr("one frame to the controller"));
    r = request();
    r.moves[0].spot_id = "S1\nhalt";
    EXPECT_THAT(script_of(r), HasSubstr("# spot S1?halt\n")) << "a name stays a comment";
    r.moves.clear();
    r.frames.clear();
    EXPECT_THAT(script_of(r), HasSubstr("sw_frame_count = 0"));
}

}  // namespace
}  // namespace seamwright
