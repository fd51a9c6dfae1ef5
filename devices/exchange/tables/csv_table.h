#pragma once
// A CSV table whose columns are named in its header: what profile_csv.h and path_csv.h have in common. Which
// texts are accepted and refused is said there.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/exchange/shown_text.h"

namespace seamwright {
namespace csv {

inline std::string_view blanks_off(std::string_view s) {
    const auto first = s.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return s.substr(first, s.find_last_not_of(" \t") - first + 1);
}
inline std::string_view trimmed(std::string_view s) {
    s = blanks_off(s);
    if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = trimmed(s.substr(1, s.size() - 2));
    return s;
}

// A text as one field (RFC 4180): in quotes, its own quotes doubled, where it holds what ends a field or a
// line, or blanks about it.
inline std::string field(std::string_view text) {
    const bool plain = text.find_first_of(",\"\r\n;\t") == std::string_view::npos &&
                       (text.empty() || (text.front() != ' ' && text.back() != ' '));
    if (plain) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

// For messages: short and printable, whatever the file holds.
inline std::string shown(std::string_view field) {
    return shown_text(field, 24);
}

// Lines that end as they did before 2001 on a Macintosh, in '\r' alone.
inline bool old_line_ends(std::string_view text) {
    return text.find('\n') == text.npos && text.find('\r') != text.npos;
}
inline std::string new_line_ends(std::string_view text) {
    std::string turned(text);
    std::replace(turned.begin(), turned.end(), '\r', '\n');
    return turned;
}

// Lines of a text, '\n' or "\r\n", numbered from 1.
class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {}
    bool next(std::string_view& line) {
        if (rest_.empty()) return false;
        const auto end = rest_.find('\n');
        line = rest_.substr(0, end);
        rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        ++number_;
        return true;
    }
    std::size_t number() const { return number_; }
    bool only_blanks_left() const { return rest_.find_first_not_of(" \t\r\n") == std::string_view::npos; }

  private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

}  // namespace csv

// A CSV table of numbers: names the columns that are wanted, then hands over their fields row by row.
class CsvTable {
  public:
    // `optional` names further columns in the message about a wrong header: "[,intensity]".
    CsvTable(std::string_view text, std::string where, std::string_view optional)
        : lines_(text), where_(std::move(where)), optional_(optional) {}

    // Reads the header; columns[i] becomes the column of wanted[i], -1 when absent.
    Expected<void> header(std::span<const std::string_view> wanted, std::size_t required) {
        if (text_is_utf16())
            return input_error("the text is UTF-16", where_, "save it as UTF-8 or plain ASCII");
        std::string_view line;
        if (lines_.only_blanks_left() || !lines_.next(line)) {
            return input_error("the file is empty", where_,
                               Text("the first line must be {}", example(wanted, required)));
        }
        if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
        for (const auto& [sign, name] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}}) {
            if (line.find(sign) != std::string_view::npos && line.find(',') == std::string_view::npos) {
                return input_error(Text("the columns are separated by {}", name), at(),
                                   "separate them by commas and write decimal points, not decimal commas");
            }
        }
        split(line);
        columns_.assign(wanted.size(), -1);
        width_ = fields_.size();
        for (std::size_t c = 0; c < fields_.size(); ++c) {
            for (std::size_t w = 0; w < wanted.size(); ++w) {
                if (csv::trimmed(fields_[c]) != wanted[w]) continue;
                if (columns_[w] >= 0)
                    return input_error(Text("the column {} is named twice", wanted[w]), at());
                columns_[w] = static_cast<int>(c);
            }
        }
        for (std::size_t w = 0; w < required; ++w) {
            if (columns_[w] >= 0) continue;
            return input_error(Text("the header \"{}\" has no column {}", csv::shown(line), wanted[w]), at(),
                               Text("the first line must be {}", example(wanted, required)));
        }
        return {};
    }

    // False at the end.
    Expected<bool> row() {
        std::string_view line;
        if (lines_.only_blanks_left() || !lines_.next(line)) return false;
        split(line);
        if (fields_.size() == width_) return true;
        if (csv::trimmed(line).empty()) {
            return input_error("the line is blank", at(),
                               "a point without return is a line with empty fields");
        }
        std::string mend;
        if (line.find(';') != std::string_view::npos) {
            mend = "separate the columns by commas and write decimal points";
        } else if (fields_.size() == 2 * width_) {
            mend = "these look like decimal commas: write decimal points";
        }
        return input_error(Text("has {} fields where the header names {}", fields_.size(), width_), at(),
                           mend);
    }

    bool has(std::size_t wanted) const { return columns_[wanted] >= 0; }

    // Without blanks about it and, where it stands in quotes, without those; two quotes inside are one.
    std::string text(std::size_t wanted) const {
        const std::string_view field = csv::blanks_off(fields_[static_cast<std::size_t>(columns_[wanted])]);
        if (field.size() < 2 || field.front() != '"' || field.back() != '"') return std::string(field);
        std::string text(field.substr(1, field.size() - 2));
        for (std::size_t at = 0; (at = text.find("\"\"", at)) != std::string::npos; ++at) text.erase(at, 1);
        return text;
    }

    // NaN for an empty field or "nan".
    Expected<double> number(std::size_t wanted, std::string_view name) const {
        std::string_view field = csv::trimmed(fields_[static_cast<std::size_t>(columns_[wanted])]);
        if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
        const std::string_view digits = field.front() == '+' ? field.substr(1) : field;
        double value = 0;
        const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (problem == std::errc::result_out_of_range) {
            return input_error(Text("{} = \"{}\" does not fit a number", name, csv::shown(field)), at());
        }
        if (problem != std::errc() || end != digits.data() + digits.size()) {
            const bool comma = field.find(';') != std::string_view::npos;
            return input_error(Text("{} = \"{}\" is no number", name, csv::shown(field)), at(),
                               comma ? "separate the columns by commas and write decimal points" : "");
        }
        if (std::isinf(value)) return input_error(Text("{} is infinite", name), at());
        return value;
    }

    Expected<double> millimetres(std::size_t wanted, std::string_view name) const {
        auto value = number(wanted, name);
        if (value && std::abs(*value) > 1e6) {
            return input_error(Text("{} = {} mm is beyond 1 km", name, *value), at(), "give millimetres");
        }
        return value;
    }

    std::string at() const { return fmt::format("{}, line {}", where_, lines_.number()); }
    const std::string& where() const { return where_; }

  private:
    bool text_is_utf16() {
        csv::Lines copy = lines_;
        std::string_view line;
        return copy.next(line) && is_utf16(line);
    }
    std::string example(std::span<const std::string_view> wanted, std::size_t required) const {
        std::string s;
        for (std::size_t w = 0; w < required; ++w) s += (w ? "," : "") + std::string(wanted[w]);
        return s + optional_;
    }
    // A comma inside quotes belongs to the field.
    void split(std::string_view line) {
        fields_.clear();
        std::size_t begin = 0;
        for (;;) {
            std::size_t from = line.find_first_not_of(" \t", begin);
            if (from != std::string_view::npos && line[from] == '"') {
                do from = line.find('"', from + 1);
                while (from != std::string_view::npos && line.substr(from, 2) == "\"\"" && ++from);
            }
            const auto comma = line.find(',', from == std::string_view::npos ? begin : std::max(from, begin));
            fields_.push_back(line.substr(begin, comma - begin));
            if (comma == std::string_view::npos || fields_.size() > 4096) break;
            begin = comma + 1;
        }
    }

    csv::Lines lines_;
    std::string where_, optional_;
    std::vector<int> columns_;
    std::vector<std::string_view> fields_;
    std::size_t width_ = 0;
};

}  // namespace seamwright
