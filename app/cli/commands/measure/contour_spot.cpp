#include "app/cli/commands/measure/contour_spot.h"

#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "core/profile/units.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/tables/profile_csv.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

constexpr double kFarthest_mm = 1e6;  // as in a CSV: beyond is another unit

Expected<Profile> points_of(const json& rows, const std::string& where) {
    Profile profile;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const json& row = rows[i];
        const bool pair = row.is_array() && row.size() == 2 && row[0].is_number();
        if (!pair || !(row[1].is_number() || row[1].is_null()))
            return input_error("not a point", json_path(where, i),
                               "give [x, z] in mm; z is null where there is no return");
        const double x = row[0].get<double>(), z = row[1].is_null() ? std::nan("") : row[1].get<double>();
        if (!(std::abs(x) <= kFarthest_mm) || std::abs(z) > kFarthest_mm)
            return input_error("a coordinate lies more than a kilometre away", json_path(where, i),
                               "give millimetres");
        profile.x_mm.push_back(x);
        profile.z_mm.push_back(z);
    }
    return profile;
}

Expected<Profile> curve(const json& spot, const std::string& key, const std::string& path,
                        const std::filesystem::path& folder) {
    SEAM_TRY(const json* field, json_field(spot, key, path));
    const std::string where = json_path(path, key);
    Profile profile;
    if (field->is_string()) {
        const std::filesystem::path file = field->get<std::string>();
        SEAM_TRY(profile, read_profile_csv(file.is_absolute() ? file : folder / file));
    } else if (field->is_array()) {
        SEAM_TRY(profile, points_of(*field, where));
    } else {
        return input_error("not a curve", where,
                           "give [[x,z],..] in sensor order, or the name of a CSV file");
    }
    if (profile.size() == 0) return input_error("the curve has no points", where);
    SEAM_OK(check_profile_millimetres(profile, where));
    if (!profile.filtered()) SEAM_OK(filter_profile(profile, FilterOptions{}));
    return profile;
}

}  // namespace

Eigen::Vector2d middle_of(const Profile& profile) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double n = 0;
    for (std::size_t i = 0; i < profile.size(); ++i)
        if (profile.segment[i] != kOutlier) sum += Eigen::Vector2d(profile.x_mm[i], profile.z_mm[i]), ++n;
    return n > 0 ? Eigen::Vector2d(sum / n) : sum;
}

bool told_by_contours(const json& spot) {
    return spot.is_object() && (spot.contains("reference_curve") || spot.contains("curve"));
}

Expected<ContourSpot> find_contour(const json& spot, const std::string& path,
                                   const std::filesystem::path& folder, bool measured) {
    FeatureRecipe recipe;
    recipe.kind = "template";
    SEAM_TRY(recipe.template_profile, curve(spot, "reference_curve", path, folder));
    ContourSpot contour{middle_of(recipe.template_profile), {}};
    if (spot.contains("reference")) {
        SEAM_TRY(const auto reference, json_vector3(spot, "reference", path));
        if (reference.y() != 0)
            return input_error("the reference of a contour lies in its laser plane",
                               json_path(path, "reference"), "give [x, 0, z]");
        contour.reference_mm = {reference.x(), reference.z()};
    }
    recipe.template_reference_mm = contour.reference_mm;
    if (spot.contains("window")) {
        const std::string where = json_path(path, "window");
        SEAM_TRY(const auto window, as_numbers(spot["window"], 3, where));
        if (!(window[0] > 0 && window[1] > 0 && window[2] >= 0 && window[2] <= 180))
            return input_error("the window must be positive (mm, mm) and 0 to 180 degrees", where);
        recipe.parameters = {
            {"window_dx_mm", window[0]}, {"window_dz_mm", window[1]}, {"window_dphi_deg", window[2]}};
    }
    auto finder = make_feature_finder(recipe);
    if (!finder) {
        Error error = finder.error();
        error.within(json_path(path, "reference_curve"));
        return tl::unexpected(error);
    }
    if (!measured) {
        contour.found = (*finder)->find(recipe.template_profile);
        return contour;
    }
    SEAM_TRY(const auto scene, curve(spot, "curve", path, folder));
    contour.found = (*finder)->find(scene);
    return contour;
}

void take_contour(const ContourSpot& contour, const Eigen::Matrix2d& own, SpotObservation& spot) {
    const Feature& found = contour.found;
    spot.reference_mm = {contour.reference_mm.x(), 0, contour.reference_mm.y()};
    spot.measured_mm = {found.point_mm.x(), 0, found.point_mm.y()};
    const Eigen::Matrix2d covariance =
        found.covariance_mm2 + own + kSurestContour_mm * kSurestContour_mm * Eigen::Matrix2d::Identity();
    spot.sigma_mm = std::sqrt(0.5 * covariance.trace());
    // As in a run (projects/measure): where x and z weigh differently their correlation says nothing.
    spot.covariance_mm2.reset();
    if (spot.weights.x() == spot.weights.z()) spot.covariance_mm2 = covariance;
}

}  // namespace seamwright::cli
