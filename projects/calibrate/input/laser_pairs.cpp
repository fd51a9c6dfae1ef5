#include "projects/calibrate/input/laser_pairs.h"

#include "devices/exchange/json_fields.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {

using nlohmann::json;

Expected<std::vector<LaserPair>> parse_laser_pairs(const json& data) {
    SEAM_TRY(auto list, json_array(data, "pairs", ""));
    std::vector<LaserPair> pairs;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("pairs", i);
        LaserPair pair;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        SEAM_TRY(auto pixel, json_vector2(entry, "pixel", where));
        SEAM_TRY(auto laser, json_vector2(entry, "laser", where));
        pairs.push_back({id, pixel, laser});
    }
    return pairs;
}

}  // namespace seamwright
