#pragma once
// The links to PLCs and brokers that a project names (Project::line), while it is watched: their calls for parts and
// their names for them go into the watching (WatchLine), what the watching tells goes out to all of them.
//
// Nothing here waits for a link (devices/line/line_link.h), and nothing that comes from one goes anywhere but into
// the part's name, the call for it, or the refusal of it.

#include <memory>
#include <string>
#include <vector>

#include "devices/line/line_link.h"
#include "projects/model/project.h"
#include "projects/station/watch.h"

namespace seamwright {

// What the line is told of a finished run.
LineResult line_result(const RunRecord& run);
LineAlarm line_alarm(LineResult result);
LineAlarm line_alarm(ErrorCode lost);  // of a lost device
LineRegion line_region(const RegionRecord& region);

class LineControl {
  public:
    // Every enabled link. Error: settings, or a server's port is taken; two links that start parts.
    static Expected<LineControl> open(const Project& project);

    // For WatchOptions::line; this object must outlive the watching.
    WatchLine watch_line();
    // On the watching's thread, as WatchOptions::tell and ::alive.
    void take(const WatchEvent& event);
    void alive();

    bool empty() const { return links_.empty(); }
    const LineState& state() const { return state_; }
    // One sentence a link, for the screen: "plc: modbus-server, port 1502".
    std::vector<std::string> described() const;

  private:
    struct Link {
        LineSetup setup;
        std::unique_ptr<LineLink> link;
    };
    Expected<NamedPart> named(const std::string& part_id);
    void publish();

    std::vector<Link> links_;
    Link* caller();  // the one that starts parts
    LineState state_;
    LinePart called_;          // by the line that starts parts
    bool same_names_ = false;  // robot and line have called a part by one name
    std::vector<Text> notices_;
    LineAlarm refused_ = LineAlarm::none;  // why the part that is missed next is
    LineAlarm lost_ = LineAlarm::none;
    std::chrono::steady_clock::time_point told_alive_{};
};

}  // namespace seamwright
