// The budget's shares are the covariance that the correction states, each share what its source alone does, and
// drawn corrections scatter as it says.

#include "core/correction/budget/budget.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <set>

#include "core/correction/budget/monte_carlo.h"
#include "core/correction/predicted.h"
#include "core/correction/travel.h"
#include "tests/core/correction/trials.h"

namespace seamwright {
namespace {

using namespace testing_doors;

const Eigen::Vector3d kCentre(900, -400, 250);

Displacement moved(Rng& rng, double mm, double deg) {
    const Eigen::Matrix3d r = rotation_exp(rad_from_deg(deg) * gaussian(rng).normalized());
    return {make_pose(r, mm * gaussian(rng).normalized() + kCentre - r * kCentre)};
}

std::vector<BudgetSpot> budget_spots(const std::vector<SpotObservation>& spots) {
    std::vector<BudgetSpot> all;
    for (const SpotObservation& s : spots) all.push_back({s, 0, 0});
    return all;
}

// What the correction of the displaced part states.
RegionCorrection stated(const std::vector<BudgetSpot>& spots, const CorrectionOptions& options,
                        const Displacement& d) {
    std::vector<SpotObservation> measured;
    for (const BudgetSpot& b : spots) {
        measured.push_back(b.spot);
        measured.back().measured_mm = displaced_measure(b.spot, d);
        add_travel(measured.back(), d, b.half_window_mm);
    }
    const auto solved = solve_region(measured, options);
    EXPECT_TRUE(solved) << solved.error().sentence();
    return *solved;
}

void expect_equal(const Matrix6& a, const Matrix6& b, double relative = 1e-9) {
    const Vector6 size = b.diagonal().cwiseSqrt().cwiseMax(1e-9);  // what is fixed is 0
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(a(i, k), b(i, k), relative * size[i] * size[k]) << i << k;
}

// A correction states its covariance one step of its solver before where it ends (some 1e-5 mm); as taught it is
// where it ends.
constexpr double kLastStep = 1e-6;
double to_what(const Displacement& d) {
    return d.workobject_from_movedworkobject.matrix().isIdentity(0) ? 1e-9 : kLastStep;
}

// As the correction's own sum at exactly this displacement.
PredictedCovariance predicted(const std::vector<BudgetSpot>& spots, const CorrectionOptions& options,
                              const Displacement& d) {
    std::vector<SpotObservation> all;
    for (const BudgetSpot& b : spots) {
        all.push_back(b.spot);
        all.back().measured_mm = displaced_measure(b.spot, d);
        add_travel(all.back(), d, b.half_window_mm);
    }
    return *predicted_covariance(all, options, d);
}

void shares_add_up(unsigned seed, bool priors) {
    Rng rng(seed);
    int tried = 0;
    for (int i = 0; i < 60; ++i) {
        World w = world(rng, 4 + i % 6);
        if (!priors) {
            w.options.sensors.clear();
            for (SpotObservation& s : w.spots)
                s.sensor.clear(), s.reference_covariance_mm2.reset(), s.robot_covariance.reset();
        }
        if (i % 4 == 1)
            for (SpotObservation& s : w.spots) s.weights = {uniform(rng, 0.5, 2), 0, uniform(rng, 0.5, 2)};
        if (i % 4 == 2)
            for (SpotObservation& s : w.spots)
                s.covariance_mm2 = (Eigen::Matrix2d() << 0.002, 0.001, 0.001, 0.003).finished();
        if (i % 3 == 2) w.spots[1].curve = ContourCurve{{0.05, 1e-4, 0}, {0.02, 1e-4, 0}, -20, 20};
        if (i % 5 == 3) w.options.free = {true, true, true, true, true, false};
        if (i % 7 == 3) w.options.free = {true, true, false, true, true, true};
        std::vector<BudgetSpot> spots = budget_spots(w.spots);
        for (BudgetSpot& b : spots) {
            b.stated_sigma_mm = 0.5 * b.spot.sigma_mm;
            if (i % 2) b.half_window_mm = 2;
        }
        const Displacement d = i % 6 == 0 ? Displacement{} : moved(rng, 10, 1);
        const RegionCorrection correction = stated(spots, w.options, d);
        if (correction.status != CorrectionStatus::ok) continue;  // a weak door
        // Angles that are fixed stand at 0, and the part has turned about them.
        if (w.options.free != kAllFree && i % 6 != 0) continue;
        ++tried;
        const auto budget = uncertainty_budget(spots, w.options, d);
        ASSERT_TRUE(budget && budget->determined);
        Matrix6 sum = Matrix6::Zero(), systematic = Matrix6::Zero();
        Eigen::Vector3d xyz = Eigen::Vector3d::Zero(), abc = xyz;
        for (const BudgetTerm& t : budget->terms) {
            sum += t.covariance;
            if (is_systematic(t.source)) systematic += t.covariance;
            xyz += t.sigma.xyz_mm.cwiseAbs2();
            abc += t.sigma.abc_deg.cwiseAbs2();
        }
        const PredictedCovariance at = predicted(spots, w.options, d);
        expect_equal(sum, at.sum);
        expect_equal(budget->covariance, at.sum);
        expect_equal(sum, correction.covariance, to_what(d));
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(systematic(k, k), at.systematic(k, k), 1e-9 * at.sum(k, k));
        EXPECT_EQ(systematic.isZero(0), !priors);
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(std::sqrt(xyz[k]), budget->sigma.xyz_mm[k], 1e-9 * budget->sigma.xyz_mm[k]);
            EXPECT_NEAR(std::sqrt(abc[k]), budget->sigma.abc_deg[k], 1e-9 * budget->sigma.abc_deg[k]);
            EXPECT_NEAR(budget->sigma.abc_deg[k], correction.sigma_abc_deg[k],
                        to_what(d) * correction.sigma_abc_deg[k]);
        }
    }
    EXPECT_GT(tried, 20);
}

TEST(Budget, SharesAddUpToWhatTheCorrectionStates) {
    shares_add_up(1, true);
}
TEST(Budget, SharesOfTriggerDriftAndWorkObjectAddUp) {
    Rng rng(21);
    for (int i = 0; i < 20; ++i) {
        World w = world(rng, 5 + i % 4);
        for (SensorPrior& p : w.options.sensors) {
            p.latency_sigma = 1;
            p.speed_sigma = 0.1;
            p.drift_sigma_mm = {0.03, 0.02, 0.04};
        }
        for (SpotObservation& s : w.spots) s.latency_travel_mm = uniform(rng, 0.2, 1);
        w.options.robot_drift_sigma_mm = 0.02;
        w.options.workobject_covariance = some_covariance(rng, 0.05, 0.02);
        if (i % 3 == 2) w.spots[1].curve = ContourCurve{{0.05, 1e-4, 0}, {0.02, 1e-4, 0}, -20, 20};
        const Displacement d = i % 4 == 0 ? Displacement{} : moved(rng, 10, 1);
        const auto spots = budget_spots(w.spots);
        const auto budget = uncertainty_budget(spots, w.options, d);
        ASSERT_TRUE(budget) << budget.error().sentence();
        if (!budget->determined) continue;
        Matrix6 sum = Matrix6::Zero(), systematic = Matrix6::Zero();
        std::set<ErrorSource> sources;
        for (const BudgetTerm& t : budget->terms) {
            sum += t.covariance;
            if (is_systematic(t.source)) systematic += t.covariance;
            sources.insert(t.source);
        }
        const PredictedCovariance at = predicted(spots, w.options, d);
        expect_equal(sum, at.sum);
        expect_equal(budget->covariance, at.sum);
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(systematic(k, k), at.systematic(k, k), 1e-9 * at.sum(k, k));
        for (const ErrorSource source : {ErrorSource::latency, ErrorSource::speed, ErrorSource::sensor_drift,
                                         ErrorSource::robot_drift, ErrorSource::workobject})
            EXPECT_TRUE(sources.count(source)) << to_string(source);
        // Where the part has not moved, latency and work object cost nothing; drift does.
        for (const BudgetTerm& t : budget->terms) {
            if (i % 4 != 0) continue;
            if (t.source == ErrorSource::latency || t.source == ErrorSource::workobject) {
                EXPECT_LT(t.covariance.diagonal().head<3>().maxCoeff(), 1e-12) << to_string(t.source);
            }
            if (t.source == ErrorSource::sensor_drift || t.source == ErrorSource::robot_drift) {
                EXPECT_GT(t.covariance.diagonal().head<3>().maxCoeff(), 1e-7) << to_string(t.source);
            }
        }
    }
}

TEST(Budget, SharesAddUpWithoutPriors) {
    shares_add_up(2, false);
}

TEST(Budget, FixedDegreesOfAnUnturnedPartAddUpToo) {
    Rng rng(3);
    World w = world(rng, 7);
    w.options.free = {true, true, true, false, false, true};
    const Displacement d{make_pose(Eigen::Matrix3d::Identity(), {8, -5, 3})};
    const auto spots = budget_spots(w.spots);
    const auto budget = uncertainty_budget(spots, w.options, d);
    const RegionCorrection correction = stated(spots, w.options, d);
    ASSERT_EQ(correction.status, CorrectionStatus::ok) << correction.message;
    Matrix6 sum = Matrix6::Zero();
    for (const BudgetTerm& t : budget->terms) sum += t.covariance;
    expect_equal(sum, predicted(spots, w.options, d).sum);
    expect_equal(sum, correction.covariance, to_what(d));
}

// Three spots, six numbers: whatever the sensor errs by goes into the displacement, by the closed form
// de = (I - R_A) rho + theta x y - R_A (theta x m).
TEST(Budget, HandEyeAloneIsTheClosedForm) {
    Rng rng(4);
    for (int i = 0; i < 10; ++i) {
        auto spots = door(rng, 3, kCentre);
        for (SpotObservation& s : spots) s.sigma_mm = 0.01, s.sensor = "A";
        CorrectionOptions options;
        options.sensors.push_back({"A", some_covariance(rng, 0.1, 0.1)});
        const Displacement moved_part = moved(rng, 15, 1);
        const Pose& d = moved_part.workobject_from_movedworkobject;
        const auto budget = uncertainty_budget(budget_spots(spots), options, moved_part);
        ASSERT_TRUE(budget) << budget.error().sentence();
        if (!budget->determined || budget->sigma.xyz_mm.maxCoeff() > 1) continue;
        const BudgetTerm* hand_eye = nullptr;
        for (const BudgetTerm& t : budget->terms) {
            EXPECT_TRUE(t.source == ErrorSource::hand_eye || t.source == ErrorSource::feature);
            if (t.source == ErrorSource::hand_eye) hand_eye = &t;
        }
        ASSERT_TRUE(hand_eye);
        const auto residual = [&](const Pose& at, const Eigen::Vector3d& m, const SpotObservation& s) {
            const Pose& w = s.workobject_from_sensor;
            return Eigen::Vector3d(s.reference_mm - w.inverse() * (at.inverse() * (w * m)));
        };
        Matrix6 by_pose, by_eye;
        for (std::size_t n = 0; n < 3; ++n) {
            const SpotObservation& s = spots[n];
            const Eigen::Vector3d m = displaced_measure(s, moved_part);
            const Pose a = s.workobject_from_sensor.inverse() * d.inverse() * s.workobject_from_sensor;
            for (int k = 0; k < 6; ++k) {
                const double step = k < 3 ? 1e-3 : 1e-6;
                const Vector6 delta = step * Vector6::Unit(k);
                const Eigen::Vector3d slope =
                    (residual(retract(d, delta), m, s) - residual(retract(d, -delta), m, s)) / (2 * step);
                const Vector6 eta = Vector6::Unit(k);
                const Eigen::Vector3d rho = eta.head<3>(), theta = eta.tail<3>();
                const Eigen::Vector3d de =
                    rho - a.linear() * rho + theta.cross(a * m) - a.linear() * theta.cross(m);
                for (int axis = 0; axis < 2; ++axis) {
                    by_pose(static_cast<int>(2 * n) + axis, k) = slope[2 * axis];
                    by_eye(static_cast<int>(2 * n) + axis, k) = de[2 * axis];
                }
            }
        }
        const Matrix6 pose_by_eye = by_pose.inverse() * by_eye;
        const Matrix6 expected =
            pose_by_eye * options.sensors[0].hand_eye_covariance * pose_by_eye.transpose();
        const Vector6 size = expected.diagonal().cwiseSqrt();
        for (int r = 0; r < 6; ++r)
            for (int c = 0; c < 6; ++c)
                EXPECT_NEAR(hand_eye->covariance(r, c), expected(r, c), 1e-6 * size[r] * size[c]);
        const auto as_taught = uncertainty_budget(budget_spots(spots), options, {});
        for (const BudgetTerm& t : as_taught->terms)
            EXPECT_EQ(t.covariance.isZero(0), t.source == ErrorSource::hand_eye);
    }
}

TEST(Budget, EachSourceStandsByItself) {
    Rng rng(5);
    World w = world(rng, 8);
    for (SpotObservation& s : w.spots)
        s.reference_covariance_mm2.reset(), s.robot_covariance.reset(), s.sensor.clear();
    w.options.sensors.clear();
    auto spots = budget_spots(w.spots);
    const Displacement d = moved(rng, 15, 1);
    const auto of = [&](ErrorSource source) {
        const auto budget = uncertainty_budget(spots, w.options, d);
        std::size_t n = 0;
        for (const BudgetTerm& t : budget->terms) n += t.source == source;
        return std::pair(n, budget->terms.size());
    };
    EXPECT_EQ(of(ErrorSource::feature), std::pair(std::size_t{8}, std::size_t{8}));
    for (BudgetSpot& b : spots) b.stated_sigma_mm = b.spot.sigma_mm;
    EXPECT_EQ(of(ErrorSource::stated), std::pair(std::size_t{8}, std::size_t{8}));
    spots[2].spot.robot_covariance = some_covariance(rng, 0.03, 0.01);
    EXPECT_EQ(of(ErrorSource::robot_run), std::pair(std::size_t{1}, std::size_t{10}));
    EXPECT_EQ(of(ErrorSource::robot_taught), std::pair(std::size_t{1}, std::size_t{10}));
    spots[2].spot.robot_covariance.reset();
    spots[1].half_window_mm = 3;
    EXPECT_EQ(of(ErrorSource::travel), std::pair(std::size_t{1}, std::size_t{9}));
}

TEST(Budget, RefusesWhatTheCorrectionRefuses) {
    EXPECT_FALSE(uncertainty_budget({}, {}, {}));
    Rng rng(6);
    auto spots = budget_spots(door(rng, 4));
    spots[1].spot.sigma_mm = std::nan("");
    EXPECT_FALSE(uncertainty_budget(spots, {}, {}));
    auto parallel = budget_spots({spot("a", {0, 0, 0}, {0, 1, 0}), spot("b", {500, 0, 0}, {0, 1, 0}),
                                  spot("c", {0, 400, 0}, {0, 1, 0})});
    const auto budget = uncertainty_budget(parallel, {}, {});
    ASSERT_TRUE(budget);
    EXPECT_FALSE(budget->determined);
}

// The whole estimator on drawn calibrations, references, arrivals and noise, at 15 mm and 1 degree.
TEST(MonteCarlo, TheCorrectionScattersAsTheBudgetSays) {
    Rng rng(7);
    const World w = world(rng, 8, {0.1, 0.1, 0.001, 0.001, 0.03, 0.02, 0.005, 0.03});
    auto spots = budget_spots(w.spots);
    for (BudgetSpot& b : spots) b.half_window_mm = 1, b.stated_sigma_mm = 0.02;
    const Displacement d = moved(rng, 15, 1);
    const auto budget = uncertainty_budget(spots, w.options, d);
    ASSERT_TRUE(budget && budget->determined);
    CorrectionDraws draws(spots, w.options, d, 1);
    RegionSolver solver;
    RegionCorrection result;
    MonteCarloOptions options;
    options.most = 20000;
    const MonteCarlo mc = monte_carlo(6, options, [&](std::span<double> out) {
        auto& drawn = draws.next();
        for (SpotObservation& s : drawn) add_travel(s, d, 1);
        if (!solver.solve(drawn, w.options, result) || result.status != CorrectionStatus::ok) return false;
        const Vector6 e = difference(result.displacement.workobject_from_movedworkobject,
                                     d.workobject_from_movedworkobject);
        for (int k = 0; k < 6; ++k) out[static_cast<std::size_t>(k)] = e[k];
        return true;
    });
    EXPECT_EQ(mc.trials, 20000u);
    EXPECT_FALSE(mc.settled);
    EXPECT_LT(mc.failed, 5u);
    for (int k = 0; k < 6; ++k) {
        const MonteCarloFigure& f = mc.figures[static_cast<std::size_t>(k)];
        const double u = std::sqrt(budget->covariance(k, k));
        EXPECT_NEAR(f.u / u, 1, 0.03) << k;
        EXPECT_NEAR(f.mean / u, 0, 0.06) << k;
        EXPECT_NEAR(f.high / u, 1.96, 0.1) << k;
        EXPECT_NEAR(f.low / u, -1.96, 0.1) << k;
    }
}

TEST(MonteCarlo, KnownDistributionsAndTheirLimits) {
    std::mt19937_64 rng(8);
    std::normal_distribution<double> normal(3, 2);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::size_t told = 0;
    MonteCarloOptions options;
    options.progress = [&](std::size_t trials) { told = trials; };
    const MonteCarlo mc = monte_carlo(2, options, [&](std::span<double> out) {
        out[0] = normal(rng);
        out[1] = uniform(rng);
        return true;
    });
    EXPECT_TRUE(mc.settled);
    EXPECT_EQ(told, mc.trials);
    // A limit of 2.5 % of M normal values stands to 2.67 u / sqrt(M): twice that is 1 % at 285 000.
    EXPECT_GT(mc.trials, 100000u);
    EXPECT_LT(mc.trials, 700000u);
    EXPECT_NEAR(mc.figures[0].mean, 3, 0.03);
    EXPECT_NEAR(mc.figures[0].u, 2, 0.02);
    EXPECT_NEAR(mc.figures[0].low, 3 - 2 * 1.95996, 0.04);
    EXPECT_NEAR(mc.figures[0].high, 3 + 2 * 1.95996, 0.04);
    EXPECT_NEAR(mc.figures[1].u, 1 / std::sqrt(3.0), 0.005);
    EXPECT_NEAR(mc.figures[1].low, -0.95, 0.005);
}

TEST(MonteCarlo, EndsAtItsCapAndCountsWhatFailed) {
    MonteCarloOptions options;
    options.most = 50000;
    int i = 0;
    const MonteCarlo none = monte_carlo(1, options, [&](std::span<double>) { return false; });
    EXPECT_EQ(none.trials, 50000u);
    EXPECT_EQ(none.failed, 50000u);
    EXPECT_FALSE(none.settled);
    EXPECT_EQ(none.figures[0].u, 0);
    // Always the same value: it stands at once.
    const MonteCarlo same = monte_carlo(1, options, [&](std::span<double> out) {
        out[0] = 5;
        return ++i % 2 == 0;
    });
    EXPECT_TRUE(same.settled);
    EXPECT_EQ(same.failed, same.trials / 2);
    EXPECT_NEAR(same.figures[0].mean, 5, 1e-9);
}

}  // namespace
}  // namespace seamwright
