#include "devices/exchange/tables/program_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/geometry/notation.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/words/tokens.h"

namespace seamwright {
namespace {

using program_path::Cursor;
using program_path::Dialect;
using program_path::Expr;
using program_path::Misread;
using program_path::Token;

Expected<Pose> placed(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& mm, const std::string& at) {
    if (!mm.allFinite() || !rotation.allFinite()) return input_error("a number is not finite", at);
    if (mm.cwiseAbs().maxCoeff() > kFarthestPose_mm) return input_error("the position exceeds 100 m", at);
    return make_pose(rotation, mm);
}

void understand(PoseTable& table, std::string_view brand, const std::string& frames) {
    const bool abb = brand == "ABB";
    table.says = {abb                ? "quat-wxyz"
                  : brand == "FANUC" ? "fanuc-wpr"
                                     : "kuka-abc",
                  "mm", abb ? kNoAngles : "deg"};
    table.understood =
        fmt::format("{} {} positions{}{}", table.poses.size(), brand, frames.empty() ? "" : " in ", frames);
    table.of_own_frames = frames.empty() || frames.find_first_of("123456789?") != frames.npos;
}

Expected<PoseTable> fanuc_poses(std::string_view text, const std::string& where) {
    PoseTable table;
    table.names.push_back({PoseNames::Says::remarks, "", {}});
    const auto positions = text.find("/POS");
    if (positions == std::string_view::npos) return input_error("the program has no /POS", where);
    std::size_t line = 1 + static_cast<std::size_t>(std::count(
                               text.begin(), text.begin() + static_cast<std::ptrdiff_t>(positions), '\n'));
    std::string_view rest = text.substr(positions);
    std::string frames;
    for (std::size_t at; (at = rest.find("P[")) != std::string_view::npos;) {
        line += static_cast<std::size_t>(
            std::count(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
        rest.remove_prefix(at);
        const auto close = rest.find(']'), open = rest.find('{'), end = rest.find('}');
        TablePose pose;
        pose.at = fmt::format("{}, line {}", where, line);
        if (close == rest.npos || open == rest.npos || end == rest.npos || close > open || open > end)
            return input_error("the position does not end", pose.at, "the file is cut short");
        const std::string_view label = rest.substr(2, close - 2),
                               body = rest.substr(open + 1, end - open - 1);
        const auto colon = label.find(':');
        table.names.front().cells.emplace_back(
            csv::trimmed(colon == label.npos ? label : label.substr(colon + 1)));
        const auto after = [&](std::string_view key, char sign) -> std::optional<std::string_view> {
            for (std::size_t from = 0; (from = body.find(key, from)) != body.npos; from += key.size()) {
                const bool starts =
                    from == 0 || std::string_view(" \t\r\n,;:").find(body[from - 1]) != body.npos;
                const auto value = csv::blanks_off(body.substr(from + key.size()));
                if (starts && value.starts_with(sign)) {
                    const auto v = csv::blanks_off(value.substr(1));
                    return v.substr(0, v.find_first_of(" \t\r\n,;"));
                }
            }
            return std::nullopt;
        };
        if (after("J1", '='))
            return input_error("is given in joint angles", pose.at, "store it as Cartesian");
        std::array<double, 6> values{};
        const char* keys[] = {"X", "Y", "Z", "W", "P", "R"};
        for (std::size_t i = 0; i < 6; ++i) {
            const auto value = after(keys[i], '=');
            double number = 0;
            if (!value || !text_number(*value, false, number) || std::isnan(number))
                return input_error(Text("{} is {}", keys[i], value ? "no number" : "missing"), pose.at);
            values[i] = number;
        }
        const std::string here = fmt::format("UF {}, UT {}", csv::shown(after("UF", ':').value_or("?")),
                                             csv::shown(after("UT", ':').value_or("?")));
        if (!frames.empty() && frames != here)
            return input_error(Text("is in {}, those before in {}", here, frames), pose.at,
                               "give poses of one user frame and one tool");
        frames = here;
        SEAM_TRY(pose.pose, placed(rotation_from_fanuc({values[3], values[4], values[5]}),
                                   {values[0], values[1], values[2]}, pose.at));
        table.poses.push_back(std::move(pose));
        line += static_cast<std::size_t>(
            std::count(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
        rest.remove_prefix(end);
        if (table.poses.size() > kPoseLimit) return input_error("there are more poses than a million", where);
    }
    if (table.poses.empty()) return input_error("there are no positions behind /POS", where);
    understand(table, "FANUC", frames);
    return table;
}

// The declarations of a program, without what separates lines.
std::vector<Token> words_of(std::string_view text, Dialect dialect) {
    std::vector<Token> words = program_path::tokens_of(text, dialect);
    std::erase_if(words, [](const Token& t) { return t.kind == Token::Kind::newline; });
    return words;
}

// Adds a point; its name must be new.
Expected<void> put(PoseTable& table, std::set<std::string>& given, const std::string& name, const Pose& pose,
                   const std::string& at) {
    if (table.poses.size() >= kPoseLimit) return input_error("there are more poses than a million", at);
    if (!given.insert(name).second)
        return input_error(Text("the pose \"{}\" is given twice", csv::shown(name)), at);
    table.poses.push_back({pose, at});
    table.names.front().cells.push_back(name);
    return {};
}

std::optional<double> number_of(const Expr* e) {
    if (!e) return std::nullopt;
    if (e->kind == Expr::Kind::number) return e->number;
    if (e->kind != Expr::Kind::unary || e->parts.size() != 1) return std::nullopt;
    const auto inner = number_of(e->parts[0].value.get());
    if (!inner || (e->text != "-" && e->text != "+")) return std::nullopt;
    return e->text == "-" ? -*inner : *inner;
}

// What stands from the word `from` on, and the word behind it in `next`.
Expected<program_path::ExprPtr> value_from(const std::vector<Token>& words, std::size_t from, Dialect dialect,
                                           const std::string& name, const std::string& at,
                                           std::size_t& next) {
    Cursor cursor(std::span<const Token>{words}.subspan(from));
    try {
        auto value = program_path::read_expression(cursor, dialect);
        next = from + cursor.at();
        return value;
    } catch (const Misread&) {
        return input_error(Text("the position {} does not end", csv::shown(name)), at,
                           "the file is cut short");
    }
}

const Expr* component(const Expr& record, std::string_view name) {
    for (const auto& part : record.parts)
        if (part.name == name) return part.value.get();
    return nullptr;
}

// Base and tool that an inline form names in FDAT, by the point's name without its X or F.
std::map<std::string, std::string> inline_frames(const std::vector<Token>& words) {
    std::map<std::string, std::string> out;
    for (std::size_t i = 0; i + 3 < words.size(); ++i) {
        if (words[i].text != "FDAT" || words[i + 1].kind != Token::Kind::name || words[i + 2].text != "=")
            continue;
        Cursor cursor(std::span<const Token>{words}.subspan(i + 3));
        try {
            const auto value = program_path::read_expression(cursor, Dialect::krl);
            const auto base = number_of(component(*value, "BASE_NO")),
                       tool = number_of(component(*value, "TOOL_NO"));
            if (base && tool)
                out[words[i + 1].text.substr(1)] = fmt::format("BASE_DATA[{}], TOOL_DATA[{}]", *base, *tool);
        } catch (const Misread&) {  // names no frames then
        }
    }
    return out;
}

Expected<PoseTable> kuka_poses(std::string_view text, const std::string& where) {
    const std::vector<Token> words = words_of(text, Dialect::krl);
    const auto frames_of = inline_frames(words);
    PoseTable table;
    table.names.push_back({PoseNames::Says::names, "", {}});
    std::set<std::string> given, arrays;
    std::string frames;
    bool joints = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        joints = joints || words[i].text == "E6AXIS";
        const bool typed = words[i].text == "E6POS" || words[i].text == "POS";
        const std::size_t name = typed ? i + 1 : i;
        if (name >= words.size() || words[name].kind != Token::Kind::name) continue;
        std::size_t value = name + 1;
        std::string shown = words[name].text;
        const auto word = [&](std::size_t k) { return k < words.size() ? words[k].text : std::string(); };
        if (word(value) == "[") {
            if (word(value + 2) != "]") continue;
            shown += "[" + word(value + 1) + "]";
            value += 3;
        }
        if (typed && value > name + 1) arrays.insert(words[name].text);
        const bool point = typed || (value > name + 1 && arrays.contains(words[name].text));
        if (!point || word(value) != "=" || word(value + 1) != "{") continue;
        const std::string at = fmt::format("{}, line {}", where, words[name].line);
        std::size_t next = 0;
        SEAM_TRY(const auto record, value_from(words, value + 1, Dialect::krl, shown, at, next));
        std::array<double, 6> values{};
        const char* keys[] = {"X", "Y", "Z", "A", "B", "C"};
        for (std::size_t k = 0; k < 6; ++k) {
            const Expr* of = component(*record, keys[k]);
            const auto number = number_of(of);
            if (!number) return input_error(Text("{} is {}", keys[k], of ? "no number" : "missing"), at);
            values[k] = *number;
        }
        const bool of_form = shown.size() > 1 && shown.front() == 'X' && frames_of.contains(shown.substr(1));
        if (of_form) {
            const std::string& here = frames_of.at(shown.substr(1));
            if (!frames.empty() && frames != here)
                return input_error(Text("is in {}, those before in {}", here, frames), at,
                                   "give poses of one user frame and one tool");
            frames = here;
        }
        SEAM_TRY(const Pose pose, placed(rotation_from_kuka({values[3], values[4], values[5]}),
                                         {values[0], values[1], values[2]}, at));
        SEAM_OK(put(table, given, of_form ? shown.substr(1) : shown, pose, at));
        i = next - 1;
    }
    if (table.poses.empty())
        return input_error(
            joints ? Text("holds positions of joints alone") : Text("declares no E6POS or POS with a value"),
            where, "give the data list of the program that measured");
    understand(table, "KUKA", frames);
    return table;
}

// [[x,y,z],[q1,q2,q3,q4],..] or an array of such.
Expected<void> put_targets(PoseTable& table, std::set<std::string>& given, const std::string& name,
                           const Expr& e, const std::string& at) {
    const auto list = [](const Expr* x, std::size_t least) {
        return x && x->kind == Expr::Kind::list && x->parts.size() >= least;
    };
    const Expr* first = list(&e, 1) ? e.parts[0].value.get() : nullptr;
    if (list(first, 1) && list(first->parts[0].value.get(), 0)) {
        for (std::size_t i = 0; i < e.parts.size(); ++i) {
            const std::string one = fmt::format("{}{{{}}}", name, i + 1);
            if (!e.parts[i].value)
                return input_error(Text("the position {} is not [[x,y,z],[q1,q2,q3,q4],..]", csv::shown(one)),
                                   at);
            SEAM_OK(put_targets(table, given, one, *e.parts[i].value, at));
        }
        return {};
    }
    std::vector<double> values;
    for (std::size_t k = 0; k < 2; ++k) {
        const Expr* part = list(&e, 2) ? e.parts[k].value.get() : nullptr;
        const std::size_t wanted = k == 0 ? 3 : 4;
        if (!list(part, wanted) || part->parts.size() != wanted)
            return input_error(Text("the position {} is not [[x,y,z],[q1,q2,q3,q4],..]", csv::shown(name)),
                               at);
        for (const auto& p : part->parts) {
            const auto number = number_of(p.value.get());
            if (!number)
                return input_error(Text("the position {} holds what is no number", csv::shown(name)), at);
            values.push_back(*number);
        }
    }
    SEAM_TRY(const auto rotation, rotation_from_abb({values[3], values[4], values[5], values[6]}, at));
    SEAM_TRY(const Pose pose, placed(rotation, {values[0], values[1], values[2]}, at));
    return put(table, given, name, pose, at);
}

Expected<PoseTable> abb_poses(std::string_view text, const std::string& where) {
    const std::vector<Token> words = words_of(text, Dialect::rapid);
    PoseTable table;
    table.names.push_back({PoseNames::Says::names, "", {}});
    std::set<std::string> given;
    bool joints = false;
    for (std::size_t i = 0; i + 2 < words.size(); ++i) {
        joints = joints || words[i].text == "jointtarget";
        if (words[i].text != "robtarget" || words[i + 1].kind != Token::Kind::name) continue;
        const std::string& name = words[i + 1].text;
        std::size_t value = i + 2;
        if (words[value].text == "{")
            while (value < words.size() && words[value++].text != "}") {
            }
        if (value >= words.size() || words[value].text != ":=") continue;  // of a routine's parameters
        const std::string at = fmt::format("{}, line {}", where, words[i + 1].line);
        std::size_t next = 0;
        SEAM_TRY(const auto target, value_from(words, value + 1, Dialect::rapid, name, at, next));
        SEAM_OK(put_targets(table, given, name, *target, at));
        i = next - 1;
    }
    if (table.poses.empty())
        return input_error(
            joints ? Text("holds positions of joints alone") : Text("declares no robtarget with a value"),
            where, "give the module of the program that measured");
    understand(table, "ABB", "");
    return table;
}

bool holds(std::string_view text, std::string_view word) {  // in capitals or not
    return std::search(text.begin(), text.end(), word.begin(), word.end(), [](char a, char b) {
               return std::toupper(static_cast<unsigned char>(a)) == b;
           }) != text.end();
}

}  // namespace

std::optional<Expected<PoseTable>> parse_program_poses(std::string_view text, const std::string& where) {
    if (text.find("/POS") != text.npos && text.find("/PROG") != text.npos) return fanuc_poses(text, where);
    if (holds(text, "ROBTARGET") && text.find(":=") != text.npos) return abb_poses(text, where);
    if (holds(text, "DEFDAT ") || (holds(text, "DECL ") && text.find('{') != text.npos))
        return kuka_poses(text, where);
    return std::nullopt;
}

}  // namespace seamwright
