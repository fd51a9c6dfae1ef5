#include "projects/measure/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"
#include "projects/measure/path_modes.h"

namespace seamwright {
namespace {

struct RegionPlaces {
    std::vector<std::string> spots;       // sorted
    std::vector<Eigen::Vector3d> places;  // of the references, work object
};

std::vector<RegionPlaces> places_of_regions(const Project& setup) {
    std::vector<RegionPlaces> out;
    for (const Region& region : setup.regions) {
        RegionPlaces& r = out.emplace_back();
        for (const Spot& spot : setup.spots) {
            if (std::find(region.spot_ids.begin(), region.spot_ids.end(), spot.id) == region.spot_ids.end())
                continue;
            const Calibration* calibration = calibration_of(setup, spot);
            if (!calibration) continue;
            r.spots.push_back(spot.id);
            r.places.push_back(setup.part.base_from_workobject.inverse() * spot.base_from_flange *
                               calibration->flange_from_sensor * spot.reference_mm);
        }
        std::sort(r.spots.begin(), r.spots.end());
    }
    return out;
}

std::vector<double> distances_mm(const Eigen::Vector3d& point, const RegionPlaces& region) {
    std::vector<double> out;
    for (const Eigen::Vector3d& place : region.places) out.push_back((place - point).norm());
    std::sort(out.begin(), out.end());
    return out;
}

Expected<std::vector<int>> regions_of(const Project& setup, const ApplicationPath& path,
                                      const std::vector<Pose>& workobject_from_tool) {
    std::vector<int> out(path.points.size(), -1);
    if (path.regions_named) {
        std::map<std::string, int> known;
        for (std::size_t r = 0; r < setup.regions.size(); ++r)
            known.emplace(setup.regions[r].id, static_cast<int>(r));
        for (std::size_t i = 0; i < out.size(); ++i) {
            const std::string& id = path.points[i].region_id;
            if (id.empty()) continue;
            const auto at = known.find(id);
            if (at == known.end())
                return input_error(Text("the project has no region \"{}\"", id),
                                   Text("path point {}", i + 1));
            out[i] = at->second;
        }
        return out;
    }
    if (setup.regions.size() == 1) {
        std::fill(out.begin(), out.end(), 0);
        return out;
    }
    const std::vector<RegionPlaces> regions = places_of_regions(setup);
    for (std::size_t r = 0; r < regions.size(); ++r)
        for (std::size_t other = 0; other < regions.size(); ++other)
            if (r != other && std::includes(regions[other].spots.begin(), regions[other].spots.end(),
                                            regions[r].spots.begin(), regions[r].spots.end()))
                return input_error(
                    Text("the path does not name its regions, and all spots of region {} belong "
                         "to region {} too, so that they cannot be told apart by place",
                         setup.regions[r].id, setup.regions[other].id),
                    "path", "add a column region");
    for (std::size_t i = 0; i < out.size(); ++i) {
        // In order of distance, spots that two regions share are equal in both: the nearest that they do not share decides.
        std::vector<double> nearest{std::numeric_limits<double>::infinity()};
        for (std::size_t r = 0; r < regions.size(); ++r) {
            std::vector<double> distances = distances_mm(workobject_from_tool[i].translation(), regions[r]);
            if (distances.empty() || distances >= nearest) continue;
            nearest = std::move(distances);
            out[i] = static_cast<int>(r);
        }
    }
    return out;
}

// Over its limit: one refusal for each region and kind, with the first point and how many.
class Refusals {
  public:
    explicit Refusals(std::vector<PathRefusal>& list) : list_(list) {}
    void refuse_unless(bool ok, const std::string& region, std::size_t point, const char* kind,
                       const Text& reason) {
        if (ok) return;
        const auto [at, fresh] = index_.emplace(std::pair(region, std::string(kind)), list_.size());
        if (fresh) list_.push_back({region, point, 0, reason});
        ++list_[at->second].points;
    }

  private:
    std::vector<PathRefusal>& list_;
    std::map<std::pair<std::string, std::string>, std::size_t> index_;
};

void judge(const Project& project, const std::vector<const Region*>& regions,
           const std::vector<double>& added, PathAnswer& answer) {
    Refusals refusals(answer.refusals);
    for (std::size_t i = 0; i < answer.corrected.points.size(); ++i) {
        const PathCorrection& p = answer.corrected.points[i];
        const Region &a = *regions[static_cast<std::size_t>(p.region)],
                     &b = *regions[static_cast<std::size_t>(p.next)];
        const auto limit = [&](double of_a, double of_b) { return (1 - p.share) * of_a + p.share * of_b; };
        const Pose& d = p.displacement.workobject_from_movedworkobject;
        const double length = d.translation().norm(), turn = deg_from_rad(angle_rad(d, Pose::Identity()));
        const double most_mm = limit(a.limits.translation_mm, b.limits.translation_mm);
        const double most_deg = limit(a.limits.rotation_deg, b.limits.rotation_deg);
        const double most_sigma = limit(a.sigma_limit_mm, b.sigma_limit_mm);
        const double nozzle = limit(nozzle_sigma_mm(project, a), nozzle_sigma_mm(project, b));
        const double sigma_mm = nozzle > 0 ? std::hypot(p.sigma_mm, nozzle) : p.sigma_mm;
        const std::string& id = p.share < 0.5 ? a.id : b.id;
        // The blend is exact to rounding only; NaN refuses.
        constexpr double kRounding = 1e-9;
        const auto most_added = [&](const Region& r) {
            const RegionModes* modes = modes_of(project, r.id);
            return modes ? modes->most_added_mm : 0;
        };
        const double most = std::max(most_added(a), most_added(b));
        refusals.refuse_unless(
            added[i] <= most + kRounding, id, i, "modes",
            Text("the modes add {:.3f} mm, over their limit of {:.3f} mm", added[i], most));
        refusals.refuse_unless(
            length <= most_mm + kRounding, id, i, "mm",
            Text("the displacement of {:.3f} mm is beyond the limit of {:.3f} mm", length, most_mm));
        refusals.refuse_unless(
            turn <= most_deg + kRounding, id, i, "deg",
            Text("the rotation of {:.3f} degrees is beyond the limit of {:.3f} degrees", turn, most_deg));
        refusals.refuse_unless(
            sigma_mm >= 0 && sigma_mm <= most_sigma + kRounding, id, i, "sigma",
            Text("sigma of {:.4f} mm at the path is over the limit of {:.4f} mm", sigma_mm, most_sigma));
    }
}

// The gate asks whether the rigid frame fits all spots, which the frame of a bent part does not: where it refuses for nothing
// else and the modes explain what the spots show, it is the path that is right, and its own limits judge it.
bool bends_alone(const RegionRecord& record) {
    return record.modes && record.modes->acted && record.refusals.size() == 1 &&
           !record.correction->consistent;
}

}  // namespace

Expected<PathAnswer> correct_application_path(const Project& setup, const RunRecord& run,
                                              const ApplicationPath& path, PathFrame frame,
                                              const PathBlendOptions& options) {
    const Pose workobject_from_frame =
        frame == PathFrame::base ? setup.part.base_from_workobject.inverse() : Pose::Identity();
    std::vector<Pose> taught;
    for (const ApplicationPoint& point : path.points)
        taught.push_back(workobject_from_frame * point.frame_from_tool);
    SEAM_TRY(auto region_of, regions_of(setup, path, taught));

    PathAnswer answer;
    std::vector<PathRegion> corrections;
    std::vector<const Region*> regions;
    std::vector<std::optional<ElasticCorrection>> bent;
    std::vector<int> index(setup.regions.size(), -1);
    for (const int r : region_of) {
        if (r < 0 || index[static_cast<std::size_t>(r)] >= 0) continue;
        const Region& region = setup.regions[static_cast<std::size_t>(r)];
        index[static_cast<std::size_t>(r)] = static_cast<int>(regions.size());
        regions.push_back(&region);
        answer.region_ids.push_back(region.id);
        const auto found =
            std::find_if(run.regions.begin(), run.regions.end(),
                         [&](const RegionRecord& record) { return record.region_id == region.id; });
        const bool solved = found != run.regions.end() && found->correction &&
                            found->correction->status == CorrectionStatus::ok;
        if (!solved || (!found->gate_passed && !bends_alone(*found))) {
            Text why = found == run.regions.end() ? Text("it was not measured in this run")
                       : found->refusals.empty()  ? Text("it was not solved")
                                                  : found->refusals.front();
            answer.refusals.push_back({region.id, 0, 0, Text("the safety gate refused it: {}", why)});
        }
        for (const Text& none : limits_that_are_none(region))
            answer.refusals.push_back({region.id, 0, 0, none});
        PathRegion correction;
        if (solved) {
            correction.displacement = found->correction->displacement;
            correction.covariance = found->correction->covariance;
        }
        bent.emplace_back();
        if (solved && found->modes && found->modes->acted) {
            auto joint = joint_again(setup, region, run);
            if (joint) {
                correction.displacement = joint->correction.displacement;
                correction.covariance = joint->correction.covariance;
                bent.back() = std::move(*joint);
            } else {
                answer.refusals.push_back(
                    {region.id, 0, 0,
                     Text("its modes acted in the run and cannot be found again: {}", joint.error().text())});
            }
        }
        corrections.push_back(correction);
    }
    std::vector<PathPoint> points;
    for (std::size_t i = 0; i < taught.size(); ++i) {
        const int r = region_of[i];
        points.push_back({taught[i], r < 0 ? -1 : index[static_cast<std::size_t>(r)]});
    }
    SEAM_TRY(auto corrected, correct_path(points, corrections, answer.region_ids, options));
    answer.corrected = std::move(corrected);
    SEAM_TRY(const std::vector<double> added,
             bend_path(setup, regions, bent, points, options.closed, answer));
    if (answer.refusals.empty()) judge(setup, regions, added, answer);

    const Pose frame_from_workobject = workobject_from_frame.inverse();
    answer.path.regions_named = true;
    for (std::size_t i = 0; i < points.size(); ++i)
        answer.path.points.push_back({frame_from_workobject * answer.corrected.points[i].workobject_from_tool,
                                      points[i].region < 0
                                          ? std::string()
                                          : answer.region_ids[static_cast<std::size_t>(points[i].region)]});
    return answer;
}

}  // namespace seamwright
