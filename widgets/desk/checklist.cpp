#include "widgets/desk/checklist.h"

#include <algorithm>

#include "projects/measure.h"

namespace seamwright {
namespace {

struct Checklist {
    Q_DECLARE_TR_FUNCTIONS(Checklist)
};
QString q(const std::string& text) {
    return QString::fromStdString(text);
}

struct Judged {
    bool done = false, stale = false;
    QString why;
};

Judged judge_cell(const Project& p, const DeskFacts& f) {
    if (p.sensors.empty()) return {false, false, Checklist::tr("add a sensor")};
    if (p.robots.empty()) return {false, false, Checklist::tr("add a robot")};
    if (!f.connected) return {false, false, Checklist::tr("connect the devices")};
    return {true, false,
            Checklist::tr("%1 sensors and %2 robots answer").arg(p.sensors.size()).arg(p.robots.size())};
}

Judged judge_calibrate(const Project& p, const DeskFacts& f) {
    for (std::size_t i = 0; i < p.sensors.size(); ++i) {
        const SensorSetup& sensor = p.sensors[i];
        const auto c = std::find_if(p.calibrations.begin(), p.calibrations.end(),
                                    [&](const Calibration& k) { return k.id == sensor.calibration_id; });
        if (sensor.calibration_id.empty() || c == p.calibrations.end())
            return {false, false, Checklist::tr("sensor %1 has no calibration in use").arg(q(sensor.id))};
        if (c->verdict != "good" && c->verdict != "usable")
            return {false, false,
                    Checklist::tr("calibration %1 of sensor %2 is %3")
                        .arg(q(c->id), q(sensor.id), q(c->verdict))};
        if (i < f.sensors.size() && !f.sensors[i].serial.empty() && !(f.sensors[i] == c->sensor_identity))
            return {false, true,
                    Checklist::tr("sensor %1 is another device (%2) than was calibrated (%3)")
                        .arg(q(sensor.id), q(f.sensors[i].serial), q(c->sensor_identity.serial))};
    }
    if (p.sensors.empty()) return {false, false, Checklist::tr("there is no sensor to calibrate")};
    return {true, false, Checklist::tr("every sensor has a calibration in use")};
}

Judged judge_teach(const Project& p) {
    int enabled = 0;
    for (const Spot& spot : p.spots) {
        if (!spot.enabled) continue;
        ++enabled;
        if (spot.reference_profile.size() == 0)
            return {false, false, Checklist::tr("measure the reference of spot %1").arg(q(spot.id))};
    }
    if (enabled == 0) return {false, false, Checklist::tr("add a spot where the contour is to be measured")};
    return {true, false, Checklist::tr("%1 spots have their reference").arg(enabled)};
}

Judged judge_align(const Project& p) {
    int enabled = 0;
    for (const Spot& spot : p.spots) {
        if (!spot.enabled) continue;
        ++enabled;
        if (!spot.curve)
            return {false, false, Checklist::tr("record the pass of spot %1 and accept it").arg(q(spot.id))};
    }
    if (enabled == 0) return {false, false, Checklist::tr("there is no spot to align")};
    return {true, false, Checklist::tr("the contour stands still at %1 spots").arg(enabled)};
}

Judged judge_regions(const Project& p) {
    if (p.regions.empty()) return {false, false, Checklist::tr("add a region and give it spots")};
    for (const Region& region : p.regions) {
        if (region.spot_ids.empty())
            return {false, false, Checklist::tr("region %1 has no spots").arg(q(region.id))};
        if (region.frame_name.empty())
            return {false, false,
                    Checklist::tr("name the controller's frame of region %1").arg(q(region.id))};
        const auto plan = plan_region(planned_observations(p, region), correction_options(region));
        if (!plan)
            return {false, false, Checklist::tr("region %1: %2").arg(q(region.id), q(plan.error().what))};
        if (plan->status != CorrectionStatus::ok)
            return {false, false,
                    Checklist::tr("region %1 is under-determined: %2")
                        .arg(q(region.id),
                             plan->unobservable.empty() ? q(plan->weakest) : q(plan->unobservable.front()))};
    }
    for (const Spot& spot : p.spots) {
        const bool used = std::any_of(p.regions.begin(), p.regions.end(), [&](const Region& r) {
            return std::find(r.spot_ids.begin(), r.spot_ids.end(), spot.id) != r.spot_ids.end();
        });
        if (spot.enabled && !used)
            return {false, false, Checklist::tr("spot %1 belongs to no region").arg(q(spot.id))};
    }
    return {true, false, Checklist::tr("%1 regions are observable").arg(p.regions.size())};
}

Judged judge_prove(const DeskFacts& f) {
    if (f.zero_shift_runs == 0)
        return {false, false,
                Checklist::tr("measure the unmoved part %1 times: it must read zero").arg(kZeroShiftRuns)};
    if (!f.zero_shift_current)
        return {false, true,
                Checklist::tr("spots, regions or calibration were changed since the zero shift of %1")
                    .arg(f.zero_shift_utc)};
    if (!f.zero_shift_ok)
        return {false, false, Checklist::tr("a zero-shift run was refused; see why and repeat")};
    if (f.zero_shift_runs < kZeroShiftRuns)
        return {false, false,
                Checklist::tr("%1 of %2 zero-shift runs").arg(f.zero_shift_runs).arg(kZeroShiftRuns)};
    return {true, false, Checklist::tr("%1 runs of the unmoved part read zero").arg(f.zero_shift_runs)};
}

}  // namespace

CorrectionOptions correction_options(const Region& region) {
    CorrectionOptions options;
    options.free = region.free;
    options.limits = region.limits;
    return options;
}

std::array<StepState, 7> checklist(const Project& project, const DeskFacts& facts) {
    const std::array<Judged, 7> judged{judge_cell(project, facts),
                                       judge_calibrate(project, facts),
                                       judge_teach(project),
                                       judge_align(project),
                                       judge_regions(project),
                                       judge_prove(facts),
                                       {false, false, Checklist::tr("measure the next part")}};
    std::array<StepState, 7> steps;
    bool found = false;
    QString before;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        steps[i].step = kSteps[i];
        steps[i].stale = judged[i].stale;
        steps[i].why = judged[i].why;
        if (judged[i].done) {
            steps[i].status = StepStatus::done;
        } else if (!found) {
            steps[i].status = StepStatus::next;
            found = true;
            before = step_name(kSteps[i]);
        } else {
            steps[i].status = judged[i].stale ? StepStatus::stale : StepStatus::blocked;
            if (!judged[i].stale) steps[i].why = Checklist::tr("first: %1").arg(before);
        }
    }
    return steps;
}

Step next_step(const std::array<StepState, 7>& steps) {
    for (const StepState& s : steps)
        if (s.status == StepStatus::next) return s.step;
    return Step::run;
}

QString step_name(Step step) {
    switch (step) {
        case Step::cell:
            return Checklist::tr("Cell");
        case Step::calibrate:
            return Checklist::tr("Calibrate");
        case Step::teach:
            return Checklist::tr("Teach");
        case Step::align:
            return Checklist::tr("Align");
        case Step::regions:
            return Checklist::tr("Regions");
        case Step::prove:
            return Checklist::tr("Prove");
        case Step::run:
            return Checklist::tr("Run");
    }
    return {};
}

QString status_word(StepStatus status) {
    switch (status) {
        case StepStatus::done:
            return Checklist::tr("done");
        case StepStatus::next:
            return Checklist::tr("next");
        case StepStatus::blocked:
            return Checklist::tr("waits");
        case StepStatus::stale:
            return Checklist::tr("stale");
    }
    return {};
}

}  // namespace seamwright
