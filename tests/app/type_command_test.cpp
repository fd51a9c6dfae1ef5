// `seamwright type`, and what run, robot-program and statistics make of a part's type, on the simulated door.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "projects/file/project_json.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class TypeCommand : public testing::Test {
  protected:
    fs::path folder = test_folder("type_command"), file = folder / "door.seam";

    void SetUp() override {
        json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings).value();
        settings["robot"]["frames"]["path"] = pose_json(cell->base_from_workobject());
        Project project = door_project(*cell, settings);
        ASSERT_TRUE(ProjectFile::create(file, project));
        ASSERT_NE(run({"run", file.string()}).exit_code, 3);
        auto opened = ProjectFile::open(file).value();
        const RunRecord first = opened.load_run(1).value();
        for (std::size_t i = 0; i < first.spots.size(); ++i) {
            project.spots[i].enabled = first.spots[i].status == SpotStatus::measured;
            project.spots[i].reference_mm = first.spots[i].measured_mm;
            project.spots[i].reference_profile.x_mm = {0, 1};
            project.spots[i].reference_profile.z_mm = {0, 1};
        }
        ASSERT_TRUE(opened.save(project));
    }
    ~TypeCommand() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder);
    }
    json said(std::vector<std::string> arguments, int exit_code = 0) const {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    void refused(const std::vector<std::string>& arguments, const char* why) const {
        const auto before = ProjectFile::open(file, FileAccess::read_only)->load().value();
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2) << r.err << r.out;
        EXPECT_THAT(r.err, HasSubstr(why));
        const auto after = ProjectFile::open(file, FileAccess::read_only)->load().value();
        EXPECT_EQ(to_json_document(after), to_json_document(before)) << "nothing half-written";
    }
};

TEST_F(TypeCommand, FromOneKindOfPartToTwoAndBack) {
    const std::string f = file.string();
    EXPECT_TRUE(said({"type", "list", f})["types"].empty());
    refused({"run", f, "--type", "left"}, "has no part types");
    said({"type", "add", f, "left", "--name", "door left", "--number", "1"});
    const json both = said({"type", "clone", f, "left", "right", "--number", "2"});
    ASSERT_EQ(both["types"].size(), 2u);
    EXPECT_TRUE(both["types"][0]["untaught_spots"].empty()) << both.dump();
    EXPECT_EQ(both["types"][1]["untaught_spots"].size(), both["types"][1]["spots"].get<std::size_t>());

    refused({"run", f, "--push"}, "no part type was said");
    refused({"run", f, "--push", "--type", "3"}, "part type \"3\" is not in the project");
    refused({"type", "add", f, "left"}, "two part types are called \"left\"");
    refused({"type", "add", f, "77"}, "no id of a part type");
    refused({"type", "add", f, "van", "--number", "1"}, "its number 1 is that of left too");
    refused({"type", "clone", f, "van", "bus"}, "no part type \"van\"");
    refused({"type", "remove", f, "right"}, "--with-spots");

    const json left = said({"run", f, "--part", "CAR-1", "--push", "--type", "1"});
    EXPECT_EQ(left["type"], "left");
    EXPECT_EQ(left["release"]["R1"], "taken");
    EXPECT_EQ(left["spots"].size(), both["types"][0]["spots"].get<std::size_t>());
    // A cloned reference never passes the gate silently.
    const json right = said({"run", f, "--push", "--type", "right"}, 1);
    EXPECT_THAT(right["message"].get<std::string>(), HasSubstr("another part type's"));
    EXPECT_EQ(right["regions"][0]["push"]["status"], "not_pushed");

    const json info = said({"info", f});
    EXPECT_EQ(info["part_types"], 2);
    EXPECT_FALSE(info["runs"][0].contains("type")) << "a run of before";
    EXPECT_EQ(info["runs"][1]["type"], "left");
    EXPECT_EQ(info["runs"][2]["type"], "right");
    EXPECT_EQ(said({"statistics", f, "--type", "left"})["runs"], 1);
    EXPECT_EQ(said({"statistics", f})["runs"], 3);
    EXPECT_EQ(said({"statistics", f, "--type", "wagon"}, 1)["runs"], 0);

    const json differences = said({"type", "compare", f, "left", "right"})["differences"];
    EXPECT_FALSE(differences.empty());
    for (const json& d : differences) EXPECT_EQ(d["field"], "reference_state");

    EXPECT_EQ(run({"robot-program", f, "--brand", "kuka", "--out", (folder / "krc").string()}).exit_code, 2);
    // One controller holds one of them: who writes the second is told.
    for (const auto& [type, other] : {std::pair("right", "left"), std::pair("left", "right")})
        EXPECT_EQ(
            said({"robot-program", f, "--brand", "kuka", "--type", type, "--out", (folder / type).string()})
                .value("same_files_as", json()),
            json::array({other}));
    said({"type", "remove", f, "right", "--with-spots"});
    EXPECT_FALSE(
        said({"robot-program", f, "--brand", "kuka", "--type", "left", "--out", (folder / "krc").string()})
            .contains("same_files_as"));
    said({"type", "remove", f, "left"});
    EXPECT_EQ(said({"run", f, "--push"})["status"], "ok");
    EXPECT_EQ(run({"check", f}).exit_code, 0);
}

TEST_F(TypeCommand, AnExportedProjectWithTypesComesBack) {
    const std::string f = file.string(), out = (folder / "door.json").string(),
                      again = (folder / "b.seam").string();
    said({"type", "add", f, "left", "--number", "1"});
    said({"type", "clone", f, "left", "right"});
    said({"export", f, "--out", out, "--with-taught"});
    said({"import", again, "--from", out});
    EXPECT_EQ(said({"type", "list", again})["types"], said({"type", "list", f})["types"]);
}

}  // namespace
}  // namespace seamwright
