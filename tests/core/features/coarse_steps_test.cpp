// Heights in coarse steps: what is found in them is as unsure as it says.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "core/profile/z_quantum.h"

namespace seamwright::test {
namespace {

using Eigen::Vector2d;

struct CoarseSensor {
    double pitch, noise, step;
};

class CoarseSteps : public testing::TestWithParam<CoarseSensor> {
  protected:
    double uniform(double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random_);
    }
    // `height` of the part at x, NaN where it is not.
    template <class Height>
    Profile seen(double half, Height height) {
        const CoarseSensor s = GetParam();
        std::normal_distribution<double> noise(0, s.noise);
        Profile p;
        for (double x = -half + s.pitch * uniform(0, 1); x < half; x += s.pitch) {
            p.x_mm.push_back(x);
            p.z_mm.push_back(s.step * std::round((height(x) + noise(random_)) / s.step));
        }
        EXPECT_TRUE(filter_profile(p, {}));
        return p;
    }
    static std::unique_ptr<FeatureFinder> finder(const char* kind, const ParameterValues& values = {}) {
        return make_feature_finder({kind, values, {}, Vector2d::Zero()}).value();
    }

  private:
    std::mt19937_64 random_{5};
};

// segment 2: that of the highest contour.
TEST_P(CoarseSteps, AnEndOverGroundIsThatOfItsSheet) {
    const auto end = finder("contour-end", {{"side", 1}, {"segment", 2}});
    for (const double steepest : {0.0, -0.026, -0.2}) {
        int found = 0, within_x = 0, within_z = 0;
        for (int i = 0; i < 60; ++i) {
            const double slope = uniform(steepest, 0), at = uniform(0, 3), z = uniform(-10, 10);
            const Feature f =
                end->find(seen(25, [&](double x) { return x < at ? z + slope * (x - at) : z - 8; }));
            if (f.status != FeatureStatus::ok) continue;
            ++found;
            const Vector2d e = f.point_mm - Vector2d(at, z);
            EXPECT_LT(e.norm(), 0.3) << "slope " << slope;
            within_x += std::abs(e.x()) < 2 * std::sqrt(f.covariance_mm2(0, 0));
            within_z += std::abs(e.y()) < 2 * std::sqrt(f.covariance_mm2(1, 1));
        }
        EXPECT_GE(found, 57) << steepest;
        EXPECT_GE(within_x, 0.9 * found) << steepest;
        EXPECT_GE(within_z, 0.9 * found) << steepest;
    }
}

TEST_P(CoarseSteps, ACornerWithALevelSideIsNoSurerThanItsSteps) {
    const auto corner = finder("corner");
    int found = 0, within_x = 0, within_z = 0;
    for (int i = 0; i < 60; ++i) {
        const double slope = -std::tan(uniform(0.7, 1.2)), at = uniform(-3, 3), z = uniform(-3, 3);
        const Feature f = corner->find(seen(12, [&](double x) { return x < at ? z : z + slope * (x - at); }));
        if (f.status != FeatureStatus::ok) continue;
        ++found;
        const Vector2d e = f.point_mm - Vector2d(at, z);
        within_x += std::abs(e.x()) < 2 * std::sqrt(f.covariance_mm2(0, 0));
        within_z += std::abs(e.y()) < 2 * std::sqrt(f.covariance_mm2(1, 1));
    }
    EXPECT_GE(found, 57);
    EXPECT_GE(within_x, 0.88 * found);
    EXPECT_GE(within_z, 0.88 * found);
}

TEST_P(CoarseSteps, ABeadsCircleIsFound) {
    const auto circle = finder("circle");
    int found = 0;
    for (int i = 0; i < 40; ++i) {
        const double r = uniform(3, 8), h = r * uniform(0.5, 0.9), at = uniform(-3, 3), z = uniform(-3, 3);
        const Feature f = circle->find(seen(20, [&](double x) {
            const double d2 = r * r - (x - at) * (x - at);
            return z + std::max(0.0, d2 > 0 ? h - r + std::sqrt(d2) : 0.0);
        }));
        found += f.status == FeatureStatus::ok && (f.point_mm - Vector2d(at, z + h - r)).norm() < 0.3;
    }
    EXPECT_GE(found, 37);
}

INSTANTIATE_TEST_SUITE_P(Sensors, CoarseSteps,
                         testing::Values(CoarseSensor{0.05, 0.003, 0.1}, CoarseSensor{0.1, 0.003, 0.05},
                                         CoarseSensor{0.1, 0.003, 0.02}));

// A flank on which no two neighbours are a single step apart tells the step all the same; one wider than the pitch too.
TEST(CoarseStepsOfAContour, AreToldOnAFlank) {
    std::mt19937_64 random(6);
    std::normal_distribution<double> noise(0, 0.003);
    for (const double step : {0.02, 0.05, 0.1, 0.3})
        for (const double slope : {0.05, 0.3, 1.7, 2.9}) {
            std::vector<double> x, z;
            for (int i = 0; i < 400; ++i) {
                x.push_back(0.1 * i);
                z.push_back(step * std::round((slope * x.back() + noise(random)) / step));
            }
            EXPECT_NEAR(z_quantum_mm(x, z), step, 1e-9) << slope;
        }
}

}  // namespace
}  // namespace seamwright::test
