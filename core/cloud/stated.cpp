// A rigid fit with the form's model about it: the pose and the covariance that are stated.

#include <algorithm>
#include <cmath>

#include "core/cloud/fit_steps.h"
#include "core/geometry/decompositions.h"

namespace seamwright::fitting {
namespace {

// The points that lie on the part as the rigid fit has it: with a bent part its own place leaves them off it.
Cloud within_gate(const Cloud& cloud, const Surface& surface, const Refined& rigid, bool facing) {
    const std::vector<double> off =
        distances(cloud, surface, rigid.base_from_part, 2 * rigid.gate_mm, facing);
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < cloud.size(); ++i)
        if (off[i] <= rigid.gate_mm) kept.push_back(i);
    return picked(cloud, kept);
}

}  // namespace

Stated stated(const Cloud& cloud, const Surface& surface, const Refined& rigid, bool facing) {
    const FitSystem& system = rigid.system;
    const Cloud seen = within_gate(cloud, surface, rigid, facing);
    Stated out;
    out.base_from_part = rigid.base_from_part;
    double moved_mm = 0;
    for (int round = 0; round < 2; ++round) {
        const auto residuals =
            residuals_of(seen, surface, out.base_from_part, rigid.gate_mm + moved_mm, facing);
        out.scatter_mm = local_noise_mm(residuals);
        if (!std::isfinite(out.scatter_mm)) {
            out.reason = "the scan is too thin to tell its noise";
            return out;
        }
        const FormSolution s =
            solve_with_form(form_nodes(residuals, system, out.scatter_mm),
                            plate_axes(surface, out.base_from_part), system.middle, system.spread_mm);
        if (!s.solved) {
            out.reason = "the scan covers too few places of the part";
            return out;
        }
        const Matrix6 to_tangent = tangent_of_motion(out.base_from_part, system.middle, system.spread_mm);
        out.motion_covariance = s.covariance;
        out.covariance = to_tangent * s.covariance * to_tangent.transpose();
        Matrix6 information = Matrix6::Zero();
        for (const Residual& r : residuals) {
            Vector6 row;
            row << r.normal, (r.place - system.middle).cross(r.normal) / system.spread_mm;
            information +=
                row * row.transpose() / (r.noise_mm2 > 0 ? r.noise_mm2 : out.scatter_mm * out.scatter_mm);
        }
        out.covariance_noise = to_tangent * inverse_matrix(information) * to_tangent.transpose();
        out.form_mm = s.form_mm;
        out.form_length_mm = s.length_mm;
        out.base_from_part = retract(out.base_from_part, to_tangent * s.motion);
        if (s.motion.norm() < kSettled_mm) break;
        moved_mm += 4 * s.motion.norm();  // a rotation's entry is that at the spread; points lie farther out
    }
    return out;
}

}  // namespace seamwright::fitting
