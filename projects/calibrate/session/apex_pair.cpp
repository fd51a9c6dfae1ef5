#include "projects/calibrate/session/apex_pair.h"

#include <fmt/format.h>

#include <cmath>

#include "core/features/contour/apex.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/stripe_line_points.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr double kTurnedDeg = 0.05, kAsideMm = 1;

json pair_json(const Eigen::Vector2d& p) {
    return {p.x(), p.y()};
}

Error no_apex(const SensorSetup& sensor) {
    return {ErrorKind::input, "no apex of a triangular body is seen", Text("sensor {}", sensor.id),
            "bring the stripe across the body, both flanks in the picture, less gloss"};
}

Expected<Eigen::Vector2d> by_travel(json& settings, const SensorSetup& sensor, const Calibration* base,
                                    const Eigen::Vector2d& pixel,
                                    const std::optional<Pose>& base_from_flange) {
    const Text where("sensor {}", sensor.id);
    if (!base_from_flange)
        return input_error("how far the body has moved is not known", where,
                           "connect the robot that shifts the sensor, or load measured pairs");
    if (!base || base->flange_from_sensor.isApprox(Pose::Identity()))
        return input_error("where the sensor sits on the flange is not known", where,
                           "calibrate the sensor on the flange first, or load measured pairs");
    const Pose& x = base->flange_from_sensor;
    const auto anchor = settings.find("anchor");
    if (anchor == settings.end()) {
        Eigen::Vector2d start = Eigen::Vector2d::Zero();
        if (base->model)
            if (const auto known = base->model->to_laser(pixel)) start = *known;
        settings["anchor"] = {{"base_from_flange", pose_json(*base_from_flange)},
                              {"laser", pair_json(start)}};
        return start;
    }
    SEAM_TRY(auto field, json_field(*anchor, "base_from_flange", "anchor"));
    SEAM_TRY(auto from, parse_pose(*field, "anchor.base_from_flange"));
    SEAM_TRY(auto start, json_vector2(*anchor, "laser", "anchor"));
    const Pose moved = (from * x).inverse() * (*base_from_flange * x);
    const double turned_deg = deg_from_rad(rotation_log(moved.linear()).norm());
    if (turned_deg > kTurnedDeg)
        return input_error(
            Text("the sensor was turned by {:.2f} degrees since the first capture", turned_deg), where,
            "only shift it, along its own X and Z");
    if (std::abs(moved.translation().y()) > kAsideMm)
        return input_error(Text("the sensor was shifted by {:.1f} mm along its Y", moved.translation().y()),
                           where, "only shift it along its own X and Z");
    return Eigen::Vector2d(start - Eigen::Vector2d(moved.translation().x(), moved.translation().z()));
}

}  // namespace

Expected<json> apex_pair(json& settings, const SensorSetup& sensor, const Calibration* base,
                         const Frame& frame, const std::optional<Pose>& base_from_flange) {
    StripePeaks peaks;
    SEAM_TRY(auto points, stripe_points(frame.image, peaks));
    const auto seen = find_apex(points);
    if (!seen) return tl::unexpected(no_apex(sensor));
    Eigen::Vector2d laser;
    if (frame.profile.size() > 0) {
        std::vector<Eigen::Vector2d> mm;
        for (std::size_t i = 0; i < frame.profile.size(); ++i)
            if (std::isfinite(frame.profile.z_mm[i]))
                mm.emplace_back(frame.profile.x_mm[i], frame.profile.z_mm[i]);
        const auto measured = find_apex(mm);
        if (!measured) return tl::unexpected(no_apex(sensor));
        laser = measured->point;
    } else {
        SEAM_TRY(auto travelled, by_travel(settings, sensor, base, seen->point, base_from_flange));
        laser = travelled;
    }
    return json{{"pixel", pair_json(seen->point)},
                {"laser", pair_json(laser)},
                {"flanks", {pair_json(seen->left), pair_json(seen->point), pair_json(seen->right)}}};
}

}  // namespace seamwright
