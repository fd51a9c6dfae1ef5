// The drift watch: what it learnt, its points, how it acts in a run.

#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(DriftVerdict, "learning", "fine", "watch", "recalibrate", "step");
SEAMWRIGHT_WORDS(DriftOf, "sensor", "robot");

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

SEAMWRIGHT_DESCRIBED(DriftWatch);
SEAMWRIGHT_DESCRIBED(DriftPoint);
SEAMWRIGHT_DESCRIBED(ActingDrift);

}  // namespace seamwright
