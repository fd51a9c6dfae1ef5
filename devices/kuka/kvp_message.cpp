#include "devices/kuka/kvp_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/geometry/notation.h"

namespace seamwright {
namespace {

constexpr const char* kKvpWhere = "KUKAVARPROXY message";
constexpr std::string_view kBlank{" \t\r\n\0", 5};

void put16(std::string& out, std::size_t value) {
    out += static_cast<char>(value >> 8 & 0xff);
    out += static_cast<char>(value & 0xff);
}
std::size_t get16(std::string_view bytes, std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[at]) << 8 |
                                    static_cast<unsigned char>(bytes[at + 1]));
}
tl::unexpected<Error> broken(const Text& why) {
    return device_error(why, kKvpWhere, "check that KUKAVARPROXY answers on this port");
}

// 4 bytes of id and length, then mode, then texts. `known` = the message is whole.
Expected<bool> header(const std::string& stream, std::size_t& length) {
    if (stream.size() < 4) return false;
    length = get16(stream, 2);
    if (length < 3 || length > 2 * kKvpLongestText)
        return broken(fmt::format("a message of {} bytes makes no sense", length));
    return stream.size() >= 4 + length;
}

std::string_view trimmed(std::string_view text) {
    const auto from = text.find_first_not_of(kBlank);
    if (from == std::string_view::npos) return {};
    return text.substr(from, text.find_last_not_of(kBlank) - from + 1);
}

}  // namespace

std::string kvp_bytes(const KvpRequest& r) {
    std::string body(1, r.write ? '\1' : '\0');
    put16(body, r.name.size());
    body += r.name;
    if (r.write) {
        put16(body, r.value.size());
        body += r.value;
    }
    std::string out;
    put16(out, r.id);
    put16(out, body.size());
    return out + body;
}

std::string kvp_bytes(const KvpAnswer& a) {
    std::string out;
    put16(out, a.id);
    put16(out, 3 + a.value.size());
    out += a.write ? '\1' : '\0';
    put16(out, a.value.size());
    out += a.value;
    out += std::string(1, '\0') + std::string(2, a.done ? '\1' : '\0');
    return out;
}

Expected<std::optional<KvpRequest>> take_kvp_request(std::string& stream) {
    std::size_t length = 0;
    SEAM_TRY(auto whole, header(stream, length));
    if (!whole) return std::nullopt;
    const std::string_view body = std::string_view(stream).substr(4, length);
    KvpRequest r;
    r.id = static_cast<std::uint16_t>(get16(stream, 0));
    r.write = body[0] == 1;
    const std::size_t name = get16(body, 1);
    if (3 + name > length) return broken("the name is longer than its message");
    r.name = body.substr(3, name);
    if (r.write) {
        if (5 + name > length || 5 + name + get16(body, 3 + name) > length)
            return broken("the value is longer than its message");
        r.value = body.substr(5 + name, get16(body, 3 + name));
    }
    stream.erase(0, 4 + length);
    return r;
}

Expected<std::optional<KvpAnswer>> take_kvp_answer(std::string& stream) {
    std::size_t length = 0;
    SEAM_OK(header(stream, length));
    if (stream.size() < 7) return std::nullopt;
    const std::size_t value = get16(stream, 5);
    if (3 + value != length && 6 + value != length)
        return broken(fmt::format("a value of {} bytes in an answer of {}", value, length));
    const std::size_t total = 4 + 3 + value + 3;  // the status follows in either case
    if (stream.size() < total) return std::nullopt;
    KvpAnswer a;
    a.id = static_cast<std::uint16_t>(get16(stream, 0));
    a.write = stream[4] == 1;
    a.value = stream.substr(7, value);
    // No value of KRL is empty: so the published server answers what it does not know, with a 1 behind it.
    a.done = stream[total - 1] == 1 && (a.write || value > 0);
    stream.erase(0, total);
    return a;
}

Expected<Pose> frame_from_krl(std::string_view text) {
    std::string_view rest = trimmed(text);
    if (rest.size() < 2 || rest.front() != '{' || rest.back() != '}')
        return device_error(Text("\"{}\" is no frame", text.substr(0, 60)), kKvpWhere);
    rest = rest.substr(1, rest.size() - 2);
    if (const auto colon = rest.find(':'); colon != std::string_view::npos) rest.remove_prefix(colon + 1);
    constexpr std::string_view kNames = "XYZABC";
    std::array<std::optional<double>, 6> v;
    while (!rest.empty()) {
        const auto comma = std::min(rest.find(','), rest.size());
        const std::string_view part = trimmed(rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        const auto which = part.empty() ? std::string_view::npos : kNames.find(part.front());
        if (which == std::string_view::npos || part.size() < 3 || part[1] != ' ') continue;  // S, T, E1, ...
        const std::string_view digits = trimmed(part.substr(2));
        double number = 0;
        const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || v[which])
            return device_error(Text("\"{}\" is no number of a frame", part.substr(0, 40)), kKvpWhere);
        if (!(std::abs(number) <= (which < 3 ? 1e5 : 360.0)))
            return device_error(Text("\"{}\" is no position of a robot", part.substr(0, 40)), kKvpWhere);
        v[which] = number;
    }
    for (std::size_t i = 0; i < 6; ++i)
        if (!v[i]) return device_error(Text("the frame has no {}", kNames[i]), kKvpWhere);
    return make_pose(rotation_from_kuka({*v[3], *v[4], *v[5]}), {*v[0], *v[1], *v[2]});
}

std::string krl_from_frame(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    const Eigen::Vector3d& p = pose.translation();
    return fmt::format("{{X {:.6f}, Y {:.6f}, Z {:.6f}, A {:.6f}, B {:.6f}, C {:.6f}}}", p.x(), p.y(), p.z(),
                       abc.a_deg, abc.b_deg, abc.c_deg);
}

Expected<bool> bool_from_krl(std::string_view text) {
    const std::string_view t = trimmed(text);
    if (t == "TRUE" || t == "true") return true;
    if (t == "FALSE" || t == "false") return false;
    return device_error(Text("\"{}\" is neither TRUE nor FALSE", t.substr(0, 40)), kKvpWhere);
}

Expected<std::int64_t> int_from_krl(std::string_view text) {
    const std::string_view t = trimmed(text);
    std::int64_t value = 0;
    const auto read = std::from_chars(t.data(), t.data() + t.size(), value);
    if (t.empty() || read.ec != std::errc() || read.ptr != t.data() + t.size())
        return device_error(Text("\"{}\" is no whole number", t.substr(0, 40)), kKvpWhere);
    return value;
}

std::string string_from_krl(std::string_view text) {
    std::string_view t = trimmed(text);
    if (t.size() >= 2 && t.front() == '"' && t.back() == '"') t = t.substr(1, t.size() - 2);
    return std::string(t);
}

std::string krl_from_string(std::string_view text) {
    std::string out = "\"" + std::string(text) + "\"";
    std::replace(out.begin() + 1, out.end() - 1, '"', '\'');
    return out;
}

}  // namespace seamwright
