// The demo over many seeds: none fails, and the bead comes within a tenth in every region. With and without cables.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;

TEST(DemoSeeds, EveryOneEndsWithTenGoodPartsOrAReason) {
    const char* wanted = std::getenv("SEAMWRIGHT_SEEDS");  // "1..300"
    const auto folder = test_folder("demo_seeds");
    const ProgramResult r = run_program(
        {"demo", "--dir", (folder / "out").string(), "--seeds", wanted ? wanted : "1..30", "--json", "-"},
        folder);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json sweep = json::parse(r.out);
    int whole = 0;
    for (const json& row : sweep["seeds"]) {
        whole += row["outcome"] == "ok" && row["pushed"] == 10;
        if (row["outcome"] != "ok") {
            EXPECT_NE(row["reason"], "") << row;
        }
    }
    EXPECT_GE(whole, 9 * static_cast<int>(sweep["seeds"].size()) / 10);
    for (const json& region : sweep["pooled"])
        EXPECT_LT(region["after_three_sigma_mm"].get<double>(), 0.1) << region;
    std::filesystem::remove_all(folder);
}

// The same cell with and without the cables to camera and controller: within what the demo's own noise does.
TEST(DemoSeeds, TheCablesChangeNothing) {
    const auto folder = test_folder("demo_cables");
    const auto bead = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {"demo",   "--dir", (folder / "out").string(), "--parts", "3",
                                          "--json", "-"};
        words.insert(words.end(), more.begin(), more.end());
        const ProgramResult r = run_program(words, folder);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return json::parse(r.out)["path"].back();
    };
    const json served = bead({}), direct = bead({"--in-process"});
    EXPECT_NEAR(direct["after_three_sigma_mm"], served["after_three_sigma_mm"], 0.05);
    EXPECT_NEAR(direct["after_mean_mm"], served["after_mean_mm"], 0.02);
    EXPECT_NEAR(direct["before_max_mm"], served["before_max_mm"], 0.01) << "the same parts";
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace seamwright
