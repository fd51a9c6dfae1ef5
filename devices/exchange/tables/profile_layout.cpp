#include "devices/exchange/tables/profile_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/profile/no_return.h"
#include "core/profile/units.h"
#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/profile_csv.h"

namespace seamwright {
namespace {

constexpr double kFarthestPoint_mm = 1e6;
constexpr std::size_t kTitle = 60;  // signs of one that is shown to be copied

bool is_one_of(const std::string& name, std::initializer_list<const char*> known) {
    return std::find(known.begin(), known.end(), name) != known.end();
}
bool names_x(const std::string& n) {
    return is_one_of(n, {"x", "xpos", "xposition", "xcoordinate", "xcoord", "xvalue", "position", "lateral"});
}
bool names_y(const std::string& n) {
    return is_one_of(n, {"y", "ypos", "yposition", "ycoordinate", "ycoord", "yvalue"});
}
bool names_z(const std::string& n) {
    return is_one_of(n, {"z", "zpos", "zposition", "zcoordinate", "zcoord", "zvalue", "height", "range",
                         "distance", "depth"});
}
bool names_profile(const std::string& n) {
    return is_one_of(
        n,
        {"profile",  "profileindex", "profileno",    "profilenumber", "profileid",  "profilenr",  "profil",
         "profilnr", "profilno",     "profilnummer", "profilindex",   "profilid",   "scan",       "scanindex",
         "scanid",   "scanno",       "scannr",       "scannumber",    "frame",      "frameindex", "frameid",
         "frameno",  "framenr",      "framenumber",  "slice",         "sliceindex", "sliceid",    "schnitt"});
}
bool names_counter(const std::string& n) {  // of profiles or of points
    return is_one_of(n, {"index",
                         "idx",
                         "i",
                         "no",
                         "nr",
                         "n",
                         "number",
                         "line",
                         "encoder",
                         "encoderposition",
                         "encodervalue",
                         "encodercount",
                         "enc",
                         "timestamp",
                         "stamp",
                         "zeitstempel",
                         "time",
                         "zeit",
                         "travel",
                         "travelmm"});
}
bool names_intensity(const std::string& n) {
    return is_one_of(n,
                     {"intensity", "grey", "gray", "brightness", "amplitude", "reflectance", "reflectivity"});
}

bool constant(const std::vector<double>& column) {
    return std::all_of(column.begin(), column.end(),
                       [&](double v) { return std::abs(v - column.front()) < 1e-9 || std::isnan(v); });
}
// Holds still over several points, then steps on: as the number or the travel of a profile does.
bool steps(const std::vector<double>& column) {
    std::size_t runs = 1;
    for (std::size_t i = 1; i < column.size(); ++i) {
        if (std::isnan(column[i]) || std::isnan(column[i - 1])) return false;
        if (column[i] != column[i - 1]) ++runs;
    }
    return column.size() >= 5 * runs;
}

struct PointRoles {
    std::optional<std::size_t> x, y, z, profile, intensity;
};

// But for capitals, blanks and the unit. column_name() knows letters of ASCII only; of others, none may differ.
bool alike(std::string_view title, std::string_view word) {
    const auto others = [](std::string_view text) {
        std::string kept;
        for (const char c : text)
            if (static_cast<unsigned char>(c) >= 0x80) kept += c;
        return kept;
    };
    const std::string name = column_name(word).name, beyond_ascii = others(word);
    return (!name.empty() || !beyond_ascii.empty()) && column_name(title).name == name &&
           others(title).starts_with(beyond_ascii);
}

Expected<std::size_t> column_called(const PointTable& table, std::string_view word,
                                    const std::string& where) {
    word = csv::trimmed(word);
    double number = 0;
    if (text_number(word, false, number) && number >= 1 &&
        number <= static_cast<double>(table.columns.size()) && number == std::floor(number))
        return static_cast<std::size_t>(number) - 1;
    for (const bool exactly : {true, false}) {
        std::vector<std::size_t> found;
        for (std::size_t c = 0; c < table.names.size(); ++c)
            if (exactly ? table.names[c] == word : alike(table.names[c], word)) found.push_back(c);
        if (found.size() > 1)
            return input_error(Text("the header names \"{}\" twice", csv::shown(word)), where,
                               "say which with --columns-xz X,Z (numbers from 1)");
        if (!found.empty()) return found.front();
    }
    std::string there;
    for (const std::string& name : table.names)
        there += (there.empty() ? "" : ", ") + shown_text(name, kTitle);
    return input_error(Text("there is no column \"{}\"", csv::shown(word)), where,
                       there.empty() ? Text("the columns are 1 to {}", table.columns.size())
                                     : Text("the columns are {}", there));
}

std::string named_columns(const PointTable& table) {
    std::string text;
    for (const std::string& name : table.names) text += (text.empty() ? "" : ", ") + shown_text(name, kTitle);
    return text;
}

Expected<void> named_once(const PointTable& table, std::size_t column, const std::string& where) {
    for (std::size_t c = 0; c < table.names.size(); ++c)
        if (c != column && column_name(table.names[c]).name == column_name(table.names[column]).name)
            return input_error(Text("the header names \"{}\" twice", csv::shown(table.names[column])), where,
                               "say which with --columns-xz X,Z (numbers from 1)");
    return {};
}

// Heights side by side: no names but numbers.
bool one_profile_a_row(const PointTable& table) {
    const auto numbers = std::count_if(table.names.begin(), table.names.end(), [](const std::string& name) {
        double ignored = 0;
        return text_number(name, false, ignored);
    });
    return table.names.empty() || 2 * static_cast<std::size_t>(numbers) > table.names.size();
}

Expected<PointRoles> find_columns(const PointTable& table, const ProfileLayout& layout,
                                  const std::string& where) {
    PointRoles found;
    std::optional<std::size_t> counter;  // one that numbers profiles
    const std::size_t width = table.columns.size();
    constexpr std::size_t kMostColumns = 16;
    if (layout.columns.empty() && width > kMostColumns && one_profile_a_row(table))
        return input_error("one profile per row is not read", table.at(where, 0),
                           "write a row per point, with x and z");
    for (std::size_t c = 0; c < table.names.size(); ++c) {
        const std::string name = column_name(table.names[c]).name;
        const auto take = [&](std::optional<std::size_t>& role) {
            if (!role) role = c;
        };
        if (names_x(name)) take(found.x);
        if (names_y(name)) take(found.y);
        if (names_z(name)) take(found.z);
        if (names_profile(name)) take(found.profile);
        if (names_counter(name) && steps(table.columns[c]) && !constant(table.columns[c])) take(counter);
        if (names_intensity(name)) take(found.intensity);
    }
    if (!found.profile) found.profile = counter;
    if (!layout.columns.empty()) {
        const auto words = text_fields(layout.columns, ',');
        if (words.size() != 2)
            return usage_error("gives other than two columns", "--columns-xz",
                               "write X,Z by name or by number from 1");
        SEAM_TRY(auto x, column_called(table, words[0], where));
        SEAM_TRY(auto z, column_called(table, words[1], where));
        if (x == z)
            return usage_error("names one column for x and z", "--columns-xz",
                               "write X,Z by name or by number from 1");
        found.x = x, found.z = z;
        if (found.y == found.x || found.y == found.z) found.y.reset();
        return found;
    }
    if (!table.names.empty()) {
        if (found.x && !found.z && found.y)
            std::swap(found.y, found.z);  // drawn in the plane: y is the height
        for (const auto& role : {found.x, found.z, found.profile})
            if (role) SEAM_OK(named_once(table, *role, where));
        if (found.x && found.z) return found;
        return input_error(
            Text("the header \"{}\" names no column {}", named_columns(table), found.x ? "z" : "x"), where,
            "say which with --columns-xz X,Z (names, or numbers from 1)");
    }
    if (width == 2) {
        found.x = 0, found.z = 1;
    } else if (width == 3 && (constant(table.columns[1]) || steps(table.columns[1]))) {
        found.x = 0, found.y = 1, found.z = 2;
    } else if (width == 3 && steps(table.columns[0])) {
        found.profile = 0, found.x = 1, found.z = 2;
    } else {
        return input_error(
            Text("{} columns without names", width), table.at(where, 0),
            width < 2 ? "a profile needs x and z" : "say which with --columns-xz X,Z (numbers from 1)");
    }
    return found;
}

// The header of our own form and nothing beside it: a number of the profile makes several of one file.
bool is_own_form(std::string_view bytes) {
    std::string_view first = bytes.substr(0, std::min<std::size_t>(bytes.find('\n'), 256));
    if (first.starts_with("\xEF\xBB\xBF")) first.remove_prefix(3);
    bool x = false, z = false;
    for (const auto& field : text_fields(first, ',')) {
        const std::string_view name = csv::trimmed(field);
        x = x || name == "x_mm";
        z = z || name == "z_mm";
        const std::string plain = column_name(name).name;
        if (names_profile(plain) || names_counter(plain)) return false;
    }
    return x && z;
}

// Millimetres of one unit of a column: as the person says, else as its name says, else 1.
Expected<double> factor(const PointTable& table, std::size_t column, const ProfileLayout& layout, bool& asked,
                        const std::string& where) {
    if (const auto said = mm_of_unit(layout.unit)) return *said;
    if (column >= table.names.size()) return 1;
    const ColumnName name = column_name(table.names[column]);
    if (!name.unknown.empty())
        return input_error(Text("the unit \"{}\" of the column \"{}\" is not known", csv::shown(name.unknown),
                                csv::shown(table.names[column])),
                           where, "say what the numbers are in with --unit");
    const auto named = mm_of_unit(name.unit);
    if (named) asked = false;
    return named.value_or(1);
}

// The row where x starts over: it runs one way all through, but for leaps back over more than half of its span, and runs over more
// than half of it each time.
std::optional<std::size_t> starts_over(const std::vector<double>& x, std::size_t from, std::size_t to) {
    std::vector<std::size_t> rows;
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = from; i < to; ++i) {
        if (std::isnan(x[i])) continue;
        rows.push_back(i);
        low = std::min(low, x[i]), high = std::max(high, x[i]);
    }
    constexpr std::size_t kFewest = 10;
    const double half = (high - low) / 2, jitter = (high - low) / 20;
    if (rows.size() < kFewest || !(half > 0)) return std::nullopt;
    std::size_t up = 0;
    for (std::size_t k = 1; k < rows.size(); ++k) up += x[rows[k]] > x[rows[k - 1]] ? 1 : 0;
    const double way = 2 * up > rows.size() ? 1 : -1;
    std::optional<std::size_t> first;
    double start = x[rows.front()];
    for (std::size_t k = 1; k < rows.size(); ++k) {
        const double before = x[rows[k - 1]], back = way * (before - x[rows[k]]);
        if (back <= jitter) continue;
        if (back <= half || way * (before - start) <= half) return std::nullopt;
        if (!first) first = rows[k];
        start = x[rows[k]];
    }
    return first && way * (x[rows.back()] - start) > half ? first : std::nullopt;
}

std::string told(const PointTable& table, const PointRoles& c) {
    const auto name = [&](std::size_t column) {
        return column < table.names.size() && !table.names[column].empty()
                   ? fmt::format("\"{}\"", csv::shown(table.names[column]))
                   : fmt::format("column {}", column + 1);
    };
    std::string text = fmt::format("x = {}, z = {}", name(*c.x), name(*c.z));
    if (c.profile) text += ", profiles by " + name(*c.profile);
    if (c.intensity) text += ", intensity = " + name(*c.intensity);
    return text;
}

// "px" of "x [px]" and "x_px", whose last bracket or stroke is at `from`. In round brackets a longer word or a number is a remark.
std::string unknown_unit(std::string_view title, std::size_t from) {
    if (from == title.npos || from == 0) return {};
    constexpr std::size_t kLongest = 5;
    std::string_view word = title.substr(from + 1);
    if (title[from] == '_') return word == "px" || word == "pixel" ? std::string(word) : std::string();
    const char end = title[from] == '[' ? ']' : ')';
    const auto to = word.find(end);
    if (to == word.npos || word.find_first_not_of(' ', to + 1) != word.npos) return {};
    word = csv::blanks_off(word.substr(0, to));
    const bool letters =
        std::all_of(word.begin(), word.end(), [](unsigned char c) { return c < 0x80 && std::isalpha(c); });
    return end == ']' || (letters && word.size() <= kLongest) ? std::string(word) : std::string();
}

}  // namespace

ColumnName column_name(std::string_view header) {
    ColumnName result;
    std::string lower;
    for (const char c : header) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (std::size_t at; (at = lower.find("\xC2\xB5")) != std::string::npos;)
        lower.replace(at, 2, "u");  // micro sign
    for (std::size_t at; (at = lower.find("\xCE\xBC")) != std::string::npos;)
        lower.replace(at, 2, "u");                     // mu
    for (std::size_t at = 1; at < lower.size(); ++at)  // micro sign of Latin-1
        if (lower[at] == '\xB5' && static_cast<unsigned char>(lower[at - 1]) < 0x80) lower[at] = 'u';
    for (std::size_t at; (at = lower.find("\xC2\xB0")) != std::string::npos;) lower.replace(at, 2, "deg");
    static const std::pair<const char*, const char*> units[] = {
        {"mm", "mm"},       {"millimeter", "mm"}, {"millimetre", "mm"}, {"um", "um"},   {"micron", "um"},
        {"microns", "um"},  {"micrometer", "um"}, {"m", "m"},           {"meter", "m"}, {"metre", "m"},
        {"in", "in"},       {"inch", "in"},       {"inches", "in"},     {"deg", "deg"}, {"degree", "deg"},
        {"degrees", "deg"}, {"rad", "rad"},       {"radian", "rad"},    {"cm", "cm"},   {"nm", "nm"},
        {"mil", "mil"},     {"mils", "mil"},      {"thou", "mil"},      {"\"", "in"},   {"''", "in"}};
    const auto cut = lower.find_last_of("[(/_ ");
    if (cut != std::string::npos && cut > 0) {
        std::string unit = lower.substr(cut + 1);
        std::erase_if(unit, [](char c) { return c == ']' || c == ')' || c == ' '; });
        for (const auto& [word, is] : units)
            if (unit == word) {
                result.unit = is;
                lower.resize(cut);
                if (lower.ends_with(" in")) lower.resize(lower.size() - 3);  // "Z in mm"
            }
    }
    if (result.unit.empty()) {
        const auto from = lower.find_last_of("[(_");
        const std::string word = unknown_unit(lower, from);
        if (!word.empty()) {
            result.unknown = word;
            lower.resize(from);
        }
    }
    for (const char c : lower)
        if (std::isalnum(static_cast<unsigned char>(c))) result.name += c;
    return result;
}

Expected<ReadProfiles> parse_profiles(std::string_view bytes, const std::string& where,
                                      const ProfileLayout& layout) {
    if (!layout.unit.empty() && !mm_of_unit(layout.unit))
        return usage_error(Text("\"{}\" is no unit of length", csv::shown(layout.unit)), "--unit",
                           "give mm, cm, m, um, nm, in or mil");
    ReadProfiles result;
    result.unit_asked = layout.unit.empty();
    // Our own form keeps its strict reader.
    if (layout.columns.empty() && is_own_form(bytes)) {
        SEAM_TRY(auto profile, parse_profile_csv(bytes, where, layout.invalid));
        if (std::none_of(profile.z_mm.begin(), profile.z_mm.end(),
                         [](double z) { return std::isfinite(z); }) &&
            !layout.invalid.empty())
            return input_error("every height stands for \"no return\"", where, "check --invalid");
        for (auto* column : {&profile.x_mm, &profile.z_mm})
            for (double& value : *column) value *= mm_of_unit(layout.unit).value_or(1);
        result.profiles.push_back({0, std::move(profile), {}});
        result.understood = "our own CSV (x_mm, z_mm)";
        return result;
    }
    SEAM_TRY(auto table, parse_points(bytes, where, kProfilePointLimit));
    SEAM_TRY(auto found, find_columns(table, layout, where));
    const PointRoles& c = found;
    bool asked_x = result.unit_asked, asked_z = result.unit_asked;
    SEAM_TRY(const double x_mm, factor(table, *c.x, layout, asked_x, where));
    SEAM_TRY(const double z_mm, factor(table, *c.z, layout, asked_z, where));
    result.unit_asked = asked_x || asked_z;
    double y_mm = 1;
    const bool flat = !c.y || (!table.in_base && constant(table.columns[*c.y]));
    if (!flat) {
        SEAM_TRY(y_mm, factor(table, *c.y, layout, asked_x, where));
    }
    const bool by_y = !flat && !table.in_base && !c.profile && steps(table.columns[*c.y]);
    const auto key = c.profile ? c.profile : by_y ? c.y : std::nullopt;
    std::set<double> seen;
    std::size_t block = 0, returns = 0, limits = 0, begin = 0;
    const bool in_plane = flat && !table.in_base;
    const auto one_profile = [&](std::size_t end) -> Expected<void> {
        const auto again = in_plane ? starts_over(table.columns[*c.x], begin, end) : std::nullopt;
        begin = end;
        if (!again) return {};
        return input_error("x starts over: there are several profiles and nothing numbers them",
                           table.at(where, *again),
                           "number them in a column \"profile\", or part them by blank lines");
    };
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const bool new_block = block < table.blocks.size() && table.blocks[block] == i;
        if (new_block) ++block;
        double number = static_cast<double>(block) - 1;
        if (key) number = table.columns[*key][i];
        if (std::isnan(number))
            return input_error("the number of the profile is missing", table.at(where, i));
        if (result.profiles.empty() || result.profiles.back().number != number) {
            if (!seen.insert(number).second)
                return input_error(Text("profile {} comes back after another one", number),
                                   table.at(where, i), "keep the rows of a profile together");
            SEAM_OK(one_profile(i));
            result.profiles.push_back({number, {}, {}});
        }
        ReadProfile& into = result.profiles.back();
        const double height = table.columns[*c.z][i];
        const bool limit = is_type_limit(height);
        limits += limit ? 1 : 0;
        const bool code = limit || std::count(layout.invalid.begin(), layout.invalid.end(), height) > 0;
        const double x = table.columns[*c.x][i] * x_mm,
                     z = code ? std::numeric_limits<double>::quiet_NaN() : height * z_mm;
        if (std::abs(x) > kFarthestPoint_mm || std::abs(z) > kFarthestPoint_mm)
            return input_error(Text("{} mm is beyond 1 km", std::abs(x) > kFarthestPoint_mm ? x : z),
                               table.at(where, i), "say what the numbers are in with --unit");
        const bool returned = !std::isnan(x) && !std::isnan(z);
        returns += returned ? 1 : 0;
        into.profile.x_mm.push_back(x);
        into.profile.z_mm.push_back(returned ? z : std::numeric_limits<double>::quiet_NaN());
        if (c.intensity) {
            const double grey = table.columns[*c.intensity][i];
            into.profile.intensity.push_back(std::isnan(grey) ? 0.0F : static_cast<float>(grey));
        }
        if (!flat && !by_y && !c.profile) into.y_mm.push_back(table.columns[*c.y][i] * y_mm);
    }
    SEAM_OK(one_profile(table.rows()));
    if (returns == 0) return input_error("no point has both x and z", where);
    result.understood = table.understood + ": " + told(table, c);
    if (limits > 0) result.understood += fmt::format(", {} heights at a limit taken for no return", limits);
    if (by_y) result.understood += ", one profile for every y";
    if (result.profiles.size() > 1) result.understood += fmt::format(", {} profiles", result.profiles.size());
    return result;
}

Expected<ReadProfiles> read_profiles(const std::filesystem::path& path, const ProfileLayout& layout) {
    SEAM_TRY(const auto bytes, read_text_file(path));
    return parse_profiles(bytes, path.string(), layout);
}

}  // namespace seamwright
