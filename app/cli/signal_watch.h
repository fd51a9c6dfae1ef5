#pragma once
// SIGINT and SIGTERM ask the work to end; it then ends in an orderly way.

#include <stop_token>

namespace seamwright::cli {

// Watches for the rest of the program; the first call installs the handlers. The token is stopped within 20
// ms of a signal.
std::stop_token stop_on_signal();

}  // namespace seamwright::cli
