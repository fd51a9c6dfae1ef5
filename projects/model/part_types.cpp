#include "projects/model/part_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

namespace seamwright {
namespace {

bool digits(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool type_id(const std::string& id) {
    return !id.empty() && id.size() <= kLongestTypeId && !digits(id) && std::ranges::all_of(id, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_';
    });
}

// Of the types, for the cure of a sentence.
Text types_known(const Project& project) {
    Text text;
    for (const PartType& type : project.part_types)
        text = joined(text, ", ",
                      type.number ? Text(fmt::format("{} ({})", type.id, type.number)) : Text(type.id));
    return text;
}

Expected<void> check_entries(const Project& project) {
    std::set<std::string> ids;
    std::map<int, std::string> numbers;
    for (const PartType& type : project.part_types) {
        const Text where("part type {}", type.id);
        if (!type_id(type.id))
            return input_error(
                Text("\"{}\" is no id of a part type", type.id), "part types",
                Text("use 1 to {} letters, digits, '-' and '_', and one that is no digit", kLongestTypeId));
        if (!ids.insert(type.id).second)
            return input_error(Text("two part types are called \"{}\"", type.id), "part types", "rename one");
        if (type.number < 0 || type.number > kLargestTypeNumber)
            return input_error(Text("{} is no number of a part type", type.number), where,
                               Text("give 1 to {}, or 0 for none", kLargestTypeNumber));
        if (type.number == 0) continue;
        if (const auto [other, first] = numbers.try_emplace(type.number, type.id); !first)
            return input_error(Text("its number {} is that of {} too", type.number, other->second), where,
                               "give each a number of its own");
    }
    return {};
}

Expected<void> check_owner(const Project& project, const std::string& of, const Text& where) {
    if (of.empty() || find_type(project, of)) return {};
    return input_error(Text("its part type \"{}\" is not in the project", of), where,
                       project.part_types.empty() ? Text("the project has no part types")
                                                  : Text("known are {}", types_known(project)));
}

}  // namespace

const PartType* find_type(const Project& project, const std::string& id) {
    const auto at = std::ranges::find(project.part_types, id, &PartType::id);
    return at == project.part_types.end() ? nullptr : &*at;
}

Expected<void> check_part_types(const Project& project) {
    SEAM_OK(check_entries(project));
    std::map<std::string, std::string> owners;  // by spot
    for (const Spot& spot : project.spots) {
        SEAM_OK(check_owner(project, spot.type_id, Text("spot {}", spot.id)));
        owners[spot.id] = spot.type_id;
    }
    const auto named = [](const std::string& id) { return id.empty() ? Text("no part type") : Text(id); };
    for (const Region& region : project.regions) {
        const Text where("region {}", region.id);
        SEAM_OK(check_owner(project, region.type_id, where));
        for (const std::string& id : region.spot_ids)
            if (const auto spot = owners.find(id); spot != owners.end() && spot->second != region.type_id)
                return input_error(Text("its spot {} is of {}, the region of {}", id, named(spot->second),
                                        named(region.type_id)),
                                   where, "a region has spots of its own type alone");
    }
    return {};
}

Expected<std::string> called_type(const Project& project, const std::string& id_or_number) {
    if (project.part_types.empty()) {
        if (id_or_number.empty()) return std::string();
        return input_error(Text("part type \"{}\": the project has no part types", id_or_number),
                           "part types", "name none, or add it: seamwright type add FILE.seam ID");
    }
    const Text known("known are {}", types_known(project));
    if (id_or_number.empty())
        return input_error("no part type was said, and the project has part types", "part types", known);
    if (find_type(project, id_or_number)) return id_or_number;
    int number = 0;
    const char* end = id_or_number.data() + id_or_number.size();
    if (digits(id_or_number) && std::from_chars(id_or_number.data(), end, number).ptr == end && number > 0)
        for (const PartType& type : project.part_types)
            if (type.number == number) return type.id;
    return input_error(Text("part type \"{}\" is not in the project", id_or_number), "part types", known);
}

Project of_type(const Project& project, const std::string& type_id) {
    Project one = project;
    if (project.part_types.empty()) return one;
    const auto other = [&](const auto& item) { return item.type_id != type_id; };
    std::erase_if(one.spots, other);
    std::erase_if(one.regions, other);
    std::erase_if(one.part_types, [&](const PartType& type) { return type.id != type_id; });
    return one;
}

std::string name_of(const PartType& type) {
    return type.name.empty() ? type.id : fmt::format("{} ({})", type.id, type.name);
}

}  // namespace seamwright
