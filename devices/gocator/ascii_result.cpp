#include "devices/gocator/ascii_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace seamwright::gocator {
namespace {

constexpr const char* kWhere = "Gocator ASCII";
constexpr double kMmPerUm = 1e-3;

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
    return text;
}

std::string printable(std::string_view text) {
    std::string out(text.substr(0, 120));
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
}

tl::unexpected<Error> no_result(std::string_view line) {
    return device_error(Text("\"{}\" is no result of this format", printable(line)), kWhere,
                        "give the driver the format that is set on the sensor's Output page");
}

template <class T>
std::optional<T> whole(std::string_view text, int base = 10) {
    T value{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (failed != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
    return value;
}

// A value's text into the result. A decision that says "no value" takes it out again.
bool put_value(AsciiResult& result, int id, std::string_view text, const AsciiFormat& format) {
    if (text == format.invalid) return true;
    const auto um = whole<std::int64_t>(text);
    if (!um || std::abs(static_cast<double>(*um)) > 1e9) return false;
    return result.value_mm.emplace(id, kMmPerUm * static_cast<double>(*um)).second;
}
bool put_decision(AsciiResult& result, int id, std::string_view text) {
    const auto decision = whole<std::uint32_t>(text);
    if (!decision) return false;
    if (*decision >> 1) result.value_mm.erase(id);
    return true;
}

enum class Kind { text, time, encoder, frame, value, decision };
struct Part {
    Kind kind = Kind::text;
    int id = 0;
    std::string text;
};

// nullopt: an unknown placeholder.
std::optional<std::vector<Part>> parts_of(const std::string& pattern) {
    std::vector<Part> parts;
    for (std::size_t i = 0; i < pattern.size();) {
        if (pattern[i] != '%') {
            if (parts.empty() || parts.back().kind != Kind::text) parts.emplace_back();
            parts.back().text.push_back(pattern[i++]);
            continue;
        }
        const std::string_view rest = std::string_view(pattern).substr(i + 1);
        Part part;
        std::size_t length = 0;
        for (const auto& [name, kind] : {std::pair<std::string_view, Kind>{"time", Kind::time},
                                         {"encoder", Kind::encoder},
                                         {"frame", Kind::frame},
                                         {"value[", Kind::value},
                                         {"decision[", Kind::decision}}) {
            if (!rest.starts_with(name)) continue;
            part.kind = kind;
            length = name.size();
        }
        if (part.kind == Kind::value || part.kind == Kind::decision) {
            const auto close = rest.find(']', length);
            if (close == std::string_view::npos) return std::nullopt;
            const auto id = whole<int>(rest.substr(length, close - length));
            if (!id || *id < 0) return std::nullopt;
            part.id = *id;
            length = close + 1;
        }
        if (length == 0) return std::nullopt;
        parts.push_back(std::move(part));
        i += 1 + length;
    }
    return parts;
}

Expected<AsciiResult> parse_standard(std::string_view line, const AsciiFormat& format) {
    std::vector<std::string_view> fields;
    for (std::string_view rest = line;;) {
        const auto end = rest.find(format.delimiter);
        fields.push_back(trimmed(rest.substr(0, end)));
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + format.delimiter.size());
    }
    while (!fields.empty() && fields.back().empty()) fields.pop_back();  // a delimiter at the end
    AsciiResult result;
    for (std::size_t i = 0; i < fields.size();) {
        // M type, id, V value [, D decision]; or without the value.
        if (i + 2 >= fields.size() || !fields[i].starts_with("M") ||
            !whole<std::uint32_t>(fields[i].substr(1), 16))
            return no_result(line);
        const auto id = whole<int>(fields[i + 1]);
        if (!id || *id < 0) return no_result(line);
        i += 2;
        bool any = false;
        if (i < fields.size() && fields[i].starts_with("V")) {
            if (!put_value(result, *id, fields[i++].substr(1), format)) return no_result(line);
            any = true;
        }
        if (i < fields.size() && fields[i].starts_with("D")) {
            if (!put_decision(result, *id, fields[i++].substr(1))) return no_result(line);
            any = true;
        }
        if (!any) return no_result(line);
    }
    return result;
}

}  // namespace

Expected<void> check_format(const AsciiFormat& format) {
    if (format.delimiter.empty() || format.terminator.empty())
        return input_error("delimiter and terminator must not be empty", kWhere);
    const auto parts = parts_of(format.pattern);
    if (!parts)
        return input_error("the format holds an unknown placeholder", kWhere,
                           "known are %time, %encoder, %frame, %value[ID], %decision[ID]");
    for (std::size_t i = 1; i < parts->size(); ++i)
        if ((*parts)[i].kind != Kind::text && (*parts)[i - 1].kind != Kind::text)
            return input_error("two placeholders of the format stand together", kWhere,
                               "put a delimiter between them, on the sensor too");
    return {};
}

Expected<std::optional<std::string>> take_line(std::string& stream, const AsciiFormat& format) {
    const auto end = stream.find(format.terminator);
    if (end == std::string::npos ? stream.size() > kLongestLine : end > kLongestLine)
        return device_error(Text("a line of more than {} bytes", kLongestLine), kWhere,
                            "check the terminator set on the sensor's Output page");
    if (end == std::string::npos) return std::optional<std::string>();
    std::string line = stream.substr(0, end);
    stream.erase(0, end + format.terminator.size());
    return std::optional(std::move(line));
}

Expected<AsciiResult> parse_result(std::string_view line, const AsciiFormat& format) {
    if (format.pattern.empty()) return parse_standard(line, format);
    const auto parts = parts_of(format.pattern);
    if (!parts) return no_result(line);
    AsciiResult result;
    std::vector<std::pair<int, std::string_view>> decisions;
    std::string_view rest = line;
    for (std::size_t i = 0; i < parts->size(); ++i) {
        const Part& part = (*parts)[i];
        if (part.kind == Kind::text) {
            if (!rest.starts_with(part.text)) return no_result(line);
            rest.remove_prefix(part.text.size());
            continue;
        }
        // Up to the text that follows.
        const auto end = i + 1 < parts->size() ? rest.find((*parts)[i + 1].text) : rest.size();
        if (end == std::string_view::npos) return no_result(line);
        const std::string_view text = trimmed(rest.substr(0, end));
        rest.remove_prefix(end);
        if (part.kind == Kind::value) {
            if (!put_value(result, part.id, text, format)) return no_result(line);
        } else if (part.kind == Kind::decision) {
            decisions.emplace_back(part.id, text);  // may stand before its value
        } else {
            const auto number = whole<std::int64_t>(text);
            if (!number) return no_result(line);
            if (part.kind == Kind::time) result.time_us = number;
            if (part.kind == Kind::frame) result.frame = number;
        }
    }
    if (!trimmed(rest).empty()) return no_result(line);
    for (const auto& [id, text] : decisions)
        if (!put_decision(result, id, text)) return no_result(line);
    return result;
}

}  // namespace seamwright::gocator
