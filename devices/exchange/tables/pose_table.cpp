#include "devices/exchange/tables/pose_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/geometry/notation.h"
#include "core/profile/units.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/shown_text.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/profile_layout.h"
#include "devices/exchange/tables/program_poses.h"

namespace seamwright {
namespace {

constexpr double kNearForMillimetres = 100;  // no robot measures with its flange within 100 mm of its base

struct PoseRow {
    std::string at;
    std::vector<double> numbers;
};

// The numbers of a pose: 3 of the position, then those of the rotation; or 12 or 16 of a matrix.
struct PoseForm {
    std::string convention;
    double mm = 0;   // of a unit of length; 0: not known
    double rad = 0;  // of a unit of angle; 0: not known
};

// Titles that bind: numbers below them too are names, or the table is refused. Other columns show by their cells.
bool says_that_it_names(const std::string& n) {
    for (const char* known : {"name", "file", "filename", "spot", "spotid", "id", "point", "profile", "frame",
                              "label", "image", "pose", "no", "nr", "index", "number"})
        if (n == known) return true;
    return false;
}

Expected<Eigen::Matrix3d> rotation(const PoseForm& form, const std::vector<double>& n,
                                   const std::string& at) {
    const double deg = form.rad * 180 / kPi;
    if (form.convention == "kuka-abc") return rotation_from_kuka({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "fanuc-wpr" || form.convention == "rpy")
        return rotation_from_fanuc({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "ur-rotvec") return rotation_exp(form.rad * Eigen::Vector3d(n[3], n[4], n[5]));
    if (form.convention == "zyz") return rotation_from_zyz({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "quat-wxyz") return rotation_from_abb({n[3], n[4], n[5], n[6]}, at);
    return rotation_from_abb({n[6], n[3], n[4], n[5]}, at);
}

Expected<Pose> pose_of(const PoseForm& form, const PoseRow& row) {
    const auto& n = row.numbers;
    if (form.convention == "matrix") {
        Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
        for (std::size_t i = 0; i < n.size(); ++i)
            m(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = n[i];
        if (n.size() == 16 && m.col(3).head<3>().isZero(1e-9) && !m.row(3).head<3>().isZero(1e-9))
            return input_error("the position stands in the last row of the matrix", row.at,
                               "write it transposed");
        m.col(3).head<3>() *= form.mm;
        if (m.col(3).head<3>().cwiseAbs().maxCoeff() > kFarthestPose_mm)
            return input_error("the position exceeds 100 m", row.at, "say the unit with --pose-unit");
        return pose_from_matrix(m, row.at);
    }
    const Eigen::Vector3d t = form.mm * Eigen::Vector3d(n[0], n[1], n[2]);
    if (t.cwiseAbs().maxCoeff() > kFarthestPose_mm)
        return input_error("the position exceeds 100 m", row.at, "say the unit with --pose-unit");
    SEAM_TRY(auto r, rotation(form, n, row.at));
    return make_pose(r, t);
}

// One pose in metres among others in millimetres: it stands next to the base, and a thousandfold where the others do.
Expected<void> check_one_unit(const std::vector<PoseRow>& rows, bool matrix) {
    constexpr double kNear = 10, kAlike = 3;
    const auto reach = [&](const PoseRow& row) {
        const auto& n = row.numbers;
        return matrix ? std::hypot(n[3], n[7], n[11]) : std::hypot(n[0], n[1], n[2]);
    };
    std::vector<double> reaches;
    for (const PoseRow& row : rows) reaches.push_back(reach(row));
    const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
    std::nth_element(reaches.begin(), middle, reaches.end());
    for (const PoseRow& row : rows) {
        const double mm = reach(row), if_metres = 1000 * mm;
        if (mm<kNear&& * middle> kNearForMillimetres && if_metres > *middle / kAlike &&
            if_metres < *middle * kAlike)
            return input_error(
                Text("its position is {:.4g} from the base where the others are about {:.4g}: metres among "
                     "millimetres",
                     mm, *middle),
                row.at, "write all positions in one unit, or say with --pose-unit mm that they are");
    }
    return {};
}

// Units that neither person nor header named: usual ones, unless the numbers speak against them.
Expected<void> settle_units(PoseForm& form, const std::vector<PoseRow>& rows, const std::string& where) {
    const bool matrix = form.convention == "matrix";
    double farthest = 0, widest = 0;
    for (const PoseRow& row : rows) {
        for (std::size_t i = 0; i < 3; ++i)
            farthest = std::max(farthest, std::abs(row.numbers[matrix ? 4 * i + 3 : i]));
        for (std::size_t i = 3; !matrix && i < 6; ++i) widest = std::max(widest, std::abs(row.numbers[i]));
    }
    if (form.mm == 0) {
        if (farthest > 0 && farthest < kNearForMillimetres)
            return input_error(
                Text("no position is farther than {:.4g}, which looks like metres or inches", farthest),
                where, "say the unit with --pose-unit mm, m or in");
        if (farthest > kFarthestPose_mm)
            return input_error(Text("positions reach {:.4g}, which looks like micrometres", farthest), where,
                               "say the unit with --pose-unit mm or um");
        SEAM_OK(check_one_unit(rows, matrix));
        form.mm = 1;
    }
    const bool angles = !matrix && !form.convention.starts_with("quat");
    if (angles && form.rad == 0) {
        const bool radian = form.convention == "ur-rotvec";
        if (radian ? widest > 2 * kPi + 1e-6 : widest > 0 && widest <= 2 * kPi)
            return input_error(
                Text("no angle exceeds {:.4g}, which looks like {}", widest, radian ? "degrees" : "radian"),
                where, "say the unit with --pose-angle deg or rad");
        form.rad = radian ? 1 : kPi / 180;
    }
    return {};
}

Expected<void> check_width(PoseForm& form, std::size_t width, const std::string& where) {
    if (form.convention.empty()) {
        if (width == 12 || width == 16) {
            form.convention = "matrix";
        } else if (width == 6) {
            return input_error("six numbers are a pose in several ways", where,
                               "say which with --pose-convention kuka-abc, fanuc-wpr, rpy, ur-rotvec or zyz");
        } else if (width == 7) {
            return input_error("seven numbers are a frame's number and six, or a position and a quaternion",
                               where,
                               "say which with --pose-convention: one of the six, or quat-wxyz or quat-xyzw");
        }
    }
    const bool fits = form.convention == "matrix"           ? width == 12 || width == 16
                      : form.convention.starts_with("quat") ? width == 7
                                                            : width == 6;
    if (!fits)
        return input_error(form.convention.empty()
                               ? Text("{} numbers are no pose", width)
                               : Text("{} numbers are no pose of the form {}", width, form.convention),
                           where, "give x, y, z and a rotation, or a 4x4 matrix");
    return {};
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

Expected<PoseTable> from_json(std::string_view text, const std::string& where) {
    SEAM_TRY(const auto json, parse_json(text, where));
    PoseTable table;
    table.understood = fmt::format("{} JSON poses", json.size());
    if (json.is_array()) {
        for (std::size_t i = 0; i < json.size(); ++i) {
            SEAM_TRY(auto pose, parse_pose(json[i], json_path(where, i)));
            table.poses.push_back({pose, json_path(where, i)});
        }
    } else if (json.is_object()) {
        table.names.push_back({PoseNames::Says::names, "", {}});
        for (const auto& [name, value] : json.items()) {
            SEAM_TRY(auto pose, parse_pose(value, where + ": " + csv::shown(name)));
            table.poses.push_back({pose, where + ": " + csv::shown(name)});
            table.names.front().cells.push_back(name);
        }
    }
    if (table.poses.empty())
        return input_error("there are no poses", where, "give {\"NAME\": POSE, ..} or [POSE, ..]");
    return table;
}

// As the text has them.
Expected<PoseTable> table_of(std::string_view text, const std::string& where, const PoseLayout& layout) {
    if (is_utf16(text)) return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    PoseForm form{layout.convention, 0, 0};
    if (!layout.convention.empty() && std::find(std::begin(kPoseConventions), std::end(kPoseConventions),
                                                layout.convention) == std::end(kPoseConventions))
        return usage_error(Text("\"{}\" is no convention of poses", csv::shown(layout.convention)),
                           "--pose-convention");
    if (!layout.unit.empty()) {
        const auto mm = mm_of_unit(layout.unit);
        if (!mm)
            return usage_error(Text("\"{}\" is no unit of length", csv::shown(layout.unit)), "--pose-unit");
        form.mm = *mm;
    }
    if (!layout.angle.empty()) {
        if (layout.angle != "deg" && layout.angle != "rad")
            return usage_error(Text("\"{}\" is no unit of angle", csv::shown(layout.angle)), "--pose-angle");
        form.rad = layout.angle == "deg" ? kPi / 180 : 1;
    }
    const auto start = text.find_first_not_of(" \t\r\n");
    if (start == text.npos) return input_error("the file is empty", where);
    if (text[start] == '{' || text.substr(start, 2) == "[{") return from_json(text, where);
    if (auto program = parse_program_poses(text, where)) return std::move(*program);

    const char separator = separator_of(text);
    const bool decimal_comma = separator != ',' && text.find(',') != text.npos && text.find('.') == text.npos;
    std::vector<PoseRow> rows;
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
        PoseRow row;
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
        std::vector<PoseRow> stacked;
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
    for (const PoseRow& row : rows) {
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
    const Pose tool_from_flange = layout.flange_from_tool.value_or(Pose::Identity()).inverse();
    const Pose base_from_user_frame = layout.base_from_user_frame.value_or(Pose::Identity());
    for (TablePose& p : table.poses) p.pose = base_from_user_frame * p.pose * tool_from_flange;
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

bool PoseLayout::says_nothing() const {
    return convention.empty() && unit.empty() && angle.empty() && !flange_from_tool && !base_from_user_frame;
}

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

Expected<Pose> read_frame_pose(const std::filesystem::path& path, const PoseLayout& layout) {
    const std::string extension = path.extension().string();
    if (extension != ".txt") return read_pose_file(path);
    SEAM_TRY(const auto text, read_text_file(path, std::size_t{1} << 20));
    const auto numbers = [&] {
        std::size_t count = 0, at = 0;
        constexpr std::string_view separators = "()[], \t\r\n;";
        while ((at = text.find_first_not_of(separators, at)) != std::string::npos) {
            ++count;
            at = std::min(text.find_first_of(separators, at), text.size());
        }
        return count;
    }();
    const bool usual = numbers != 6 && numbers != 12 && numbers != 16 && layout.says_nothing();
    if (usual) return read_pose_file(path);
    SEAM_TRY(auto table, parse_pose_table(text, path.string(), layout));
    if (table.poses.size() != 1)
        return input_error(Text("holds {} poses beside one frame", table.poses.size()), path.string());
    return table.poses.front().pose;
}

}  // namespace seamwright
