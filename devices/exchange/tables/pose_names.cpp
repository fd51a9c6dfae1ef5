#include "devices/exchange/tables/pose_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

std::string stem(const std::string& frame) {
    return std::filesystem::path(frame).stem().string();
}

bool digits_only(std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == text.npos;
}

// "7" of frame0007.
std::optional<long> ending_number(std::string_view text) {
    std::size_t from = text.size();
    while (from > 0 && std::isdigit(static_cast<unsigned char>(text[from - 1]))) --from;
    if (from == text.size() || text.size() - from > 9) return std::nullopt;
    return std::stol(std::string(text.substr(from)));
}

// What is left of a name when folder, extension, blanks and capitals are gone.
std::string bare_name(std::string_view name) {
    name = name.substr(std::min(name.find_last_of("/\\") + 1, name.size()));
    const auto dot = name.rfind('.');  // ".5" is part of a name, ".csv" is not
    if (dot != name.npos && dot > 0 && dot + 1 < name.size() &&
        std::isalpha(static_cast<unsigned char>(name[dot + 1])))
        name = name.substr(0, dot);
    std::string bare;
    for (const char c : name)
        if (c != ' ' && c != '\t') bare += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return bare;
}

using Rows = std::multimap<std::string, std::size_t, std::less<>>;

// A column held against the frames.
struct Match {
    const PoseNames* names = nullptr;
    std::vector<std::optional<std::size_t>> rows;  // of each frame
    std::vector<bool> by_name;                     // else by number
    std::size_t found = 0, found_by_name = 0;
    std::optional<std::size_t> twice;  // a row whose frame another row has too
    const std::string* missing = nullptr;

    bool whole() const { return !missing && !twice; }
    bool whole_by_name() const { return whole() && found_by_name == found; }
};

Match match(const PoseNames& names, std::span<const std::string> frames) {
    Rows exact, bare, numbers;
    for (std::size_t i = 0; i < names.cells.size(); ++i) {
        const std::string& cell = names.cells[i];
        if (cell.empty()) continue;
        exact.emplace(cell, i);
        bare.emplace(bare_name(cell), i);
        if (digits_only(cell) && cell.size() <= 9) numbers.emplace(std::to_string(std::stol(cell)), i);
    }
    std::map<std::string, int> alike;  // frames that only capitals, blanks or extensions tell apart
    for (const std::string& frame : frames) ++alike[bare_name(frame)];
    Match m;
    m.names = &names;
    for (const std::string& frame : frames) {
        const std::string short_name = stem(frame), bare_frame = bare_name(frame);
        std::vector<std::size_t> rows;
        bool by_name = true;
        const auto take = [&](const Rows& from, const std::string& key) {
            for (auto [it, end] = from.equal_range(key); it != end; ++it) rows.push_back(it->second);
        };
        take(exact, frame);
        if (short_name != frame) take(exact, short_name);
        if (rows.empty() && alike[bare_frame] == 1) take(bare, bare_frame);
        if (const auto number = ending_number(short_name); rows.empty() && number) {
            by_name = false;
            take(numbers, std::to_string(*number));
        }
        if (rows.size() > 1 && !m.twice) m.twice = rows[1];
        if (rows.empty() && !m.missing) m.missing = &frame;
        m.by_name.push_back(by_name);
        m.rows.push_back(rows.empty() ? std::nullopt : std::optional(rows.front()));
        m.found += rows.empty() ? 0 : 1;
        m.found_by_name += !rows.empty() && by_name ? 1 : 0;
    }
    return m;
}

bool is_text(std::string_view cell) {
    return cell.find_first_not_of("0123456789+-.,:/ TZeE") != cell.npos;  // neither a number nor a time
}
bool each_its_own(const PoseNames& names) {
    const std::set<std::string> different(names.cells.begin(), names.cells.end());
    return different.size() == names.cells.size() && different.count("") == 0;
}

// The column must name all frames, or the table is refused.
bool binds(const Match& m, std::size_t frames) {
    const PoseNames& names = *m.names;
    if (names.says == PoseNames::Says::names) return true;
    if (m.found_by_name > 0) return true;
    if (names.says == PoseNames::Says::remarks) return false;
    if (!each_its_own(names)) return false;
    if (std::any_of(names.cells.begin(), names.cells.end(), [](const auto& c) { return is_text(c); }))
        return true;
    // Numbers: a speed or a time meets some frame's number by chance, a numbering most of them.
    return 2 * m.found >= frames &&
           std::all_of(names.cells.begin(), names.cells.end(), [](const auto& c) { return digits_only(c); });
}

// Numbers under a title that says nothing name the frames only one by one.
bool names_all(const Match& m) {
    if (!m.whole()) return false;
    if (m.whole_by_name() || m.names->says == PoseNames::Says::names) return true;
    const std::set<std::optional<std::size_t>> different(m.rows.begin(), m.rows.end());
    return different.size() == m.rows.size();
}

bool contradict(const Match& a, const Match& b) {
    for (std::size_t i = 0; i < a.rows.size(); ++i)
        if (b.rows[i] && a.rows[i] != b.rows[i]) return true;
    return false;
}

tl::unexpected<Error> two_columns(const Match& a, const Match& b, const std::string& where) {
    return input_error(Text("the columns \"{}\" and \"{}\" name the poses differently",
                            csv::shown(a.names->title), csv::shown(b.names->title)),
                       where, "leave out the one that does not, or title the right one name");
}

// The column that names all frames; null: there is none.
Expected<const Match*> naming_column(const std::vector<Match>& matches, const std::string& where) {
    const auto rank = [](const Match& m) {
        return (m.whole_by_name() ? 2 : 0) + (m.names->says == PoseNames::Says::names ? 1 : 0);
    };
    const Match* best = nullptr;
    for (const Match& m : matches)
        if (names_all(m) && (!best || rank(m) > rank(*best))) best = &m;
    if (!best) return best;
    for (const Match& m : matches) {
        if (&m == best) continue;
        const bool rival = names_all(m) && rank(m) == rank(*best);
        // A running number fits often; it does not outvote names, be they only some.
        const bool other_names = !best->whole_by_name() && m.found_by_name > 0;
        if ((rival || other_names) && contradict(*best, m)) return two_columns(*best, m, where);
    }
    return best;
}

}  // namespace

Expected<FramePoses> poses_of_frames(const PoseTable& table, std::span<const std::string> frames,
                                     const std::string& where) {
    std::vector<Match> matches;
    for (const PoseNames& names : table.names) matches.push_back(match(names, frames));
    FramePoses found;
    SEAM_TRY(const Match* named, naming_column(matches, where));
    if (named) {
        for (const auto& row : named->rows) found.poses.push_back(table.poses[*row].pose);
        found.understood = named->names->title.empty() ? std::string("by name")
                                                       : fmt::format("by the names in the column \"{}\"",
                                                                     csv::shown(named->names->title));
        return found;
    }
    for (const Match& m : matches) {
        if (!binds(m, frames.size())) continue;
        if (m.twice)
            return input_error(Text("the pose \"{}\" is given twice", csv::shown(m.names->cells[*m.twice])),
                               table.poses[*m.twice].at);
        const std::string missing = m.missing ? *m.missing : frames.front();
        return input_error(m.names->title.empty() ? Text("names no pose of {}", missing)
                                                  : Text("its column \"{}\" names no pose of {}",
                                                         csv::shown(m.names->title), missing),
                           where, "name the poses as the frames' files, or leave the names out");
    }
    if (table.poses.size() != frames.size())
        return input_error(Text("holds {} poses for {} frames", table.poses.size(), frames.size()), where,
                           "give one pose a frame in the frames' order, or name them as the files");
    for (const TablePose& pose : table.poses) found.poses.push_back(pose.pose);
    found.understood = fmt::format("BY ORDER, for nothing in it names the frames: {} takes {}",
                                   frames.front(), table.poses.front().at);
    if (frames.size() > 1)
        found.understood += fmt::format(", {} takes {}", frames.back(), table.poses.back().at);
    return found;
}

}  // namespace seamwright
