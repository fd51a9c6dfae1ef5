#pragma once
// The tables of a project file and how older files become current ones.
//
// A migration is frozen once released: it is never edited, a change is a further one at the end. user_version
// counts them.

#include <cstdint>
#include <span>

#include "devices/capture/sqlite.h"

namespace seamwright {

inline constexpr std::int32_t kApplicationId = kProjectApplicationId;
inline constexpr const char* kProjectFile = "project file";  // what Errors call it

struct Migration {
    std::int32_t version;  // of the file afterwards
    const char* sql;
};
std::span<const Migration> migrations();
std::int32_t current_version();

// Runs what is missing, in one transaction with the new user_version. `until` below the current version
// serves tests.
Expected<void> migrate(Database& db, std::int32_t until = current_version());

// Refuses what is not a sound project file: application id, version 1..current, SQLite's integrity check,
// foreign keys, exactly the tables that the migrations make, and a row that contradicts its checksum.
Expected<std::int32_t> check_identity(Database& db);  // returns the version
Expected<void> check_structure(Database& db, std::int32_t version);

}  // namespace seamwright
