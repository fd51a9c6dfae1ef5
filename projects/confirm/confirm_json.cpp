#include <cmath>

#include "devices/exchange/pose_json.h"
#include "projects/confirm/confirm.h"

namespace seamwright {
namespace {

using nlohmann::json;

json number_or_null(double v) {
    return std::isfinite(v) ? json(v) : json();
}

}  // namespace

json confirmation_json(const Confirmation& confirmation) {
    json spots = json::array(), regions = json::array();
    for (const SpotConfirmation& s : confirmation.spots) {
        json one = {{"id", s.spot_id},
                    {"finding", to_string(s.finding)},
                    {"reason", s.reason.english()},
                    {"contour_rms_mm", number_or_null(s.contour_rms_mm)},
                    {"left_mm", number_or_null(s.left_mm)}};
        if (s.shift_mm.allFinite()) {
            one["shift_mm"] = {{"x", s.shift_mm.x()}, {"z", s.shift_mm.y()}};
            one["sigma_mm"] = {{"x", number_or_null(s.sigma_mm.x())}, {"z", number_or_null(s.sigma_mm.y())}};
            one["shift_workobject_mm"] = {s.shift_workobject_mm.x(), s.shift_workobject_mm.y(),
                                          s.shift_workobject_mm.z()};
        }
        spots.push_back(std::move(one));
    }
    for (const CommonShift& c : confirmation.regions) {
        json one = {{"id", c.region_id}, {"judged", c.judged}, {"redundancy", c.redundancy}};
        if (c.judged) {
            one["displacement"] = pose_json(c.displacement.workobject_from_movedworkobject);
            one["largest_mm"] = c.largest_mm;
            one["rms_mm"] = c.rms_mm;
            one["consistent"] = c.consistent;
        } else {
            one["why_not"] = c.why_not.english();
        }
        regions.push_back(std::move(one));
    }
    return {{"status", confirmation.ok ? "ok" : "refused"}, {"spots", spots}, {"regions", regions}};
}

}  // namespace seamwright
