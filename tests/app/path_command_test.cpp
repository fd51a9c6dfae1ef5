// `seamwright path --look` as a script calls it: programs and edges of drawings as paths.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class PathCommand : public testing::Test {
  protected:
    PathCommand() : folder_(test_folder("path_command")) {}
    ~PathCommand() override { fs::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return (folder_ / name).string();
    }
    ProgramResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "path");
        return run_program(arguments, folder_);
    }
    fs::path folder_;
};

TEST_F(PathCommand, LookSaysByLineWhatWasUnderstood) {
    write("BEAD.DAT", "DEFDAT BEAD\nDECL E6POS XP1={X 1,Y 2,Z 3,A 0,B 0,C 0,S 2,T 2}\nENDDAT\n");
    const std::string program = write("bead.src",
                                      "DEF BEAD()\n$BASE=BASE_DATA[4]\nLIN XP1\nLIN {X 11,Y 2,Z 3,A 0,B 0,C "
                                      "0}\nIF $IN[1] THEN\nLIN XP9\nENDIF\nEND\n");
    const ProgramResult r = run({"--look", "--path", program, "--json", "-"});
    EXPECT_EQ(r.exit_code, 1) << r.err;
    const json a = json::parse(r.out);
    EXPECT_EQ(a["status"], "not understood");
    ASSERT_EQ(a["points"].size(), 2u);
    EXPECT_EQ(a["points"][0]["name"], "XP1") << "the data list beside it is found whatever its case";
    EXPECT_EQ(a["unknown_frames"], json({"BASE_DATA[4]"}));
    int bad = 0;
    for (const json& line : a["lines"])
        if (line["what"] == "not understood") {
            ++bad;
            EXPECT_EQ(line["line"], 6);
            EXPECT_THAT(line["why"].get<std::string>(), HasSubstr("$IN[1]"));
        }
    EXPECT_EQ(bad, 1);
    EXPECT_THAT(run({"--look", "--path", program}).out,
                HasSubstr("bead.src, line 6: not understood: LIN XP9"));
    // With the frame's place the points have theirs in the base.
    const ProgramResult placed = run({"--look", "--path", program, "--frame-pose",
                                      R"(BASE_DATA[4]={"xyz":[100,0,0],"abc":[0,0,0]})", "--json", "-"});
    EXPECT_NEAR(json::parse(placed.out)["points"][0]["base_from_tool"]["xyz"][0].get<double>(), 101, 1e-9)
        << placed.err;
}

TEST_F(PathCommand, BadInputEndsInASentence) {
    const std::string program = write("p.mod", "MODULE p\nPROC a()\nTPWrite \"x\";\nENDPROC\nENDMODULE\n");
    const auto refused = [&](const std::vector<std::string>& arguments, int code, const std::string& what) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, code) << r.out;
        EXPECT_THAT(r.err, HasSubstr(what));
    };
    refused({"--look", "--path", program}, 2, "no routine of the program moves the robot");
    refused({"--look", "--path", write("p.csv", "x\n")}, 2, "in whose notation");
    refused({"--look", "--path", (folder_ / "none.src").string()}, 3, "cannot be opened");
    refused({"--look"}, 2, "--drawing and --edge");
    refused({"--look", "--path", program, "--lines", "9..3"}, 2, "no range");
    refused({"--look", "--path", program, "--frame-pose", "x"}, 2, "names no frame");
    refused({"--path", program}, 2, "the project is missing");
}

TEST_F(PathCommand, AlongAnEdgeWithOffsetAndStandOff) {
    std::string obj;
    for (const char* v :
         {"0 0 0", "200 0 0", "200 120 0", "0 120 0", "0 0 80", "200 0 80", "200 120 80", "0 120 80"})
        obj += std::string("v ") + v + "\n";
    obj += "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    const std::string block = write("block.obj", obj);
    const ProgramResult edges = run_program({"drawing", block, "--json", "-"}, folder_);
    ASSERT_EQ(edges.exit_code, 0) << edges.err;
    const json drawing = json::parse(edges.out);
    std::string top;  // along x at y = 0, z = 80: between the top and the front
    for (const json& e : drawing["edges"])
        if (e["from_mm"][1] == 0 && e["to_mm"][1] == 0 && e["from_mm"][2] == 80 && e["to_mm"][2] == 80)
            top = e["id"];
    ASSERT_FALSE(top.empty()) << edges.out;
    for (const double offset : {0.0, 5.0, -5.0}) {
        const ProgramResult r =
            run({"--look", "--drawing", block, "--edge", top, "--offset-mm", std::to_string(offset),
                 "--stand-off-mm", "8", "--step-mm", "20", "--json", "-"});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json points = json::parse(r.out)["points"];
        ASSERT_GE(points.size(), 11u);
        const json first = points.front()["pose"], last = points.back()["pose"];
        EXPECT_NEAR(std::abs(first["xyz"][0].get<double>() - last["xyz"][0].get<double>()), 200, 1e-6);
        const double y = first["xyz"][1], z = first["xyz"][2];
        if (offset == 0) {
            EXPECT_NEAR(y, -8 / std::sqrt(2.0), 1e-6);
            EXPECT_NEAR(z, 80 + 8 / std::sqrt(2.0), 1e-6);
        } else {  // on the top 5 mm in, or on the front 5 mm down: 8 mm above either
            const bool on_top = std::abs(z - 88) < 1e-6 && std::abs(y - 5) < 1e-6;
            const bool on_front = std::abs(y + 8) < 1e-6 && std::abs(z - 75) < 1e-6;
            EXPECT_TRUE(on_top || on_front) << y << " " << z;
            const bool forward = first["xyz"][0].get<double>() < last["xyz"][0].get<double>();
            // Seen from outside the top lies left of a travel towards +x.
            EXPECT_EQ(on_top, (offset > 0) == forward);
        }
        // z of the tool points into the part.
        const json m = first["matrix"];
        EXPECT_LT(m[2].is_array() ? m[2][2].get<double>() : m[10].get<double>(), 0.1);
    }
    EXPECT_EQ(run({"--look", "--drawing", block, "--edge", "e999"}).exit_code, 2);
}

}  // namespace
}  // namespace seamwright
