// What the taught geometry does not show is refused, whatever the displacement lends; what it shows is not.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/correction/correction.h"
#include "core/correction/predicted.h"
#include "core/geometry/decompositions.h"
#include "tests/core/correction/doors.h"
#include "tests/core/english.h"

namespace seamwright {
namespace {

using namespace testing_doors;
using ::testing::Contains;
using ::testing::HasSubstr;

const Eigen::Vector3d kCentre(450, 600, 0);

Pose about_centre(const Eigen::Vector3d& mm, const Eigen::Vector3d& turn_deg) {
    const Eigen::Matrix3d r = rotation_exp(rad_from_deg(1) * turn_deg);
    return make_pose(r, mm + kCentre - r * kCentre);
}

double turn_about_z_deg(const Pose& d) {
    return deg_from_rad(rotation_log(d.linear()).z());
}

// X radial, Y turned by `off_rad` from the tangent, Z the normal.
SpotObservation at_rim(const std::string& id, double angle, double radius_mm, double off_rad,
                       double sigma_mm) {
    SpotObservation s;
    s.id = id;
    s.sigma_mm = sigma_mm;
    Eigen::Matrix3d axes;
    axes.col(1) = Eigen::Vector3d(-std::sin(angle + off_rad), std::cos(angle + off_rad), 0);
    axes.col(2) = Eigen::Vector3d::UnitZ();
    axes.col(0) = axes.col(1).cross(axes.col(2));
    s.workobject_from_sensor =
        make_pose(axes, kCentre + radius_mm * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
    return s;
}

void add_noise_of_own(std::vector<SpotObservation>& spots, Rng& rng) {
    for (SpotObservation& s : spots) s.measured_mm += s.sigma_mm * gaussian(rng).cwiseProduct(s.weights);
}

// Where the displaced circle pierces the laser plane, by Newton's method from the spot's own angle.
Eigen::Vector3d on_circle(const Pose& sensor_from_part, double radius_mm, double angle) {
    Eigen::Vector3d p;
    for (int k = 0; k < 20; ++k) {
        const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0), along(-out.y(), out.x(), 0);
        p = sensor_from_part * Eigen::Vector3d(kCentre + radius_mm * out);
        angle -= p.y() / (radius_mm * (sensor_from_part.linear() * along).y());
    }
    return p;
}

// A rim that has grown by a tenth of a millimetre looks like one that has turned.
TEST(TaughtGeometry, ARoundRimDoesNotTellItsTurnHoweverManySpotsItHas) {
    Rng rng(31);
    for (const auto& [radius, grown, spots, noise] : {std::tuple{300.0, 0.1, 8, 0.02},
                                                      {300.0, 0.1, 6, 0.02},
                                                      {300.0, 0.0, 8, 0.02},
                                                      {100.0, 0.1, 12, 0.005},
                                                      {30.0, 0.03, 8, 0.005},
                                                      {300.0, -0.1, 8, 0.02}}) {
        for (int trial = 0; trial < 20; ++trial) {
            const Pose d = about_centre(gaussian(rng), 0.2 * gaussian(rng));
            std::vector<SpotObservation> rim;
            for (int n = 0; n < spots; ++n) {
                const double angle = 2 * kPi * n / spots + 0.1;
                rim.push_back(at_rim(fmt::format("S{}", n + 1), angle, radius, 0, noise));
                rim.back().measured_mm =
                    on_circle(rim.back().workobject_from_sensor.inverse() * d, radius + grown, angle);
            }
            add_noise_of_own(rim, rng);
            const RegionCorrection r = *solve_region(rim, {});
            ASSERT_EQ(r.status, CorrectionStatus::under_determined)
                << radius << " " << spots << ": A off by "
                << turn_about_z_deg(r.displacement.workobject_from_movedworkobject) - turn_about_z_deg(d);
            EXPECT_THAT(r.unobservable, Contains(HasSubstr("rotation about Z")));
        }
    }
}

// A spot in the middle of each side: turned to the left it measures as turned to the right.
TEST(TaughtGeometry, MiddlesOfAHexagonsSidesDoNotTellTheTurn) {
    Rng rng(32);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<SpotObservation> sides;
        for (int n = 0; n < 6; ++n)
            sides.push_back(at_rim(fmt::format("S{}", n + 1), kPi * n / 3, 300, 0, 0.02));
        measure(sides, about_centre(2 * gaussian(rng), Eigen::Vector3d(0, 0, 1) + 0.5 * gaussian(rng)));
        add_noise_of_own(sides, rng);
        EXPECT_EQ(solve_region(sides, {})->status, CorrectionStatus::under_determined);
    }
}

struct NearRim {
    int ok = 0, refused = 0, trials = 0;
    double largest = 0, nees = 0;  // of the turn, in stated sigmas; of the whole
    double least_share = 1;        // of the turn's sigma as taught that is stated
};

// Straight edges about a degree off the tangents: the turn shows, if weakly. `grown` is nothing that the model knows.
NearRim near_rim(unsigned seed, double off_rad, double grown, double mm, double deg) {
    Rng rng(seed);
    std::normal_distribution<double> normal;
    NearRim out;
    for (; out.trials < 150; ++out.trials) {
        std::vector<SpotObservation> rim;
        for (int n = 0; n < 8; ++n)
            rim.push_back(at_rim(fmt::format("S{}", n + 1), kPi * n / 4, 300, off_rad * normal(rng), 0.02));
        const Pose d = about_centre(mm * gaussian(rng), deg * gaussian(rng));
        measure(rim, d);
        add_noise_of_own(rim, rng);
        for (SpotObservation& s : rim) {
            const Eigen::Vector3d outward = (s.workobject_from_sensor.translation() - kCentre).normalized();
            s.measured_mm +=
                grown * (s.workobject_from_sensor.linear().transpose() * outward).cwiseProduct(s.weights);
        }
        const RegionCorrection r = *solve_region(rim, {});
        out.refused += r.status == CorrectionStatus::under_determined;
        if (r.status != CorrectionStatus::ok || !r.consistent) continue;
        ++out.ok;
        const Vector6 e = difference(d, r.displacement.workobject_from_movedworkobject);
        const double off = std::abs(e[5]) / std::sqrt(r.covariance(5, 5));
        out.largest = std::max(out.largest, off);
        const double as_taught = predicted_covariance(rim, {})->sum(5, 5);
        out.least_share = std::min(out.least_share, std::sqrt(r.covariance(5, 5) / as_taught));
        const Vector6 scale = r.covariance.diagonal().cwiseSqrt(), u = e.cwiseQuotient(scale);
        const Matrix6 correlation =
            scale.cwiseInverse().asDiagonal() * r.covariance * scale.cwiseInverse().asDiagonal();
        out.nees += u.dot(Vector6(solve_symmetric(correlation, u)));
    }
    return out;
}

TEST(TaughtGeometry, AWeakTurnIsNoSurerThanAsTaught) {
    const NearRim grown = near_rim(33, 0.01, 0.1, 1, 0.15);
    EXPECT_GT(grown.ok, 0);
    EXPECT_GT(grown.least_share, 0.4) << grown.ok << " ok, largest " << grown.largest;
    const NearRim honest = near_rim(34, 0.02, 0, 1, 0.15), far = near_rim(35, 0.02, 0, 5, 1);
    for (const NearRim& r : {honest, far}) {
        EXPECT_GE(r.ok, 140) << r.refused << " refused";
        EXPECT_LT(r.largest, 6);
        EXPECT_GT(r.nees / r.ok, 6 * 0.8);
        EXPECT_LT(r.nees / r.ok, 6 * 1.15);
    }
}

TEST(TaughtGeometry, LargeTurnsOfWellObservedDoorsAreSolved) {
    Rng rng(36);
    for (const auto& [mm, deg] : {std::pair{15.0, 3.0}, {5.0, 25.0}}) {
        double nees = 0;
        int solved = 0;
        for (int trial = 0; trial < 400; ++trial) {
            std::vector<SpotObservation> spots = door(rng, 7 + trial % 6);
            const Pose d =
                make_pose(rotation_exp(rad_from_deg(deg) * gaussian(rng).normalized()), mm * gaussian(rng));
            measure(spots, d);
            add_noise_of_own(spots, rng);
            const RegionCorrection r = *solve_region(spots, {});
            if (r.status != CorrectionStatus::ok) continue;
            ++solved;
            const Vector6 e = difference(d, r.displacement.workobject_from_movedworkobject);
            const Vector6 scale = r.covariance.diagonal().cwiseSqrt(), u = e.cwiseQuotient(scale);
            const Matrix6 correlation =
                scale.cwiseInverse().asDiagonal() * r.covariance * scale.cwiseInverse().asDiagonal();
            nees += u.dot(Vector6(solve_symmetric(correlation, u)));
        }
        EXPECT_GE(solved, 396) << deg;
        EXPECT_GT(nees / solved, 6 * 0.85) << deg;
        EXPECT_LT(nees / solved, 6 * 1.15) << deg;
    }
}

// The one spot that shows a rim's turn contradicts: without it the turn is not known, and it is not left out.
TEST(TaughtGeometry, WhatIsLeftWithoutAWrongSpotIsJudgedAsTaughtToo) {
    Rng rng(37);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<SpotObservation> rim;
        for (int n = 0; n < 8; ++n)
            rim.push_back(at_rim(fmt::format("S{}", n + 1), kPi * n / 4, 300, 0, 0.02));
        rim.push_back(at_rim("across", 0.4, 250, kPi / 2, 0.02));
        measure(rim, about_centre(gaussian(rng), Eigen::Vector3d(0, 0, 1.5)));
        add_noise_of_own(rim, rng);
        rim.back().measured_mm.x() += 4;
        const RegionCorrection r = *solve_region(rim, {});
        EXPECT_TRUE(r.status != CorrectionStatus::ok || !r.consistent || r.spots.back().used) << r.message;
    }
}

TEST(TaughtGeometry, OneMeasureUnderTwoIdsIsRefused) {
    Rng rng(38);
    std::vector<SpotObservation> spots = door(rng, 8);
    measure(spots, random_displacement(rng, 10, 1, {0, 0, 0}));
    add_noise_of_own(spots, rng);
    const auto with = [&](auto&& change) {
        std::vector<SpotObservation> more = spots;
        more.push_back(spots[2]);
        more.back().id = "again";
        change(more);
        const auto r = solve_region(more, {});
        return r ? std::string(to_string(r->status)) : r.error().sentence();
    };
    EXPECT_THAT(with([](auto&) {}), HasSubstr("\"S3\" and \"again\" are one measure"));
    EXPECT_EQ(with([](auto& s) { s.back().measured_mm.x() += 0.03; }), "ok");  // measured twice
    EXPECT_EQ(with([](auto& s) {                                               // one spot, axis by axis
                  s[2].weights = {1, 0, 0};
                  s.back().weights = {0, 0, 1};
              }),
              "ok");
    EXPECT_TRUE(plan_region(spots, {}).has_value());
    // Many spots take the other way.
    const auto many = [&](std::vector<SpotObservation>& s) {
        const std::vector<SpotObservation> further = door(rng, 300);
        for (const SpotObservation& one : further) {
            s.push_back(one);
            s.back().id += " more";
            s.back().measured_mm = one.reference_mm;
        }
    };
    EXPECT_THAT(with(many), HasSubstr("are one measure"));
    EXPECT_EQ(with([&](auto& s) {
                  s.pop_back();
                  many(s);
              }).find("one measure"),
              std::string::npos);
}

// A copy is one measure however it was written down.
TEST(TaughtGeometry, ACopyIsFoundHoweverItIsWritten) {
    Rng rng(39);
    const auto rounded = [](const Eigen::Vector3d& v, double step) {
        return Eigen::Vector3d((v / step).array().round() * step);
    };
    int found = 0, tried = 0;
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 5 + trial % 2);
        measure(spots, random_displacement(rng, 10, 1, {0, 0, 0}));
        add_noise_of_own(spots, rng);
        spots[2].measured_mm.x() += 1;  // wrong, and twice as strong by its copy
        for (int way = 0; way < 6; ++way) {
            SpotObservation copy = spots[2];
            copy.id = "copy";
            Pose& at = copy.workobject_from_sensor;
            if (way == 0) copy.measured_mm = rounded(copy.measured_mm, 1e-4);
            if (way == 1) copy.measured_mm = rounded(copy.measured_mm, 1e-3);
            if (way == 2) copy.measured_mm.y() += 3;  // not observed
            if (way == 3) at.translation() += Eigen::Vector3d(1e-9, -1e-9, 1e-9);
            if (way == 4)  // through a rotation vector with seven digits
                at.linear() = rotation_exp(rounded(rotation_log(at.linear()), 1e-7));
            if (way == 5) {  // another origin, and the sensor turned about its travel
                const Pose turned = make_pose(rotation_exp(Eigen::Vector3d(0, kPi, 0)), {1, 2, 3});
                at = at * turned;
                copy.reference_mm = turned.inverse() * copy.reference_mm;
                copy.measured_mm = turned.inverse() * copy.measured_mm;
            }
            std::vector<SpotObservation> with = spots;
            with.push_back(copy);
            const auto r = solve_region(with, {});
            ++tried;
            found +=
                !r && r.error().sentence().find("\"S3\" and \"copy\" are one measure") != std::string::npos;
        }
    }
    EXPECT_EQ(found, tried);
}

// A second pass over the same spots is none: with a noise of its own, though a tenth of the stated one, and though both are
// rounded to steps of a fifth of sigma from poses that the robot arrived at anew.
TEST(TaughtGeometry, ASecondPassIsNoCopy) {
    Rng rng(40);
    const auto refused_of = [&](double noise, double step_mm, bool arrives_anew,
                                const Eigen::Vector3d& weights) {
        int refused = 0;
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<SpotObservation> spots = door(rng, 6);
            for (SpotObservation& s : spots) s.weights = weights;
            measure(spots, random_displacement(rng, 10, 1, {0, 0, 0}));
            std::vector<SpotObservation> all;
            for (int pass = 0; pass < 2; ++pass)
                for (SpotObservation s : spots) {
                    s.id += pass == 0 ? "" : " again";
                    s.measured_mm += noise * s.sigma_mm * gaussian(rng);
                    if (step_mm > 0) s.measured_mm = (s.measured_mm / step_mm).array().round() * step_mm;
                    if (arrives_anew) s.workobject_from_sensor.translation() += 1e-6 * gaussian(rng);
                    all.push_back(s);
                }
            const auto r = solve_region(all, {});
            refused += !r;
        }
        return refused;
    };
    EXPECT_LE(refused_of(1, 0, false, {1, 0, 1}), 2);
    EXPECT_LE(refused_of(0.3, 0, false, {1, 0, 1}), 2);
    EXPECT_LE(refused_of(1, 0, false, {0, 0, 1}), 2);
    EXPECT_LE(refused_of(1, 0.01, true, {1, 0, 1}), 2);
    EXPECT_LE(refused_of(0.1, 0.05, true, {1, 0, 1}), 2);
}

}  // namespace
}  // namespace seamwright
