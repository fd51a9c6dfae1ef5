#include "devices/exchange/tables/point_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

}  // namespace

const char* words(char separator) {
    return separator == '\t'  ? "tabs"
           : separator == ';' ? "semicolons"
           : separator == ',' ? "commas"
           : separator == '|' ? "bars"
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

namespace {

constexpr std::string_view kMinus = "\xE2\x88\x92";  // U+2212
// Blanks that part thousands and no columns: no-break, narrow no-break, thin; and the Swiss apostrophes.
constexpr std::string_view kGroupSigns[] = {"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89", "\xE2\x80\x99", "'",
                                            " "};

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
// Three digits and no fourth from there on.
bool group_of_three(std::string_view text, std::size_t at) {
    for (std::size_t i = at; i < at + 3; ++i)
        if (i >= text.size() || !is_digit(text[i])) return false;
    return at + 3 >= text.size() || !is_digit(text[at + 3]);
}

bool all_of_sign(std::string_view field, char sign) {
    return field.find_first_not_of(sign) == field.npos;
}

}  // namespace

bool is_no_return(std::string_view field) {
    field = csv::trimmed(field);
    if (all_of_sign(field, '-') || all_of_sign(field, '*')) return true;  // nothing at all, too
    std::string lower;
    for (const char c : field) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::string_view word = lower;
    if (word.starts_with("-") || word.starts_with("+")) word.remove_prefix(1);
    if (word.starts_with("1.#")) return true;
    for (const char* known : {"nan", "nan(ind)", "nan(snan)", "null", "none", "#n/a", "n/a", "na", "inf",
                              "infinity", "#nv", "#num!", "#value!", "#div/0!"})
        if (word == known) return true;
    return false;
}

bool text_number(std::string_view field, bool decimal_comma, double& value) {
    field = csv::trimmed(field);
    value = kNoNumber;
    if (is_no_return(field)) return true;
    if (field.front() == '+') field.remove_prefix(1);
    if (field.empty() || field.size() > 64) return false;
    const char decimal = decimal_comma ? ',' : '.', other = decimal_comma ? '.' : ',';
    // The other sign parts thousands only where it says so itself: groups of three before a decimal sign.
    const auto at_decimal = field.find(decimal);
    const bool grouped = at_decimal != field.npos && field.rfind(other) < at_decimal;
    std::array<char, 64> copy;
    std::size_t size = 0;
    for (std::size_t i = 0; i < field.size();) {
        const std::string_view rest = field.substr(i);
        if (rest.starts_with(kMinus)) {
            copy[size++] = '-';
            i += kMinus.size();
            continue;
        }
        const auto* sign = std::find_if(std::begin(kGroupSigns), std::end(kGroupSigns),
                                        [&](std::string_view s) { return rest.starts_with(s); });
        const std::size_t skip = sign != std::end(kGroupSigns) ? sign->size()
                                 : grouped && rest[0] == other ? 1
                                                               : 0;
        if (skip > 0) {
            const bool edge = size == 0 || i + skip == field.size();
            const bool blank = skip > 0 && sign != std::end(kGroupSigns) && *sign != "'";
            if (!(edge && blank) &&
                !(size > 0 && is_digit(copy[size - 1]) && group_of_three(field, i + skip)))
                return false;
            i += skip;
            continue;
        }
        if (rest[0] == other) return false;
        const bool fortran = (rest[0] == 'D' || rest[0] == 'd') && size > 0 &&
                             (is_digit(copy[size - 1]) || copy[size - 1] == '.');
        copy[size++] = rest[0] == decimal ? '.' : fortran ? 'E' : rest[0];
        ++i;
    }
    const char* last = copy.data() + size;
    const auto [end, problem] = std::from_chars(copy.data(), last, value);
    return size > 0 && problem == std::errc() && end == last && std::isfinite(value);
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
