#include "projects/evaluate/experiments.h"
#include "projects/evaluate/spread.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/geometry/decompositions.h"
#include "devices/simulated/scene/profile_cut.h"

namespace seamwright::evaluation {
namespace {

constexpr std::size_t kSteps = 41;  // of a grid's axis
const Eigen::Vector3d kMiddle(500, 375, 0);

constexpr std::array<Method, 5> kMethods{{{1, "standard, in motion", false, true, false},
                                          {2, "standard, standing still", false, false, false},
                                          {3, "filter and template matching, in motion", true, true, false},
                                          {4, "misaligned, in motion", false, true, true},
                                          {5, "misaligned, standing still", false, false, true}}};

Pose turned_about_middle(const Eigen::Vector3d& move_mm, const Eigen::Vector3d& turn_rad) {
    const Eigen::Matrix3d r = rotation_exp(turn_rad);
    return make_pose(r, move_mm + kMiddle - r * kMiddle);
}

// 41 steps from -1 to 1 for each of three axes.
Pose grid_displacement(int column, std::size_t index, double& amount) {
    const double share = -1 + 0.05 * static_cast<double>(index % kSteps);
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<int>(index / kSteps));
    amount = column == 1 ? share : 10 * share;
    return turned_about_middle(
        column != 1 ? Eigen::Vector3d(10 * share * axis) : Eigen::Vector3d(0, 0, 0),
        column != 0 ? Eigen::Vector3d(rad_from_deg(share) * axis) : Eigen::Vector3d(0, 0, 0));
}

void judge(const std::vector<TaughtSpot>& spots, const RegionCorrection& solved, const Pose& truth,
           EvaluationTrial& trial) {
    const Pose& found = solved.displacement.workobject_from_movedworkobject;
    trial.ok = true;
    for (const TaughtSpot& s : spots) {
        const Eigen::Vector3d off = found * s.landmark - truth * s.landmark;
        trial.mean_abs_mm += off.norm() / static_cast<double>(spots.size());
        for (double v : off) trial.deviations_mm.push_back(v);
    }
    trial.nees = nees(difference(found, truth), solved.covariance);
    for (const TaughtSpot& s : spots) {
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(found.linear() * s.landmark);
        trial.stated_variance_mm2 +=
            (j * solved.covariance * j.transpose()).trace() / (3 * static_cast<double>(spots.size()));
    }
}

void run_trial(const Cell& cell, const Method& method, const TaughtCell& taught, Measurers& measurers,
               const Pose& truth, Random& random, Frame& frame, EvaluationTrial& trial) {
    std::vector<SpotMeasurement> measurements;
    for (std::size_t n = 0; n < taught.spots.size(); ++n)
        measurements.push_back(
            measure_spot(cell, method, taught.spots[n], n, measurers[n], truth, random, frame));
    if (const auto solved = correct(taught.project, measurements)) judge(taught.spots, *solved, truth, trial);
}

void hand_over(PartValue& part, EvaluationTrial& trial) {
    part(trial.displacement);
    part(trial.ok);
    part(trial.mean_abs_mm);
    part.list(trial.deviations_mm, [&](double& v) { part(v); });
    part(trial.nees);
    part(trial.stated_variance_mm2);
}

void run_column(const Cell& cell, const Method& method, const TaughtCell& taught, int column,
                std::vector<EvaluationTrial>& trials) {
    trials.assign(3 * kSteps, {});
    const auto worker = [&] {
        return [&, measurers = std::make_shared<Measurers>(make_measurers(taught)),
                frame = std::make_shared<Frame>()](std::size_t i) {
            Random random(
                hash64(cell.settings.seed, 100 + static_cast<std::uint64_t>(10 * method.number + column)), i);
            const Pose truth = grid_displacement(column, i, trials[i].displacement);
            run_trial(cell, method, taught, *measurers, truth, random, *frame, trials[i]);
        };
    };
    spread_values(cell.settings, *cell.profiles, trials.size(), worker,
                  [&](PartValue& part, std::size_t i) { hand_over(part, trials[i]); });
}

Summary summary_of(const std::vector<EvaluationTrial>& trials) {
    std::vector<double> all;
    for (const EvaluationTrial& t : trials)
        all.insert(all.end(), t.deviations_mm.begin(), t.deviations_mm.end());
    return summarise(all);
}

double stated_three_sigma(const std::vector<EvaluationTrial>& trials) {
    double sum = 0, count = 0;
    for (const EvaluationTrial& t : trials)
        if (t.ok) sum += t.stated_variance_mm2, ++count;
    return count > 0 ? 3 * std::sqrt(sum / count) : 0;
}

int refused_of(const std::vector<EvaluationTrial>& trials) {
    return static_cast<int>(std::count_if(trials.begin(), trials.end(), [](const auto& t) { return !t.ok; }));
}

Growth growth_along(const std::vector<EvaluationTrial>& trials, std::size_t axis) {
    Growth out;
    out.axis = "XYZ"[axis];
    std::vector<const EvaluationTrial*> good;
    for (std::size_t i = kSteps * axis; i < kSteps * (axis + 1); ++i)
        if (trials[i].ok) good.push_back(&trials[i]);
    if (good.size() < 8) return out;
    const auto rows = static_cast<Eigen::Index>(good.size());
    const auto coordinates = static_cast<Eigen::Index>(good.front()->deviations_mm.size());
    Eigen::MatrixXd powers(rows, 4), deviation(rows, coordinates);
    double reach = 0;
    for (const auto* t : good) reach = std::max(reach, std::abs(t->displacement));
    for (Eigen::Index i = 0; i < rows; ++i) {
        const EvaluationTrial& t = *good[static_cast<std::size_t>(i)];
        const double d = t.displacement / reach;
        powers.row(i) << 1, d, d * d, d * d * d;
        deviation.row(i) = Eigen::Map<const Eigen::RowVectorXd>(t.deviations_mm.data(), coordinates);
    }
    const auto left_by = [&](Eigen::Index terms) {
        const Eigen::MatrixXd a = powers.leftCols(terms);
        return (deviation - a * least_squares(a, deviation).x).squaredNorm();
    };
    const double about_mean = left_by(1), straight = left_by(2), bent = left_by(4);
    const Eigen::MatrixXd line = least_squares(powers.leftCols(2), deviation).x;
    out.slope_mm_per_mm = std::sqrt(line.row(1).squaredNorm() / static_cast<double>(coordinates)) / reach;
    if (about_mean > 0) {
        out.linear_share = 1 - straight / about_mean;
        out.bend_share = (straight - bent) / about_mean;
    }
    return out;
}

void summarise_experiment(ExperimentResult& r) {
    double sum = 0, count = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        r.summary[c] = summary_of(r.trials[c]);
        r.stated_three_sigma[c] = stated_three_sigma(r.trials[c]);
        r.refused[c] = refused_of(r.trials[c]);
        for (const EvaluationTrial& t : r.trials[c])
            if (t.ok) sum += t.nees, ++count;
    }
    r.nees = count > 0 ? sum / count : 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Growth g = growth_along(r.trials[0], axis);
        if (axis == 0 || g.slope_mm_per_mm > r.growth.slope_mm_per_mm) r.growth = g;
    }
}

Expected<ExperimentResult> run_experiment(const Cell& cell, const Method& method, TaughtCell& taught) {
    ExperimentResult result;
    result.method = method;
    SEAM_TRY(taught, teach_all(cell, method));
    double variance = 0;
    for (const TaughtSpot& s : taught.spots) {
        result.flagged += s.flagged;
        result.worst_yaw_deg = std::max(result.worst_yaw_deg, std::abs(s.yaw_deg));
        variance += s.spread_mm * s.spread_mm / static_cast<double>(taught.spots.size());
    }
    result.spots = static_cast<int>(taught.spots.size());
    result.sigma_mm = std::sqrt(variance);
    for (int column = 0; column < 3; ++column)
        run_column(cell, method, taught, column, result.trials[static_cast<std::size_t>(column)]);
    summarise_experiment(result);
    return result;
}

// The part of the clean profile that the template covers, with normals from neighbours.
Eigen::Matrix2d bound_of(const TaughtSpot& spot, double noise_mm) {
    std::vector<Eigen::Vector2d> points, normals;
    const Profile& piece = spot.spot.feature.template_profile;
    const auto [from, to] = std::minmax_element(piece.x_mm.begin(), piece.x_mm.end());
    for (std::size_t i = 1; i + 1 < spot.clean.size(); ++i) {
        const auto at = [&](std::size_t k) {
            return Eigen::Vector2d(spot.clean.x_mm[k], spot.clean.z_mm[k]);
        };
        const Eigen::Vector2d p = at(i), step = at(i + 1) - at(i - 1);
        if (!p.allFinite() || !step.allFinite() || step.norm() > 1 || p.x() < *from || p.x() > *to) continue;
        points.push_back(p);
        normals.push_back(Eigen::Vector2d(-step.y(), step.x()).normalized());
    }
    return landmark_bound(points, normals, spot.spot.feature.template_reference_mm, noise_mm);
}

struct Spread6 {
    Vector6 mean = Vector6::Zero();
    Matrix6 covariance = Matrix6::Zero();
    int count = 0;
    void finish(const std::vector<std::optional<Vector6>>& values) {
        for (const auto& v : values)
            if (v) mean += *v, ++count;
        if (count < 2) return;
        mean /= count;
        for (const auto& v : values)
            if (v) covariance += (*v - mean) * (*v - mean).transpose() / (count - 1);
    }
};

// Sensor noise alone on the part in its place. The scatter is taken about its mean: the taught reference's
// own error is common to all trials.
void noise_alone(const Cell& cell, const TaughtCell& taught, StraightTrials& out) {
    const std::vector<TaughtSpot>& spots = taught.spots;
    std::vector<SpotObservation> as_taught;
    std::vector<Eigen::Matrix2d> bounds;
    for (const TaughtSpot& s : spots) {
        as_taught.push_back(observation_of(s, {}));
        bounds.push_back(bound_of(s, cell.settings.noise_mm));
    }
    const auto count = static_cast<std::size_t>(out.trials);
    std::vector<std::optional<Vector6>> found(count), found_one_sigma(count);
    const std::vector<Eigen::Vector2d> none(spots.size(), Eigen::Vector2d::Zero());
    std::vector<std::vector<Eigen::Vector2d>> points(count, none);
    const auto worker = [&] {
        return [&, measurers = std::make_shared<Measurers>(make_measurers(taught)),
                frame = std::make_shared<Frame>()](std::size_t i) {
            Random random(hash64(cell.settings.seed, 7), i);
            std::vector<SpotObservation> observed;
            for (std::size_t n = 0; n < spots.size(); ++n) {
                frame->profile = spots[n].clean;
                add_noise(frame->profile, cell.settings.noise_mm, random);
                ++*cell.profiles;
                const SpotMeasurement& m = (*measurers)[n].measure(*frame);
                points[i][n] = m.feature.point_mm;
                if (m.status == SpotStatus::measured) observed.push_back(observation_of(spots[n], m));
            }
            CorrectionOptions all;
            all.reject_outliers = false;
            const auto solve = [&]() -> std::optional<Vector6> {
                const auto solved = solve_region(observed, all);
                if (!solved || solved->status != CorrectionStatus::ok) return std::nullopt;
                return difference(solved->displacement.workobject_from_movedworkobject, Pose::Identity());
            };
            found[i] = solve();
            for (SpotObservation& o : observed) {
                o.sigma_mm = std::sqrt(0.5 * o.covariance_mm2->trace());
                o.covariance_mm2.reset();
            }
            found_one_sigma[i] = solve();
        };
    };
    spread_values(cell.settings, *cell.profiles, count, worker, [&](PartValue& part, std::size_t i) {
        const auto matrix = [&](auto& m) { part.matrix(m); };
        part.maybe(found[i], matrix);
        part.maybe(found_one_sigma[i], matrix);
        part.list(points[i], matrix);
    });
    Spread6 spread, one_sigma;
    spread.finish(found);
    one_sigma.finish(found_one_sigma);
    out.bound_mm = std::sqrt(mean_square_at_spots(as_taught, displacement_bound(as_taught, bounds)));
    out.found_mm = std::sqrt(mean_square_at_spots(as_taught, spread.covariance));
    out.efficiency = std::pow(out.bound_mm / out.found_mm, 2);
    out.efficiency_one_sigma =
        out.bound_mm * out.bound_mm / mean_square_at_spots(as_taught, one_sigma.covariance);
    for (std::size_t n = 0; n < spots.size(); ++n) {
        std::vector<double> x, z;
        for (const auto& p : points) {
            x.push_back(p[n].x());
            z.push_back(p[n].y());
        }
        out.landmark_efficiency +=
            0.5 * (bounds[n](0, 0) / summarise(x).variance + bounds[n](1, 1) / summarise(z).variance) /
            static_cast<double>(spots.size());
    }
}

// Everything but deformation and calibration error, at random displacements.
double displaced_nees(const Cell& cell, const Method& method, const TaughtCell& taught, StraightTrials& out) {
    std::vector<EvaluationTrial> trials(static_cast<std::size_t>(out.trials));
    const auto worker = [&] {
        return [&, measurers = std::make_shared<Measurers>(make_measurers(taught)),
                frame = std::make_shared<Frame>()](std::size_t i) {
            Random random(hash64(cell.settings.seed, method.in_motion ? 8 : 9), i);
            const auto part = [&](double reach) {
                const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach),
                             z = random.uniform(-reach, reach);
                return Eigen::Vector3d(x, y, z);
            };
            const Eigen::Vector3d move = part(10), turn = part(rad_from_deg(1));
            run_trial(cell, method, taught, *measurers, turned_about_middle(move, turn), random, *frame,
                      trials[i]);
        };
    };
    spread_values(cell.settings, *cell.profiles, trials.size(), worker,
                  [&](PartValue& part, std::size_t i) { hand_over(part, trials[i]); });
    double sum = 0;
    for (const EvaluationTrial& t : trials) sum += t.nees;
    const int refused = refused_of(trials);
    out.refused += refused;
    if (method.in_motion) out.three_sigma_mm = summary_of(trials).three_sigma;
    return sum / std::max(1, out.trials - refused);
}

struct Source {
    const char* name;
    double noise, robot, jitter, bend, calibration;
};

// Each source alone, with spots taught with all of them. Measures without noise still leave what the learnt
// curve and the template do not say about a displaced curved contour.
Expected<std::vector<BudgetLine>> error_budget(const EvaluationSettings& s, const Method& method,
                                               const TaughtCell& taught, std::atomic<std::size_t>& profiles) {
    std::vector<BudgetLine> lines;
    double nothing = 0, squares = 0;
    for (const Source& source :
         {Source{"curvature of the contour, nothing else", 0, 0, 0, 0, 0},
          Source{"sensor noise", s.noise_mm, 0, 0, 0, 0},
          Source{"robot repeatability", 0, s.repeatability_mm, 0, 0, 0},
          Source{"trigger jitter", 0, 0, s.jitter_mm, 0, 0}, Source{"calibration error", 0, 0, 0, 0, 1},
          Source{"deformed part", 0, 0, 0, kBudgetBendMm, 0}}) {
        EvaluationSettings alone = s;
        alone.noise_mm = std::max(1e-4, source.noise);
        alone.repeatability_mm = source.robot;
        alone.jitter_mm = source.jitter;
        alone.bend_mm = source.bend;
        alone.calibration_mm = source.calibration * kBudgetCalibrationMm;
        alone.calibration_deg = source.calibration * kBudgetCalibrationDeg;
        Cell cell = door_cell(alone, profiles);
        cell.stated_jitter_mm = s.jitter_mm;  // the weights stay those of the experiment
        std::vector<EvaluationTrial> trials;
        if (source.calibration > 0) {  // it is there when teaching, too
            EvaluationSettings teaching = s;
            teaching.calibration_mm = alone.calibration_mm;
            teaching.calibration_deg = alone.calibration_deg;
            SEAM_TRY(const auto erring, teach_all(door_cell(teaching, profiles), method));
            run_column(cell, method, erring, 2, trials);
        } else {
            run_column(cell, method, taught, 2, trials);
        }
        BudgetLine line{source.name, summary_of(trials).three_sigma, stated_three_sigma(trials), 0};
        if (lines.empty()) nothing = line.three_sigma_mm;
        line.adds_mm =
            lines.empty()
                ? nothing
                : std::sqrt(std::max(0.0, line.three_sigma_mm * line.three_sigma_mm - nothing * nothing));
        squares += line.adds_mm * line.adds_mm;
        lines.push_back(std::move(line));
    }
    lines.push_back(
        {"all of them, root of the sum of squares", std::sqrt(squares), std::nan(""), std::sqrt(squares)});
    return lines;
}

}  // namespace

Expected<StraightTrials> straight_trials(const EvaluationSettings& settings,
                                         std::atomic<std::size_t>& profiles) {
    StraightTrials out;
    out.trials = settings.trials;
    Cell cell = straight_cell(settings, profiles);
    Method method = kMethods[2];
    // The model of a straight contour: what the teaching pass found beside it is noise.
    const auto teach = [&] {
        auto cells = teach_all(cell, method);
        if (cells)
            for (std::size_t n = 0; n < cells->spots.size(); ++n) {
                cells->spots[n].spot.curve.reset();
                cells->project.spots[n].curve.reset();
            }
        return cells;
    };
    cell.settings.repeatability_mm = 0;
    SEAM_TRY(const auto steady, teach());
    noise_alone(cell, steady, out);
    cell.settings.repeatability_mm = settings.repeatability_mm;
    SEAM_TRY(auto taught, teach());
    out.nees_in_motion = displaced_nees(cell, method, taught, out);
    method.in_motion = false;
    for (Spot& s : taught.project.spots) s.stop_at_trigger = true;
    out.nees_still = displaced_nees(cell, method, taught, out);
    return out;
}

Expected<EvaluationResult> evaluate(const EvaluationSettings& settings,
                                    const std::function<void(const std::string&)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    EvaluationResult out;
    out.settings = settings;
    if (out.settings.jobs <= 0)
        out.settings.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    std::atomic<std::size_t> profiles{0};
    const Cell door = door_cell(out.settings, profiles);
    for (const Method& method : kMethods) {
        if (settings.experiment != 0 && settings.experiment != method.number) continue;
        progress(fmt::format("experiment {}: {}", method.number, method.name));
        TaughtCell taught;
        SEAM_TRY(auto result, run_experiment(door, method, taught));
        out.experiments.push_back(std::move(result));
        if (!method.matched) continue;
        progress("error budget");
        SEAM_TRY(auto budget, error_budget(out.settings, method, taught, profiles));
        out.budget = std::move(budget);
        progress("straight contours: Cramer-Rao bound and NEES");
        SEAM_TRY(auto straight, straight_trials(out.settings, profiles));
        out.straight = straight;
        progress("curved contours");
        for (const double radius : kCurveRadiiMm) {
            SEAM_TRY(auto curved, curved_contour(out.settings, radius, profiles));
            out.curved.push_back(std::move(curved));
        }
    }
    if (settings.experiment == 0 || settings.experiment == kOnline) {
        progress("online correction against the offline method");
        SEAM_TRY(auto online, online_experiment(out.settings, profiles));
        out.online = std::move(online);
    }
    if (settings.parts) SEAM_OK(settings.parts->check());
    out.settings.parts = nullptr;
    out.profiles = profiles;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
}

}  // namespace seamwright::evaluation
