#include "devices/abb/rapid_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/geometry/notation.h"

namespace seamwright::abb {
namespace {

bool printable(char c) {
    return c >= ' ' && c <= '~';
}
bool letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool digit(char c) {
    return c >= '0' && c <= '9';
}

std::string_view trimmed(std::string_view line) {
    while (!line.empty() && line.back() == ' ') line.remove_suffix(1);
    return line;
}

std::vector<std::string> words(std::string_view line) {
    std::vector<std::string> result;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find(' '), line.size());
        if (end > 0) result.emplace_back(line.substr(0, end));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return result;
}

template <std::size_t N>
bool numbers(std::string_view line, std::array<double, N>& values) {
    const auto parts = words(line);
    if (parts.size() != N) return false;
    for (std::size_t i = 0; i < N; ++i) {
        const char* end = parts[i].data() + parts[i].size();
        const auto read = std::from_chars(parts[i].data(), end, values[i]);
        if (read.ec != std::errc() || read.ptr != end || !std::isfinite(values[i])) return false;
    }
    return true;
}

void append_line(std::string& bytes, std::string_view line) {
    for (std::size_t i = 0; i + 1 < kLineBytes; ++i) {
        const char c = i < line.size() ? line[i] : ' ';
        bytes += printable(c) ? c : '?';
    }
    bytes += '\n';
}

}  // namespace

Expected<Message> parse_message(std::string_view bytes, const std::string& where) {
    if (bytes.size() != kMessageBytes)
        return device_error(Text("a message of {} bytes came, they have {}", bytes.size(), kMessageBytes),
                            where);
    std::array<std::string_view, 3> lines;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view line = bytes.substr(i * kLineBytes, kLineBytes);
        if (line.back() != '\n' || !std::all_of(line.begin(), line.end() - 1, printable))
            return device_error(
                Text("line {} of a message is not 79 printable characters and a line feed", i + 1), where,
                "the controller's module and this program must speak the same version");
        lines[i] = trimmed(line.substr(0, kLineBytes - 1));
    }
    auto fields = words(lines[0]);
    Message message;
    const auto number = fields.size() < 2 ? std::nullopt : parse_count(fields[0]);
    if (!number)
        return device_error(Text("\"{}\" is no message: number and word are missing", lines[0]), where);
    message.number = *number;
    message.word = fields[1];
    message.fields.assign(fields.begin() + 2, fields.end());
    message.line2 = lines[1];
    message.line3 = lines[2];
    return message;
}

std::string message_bytes(const Message& message) {
    std::string line = fmt::format("{} {}", message.number, message.word);
    for (const std::string& field : message.fields) line += " " + field;
    std::string bytes;
    bytes.reserve(kMessageBytes);
    append_line(bytes, line);
    append_line(bytes, message.line2);
    append_line(bytes, message.line3);
    return bytes;
}

Expected<Pose> parse_pose_lines(const Message& message, const std::string& where) {
    std::array<double, 3> t{};
    std::array<double, 4> q{};
    if (!numbers(message.line2, t))
        return device_error(Text("\"{}\" is no position of three finite numbers", message.line2), where);
    if (!numbers(message.line3, q))
        return device_error(Text("\"{}\" is no quaternion of four finite numbers", message.line3), where);
    for (const double value : t)
        if (std::abs(value) > 1e5)
            return device_error(Text("{} mm is no position of a robot", value), where,
                                "a robot reaches less than 1e5 mm");
    auto rotation = rotation_from_abb({q[0], q[1], q[2], q[3]}, where);
    if (!rotation) return device_error(rotation.error().what, where);
    return make_pose(*rotation, {t[0], t[1], t[2]});
}

void set_pose_lines(Message& message, const Pose& pose) {
    const Eigen::Vector3d t = pose.translation();
    const AbbQuaternion q = abb_from_rotation(pose.linear());
    message.line2 = fmt::format("{:.4f} {:.4f} {:.4f}", t.x(), t.y(), t.z());
    message.line3 = fmt::format("{:.8f} {:.8f} {:.8f} {:.8f}", q.w, q.x, q.y, q.z);
}

std::optional<std::uint32_t> parse_count(std::string_view text, std::uint32_t highest) {
    std::uint32_t value = 0;
    if (text.empty() || !std::all_of(text.begin(), text.end(), digit)) return std::nullopt;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || value > highest) return std::nullopt;
    return value;
}

bool is_rapid_identifier(std::string_view name) {
    return !name.empty() && name.size() <= 32 && letter(name.front()) &&
           std::all_of(name.begin(), name.end(), [](char c) { return letter(c) || digit(c) || c == '_'; });
}

bool is_spot_name(std::string_view name) {
    return !name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), [](char c) {
        return printable(c) && c != ' ' && c != '"' && c != '\\';
    });
}

}  // namespace seamwright::abb
