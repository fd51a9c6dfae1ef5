#include "projects/evaluate/cell.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/alignment/alignment.h"
#include "core/correction/travel.h"
#include "core/evaluation/statistics.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/profile_cut.h"
#include "devices/simulated/scene/swept_rim.h"

namespace seamwright::evaluation {
namespace {

constexpr int kRepeats = 100;          // measures that make the reference
constexpr int kTemplateProfiles = 10;  // averaged to a template
constexpr double kPassMm = 20, kPassStepMm = 0.5;
constexpr double kTemplateBeyondMm = 1, kTemplateReachMm = 40;  // outboard and inboard of the landmark

void finish_cell(Cell& cell) {
    const EvaluationSettings& s = cell.settings;
    cell.stated_jitter_mm = s.jitter_mm;
    cell.sensor_from_believed.assign(cell.spots.size(), Pose::Identity());
    if (s.calibration_mm == 0 && s.calibration_deg == 0) return;
    for (std::size_t n = 0; n < cell.spots.size(); ++n) {
        Random random(hash64(s.seed, 31), n);
        const Eigen::Vector3d move = s.calibration_mm * random.normal3();
        const Eigen::Vector3d turn = rad_from_deg(s.calibration_deg) * random.normal3();
        cell.sensor_from_believed[n] = make_pose(rotation_exp(turn), move);
    }
}

Cell swept_cell(const EvaluationSettings& settings, std::vector<CellSpot> spots,
                const std::vector<double>& radii, std::atomic<std::size_t>& profiles) {
    Cell cell;
    cell.settings = settings;
    cell.profiles = &profiles;
    cell.spots = std::move(spots);
    std::vector<RimPiece> pieces;
    for (std::size_t n = 0; n < cell.spots.size(); ++n)
        pieces.push_back({cell.spots[n].workobject_from_sensor, radii[n], 60});
    cell.taught = cell.measured = std::make_shared<MeshTree>(swept_rim_mesh(pieces));
    finish_cell(cell);
    return cell;
}

std::vector<CellSpot> door_spots() {
    std::vector<CellSpot> spots;
    for (const DoorSpot& door : default_door_spots()) spots.push_back({door.id, door.workobject_from_sensor});
    return spots;
}

// As the robot carries it: the taught pose, turned when misaligned.
Pose taught_pose(const Cell& cell, const Method& method, std::size_t n) {
    Pose pose = cell.spots[n].workobject_from_sensor;
    if (method.misaligned)
        pose.linear() *= rotation_exp({0, 0, rad_from_deg(cell.settings.misalignment_deg)});
    return pose;
}

// The sensor where the robot, its trigger and the calibration really put it.
Pose arrived(const Cell& cell, const Pose& taught, std::size_t n, bool in_motion, Random& random) {
    Pose at = taught;
    at.translation() += cell.settings.repeatability_mm * random.normal3();
    if (in_motion)
        at.translation() +=
            random.uniform(-cell.settings.jitter_mm, cell.settings.jitter_mm) * taught.linear().col(1);
    return at * cell.sensor_from_believed[n].inverse();
}

void take_profile(const Cell& cell, const MeshTree& part, const Pose& part_from_sensor, bool matched,
                  Random& random, Profile& profile) {
    cut_profile(part, part_from_sensor, cell.optics, profile);
    ++*cell.profiles;
    add_noise(profile, cell.settings.noise_mm, random);
    make_ready(profile, matched);
}

// Column by column, where all profiles have a point that the filter accepts.
Profile averaged(const std::vector<Profile>& profiles) {
    Profile mean = profiles.front();
    for (std::size_t i = 0; i < mean.size(); ++i) {
        bool all = true;
        double x = 0, z = 0;
        for (const Profile& p : profiles) {
            all = all && p.segment[i] != kOutlier;
            x += p.x_mm[i] / static_cast<double>(profiles.size());
            z += p.z_mm[i] / static_cast<double>(profiles.size());
        }
        mean.x_mm[i] = all ? x : std::nan("");
        mean.z_mm[i] = all ? z : std::nan("");
    }
    (void)filter_profile(mean, {});  // refuses only arrays of different length
    return mean;
}

FeatureRecipe contour_end() {
    FeatureRecipe recipe;
    recipe.kind = "contour-end";
    recipe.parameters = {{"side", 0.0}};
    return recipe;
}

Expected<FeatureRecipe> template_recipe(const Cell& cell, const Pose& pose, std::size_t n, Random& random) {
    SEAM_TRY(auto end, make_feature_finder(contour_end()));
    std::vector<Profile> profiles(kTemplateProfiles);
    for (Profile& p : profiles)
        take_profile(cell, *cell.taught, arrived(cell, pose, n, false, random), true, random, p);
    const Profile profile = averaged(profiles);
    const Feature edge = end->find(profile);
    if (edge.status != FeatureStatus::ok)
        return input_error(Text("the contour's end is not found when teaching: {}", edge.message),
                           Text("spot {}", cell.spots[n].id), "evaluate with less noise");
    FeatureRecipe recipe;
    recipe.kind = "template";
    recipe.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
    recipe.template_reference_mm = edge.point_mm;
    Profile& piece = recipe.template_profile;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const double along = profile.x_mm[i] - edge.point_mm.x();
        if (profile.segment[i] == kOutlier || along < -kTemplateBeyondMm || along > kTemplateReachMm)
            continue;
        piece.x_mm.push_back(profile.x_mm[i]);
        piece.z_mm.push_back(profile.z_mm[i]);
        piece.segment.push_back(profile.segment[i]);
    }
    return recipe;
}

Expected<TaughtSpot> teach(const Cell& cell, const Method& method, std::size_t n) {
    Random random(hash64(cell.settings.seed, 1000 * static_cast<std::uint64_t>(method.number) + n));
    TaughtSpot spot;
    spot.observation.id = cell.spots[n].id;
    const Pose pose = taught_pose(cell, method, n);
    spot.observation.workobject_from_sensor = pose;
    cut_profile(*cell.taught, pose * cell.sensor_from_believed[n].inverse(), cell.optics, spot.clean);
    spot.recipe = contour_end();
    if (method.matched) {
        SEAM_TRY(auto recipe, template_recipe(cell, pose, n, random));
        spot.recipe = std::move(recipe);
    }
    SEAM_TRY(auto finder, make_feature_finder(spot.recipe));
    std::vector<double> x, z;
    Eigen::Matrix2d stated = Eigen::Matrix2d::Zero();
    Profile profile;
    for (int k = 0; k < kRepeats; ++k) {
        take_profile(cell, *cell.taught, arrived(cell, pose, n, false, random), method.matched, random,
                     profile);
        const Feature f = finder->find(profile);
        if (f.status != FeatureStatus::ok) continue;
        x.push_back(f.point_mm.x());
        z.push_back(f.point_mm.y());
        stated += f.covariance_mm2;
    }
    const Summary in_x = summarise(x), in_z = summarise(z);
    if (in_x.count < kRepeats / 2)
        return input_error("the feature is not found when teaching", Text("spot {}", cell.spots[n].id),
                           "evaluate with less noise");
    spot.observation.reference_mm = {in_x.mean, 0, in_z.mean};
    const double count = static_cast<double>(in_x.count);
    const double robot = cell.settings.repeatability_mm * cell.settings.repeatability_mm;
    spot.covariance_mm2 = (1 + 1 / count) * (stated / count + (robot + 1e-12) * Eigen::Matrix2d::Identity());
    // Both coordinates share one sigma; the reference's own share is added.
    spot.observation.sigma_mm =
        std::max(1e-4, std::sqrt(0.5 * (in_x.variance + in_z.variance) * (1 + 1 / count)));
    spot.landmark = pose * spot.observation.reference_mm;

    std::vector<TravelProfile> pass;
    std::vector<TravelPoint> points;
    for (double y = -kPassMm; y <= kPassMm; y += kPassStepMm) {
        Pose at = pose;
        at.translation() += y * pose.linear().col(1);
        take_profile(cell, *cell.taught, arrived(cell, at, n, false, random), method.matched, random,
                     profile);
        const Feature f = finder->find(profile);
        if (f.status == FeatureStatus::ok) points.push_back({y, f.point_mm.x(), f.point_mm.y()});
        if (!method.matched) make_ready(profile, true);
        pass.push_back({y, profile});
    }
    AlignmentOptions alignment;
    alignment.jitter_mm = std::max(0.1, cell.settings.jitter_mm);
    SEAM_TRY(auto frozen, check_alignment(pass, alignment));
    spot.flagged = frozen.status == AlignmentStatus::drifting;
    spot.yaw_deg = frozen.yaw_deg;
    if (method.matched) {
        SEAM_TRY(auto curve, fit_contour_curve(points));
        spot.observation.curve = curve;
    }
    return spot;
}

}  // namespace

Cell door_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles) {
    Cell cell;
    cell.settings = settings;
    cell.profiles = &profiles;
    cell.spots = door_spots();
    TriangleMesh mesh = door_mesh();
    cell.taught = cell.measured = std::make_shared<MeshTree>(mesh);
    if (settings.bend_mm != 0) {
        const Eigen::AlignedBox3d box = mesh.box();
        for (Eigen::Vector3d& v : mesh.vertices) v.z() += bend_at({settings.bend_mm, 0}, box, v);
        cell.measured = std::make_shared<MeshTree>(std::move(mesh));
    }
    finish_cell(cell);
    return cell;
}

Cell straight_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles) {
    const std::vector<CellSpot> spots = door_spots();
    return swept_cell(settings, spots,
                      std::vector<double>(spots.size(), std::numeric_limits<double>::infinity()), profiles);
}

Cell curved_cell(const EvaluationSettings& settings, double radius_mm, std::atomic<std::size_t>& profiles) {
    struct Side {
        const char* letter;
        Eigen::Vector3d inboard;
        double bend;  // sense
    };
    const Side sides[] = {
        {"T", {0, -1, 0}, 1}, {"L", {-1, 0, 0}, 1}, {"B", {0, 1, 0}, -1}, {"H", {1, 0, 0}, -1}};
    const Eigen::Vector3d middle(500, 375, 0), half(450, 350, 0);
    std::vector<CellSpot> spots;
    std::vector<double> radii;
    for (const Side& side : sides) {
        for (int i = -1; i <= 1; ++i) {
            Eigen::Matrix3d axes;
            axes.col(0) = side.inboard;
            axes.col(2) = Eigen::Vector3d::UnitZ();
            axes.col(1) = axes.col(2).cross(axes.col(0));
            spots.push_back(
                {side.letter + std::to_string(i + 2),
                 make_pose(axes, middle - side.inboard.cwiseProduct(half) + 230.0 * i * axes.col(1))});
            radii.push_back(side.bend * radius_mm);
        }
    }
    return swept_cell(settings, std::move(spots), radii, profiles);
}

Expected<std::vector<TaughtSpot>> teach_all(const Cell& cell, const Method& method) {
    std::vector<TaughtSpot> spots(cell.spots.size());
    std::vector<std::optional<Error>> errors(spots.size());
    spread_out(cell.settings.jobs, spots.size(), [&] {
        return [&](std::size_t n) {
            if (auto spot = teach(cell, method, n))
                spots[n] = std::move(*spot);
            else
                errors[n] = spot.error();
        };
    });
    for (const auto& e : errors)
        if (e) return tl::unexpected(*e);
    return spots;
}

Finders make_finders(const std::vector<TaughtSpot>& spots) {
    Finders finders;
    for (const TaughtSpot& s : spots) finders.push_back(std::move(*make_feature_finder(s.recipe)));
    return finders;
}

void make_ready(Profile& profile, bool matched) {
    if (matched) {
        (void)filter_profile(profile, {});  // refuses only arrays of different length
        return;
    }
    profile.segment.assign(profile.size(), 0);
    for (std::size_t i = 0; i < profile.size(); ++i)
        if (!std::isfinite(profile.z_mm[i])) profile.segment[i] = kOutlier;
}

SpotObservation observation_of(const Method& method, const TaughtSpot& spot, const Feature& feature) {
    SpotObservation o = spot.observation;
    o.measured_mm = {feature.point_mm.x(), 0, feature.point_mm.y()};
    if (method.matched) o.covariance_mm2 = spot.covariance_mm2;
    return o;
}

std::optional<SpotObservation> measure_spot(const Cell& cell, const Method& method, const TaughtSpot& spot,
                                            std::size_t n, const FeatureFinder& finder, const Pose& truth,
                                            Random& random, Profile& profile) {
    const Pose at = arrived(cell, spot.observation.workobject_from_sensor, n, method.in_motion, random);
    take_profile(cell, *cell.measured, truth.inverse() * at, method.matched, random, profile);
    const Feature f = finder.find(profile);
    if (f.status != FeatureStatus::ok) return std::nullopt;
    return observation_of(method, spot, f);
}

std::optional<RegionCorrection> correct(const Cell& cell, const Method& method,
                                        std::vector<SpotObservation> observed) {
    if (observed.empty()) return std::nullopt;
    if (method.matched && method.in_motion && cell.stated_jitter_mm > 0) {
        CorrectionOptions all;  // which spot is wrong is judged when the jitter's share is known
        all.reject_outliers = false;
        const auto first = solve_region(observed, all);
        if (!first || first->status != CorrectionStatus::ok) return std::nullopt;
        for (SpotObservation& o : observed)
            *o.covariance_mm2 +=
                travel_covariance(o, first->displacement, cell.stated_jitter_mm / std::sqrt(3.0));
    }
    const auto solved = solve_region(observed, {});
    if (!solved || solved->status != CorrectionStatus::ok) return std::nullopt;
    return *solved;
}

void spread_out(int jobs, std::size_t count,
                const std::function<std::function<void(std::size_t)>()>& worker) {
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        const auto work = worker();
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> threads;
    for (int t = 1; t < jobs; ++t) threads.emplace_back(run);
    run();
}

}  // namespace seamwright::evaluation
