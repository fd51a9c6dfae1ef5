#include "projects/proof/budget/budget_json.h"

#include <cmath>

#include "devices/exchange/pose_json.h"
#include "projects/proof/budget/budget_advice.h"

namespace seamwright {
namespace {

using nlohmann::json;

json degrees_json(double degrees) {
    return std::isfinite(degrees) ? json(degrees) : json();
}

json row_json(const BudgetRow& row) {
    return {{"source", to_string(row.source)},
            {"of", row.owner},
            {"spot", row.spot_id.empty() ? json() : json(row.spot_id)},
            {"part", is_systematic(row.source) ? "systematic" : "random"},
            {"input_u", row.input_u},
            {"input_unit", is_share(row.source) ? "1" : "mm"},
            {"type", row.type_a ? "A" : "B"},
            {"degrees", degrees_json(row.degrees)},
            {"sensitivity", row.sensitivity},
            {"u", row.u},
            {"share_percent", 100 * row.share}};
}

json measurand_json(const MeasurandBudget& m) {
    json rows = json::array();
    for (const BudgetRow& row : m.rows) rows.push_back(row_json(row));
    json out = {{"name", to_string(m.quantity)},
                {"unit", is_angle(m.quantity) ? "deg" : "mm"},
                {"u", m.u},
                {"u_random", m.u_random},
                {"u_systematic", m.u_systematic},
                {"degrees", degrees_json(m.degrees)},
                {"k", m.k},
                {"expanded", m.expanded},
                {"rows", rows}};
    if (m.drawn)
        out["monte_carlo"] = {{"mean", m.drawn->mean},
                              {"u", m.drawn->u},
                              {"limits", {m.drawn->low, m.drawn->high}},
                              {"agrees", m.agrees}};
    return out;
}

}  // namespace

json budget_json(const RegionBudget& b) {
    json measurands = json::array();
    for (const MeasurandBudget& m : b.measurands) measurands.push_back(measurand_json(m));
    json mend = json::array();
    for (const Mending& m : mendings(b))
        mend.push_back({{"source", to_string(m.source)},
                        {"what", m.what},
                        {"share_percent", 100 * m.share},
                        {"u_without", m.u_mm}});
    json out = {
        {"id", b.region_id},    {"status", to_string(b.status)},
        {"message", b.message}, {"displacement", pose_json(b.displacement.workobject_from_movedworkobject)},
        {"spot", b.spot_id},    {"measurands", measurands},
        {"remarks", b.remarks}, {"mend", mend}};
    if (b.drawn)
        out["monte_carlo"] = {{"trials", b.drawn->trials},
                              {"failed", b.drawn->failed},
                              {"settled", b.drawn->settled},
                              {"seed", b.seed},
                              {"first_order_holds", b.first_order_holds()}};
    return out;
}

}  // namespace seamwright
