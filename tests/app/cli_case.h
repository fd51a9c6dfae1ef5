#pragma once
// A folder, and the program run in it: what tests of the command line begin with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {

class CliCase : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("cli");
    ~CliCase() override { std::filesystem::remove_all(folder); }

    std::string write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary) << text;
        return (folder / name).string();
    }
    ProgramResult run(const std::vector<std::string>& arguments) { return run_program(arguments, folder); }
    // Runs with --json - and parses the answer; the exit code is checked.
    nlohmann::json answer(std::vector<std::string> arguments, int exit_code) {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return nlohmann::json::parse(r.out, nullptr, false);
    }
    // Bad input: exit 2, exactly one line on stderr, nothing on stdout.
    void expect_refused(const std::vector<std::string>& arguments, const std::string& sentence_part,
                        int exit_code = 2) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        EXPECT_THAT(r.err, testing::HasSubstr(sentence_part));
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(r.out, "");
    }
};

}  // namespace seamwright
