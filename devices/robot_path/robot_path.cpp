#include "devices/robot_path/robot_path.h"

#include <algorithm>
#include <set>

#include "devices/exchange/files.h"
#include "devices/robot_path/machine/machine.h"

namespace seamwright {
namespace {

constexpr std::size_t kLargestProgram = std::size_t{64} << 20;

std::string small_ending(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return ending;
}

std::unique_ptr<program_path::Machine> machine_of(ProgramLanguage language,
                                                  const ProgramPathOptions& options) {
    switch (language) {
        case ProgramLanguage::krl:
            return program_path::krl_machine(options);
        case ProgramLanguage::rapid:
            return program_path::rapid_machine(options);
        case ProgramLanguage::fanuc:
            return program_path::fanuc_machine(options);
        case ProgramLanguage::urscript:
            return program_path::urscript_machine(options);
        default:
            return program_path::apt_machine(options);
    }
}

Expected<program_path::Source> source_of(const ProgramText& file) {
    std::string_view text = file.text;
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        return input_error("the text is UTF-16", file.name, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.find('\0') != std::string_view::npos)
        return input_error("this is no text", file.name,
                           "give the program as text, not as the controller's own file");
    program_path::Source source{std::filesystem::path(file.name).filename().string(), {}};
    // A carriage return alone ends a line too: old controllers wrote so.
    const bool old = text.find('\n') == std::string_view::npos;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(old ? '\r' : '\n'), text.size());
        source.lines.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return source;
}

// The data list of a .src: the same name beside it, whatever its case.
std::optional<std::filesystem::path> data_list_of(const std::filesystem::path& program) {
    std::error_code failed;
    const auto folder = program.parent_path().empty() ? std::filesystem::path(".") : program.parent_path();
    for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
        std::string stem = entry.path().stem().string(), wanted = program.stem().string();
        for (std::string* s : {&stem, &wanted})
            std::transform(s->begin(), s->end(), s->begin(), [](unsigned char c) { return std::tolower(c); });
        if (stem == wanted && small_ending(entry.path()) == ".dat") return entry.path();
    }
    return {};
}

}  // namespace

std::string_view to_string(ProgramLanguage language) {
    static constexpr std::string_view words[] = {"KRL", "RAPID", "FANUC TP", "URScript", "APT"};
    return words[static_cast<std::size_t>(language)];
}
std::string_view brand_of(ProgramLanguage language) {
    static constexpr std::string_view brands[] = {"kuka", "abb", "", "ur", ""};
    return brands[static_cast<std::size_t>(language)];
}
std::string_view to_string(ProgramMotion motion) {
    static constexpr std::string_view words[] = {"joint", "linear", "circular", "spline"};
    return words[static_cast<std::size_t>(motion)];
}
std::string_view to_string(LineKind kind) {
    static constexpr std::string_view words[] = {"point",    "understood",  "passed over",
                                                 "left out", "not reached", "not understood"};
    return words[static_cast<std::size_t>(kind)];
}

std::optional<ProgramLanguage> program_language_of(const std::filesystem::path& path) {
    static const std::map<std::string, ProgramLanguage> endings = {{".src", ProgramLanguage::krl},
                                                                   {".dat", ProgramLanguage::krl},
                                                                   {".sub", ProgramLanguage::krl},
                                                                   {".mod", ProgramLanguage::rapid},
                                                                   {".modx", ProgramLanguage::rapid},
                                                                   {".sys", ProgramLanguage::rapid},
                                                                   {".sysx", ProgramLanguage::rapid},
                                                                   {".prg", ProgramLanguage::rapid},
                                                                   {".ls", ProgramLanguage::fanuc},
                                                                   {".script", ProgramLanguage::urscript},
                                                                   {".urscript", ProgramLanguage::urscript},
                                                                   {".apt", ProgramLanguage::apt},
                                                                   {".cl", ProgramLanguage::apt},
                                                                   {".cls", ProgramLanguage::apt},
                                                                   {".clf", ProgramLanguage::apt},
                                                                   {".ncl", ProgramLanguage::apt},
                                                                   {".aptsource", ProgramLanguage::apt}};
    const auto at = endings.find(small_ending(path));
    return at == endings.end() ? std::nullopt : std::optional(at->second);
}

std::size_t ProgramPath::count(LineKind kind) const {
    return static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [&](const ProgramLine& l) { return l.kind == kind; }));
}

std::vector<std::string> ProgramPath::unknown_frames() const {
    std::vector<std::string> names;
    std::set<std::string> seen;
    for (const ProgramPoint& p : points)
        if (!p.base_from_frame && seen.insert(p.frame).second) names.push_back(p.frame);
    return names;
}

Expected<ProgramPath> parse_program_path(const std::vector<ProgramText>& files,
                                         const ProgramPathOptions& options) {
    if (files.empty()) return input_error("there is no program");
    const auto language = program_language_of(files.front().name);
    if (!language)
        return file_error("its ending is none of a robot program", files.front().name,
                          "give .src, .mod, .ls, .script, .apt or .csv");
    if (!(options.chord_mm >= 1e-3 && options.chord_mm <= 10))
        return usage_error(Text("{} mm is no chord error", options.chord_mm), "", "give 0.001 to 10 mm");
    std::vector<program_path::Source> sources;
    for (const ProgramText& file : files) {
        if (program_language_of(file.name) != language)
            return input_error(Text("is no {}", to_string(*language)), file.name,
                               "give files of one language");
        SEAM_TRY(auto source, source_of(file));
        sources.push_back(std::move(source));
    }
    const auto machine = machine_of(*language, options);
    SEAM_TRY(auto path, machine->run(std::move(sources), files.front().name));
    path.language = *language;
    return path;
}

Expected<ProgramPath> read_program_path(const std::filesystem::path& path,
                                        const ProgramPathOptions& options) {
    std::vector<std::filesystem::path> names = {path};
    if (small_ending(path) == ".src")
        if (const auto data = data_list_of(path)) names.push_back(*data);
    names.insert(names.end(), options.also.begin(), options.also.end());
    std::vector<ProgramText> files;
    for (const auto& name : names) {
        SEAM_TRY(auto text, read_text_file(name, kLargestProgram));
        files.push_back({name.string(), std::move(text)});
    }
    return parse_program_path(files, options);
}

Expected<ApplicationPath> application_path(const ProgramPath& program, bool in_own_frame, bool leave_out) {
    const auto bad = std::find_if(program.lines.begin(), program.lines.end(),
                                  [](const ProgramLine& l) { return l.kind == LineKind::not_understood; });
    if (bad != program.lines.end() && !leave_out)
        return input_error(
            Text("{} lines are not understood, the first: {}", program.count(LineKind::not_understood),
                 joined(Text(bad->text), ": ", bad->why)),
            Text("{}, line {}", bad->file, bad->line),
            "see them all with --look; --leave-out takes the path without them, --lines a part of the "
            "program");
    if (program.points.size() < 2)
        return input_error("a path has at least 2 points",
                           program.lines.empty() ? std::string() : program.lines.front().file);
    const std::string where = program.points.front().file;
    if (program.tools.size() > 1)
        return input_error(
            Text("the tool changes on the way, from \"{}\" to \"{}\"", program.tools[0], program.tools[1]),
            where, "take the points of one tool with --lines");
    ApplicationPath path;
    if (in_own_frame) {
        const ProgramPoint& first = program.points.front();
        for (const ProgramPoint& p : program.points) {
            const bool same =
                p.frame == first.frame &&
                p.base_from_frame.has_value() == first.base_from_frame.has_value() &&
                (!p.base_from_frame || p.base_from_frame->isApprox(*first.base_from_frame, 1e-9));
            if (!same)
                return input_error(Text("the points are in {} and in {}",
                                        first.frame.empty() ? "the robot's base" : first.frame,
                                        p.frame.empty() ? "the robot's base" : p.frame),
                                   Text("{}, line {}", p.file, p.line),
                                   "take the points of one frame with --lines");
            path.points.push_back({p.frame_from_tool, {}});
        }
        return path;
    }
    for (const ProgramPoint& p : program.points) {
        if (!p.base_from_frame)
            return input_error(Text("the program does not say where {} is", p.frame),
                               Text("{}, line {}", p.file, p.line),
                               "give the file that does with --with, its pose with --frame-pose, or --frame "
                               "workobject where it is "
                               "the work object");
        path.points.push_back({*p.base_from_frame * p.frame_from_tool, {}});
    }
    return path;
}

}  // namespace seamwright
