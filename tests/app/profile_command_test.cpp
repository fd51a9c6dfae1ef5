// filter and feature: profiles as tables.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Cli = CliCase;

std::string step_profile() {
    std::string csv = "x_mm,z_mm\n";
    for (int i = 0; i < 300; ++i) {
        const double x = 0.1 * i;
        csv += std::to_string(x) + "," +
               (i == 150 ? ""
                         : std::to_string(i == 80  ? 9.0
                                          : x < 20 ? 1.0
                                                   : -2.0)) +
               "\n";
    }
    return csv;
}

// The same in a field that is wider than the sheets.
std::string step_in_a_wide_field() {
    std::string csv = step_profile();
    std::string before, after;
    for (int i = 1; i <= 20; ++i) {
        before = std::to_string(-0.1 * i) + ",\n" + before;
        after += std::to_string(29.9 + 0.1 * i) + ",\n";
    }
    csv.insert(csv.find('\n') + 1, before);
    return csv + after;
}

TEST_F(Cli, FilterMarksEveryPointAndLosesNone) {
    const std::string out = (folder / "out.csv").string();
    const json a = answer({"filter", write("in.csv", step_profile()), "--out", out}, 0);
    EXPECT_EQ(a["points"], 300);
    EXPECT_EQ(a["outliers"], 1);
    EXPECT_EQ(a["no_return"], 1);
    EXPECT_EQ(a["segments"], 2);
    const std::string text = slurp(out);
    EXPECT_THAT(text, HasSubstr("valid"));
    EXPECT_THAT(text, HasSubstr("segment"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 301);
}

TEST_F(Cli, FeatureFindsTheContourEndOnEitherSide) {
    const std::string in = write("in.csv", step_in_a_wide_field());
    const json left =
        answer({"feature", in, "--kind", "contour-end", "--side", "left", "--segment", "outermost"}, 0);
    const json right =
        answer({"feature", in, "--kind", "contour-end", "--side", "right", "--segment", "outermost"}, 0);
    // Both sheets end to the right: nothing is chosen unasked.
    const json two = answer({"feature", in, "--kind", "contour-end", "--side", "right"}, 1);
    EXPECT_EQ(two["status"], "ambiguous");
    ASSERT_EQ(two["rivals_mm"].size(), 2u);
    // Seen to the rim of the field, no end is seen.
    const json cut = answer({"feature", write("cut.csv", "x_mm,z_mm\n-2.1,\n" + step_profile().substr(10)),
                             "--kind", "contour-end", "--side", "left", "--segment", "outermost"},
                            1);
    EXPECT_EQ(cut["status"], "not_found");
    EXPECT_EQ(left["status"], "ok");
    EXPECT_NEAR(left["point"][0].get<double>(), 0.0, 0.1);
    EXPECT_NEAR(right["point"][0].get<double>(), 29.9, 0.1);
    EXPECT_EQ(left["covariance"].size(), 2u);
    expect_refused({"feature", in, "--kind", "contour-end", "--side", "upwards"}, "left");
}

TEST_F(Cli, HostileProfilesAreRefused) {
    const std::string out = (folder / "out.csv").string();
    expect_refused({"filter", write("a.csv", ""), "--out", out}, "a.csv");
    expect_refused({"filter", write("a.csv", "a,b\n1,2\n"), "--out", out}, "x_mm");
    expect_refused({"filter", write("a.csv", "x_mm,z_mm\n1,2\n3;4\n"), "--out", out}, "3");
    expect_refused({"filter", write("a.csv", "x_mm,z_mm\n1,2\nfoo,4\n"), "--out", out}, "foo");
    EXPECT_FALSE(std::filesystem::exists(out)) << "nothing may be half-written";
}

std::string in_unit(double mm_each, const std::string& csv) {
    std::istringstream in(csv);
    std::string line, out;
    std::getline(in, line);
    out = line + "\n";
    while (std::getline(in, line)) {
        const auto comma = line.find(',');
        out += std::to_string(std::stod(line.substr(0, comma)) / mm_each) + ",";
        if (comma + 1 < line.size()) out += std::to_string(std::stod(line.substr(comma + 1)) / mm_each);
        out += "\n";
    }
    return out;
}

TEST_F(Cli, ProfilesInAnotherUnitAreSuspectedUnlessTheUnitIsSaid) {
    const std::string out = (folder / "out.csv").string(), mm = write("mm.csv", step_profile());
    for (const auto& [unit, mm_each, word] :
         {std::tuple{"m", 1000.0, "looks like metres"}, std::tuple{"um", 1e-3, "looks like micrometres"}}) {
        const std::string in = write("in.csv", in_unit(mm_each, step_in_a_wide_field()));
        for (const std::vector<std::string>& command : {std::vector<std::string>{"filter", in, "--out", out},
                                                        {"feature", in, "--kind", "contour-end"},
                                                        {"match", "--template", in, "--scene", in}}) {
            expect_refused(command, word);
            expect_refused(command, "--unit");
        }
        const json left = answer({"feature", in, "--unit", unit, "--kind", "contour-end", "--side", "right",
                                  "--segment", "outermost"},
                                 0);
        EXPECT_NEAR(left["point"][0].get<double>(), 29.9, 0.1) << unit;
        EXPECT_EQ(answer({"filter", in, "--unit", unit, "--out", out}, 0)["segments"], 2) << unit;
    }
    EXPECT_FALSE(
        answer({"filter", write("in.csv", in_unit(1000, step_profile())), "--unit", "mm", "--out", out}, 0)
            .empty())
        << "whoever says so means it";
    const ProgramResult inch = run({"filter", mm, "--unit", "inch", "--out", out});
    EXPECT_EQ(inch.exit_code, 2);
    EXPECT_THAT(inch.err, HasSubstr("--unit"));
}

// One profile of a pass that lost its stripe, in millimetres and in another unit.
TEST_F(Cli, AnUnitIsJudgedByThePassAndNotByOneOfItsProfiles) {
    const auto pass = [](double mm_each, int lost) {
        std::string csv = "travel_mm,profile_index,x_mm,z_mm\n";
        unsigned state = 7;
        const auto any = [&] {
            state = state * 1664525U + 1013904223U;
            return static_cast<double>(state >> 8) / (1 << 24) - 0.5;
        };
        for (int k = 0; k < 61; ++k)
            for (int i = 0; i < 600; ++i) {
                const double x = 0.1 * i - 30, z = k == lost ? 40 * any() : (x < 0 ? 1 : -2) + 0.03 * any();
                csv += std::to_string((k - 30) / mm_each) + "," + std::to_string(k) + "," +
                       std::to_string(x / mm_each) + "," + std::to_string(z / mm_each) + "\n";
            }
        return csv;
    };
    for (const int lost : {0, 30, 60}) {
        const json a = answer({"align", write("pass.csv", pass(1, lost))}, 0);
        EXPECT_EQ(a["status"], "frozen") << lost;
    }
    expect_refused({"align", write("pass.csv", pass(1000, 0))}, "looks like metres");
    expect_refused({"align", write("pass.csv", pass(1e-3, 0))}, "looks like micrometres");
}

}  // namespace
}  // namespace seamwright
