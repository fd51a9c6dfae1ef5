// Errors that repeat: zero priors change nothing, the linearised terms are the derivatives, what is no prior
// is refused, the stated parts add up.

#include "core/correction/nuisance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>

#include "core/correction/predicted.h"
#include "tests/core/correction/trials.h"

namespace seamwright {
namespace {

using namespace testing_doors;

void expect_same(const RegionCorrection& a, const RegionCorrection& b) {
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.displacement.workobject_from_movedworkobject.matrix(),
              b.displacement.workobject_from_movedworkobject.matrix());
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.covariance_random, b.covariance_random);
    EXPECT_EQ(a.covariance_systematic, b.covariance_systematic);
    EXPECT_EQ(a.sigma_xyz_mm, b.sigma_xyz_mm);
    EXPECT_EQ(a.sigma_abc_deg, b.sigma_abc_deg);
    EXPECT_EQ(a.sigma_at_spots_mm, b.sigma_at_spots_mm);
    EXPECT_EQ(a.rms_mm, b.rms_mm);
    EXPECT_EQ(a.variance_factor, b.variance_factor);
    EXPECT_EQ(a.consistent, b.consistent);
    EXPECT_EQ(a.message, b.message);
    EXPECT_EQ(a.iterations, b.iterations);
    for (std::size_t n = 0; n < a.spots.size(); ++n) {
        EXPECT_EQ(a.spots[n].residual_mm, b.spots[n].residual_mm);
        EXPECT_EQ(a.spots[n].used, b.spots[n].used);
    }
}

TEST(Nuisance, PriorsOfZeroChangeNotABit) {
    Rng rng(1);
    for (int i = 0; i < 60; ++i) {
        auto spots = door(rng, 3 + i % 9, {900, -400, 250});
        measure(spots, random_displacement(rng, 10, 1, {900, -400, 250}));
        add_noise(spots, rng, 0.05);
        if (i % 4 == 1) spots[1].measured_mm.x() += 4;
        if (i % 3 == 1)
            for (SpotObservation& s : spots) s.weights = {uniform(rng, 0.5, 2), 0, uniform(rng, 0.5, 2)};
        if (i % 3 == 2)
            for (SpotObservation& s : spots)
                s.covariance_mm2 = (Eigen::Matrix2d() << 0.002, 0.001, 0.001, 0.003).finished();
        if (i % 5 == 2) spots[0].curve = ContourCurve{{0.01, 1e-4, 0}, {0, 1e-4, 0}, -20, 20};
        CorrectionOptions options;
        if (i % 7 == 3) options.free = {true, true, true, true, false, false};
        auto with = spots;
        CorrectionOptions priors = options;
        priors.sensors.resize(2);
        priors.sensors[0].id = "A";
        priors.sensors[1].id = "B";
        for (std::size_t n = 0; n < with.size(); ++n) {
            with[n].sensor = n % 2 ? "A" : "B";
            with[n].reference_covariance_mm2 = Eigen::Matrix2d::Zero();
            with[n].robot_covariance = Matrix6::Zero();
        }
        const auto a = solve_region(spots, options), b = solve_region(with, priors);
        ASSERT_TRUE(a && b) << b.error().sentence();
        expect_same(*a, *b);
        EXPECT_EQ(b->covariance_random, b->covariance);
        EXPECT_EQ(b->covariance_systematic, Matrix6::Zero());
        EXPECT_EQ(plan_region(spots, options)->covariance, plan_region(with, priors)->covariance);
        EXPECT_EQ(plan_region(spots, options)->advice, plan_region(with, priors)->advice);
    }
}

// A reference that is the mean of n arrivals errs by the n-th part of one arrival's variance; the run still arrives once.
TEST(Nuisance, TheMeanOfManyArrivalsLeavesTheShareOfOne) {
    Rng rng(11);
    auto spots = door(rng, 8, {900, -400, 250});
    measure(spots, Pose::Identity());
    for (SpotObservation& s : spots) {
        s.sigma_mm = 0.02;
        s.robot_covariance = Matrix6::Zero();
        s.robot_covariance->topLeftCorner<3, 3>().diagonal().setConstant(0.03 * 0.03);
    }
    const auto solve = [&](int arrivals) {
        for (SpotObservation& s : spots) s.reference_arrivals = arrivals;
        const auto solved = solve_region(spots, {});
        EXPECT_TRUE(solved) << solved.error().sentence();
        return *solved;
    };
    const RegionCorrection one = solve(1), four = solve(4);
    EXPECT_LT((four.covariance_systematic - one.covariance_systematic / 4).norm(),
              1e-6 * one.covariance_systematic.norm());
    EXPECT_LT((four.covariance_random - one.covariance_random).norm(), 1e-6 * one.covariance_random.norm());
    EXPECT_GT(one.covariance_systematic(0, 0), 0);
    spots[2].reference_arrivals = 0;
    EXPECT_FALSE(solve_region(spots, {}));
}

// A sensor whose errors are known to be tiny gives the answer of one without, by another way.
TEST(Nuisance, PriorsOfNearlyZeroChangeNearlyNothing) {
    Rng rng(2);
    for (int i = 0; i < 40; ++i) {
        Sizes tiny{1e-7, 1e-7, 1e-9, 1e-9, 1e-8, 1e-8, 1e-8, 0.05};
        World w = world(rng, 4 + i % 6, tiny);
        const Pose d = random_displacement(rng, 10, 1, {900, -400, 250});
        Trial trial(rng, w);
        auto spots = trial.measure(rng, d);
        if (i % 3 == 1)
            for (SpotObservation& s : spots) s.weights = {uniform(rng, 0.5, 2), 0, uniform(rng, 0.5, 2)};
        if (i % 3 == 2)
            for (SpotObservation& s : spots) s.curve = ContourCurve{{0.01, 1e-4, 0}, {0, 1e-4, 0}, -20, 20};
        if (i % 4 == 3) w.options.free = {true, true, true, true, true, false};
        w.options.reject_outliers = false;
        const auto with = solve_region(spots, w.options);
        for (SpotObservation& s : spots) {
            s.sensor.clear();
            s.reference_covariance_mm2.reset();
            s.robot_covariance.reset();
        }
        w.options.sensors.clear();
        const auto without = solve_region(spots, w.options);
        ASSERT_TRUE(with && without);
        ASSERT_EQ(with->status, without->status) << with->message;
        if (with->status != CorrectionStatus::ok) continue;
        EXPECT_LT(distance_mm(with->displacement.workobject_from_movedworkobject,
                              without->displacement.workobject_from_movedworkobject),
                  1e-4);
        EXPECT_LT((with->covariance - without->covariance).norm(), 1e-4 * without->covariance.norm());
        EXPECT_NEAR(with->variance_factor, without->variance_factor, 1e-4 * without->variance_factor);
        EXPECT_LT(with->sigma_systematic.xyz_mm.norm(), 1e-3 * with->sigma_xyz_mm.norm());
    }
}

TEST(Nuisance, TermsAreTheDerivativesOfTheResidual) {
    Rng rng(3);
    correction::SharedRoot unit;
    unit.hand_eye.setIdentity();
    unit.scale.setOnes();
    unit.drift.setOnes();
    unit.latency = unit.speed = 1;
    for (int i = 0; i < 50; ++i) {
        const Pose w = make_pose(any_rotation(rng), 500 * gaussian(rng));
        const Pose d = random_displacement(rng, 15, 3, w.translation());
        const Eigen::Vector3d r(uniform(rng, -20, 20), uniform(rng, -1, 1), uniform(rng, -15, 15));
        const Eigen::Vector3d m = r + 5 * gaussian(rng);
        const double travel = uniform(rng, -2, 2);
        const auto residual = [&](const Eigen::Matrix<double, correction::kShared, 1>& b) {
            const Pose eye = make_pose(rotation_exp(b.segment<3>(3)), b.head<3>());
            Eigen::Matrix3d bent = Eigen::Matrix3d::Identity();
            bent(0, 0) += b[6];
            bent(2, 2) += b[7];
            bent(0, 2) += b[8];
            const Pose there = w * eye;
            // A latency puts both cuts further along, the run's by another share where it is driven at another speed.
            const Eigen::Vector3d taught = bent * r + travel * b[9] * Eigen::Vector3d::UnitY();
            const Eigen::Vector3d seen =
                bent * m + travel * (b[9] + b[10]) * Eigen::Vector3d::UnitY() + b.tail<3>();
            return Eigen::Vector3d(taught - there.inverse() * (d.inverse() * (there * seen)));
        };
        correction::SharedGeometry g;
        g.axes = w.linear();
        g.origin = w.translation();
        g.reference = r;
        g.measured = m;
        g.latency_travel = travel;
        const Eigen::Vector3d y = w.inverse() * (d.inverse() * (w * m));
        for (int k = 0; k < correction::kShared; ++k) {
            const double h = k < 3 || k >= correction::kLatencyAt ? 1e-3 : 1e-6;
            Eigen::Matrix<double, correction::kShared, 1> b =
                Eigen::Matrix<double, correction::kShared, 1>::Zero();
            b[k] = h;
            const Eigen::Vector3d slope = (residual(b) - residual(-b)) / (2 * h);
            for (int axis = 0; axis < 3; ++axis) {
                correction::SharedVector row;
                correction::shared_row(g, unit, Eigen::Vector3d::Unit(axis),
                                       d.linear() * w.linear().col(axis), y, row.data());
                EXPECT_NEAR(row[k], slope[axis], 1e-6 * (1 + slope.norm())) << k << " " << axis;
            }
        }
    }
}

TEST(Nuisance, OneArrivalMovesAPointAsStated) {
    Rng rng(4);
    const Pose w = make_pose(any_rotation(rng), 500 * gaussian(rng));
    const Matrix6 c = some_covariance(rng, 0.05, 0.1);
    const Eigen::Vector3d p(12, 0.5, -9);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    constexpr int kDraws = 20000;
    for (int i = 0; i < kDraws; ++i) {
        const Vector6 off = draw<6>(rng, c);
        const Eigen::Vector3d moved =
            rotation_exp(off.tail<3>()) * (w.linear() * p) + w.translation() + off.head<3>();
        const Eigen::Vector3d e = w.inverse() * moved - p;
        scatter += e * e.transpose() / kDraws;
    }
    const Matrix6 along = correction::arrival_along_sensor(w, c);
    const Eigen::Matrix3d stated = correction::arrival_covariance(along, p);
    Eigen::Matrix3d flat = stated;  // without the travel: x and z alone
    flat.row(1).setZero();
    flat.col(1).setZero();
    EXPECT_LT((correction::arrival_covariance(along, p, false) - flat).norm(), 1e-12);
    EXPECT_LT((scatter - stated).norm(), 0.04 * stated.norm());
}

TEST(Nuisance, TheTangentOfThePoseIsTurnedIntoTheSensor) {
    Rng rng(5);
    const Pose f = make_pose(any_rotation(rng), 200 * gaussian(rng));
    const Matrix6 c = some_covariance(rng, 0.05, 0.1);
    const Vector6 delta = 1e-6 * draw<6>(rng, c);
    const Pose eye = f.inverse() * retract(f, delta);
    Vector6 eta;
    eta << eye.translation(), rotation_log(eye.linear());
    const Matrix6 turned = hand_eye_along_sensor(f, delta * delta.transpose());
    EXPECT_LT((turned - eta * eta.transpose()).norm(), 1e-6 * turned.norm());
}

TEST(Nuisance, PartsAddUpAndGrowWithTheDisplacement) {
    Rng rng(6);
    const World w = world(rng, 8);
    Trial trial(rng, w);
    double before = 0;
    for (const double mm : {0.0, 5.0, 15.0}) {
        const Pose d = make_pose(rotation_exp({0, 0, 1e-3 * mm}), {mm, -0.5 * mm, 0});
        const auto solved = solve_region(trial.measure(rng, d), w.options);
        ASSERT_TRUE(solved);
        ASSERT_EQ(solved->status, CorrectionStatus::ok) << solved->message;
        EXPECT_LT((solved->covariance_random + solved->covariance_systematic - solved->covariance).norm(),
                  1e-9 * solved->covariance.norm());
        EXPECT_GT(solved->covariance_systematic.trace(), before);
        before = solved->covariance_systematic.trace();
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(std::hypot(solved->sigma_random.xyz_mm[i], solved->sigma_systematic.xyz_mm[i]),
                        solved->sigma_xyz_mm[i], 1e-9);
            EXPECT_NEAR(std::hypot(solved->sigma_random.abc_deg[i], solved->sigma_systematic.abc_deg[i]),
                        solved->sigma_abc_deg[i], 1e-9);
        }
        // The forecast knows it beforehand.
        const auto forecast = predicted_covariance(w.spots, w.options, {d});
        ASSERT_TRUE(forecast);
        EXPECT_LT((forecast->sum - solved->covariance).norm(), 0.02 * solved->covariance.norm());
        EXPECT_LT((forecast->systematic - solved->covariance_systematic).norm(),
                  0.02 * solved->covariance_systematic.norm());
    }
}

// Drawn from what happens: sensors that have moved since the check, a robot that has wandered, cuts further along the
// travel than the controller told, a path laid in another work object.
TEST(Nuisance, TriggerDriftAndWorkObjectCoverAsStated) {
    Rng rng(13);
    std::normal_distribution<double> normal;
    constexpr int kTrials = 1500;
    const Eigen::Vector3d middle(900, -400, 250), bead(1300, -150, 250);
    int trials = 0, inside = 0;
    std::array<int, 6> dof{};
    while (trials < kTrials) {
        World w = world(rng, 8);
        w.options.sensors.resize(1);
        SensorPrior& p = w.options.sensors[0];
        p = SensorPrior{};
        p.id = "A";
        p.latency_sigma = 1;
        p.speed_sigma = 0.2;
        p.drift_sigma_mm = {0.05, 0.03, 0.04};
        w.options.robot_drift_sigma_mm = 0.03;
        w.options.workobject_covariance = some_covariance(rng, 0.05, 0.03);
        const Pose d = random_displacement(rng, 15, 1.5, middle);
        const double late = normal(rng), faster = 0.2 * normal(rng), robot = 0.03;
        const Eigen::Vector3d drift(0.05 * normal(rng), 0.03 * normal(rng), 0.04 * normal(rng)),
            wandered(robot * normal(rng), robot * normal(rng), robot * normal(rng));
        for (SpotObservation& s : w.spots) {
            s.sensor = "A";
            s.sigma_mm = 0.02;
            s.reference_covariance_mm2.reset();
            s.robot_covariance.reset();
            s.latency_travel_mm = uniform(rng, 0.5, 2);
            const Pose& at = s.workobject_from_sensor;
            const Eigen::Vector3d point = at * s.reference_mm, along = at.linear().col(1);
            const auto cut = [&](const Pose& moved, double share) {
                Pose plane = at;
                plane.translation() += share * s.latency_travel_mm * along;
                return Eigen::Vector3d(pierced(plane, moved * point, moved.linear() * along));
            };
            // The robot stands where it has wandered to, so that the part seems to stand back by as much.
            Pose seen = d;
            seen.translation() -= wandered;
            s.reference_mm = cut(Pose::Identity(), late);
            const Eigen::Vector3d e = s.sigma_mm * gaussian(rng);
            s.measured_mm = cut(seen, late + faster) - drift + Eigen::Vector3d(e.x(), 0, e.z());
            s.measured_mm.y() = 0;
            s.reference_mm.y() = 0;
        }
        const auto solved = solve_region(w.spots, w.options);
        ASSERT_TRUE(solved) << solved.error().sentence();
        if (solved->status != CorrectionStatus::ok) continue;
        ++trials;
        const Vector6 eta = draw<6>(rng, w.options.workobject_covariance);
        const Pose off = make_pose(rotation_exp(eta.tail<3>()), eta.head<3>());
        const Pose laid = off * solved->displacement.workobject_from_movedworkobject * off.inverse();
        const Vector6 miss = difference(d, laid);
        for (int i = 0; i < 6; ++i)
            dof[static_cast<std::size_t>(i)] +=
                std::abs(miss[i]) <= 1.96 * std::sqrt(solved->covariance(i, i));
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(laid.linear() * bead);
        const Eigen::Matrix3d c = j * solved->covariance * j.transpose();
        const Eigen::Vector3d there = d * bead - laid * bead;
        inside += there.dot(Eigen::Vector3d(c.ldlt().solve(there))) <= 7.8147;
    }
    for (const int count : dof) {
        EXPECT_GE(count, 0.93 * kTrials);
        EXPECT_LE(count, 0.97 * kTrials);
    }
    EXPECT_GE(inside, 0.93 * kTrials);
    EXPECT_LE(inside, 0.97 * kTrials);
}

TEST(Nuisance, AWrongSpotIsStillNamedAndAGoodOneNotAccused) {
    Rng rng(7);
    int accused = 0, missed = 0;
    for (int i = 0; i < 300; ++i) {
        const World w = world(rng, 9);
        Trial trial(rng, w);
        const Pose d = random_displacement(rng, 15, 1, {900, -400, 250});
        auto spots = trial.measure(rng, d);
        const auto good = solve_region(spots, w.options);
        ASSERT_TRUE(good);
        for (const SpotResidual& s : good->spots) accused += !s.used;
        spots[4].measured_mm.x() += 5;
        const auto bad = solve_region(spots, w.options);
        ASSERT_TRUE(bad);
        missed += bad->spots[4].used && bad->status == CorrectionStatus::ok && bad->consistent;
    }
    EXPECT_LE(accused, 3);  // significance 1e-3 of a region
    EXPECT_EQ(missed, 0);
}

TEST(Nuisance, WhatIsNoPriorIsRefused) {
    Rng rng(8);
    const World good = world(rng, 6);
    Trial trial(rng, good);
    const auto spots = trial.measure(rng, Pose::Identity());
    ASSERT_TRUE(solve_region(spots, good.options));
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    const auto refused = [&](const auto& spoil, const char* where) {
        auto s = spots;
        auto o = good.options;
        spoil(s, o);
        for (const bool plan : {false, true}) {
            std::optional<Error> error;
            if (plan) {
                if (const auto r = plan_region(s, o); !r) error = r.error();
            } else if (const auto r = solve_region(s, o); !r) {
                error = r.error();
            }
            ASSERT_TRUE(error) << where;
            EXPECT_NE(error->where.english().find(where), std::string::npos) << error->sentence();
            EXPECT_FALSE(error->mend.empty());
        }
    };
    using S = std::vector<SpotObservation>;
    using O = CorrectionOptions;
    for (const double bad : {nan, inf, -1.0, 1e9}) {
        refused([&](S& s, O&) { (*s[2].reference_covariance_mm2)(0, 0) = bad; }, "reference_covariance_mm2");
        refused([&](S& s, O&) { (*s[2].robot_covariance)(4, 4) = bad; }, "robot_covariance");
        refused([&](S&, O& o) { o.sensors[1].hand_eye_covariance(1, 1) = bad; }, "hand_eye_covariance");
        refused([&](S&, O& o) { o.sensors[1].scale_sigma.y() = bad; }, "scale_sigma");
        refused([&](S&, O& o) { o.sensors[1].shear_sigma = bad; }, "shear_sigma");
    }
    refused([&](S& s, O&) { (*s[2].reference_covariance_mm2)(0, 1) += 1e-4; }, "reference_covariance_mm2");
    refused([&](S& s, O&) { (*s[2].robot_covariance)(0, 5) += 1e-4; }, "robot_covariance");
    // Indefinite although every correlation is below 1.
    refused(
        [&](S&, O& o) {
            Matrix6 c = Matrix6::Identity();
            c(0, 1) = c(1, 0) = c(1, 2) = c(2, 1) = 0.9;
            c(0, 2) = c(2, 0) = -0.9;
            o.sensors[0].hand_eye_covariance = 1e-4 * c;
        },
        "hand_eye_covariance");
    // A variance of 0 with a correlation.
    refused([&](S& s, O&) { *s[0].reference_covariance_mm2 << 0, 1e-6, 1e-6, 1; },
            "reference_covariance_mm2");
    refused([&](S& s, O&) { s[3].sensor = "C"; }, "sensor");
    refused([&](S& s, O&) { s[3].sensor.clear(); }, "sensor");
    refused([&](S&, O& o) { o.sensors.clear(); }, "sensor");
    refused([&](S&, O& o) { o.sensors[1].id = "A"; }, "sensors");
    // Known exactly in some directions is fine.
    auto o = good.options;
    o.sensors[0].hand_eye_covariance.setZero();
    o.sensors[0].hand_eye_covariance.topLeftCorner<2, 2>().setConstant(1e-4);
    auto s = spots;
    *s[1].reference_covariance_mm2 << 1e-4, 0, 0, 0;
    s[2].robot_covariance->setZero();
    (*s[2].robot_covariance)(2, 2) = 1e-4;
    EXPECT_TRUE(solve_region(s, o));
}

}  // namespace
}  // namespace seamwright
