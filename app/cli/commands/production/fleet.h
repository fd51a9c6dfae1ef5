#pragma once
// How commands ask for a fleet's database.

#include <CLI/CLI.hpp>
#include <string>

namespace seamwright::cli {

// `help` empty: the usual one.
CLI::Option* add_fleet_option(CLI::App* command, const std::string& name, std::string& url,
                              const std::string& help = {});

}  // namespace seamwright::cli
