#include "devices/gocator/gdp_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/number_text.h"

namespace seamwright::gdp {
namespace {

constexpr const char* kWhere = "Gocator";
constexpr std::int16_t kNoReturn = std::numeric_limits<std::int16_t>::min();
constexpr double kMmPerNm = 1e-6, kMmPerUm = 1e-3;

template <class T>
void put(std::string& out, T value) {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<char>((bits >> (8 * i)) & 0xff));
}

template <class T>
T at(std::string_view bytes, std::size_t offset) {  // precondition: long enough
    std::uint64_t bits = 0;
    for (std::size_t i = sizeof(T); i-- > 0;)
        bits = bits << 8 | static_cast<unsigned char>(bytes[offset + i]);
    return static_cast<T>(static_cast<std::make_unsigned_t<T>>(bits));
}

tl::unexpected<Error> too_short(std::string_view what, std::size_t got) {
    return device_error(Text("a {} message of {} bytes is too short for what it says", what, got), kWhere);
}

// The first whole message without its size; nullopt while it is not whole.
Expected<std::optional<std::string>> take(std::string& stream, std::size_t least) {
    if (stream.size() < 4) return std::optional<std::string>();
    const std::size_t size = at<std::uint32_t>(stream, 0);
    if (size < least || size > kLongestMessage)
        return device_error(Text("a message says it has {} bytes", size), kWhere,
                            "check that address and ports are those of a Gocator");
    if (stream.size() < size) return std::optional<std::string>();
    std::string message = stream.substr(4, size - 4);
    stream.erase(0, size);
    return std::optional(std::move(message));
}

std::string sized(const std::string& body) {
    std::string out;
    put(out, static_cast<std::uint32_t>(body.size() + 4));
    return out + body;
}

// What profiles and intensities begin with.
struct Head {
    std::size_t data = 0;  // offset of the arrays
    std::size_t count = 0, width = 0;
    std::size_t attributes = 0;  // bytes
};
Expected<Head> head_of(std::string_view content, std::size_t least_attributes, std::size_t bytes_per_point,
                       std::string_view what) {
    if (content.size() < 2) return too_short(what, content.size());
    const std::size_t attributes = at<std::uint16_t>(content, 0);
    Head head{2 + attributes, 0, 0, attributes};
    if (attributes < least_attributes || content.size() < head.data) return too_short(what, content.size());
    head.count = at<std::uint32_t>(content, 2);
    head.width = at<std::uint32_t>(content, 6);
    if (head.count > kMostProfiles)
        return device_error(Text("a {} message says it has {} profiles", what, head.count), kWhere);
    const std::size_t bytes = content.size() - head.data;
    // No product of two numbers from outside before both are known to be small.
    if (head.count > bytes || head.width > bytes || head.count * head.width * bytes_per_point > bytes)
        return too_short(what, content.size());
    return head;
}

}  // namespace

std::string command_bytes(Command command, std::string_view arguments) {
    std::string body;
    put(body, static_cast<std::uint16_t>(command));
    return sized(body.append(arguments));
}

std::string reply_bytes(const Reply& reply) {
    std::string body;
    put(body, reply.command);
    put(body, reply.status);
    return sized(body + reply.answer);
}

Expected<std::optional<Reply>> take_reply(std::string& stream) {
    SEAM_TRY(auto bytes, take(stream, 10));
    if (!bytes) return std::optional<Reply>();
    return std::optional(Reply{at<std::uint16_t>(*bytes, 0), at<std::int32_t>(*bytes, 2), bytes->substr(6)});
}

Expected<std::optional<Request>> take_request(std::string& stream) {
    SEAM_TRY(auto bytes, take(stream, 6));
    if (!bytes) return std::optional<Request>();
    return std::optional(Request{at<std::uint16_t>(*bytes, 0), bytes->substr(2)});
}

std::string message_bytes(const Message& message) {
    std::string body;
    put(body, static_cast<std::uint16_t>(message.type | (message.last ? 0x8000 : 0)));
    return sized(body + message.content);
}

Expected<std::optional<Message>> take_message(std::string& stream) {
    SEAM_TRY(auto bytes, take(stream, 6));
    if (!bytes) return std::optional<Message>();
    const auto control = at<std::uint16_t>(*bytes, 0);
    return std::optional(
        Message{static_cast<std::uint16_t>(control & 0x7fff), (control & 0x8000) != 0, bytes->substr(2)});
}

Expected<std::vector<Stamp>> parse_stamps(std::string_view content) {
    constexpr std::size_t kHead = 8, kLeast = 44;
    if (content.size() < kHead) return too_short("stamp", content.size());
    const std::size_t count = at<std::uint32_t>(content, 0), size = at<std::uint16_t>(content, 4);
    const std::size_t bytes = content.size() - kHead;
    if (size < kLeast || count > bytes || count * size > bytes) return too_short("stamp", content.size());
    std::vector<Stamp> stamps;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string_view s = content.substr(kHead + i * size, size);
        stamps.push_back({at<std::uint64_t>(s, 0), at<std::uint64_t>(s, 8), at<std::int64_t>(s, 16),
                          at<std::uint32_t>(s, 40)});
    }
    return stamps;
}

std::string stamps_content(const std::vector<Stamp>& stamps) {
    constexpr std::uint16_t kSize = 56;
    std::string out;
    put(out, static_cast<std::uint32_t>(stamps.size()));
    put(out, kSize);
    put(out, std::uint16_t{0});  // source, reserved
    for (const Stamp& s : stamps) {
        std::string one;
        put(one, s.frame);
        put(one, s.timestamp_us);
        put(one, s.encoder);
        put(one, std::int64_t{0});
        put(one, std::uint64_t{0});
        put(one, s.serial);
        one.resize(kSize, '\0');
        out += one;
    }
    return out;
}

Expected<Profiles> parse_profiles(Type type, std::string_view content) {
    const std::size_t point_bytes = type == Type::points ? 4 : 2;
    SEAM_TRY(const auto head, head_of(content, 32, point_bytes, "profile"));
    const double x_scale = kMmPerNm * at<std::uint32_t>(content, 10),
                 z_scale = kMmPerNm * at<std::uint32_t>(content, 14),
                 x_offset = kMmPerUm * at<std::int32_t>(content, 18),
                 z_offset = kMmPerUm * at<std::int32_t>(content, 22);
    Profiles out;
    out.source = at<std::uint8_t>(content, 26);
    if (head.attributes >= 36) out.step = static_cast<Step>(at<std::int32_t>(content, 34));
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t c = 0; c < head.count; ++c) {
        Profile& profile = out.profiles.emplace_back();
        profile.x_mm.reserve(head.width);
        profile.z_mm.reserve(head.width);
        std::size_t next = head.data + c * head.width * point_bytes;
        for (std::size_t i = 0; i < head.width; ++i, next += point_bytes) {
            if (type == Type::points) {
                const auto x = at<std::int16_t>(content, next), z = at<std::int16_t>(content, next + 2);
                const bool seen = x != kNoReturn && z != kNoReturn;
                profile.x_mm.push_back(seen ? x_offset + x_scale * x : kNan);
                profile.z_mm.push_back(seen ? z_offset + z_scale * z : kNan);
            } else {
                const auto z = at<std::int16_t>(content, next);
                profile.x_mm.push_back(x_offset + x_scale * static_cast<double>(i));
                profile.z_mm.push_back(z == kNoReturn ? kNan : z_offset + z_scale * z);
            }
        }
    }
    return out;
}

std::string points_content(const Profile& profile) {
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const double p[2] = {profile.x_mm[i], profile.z_mm[i]};
        if (!std::isfinite(p[0]) || !std::isfinite(p[1])) continue;
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    std::int32_t offset_um[2] = {0, 0};
    for (int k = 0; k < 2; ++k)
        if (low[k] <= high[k])
            offset_um[k] = static_cast<std::int32_t>(std::lround(500 * (low[k] + high[k])));
    std::string out;
    put(out, std::uint16_t{40});
    put(out, std::uint32_t{1});
    put(out, static_cast<std::uint32_t>(profile.size()));
    put(out, std::uint32_t{1000});  // 1 um
    put(out, std::uint32_t{1000});
    put(out, offset_um[0]);
    put(out, offset_um[1]);
    out.resize(2 + 32, '\0');  // source top, exposure, camera
    put(out, static_cast<std::int32_t>(Step::profile));
    put(out, std::int32_t{0});
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const double x = std::round(1000 * profile.x_mm[i] - offset_um[0]),
                     z = std::round(1000 * profile.z_mm[i] - offset_um[1]);
        const bool seen = std::abs(x) <= 32767 && std::abs(z) <= 32767;  // false for NaN
        put(out, seen ? static_cast<std::int16_t>(x) : kNoReturn);
        put(out, seen ? static_cast<std::int16_t>(z) : kNoReturn);
    }
    return out;
}

Expected<Intensities> parse_intensities(std::string_view content) {
    SEAM_TRY(const auto head, head_of(content, 24, 1, "intensity"));
    Intensities out;
    out.source = at<std::uint8_t>(content, 18);
    if (head.attributes >= 28) out.step = static_cast<Step>(at<std::int32_t>(content, 26));
    for (std::size_t c = 0; c < head.count; ++c) {
        auto& row = out.rows.emplace_back(head.width);
        for (std::size_t i = 0; i < head.width; ++i)
            row[i] = static_cast<float>(at<std::uint8_t>(content, head.data + c * head.width + i)) / 255.0f;
    }
    return out;
}

Expected<SystemInfo> parse_system_info(Command command, std::string_view answer) {
    // Both layouts of this device: serial number, address, model, firmware, state.
    const std::size_t head = command == Command::system_info ? 2 : 0;
    if (answer.size() < head + 48) return too_short("system information", answer.size());
    const std::string_view info = answer.substr(head);
    SystemInfo out;
    out.serial = std::to_string(at<std::uint32_t>(info, 0));
    out.model = std::string(info.substr(8, 32));
    out.model.resize(std::min(out.model.size(), out.model.find('\0')));
    out.state = at<std::int32_t>(info, 44);
    return out;
}

std::string system_info_answer(const SystemInfo& info) {
    std::string out;
    put(out, std::uint16_t{52});
    put(out, number_from<std::uint32_t>(info.serial).value_or(0));
    put(out, std::uint32_t{0});
    out += info.model.substr(0, 31);
    out.resize(2 + 40, '\0');
    put(out, std::uint32_t{0});
    put(out, info.state);
    put(out, std::int32_t{0});
    out.resize(2 + 52, '\0');
    put(out, std::uint32_t{0});  // no other sensors, no buddies
    put(out, std::uint16_t{60});
    put(out, std::uint32_t{0});
    put(out, std::uint16_t{8});
    return out;
}

}  // namespace seamwright::gdp
