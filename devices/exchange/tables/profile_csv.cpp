#include "devices/exchange/tables/profile_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/profile/no_return.h"
#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Appends the point of the current row. Column numbers as in the `wanted` list of the callers.
struct PointColumns {
    std::size_t x, z, intensity, valid, segment;
};

Expected<void> append_point(const CsvTable& table, const PointColumns& c, Profile& profile,
                            std::span<const double> no_returns = {}) {
    if (profile.size() >= kProfilePointLimit) {
        return input_error(Text("there are more than {} points", kProfilePointLimit), table.at());
    }
    SEAM_TRY(const auto x, table.millimetres(c.x, "x_mm"));
    SEAM_TRY(auto z, table.number(c.z, "z_mm"));
    if (is_type_limit(z) || std::find(no_returns.begin(), no_returns.end(), z) != no_returns.end()) z = kNaN;
    if (!std::isnan(z)) SEAM_OK(table.millimetres(c.z, "z_mm"));
    const bool returned = !std::isnan(x) && !std::isnan(z);
    profile.x_mm.push_back(x);
    profile.z_mm.push_back(returned ? z : kNaN);
    if (table.has(c.intensity)) {
        SEAM_TRY(const auto grey, table.number(c.intensity, "intensity"));
        profile.intensity.push_back(std::isnan(grey) ? 0.0F : static_cast<float>(grey));
    }
    std::optional<bool> valid;
    if (table.has(c.valid)) {
        SEAM_TRY(const auto value, table.number(c.valid, "valid"));
        if (value != 0 && value != 1) return input_error("valid must be 0 or 1", table.at());
        valid = value == 1;
    }
    if (table.has(c.segment)) {
        SEAM_TRY(const auto value, table.number(c.segment, "segment"));
        if (!(value >= kOutlier && value < 1e9) || value != std::floor(value)) {
            return input_error("segment must be a whole number from -1 on", table.at());
        }
        const auto segment = static_cast<std::int32_t>(value);
        if (valid && *valid != (segment != kOutlier)) {
            return input_error(Text("valid = {} contradicts segment = {}", *valid ? 1 : 0, segment),
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

Expected<Profile> parse_profile_csv(std::string_view text, const std::string& where,
                                    std::span<const double> no_returns) {
    constexpr std::string_view wanted[] = {"x_mm", "z_mm", "intensity", "valid", "segment"};
    CsvTable table(text, where, "[,intensity]");
    SEAM_OK(table.header(wanted, 2));
    Profile profile;
    for (;;) {
        SEAM_TRY(const auto more, table.row());
        if (!more) break;
        SEAM_OK(append_point(table, {0, 1, 2, 3, 4}, profile, no_returns));
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
    SEAM_TRY(const auto text, read_text_file(path));
    return parse_profile_csv(text, path.string());
}

Expected<void> write_profile_csv(const std::filesystem::path& path, const Profile& profile) {
    return write_text_file(path, profile_csv(profile));
}

Expected<std::vector<TravelProfile>> parse_align_csv(std::string_view text, const std::string& where) {
    constexpr std::string_view wanted[] = {"travel_mm", "profile_index", "x_mm",   "z_mm",
                                           "intensity", "valid",         "segment"};
    CsvTable table(text, where, "[,intensity]");
    SEAM_OK(table.header(wanted, 4));
    std::vector<TravelProfile> pass;
    std::set<long> seen;
    long current = -1;
    for (;;) {
        SEAM_TRY(const auto more, table.row());
        if (!more) break;
        SEAM_TRY(const auto travel, table.millimetres(0, "travel_mm"));
        if (std::isnan(travel)) return input_error("travel_mm is missing", table.at());
        SEAM_TRY(const auto index, table.number(1, "profile_index"));
        if (!(index >= 0 && index < 1e9) || index != std::floor(index)) {
            return input_error("profile_index must be a whole number from 0 on", table.at());
        }
        const long number = static_cast<long>(index);
        if (pass.empty() || number != current) {
            if (!seen.insert(number).second) {
                return input_error(Text("profile {} comes back after another one", number), table.at(),
                                   "keep the rows of a profile together");
            }
            current = number;
            pass.push_back({travel, {}});
        } else if (pass.back().travel_mm != travel) {
            return input_error(Text("travel_mm changes within profile {}", number), table.at());
        }
        SEAM_OK(append_point(table, {2, 3, 4, 5, 6}, pass.back().profile));
    }
    if (pass.empty()) return input_error("there are no profiles", where);
    return pass;
}

std::string align_csv(std::span<const TravelProfile> pass) {
    fmt::memory_buffer out;
    fmt::format_to(std::back_inserter(out), "travel_mm,profile_index,x_mm,z_mm\n");
    for (std::size_t p = 0; p < pass.size(); ++p) {
        if (pass[p].profile.size() == 0)  // nothing was seen there, which is told as well
            fmt::format_to(std::back_inserter(out), "{},{},,\n", pass[p].travel_mm, p);
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
    SEAM_TRY(const auto text, read_text_file(path));
    return parse_align_csv(text, path.string());
}

}  // namespace seamwright
