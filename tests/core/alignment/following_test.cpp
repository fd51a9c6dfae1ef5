// A contour of which one part stands still and another, with the reference point, does not: what counts is the point.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "core/alignment/alignment.h"

namespace seamwright {
namespace {

using Outline = std::vector<std::pair<double, double>>;

double height(const Outline& o, double x) {
    for (std::size_t i = 1; i < o.size(); ++i)
        if (x >= o[i - 1].first && x <= o[i].first)
            return o[i - 1].second +
                   (o[i].second - o[i - 1].second) * (x - o[i - 1].first) / (o[i].first - o[i - 1].first);
    return std::nan("");
}

struct Scene {
    const char* name;
    std::function<double(double x, double travel)> z;  // NaN: nothing is seen
    Eigen::Vector2d reference;
    double causes_mm;  // at the reference point, within 5 mm of travel
};

// `slope` per mm of travel.
std::vector<Scene> scenes(double slope) {
    return {
        {"sheet that ends, with a swage that stands still",
         [=](double x, double y) {
             return height({{-40, 0}, {-18, 0}, {-15, -0.5}, {-12, 0}, {slope * y, 0}}, x);
         },
         {0, 0},
         5 * slope},
        {"sheet over the ground, with a step that stands still",
         [=](double x, double y) {
             return x < slope * y ? height({{-40, 2}, {-20, 2}, {-19.7, 0}, {40, 0}}, x) : -3;
         },
         {0, 0},
         5 * slope},
        {"groove that deepens",
         [=](double x, double y) { return -std::max(0.0, 3 + slope * y - std::abs(x)); },
         {0, -3},
         5 * slope},
        {"plate that grows between two folds",
         [=](double x, double y) {
             const double corner = 7 + slope * y;
             return height({{-40, 0}, {0, 0}, {1, -2}, {corner, -2}, {corner + 0.3, -4}, {60, -4}}, x);
         },
         {7, -2},
         5 * slope},
    };
}

AlignmentResult checked(const Scene& scene, double noise_mm, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<TravelProfile> pass;
    for (double y = -8; y <= 8; y += 0.5) {
        TravelProfile p;
        p.travel_mm = y;
        for (int i = 0; i < 800; ++i) {
            const double x = 0.05 * i - 20, z = scene.z(x, y);
            if (std::isnan(z) || uniform(engine) < 0.01) continue;
            p.profile.x_mm.push_back(x);
            p.profile.z_mm.push_back(z + noise_mm * normal(engine));
        }
        pass.push_back(std::move(p));
    }
    AlignmentOptions options;
    options.reference_mm = scene.reference;
    const auto result = check_alignment(pass, options);
    EXPECT_TRUE(result) << result.error().sentence();
    return result.value_or(AlignmentResult{});
}

TEST(FollowsThePoint, WhereAnotherPartOfTheContourStandsStill) {
    std::mt19937_64 engine(61);
    for (const double slope : {0.03, 0.1})
        for (const Scene& scene : scenes(slope))
            for (const double noise : {0.01, 0.04}) {
                const AlignmentResult r = checked(scene, noise, engine);
                EXPECT_EQ(r.status, AlignmentStatus::drifting) << scene.name << " " << slope << " " << noise;
                EXPECT_NEAR(r.expected_error_mm, scene.causes_mm, 0.03 + 4 * r.expected_error_sigma_mm)
                    << scene.name << " " << slope << " " << noise;
            }
}

TEST(FollowsThePoint, AndNothingWhereAllStandsStill) {
    std::mt19937_64 engine(62);
    for (const Scene& scene : scenes(0))
        for (const double noise : {0.01, 0.04})
            for (int trial = 0; trial < 3; ++trial)
                EXPECT_EQ(checked(scene, noise, engine).status, AlignmentStatus::frozen)
                    << scene.name << " " << noise;
}

// The last point of a contour steps by whole points; an edge that moves by less does not stand still for it.
TEST(FollowsThePoint, AnEdgeThatMovesByLessThanAPointIsAsSureAsItsPointsTell) {
    std::mt19937_64 engine(64);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-0.003, 0.003);
    int beyond = 0, trials = 0;
    for (int trial = 0; trial < 12; ++trial) {
        const double along_x = uniform(engine), along_z = uniform(engine),
                     shift = 0.1 * uniform(engine) / 0.006;
        std::vector<TravelProfile> pass;
        for (double y = -20; y <= 20; y += 1) {
            TravelProfile p;
            p.travel_mm = y;
            for (int i = -200; i < 200; ++i) {  // a rim of radius 1 at the end of a tilted sheet
                const double u = 0.1 * i + shift - along_x * y;
                if (u > 0) continue;
                const double rim = u > -1 ? std::sqrt(1 - (u + 1) * (u + 1)) - 1 : 0;
                p.profile.x_mm.push_back(0.1 * i + shift);
                p.profile.z_mm.push_back(rim - 0.15 * u + along_z * y + 0.03 * normal(engine));
            }
            pass.push_back(std::move(p));
        }
        AlignmentOptions options;
        options.reference_mm = Eigen::Vector2d(0, -1);
        const auto r = check_alignment(pass, options);
        ASSERT_TRUE(r) << r.error().sentence();
        EXPECT_NE(r->status, AlignmentStatus::drifting) << trial;
        if (!(r->sigma_yaw_deg > 0 && std::isfinite(r->sigma_yaw_deg))) continue;
        ++trials;
        const double off = r->yaw_deg - std::atan(along_x) * 180 / 3.14159265358979;
        beyond += std::abs(off) > 4 * r->sigma_yaw_deg ? 1 : 0;
    }
    EXPECT_GE(trials, 6);
    EXPECT_LE(beyond, 1);
}

TEST(FollowsThePoint, ARippleThatTheStepsDoNotResolveIsNotFrozen) {
    std::mt19937_64 engine(63);
    for (const double depth : {0.0, 0.15}) {
        const Scene ripple{"weld ripple",
                           [=](double x, double y) {
                               return depth * std::sin(2 * M_PI * y / 3) +
                                      height({{-40, 0}, {0, 0}, {3, -4}, {60, -4.5}}, x);
                           },
                           {0, 0},
                           depth};
        const AlignmentResult r = checked(ripple, 0.02, engine);
        EXPECT_EQ(r.status, depth > 0 ? AlignmentStatus::shape_changes : AlignmentStatus::frozen);
        EXPECT_EQ(r.shape_change_mm > 0.05, depth > 0);
    }
}

}  // namespace
}  // namespace seamwright
