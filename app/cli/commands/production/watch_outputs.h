#pragma once
// What `run --watch` tells beside its line on the screen: shift reports, the status page, the fleet's database, the service
// manager.

#include <CLI/CLI.hpp>
#include <memory>

#include "projects/fleet/publish.h"
#include "projects/station/watch.h"
#include "projects/statistics/shift_report.h"
#include "projects/status/status_server.h"

namespace seamwright::cli {

struct WatchOutputArguments {
    std::string report_every, report_from = "00:00", report_to, language = "en";
    std::string status, status_token;
    std::string fleet, station;
    CLI::Option* into_fleet = nullptr;  // --fleet, which may be given without a URL
};
// The first line of the file: what stands on a command line everybody on the computer can read. "": none. Error (usage): empty.
Expected<std::string> read_status_token(const std::string& path);
// The options; all of them need `watching`.
void add_watch_outputs(CLI::App* command, CLI::Option* watching, WatchOutputArguments& arguments);

class WatchOutputs {
  public:
    // Error (usage): arguments that are none; (device): the port of the status page is taken.
    static Expected<WatchOutputs> open(const WatchOutputArguments& arguments, Station& station, bool push);
    void tell(const WatchEvent& event);
    // Often: that the watching goes on. At most once a second the service manager hears of it.
    void alive();
    // The watching is over: what is queued for the fleet still goes out, if its database takes it at once.
    void finish();

  private:
    void tell_fleet(const WatchEvent& event);
    void tell_failed(const Expected<void>& done);

    std::unique_ptr<StatusBoard> board_;
    std::unique_ptr<StatusServer> server_;  // goes before the board
    std::unique_ptr<ShiftReports> reports_;
    std::unique_ptr<FleetPublisher> fleet_;
    std::string fleet_failed_;  // the last sentence that was told
    std::chrono::steady_clock::time_point told_{};
};

}  // namespace seamwright::cli
