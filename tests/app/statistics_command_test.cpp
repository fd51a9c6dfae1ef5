// `seamwright statistics` and `seamwright service`: the contract from the outside.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

class StatisticsCommand : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("statistics"), file = folder / "door $1 100%.seam";

    void SetUp() override {
        const Project project = production_project();
        auto made = ProjectFile::create(file, project);
        ASSERT_TRUE(made);
        for (int i = 0; i < 15; ++i)
            ASSERT_TRUE(made->append_run(production_run(i, {0.1 * (i % 4), 0.2 * (i % 3), 0}), project));
        ASSERT_TRUE(made->append_run(refused_run(20, "no calibration"), project));
    }
    ~StatisticsCommand() override { std::filesystem::remove_all(folder); }
    void refused(std::vector<std::string> arguments, const std::string& part, int exit_code = 2) const {
        const ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(r.out, "");
    }
};

TEST_F(StatisticsCommand, WritesEveryKindOfFile) {
    const ProgramResult r = run_program(
        {"statistics", file.string(), "--html", folder / "a.html", "--pdf", folder / "a.pdf", "--xlsx",
         folder / "a.xlsx", "--dfq", folder / "a.dfq", "--language", "de", "--json", "-"},
        folder);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json answer = json::parse(r.out, nullptr, false);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["runs"], 16);
    EXPECT_EQ(answer["by_status"]["refused"], 1);
    EXPECT_EQ(answer["regions"][0]["refusals"][0]["pattern"], "no calibration");
    EXPECT_THAT(slurp(folder / "a.html"), HasSubstr("Produktionsstatistik: door"));
    EXPECT_THAT(slurp(folder / "a.pdf"), StartsWith("%PDF"));
    EXPECT_THAT(slurp(folder / "a.xlsx"), StartsWith("PK"));
    EXPECT_THAT(slurp(folder / "a.dfq"), StartsWith("K0100 5"));
    const ProgramResult words = run_program({"statistics", file.string()}, folder);
    EXPECT_THAT(words.out, HasSubstr("Cycle time"));
}

TEST_F(StatisticsCommand, BadInputIsOneSentence) {
    refused({"statistics", file.string(), "--since", "yesterday"}, "is no time");
    refused({"statistics", file.string(), "--since", "2024-06-01", "--until", "2024-05-01"},
            "not after the beginning");
    refused({"statistics", file.string(), "--region", "no"}, "there are: edge");
    refused({"statistics", file.string(), "--subgroup", "0"}, "give 1 to 25");
    refused({"statistics", file.string(), "--tolerance-mm", "nan"}, "tolerance");
    refused({"statistics", file.string(), file.string()}, "given twice");
    refused({"statistics", folder / "none.seam"}, "none.seam", 3);
    refused({"statistics"}, "no file is given");
    refused({"statistics", file.string(), "--xlsx", "/nowhere/a.xlsx"}, "cannot be written", 3);
    // Nothing in this time: said, and no file that is read for an answer.
    const ProgramResult none =
        run_program({"statistics", file.string(), "--since", "2030-01-01", "--json", "-"}, folder);
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_EQ(json::parse(none.out, nullptr, false)["status"], "no_production");
}

TEST_F(StatisticsCommand, ADamagedFileIsRefused) {
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    refused({"statistics", file.string()}, "is damaged", 3);
}

TEST_F(StatisticsCommand, OptionsOfTheWatchNeedIt) {
    refused({"run", file.string(), "--status", "127.0.0.1:0"}, "--watch");
    refused({"run", file.string(), "--watch", "--report-every", "8h"}, "--to");
    refused({"run", file.string(), "--watch", "--status-token", "x"}, "--status");
}

// systemd's own reader says whether it is a unit, where it is installed.
TEST_F(StatisticsCommand, AServiceIsAUnitOfSystemd) {
    const auto unit = folder / "door.service";
    const ProgramResult r =
        run_program({"service", file.string(), "--push", "--user", "root", "--status", "127.0.0.1:8080",
                     "--report-every", "8h", "--to", folder / "reports", "--fleet",
                     "postgresql://seam@db/fleet", "--station", "line 2", "--out", unit.string()},
                    folder);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const std::string text = slurp(unit);
    EXPECT_THAT(text, HasSubstr("Type=notify\n"));
    EXPECT_THAT(text, HasSubstr("door $$1 100%%.seam\" \"--watch\" \"--push\""));
    EXPECT_THAT(text, HasSubstr("WatchdogSec="));
    EXPECT_THAT(text, HasSubstr("\"--fleet\" \"postgresql://seam@db/fleet\" \"--station\" \"line 2\""));
    if (std::filesystem::exists("/usr/bin/systemd-analyze")) {
        const std::string verify = "systemd-analyze verify --man=no '" + unit.string() + "' >'" +
                                   (folder / "said").string() + "' 2>&1";
        EXPECT_EQ(std::system(verify.c_str()), 0) << slurp(folder / "said");
    }
    refused({"service", folder / "none.seam"}, "none.seam", 3);
    refused({"service", file.string(), "--fleet", "postgresql://seam:secret@db/fleet"},
            "no place for a password");
    refused({"service", file.string(), "--user", "a b\nExecStart=x"}, "no user's name");
}

}  // namespace
}  // namespace seamwright
