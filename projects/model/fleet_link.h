#pragma once
// The fleet that a station's results go to.

#include <string>

namespace seamwright {

struct FleetLink {
    std::string id = "fleet";
    // "postgresql://user@host:port/database". A password is none of it: project files are copied and mailed.
    std::string address;
    std::string station;  // its name there; empty: the project's
    bool operator==(const FleetLink&) const = default;
};

// Whether the address has a password in it, in whatever place of the URI.
bool has_password(const std::string& address);

}  // namespace seamwright
