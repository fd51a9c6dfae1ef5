// Spots that state the covariance of their (x, z) instead of one sigma.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/correction/correction.h"
#include "core/geometry/decompositions.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;

const Eigen::Vector3d kWhere(900, -400, 250);

Eigen::Matrix2d correlated(Rng& rng, double sigma) {
    const double x = sigma * uniform(rng, 0.5, 2), z = sigma * uniform(rng, 0.5, 2),
                 c = uniform(rng, -0.9, 0.9);
    return (Eigen::Matrix2d() << x * x, c * x * z, c * x * z, z * z).finished();
}

void add_noise_of(SpotObservation& s, Rng& rng) {
    const Eigen::Matrix2d l = s.covariance_mm2->llt().matrixL();
    const Eigen::Vector3d n = gaussian(rng);
    const Eigen::Vector2d e = l * n.head<2>();
    s.measured_mm += Eigen::Vector3d(e.x(), 0, e.y());
}

double worst_mm(const std::vector<SpotObservation>& spots, const Pose& a, const Pose& b) {
    double worst = 0;
    for (const SpotObservation& s : spots) {
        const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
        worst = std::max(worst, (a * p - b * p).norm());
    }
    return worst;
}

TEST(SpotCovariance, IsotropicOneSaysTheSameAsSigma) {
    Rng rng(1);
    for (int i = 0; i < 20; ++i) {
        auto spots = door(rng, 8, kWhere);
        measure(spots, random_displacement(rng, 10, 1, kWhere));
        add_noise(spots, rng, 0.05);
        for (SpotObservation& s : spots) {
            s.curve.emplace();
            s.curve->x_coefficients = {0.02, uniform(rng, -1e-3, 1e-3), 0};
            s.curve->z_coefficients = {-0.01, uniform(rng, -1e-3, 1e-3), 1e-6};
            s.curve->valid_from_mm = -20, s.curve->valid_to_mm = 20;
        }
        const auto by_sigma = solve_region(spots, {});
        for (SpotObservation& s : spots) {
            s.covariance_mm2 = Eigen::Matrix2d(s.sigma_mm * s.sigma_mm * Eigen::Matrix2d::Identity());
            s.sigma_mm = 7;  // of no account beside it
        }
        const auto by_covariance = solve_region(spots, {});
        ASSERT_TRUE(by_sigma && by_covariance);
        ASSERT_EQ(by_covariance->status, CorrectionStatus::ok);
        EXPECT_LT(worst_mm(spots, by_sigma->displacement.workobject_from_movedworkobject,
                           by_covariance->displacement.workobject_from_movedworkobject),
                  1e-9);
        EXPECT_LT((by_sigma->covariance - by_covariance->covariance).norm(),
                  1e-9 * by_sigma->covariance.norm());
        EXPECT_NEAR(by_sigma->variance_factor, by_covariance->variance_factor, 1e-9);
        EXPECT_NEAR(by_sigma->rms_mm, by_covariance->rms_mm, 1e-9);
        for (std::size_t n = 0; n < spots.size(); ++n)
            EXPECT_LT((by_sigma->spots[n].residual_mm - by_covariance->spots[n].residual_mm).norm(), 1e-9);
    }
}

// At a tiny displacement the problem is linear: the answer is the textbook's generalised least squares.
TEST(SpotCovariance, IsTheGeneralisedLeastSquaresSolution) {
    Rng rng(2);
    for (int i = 0; i < 20; ++i) {
        auto spots = door(rng, 7, {0, 0, 0});
        for (SpotObservation& s : spots) {
            s.covariance_mm2 = correlated(rng, 1e-4);
            s.sigma_mm = 1e-4;
            s.measured_mm = s.reference_mm;
            add_noise_of(s, rng);
        }
        Matrix6 information = Matrix6::Zero();
        Vector6 right = Vector6::Zero();
        for (const SpotObservation& s : spots) {
            const Eigen::Matrix3d axes = s.workobject_from_sensor.linear().transpose();
            Eigen::Matrix<double, 3, 6> all;
            all << axes, -axes * skew(s.workobject_from_sensor * s.measured_mm);
            Eigen::Matrix<double, 2, 6> rows;
            rows << all.row(0), all.row(2);
            const Eigen::Vector3d off = s.measured_mm - s.reference_mm;
            const Eigen::Matrix2d omega = s.covariance_mm2->inverse();
            information += rows.transpose() * omega * rows;
            right += rows.transpose() * omega * Eigen::Vector2d(off.x(), off.z());
        }
        const Vector6 expected = solve_symmetric(information, right);
        CorrectionOptions options;
        options.reject_outliers = false;
        const auto solved = solve_region(spots, options);
        ASSERT_TRUE(solved);
        const Pose& d = solved->displacement.workobject_from_movedworkobject;
        EXPECT_LT((d.translation() - expected.head<3>()).norm(), 1e-5 * expected.head<3>().norm());
        EXPECT_LT((rotation_log(d.linear()) - expected.tail<3>()).norm(), 1e-5 * expected.tail<3>().norm());
        const Matrix6 covariance = inverse_matrix(information);
        EXPECT_LT((solved->covariance - covariance).norm(), 1e-5 * covariance.norm());
    }
}

TEST(SpotCovariance, StatedSpreadIsTheRealOneAndSmallerThanWithoutIt) {
    Rng rng(3);
    const int trials = 3000;
    double nees = 0, with = 0, without = 0;
    int left_out = 0;
    for (int i = 0; i < trials; ++i) {
        auto spots = door(rng, 8, kWhere);
        const Pose truth = random_displacement(rng, 10, 1, kWhere);
        measure(spots, truth);
        for (SpotObservation& s : spots) {
            s.covariance_mm2 = correlated(rng, 0.05);
            add_noise_of(s, rng);
        }
        const auto solved = solve_region(spots, {});
        ASSERT_TRUE(solved);
        ASSERT_EQ(solved->status, CorrectionStatus::ok);
        for (const SpotResidual& s : solved->spots) left_out += !s.used;
        const Pose& d = solved->displacement.workobject_from_movedworkobject;
        const Vector6 scale = solved->covariance.diagonal().cwiseSqrt().cwiseInverse();
        const Matrix6 correlation = scale.asDiagonal() * solved->covariance * scale.asDiagonal();
        const Vector6 u = scale.cwiseProduct(difference(truth, d));
        nees += u.dot(Vector6(solve_symmetric(correlation, u))) / trials;
        with += std::pow(worst_mm(spots, d, truth), 2);
        for (SpotObservation& s : spots) {
            s.sigma_mm = std::sqrt(0.5 * s.covariance_mm2->trace());
            s.covariance_mm2.reset();
        }
        const auto plain = solve_region(spots, {});
        ASSERT_TRUE(plain);
        without += std::pow(worst_mm(spots, plain->displacement.workobject_from_movedworkobject, truth), 2);
    }
    // 95 % interval of the mean of 3000 chi-squares with 6 degrees: +-0.124.
    EXPECT_NEAR(nees, 6, 0.15);
    EXPECT_LT(with, 0.75 * without);
    EXPECT_LT(left_out, trials / 100);  // significance 1e-3 of a region
}

TEST(SpotCovariance, WrongSpotIsStillNamed) {
    Rng rng(4);
    for (int i = 0; i < 50; ++i) {
        auto spots = door(rng, 8, kWhere);
        measure(spots, random_displacement(rng, 10, 1, kWhere));
        for (SpotObservation& s : spots) {
            s.covariance_mm2 = correlated(rng, 0.05);
            add_noise_of(s, rng);
        }
        spots[3].measured_mm.x() += 4;
        const auto solved = solve_region(spots, {});
        ASSERT_TRUE(solved);
        ASSERT_EQ(solved->status, CorrectionStatus::ok) << solved->message;
        for (std::size_t n = 0; n < spots.size(); ++n) EXPECT_EQ(solved->spots[n].used, n != 3) << i;
        EXPECT_GT(solved->spots[3].residual_mm.norm(), 3);
    }
}

TEST(SpotCovariance, RefusesWhatIsNoCovariance) {
    Rng rng(5);
    const auto with = [&](const Eigen::Matrix2d& c, const Eigen::Vector3d& weights) {
        auto spots = door(rng, 8, kWhere);
        measure(spots, Pose::Identity());
        spots[2].covariance_mm2 = c;
        spots[2].weights = weights;
        return solve_region(spots, {});
    };
    const Eigen::Matrix2d good = 1e-3 * Eigen::Matrix2d::Identity();
    Eigen::Matrix2d c = good;
    EXPECT_TRUE(with(c, {1, 0, 1}));
    EXPECT_FALSE(with(c, {1, 0, 0.5}));
    c(0, 1) = c(1, 0) = 1.1e-3;  // beyond what a correlation can be
    EXPECT_FALSE(with(c, {1, 0, 1}));
    c = good;
    c(0, 1) = 1e-4;  // not symmetric
    EXPECT_FALSE(with(c, {1, 0, 1}));
    c = good;
    c(1, 1) = -1e-3;
    EXPECT_FALSE(with(c, {1, 0, 1}));
    c(1, 1) = std::numeric_limits<double>::quiet_NaN();
    const auto refused = with(c, {1, 0, 1});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().where.english().find("covariance_mm2"), std::string::npos);
}

}  // namespace
}  // namespace seamwright
