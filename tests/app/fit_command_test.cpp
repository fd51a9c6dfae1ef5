// `seamwright fit` as a script calls it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// A sheet of 400 x 120 mm whose one side is waved, and its scan from profiles across that side, moved by `shift` along Y.
double waved(double x) {
    return 100 + 12 * std::sin(x / 45) + 6 * std::cos(x / 110);
}
double humped(double x) {
    return 10 * std::sin(x / 70);
}

TEST_F(FitCommand, ASheetIsFoundByItsWavedSide) {
    std::string obj, csv = "x_mm,y_mm,z_mm\n";
    int n = 0;
    for (double x = 0; x < 400; x += 4, n += 4) {
        for (const double at : {x, x + 4})
            for (const double y : {0.0, waved(at)})
                obj += "v " + std::to_string(at) + " " + std::to_string(y) + " " +
                       std::to_string(humped(at)) + "\n";
        const auto v = [&](int k) { return " " + std::to_string(n + k); };
        obj += "f" + v(1) + v(3) + v(4) + "\nf" + v(1) + v(4) + v(2) + "\n";
    }
    unsigned noise = 1;
    for (double x = 1; x < 399; x += 2)
        for (double y = 40.03 + 0.017 * x; y < waved(x); y += 0.25) {
            noise = noise * 1664525U + 1013904223U;
            csv += std::to_string(x) + "," + std::to_string(y + 5) + "," +
                   std::to_string(humped(x) + 0.02 * (static_cast<double>(noise >> 16) / 32768 - 1)) + "\n";
        }
    const std::string mesh = write("sheet.obj", obj), cloud = write("sheet.csv", csv);
    const ProgramResult listed = run_program({"drawing", mesh, "--json", "-"}, folder_);
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    std::string side;
    double longest = 0;
    const json drawing = json::parse(listed.out);
    for (const json& edge : drawing["edges"])
        if (edge["length_mm"].get<double>() > longest)
            longest = edge["length_mm"].get<double>(), side = edge["id"].get<std::string>();
    const std::vector<std::string> with = {
        "--cloud", cloud,    "--mesh", mesh,      "--to",
        "edge",    "--edge", side,     "--start", R"({"xyz":[0,0,0],"abc":[0,0,0]})"};
    auto found_with = with;
    found_with.insert(found_with.end(), {"--report", at("edge.html"), "--json", "-"});
    const ProgramResult found = run(found_with);
    ASSERT_EQ(found.exit_code, 0) << found.err << found.out;
    const json answer = json::parse(found.out);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["edges"], json::array({side}));
    EXPECT_NEAR(answer["base_from_workobject"]["xyz"][1].get<double>(), 5, 0.3);
    EXPECT_EQ(answer["covariance"].size(), 6U);
    EXPECT_FALSE(answer["deviation"]["histogram"].empty());
    EXPECT_NE(slurp(at("edge.html")).find("<svg"), std::string::npos);

    auto nowhere = with;
    nowhere[7] = "e9999";
    EXPECT_EQ(run(nowhere).exit_code, 2);
    EXPECT_EQ(run({"--cloud", cloud, "--mesh", mesh, "--to", "edge"}).exit_code, 2);
    EXPECT_EQ(run({"--cloud", cloud, "--mesh", mesh, "--to", "edge", "--edge", side}).exit_code, 2)
        << "an edge alone is found from a start only";
    EXPECT_EQ(run({"--cloud", cloud, "--mesh", mesh, "--edge", side}).exit_code, 2);
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
