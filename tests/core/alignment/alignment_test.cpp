// A simulated profiled edge, passed by a sensor that is turned by known angles: numbers, verdict and cure.

#include "core/alignment/alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "core/geometry/pose.h"

namespace seamwright {
namespace {

using ::testing::HasSubstr;
using Rng = std::mt19937_64;

double normal(Rng& rng) {
    return std::normal_distribution<double>()(rng);
}

// Cross-section of a hemmed edge with a bead, in x and z, about 24 mm wide.
std::vector<Eigen::Vector2d> edge_section() {
    std::vector<Eigen::Vector2d> out;
    for (double u = -14; u < 6; u += 0.08)
        out.emplace_back(u, 0.1 * u + 2.0 * std::exp(-0.5 * std::pow((u + 6) / 1.2, 2)));
    for (double t = 0; t < 1.9; t += 0.03)
        out.emplace_back(6 + 2.5 * std::sin(t), 0.6 - 2.5 * (1 - std::cos(t)));
    return out;
}

// The section drawn along the work object's Y, seen by a sensor of rotation `workobject_from_sensor` that
// travels along its own Y through the origin. `radius` bends the contour about an axis parallel to Z at x =
// -radius.
std::vector<TravelProfile> pass(const Eigen::Matrix3d& workobject_from_sensor, double step, double noise,
                                Rng& rng, const std::vector<Eigen::Vector2d>& section = edge_section()) {
    std::vector<TravelProfile> out;
    for (double y = -20; y <= 20 + 1e-9; y += step) {
        TravelProfile t;
        t.travel_mm = y;
        for (const Eigen::Vector2d& s : section) {
            Eigen::Vector3d p = workobject_from_sensor.transpose() * Eigen::Vector3d(s.x(), 0, s.y());
            const Eigen::Vector3d d = workobject_from_sensor.transpose().col(1);
            p.y() -= y;
            p -= d * (p.y() / d.y());
            t.profile.x_mm.push_back(p.x() + noise * normal(rng));
            t.profile.z_mm.push_back(p.z() + noise * normal(rng));
        }
        out.push_back(t);
    }
    return out;
}

std::vector<TravelProfile> bent_pass(double radius, double noise, Rng& rng) {
    std::vector<TravelProfile> out;
    for (double y = -20; y <= 20 + 1e-9; y += 1) {
        TravelProfile t;
        t.travel_mm = y;
        for (const Eigen::Vector2d& s : edge_section()) {
            const double r = radius + s.x();
            t.profile.x_mm.push_back(-radius + std::sqrt(r * r - y * y) + noise * normal(rng));
            t.profile.z_mm.push_back(s.y() + noise * normal(rng));
        }
        out.push_back(t);
    }
    return out;
}

AlignmentResult checked(const std::vector<TravelProfile>& p, const AlignmentOptions& o = {}) {
    const auto r = check_alignment(p, o);
    EXPECT_TRUE(r.has_value()) << (r ? "" : r.error().sentence());
    return r ? *r : AlignmentResult{};
}

Eigen::Matrix3d turn(double z_deg, double x_deg) {
    return (Eigen::AngleAxisd(rad_from_deg(z_deg), Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(rad_from_deg(x_deg), Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
}

TEST(Alignment, AnAlignedPassIsFrozen) {
    Rng rng(1);
    const AlignmentResult r = checked(pass(Eigen::Matrix3d::Identity(), 1, 0.02, rng));
    EXPECT_EQ(r.status, AlignmentStatus::frozen) << r.cure;
    EXPECT_LT(std::abs(r.yaw_deg), 0.05);
    EXPECT_LT(std::abs(r.pitch_deg), 0.05);
    EXPECT_LT(r.expected_error_mm, 0.01);
    EXPECT_LT(r.shape_change_mm, 0.02);
    EXPECT_TRUE(std::isinf(r.radius_mm));
    EXPECT_EQ(r.cure, "");
    for (const TravelOffset& o : r.offsets) EXPECT_TRUE(o.ok);
}

// A sensor turned by +yaw about its Z sees the contour drift to +x; one turned by +x about X sees it sink.
TEST(Alignment, SlopesAndAnglesAreThoseOfTheTurn) {
    Rng rng(2);
    for (const auto& [z, x] :
         {std::pair{1.5, 0.0}, {-0.7, 0.0}, {0.0, 1.2}, {0.0, -2.0}, {2.0, -1.0}, {-5.0, 4.0}}) {
        const Eigen::Matrix3d r0 = turn(z, x);
        const AlignmentResult r = checked(pass(r0, 1, 0.01, rng));
        const Eigen::Vector3d contour = r0.transpose().col(1);
        EXPECT_NEAR(r.dx_mm_per_mm, contour.x() / contour.y(), 3e-4);
        EXPECT_NEAR(r.dz_mm_per_mm, contour.z() / contour.y(), 3e-4);
        EXPECT_NEAR(r.yaw_deg, deg_from_rad(std::atan(contour.x() / contour.y())), 0.02);
        EXPECT_NEAR(r.pitch_deg, deg_from_rad(std::atan(contour.z() / contour.y())), 0.02);
        const double error = 5.0 * std::hypot(contour.x(), contour.z()) / contour.y();
        EXPECT_NEAR(r.expected_error_mm, error, 0.01 + 0.02 * error);
        EXPECT_EQ(r.status, error > 0.05 ? AlignmentStatus::drifting : AlignmentStatus::frozen);
        EXPECT_EQ(r.yaw_deg > 0, z > 0 || (z == 0 && r.yaw_deg > 0));
    }
}

// The cure, applied, freezes the contour.
TEST(Alignment, TheCureCures) {
    Rng rng(3);
    for (const auto& [z, x] : {std::pair{1.5, 0.0}, {0.0, -2.0}, {2.0, -1.0}, {-5.0, 4.0}, {7.0, 7.0}}) {
        const Eigen::Matrix3d r0 = turn(x, z) * turn(z, x);
        const AlignmentResult before = checked(pass(r0, 1, 0.005, rng));
        ASSERT_EQ(before.status, AlignmentStatus::drifting);
        EXPECT_THAT(before.cure, HasSubstr("rotate the sensor"));
        const AlignmentResult after =
            checked(pass(r0 * turn(before.cure_about_z_deg, before.cure_about_x_deg), 1, 0.005, rng));
        EXPECT_EQ(after.status, AlignmentStatus::frozen) << after.cure;
        EXPECT_LT(std::abs(after.yaw_deg), 0.03);
        EXPECT_LT(std::abs(after.pitch_deg), 0.03);
        EXPECT_LT(after.expected_error_mm, 0.01);
    }
}

TEST(Alignment, StatedSigmaOfTheAnglesIsHonest) {
    Rng rng(4);
    const int trials = 120;
    double yaw = 0, pitch = 0;
    const Eigen::Matrix3d r0 = turn(0.8, 0.5);
    const Eigen::Vector3d contour = r0.transpose().col(1);
    for (int i = 0; i < trials; ++i) {
        const AlignmentResult r = checked(pass(r0, 2, 0.03, rng));
        yaw +=
            std::pow((r.yaw_deg - deg_from_rad(std::atan(contour.x() / contour.y()))) / r.sigma_yaw_deg, 2) /
            trials;
        pitch +=
            std::pow((r.pitch_deg - deg_from_rad(std::atan(contour.z() / contour.y()))) / r.sigma_pitch_deg,
                     2) /
            trials;
    }
    // Student's t with about 18 degrees: variance 1.12; the mean over 120 trials scatters by 0.17.
    EXPECT_NEAR(yaw, 1.12, 0.55);
    EXPECT_NEAR(pitch, 1.12, 0.55);
}

TEST(Alignment, CurvatureIsFoundAndAStraightContourHasNone) {
    Rng rng(5);
    for (const double radius : {350.0, 1000.0}) {
        const AlignmentResult r = checked(bent_pass(radius, 0.01, rng));
        EXPECT_NEAR(r.radius_mm, radius, 0.06 * radius);
        EXPECT_NEAR(r.curve.x_coefficients[1], -0.5 / radius, 0.06 * 0.5 / radius);
        EXPECT_NEAR(r.expected_error_mm, radius - std::sqrt(radius * radius - 25), 0.006);
        EXPECT_EQ(r.status, AlignmentStatus::frozen) << r.cure;  // 5 mm of jitter: 0.036 mm
    }
    AlignmentOptions wide;
    wide.jitter_mm = 10;
    const AlignmentResult r = checked(bent_pass(350, 0.01, rng), wide);
    EXPECT_EQ(r.status, AlignmentStatus::drifting);
    EXPECT_NEAR(r.expected_error_mm, 0.143, 0.006);
    EXPECT_THAT(r.cure, HasSubstr("radius"));
    int bent = 0;
    for (int i = 0; i < 40; ++i) bent += std::isfinite(checked(pass(turn(0.5, 0), 2, 0.02, rng)).radius_mm);
    EXPECT_LE(bent, 1);
}

// A straight line as profile: only the drift across it is seen, and it is said.
TEST(Alignment, AStraightProfileIsJudgedAcrossItOnly) {
    Rng rng(6);
    std::vector<Eigen::Vector2d> line;
    for (double u = -15; u < 15; u += 0.1) line.emplace_back(u, 0.0);
    const AlignmentResult r = checked(pass(turn(3, 1.5), 1, 0.02, rng, line));
    EXPECT_TRUE(r.sliding);
    EXPECT_NEAR(r.pitch_deg, -1.5, 0.1);
    EXPECT_NEAR(r.dx_mm_per_mm, 0, 2e-3);
    EXPECT_TRUE(std::isinf(r.sigma_yaw_deg));
    EXPECT_TRUE(std::isfinite(r.sigma_pitch_deg));
    EXPECT_EQ(r.status, AlignmentStatus::drifting);
    EXPECT_THAT(r.cure, HasSubstr("straight line"));
}

TEST(Alignment, AProfileThatChangesItsShapeIsNoticed) {
    Rng rng(7);
    std::vector<TravelProfile> p = pass(Eigen::Matrix3d::Identity(), 1, 0.01, rng);
    for (TravelProfile& t : p) {
        // A second bead that grows along the travel.
        for (std::size_t i = 0; i < t.profile.size(); ++i)
            t.profile.z_mm[i] += 0.06 * t.travel_mm * std::sin(1.7 * t.profile.x_mm[i]);
    }
    const AlignmentResult r = checked(p);
    EXPECT_NE(r.status, AlignmentStatus::frozen);
    EXPECT_GT(r.shape_change_mm, 0.05);
    EXPECT_THAT(r.cure, HasSubstr("shape"));
}

// A joggle that gets deeper along the travel: either flat may be taken for what stands still, the other does
// not.
TEST(Alignment, AJoggleThatGetsDeeperIsNotFrozen) {
    for (const double left : {8.0, 4.0, 14.0}) {
        for (const double noise : {0.01, 0.03}) {
            Rng rng(17);
            std::vector<TravelProfile> p;
            for (double y = -20; y <= 20 + 1e-9; y += 1) {
                TravelProfile t;
                t.travel_mm = y;
                const double depth = 2 + 0.04 * y;
                for (double x = -left; x < 20 - left; x += 0.06) {
                    t.profile.x_mm.push_back(x);
                    t.profile.z_mm.push_back(depth * std::clamp(x / 2, 0.0, 1.0) + noise * normal(rng));
                }
                p.push_back(t);
            }
            const AlignmentResult r = checked(p);
            EXPECT_NE(r.status, AlignmentStatus::frozen) << left << " " << noise;
            EXPECT_TRUE(r.shape_change_mm > 0.05 || r.status == AlignmentStatus::drifting)
                << left << " " << noise;
        }
    }
}

// The profile at the trigger position is noisy, or half of it belongs to a reflection: the others say what
// there is.
TEST(Alignment, OneBadTriggerProfileDoesNotSpoilTheVerdict) {
    Rng rng(18);
    for (const double yaw : {0.0, 1.0, -2.0}) {
        for (int kind = 0; kind < 4; ++kind) {
            SCOPED_TRACE(testing::Message() << "yaw " << yaw << ", kind " << kind);
            std::vector<TravelProfile> p = pass(turn(yaw, 0), 1, 0.02, rng);
            Profile& trigger = p[20].profile;
            ASSERT_NEAR(p[20].travel_mm, 0, 1e-9);
            for (std::size_t i = 0; i < trigger.size(); ++i) {
                const double x = trigger.x_mm[i];
                if (kind == 0) trigger.z_mm[i] += 0.5 * normal(rng);
                if (kind == 1 && x > -9 && x < -2) trigger.z_mm[i] += 1.5;  // a ghost over the bead
                if (kind == 2) trigger.z_mm[i] += 0.15 * normal(rng);
                if (kind == 3 && x > 0) trigger.z_mm[i] = 4 + 0.3 * x + 0.02 * normal(rng);  // over the rim
            }
            const AlignmentResult r = checked(p);
            EXPECT_EQ(r.status, yaw == 0 ? AlignmentStatus::frozen : AlignmentStatus::drifting) << r.cure;
            EXPECT_NEAR(r.yaw_deg, yaw, 0.05);
            EXPECT_LT(r.sigma_yaw_deg, 0.05);
        }
    }
}

TEST(Alignment, WhatIsNotSeenIsNotFrozen) {
    Rng rng(19);
    // A straight line that drifts along itself only, or not at all: nobody knows.
    std::vector<Eigen::Vector2d> line;
    for (double u = -15; u < 15; u += 0.1) line.emplace_back(u, 0.0);
    for (const double yaw : {0.0, 3.0}) {
        const AlignmentResult r = checked(pass(turn(yaw, 0), 1, 0.02, rng, line));
        EXPECT_EQ(r.status, AlignmentStatus::undetermined);
        EXPECT_TRUE(std::isinf(r.expected_error_sigma_mm));
        EXPECT_THAT(r.cure, HasSubstr("straight line"));
    }
    // A few profiles of much noise.
    std::vector<TravelProfile> p = pass(Eigen::Matrix3d::Identity(), 6, 0.05, rng);
    for (TravelProfile& t : p) {
        const double dx = 0.3 * normal(rng), dz = 0.3 * normal(rng);  // the robot's path is rough
        for (double& x : t.profile.x_mm) x += dx;
        for (double& z : t.profile.z_mm) z += dz;
    }
    const AlignmentResult r = checked(p);
    EXPECT_EQ(r.status, AlignmentStatus::undetermined)
        << r.expected_error_mm << " " << r.expected_error_sigma_mm;
    EXPECT_THAT(r.cure, HasSubstr("sigma"));
}

// The sentence, followed to the letter.
TEST(Alignment, TheCureAsWordedCures) {
    Rng rng(20);
    for (const auto& [z, x] : {std::pair{0.1, 0.0}, {3.0, -2.0}, {-9.0, 8.0}, {14.0, 12.0}, {-20.0, -15.0}}) {
        const Eigen::Matrix3d r0 = turn(0.5 * x, 0) * turn(z, x);
        const AlignmentResult before = checked(pass(r0, 1, 0.003, rng));
        if (before.status == AlignmentStatus::frozen) continue;
        Eigen::Matrix3d r = r0;
        std::string rest = before.cure.english();
        for (std::size_t at; (at = rest.find(" axis by ")) != std::string::npos; rest = rest.substr(at + 9)) {
            const bool about_z = rest[at - 1] == 'Z';
            const double degrees = std::stod(rest.substr(at + 9));
            r = r * (about_z ? turn(degrees, 0) : turn(0, degrees));
        }
        const AlignmentResult after = checked(pass(r, 1, 0.003, rng));
        EXPECT_EQ(after.status, AlignmentStatus::frozen) << before.cure;
        const Eigen::Vector3d contour = r.transpose().col(1);
        EXPECT_LT(deg_from_rad(std::atan(std::hypot(contour.x(), contour.z()) / contour.y())), 0.05)
            << before.cure;
    }
}

TEST(Alignment, OrderDuplicatesGapsAndBadProfilesDoNotMatter) {
    Rng rng(8);
    const Eigen::Matrix3d r0 = turn(1.5, -1.0);
    std::vector<TravelProfile> p = pass(r0, 0.5, 0.01, rng);
    const AlignmentResult want = checked(p);
    std::vector<TravelProfile> mixed = p;
    for (const std::size_t k : {3u, 30u, 50u}) mixed.push_back(p[k]);  // duplicates
    std::shuffle(mixed.begin(), mixed.end(), rng);
    const double nan = std::nan("");
    std::erase_if(mixed,
                  [](const TravelProfile& t) { return std::abs(t.travel_mm) < 0.9; });  // no trigger profile
    mixed.push_back({nan, p[10].profile});
    mixed.push_back({0.1, {}});
    TravelProfile blind{0.0, p[40].profile};
    std::fill(blind.profile.z_mm.begin(), blind.profile.z_mm.end(), nan);
    mixed.push_back(blind);
    TravelProfile other = p[20];
    for (double& z : other.profile.z_mm) z = 40 * normal(rng);
    mixed.push_back(other);
    for (TravelProfile& t : mixed) {  // some points missing, some wild
        for (std::size_t i = 0; i < t.profile.size(); ++i) {
            if (rng() % 25 == 0) t.profile.z_mm[i] = nan;
            if (rng() % 60 == 0) t.profile.z_mm[i] += 15;
        }
    }
    const AlignmentResult r = checked(mixed);
    EXPECT_EQ(r.status, AlignmentStatus::drifting);
    EXPECT_NEAR(r.yaw_deg, want.yaw_deg, 0.05);
    EXPECT_NEAR(r.pitch_deg, want.pitch_deg, 0.05);
    ASSERT_EQ(r.offsets.size(), mixed.size());
    for (std::size_t i = 0; i < mixed.size(); ++i) {
        if (!std::isnan(mixed[i].travel_mm)) {
            EXPECT_EQ(r.offsets[i].travel_mm, mixed[i].travel_mm);
        }
    }
    EXPECT_FALSE(r.offsets[mixed.size() - 4].ok);
    EXPECT_FALSE(r.offsets[mixed.size() - 3].ok);
    EXPECT_FALSE(r.offsets[mixed.size() - 2].ok);
}

TEST(Alignment, DriftIsThatOfTheReferencePoint) {
    Rng rng(9);
    AlignmentOptions o;
    o.reference_mm = Eigen::Vector2d(8.5, -1.9);
    const AlignmentResult r = checked(pass(turn(1, 0), 1, 0.01, rng), o);
    EXPECT_NEAR(r.yaw_deg, 1.0, 0.03);
}

// A rim on a flat, moved as `shift` says of the travel; nothing where it says nothing.
using Shift = std::function<std::optional<Eigen::Vector2d>(double y)>;
std::vector<TravelProfile> moved_rim(const Shift& shift, double noise, Rng& rng, double from = -20,
                                     double to = 20) {
    std::vector<TravelProfile> out;
    for (double y = from; y <= to + 1e-9; y += 1) {
        TravelProfile t;
        t.travel_mm = y;
        if (const auto by = shift(y))
            for (double u = -14; u < 0; u += 0.06) {
                t.profile.x_mm.push_back(u + by->x());
                t.profile.z_mm.push_back(by->y() + noise * normal(rng));
            }
        if (const auto by = shift(y))
            for (double a = 0; a < 1.4; a += 0.02) {
                t.profile.x_mm.push_back(3 * std::sin(a) + by->x());
                t.profile.z_mm.push_back(3 * (std::cos(a) - 1) + by->y() + noise * normal(rng));
            }
        out.push_back(t);
    }
    return out;
}

// Neither drift nor bend of low order, but where the robot may fire the contour is elsewhere, or not at all.
TEST(Alignment, WhatStandsOffWithinTheJitterIsNotFrozen) {
    const auto still = [](double) { return Eigen::Vector2d(0, 0); };
    const std::vector<std::pair<const char*, Shift>> shapes = {
        {"notch", [](double y) { return Eigen::Vector2d(y >= 2 && y <= 4 ? -1 : 0, 0); }},
        {"nugget", [](double y) { return Eigen::Vector2d(0, y >= 1 && y <= 4 ? 0.4 : 0); }},
        {"wave in x", [](double y) { return Eigen::Vector2d(0.3 * std::sin(y * EIGEN_PI / 4), 0); }},
        {"long wave in x", [](double y) { return Eigen::Vector2d(0.15 * std::sin(y * EIGEN_PI / 6), 0); }},
        {"wave in z", [](double y) { return Eigen::Vector2d(0, 0.2 * std::sin(y * EIGEN_PI / 5)); }},
        {"lost here, and at the end",
         [](double y) {
             return (y >= 2 && y <= 4) || y > 14 ? std::nullopt : std::optional<Eigen::Vector2d>({0, 0});
         }},
        {"ends at 2 mm",
         [](double y) {
             return y > 2 ? std::nullopt : std::optional<Eigen::Vector2d>({0, 0});
         }},
    };
    AlignmentOptions o;
    o.reference_mm = Eigen::Vector2d(3, -2.5);
    for (const double noise : {0.02, 0.05, 0.1})
        for (const auto& [name, shift] : shapes) {
            Rng rng(31);
            const AlignmentResult r = checked(moved_rim(shift, noise, rng), o);
            EXPECT_EQ(r.status, AlignmentStatus::shape_changes) << name << " " << noise << " " << r.cure;
            EXPECT_THAT(r.cure, HasSubstr("within the jitter")) << name;
        }
    // What lies beyond the window says nothing of what is lost within.
    const auto gone = [](double y) {
        return y >= 2 && y <= 4 ? std::nullopt : std::optional<Eigen::Vector2d>({0, 0});
    };
    Rng long_rng(35);
    EXPECT_EQ(checked(moved_rim(gone, 0.03, long_rng, -60, 60), o).status, AlignmentStatus::shape_changes);
    for (int seed = 0; seed < 100; ++seed) {
        Rng rng(100 + static_cast<unsigned>(seed));
        const AlignmentResult r = checked(moved_rim(still, 0.02 + 0.0005 * seed, rng), o);
        EXPECT_EQ(r.status, AlignmentStatus::frozen) << seed << " " << r.cure;
    }
}

TEST(Alignment, WhereNothingWasRecordedNothingIsKnown) {
    const auto still = [](double) { return Eigen::Vector2d(0, 0); };
    Rng rng(32);
    for (const auto& [from, to] : {std::pair{8.0, 20.0}, {-3.0, 3.0}, {-20.0, 0.0}}) {
        const AlignmentResult r = checked(moved_rim(still, 0.03, rng, from, to));
        EXPECT_EQ(r.status, AlignmentStatus::undetermined) << from << " " << to << " " << r.cure;
        EXPECT_THAT(r.cure, HasSubstr("from entry to exit"));
    }
    EXPECT_EQ(checked(moved_rim(still, 0.03, rng, -5, 5)).status, AlignmentStatus::frozen);
}

// Two sheets, each straight, that part: neither the mean of both nor one of them is what stands still.
TEST(Alignment, TwoEdgesThatPartAreNotFrozen) {
    AlignmentOptions o;
    o.reference_mm = Eigen::Vector2d(-1.5, 0);
    for (const auto& [left, right] : {std::pair{1.0, 0.0}, {0.9, -0.9}, {0.5, -1.0}}) {
        Rng rng(33);
        std::vector<TravelProfile> p;
        for (double y = -20; y <= 20 + 1e-9; y += 1) {
            TravelProfile t;
            t.travel_mm = y;
            const double l = -1.5 + y * std::tan(rad_from_deg(left)),
                         r = 1.5 + y * std::tan(rad_from_deg(right));
            for (double x = -15; x < 15; x += 0.06) {
                if (x > l && x < r) continue;
                t.profile.x_mm.push_back(x);
                t.profile.z_mm.push_back((x < l ? 0 : 0.4) + 0.03 * normal(rng));
            }
            p.push_back(t);
        }
        const AlignmentResult r = checked(p, o);
        EXPECT_NE(r.status, AlignmentStatus::frozen) << left << " " << right;
        EXPECT_NEAR(r.shape_change_mm,
                    5 * std::abs(std::tan(rad_from_deg(left)) - std::tan(rad_from_deg(right))), 0.03);
    }
    // A rim that turns away over a frame that stands still: the rim is meant.
    o.reference_mm = Eigen::Vector2d(3, -2.5);
    Rng rng(34);
    std::vector<TravelProfile> p =
        moved_rim([](double y) { return Eigen::Vector2d(y * std::tan(rad_from_deg(1)), 0); }, 0.03, rng);
    for (TravelProfile& t : p)
        for (double x = t.profile.x_mm.back() + 0.06; x < 16; x += 0.06) {
            t.profile.x_mm.push_back(x);
            t.profile.z_mm.push_back(-12 + 0.03 * normal(rng));
        }
    const AlignmentResult r = checked(p, o);
    EXPECT_EQ(r.status, AlignmentStatus::drifting);
    EXPECT_NEAR(r.yaw_deg, 1, 0.1);
}

TEST(Alignment, TooLittleIsSaid) {
    Rng rng(10);
    std::vector<TravelProfile> p = pass(Eigen::Matrix3d::Identity(), 1, 0.01, rng);
    EXPECT_EQ(checked({p.begin(), p.begin() + 3}).status, AlignmentStatus::not_enough_profiles);
    std::vector<TravelProfile> same(20, p[20]);
    EXPECT_EQ(checked(same).status, AlignmentStatus::not_enough_profiles);
    for (TravelProfile& t : p) t.travel_mm += 1000;
    EXPECT_EQ(checked(p).status, AlignmentStatus::not_enough_profiles);
    for (TravelProfile& t : p) t.travel_mm = std::nan("");
    const AlignmentResult r = checked(p);
    EXPECT_EQ(r.status, AlignmentStatus::not_enough_profiles);
    EXPECT_THAT(r.cure, HasSubstr("record"));
}

TEST(Alignment, HostileInputIsRefused) {
    Rng rng(11);
    std::vector<TravelProfile> p = pass(Eigen::Matrix3d::Identity(), 4, 0.01, rng);
    EXPECT_FALSE(check_alignment({}, {}).has_value());
    for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        AlignmentOptions o;
        o.jitter_mm = bad;
        EXPECT_FALSE(check_alignment(p, o).has_value());
        o = {};
        o.tolerance_mm = bad;
        EXPECT_FALSE(check_alignment(p, o).has_value());
        o = {};
        o.window_mm = bad;
        EXPECT_FALSE(check_alignment(p, o).has_value());
    }
    p[2].profile.z_mm.pop_back();
    EXPECT_THAT(check_alignment(p, {}).error().sentence(), HasSubstr("profile 2"));
    // Infinite and huge coordinates are no points, not a crash.
    p = pass(Eigen::Matrix3d::Identity(), 2, 0.01, rng);
    p[5].profile.x_mm[7] = std::numeric_limits<double>::infinity();
    p[6].profile.z_mm[7] = 1e300;
    EXPECT_TRUE(check_alignment(p, {}).has_value());
}

}  // namespace
}  // namespace seamwright
