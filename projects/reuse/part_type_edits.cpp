#include "projects/reuse/part_type_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "projects/file/id_length.h"
#include "projects/file/project_file.h"
#include "projects/file/project_json.h"
#include "projects/model/part_types.h"

namespace seamwright {
namespace {

Expected<void> known_type(const Project& project, const std::string& id) {
    if (find_type(project, id)) return {};
    return input_error(Text("the project has no part type \"{}\"", id), "part types",
                       "seamwright type list FILE.seam shows them");
}

Expected<Project> checked(Project&& project) {
    SEAM_OK(check_part_types(project));
    return std::move(project);
}

// "S1" of "S1-left" of the type "left"; ids that name no type as they are.
std::string common_id(const std::string& id, const std::string& type) {
    const std::string tail = "-" + type;
    return id.size() > tail.size() && id.ends_with(tail) ? id.substr(0, id.size() - tail.size()) : id;
}

template <class T>
bool is_there(const std::vector<T>& items, const std::string& id) {
    return std::ranges::any_of(items, [&](const T& item) { return item.id == id; });
}

template <class T>
Expected<std::string> cloned_id(const std::vector<T>& items, const std::string& id, const std::string& from,
                                const std::string& to) {
    const std::string common = common_id(id, from) + "-" + to;
    std::string fresh = common;
    for (int n = 2; is_there(items, fresh); ++n) fresh = fmt::format("{}-{}", common, n);
    if (is_too_long(fresh))
        return input_error(Text("\"{}\" is longer than {} signs", fresh, kLongestId), Text("clone of {}", id),
                           "give it or the part type a shorter id");
    return fresh;
}

}  // namespace

Expected<Project> add_part_type(const Project& project, const PartType& type) {
    Project after = project;
    after.part_types.push_back(type);
    if (project.part_types.empty()) {
        for (Spot& spot : after.spots) spot.type_id = type.id;
        for (Region& region : after.regions) region.type_id = type.id;
    }
    return checked(std::move(after));
}

Expected<Project> clone_part_type(const Project& project, const std::string& from, const PartType& type) {
    SEAM_OK(known_type(project, from));
    Project after = project;
    after.part_types.push_back(type);
    std::map<std::string, std::string> names;
    for (const Spot& spot : project.spots) {
        if (spot.type_id != from) continue;
        Spot copy = spot;
        SEAM_TRY(copy.id, cloned_id(after.spots, spot.id, from, type.id));
        copy.type_id = type.id;
        if (copy.reference_profile.size() > 0 && copy.reference_state == ReferenceState::measured)
            copy.reference_state = ReferenceState::from_type;
        copy.curve.reset();
        names[spot.id] = copy.id;
        after.spots.push_back(std::move(copy));
    }
    for (const Region& region : project.regions) {
        if (region.type_id != from) continue;
        Region copy = region;
        SEAM_TRY(copy.id, cloned_id(after.regions, region.id, from, type.id));
        copy.type_id = type.id;
        copy.offsets.clear();
        copy.offset_switches.clear();
        for (std::string& id : copy.spot_ids)
            if (const auto name = names.find(id); name != names.end()) id = name->second;
        after.regions.push_back(std::move(copy));
    }
    return checked(std::move(after));
}

Expected<Project> remove_part_type(const Project& project, const std::string& id, bool with_spots) {
    SEAM_OK(known_type(project, id));
    Project after = project;
    std::erase_if(after.part_types, [&](const PartType& type) { return type.id == id; });
    const auto its = [&](const auto& item) { return item.type_id == id; };
    if (after.part_types.empty()) {
        for (Spot& spot : after.spots)
            if (its(spot)) spot.type_id.clear();
        for (Region& region : after.regions)
            if (its(region)) region.type_id.clear();
        return checked(std::move(after));
    }
    const auto spots = std::erase_if(after.spots, its), regions = std::erase_if(after.regions, its);
    if (!with_spots && spots + regions > 0)
        return input_error(Text("{} spots and {} regions are of it", spots, regions),
                           Text("part type {}", id), "say that they go too: --with-spots");
    return checked(std::move(after));
}

Expected<Project> take_into_part_type(const Project& project, const std::string& type,
                                      const std::vector<std::string>& ids) {
    SEAM_OK(known_type(project, type));
    Project after = project;
    const auto take = [&](auto& item, const Text& where) -> Expected<void> {
        if (!item.type_id.empty() && item.type_id != type)
            return input_error(Text("it is of part type {}", item.type_id), where,
                               "clone that type instead: seamwright type clone FILE.seam");
        item.type_id = type;
        return {};
    };
    const auto take_spot = [&](const std::string& id) -> Expected<void> {
        for (Spot& spot : after.spots)
            if (spot.id == id) return take(spot, Text("spot {}", id));
        return input_error("it is not in the project", Text("spot {}", id), "name a spot or a region");
    };
    for (const std::string& id : ids) {
        const auto region = std::ranges::find(after.regions, id, &Region::id);
        if (region == after.regions.end()) {
            SEAM_OK(take_spot(id));
            continue;
        }
        SEAM_OK(take(*region, Text("region {}", id)));
        for (const std::string& spot : region->spot_ids)
            if (is_there(after.spots, spot)) SEAM_OK(take_spot(spot));
    }
    return checked(std::move(after));
}

namespace {

nlohmann::json fields_of(Spot spot, const std::string& type) {
    spot.id = common_id(spot.id, type);
    spot.type_id.clear();
    return to_json_document(spot);
}
nlohmann::json fields_of(Region region, const std::string& type) {
    region.id = common_id(region.id, type);
    region.type_id.clear();
    for (std::string& id : region.spot_ids) id = common_id(id, type);
    return to_json_document(region);
}

template <class T>
void compare_items(const std::vector<T>& items, const char* kind, const std::string& a, const std::string& b,
                   std::vector<PartTypeDifference>& out) {
    std::map<std::string, std::array<std::optional<nlohmann::json>, 2>> pairs;
    std::vector<std::string> order;
    for (const T& item : items)
        for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
            const std::string& type = side == 0 ? a : b;
            if (item.type_id != type) continue;
            const std::string id = common_id(item.id, type);
            const auto [at, fresh] = pairs.try_emplace(id);
            if (fresh) order.push_back(id);
            at->second[side] = fields_of(item, type);
        }
    for (const std::string& id : order) {
        const auto& [first, second] = pairs.at(id);
        const std::string what = fmt::format("{} {}", kind, id);
        if (!first || !second) {
            out.push_back({what, "", first ? nlohmann::json(a) : nlohmann::json(),
                           second ? nlohmann::json(b) : nlohmann::json()});
            continue;
        }
        std::set<std::string> fields;
        for (const auto* document : {&*first, &*second})
            for (const auto& [field, value] : document->items()) fields.insert(field);
        for (const std::string& field : fields) {
            const auto of = [&](const nlohmann::json& document) {
                const auto found = document.find(field);
                return found == document.end() ? nlohmann::json() : *found;
            };
            if (of(*first) != of(*second)) out.push_back({what, field, of(*first), of(*second)});
        }
    }
}

}  // namespace

Expected<std::vector<PartTypeDifference>> compare_part_types(const Project& project, const std::string& a,
                                                             const std::string& b) {
    SEAM_OK(known_type(project, a));
    SEAM_OK(known_type(project, b));
    if (a == b) return usage_error(Text("\"{}\" is named twice", a), "part types", "name two");
    std::vector<PartTypeDifference> out;
    compare_items(project.spots, "spot", a, b, out);
    compare_items(project.regions, "region", a, b, out);
    return out;
}

}  // namespace seamwright
