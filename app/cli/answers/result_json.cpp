#include "app/cli/answers/result_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {

using nlohmann::json;

json vector_json(const Eigen::Ref<const Eigen::VectorXd>& v) {
    json list = json::array();
    for (double x : v) list.push_back(x);
    return list;
}

json matrix_json(const Eigen::Ref<const Eigen::MatrixXd>& m) {
    json rows = json::array();
    for (Eigen::Index r = 0; r < m.rows(); ++r) rows.push_back(vector_json(m.row(r).transpose()));
    return rows;
}

std::string pose_text(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    const Eigen::Vector3d t = pose.translation();
    return fmt::format("X {:.3f}  Y {:.3f}  Z {:.3f} mm   A {:.4f}  B {:.4f}  C {:.4f} deg (KUKA A B C)",
                       t.x(), t.y(), t.z(), abc.a_deg, abc.b_deg, abc.c_deg);
}

namespace {
json sigma_json(const Eigen::Vector3d& xyz_mm, const Eigen::Vector3d& abc_deg) {
    return {{"xyz_mm", vector_json(xyz_mm)}, {"abc_deg", vector_json(abc_deg)}};
}

// Of a correction whose spots contradict each other: the stated sigma times their scatter; else as stated.
DofSigma scattered_sigma(const RegionCorrection& c) {
    const double times = c.consistent ? 1.0 : std::sqrt(std::max(1.0, c.variance_factor));
    return {times * c.sigma_xyz_mm, times * c.sigma_abc_deg};
}

// "sigma", "covariance" and their two parts, of a correction or a plan.
template <class T>
void put_spread(const T& r, json& out) {
    out["sigma"] = sigma_json(r.sigma_xyz_mm, r.sigma_abc_deg);
    out["sigma_random"] = sigma_json(r.sigma_random.xyz_mm, r.sigma_random.abc_deg);
    out["sigma_systematic"] = sigma_json(r.sigma_systematic.xyz_mm, r.sigma_systematic.abc_deg);
    out["covariance"] = matrix_json(r.covariance);
    out["covariance_random"] = matrix_json(r.covariance_random);
    out["covariance_systematic"] = matrix_json(r.covariance_systematic);
}
}  // namespace

json light_json(const SeenLight& light) {
    const auto value = [](const std::optional<double>& v) { return v ? json(*v) : json(); };
    return {{"settings", light.settings},
            {"bright", value(light.bright)},
            {"saturated_share", value(light.saturated_share)},
            {"width_px", value(light.width_px)},
            {"exposures", light.exposures}};
}

json correction_json(const RegionCorrection& c) {
    json spots = json::array();
    for (const SpotResidual& s : c.spots)
        spots.push_back({{"id", s.id}, {"residual_mm", vector_json(s.residual_mm)}, {"used", s.used}});
    json out = {{"status", to_string(c.status)},
                {"displacement", pose_json(c.displacement.workobject_from_movedworkobject)},
                {"rms_mm", c.rms_mm},
                {"redundancy", c.redundancy},
                {"consistent", c.consistent},
                {"variance_factor", c.variance_factor},
                {"iterations", c.iterations},
                {"spots", spots},
                {"unobservable", c.unobservable},
                {"message", c.message}};
    put_spread(c, out);
    const DofSigma scattered = scattered_sigma(c);
    out["sigma_scattered"] = sigma_json(scattered.xyz_mm, scattered.abc_deg);
    return out;
}

namespace {
std::string sigma_line(const char* name, const Eigen::Vector3d& xyz, const Eigen::Vector3d& abc) {
    return fmt::format("{}  X {:.3f}  Y {:.3f}  Z {:.3f} mm   A {:.4f}  B {:.4f}  C {:.4f} deg\n", name,
                       xyz.x(), xyz.y(), xyz.z(), abc.x(), abc.y(), abc.z());
}

// The sum, and its parts where something repeats.
template <class T>
std::string sigma_text(const T& r) {
    std::string text = sigma_line("sigma", r.sigma_xyz_mm, r.sigma_abc_deg);
    if (!r.covariance_systematic.isZero(0)) {
        text += sigma_line("  random    ", r.sigma_random.xyz_mm, r.sigma_random.abc_deg);
        text += sigma_line("  systematic", r.sigma_systematic.xyz_mm, r.sigma_systematic.abc_deg);
    }
    return text;
}
}  // namespace

std::string correction_sigma_text(const RegionCorrection& c) {
    return sigma_text(c);
}

std::string correction_text(const RegionCorrection& c) {
    std::string text = fmt::format("{}{}{}\n", to_string(c.status), c.message.empty() ? "" : ": ", c.message);
    for (const Text& direction : c.unobservable) text += "unobservable: " + direction.english() + "\n";
    if (c.status == CorrectionStatus::under_determined) return text;
    text += "D      " + pose_text(c.displacement.workobject_from_movedworkobject) + "\n";
    text += sigma_text(c);
    if (!c.consistent) {
        const DofSigma scattered = scattered_sigma(c);
        text += sigma_line("  scattered ", scattered.xyz_mm, scattered.abc_deg);
    }
    text += fmt::format("rms {:.4f} mm, redundancy {}\n", c.rms_mm, c.redundancy);
    for (const SpotResidual& s : c.spots)
        text += fmt::format("  {:<12} residual {:8.4f} {:8.4f} {:8.4f} mm{}\n", s.id, s.residual_mm.x(),
                            s.residual_mm.y(), s.residual_mm.z(),
                            s.used ? "" : "   left out: it contradicts the others");
    return text;
}

json plan_json(const RegionPlan& p) {
    json out = {{"status", to_string(p.status)},
                {"weakest", p.weakest},
                {"weakest_direction", vector_json(p.weakest_direction)},
                {"unobservable", p.unobservable},
                {"redundancy", p.redundancy},
                {"uncontrolled", p.uncontrolled},
                {"advice", p.advice}};
    put_spread(p, out);
    return out;
}

std::string plan_text(const RegionPlan& p) {
    std::string text = fmt::format("{}\n", to_string(p.status));
    if (p.status == CorrectionStatus::ok) text += sigma_text(p);
    text += fmt::format("weakest: {}\nredundancy: {}\n", p.weakest, p.redundancy);
    for (const Text& direction : p.unobservable) text += "unobservable: " + direction.english() + "\n";
    if (!p.uncontrolled.empty())
        text += fmt::format("a single wrong measure could not be found at: {}\n",
                            fmt::join(p.uncontrolled, ", "));
    if (!p.advice.empty()) text += "advice: " + p.advice.english() + "\n";
    return text;
}

json feature_json(const Feature& f) {
    json j = {{"status", to_string(f.status)},
              {"point", vector_json(f.point_mm)},
              {"covariance", matrix_json(f.covariance_mm2)},
              {"rms_mm", f.rms_mm},
              {"points_used", f.points_used},
              {"message", f.message}};
    if (f.phi_rad) j["phi_deg"] = deg_from_rad(*f.phi_rad);
    for (const Eigen::Vector2d& rival : f.rivals_mm) j["rivals_mm"].push_back(vector_json(rival));
    return j;
}

std::string feature_text(const Feature& f) {
    if (f.status != FeatureStatus::ok) return fmt::format("{}: {}\n", to_string(f.status), f.message);
    std::string text =
        fmt::format("ok   x {:.4f} ± {:.4f}   z {:.4f} ± {:.4f} mm   rms {:.4f} mm, {} points\n",
                    f.point_mm.x(), std::sqrt(f.covariance_mm2(0, 0)), f.point_mm.y(),
                    std::sqrt(f.covariance_mm2(1, 1)), f.rms_mm, f.points_used);
    if (f.phi_rad)
        text += fmt::format("     phi {:.4f} deg (from +x towards +z)\n", deg_from_rad(*f.phi_rad));
    return text;
}

json registration_json(const Registration& r) {
    // Degrees at the edge: covariance and sigma of (x, z, phi_deg).
    const Eigen::Vector3d scale(1, 1, deg_from_rad(1));
    const Eigen::Matrix3d covariance = scale.asDiagonal() * r.covariance * scale.asDiagonal();
    return {{"status", to_string(r.status)},
            {"pose",
             {{"x", r.scene_from_template.dx_mm},
              {"z", r.scene_from_template.dz_mm},
              {"phi_deg", deg_from_rad(r.scene_from_template.phi_rad)}}},
            {"rms_mm", r.rms_mm},
            {"inliers", r.inlier_share},
            {"replaced", r.replaced_share},
            {"iterations", r.iterations},
            {"sigma",
             {{"x_mm", std::sqrt(covariance(0, 0))},
              {"z_mm", std::sqrt(covariance(1, 1))},
              {"phi_deg", std::sqrt(covariance(2, 2))}}},
            {"covariance", matrix_json(covariance)}};
}

std::string registration_text(const Registration& r) {
    const PlanarMotion& m = r.scene_from_template;
    return fmt::format(
        "{}   x {:.4f} mm  z {:.4f} mm  phi {:.4f} deg (template to scene, from +x towards +z)\n"
        "rms {:.4f} mm, inliers {:.1f} %\n",
        to_string(r.status), m.dx_mm, m.dz_mm, deg_from_rad(m.phi_rad), r.rms_mm, 100 * r.inlier_share);
}

json alignment_json(const AlignmentResult& a) {
    json offsets = json::array();
    for (const TravelOffset& o : a.offsets)
        offsets.push_back({{"travel_mm", o.travel_mm},
                           {"dx_mm", o.dx_mm},
                           {"dz_mm", o.dz_mm},
                           {"dphi_deg", o.dphi_deg},
                           {"rms_mm", o.rms_mm},
                           {"ok", o.ok}});
    return {{"status", to_string(a.status)},
            {"yaw_deg", a.yaw_deg},
            {"pitch_deg", a.pitch_deg},
            {"roll_deg", a.roll_deg},
            {"sigma_yaw_deg", a.sigma_yaw_deg},
            {"sigma_pitch_deg", a.sigma_pitch_deg},
            {"radius_mm", a.radius_mm},  // null: straight within the noise
            {"dx_mm_per_mm", a.dx_mm_per_mm},
            {"dz_mm_per_mm", a.dz_mm_per_mm},
            {"expected_error_mm", a.expected_error_mm},
            {"expected_error_sigma_mm", a.expected_error_sigma_mm},  // null: a direction is not seen
            {"shape_change_mm", a.shape_change_mm},
            {"cure", a.cure},
            {"cure_about_z_deg", a.cure_about_z_deg},  // the sensor's own Z first
            {"cure_about_x_deg", a.cure_about_x_deg},  // then about its turned X
            {"offsets", offsets}};
}

std::string alignment_text(const AlignmentResult& a) {
    std::string radius = std::isfinite(a.radius_mm) ? fmt::format("{:.0f} mm", a.radius_mm) : "straight";
    return fmt::format(
        "{}   yaw {:+.3f} ± {:.3f} deg   pitch {:+.3f} ± {:.3f} deg   roll {:+.3f} deg   radius {}\n"
        "expected error from jitter {:.4f} ± {:.4f} mm, shape change {:.4f} mm\n{}{}",
        to_string(a.status), a.yaw_deg, a.sigma_yaw_deg, a.pitch_deg, a.sigma_pitch_deg, a.roll_deg, radius,
        a.expected_error_mm, a.expected_error_sigma_mm, a.shape_change_mm,
        a.cure.empty() ? "" : "to cure: ", a.cure.empty() ? "" : a.cure.english() + "\n");
}

static json value_json(const GapFlushValue& v) {
    return {{"gap_mm", v.gap_mm}, {"flush_mm", v.flush_mm}};
}

json panel_fit_json(const PanelFit& fit) {
    json spots = json::array();
    for (const PanelSpotResult& s : fit.spots)
        spots.push_back({{"id", s.id},
                         {"gap_mm", s.remaining.gap_mm},
                         {"flush_mm", s.remaining.flush_mm},
                         {"residual_mm", vector_json(s.residual_mm)},
                         {"taught", value_json(s.taught)},
                         {"before", value_json(s.before)},
                         {"panel_used", s.panel_used},
                         {"body_used", s.body_used}});
    return {
        {"status", to_string(fit.status)},
        {"gripper_motion", pose_json(fit.gripper_motion)},
        {"single_step", pose_json(fit.single_step)},
        {"sigma", {{"xyz_mm", vector_json(fit.sigma_xyz_mm)}, {"abc_deg", vector_json(fit.sigma_abc_deg)}}},
        {"covariance", matrix_json(fit.covariance)},
        {"rms_mm", fit.rms_mm},
        {"panel", correction_json(fit.panel)},
        {"body", correction_json(fit.body)},
        {"spots", spots},
        {"unobservable", fit.unobservable},
        {"message", fit.message}};
}

std::string panel_fit_text(const PanelFit& fit) {
    std::string text =
        fmt::format("{}{}{}\n", to_string(fit.status), fit.message.empty() ? "" : ": ", fit.message);
    for (const Text& direction : fit.unobservable) text += "unobservable: " + direction.english() + "\n";
    if (fit.status == CorrectionStatus::under_determined) return text;
    text += "G      " + pose_text(fit.gripper_motion) + "\n";
    text += fmt::format("sigma  X {:.3f}  Y {:.3f}  Z {:.3f} mm   A {:.4f}  B {:.4f}  C {:.4f} deg\n",
                        fit.sigma_xyz_mm.x(), fit.sigma_xyz_mm.y(), fit.sigma_xyz_mm.z(),
                        fit.sigma_abc_deg.x(), fit.sigma_abc_deg.y(), fit.sigma_abc_deg.z());
    text += fmt::format("left off after the motion, rms {:.4f} mm:\n", fit.rms_mm);
    for (const PanelSpotResult& s : fit.spots)
        text +=
            fmt::format("  {:<12} gap {:+8.4f}   flush {:+8.4f} mm   (as measured {:+8.4f}, {:+8.4f}){}{}\n",
                        s.id, s.remaining.gap_mm, s.remaining.flush_mm, s.before.gap_mm, s.before.flush_mm,
                        s.panel_used ? "" : "   panel left out: contradicts the others",
                        s.body_used ? "" : "   body left out: contradicts the others");
    return text;
}

}  // namespace seamwright::cli
