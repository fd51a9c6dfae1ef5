#pragma once
// What the sources *_json.cpp take from one another: each describes the types of one subject and instantiates those that a
// document or another subject's types hold.

#include "projects/file/project_json.h"

// The words on disk. Their order is that of the enum's values and must never change.
#define SEAMWRIGHT_WORDS(E, ...)                                                 \
    template <>                                                                  \
    struct EnumWords<E> {                                                        \
        static constexpr auto words = std::to_array<const char*>({__VA_ARGS__}); \
    }
// Beside its description, for both archives.
// NOLINTBEGIN(bugprone-macro-parentheses): T is the name of a type
#define SEAMWRIGHT_DESCRIBED(T)              \
    template void describe(JsonWriter&, T&); \
    template void describe(JsonReader&, T&)
// NOLINTEND(bugprone-macro-parentheses)

namespace seamwright {

SEAMWRIGHT_WORDS(CorrectionStatus, "ok", "under_determined", "over_limit", "not_converged");
SEAMWRIGHT_WORDS(SpotStatus, "measured", "not_measured", "damaged_frame", "no_stripe", "no_calibration",
                 "no_feature");

// core_json.cpp
template <class A>
void describe(A& a, SensorIdentity& v);
template <class A>
void describe(A& a, RobotIdentity& v);
template <class A>
void describe(A& a, PeakOptions& v);
template <class A>
void describe(A& a, FilterOptions& v);
template <class A>
void describe(A& a, SensorModel& v);
template <class A>
void describe(A& a, Profile& v);
template <class A>
void describe(A& a, FeatureRecipe& v);
template <class A>
void describe(A& a, ContourCurve& v);
template <class A>
void describe(A& a, CorrectionLimits& v);
template <class A>
void describe(A& a, Feature& v);
template <class A>
void describe(A& a, SpotResidual& v);
template <class A>
void describe(A& a, RegionCorrection& v);

// panel_json.cpp
template <class A>
void describe(A& a, PanelJob& v);
template <class A>
void describe(A& a, PanelMeasurement& v);
template <class A>
void describe(A& a, PanelRecord& v);

// drift_json.cpp
template <class A>
void describe(A& a, DriftWatch& v);
template <class A>
void describe(A& a, DriftPoint& v);
template <class A>
void describe(A& a, ActingDrift& v);

// run_json.cpp
template <class A>
void describe(A& a, SpotMeasurement& v);
template <class A>
void describe(A& a, PushRecord& v);
template <class A>
void describe(A& a, RegionRecord& v);

// evidence_json.cpp
template <class A>
void describe(A& a, FrozenContour& v);
template <class A>
void describe(A& a, ZeroShift& v);
template <class A>
void describe(A& a, KnownShift& v);
template <class A>
void describe(A& a, HeadlessRun& v);
template <class A>
void describe(A& a, RobotReturns& v);
template <class A>
void describe(A& a, TriggerPasses& v);
template <class A>
void describe(A& a, StudyPlan& v);

// project_json.cpp
template <class A>
void describe(A& a, SeenLight& v);

}  // namespace seamwright
