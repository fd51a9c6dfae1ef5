#include "projects/calibrate/input/entry.h"

#include "core/geometry/pose.h"
#include "devices/exchange/json_fields.h"

namespace seamwright {

using nlohmann::json;

Expected<std::string> entry_id(const json& entry, std::size_t index, const std::string& where) {
    if (!entry.is_object()) return input_error("this is not an object", where);
    const auto it = entry.find("id");
    if (it == entry.end()) return std::to_string(index);
    if (it->is_string()) return it->get<std::string>();
    if (it->is_number()) return it->dump();
    return input_error("the id is neither text nor number", json_path(where, "id"));
}

Expected<std::pair<int, int>> image_size_of(const json& data, const std::string& where) {
    SEAM_TRY(auto field, json_field(data, "size", where));
    const std::string at = json_path(where, "size");
    SEAM_TRY(auto size, as_numbers(*field, 2, at));
    constexpr double kLargest = 1e5;
    for (const double side : size)
        if (!(side >= 1 && side <= kLargest))
            return input_error("this is no image size", at, "give [width, height] in pixels");
    return std::pair(static_cast<int>(size[0]), static_cast<int>(size[1]));
}

namespace {

constexpr double kLeastSigma = 1e-9;  // beneath, its inverse square is beyond what the solvers carry

Expected<double> within(double sigma, bool exact, const std::string& key, const std::string& where) {
    const double most = key.ends_with("_deg") ? kLargestSigma_deg : kLargestSigma;
    if (sigma <= most && (sigma >= kLeastSigma || (exact && sigma == 0))) return sigma;
    const std::string at = json_path(where, key);
    return exact ? input_error(Text("the sigma is negative or above {:.0f}", most), at,
                               "give one standard deviation, 0 for exact")
                 : input_error(Text("the sigma is not above 0 and up to {:.0f}", most), at,
                               "give one standard deviation, or leave the field out");
}

}  // namespace

Expected<double> json_sigma(const json& entry, const std::string& key, const std::string& where) {
    SEAM_TRY(const double sigma, json_number(entry, key, where));
    return within(sigma, false, key, where);
}

Expected<double> json_sigma_or_exact(const json& entry, const std::string& key, double otherwise,
                                     const std::string& where) {
    SEAM_TRY(const double sigma, json_number_or(entry, key, otherwise, where));
    return within(sigma, true, key, where);
}

Expected<void> check_variances(const Eigen::VectorXd& variances, const std::string& where) {
    for (Eigen::Index i = 0; i < variances.size(); ++i) {
        const double most = i < 3 ? kLargestSigma : rad_from_deg(kLargestSigma_deg);
        if (!(variances[i] <= most * most))
            return input_error("a variance is above that of 1000 mm or 180 degrees", where,
                               "give mm^2 and rad^2");
    }
    return {};
}

Expected<RobotRepeatability> repeatability_of(const json& data) {
    const auto robot = data.find("robot");
    if (robot == data.end() || robot->is_null()) return RobotRepeatability{};
    SEAM_TRY(const double mm, json_number(*robot, "sigma_mm", "robot"));
    SEAM_TRY(const double deg, json_number_or(*robot, "sigma_deg", 0.0, "robot"));
    const RobotRepeatability stated{mm, rad_from_deg(deg)};
    SEAM_OK(check_repeatability(stated));
    return stated;
}

}  // namespace seamwright
