#pragma once
// A connection that takes messages: for the sources of this folder alone.

#include <memory>
#include <string>
#include <vector>

#include "projects/file/outbox/outbox.h"
#include "projects/fleet/connection.h"

namespace seamwright::fleet {

struct Outgoing {
    QueuedRun run;
    std::string message;
};

class Store {
  public:
    // Error (device): no server, no schema, a newer one.
    static Expected<Store> connect(const FleetTarget& target);

    // With their sums (sums.h), in one transaction. Whether the database has them: confirmed when it answers. Refused data are `refused` with their Errors, the others taken.
    struct Taken {
        std::vector<QueuedRun> runs;
        std::vector<std::pair<std::int64_t, Error>> refused;
    };
    Expected<Taken> take(const std::string& station, const std::string& setup,
                         const std::vector<Outgoing>& batch);

    pqxx::connection& connection() { return *connection_; }
    const FleetTarget& target() const { return target_; }

  private:
    Store(FleetTarget target, std::unique_ptr<pqxx::connection> connection)
        : target_(std::move(target)), connection_(std::move(connection)) {}
    FleetTarget target_;
    std::unique_ptr<pqxx::connection> connection_;
};

}  // namespace seamwright::fleet
