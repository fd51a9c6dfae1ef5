#include "projects/proof/budget/budget_advice.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

Text mend(const BudgetRow& row, bool robot_measured) {
    const std::string& of = row.owner;
    switch (row.source) {
        case ErrorSource::feature:
            return row.spot_id.empty()
                       ? Text("sensor {}: teach the spots by templates of longer pieces with more shape", of)
                       : Text(
                             "sensor {}: spot {} contributes most; teach it by a template of a longer piece "
                             "with "
                             "more shape, or put it where the contour is sharper",
                             of, row.spot_id);
        case ErrorSource::stated:
            return robot_measured
                       ? Text(
                             "the spots' own sigma is typed and stands beside the measured robot: what it "
                             "held for the robot counts twice; lower it")
                       : Text(
                             "the spots' own sigma is typed: measure the robot (measure-robot), which then "
                             "stands in its place, and lower it");
        case ErrorSource::travel:
            return Text(
                "robot {}: stand still at the trigger, or measure the jitter (measure-trigger), which takes "
                "the typed window's place",
                of);
        case ErrorSource::robot_run:
            return Text(
                "robot {}: its arrivals scatter; arrive slower, let it settle, or take a stiffer one, and "
                "measure it again (measure-robot); more spots average it out",
                of);
        case ErrorSource::reference:
            return Text("sensor {}: teach the references again with more profiles", of);
        case ErrorSource::robot_taught:
            return Text("robot {}: teach the references by more arrivals", of);
        case ErrorSource::nozzle:
            return Text("robot {}: calibrate the nozzle with more touches, from more sides", of);
        case ErrorSource::offset:
            return Text(
                "the kept offset is known this well: correlate more parts with the better instrument");
        case ErrorSource::workobject:
            return Text(
                "measure the work object with the robot that lays the bead, or teach the path with the robot "
                "that measures");
        case ErrorSource::robot_drift:
        case ErrorSource::sensor_drift:
            return Text(
                "drift of {}: a narrower limit of the drift watch, references with every part, or have it "
                "compensated",
                of);
        case ErrorSource::hand_eye:
            return Text("recalibrate sensor {} with more poses, turned further", of);
        case ErrorSource::scale_x:
        case ErrorSource::scale_z:
        case ErrorSource::shear:
            return Text(
                "sensor {}: calibrate its millimetres with more places over the whole field (stripe-camera "
                "or lut)",
                of);
        case ErrorSource::latency:
        case ErrorSource::speed:
            return Text(
                "sensor {}: pass the spots slower, with the override of the teaching, or stand still at the "
                "trigger",
                of);
    }
    return {};
}

}  // namespace

const MeasurandBudget* worst_across_bead(const RegionBudget& budget) {
    const MeasurandBudget* worst = nullptr;
    for (const MeasurandBudget& m : budget.measurands)
        if (m.quantity <= Quantity::binormal && (!worst || m.u > worst->u)) worst = &m;
    return worst;
}

std::vector<Mending> mendings(const RegionBudget& budget) {
    std::vector<Mending> all;
    const MeasurandBudget* m = worst_across_bead(budget);
    if (!m) return all;
    const bool robot_measured = std::any_of(m->rows.begin(), m->rows.end(), [](const BudgetRow& row) {
        return row.source == ErrorSource::robot_run;
    });
    for (const BudgetRow& row : m->rows)
        if (row.share >= kWorthMending)
            all.push_back({row.source, mend(row, robot_measured), row.share,
                           m->u * std::sqrt(std::max(0.0, 1 - row.share))});
    std::stable_sort(all.begin(), all.end(),
                     [](const Mending& a, const Mending& b) { return a.share > b.share; });
    return all;
}

}  // namespace seamwright
