// Sheet metal that is drawn with its thickness: a scan of one of its faces lies as well on the other, and only a scan
// that knows where it was seen from, or sees where the sheet ends, tells them apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/cloud/fit.h"
#include "tests/core/cloud/test_parts.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using namespace test_parts;

enum class Side { outer, inner, rim };
struct Quad {
    std::array<Vector3d, 4> p;  // anticlockwise seen from outside
    Side side;
    Vector3d normal() const { return (p[1] - p[0]).cross(p[2] - p[0]).normalized(); }
};
using Sheet = std::vector<Quad>;

TriangleMesh mesh_of(const Sheet& sheet) {
    TriangleMesh mesh;
    for (const Quad& q : sheet) quad(mesh, q.p[0], q.p[1], q.p[2], q.p[3]);
    return mesh;
}

// Three plates that meet in a corner at the origin.
Sheet corner(double a, double b, double c, double t) {
    return {{{{{0, 0, 0}, {0, b, 0}, {a, b, 0}, {a, 0, 0}}}, Side::outer},
            {{{{0, 0, 0}, {a, 0, 0}, {a, 0, c}, {0, 0, c}}}, Side::outer},
            {{{{0, 0, 0}, {0, 0, c}, {0, b, c}, {0, b, 0}}}, Side::outer},
            {{{{t, t, t}, {a, t, t}, {a, b, t}, {t, b, t}}}, Side::inner},
            {{{{t, t, t}, {t, t, c}, {a, t, c}, {a, t, t}}}, Side::inner},
            {{{{t, t, t}, {t, b, t}, {t, b, c}, {t, t, c}}}, Side::inner},
            {{{{a, 0, 0}, {a, b, 0}, {a, b, t}, {a, t, t}}}, Side::rim},
            {{{{a, 0, 0}, {a, t, t}, {a, t, c}, {a, 0, c}}}, Side::rim},
            {{{{0, b, 0}, {0, b, c}, {t, b, c}, {t, b, t}}}, Side::rim},
            {{{{0, b, 0}, {t, b, t}, {a, b, t}, {a, b, 0}}}, Side::rim},
            {{{{0, 0, c}, {a, 0, c}, {a, t, c}, {t, t, c}}}, Side::rim},
            {{{{0, 0, c}, {t, t, c}, {t, b, c}, {0, b, c}}}, Side::rim}};
}

// A pan with four walls; its far edge runs aslant, so that nothing of it is alike when turned.
Sheet pan(double a, double b, double c, double t) {
    const auto at = [&](double x, double y, double z) {
        return Vector3d(x, y + (y > b / 2 ? 0.12 * x : 0), z);
    };
    std::array<Vector3d, 16> v;
    for (int k = 0; k < 2; ++k) {
        const double in = k * t, low = k * t;
        const auto i = static_cast<std::size_t>(8 * k);
        v[i] = at(in, in, low), v[i + 1] = at(a - in, in, low), v[i + 2] = at(a - in, b - in, low),
        v[i + 3] = at(in, b - in, low);
        for (std::size_t n = 0; n < 4; ++n) v[i + 4 + n] = {v[i + n].x(), v[i + n].y(), c};
    }
    const auto of = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l, Side side) {
        return Quad{{v[i], v[j], v[k], v[l]}, side};
    };
    Sheet sheet{of(0, 3, 2, 1, Side::outer), of(8, 9, 10, 11, Side::inner)};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t n = (k + 1) % 4;
        sheet.push_back(of(k, n, 4 + n, 4 + k, Side::outer));
        sheet.push_back(of(8 + k, 12 + k, 12 + n, 8 + n, Side::inner));
        sheet.push_back(of(4 + k, 4 + n, 12 + n, 12 + k, Side::rim));
    }
    return sheet;
}

// Points of the faces in `sides` for which `seen` holds, spread by area, with the normals as `normals` alone.
Cloud scan(std::mt19937_64& random, const Sheet& sheet, const std::vector<Side>& sides, std::size_t count,
           double noise_mm, const std::function<bool(const Vector3d&)>& seen) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> noise(0, noise_mm);
    struct Triangle {
        Vector3d a, u, v, normal;
    };
    std::vector<Triangle> triangles;
    std::vector<double> areas;
    for (const Quad& q : sheet) {
        if (std::find(sides.begin(), sides.end(), q.side) == sides.end()) continue;
        for (const std::size_t k : {1U, 2U}) {
            triangles.push_back({q.p[0], q.p[k] - q.p[0], q.p[k + 1] - q.p[0], q.normal()});
            areas.push_back(triangles.back().u.cross(triangles.back().v).norm());
        }
    }
    std::discrete_distribution<std::size_t> which(areas.begin(), areas.end());
    Cloud cloud;
    while (cloud.size() < count) {
        const Triangle& t = triangles[which(random)];
        double u = uniform(random), v = uniform(random);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Vector3d p = t.a + u * t.u + v * t.v;
        if (!seen(p)) continue;
        cloud.points.emplace_back(p + noise(random) * t.normal);
        cloud.normals.push_back(t.normal.cast<float>());
    }
    return cloud;
}

struct Placed {
    SurfaceFit fit;
    double error_mm = 0;  // at the part's middle
};
Placed placed(std::mt19937_64& random, const Sheet& sheet, Cloud cloud, double noise_mm = 0.05) {
    const Surface surface(mesh_of(sheet));
    const Pose truth = random_pose(random, 0.08, 20);
    transform(cloud, truth);
    FitOptions options;
    options.noise_mm = noise_mm;
    options.start = truth * random_pose(random, 0.01, 4);
    auto fit = fit_surface(cloud, surface, options);
    EXPECT_TRUE(fit);
    if (!fit) return {};
    const Vector3d middle = surface.box().center();
    return {*fit, (fit->base_from_part * middle - truth * middle).norm()};
}

struct Measures {
    double a, b, c, t;
    Sheet sheet() const { return corner(a, b, c, t); }
    // Away from the rims, and from the bends.
    bool inside(const Vector3d& p) const {
        return p.x() < 0.85 * a && p.y() < 0.85 * b && p.z() < 0.8 * c && (p.array() > 15).count() >= 2;
    }
};
constexpr Measures kSmall{200, 300, 80, 0.8}, kLarge{800, 1000, 120, 3};

TEST(FitSheet, OneFaceAwayFromTheRimsIsAmbiguousWhateverTheThickness) {
    for (const Measures& m : {kSmall, kLarge})
        for (const Side side : {Side::outer, Side::inner}) {
            std::mt19937_64 random(1);
            Cloud cloud =
                scan(random, m.sheet(), {side}, 3000, 0.05, [&](const auto& p) { return m.inside(p); });
            cloud.normals.clear();
            const Placed p = placed(random, m.sheet(), cloud);
            EXPECT_EQ(p.fit.status, FitStatus::ambiguous) << m.t << " off by " << p.error_mm;
        }
}

TEST(FitSheet, NormalsThatLookOutwardsTellTheFaceAndOthersAreNotBelieved) {
    const Measures& m = kSmall;
    for (const Side side : {Side::outer, Side::inner}) {
        std::mt19937_64 random(2);
        Cloud cloud = scan(random, m.sheet(), {side}, 3000, 0.05, [&](const auto& p) { return m.inside(p); });
        const Placed p = placed(random, m.sheet(), cloud);
        EXPECT_EQ(p.fit.status, FitStatus::ok) << m.t << " " << p.fit.reason.english();
        EXPECT_LT(p.error_mm, 0.05) << m.t;
        for (Eigen::Vector3f& n : cloud.normals)
            if (random() % 2 == 0) n = -n;
        EXPECT_EQ(placed(random, m.sheet(), cloud).fit.status, FitStatus::ambiguous) << m.t;
    }
}

TEST(FitSheet, BothFacesOrTheRimsTellItWithoutSides) {
    const auto all = [](const Vector3d&) { return true; };
    const Measures& m = kSmall;
    std::mt19937_64 random(3);
    Cloud both = scan(random, m.sheet(), {Side::outer, Side::inner}, 3000, 0.05,
                      [&](const auto& p) { return m.inside(p); });
    both.normals.clear();
    const Placed of_both = placed(random, m.sheet(), both);
    EXPECT_EQ(of_both.fit.status, FitStatus::ok) << m.t << " " << of_both.fit.reason.english();
    EXPECT_LT(of_both.error_mm, 0.05) << m.t;
    Cloud rims = scan(random, m.sheet(), {Side::outer, Side::rim}, 8000, 0.05, all);
    rims.normals.clear();
    const Placed of_rims = placed(random, m.sheet(), rims);
    EXPECT_EQ(of_rims.fit.status, FitStatus::ok) << m.t << " " << of_rims.fit.reason.english();
    EXPECT_LT(of_rims.error_mm, 0.05) << m.t;
}

// Its walls hold one another: only its bottom could be on its other face, and the strips of it beside the walls say no.
TEST(FitSheet, APanWithFourWallsIsFound) {
    const Sheet sheet = pan(500, 700, 60, 0.7);
    std::mt19937_64 random(4);
    Cloud cloud = scan(random, sheet, {Side::outer}, 12000, 0.05, [](const auto& p) { return p.z() < 48; });
    cloud.normals.clear();
    const Placed p = placed(random, sheet, cloud);
    EXPECT_EQ(p.fit.status, FitStatus::ok) << p.fit.reason.english();
    EXPECT_LT(p.error_mm, 0.05);
}

// A curved sheet over a rectangle about the origin, between two faces that lie t apart.
Sheet curved(double a, double b, std::size_t along, std::size_t across, double t,
             const std::function<double(double, double)>& height) {
    const auto at = [&](std::size_t i, std::size_t j, double side) {
        const double x = a * (static_cast<double>(i) / static_cast<double>(along) - 0.5),
                     y = b * (static_cast<double>(j) / static_cast<double>(across) - 0.5), h = 1e-3;
        const Vector3d normal =
            Vector3d(height(x - h, y) - height(x + h, y), height(x, y - h) - height(x, y + h), 2 * h)
                .normalized();
        return Vector3d(Vector3d(x, y, height(x, y)) + side * t / 2 * normal);
    };
    Sheet sheet;
    for (std::size_t i = 0; i < along; ++i)
        for (std::size_t j = 0; j < across; ++j) {
            sheet.push_back(
                {{at(i, j, 1), at(i + 1, j, 1), at(i + 1, j + 1, 1), at(i, j + 1, 1)}, Side::outer});
            sheet.push_back(
                {{at(i, j, -1), at(i, j + 1, -1), at(i + 1, j + 1, -1), at(i + 1, j, -1)}, Side::inner});
        }
    const auto rim = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
        sheet.push_back({{at(i, j, 1), at(i, j, -1), at(k, l, -1), at(k, l, 1)}, Side::rim});
    };
    for (std::size_t i = 0; i < along; ++i) rim(i, 0, i + 1, 0), rim(i + 1, across, i, across);
    for (std::size_t j = 0; j < across; ++j) rim(0, j + 1, 0, j), rim(along, j, along, j + 1);
    return sheet;
}

// A pressed panel of 500 x 400 mm, curved both ways, with two steps: moved by its thickness its one face all but lies on
// the other.
Sheet pressed(double t) {
    const auto step = [](double x) { return 1 / (1 + std::exp(-x)); };
    return curved(500, 400, 36, 28, t, [&](double u, double v) {
        const double x = u + 250, y = v + 200;
        return 60 * std::sin(0.9 * M_PI * x / 500) + 50 * std::sin(0.8 * M_PI * y / 400) +
               30 * step((x - 380) / 12) + 25 * step((y - 290) / 12) * (1 - x / 1000);
    });
}

// A wing of 300 x 180 mm with a dent: its faces lie on one another but for some hundredths of a millimetre.
Sheet wing(double t) {
    return curved(300, 180, 50, 30, t, [](double x, double y) {
        return x * x / 900 + y * y / 400 + 4e-5 * x * x * x +
               8 * std::exp(-(x - 60) * (x - 60) / 900 - (y + 30) * (y + 30) / 600);
    });
}

// Lids of weld nuts on the seen face, as far off it as none of its points.
void add_lids(std::mt19937_64& random, Cloud& cloud, int points_each) {
    constexpr double kRadius = 6, kHeight = 8;
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> noise(0, 0.03);
    const std::size_t seen = cloud.size();
    for (const Eigen::Vector2d& at : {Eigen::Vector2d{-40, 20}, {30, -50}, {70, 10}, {-90, -40}}) {
        std::size_t foot = 0;
        const auto off = [&](std::size_t i) {
            return std::hypot(cloud.points[i].x() - at.x(), cloud.points[i].y() - at.y());
        };
        for (std::size_t i = 0; i < seen; ++i)
            if (off(i) < off(foot)) foot = i;
        const Vector3d p = cloud.points[foot], n = cloud.normals[foot].cast<double>(),
                       u = n.cross(Vector3d::UnitY()).normalized(), v = n.cross(u);
        for (int k = 0; k < points_each; ++k) {
            const double turn = 2 * M_PI * uniform(random), out = kRadius * std::sqrt(uniform(random));
            cloud.points.emplace_back(p + out * (std::cos(turn) * u + std::sin(turn) * v) +
                                      (kHeight + noise(random)) * n);
            cloud.normals.push_back(n.cast<float>());
        }
    }
}

// Weld nuts on the seen face: their sides and their tops.
void add_nuts(std::mt19937_64& random, Cloud& cloud, int count) {
    constexpr double kRadius = 6.5, kHeight = 6.5;
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int nut = 0; nut < count; ++nut) {
        const std::size_t foot = random() % cloud.size();
        const Vector3d p = cloud.points[foot], n = cloud.normals[foot].cast<double>(),
                       u = n.cross(Vector3d::UnitY()).normalized(), v = n.cross(u);
        for (int k = 0; k < 30; ++k) {
            const double turn = 2 * M_PI * uniform(random);
            const double out = k % 2 == 0 ? 1 : std::sqrt(uniform(random)),
                         up = k % 2 == 0 ? uniform(random) : 1;
            cloud.points.emplace_back(p + kRadius * out * (std::cos(turn) * u + std::sin(turn) * v) +
                                      kHeight * up * n);
            cloud.normals.push_back(n.cast<float>());
        }
    }
}

TEST(FitSheet, TheOneFaceOfACurvedSheetIsNotTakenForTheOther) {
    std::mt19937_64 random(1);
    Cloud cloud = scan(random, pressed(1), {Side::outer}, 2500, 0.03, [](const auto&) { return true; });
    cloud.normals.clear();
    const Placed p = placed(random, pressed(1), cloud, 0);
    EXPECT_TRUE(p.fit.status != FitStatus::ok || p.error_mm < 0.05) << p.error_mm;
}

TEST(FitSheet, WhatStandsOnACurvedSheetDoesNotTellItsFaceButItsEndsDo) {
    for (const bool with_rim : {false, true}) {
        std::mt19937_64 random(1);
        const auto all = [](const auto&) { return true; };
        const Sheet sheet = pressed(1);
        Cloud cloud = scan(random, sheet, {Side::inner}, 1500, 0.03, all);
        add_nuts(random, cloud, 6);
        if (with_rim) {
            const Cloud rim = scan(random, sheet, {Side::rim}, 80, 0.03, all);
            cloud.points.insert(cloud.points.end(), rim.points.begin(), rim.points.end());
        }
        cloud.normals.clear();
        const Placed p = placed(random, sheet, cloud, 0);
        if (with_rim) {
            EXPECT_EQ(p.fit.status, FitStatus::ok) << p.fit.reason.english();
        }
        EXPECT_TRUE(p.fit.status != FitStatus::ok || p.error_mm < 0.05) << p.error_mm;
    }
}

// The pose is drawn to the nuts, and on the wrong face the misfit passes for a form that would hold the right one too.
TEST(FitSheet, NutsDoNotTellTheFaceOfACurvedSheetWhoseEndsAreNotSeen) {
    const auto inside = [](const Vector3d& p) { return std::abs(p.x()) < 100 && std::abs(p.y()) < 60; };
    for (const Side side : {Side::outer, Side::inner})
        for (const int points_each : {4, 13}) {
            std::mt19937_64 random(static_cast<std::uint64_t>(points_each));
            Cloud cloud = scan(random, wing(1), {side}, 1800, 0.03, inside);
            add_lids(random, cloud, points_each);
            cloud.normals.clear();
            const Placed p = placed(random, wing(1), cloud, 0);
            EXPECT_TRUE(p.fit.status == FitStatus::ambiguous ||
                        (p.fit.status == FitStatus::ok && p.error_mm < 0.1))
                << to_string(p.fit.status) << " " << p.error_mm;
        }
}

// Of three scans of one face of a curved sheet with nuts on it those that are placed; each of them right.
void expect_placed_beside_nuts(Side side, int first_seed) {
    int right = 0;
    for (int seed = first_seed; seed < first_seed + 6; seed += 2) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        Cloud cloud = scan(random, wing(1), {side}, 2500, 0.03, [](const auto&) { return true; });
        add_lids(random, cloud, 6);
        cloud.normals.clear();
        const Placed p = placed(random, wing(1), cloud, 0);
        if (p.fit.status != FitStatus::ok) continue;
        EXPECT_LT(p.error_mm, 0.1) << seed;
        ++right;
    }
    EXPECT_GE(right, 2);
}

TEST(FitSheet, NutsDoNotHideWhatTheEndsOfACurvedSheetTellOfItsOuterFace) {
    expect_placed_beside_nuts(Side::outer, 0);
}

TEST(FitSheet, NutsDoNotHideWhatTheEndsOfACurvedSheetTellOfItsInnerFace) {
    expect_placed_beside_nuts(Side::inner, 1);
}

TEST(FitSheet, SolidsAndSurfacesWithoutThicknessAreFoundWithoutSides) {
    const auto found = [](const TriangleMesh& mesh, Cloud cloud, int seed) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed));
        cloud.towards.clear();
        const Pose truth = random_pose(random, 0.08, 15);
        transform(cloud, truth);
        FitOptions options;
        options.start = Pose::Identity();
        const auto fit = fit_surface(cloud, Surface(mesh), options);
        ASSERT_TRUE(fit);
        EXPECT_EQ(fit->status, FitStatus::ok) << seed << " " << fit->reason.english();
        EXPECT_LT((fit->base_from_part.translation() - truth.translation()).norm(), 0.1) << seed;
    };
    std::mt19937_64 random(11);
    found(panel(8), panel_scan(random, 6000, 0.05), 1);
    found(box({200, 120, 80}), box_scan(random, {200, 120, 80}, 4000, 0.05, 0b010101), 2);
}

}  // namespace
}  // namespace seamwright
