#include "app/cli/evaluate/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/alignment/alignment.h"
#include "core/features/feature.h"
#include "core/profile/filter.h"
#include "devices/simulated/door.h"
#include "devices/simulated/profile_cut.h"

namespace seamwright::cli {
namespace {

constexpr int kRepeats = 100;
constexpr double kPassMm = 20, kPassStepMm = 2;
const Eigen::Vector3d kMiddle(500, 375, 0);

struct Method {
    int number;
    const char* name;
    bool matched, in_motion, misaligned;
};
constexpr std::array<Method, 5> kMethods{{{1, "standard, in motion", false, true, false},
                                          {2, "standard, standing still", false, false, false},
                                          {3, "filter and template matching, in motion", true, true, false},
                                          {4, "misaligned, in motion", false, true, true},
                                          {5, "misaligned, standing still", false, false, true}}};

struct TaughtSpot {
    SpotObservation observation;
    FeatureRecipe recipe;
    Eigen::Vector3d landmark = Eigen::Vector3d::Zero();  // work object
    Profile clean;                                       // of the undisplaced door, without noise
};
using Finders = std::vector<std::unique_ptr<FeatureFinder>>;

// The world of one evaluation: read-only once made.
struct World {
    EvaluationSettings settings;
    OpticsSettings optics;
    std::shared_ptr<MeshTree> taught, measured;
    std::atomic<std::size_t>* profiles;
};

// Runs `work(i)` for all i on the threads; the results lie where the index says.
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

void make_ready(Profile& profile, bool matched) {
    if (matched) {
        (void)filter_profile(profile, {});  // refuses only arrays of different length
        return;
    }
    profile.segment.assign(profile.size(), 0);
    for (std::size_t i = 0; i < profile.size(); ++i)
        if (!std::isfinite(profile.z_mm[i])) profile.segment[i] = kOutlier;
}

Feature measure(const World& w, const FeatureFinder& finder, const MeshTree& part,
                const Pose& part_from_sensor, bool matched, Random& random, Profile& profile) {
    cut_profile(part, part_from_sensor, w.optics, profile);
    ++*w.profiles;
    add_noise(profile, w.settings.noise_mm, random);
    make_ready(profile, matched);
    return finder.find(profile);
}

// The sensor where the robot and its trigger really put it.
Pose arrived(const World& w, const Pose& taught, bool in_motion, Random& random) {
    Pose at = taught;
    at.translation() += w.settings.repeatability_mm * random.normal3();
    if (in_motion)
        at.translation() +=
            random.uniform(-w.settings.jitter_mm, w.settings.jitter_mm) * taught.linear().col(1);
    return at;
}

Expected<TaughtSpot> teach(const World& w, const Method& method, const DoorSpot& door, std::size_t index,
                           Summary& spread, bool& flagged, double& yaw_deg) {
    Random random(hash64(w.settings.seed, 1000 * static_cast<std::uint64_t>(method.number) + index));
    TaughtSpot spot;
    spot.observation.id = door.id;
    Pose& pose = spot.observation.workobject_from_sensor;
    pose = door.workobject_from_sensor;
    if (method.misaligned) pose.linear() *= rotation_exp({0, 0, rad_from_deg(w.settings.misalignment_deg)});
    cut_profile(*w.taught, pose, w.optics, spot.clean);
    spot.recipe.kind = "contour-end";
    spot.recipe.parameters = {{"side", 0.0}};
    Profile profile;
    if (method.matched) {
        auto end = make_feature_finder(spot.recipe);
        if (!end) return tl::unexpected(end.error());
        const Feature edge = measure(w, **end, *w.taught, pose, true, random, profile);
        if (edge.status != FeatureStatus::ok) return input_error(edge.message, "spot " + door.id);
        spot.recipe.kind = "template";
        spot.recipe.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
        spot.recipe.template_reference_mm = edge.point_mm;
        Profile& piece = spot.recipe.template_profile;
        for (std::size_t i = 0; i < profile.size(); ++i) {
            const double along = profile.x_mm[i] - edge.point_mm.x();
            if (profile.segment[i] == kOutlier || along < -1 || along > 40) continue;
            piece.x_mm.push_back(profile.x_mm[i]);
            piece.z_mm.push_back(profile.z_mm[i]);
            piece.segment.push_back(profile.segment[i]);
        }
    }
    auto finder = make_feature_finder(spot.recipe);
    if (!finder) return tl::unexpected(finder.error());
    std::vector<double> x, z;
    for (int k = 0; k < kRepeats; ++k) {
        const Feature f =
            measure(w, **finder, *w.taught, arrived(w, pose, false, random), method.matched, random, profile);
        if (f.status != FeatureStatus::ok) continue;
        x.push_back(f.point_mm.x());
        z.push_back(f.point_mm.y());
    }
    const Summary in_x = summarise(x), in_z = summarise(z);
    if (in_x.count < kRepeats / 2)
        return input_error("the feature is not found when teaching", "spot " + door.id);
    spot.observation.reference_mm = {in_x.mean, 0, in_z.mean};
    // Both coordinates share one sigma; the taught mean'"'"'s own share is added.
    spread.variance = 0.5 * (in_x.variance + in_z.variance) * (1 + 1.0 / static_cast<double>(in_x.count));
    spot.observation.sigma_mm = std::max(1e-4, std::sqrt(spread.variance));
    spot.landmark = pose * spot.observation.reference_mm;

    std::vector<TravelProfile> pass;
    std::vector<TravelPoint> points;
    for (double y = -kPassMm; y <= kPassMm; y += kPassStepMm) {
        Pose at = arrived(w, pose, false, random);
        at.translation() += y * pose.linear().col(1);
        const Feature f = measure(w, **finder, *w.taught, at, method.matched, random, profile);
        if (f.status == FeatureStatus::ok) points.push_back({y, f.point_mm.x(), f.point_mm.y()});
        if (!method.matched) make_ready(profile, true);
        pass.push_back({y, profile});
    }
    AlignmentOptions alignment;
    alignment.jitter_mm = std::max(0.1, w.settings.jitter_mm);
    auto frozen = check_alignment(pass, alignment);
    if (!frozen) return tl::unexpected(frozen.error());
    flagged = frozen->status == AlignmentStatus::drifting;
    yaw_deg = frozen->yaw_deg;
    if (method.matched) {
        auto curve = fit_contour_curve(points);
        if (!curve) return tl::unexpected(curve.error());
        spot.observation.curve = *curve;
    }
    return spot;
}

Expected<std::vector<TaughtSpot>> teach_all(const World& w, const Method& method, ExperimentResult& result) {
    const std::vector<DoorSpot> doors = default_door_spots();
    std::vector<TaughtSpot> spots(doors.size());
    std::vector<Summary> spread(doors.size());
    std::vector<char> flagged(doors.size());
    std::vector<double> yaw(doors.size());
    std::vector<Error> errors(doors.size());
    spread_out(w.settings.jobs, doors.size(), [&] {
        return [&](std::size_t n) {
            bool drifting = false;
            auto spot = teach(w, method, doors[n], n, spread[n], drifting, yaw[n]);
            flagged[n] = drifting;
            if (spot)
                spots[n] = std::move(*spot);
            else
                errors[n] = spot.error();
        };
    });
    double variance = 0;
    for (std::size_t n = 0; n < doors.size(); ++n) {
        if (!errors[n].what.empty()) return tl::unexpected(errors[n]);
        result.flagged += flagged[n];
        result.worst_yaw_deg = std::max(result.worst_yaw_deg, std::abs(yaw[n]));
        variance += spread[n].variance / static_cast<double>(doors.size());
    }
    result.spots = static_cast<int>(doors.size());
    result.sigma_mm = std::sqrt(variance);
    return spots;
}

// 41 steps from -1 to 1 for each of three axes.
Pose grid_displacement(int column, std::size_t index, double& amount) {
    const double share = -1 + 0.05 * static_cast<double>(index % 41);
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<int>(index / 41));
    amount = column == 1 ? share : 10 * share;
    Pose d = Pose::Identity();
    if (column != 1) d.translation() = 10 * share * axis;
    if (column != 0) {
        const Eigen::Matrix3d r = rotation_exp(rad_from_deg(share) * axis);
        d = make_pose(r, d.translation() + kMiddle - r * kMiddle);
    }
    return d;
}

Finders make_finders(const std::vector<TaughtSpot>& spots) {
    Finders finders;
    for (const TaughtSpot& s : spots) finders.push_back(std::move(*make_feature_finder(s.recipe)));
    return finders;
}

void judge(const std::vector<TaughtSpot>& spots, const std::vector<SpotObservation>& observed,
           const Pose& truth, EvaluationTrial& trial) {
    if (observed.empty()) return;
    const auto solved = solve_region(observed, {});
    if (!solved || solved->status != CorrectionStatus::ok) return;
    const Pose& found = solved->displacement.workobject_from_movedworkobject;
    trial.ok = true;
    for (const TaughtSpot& s : spots) {
        const Eigen::Vector3d off = found * s.landmark - truth * s.landmark;
        trial.mean_abs_mm += off.norm() / static_cast<double>(spots.size());
        for (double v : off) trial.deviations_mm.push_back(v);
    }
    trial.nees = nees(difference(found, truth), solved->covariance);
}

void run_column(const World& w, const Method& method, const std::vector<TaughtSpot>& spots, int column,
                std::vector<EvaluationTrial>& trials) {
    trials.assign(3 * 41, {});
    spread_out(w.settings.jobs, trials.size(), [&] {
        return [&, finders = std::make_shared<Finders>(make_finders(spots)),
                profile = std::make_shared<Profile>()](std::size_t i) {
            Random random(
                hash64(w.settings.seed, 100 + static_cast<std::uint64_t>(10 * method.number + column)), i);
            EvaluationTrial& trial = trials[i];
            const Pose truth = grid_displacement(column, i, trial.displacement);
            std::vector<SpotObservation> observed;
            for (std::size_t n = 0; n < spots.size(); ++n) {
                SpotObservation o = spots[n].observation;
                const Pose at = arrived(w, o.workobject_from_sensor, method.in_motion, random);
                const Feature f = measure(w, *(*finders)[n], *w.measured, truth.inverse() * at,
                                          method.matched, random, *profile);
                if (f.status != FeatureStatus::ok) continue;
                o.measured_mm = {f.point_mm.x(), 0, f.point_mm.y()};
                observed.push_back(std::move(o));
            }
            judge(spots, observed, truth, trial);
        };
    });
}

void summarise_columns(ExperimentResult& r) {
    double sum = 0, count = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> all;
        for (const EvaluationTrial& t : r.trials[c]) {
            if (!t.ok) ++r.refused[c];
            all.insert(all.end(), t.deviations_mm.begin(), t.deviations_mm.end());
            if (t.ok) sum += t.nees, ++count;
        }
        r.summary[c] = summarise(all);
    }
    r.nees = count > 0 ? sum / count : 0;
    // The axis along which it grows most: a contour that runs along the motion shows nothing.
    for (std::size_t axis = 0; axis < 3 && r.trials[0].size() == 3 * 41; ++axis) {
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
        for (std::size_t i = 41 * axis; i < 41 * (axis + 1); ++i) {
            const EvaluationTrial& t = r.trials[0][i];
            if (!t.ok) continue;
            const double x = std::abs(t.displacement), y = t.mean_abs_mm;
            ++n, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
        }
        if (n < 3) continue;
        const double vx = sxx - sx * sx / n, vy = syy - sy * sy / n, vxy = sxy - sx * sy / n;
        if (!(vx > 0) || !(vy > 0) || vxy / vx <= r.slope_mm_per_mm) continue;
        r.slope_mm_per_mm = vxy / vx;
        r.linear_share = vxy * vxy / (vx * vy);
        r.steepest = "XYZ"[axis];
    }
}

// The part of the clean profile that the template covers, with normals from neighbours.
Eigen::Matrix2d bound_of(const World& w, const TaughtSpot& spot) {
    std::vector<Eigen::Vector2d> points, normals;
    const double x0 = spot.recipe.template_reference_mm.x();
    for (std::size_t i = 2; i + 2 < spot.clean.size(); ++i) {
        const auto at = [&](std::size_t k) {
            return Eigen::Vector2d(spot.clean.x_mm[k], spot.clean.z_mm[k]);
        };
        const Eigen::Vector2d p = at(i), step = at(i + 1) - at(i - 1);
        if (!p.allFinite() || !step.allFinite() || step.norm() > 1 || p.x() < x0 - 1 || p.x() > x0 + 40)
            continue;
        points.push_back(p);
        normals.push_back(Eigen::Vector2d(-step.y(), step.x()).normalized());
    }
    return landmark_bound(points, normals, spot.recipe.template_reference_mm, w.settings.noise_mm);
}

NoiseTrials noise_trials(const World& w, const std::vector<TaughtSpot>& spots) {
    NoiseTrials out;
    out.trials = w.settings.trials;
    std::vector<SpotObservation> taught;
    std::vector<Eigen::Matrix2d> bounds;
    for (const TaughtSpot& s : spots) {
        taught.push_back(s.observation);
        bounds.push_back(bound_of(w, s));
    }
    out.bound_mm = std::sqrt(mean_square_at_spots(taught, displacement_bound(taught, bounds)));
    struct One {
        bool ok[2] = {false, false};
        Vector6 off = Vector6::Zero();
        double nees = 0;
    };
    std::vector<One> ones(static_cast<std::size_t>(w.settings.trials));
    spread_out(w.settings.jobs, ones.size(), [&] {
        return [&, finders = std::make_shared<Finders>(make_finders(spots)),
                profile = std::make_shared<Profile>()](std::size_t i) {
            Random random(hash64(w.settings.seed, 7), i);
            for (const bool with_robot : {false, true}) {
                std::vector<SpotObservation> observed;
                for (std::size_t n = 0; n < spots.size(); ++n) {
                    *profile = spots[n].clean;
                    add_noise(*profile, w.settings.noise_mm, random);
                    make_ready(*profile, true);
                    ++*w.profiles;
                    const Feature f = (*finders)[n]->find(*profile);
                    if (f.status != FeatureStatus::ok) continue;
                    SpotObservation o = spots[n].observation;
                    o.curve.reset();
                    o.measured_mm = {f.point_mm.x(), 0, f.point_mm.y()};
                    // The robot'"'"'s error moves the profile in the laser plane.
                    if (with_robot) {
                        const Eigen::Vector3d e = w.settings.repeatability_mm * random.normal3();
                        o.measured_mm += Eigen::Vector3d(e.x(), 0, e.z());
                    }
                    observed.push_back(std::move(o));
                }
                CorrectionOptions plain;
                plain.reject_outliers = false;
                const auto solved = solve_region(observed, plain);
                if (!solved || solved->status != CorrectionStatus::ok) continue;
                ones[i].ok[with_robot] = true;
                const Vector6 off =
                    difference(solved->displacement.workobject_from_movedworkobject, Pose::Identity());
                if (with_robot)
                    ones[i].nees = nees(off, solved->covariance);
                else
                    ones[i].off = off;
            }
        };
    });
    // Spread about the mean: the taught reference'"'"'s own error is common to all trials.
    Vector6 mean = Vector6::Zero();
    double count = 0, robot = 0;
    for (const One& o : ones) {
        if (o.ok[0]) mean += o.off, ++count;
        if (o.ok[1]) out.nees += o.nees, ++robot;
    }
    if (count < 2 || robot < 1) return out;
    mean /= count;
    out.nees /= robot;
    Matrix6 spread = Matrix6::Zero();
    for (const One& o : ones)
        if (o.ok[0]) spread += (o.off - mean) * (o.off - mean).transpose() / (count - 1);
    out.found_mm = std::sqrt(mean_square_at_spots(taught, spread));
    out.efficiency = std::pow(out.bound_mm / out.found_mm, 2);
    return out;
}

World make_world(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles) {
    World w;
    w.settings = settings;
    w.profiles = &profiles;
    TriangleMesh mesh = door_mesh();
    w.taught = std::make_shared<MeshTree>(mesh);
    w.measured = w.taught;
    if (settings.bend_mm != 0) {
        const Eigen::AlignedBox3d box = mesh.box();
        for (Eigen::Vector3d& v : mesh.vertices) v.z() += bend_at({settings.bend_mm, 0}, box, v);
        w.measured = std::make_shared<MeshTree>(std::move(mesh));
    }
    return w;
}

}  // namespace

Expected<EvaluationResult> evaluate(const EvaluationSettings& settings,
                                    const std::function<void(const std::string&)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    EvaluationResult out;
    out.settings = settings;
    if (out.settings.jobs <= 0)
        out.settings.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    std::atomic<std::size_t> profiles{0};
    const World world = make_world(out.settings, profiles);
    for (const Method& method : kMethods) {
        if (settings.experiment != 0 && settings.experiment != method.number) continue;
        progress(fmt::format("experiment {}: {}", method.number, method.name));
        ExperimentResult result;
        result.number = method.number;
        result.name = method.name;
        auto spots = teach_all(world, method, result);
        if (!spots) return tl::unexpected(spots.error());
        for (int column = 0; column < 3; ++column)
            run_column(world, method, *spots, column, result.trials[static_cast<std::size_t>(column)]);
        summarise_columns(result);
        out.experiments.push_back(std::move(result));
        if (!method.matched) continue;
        progress("sensor noise alone, against the Cramer-Rao bound");
        out.noise = noise_trials(world, *spots);
        progress("error budget");
        struct Source {
            const char* name;
            double noise, robot, jitter, bend;
        };
        const EvaluationSettings& s = out.settings;
        for (const Source& source : {Source{"sensor noise", s.noise_mm, 0, 0, 0},
                                     Source{"robot repeatability", 0, s.repeatability_mm, 0, 0},
                                     Source{"trigger jitter", 0, 0, s.jitter_mm, 0},
                                     Source{"curvature alone (in every line)", 0, 0, 0, 0},
                                     Source{"door bent by 0.3 mm", 0, 0, 0, 0.3}}) {
            EvaluationSettings alone = s;
            alone.noise_mm = std::max(1e-4, source.noise);
            alone.repeatability_mm = source.robot;
            alone.jitter_mm = source.jitter;
            alone.bend_mm = source.bend;
            World w = make_world(alone, profiles);
            ExperimentResult only;
            run_column(w, method, *spots, 2, only.trials[2]);
            summarise_columns(only);
            out.budget.push_back({source.name, only.summary[2].three_sigma});
        }
    }
    out.profiles = profiles;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

}  // namespace seamwright::cli
