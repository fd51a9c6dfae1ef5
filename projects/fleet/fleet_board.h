#pragma once
// What all stations of a fleet do: counts, last parts, and who has been silent. Once, or asked again and again by a thread of its
// own for a page that many look at.

#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "projects/fleet/target.h"

namespace seamwright {

struct FleetPart {
    std::string station, utc, part, type, status, message;
    std::int64_t run = 0;
    double seconds = 0;  // 0: not known
};
struct FleetStation {
    std::string name, published_utc;   // as utc_now() writes it; empty: never
    std::int64_t runs = 0, parts = 0;  // all, and those of production
    std::int64_t ok = 0, refused = 0;  // of production
    std::optional<FleetPart> last;     // its newest run
};
struct FleetStanding {
    std::vector<FleetStation> stations;  // by name
    std::vector<FleetPart> parts;        // of all stations, newest first
};
// Error (device): the database.
Expected<FleetStanding> fleet_standing(const FleetTarget& target, int newest_parts);

struct FleetView {
    std::string fleet, program, now_utc;
    std::string asked_utc;  // when the standing was true; empty: not yet
    Text trouble;           // why it is older than that; empty: it is not
    FleetStanding standing;
};
nlohmann::json fleet_json(const FleetView& view);  // stations and trouble
nlohmann::json fleet_parts_json(const FleetView& view);
std::string fleet_metrics(const FleetView& view);  // Prometheus
std::string fleet_page(const FleetView& view, Language language);

class FleetBoard {
  public:
    FleetBoard(FleetTarget target, std::string program, std::chrono::milliseconds every);
    FleetView view() const;

  private:
    void ask(const std::stop_token& stop);
    FleetTarget target_;
    std::chrono::milliseconds every_;
    mutable std::mutex mutex_;
    FleetView view_;
    std::jthread thread_;  // the last: it ends before the rest goes
};

}  // namespace seamwright
