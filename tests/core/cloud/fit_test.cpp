// Fits with known answers, and those that must be refused.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "core/cloud/fit.h"
#include "tests/core/cloud/test_parts.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using namespace test_parts;

std::vector<std::string> english_of(const std::vector<Text>& texts) {
    std::vector<std::string> out;
    for (const Text& t : texts) out.push_back(t.english());
    return out;
}

FitOptions about(const Pose& start) {
    FitOptions o;
    o.start = start;
    return o;
}

const Surface& panel_surface() {
    static const Surface surface(panel());
    return surface;
}

double error_mm(const SurfaceFit& fit, const Pose& truth) {
    double most = 0;
    for (const Vector3d& p :
         {Vector3d(0, 0, 0), Vector3d(kPanelX, 0, 0), Vector3d(0, kPanelY, 0), Vector3d(kPanelX, kPanelY, 0)})
        most = std::max(most, (fit.base_from_part * p - truth * p).norm());
    return most;
}

TEST(Fit, APanelIsFoundFromNothing) {
    for (const int seed : {1, 2}) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        Cloud cloud = panel_scan(random, 20000, 0.05);
        const Pose truth = random_pose(random, 3, 900);
        transform(cloud, truth);
        const auto fit = fit_surface(cloud, panel_surface(), {});
        ASSERT_TRUE(fit);
        EXPECT_EQ(fit->status, FitStatus::ok) << fit->reason.english();
        EXPECT_LT(error_mm(*fit, truth), 0.05);
        EXPECT_NEAR(fit->noise_mm, 0.05, 0.015);
    }
}

// So much of a bend in so little of a part may have another place nearly as good: then it is refused, never "ok" outside
// of what is stated.
TEST(Fit, BentTwistedDisplacedAndFortyPercentSeenIsRefusedOrInsideTheStatedRegion) {
    std::mt19937_64 random(3);
    Cloud cloud = panel_scan(random, 20000, 0.05, 0.4, [](const Vector3d& p) -> Vector3d {
        const double x = p.x() / kPanelX, y = p.y() / kPanelY;
        return Vector3d(0, 0, 1.5 * x * x + 1.0 * x * (2 * y - 1));
    });
    const Pose truth = make_pose(rotation_exp(Vector3d(0.01, -0.01, 0.015)), Vector3d(9, -10, 6));
    transform(cloud, truth);
    const auto fit = fit_surface(cloud, panel_surface(), about(Pose::Identity()));
    ASSERT_TRUE(fit);
    EXPECT_NE(fit->status, FitStatus::no_fit);
    EXPECT_LT(error_mm(*fit, truth), 6);
    if (fit->status != FitStatus::ok) return;
    const Vector6 d = difference(fit->base_from_part, truth);
    EXPECT_LT(d.dot(fit->covariance.ldlt().solve(d)), 12.6);  // chi^2 of 6 at 95 %
}

TEST(Fit, ThreePickedPairsAreAStart) {
    std::mt19937_64 random(4);
    Cloud cloud = panel_scan(random, 10000, 0.05);
    const Pose truth = random_pose(random, 3, 900);
    transform(cloud, truth);
    FitOptions options;
    for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(600, 0, 0), Vector3d(0, 400, 0)}) {
        options.pairs_part.push_back(p);
        options.pairs_base.push_back(truth * p + Vector3d(8, -5, 6));
    }
    const auto fit = fit_surface(cloud, panel_surface(), options);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->status, FitStatus::ok) << fit->reason.english();
    EXPECT_LT(error_mm(*fit, truth), 0.05);
}

TEST(Fit, ABoxIsAmbiguousWithoutAStartAndFoundWithOne) {
    std::mt19937_64 random(5);
    const Vector3d size(200, 120, 80);
    Cloud cloud = box_scan(random, size, 10000, 0.05);
    const Pose truth = random_pose(random, 0.1, 15);
    transform(cloud, truth);
    const Surface surface(box(size));
    EXPECT_EQ(fit_surface(cloud, surface, {})->status, FitStatus::ambiguous);
    const auto fit = fit_surface(cloud, surface, about(Pose::Identity()));
    EXPECT_EQ(fit->status, FitStatus::ok) << fit->reason.english();
    EXPECT_LT(difference(fit->base_from_part, truth).head<3>().norm(), 0.05);
}

TEST(Fit, ABoxThatIsNearlySquareIsRefusedThoughItsSidesDiffer) {
    const Vector3d size(200, 100, 100.1);
    const Surface surface(box(size));
    for (const int seed : {1, 2, 3}) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        Cloud cloud = box_scan(random, size, 10000, 0.1);
        transform(cloud, random_pose(random, 3, 300));
        EXPECT_EQ(fit_surface(cloud, surface, {})->status, FitStatus::ambiguous) << seed;
        // A start of 100 degrees lets the quarter turn in.
        FitOptions wide = about(Pose::Identity());
        wide.start_deg = 100;
        Cloud unturned = box_scan(random, size, 10000, 0.1);
        EXPECT_NE(fit_surface(unturned, surface, wide)->status, FitStatus::ok) << seed;
    }
}

TEST(Fit, APlaneLeavesThreeDirectionsOpenAndNamesThem) {
    TriangleMesh plane;
    quad(plane, {-200, -150, 0}, {200, -150, 0}, {200, 150, 0}, {-200, 150, 0});
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> uniform(-0.4, 0.4);
    std::normal_distribution<double> noise(0, 0.05);
    Cloud cloud;
    for (int i = 0; i < 5000; ++i) {
        cloud.points.emplace_back(400 * uniform(random), 300 * uniform(random), noise(random));
        cloud.towards.emplace_back(0, 0, 1);
    }
    const auto fit = fit_surface(cloud, Surface(plane), about(Pose::Identity()));
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->status, FitStatus::under_determined);
    EXPECT_THAT(english_of(fit->unobservable),
                testing::ElementsAre("translation along X", "translation along Y",
                                     testing::StartsWith("rotation about Z")));
    EXPECT_EQ(fit_surface(cloud, Surface(plane), {})->status, FitStatus::under_determined);
}

TEST(Fit, ACylinderMayTurnAboutItsAxisHoweverItIsDrawn) {
    for (const int facets : {24, 48, 200}) {
        const Surface surface(cylinder(50, 200, facets));
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform(0, 1);
        std::normal_distribution<double> noise(0, 0.05);
        Cloud cloud;
        for (int i = 0; i < 8000; ++i) {
            const double a = 2 * kPi * uniform(random);
            const Vector3d out(std::cos(a), std::sin(a), 0);
            cloud.points.push_back((50 + noise(random)) * out + 200 * uniform(random) * Vector3d::UnitZ());
            cloud.towards.push_back(out.cast<float>());
        }
        const auto fit = fit_surface(cloud, surface, about(Pose::Identity()));
        ASSERT_TRUE(fit);
        EXPECT_EQ(fit->status, FitStatus::under_determined) << facets;
        EXPECT_THAT(english_of(fit->unobservable), testing::Contains("rotation about Z")) << facets;
    }
}

TEST(Fit, OneFaceOfABoxAndTwoFacesNameWhatTheyLeave) {
    std::mt19937_64 random(8);
    const Vector3d size(200, 120, 80);
    const Surface surface(box(size));
    const auto two = fit_surface(box_scan(random, size, 8000, 0.05, 20), surface, about(Pose::Identity()));
    EXPECT_EQ(two->status, FitStatus::under_determined);
    EXPECT_THAT(english_of(two->unobservable), testing::ElementsAre("translation along X"));
    const auto one = fit_surface(box_scan(random, size, 8000, 0.05, 16), surface, about(Pose::Identity()));
    EXPECT_EQ(one->status, FitStatus::under_determined);
    EXPECT_GE(one->unobservable.size(), 2U);
}

// Most of the points are of the part, most of the area is the table's.
TEST(Fit, ABracketIsFoundAmongThingsThatAreNotOfIt) {
    const Surface surface(bracket());
    for (unsigned seed = 1; seed <= 6; ++seed) {
        std::mt19937_64 random(seed);
        Cloud cloud = surface.sampled(12000, 5);
        cloud.towards = cloud.normals;
        std::normal_distribution<double> noise(0, 0.05);
        for (std::size_t i = 0; i < cloud.size(); ++i)
            cloud.points[i] += noise(random) * cloud.normals[i].cast<double>();
        std::uniform_real_distribution<double> any(-150, 150);
        for (int i = 0; i < 2500; ++i) {  // a table below it
            const double x = any(random), y = any(random);
            cloud.points.emplace_back(x, y, -60);
            cloud.towards.emplace_back(0, 0, 1);
        }
        cloud.normals.clear();
        const Pose truth = make_pose(rotation_exp(Vector3d(0.03, 0.02, -0.05)), Vector3d(8, -6, 5));
        transform(cloud, truth);
        const auto fit = fit_surface(cloud, surface, about(Pose::Identity()));
        ASSERT_TRUE(fit);
        EXPECT_EQ(fit->status, FitStatus::ok) << seed << ": " << fit->reason.english();
        EXPECT_LT(difference(fit->base_from_part, truth).head<3>().norm(), 0.1) << seed;
        EXPECT_NEAR(fit->share_on_part, 12000.0 / 14500, 0.05) << seed;
    }
}

TEST(Fit, AnotherPartIsNoFit) {
    std::mt19937_64 random(10);
    const Cloud cloud = panel_scan(random, 5000, 0.05);
    const auto fit = fit_surface(cloud, Surface(bracket()), {});
    ASSERT_TRUE(fit);
    EXPECT_NE(fit->status, FitStatus::ok);
}

TEST(Fit, BadInputIsRefusedWithASentence) {
    std::mt19937_64 random(11);
    Cloud cloud = panel_scan(random, 200, 0.05);
    EXPECT_FALSE(fit_surface(Cloud{}, panel_surface(), {}));
    EXPECT_FALSE(fit_surface(cloud, Surface(TriangleMesh{}), {}));
    FitOptions line;
    line.pairs_part = line.pairs_base = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    EXPECT_FALSE(fit_surface(cloud, panel_surface(), line));
    cloud.points[7].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(fit_surface(cloud, panel_surface(), {}));
}

TEST(Fit, TheSameSeedGivesTheSameAnswer) {
    std::mt19937_64 random(12);
    Cloud cloud = panel_scan(random, 5000, 0.05);
    transform(cloud, random_pose(random, 3, 900));
    const auto a = fit_surface(cloud, panel_surface(), {}), b = fit_surface(cloud, panel_surface(), {});
    EXPECT_EQ(a->status, b->status);
    EXPECT_TRUE(a->base_from_part.matrix() == b->base_from_part.matrix());
}

}  // namespace
}  // namespace seamwright
