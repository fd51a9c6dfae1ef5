#include "projects/panel/panel_sensitivity.h"

#include <cmath>

#include "core/panel/panel_fit.h"
#include "projects/panel/panel_measure.h"

namespace seamwright {

Expected<std::vector<std::array<double, 6>>> computed_sensitivity(const Project& project,
                                                                  const PanelJob& job) {
    std::vector<std::array<double, 6>> rows;
    for (const PanelPlace& place : job.places) {
        if (!place.enabled) continue;
        const auto stands = gripper_from_place(project, place);
        if (!stands)
            return input_error("a sensor of it has no calibration",
                               Text("panel job {}, place {}", job.id, place.id), "calibrate it");
        PanelSpot spot;
        spot.panel.reference_mm = place.panel_reference_mm;
        spot.body.reference_mm = place.body_reference_mm;
        spot.surface_rad = rad_from_deg(place.surface_deg);
        const GapFlushValue taught = gap_and_flush(spot, place.panel_reference_mm, place.body_reference_mm);
        const Eigen::Vector3d body = *stands * place.body_reference_mm;
        const Eigen::Matrix3d place_from_gripper = stands->linear().transpose();
        std::array<double, 6> gap{}, flush{};
        for (int k = 0; k < 6; ++k) {
            const Eigen::Vector3d motion = k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
                                                 : Eigen::Vector3d(Eigen::Vector3d::Unit(k - 3).cross(body));
            const GapFlushValue moved = gap_and_flush(spot, place.panel_reference_mm,
                                                      place.body_reference_mm - place_from_gripper * motion);
            gap[static_cast<std::size_t>(k)] = moved.gap_mm - taught.gap_mm;
            flush[static_cast<std::size_t>(k)] = moved.flush_mm - taught.flush_mm;
        }
        rows.push_back(gap);
        rows.push_back(flush);
    }
    return rows;
}

Expected<SensitivityComparison> compare_sensitivity(const Project& project, const PanelJob& job) {
    const Text where("panel job {}", job.id);
    if (!job.sensitivity) return usage_error("its sensitivity is not learnt", where, "learn it first");
    SEAM_TRY(const auto computed, computed_sensitivity(project, job));
    const PanelSensitivity& learnt = *job.sensitivity;
    if (learnt.rows.size() != computed.size() || 2 * learnt.places.size() != computed.size())
        return input_error("its sensitivity is that of other places", where, "learn it anew");
    SensitivityComparison out;
    double off = 0, all = 0;
    for (std::size_t i = 0; i < computed.size(); ++i)
        for (std::size_t k = 0; k < 6; ++k) {
            const double step = k < 3 ? learnt.step_mm : rad_from_deg(learnt.step_deg);
            const double difference = step * (learnt.rows[i][k] - computed[i][k]);
            off += difference * difference;
            all += std::pow(step * computed[i][k], 2);
            if (!(std::abs(difference) <= out.largest_mm)) {
                out.largest_mm = std::abs(difference);
                out.place = learnt.places[i / 2];
                out.flush = i % 2 == 1;
            }
        }
    out.off_share = std::sqrt(off / all);
    return out;
}

}  // namespace seamwright
