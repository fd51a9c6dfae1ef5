#pragma once
// Every double that a judgement is made from, by reflection that cannot forget one: each struct is taken
// apart by a structured binding, so that a member which is added does not compile before it is named here.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/panel/panel_fit.h"
#include "projects/gate/safety_gate.h"
#include "projects/model/panel_job.h"

namespace seamwright {

using NumberVisitor = std::function<void(const std::string& path, double& number)>;

// Nothing that can be not finite.
inline void numbers(const NumberVisitor&, const std::string&, const std::string&) {}
inline void numbers(const NumberVisitor&, const std::string&, const bool&) {}
inline void numbers(const NumberVisitor&, const std::string&, const int&) {}
inline void numbers(const NumberVisitor&, const std::string&, const std::int64_t&) {}
inline void numbers(const NumberVisitor&, const std::string&, const FreeDof&) {}
inline void numbers(const NumberVisitor&, const std::string&, const SensorIdentity&) {}
inline void numbers(const NumberVisitor&, const std::string&, const RobotIdentity&) {}
template <class E>
requires std::is_enum_v<E>
void numbers(const NumberVisitor&, const std::string&, const E&) {}

inline void numbers(const NumberVisitor& visit, const std::string& path, double& number) {
    visit(path, number);
}
template <int R, int C>
void numbers(const NumberVisitor& visit, const std::string& path, Eigen::Matrix<double, R, C>& m) {
    for (int r = 0; r < R; ++r)
        for (int c = 0; c < C; ++c)
            visit(path + "(" + std::to_string(r) + "," + std::to_string(c) + ")", m(r, c));
}
inline void numbers(const NumberVisitor& visit, const std::string& path, Pose& pose) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c)
            visit(path + "(" + std::to_string(r) + "," + std::to_string(c) + ")", pose.matrix()(r, c));
}
template <class T>
void numbers(const NumberVisitor& visit, const std::string& path, std::optional<T>& value);
template <class T>
void numbers(const NumberVisitor& visit, const std::string& path, std::vector<T>& list);

inline void numbers(const NumberVisitor& visit, const std::string& path, CorrectionLimits& v) {
    auto& [translation, rotation] = v;
    numbers(visit, path + ".translation_mm", translation);
    numbers(visit, path + ".rotation_deg", rotation);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, Displacement& v) {
    auto& [d] = v;
    numbers(visit, path, d);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, SpotResidual& v) {
    auto& [id, residual, used] = v;
    numbers(visit, path + ".residual_mm", residual);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, DofSigma& v) {
    auto& [xyz, abc] = v;
    numbers(visit, path + ".xyz_mm", xyz);
    numbers(visit, path + ".abc_deg", abc);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, RegionCorrection& v) {
    auto& [status, displacement, covariance, random, systematic, sigma_xyz, sigma_abc, sigma_random,
           sigma_systematic, sigma_at_spots, rms, redundancy, factor, consistent, spots, unobservable,
           message, iterations] = v;
    numbers(visit, path + ".displacement", displacement);
    numbers(visit, path + ".covariance", covariance);
    numbers(visit, path + ".covariance_random", random);
    numbers(visit, path + ".covariance_systematic", systematic);
    numbers(visit, path + ".sigma_xyz_mm", sigma_xyz);
    numbers(visit, path + ".sigma_abc_deg", sigma_abc);
    numbers(visit, path + ".sigma_random", sigma_random);
    numbers(visit, path + ".sigma_systematic", sigma_systematic);
    numbers(visit, path + ".sigma_at_spots_mm", sigma_at_spots);
    numbers(visit, path + ".rms_mm", rms);
    numbers(visit, path + ".variance_factor", factor);
    numbers(visit, path + ".spots", spots);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, Region& v) {
    // Kept offsets are in the correction before the gate sees it.
    auto& [id, type_id, spot_ids, free, limits, sigma_mm, sigma_deg, frame_name, frame, offsets, switches] =
        v;
    numbers(visit, path + ".free", free);
    numbers(visit, path + ".limits", limits);
    numbers(visit, path + ".sigma_limit_mm", sigma_mm);
    numbers(visit, path + ".sigma_limit_deg", sigma_deg);
    numbers(visit, path + ".base_from_frame", frame);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, GateSpot& v) {
    auto& [id, required, measured, part, measured_at, point, calibration, verdict, calibrated_utc,
           collided_utc, sensor, calibrated_sensor, robot, calibrated_robot, reference] = v;
    numbers(visit, path + ".point_workobject_mm", point);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, GateRequest& v) {
    auto& [region, correction, spots, workobject, part, since, now_ns, mode, tells_mode, required_mode,
           now_utc, age_days, nozzle_sigma, nozzle_trouble, other_frames, frame_now, frame_trouble,
           of_other_types, drift_trouble, project_trouble] = v;
    numbers(visit, path + "region", region);
    numbers(visit, path + "correction", correction);
    numbers(visit, path + "spots", spots);
    numbers(visit, path + "base_from_workobject", workobject);
    numbers(visit, path + "calibration_age_days", age_days);
    numbers(visit, path + "nozzle_sigma_mm", nozzle_sigma);
    numbers(visit, path + "base_from_frame_now", frame_now);
}

inline void numbers(const NumberVisitor& visit, const std::string& path, GapFlushValue& v) {
    auto& [gap, flush] = v;
    numbers(visit, path + ".gap_mm", gap);
    numbers(visit, path + ".flush_mm", flush);
}
// What was taught and stood there before is reported, not judged.
inline void numbers(const NumberVisitor& visit, const std::string& path, PanelSpotResult& v) {
    auto& [id, taught, before, remaining, residual, panel_used, body_used] = v;
    numbers(visit, path + ".remaining", remaining);
    numbers(visit, path + ".residual_mm", residual);
}
// The separate fits of panel and body and the motion in one step are reported, not judged; sigma is taken
// from the covariance.
inline void numbers(const NumberVisitor& visit, const std::string& path, PanelFit& v) {
    auto& [status, motion, single_step, covariance, sigma_xyz, sigma_abc, sigma_at_spots, rms, panel, body,
           spots, unobservable, message] = v;
    numbers(visit, path + ".gripper_motion", motion);
    numbers(visit, path + ".covariance", covariance);
    numbers(visit, path + ".sigma_at_spots_mm", sigma_at_spots);
    numbers(visit, path + ".rms_mm", rms);
    numbers(visit, path + ".spots", spots);
}
inline void numbers(const NumberVisitor& visit, const std::string& path, PanelMeasurement& v) {
    auto& [place, status, message, panel, body, sigma, gap, flush, covariance, disagreement, offset, overlap,
           part, time, capture, second_capture] = v;
    numbers(visit, path + ".panel_mm", panel);
    numbers(visit, path + ".body_mm", body);
    numbers(visit, path + ".sigma_mm", sigma);
    numbers(visit, path + ".gap_mm", gap);
    numbers(visit, path + ".flush_mm", flush);
    numbers(visit, path + ".gap_flush_covariance", covariance);
    numbers(visit, path + ".head_disagreement_mm", disagreement);
    numbers(visit, path + ".head_offset_mm", offset);
    numbers(visit, path + ".head_overlap_mm", overlap);
}
// The gauge's settings are judged where it is made (check of gap_flush.h); a profile marks missing returns by
// NaN.
inline void numbers(const NumberVisitor& visit, const std::string& path, PanelPlace& v) {
    auto& [id, sensor, second_sensor, enabled, required, gauge, panel_reference, body_reference, gap, flush,
           surface, profile, weights, sigma] = v;
    numbers(visit, path + ".panel_reference_mm", panel_reference);
    numbers(visit, path + ".body_reference_mm", body_reference);
    numbers(visit, path + ".gap_mm", gap);
    numbers(visit, path + ".flush_mm", flush);
    numbers(visit, path + ".surface_deg", surface);
    numbers(visit, path + ".weights", weights);
    numbers(visit, path + ".sigma_mm", sigma);
}
// What a learnt sensitivity leads to is a motion of its own, which the gate judges as any other.
inline void numbers(const NumberVisitor& visit, const std::string& path, PanelJob& v) {
    auto& [id, robot, places, gripper, limits, sigma_mm, sigma_deg, gap, flush, head, deviation, frame_name,
           frame, sensitivity] = v;
    numbers(visit, path + ".places", places);
    numbers(visit, path + ".base_from_gripper", gripper);
    numbers(visit, path + ".limits", limits);
    numbers(visit, path + ".sigma_limit_mm", sigma_mm);
    numbers(visit, path + ".sigma_limit_deg", sigma_deg);
    numbers(visit, path + ".gap_tolerance_mm", gap);
    numbers(visit, path + ".flush_tolerance_mm", flush);
    numbers(visit, path + ".head_limit_mm", head);
    numbers(visit, path + ".base_from_frame", frame);
}

template <class T>
void numbers(const NumberVisitor& visit, const std::string& path, std::optional<T>& value) {
    if (value) numbers(visit, path, *value);
}
template <class T>
void numbers(const NumberVisitor& visit, const std::string& path, std::vector<T>& list) {
    for (std::size_t i = 0; i < list.size(); ++i)
        numbers(visit, path + "[" + std::to_string(i) + "]", list[i]);
}

// `good` with one number not finite after the other: all that `refuses` lets pass. `tried` counts.
template <class T, class Refuses>
std::vector<std::string> passes_with_one_not_finite(const T& good, const Refuses& refuses, int& tried) {
    std::vector<std::string> passing;
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          -std::numeric_limits<double>::infinity()};
    int count = 0;
    T probe = good;
    numbers([&](const std::string&, double&) { ++count; }, "", probe);
    for (int k = 0; k < count; ++k)
        for (const double value : bad) {
            T spoiled = good;
            int at = 0;
            std::string name;
            numbers(
                [&](const std::string& path, double& number) {
                    if (at++ != k) return;
                    number = value;
                    name = path;
                },
                "", spoiled);
            ++tried;
            if (!refuses(spoiled)) passing.push_back(name + " = " + std::to_string(value));
        }
    return passing;
}

}  // namespace seamwright
