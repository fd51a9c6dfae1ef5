// The written RAPID against the project, read by a small reader of its own.

#include "devices/abb/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>

#include "core/geometry/pose.h"

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
        m.stop_at_trigger = i == 2;
        r.moves.push_back(m);
    }
    r.frames = {{"left", "BASE_left", make_pose(rotation_exp({0.1, 0.2, 0.3}), {900, -450, 500})},
                {"top", "BASE_top", make_pose(rotation_exp({-0.1, 0.2, 3.1}), {901, -451, 501})}};
    r.settings = {{"address", "192.168.1.33"}, {"port", 1026}, {"timeout_ms", 500}};
    return r;
}

std::map<std::string, std::string> files_of(const ProgramRequest& r) {
    auto files = write_abb_program(r);
    EXPECT_TRUE(files) << files.error().sentence();
    std::map<std::string, std::string> by_name;
    if (files)
        for (const ProgramFile& f : *files) by_name[f.name] = f.text;
    return by_name;
}

// "[x,y,z],[q1,q2,q3,q4]" behind the declaration of `name`.
Pose pose_of(const std::string& text, const std::string& name) {
    const std::size_t at = text.find(" " + name + ":=");
    EXPECT_NE(at, std::string::npos) << name;
    const std::regex numbers(
        R"(\[([-0-9.]+),([-0-9.]+),([-0-9.]+)\],\[([-0-9.]+),([-0-9.]+),([-0-9.]+),([-0-9.]+)\])");
    const std::string rest = text.substr(at, 400);
    std::vector<std::smatch> found;
    for (std::sregex_iterator i(rest.begin(), rest.end(), numbers), end; i != end; ++i) found.push_back(*i);
    // A work object begins with its user frame, which is none.
    const std::smatch& m = found.at(rest.find("[[0,0,0],[1,0,0,0]]") < 100 ? 1 : 0);
    const Eigen::Quaterniond q(std::stod(m[4]), std::stod(m[5]), std::stod(m[6]), std::stod(m[7]));
    EXPECT_NEAR(q.norm(), 1, 1e-7);
    return make_pose(q.normalized().toRotationMatrix(), {std::stod(m[1]), std::stod(m[2]), std::stod(m[3])});
}

TEST(AbbProgram, EverySpotAndFrameIsWhereTheProjectHasIt) {
    const ProgramRequest r = request();
    const std::string text = files_of(r)["SeamwrightSpots.mod"];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string point = "s0" + std::to_string(i + 1);
        const MeasuringMove& m = r.moves[i];
        const std::pair<std::string, const Pose*> wanted[] = {
            {point + "_entry", &m.entry}, {point + "_spot", &m.trigger}, {point + "_exit", &m.exit}};
        for (const auto& [name, pose] : wanted) {
            EXPECT_LT(distance_mm(pose_of(text, name), *pose), 2e-4) << name;
            EXPECT_LT(angle_rad(pose_of(text, name), *pose), 1e-7) << name;
        }
    }
    EXPECT_LT(distance_mm(pose_of(text, "BASE_top"), r.frames[1].base_from_frame), 2e-4);
    EXPECT_LT(angle_rad(pose_of(text, "BASE_top"), r.frames[1].base_from_frame), 1e-7);
    EXPECT_THAT(text, HasSubstr("swSignature:=\"" + program_signature(r.moves) + "\""));
    EXPECT_THAT(text, HasSubstr("swCount:=3;"));
    EXPECT_THAT(text, HasSubstr("SW_Pass 2,s02_entry,s02_spot,s02_exit,s02_speed,TRUE;"));
    EXPECT_THAT(text, HasSubstr("SW_Pass 3,s03_entry,s03_spot,s03_exit,s03_speed,FALSE;"));
}

TEST(AbbProgram, ViaPointsAreDrivenBeforeTheEntry) {
    ProgramRequest r = request();
    r.moves[1].via = {make_pose(rotation_exp({0.1, 0, 0}), {900, 1, 2}),
                      make_pose(rotation_exp({0.2, 0, 0}), {910, 1, 2})};
    const std::string text = files_of(r)["SeamwrightSpots.mod"];
    EXPECT_LT(distance_mm(pose_of(text, "s02_via2"), r.moves[1].via[1]), 2e-4);
    EXPECT_THAT(text, HasSubstr("        SW_Via s02_via1;\n        SW_Via s02_via2;\n        SW_Pass 2,"));
    r.moves[1].via[0].translation().x() = 1e9;
    EXPECT_FALSE(write_abb_program(r));
}

TEST(AbbProgram, TheServerListensWhereTheLinkConnects) {
    auto files = files_of(request());
    EXPECT_THAT(files["SeamwrightServer.mod"], HasSubstr("SocketBind server,\"192.168.1.33\",1026;"));
    for (const auto& [name, text] : files) EXPECT_EQ(text.find('@'), std::string::npos) << name;
    for (const char* word :
         {"HELLO", "MODE", "PING", "POSE", "READ", "WRITE", "MEASURE", "VERDICT", "PERMIT", "MOVE"})
        EXPECT_THAT(files["SeamwrightServer.mod"], HasSubstr("CASE \"" + std::string(word) + "\":"));
}

// What both tasks declare must be the same data: the server's without a value.
TEST(AbbProgram, SharedDataHasOneType) {
    auto files = files_of(request());
    const std::regex declared(R"(\n    PERS (\w+) (\w+(?:\{\d+\})?)(:=|;))");
    std::map<std::string, std::string> motion;
    for (const char* name : {"Seamwright.mod", "SeamwrightSpots.mod"}) {
        const std::string& text = files[name];
        for (std::sregex_iterator i(text.begin(), text.end(), declared), end; i != end; ++i)
            motion[(*i)[2]] = (*i)[1];
    }
    int shared = 0;
    const std::string& server = files["SeamwrightServer.mod"];
    for (std::sregex_iterator i(server.begin(), server.end(), declared), end; i != end; ++i, ++shared) {
        EXPECT_EQ((*i)[3], ";");
        EXPECT_EQ(motion[(*i)[2]], (*i)[1]) << (*i)[2];
    }
    EXPECT_EQ(shared, 21);
}

TEST(AbbProgram, BlocksAreClosedAndNamesFit) {
    for (const auto& [name, text] : files_of(request(64))) {
        std::istringstream in(text);
        std::vector<std::string> open;
        std::string whole;  // a statement may go over lines
        for (std::string line; std::getline(in, line);) {
            EXPECT_LE(line.size(), 130U) << name << ": " << line;
            const std::size_t at = line.find_first_not_of(' ');
            if (at == std::string::npos || line[at] == '!') continue;
            std::istringstream words(line);
            std::string word;
            words >> word;
            if (word == "LOCAL") words >> word;
            static const std::map<std::string, std::string> closes = {
                {"ENDMODULE", "MODULE"}, {"ENDPROC", "PROC"}, {"ENDFUNC", "FUNC"}, {"ENDTRAP", "TRAP"},
                {"ENDIF", "IF"},         {"ENDFOR", "FOR"},   {"ENDTEST", "TEST"}, {"ENDWHILE", "WHILE"}};
            if (const auto end = closes.find(word); end != closes.end()) {
                ASSERT_FALSE(open.empty()) << line;
                EXPECT_EQ(open.back(), end->second) << name << ": " << line;
                open.pop_back();
            }
            const bool block_if = word == "IF" && line.ends_with(" THEN");
            if (word == "MODULE" || word == "PROC" || word == "FUNC" || word == "TRAP" || block_if ||
                word == "FOR" || word == "TEST" || word == "WHILE")
                open.push_back(word);
        }
        EXPECT_TRUE(open.empty()) << name;
        const std::regex identifier(R"([A-Za-z_]\w*)");
        for (std::sregex_iterator i(text.begin(), text.end(), identifier), end; i != end; ++i)
            EXPECT_LE(i->str().size(), 32U) << i->str();
    }
}

TEST(AbbProgram, WhatRapidCannotHoldIsRefused) {
    EXPECT_FALSE(write_abb_program(request(65)));
    auto refused = [](auto change) {
        ProgramRequest r = request();
        change(r);
        auto files = write_abb_program(r);
        return files ? "" : files.error().sentence();
    };
    EXPECT_THAT(refused([](auto& r) { r.frames[0].name = "1left"; }), HasSubstr("region left"));
    EXPECT_THAT(refused([](auto& r) { r.frames[1].name = "base_LEFT"; }), HasSubstr("two regions"));
    EXPECT_THAT(refused([](auto& r) { r.moves[1].spot_id = "S \"2\""; }), HasSubstr("S \"2\""));
    EXPECT_THAT(refused([](auto& r) { r.moves[1].speed_mm_s = 0; }), HasSubstr("spot S2"));
    EXPECT_THAT(refused([](auto& r) { r.moves[1].exit.translation().x() = 1e9; }), HasSubstr("spot S2"));
    EXPECT_THAT(refused([](auto& r) { r.settings["address"] = "a\";halt"; }), HasSubstr("address"));
    EXPECT_THAT(refused([](auto& r) { r.settings["port"] = 70000; }), HasSubstr("port"));
}

}  // namespace
}  // namespace seamwright
