#include "devices/exchange/profile_csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "devices/exchange/files.h"

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kFarthest_mm = 1e6;

std::string_view trimmed(std::string_view s) {
    const auto first = s.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    s = s.substr(first, s.find_last_not_of(" \t") - first + 1);
    if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = trimmed(s.substr(1, s.size() - 2));
    return s;
}

// For messages: short and printable, whatever the file holds.
std::string shown(std::string_view field) {
    std::string s;
    for (char c : field.substr(0, 24)) s += (c >= 32 && c < 127) ? c : '?';
    if (field.size() > 24) s += "...";
    return s;
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

// A CSV table of numbers: names the columns that are wanted, then hands over their fields row by row.
class Table {
  public:
    Table(std::string_view text, std::string where) : lines_(text), where_(std::move(where)) {}

    // Reads the header; columns[i] becomes the column of wanted[i], -1 when absent.
    Expected<void> header(std::span<const std::string_view> wanted, std::size_t required) {
        if (text_is_utf16())
            return input_error("the text is UTF-16", where_, "save it as UTF-8 or plain ASCII");
        std::string_view line;
        if (lines_.only_blanks_left() || !lines_.next(line)) {
            return input_error("the file is empty", where_,
                               "the first line must be " + example(wanted, required));
        }
        if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
        for (const auto& [sign, name] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}}) {
            if (line.find(sign) != std::string_view::npos && line.find(',') == std::string_view::npos) {
                return input_error(fmt::format("the columns are separated by {}", name), at(),
                                   "separate them by commas and write decimal points, not decimal commas");
            }
        }
        split(line);
        columns_.assign(wanted.size(), -1);
        width_ = fields_.size();
        for (std::size_t c = 0; c < fields_.size(); ++c) {
            for (std::size_t w = 0; w < wanted.size(); ++w) {
                if (trimmed(fields_[c]) != wanted[w]) continue;
                if (columns_[w] >= 0)
                    return input_error(fmt::format("the column {} is named twice", wanted[w]), at());
                columns_[w] = static_cast<int>(c);
            }
        }
        for (std::size_t w = 0; w < required; ++w) {
            if (columns_[w] >= 0) continue;
            return input_error(fmt::format("the header \"{}\" has no column {}", shown(line), wanted[w]),
                               at(), "the first line must be " + example(wanted, required));
        }
        return {};
    }

    // False at the end.
    Expected<bool> row() {
        std::string_view line;
        if (lines_.only_blanks_left() || !lines_.next(line)) return false;
        split(line);
        if (fields_.size() == width_) return true;
        if (trimmed(line).empty()) {
            return input_error("the line is blank", at(),
                               "a point without return is a line with empty fields");
        }
        std::string mend;
        if (line.find(';') != std::string_view::npos) {
            mend = "separate the columns by commas and write decimal points";
        } else if (fields_.size() == 2 * width_) {
            mend = "these look like decimal commas: write decimal points";
        }
        return input_error(fmt::format("has {} fields where the header names {}", fields_.size(), width_),
                           at(), mend);
    }

    bool has(std::size_t wanted) const { return columns_[wanted] >= 0; }

    // NaN for an empty field or "nan".
    Expected<double> number(std::size_t wanted, std::string_view name) const {
        std::string_view field = trimmed(fields_[static_cast<std::size_t>(columns_[wanted])]);
        if (field.empty()) return kNaN;
        const std::string_view digits = field.front() == '+' ? field.substr(1) : field;
        double value = 0;
        const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (problem == std::errc::result_out_of_range) {
            return input_error(fmt::format("{} = \"{}\" does not fit a number", name, shown(field)), at());
        }
        if (problem != std::errc() || end != digits.data() + digits.size()) {
            const bool comma = field.find(';') != std::string_view::npos;
            return input_error(fmt::format("{} = \"{}\" is no number", name, shown(field)), at(),
                               comma ? "separate the columns by commas and write decimal points" : "");
        }
        if (std::isinf(value)) return input_error(fmt::format("{} is infinite", name), at());
        return value;
    }

    Expected<double> millimetres(std::size_t wanted, std::string_view name) const {
        auto value = number(wanted, name);
        if (value && std::abs(*value) > kFarthest_mm) {
            return input_error(fmt::format("{} = {} mm is beyond 1 km", name, *value), at(),
                               "give millimetres");
        }
        return value;
    }

    std::string at() const { return fmt::format("{}, line {}", where_, lines_.number()); }
    const std::string& where() const { return where_; }

  private:
    bool text_is_utf16() {
        Lines copy = lines_;
        std::string_view line;
        return copy.next(line) && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF"));
    }
    static std::string example(std::span<const std::string_view> wanted, std::size_t required) {
        std::string s;
        for (std::size_t w = 0; w < required; ++w) s += (w ? "," : "") + std::string(wanted[w]);
        return s + "[,intensity]";
    }
    void split(std::string_view line) {
        fields_.clear();
        std::size_t begin = 0;
        for (;;) {
            const auto comma = line.find(',', begin);
            fields_.push_back(line.substr(begin, comma - begin));
            if (comma == std::string_view::npos || fields_.size() > 4096) break;
            begin = comma + 1;
        }
    }

    Lines lines_;
    std::string where_;
    std::vector<int> columns_;
    std::vector<std::string_view> fields_;
    std::size_t width_ = 0;
};

// Appends the point of the current row. Column numbers as in the `wanted` list of the callers.
struct PointColumns {
    std::size_t x, z, intensity, valid, segment;
};

Expected<void> append_point(const Table& table, const PointColumns& c, Profile& profile) {
    if (profile.size() >= kProfilePointLimit) {
        return input_error(fmt::format("there are more than {} points", kProfilePointLimit), table.at());
    }
    const auto x = table.millimetres(c.x, "x_mm");
    if (!x) return tl::unexpected(x.error());
    const auto z = table.millimetres(c.z, "z_mm");
    if (!z) return tl::unexpected(z.error());
    const bool returned = !std::isnan(*x) && !std::isnan(*z);
    profile.x_mm.push_back(*x);
    profile.z_mm.push_back(returned ? *z : kNaN);
    if (table.has(c.intensity)) {
        const auto grey = table.number(c.intensity, "intensity");
        if (!grey) return tl::unexpected(grey.error());
        profile.intensity.push_back(std::isnan(*grey) ? 0.0F : static_cast<float>(*grey));
    }
    std::optional<bool> valid;
    if (table.has(c.valid)) {
        const auto value = table.number(c.valid, "valid");
        if (!value) return tl::unexpected(value.error());
        if (*value != 0 && *value != 1) return input_error("valid must be 0 or 1", table.at());
        valid = *value == 1;
    }
    if (table.has(c.segment)) {
        const auto value = table.number(c.segment, "segment");
        if (!value) return tl::unexpected(value.error());
        if (!(*value >= kOutlier && *value < 1e9) || *value != std::floor(*value)) {
            return input_error("segment must be a whole number from -1 on", table.at());
        }
        const auto segment = static_cast<std::int32_t>(*value);
        if (valid && *valid != (segment != kOutlier)) {
            return input_error(fmt::format("valid = {} contradicts segment = {}", *valid ? 1 : 0, segment),
                               table.at());
        }
        if (segment != kOutlier && !returned) {
            return input_error("a point without return cannot belong to a segment", table.at());
        }
        profile.segment.push_back(segment);
    } else if (valid) {
        if (*valid && !returned) return input_error("a point without return cannot be valid", table.at());
        profile.segment.push_back(*valid ? 0 : kOutlier);
    }
    return {};
}

void append_number(fmt::memory_buffer& out, double value) {
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(out), "{}", value);
}

}  // namespace

Expected<Profile> parse_profile_csv(std::string_view text, const std::string& where) {
    constexpr std::string_view wanted[] = {"x_mm", "z_mm", "intensity", "valid", "segment"};
    Table table(text, where);
    if (auto ok = table.header(wanted, 2); !ok) return tl::unexpected(ok.error());
    Profile profile;
    for (;;) {
        const auto more = table.row();
        if (!more) return tl::unexpected(more.error());
        if (!*more) break;
        if (auto ok = append_point(table, {0, 1, 2, 3, 4}, profile); !ok) return tl::unexpected(ok.error());
    }
    if (profile.size() == 0) return input_error("the profile has no points", where);
    return profile;
}

std::string profile_csv(const Profile& profile) {
    const bool grey = profile.intensity.size() == profile.size();
    const bool filtered = profile.filtered();
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "x_mm,z_mm{}{}\n", grey ? ",intensity" : "",
                   filtered ? ",valid,segment" : "");
    for (std::size_t i = 0; i < profile.size(); ++i) {
        append_number(out, profile.x_mm[i]);
        out.push_back(',');
        append_number(out, profile.z_mm[i]);
        if (grey) {
            out.push_back(',');
            if (std::isfinite(profile.intensity[i]))
                fmt::format_to(std::back_inserter(out), "{}", profile.intensity[i]);
        }
        if (filtered) {
            const auto s = profile.segment[i];
            fmt::format_to(std::back_inserter(out), ",{},{}", s != kOutlier ? 1 : 0, s);
        }
        out.push_back('\n');
    }
    return fmt::to_string(out);
}

Expected<Profile> read_profile_csv(const std::filesystem::path& path) {
    const auto text = read_text_file(path);
    if (!text) return tl::unexpected(text.error());
    return parse_profile_csv(*text, path.string());
}

Expected<void> write_profile_csv(const std::filesystem::path& path, const Profile& profile) {
    return write_text_file(path, profile_csv(profile));
}

Expected<std::vector<TravelProfile>> parse_align_csv(std::string_view text, const std::string& where) {
    constexpr std::string_view wanted[] = {"travel_mm", "profile_index", "x_mm",   "z_mm",
                                           "intensity", "valid",         "segment"};
    Table table(text, where);
    if (auto ok = table.header(wanted, 4); !ok) return tl::unexpected(ok.error());
    std::vector<TravelProfile> pass;
    std::set<long> seen;
    long current = -1;
    for (;;) {
        const auto more = table.row();
        if (!more) return tl::unexpected(more.error());
        if (!*more) break;
        const auto travel = table.millimetres(0, "travel_mm");
        if (!travel) return tl::unexpected(travel.error());
        if (std::isnan(*travel)) return input_error("travel_mm is missing", table.at());
        const auto index = table.number(1, "profile_index");
        if (!index) return tl::unexpected(index.error());
        if (!(*index >= 0 && *index < 1e9) || *index != std::floor(*index)) {
            return input_error("profile_index must be a whole number from 0 on", table.at());
        }
        const long number = static_cast<long>(*index);
        if (pass.empty() || number != current) {
            if (!seen.insert(number).second) {
                return input_error(fmt::format("profile {} comes back after another one", number), table.at(),
                                   "keep the rows of a profile together");
            }
            current = number;
            pass.push_back({*travel, {}});
        } else if (pass.back().travel_mm != *travel) {
            return input_error(fmt::format("travel_mm changes within profile {}", number), table.at());
        }
        if (auto ok = append_point(table, {2, 3, 4, 5, 6}, pass.back().profile); !ok)
            return tl::unexpected(ok.error());
    }
    if (pass.empty()) return input_error("there are no profiles", where);
    return pass;
}

std::string align_csv(std::span<const TravelProfile> pass) {
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "travel_mm,profile_index,x_mm,z_mm\n");
    for (std::size_t p = 0; p < pass.size(); ++p) {
        for (std::size_t i = 0; i < pass[p].profile.size(); ++i) {
            fmt::format_to(std::back_inserter(out), "{},{},", pass[p].travel_mm, p);
            append_number(out, pass[p].profile.x_mm[i]);
            out.push_back(',');
            append_number(out, pass[p].profile.z_mm[i]);
            out.push_back('\n');
        }
    }
    return fmt::to_string(out);
}

Expected<std::vector<TravelProfile>> read_align_csv(const std::filesystem::path& path) {
    const auto text = read_text_file(path);
    if (!text) return tl::unexpected(text.error());
    return parse_align_csv(*text, path.string());
}

}  // namespace seamwright
