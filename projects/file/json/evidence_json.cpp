// What was proven, and the data that settings were measured from.

#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(AlignmentStatus, "frozen", "drifting", "shape_changes", "not_enough_profiles",
                 "undetermined");
SEAMWRIGHT_WORDS(ShiftBy, "simulated_part", "robot_moves", "by_hand");
SEAMWRIGHT_WORDS(ShiftKind, "translation", "rotation", "both");

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

SEAMWRIGHT_DESCRIBED(FrozenContour);
SEAMWRIGHT_DESCRIBED(ZeroShift);
SEAMWRIGHT_DESCRIBED(KnownShift);
SEAMWRIGHT_DESCRIBED(HeadlessRun);
SEAMWRIGHT_DESCRIBED(RobotReturns);
SEAMWRIGHT_DESCRIBED(TriggerPasses);
SEAMWRIGHT_DESCRIBED(StudyPlan);

}  // namespace seamwright
