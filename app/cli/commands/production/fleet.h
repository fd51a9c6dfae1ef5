#pragma once
// How commands ask for a fleet's database.

#include <CLI/CLI.hpp>
#include <string>

#include "projects/file/project_file.h"
#include "projects/fleet/target.h"

namespace seamwright::cli {

// `help` empty: the usual one.
CLI::Option* add_fleet_option(CLI::App* command, const std::string& name, std::string& url,
                              const std::string& help = {});

// For commands that have a project: without a URL the fleet that it names (`fleet set`).
CLI::Option* add_project_fleet_option(CLI::App* command, std::string& url, const std::string& help);
// Where to, and as which station: what is given goes before the project's. Error (usage): neither names a fleet, or the
// station's name.
struct FleetAddress {
    FleetTarget target;
    std::string station;  // empty: the project's name
};
Expected<FleetAddress> fleet_address(const ProjectFile& file, const std::string& url,
                                     const std::string& station);

}  // namespace seamwright::cli
