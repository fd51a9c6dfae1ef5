#pragma once
// From the outboxes of stations into the fleet's database: every finished run once, whatever dies in between.
//
// A batch is one transaction of the database, after whose commit the runs leave the outbox. What was sent and not confirmed is sent
// again, and a run whose id and revision the database has already changes nothing there.

#include <chrono>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "projects/file/project_file.h"
#include "projects/fleet/target.h"

namespace seamwright {

struct PublishReport {
    std::string station;
    std::int64_t runs = 0;                                // that the database has by this publishing
    std::int64_t waiting = 0;                             // that are still queued
    std::vector<std::pair<std::int64_t, Error>> refused;  // by the number of the run: they stay queued
};

struct PublishOptions {
    std::string station;  // empty: the project's name
    std::stop_token cancel = {};
    std::function<void(std::int64_t published, std::int64_t queued)> progress = {};
};
// Everything queued. Error: the file; (device) the database, what was confirmed before has left the outbox.
Expected<PublishReport> publish_file(ProjectFile& file, const FleetTarget& target,
                                     const PublishOptions& options);

struct PublisherOptions {
    std::string station;  // empty: the project's name
    std::chrono::milliseconds retry_first{1000}, retry_longest{60'000};
    // When it begins to fail, and when it goes on: on the publishing thread.
    std::function<void(const Text&)> told = {};
};

// Publishes while a station is watched. Reading and writing the file is done by whoever watches, in the pauses between
// two parts and a few runs at a time; a thread of its own speaks with the database, so that no network delays a robot.
class FleetPublisher {
  public:
    // Error: the file, the station's name. The database need not be there.
    static Expected<std::unique_ptr<FleetPublisher>> start(ProjectFile& file, const FleetTarget& target,
                                                           PublisherOptions options);
    ~FleetPublisher();

    // On the thread that owns the file.
    void measuring(bool on);                     // as long as it does the file is left alone
    Expected<void> part_done(std::int64_t run);  // after the robot has its verdict
    Expected<void> idle();                       // often
    // What is queued still, for so long and while the database takes it. Returns how many are left.
    std::int64_t finish(std::chrono::milliseconds longest);

  private:
    struct Impl;
    explicit FleetPublisher(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
