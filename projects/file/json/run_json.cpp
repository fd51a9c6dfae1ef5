// What a run says of its spots and regions.

#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(PushStatus, "not_pushed", "written", "failed", "restored", "not_restored");
SEAMWRIGHT_WORDS(Release, "none", "given", "taken", "not_taken", "withdrawn");

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

SEAMWRIGHT_DESCRIBED(SpotMeasurement);
SEAMWRIGHT_DESCRIBED(PushRecord);
SEAMWRIGHT_DESCRIBED(RegionRecord);

}  // namespace seamwright
