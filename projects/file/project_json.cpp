#include "projects/file/project_json.h"

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {

// The words on disk. Their order is that of the enum's values and must never change.
#define SEAMWRIGHT_WORDS(E, ...)                                                 \
    template <>                                                                  \
    struct EnumWords<E> {                                                        \
        static constexpr auto words = std::to_array<const char*>({__VA_ARGS__}); \
    }
SEAMWRIGHT_WORDS(ScanLines, "columns", "rows");
SEAMWRIGHT_WORDS(PeakMethod, "centre_of_gravity", "gaussian", "steger");
SEAMWRIGHT_WORDS(DriftVerdict, "learning", "fine", "watch", "recalibrate", "step");
SEAMWRIGHT_WORDS(DriftOf, "sensor", "robot");
SEAMWRIGHT_WORDS(ReferenceState, "measured", "from_drawing", "from_type");
SEAMWRIGHT_WORDS(RobotMode, "unknown", "manual_reduced", "manual_full", "automatic", "external", "stopped",
                 "fault");
SEAMWRIGHT_WORDS(FeatureStatus, "ok", "no_points", "not_found", "ambiguous", "ill_conditioned");
SEAMWRIGHT_WORDS(CorrectionStatus, "ok", "under_determined", "over_limit", "not_converged");
SEAMWRIGHT_WORDS(SpotStatus, "measured", "not_measured", "damaged_frame", "no_stripe", "no_calibration",
                 "no_feature");
SEAMWRIGHT_WORDS(PushStatus, "not_pushed", "written", "failed", "restored", "not_restored");
SEAMWRIGHT_WORDS(Release, "none", "given", "taken", "not_taken", "withdrawn");
SEAMWRIGHT_WORDS(AlignmentStatus, "frozen", "drifting", "shape_changes", "not_enough_profiles",
                 "undetermined");
SEAMWRIGHT_WORDS(ShiftBy, "simulated_part", "robot_moves", "by_hand");
SEAMWRIGHT_WORDS(GapFlushSettings::Reference, "left", "right");
SEAMWRIGHT_WORDS(GapBy, "along_surface", "edge_distance");
SEAMWRIGHT_WORDS(PanelDeviation, "share", "leave_out");
SEAMWRIGHT_WORDS(PanelVerdict, "not_verified", "in_tolerance", "out_of_tolerance");
SEAMWRIGHT_WORDS(Verdict, "good", "usable", "poor", "undetermined");
SEAMWRIGHT_WORDS(ShiftKind, "translation", "rotation", "both");
SEAMWRIGHT_WORDS(ServoingStatus, "reached", "settled", "diverged", "not_converged", "ill_conditioned");
#undef SEAMWRIGHT_WORDS

namespace {

template <class A>
void profile_fields(A& a, Profile& p) {
    a("x_mm", p.x_mm);
    a("z_mm", p.z_mm);
    a("intensity", p.intensity);
    a("segment", p.segment);
}

}  // namespace

nlohmann::json JsonWriter::encode(const Pose& pose) {
    if (pose.matrix().allFinite()) return pose_json(pose);
    JsonWriter writer(ArchiveOptions{});
    return {{"matrix", writer.encode(Eigen::Matrix4d(pose.matrix()))}};
}

void JsonReader::decode(const nlohmann::json& json, Pose& pose) {
    if (!json.is_object()) return expected("a pose", json);
    const auto field = json.find("matrix");
    if (options_.rigid_poses || field == json.end()) {
        auto parsed = parse_pose(json, path_);
        if (!parsed) {
            if (!error_) error_ = parsed.error();
            return;
        }
        pose = *parsed;
        if (field == json.end()) return;
    }
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    if (field->is_array() && field->size() == 4 && field->front().is_array()) {
        for (std::size_t r = 0; r < 4 && !error_; ++r) {
            Eigen::Vector4d row = Eigen::Vector4d::Zero();
            decode((*field)[r], row);
            m.row(static_cast<int>(r)) = row;
        }
    } else {
        decode(*field, m);
    }
    if (error_) return;
    if (options_.rigid_poses) {
        // The stored bits are kept when they are a rotation to rounding; a hand-written one is made
        // orthonormal.
        if ((pose.matrix() - m).cwiseAbs().maxCoeff() > 1e-9) m = pose.matrix();
    } else if (const auto xyz = json.find("xyz"); xyz != json.end()) {
        // A result need not be rigid, so that its angles may say nothing; what stands beside it was written
        // with it all the same.
        Eigen::Vector3d beside = Eigen::Vector3d::Zero();
        decode(*xyz, beside);
        if (!error_ && !(beside - m.topRightCorner<3, 1>()).isZero(0)) fail("xyz contradicts the matrix");
    }
    pose.matrix() = m;
    pose.makeAffine();
}

// --- devices and core

template <class A>
void describe(A& a, SensorIdentity& v) {
    a("driver", v.driver);
    a("vendor", v.vendor);
    a("model", v.model);
    a("serial", v.serial);
}
template <class A>
void describe(A& a, RobotIdentity& v) {
    a("driver", v.driver);
    a("brand", v.brand);
    a("model", v.model);
    a("serial", v.serial);
}
template <class A>
void describe(A& a, PeakOptions& v) {
    a("scan", v.scan);
    a("method", v.method);
    a("per_line", v.per_line);
    a("threshold", v.threshold);
    a("min_width_px", v.min_width_px);
    a("max_width_px", v.max_width_px);
    a("steger_sigma_px", v.steger_sigma_px);
}
template <class A>
void describe(A& a, FilterOptions& v) {
    a("noise_mm", v.noise_mm);
    a("band_sigmas", v.band_sigmas);
    a("lookahead", v.lookahead);
    a("average", v.average);
    a("initial_sigma", v.initial_sigma);
    a("min_segment_points", v.min_segment_points);
    if (A::reading || v.as_delivered) a("as_delivered", v.as_delivered);
}
template <class A>
void describe(A& a, CameraModel& v) {
    a("fx", v.fx);
    a("fy", v.fy);
    a("cx", v.cx);
    a("cy", v.cy);
    a("k1", v.k1);
    a("k2", v.k2);
    a("p1", v.p1);
    a("p2", v.p2);
    a("k3", v.k3);
    a("width", v.width);
    a("height", v.height);
}
template <class A>
void describe(A& a, LookupTable& v) {
    a("u0", v.u0);
    a("v0", v.v0);
    a("step_u", v.step_u);
    a("step_v", v.step_v);
    a("columns", v.columns);
    a("rows", v.rows);
    a("x_mm", v.x_mm);
    a("z_mm", v.z_mm);
    if constexpr (A::reading) {
        const bool sizes =
            v.columns >= 0 && v.rows >= 0 && v.x_mm.size() == v.z_mm.size() &&
            v.x_mm.size() == static_cast<std::size_t>(v.columns) * static_cast<std::size_t>(v.rows);
        if (!sizes) a.fail("the table does not hold rows * columns entries");
    }
}
template <class A>
void describe(A& a, SensorModel& v) {
    a("camera", v.camera);
    a("camera_from_laser", v.camera_from_laser);
    a("table", v.table);
}
template <class A>
void describe(A& a, Profile& v) {
    profile_fields(a, v);
    if constexpr (A::reading) {
        const std::size_t n = v.x_mm.size();
        if (v.z_mm.size() != n || (!v.intensity.empty() && v.intensity.size() != n) ||
            (!v.segment.empty() && v.segment.size() != n))
            a.fail("the columns of the profile differ in length");
    }
}
template <class A>
void describe(A& a, FeatureRecipe& v) {
    a("kind", v.kind);
    a("parameters", v.parameters);
    a("template_reference_mm", v.template_reference_mm);
    if (a.options().profiles) a("template_profile", v.template_profile);
}
template <class A>
void describe(A& a, ContourCurve& v) {
    a("x_coefficients", v.x_coefficients);
    a("z_coefficients", v.z_coefficients);
    a("valid_from_mm", v.valid_from_mm);
    a("valid_to_mm", v.valid_to_mm);
}
template <class A>
void describe(A& a, CorrectionLimits& v) {
    a("translation_mm", v.translation_mm);
    a("rotation_deg", v.rotation_deg);
}
template <class A>
void describe(A& a, Feature& v) {
    a("status", v.status);
    a("point_mm", v.point_mm);
    a("covariance_mm2", v.covariance_mm2);
    a("phi_rad", v.phi_rad);
    a("rms_mm", v.rms_mm);
    a("points_used", v.points_used);
    a("message", v.message);
    a("rivals_mm", v.rivals_mm);
}
template <class A>
void describe(A& a, SpotResidual& v) {
    a("id", v.id);
    a("residual_mm", v.residual_mm);
    a("used", v.used);
}
template <class A>
void describe(A& a, DofSigma& v) {
    a("xyz_mm", v.xyz_mm);
    a("abc_deg", v.abc_deg);
}
template <class A>
void describe(A& a, RegionCorrection& v) {
    a("status", v.status);
    a("workobject_from_movedworkobject", v.displacement.workobject_from_movedworkobject);
    a("covariance", v.covariance);
    a("covariance_systematic", v.covariance_systematic);
    a("sigma_xyz_mm", v.sigma_xyz_mm);
    a("sigma_abc_deg", v.sigma_abc_deg);
    a("sigma_systematic", v.sigma_systematic);
    if constexpr (A::reading) {
        // A file from before the two parts were told apart knew the random one alone.
        std::optional<Matrix6> random;
        std::optional<DofSigma> sigma;
        a("covariance_random", random);
        a("sigma_random", sigma);
        v.covariance_random = random.value_or(v.covariance);
        v.sigma_random = sigma.value_or(DofSigma{v.sigma_xyz_mm, v.sigma_abc_deg});
    } else {
        a("covariance_random", v.covariance_random);
        a("sigma_random", v.sigma_random);
    }
    a("sigma_at_spots_mm", v.sigma_at_spots_mm);
    a("rms_mm", v.rms_mm);
    a("redundancy", v.redundancy);
    a("variance_factor", v.variance_factor);
    a("consistent", v.consistent);
    a("spots", v.spots);
    a("unobservable", v.unobservable);
    a("message", v.message);
    a("iterations", v.iterations);
}

// --- the project

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
void describe(A& a, FeatureWindow& v) {
    a("x_min_mm", v.x_min);
    a("x_max_mm", v.x_max);
    a("z_min_mm", v.z_min);
    a("z_max_mm", v.z_max);
}
template <class A>
void describe(A& a, GapFlushSettings& v) {
    a("reference", v.reference);
    a("gap_by", v.gap_by);
    a("window", v.window);
    a("surface_mm", v.surface_mm);
    a("edge_skip_mm", v.edge_skip_mm);
    a("minimum_points", v.minimum_points);
}
template <class A>
void describe(A& a, PanelPlace& v) {
    a("id", v.id);
    a("sensor_id", v.sensor_id);
    a("second_sensor_id", v.second_sensor_id);
    a("enabled", v.enabled);
    a("required", v.required);
    a("gauge", v.gauge);
    a("panel_reference_mm", v.panel_reference_mm);
    a("body_reference_mm", v.body_reference_mm);
    a("gap_mm", v.gap_mm);
    a("flush_mm", v.flush_mm);
    a("surface_deg", v.surface_deg);
    if (a.options().profiles) a("reference_profile", v.reference_profile);
    a("weights", v.weights);
    a("sigma_mm", v.sigma_mm);
}
template <class A>
void describe(A& a, PanelSensitivity& v) {
    a("places", v.places);
    a("rows", v.rows);
    a("step_mm", v.step_mm);
    a("step_deg", v.step_deg);
    a("condition", v.condition);
    a("utc", v.utc);
}
template <class A>
void describe(A& a, PanelJob& v) {
    a("id", v.id);
    a("robot_id", v.robot_id);
    a("places", v.places);
    a("base_from_gripper", v.base_from_gripper);
    a("limits", v.limits);
    a("sigma_limit_mm", v.sigma_limit_mm);
    a("sigma_limit_deg", v.sigma_limit_deg);
    a("gap_tolerance_mm", v.gap_tolerance_mm);
    a("flush_tolerance_mm", v.flush_tolerance_mm);
    a("head_limit_mm", v.head_limit_mm);
    a("deviation", v.deviation);
    a("frame_name", v.frame_name);
    a("base_from_frame", v.base_from_frame);
    // Only where it was learnt: a program that knows none of it reads the others.
    if (A::reading || v.sensitivity) a("sensitivity", v.sensitivity);
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
void describe(A& a, LearntDirection& v) {
    a("spot_id", v.spot_id);
    a("axis", v.axis);
    a("mean_mm", v.mean_mm);
    a("sigma_mm", v.sigma_mm);
    a("stated_mm", v.stated_mm);
    a("warm_up_mm", v.warm_up_mm);
}
template <class A>
void describe(A& a, LearntDrift& v) {
    a("utc", v.utc);
    a("first_point", v.first_point);
    a("last_point", v.last_point);
    a("points", v.points);
    a("degrees", v.degrees);
    a("time_constant_s", v.time_constant_s);
    a("mark", v.mark);
    a("directions", v.directions);
}
template <class A>
void describe(A& a, SetAside& v) {
    a("first_point", v.first_point);
    a("last_point", v.last_point);
    a("utc", v.utc);
    a("by", v.by);
    a("text", v.text);
}
template <class A>
void describe(A& a, DriftWatch& v) {
    a("id", v.id);
    a("spot_ids", v.spot_ids);
    a("every_parts", v.every_parts);
    a("every_minutes", v.every_minutes);
    a("limit_mm", v.limit_mm);
    a("pause_minutes", v.pause_minutes);
    a("compensate", v.compensate);
    a("drifts", v.drifts);
    a("most_mm", v.most_mm);
    a("switched_utc", v.switched_utc);
    a("learnt", v.learnt);
    a("set_aside", v.set_aside);
    if constexpr (A::reading) {
        if (!(v.limit_mm > 0) || !(v.most_mm > 0) || !(v.pause_minutes > 0) || !(v.every_minutes >= 0) ||
            v.every_parts < 0)
            a.fail("a limit or interval of the drift watch is no positive number");
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
void describe(A& a, DriftPoint& v) {
    a("id", v.id);
    a("run", v.run);
    a("utc", v.utc);
    a("mark", v.mark);
    a("running_s", v.running_s);
    a("pause_s", v.pause_s);
    a("values_mm", v.values_mm);
    a("sigma_mm", v.sigma_mm);
    a("verdict", v.verdict);
    a("step", v.step);
    a("changed", v.changed);
    a("text", v.text);
}
template <class A>
void describe(A& a, ActingDrift& v) {
    a("verdict", v.verdict);
    a("text", v.text);
    a("compensated", v.compensated);
    a("why", v.why);
    a("drifts", v.drifts);
    a("device_id", v.device_id);
    a("shift_mm", v.shift_mm);
    a("sigma_mm", v.sigma_mm);
    if (A::reading || v.standing_mm != 0) a("standing_mm", v.standing_mm);
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

// --- runs

template <class A>
void describe(A& a, SpotMeasurement& v) {
    a("spot_id", v.spot_id);
    a("status", v.status);
    a("message", v.message);
    a("feature", v.feature);
    a("measured_mm", v.measured_mm);
    a("sigma_mm", v.sigma_mm);
    a("pose_reported", v.pose_reported);
    a("part_id", v.part_id);
    a("host_time_ns", v.host_time_ns);
    a("capture", v.capture);
    if (A::reading || v.light) a("light", v.light);
}
template <class A>
void describe(A& a, PushRecord& v) {
    a("status", v.status);
    a("frame_name", v.frame_name);
    a("robot_id", v.robot_id);
    a("release", v.release);
    a("before", v.before);
    a("read_back", v.read_back);
    a("message", v.message);
}
template <class A>
void describe(A& a, ActingOffset& v) {
    a("version", v.version);
    a("offset_mm", v.offset_mm);
}
template <class A>
void describe(A& a, ActingModes& v) {
    a("acted", v.acted);
    a("why", v.why);
    a("amplitudes_mm", v.amplitudes_mm);
    a("sigma_mm", v.sigma_mm);
    a("largest_added_mm", v.largest_added_mm);
    a("probability", v.probability);
    a("covariance", v.covariance);
}
template <class A>
void describe(A& a, RegionRecord& v) {
    a("region_id", v.region_id);
    a("correction", v.correction);
    a("base_from_frame", v.base_from_frame);
    a("gate_passed", v.gate_passed);
    a("refusals", v.refusals);
    a("push", v.push);
    if (A::reading || v.offset) a("offset", v.offset);
    if (A::reading || v.modes) a("modes", v.modes);
    if (A::reading || v.drift) a("drift", v.drift);
}

template <class A>
void describe(A& a, PanelMeasurement& v) {
    a("place_id", v.place_id);
    a("status", v.status);
    a("message", v.message);
    a("panel_mm", v.panel_mm);
    a("body_mm", v.body_mm);
    a("sigma_mm", v.sigma_mm);
    a("gap_mm", v.gap_mm);
    a("flush_mm", v.flush_mm);
    a("gap_flush_covariance", v.gap_flush_covariance);
    a("head_disagreement_mm", v.head_disagreement_mm);
    a("head_offset_mm", v.head_offset_mm);
    a("head_overlap_mm", v.head_overlap_mm);
    a("part_id", v.part_id);
    a("host_time_ns", v.host_time_ns);
    a("capture", v.capture);
    a("second_capture", v.second_capture);
}
template <class A>
void describe(A& a, GapFlushValue& v) {
    a("gap_mm", v.gap_mm);
    a("flush_mm", v.flush_mm);
}
template <class A>
void describe(A& a, PanelSpotResult& v) {
    a("id", v.id);
    a("taught", v.taught);
    a("before", v.before);
    a("remaining", v.remaining);
    a("residual_mm", v.residual_mm);
    a("panel_used", v.panel_used);
    a("body_used", v.body_used);
}
template <class A>
void describe(A& a, PanelFit& v) {
    a("status", v.status);
    a("gripper_motion", v.gripper_motion);
    a("single_step", v.single_step);
    a("covariance", v.covariance);
    a("sigma_xyz_mm", v.sigma_xyz_mm);
    a("sigma_abc_deg", v.sigma_abc_deg);
    a("sigma_at_spots_mm", v.sigma_at_spots_mm);
    a("rms_mm", v.rms_mm);
    a("panel", v.panel);
    a("body", v.body);
    a("spots", v.spots);
    a("unobservable", v.unobservable);
    a("message", v.message);
}
template <class A>
void describe(A& a, PanelServoMove& v) {
    a("motion", v.motion);
    a("rms_mm", v.rms_mm);
}
template <class A>
void describe(A& a, PanelServo& v) {
    a("status", v.status);
    a("moves", v.moves);
    a("motion", v.motion);
}
template <class A>
void describe(A& a, PanelRecord& v) {
    a("job_id", v.job_id);
    a("before", v.before);
    a("after", v.after);
    a("fit", v.fit);
    a("base_from_gripper", v.base_from_gripper);
    a("base_from_moved_gripper", v.base_from_moved_gripper);
    a("base_from_frame", v.base_from_frame);
    a("gate_passed", v.gate_passed);
    a("refusals", v.refusals);
    a("push", v.push);
    a("verdict", v.verdict);
    if (A::reading || v.servo) a("servo", v.servo);
}

// --- evidence

template <class A>
void describe(A& a, TravelOffset& v) {
    a("travel_mm", v.travel_mm);
    a("dx_mm", v.dx_mm);
    a("dz_mm", v.dz_mm);
    a("dphi_deg", v.dphi_deg);
    a("rms_mm", v.rms_mm);
    a("ok", v.ok);
}
template <class A>
void describe(A& a, FrozenContour& v) {
    a("spot_id", v.spot_id);
    a("status", v.status);
    a("yaw_deg", v.yaw_deg);
    a("pitch_deg", v.pitch_deg);
    a("radius_mm", v.radius_mm);
    a("expected_error_mm", v.expected_error_mm);
    a("tolerance_mm", v.tolerance_mm);
    a("jitter_mm", v.jitter_mm);
    a("offsets", v.offsets);
}
template <class A>
void describe(A& a, ZeroShiftRegion& v) {
    a("region_id", v.region_id);
    a("mean", v.mean);
    a("three_sigma", v.three_sigma);
    a("stated_three_sigma", v.stated_three_sigma);
    a("worst_mean_mm", v.worst_mean_mm);
}
template <class A>
void describe(A& a, ZeroShift& v) {
    a("runs", v.runs);
    a("refused", v.refused);
    a("regions", v.regions);
}
template <class A>
void describe(A& a, ShiftOutcome& v) {
    a("region_id", v.region_id);
    a("ok", v.ok);
    a("mean_abs_mm", v.mean_abs_mm);
    a("deviations_mm", v.deviations_mm);
    a("message", v.message);
}
template <class A>
void describe(A& a, ShiftTest& v) {
    a("kind", v.kind);
    a("axis", v.axis);
    a("amount", v.amount);
    a("workobject_from_movedworkobject", v.workobject_from_movedworkobject);
    a("run", v.run);
    a("regions", v.regions);
}
template <class A>
void describe(A& a, KnownShift& v) {
    a("realised_by", v.realised_by);
    a("range_mm", v.range_mm);
    a("range_deg", v.range_deg);
    a("tests", v.tests);
}
template <class A>
void describe(A& a, HeadlessRun& v) {
    a("run", v.run);
    a("part_id", v.part_id);
    a("push", v.push);
    a("host", v.host);
}

template <class A>
void describe(A& a, SpotReturns& v) {
    a("spot_id", v.spot_id);
    a("sees", v.sees);
    a("x", v.x);
    a("z", v.z);
    a("stated_mm", v.stated_mm);
    a("returns", v.returns);
}
template <class A>
void describe(A& a, RobotReturns& v) {
    a("robot_id", v.robot_id);
    a("spots", v.spots);
    a("not_found", v.not_found);
    a("replaced_covariance", v.replaced_covariance);
}
template <class A>
void describe(A& a, TriggerPass& v) {
    a("velocity_mm_s", v.velocity_mm_s);
    a("backward", v.backward);
    a("travel_mm", v.travel_mm);
}
template <class A>
void describe(A& a, TriggerPasses& v) {
    a("spot_id", v.spot_id);
    a("travel_deg", v.travel_deg);
    a("slope", v.slope);
    a("slope_sigma", v.slope_sigma);
    a("passes", v.passes);
    a("not_found", v.not_found);
    a("replaced_latency_ms", v.replaced_latency_ms);
    a("replaced_jitter_mm", v.replaced_jitter_mm);
}

template <class A>
void describe(A& a, StudyPlan& v) {
    a("study", v.study);
    a("region_id", v.region_id);
    a("parts", v.parts);
    a("rehangs", v.rehangs);
    a("runs", v.runs);
    a("after_run", v.after_run);
}

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

std::optional<CorrectionStatus> correction_status_named(const std::string& word) {
    const auto& words = EnumWords<CorrectionStatus>::words;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (word == words[i]) return static_cast<CorrectionStatus>(i);
    return std::nullopt;
}

}  // namespace seamwright
