#include "devices/exchange/tables/point_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

constexpr TextForm kTextForms[] = {{'\t', false}, {'\t', true}, {';', false}, {';', true},
                                   {',', false},  {' ', false}, {' ', true}};
constexpr std::size_t kLooksAt = 2000;  // lines, to see how a text is written

bool is_comment(std::string_view line) {
    return line.starts_with("#") || line.starts_with("%") || line.starts_with("//");
}
std::string_view without_comment_sign(std::string_view line) {
    const auto from = line.find_first_not_of("#%/ \t");
    return from == std::string_view::npos ? std::string_view{} : line.substr(from);
}

// At least two fields, all numbers or empty, one a number.
bool numeric_row(std::string_view line, const TextForm& form, std::size_t& width) {
    const auto fields = text_fields(line, form.separator);
    width = fields.size();
    if (width < 2 || width > 4096) return false;
    bool any = false;
    for (const auto& field : fields) {
        double value = 0;
        if (!text_number(field, form.decimal_comma, value)) return false;
        any = any || !std::isnan(value);
    }
    return any;
}

struct Sniffed {
    TextForm form;
    std::size_t width = 0, rows = 0;
};
Sniffed sniff(std::string_view text) {
    Sniffed best;
    for (const TextForm& form : kTextForms) {
        std::map<std::size_t, std::size_t> widths;
        csv::Lines lines(text);
        std::string_view line;
        while (lines.number() < kLooksAt && lines.next(line)) {
            std::size_t width = 0;
            if (numeric_row(line, form, width)) ++widths[width];
        }
        for (const auto& [width, rows] : widths)
            if (rows > best.rows) best = {form, width, rows};
    }
    return best;
}

// Names of the columns: a unit in brackets that stands off by a blank belongs to the name before it.
std::vector<std::string> header_names(std::string_view line, char separator, std::size_t width) {
    line = without_comment_sign(line);
    const std::array<char, 5> signs{separator, ';', ',', '\t', ' '};
    for (const char sign : signs) {
        std::vector<std::string> names;
        for (const auto& field : text_fields(line, sign)) {
            const std::string name(csv::trimmed(field));
            const bool unit = sign == ' ' && (name.starts_with("[") || name.starts_with("("));
            if (unit && !names.empty())
                names.back() += " " + name;
            else
                names.push_back(name);
        }
        while (names.size() > width && names.back().empty()) names.pop_back();
        if (sign == separator && names.size() + 1 == width && names.size() > 1) names.emplace_back();
        if (names.size() == width) return names;
    }
    return {};
}

bool are_units(const std::vector<std::string>& names) {
    return !names.empty() && std::all_of(names.begin(), names.end(), [](std::string name) {
        std::erase_if(name,
                      [](char c) { return std::string_view("[]() ").find(c) != std::string_view::npos; });
        return name.empty() || name == "mm" || name == "m" || name == "um" || name == "in" ||
               name == "inch" || name == "-";
    });
}

bool has_letters(const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(), [](const std::string& s) {
        return std::any_of(s.begin(), s.end(), [](unsigned char c) { return std::isalpha(c); });
    });
}

}  // namespace

const char* words(char separator) {
    return separator == '\t'  ? "tabs"
           : separator == ';' ? "semicolons"
           : separator == ',' ? "commas"
                              : "blanks";
}

std::string PointTable::at(const std::string& where, std::size_t row) const {
    return row < lines.size() ? fmt::format("{}, line {}", where, lines[row])
                              : fmt::format("{}, point {}", where, row + 1);
}

std::vector<std::string_view> text_fields(std::string_view line, char separator) {
    std::vector<std::string_view> fields;
    if (separator == ' ') {
        for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
            const auto end = std::min(line.find_first_of(" \t", at), line.size());
            fields.push_back(line.substr(at, end - at));
            at = end;
        }
        return fields;
    }
    for (std::size_t begin = 0;;) {
        std::size_t from = begin;
        if (begin < line.size() && line[begin] == '"')
            from = std::min(line.find('"', begin + 1), line.size());
        const auto end = line.find(separator, from);
        fields.push_back(csv::trimmed(line.substr(begin, end - begin)));
        if (end == std::string_view::npos || fields.size() > 4096) break;
        begin = end + 1;
    }
    return fields;
}

bool text_number(std::string_view field, bool decimal_comma, double& value) {
    field = csv::trimmed(field);
    value = kNoNumber;
    if (field.empty() || field == "-" || field == "null" || field == "NULL") return true;
    if (field.front() == '+') field.remove_prefix(1);
    if (field.empty() || field.size() > 64) return false;
    std::array<char, 64> copy;
    std::copy(field.begin(), field.end(), copy.begin());
    if (decimal_comma) {
        if (field.find('.') != std::string_view::npos) return false;
        std::replace(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(field.size()), ',', '.');
    }
    const char* last = copy.data() + field.size();
    const auto [end, problem] = std::from_chars(copy.data(), last, value);
    if (problem != std::errc() || end != last || std::isinf(value)) return false;
    return true;
}

Expected<PointTable> parse_text_points(std::string_view text, const std::string& where, std::size_t limit) {
    if (is_utf16(text)) return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        return input_error("the file is empty", where);
    if (text.substr(0, 4096).find('\0') != std::string_view::npos)
        return input_error("this is no text, and no known binary form", where, "give text, NPY, PLY or PCD");
    const Sniffed seen = sniff(text);
    if (seen.rows == 0)
        return input_error("no line holds two or more numbers", Text("{}, line 1", where),
                           "a profile is a table with a column x and a column z");
    PointTable table;
    csv::Lines lines(text);
    std::string_view line, header_line, line_before;
    std::size_t header_number = 0, before_number = 0;
    bool between = false;
    bool whole_numbers = true;
    while (lines.next(line)) {
        const bool blank = csv::blanks_off(line).empty();
        std::size_t width = 0;
        const bool numbers = !blank && numeric_row(line, seen.form, width);
        if (table.lines.empty() && !(numbers && width == seen.width)) {
            if (blank) continue;
            line_before = header_line, before_number = header_number;
            header_line = line, header_number = lines.number();
            continue;
        }
        if (blank || is_comment(csv::blanks_off(line))) {
            between = true;
            continue;
        }
        const std::string at = fmt::format("{}, line {}", where, lines.number());
        const auto fields = text_fields(line, seen.form.separator);
        if (fields.size() != seen.width)
            return input_error(
                Text("has {} columns where the other lines have {}", fields.size(), seen.width), at);
        if (table.lines.size() >= limit) return input_error(Text("there are more than {} points", limit), at);
        table.columns.resize(seen.width);
        for (std::size_t c = 0; c < seen.width; ++c) {
            double value = 0;
            if (!text_number(fields[c], seen.form.decimal_comma, value))
                return input_error(Text("\"{}\" is no number", csv::shown(fields[c])), at);
            whole_numbers = whole_numbers && (std::isnan(value) || value == std::floor(value));
            table.columns[c].push_back(value);
        }
        if (table.lines.empty() || between) table.blocks.push_back(table.lines.size());
        between = false;
        table.lines.push_back(static_cast<std::uint32_t>(lines.number()));
    }
    if (header_number > 0) {
        table.names = header_names(header_line, seen.form.separator, seen.width);
        if (are_units(table.names) && before_number > 0) {  // units have a line of their own
            auto names = header_names(line_before, seen.form.separator, seen.width);
            for (std::size_t c = 0; c < names.size(); ++c)
                if (!table.names[c].empty() && table.names[c] != "-") names[c] += " [" + table.names[c] + "]";
            if (!names.empty()) table.names = names, header_number = before_number;
        }
        if (!has_letters(table.names)) table.names.clear();
    }
    // A separator at the end of every line is no further column.
    const auto& last = table.columns.back();
    if ((table.names.empty() || table.names.back().empty()) &&
        std::all_of(last.begin(), last.end(), [](double v) { return std::isnan(v); })) {
        table.columns.pop_back();
        if (!table.names.empty()) table.names.pop_back();
    }
    if (seen.form.separator == ',' && whole_numbers && seen.width >= 3 && table.names.empty())
        return input_error("the commas may stand between columns or be decimal commas", table.at(where, 0),
                           "separate the columns by semicolons, or write decimal points");
    table.understood = fmt::format("text separated by {}", words(seen.form.separator));
    if (seen.form.decimal_comma) table.understood += ", decimal comma";
    table.understood += table.names.empty()
                            ? fmt::format(", no header, numbers from line {}", table.lines.front())
                            : fmt::format(", header in line {}", header_number);
    return table;
}

Expected<PointTable> parse_points(std::string_view bytes, const std::string& where, std::size_t limit) {
    if (bytes.starts_with("\x93NUMPY")) return parse_npy(bytes, where, limit);
    const auto marked = [&](Expected<PointTable> table) {
        if (table && bytes.substr(0, 1024).find(kInBaseMark) != std::string_view::npos) {
            table->in_base = true;
            table->understood += ", in the robot's base";
        }
        return table;
    };
    if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r"))
        return marked(parse_ply_points(bytes, where, limit));
    csv::Lines lines(bytes.substr(0, 4096));
    std::string_view line;
    while (lines.next(line)) {
        if (line.starts_with("#") || line.empty()) continue;
        if (line.starts_with("VERSION ") || line.starts_with("FIELDS "))
            return marked(parse_pcd_points(bytes, where, limit));
        break;
    }
    return parse_text_points(bytes, where, limit);
}

}  // namespace seamwright
