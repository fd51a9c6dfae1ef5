#include "projects/file/project_json.h"

#include "devices/exchange/json_fields.h"
#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(ReferenceState, "measured", "from_drawing", "from_type");
SEAMWRIGHT_WORDS(RobotMode, "unknown", "manual_reduced", "manual_full", "automatic", "external", "stopped",
                 "fault");
SEAMWRIGHT_WORDS(Verdict, "good", "usable", "poor", "undetermined");

template <class A>
void describe(A& a, PartType& v) {
    a("id", v.id);
    a("name", v.name);
    a("number", v.number);
}
template <class A>
void describe(A& a, PartSetup& v) {
    a("name", v.name);
    a("mesh_source", v.mesh_source);
    a("base_from_workobject", v.base_from_workobject);
    // Absent where it says nothing, so that a setup of before is the same setup.
    if (A::reading || !v.workobject_covariance.isZero(0)) a("workobject_covariance", v.workobject_covariance);
}
template <class A>
void describe(A& a, SensorSetup& v) {
    a("id", v.id);
    a("driver", v.driver);
    a("settings", v.settings);
    a("identity", v.identity);
    a("peaks", v.peaks);
    a("filter", v.filter);
    a("calibration_id", v.calibration_id);
}
template <class A>
void describe(A& a, RobotSetup& v) {
    a("id", v.id);
    a("driver", v.driver);
    a("settings", v.settings);
    a("identity", v.identity);
    a("required_mode", v.required_mode);
    a("arrival_covariance", v.arrival_covariance);
    a("trigger_latency_ms", v.trigger_latency_ms);
    if (A::reading || v.speed_sigma != 0) a("speed_sigma", v.speed_sigma);
    if (A::reading || !v.collisions.empty()) a("collisions", v.collisions);
}
template <class A>
void describe(A& a, NozzleTip& v) {
    a("flange_from_nozzle", v.flange_from_nozzle);
    a("covariance_mm2", v.covariance_mm2);
    a("degrees", v.degrees);
    a("off_programmed_mm", v.off_programmed_mm);
}
template <class A>
void describe(A& a, Calibration& v) {
    a("id", v.id);
    a("method", v.method);
    a("sensor_id", v.sensor_id);
    a("robot_id", v.robot_id);
    a("sensor_identity", v.sensor_identity);
    a("robot_identity", v.robot_identity);
    a("created_utc", v.created_utc);
    a("source", v.source);
    a("model", v.model);
    a("flange_from_sensor", v.flange_from_sensor);
    a("covariance", v.covariance);
    if (A::reading || !v.scale_sigma.isZero(0)) a("scale_sigma", v.scale_sigma);
    if (A::reading || v.shear_sigma != 0) a("shear_sigma", v.shear_sigma);
    a("verdict", v.verdict);
    if (A::reading || v.nozzle) a("nozzle", v.nozzle);
    a("raw", v.raw);
    a("result", v.result);
}
template <class A>
void describe(A& a, DrawingOrigin& v) {
    a("name", v.name);
    a("bytes", v.bytes);
    a("crc32", v.crc32);
    a("edge", v.edge);
    a("arc_mm", v.arc_mm);
    a("reference_mm", v.reference_mm);
}
template <class A>
void describe(A& a, SeenLight& v) {
    a("settings", v.settings);
    a("bright", v.bright);
    a("saturated_share", v.saturated_share);
    a("width_px", v.width_px);
    a("exposures", v.exposures);
}
template <class A>
void describe(A& a, PaintLight& v) {
    a("paint", v.paint);
    a("settings", v.settings);
}
template <class A>
void describe(A& a, SpotLight& v) {
    a("settings", v.settings);
    a("merge_us", v.merge_us);
    a("shortest_us", v.shortest_us);
    a("longest_us", v.longest_us);
    a("paints", v.paints);
}
template <class A>
void describe(A& a, Spot& v) {
    a("id", v.id);
    // Absent where there is none, so that a setup of before is the same setup.
    if (A::reading || !v.type_id.empty()) a("type_id", v.type_id);
    a("sensor_id", v.sensor_id);
    a("robot_id", v.robot_id);
    a("enabled", v.enabled);
    a("required", v.required);
    a("base_from_flange", v.base_from_flange);
    a("entry_mm", v.entry_mm);
    a("exit_mm", v.exit_mm);
    a("speed_mm_s", v.speed_mm_s);
    a("stop_at_trigger", v.stop_at_trigger);
    if (A::reading || !v.via.empty()) a("via", v.via);
    a("feature", v.feature);
    a("reference_mm", v.reference_mm);
    if (A::reading || v.reference_arrivals != 1) a("reference_arrivals", v.reference_arrivals);
    // Absent where they say nothing, so that a setup of before is the same setup.
    if (A::reading || v.reference_state != ReferenceState::measured) a("reference_state", v.reference_state);
    if (A::reading || v.drawn) a("drawn", v.drawn);
    if (A::reading || v.reference_light) a("reference_light", v.reference_light);
    if (A::reading || !v.light.empty()) a("light", v.light);
    if (a.options().profiles) a("reference_profile", v.reference_profile);
    a("weights", v.weights);
    a("sigma_mm", v.sigma_mm);
    a("jitter_mm", v.jitter_mm);
    a("curve", v.curve);
}
template <class A>
void describe(A& a, KeptOffset& v) {
    a("version", v.version);
    a("utc", v.utc);
    a("source", v.source);
    a("offset_mm", v.offset_mm);
    a("covariance_mm2", v.covariance_mm2);
}
template <class A>
void describe(A& a, Region& v) {
    a("id", v.id);
    if (A::reading || !v.type_id.empty()) a("type_id", v.type_id);
    a("spot_ids", v.spot_ids);
    a("free", v.free);
    a("limits", v.limits);
    a("sigma_limit_mm", v.sigma_limit_mm);
    a("sigma_limit_deg", v.sigma_limit_deg);
    a("frame_name", v.frame_name);
    a("base_from_frame", v.base_from_frame);
    // Absent where there are none, so that a setup of before is the same setup.
    if (A::reading || !v.offsets.empty()) a("offsets", v.offsets);
    if (A::reading || !v.offset_switches.empty()) a("offset_switches", v.offset_switches);
    if constexpr (A::reading) {
        std::set<int> versions{0};
        for (const KeptOffset& offset : v.offsets)
            if (!versions.insert(offset.version).second) a.fail("two kept offsets have one version");
        for (const int version : v.offset_switches)
            if (!versions.count(version)) a.fail("a kept offset that is switched on is missing");
    }
}
template <class A>
void describe(A& a, AcceptanceRequirements& v) {
    a("tolerance_mm", v.tolerance_mm);
    a("nominal_mm", v.nominal_mm);
    a("cg_share", v.cg_share);
    a("cg_width", v.cg_width);
    a("cg", v.cg);
    a("cgk", v.cgk);
    a("grr_accepted_percent", v.grr_accepted_percent);
    a("grr_refused_percent", v.grr_refused_percent);
    a("ndc", v.ndc);
    a("system_percent", v.system_percent);
    a("process_percent", v.process_percent);
}
template <class A>
void describe(A& a, Requirements& v) {
    a("sigma3_mm", v.sigma3_mm);
    a("calibration_age_days", v.calibration_age_days);
    a("zero_shift_runs", v.zero_shift_runs);
    a("known_shift_mm", v.known_shift_mm);
    a("known_shift_deg", v.known_shift_deg);
    if (A::reading || v.acceptance != AcceptanceRequirements{}) a("acceptance", v.acceptance);
}
template <class A>
void describe(A& a, LineSetup& v) {
    a("id", v.id);
    a("protocol", v.protocol);
    a("enabled", v.enabled);
    a("settings", v.settings);
    a("part_types", v.part_types);
}
template <class A>
void describe(A& a, ElasticSpot& v) {
    a("id", v.id);
    a("workobject_from_sensor", v.workobject_from_sensor);
    a("reference_mm", v.reference_mm);
    a("weights", v.weights);
    a("seen", v.seen);
    a("noise_factor", v.noise_factor);
    a("common_mm", v.common_mm);
}
template <class A>
void describe(A& a, ElasticMode& v) {
    a("shape", v.shape);
    a("variance_mm2", v.variance_mm2);
    a("variance_low_mm2", v.variance_low_mm2);
    a("variance_high_mm2", v.variance_high_mm2);
    a("mean_mm", v.mean_mm);
    a("lowest_mm", v.lowest_mm);
    a("highest_mm", v.highest_mm);
}
template <class A>
void describe(A& a, ElasticModes& v) {
    a("spots", v.spots);
    a("modes", v.modes);
    a("noise_factor", v.noise_factor);
    a("rows", v.rows);
    a("parts", v.parts);
    a("gain", v.gain);
    a("gain_sigma", v.gain_sigma);
    a("message", v.message);
}
template <class A>
void describe(A& a, LearntRun& v) {
    a("run", v.run);
    a("part_id", v.part_id);
    a("utc", v.utc);
}
template <class A>
void describe(A& a, RegionModes& v) {
    a("id", v.id);
    a("on", v.on);
    a("learnt_utc", v.learnt_utc);
    a("switched_utc", v.switched_utc);
    a("most_added_mm", v.most_added_mm);
    a("modes", v.modes);
    a("learnt_from", v.learnt_from);
    if constexpr (A::reading) {
        if (!(v.most_added_mm > 0)) a.fail("the limit of what the modes may add is no positive number");
    }
}
template <class A>
void describe(A& a, FixtureElement& v) {
    a("id", v.id);
    a("at_mm", v.at_mm);
    a("directions", v.directions);
}
template <class A>
void describe(A& a, Fixture& v) {
    a("id", v.id);
    a("elements", v.elements);
    a("carrier_pattern", v.carrier_pattern);
}
template <class A>
void describe(A& a, FleetLink& v) {
    a("id", v.id);
    a("address", v.address);
    if (A::reading || !v.station.empty()) a("station", v.station);
    if constexpr (A::reading)
        if (has_password(v.address)) a.fail("the fleet's address holds a password");
}
template <class A>
void describe(A& a, Project& v) {
    a("name", v.name);
    a("requirements", v.requirements);
    a("part", v.part);
    if (A::reading || !v.part_types.empty()) a("part_types", v.part_types);
    a("sensors", v.sensors);
    a("robots", v.robots);
    a("calibrations", v.calibrations);
    a("spots", v.spots);
    a("regions", v.regions);
    a("panel_jobs", v.panel_jobs);
    if (A::reading || !v.line.empty()) a("line", v.line);
    if (A::reading || !v.elastic.empty()) a("elastic", v.elastic);
    if (A::reading || v.drift) a("drift", v.drift);
    if (A::reading || v.fixture) a("fixture", v.fixture);
    if (A::reading || v.fleet) a("fleet", v.fleet);
}

SEAMWRIGHT_DESCRIBED(SeenLight);

template <class T>
nlohmann::json to_json_document(const T& value, const ArchiveOptions& options) {
    return JsonWriter(options).document(value);
}

template <class T>
Expected<T> from_json_document(const nlohmann::json& document, const std::string& where,
                               const ArchiveOptions& options) {
    return JsonReader(options).document<T>(document, where);
}

#define SEAMWRIGHT_DOCUMENT(T)                                                 \
    template nlohmann::json to_json_document(const T&, const ArchiveOptions&); \
    template Expected<T> from_json_document(const nlohmann::json&, const std::string&, const ArchiveOptions&)
SEAMWRIGHT_DOCUMENT(Project);
SEAMWRIGHT_DOCUMENT(PartSetup);
SEAMWRIGHT_DOCUMENT(PartType);
SEAMWRIGHT_DOCUMENT(SensorSetup);
SEAMWRIGHT_DOCUMENT(RobotSetup);
SEAMWRIGHT_DOCUMENT(Calibration);
SEAMWRIGHT_DOCUMENT(Spot);
SEAMWRIGHT_DOCUMENT(Region);
SEAMWRIGHT_DOCUMENT(RegionModes);
SEAMWRIGHT_DOCUMENT(DriftWatch);
SEAMWRIGHT_DOCUMENT(Fixture);
SEAMWRIGHT_DOCUMENT(LineSetup);
SEAMWRIGHT_DOCUMENT(FleetLink);
SEAMWRIGHT_DOCUMENT(DriftPoint);
SEAMWRIGHT_DOCUMENT(PanelJob);
SEAMWRIGHT_DOCUMENT(PanelMeasurement);
SEAMWRIGHT_DOCUMENT(PanelRecord);
SEAMWRIGHT_DOCUMENT(SpotMeasurement);
SEAMWRIGHT_DOCUMENT(RegionRecord);
SEAMWRIGHT_DOCUMENT(Requirements);
SEAMWRIGHT_DOCUMENT(FrozenContour);
SEAMWRIGHT_DOCUMENT(ZeroShift);
SEAMWRIGHT_DOCUMENT(KnownShift);
SEAMWRIGHT_DOCUMENT(HeadlessRun);
SEAMWRIGHT_DOCUMENT(RobotReturns);
SEAMWRIGHT_DOCUMENT(TriggerPasses);
SEAMWRIGHT_DOCUMENT(StudyPlan);
#undef SEAMWRIGHT_DOCUMENT

Expected<std::string> dump_document(const nlohmann::json& document, const std::string& where) {
    try {
        return document.dump();
    } catch (const nlohmann::json::exception&) {
        return input_error("a text is not UTF-8", where, "use plain letters in names");
    }
}

std::string dump_messages(const nlohmann::json& document) {
    return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string utf8_text(const std::string& text) {
    return parse_json(dump_messages(text), {})->get<std::string>();
}

}  // namespace seamwright
