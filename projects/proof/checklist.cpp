#include "projects/proof/checklist.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "devices/capture/capture.h"
#include "devices/registry.h"
#include "projects/drift/drift_point.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"
#include "projects/measure/reference_feature.h"
#include "projects/model/part_types.h"
#include "projects/proof/forecast.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/present_names.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

std::string mm(double value) {
    return fmt::format("{:.3f}", value);
}

CheckItem made(CheckStep step, CheckStatus status, Text why) {
    return {step, status, std::move(why), {}};
}
CheckItem missing(CheckStep step, Text why) {
    return made(step, CheckStatus::missing, std::move(why));
}
CheckItem stale(CheckStep step, Text why) {
    return made(step, CheckStatus::stale, std::move(why));
}
CheckItem done(CheckStep step, Text why, std::vector<Text> evidence) {
    return {step, CheckStatus::done, std::move(why), std::move(evidence)};
}

constexpr double kSlackOfTyped = 1 + 1e-9;  // of limits that were typed

std::string date_of(const std::string& utc) {
    return utc.substr(0, std::min<std::size_t>(10, utc.size()));
}

const DeviceFact* fact_of(const std::vector<DeviceFact>& facts, const std::string& id) {
    for (const DeviceFact& f : facts)
        if (f.id == id) return &f;
    return nullptr;
}

CheckItem check_sensors(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::sensors;
    if (p.sensors.empty()) return missing(kStep, Text("add a sensor"));
    std::vector<Text> evidence;
    for (const SensorSetup& s : p.sensors) {
        if (facts.sensors) {
            const DeviceFact* fact = fact_of(*facts.sensors, s.id);
            if (!fact || !fact->answers) return missing(kStep, Text("connect the devices"));
            if (!fact->trouble.empty())
                return missing(kStep, Text("sensor {} delivers no frame: {}", s.id, fact->trouble));
        } else if (s.identity.serial.empty()) {
            return missing(kStep, Text("sensor {} was never connected", s.id));
        }
        evidence.push_back(Text("sensor {}: {} {}, serial {}", s.id, s.identity.vendor, s.identity.model,
                                s.identity.serial));
    }
    return done(kStep,
                Text::chosen(facts.sensors ? "all sensors answer ({})" : "all sensors answered last ({})",
                             p.sensors.size()),
                std::move(evidence));
}

CheckItem check_robots(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::robots;
    if (p.robots.empty()) return missing(kStep, Text("add a robot"));
    std::vector<Text> evidence;
    for (const RobotSetup& r : p.robots) {
        if (facts.robots) {
            const DeviceFact* fact = fact_of(*facts.robots, r.id);
            if (!fact || !fact->answers) return missing(kStep, Text("connect the devices"));
            if (!fact->trouble.empty())
                return missing(kStep, Text("robot {} does not answer: {}", r.id, fact->trouble));
        }
        if (r.identity.serial.empty() && r.identity.brand.empty())
            return missing(kStep, Text("robot {} has not told who it is", r.id));
        evidence.push_back(
            Text("robot {}: {} {}, serial {}", r.id, r.identity.brand, r.identity.model, r.identity.serial));
    }
    return done(kStep,
                Text::chosen(facts.robots ? "all robots answer ({})" : "all robots answered last ({})",
                             p.robots.size()),
                std::move(evidence));
}

CheckItem check_calibrations(const Project& p, const std::string& now_utc) {
    constexpr CheckStep kStep = CheckStep::calibrations;
    if (p.sensors.empty()) return missing(kStep, Text("there is no sensor to calibrate"));
    std::vector<Text> evidence;
    for (const SensorSetup& s : p.sensors) {
        const auto c = std::find_if(p.calibrations.begin(), p.calibrations.end(),
                                    [&](const Calibration& k) { return k.id == s.calibration_id; });
        if (s.calibration_id.empty() || c == p.calibrations.end())
            return missing(kStep, Text("sensor {} has no calibration in use", s.id));
        if (!serves(c->verdict))
            return missing(kStep, Text("calibration {} of sensor {} is {}", c->id, s.id,
                                       Text(name_of(c->verdict).data())));
        if (!s.identity.serial.empty() && !(s.identity == c->sensor_identity))
            return stale(kStep, Text("sensor {} is another device ({}) than was calibrated ({})", s.id,
                                     s.identity.serial, c->sensor_identity.serial));
        if (const RobotSetup* r = find_robot(p, c->robot_id);
            r && !r->identity.serial.empty() && !(r->identity == c->robot_identity))
            return stale(kStep, Text("robot {} is another one ({}) than sensor {} was calibrated on ({})",
                                     r->id, r->identity.serial, s.id, c->robot_identity.serial));
        const auto age = days_between(c->created_utc, now_utc);
        if (!age) return stale(kStep, Text("calibration {} of sensor {} has no date", c->id, s.id));
        if (*age > p.requirements.calibration_age_days)
            return stale(kStep, Text("calibration {} of sensor {} is {} days old, {} are allowed", c->id,
                                     s.id, fmt::format("{:.0f}", *age),
                                     fmt::format("{:.0f}", p.requirements.calibration_age_days)));
        if (const std::string collided = last_collision(p, c->robot_id);
            before_collision(c->created_utc, collided))
            return stale(kStep, Text("calibration {} of sensor {} is older than the collision of {}", c->id,
                                     s.id, collided));
        evidence.push_back(Text("sensor {}: {} of {}, {}", s.id, c->method, date_of(c->created_utc),
                                Text(name_of(c->verdict).data())));
    }
    for (const RobotSetup& r : p.robots) {
        const Calibration* nozzle = nozzle_of(p, r.id);
        if (!nozzle) continue;
        if (Text trouble = nozzle_trouble(p, r.id); !trouble.empty()) return stale(kStep, std::move(trouble));
        evidence.push_back(Text("robot {}: nozzle of {}, three sigma {} mm", r.id,
                                date_of(nozzle->created_utc), mm(3 * nozzle_sigma_mm(*nozzle))));
    }
    return done(kStep, Text("every sensor has a fresh calibration in use"), std::move(evidence));
}

CheckItem check_taught(const Project& p) {
    constexpr CheckStep kStep = CheckStep::taught;
    std::vector<Text> evidence;
    for (const Spot& spot : p.spots) {
        if (!spot.enabled) continue;
        if (auto open = taught_open(p, spot)) return *open;
        evidence.push_back(Text("spot {}: {}, reference x {} mm, z {} mm", spot.id, spot.feature.kind,
                                mm(spot.reference_mm.x()), mm(spot.reference_mm.z())));
    }
    if (evidence.empty()) return missing(kStep, Text("add a spot where the contour is to be measured"));
    const std::size_t taught = evidence.size();
    return done(kStep, Text("{} spots have their reference", taught), std::move(evidence));
}

Text name_of_status(AlignmentStatus status) {
    switch (status) {
        case AlignmentStatus::frozen:
            return Text("frozen");
        case AlignmentStatus::drifting:
            return Text("drifting");
        case AlignmentStatus::shape_changes:
            return Text("changing its shape");
        case AlignmentStatus::not_enough_profiles:
        case AlignmentStatus::undetermined:
            break;
    }
    return Text("seen too little");
}

CheckItem check_frozen(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::frozen;
    std::vector<Text> evidence;
    for (const Spot& spot : p.spots) {
        if (!spot.enabled) continue;
        if (auto open = frozen_open(p, facts, spot)) return *open;
        const Evidence* e = newest_pass(p, facts, spot.id);
        const auto& f = std::get<FrozenContour>(e->what);
        evidence.push_back(
            Text("spot {}: frozen, expected error {} mm at a jitter of {} mm, tolerance {} mm, {}", spot.id,
                 mm(f.expected_error_mm), mm(f.jitter_mm), mm(f.tolerance_mm), date_of(e->utc)));
    }
    if (evidence.empty()) return missing(kStep, Text("there is no spot to align"));
    const std::size_t frozen = evidence.size();
    return done(kStep, Text("the contour stands still at {} spots", frozen), std::move(evidence));
}

CheckItem check_observable(const Project& p) {
    constexpr CheckStep kStep = CheckStep::observable;
    if (p.regions.empty()) return missing(kStep, Text("add a region and give it spots"));
    std::vector<Text> evidence;
    for (const Region& region : p.regions) {
        if (region.spot_ids.empty()) return missing(kStep, Text("region {} has no spots", region.id));
        if (region.frame_name.empty())
            return missing(kStep, Text("name the controller's frame of region {}", region.id));
        const auto forecast = forecast_region(p, region);
        if (!forecast) return missing(kStep, Text("region {}: {}", region.id, forecast.error().what));
        const RegionPlan& plan = forecast->plan;
        if (plan.status != CorrectionStatus::ok)
            return missing(kStep, Text("region {} is under-determined: {}", region.id,
                                       plan.unobservable.empty() ? plan.weakest : plan.unobservable.front()));
        if (!forecast->enough()) {
            const Text cure = forecast->cures.empty() ? Text("add spots that lie farther apart")
                                                      : forecast->cures.front().what;
            if (forecast->sigma_mm > forecast->wanted_mm)
                return missing(kStep,
                               Text("region {} reaches 3 sigma {} mm, {} mm are required: {}", region.id,
                                    mm(3 * forecast->sigma_mm), mm(3 * forecast->wanted_mm), cure));
            return missing(kStep,
                           Text("region {} reaches a sigma of {} deg, its limit is {} deg: {}", region.id,
                                fmt::format("{:.4f}", forecast->sigma_deg), forecast->wanted_deg, cure));
        }
        evidence.push_back(Text("region {}: predicted 3 sigma {} mm, required {} mm", region.id,
                                mm(3 * forecast->sigma_mm), mm(3 * forecast->wanted_mm)));
    }
    for (const Spot& spot : p.spots) {
        const bool used = std::any_of(p.regions.begin(), p.regions.end(), [&](const Region& r) {
            return std::find(r.spot_ids.begin(), r.spot_ids.end(), spot.id) != r.spot_ids.end();
        });
        if (spot.enabled && !used) return missing(kStep, Text("spot {} belongs to no region", spot.id));
    }
    return done(kStep, Text("{} regions are observable within the required 3 sigma", p.regions.size()),
                std::move(evidence));
}

// Whether evidence still holds for the project; else the stale item.
std::optional<CheckItem> outdated(CheckStep step, const Evidence& e, const Project& p, const Facts& facts) {
    const auto then = facts.setups.find(e.setup);
    const Text changed = then == facts.setups.end() ? Text("the project") : changed_since(*then->second, p);
    if (changed.empty()) return std::nullopt;
    return stale(step, Text("{} was changed since the proof of {}", changed, date_of(e.utc)));
}

Text put_back(const Project& p, double off_mm) {
    const std::string off = fmt::format("{:.1f}", off_mm);
    const bool simulated = std::any_of(p.sensors.begin(), p.sensors.end(),
                                       [](const SensorSetup& s) { return is_simulated_cell(s.driver); });
    if (simulated)
        return Text(
            "all regions read one displacement, {} mm: the simulated part does not lie as taught. Press "
            "\"As taught\" in step Cell and measure again",
            off);
    return Text(
        "all regions read one displacement, {} mm: the part does not lie as taught. Put it back and "
        "measure again, or teach anew if this is the new master",
        off);
}

CheckItem check_zero_shift(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::zero_shift;
    const int wanted = static_cast<int>(std::lround(p.requirements.zero_shift_runs));
    const Evidence* e = newest<ZeroShift>(facts);
    if (!e) return missing(kStep, Text("measure the unmoved part {} times: it must read zero", wanted));
    if (auto old = outdated(kStep, *e, p, facts)) return *old;
    const auto zero = in_present_names<ZeroShift>(*e, facts, p);
    if (zero.refused > 0)
        return missing(kStep, Text("{} of {} zero-shift runs were refused; see why and repeat", zero.refused,
                                   zero.runs.size()));
    if (static_cast<int>(zero.runs.size()) < wanted)
        return missing(kStep, Text("{} of {} zero-shift runs", zero.runs.size(), wanted));
    if (const auto off_mm = displaced_as_one_mm(p, zero)) return missing(kStep, put_back(p, *off_mm));
    std::vector<Text> evidence;
    for (const ZeroShiftRegion& r : zero.regions) {
        if (r.worst_mean_mm > p.requirements.sigma3_mm)
            return missing(kStep, Text("region {} reads {} mm on the unmoved part; teach it again",
                                       r.region_id, mm(r.worst_mean_mm)));
        evidence.push_back(Text("region {}: mean of {} runs within {} mm of zero, {}", r.region_id,
                                zero.runs.size(), mm(r.worst_mean_mm), date_of(e->utc)));
    }
    return done(kStep, Text("{} runs of the unmoved part read zero", zero.runs.size()), std::move(evidence));
}

CheckItem check_known_shift(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::known_shift;
    const Requirements& need = p.requirements;
    const Evidence* e = newest<KnownShift>(facts);
    if (!e) return missing(kStep, Text("displace the part by known amounts and measure it"));
    if (auto old = outdated(kStep, *e, p, facts)) return *old;
    const auto proof = in_present_names<KnownShift>(*e, facts, p);
    std::vector<Text> evidence;
    for (const Region& region : p.regions) {
        const ProvenAccuracy proven = proven_accuracy(proof, region.id);
        if (proven.refused > 0 || proven.tests == 0)
            return missing(kStep, Text("region {}: {} of {} known shifts were refused", region.id,
                                       proven.refused, proven.tests));
        if (proven.three_sigma_mm > need.sigma3_mm)
            return missing(kStep,
                           Text("region {}: known shifts come back with 3 sigma {} mm, required are {} mm",
                                region.id, mm(proven.three_sigma_mm), mm(need.sigma3_mm)));
        evidence.push_back(Text("region {}: {} displacements, 3 sigma {} mm about the truth, {}", region.id,
                                proven.tests, mm(proven.three_sigma_mm), date_of(e->utc)));
    }
    // A hair of tolerance for ranges that were typed.
    if (proof.range_mm < need.known_shift_mm * (1 - 1e-9) ||
        proof.range_deg < need.known_shift_deg * (1 - 1e-9))
        return missing(kStep,
                       Text("proven up to {} mm and {} deg, required are {} mm and {} deg", proof.range_mm,
                            proof.range_deg, need.known_shift_mm, need.known_shift_deg));
    return done(kStep, Text("{} known displacements were recovered", proof.tests.size()),
                std::move(evidence));
}

CheckItem check_limits(const Project& p, const Facts& facts, const CheckItem& known_shift) {
    constexpr CheckStep kStep = CheckStep::limits;
    if (p.regions.empty()) return missing(kStep, Text("add a region and give it spots"));
    if (!known_shift.done())
        return missing(kStep, Text("limits are judged by the range that the known shift has proven"));
    const auto& proof = std::get<KnownShift>(newest<KnownShift>(facts)->what);
    const ProvenRange range = proven_range(proof);
    const CorrectionLimits rounded = proven_limits(proof);
    constexpr double kSlack = 1 + 1e-6;
    std::vector<Text> evidence;
    for (const Region& r : p.regions) {
        if (!(r.limits.translation_mm <= range.translation_mm * kSlack) ||
            !(r.limits.rotation_deg <= range.rotation_deg * kSlack))
            return missing(
                kStep,
                Text("region {} lets {} mm and {} deg through, proven are {} mm and {} deg: lower its limits "
                     "or prove more",
                     r.id, r.limits.translation_mm, r.limits.rotation_deg,
                     fmt::format("{:.2f}", rounded.translation_mm),
                     fmt::format("{:.3f}", rounded.rotation_deg)));
        if (!(3 * r.sigma_limit_mm <= p.requirements.sigma3_mm * kSlack))
            return missing(kStep, Text("region {} lets 3 sigma {} mm through, required are {} mm: lower its "
                                       "sigma limit",
                                       r.id, mm(3 * r.sigma_limit_mm), mm(p.requirements.sigma3_mm)));
        evidence.push_back(Text("region {}: {} mm, {} deg, 3 sigma {} mm", r.id, r.limits.translation_mm,
                                r.limits.rotation_deg, mm(3 * r.sigma_limit_mm)));
    }
    return done(kStep, Text("no region lets through more than was proven"), std::move(evidence));
}

CheckItem check_headless(const Project& p, const Facts& facts) {
    constexpr CheckStep kStep = CheckStep::headless;
    const Evidence* e = newest<HeadlessRun>(facts);
    if (!e)
        return missing(kStep, Text("save, close, and run it once without the screen: seamwright run {}",
                                   facts.file.empty() ? std::string("FILE.seam") : facts.file));
    if (auto old = outdated(kStep, *e, p, facts)) return *old;
    const auto& run = std::get<HeadlessRun>(e->what);
    return done(kStep, Text("a run without the screen ended ok"),
                {run.push ? Text("run {} of part {} on {}, pushed and read back, {}", run.run, run.part_id,
                                 run.host, date_of(e->utc))
                          : Text("run {} of part {} on {}, dry run, {}", run.run, run.part_id, run.host,
                                 date_of(e->utc))});
}

}  // namespace

std::string_view to_string(CheckStep step) {
    constexpr std::array<std::string_view, 10> names{"sensors", "robots",     "calibrations", "taught",
                                                     "frozen",  "observable", "zero-shift",   "known-shift",
                                                     "limits",  "headless"};
    return names[static_cast<std::size_t>(step)];
}

Text name_of(CheckStep step) {
    switch (step) {
        case CheckStep::sensors:
            return Text("Sensors connected and healthy");
        case CheckStep::robots:
            return Text("Robots connected and known");
        case CheckStep::calibrations:
            return Text("Sensors calibrated, fresh");
        case CheckStep::taught:
            return Text("Spots taught");
        case CheckStep::frozen:
            return Text("Contours frozen");
        case CheckStep::observable:
            return Text("Regions observable");
        case CheckStep::zero_shift:
            return Text("Zero shift");
        case CheckStep::known_shift:
            return Text("Known shift recovered");
        case CheckStep::limits:
            return Text("Limits set");
        case CheckStep::headless:
            break;
    }
    return Text("Run without the screen");
}

std::string_view to_string(CheckStatus status) {
    return status == CheckStatus::done ? "done" : status == CheckStatus::stale ? "stale" : "missing";
}
Text name_of(CheckStatus status) {
    return status == CheckStatus::done    ? Text("done")
           : status == CheckStatus::stale ? Text("stale")
                                          : Text("missing");
}

std::optional<CheckItem> taught_open(const Project& project, const Spot& spot) {
    constexpr CheckStep kStep = CheckStep::taught;
    if (spot.reference_profile.size() == 0)
        return missing(kStep, Text("measure the reference of spot {}", spot.id));
    if (spot.reference_state == ReferenceState::from_type)
        return missing(kStep,
                       Text("teach spot {} on its own part: its reference is another type's", spot.id));
    if (spot.reference_state == ReferenceState::from_drawing)
        return missing(kStep,
                       Text("confirm spot {} on the part: its reference is from the drawing", spot.id));
    if (const double beside = reference_beside_mm(project, spot); beside > 0)
        return missing(
            kStep, Text("the reference of spot {} lies {} mm beside its feature in the profile kept with it: "
                        "measure the reference again",
                        spot.id, mm(beside)));
    return std::nullopt;
}

std::optional<CheckItem> frozen_open(const Project& project, const Facts& facts, const Spot& spot) {
    constexpr CheckStep kStep = CheckStep::frozen;
    if (!spot.curve) return missing(kStep, Text("record the pass of spot {} and accept it", spot.id));
    const Evidence* e = newest_pass(project, facts, spot.id);
    if (!e)
        return missing(kStep,
                       Text("the file holds no accepted pass of spot {}: record it and accept it", spot.id));
    const auto& f = std::get<FrozenContour>(e->what);
    if (f.status != AlignmentStatus::frozen)
        return missing(kStep, Text("the contour of spot {} is {}", spot.id, name_of_status(f.status)));
    const double needed = project.requirements.sigma3_mm;
    if (!(f.expected_error_mm <= needed * kSlackOfTyped))
        return missing(
            kStep, Text("the jitter moves the contour of spot {} by up to {} mm, {} mm are required", spot.id,
                        mm(f.expected_error_mm), mm(needed)));
    if (widened_tolerance(project, f.tolerance_mm))
        return missing(kStep,
                       Text("the contour of spot {} was judged frozen at a tolerance of {} mm, {} mm are "
                            "required: record its pass again with a smaller tolerance",
                            spot.id, mm(f.tolerance_mm), mm(needed)));
    if (const auto then = facts.setups.find(e->setup);
        then == facts.setups.end() || pass_changed(*then->second, project, spot.id))
        return stale(kStep, Text("spot {} was changed since its pass of {}", spot.id, date_of(e->utc)));
    return std::nullopt;
}

bool widened_tolerance(const Project& project, double tolerance_mm) {
    return !(tolerance_mm <= project.requirements.sigma3_mm * kSlackOfTyped);
}

std::optional<double> days_between(const std::string& from_utc, const std::string& to_utc) {
    const auto from = utc_seconds(from_utc), to = utc_seconds(to_utc);
    if (!from || !to) return std::nullopt;
    const auto day = [](std::int64_t seconds) {
        return std::chrono::floor<std::chrono::days>(std::chrono::seconds(seconds)).count();
    };
    return static_cast<double>(day(*to) - day(*from));
}

Expected<void> gather(const ProjectFile& file, Facts& facts) {
    facts.file = file.path().filename().string();
    SEAM_TRY(auto more, file.evidence(facts.evidence.empty() ? 0 : facts.evidence.back().id));
    for (Evidence& e : more) {
        if (!facts.setups.count(e.setup)) {
            SEAM_TRY(auto setup, file.load_setup(e.setup));
            facts.setups[e.setup] = std::make_shared<const Project>(std::move(setup));
        }
        facts.evidence.push_back(std::move(e));
    }
    return {};
}

namespace {

std::vector<CheckItem> checklist_of_one(const Project& project, const Facts& facts) {
    std::vector<CheckItem> items{
        check_sensors(project, facts),
        check_robots(project, facts),
        check_calibrations(project, facts.now_utc.empty() ? utc_now() : facts.now_utc),
        check_taught(project),
        check_frozen(project, facts),
        check_observable(project),
        check_zero_shift(project, facts),
        check_known_shift(project, facts)};
    items.push_back(check_limits(project, facts, items.back()));
    items.push_back(check_headless(project, facts));
    return items;
}

// What was proven of one type: with a setup of it alone; a contour is known by its spot.
Facts facts_of(const std::string& type, const Facts& facts) {
    Facts its = facts;
    std::erase_if(its.evidence, [&](const Evidence& e) {
        if (std::holds_alternative<FrozenContour>(e.what)) return false;
        const auto setup = facts.setups.find(e.setup);
        if (setup == facts.setups.end()) return true;
        const auto& types = setup->second->part_types;
        return types.size() != 1 || types.front().id != type;
    });
    return its;
}

}  // namespace

std::vector<CheckItem> checklist(const Project& project, const Facts& facts) {
    if (project.part_types.empty()) return checklist_of_one(project, facts);
    std::vector<CheckItem> items;
    // The references' own program corrects nothing: it comes last, with what it owes.
    auto types = project.part_types;
    std::stable_partition(types.begin(), types.end(),
                          [&](const PartType& type) { return !references_alone(of_type(project, type.id)); });
    for (const PartType& type : types) {
        std::vector<CheckItem> its = checklist_of_one(of_type(project, type.id), facts_of(type.id, facts));
        if (!items.empty() && references_alone(of_type(project, type.id)))
            std::erase_if(its, [](const CheckItem& item) { return item.step >= CheckStep::observable; });
        for (CheckItem& item : its) {
            item.why = Text("part type {}: {}", type.id, item.why);
            for (Text& line : item.evidence) line = Text("part type {}: {}", type.id, line);
        }
        if (items.empty()) {
            items = std::move(its);
            continue;
        }
        // The first type with something open speaks for the step.
        for (std::size_t i = 0; i < its.size(); ++i) {
            if (!items[i].done()) continue;
            if (!its[i].done()) {
                items[i] = std::move(its[i]);
                continue;
            }
            items[i].why = joined(items[i].why, "; ", its[i].why);
            items[i].evidence.insert(items[i].evidence.end(), its[i].evidence.begin(), its[i].evidence.end());
        }
    }
    return items;
}

}  // namespace seamwright
