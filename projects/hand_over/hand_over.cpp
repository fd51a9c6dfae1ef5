#include "projects/hand_over/hand_over.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/notation.h"
#include "core/median.h"
#include "projects/drift/drift_keeper.h"
#include "projects/file/stored_text.h"
#include "projects/hand_over/hand_over_detail.h"
#include "projects/measure/measure.h"
#include "projects/proof/present_names.h"

namespace seamwright {
namespace {

using report::Mark;
using report::Plot;
using report::Rows;
using report::Series;
using report::Tone;
namespace colour = report::colour;

constexpr int kHalfWidth = 400, kPlotHeight = 240;

void checklist_chapter(HandOverWriter& w, const std::vector<CheckItem>& items) {
    const auto open = std::count_if(items.begin(), items.end(), [](const CheckItem& i) { return !i.done(); });
    w.page.heading(w.t("Commissioning"));
    if (open == 0)
        w.page.verdict(w.t("complete"), Tone::good, w.t("all {} steps are done", items.size()));
    else
        w.page.verdict(w.t("not complete"), Tone::attention,
                       w.t("{} of {} steps are open", open, items.size()));
    Rows rows{{w.t("Step"), w.t("State"), w.t("Finding")}};
    for (const CheckItem& item : items)
        rows.push_back({name_of(item.step).in(w.options.language),
                        name_of(item.status).in(w.options.language), item.why.in(w.options.language)});
    w.page.table(rows);
    const Requirements& r = w.project.requirements;
    w.page.table(
        {{w.t("Requirement"), w.t("Value")},
         {w.t("3 sigma of the corrected path, predicted and proven"), w.number(r.sigma3_mm, 3) + " mm"},
         {w.t("Age of a calibration, at most"), w.t("{} days", w.number(r.calibration_age_days, 0))},
         {w.t("Measurements of the unmoved part, at least"), w.number(r.zero_shift_runs, 0)},
         {w.t("Known shift, range"), fmt::format("{} mm, {}°", r.known_shift_mm, r.known_shift_deg)}},
        w.t("Requirements of this project"));
}

void devices_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Devices"));
    Rows rows{{w.t("Sensor"), w.t("Driver"), w.t("Vendor"), w.t("Model"), w.t("Serial"), w.t("Calibration")}};
    for (const SensorSetup& s : w.project.sensors)
        rows.push_back({s.id, s.driver, s.identity.vendor, s.identity.model, s.identity.serial,
                        s.calibration_id.empty() ? w.t("none") : s.calibration_id});
    w.page.table(rows);
    rows = {
        {w.t("Robot"), w.t("Driver"), w.t("Brand"), w.t("Model"), w.t("Serial"), w.t("Mode for pushing")}};
    for (const RobotSetup& r : w.project.robots)
        rows.push_back({r.id, r.driver, r.identity.brand, r.identity.model, r.identity.serial,
                        r.required_mode == RobotMode::unknown ? w.t("any that runs")
                                                              : std::string(to_string(r.required_mode))});
    w.page.table(rows);
    const KukaAbc abc = kuka_from_rotation(w.project.part.base_from_workobject.linear());
    const Eigen::Vector3d at = w.project.part.base_from_workobject.translation();
    w.page.paragraph(w.t("Part {}, work object in the base: X {} Y {} Z {} mm, A {} B {} C {}°.",
                         w.project.part.name, w.number(at.x(), 2), w.number(at.y(), 2), w.number(at.z(), 2),
                         w.number(abc.a_deg, 3), w.number(abc.b_deg, 3), w.number(abc.c_deg, 3)));
}

double number_in(const nlohmann::json& object, const char* key) {
    const auto it = object.find(key);
    return it != object.end() && it->is_number() ? it->get<double>() : std::nan("");
}
std::string text_in(const nlohmann::json& object, const char* key) {
    const auto it = object.find(key);
    return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
}

// Residual per pose as `seamwright calibrate` keeps it; nullopt where the method kept none.
std::optional<std::string> residual_plot(const HandOverWriter& w, const nlohmann::json& result) {
    const auto poses = result.find("per_pose");
    if (poses == result.end() || !poses->is_array() || poses->empty()) return std::nullopt;
    const char* key = nullptr;
    for (const char* k : {"rms_mm", "rms_px", "deg"})
        if (!key && std::any_of(poses->begin(), poses->end(), [&](const auto& p) {
                return p.is_object() && std::isfinite(number_in(p, k));
            }))
            key = k;
    if (!key) return std::nullopt;
    const std::string unit = key == std::string("rms_mm") ? "mm" : key == std::string("rms_px") ? "px" : "°";
    Plot plot;
    plot.title = w.t("Residual per pose");
    plot.y_label = unit;
    plot.x_label = w.t("pose");
    plot.height_px = 220;
    plot.width_px = 2 * kHalfWidth;
    Series used{w.t("used"), {}, {}, Mark::bars, colour::kBlue},
        left_out{w.t("left out"), {}, {}, Mark::crosses, colour::kVermilion};
    for (std::size_t i = 0; i < poses->size(); ++i) {
        const auto& p = (*poses)[i];
        if (!p.is_object()) continue;
        Series& s = p.value("used", true) ? used : left_out;
        s.x.push_back(static_cast<double>(i));
        s.y.push_back(number_in(p, key));
        plot.categories.push_back(poses->size() > 40 && i % 5 ? std::string() : text_in(p, "id"));
    }
    plot.series = {used};
    if (!left_out.x.empty()) plot.series.push_back(left_out);
    return report::svg(plot);
}

void one_calibration(HandOverWriter& w, const Calibration& c) {
    const bool in_use = std::any_of(w.project.sensors.begin(), w.project.sensors.end(),
                                    [&](const SensorSetup& s) { return s.calibration_id == c.id; });
    w.page.heading(in_use ? w.t("{}, in use at sensor {}", c.id, c.sensor_id)
                          : w.t("{} of sensor {}, not in use", c.id, c.sensor_id),
                   3);
    w.page.verdict(w.t(name_of(c.verdict).data()), report::tone_of(c.verdict),
                   seamwright::text_in(c.result, "reason").in(w.options.language));
    const KukaAbc abc = kuka_from_rotation(c.flange_from_sensor.linear());
    const Eigen::Vector3d at = c.flange_from_sensor.translation();
    const auto sigma = [&](int i, bool angle) {
        const double v = c.covariance(i, i);
        return v > 0 ? w.number(std::sqrt(v) * (angle ? 180 / kPi : 1), angle ? 4 : 3) : "-";
    };
    w.page.table({{w.t("Method"), w.t("Date"), w.t("Sensor serial"), w.t("Robot serial"), w.t("Source")},
                  {c.method, w.time_of(c.created_utc), c.sensor_identity.serial, c.robot_identity.serial,
                   c.source.in(w.options.language)}});
    w.page.table({{w.t("Sensor on the flange"), "X mm", "Y mm", "Z mm", "A °", "B °", "C °"},
                  {w.t("value"), w.number(at.x(), 3), w.number(at.y(), 3), w.number(at.z(), 3),
                   w.number(abc.a_deg, 4), w.number(abc.b_deg, 4), w.number(abc.c_deg, 4)},
                  {w.t("1 sigma (angles about X, Y, Z)"), sigma(0, false), sigma(1, false), sigma(2, false),
                   sigma(3, true), sigma(4, true), sigma(5, true)}});
    if (const auto parameters = c.result.find("parameters");
        parameters != c.result.end() && parameters->is_array() && !parameters->empty()) {
        Rows rows{{w.t("Parameter"), w.t("Value"), w.t("1 sigma"), w.t("Unit")}};
        for (const auto& p : *parameters) {
            if (!p.is_object()) continue;
            rows.push_back({text_in(p, "name"), fmt::format("{:.6g}", number_in(p, "value")),
                            fmt::format("{:.2g}", number_in(p, "sigma")), text_in(p, "unit")});
        }
        w.page.table(rows);
    }
    if (auto plot = residual_plot(w, c.result))
        w.page.figure(*plot);
    else
        w.page.paragraph(w.t("This method keeps no residual per pose."));
    if (const auto hold = c.result.find("hold_out");
        hold != c.result.end() && hold->is_object() && number_in(*hold, "folds") > 0) {
        const bool px = !std::isfinite(number_in(*hold, "rms_mm"));
        w.page.paragraph(w.t("Poses not used for the solution are met within {} {} rms.",
                             w.number(number_in(*hold, px ? "rms_px" : "rms_mm"), 3), px ? "px" : "mm"));
    }
}

void calibrations_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Calibrations"));
    if (w.project.calibrations.empty()) w.page.verdict(w.t("none"), Tone::alarm);
    const auto in_use = [&](const Calibration& c) {
        return std::any_of(w.project.sensors.begin(), w.project.sensors.end(),
                           [&](const SensorSetup& s) { return s.calibration_id == c.id; });
    };
    for (const bool used : {true, false})
        for (const Calibration& c : w.project.calibrations)
            if (in_use(c) == used) one_calibration(w, c);
}

std::string reference_plot(const HandOverWriter& w, const Spot& spot) {
    Plot plot;
    plot.title = w.t("Spot {}: reference profile", spot.id);
    plot.x_label = "x (mm)";
    plot.y_label = "z (mm)";
    plot.equal_scale = true;
    plot.width_px = kHalfWidth;
    plot.height_px = kPlotHeight;
    Series kept{w.t("contour"), {}, {}, Mark::dots, colour::kBlue};
    const Profile& p = spot.reference_profile;
    // Enough points for a plot this wide.
    const std::size_t every = std::max<std::size_t>(1, p.size() / 400);
    for (std::size_t i = 0; i < p.size(); i += every) {
        if (!p.segment.empty() && p.segment[i] == kOutlier) continue;
        kept.x.push_back(p.x_mm[i]);
        kept.y.push_back(p.z_mm[i]);
    }
    plot.series = {kept,
                   {w.t("reference"),
                    {spot.reference_mm.x()},
                    {spot.reference_mm.z()},
                    Mark::crosses,
                    colour::kVermilion}};
    return report::svg(plot);
}

// What all offsets share is of the one profile that the others were laid over, not of the contour: median within the jitter,
// where a frozen contour stands still.
double shared_mm(const FrozenContour& f, double TravelOffset::*axis) {
    std::vector<double> near;
    for (const TravelOffset& o : f.offsets)
        if (std::abs(o.travel_mm) <= f.jitter_mm) near.push_back(o.*axis);
    return near.empty() ? 0 : median(near);
}

std::string frozen_plot(const HandOverWriter& w, const std::string& spot_id, const FrozenContour& f) {
    Plot plot;
    plot.title = w.t("Spot {}: drift over the travel", spot_id);
    plot.x_label = w.t("travel (mm)");
    plot.y_label = "mm";
    plot.width_px = kHalfWidth;
    plot.height_px = kPlotHeight;
    Series dx{"dx", {}, {}, Mark::line, colour::kBlue}, dz{"dz", {}, {}, Mark::dashed, colour::kVermilion};
    const double x_mm = shared_mm(f, &TravelOffset::dx_mm), z_mm = shared_mm(f, &TravelOffset::dz_mm);
    for (const TravelOffset& o : f.offsets) {
        dx.x.push_back(o.travel_mm), dx.y.push_back(o.dx_mm - x_mm);
        dz.x.push_back(o.travel_mm), dz.y.push_back(o.dz_mm - z_mm);
    }
    plot.series = {dx, dz};
    plot.bands = {{-f.tolerance_mm, f.tolerance_mm, w.t("tolerance")}};
    return report::svg(plot);
}

void spots_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Spots"));
    Rows rows{{w.t("Spot"), w.t("Sensor"), w.t("Feature"), w.t("Reference x mm"), "z mm", w.t("1 sigma mm"),
               w.t("Contour"), w.t("Yaw °"), w.t("Pitch °"), w.t("Expected error mm"), w.t("Jitter mm")}};
    for (const Spot& s : w.project.spots) {
        const Evidence* e = newest_pass(w.project, w.facts, s.id);
        const FrozenContour* f = e ? &std::get<FrozenContour>(e->what) : nullptr;
        const bool old = e && (!w.facts.setups.count(e->setup) ||
                               pass_changed(*w.facts.setups.at(e->setup), w.project, s.id));
        rows.push_back({s.enabled ? s.id : w.t("{} (off)", s.id), s.sensor_id, s.feature.kind,
                        w.number(s.reference_mm.x(), 3), w.number(s.reference_mm.z(), 3),
                        w.number(s.sigma_mm, 3),
                        !s.curve                               ? w.t("not recorded")
                        : !f                                   ? w.t("accepted")
                        : old                                  ? w.t("stale")
                        : f->status == AlignmentStatus::frozen ? w.t("frozen")
                                                               : w.t("drifting"),
                        f ? w.number(f->yaw_deg, 3) : "-", f ? w.number(f->pitch_deg, 3) : "-",
                        f ? w.number(f->expected_error_mm, 3) : "-", w.number(s.jitter_mm, 1)});
    }
    w.page.table(rows);
    std::vector<std::string> plots;
    for (const Spot& s : w.project.spots) {
        plots.push_back(reference_plot(w, s));
        if (const Evidence* e = newest_pass(w.project, w.facts, s.id))
            plots.push_back(frozen_plot(w, s.id, std::get<FrozenContour>(e->what)));
    }
    if (!plots.empty()) w.page.figures(plots);
}

void limits_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Limits"));
    w.page.paragraph(w.t("A correction beyond these is refused and not sent to the robot."));
    Rows rows{{w.t("Region"), w.t("Frame on the controller"), w.t("Translation mm"), w.t("Rotation °"),
               w.t("1 sigma mm"), w.t("1 sigma °")}};
    for (const Region& r : w.project.regions)
        rows.push_back({r.id, r.frame_name, fmt::format("{}", r.limits.translation_mm),
                        fmt::format("{}", r.limits.rotation_deg), w.number(r.sigma_limit_mm, 3),
                        w.number(r.sigma_limit_deg, 4)});
    w.page.table(rows);
}

Expected<void> drift_chapter(HandOverWriter& w, const ProjectFile& file) {
    if (!w.project.drift) return {};
    const DriftWatch& watch = *w.project.drift;
    SEAM_TRY(const auto s, stored_standing(file, w.project, w.options.now_utc));
    w.page.heading(w.t("Drift watch"));
    const auto tone = s.stopped || s.verdict == DriftVerdict::recalibrate ? report::Tone::alarm
                      : s.verdict == DriftVerdict::fine                   ? report::Tone::good
                                                                          : report::Tone::attention;
    w.page.verdict(std::string(to_string(s.verdict)), tone, s.text.in(w.options.language));
    w.page.paragraph(w.t("{} points of the references; the last one at {} UTC, {} parts ago.", s.points,
                         w.time_of(s.last_utc), s.parts_since));
    if (watch.learnt) {
        Rows rows{
            {w.t("Direction"), w.t("1 sigma mm"), w.t("stated mm"), w.t("warm-up mm"), w.t("now off mm")}};
        for (std::size_t d = 0; d < watch.learnt->directions.size(); ++d) {
            const LearntDirection& direction = watch.learnt->directions[d];
            rows.push_back({name_of(direction), w.number(direction.sigma_mm, 4),
                            w.number(direction.stated_mm, 4), w.number(direction.warm_up_mm, 3),
                            d < s.level_mm.size() ? w.number(s.level_mm[d], 4) : "-"});
        }
        w.page.table(rows);
    }
    if (watch.compensate)
        w.page.verdict(w.t("compensated"), report::Tone::attention,
                       w.t("Switched on by a person ({}), at most {} mm: {}.", w.time_of(watch.switched_utc),
                           w.number(watch.most_mm, 3), said_of(s.acting)));
    for (const SetAside& range : watch.set_aside)
        w.page.paragraph(
            w.t("A step was acknowledged by {} on {}: {}", range.by, w.time_of(range.utc), range.text));
    return {};
}

Expected<void> events_chapter(HandOverWriter& w, const ProjectFile& file) {
    SEAM_TRY(auto events, file.events());
    w.page.heading(w.t("Event log"));
    const std::size_t shown = std::min(events.size(), w.options.newest_events);
    if (shown < events.size()) w.page.paragraph(w.t("The newest {} of {} events.", shown, events.size()));
    if (shown == 0) w.page.paragraph(w.t("No events."));
    Rows rows{{w.t("Time (UTC)"), w.t("Run"), w.t("Kind"), w.t("Subject"), w.t("Text")}};
    for (std::size_t i = events.size() - shown; i < events.size(); ++i) {
        const EventRecord& e = events[i];
        rows.push_back({w.time_of(e.utc), e.run ? fmt::format("{}", e.run) : "-",
                        std::string(to_string(e.kind)), e.subject, e.text.in(w.options.language)});
    }
    if (shown) w.page.table(rows);
    return {};
}

}  // namespace

Expected<report::Page> hand_over_report(const ProjectFile& file, const Project& project, const Facts& facts,
                                        const HandOverOptions& given) {
    HandOverOptions options = given;
    if (options.now_utc.empty()) options.now_utc = utc_now();
    Facts at = facts;
    at.now_utc = options.now_utc;
    const std::string title = Text("Hand-over report: {}", project.name).in(options.language);
    report::Page page(title, std::string(code_of(options.language)));
    HandOverWriter w{project, at, options, page};
    page.paragraph(w.t("File {}, {} UTC, {}.", file.path().filename().string(), w.time_of(options.now_utc),
                       options.program.empty() ? "Seamwright" : options.program));
    checklist_chapter(w, checklist(project, at));
    devices_chapter(w);
    calibrations_chapter(w);
    spots_chapter(w);
    regions_chapter(w);
    zero_shift_chapter(w);
    known_shift_chapter(w);
    limits_chapter(w);
    headless_chapter(w);
    SEAM_OK(acceptance_chapter(w, file));
    SEAM_OK(panels_chapter(w, file));
    SEAM_OK(drift_chapter(w, file));
    SEAM_OK(events_chapter(w, file));
    page.heading(w.t("Hand-over"));
    page.paragraph(w.t("The cell was handed over in the state that this report describes."));
    const std::string date = w.t("Place, date");
    page.signatures(
        {{date, w.t("Commissioning engineer"), w.t("Signature")}, {date, w.t("Customer"), w.t("Signature")}});
    return page;
}

}  // namespace seamwright
