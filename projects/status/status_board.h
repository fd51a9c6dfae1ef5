#pragma once
// What the status page shows: a watching told event by event, and read from another thread.

#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "projects/station/watch.h"

namespace seamwright {

struct StatusRegion {
    std::string id;
    bool passed = false;
    // Displacement and its standard deviation, work object; absent where nothing was solved.
    std::optional<Eigen::Vector3d> xyz_mm, sigma_mm;
    std::string refusal;  // the first
};
struct StatusPart {
    std::string utc, part, status, text;
    std::int64_t run = 0;
    double seconds = 0;
    std::vector<StatusRegion> regions;
};
struct StatusAlarm {
    std::string utc, level, text;
};

// Everything at one instant.
struct StatusView {
    std::string project, program, started_utc, now_utc;
    bool push = false;
    std::string state, text;  // the last event's
    std::string event_utc;
    WatchCounts counts;
    int spots_done = 0, spots = 0;  // of the part that is measured now
    std::string part;
    std::deque<StatusPart> parts;    // newest last, at most kStatusParts
    std::deque<StatusAlarm> alarms;  // warnings and alarms, newest last, at most kStatusAlarms
    double measuring_seconds = 0;    // of all runs together
    std::map<std::string, std::int64_t> runs_by_status;
    DriftStanding drift;  // after the last run
};
inline constexpr std::size_t kStatusParts = 300, kStatusAlarms = 100;

class StatusBoard {
  public:
    StatusBoard(std::string project, std::string program, bool push);
    void take(const WatchEvent& event);
    StatusView view() const;

  private:
    mutable std::mutex mutex_;
    StatusView view_;
};

nlohmann::json status_json(const StatusView& view);         // without parts and alarms
nlohmann::json status_parts_json(const StatusView& view);   // newest first
nlohmann::json status_alarms_json(const StatusView& view);  // newest first
// Prometheus' text format, version 0.0.4.
std::string status_metrics(const StatusView& view);
// One page without scripts that asks for itself again every few seconds.
std::string status_page(const StatusView& view, Language language);

}  // namespace seamwright
