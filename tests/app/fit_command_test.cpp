// `seamwright fit` as a script calls it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class FitCommand : public testing::Test {
  protected:
    FitCommand() : folder_(test_folder("fit_command")) {}
    ~FitCommand() override { fs::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return (folder_ / name).string();
    }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }
    ProgramResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "fit");
        return run_program(arguments, folder_);
    }
    // A block of 200 x 120 x 80 mm and points on all of its faces, moved by `shift`.
    std::string block() const {
        std::string obj;
        for (const char* v :
             {"0 0 0", "200 0 0", "200 120 0", "0 120 0", "0 0 80", "200 0 80", "200 120 80", "0 120 80"})
            obj += std::string("v ") + v + "\n";
        obj += "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
        return write("block.obj", obj);
    }
    std::string scan(double shift) const {
        std::string csv = "x_mm,y_mm,z_mm\n";
        const auto add = [&](double x, double y, double z) {
            const double wave =
                0.02 * (static_cast<double>((static_cast<int>(x * 7 + y * 13 + z * 17)) % 5) - 2);
            csv += std::to_string(x + shift + wave) + "," + std::to_string(y + wave) + "," +
                   std::to_string(z - wave) + "\n";
        };
        for (double a = 3; a < 200; a += 5)
            for (double b = 3; b < 120; b += 5) add(a, b, 0), add(a, b, 80);
        for (double a = 3; a < 200; a += 5)
            for (double c = 3; c < 80; c += 5) add(a, 0, c), add(a, 120, c);
        for (double b = 3; b < 120; b += 5)
            for (double c = 3; c < 80; c += 5) add(0, b, c), add(200, b, c);
        return write("scan.csv", csv);
    }
    fs::path folder_;
};

TEST_F(FitCommand, ABlockIsRefusedWithoutAStartAndFoundWithOne) {
    const std::string mesh = block(), cloud = scan(7);
    const ProgramResult anywhere = run({"--cloud", cloud, "--mesh", mesh, "--json", "-"});
    EXPECT_EQ(anywhere.exit_code, 1) << anywhere.err;
    EXPECT_EQ(json::parse(anywhere.out)["status"], "ambiguous");

    const ProgramResult found =
        run({"--cloud", cloud, "--mesh", mesh, "--start", R"({"xyz":[0,0,0],"abc":[0,0,0]})", "--report",
             at("fit.html"), "--map", at("map.svg"), "--json", "-"});
    ASSERT_EQ(found.exit_code, 0) << found.err << found.out;
    const json answer = json::parse(found.out);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_NEAR(answer["base_from_workobject"]["xyz"][0].get<double>(), 7, 0.05);
    EXPECT_EQ(answer["covariance"].size(), 6U);
    EXPECT_EQ(answer["sigma"]["xyz_mm"].size(), 3U);
    EXPECT_GT(answer["share_seen"].get<double>(), 0.8);
    EXPECT_TRUE(answer["unobservable"].empty());
    EXPECT_FALSE(answer["deviation"]["histogram"].empty());
    EXPECT_NE(slurp(at("fit.html")).find("<svg"), std::string::npos);
    EXPECT_EQ(slurp(at("map.svg")).rfind("<svg", 0), 0U);
}

TEST_F(FitCommand, BadInputIsOneSentenceAndNothingIsWritten) {
    const std::string mesh = block(), cloud = scan(0), empty = write("empty.csv", ""),
                      pairs = write("pairs.json", R"({"pairs":[{"part":[0,0,0],"base":"here"}]})");
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{},
          {"--cloud", cloud},
          {"--cloud", empty, "--mesh", mesh},
          {"--cloud", cloud, "--mesh", mesh, "--pairs", pairs},
          {"--cloud", cloud, "--mesh", mesh, "--to", "moon"},
          {"--cloud", cloud, "--mesh", mesh, "--take"},
          {"--cloud", cloud, "--mesh", mesh, "--start", "{\"xyz\":[1]}"}}) {
        auto with_report = arguments;
        with_report.insert(with_report.end(), {"--report", at("never.html")});
        const ProgramResult result = run(with_report);
        EXPECT_EQ(result.exit_code, 2) << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_FALSE(fs::exists(at("never.html")));
    }
    EXPECT_EQ(run({"--cloud", at("none.ply"), "--mesh", mesh}).exit_code, 3);
}

}  // namespace
}  // namespace seamwright
