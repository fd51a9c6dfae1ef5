#include "core/calibration/pose/plate.h"

#include <algorithm>
#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

Expected<CalibrateOutcome> calibrate_plate_json(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate plate --help");
    PlateOptions options;
    options.exclude = exclude;
    if (data.contains("sigma_mm") && !data["sigma_mm"].is_null()) {
        auto sigma = json_number(data, "sigma_mm", "");
        if (!sigma) return tl::unexpected(sigma.error());
        options.sigma_mm = *sigma;
    }
    auto list = json_array(data, "points", "");
    if (!list) return tl::unexpected(list.error());
    std::vector<PlatePoint> points;
    // Of a stand with several points. Stands see the same points of the plate again: each is solved with as
    // the mean over the stands that take part.
    struct Stand {
        std::string id;
        std::vector<PlatePoint> points;
        bool used = true;
    };
    std::vector<Stand> stands;
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const json& entry = (**list)[i];
        const std::string where = json_path("points", i);
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        const auto point = [](const json& from, const std::string& name,
                              const std::string& at) -> Expected<PlatePoint> {
            auto plate = json_vector3(from, "plate", at);
            if (!plate) return tl::unexpected(plate.error());
            auto world = json_vector3(from, "world", at);
            if (!world) return tl::unexpected(world.error());
            return PlatePoint{name, *plate, *world};
        };
        if (!entry.contains("points")) {
            auto one = point(entry, *id, where);
            if (!one) return tl::unexpected(one.error());
            points.push_back(std::move(*one));
            continue;
        }
        auto inner = json_array(entry, "points", where);
        if (!inner) return tl::unexpected(inner.error());
        if ((*inner)->empty()) return input_error("there is no point", json_path(where, "points"));
        Stand stand;
        stand.id = *id;
        stand.used = std::erase(options.exclude, *id) == 0;
        for (std::size_t k = 0; k < (*inner)->size(); ++k) {
            auto one = point((**inner)[k], std::to_string(k + 1), json_path(json_path(where, "points"), k));
            if (!one) return tl::unexpected(one.error());
            stand.points.push_back(std::move(*one));
        }
        stands.push_back(std::move(stand));
    }
    std::vector<std::pair<PlatePoint, int>> means;
    for (const Stand& stand : stands) {
        if (!stand.used) continue;
        for (const PlatePoint& p : stand.points) {
            auto same = std::find_if(means.begin(), means.end(),
                                     [&](const auto& m) { return m.first.plate.isApprox(p.plate, 1e-9); });
            if (same == means.end()) {
                means.emplace_back(p, 1);
                means.back().first.id = "corner " + std::to_string(means.size());
            } else {
                same->first.world = (same->first.world * same->second + p.world) / (same->second + 1);
                ++same->second;
            }
        }
    }
    const std::size_t single = points.size();
    for (auto& m : means) points.push_back(std::move(m.first));
    auto solved = calibrate_plate(points, options);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool ok = solved->status == PlateStatus::ok;
    result["method"] = "plate";
    result["status"] = std::string(name_of(solved->status));
    result["world_from_plate"] = ok ? pose_json(solved->world_from_plate) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved->rms_mm) : json(nullptr);
    result["sigma"] = ok ? pose_sigma_json(solved->world_from_plate, solved->covariance) : json(nullptr);
    if (ok) {
        result["covariance_pose"] = matrix_json(solved->covariance);
        result["point_sigma_mm"] = number_json(solved->sigma_mm);
        result["scale"] = number_json(solved->scale);
        result["mirrored"] = solved->mirrored;
    }
    put_texts(result, "notices", solved->notices);
    CalibrationReport report = solved->report;
    if (!stands.empty()) {  // people left stands out, not means
        report.poses.resize(single);
        for (const Stand& stand : stands) {
            PoseResidual row;
            row.id = stand.id;
            row.used = stand.used;
            if (!stand.used) row.note = "excluded";
            double squares = 0;
            for (const PlatePoint& p : stand.points)
                squares += (p.world - solved->world_from_plate * p.plate).squaredNorm();
            if (ok) row.rms_mm = std::sqrt(squares / static_cast<double>(stand.points.size()));
            report.poses.push_back(std::move(row));
        }
    }
    add_report(report, result);
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
