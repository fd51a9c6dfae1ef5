#include "projects/proof/zero_shift.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/evaluation/statistics.h"
#include "core/geometry/notation.h"
#include "projects/measure/measure.h"
#include "projects/model/part_types.h"

namespace seamwright {

std::vector<Eigen::Vector3d> reference_points(const Project& project, const Region& region) {
    std::vector<Eigen::Vector3d> points;
    for (const SpotObservation& spot : planned_observations(project, region))
        points.push_back(spot.workobject_from_sensor * spot.reference_mm);
    return points;
}

ZeroShift summarise_zero_shift(const Project& setup, const std::vector<RunRecord>& runs) {
    ZeroShift zero;
    for (const RunRecord& run : runs) {
        zero.runs.push_back(run.number);
        zero.refused += run.status != RunStatus::ok;
    }
    for (const Region& region : setup.regions) {
        std::array<std::vector<double>, 6> values;
        ZeroShiftRegion& result = zero.regions.emplace_back();
        result.region_id = region.id;
        std::vector<Eigen::Vector3d> points = reference_points(setup, region);
        std::vector<Eigen::Vector3d> moved(points.size(), Eigen::Vector3d::Zero());
        for (const RunRecord& run : runs)
            for (const RegionRecord& r : run.regions) {
                if (r.region_id != region.id || !r.correction) continue;
                const Pose& d = r.correction->displacement.workobject_from_movedworkobject;
                const KukaAbc abc = kuka_from_rotation(d.linear());
                const std::array<double, 6> six{d.translation().x(), d.translation().y(), d.translation().z(),
                                                abc.a_deg,           abc.b_deg,           abc.c_deg};
                for (std::size_t k = 0; k < 6; ++k) {
                    values[k].push_back(six[k]);
                    result.stated_three_sigma[k] =
                        3 * (k < 3 ? r.correction->sigma_random.xyz_mm[static_cast<int>(k)]
                                   : r.correction->sigma_random.abc_deg[static_cast<int>(k) - 3]);
                }
                for (std::size_t i = 0; i < points.size(); ++i) moved[i] += d * points[i] - points[i];
            }
        if (values[0].empty()) {
            zero.regions.pop_back();
            continue;
        }
        for (std::size_t k = 0; k < 6; ++k) {
            const Summary s = summarise(values[k]);
            result.mean[k] = s.mean;
            result.three_sigma[k] = s.three_sigma;
        }
        for (const Eigen::Vector3d& sum : moved)
            result.worst_mean_mm =
                std::max(result.worst_mean_mm, sum.norm() / static_cast<double>(values[0].size()));
    }
    return zero;
}

Expected<ZeroShift> measure_zero_shift(Station& station, const ZeroShiftOptions& options) {
    if (options.runs < 2 || options.runs > 1000)
        return usage_error(Text("{} runs", options.runs), "zero shift", "give 2 to 1000");
    SEAM_TRY(const auto type, called_type(station.project(), options.part_type));
    const Project setup = of_type(station.project(), type);
    std::vector<RunRecord> runs;
    for (int n = 0; n < options.runs; ++n) {
        RunOptions run_options;
        run_options.part_id = fmt::format("{}{}", kZeroShiftPrefix, n + 1);
        run_options.part_type = type;
        run_options.cancel = options.cancel;
        if (options.progress)
            run_options.progress = [&](const RunProgress& p) {
                options.progress({n * p.total + p.done, options.runs * p.total,
                                  Text("{}/{}: {}", n + 1, options.runs, p.text)});
            };
        SEAM_TRY(auto run, station.run(run_options));
        if (options.measured) options.measured(run);
        if (run.status == RunStatus::cancelled)
            return usage_error(Text("cancelled after {} runs", n), "zero shift", "start it again");
        if (run.status == RunStatus::device) return device_error(run.message, "zero shift");
        run.captures.clear();
        runs.push_back(std::move(run));
    }
    ZeroShift zero = summarise_zero_shift(setup, runs);
    SEAM_OK(station.file().append_evidence({0, {}, 0, zero}, setup));
    return zero;
}

std::optional<double> displaced_as_one_mm(const Project& p, const ZeroShift& zero) {
    constexpr double kShareOfBend = 0.05;
    double worst = 0;
    std::vector<Eigen::Vector3d> taught, found;
    for (const ZeroShiftRegion& r : zero.regions) {
        const auto region = std::find_if(p.regions.begin(), p.regions.end(),
                                         [&](const Region& one) { return one.id == r.region_id; });
        if (region == p.regions.end()) return std::nullopt;
        const Pose moved = make_pose(rotation_from_kuka({r.mean[3], r.mean[4], r.mean[5]}),
                                     {r.mean[0], r.mean[1], r.mean[2]});
        double farthest = 0;
        for (const Eigen::Vector3d& point : reference_points(p, *region)) {
            taught.push_back(point);
            found.push_back(moved * point);
            farthest = std::max(farthest, (found.back() - point).norm());
        }
        if (farthest <= p.requirements.sigma3_mm) return std::nullopt;
        worst = std::max(worst, farthest);
    }
    if (taught.empty()) return std::nullopt;
    const auto points = static_cast<Eigen::Index>(taught.size());
    Eigen::Matrix3Xd from(3, points), to(3, points);
    for (Eigen::Index i = 0; i < points; ++i) {
        from.col(i) = taught[static_cast<std::size_t>(i)];
        to.col(i) = found[static_cast<std::size_t>(i)];
    }
    const Eigen::Matrix4d whole = Eigen::umeyama(from, to, false);
    const double most = std::max(p.requirements.sigma3_mm, kShareOfBend * worst);
    for (std::size_t i = 0; i < taught.size(); ++i)
        if (!(((whole * taught[i].homogeneous()).head<3>() - found[i]).norm() <= most)) return std::nullopt;
    return worst;
}

}  // namespace seamwright
