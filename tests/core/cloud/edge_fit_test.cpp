// A scan on edges of its drawing: known answers, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "core/cloud/edge/edge_fit.h"
#include "core/cloud/edge/sheet_ends.h"
#include "tests/core/cloud/edge_sheet.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using namespace test_parts;

Expected<EdgeFit> fitted(const Cloud& cloud, const EdgeCurve& edge, const TriangleMesh& mesh,
                         const Pose& start = Pose::Identity()) {
    FitOptions options;
    options.start = start;
    return fit_edges(cloud, {&edge, 1}, Surface(mesh), options);
}

// A flat sheet y < side(x), 200 mm long, with profiles every 2 mm.
Cloud flat_scan(const std::function<bool(double, double)>& sheet, double reach) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    Cloud c;
    for (double x = -reach; x < reach; x += 2) {
        const double phase = uniform(random) * 0.2;
        for (double y = -reach + phase; y < reach; y += 0.2)
            if (sheet(x, y)) c.points.emplace_back(x, y, 0.02 * normal(random));
    }
    return c;
}
EdgeCurve curve_of(const std::function<Vector3d(double)>& at, double last, double step,
                   const std::function<Vector3d(double)>& outward) {
    EdgeCurve e;
    e.sided = false;
    for (double s = 0; s <= last + 1e-9; s += step) {
        EdgeSample p;
        p.point_mm = at(s);
        p.outward = outward(s);
        p.normal = Vector3d::UnitZ();
        p.tangent = p.outward.cross(p.normal);
        p.arc_mm = s;
        e.samples.push_back(p);
    }
    return e;
}
TriangleMesh flat_mesh(double reach) {
    TriangleMesh m;
    quad(m, {-reach, -reach, 0}, {reach, -reach, 0}, {reach, reach / 2, 0}, {-reach, reach / 2, 0});
    return m;
}

TEST(EdgeFit, ACurvedSideIsFoundWhereItIsAndTheSheetBelowIsNoPartOfIt) {
    std::mt19937_64 random(3);
    Cloud cloud = sheet_scan(random, {});
    const Pose truth = make_pose(rotation_exp({0.02, -0.03, 0.04}), {9, -7, 5});
    transform(cloud, truth);
    const auto found = fitted(cloud, sheet_edge(), sheet_mesh());
    ASSERT_TRUE(found) << found.error().what.english();
    ASSERT_EQ(found->fit.status, FitStatus::ok) << found->fit.reason.english();
    const Vector3d middle(350, 300, 0);
    EXPECT_LT((found->fit.base_from_part * middle - truth * middle).norm(), 0.05);
    EXPECT_GT(found->fit.share_on_part, 0.9);
    EXPECT_GT(found->deviation.share_seen, 0.9);
    EXPECT_LT(found->deviation.rms_mm, 0.2);
    EXPECT_EQ(found->ends.size(), found->deviation.signed_mm.size());
}

// Without renewal theory's half spacing every end would lie inside: 0.5 mm between points, and the side is found to a tenth
// of that.
TEST(EdgeFit, TheSpacingOfThePointsMovesNothing) {
    std::mt19937_64 random(4);
    ScanOfSheet s;
    s.point_mm = 0.5, s.beneath = false;
    const auto found = fitted(sheet_scan(random, s), sheet_edge(), sheet_mesh());
    ASSERT_TRUE(found);
    ASSERT_EQ(found->fit.status, FitStatus::ok) << found->fit.reason.english();
    EXPECT_NEAR(found->fit.base_from_part.translation().y(), 0, 0.05);
}

TEST(EdgeFit, AStraightEdgeLeavesTheShiftAlongAndTheTurnAboutItOpen) {
    const auto edge = curve_of([](double s) { return Vector3d(-90 + s, 20, 0); }, 180, 2,
                               [](double) { return Vector3d::UnitY(); });
    const auto found = fitted(flat_scan([](double, double y) { return y < 20; }, 100), edge, flat_mesh(100));
    ASSERT_TRUE(found) << found.error().what.english();
    EXPECT_EQ(found->fit.status, FitStatus::under_determined) << found->fit.reason.english();
    ASSERT_EQ(found->fit.unobservable.size(), 2U) << found->fit.reason.english();
    EXPECT_NE(found->fit.unobservable[0].english().find("translation along X"), std::string::npos)
        << found->fit.reason.english();
    EXPECT_NE(found->fit.unobservable[1].english().find("rotation about"), std::string::npos);
    EXPECT_TRUE(found->fit.covariance.isZero(0)) << "nothing is stated of what is refused";
}

TEST(EdgeFit, ACircleLeavesTheTurnAboutItsAxisOpen) {
    const double radius = 60;
    auto edge = curve_of(
        [&](double s) { return Vector3d(radius * std::cos(s / radius), radius * std::sin(s / radius), 0); },
        2 * kPi * radius, 2 * kPi * radius / 180,
        [&](double s) { return Vector3d(std::cos(s / radius), std::sin(s / radius), 0); });
    for (auto& s : edge.samples) s.tangent = -s.tangent;  // counter-clockwise
    edge.closed = true;
    const auto found =
        fitted(flat_scan([&](double x, double y) { return std::hypot(x - 1, y + 2) < radius; }, 100), edge,
               flat_mesh(80));
    ASSERT_TRUE(found) << found.error().what.english();
    EXPECT_EQ(found->fit.status, FitStatus::under_determined) << found->fit.reason.english();
    ASSERT_EQ(found->fit.unobservable.size(), 1U) << found->fit.reason.english();
    EXPECT_NE(found->fit.unobservable[0].english().find("rotation about Z"), std::string::npos)
        << found->fit.reason.english();
    EXPECT_NEAR(found->fit.base_from_part.translation().x(), 1, 0.1);
    EXPECT_NEAR(found->fit.base_from_part.translation().y(), -2, 0.1);
}

// A sheet that ends against the drawing's side, or nowhere in the scan, is none of it.
TEST(EdgeFit, WhatIsNoEndOfThisSheetIsRefused) {
    std::mt19937_64 random(6);
    EdgeCurve other_side = sheet_edge();
    for (EdgeSample& s : other_side.samples) s.outward = -s.outward;
    ScanOfSheet alone;
    alone.beneath = false;
    const auto turned = fitted(sheet_scan(random, alone), other_side, sheet_mesh());
    ASSERT_TRUE(turned);
    EXPECT_NE(turned->fit.status, FitStatus::ok);
    Cloud inside = sheet_scan(random, {});
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (inside.points[i].y() < sheet_side(inside.points[i].x()) - 75) kept.push_back(i);
    const auto nothing = fitted(picked(inside, kept), sheet_edge(), sheet_mesh());
    EXPECT_TRUE(!nothing || nothing->fit.status == FitStatus::no_fit);
}

TEST(EdgeFit, WithoutAStartNothingIsFitted) {
    std::mt19937_64 random(7);
    const EdgeCurve edge = sheet_edge();
    const auto found = fit_edges(sheet_scan(random, {}), {&edge, 1}, Surface(sheet_mesh()), {});
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().kind, ErrorKind::input);
}

TEST(SheetEnds, LieOnTheSidesOfASheet) {
    const SheetEnds found = sheet_ends(flat_scan([](double, double y) { return y < 20; }, 100));
    ASSERT_GT(found.ends.size(), 50U);
    int side = 0;
    for (const SheetEnd& e : found.ends) {
        EXPECT_LT(std::min({100 - std::abs(e.place_mm.x()), 20 - e.place_mm.y(), e.place_mm.y() + 100}),
                  found.radius_mm);
        side += e.outward.y() > 0.9 && e.place_mm.y() > 20 - found.radius_mm;
    }
    EXPECT_GT(side, 20);
}

}  // namespace
}  // namespace seamwright
