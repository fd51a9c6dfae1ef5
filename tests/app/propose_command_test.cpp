// `seamwright propose --take` and `seamwright confirm`: the contract from the outside, on the simulated door.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "devices/drawing/door_step.h"
#include "devices/drawing/drawing.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// One read for all: the sides' edges.
const std::map<std::string, std::string>& edges() {
    static const auto found = [] {
        std::map<std::string, std::string> by_side;
        const std::string text = *door_step();
        const auto drawing = read_drawing(std::as_bytes(std::span(text)), "door.step", {});
        for (const DrawingEdge& e : drawing->edges)
            if (e.fold_deg > 60 && !e.convex && e.length_mm > 300)
                by_side[door_side_of(e.points[e.points.size() / 2].point_mm)] = e.id;
        return by_side;
    }();
    return found;
}

class ProposeCommand : public testing::Test {
  protected:
    void SetUp() override {
        nlohmann::json settings = cell_settings(Pose::Identity());
        settings["robot"]["mode"] = "manual_reduced";
        auto cell = SimulatedCell::open(settings);
        ASSERT_TRUE(cell);
        Project project = door_project(**cell, settings);
        project.regions.front().sigma_limit_mm = 0.2;
        ASSERT_TRUE(ProjectFile::create(file, project));
        ASSERT_TRUE(write_text_file(drawing, *door_step()));
    }
    ~ProposeCommand() override { std::filesystem::remove_all(folder); }
    std::vector<std::string> with(const std::string& edge, std::vector<std::string> more) const {
        std::vector<std::string> all = {"propose",          file,  "--drawing",  drawing, "--edge",  edge,
                                        "--step-mm",        "120", "--chord-mm", "0.1",   "--spots", "8..12",
                                        "--three-sigma-mm", "0.4"};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    void refused(const std::vector<std::string>& arguments, const std::string& part,
                 int exit_code = 2) const {
        const std::string before = *read_text_file(file);
        const ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(*read_text_file(file), before) << "nothing half-written: " << part;
    }
    Project project() const { return ProjectFile::open(file, FileAccess::read_only)->load().value(); }

    std::filesystem::path folder = test_folder("propose");
    std::string file = folder / "door $1.seam", drawing = folder / "door.step";
};

TEST_F(ProposeCommand, TakesWritesTheProgramAndGoesOutAgain) {
    const auto before = project();
    for (const auto& [side, edge] : edges()) {
        const ProgramResult r =
            run_program(with(edge, {"--take", "--new-region", "drawn " + side, "--json", "-"}), folder);
        ASSERT_EQ(r.exit_code, 0) << side << r.err;
        const json answer = json::parse(r.out, nullptr, false);
        EXPECT_EQ(answer["taken"]["region"], "drawn " + side);
        EXPECT_EQ(answer["taken"]["spots"].size(), answer["spots"].size());
    }
    const Project after = project();
    EXPECT_EQ(after.regions.size(), before.regions.size() + 4);
    EXPECT_GE(after.spots.size(), before.spots.size() + 4 * 8);
    const ProgramResult info = run_program({"info", file, "--json", "-"}, folder);
    EXPECT_EQ(json::parse(info.out)["unconfirmed_spots"].size(), after.spots.size() - before.spots.size());
    const ProgramResult words = run_program({"info", file}, folder);
    EXPECT_THAT(words.out,
                HasSubstr("from the drawing, not confirmed (door.step, edge " + edges().at("top")));
    for (const char* brand : {"kuka", "abb", "ur"}) {
        const ProgramResult program =
            run_program({"robot-program", file, "--brand", brand, "--out", folder / brand}, folder);
        EXPECT_EQ(program.exit_code, 0) << brand << ": " << program.err;
    }
    refused(with(edges().at("top"), {"--take", "--new-region", "drawn top"}),
            "there is a region \"drawn top\"");
    const ProgramResult undo = run_program({"propose", file, "--undo", "--json", "-"}, folder);
    EXPECT_EQ(undo.exit_code, 0) << undo.err;
    EXPECT_EQ(project().spots.size(), before.spots.size());
    EXPECT_EQ(project().regions.size(), before.regions.size());
    refused({"propose", file, "--undo"}, "no spot from the drawing");
}

TEST_F(ProposeCommand, ConfirmsOnTheSimulatedPart) {
    const ProgramResult taken =
        run_program(with(edges().at("top"), {"--take", "--new-region", "drawn"}), folder);
    ASSERT_EQ(taken.exit_code, 0) << taken.err;
    const ProgramResult dry = run_program(
        {"confirm", file, "--region", "drawn", "--repeats", "2", "--dry-run", "--json", "-"}, folder);
    ASSERT_EQ(dry.exit_code, 0) << dry.err << dry.out;
    EXPECT_EQ(json::parse(dry.out)["taken"], false);
    EXPECT_THAT(run_program({"info", file}, folder).out, HasSubstr(" not confirmed\n0 runs"));
    const ProgramResult done = run_program({"confirm", file, "--repeats", "2", "--json", "-"}, folder);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    const json answer = json::parse(done.out);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["regions"][0]["judged"], true);
    for (const json& s : answer["spots"]) {
        EXPECT_EQ(s["finding"], "ok");
        EXPECT_LT(std::abs(s["shift_mm"]["x"].get<double>()), 0.5);
        EXPECT_GT(s["sigma_mm"]["x"].get<double>(), 0);
    }
    for (const Spot& spot : project().spots) EXPECT_EQ(spot.reference_state, ReferenceState::measured);
    refused({"confirm", file}, "no spot from the drawing");
}

TEST_F(ProposeCommand, BadArgumentsAreOneSentence) {
    refused(with("e99999", {"--take"}), "e99999");
    refused(with(edges().at("top"), {"--take", "--region", "nowhere"}), "there is no region \"nowhere\"");
    refused(with(edges().at("top"), {"--take", "--region", "all", "--new-region", "b"}), "keeps its name");
    refused(with(edges().at("top"), {"--take", "--frame", "PATH"}), "frame PATH is written");
    refused(with(edges().at("top"), {"--new-region", "b"}), "--take");
    refused({"propose", file, "--drawing", folder / "none.step", "--edge", "e1"}, "none.step", 3);
    refused({"propose", file, "--drawing", drawing}, "no edge is named");
    refused({"confirm", file, "--spot", "nobody"}, "there is no spot \"nobody\"");
    refused({"confirm", file, "--region", "nowhere"}, "there is no region \"nowhere\"");
    refused({"confirm", file, "--all", "--spot", "T1"}, "some of them");
    refused({"confirm", file, "--spot", "T1"}, "it is not from the drawing");
    refused({"confirm", file, "--shift-limit-mm", "nan"}, "the limit of the shift");
}

}  // namespace
}  // namespace seamwright
