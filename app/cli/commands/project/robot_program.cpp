// seamwright robot-program: the controller's side of a project.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "app/cli/program_files.h"
#include "devices/registry.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"
#include "projects/station/program.h"

namespace seamwright::cli {
namespace {

struct ProgramArguments {
    std::string file, brand, robot, type;
    std::filesystem::path folder;
};

Expected<Answer> write_program(const ProgramArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto request, program_request(project, RobotId(a.robot), PartTypeId(a.type)));
    SEAM_TRY(auto files, write_robot_program(a.brand, request));
    Answer answer;
    answer.json = {{"status", "ok"}, {"brand", a.brand}};
    SEAM_OK(write_program_files(a.folder, files, answer));
    answer.json["spots"] = request.moves.size();
    answer.json["frames"] = request.frames.size();
    if (!request.part_type.empty()) answer.json["type"] = request.part_type;
    answer.text += fmt::format("{} spots, {} frames\n", request.moves.size(), request.frames.size());
    const auto types = types_with_these_files(project, RobotId(a.robot), a.brand, request, files);
    if (!types.empty()) {
        answer.json["same_files_as"] = types;
        answer.text += fmt::format(
            "the files of part type {} have the same names: a controller holds the program of one type, the "
            "one that was loaded last\n",
            fmt::join(types, ", "));
    }
    return answer;
}

}  // namespace

void add_robot_program(CommandLine& line) {
    auto a = std::make_shared<ProgramArguments>();
    CLI::App* command = line.add(
        "robot-program",
        "The controller's side of a project: the module that talks to Seamwright, the measuring program "
        "(entry, trigger and exit of every spot, and the via points that the project gives on the way to it; "
        "without any it goes straight from exit to the next entry) and the application frames.",
        "seamwright robot-program door_left.seam --brand kuka --out krc");
    std::vector<std::string> brands;
    for (const ProgramWriter& w : program_writers()) brands.emplace_back(w.name);
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("--brand", a->brand, fmt::format("{}", fmt::join(brands, " | ")))->required();
    command->add_option("--out", a->folder, "Folder to write into")->required()->type_name("DIR");
    command->add_option("--robot", a->robot, "Which robot of the project, when it has several")
        ->type_name("ID");
    command
        ->add_option(
            "--type", a->type,
            "Of which part type, when the project has types; the program says it with its start signal")
        ->type_name("ID");
    line.on(command, [a] { return write_program(*a); });
}

}  // namespace seamwright::cli
