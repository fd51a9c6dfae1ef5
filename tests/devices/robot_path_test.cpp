// Robot programs read back as paths: those that this program writes, parts, and what is none.
#include "devices/robot_path/robot_path.h"

#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "core/geometry/notation.h"
#include "devices/registry.h"
#include "tests/devices/robot_programs.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

// ---- what this program writes

// Poses as a file of so many digits holds them lie half its last digit off.
TEST(ProgramPath, WhatOurWritersWriteReadsBackExactly) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> mm(-1500, 1500), deg(-180, 180);
    PathProgramRequest request;
    request.name = "bead";
    request.comment = "path corrected by run 3";
    request.base_from_frame = kuka(812.4, -103.9, 655, 91.2, -1.1, 178.8);
    for (int i = 0; i < 200; ++i)
        request.frame_from_tool.push_back(
            kuka(mm(random), mm(random), mm(random), deg(random), deg(random) / 2, deg(random)));
    for (const char* brand : {"kuka", "abb", "ur"}) {
        const auto files = write_robot_path(brand, request);
        ASSERT_TRUE(files) << files.error().sentence();
        const ProgramPath path = parsed(files->front().name, files->front().text);
        EXPECT_EQ(path.count(LineKind::not_understood), 0U) << brand;
        EXPECT_EQ(path.count(LineKind::left_out), 0U) << brand;
        EXPECT_TRUE(path.remarks.empty()) << path.remarks.front();
        EXPECT_EQ(path.tools.size(), 1U);
        ASSERT_EQ(path.points.size(), request.frame_from_tool.size()) << brand;
        for (std::size_t i = 0; i < path.points.size(); ++i) {
            EXPECT_EQ(path.points[i].motion, ProgramMotion::linear);
            expect_pose(in_base(path.points[i]), request.base_from_frame * request.frame_from_tool[i], brand,
                        5e-4, 5e-7);
        }
        // To the last digit: what was read, written again, is the same file.
        PathProgramRequest again = request;
        for (std::size_t i = 0; i < path.points.size(); ++i) {
            if (std::string(brand) == "ur")
                again.frame_from_tool[i] = request.base_from_frame.inverse() * path.points[i].frame_from_tool;
            else
                again.frame_from_tool[i] = path.points[i].frame_from_tool;
        }
        const auto second = write_robot_path(brand, again);
        ASSERT_TRUE(second);
        const ProgramPath twice = parsed(second->front().name, second->front().text);
        for (std::size_t i = 0; i < path.points.size(); ++i)
            expect_pose(in_base(twice.points[i]), in_base(path.points[i]), brand, 2e-4, 1e-7);
        if (std::string(brand) == "kuka") {
            EXPECT_EQ(second->front().text, files->front().text) << brand;
        }
    }
}

TEST(ProgramPath, MeasuringProgramsReadBackWithTheirModules) {
    ProgramRequest request;
    request.project = "door";
    for (int i = 0; i < 3; ++i) {
        MeasuringMove move;
        move.spot_id = "S" + std::to_string(i + 1);
        move.entry = kuka(100 + i, 200, 300, 10, 20, 30);
        move.trigger = kuka(110 + i, 200, 300, 10, 20, 30);
        move.exit = kuka(120 + i, 200, 300, 10, 20, 30);
        move.stop_at_trigger = i == 1;
        request.moves.push_back(move);
    }
    for (const char* brand : {"kuka", "abb", "ur"}) {
        const auto files = write_robot_program(brand, request);
        ASSERT_TRUE(files) << files.error().sentence();
        std::vector<ProgramText> texts;
        for (const ProgramFile& f : *files) {
            const bool program = f.name == "seamwright_spots.src" || f.name == "SeamwrightSpots.mod" ||
                                 f.name == "seamwright.script";
            if (program)
                texts.insert(texts.begin(), {f.name, f.text});
            else if (program_language_of(f.name))
                texts.push_back({f.name, f.text});
        }
        ProgramPathOptions options;
        if (std::string(brand) == "ur") options.routine = "sw_measure";
        auto path = parse_program_path(texts, options);
        ASSERT_TRUE(path) << brand << path.error().sentence();
        ASSERT_EQ(path->points.size(), 9U) << brand;
        for (std::size_t i = 0; i < 9; ++i) {
            const MeasuringMove& m = request.moves[i / 3];
            expect_pose(in_base(path->points[i]),
                        i % 3 == 0   ? m.entry
                        : i % 3 == 1 ? m.trigger
                                     : m.exit,
                        brand, 5e-4, 5e-7);
        }
    }
}

// ---- whole and broken

TEST(ProgramPath, EveryStatementOfAProgramHasANote) {
    for (const auto& [name, text] :
         std::vector<std::pair<std::string, std::string>>{{"BEAD.SRC", kInline}, {"BEAD.LS", kTp}}) {
        const ProgramPath path = parsed(name, text);
        for (const ProgramLine& l : path.lines) EXPECT_FALSE(l.text.empty()) << l.line;
        if (name == "BEAD.SRC") {
            EXPECT_EQ(path.lines.size(), 26U);
        }
    }
}

TEST(ProgramPath, PartOfAProgramByItsLines) {
    ProgramPathOptions options;
    options.first_line = 26;
    options.last_line = 40;
    const ProgramPath path = parsed("BEAD.SRC", kInline, options, {{"bead.dat", kInlineData}});
    ASSERT_EQ(path.points.size(), 2U);
    EXPECT_EQ(path.points[0].name, "XP2");
    EXPECT_THAT(why_at(path, 25), HasSubstr("left out: outside the lines"));
}

TEST(ProgramPath, WhatIsNoProgramEndsInASentence) {
    const auto refused = [](const std::string& name, const std::string& text) {
        const auto path = parse_program_path({{name, text}});
        EXPECT_FALSE(path) << name;
        return path ? std::string() : path.error().sentence();
    };
    EXPECT_THAT(refused("a.txt", "x"), HasSubstr("ending"));
    EXPECT_THAT(refused("a.src", ""), HasSubstr("no routine of the program moves the robot"));
    EXPECT_THAT(refused("a.src", std::string("DEF A()\0LIN", 11)), HasSubstr("no text"));
    EXPECT_THAT(refused("a.src",
                        "\xFF\xFE"
                        "D\0E\0"),
                HasSubstr("UTF-16"));
    EXPECT_THAT(
        refused("a.mod",
                "MODULE m\nPROC p()\nWHILE 1=1 DO\nx:=x;\nENDWHILE\nMoveL p,v,z,t;\nENDPROC\nENDMODULE"),
        HasSubstr("does not come to an end"));
    EXPECT_THAT(refused("a.script", "def a():\na()\nmovel(p[0,0,0,0,0,0])\nend\n"),
                HasSubstr("does not come to an end"));
    std::string deep = "DEF a()\n";
    for (int i = 0; i < 100000; ++i) deep += "IF TRUE THEN\n";
    EXPECT_TRUE(parse_program_path({{"a.src", deep + "LIN {X 1,Y 1,Z 1,A 0,B 0,C 0}\n"}}));
    std::string brackets =
        "DEF a()\nLIN P\nX=" + std::string(100000, '(') + "\nY=" + std::string(100000, '-') + "1\nZ=1";
    for (int i = 0; i < 100000; ++i) brackets += "+1";
    EXPECT_TRUE(parse_program_path({{"a.src", brackets + "\n"}}));
    std::string many = "def a():\n while i < 1:\n";
    for (int i = 0; i < 3000; ++i) many += "  movel(p[0,0,0,0,0,0])\n";
    EXPECT_TRUE(parse_program_path({{"a.script", many}}));
}

}  // namespace
}  // namespace seamwright
