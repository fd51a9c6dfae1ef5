#include "projects/model/project.h"

#include <algorithm>

namespace seamwright {

std::string_view to_string(ReferenceState state) {
    switch (state) {
        case ReferenceState::from_drawing:
            return "from_drawing";
        case ReferenceState::from_type:
            return "from_type";
        case ReferenceState::measured:
            break;
    }
    return "measured";
}

Text name_of(ReferenceState state) {
    switch (state) {
        case ReferenceState::from_drawing:
            return "from the drawing, not confirmed";
        case ReferenceState::from_type:
            return "of another part type, not taught on this one";
        case ReferenceState::measured:
            break;
    }
    return "measured on the part";
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

bool has_password(const std::string& address) {
    const auto begin = address.find("://");
    if (begin == std::string::npos) return address.find("password") != std::string::npos;
    const std::string rest = address.substr(begin + 3);
    const auto query = rest.find('?');
    const std::string authority = rest.substr(0, std::min(rest.find('/'), query));
    const auto at = authority.rfind('@');
    return (at != std::string::npos && authority.substr(0, at).find(':') != std::string::npos) ||
           (query != std::string::npos && rest.find("password", query) != std::string::npos);
}

}  // namespace seamwright
