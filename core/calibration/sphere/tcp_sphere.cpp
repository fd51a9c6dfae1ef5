#include "core/calibration/sphere/tcp_sphere.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/sphere/sphere_scale.h"
#include "core/calibration/sphere/tcp_sphere_advice.h"
#include "core/calibration/sphere/tcp_sphere_judge.h"
#include "core/calibration/sphere/tcp_sphere_settle.h"
#include "core/calibration/sphere/tcp_sphere_solve.h"
#include "core/calibration/sphere/tcp_sphere_start.h"
#include "core/calibration/statistics.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace tcp_sphere;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNoiseFloor_mm =
    0.02;  // no sensor on a robot is better; keeps noise-free data from looking sure
constexpr double kUndeterminedSigma_mm = 2.0;  // a direction weaker than this is not determined
constexpr double kStatedTold = 0.99;  // of chi squared: the poses err by more than is stated of the robot
constexpr double kLooksLikeMetres_mm = 0.5;  // extent of all profiles in x, and a radius, below
// Another radius is told where it leaves this share of the disagreement and differs by so much; else where it differs by
// so many sigmas, and by more of itself than a sensor's own millimetres are wrong.
constexpr double kMuchBetter = 0.2, kOtherRadius_mm = 0.05;
constexpr double kRadiusSigmas = 4, kScaleOfSensors = 0.003;
// Of a profile's steps in x, and of the profiles: so many one way make an order.
constexpr double kOneWay = 0.8;
constexpr double kBulges = 0.15;  // mean_side of a cap that is seen from one side

Expected<void> check_input(const std::vector<SphereObservation>& observations,
                           const TcpSphereOptions& options) {
    std::vector<std::string> ids;
    std::vector<Pose> poses;
    for (const auto& observation : observations) {
        ids.push_back(observation.id);
        poses.push_back(observation.base_from_flange);
        if (observation.profile.x_mm.size() != observation.profile.z_mm.size())
            return input_error("the profile has different numbers of x and z",
                               Text("observation '{}'", observation.id));
    }
    SEAM_OK(check_ids(ids, options.exclude, "observations"));
    SEAM_OK(check_repeatability(options.robot));
    if (options.radius_mm && !(std::isfinite(*options.radius_mm) && *options.radius_mm > 0))
        return input_error("the sphere's radius is not a positive number", "radius_mm",
                           "give it in millimetres or null");
    SEAM_OK(check_rigid(poses, ids, "base_from_flange of"));
    SEAM_OK(check_millimetres(poses, "observations"));
    if (options.nominal_flange_from_sensor)
        if (auto ok = check_rigid({*options.nominal_flange_from_sensor}, {"nominal"}, "flange_from_sensor");
            !ok)
            return ok;

    const std::set<std::string> excluded(options.exclude.begin(), options.exclude.end());
    std::vector<Pose> kept;
    for (size_t i = 0; i < poses.size(); ++i)
        if (!excluded.contains(ids[i])) kept.push_back(poses[i]);
    if (static_cast<int>(kept.size()) < kTcpSphereFewestPoses)
        return input_error(Text("{} poses are too few", kept.size()), "observations",
                           Text("give at least {}, better nine or more", kTcpSphereFewestPoses));
    const auto first = first_equal_pose(kept);
    int distinct = 0;
    for (size_t i = 0; i < first.size(); ++i) distinct += first[i] == static_cast<int>(i) ? 1 : 0;
    if (distinct < kTcpSphereFewestPoses)
        return input_error(
            Text("only {} of the {} poses differ from one another", distinct, kept.size()), "observations",
            Text("give at least {} different poses, better nine or more", kTcpSphereFewestPoses));

    // Extents of the points, for units: a sensor's field is centimetres, a sphere's radius is millimetres.
    double low = std::numeric_limits<double>::infinity(), high = -low;
    size_t finite = 0;
    for (const auto& observation : observations) {
        for (size_t i = 0; i < observation.profile.size(); ++i) {
            const double x = observation.profile.x_mm[i];
            if (!std::isfinite(x) || !std::isfinite(observation.profile.z_mm[i])) continue;
            low = std::min(low, x);
            high = std::max(high, x);
            ++finite;
        }
    }
    if (finite == 0) return input_error("no profile holds a single point", "observations");
    if (high - low < kLooksLikeMetres_mm)
        return input_error(
            Text("all profile points lie within {:.3g} in x: these look like metres, not millimetres",
                 high - low),
            "observations", "give profile points in millimetres (times 1000)");
    if (options.radius_mm && *options.radius_mm < kLooksLikeMetres_mm)
        return input_error(Text("a radius of {:.3g} mm looks like metres", *options.radius_mm), "radius_mm",
                           "give it in millimetres (times 1000)");
    return {};
}

MirroredAxis judge_axes(const std::vector<Section>& sections,
                        const std::vector<SphereObservation>& observations, const TcpSphereOptions& options,
                        const Model& model, std::vector<Text>& notices) {
    double side = 0, descending = 0, ascending = 0, used = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        used += 1;
        side += section.circle.mean_side;
        int steps = 0;
        const auto& x = observations[section.observation].profile.x_mm;
        for (size_t k = 1; k < section.circle.inliers.size(); ++k) {
            const auto a = static_cast<size_t>(section.circle.inliers[k - 1]);
            const auto b = static_cast<size_t>(section.circle.inliers[k]);
            steps += x[b] > x[a] ? 1 : -1;
        }
        const double share = steps / std::max(1.0, section.count() - 1);
        descending += share < -kOneWay ? 1 : 0;
        ascending += share > kOneWay ? 1 : 0;
    }
    if (used == 0) return MirroredAxis::none;
    if (options.nominal_flange_from_sensor) {
        constexpr double kThatWay_deg = 45;  // within, from an attitude
        // Half a turn about Z is what mirrored x looks like, half a turn about X mirrored z.
        const Eigen::Matrix3d turn =
            options.nominal_flange_from_sensor->linear().transpose() * model.flange_from_sensor.linear();
        const auto angle_to = [&](double x, double y, double z) {
            return rotation_log(turn * Eigen::Vector3d(x, y, z).asDiagonal()).norm();
        };
        const double plain = angle_to(1, 1, 1), about_z = angle_to(-1, -1, 1), about_x = angle_to(1, -1, -1);
        if (about_z < plain && about_z < about_x && about_z < rad_from_deg(kThatWay_deg)) {
            notices.push_back(
                "the profile's x axis is mirrored: the sensor comes out turned half about Z against its "
                "nominal mounting");
            return MirroredAxis::x;
        }
        if (about_x < plain && about_x < rad_from_deg(kThatWay_deg)) {
            notices.push_back(
                "the profile's z axis is mirrored: the sensor comes out turned half about X against its "
                "nominal mounting");
            return MirroredAxis::z;
        }
        if (plain < rad_from_deg(kThatWay_deg)) return MirroredAxis::none;
    }
    if (side / used < -kBulges) {
        notices.push_back(
            "the profile's z axis is mirrored or counts away from the sensor: the sphere's visible cap lies "
            "towards -z; "
            "flange_from_sensor holds for the profile as delivered, with its Y axis reversed");
        return MirroredAxis::z;
    }
    if (descending > kOneWay * used && ascending == 0) {
        notices.push_back(
            "the profile's x axis looks mirrored: x falls along the order of the points in every profile; "
            "flange_from_sensor holds for the profile as delivered, with its Y axis reversed if x is indeed "
            "mirrored");
        return MirroredAxis::x;
    }
    return MirroredAxis::none;
}

HoldOut verify(const std::vector<Section>& sections, const Model& model, bool radius_free) {
    HoldOut result;
    std::vector<size_t> used;
    for (size_t i = 0; i < sections.size(); ++i)
        if (sections[i].used) used.push_back(i);
    if (used.size() < static_cast<size_t>(kFewestSections) + 1) return result;
    const size_t folds = std::min<size_t>(used.size(), 9);
    double squares = 0, points = 0, largest = 0, turn = 0, turns = 0;
    std::vector<Section> rest = sections;
    for (size_t fold = 0; fold < folds; ++fold) {
        int left_out = 0;
        for (size_t k = fold; k < used.size(); k += folds) {
            rest[used[k]].used = false;
            ++left_out;
        }
        Model model_of_rest = model;
        solve_points(rest, model_of_rest, radius_free);
        for (size_t k = fold; k < used.size(); k += folds) {
            const auto& section = sections[used[k]];
            const double s = point_squares(section, model_of_rest);
            squares += s;
            points += section.count();
            largest = std::max(largest, std::sqrt(s / section.count()));
            rest[used[k]].used = true;
        }
        turn += std::pow(angle_rad(model_of_rest.flange_from_sensor, model.flange_from_sensor), 2);
        turns += 1;
        result.left_out = std::max(result.left_out, left_out);
    }
    result.folds = static_cast<int>(folds);
    result.rms_mm = std::sqrt(squares / points);
    result.max_mm = largest;
    result.rms_deg = deg_from_rad(std::sqrt(turn / turns));
    return result;
}

void write_poses(const std::vector<SphereObservation>& observations, const std::vector<Section>& sections,
                 const std::vector<bool>& excluded, const Model* model, CalibrationReport& report) {
    report.poses.resize(observations.size());
    for (size_t i = 0; i < observations.size(); ++i) {
        report.poses[i].id = observations[i].id;
        report.poses[i].used = false;
        report.poses[i].excluded = excluded[i];
        report.poses[i].note =
            excluded[i] ? "excluded by the user" : "no circle of the sphere found in this profile";
    }
    for (const auto& section : sections) {
        auto& pose = report.poses[section.observation];
        pose.used = section.used;
        if (section.used)
            pose.note.clear();
        else if (!excluded[section.observation])
            pose.note =
                "contradicts the sphere that the other poses agree on: wrong pose, or something else in the "
                "profile";
        if (model == nullptr) continue;
        pose.rms_mm = section_rms(section, *model);
        // The turn of the flange that would explain where this profile sees the centre.
        const double offset = section.best.head<2>().norm();
        const Eigen::Vector3d s = centre_in_sensor(section, *model);
        const Eigen::Vector2d miss(s.x() - section.circle.x_mm - section.best[0],
                                   s.z() - section.circle.z_mm - section.best[1]);
        const double distance = (section.flange_from_base * model->centre_base).norm();
        pose.deg =
            std::isfinite(offset) && distance > 1 ? deg_from_rad(std::atan2(miss.norm(), distance)) : kNaN;
    }
}

void write_statistics(const Model& model, const Matrix10& covariance, bool radius_free,
                      TcpSphereResult& result) {
    result.covariance = covariance.topLeftCorner<6, 6>();
    result.centre_covariance = covariance.block<3, 3>(6, 6);
    result.radius_sigma_mm = radius_free ? std::sqrt(std::max(0.0, covariance(9, 9))) : 0;
    Eigen::Matrix<double, 3, 6> lever;
    lever.leftCols<3>().setIdentity();
    lever.rightCols<3>() = -skew(model.flange_from_sensor.linear() * result.working_point_mm);
    const Eigen::Matrix3d at_work = lever * result.covariance * lever.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(at_work);
    result.working_sigma_mm = std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));

    auto& report = result.report;
    const Eigen::Vector3d& c = model.centre_base;
    add_pose(report, model.flange_from_sensor);
    report.parameters.insert(
        report.parameters.end(),
        {{"centre_x", c.x(), "mm", 0}, {"centre_y", c.y(), "mm", 0}, {"centre_z", c.z(), "mm", 0}});
    if (radius_free) report.parameters.push_back({"radius", model.radius, "mm", 0});
    const auto n = static_cast<Eigen::Index>(report.parameters.size());
    state_covariance(report, covariance.topLeftCorner(n, n));
}

// The sphere's cut in every profile that shows one.
std::vector<Section> find_sections(const std::vector<SphereObservation>& observations,
                                   const std::vector<bool>& excluded, const CircleSectionLimits& limits) {
    std::vector<Section> sections;
    for (size_t i = 0; i < observations.size(); ++i) {
        const auto circle = find_circle_section(observations[i].profile, limits);
        if (!circle) continue;
        Section section;
        section.observation = i;
        section.flange_from_base = observations[i].base_from_flange.inverse();
        section.profile = &observations[i].profile;
        section.used = !excluded[i];
        take_inliers(section, *circle);
        sections.push_back(std::move(section));
    }
    return sections;
}

CircleSectionLimits section_limits(const std::optional<double>& radius_mm) {
    return radius_mm ? limits_of_sphere(*radius_mm) : CircleSectionLimits();
}

// Of the cuts in use. Rims of other things can be rounder than the sphere is large: the second largest bounds the radius.
double second_largest_radius(const std::vector<Section>& sections) {
    std::vector<double> radii;
    for (const Section& s : sections)
        if (s.used) radii.push_back(s.circle.radius_mm);
    std::sort(radii.begin(), radii.end());
    return radii[radii.size() - 2];
}

// Does another, different solution fit about as well?
bool has_rival(const std::vector<Section>& sections, const std::vector<Start>& starts, const Model& model,
               bool radius_free, double mean_disagreement, double redundancy) {
    constexpr double kOtherPlace_rad = 0.02, kOtherPlace_mm = 5, kAlike_mm = 0.02;
    double cost = std::numeric_limits<double>::infinity();
    for (size_t k = 1; k < starts.size(); ++k) {
        Model other = starts[k].model;
        const double found =
            solve_reduced(sections, other, radius_free, std::numeric_limits<double>::infinity(), 60);
        if (angle_rad(other.flange_from_sensor, model.flange_from_sensor) > kOtherPlace_rad ||
            distance_mm(other.flange_from_sensor, model.flange_from_sensor) > kOtherPlace_mm)
            cost = std::min(cost, found);
    }
    return cost < std::max(mean_disagreement * (1 + 60 / std::max(1.0, redundancy)), kAlike_mm * kAlike_mm);
}

// The poses disagree by more than the robot's stated repeatability explains (99 %).
bool beyond_stated(const NoiseLevels& noise, double stated_variance) {
    const double limit = chi_squared_quantile(kStatedTold, noise.freedom) / noise.freedom;
    return noise.poses_disagree && noise.centre_variance > limit * stated_variance;
}

// Sandwich for the points' noise; the poses' own error is added when they disagree by more (see tcp_sphere.h).
Matrix10 covariance_of(const std::vector<Section>& sections, const Model& model, const System& system,
                       const Matrix10& inverse, const NoiseLevels& noise, double stated_variance,
                       bool radius_free) {
    const int unknowns = radius_free ? 10 : 9;
    if (stated_variance > 0 && !beyond_stated(noise, stated_variance))
        return inverse * noise.point_variance +
               covariance_of_centres(sections, model, inverse, stated_variance);
    if (!noise.poses_disagree)
        return inverse * system.meat * inverse * (system.count / std::max(1.0, system.count - unknowns));
    const double student = student_quantile(kUpper95, noise.freedom) / kNormal95;
    return student * student *
           (inverse * noise.point_variance +
            covariance_of_centres(sections, model, inverse, noise.centre_variance));
}

// The radius that the profiles fit much better than the given one, or that they tell from it beyond chance; NaN: none.
double better_radius(const std::vector<Section>& sections, const Model& model, double mean_disagreement,
                     const Eigen::Vector3d& working_point, double stated) {
    Model other = model;
    const double cost = solve_reduced(sections, other, true, std::numeric_limits<double>::infinity(), 100);
    if (cost < kMuchBetter * mean_disagreement && std::abs(other.radius - model.radius) > kOtherRadius_mm)
        return other.radius;
    solve_points(sections, other, true);
    const System system = accumulate(sections, other, true);
    const Determination known = determination(system.information, other, working_point, true);
    if (!std::isfinite(known.weakest)) return kNaN;
    const NoiseLevels noise = noise_levels(sections, other, known.inverse, true);
    const double sigma =
        std::sqrt(covariance_of(sections, other, system, known.inverse, noise, stated, true)(9, 9));
    const double told = std::max({kOtherRadius_mm, kScaleOfSensors * model.radius, kRadiusSigmas * sigma});
    return std::abs(other.radius - model.radius) > told ? other.radius : kNaN;
}

}  // namespace

std::string_view name_of(TcpSphereStatus status) {
    switch (status) {
        case TcpSphereStatus::ok:
            return "ok";
        case TcpSphereStatus::undetermined:
            return "undetermined";
        case TcpSphereStatus::not_converged:
            return "not_converged";
    }
    return "undetermined";
}

std::string_view name_of(MirroredAxis axis) {
    switch (axis) {
        case MirroredAxis::none:
            return "none";
        case MirroredAxis::x:
            return "x";
        case MirroredAxis::z:
            return "z";
    }
    return "none";
}

Expected<TcpSphereResult> calibrate_tcp_sphere(const std::vector<SphereObservation>& observations,
                                               const TcpSphereOptions& options) {
    SEAM_OK(check_input(observations, options));
    const bool radius_free = !options.radius_mm.has_value();
    std::vector<bool> excluded(observations.size());
    for (size_t i = 0; i < observations.size(); ++i)
        excluded[i] = std::find(options.exclude.begin(), options.exclude.end(), observations[i].id) !=
                      options.exclude.end();
    const CircleSectionLimits limits = section_limits(options.radius_mm);
    TcpSphereResult result;
    std::vector<Section> sections = find_sections(observations, excluded, limits);
    const auto refused = [&](TcpSphereStatus status, Judgement judgement) {
        result.status = status;
        write_poses(observations, sections, excluded, nullptr, result.report);
        result.report.judgement = std::move(judgement);
        return result;
    };
    const size_t candidates = used_count(sections);
    if (static_cast<int>(candidates) < kFewestSections)
        return refused(TcpSphereStatus::not_converged,
                       {Verdict::undetermined, Text("the sphere was found in {} profiles only", candidates),
                        radius_free ? "let the laser cut the sphere in every pose"
                                    : "let the laser cut the sphere in every pose, and check its radius"});
    const double radius = options.radius_mm.value_or(second_largest_radius(sections));
    const auto starts = global_start(sections, radius, radius_free, options.thorough);
    if (starts.empty())
        return refused(
            TcpSphereStatus::not_converged,
            {Verdict::undetermined, "no sphere common to the profiles was found", "record the poses again"});
    Model model = starts.front().model;
    settle(sections, model, radius_free, limits, excluded);
    solve_points(sections, model, radius_free);

    double used = 0, between = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        used += 1;
        result.working_point_mm += centre_in_sensor(section, model);
        between += disagreement(section, model);
    }
    result.working_point_mm /= used;
    const System system = accumulate(sections, model, true);
    result.rms_mm = std::sqrt(system.squares / system.count);
    const Determination known =
        determination(system.information, model, result.working_point_mm, radius_free);
    const NoiseLevels noise = noise_levels(sections, model, known.inverse, radius_free);
    result.noise_mm = std::sqrt(noise.point_variance);
    const double floor_sigma = std::max({result.rms_mm, result.noise_mm, kNoiseFloor_mm});
    result.weakest_sigma_mm = floor_sigma * known.weakest;
    const double mean_disagreement = between / system.count;
    result.poses_freedom = noise.redundancy;
    result.poses_variance_mm2 = between / std::max(1.0, noise.redundancy);
    const bool ambiguous =
        has_rival(sections, starts, model, radius_free, mean_disagreement, noise.redundancy);

    result.degenerate = degenerate_pose_words(sections, model, radius_free);
    const bool weak = !(result.weakest_sigma_mm < kUndeterminedSigma_mm);
    if (options.thorough && (weak || result.weakest_sigma_mm * 3 > kUsableTcp_mm || used < 9))
        result.proposals = propose_poses(sections, model, system.information, result.working_point_mm,
                                         radius_free, floor_sigma, weak ? 3 : 1);
    if (weak || ambiguous) return refused(TcpSphereStatus::undetermined, undetermined_sphere(result, weak));
    if (result.weakest_sigma_mm * 3 < kUsableTcp_mm) result.degenerate.clear();

    const double turned =
        options.robot.sigma_rad * (model.flange_from_sensor * result.working_point_mm).norm();
    const double stated = options.robot.sigma_mm * options.robot.sigma_mm + turned * turned;
    result.status = TcpSphereStatus::ok;
    result.flange_from_sensor = model.flange_from_sensor;
    result.centre_base_mm = model.centre_base;
    result.radius_mm = model.radius;
    write_statistics(model, covariance_of(sections, model, system, known.inverse, noise, stated, radius_free),
                     radius_free, result);
    if (!radius_free)
        result.scale =
            sphere_scale(sections, model, noise.point_variance, std::max(stated, noise.centre_variance));
    write_poses(observations, sections, excluded, &model, result.report);
    if (options.thorough) result.report.hold_out = verify(sections, model, radius_free);
    result.mirrored = judge_axes(sections, observations, options, model, result.notices);
    if (const std::string rejected = left_out(result.report.poses); !rejected.empty())
        result.notices.push_back(Text("not used: {}", rejected));
    if (noise.poses_disagree && (stated == 0 || beyond_stated(noise, stated))) {
        result.sigma_freedom = noise.freedom;
        result.notices.push_back(
            stated == 0
                ? Text("the poses disagree by {:.1f} times the sensor's own noise: the robot's poses are "
                       "less exact than the "
                       "profiles, and the stated sigma counts that in",
                       std::sqrt(noise.ratio))
                : Text("the poses err by {:.3f} mm, more than the {:.3f} mm that are stated of the robot: "
                       "the stated sigma counts that in",
                       std::sqrt(noise.centre_variance), std::sqrt(stated)));
    }
    SphereFit fit{used, used<0.5 * static_cast<double>(candidates), stated> 0, kNaN, model.radius};
    if (!radius_free && noise.poses_disagree)
        fit.better_radius =
            better_radius(sections, model, mean_disagreement, result.working_point_mm, stated);
    result.report.judgement = judge_sphere(fit, result);
    return result;
}

}  // namespace seamwright
