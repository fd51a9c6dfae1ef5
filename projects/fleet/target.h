#pragma once
// Where a fleet's database is: "postgresql://user@host:port/database". What the URI leaves open libpq takes from the environment
// and its files, the password above all: PGPASSWORD, PGPASSFILE or ~/.pgpass.
//
// A password in the URI is used and never said again: name() has none, and what the library says is cleaned of it.

#include <string>

#include "core/error.h"

namespace seamwright {

class FleetTarget {
  public:
    // Error (usage): no URI of PostgreSQL. What was given is not repeated, it may hold a password.
    static Expected<FleetTarget> from(const std::string& uri);

    const std::string& name() const { return name_; }  // "postgresql://user@host:5432/database"
    bool holds_password() const { return !password_.empty(); }
    // For libpq, the password in it. With limits of time: 5 s to connect, 10 s for a network that takes no bytes.
    const std::string& connection() const { return connection_; }
    // Somebody else's words without the password.
    std::string cleaned(std::string words) const;

  private:
    std::string name_, connection_, password_;
};

}  // namespace seamwright
