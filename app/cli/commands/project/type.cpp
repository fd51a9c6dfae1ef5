// seamwright type: the part types of a project.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "projects/file/project_file.h"
#include "projects/model/part_types.h"
#include "projects/reuse/part_type_edits.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct TypeArguments {
    std::string file, other;
    PartType type;
    std::vector<std::string> ids;
    bool with_spots = false;
};

Answer listed(const Project& project) {
    Answer answer;
    answer.json = {{"status", "ok"}, {"types", json::array()}};
    for (const PartType& type : project.part_types) {
        const Project one = of_type(project, type.id);
        json untaught = json::array();
        for (const Spot& spot : one.spots)
            if (spot.reference_state != ReferenceState::measured || spot.reference_profile.size() == 0)
                untaught.push_back(spot.id);
        answer.text += fmt::format("{:<16} {:>5}  {} spots, {} regions{}{}\n", type.id,
                                   type.number ? std::to_string(type.number) : "-", one.spots.size(),
                                   one.regions.size(), type.name.empty() ? "" : "  " + type.name,
                                   untaught.empty() ? "" : fmt::format("  ({} to teach)", untaught.size()));
        answer.json["types"].push_back({{"id", type.id},
                                        {"name", type.name},
                                        {"number", type.number},
                                        {"spots", one.spots.size()},
                                        {"regions", one.regions.size()},
                                        {"untaught_spots", std::move(untaught)}});
    }
    if (project.part_types.empty()) answer.text = "the project is of one kind of part\n";
    return answer;
}

template <class Edit>
Expected<Answer> edited(const std::string& path, const Edit& edit) {
    SEAM_TRY(auto file, open_to_edit(path));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto after, edit(project));
    SEAM_OK(file.save(after));
    return listed(after);
}

Expected<Answer> compared(const TypeArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto differences, compare_part_types(project, a.type.id, a.other));
    Answer answer;
    answer.json = {{"status", "ok"}, {"a", a.type.id}, {"b", a.other}, {"differences", json::array()}};
    constexpr std::size_t kLongestValue = 60;
    const auto shown = [](const json& value) {
        std::string text = value.dump();
        return text.size() > kLongestValue ? text.substr(0, kLongestValue) + "..." : text;
    };
    for (const PartTypeDifference& d : differences) {
        answer.json["differences"].push_back({{"what", d.what}, {"field", d.field}, {"a", d.a}, {"b", d.b}});
        answer.text += d.field.empty()
                           ? fmt::format("{}: only of {}\n", d.what, d.a.is_null() ? a.other : a.type.id)
                           : fmt::format("{} {}: {} | {}\n", d.what, d.field, shown(d.a), shown(d.b));
    }
    if (differences.empty()) answer.text = "nothing differs\n";
    return answer;
}

CLI::App* subcommand(CommandLine& line, CLI::App& group, const std::shared_ptr<TypeArguments>& a,
                     const char* name, const char* help, const char* example) {
    CLI::App* command = line.add(group, name, help, example);
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    return command;
}

void describe_options(CLI::App* command, const std::shared_ptr<TypeArguments>& a) {
    command->add_option("--name", a->type.name, "For people: \"door left\"");
    command->add_option("--number", a->type.number, "As a PLC says it")
        ->check(CLI::Range(1, kLargestTypeNumber));
}

void add_edits(CommandLine& line, CLI::App& group) {
    auto a = std::make_shared<TypeArguments>();
    CLI::App* command = subcommand(
        line, group, a, "add", "A new part type. The first one owns the spots and regions that there are.",
        "seamwright type add door.seam left --name \"door left\" --number 1");
    command->add_option("id", a->type.id, "Its id")->required();
    describe_options(command, a);
    line.on(command,
            [a] { return edited(a->file, [&](const Project& p) { return add_part_type(p, a->type); }); });

    a = std::make_shared<TypeArguments>();
    command =
        subcommand(line, group, a, "clone",
                   "A new part type with copies of another one's spots and regions. Their references are to "
                   "be taught on its own part: until then nothing is pushed by them.",
                   "seamwright type clone door.seam left right --number 2");
    command->add_option("from", a->other, "The type to copy")->required();
    command->add_option("id", a->type.id, "The new one's id")->required();
    describe_options(command, a);
    line.on(command, [a] {
        return edited(a->file, [&](const Project& p) { return clone_part_type(p, a->other, a->type); });
    });

    a = std::make_shared<TypeArguments>();
    command = subcommand(line, group, a, "remove", "Forget a part type. Its stored runs stay.",
                         "seamwright type remove door.seam right --with-spots");
    command->add_option("id", a->type.id, "Its id")->required();
    command->add_flag("--with-spots", a->with_spots, "Its spots and regions go with it");
    line.on(command, [a] {
        return edited(a->file,
                      [&](const Project& p) { return remove_part_type(p, a->type.id, a->with_spots); });
    });

    a = std::make_shared<TypeArguments>();
    command = subcommand(line, group, a, "take", "Spots and regions that are of no type become a type's.",
                         "seamwright type take door.seam left R3 S12");
    command->add_option("id", a->type.id, "The type")->required();
    command->add_option("items", a->ids, "Regions (with their spots) and spots")->required();
    line.on(command, [a] {
        return edited(a->file, [&](const Project& p) { return take_into_part_type(p, a->type.id, a->ids); });
    });
}

}  // namespace

void add_type(CommandLine& line) {
    CLI::App* group =
        line.group("type", "Part types of a project: door left, door right, station wagon ...",
                   "seamwright type list door.seam\n  seamwright type clone door.seam left right");
    auto a = std::make_shared<TypeArguments>();
    CLI::App* list = subcommand(line, *group, a, "list", "The types, and what is still to be taught.",
                                "seamwright type list door.seam");
    line.on(list, [a]() -> Expected<Answer> {
        SEAM_TRY(auto file, ProjectFile::open(a->file, FileAccess::read_only));
        SEAM_TRY(auto project, file.load());
        return listed(project);
    });
    add_edits(line, *group);
    a = std::make_shared<TypeArguments>();
    CLI::App* compare = subcommand(line, *group, a, "compare", "What differs between two types.",
                                   "seamwright type compare door.seam left right");
    compare->add_option("a", a->type.id, "The one")->required();
    compare->add_option("b", a->other, "The other")->required();
    line.on(compare, [a] { return compared(*a); });
}

}  // namespace seamwright::cli
