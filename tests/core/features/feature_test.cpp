// Kinds of feature: known answers, statuses, refusals, hostile input, no allocation. Statistics of the
// covariances are in features_long_test.cpp.

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "contours.h"
#include "core/features/gap/gap_flush.h"
#include "tests/allocations.h"

namespace seamwright::test {
namespace {

std::unique_ptr<FeatureFinder> finder(const std::string& kind, ParameterValues values = {}) {
    FeatureRecipe recipe;
    recipe.kind = kind;
    recipe.parameters = std::move(values);
    if (kind == "template") recipe.template_profile = sample(hem(-15, 15), 0.05);
    auto made = make_feature_finder(recipe);
    EXPECT_TRUE(made) << (made ? "" : made.error().sentence());
    return made ? std::move(*made) : nullptr;
}

TEST(FeatureRegistry, EveryKindIsMadeAndDescribesItself) {
    ASSERT_EQ(feature_kinds().size(), 6U);
    for (const FeatureKind& kind : feature_kinds()) {
        EXPECT_EQ(feature_kind(kind.name), &kind);
        EXPECT_FALSE(kind.help.empty());
        for (const ParameterInfo& p : kind.parameters) {
            EXPECT_LE(p.minimum, p.default_value) << kind.name << " " << p.name;
            EXPECT_GE(p.maximum, p.default_value) << kind.name << " " << p.name;
            EXPECT_FALSE(p.help.empty());
        }
        EXPECT_NE(finder(std::string(kind.name)), nullptr);
    }
    EXPECT_EQ(feature_kind("nothing"), nullptr);
}

TEST(FeatureRegistry, RefusesWithOneSentence) {
    FeatureRecipe recipe;
    recipe.kind = "edge";
    auto r = make_feature_finder(recipe);
    ASSERT_FALSE(r);
    EXPECT_NE(r.error().sentence().find("contour-end"), std::string::npos);
    recipe.kind = "corner";
    recipe.parameters = {{"colour", 1}};
    EXPECT_FALSE(make_feature_finder(recipe));
    recipe.parameters = {{"window_x_min_mm", 5}, {"window_x_max_mm", 1}};
    EXPECT_FALSE(make_feature_finder(recipe));
    recipe.parameters = {{"blend_mm", std::nan("")}};
    EXPECT_FALSE(make_feature_finder(recipe));
    recipe.kind = "circle";
    recipe.parameters = {{"radius_min_mm", 5}, {"radius_max_mm", 1}};
    EXPECT_FALSE(make_feature_finder(recipe));
    recipe.kind = "template";
    recipe.parameters = {};
    EXPECT_FALSE(make_feature_finder(recipe));  // no template
}

TEST(ContourEnd, EitherSideAndSegments) {
    // Two sheets, the right one lower, and a gap.
    Profile p;
    for (int i = 0; i < 200; ++i) {
        p.x_mm.push_back(-10 + 0.05 * i);
        p.z_mm.push_back(5);
    }
    for (int i = 0; i < 100; ++i) {
        p.x_mm.push_back(3 + 0.05 * i);
        p.z_mm.push_back(1);
    }
    p.segment.assign(200, 0);
    p.segment.insert(p.segment.end(), 100, 1);
    const Feature several = finder("contour-end", {{"side", 0}})->find(p);
    EXPECT_EQ(several.status, FeatureStatus::ambiguous);
    EXPECT_EQ(several.rivals_mm.size(), 2U);
    const double outermost = 0;
    const Feature left = finder("contour-end", {{"side", 0}, {"segment", outermost}})->find(p);
    ASSERT_EQ(left.status, FeatureStatus::ok);
    EXPECT_NEAR(left.point_mm.x(), -10.025, 1e-9);
    EXPECT_NEAR(left.point_mm.y(), 5, 1e-9);
    EXPECT_NEAR(finder("contour-end", {{"side", 1}, {"segment", outermost}})->find(p).point_mm.x(),
                3 + 0.05 * 99 + 0.025, 1e-9);
    EXPECT_NEAR(
        finder("contour-end", {{"side", 1}, {"segment", outermost}, {"order", 2}})->find(p).point_mm.x(),
        -0.025, 1e-9);
    for (const double choice : {1.0, 2.0}) {  // longest, highest: the left sheet's right end
        const Feature f = finder("contour-end", {{"side", 1}, {"segment", choice}})->find(p);
        ASSERT_EQ(f.status, FeatureStatus::ok);
        EXPECT_NEAR(f.point_mm.x(), -10 + 0.05 * 199 + 0.025, 1e-9);
        EXPECT_NEAR(std::sqrt(f.covariance_mm2(0, 0)), 0.05 * std::sqrt(1 / 12.0 + 0.81 / 36), 1e-6);
    }
    EXPECT_NEAR(finder("contour-end", {{"side", 1}, {"window_z_min_mm", 3}})->find(p).point_mm.x(), -0.025,
                1e-9);
    const Feature cut = finder("contour-end", {{"side", 1}, {"window_x_max_mm", -3}})->find(p);
    EXPECT_EQ(cut.status, FeatureStatus::not_found);
    EXPECT_FALSE(cut.message.empty());
    EXPECT_EQ(finder("contour-end", {{"minimum_points", 500}})->find(p).status, FeatureStatus::no_points);
    // The same, not filtered: the gap ends the segment.
    p.segment.clear();
    EXPECT_NEAR(finder("contour-end", {{"side", 1}, {"segment", 1}})->find(p).point_mm.x(), -0.025, 1e-9);
}

TEST(Corner, ExactWithoutNoiseAndParallelRefused) {
    const Profile p = sample(corner(-20, 20).moved({1, 2, 0}), 0.07);
    const Feature f = finder("corner")->find(p);
    ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
    EXPECT_NEAR(f.point_mm.x(), 1, 1e-6);
    EXPECT_NEAR(f.point_mm.y(), 5, 1e-6);
    ASSERT_TRUE(f.phi_rad);
    EXPECT_NEAR(*f.phi_rad, 0.5 * (std::atan(0.25) - std::atan(0.4)), 1e-6);
    Shape line;
    line.line_to(-10, 0);
    line.line_to(10, 1);
    const Feature none = finder("corner")->find(sample(line, 0.05));
    EXPECT_EQ(none.status, FeatureStatus::ill_conditioned);
    // A third of the points of one side far off does not bend it.
    Random random(3);
    Profile dirty = p;
    for (std::size_t i = 0; i < dirty.size() / 2; i += 4) dirty.z_mm[i] += 3;
    const Feature g = finder("corner")->find(dirty);
    ASSERT_EQ(g.status, FeatureStatus::ok);
    EXPECT_NEAR(g.point_mm.x(), 1, 1e-6);
}

TEST(Circle, ExactShortArcAndKnownRadius) {
    Shape arc, tiny;
    arc.arc(3, -2, 6, 160, 30);
    tiny.arc(3, -2, 60, 93, 87);
    const Feature f = finder("circle")->find(sample(arc, 0.05));
    ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
    EXPECT_NEAR(f.point_mm.x(), 3, 1e-4);
    EXPECT_NEAR(f.point_mm.y(), -2, 1e-4);
    Random random(4);
    Profile t = sample(tiny, 0.05);
    add_noise(t, 0.02, random);
    EXPECT_NE(finder("circle")->find(t).status, FeatureStatus::ok);
    const Feature k = finder("circle", {{"radius_mm", 6}})->find(sample(arc, 0.05));
    ASSERT_EQ(k.status, FeatureStatus::ok);
    EXPECT_NEAR(k.point_mm.y(), -2, 1e-4);
    Shape line;
    line.line_to(-10, 0);
    line.line_to(10, 1);
    Profile flat = sample(line, 0.05);
    add_noise(flat, 0.02, random);
    EXPECT_NE(finder("circle")->find(flat).status, FeatureStatus::ok);
}

TEST(Extremum, EachOfTheFour) {
    const Profile up = sample(bead(-10, 10, 1, 6, 2), 0.05);
    Profile down = up, right = up, left = up;
    for (double& z : down.z_mm) z = -z;
    std::swap(right.x_mm, right.z_mm);
    left = right;
    for (double& x : left.x_mm) x = -x;
    const Profile* profiles[] = {&up, &down, &left, &right};
    const Eigen::Vector2d expected[] = {{1, 2}, {1, -2}, {-2, 1}, {2, 1}};
    for (int which = 0; which < 4; ++which) {
        const Feature f = finder("extremum", {{"which", double(which)}})->find(*profiles[which]);
        ASSERT_EQ(f.status, FeatureStatus::ok) << which << f.message;
        EXPECT_NEAR(f.point_mm.x(), expected[which].x(), 2e-3) << which;
        EXPECT_NEAR(f.point_mm.y(), expected[which].y(), 2e-3) << which;
    }
    EXPECT_EQ(finder("extremum")->find(sample(corner(-10, 10), 0.05)).status, FeatureStatus::not_found);
    Shape flat;
    flat.line_to(-10, 0);
    flat.line_to(10, 0);
    Random random(5);
    Profile noisy = sample(flat, 0.05);
    add_noise(noisy, 0.02, random);
    EXPECT_NE(finder("extremum")->find(noisy).status, FeatureStatus::ok);
}

TEST(TemplateFeature, CarriesItsReference) {
    FeatureRecipe recipe;
    recipe.kind = "template";
    recipe.template_profile = sample(hem(-15, 15), 0.05);
    recipe.template_reference_mm = {3, 12};
    auto made = make_feature_finder(recipe);
    ASSERT_TRUE(made);
    const PlanarMotion truth{5, -6, 0.15};
    const Feature f = (*made)->find(sample(hem(-30, 30).moved(truth), 0.05, 0.3));
    ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
    EXPECT_LT((f.point_mm - truth * recipe.template_reference_mm).norm(), 5e-3);
    ASSERT_TRUE(f.phi_rad);
    EXPECT_NEAR(*f.phi_rad, 0.15, 1e-4);
}

// Part of the contour in the dark, with and without noise: what is seen lies where it is.
TEST(TemplateFeature, SeenInPartIsFoundAsLongAsThePartHasItsShape) {
    FeatureRecipe recipe;
    recipe.kind = "template";
    recipe.template_reference_mm = {3, 12};
    const PlanarMotion truth{2, -3, 0.05};
    for (const double sigma : {0.0, 1e-4, 0.02}) {
        SCOPED_TRACE(sigma);
        Random random(5);
        std::normal_distribution<double> noise(0, 1);
        const auto noisy = [&](Profile p) {
            for (double& z : p.z_mm) z += sigma * noise(random);
            return p;
        };
        recipe.template_profile = noisy(sample(hem(-15, 15), 0.05));
        const auto finder = make_feature_finder(recipe).value();
        const Profile all = noisy(sample(hem(-15, 15).moved(truth), 0.05, 0.3));
        for (const double seen_to : {4.0, 8.0}) {
            Profile part = all;
            for (std::size_t i = 0; i < part.size(); ++i)
                if (part.x_mm[i] > seen_to) part.x_mm[i] = part.z_mm[i] = NAN;
            const Feature f = finder->find(part);
            ASSERT_EQ(f.status, FeatureStatus::ok) << f.message << ", up to " << seen_to;
            EXPECT_LT((f.point_mm - truth * recipe.template_reference_mm).norm(), 0.02 + 2 * sigma);
        }
    }
}

TEST(GapFlush, KnownGapEitherReference) {
    Profile p;
    for (int i = 0; i < 300; ++i) {
        p.x_mm.push_back(-15 + 0.05 * i);
        p.z_mm.push_back(0);
    }
    for (int i = 0; i < 300; ++i) {
        p.x_mm.push_back(3 + 0.05 * i);
        p.z_mm.push_back(0.8);
    }
    for (const double turn : {0.0, 0.2, -0.3}) {
        Profile q = p;
        const PlanarMotion m{4, -7, turn};
        for (std::size_t i = 0; i < p.size(); ++i) {
            const Eigen::Vector2d v = m * Eigen::Vector2d(p.x_mm[i], p.z_mm[i]);
            q.x_mm[i] = v.x();
            q.z_mm[i] = v.y();
        }
        for (const bool right : {false, true}) {
            GapFlushSettings settings;
            settings.reference =
                right ? GapFlushSettings::Reference::right : GapFlushSettings::Reference::left;
            const GapFlush g = GapFlushGauge(settings).measure(q);
            ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
            EXPECT_NEAR(g.gap_mm, 3 - (-15 + 0.05 * 299) - 0.05, 1e-6);  // half a pitch at either edge
            EXPECT_NEAR(g.flush_mm, right ? -0.8 : 0.8, 1e-6);
            const Eigen::Vector2d between = g.other_point_mm - g.reference_point_mm;
            EXPECT_NEAR(between.dot(g.along), g.gap_mm, 1e-9);
            EXPECT_NEAR(between.norm(), std::hypot(g.gap_mm, g.flush_mm), 1e-9);
            settings.gap_by = GapBy::edge_distance;
            const GapFlush d = GapFlushGauge(settings).measure(q);
            ASSERT_EQ(d.status, GapFlushStatus::ok) << d.message;
            EXPECT_NEAR(d.gap_mm, std::hypot(g.gap_mm, 0.8), 1e-6);
            EXPECT_EQ(d.flush_mm, g.flush_mm);
        }
    }
    Profile whole = sample(hem(-10, 10), 0.05);
    EXPECT_NE(GapFlushGauge({}).measure(Profile{}).status, GapFlushStatus::ok);
    Shape line;
    line.line_to(-10, 0);
    line.line_to(10, 1);
    EXPECT_EQ(GapFlushGauge({}).measure(sample(line, 0.05)).status, GapFlushStatus::not_found);
}

TEST(GapFlush, DarkGapBetweenSheetsInFlushIsFound) {
    // The filter gives both sheets one segment, and another hole, narrower than the gap, lies in the left
    // one.
    Profile p;
    for (int i = 0; i < 600; ++i) {
        const double x = -15 + 0.05 * i;
        const bool dark = (x > -2.01 && x < 1.01) || (x > -9 && x < -8);
        p.x_mm.push_back(x);
        p.z_mm.push_back(dark ? std::numeric_limits<double>::quiet_NaN() : 0.1 * x);
        p.segment.push_back(dark ? kOutlier : 0);
    }
    const GapFlush g = GapFlushGauge({}).measure(p);
    ASSERT_EQ(g.status, GapFlushStatus::ok) << g.message;
    // Returns end at -2.05 and begin at 1.05; half a pitch more at either edge.
    EXPECT_NEAR(g.gap_mm, (3.1 - 0.05) * std::hypot(1, 0.1), 1e-6);
    EXPECT_NEAR(g.flush_mm, 0, 1e-9);
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.x_mm[i] > -2.01 && p.x_mm[i] < 0.85) {
            p.z_mm[i] = 0.1 * p.x_mm[i];
            p.segment[i] = 0;
        }
    GapFlushSettings near;
    near.window.x_min = -5;
    EXPECT_EQ(GapFlushGauge(near).measure(p).status, GapFlushStatus::not_found) << "a few missing returns";
}

TEST(GapFlush, EdgeDistanceIsAsSureAsItSays) {
    std::mt19937_64 engine(9);
    std::normal_distribution<double> noise(0, 0.02);
    std::uniform_real_distribution<double> phase(0, 1);
    int inside = 0;
    constexpr int kTrials = 2000;
    for (int trial = 0; trial < kTrials; ++trial) {
        Profile p;
        const double left = -2 - 0.05 * phase(engine), right = 1 + 0.05 * phase(engine);
        for (int i = 240; i >= 0; --i) {
            p.x_mm.push_back(left - 0.05 * i);
            p.z_mm.push_back(noise(engine));
        }
        for (int i = 0; i < 240; ++i) {
            p.x_mm.push_back(right + 0.05 * i);
            p.z_mm.push_back(3 + noise(engine));
        }
        GapFlushSettings settings;
        settings.gap_by = GapBy::edge_distance;
        const GapFlush g = GapFlushGauge(settings).measure(p);
        ASSERT_EQ(g.status, GapFlushStatus::ok);
        // The surfaces end at -2 and 1, up to a pitch beyond their last returns.
        inside += std::abs(g.gap_mm - std::hypot(3, 3)) <= 1.959964 * std::sqrt(g.covariance(0, 0));
    }
    EXPECT_NEAR(static_cast<double>(inside) / kTrials, 0.95, 0.02);
}

TEST(GapFlush, RefusesSettingsThatAreNoSurface) {
    EXPECT_TRUE(check(GapFlushSettings{}));
    const auto with = [](auto change) {
        GapFlushSettings s;
        change(s);
        return check(s).has_value();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(with([](auto& s) { s.window.x_min = s.window.x_max; }));
    EXPECT_FALSE(with([&](auto& s) { s.window.z_max = nan; }));
    EXPECT_FALSE(with([](auto& s) { s.surface_mm = 0; }));
    EXPECT_FALSE(with([&](auto& s) { s.surface_mm = nan; }));
    EXPECT_FALSE(with([](auto& s) { s.edge_skip_mm = -1; }));
    EXPECT_FALSE(with([](auto& s) { s.minimum_points = 3; }));
    // A profile of nothing but missing returns, and one whose numbers overflow.
    Profile bad;
    bad.x_mm = {nan, 1e308, -1e308, nan};
    bad.z_mm = {nan, 1e308, 1e308, 0};
    EXPECT_NE(GapFlushGauge({}).measure(bad).status, GapFlushStatus::ok);
}

TEST(Features, SensorPointIsTheSensorsWithTheStatedSigma) {
    Profile points;
    points.x_mm = {1, std::numeric_limits<double>::quiet_NaN(), -3.5};
    points.z_mm = {2, 4, 0.25};
    points.segment = {kOutlier, kOutlier, kOutlier};  // no contour, no segments
    const Feature third = finder("sensor-point", {{"index", 2}, {"sigma_mm", 0.1}})->find(points);
    ASSERT_EQ(third.status, FeatureStatus::ok) << third.message;
    EXPECT_EQ(third.point_mm, Eigen::Vector2d(-3.5, 0.25));
    EXPECT_TRUE(third.covariance_mm2.isApprox(0.01 * Eigen::Matrix2d::Identity(), 1e-12));
    EXPECT_EQ(finder("sensor-point", {{"index", 1}})->find(points).status, FeatureStatus::not_found);
    EXPECT_EQ(finder("sensor-point", {{"index", 3}})->find(points).status, FeatureStatus::no_points);
}

TEST(Features, HostileProfilesNeverGiveAGoodPoint) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Profile none, one, same, nans, two;
    one.x_mm = one.z_mm = {1};
    two.x_mm = two.z_mm = {1, 2};
    same.x_mm = same.z_mm = std::vector<double>(200, 3.0);
    nans.x_mm = std::vector<double>(200, 1.0);
    nans.z_mm = std::vector<double>(200, nan);
    Profile outliers = sample(hem(-10, 10), 0.05);
    outliers.segment.assign(outliers.size(), kOutlier);
    Profile infinite = sample(hem(-10, 10), 0.05);
    for (double& z : infinite.z_mm) z = std::numeric_limits<double>::infinity();
    for (const FeatureKind& kind : feature_kinds()) {
        const auto f = finder(std::string(kind.name));
        for (const Profile* p : {&none, &one, &two, &same, &nans, &outliers, &infinite}) {
            // The sensor's own point needs no contour: any finite one is what the sensor says.
            if (kind.name == "sensor-point" && p->size() > 0 && std::isfinite(p->z_mm[0])) continue;
            const Feature r = f->find(*p);
            EXPECT_NE(r.status, FeatureStatus::ok) << kind.name;
            EXPECT_FALSE(r.message.empty()) << kind.name;
        }
        // Far away and very large: an answer or a status, but nothing that is not a number.
        for (const double scale : {1e-6, 1.0, 1e6}) {
            Profile p = sample(hem(-10, 10), 0.05);
            for (double& x : p.x_mm) x = x * scale + 4e4;
            for (double& z : p.z_mm) z *= scale;
            const Feature r = f->find(p);
            if (r.status == FeatureStatus::ok) {
                EXPECT_TRUE(r.point_mm.allFinite()) << kind.name;
                EXPECT_TRUE(r.covariance_mm2.allFinite()) << kind.name;
            }
        }
    }
}

TEST(Features, FindAllocatesNothingAfterTheFirstCalls) {
    Random random(6);
    std::vector<Profile> profiles;
    for (int i = 0; i < 6; ++i) {
        Profile p = sample(hem(-20, 20).moved({i - 3.5, 2.0 - i, 0.02 * i}), 0.05);
        add_noise(p, 0.02, random);
        profiles.push_back(p);
    }
    for (const FeatureKind& kind : feature_kinds()) {
        const bool ends = kind.name == "contour-end";  // of the hem, whose wall may count as a step
        const auto f =
            finder(std::string(kind.name), ends ? ParameterValues{{"segment", 1}} : ParameterValues{});
        for (int round = 0; round < 2; ++round)
            for (const Profile& p : profiles) f->find(p);
        const long before = allocations_so_far();
        int good = 0;
        for (const Profile& p : profiles) good += f->find(p).status == FeatureStatus::ok;
        // A refusal carries its sentence, which is text on the heap: only good answers must be free.
        if (good == static_cast<int>(profiles.size())) {
            EXPECT_EQ(allocations_so_far() - before, 0) << kind.name;
        }
        if (kind.name == "template" || kind.name == "contour-end") {
            EXPECT_EQ(good, 6) << kind.name;
        }
    }
}

}  // namespace
}  // namespace seamwright::test
