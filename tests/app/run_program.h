#pragma once
// Runs the built `seamwright` as somebody's script would: arguments in, exit code and both streams out.

#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace seamwright {

struct ProgramResult {
    int exit_code = -1;  // -1: ended by a signal
    std::string out, err;
};

inline std::string slurp(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline std::filesystem::path test_folder(const std::string& name) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("seamwright_" + name + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

inline ProgramResult run_program(const std::vector<std::string>& arguments,
                                 const std::filesystem::path& folder,
                                 const std::filesystem::path& program = SEAMWRIGHT_PROGRAM) {
    std::string command = "'" + program.string() + "'";
    for (const std::string& a : arguments) {
        command += " '";
        for (char c : a) c == '\'' ? command += "'\\''" : command += c;
        command += "'";
    }
    const auto out = folder / "stdout.txt", err = folder / "stderr.txt";
    command += " >'" + out.string() + "' 2>'" + err.string() + "' </dev/null";
    const int status = std::system(command.c_str());
    ProgramResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.out = slurp(out);
    result.err = slurp(err);
    return result;
}

}  // namespace seamwright
