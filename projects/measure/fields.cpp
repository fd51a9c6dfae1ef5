#include "projects/measure/fields.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "core/panel/double_head.h"

namespace seamwright {
namespace {

template <class T>
Expected<void> set_in(const std::vector<Field<T>>& fields, T& thing, std::string_view name, double value,
                      const Text& where) {
    const auto field =
        std::find_if(fields.begin(), fields.end(), [&](const Field<T>& f) { return f.info.name == name; });
    assert(field != fields.end());
    const ParameterValues one{{field->info.name, value}};
    SEAM_OK(validate(one, {field->info}, where));
    field->set(thing, value);
    return {};
}

template <class T>
Expected<void> validate_in(const std::vector<Field<T>>& fields, const T& thing, const Text& where) {
    ParameterValues values;
    std::vector<ParameterInfo> infos;
    for (const Field<T>& f : fields) {
        values[f.info.name] = f.get(thing);
        infos.push_back(f.info);
    }
    return validate(values, infos, where);
}

}  // namespace

const std::vector<Field<Spot>>& spot_fields() {
    static const std::vector<Field<Spot>> fields = {
        {{"entry_mm", "mm", 0, 500, 20, 1, "Travel before the trigger, along the sensor's Y."},
         [](const Spot& s) { return s.entry_mm; },
         [](Spot& s, double v) { s.entry_mm = v; }},
        {{"exit_mm", "mm", 0, 500, 20, 1, "Travel after the trigger, along the sensor's Y."},
         [](const Spot& s) { return s.exit_mm; },
         [](Spot& s, double v) { s.exit_mm = v; }},
        {{"speed_mm_s", "mm/s", 1, 2000, 100, 0, "Speed of the pass."},
         [](const Spot& s) { return s.speed_mm_s; },
         [](Spot& s, double v) { s.speed_mm_s = v; }},
        {{"sigma_mm", "mm", 0.001, 10, 0.05, 3, "Standard deviation of a measured coordinate, with jitter."},
         [](const Spot& s) { return s.sigma_mm; },
         [](Spot& s, double v) { s.sigma_mm = v; }},
        {{"jitter_mm", "mm", 0.01, 100, 3, 2, "Half width of the trigger jitter along the travel."},
         [](const Spot& s) { return s.jitter_mm; },
         [](Spot& s, double v) { s.jitter_mm = v; }},
        {{"weight_x", "", 0, 100, 1, 2, "How much the sensor's X counts; 0 = not observed."},
         [](const Spot& s) { return s.weights.x(); },
         [](Spot& s, double v) { s.weights.x() = v; }},
        {{"weight_y", "", 0, 100, 0, 2, "How much the travel direction Y counts; a profile does not see it."},
         [](const Spot& s) { return s.weights.y(); },
         [](Spot& s, double v) { s.weights.y() = v; }},
        {{"weight_z", "", 0, 100, 1, 2, "How much the sensor's Z (height) counts; 0 = not observed."},
         [](const Spot& s) { return s.weights.z(); },
         [](Spot& s, double v) { s.weights.z() = v; }},
    };
    return fields;
}

const std::vector<Field<Region>>& region_fields() {
    static const std::vector<Field<Region>> fields = {
        {{"limit_translation_mm", "mm", 0.01, 1000, 25, 2, "Larger displacements are refused."},
         [](const Region& r) { return r.limits.translation_mm; },
         [](Region& r, double v) { r.limits.translation_mm = v; }},
        {{"limit_rotation_deg", "deg", 0.001, 45, 3, 3, "Larger turns are refused."},
         [](const Region& r) { return r.limits.rotation_deg; },
         [](Region& r, double v) { r.limits.rotation_deg = v; }},
        {{"sigma_limit_mm", "mm", 0.001, 10, 0.1, 3, "A correction less sure than this is not pushed."},
         [](const Region& r) { return r.sigma_limit_mm; },
         [](Region& r, double v) { r.sigma_limit_mm = v; }},
        {{"sigma_limit_deg", "deg", 0.0001, 10, 0.05, 4, "A turn less sure than this is not pushed."},
         [](const Region& r) { return r.sigma_limit_deg; },
         [](Region& r, double v) { r.sigma_limit_deg = v; }},
    };
    return fields;
}

const std::vector<Field<PanelJob>>& panel_fields() {
    static const std::vector<Field<PanelJob>> fields = {
        {{"limit_translation_mm", "mm", 0.01, 1000, 25, 2, "Larger motions of the gripper are refused."},
         [](const PanelJob& j) { return j.limits.translation_mm; },
         [](PanelJob& j, double v) { j.limits.translation_mm = v; }},
        {{"limit_rotation_deg", "deg", 0.001, 45, 3, 3, "Larger turns of the gripper are refused."},
         [](const PanelJob& j) { return j.limits.rotation_deg; },
         [](PanelJob& j, double v) { j.limits.rotation_deg = v; }},
        {{"sigma_limit_mm", "mm", 0.001, 10, 0.1, 3, "A motion less sure than this is refused."},
         [](const PanelJob& j) { return j.sigma_limit_mm; },
         [](PanelJob& j, double v) { j.sigma_limit_mm = v; }},
        {{"sigma_limit_deg", "deg", 0.0001, 10, 0.05, 4, "A turn less sure than this is refused."},
         [](const PanelJob& j) { return j.sigma_limit_deg; },
         [](PanelJob& j, double v) { j.sigma_limit_deg = v; }},
        {{"gap_tolerance_mm", "mm", 0.01, 20, 0.5, 2, "How far the gap may be off the taught one anywhere."},
         [](const PanelJob& j) { return j.gap_tolerance_mm; },
         [](PanelJob& j, double v) { j.gap_tolerance_mm = v; }},
        {{"flush_tolerance_mm", "mm", 0.01, 20, 0.5, 2,
          "How far the flush may be off the taught one anywhere."},
         [](const PanelJob& j) { return j.flush_tolerance_mm; },
         [](PanelJob& j, double v) { j.flush_tolerance_mm = v; }},
        // Farther apart than kSameSurfaceMm two heads do not see one surface (double_head.h).
        {{"head_limit_mm", "mm", 0.005, 0.99 * kSameSurfaceMm, 0.15, 3,
          "Largest disagreement of the two sensors of a double head."},
         [](const PanelJob& j) { return j.head_limit_mm; },
         [](PanelJob& j, double v) { j.head_limit_mm = v; }},
        {{"deviation",
          "",
          0,
          1,
          0,
          0,
          "A place that contradicts the others: share its deviation out (best fit), or leave it out.",
          {"share", "leave_out"}},
         [](const PanelJob& j) { return static_cast<double>(j.deviation); },
         [](PanelJob& j, double v) {
             j.deviation = v < 0.5 ? PanelDeviation::share : PanelDeviation::leave_out;
         }},
    };
    return fields;
}

namespace {
template <class E>
E choice(double v) {
    return static_cast<E>(std::lround(v));
}
int whole(double v) {
    return static_cast<int>(std::lround(v));
}
}  // namespace

const std::vector<Field<SensorSetup>>& sensor_fields() {
    using S = SensorSetup;
    static const std::vector<Field<S>> fields = {
        {{"scan", "", 0, 1, 0, 0, "Image lines that the stripe is cut along.", {"columns", "rows"}},
         [](const S& s) { return static_cast<double>(s.peaks.scan); },
         [](S& s, double v) { s.peaks.scan = choice<ScanLines>(v); }},
        {{"peak_method",
          "",
          0,
          2,
          0,
          0,
          "How the middle of the stripe is found; gaussian for overexposed stripes.",
          {"centre_of_gravity", "gaussian", "steger"}},
         [](const S& s) { return static_cast<double>(s.peaks.method); },
         [](S& s, double v) { s.peaks.method = choice<PeakMethod>(v); }},
        {{"per_line", "", 1, 64, 3, 0,
          "Peaks of a line that the stripe is chosen from: itself and reflections."},
         [](const S& s) { return static_cast<double>(s.peaks.per_line); },
         [](S& s, double v) { s.peaks.per_line = whole(v); }},
        {{"peak_threshold", "", 0, 65535, 0, 0,
          "Grey values above the background that a peak needs; 0: by itself."},
         [](const S& s) { return s.peaks.threshold; },
         [](S& s, double v) { s.peaks.threshold = v; }},
        {{"min_width_px", "px", 0, 1000, 1, 1, "Narrower peaks are none, full width at half height."},
         [](const S& s) { return s.peaks.min_width_px; },
         [](S& s, double v) { s.peaks.min_width_px = v; }},
        {{"max_width_px", "px", 0.1, 10000, 80, 1, "Wider peaks are none, full width at half height."},
         [](const S& s) { return s.peaks.max_width_px; },
         [](S& s, double v) { s.peaks.max_width_px = v; }},
        {{"steger_sigma_px", "px", 0.5, 20, 2, 1, "Smoothing of the line, method steger."},
         [](const S& s) { return s.peaks.steger_sigma_px; },
         [](S& s, double v) { s.peaks.steger_sigma_px = v; }},
        {{"noise_mm", "mm", 0, 10, 0, 4, "Standard deviation of a point; 0: estimated from each profile."},
         [](const S& s) { return s.filter.noise_mm; },
         [](S& s, double v) { s.filter.noise_mm = v; }},
        {{"band_sigmas", "", 1, 20, 4, 1, "Acceptance band in predicted standard deviations."},
         [](const S& s) { return s.filter.band_sigmas; },
         [](S& s, double v) { s.filter.band_sigmas = v; }},
        {{"lookahead", "", 1, 50, 3, 0, "Longest burst of outliers, points."},
         [](const S& s) { return static_cast<double>(s.filter.lookahead); },
         [](S& s, double v) { s.filter.lookahead = whole(v); }},
        {{"average", "", 0.001, 1, 0.15, 3,
          "Weight of the newest point in the averages of drift and variance."},
         [](const S& s) { return s.filter.average; },
         [](S& s, double v) { s.filter.average = v; }},
        {{"initial_sigma", "", 0.001, 2, 0.15, 3, "Sigma of the spacing's logarithm where a segment begins."},
         [](const S& s) { return s.filter.initial_sigma; },
         [](S& s, double v) { s.filter.initial_sigma = v; }},
        {{"min_segment_points", "", 1, 10000, 4, 0, "Shorter pieces are outliers, points."},
         [](const S& s) { return static_cast<double>(s.filter.min_segment_points); },
         [](S& s, double v) { s.filter.min_segment_points = whole(v); }},
        {{"as_delivered",
          "",
          0,
          1,
          0,
          0,
          "Finished profiles count as the sensor delivers them, without outliers and segments.",
          {"no", "yes"}},
         [](const S& s) { return s.filter.as_delivered ? 1.0 : 0.0; },
         [](S& s, double v) { s.filter.as_delivered = v >= 0.5; }},
    };
    return fields;
}

const std::vector<Field<Requirements>>& requirement_fields() {
    static const std::vector<Field<Requirements>> fields = {
        {{"sigma3_mm", "mm", 0.001, 10, 0.3, 3,
          "3 sigma of a point of the corrected path, predicted and proven, at most."},
         [](const Requirements& r) { return r.sigma3_mm; },
         [](Requirements& r, double v) { r.sigma3_mm = v; }},
        {{"calibration_age_days", "days", 1, 3650, 365, 0, "An older calibration in use is stale."},
         [](const Requirements& r) { return r.calibration_age_days; },
         [](Requirements& r, double v) { r.calibration_age_days = v; }},
        {{"zero_shift_runs", "", 2, 1000, 3, 0, "Measurements of the unmoved part, at least."},
         [](const Requirements& r) { return r.zero_shift_runs; },
         [](Requirements& r, double v) { r.zero_shift_runs = v; }},
        {{"known_shift_mm", "mm", 0.1, 100, 10, 1, "Known translations must be recovered up to here."},
         [](const Requirements& r) { return r.known_shift_mm; },
         [](Requirements& r, double v) { r.known_shift_mm = v; }},
        {{"known_shift_deg", "deg", 0.01, 10, 1, 2, "Known rotations must be recovered up to here."},
         [](const Requirements& r) { return r.known_shift_deg; },
         [](Requirements& r, double v) { r.known_shift_deg = v; }},
    };
    return fields;
}

const std::vector<Field<AcceptanceRequirements>>& acceptance_fields() {
    using A = AcceptanceRequirements;
    static const std::vector<Field<A>> fields = {
        {{"tolerance_mm", "mm", 0, 1000, 0, 3, "T = USL - LSL of the bead across its path; 0: not stated."},
         [](const A& r) { return r.tolerance_mm; },
         [](A& r, double v) { r.tolerance_mm = v; }},
        {{"nominal_mm", "mm", -1000, 1000, 0, 3, "Middle of the tolerance."},
         [](const A& r) { return r.nominal_mm; },
         [](A& r, double v) { r.nominal_mm = v; }},
        {{"cg_share", "", 0.01, 1, 0.2, 2, "Share of the tolerance in Cg and Cgk."},
         [](const A& r) { return r.cg_share; },
         [](A& r, double v) { r.cg_share = v; }},
        {{"cg_width", "", 1, 12, 6, 0, "Standard deviations in Cg."},
         [](const A& r) { return r.cg_width; },
         [](A& r, double v) { r.cg_width = v; }},
        {{"cg", "", 0.1, 10, 1.33, 2, "Cg, at least."},
         [](const A& r) { return r.cg; },
         [](A& r, double v) { r.cg = v; }},
        {{"cgk", "", 0.1, 10, 1.33, 2, "Cgk, at least."},
         [](const A& r) { return r.cgk; },
         [](A& r, double v) { r.cgk = v; }},
        {{"grr_accepted_percent", "%", 0.1, 100, 10, 1, "%GRR that is accepted, of the tolerance."},
         [](const A& r) { return r.grr_accepted_percent; },
         [](A& r, double v) { r.grr_accepted_percent = v; }},
        {{"grr_refused_percent", "%", 0.1, 100, 30, 1, "%GRR beyond which it is refused."},
         [](const A& r) { return r.grr_refused_percent; },
         [](A& r, double v) { r.grr_refused_percent = v; }},
        {{"ndc", "", 1, 100, 5, 0, "Number of distinct categories, at least."},
         [](const A& r) { return r.ndc; },
         [](A& r, double v) { r.ndc = v; }},
        {{"system_percent", "%", 1, 100, 15, 0, "Q of the measuring system (VDA 5), at most."},
         [](const A& r) { return r.system_percent; },
         [](A& r, double v) { r.system_percent = v; }},
        {{"process_percent", "%", 1, 100, 30, 0, "Q of the measuring process (VDA 5), at most."},
         [](const A& r) { return r.process_percent; },
         [](A& r, double v) { r.process_percent = v; }},
    };
    return fields;
}

Expected<void> set_field(Spot& spot, std::string_view name, double value) {
    return set_in(spot_fields(), spot, name, value, Text("spot {}", spot.id));
}
Expected<void> set_field(Region& region, std::string_view name, double value) {
    return set_in(region_fields(), region, name, value, Text("region {}", region.id));
}

Expected<void> set_field(PanelJob& job, std::string_view name, double value) {
    return set_in(panel_fields(), job, name, value, Text("panel job {}", job.id));
}

Expected<void> set_field(SensorSetup& sensor, std::string_view name, double value) {
    return set_in(sensor_fields(), sensor, name, value, Text("sensor {}", sensor.id));
}

Expected<void> set_field(Requirements& requirements, std::string_view name, double value) {
    return set_in(requirement_fields(), requirements, name, value, "requirements");
}

Expected<void> validate_fields(const Spot& spot) {
    const Text where("spot {}", spot.id);
    SEAM_OK(validate_in(spot_fields(), spot, where));
    const FeatureKind* kind = feature_kind(spot.feature.kind);
    if (!kind) return input_error(Text("the feature kind \"{}\" is not known", spot.feature.kind), where);
    return validate(spot.feature.parameters, kind->parameters, where);
}
Expected<void> validate_fields(const Region& region) {
    return validate_in(region_fields(), region, Text("region {}", region.id));
}

Expected<void> validate_fields(const PanelJob& job) {
    return validate_in(panel_fields(), job, Text("panel job {}", job.id));
}

Expected<void> validate_fields(const SensorSetup& sensor) {
    const Text where("sensor {}", sensor.id);
    SEAM_OK(validate_in(sensor_fields(), sensor, where));
    if (sensor.peaks.min_width_px > sensor.peaks.max_width_px)
        return input_error(Text("peaks of {} px at least and {} px at most", sensor.peaks.min_width_px,
                                sensor.peaks.max_width_px),
                           where, "give a min_width_px below max_width_px");
    // A burst of outliers would be a segment (filter.h).
    if (sensor.filter.min_segment_points <= sensor.filter.lookahead)
        return input_error(Text("segments of {} points and bursts of {} outliers",
                                sensor.filter.min_segment_points, sensor.filter.lookahead),
                           where, "give a min_segment_points above lookahead");
    return {};
}

Expected<void> validate_fields(const Requirements& requirements) {
    SEAM_OK(validate_in(requirement_fields(), requirements, "requirements"));
    return validate_fields(requirements.acceptance);
}

Expected<void> validate_fields(const AcceptanceRequirements& requirements) {
    const Text where("requirements of the acceptance");
    SEAM_OK(validate_in(acceptance_fields(), requirements, where));
    if (requirements.grr_accepted_percent > requirements.grr_refused_percent)
        return input_error(Text("%GRR of {} is accepted and of {} refused", requirements.grr_accepted_percent,
                                requirements.grr_refused_percent),
                           where, "accept less than what is refused");
    return {};
}

}  // namespace seamwright
