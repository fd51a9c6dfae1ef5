#pragma once
// What `run --watch` tells beside its line on the screen: shift reports, the status page, the service manager.

#include <CLI/CLI.hpp>
#include <memory>

#include "projects/station/watch.h"
#include "projects/statistics/shift_report.h"
#include "projects/status/status_server.h"

namespace seamwright::cli {

struct WatchOutputArguments {
    std::string report_every, report_from = "00:00", report_to, language = "en";
    std::string status, status_token;
};
// The options; all of them need `watching`.
void add_watch_outputs(CLI::App* command, CLI::Option* watching, WatchOutputArguments& arguments);

class WatchOutputs {
  public:
    // Error (usage): arguments that are none; (device): the port of the status page is taken.
    static Expected<WatchOutputs> open(const WatchOutputArguments& arguments, Station& station, bool push);
    void tell(const WatchEvent& event);
    // Often: that the watching goes on. At most once a second the service manager hears of it.
    void alive();

  private:
    std::unique_ptr<StatusBoard> board_;
    std::unique_ptr<StatusServer> server_;  // goes before the board
    std::unique_ptr<ShiftReports> reports_;
    std::chrono::steady_clock::time_point told_{};
};

}  // namespace seamwright::cli
