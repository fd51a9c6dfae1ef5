#include "devices/exchange/tables/pose_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/profile/units.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/shown_text.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/json_poses.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/pose_form.h"
#include "devices/exchange/tables/profile_layout.h"
#include "devices/exchange/tables/program_poses.h"

namespace seamwright {
namespace {

// Titles that bind: numbers below them too are names, or the table is refused. Other columns show by their cells.
bool says_that_it_names(const std::string& n) {
    for (const char* known : {"name", "file", "filename", "spot", "spotid", "id", "point", "profile", "frame",
                              "label", "image", "pose", "no", "nr", "index", "number"})
        if (n == known) return true;
    return false;
}

// What a header says: which columns are the numbers, in the order of the convention, and which may be names.
struct PoseHeader {
    std::vector<std::size_t> numbers, names;
};

Expected<PoseHeader> read_header(const std::vector<std::string_view>& fields, PoseForm& form,
                                 const std::string& at) {
    std::multimap<std::string, std::size_t> columns;
    PoseHeader header;
    std::string length_unit, angle_unit;
    std::vector<ColumnName> names;
    for (std::size_t c = 0; c < fields.size(); ++c) {
        names.push_back(column_name(fields[c]));
        if (const std::string& n = names[c].name; n == "tx" || n == "ty" || n == "tz")
            names[c].name = n.substr(1);
        columns.emplace(names[c].name, c);
    }
    static const std::pair<const char*, std::vector<const char*>> rotations[] = {
        {"kuka-abc", {"a", "b", "c"}},           {"fanuc-wpr", {"w", "p", "r"}},
        {"rpy", {"roll", "pitch", "yaw"}},       {"quat-wxyz", {"qw", "qx", "qy", "qz"}},
        {"quat-wxyz", {"q1", "q2", "q3", "q4"}}, {"", {"rx", "ry", "rz"}}};
    // Of two columns of one title (a point "P" before W, P and R) that which goes on from the one before.
    std::string twice;
    const auto take = [&](const std::vector<const char*>& wanted) {
        std::vector<std::size_t> found;
        std::string_view again;
        for (const char* name : wanted) {
            const auto [first, last] = columns.equal_range(name);
            if (first == last) return std::vector<std::size_t>{};
            const std::size_t before = !found.empty()           ? found.back()
                                       : header.numbers.empty() ? fields.size()
                                                                : header.numbers.back();
            const auto next =
                std::find_if(first, last, [&](const auto& c) { return c.second == before + 1; });
            if (std::next(first) != last && next == last) again = fields[first->second];
            found.push_back(next != last ? next->second : first->second);
        }
        if (!again.empty()) twice = again;
        return found;
    };
    header.numbers = take({"x", "y", "z"});
    if (header.numbers.empty())
        return input_error("the header names no columns x, y and z", at,
                           "name them x, y, z and a rotation, or leave the header out");
    length_unit = names[header.numbers[0]].unit;
    for (const auto& [convention, wanted] : rotations) {
        const auto found = take(wanted);
        if (found.empty()) continue;
        angle_unit = names[found[0]].unit;
        header.numbers.insert(header.numbers.end(), found.begin(), found.end());
        const bool same = convention == std::string("fanuc-wpr") && form.convention == "rpy";
        // The titles name each number of a quaternion, whatever their order: either word for it fits.
        const bool named = convention == std::string("quat-wxyz") && wanted[0] == std::string("qw") &&
                           form.convention == "quat-xyzw";
        if (named) form.convention = convention;
        if (!form.convention.empty() && *convention && form.convention != convention && !same)
            return input_error(Text("the header names {}, --pose-convention {}", convention, form.convention),
                               at);
        if (form.convention.empty()) form.convention = convention;
        break;
    }
    if (!twice.empty())
        return input_error(Text("the header names \"{}\" twice", csv::shown(twice)), at,
                           "give every column a title of its own");
    for (std::size_t c = 0; c < fields.size(); ++c)
        if (std::find(header.numbers.begin(), header.numbers.end(), c) == header.numbers.end())
            header.names.push_back(c);
    if (header.numbers.size() == 3)
        return input_error("the header names no rotation that is known", at,
                           "name it a,b,c or w,p,r or roll,pitch,yaw or qw,qx,qy,qz or rx,ry,rz");
    if (const ColumnName& x = names[header.numbers[0]]; form.mm == 0 && !x.unknown.empty())
        return input_error(Text("the unit \"{}\" of the column \"{}\" is not known", csv::shown(x.unknown),
                                csv::shown(fields[header.numbers[0]])),
                           at, "say what the positions are in with --pose-unit");
    if (form.mm == 0) form.mm = mm_of_unit(length_unit).value_or(0);
    if (form.rad == 0) form.rad = angle_unit == "deg" ? kPi / 180 : angle_unit == "rad" ? 1 : 0;
    return header;
}

char separator_of(std::string_view text) {
    for (const char sign : {';', '\t', ','})
        if (text.find(sign) != std::string_view::npos) {
            // "1,5 2,5": the commas are the decimal signs of numbers between blanks
            if (sign != ',' || text.find(", ") != std::string_view::npos ||
                text.find('.') != std::string_view::npos)
                return sign;
            const auto line = text.substr(0, text.find('\n'));
            return text_fields(line, ' ').size() >= 4 ? ' ' : sign;
        }
    return ' ';
}

// Poses as a robot's own words print them, a line each, as rows of numbers in the same lines; empty: no such text.
//     p[0.8, -0.1, 0.6, 2.2, 2.2, 0.04]        UR: metre, rotation vector
//     {X 812.4,Y -103.9,Z 655,A 91.2,B -1.1,C 178.8}     KUKA
std::string rows_of_frames(std::string_view text, PoseForm& form) {
    std::string rows;
    bool ur = false, kuka = false;
    csv::Lines lines(text);
    std::string_view line;
    while (lines.next(line)) {
        std::string row(csv::blanks_off(line));
        const bool vector = row.starts_with("p[") && row.ends_with("]");
        const bool frame = row.starts_with("{") && row.ends_with("}") && row.find(':') == row.npos;
        if (!row.empty() && !vector && !frame) return {};
        ur = ur || vector, kuka = kuka || frame;
        std::string numbers;
        const std::string_view inside =
            row.empty() ? std::string_view{}
                        : std::string_view(row).substr(vector ? 2 : 1, row.size() - (vector ? 3 : 2));
        constexpr std::string_view kLetters = "XYZABC";
        std::size_t place = 0;
        for (std::string_view field : text_fields(inside, ',')) {
            if (frame && place < kLetters.size()) {
                if (field.empty() ||
                    std::toupper(static_cast<unsigned char>(field.front())) != kLetters[place])
                    return {};
                field.remove_prefix(1);
            }
            if (frame && place >= kLetters.size()) break;  // S, T, E1..
            numbers += (place++ ? "," : "") + std::string(csv::blanks_off(field));
        }
        rows += numbers + "\n";
    }
    if (ur == kuka) return {};
    if (form.convention.empty()) form.convention = ur ? "ur-rotvec" : "kuka-abc";
    if (ur && form.mm == 0) form.mm = 1000;
    return rows;
}

// As the text has them.
Expected<PoseTable> table_of(std::string_view text, const std::string& where, const PoseLayout& layout) {
    if (is_utf16(text)) return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    const std::string with_newlines = csv::old_line_ends(text) ? csv::new_line_ends(text) : std::string();
    if (!with_newlines.empty()) text = with_newlines;
    SEAM_TRY(PoseForm form, pose_form(layout));
    const auto start = text.find_first_not_of(" \t\r\n");
    if (start == text.npos) return input_error("the file is empty", where);
    const bool frame_of_kuka = text[start] == '{' && text.substr(start + 1, 1).find_first_of("Xx") == 0;
    if ((text[start] == '{' && !frame_of_kuka) || text.substr(start, 2) == "[{")
        return parse_json_poses(text, where, layout);
    if (auto program = parse_program_poses(text, where)) {
        if (*program) SEAM_OK(check_said(layout, (*program)->says, where));
        return std::move(*program);
    }

    const std::string bare_rows = rows_of_frames(text, form);
    if (!bare_rows.empty()) text = bare_rows;
    const char separator = separator_of(text);
    const bool decimal_comma = separator != ',' && text.find(',') != text.npos && text.find('.') == text.npos;
    std::vector<WrittenRow> rows;
    PoseTable table;
    std::optional<PoseHeader> header;
    std::size_t width = 0;
    csv::Lines lines(text);
    std::string_view line;
    while (lines.next(line)) {
        const std::string_view bare = csv::blanks_off(line);
        const std::string at = fmt::format("{}, line {}", where, lines.number());
        if (bare.empty()) continue;
        const bool comment = bare.starts_with("#") || bare.starts_with("%") || bare.starts_with("//");
        auto fields = text_fields(comment ? bare.substr(bare.find_first_not_of("#%/ \t") == bare.npos
                                                            ? bare.size()
                                                            : bare.find_first_not_of("#%/ \t"))
                                          : bare,
                                  separator);
        if (!fields.empty() && fields.back().empty()) fields.pop_back();
        double first = 0, last = 0;
        const bool numbers = fields.size() >= 2 && text_number(fields.back(), decimal_comma, last) &&
                             text_number(fields[fields.size() - 2], decimal_comma, first);
        if (!numbers && rows.empty() && !header && fields.size() >= 6) {
            auto read = read_header(fields, form, at);
            if (read) {
                header = std::move(*read);
                width = fields.size();
                for (const std::size_t c : header->names)
                    table.names.push_back({says_that_it_names(column_name(fields[c]).name)
                                               ? PoseNames::Says::names
                                               : PoseNames::Says::nothing,
                                           std::string(fields[c]),
                                           {}});
            } else if (!comment) {
                return tl::unexpected(read.error());
            }
            continue;
        }
        if (comment) continue;
        if (width == 0) width = fields.size();
        if (fields.size() != width)
            return input_error(Text("has {} fields where the other lines have {}", fields.size(), width), at);
        WrittenRow row;
        row.at = at;
        std::vector<std::size_t> order;
        if (header) {
            order = header->numbers;
            for (std::size_t i = 0; i < header->names.size(); ++i)
                table.names[i].cells.emplace_back(fields[header->names[i]]);
        } else {
            double ignored = 0;
            const bool odd = width == 7 && layout.convention != "quat-wxyz" &&
                             layout.convention != "quat-xyzw" && !layout.convention.empty();
            // The first row decides: in all of them the same columns are the numbers.
            if (rows.empty() && (!text_number(fields[0], decimal_comma, ignored) || odd || width == 8 ||
                                 width == 13 || width == 17))
                table.names.push_back({PoseNames::Says::names, "", {}});
            const bool named = !table.names.empty();
            if (named) table.names.front().cells.emplace_back(fields[0]);
            for (std::size_t i = named ? 1 : 0; i < width; ++i) order.push_back(i);
        }
        for (const std::size_t i : order) {
            double value = 0;
            if (!text_number(fields[i], decimal_comma, value) || std::isnan(value))
                return input_error(Text("\"{}\" is no number", csv::shown(fields[i])), at);
            row.numbers.push_back(value);
        }
        rows.push_back(std::move(row));
        if (rows.size() > 4 * kPoseLimit) return input_error("there are more poses than a million", where);
    }
    if (rows.empty()) return input_error("there are no poses", where);
    if (width == 4 && !header) {  // stacked 4x4
        if (rows.size() % 4 != 0)
            return input_error(Text("{} rows of four numbers are no 4x4 matrices", rows.size()), where);
        std::vector<WrittenRow> stacked;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].numbers.size() != 4) return input_error("is no row of a 4x4 matrix", rows[i].at);
            if (i % 4 == 0) stacked.push_back({rows[i].at, {}});
            stacked.back().numbers.insert(stacked.back().numbers.end(), rows[i].numbers.begin(),
                                          rows[i].numbers.end());
        }
        rows = std::move(stacked);
    }
    SEAM_OK(check_width(form, rows.front().numbers.size(), rows.front().at));
    SEAM_OK(settle_units(form, rows, where));
    for (const WrittenRow& row : rows) {
        SEAM_TRY(auto pose, pose_of(form, row));
        table.poses.push_back({pose, row.at});
    }
    if (table.names.size() == 1 && table.names.front().says == PoseNames::Says::names) {
        std::set<std::string> given;
        const auto& cells = table.names.front().cells;
        for (std::size_t i = 0; i < cells.size(); ++i)
            if (!cells[i].empty() && !given.insert(cells[i]).second)
                return input_error(Text("the pose \"{}\" is given twice", csv::shown(cells[i])), rows[i].at);
    }
    table.understood =
        fmt::format("{} poses, {}, {} mm a unit", table.poses.size(), form.convention, form.mm);
    return table;
}

// From the tool in the frame that the layout names to the flange in the robot's base.
void bring_to_flange(PoseTable& table, const PoseLayout& layout) {
    for (TablePose& p : table.poses) p.pose = brought_to_flange(p.pose, layout);
    if (layout.flange_from_tool || layout.base_from_user_frame)
        table.understood +=
            fmt::format(", brought {}{}", layout.flange_from_tool ? "from the tool to the flange" : "",
                        layout.base_from_user_frame ? fmt::format("{}from the user frame to the robot's base",
                                                                  layout.flange_from_tool ? " and " : "")
                                                    : "");
    else if (table.of_own_frames)
        table.understood +=
            ", TAKEN AS THE FLANGE IN THE ROBOT'S BASE: a tool or user frame that is not zero is said by "
            "--flange-from-tool and --base-from-user-frame";
}

}  // namespace

Expected<PoseTable> parse_pose_table(std::string_view text, const std::string& where,
                                     const PoseLayout& layout) {
    SEAM_TRY(auto table, table_of(text, where, layout));
    bring_to_flange(table, layout);
    return table;
}

Expected<PoseTable> read_pose_table(const std::filesystem::path& path, const PoseLayout& layout) {
    SEAM_TRY(const auto text, read_text_file(path));
    return parse_pose_table(text, path.string(), layout);
}

namespace {

constexpr std::size_t kMostOfAPoseFile = std::size_t{1} << 20;

// Of a form that is no JSON.
Expected<Pose> read_frame_pose(const std::filesystem::path& path, const PoseLayout& layout) {
    const std::string where = path.string();
    const bool listed = path.extension() != ".txt";
    SEAM_TRY(const auto text, read_text_file(path, kMostOfAPoseFile));
    std::size_t numbers = 0, at = 0;
    constexpr std::string_view separators = "()[], \t\r\n;";
    while ((at = text.find_first_not_of(separators, at)) != std::string::npos) {
        ++numbers;
        at = std::min(text.find_first_of(separators, at), text.size());
    }
    const bool plain = layout.convention.empty() && layout.unit.empty() && layout.angle.empty();
    if (listed || (plain && numbers != 6 && numbers != 12 && numbers != 16)) {
        SEAM_OK(check_said(layout, {"quat-xyzw", "m", kNoAngles}, where));
        SEAM_TRY(const auto pose, read_pose_file(path));
        return brought_to_flange(pose, layout);
    }
    SEAM_TRY(auto table, parse_pose_table(text, where, layout));
    if (table.poses.size() != 1)
        return input_error(Text("holds {} poses beside one frame", table.poses.size()), where);
    return table.poses.front().pose;
}

}  // namespace

Expected<std::vector<Pose>> read_frame_poses(std::span<const std::filesystem::path> files,
                                             const PoseLayout& layout) {
    std::vector<Pose> poses(files.size(), Pose::Identity());
    std::vector<std::filesystem::path> json;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (files[i].extension() == ".json") {
            json.push_back(files[i]);
            places.push_back(i);
            continue;
        }
        SEAM_TRY(poses[i], read_frame_pose(files[i], layout));
    }
    if (json.empty()) return poses;
    SEAM_TRY(const auto read, read_json_poses(json, layout));
    for (std::size_t i = 0; i < read.size(); ++i) poses[places[i]] = read[i];
    return poses;
}

}  // namespace seamwright
