#include "projects/model/project.h"

#include <algorithm>

namespace seamwright {

std::string_view to_string(ReferenceState state) {
    return state == ReferenceState::from_drawing ? "from_drawing" : "measured";
}

Text name_of(ReferenceState state) {
    return state == ReferenceState::from_drawing ? Text("from the drawing, not confirmed")
                                                 : Text("measured on the part");
}

std::vector<std::string> unconfirmed_spots(const Project& project, const Region& region) {
    std::vector<std::string> ids;
    for (const std::string& id : region.spot_ids)
        if (std::any_of(project.spots.begin(), project.spots.end(), [&](const Spot& spot) {
                return spot.id == id && spot.reference_state == ReferenceState::from_drawing;
            }))
            ids.push_back(id);
    return ids;
}

const RegionModes* modes_of(const Project& project, const std::string& region_id) {
    for (const RegionModes& modes : project.elastic)
        if (modes.id == region_id) return &modes;
    return nullptr;
}

}  // namespace seamwright
