// Robot programs: the first byte says the language. Whatever is read must be finite, stand in a line of its own that has a note, and
// be told in the same way twice.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "devices/robot_path/robot_path.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const char* names[] = {"a.src", "a.dat", "a.mod", "a.ls", "a.script", "a.apt"};
    if (size == 0) return 0;
    // A byte of the text itself, so that corpora stay readable: '0' to '5'.
    const char* name = names[data[0] % std::size(names)];
    const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
    seamwright::ProgramPathOptions options;
    options.unit_mm = 1;
    options.chord_mm = 10;
    const auto path = seamwright::parse_program_path({{name, text}}, options);
    if (!path) {
        if (path.error().sentence().empty()) std::abort();
        return 0;
    }
    std::size_t noted = 0;
    for (const auto& line : path->lines) noted += static_cast<std::size_t>(line.points);
    if (noted != path->points.size()) std::abort();
    for (const auto& p : path->points)
        if (!p.frame_from_tool.matrix().allFinite() || p.line < 1) std::abort();
    (void)seamwright::application_path(*path, false);
    (void)seamwright::application_path(*path, true);
    return 0;
}
