// What devices and core measure with and answer.

#include "projects/file/json/described.h"

namespace seamwright {

SEAMWRIGHT_WORDS(ScanLines, "columns", "rows");
SEAMWRIGHT_WORDS(PeakMethod, "centre_of_gravity", "gaussian", "steger");
SEAMWRIGHT_WORDS(FeatureStatus, "ok", "no_points", "not_found", "ambiguous", "ill_conditioned");

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
    a("x_mm", v.x_mm);
    a("z_mm", v.z_mm);
    a("intensity", v.intensity);
    a("segment", v.segment);
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

SEAMWRIGHT_DESCRIBED(SensorIdentity);
SEAMWRIGHT_DESCRIBED(RobotIdentity);
SEAMWRIGHT_DESCRIBED(PeakOptions);
SEAMWRIGHT_DESCRIBED(FilterOptions);
SEAMWRIGHT_DESCRIBED(SensorModel);
SEAMWRIGHT_DESCRIBED(Profile);
SEAMWRIGHT_DESCRIBED(FeatureRecipe);
SEAMWRIGHT_DESCRIBED(ContourCurve);
SEAMWRIGHT_DESCRIBED(CorrectionLimits);
SEAMWRIGHT_DESCRIBED(Feature);
SEAMWRIGHT_DESCRIBED(SpotResidual);
SEAMWRIGHT_DESCRIBED(RegionCorrection);

std::optional<CorrectionStatus> correction_status_named(const std::string& word) {
    const auto& words = EnumWords<CorrectionStatus>::words;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (word == words[i]) return static_cast<CorrectionStatus>(i);
    return std::nullopt;
}

}  // namespace seamwright
