// Known displacements, limits, free degrees, refusals and hostile input of solve_region.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/correction/correction.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/notation.h"
#include "tests/core/correction/doors.h"
#include "tests/core/english.h"

namespace seamwright {
namespace {

using namespace testing_doors;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

RegionCorrection solved(const std::vector<SpotObservation>& spots, const CorrectionOptions& options = {}) {
    auto r = solve_region(spots, options);
    EXPECT_TRUE(r.has_value()) << (r ? "" : r.error().sentence());
    return r ? *r : RegionCorrection{};
}

struct Case {
    double mm, deg;
    Eigen::Vector3d offset;
};

// Weak random doors of few spots may be refused, but only those; every solved one is exact.
TEST(SolveRegion, RecoversRandomDoorsWithoutNoise) {
    Rng rng(1);
    for (const Case& c : {Case{10, 1, {0, 0, 0}}, Case{50, 20, {0, 0, 0}}, Case{10, 1, {2000, -1500, 800}},
                          Case{50, 20, {-3000, 4000, 1000}}}) {
        int refused = 0;
        for (int trial = 0; trial < 200; ++trial) {
            const int n = 4 + trial % 17;
            std::vector<SpotObservation> spots = door(rng, n, c.offset);
            for (SpotObservation& s : spots) {
                if (rng() % 4 == 0) s.weights = {1, 1, 1};
            }
            const Pose truth = random_displacement(rng, c.mm, c.deg, c.offset);
            measure(spots, truth);
            const RegionCorrection r = solved(spots);
            if (r.status == CorrectionStatus::under_determined) {
                ++refused;
                EXPECT_LE(n, 6);
                EXPECT_FALSE(r.unobservable.empty());
                EXPECT_TRUE(r.displacement.workobject_from_movedworkobject.isApprox(Pose::Identity(), 0));
                continue;
            }
            ASSERT_EQ(r.status, CorrectionStatus::ok) << r.message;
            const Pose& d = r.displacement.workobject_from_movedworkobject;
            EXPECT_LT(angle_rad(d, truth), 1e-10);
            for (const SpotObservation& s : spots) {
                const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
                EXPECT_LT((d * p - truth * p).norm(), 1e-8);
            }
            EXPECT_LT(distance_mm(d, truth), 1e-6);
            EXPECT_LT(r.rms_mm, 1e-9);
            for (const SpotResidual& s : r.spots) EXPECT_TRUE(s.used);
        }
        EXPECT_LE(refused, 10);
    }
}

// D moves the path with the part: a point of the part at p stands at D p afterwards, and the corrected frame
// holds it.
TEST(SolveRegion, ReturnsTheShiftThatMovesThePathWithThePart) {
    Rng rng(2);
    std::vector<SpotObservation> spots = door(rng, 8);
    const Pose truth = make_pose(Eigen::Matrix3d::Identity(), {7, 0, 0});  // the part moved by +7 mm along X
    measure(spots, truth);
    const RegionCorrection r = solved(spots);
    EXPECT_NEAR(r.displacement.workobject_from_movedworkobject.translation().x(), 7.0, 1e-9);
    const Pose base_from_frame = make_pose(any_rotation(rng), {1000, 200, 300});
    const Eigen::Vector3d in_frame(10, 20, 30);
    EXPECT_LT(
        (r.displacement.corrected(base_from_frame) * in_frame - base_from_frame * (truth * in_frame)).norm(),
        1e-8);
}

// The minimum against numeric differentiation: the gradient of the printed objective vanishes at the
// solution, and the covariance is the inverse of its curvature.
TEST(SolveRegion, SolutionIsTheMinimumOfTheObjectiveAndCovarianceItsCurvature) {
    Rng rng(3);
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 7, {300, -200, 100});
        measure(spots, random_displacement(rng, 10, 1, {300, -200, 100}));
        for (SpotObservation& s : spots) s.sigma_mm = uniform(rng, 0.02, 0.2);
        add_noise(spots, rng, 0.05);
        CorrectionOptions options;
        options.reject_outliers = false;
        const RegionCorrection r = solved(spots, options);
        ASSERT_EQ(r.status, CorrectionStatus::ok);
        const auto residuals = [&](const Vector6& delta) {
            const Pose d = retract(r.displacement.workobject_from_movedworkobject, delta);
            Eigen::VectorXd e(3 * spots.size());
            for (std::size_t n = 0; n < spots.size(); ++n) {
                const SpotObservation& s = spots[n];
                const Pose& w = s.workobject_from_sensor;
                e.segment<3>(3 * static_cast<Eigen::Index>(n)) =
                    s.weights.asDiagonal() *
                    (s.reference_mm - w.inverse() * d.inverse() * w * s.measured_mm) / s.sigma_mm;
            }
            return e;
        };
        Eigen::MatrixXd j(3 * spots.size(), 6);
        Vector6 unit;
        unit << 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6;
        for (int k = 0; k < 6; ++k) {
            const Vector6 h = unit[k] * Vector6::Unit(k);
            j.col(k) = (residuals(h) - residuals(-h)) / (2 * unit[k]);
        }
        const Vector6 gradient = j.transpose() * residuals(Vector6::Zero());
        const Matrix6 covariance = inverse_matrix(j.transpose() * j);
        EXPECT_LT(std::sqrt(gradient.dot(covariance * gradient)), 1e-5);  // in sigmas
        const Vector6 scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
        EXPECT_LT(
            (scale.asDiagonal() * (r.covariance - covariance) * scale.asDiagonal()).cwiseAbs().maxCoeff(),
            1e-5);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(r.sigma_xyz_mm[i], std::sqrt(covariance(i, i)), 1e-6);
    }
}

TEST(SolveRegion, FixedDegreesStayExactlyZeroAndFreeOnesAreExact) {
    Rng rng(4);
    for (int bits = 1; bits < 64; ++bits) {
        CorrectionOptions options;
        for (std::size_t i = 0; i < 6; ++i) options.free[i] = bits >> i & 1;
        std::vector<SpotObservation> spots = door(rng, 10, {800, 300, -100});
        const auto value = [&](std::size_t i, double size) {
            return options.free[i] ? uniform(rng, -size, size) : 0.0;
        };
        const Eigen::Vector3d t(value(0, 10), value(1, 10), value(2, 10));
        const KukaAbc abc{value(3, 5), value(4, 5), value(5, 5)};
        measure(spots, make_pose(rotation_from_kuka(abc), t));
        const RegionCorrection r = solved(spots, options);
        ASSERT_EQ(r.status, CorrectionStatus::ok) << bits << " " << r.message;
        const Pose& d = r.displacement.workobject_from_movedworkobject;
        const KukaAbc got = kuka_from_rotation(d.linear());
        const double angles[3] = {got.a_deg, got.b_deg, got.c_deg},
                     want[3] = {abc.a_deg, abc.b_deg, abc.c_deg};
        EXPECT_EQ(r.redundancy, 20 - __builtin_popcount(static_cast<unsigned>(bits)));
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            EXPECT_NEAR(d.translation()[i], t[i], 1e-7);
            EXPECT_NEAR(angles[i], want[i], 1e-9);
            if (!options.free[k]) {
                EXPECT_EQ(d.translation()[i], 0.0);
                EXPECT_EQ(r.sigma_xyz_mm[i], 0.0);
                EXPECT_EQ(r.covariance.row(i).cwiseAbs().maxCoeff(), 0.0);
            } else {
                EXPECT_GT(r.sigma_xyz_mm[i], 0.0);
            }
            if (!options.free[k + 3]) {
                EXPECT_EQ(angles[i], 0.0);
                EXPECT_EQ(r.sigma_abc_deg[i], 0.0);
            } else {
                EXPECT_GT(r.sigma_abc_deg[i], 0.0);
            }
        }
    }
}

// Parallel edges: the direction along them is named, in whatever frame.
TEST(SolveRegion, ParallelEdgesAreRefusedAndTheDirectionIsNamed) {
    for (const auto& [edge, words] :
         {std::pair{Eigen::Vector3d(0, 1, 0), "translation along Y"},
          std::pair{Eigen::Vector3d(1, 0, 0), "translation along X"},
          std::pair{Eigen::Vector3d(0, 0, -1), "translation along Z"},
          std::pair{Eigen::Vector3d(1, 1, 0).normalized().eval(), "translation along (0.71, 0.71, 0.00)"}}) {
        std::vector<SpotObservation> spots{spot("A", {0, 0, 0}, edge), spot("B", {700, 100, 30}, edge),
                                           spot("C", {300, 500, 120}, edge)};
        for (SpotObservation& s : spots) s.measured_mm = s.reference_mm;
        RegionCorrection r = solved(spots);
        EXPECT_EQ(r.status, CorrectionStatus::under_determined);
        EXPECT_THAT(english(r.unobservable), ElementsAre(words));
        EXPECT_THAT(r.message, HasSubstr(words));
        EXPECT_TRUE(r.displacement.workobject_from_movedworkobject.matrix().isIdentity(0));
        // With that degree fixed the same spots suffice.
        CorrectionOptions options;
        if (edge.cwiseAbs().maxCoeff() > 0.9) {
            for (int i = 0; i < 3; ++i) options.free[static_cast<std::size_t>(i)] = std::abs(edge[i]) < 0.9;
            measure(spots, make_pose(Eigen::Matrix3d::Identity(),
                                     Eigen::Vector3d(1, 2, 3) - edge * edge.dot(Eigen::Vector3d(1, 2, 3))));
            r = solved(spots, options);
            EXPECT_EQ(r.status, CorrectionStatus::ok) << r.message;
        }
    }
}

TEST(SolveRegion, NamesRotations) {
    // Edges all parallel to Z on the same line leave the rotation about that line open as well.
    std::vector<SpotObservation> spots{spot("A", {0, 0, -300}, {0, 0, 1}), spot("B", {0, 0, 100}, {0, 0, 1}),
                                       spot("C", {0, 0, 400}, {0, 0, 1})};
    EXPECT_THAT(english(solved(spots).unobservable), ElementsAre("translation along Z", "rotation about Z"));
    for (SpotObservation& s : spots) s.workobject_from_sensor.pretranslate(Eigen::Vector3d(1000, 200, 0));
    for (SpotObservation& s : spots) s.measured_mm = s.reference_mm;
    EXPECT_THAT(english(solved(spots).unobservable),
                ElementsAre("translation along Z", "rotation about Z through (1000.0, 200.0, 66.7)"));
    // Edges tangent to circles about one axis.
    std::vector<SpotObservation> ring;
    for (int n = 0; n < 8; ++n) {
        const double t = 2 * kPi * n / 8 + 0.1;
        ring.push_back(spot(fmt::format("R{}", n),
                            {500 + 200 * std::cos(t), 50.0 * (n % 3), 200 * std::sin(t)},
                            Eigen::Vector3d(-std::sin(t), 0, std::cos(t))));
    }
    const auto words = solved(ring).unobservable;
    ASSERT_EQ(words.size(), 1u);
    EXPECT_THAT(words[0], HasSubstr("rotation about Y through (500.0, "));
    // A single spot: one translation and all rotations.
    EXPECT_THAT(
        english(solved({spot("A", {0, 0, 0}, {1, 0, 0})}).unobservable),
        ElementsAre("translation along X", "rotation about X", "rotation about Y", "rotation about Z"));
}

// Enough equations are not enough: three spots near a singular arrangement are judged by the predicted sigma.
TEST(SolveRegion, NearSingularTriplesAreJudgedByPredictedSigma) {
    Rng rng(5);
    int refused = 0, accepted = 0;
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 3);
        const Pose truth = random_displacement(rng, 5, 0.5, {0, 0, 0});
        measure(spots, truth);
        const RegionCorrection r = solved(spots);
        if (r.status == CorrectionStatus::ok) {
            ++accepted;
            EXPECT_LE(r.sigma_at_spots_mm, 1.0);
            EXPECT_LT(distance_mm(r.displacement.workobject_from_movedworkobject, truth), 1e-6);
        } else {
            ++refused;
            EXPECT_EQ(r.status, CorrectionStatus::under_determined);
            EXPECT_GT(r.sigma_at_spots_mm, 0.5);
            EXPECT_FALSE(r.unobservable.empty());
        }
    }
    EXPECT_GT(refused, 20);
    EXPECT_GT(accepted, 100);
}

// The verdict must not depend on where the work object's origin lies.
TEST(SolveRegion, VerdictIsIndependentOfTheOrigin) {
    Rng rng(6);
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 4);
        measure(spots, Pose::Identity());
        const RegionCorrection here = solved(spots);
        const Pose far = make_pose(any_rotation(rng), 5000 * gaussian(rng));
        for (SpotObservation& s : spots) s.workobject_from_sensor = far * s.workobject_from_sensor;
        const RegionCorrection there = solved(spots);
        EXPECT_EQ(here.status, there.status);
        EXPECT_NEAR(there.sigma_at_spots_mm / here.sigma_at_spots_mm, 1.0, 1e-3);
    }
}

// Rounding of far coordinates must not keep a noisy region from converging.
TEST(SolveRegion, ConvergesQuicklyWithNoiseWhereverTheOriginLies) {
    Rng rng(61);
    for (const double far : {0.0, 1e3, 2e4, 1e5}) {
        for (int trial = 0; trial < 200; ++trial) {
            const Eigen::Vector3d offset = far * gaussian(rng).normalized();
            std::vector<SpotObservation> spots = door(rng, 6 + trial % 12, offset);
            measure(spots, random_displacement(rng, 10, 1, offset));
            add_noise(spots, rng, 0.05);
            const RegionCorrection r = solved(spots);
            EXPECT_NE(r.status, CorrectionStatus::not_converged) << far << " " << r.message;
            EXPECT_LE(r.iterations, 20) << far;
        }
    }
}

TEST(SolveRegion, OverLimitHoldsTheSolution) {
    Rng rng(7);
    std::vector<SpotObservation> spots = door(rng, 8);
    const Pose truth = make_pose(rotation_exp({0, 0, 0.02}), {12, 0, 0});
    measure(spots, truth);
    CorrectionOptions options;
    options.limits = {10, 5};
    RegionCorrection r = solved(spots, options);
    EXPECT_EQ(r.status, CorrectionStatus::over_limit);
    EXPECT_LT(distance_mm(r.displacement.workobject_from_movedworkobject, truth), 1e-6);
    EXPECT_THAT(r.message, HasSubstr("12.000 mm"));
    options.limits = {20, 1};
    EXPECT_EQ(solved(spots, options).status, CorrectionStatus::over_limit);
    options.limits = {20, 2};
    EXPECT_EQ(solved(spots, options).status, CorrectionStatus::ok);
}

TEST(SolveRegion, TooFewIterationsAreSaid) {
    Rng rng(8);
    std::vector<SpotObservation> spots = door(rng, 8);
    measure(spots, random_displacement(rng, 50, 20, {0, 0, 0}));
    CorrectionOptions options;
    options.max_iterations = 2;
    options.reject_outliers = false;
    const RegionCorrection r = solved(spots, options);
    EXPECT_EQ(r.status, CorrectionStatus::not_converged);
    EXPECT_TRUE(r.displacement.workobject_from_movedworkobject.matrix().isIdentity(0));
}

TEST(SolveRegion, RefusesHostileInputWithASentence) {
    Rng rng(9);
    std::vector<SpotObservation> good = door(rng, 5);
    measure(good, Pose::Identity());
    const auto reason = [&](auto&& spoil) {
        std::vector<SpotObservation> spots = good;
        CorrectionOptions options;
        spoil(spots, options);
        const auto r = solve_region(spots, options);
        return r ? std::string("accepted") : r.error().sentence();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    using Spots = std::vector<SpotObservation>;
    using Options = CorrectionOptions;
    EXPECT_THAT(reason([](Spots& s, Options&) { s.clear(); }), HasSubstr("no spots"));
    EXPECT_THAT(reason([](Spots& s, Options&) { s[2].id = s[0].id; }), HasSubstr("twice"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[1].measured_mm.x() = nan; }), HasSubstr("measured"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[1].measured_mm.z() = inf; }), HasSubstr("S2"));
    EXPECT_THAT(reason([](Spots& s, Options&) { s[1].measured_mm.z() = 1e300; }), HasSubstr("10 km"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[1].reference_mm.y() = nan; }), HasSubstr("reference"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[3].weights.x() = -1; }), HasSubstr("weight"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[3].weights.x() = nan; }), HasSubstr("weight"));
    EXPECT_THAT(reason([](Spots& s, Options&) { s[0].sigma_mm = 0; }), HasSubstr("sigma"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[0].sigma_mm = nan; }), HasSubstr("sigma"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[0].sigma_mm = inf; }), HasSubstr("sigma"));
    EXPECT_THAT(reason([&](Spots& s, Options&) { s[0].workobject_from_sensor.translation().x() = nan; }),
                HasSubstr("pose"));
    EXPECT_THAT(reason([](Spots& s, Options&) { s[0].workobject_from_sensor.linear() *= 1.01; }),
                HasSubstr("orthonormal"));
    EXPECT_THAT(reason([](Spots& s, Options&) { s[0].workobject_from_sensor.linear().col(0) *= -1; }),
                HasSubstr("orthonormal"));
    EXPECT_THAT(reason([](Spots&, Options& o) { o.free = {}; }), HasSubstr("free"));
    EXPECT_THAT(reason([&](Spots&, Options& o) { o.limits.translation_mm = nan; }), HasSubstr("limit"));
    EXPECT_THAT(reason([](Spots&, Options& o) { o.max_iterations = 0; }), HasSubstr("iteration"));
    EXPECT_THAT(reason([&](Spots& s, Options&) {
                    s[0].curve = ContourCurve{{nan, 0, 0}, {0, 0, 0}, -1, 1};
                }),
                HasSubstr("curve"));
    EXPECT_EQ(reason([](Spots&, Options&) {}), "accepted");
    // Many spots take the other way of finding duplicates.
    std::vector<SpotObservation> many = door(rng, 300);
    measure(many, Pose::Identity());
    EXPECT_TRUE(solve_region(many, {}).has_value());
    many[299].id = many[7].id;
    EXPECT_THAT(solve_region(many, {}).error().sentence(), HasSubstr("twice"));
    // Nothing observed at all, and everything at one place: refused, not crashed.
    for (SpotObservation& s : good) s.weights.setZero();
    EXPECT_EQ(solved(good).status, CorrectionStatus::under_determined);
    for (SpotObservation& s : good) {
        s.weights = {1, 1, 1};
        s.reference_mm.setZero();
        s.measured_mm.setZero();
        s.workobject_from_sensor.translation().setZero();
    }
    const RegionCorrection together = solved(good);
    EXPECT_EQ(together.status, CorrectionStatus::under_determined);
    EXPECT_THAT(english(together.unobservable),
                ElementsAre("rotation about X", "rotation about Y", "rotation about Z"));
    // Measures kilometres off: any status but a crash or an ok.
    Rng other(10);
    std::vector<SpotObservation> wild = door(other, 6);
    for (SpotObservation& s : wild) s.measured_mm = 9e6 * gaussian(other).cwiseMax(-1).cwiseMin(1);
    EXPECT_NE(solved(wild).status, CorrectionStatus::ok);
}

}  // namespace
}  // namespace seamwright
