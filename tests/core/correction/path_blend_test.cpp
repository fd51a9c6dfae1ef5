// Laws of the path's blend: uniform, continuous, independent of frame and direction, inverse pairs.

#include "core/correction/path/path_blend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

namespace seamwright {
namespace {

class Maker {
  public:
    explicit Maker(unsigned seed) : rng_(seed) {}
    Eigen::Vector3d vector(double scale) {
        std::uniform_real_distribution<double> u(-scale, scale);
        const double x = u(rng_), y = u(rng_), z = u(rng_);
        return {x, y, z};
    }
    Pose pose(double mm, double deg) {
        const Eigen::Vector3d t = vector(mm);
        return make_pose(rotation_exp(vector(rad_from_deg(deg))), t);
    }
    PathRegion region(double mm = 10, double deg = 1.5) {
        PathRegion r;
        r.displacement.workobject_from_movedworkobject = pose(mm, deg);
        Matrix6 a;
        for (int i = 0; i < 36; ++i) a.data()[i] = vector(1).x() * (i % 6 < 3 ? 0.02 : 2e-5);
        r.covariance = a * a.transpose();
        return r;
    }

  private:
    std::mt19937 rng_;
};

// Around an ellipse of 1000 x 700 mm, every point with its own tool pose. Quarters belong to regions 0..3;
// the last `free` points of each quarter to none.
std::vector<PathPoint> ring(std::size_t n, std::size_t free, unsigned seed = 5) {
    Maker make(seed);
    std::vector<PathPoint> path;
    for (std::size_t i = 0; i < n; ++i) {
        const double a = 2 * kPi * static_cast<double>(i) / static_cast<double>(n);
        PathPoint p;
        p.workobject_from_tool = make.pose(0, 170);
        p.workobject_from_tool.translation() =
            Eigen::Vector3d(500 + 500 * std::cos(a), 350 + 350 * std::sin(a), 20 * std::sin(3 * a));
        const std::size_t quarter = 4 * i / n, left = n * (quarter + 1) / 4 - i;
        p.region = left <= free ? -1 : static_cast<int>(quarter);
        path.push_back(p);
    }
    return path;
}

const std::vector<std::string> kNames{"a", "b", "c", "d"};

std::vector<PathRegion> regions(unsigned seed) {
    Maker make(seed);
    return {make.region(), make.region(), make.region(), make.region()};
}

const Pose& at(const CorrectedPath& path, std::size_t i) {
    return path.points[i].displacement.workobject_from_movedworkobject;
}

TEST(PathBlend, UniformCorrectionMovesThePathRigidlyToTheLastBit) {
    const PathRegion same = Maker(1).region(20, 3);
    const std::vector<PathRegion> all(4, same);
    const Pose& d = same.displacement.workobject_from_movedworkobject;
    for (const std::size_t free : {0u, 12u})
        for (const bool closed : {false, true}) {
            const auto path = ring(200, free);
            const auto r = correct_path(path, all, kNames, {50, closed});
            ASSERT_TRUE(r) << r.error().sentence();
            for (std::size_t i = 0; i < path.size(); ++i)
                EXPECT_EQ(r->points[i].workobject_from_tool.matrix(),
                          (d * path[i].workobject_from_tool).matrix());
            EXPECT_EQ(r->largest_mm.mm, 0);
            EXPECT_EQ(r->largest_deg.deg, 0);
            EXPECT_EQ(r->unblended_mm, 0);
            EXPECT_LT(r->curvature_change_per_m, 1e-8);
            EXPECT_GT(r->curvature_per_m, 1);
        }
}

TEST(PathBlend, EqualsTheRegionsOutsideOfTransitions) {
    const auto path = ring(400, 20);
    const auto all = regions(2);
    const auto r = correct_path(path, all, kNames, {60, true});
    ASSERT_TRUE(r) << r.error().sentence();
    int inside = 0, blended = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i].region < 0) {
            ++blended;
            continue;
        }
        ++inside;
        EXPECT_EQ(at(*r, i).matrix(), all[static_cast<std::size_t>(path[i].region)]
                                          .displacement.workobject_from_movedworkobject.matrix());
    }
    EXPECT_EQ(inside, 320);
    EXPECT_EQ(blended, 80);
    // Regions that meet: only within half a blend of the border.
    const auto meeting = ring(400, 0);
    const auto m = correct_path(meeting, all, kNames, {60, true});
    ASSERT_TRUE(m);
    for (std::size_t i = 0; i < meeting.size(); ++i) {
        const bool whole = at(*m, i).matrix() == all[static_cast<std::size_t>(meeting[i].region)]
                                                     .displacement.workobject_from_movedworkobject.matrix();
        const std::size_t from_border = std::min(i % 100, 99 - i % 100);
        // Points are 5.5 to 7.9 mm apart.
        if (from_border >= 6) {
            EXPECT_TRUE(whole) << i;
        }
        if (from_border < 3) {
            EXPECT_FALSE(whole) << i;
        }
    }
}

TEST(PathBlend, IsContinuousAndHalvesItsStepWithThePoints) {
    const auto all = regions(3);
    double before = 0;
    for (const std::size_t n : {400u, 800u, 1600u, 3200u}) {
        const auto path = ring(n, n / 20);
        const auto r = correct_path(path, all, kNames, {60, true});
        ASSERT_TRUE(r);
        EXPECT_TRUE(r->remarks.empty());
        EXPECT_GT(r->unblended_mm, 5);
        if (before > 0) {
            EXPECT_NEAR(r->largest_mm.mm / before, 0.5, 0.03);
        }
        before = r->largest_mm.mm;
        // Nowhere steeper than the pace's 15/8 of the whole over the transition, with 10 % for what the screw
        // adds and for uneven points.
        EXPECT_LT(r->largest_mm.mm, 1.1 * 15.0 / 8 * r->unblended_mm / (static_cast<double>(n) / 20));
    }
}

TEST(PathBlend, CurvatureGoesOverWithoutAJump) {
    // A straight path: all curvature is the correction's. Second differences of the shift converge and vanish
    // at the ends of the transition.
    const auto straight = [](std::size_t n) {
        std::vector<PathPoint> path(n + 1);
        for (std::size_t i = 0; i <= n; ++i) {
            path[i].workobject_from_tool.translation().x() =
                1000.0 * static_cast<double>(i) / static_cast<double>(n);
            path[i].region = 3 * i < n ? 0 : 3 * i > 2 * n ? 1 : -1;
        }
        return path;
    };
    std::vector<PathRegion> all(2);
    all[1].displacement.workobject_from_movedworkobject.translation() = Eigen::Vector3d(0, 4, 3);
    const std::vector<std::string> names{"a", "b"};
    for (const std::size_t n : {600u, 3000u}) {
        const auto r = correct_path(straight(n), all, names, {});
        ASSERT_TRUE(r);
        // max |h''| = 10 / sqrt(3) over L^2 times 5 mm, per m; L from the last point of a to the first of b.
        const double length = 1000.0 / 3 + 2 * 1000.0 / static_cast<double>(n);
        const double expected = 1000 * 5 * 10 / std::sqrt(3.0) / (length * length);
        EXPECT_NEAR(r->curvature_change_per_m, expected, 0.005 * expected);
        EXPECT_LT(r->curvature_per_m, 1e-6);
        // At the transition's ends the second difference is small against the largest.
        const auto y = [&](std::size_t i) { return r->points[i].workobject_from_tool.translation().y(); };
        double most = 0;
        for (std::size_t i = 1; i < n; ++i) most = std::max(most, std::abs(y(i - 1) - 2 * y(i) + y(i + 1)));
        EXPECT_LT(std::abs(y(n / 3 - 1) - 2 * y(n / 3) + y(n / 3 + 1)), 0.1 * most);
    }
}

TEST(PathBlend, DoesNotDependOnTheFrame) {
    const auto path = ring(300, 15);
    const auto all = regions(4);
    const Pose f = Maker(9).pose(900, 120);  // workobject_from_other
    auto other_path = path;
    for (PathPoint& p : other_path) p.workobject_from_tool = f.inverse() * p.workobject_from_tool;
    auto other = all;
    for (PathRegion& r : other) {
        Pose& d = r.displacement.workobject_from_movedworkobject;
        d = f.inverse() * d * f;
    }
    const auto a = correct_path(path, all, kNames, {60, true});
    const auto b = correct_path(other_path, other, kNames, {60, true});
    ASSERT_TRUE(a && b);
    for (std::size_t i = 0; i < path.size(); ++i)
        EXPECT_TRUE(
            (f * b->points[i].workobject_from_tool).isApprox(a->points[i].workobject_from_tool, 1e-11));
    EXPECT_NEAR(a->largest_mm.mm, b->largest_mm.mm, 1e-9);
    EXPECT_NEAR(a->curvature_change_per_m, b->curvature_change_per_m, 1e-6);
}

TEST(PathBlend, DoesNotDependOnTheDirectionOfTravel) {
    const auto path = ring(300, 15);
    const auto all = regions(5);
    const std::vector<PathPoint> back(path.rbegin(), path.rend());
    for (const bool closed : {false, true}) {
        const auto a = correct_path(path, all, kNames, {60, closed});
        const auto b = correct_path(back, all, kNames, {60, closed});
        ASSERT_TRUE(a && b);
        for (std::size_t i = 0; i < path.size(); ++i)
            EXPECT_TRUE(at(*a, i).isApprox(at(*b, path.size() - 1 - i), 1e-11));
        EXPECT_NEAR(a->points.back().sigma_mm, b->points.front().sigma_mm, 1e-12);
    }
}

TEST(PathBlend, BlendOfTheInversesIsTheInverse) {
    const auto path = ring(300, 15);
    const auto all = regions(6);
    auto inverse = all;
    for (PathRegion& r : inverse) {
        Pose& d = r.displacement.workobject_from_movedworkobject;
        d = d.inverse();
    }
    const auto a = correct_path(path, all, kNames, {60, true});
    const auto b = correct_path(path, inverse, kNames, {60, true});
    ASSERT_TRUE(a && b);
    for (std::size_t i = 0; i < path.size(); ++i)
        EXPECT_LT((at(*a, i) * at(*b, i)).matrix().cwiseAbs().sum() - 4, 1e-9) << i;
}

TEST(PathBlend, SigmaIsABoundForEveryCorrelation) {
    // Both regions in error, drawn from their covariances, by the same, the opposite and independent numbers.
    const auto path = ring(80, 8);
    const auto all = regions(7);
    const auto truth = correct_path(path, all, kNames, {60, true});
    ASSERT_TRUE(truth);
    std::mt19937 rng(3);
    std::normal_distribution<double> normal;
    std::vector<Matrix6> roots;
    for (const PathRegion& r : all) roots.push_back(r.covariance.llt().matrixL());
    for (int way = 0; way < 3; ++way) {
        const int trials = 400;
        std::vector<Eigen::Matrix3d> scatter(path.size(), Eigen::Matrix3d::Zero());
        for (int t = 0; t < trials; ++t) {
            auto wrong = all;
            Vector6 common;
            for (double& v : common) v = normal(rng);
            for (std::size_t r = 0; r < all.size(); ++r) {
                Vector6 own = (way == 1 && r % 2 ? -1.0 : 1.0) * common;
                if (way == 2)
                    for (double& v : own) v = normal(rng);
                Pose& d = wrong[r].displacement.workobject_from_movedworkobject;
                d = retract(d, roots[r] * own);
            }
            const auto found = correct_path(path, wrong, kNames, {60, true});
            ASSERT_TRUE(found);
            for (std::size_t i = 0; i < path.size(); ++i) {
                const Eigen::Vector3d off = found->points[i].workobject_from_tool.translation() -
                                            truth->points[i].workobject_from_tool.translation();
                scatter[i] += off * off.transpose() / trials;
            }
        }
        for (std::size_t i = 0; i < path.size(); ++i) {
            const double worst = std::sqrt(scatter[i].eigenvalues().real().maxCoeff());
            // 400 trials scatter by 3.5 %, the worst of 80 points by three times that.
            EXPECT_LT(worst, 1.12 * truth->points[i].sigma_mm) << i;
            if (path[i].region >= 0) {
                EXPECT_GT(worst, 0.85 * truth->points[i].sigma_mm) << i;
            }
        }
    }
}

TEST(PathBlend, SparsePathSaysThatTheStepLiesInOneSegment) {
    std::vector<PathPoint> path(4);
    for (std::size_t i = 0; i < 4; ++i) {
        path[i].workobject_from_tool.translation().x() = 200.0 * static_cast<double>(i);
        path[i].region = i < 2 ? 0 : 1;
    }
    std::vector<PathRegion> all(2);
    all[1].displacement.workobject_from_movedworkobject.translation().y() = 2;
    const std::vector<std::string> names{"top", "latch"};
    const auto r = correct_path(path, all, names, {50, false});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->largest_mm.mm, 2);
    EXPECT_EQ(r->largest_mm.from, 1u);
    ASSERT_EQ(r->remarks.size(), 1u);
    EXPECT_THAT(r->remarks[0], testing::HasSubstr("between top and latch"));
}

TEST(PathBlend, EndsOfAnOpenPathKeepTheNearestRegion) {
    auto path = ring(100, 0);
    for (std::size_t i = 0; i < 100; ++i) path[i].region = i < 10 || i >= 90 ? -1 : i < 50 ? 0 : 1;
    const auto all = regions(8);
    const auto r = correct_path(path, all, kNames, {60, false});
    ASSERT_TRUE(r);
    EXPECT_EQ(at(*r, 0).matrix(), at(*r, 20).matrix());
    EXPECT_EQ(at(*r, 99).matrix(), at(*r, 80).matrix());
    // Closed, they are the transition from the last region to the first.
    const auto c = correct_path(path, all, kNames, {60, true});
    ASSERT_TRUE(c);
    EXPECT_GT(c->points[0].share, 0.1);
    EXPECT_LT(c->points[0].share, 0.9);
}

TEST(PathBlend, HostileInputIsRefused) {
    const auto path = ring(20, 2);
    const auto all = regions(9);
    const auto refused = [&](auto&& spoil, const std::string& part) {
        auto p = path;
        auto r = all;
        PathBlendOptions o{60, true};
        spoil(p, r, o);
        const auto answer = correct_path(p, r, kNames, o);
        ASSERT_FALSE(answer) << part;
        EXPECT_THAT(answer.error().sentence(), testing::HasSubstr(part));
    };
    const double nan = std::nan("");
    refused([&](auto& p, auto&, auto&) { p.resize(1); }, "a path of 1 points");
    refused([&](auto& p, auto&, auto&) { p[3].workobject_from_tool.translation().y() = nan; },
            "path point 4");
    refused([&](auto& p, auto&, auto&) { p[3].workobject_from_tool.linear() *= 1.01; }, "path point 4");
    refused([&](auto& p, auto&, auto&) { p[3].region = 4; }, "path point 4");
    refused([&](auto& p, auto&, auto&) { p[3].region = -2; }, "path point 4");
    refused(
        [&](auto& p, auto&, auto&) {
            for (auto& q : p) q.region = -1;
        },
        "no point belongs to a region");
    refused([&](auto&, auto& r,
                auto&) { r[1].displacement.workobject_from_movedworkobject.linear()(0, 0) = nan; },
            "region b");
    refused([&](auto&, auto& r, auto&) { r[2].covariance(3, 3) = nan; }, "region c");
    refused([&](auto&, auto& r, auto&) { r[2].covariance(3, 3) = -1; }, "region c");
    refused([&](auto&, auto&, auto& o) { o.blend_mm = 0; }, "blend_mm");
    refused([&](auto&, auto&, auto& o) { o.blend_mm = nan; }, "blend_mm");
    refused(
        [&](auto&, auto& r, auto&) {
            r[1].displacement.workobject_from_movedworkobject.linear() = rotation_exp({0, 0, 3.1});
        },
        "turned by");
    // Points on one place are a dwell, not an error.
    auto dwell = path;
    dwell[5].workobject_from_tool = dwell[4].workobject_from_tool;
    const auto r = correct_path(dwell, all, kNames, {60, true});
    ASSERT_TRUE(r);
    EXPECT_TRUE(std::isfinite(r->curvature_change_per_m));
}

}  // namespace
}  // namespace seamwright
