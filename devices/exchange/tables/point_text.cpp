// Text of any separator as a table of points.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/profile/units.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/profile_layout.h"

namespace seamwright {
namespace {

constexpr TextForm kTextForms[] = {{'\t', false}, {'\t', true}, {';', false}, {';', true},
                                   {',', false},  {',', true},  // "1,5","2,5"
                                   {'|', false},  {'|', true},  {' ', false}, {' ', true}};
constexpr std::size_t kLooksAt = 2000;  // lines, to see how a text is written

bool is_comment(std::string_view line) {
    if (is_no_return(line.substr(0, line.find_first_of(";,|\t ")))) return false;  // "#N/A;1.5"
    return line.starts_with("#") || line.starts_with("%") || line.starts_with("//");
}
std::string_view without_comment_sign(std::string_view line) {
    const auto from = line.find_first_not_of("#%/ \t");
    return from == std::string_view::npos ? std::string_view{} : line.substr(from);
}

struct FieldCount {
    std::size_t width = 0, numbers = 0, none = 0;  // of the fields: numbers, and words for no number
    bool strict() const { return width >= 2 && numbers > 0 && numbers + none == width; }
    bool loose() const { return width >= 2 && numbers > 0 && numbers + none >= 2; }
};
FieldCount row_of(std::string_view line, const TextForm& form) {
    FieldCount row;
    const auto fields = text_fields(line, form.separator);
    row.width = fields.size();
    if (row.width < 2 || row.width > 4096) return {};
    for (const auto& field : fields) {
        double value = 0;
        if (!text_number(field, form.decimal_comma, value)) continue;
        ++(std::isnan(value) ? row.none : row.numbers);
    }
    return row;
}

struct Sniffed {
    TextForm form;
    std::size_t width = 0, rows = 0;
    std::vector<bool> text;  // of each column: holds no number in any line
    bool is_row(const FieldCount& row) const {
        if (row.width != width) return false;
        return text.empty() ? row.strict() : row.loose();
    }
};

template <class Counts>
void count_rows(std::string_view text, const TextForm& form, const Counts& counts) {
    csv::Lines lines(text);
    std::string_view line;
    while (lines.number() < kLooksAt && lines.next(line))
        if (!is_comment(csv::blanks_off(line))) counts(line, row_of(line, form));
}

// The columns of such a row that hold no number in any line; empty where all do.
std::vector<bool> text_columns(std::string_view text, const Sniffed& seen) {
    std::vector<bool> is_text(seen.width, true);
    count_rows(text, seen.form, [&](std::string_view line, const FieldCount& row) {
        if (row.width != seen.width || !row.loose()) return;
        const auto fields = text_fields(line, seen.form.separator);
        double value = 0;
        for (std::size_t c = 0; c < seen.width; ++c)
            if (text_number(fields[c], seen.form.decimal_comma, value) && std::isfinite(value))
                is_text[c] = false;
    });
    return is_text;
}

Sniffed sniff(std::string_view text) {
    Sniffed strict, loose;
    std::size_t most_numbers = 0;
    for (const TextForm& form : kTextForms) {
        std::map<std::size_t, std::size_t> strict_rows, loose_rows, numbers;
        count_rows(text, form, [&](std::string_view, const FieldCount& row) {
            if (row.strict()) ++strict_rows[row.width];
            if (row.loose()) ++loose_rows[row.width], numbers[row.width] += row.numbers;
        });
        for (const auto& [width, rows] : strict_rows)
            if (rows > strict.rows) strict = {form, width, rows, {}};
        for (const auto& [width, rows] : loose_rows)
            if (rows > loose.rows || (rows == loose.rows && numbers[width] > most_numbers)) {
                loose = {form, width, rows, {}};
                most_numbers = numbers[width];
            }
    }
    // Words among the numbers are a reading only where it has far more rows than the one of numbers alone.
    if (2 * strict.rows >= loose.rows) return strict;
    loose.text = text_columns(text, loose);
    return loose;
}

// Names of the columns: a unit in brackets that stands off by a blank belongs to the name before it.
std::vector<std::string> header_names(std::string_view line, char separator, std::size_t width) {
    line = without_comment_sign(line);
    const std::array<char, 6> signs{separator, ';', ',', '\t', '|', ' '};
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

std::string bare_unit(std::string name) {
    std::erase_if(name, [](char c) { return std::string_view("[]() ").find(c) != std::string_view::npos; });
    return name;
}
bool are_units(const std::vector<std::string>& names) {
    bool length = false;
    for (const std::string& name : names) {
        const std::string unit = bare_unit(name);
        const std::string known = column_name("x [" + unit + "]").unit;
        length = length || mm_of_unit(known);
        static const std::set<std::string> others{
            "",      "-", "a.u.",   "a.u",   "au", "%", "px", "s",   "ms",  "us", "counts",
            "count", "n", "digits", "digit", "1",  "#", "Hz", "lsb", "LSB", "DN", "\xC2\xB0"};
        if (known.empty() && !others.contains(unit)) return false;
    }
    return length;
}

bool has_letters(const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(), [](const std::string& s) {
        return std::any_of(s.begin(), s.end(), [](unsigned char c) { return std::isalpha(c); });
    });
}

bool looks_broken(std::string_view field) {
    field = csv::trimmed(field);
    return !field.empty() && std::string_view("+-.,0123456789#*").find(field.front()) != field.npos;
}

// A line of the preamble that has the form of a row and a field that is no number, though it looks like one; that field.
std::optional<std::string> broken_row(std::string_view line, const Sniffed& seen) {
    const FieldCount row = row_of(line, seen.form);
    if (row.width != seen.width || row.numbers == 0) return std::nullopt;
    std::optional<std::string> broken;
    const auto fields = text_fields(line, seen.form.separator);
    for (std::size_t c = 0; c < fields.size(); ++c) {
        double value = 0;
        if (text_number(fields[c], seen.form.decimal_comma, value)) continue;
        if (!seen.text.empty() && seen.text[c]) continue;
        if (!looks_broken(fields[c])) return std::nullopt;
        if (!broken) broken = fields[c];
    }
    return broken;
}
// Words for no number alone; a lone dash may stand for a unit.
bool row_without_numbers(std::string_view line, const Sniffed& seen) {
    const FieldCount row = row_of(line, seen.form);
    if (row.width != seen.width || row.none != seen.width) return false;
    const auto fields = text_fields(line, seen.form.separator);
    return std::any_of(fields.begin(), fields.end(), [](auto field) { return field.size() > 1; });
}

tl::unexpected<Error> nothing_numeric(std::string_view text, const std::string& where) {
    csv::Lines lines(text);
    std::string_view line;
    while (lines.number() < kLooksAt && lines.next(line))
        for (const TextForm& form : kTextForms) {
            const FieldCount row = row_of(line, form);
            if (row.numbers == 0 || is_comment(csv::blanks_off(line))) continue;
            for (const auto& field : text_fields(line, form.separator)) {
                double value = 0;
                if (!text_number(field, form.decimal_comma, value) && looks_broken(field))
                    return input_error(Text("\"{}\" is no number", csv::shown(field)),
                                       fmt::format("{}, line {}", where, lines.number()),
                                       "a profile is a table with a column x and a column z");
            }
        }
    return input_error("no line holds two or more numbers", Text("{}, line 1", where),
                       "a profile is a table with a column x and a column z");
}

// Whether the signs between digits may part thousands: all fields with one have three digits behind it, and beside them stand whole
// numbers below a thousand.
class ThousandsOrDecimals {
  public:
    explicit ThousandsOrDecimals(char decimal) : decimal_(decimal) {}
    void add(std::string_view field, double value, std::size_t row) {
        if (std::isnan(value)) return;
        const auto at = field.find(decimal_);
        if (at == field.npos) {
            if (value == std::floor(value) && std::abs(value) >= 1 && std::abs(value) < 1000 &&
                plain_.size() < 2)
                plain_.insert(value);
            return;
        }
        const bool three =
            field.size() == at + 4 && at > 0 && std::isdigit(static_cast<unsigned char>(field[at - 1]));
        const auto digits = at - std::min(at, field.find_first_of("0123456789"));
        if (!three || digits > 3 || (value != 0 && std::abs(value) < 1)) certain_ = true;
        if (!certain_ && signs_++ == 0) first_ = field, row_ = row;
    }
    bool unclear() const { return !certain_ && signs_ >= 3 && plain_.size() >= 2; }
    const std::string& first() const { return first_; }
    std::size_t row() const { return row_; }

  private:
    char decimal_;
    bool certain_ = false;
    std::set<double> plain_;
    std::string first_;
    std::size_t signs_ = 0, row_ = 0;
};

// The lines before the first row.
struct Preamble {
    struct Line {
        std::string_view text;
        std::size_t number = 0;
    };
    std::vector<Line> lines;

    // Error: a broken row just above the first one.
    Expected<void> check(const Sniffed& seen, const std::string& where) const {
        for (std::size_t i = lines.size(); i-- > 0;) {
            const auto broken = broken_row(lines[i].text, seen);
            if (!broken) break;
            if (i > 0 && broken_row(lines[i - 1].text, seen)) continue;  // the first of them is named
            return input_error(Text("\"{}\" is no number", csv::shown(*broken)),
                               fmt::format("{}, line {}", where, lines[i].number));
        }
        return {};
    }
    // The line of the header; 0: there is none.
    std::size_t name_columns(PointTable& table, const Sniffed& seen) const {
        if (lines.empty()) return 0;
        std::size_t number = lines.back().number;
        table.names = header_names(lines.back().text, seen.form.separator, seen.width);
        if (!table.names.empty() && are_units(table.names) &&
            lines.size() > 1) {  // units have a line of their own
            const Line& before = lines[lines.size() - 2];
            auto names = header_names(before.text, seen.form.separator, seen.width);
            for (std::size_t c = 0; c < names.size(); ++c)
                if (const std::string unit = bare_unit(table.names[c]); !unit.empty() && unit != "-")
                    names[c] += " [" + unit + "]";
            if (!names.empty()) table.names = names, number = before.number;
        }
        if (!has_letters(table.names)) table.names.clear();
        return number;
    }
};

void drop_trailing_column(PointTable& table) {
    const auto& last = table.columns.back();
    if ((table.names.empty() || table.names.back().empty()) &&
        std::all_of(last.begin(), last.end(), [](double v) { return std::isnan(v); })) {
        table.columns.pop_back();
        if (!table.names.empty()) table.names.pop_back();
    }
}

}  // namespace

Expected<PointTable> parse_text_points(std::string_view text, const std::string& where, std::size_t limit) {
    if (is_utf16(text)) return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        return input_error("the file is empty", where);
    if (text.substr(0, 4096).find('\0') != std::string_view::npos)
        return input_error("this is no text, and no known binary form", where, "give text, NPY, PLY or PCD");
    const std::string with_newlines = csv::old_line_ends(text) ? csv::new_line_ends(text) : std::string();
    if (!with_newlines.empty()) text = with_newlines;
    const Sniffed seen = sniff(text);
    if (seen.rows == 0) return nothing_numeric(text, where);
    PointTable table;
    table.columns.resize(seen.width);
    Preamble preamble;
    std::vector<ThousandsOrDecimals> thousands(seen.width,
                                               ThousandsOrDecimals(seen.form.decimal_comma ? ',' : '.'));
    csv::Lines lines(text);
    std::string_view line;
    bool between = false;
    bool whole_numbers = true;
    while (lines.next(line)) {
        const std::string_view bare = csv::blanks_off(line);
        if (table.lines.empty()) {
            if (bare.empty()) continue;
            const FieldCount row = row_of(line, seen.form);
            const bool comment = is_comment(bare) && !seen.is_row(row);
            if (comment || (!seen.is_row(row) && !row_without_numbers(line, seen))) {
                if (row.width != seen.width || row.none != seen.width || !seen.text.empty() ||
                    bare.find_first_not_of(";,| \t") != bare.npos)  // separators alone say nothing
                    preamble.lines.push_back({line, lines.number()});
                continue;
            }
            SEAM_OK(preamble.check(seen, where));
        } else if (bare.empty() || is_comment(bare)) {
            between = true;
            continue;
        }
        const std::string at = fmt::format("{}, line {}", where, lines.number());
        const auto fields = text_fields(line, seen.form.separator);
        if (fields.size() != seen.width)
            return input_error(
                Text("has {} columns where the other lines have {}", fields.size(), seen.width), at);
        if (table.lines.size() >= limit) return input_error(Text("there are more than {} points", limit), at);
        for (std::size_t c = 0; c < seen.width; ++c) {
            double value = std::numeric_limits<double>::quiet_NaN();
            const bool text_column = !seen.text.empty() && seen.text[c];
            if (!text_column && !text_number(fields[c], seen.form.decimal_comma, value))
                return input_error(Text("\"{}\" is no number", csv::shown(fields[c])), at);
            whole_numbers = whole_numbers && (std::isnan(value) || value == std::floor(value));
            thousands[c].add(fields[c], value, table.lines.size());
            table.columns[c].push_back(value);
        }
        if (table.lines.empty() || between) table.blocks.push_back(table.lines.size());
        between = false;
        table.lines.push_back(static_cast<std::uint32_t>(lines.number()));
    }
    const std::size_t header = preamble.name_columns(table, seen);
    for (const ThousandsOrDecimals& column : thousands)
        if (column.unclear())
            return input_error(
                Text("\"{}\" may have decimals or be thousands: beside it stand whole numbers",
                     csv::shown(column.first())),
                table.at(where, column.row()),
                "write the column with decimals throughout, or without signs between thousands");
    // A separator at the end of every line is no further column.
    drop_trailing_column(table);
    if (seen.form.separator == ',' && whole_numbers && seen.width >= 3 && table.names.empty())
        return input_error("the commas may stand between columns or be decimal commas", table.at(where, 0),
                           "separate the columns by semicolons, or write decimal points");
    table.understood = fmt::format("text separated by {}", words(seen.form.separator));
    if (seen.form.decimal_comma) table.understood += ", decimal comma";
    if (const auto passed = std::count(seen.text.begin(), seen.text.end(), true); passed > 0)
        table.understood += fmt::format(", {} columns of words passed over", passed);
    table.understood += table.names.empty()
                            ? fmt::format(", no header, numbers from line {}", table.lines.front())
                            : fmt::format(", header in line {}", header);
    return table;
}

}  // namespace seamwright
