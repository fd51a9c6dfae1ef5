#include "projects/measure/path_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/elastic/bead_shape.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

constexpr double kOnPathMm = 60;  // a spot farther from the path has no place along it

// Places of the learnt spots; along the arc only where all of them lie by the path.
struct Places {
    std::vector<BeadPlace> spots;
    BeadArc arc;
};
Places places_of(const ElasticModes& modes, const std::vector<PathPoint>& taught, bool closed,
                 const CorrectedPath& path) {
    Places out;
    out.arc = {true, closed ? path.length_mm : 0};
    for (const ElasticSpot& s : modes.spots) {
        BeadPlace place{s.place_mm(), 0};
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < taught.size(); ++i) {
            const double d = (taught[i].workobject_from_tool.translation() - place.place_mm).norm();
            if (d >= nearest) continue;
            nearest = d;
            place.arc_mm = path.points[i].length_mm;
        }
        out.arc.known = out.arc.known && nearest <= kOnPathMm;
        out.spots.push_back(place);
    }
    return out;
}

Eigen::Matrix3d across(const std::vector<PathPoint>& taught, std::size_t i, bool closed) {
    const std::size_t n = taught.size();
    const std::size_t before = i > 0 ? i - 1 : closed ? n - 1 : 0;
    const std::size_t after = i + 1 < n ? i + 1 : closed ? 0 : n - 1;
    const Eigen::Vector3d along =
        taught[after].workobject_from_tool.translation() - taught[before].workobject_from_tool.translation();
    const double length = along.norm();
    if (!(length > 0)) return Eigen::Matrix3d::Identity();
    return Eigen::Matrix3d::Identity() - along * along.transpose() / (length * length);
}

}  // namespace

Expected<ElasticCorrection> joint_again(const Project& setup, const Region& region, const RunRecord& run) {
    const RegionModes* modes = modes_of(setup, region.id);
    if (!modes) return input_error("none were learnt", Text("region {}: modes", region.id));
    std::vector<SpotObservation> spots =
        region_observations(setup, region, without_drift(setup, run.spots, acting_drift(run)));
    RegionCorrection rigid;
    SEAM_OK(RegionCorrector(setup, region).correct(spots, rigid));
    ElasticOptions limits;
    limits.most_added_mm = modes->most_added_mm;
    SEAM_TRY(auto joint, solve_elastic(spots, correction_options(setup, region), modes->modes, limits));
    if (!joint.acted) return input_error(joint.why, Text("region {}: modes", region.id));
    if (const KeptOffset* kept = acting_offset(region))
        joint.correction.displacement.workobject_from_movedworkobject.pretranslate(-kept->offset_mm);
    return joint;
}

Expected<std::vector<double>> bend_path(const Project& setup, const std::vector<const Region*>& regions,
                                        const std::vector<std::optional<ElasticCorrection>>& bent,
                                        const std::vector<PathPoint>& taught, bool closed,
                                        PathAnswer& answer) {
    std::vector<double> added(taught.size(), 0);
    std::vector<Places> places(regions.size());
    std::vector<std::optional<BeadShape>> shapes(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const RegionModes* modes = bent[r] ? modes_of(setup, regions[r]->id) : nullptr;
        if (!modes) continue;
        places[r] = places_of(modes->modes, taught, closed, answer.corrected);
        SEAM_TRY(shapes[r], BeadShape::make(modes->modes, places[r].spots, places[r].arc));
    }
    for (std::size_t i = 0; i < taught.size(); ++i) {
        PathCorrection& p = answer.corrected.points[i];
        const Eigen::Matrix3d aside = across(taught, i, closed);
        Eigen::Vector3d u = Eigen::Vector3d::Zero();
        double sigma = 0;
        bool bends = false;
        for (const auto& [index, share] : {std::pair(p.region, 1 - p.share), std::pair(p.next, p.share)}) {
            const auto r = static_cast<std::size_t>(index);
            if (!shapes[r] || share == 0) continue;
            const BeadPoint point =
                bead_point(*bent[r], *shapes[r], {taught[i].workobject_from_tool.translation(), p.length_mm});
            u += share * aside * point.added_mm;
            const Eigen::Matrix3d turned =
                bent[r]->correction.displacement.workobject_from_movedworkobject.linear();
            const Eigen::Matrix3d seen = turned * aside * turned.transpose();
            const Eigen::Matrix3d c = seen * point.covariance_mm2 * seen.transpose();
            sigma +=
                share * std::sqrt(std::max(
                            0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(c).eigenvalues().maxCoeff()));
            bends = true;
        }
        if (!bends) continue;
        added[i] = u.norm();
        p.workobject_from_tool.pretranslate(p.displacement.workobject_from_movedworkobject.linear() * u);
        p.sigma_mm = std::max(p.sigma_mm, sigma);
    }
    return added;
}

}  // namespace seamwright
