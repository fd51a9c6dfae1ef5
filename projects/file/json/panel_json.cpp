// Panel jobs, and what a run of one leaves behind.

#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(GapFlushSettings::Reference, "left", "right");
SEAMWRIGHT_WORDS(GapBy, "along_surface", "edge_distance");
SEAMWRIGHT_WORDS(PanelDeviation, "share", "leave_out");
SEAMWRIGHT_WORDS(PanelVerdict, "not_verified", "in_tolerance", "out_of_tolerance");
SEAMWRIGHT_WORDS(ServoingStatus, "reached", "settled", "diverged", "not_converged", "ill_conditioned");

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

SEAMWRIGHT_DESCRIBED(PanelJob);
SEAMWRIGHT_DESCRIBED(PanelMeasurement);
SEAMWRIGHT_DESCRIBED(PanelRecord);

}  // namespace seamwright
