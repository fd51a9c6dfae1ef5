#pragma once
// systemd's notification protocol (sd_notify(3)): a datagram to the socket that NOTIFY_SOCKET names.

#include <string_view>

namespace seamwright::cli {

// "READY=1", "WATCHDOG=1", "STATUS=..."; without effect where no service manager listens.
void tell_service_manager(std::string_view assignment);

}  // namespace seamwright::cli
