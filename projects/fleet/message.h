#pragma once
// What a station publishes of a run: one JSON object, which is everything that the fleet's database takes of it.

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "projects/file/project_file.h"
#include "projects/statistics/production.h"

namespace seamwright {

// What of a project goes along: limits, places, path points, names; no settings of devices, which may hold passwords, and
// no profiles.
struct FleetSetup {
    Project project;
    std::map<std::string, std::vector<PathDirection>> path_points;
};
FleetSetup fleet_setup(const Project& project);
std::string to_text(const FleetSetup& setup);
Expected<FleetSetup> fleet_setup_from(const std::string& text, const std::string& where);

// Makes the messages of one file's runs.
class FleetMessages {
  public:
    static Expected<FleetMessages> of(const ProjectFile& file);

    // As kept in the outbox, or made of the stored run. nullopt: the run is gone, and there is nothing to publish.
    Expected<std::optional<std::string>> message(const ProjectFile& file, const QueuedRun& run) const;
    const std::string& setup() const { return setup_; }
    const std::string& project_name() const { return name_; }

  private:
    explicit FleetMessages(RunPurposes purposes) : purposes_(std::move(purposes)) {}
    RunPurposes purposes_;
    std::map<std::string, std::vector<PathDirection>> path_points_;
    std::string setup_, name_;
};

// Error (usage): empty, longer than kLongestId bytes, no UTF-8, a control character.
Expected<void> check_station_name(const std::string& name);

}  // namespace seamwright
