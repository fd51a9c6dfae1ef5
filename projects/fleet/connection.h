#pragma once
// libpqxx behind Expected: for the sources of this folder alone.

#include <cstdint>
#include <memory>
#include <optional>
#include <pqxx/pqxx>
#include <string>
#include <string_view>

#include "projects/fleet/target.h"

namespace seamwright::fleet {

// What an exception of libpqxx says, in our words where they help.
Error error_of(const std::exception& e, const FleetTarget& target);
// Whether the database refuses the data and would refuse it again.
bool refuses_data(const std::exception& e);

// `work` may throw what libpqxx throws.
template <class Work>
auto guarded(const FleetTarget& target, const Work& work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::exception& e) {
        return tl::unexpected(error_of(e, target));
    }
}

// Error (device): no server, wrong password, no database, each with its sentence.
Expected<std::unique_ptr<pqxx::connection>> connect(const FleetTarget& target);

// Of the schema; nullopt: there is none.
std::optional<int> schema_version(pqxx::transaction_base& work);

// A number as the database writes it; 0 for NULL.
double number(const pqxx::field& field);
std::int64_t whole(const pqxx::field& field);
// For to_char: as utc_now() writes a time.
inline constexpr const char* kUtc = R"('YYYY-MM-DD"T"HH24:MI:SS.MS"Z"')";

}  // namespace seamwright::fleet
