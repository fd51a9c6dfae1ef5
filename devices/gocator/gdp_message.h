#pragma once
// What a Gocator sends and takes in binary, little endian throughout.
//
//     control   size uint32 (itself included) | command uint16 | arguments           TCP port 3190
//     reply     size uint32 | command uint16 | status int32 (1 = done) | answer
//     data      size uint32 | control uint16 (bit 15: last message of a group, bits 0-14: type) | content
//                                                                                    TCP port 3196
//
// A group is what one exposure brings: a stamp message (type 1), then profiles (5: points, 6: equidistant in
// x), their intensities (7), and others, which are passed over. A profile message begins with the size of its
// attributes, count and width of its arrays, scales in nm and offsets in um; newer firmware appends
// attributes, among them the step of the sensor's processing that the data come from. z = offset + scale * value; a value of -32768 is no return. Source:
// the vendor's user manual, chapter "Gocator Protocol" (firmware 4 to 6).

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright::gdp {

inline constexpr std::uint16_t kControlPort = 3190, kDataPort = 3196;
inline constexpr std::size_t kLongestMessage = 16 << 20;  // a longer one is no message of a profile sensor
inline constexpr std::size_t kMostProfiles =
    4096;  // of one message; empty ones cost it no bytes, but us memory

enum class Command : std::uint16_t {
    stop = 0x1001,
    start = 0x100D,
    ping = 0x100E,
    system_info_v1 = 0x4002,
    system_info = 0x4010,
    trigger = 0x4510,
    protocol_version = 0x4511
};
inline constexpr std::int32_t kDone = 1;

struct Reply {
    std::uint16_t command = 0;
    std::int32_t status = 0;
    std::string answer;
};
std::string command_bytes(Command command, std::string_view arguments = {});
std::string reply_bytes(const Reply& reply);
// Takes the first whole message off the front of `stream`; nullopt while it is not whole. Error (device): a
// size that no message has; the stream is then broken.
Expected<std::optional<Reply>> take_reply(std::string& stream);
struct Request {
    std::uint16_t command = 0;
    std::string arguments;
};
Expected<std::optional<Request>> take_request(std::string& stream);

enum class Type : std::uint16_t { stamp = 1, points = 5, uniform = 6, intensity = 7 };
struct Message {
    std::uint16_t type = 0;
    bool last = false;
    std::string content;
};
std::string message_bytes(const Message& message);
Expected<std::optional<Message>> take_message(std::string& stream);

struct Stamp {
    std::uint64_t frame = 0;         // counts up from zero at every start
    std::uint64_t timestamp_us = 0;  // the sensor's clock
    std::int64_t encoder = 0;        // ticks
    std::uint32_t serial = 0;
};
Expected<std::vector<Stamp>> parse_stamps(std::string_view content);
std::string stamps_content(const std::vector<Stamp>& stamps);

// Where in the sensor's processing data come from: its own contour, or what a tool of its job makes of it. Firmware whose
// messages do not say so sends contours alone.
enum class Step : std::int32_t { none = -1, video = 0, profile = 2, section = 4, raw_profile = 5, tool = 8 };

// Profiles of a message of type points or uniform, all of one source and step.
struct Profiles {
    int source = 0;  // 0 top, 1 bottom, 2 top left, 3 top right
    std::optional<Step> step;
    std::vector<Profile> profiles;
};
Expected<Profiles> parse_profiles(Type type, std::string_view content);
// In steps of 1 um around the profile's middle, as points; beyond +-32 mm of it there is no return.
std::string points_content(const Profile& profile);

struct Intensities {
    int source = 0;
    std::optional<Step> step;
    std::vector<std::vector<float>> rows;  // 0..1
};
Expected<Intensities> parse_intensities(std::string_view content);

struct SystemInfo {
    std::string model, serial;
    std::int32_t state = 0;  // -1 conflict, 0 ready, 1 running
};
// The answer to system_info or system_info_v1.
Expected<SystemInfo> parse_system_info(Command command, std::string_view answer);
std::string system_info_answer(const SystemInfo& info);  // to system_info

}  // namespace seamwright::gdp
