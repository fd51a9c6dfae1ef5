#include "core/panel/double_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "core/features/gap/gap_flush.h"

namespace seamwright {
namespace {

constexpr double kFold = 1.5;  // radius

// Body left of the gap (surface z = 0.03 x, fold at x = -2 downwards), panel right of it from x = 2, 0.4 mm
// proud. The contour by its arc length from the fold's end into the surface.
Eigen::Vector2d on_side(double s, double edge_x, double height, double inward) {
    const double arc = kFold * kPi / 2;
    if (s < arc) {
        const double a = s / kFold;  // 0: pointing into the gap, at the edge
        return {edge_x + inward * kFold * (1 - std::cos(a)), height - kFold * (1 - std::sin(a))};
    }
    const double d = s - arc;
    return {edge_x + inward * (kFold + d), height + 0.03 * inward * d};
}
Eigen::Vector2d body_at(double s) {
    return on_side(s, -2, 0, -1);
}
Eigen::Vector2d panel_at(double s) {
    return on_side(s, 2, 0.4, 1);
}

struct View {
    Pose sensor_from_head = Pose::Identity();
    double pitch = 0.1, phase = 0.5, body_from = 0, body_to = 25, panel_from = 0,
           panel_to = 25;  // arc lengths
};

Profile seen(const View& view, double noise_mm, std::mt19937_64* engine) {
    std::vector<std::pair<Eigen::Vector2d, std::int32_t>> points;
    for (double s = view.body_to - view.phase * view.pitch; s > view.body_from; s -= view.pitch)
        points.push_back({body_at(s), 0});
    for (double s = view.panel_from + view.phase * view.pitch; s < view.panel_to; s += view.pitch)
        points.push_back({panel_at(s), 1});
    const Pose head_from_sensor = view.sensor_from_head.inverse();
    Profile p;
    for (const auto& [at, segment] : points) {
        Eigen::Vector3d q = head_from_sensor * Eigen::Vector3d(at.x(), 0, at.y());
        if (noise_mm > 0) {
            std::normal_distribution<double> normal(0, noise_mm);
            q.x() += normal(*engine);
            q.z() += normal(*engine);
        }
        p.x_mm.push_back(q.x());
        p.z_mm.push_back(q.z());
        p.intensity.push_back(0.5f);
        p.segment.push_back(segment);
    }
    return p;
}

// Tilted towards each other: each sees the fold that faces it, and the surfaces up to 10 mm beyond the gap.
View left_view() {
    View v;
    v.sensor_from_head = make_pose(rotation_exp({0, 0.35, 0}), {-8, 0, 3});
    v.pitch = 0.08;
    v.body_from = kFold * kPi / 2;
    v.panel_to = 12;
    return v;
}
View right_view() {
    View v;
    v.sensor_from_head = make_pose(rotation_exp({0, -0.3, 0}), {9, 0, 2});
    v.pitch = 0.11;
    v.phase = 0.3;
    v.panel_from = kFold * kPi / 2;
    v.body_to = 12;
    return v;
}

double off_contour(double x, double z) {
    double best = 1e9;
    for (const auto& at : {body_at, panel_at}) {
        double centre = 12, reach = 16;
        for (int round = 0; round < 6; ++round, reach /= 40) {
            double nearest = 1e9, where = centre;
            for (int k = -100; k <= 100; ++k) {
                const double s = std::max(0.0, centre + reach * k / 100);
                if (const double d = (at(s) - Eigen::Vector2d(x, z)).norm(); d < nearest) {
                    nearest = d;
                    where = s;
                }
            }
            centre = where;
            best = std::min(best, nearest);
        }
    }
    return best;
}

DoubleHeadProfile merged(const View& a, const View& b, double noise, std::mt19937_64* engine,
                         const DoubleHeadOptions& options = {}) {
    const Profile first = seen(a, noise, engine), second = seen(b, noise, engine);
    const double sigma = noise > 0 ? noise : 0.03;
    auto out = merge_heads(first, {a.sensor_from_head, sigma}, second, {b.sensor_from_head, sigma}, options);
    EXPECT_TRUE(out) << out.error().sentence();
    return out ? *out : DoubleHeadProfile{};
}

TEST(DoubleHead, IsTheProfileThatOneIdealHeadWouldSee) {
    const DoubleHeadProfile m = merged(left_view(), right_view(), 0, nullptr);
    ASSERT_EQ(m.status, DoubleHeadStatus::ok) << m.message;
    EXPECT_TRUE(m.profile.filtered());
    ASSERT_EQ(m.sigma_mm.size(), m.profile.size());
    EXPECT_EQ(m.profile.segment.front(), 0);
    EXPECT_EQ(m.profile.segment.back(), 1);
    for (std::size_t i = 0; i < m.profile.size(); ++i)
        EXPECT_LT(off_contour(m.profile.x_mm[i], m.profile.z_mm[i]), 2e-3) << m.profile.x_mm[i];
    EXPECT_LT(m.disagreement_mm, 1e-3);

    const Profile ideal = seen({}, 0, nullptr);
    GapFlushGauge gauge{GapFlushSettings{}};
    const GapFlush whole = gauge.measure(m.profile), one = gauge.measure(ideal);
    ASSERT_EQ(one.status, GapFlushStatus::ok);
    ASSERT_EQ(whole.status, GapFlushStatus::ok);
    EXPECT_NEAR(whole.gap_mm, one.gap_mm, 0.1);
    EXPECT_NEAR(whole.flush_mm, one.flush_mm, 1e-3);
    // What the double head is for: the left head alone takes the body's surface for its edge.
    const GapFlush alone = gauge.measure(seen(left_view(), 0, nullptr));
    EXPECT_GT(std::abs(alone.gap_mm - one.gap_mm), 1.0);
}

TEST(DoubleHead, NoPlaceCountsTwice) {
    const DoubleHeadProfile m = merged(left_view(), right_view(), 0, nullptr);
    const auto count = [](const Profile& p, double from, double to) {
        return std::count_if(p.x_mm.begin(), p.x_mm.end(), [&](double x) { return x > from && x < to; });
    };
    // 5 mm of panel surface that both see: as many points as the coarser head has alone.
    EXPECT_NEAR(static_cast<double>(count(m.profile, 5, 10)), 5 / 0.11, 2);
    EXPECT_NEAR(static_cast<double>(count(m.profile, 16, 20)), 4 / 0.11, 2);  // right head alone
    for (std::size_t i = 1; i < m.profile.size(); ++i)
        if (m.profile.segment[i] == m.profile.segment[i - 1]) {
            EXPECT_GE(m.profile.x_mm[i], m.profile.x_mm[i - 1]);
        }
}

TEST(DoubleHead, OrderOfTheHeadsDoesNotMatter) {
    std::mt19937_64 engine(5);
    const View a = left_view(), b = right_view();
    const Profile first = seen(a, 0.03, &engine), second = seen(b, 0.03, &engine);
    const Head ha{a.sensor_from_head, 0.03}, hb{b.sensor_from_head, 0.05};
    const auto one = merge_heads(first, ha, second, hb), other = merge_heads(second, hb, first, ha);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->profile.x_mm, other->profile.x_mm);
    EXPECT_EQ(one->profile.z_mm, other->profile.z_mm);
    EXPECT_EQ(one->profile.segment, other->profile.segment);
    EXPECT_EQ(one->profile.intensity, other->profile.intensity);
    EXPECT_EQ(one->sigma_mm, other->sigma_mm);
    EXPECT_EQ(one->disagreement_mm, other->disagreement_mm);
    EXPECT_EQ(one->offset_mm, -other->offset_mm);
}

TEST(DoubleHead, StatedSigmaHolds) {
    std::mt19937_64 engine(11);
    int inside = 0, points = 0, offsets = 0;
    constexpr int kTrials = 1500;
    constexpr double kNoise = 0.03;
    double squares = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        const DoubleHeadProfile m = merged(left_view(), right_view(), kNoise, &engine);
        ASSERT_EQ(m.status, DoubleHeadStatus::ok) << m.message;
        offsets += std::abs(m.offset_mm) <= 1.959964 * m.offset_sigma_mm;
        for (std::size_t i = 0; i < m.profile.size(); ++i) {
            const double x = m.profile.x_mm[i];
            if (x < 4.5) continue;  // the panel's plain surface, shared up to about 12 mm
            const double off = (m.profile.z_mm[i] - 0.4 - 0.03 * (x - 2 - kFold)) / std::hypot(1, 0.03);
            inside += std::abs(off) <= 1.959964 * m.sigma_mm[i];
            squares += std::pow(off / m.sigma_mm[i], 2);
            ++points;
        }
    }
    EXPECT_NEAR(static_cast<double>(inside) / points, 0.95, 0.005);
    EXPECT_NEAR(squares / points, 1.0, 0.01);
    EXPECT_NEAR(static_cast<double>(offsets) / kTrials, 0.95, 0.02);
}

TEST(DoubleHead, InformationIsNeitherLostNorCountedTwice) {
    std::mt19937_64 engine(3);
    const View a = left_view(), b = right_view();
    const Profile first = seen(a, 0.03, &engine), second = seen(b, 0.03, &engine);
    const auto m = merge_heads(first, {a.sensor_from_head, 0.03}, second, {b.sensor_from_head, 0.05});
    ASSERT_TRUE(m);
    double information = 0;
    for (double sigma : m->sigma_mm) information += 1 / (sigma * sigma);
    const double given = static_cast<double>(first.size()) / (0.03 * 0.03) +
                         static_cast<double>(second.size()) / (0.05 * 0.05);
    EXPECT_NEAR(information / given, 1, 1e-12);
    EXPECT_LT(m->sigma_mm.size() + 100, first.size() + second.size());  // the overlap is merged, not mixed
    EXPECT_GT(m->shared_cells, 100);
}

TEST(DoubleHead, TellsAWrongRelationAndRefusesBeyondTheLimit) {
    std::mt19937_64 engine(7);
    const View a = left_view(), b = right_view();
    const Profile first = seen(a, 0.02, &engine), second = seen(b, 0.02, &engine);
    const auto with = [&](const Eigen::Vector3d& wrong) {
        Pose p = b.sensor_from_head;
        p.translation() += wrong;
        auto out = merge_heads(first, {a.sensor_from_head, 0.02}, second, {p, 0.02});
        EXPECT_TRUE(out);
        return *out;
    };
    const DoubleHeadProfile little = with({0, 0, 0.05});
    EXPECT_EQ(little.status, DoubleHeadStatus::ok);
    EXPECT_NEAR(little.offset_mm, 0.05, 4 * little.offset_sigma_mm);
    const DoubleHeadProfile much = with({0, 0, -0.3});
    EXPECT_EQ(much.status, DoubleHeadStatus::disagree);
    EXPECT_NEAR(much.disagreement_mm, 0.3, 0.02);
    EXPECT_NEAR(much.offset_mm, -0.3, 0.02);
    EXPECT_THAT(much.message, testing::HasSubstr("calibrate"));
    EXPECT_EQ(with({0, 0, 2.5}).status, DoubleHeadStatus::disagree);  // nothing in common any more
    EXPECT_EQ(with({0, 1, 0}).status, DoubleHeadStatus::not_coplanar);
}

// A level sheet from -12 to `end` seen by two upright heads with fields of +-20 mm.
Profile level(double end, int lines, bool every_line) {
    Profile p;
    for (int i = 0; i < lines; ++i) {
        const double x = -20 + 40. / lines * (i + 0.5);
        const bool there = x > -12 && x < end;
        if (!there && !every_line) continue;
        p.x_mm.push_back(x);
        p.z_mm.push_back(there ? 0 : std::numeric_limits<double>::quiet_NaN());
        p.segment.push_back(there ? 0 : kOutlier);
    }
    return p;
}

TEST(DoubleHead, TellsWhereItsFieldEnds) {
    const auto empty_lines = [](const DoubleHeadProfile& m) {
        const auto& z = m.profile.z_mm;
        const auto returned = [](double v) { return std::isfinite(v); };
        return std::pair(std::find_if(z.begin(), z.end(), returned) - z.begin(),
                         std::find_if(z.rbegin(), z.rend(), returned) - z.rbegin());
    };
    // 8 mm on the left; the sheet leaves the field on the right. Steps of 0.1 and 0.2 mm.
    const Profile fine = level(99, 400, true), coarse = level(99, 200, true);
    for (const auto& [first, second] : {std::pair(fine, coarse), std::pair(coarse, fine)}) {
        const auto m = merge_heads(first, {}, second, {});
        ASSERT_TRUE(m && m->status == DoubleHeadStatus::ok);
        EXPECT_EQ(empty_lines(*m), (std::pair<std::ptrdiff_t, std::ptrdiff_t>(41, 1)));
    }
    // The other way round, and of a head that is turned over.
    const Pose over = make_pose(rotation_exp({0, 0, kPi}), {0, 0, 0});
    const auto turned = merge_heads(fine, {over}, coarse, {over});
    ASSERT_TRUE(turned && turned->status == DoubleHeadStatus::ok);
    EXPECT_EQ(empty_lines(*turned), (std::pair<std::ptrdiff_t, std::ptrdiff_t>(1, 41)));
    const auto unknown = merge_heads(level(5, 400, false), {}, level(5, 200, false), {});
    ASSERT_TRUE(unknown && unknown->status == DoubleHeadStatus::ok);
    EXPECT_EQ(empty_lines(*unknown), (std::pair<std::ptrdiff_t, std::ptrdiff_t>(0, 0)));
}

// The first head sees the upper sheet 0.6 mm farther than the second, which there sees the lower one already.
TEST(DoubleHead, AStepIsDividedWhereEachHeadSeesIt) {
    const auto lap = [](double step_at) {
        Profile p;
        for (double x = -20 + 0.05; x < 20; x += 0.1) {
            p.x_mm.push_back(x);
            p.z_mm.push_back(x < step_at ? 0 : -0.7);
            p.segment.push_back(0);
        }
        return p;
    };
    const Head head{Pose::Identity(), 0.02};
    for (const bool exchanged : {false, true}) {
        const Profile a = lap(exchanged ? -0.6 : 0), b = lap(exchanged ? 0 : -0.6);
        const auto m = merge_heads(a, head, b, head);
        ASSERT_TRUE(m);
        ASSERT_EQ(m->status, DoubleHeadStatus::ok) << m->message.english();
        EXPECT_LT(m->disagreement_mm, 1e-9) << "different surfaces are not compared";
        double last_upper = -99, first_lower = 99;
        for (std::size_t i = 0; i < m->profile.size(); ++i) {
            const double x = m->profile.x_mm[i], z = m->profile.z_mm[i];
            if (!std::isfinite(z)) continue;
            EXPECT_TRUE(std::abs(z) < 1e-9 || std::abs(z + 0.7) < 1e-9) << "a mean of both at " << x;
            EXPECT_EQ(m->profile.segment[i], z > -0.35 ? 0 : 1) << x;
            if (z > -0.35)
                last_upper = std::max(last_upper, x);
            else
                first_lower = std::min(first_lower, x);
        }
        EXPECT_NEAR(last_upper, -0.05, 0.051);
        EXPECT_NEAR(first_lower, -0.55, 0.051);
    }
}

TEST(DoubleHead, RefusesHeadsThatShareTooLittle) {
    View a = left_view(), b = right_view();
    a.panel_to = 3;
    b.body_to = 3;
    const DoubleHeadProfile m = merged(a, b, 0, nullptr);
    EXPECT_EQ(m.status, DoubleHeadStatus::no_overlap);
    EXPECT_TRUE(m.profile.x_mm.empty());
    const auto nothing = merge_heads({}, {}, seen(b, 0, nullptr), {});
    ASSERT_TRUE(nothing);
    EXPECT_EQ(nothing->status, DoubleHeadStatus::no_points);
    EXPECT_THAT(nothing->message, testing::HasSubstr("first"));
}

TEST(DoubleHead, RefusesHostileInput) {
    const Profile good = seen(left_view(), 0, nullptr);
    Profile unfiltered = good, ragged = good, holes = good;
    unfiltered.segment.clear();
    ragged.z_mm.pop_back();
    EXPECT_FALSE(merge_heads(unfiltered, {}, good, {}));
    EXPECT_FALSE(merge_heads(good, {}, ragged, {}));
    Head bad;
    bad.sigma_mm = 0;
    EXPECT_FALSE(merge_heads(good, bad, good, {}));
    bad.sigma_mm = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(merge_heads(good, bad, good, {}));
    bad = {};
    bad.sensor_from_head.linear() *= 2;
    EXPECT_FALSE(merge_heads(good, {}, good, bad));
    DoubleHeadOptions options;
    options.disagreement_limit_mm = 5;
    EXPECT_FALSE(merge_heads(good, {}, good, {}, options));
    options = {};
    options.minimum_overlap_mm = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(merge_heads(good, {}, good, {}, options));
    // Missing returns and outliers are no error and no points.
    for (std::size_t i = 0; i < holes.size(); i += 3)
        holes.z_mm[i] = std::numeric_limits<double>::quiet_NaN();
    holes.segment[1] = kOutlier;
    const auto merged = merge_heads(holes, {}, good, {});
    ASSERT_TRUE(merged);
    EXPECT_EQ(merged->status, DoubleHeadStatus::ok);
    for (std::size_t i = 0; i < merged->profile.size(); ++i)
        EXPECT_EQ(std::isfinite(merged->profile.z_mm[i]), merged->profile.segment[i] != kOutlier);
}

}  // namespace
}  // namespace seamwright
