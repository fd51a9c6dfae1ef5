#pragma once
// The line beside the station: a PLC or a broker that says which part comes, may start it, and is told what became of
// it. One interface, a protocol a file, a line each in line_registry.cpp (OPC UA would be one more).
//
// Nothing a line says writes to a robot: it names parts and calls for them, and what follows is a run like any other,
// through the same gate. A line that is silent, away or hostile never makes the station wait: every link has a thread of
// its own, and each function here returns at once.

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/exchange/settings.h"

namespace seamwright {

// What became of a part, as a number that PLC programs hold; frozen.
enum class LineResult : std::uint16_t {
    none = 0,
    corrected = 1,     // pushed, and the application runs in the frames
    measured = 2,      // a dry run whose regions would all have passed
    refused = 3,       // the gate refused at least one region, or it could not be solved
    not_taken = 4,     // pushed, but the application did not begin; the old frames stand again
    alarm = 5,         // a push went wrong
    device = 6,        // a sensor or robot failed
    cancelled = 7,     // by a person
    not_measured = 8,  // the call was not followed: the alarm number says why
};
std::string_view to_string(LineResult result);

// Alarm numbers, frozen too; 0 = none.
enum class LineAlarm : std::uint16_t {
    none = 0,
    station_starts = 1,
    device_lost = 10,
    device_silent = 11,
    device_disconnected = 12,
    device_in_use = 13,
    refused = 20,
    not_taken = 21,
    push_failed = 22,
    device_failed = 23,
    cancelled = 24,
    call_not_followed = 30,
    call_too_old = 31,
    part_type_unknown = 32,
    start_not_dropped = 33,
    line_silent = 34,
};
struct LineCode {
    int number;
    std::string_view name, help;
};
const std::vector<LineCode>& line_alarms();
const std::vector<LineCode>& line_results();

// The part that a line speaks of. All may be absent: 0, 0, 0, "".
struct LinePart {
    std::uint16_t type = 0;
    std::uint32_t number = 0;
    std::string name;         // printable, at most kLongestLineName bytes
    std::uint16_t paint = 0;  // colour, as the line numbers them
    bool operator==(const LinePart&) const = default;
    // The name, else the number, else "".
    std::string id() const;
};
inline constexpr std::size_t kLongestLineName = 32;
// What is not printable ASCII becomes '_', the rest is cut.
std::string line_name(std::string_view bytes);

struct LineCall {
    LinePart part;
    std::int64_t host_time_ns = 0;  // when it was heard, steady clock
};

struct LineRegion {
    std::string id;
    bool passed = false;  // the gate
    bool solved = false;  // else the vectors mean nothing
    // Displacement of the part in the work object (KUKA A, B, C), and its standard deviations, random and systematic.
    Eigen::Vector3d xyz_mm = Eigen::Vector3d::Zero(), abc_deg = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero(), sigma_abc_deg = Eigen::Vector3d::Zero();
    std::string refusal;  // the first, in English
    bool operator==(const LineRegion&) const = default;
};

// What the station says of itself; everything at one instant.
struct LineState {
    bool ready = false;                    // all devices answer, nothing is measured
    bool busy = false;                     // a part is measured
    std::uint32_t results = 0;             // how many ended since the start; each is one more
    LineResult result = LineResult::none;  // of the last part
    LineAlarm alarm = LineAlarm::station_starts;
    LinePart part;           // the present or last one, as the line named it
    std::string part_id;     // as the run is called
    std::int64_t run = 0;    // its number in the project file
    std::int64_t parts = 0;  // started since the start
    double seconds = 0;      // the last part took
    std::string utc, text;   // of the last event; English
    std::vector<LineRegion> regions;
    bool operator==(const LineState&) const = default;
};

// Every function is for the station's one thread and returns at once.
class LineLink {
  public:
    virtual ~LineLink() = default;
    virtual void publish(const LineState& state) = 0;
    // The watching goes on; the heartbeat beats for kLineAlive after each.
    virtual void alive() = 0;
    // The line's call for a part, once each; none where the line does not start parts. After it the line waits for
    // LineState::results to count on.
    virtual std::optional<LineCall> take_call() = 0;
    // The line has given up the part that it called for: no permission is to wait for it any longer.
    virtual bool given_up() const = 0;
    // The part that the line speaks of, for one call of the robot: registers hold it as long as the line lets them, a
    // message counts once. Taken too late it would name the next part after this one.
    virtual LinePart take_announced() = 0;
    virtual bool starts_parts() const = 0;
    virtual bool connected() const = 0;
    // What there is to tell since the last call, a sentence each.
    virtual std::vector<Text> take_notices() = 0;
    virtual int port() const { return 0; }  // of a server
};

struct LineProtocol {
    std::string_view name, help;
    // `name`: of the station, for the topics. Error (input): settings; (device): a server's port is taken. A client or a
    // broker that is away is none: it is tried again.
    Expected<std::unique_ptr<LineLink>> (*open)(const nlohmann::json& settings, const std::string& name);
    const SettingTable& (*settings)();
};
const std::vector<LineProtocol>& line_protocols();
const LineProtocol* line_protocol(std::string_view name);  // nullptr: there is none of that name
Expected<std::unique_ptr<LineLink>> open_line(const std::string& protocol, const nlohmann::json& settings,
                                              const std::string& name);

// Registers, handshake, codes and topics for who programs the other side: devices/line/LINE.md.
std::string line_document();

}  // namespace seamwright
