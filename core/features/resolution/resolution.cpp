#include "core/features/resolution/resolution.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/features/contour/contour_noise.h"
#include "core/features/contour/reduce_contour.h"
#include "core/features/kinds/feature_registry.h"
#include "core/median.h"

namespace seamwright {
namespace {

constexpr int kFewestPoints = 10;
constexpr std::size_t kFewestNeighbours = 20;
constexpr double kMostMissing = 0.3;
constexpr double kPointsAPiece = 3;
constexpr double kShortPieces = 0.1;  // share of the contour's length
constexpr double kHeightInNoise = 6;
constexpr double kNoStep_mm = 1e-7;           // differences below are none
constexpr double kMiss = 0.1;                 // of a step: no whole multiple
constexpr double kMostMisses = 0.05;          // of the differences
constexpr double kLeastTolerance_mm = 0.02;   // of a straight piece
constexpr double kLeastHas = 1e-9;            // of what is divided by
const double kUniform = 1 / std::sqrt(12.0);  // sigma of what lies anywhere within a step of 1

// The step that nearly all differences are whole multiples of; 0: there is none.
double depth_step(std::vector<double> differences) {
    std::erase_if(differences, [](double d) { return d < kNoStep_mm; });
    if (differences.size() < kFewestNeighbours) return 0;
    std::sort(differences.begin(), differences.end());
    // The smallest ones are one step, unless there is none: then they are anything.
    const double step = differences[differences.size() / 50];
    double misses = 0;
    for (const double d : differences) {
        const double steps = d / step;
        if (steps > 20) break;  // far apart they tell nothing about the step
        misses += std::abs(steps - std::round(steps)) > kMiss;
    }
    return misses < kMostMisses * static_cast<double>(differences.size()) ? step : 0;
}

struct Piece {
    double length_mm = 0, height_mm = 0;
};
// Of the contour that the feature is looked for in: the length that its straight pieces have over nine tenths of it (at a
// kink, a jump or a point of noise two neighbours are a piece), and how much it stands up.
Piece pieces_of(const std::vector<double>& x, const std::vector<double>& z, double noise_mm) {
    std::vector<int> kept;
    reduce_contour(x, z, std::max(4 * noise_mm, kLeastTolerance_mm), kept);
    Piece piece;
    std::vector<double> lengths;
    double whole = 0, below = 0;
    for (std::size_t i = 1; i < kept.size(); ++i) {
        const auto a = static_cast<std::size_t>(kept[i - 1]), b = static_cast<std::size_t>(kept[i]);
        lengths.push_back(std::hypot(x[b] - x[a], z[b] - z[a]));
        whole += lengths.back();
    }
    std::sort(lengths.begin(), lengths.end());
    for (const double length : lengths) {
        piece.length_mm = length;
        below += length;
        if (below > kShortPieces * whole) break;
    }
    const auto [low, high] = std::minmax_element(z.begin(), z.end());
    piece.height_mm = *high - *low;
    return piece;
}

double worst(const Eigen::Matrix2d& c) {
    const double mean = 0.5 * (c(0, 0) + c(1, 1)), half = 0.5 * (c(0, 0) - c(1, 1));
    return std::sqrt(std::max(0.0, mean + std::hypot(half, c(0, 1))));
}

// The pitch decides where an end lies; for a fitted point it is in the finder's own covariance.
bool ends_within_a_pitch(const FeatureRecipe& recipe) {
    return recipe.kind == "contour-end";
}

Text what_of(const ResolutionItem& item) {
    if (item.name == "pitch")
        return Text("its points lie {:.3f} mm apart, {:.3f} mm are needed", item.has, item.needs);
    if (item.name == "depth_step")
        return Text("its depth comes in steps of {:.4f} mm, {:.4f} mm are needed", item.has, item.needs);
    if (item.name == "points")
        return Text("the feature rests on {:.0f} points, {:.0f} are needed", item.has, item.needs);
    if (item.name == "height")
        return Text("the contour is {:.3f} mm high, {:.3f} mm stand out of the noise", item.has, item.needs);
    if (item.name == "missing")
        return Text("{:.0f} % of the lines have no point, {:.0f} % may be missing", 100 * item.has,
                    100 * item.needs);
    return Text("the reference point's sigma is {:.4f} mm, {:.4f} mm are allowed", item.has, item.needs);
}

}  // namespace

std::string_view name_of(ResolutionVerdict verdict) {
    constexpr std::array<std::string_view, 4> words{"resolves", "marginal", "does_not_resolve", "not_found"};
    return words.at(static_cast<std::size_t>(verdict));
}

Expected<SensorNumbers> sensor_numbers(const Profile& profile) {
    std::vector<double> spacing, step, x, z, scratch;
    std::size_t returns = 0, first = 0, last = 0;
    const std::size_t n = profile.size();
    const auto seen = [&](std::size_t i) { return profile.segment[i] != kOutlier; };
    for (std::size_t i = 0; i < n; ++i) {
        if (std::isfinite(profile.z_mm[i])) {
            if (returns++ == 0) first = i;
            last = i;
        }
        if (!seen(i)) continue;
        x.push_back(profile.x_mm[i]);
        z.push_back(profile.z_mm[i]);
        if (i == 0 || !seen(i - 1) || profile.segment[i] != profile.segment[i - 1]) continue;
        const double dx = profile.x_mm[i] - profile.x_mm[i - 1], dz = profile.z_mm[i] - profile.z_mm[i - 1];
        spacing.push_back(std::hypot(dx, dz));
        step.push_back(std::abs(dz));
    }
    if (spacing.size() < kFewestNeighbours)
        return input_error(Text("{} points lie on one contour", spacing.size()), "profile",
                           "give a profile of the contour, or of a flat sheet at its distance");
    SensorNumbers numbers;
    // On a grid that was interpolated from coarser points neither lies as close nor as still as it seems.
    const ContourNoise noise = contour_noise(x, z, scratch);
    numbers.pitch_mm = median(spacing) * std::max(1.0, noise.measured_apart);
    numbers.noise_mm = noise.point_mm;
    numbers.depth_step_mm = depth_step(std::move(step));
    // Beside the part there is nothing to return.
    numbers.missing_share = 1 - static_cast<double>(returns) / static_cast<double>(last - first + 1);
    return numbers;
}

std::optional<SensorNumbers> sensor_numbers(const SensorModel& model, const Eigen::Vector2d& at_mm,
                                            double peak_noise_px) {
    const auto pixel = model.to_pixel(at_mm);
    if (!pixel || pixel->x() < 1 || pixel->y() < 1 || pixel->x() > model.camera.width - 2 ||
        pixel->y() > model.camera.height - 2)
        return std::nullopt;
    const auto across = model.to_laser(*pixel + Eigen::Vector2d(1, 0));
    const auto deeper = model.to_laser(*pixel + Eigen::Vector2d(0, 1));
    if (!across || !deeper) return std::nullopt;
    // Lines are columns where the stripe runs along x, rows where the camera is turned.
    const double a = (*across - at_mm).norm(), d = (*deeper - at_mm).norm();
    const bool columns = std::abs((*across - at_mm).x()) >= std::abs((*deeper - at_mm).x());
    SensorNumbers numbers;
    numbers.pitch_mm = columns ? a : d;
    numbers.noise_mm = peak_noise_px * (columns ? d : a);
    return numbers;
}

Expected<ResolutionCheck> check_resolution(const Profile& profile, const FeatureRecipe& recipe,
                                           double sigma_mm, const std::optional<SensorNumbers>& numbers) {
    if (!(sigma_mm > 0) || !std::isfinite(sigma_mm))
        return input_error("the sigma that is needed is not a positive number", "sigma_mm");
    SEAM_TRY(const auto finder, make_feature_finder(recipe));
    ResolutionCheck check;
    if (numbers) {
        check.sensor = *numbers;
    } else {
        SEAM_TRY(const auto seen, sensor_numbers(profile));
        check.sensor = seen;
    }
    const SensorNumbers& s = check.sensor;
    check.feature = finder->find(profile);
    if (check.feature.status != FeatureStatus::ok) {
        check.reason = Text("the feature is not found in the profile: {}", check.feature.message);
        check.cure = "bring the contour into view, or choose another feature";
        return check;
    }
    std::vector<double> x, z;
    const Profile& contour = recipe.kind == "template" ? recipe.template_profile : profile;
    for (std::size_t i = 0; i < contour.size(); ++i)
        if (std::isfinite(contour.z_mm[i]) &&
            (contour.segment.size() != contour.size() || contour.segment[i] != kOutlier)) {
            x.push_back(contour.x_mm[i]);
            z.push_back(contour.z_mm[i]);
        }
    const Piece piece = pieces_of(x, z, s.noise_mm);
    const bool end = ends_within_a_pitch(recipe), taught = recipe.kind == "template";
    const bool shape = taught || recipe.kind == "corner";
    const double pitch_share = end ? s.pitch_mm * kUniform : 0;
    check.sigma_mm = std::sqrt(std::pow(worst(check.feature.covariance_mm2), 2) + pitch_share * pitch_share +
                               std::pow(s.depth_step_mm * kUniform, 2));
    const double pitch_needed = end      ? sigma_mm / kUniform
                                : taught ? piece.length_mm / kPointsAPiece
                                         : std::numeric_limits<double>::infinity();
    if (std::isfinite(pitch_needed)) check.items.push_back({"pitch", s.pitch_mm, pitch_needed, false, "mm"});
    check.items.push_back(
        {"points", static_cast<double>(check.feature.points_used), kFewestPoints, true, ""});
    check.items.push_back({"depth_step", s.depth_step_mm, 0.5 * sigma_mm / kUniform, false, "mm"});
    if (shape) check.items.push_back({"height", piece.height_mm, kHeightInNoise * s.noise_mm, true, "mm"});
    check.items.push_back({"missing", s.missing_share, kMostMissing, false, ""});
    check.items.push_back({"sigma", check.sigma_mm, sigma_mm, false, "mm"});

    const auto bad = std::find_if(check.items.begin(), check.items.end(),
                                  [](const ResolutionItem& item) { return !item.ok(); });
    const auto near = std::find_if(check.items.begin(), check.items.end(), [](const ResolutionItem& item) {
        return item.name != "missing" && item.close();
    });
    const auto& shown = bad != check.items.end() ? bad : near;
    check.verdict = bad != check.items.end()    ? ResolutionVerdict::does_not_resolve
                    : near != check.items.end() ? ResolutionVerdict::marginal
                                                : ResolutionVerdict::resolves;
    if (shown == check.items.end()) {
        check.reason = Text("the reference point's sigma will be {:.4f} mm, {:.4f} mm are allowed",
                            check.sigma_mm, sigma_mm);
        return check;
    }
    check.reason = what_of(*shown);
    if (shown->name == "missing") {
        check.cure = "find the light for this contour, or look at it from another side";
    } else if (shown->name == "depth_step") {
        check.cure = "choose a finer depth in the sensor's settings, or a sensor of a smaller range";
    } else if (shown->name == "pitch" || shown->name == "points") {
        check.reach =
            shown->at_least ? shown->needs / std::max(shown->has, kLeastHas) : shown->has / shown->needs;
        check.cure =
            Text("let the sensor stand {:.1f} times nearer, or use one of a narrower field", check.reach);
    } else {
        check.cure = "let the sensor stand nearer, or choose a feature that rests on more points";
    }
    return check;
}

}  // namespace seamwright
