#include <gtest/gtest.h>

#include <limits>

#include "tests/core/elastic/bent_doors.h"

namespace seamwright {
namespace {

using namespace bent_doors;

ElasticModes learnt(const Door& d, int parts, double bend, double twist, std::uint64_t seed) {
    Rng rng(seed);
    auto modes = learn_modes(slots(d), rows(d, parts, bend, twist, rng));
    EXPECT_TRUE(modes) << (modes ? "" : modes.error().sentence());
    return modes ? *modes : ElasticModes{};
}

TEST(ElasticModes, RigidPartsGiveNone) {
    const Door d = door(12);
    int none = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) none += learnt(d, 30, 0, 0, seed).modes.empty();
    EXPECT_GE(none, 11);
}

TEST(ElasticModes, BendAndTwistGiveTwo) {
    const Door d = door(12);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const ElasticModes modes = learnt(d, 40, 0.3, 0.2, seed);
        ASSERT_EQ(modes.modes.size(), 2u) << "seed " << seed;
        EXPECT_NEAR(modes.noise_factor, 1, 0.12);
        for (const ElasticMode& m : modes.modes) {
            EXPECT_LT(m.variance_low_mm2, m.variance_mm2);
            EXPECT_GT(m.variance_high_mm2, m.variance_mm2);
            EXPECT_LT(m.lowest_mm, 0);
            EXPECT_GT(m.highest_mm, 0);
        }
    }
}

TEST(ElasticModes, AMissingSpotIsNoShapeOfZero) {
    const Door d = door(12);
    Rng rng(3);
    std::vector<ElasticRow> all;
    std::normal_distribution<double> n;
    for (int p = 0; p < 40; ++p) {
        auto spots = measured(d, small_motion(rng, 1, 0.1), {0.3 * n(rng), 0, 0}, rng);
        spots.erase(spots.begin() + p % 12);
        CorrectionOptions options;
        options.reject_outliers = false;
        const auto solved = solve_region(spots, options);
        auto row = elastic_row(slots(d), spots, options, solved->displacement);
        ASSERT_TRUE(row);
        row->id = fmt::format("run {}", p);
        row->part_id = row->id;
        all.push_back(*row);
    }
    const auto modes = learn_modes(slots(d), all);
    ASSERT_TRUE(modes);
    ASSERT_EQ(modes->modes.size(), 1u);
    EXPECT_NEAR(modes->noise_factor, 1, 0.12);
}

TEST(ElasticModes, NoiseStatedTooSmallBecomesNoMode) {
    const Door d = door(12);
    Rng rng(8);
    const auto modes = learn_modes(slots(d), rows(d, 40, 0, 0, rng, 3));
    ASSERT_TRUE(modes);
    EXPECT_TRUE(modes->modes.empty());
    EXPECT_NEAR(modes->noise_factor, 3, 0.3);
    EXPECT_EQ(modes->message.english().find("rigid"), std::string::npos) << modes->message.english();
}

// A dull edge at one spot, a bright one at another: each scatters by itself, which no shape explains.
TEST(ElasticModes, SpotsOfUnequalNoiseAreNoModeAndHideNone) {
    const Door d = door(12);
    int none = 0, two = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Rng rng(seed);
        std::normal_distribution<double> normal;
        std::vector<double> of_spot;
        for (int n = 0; n < 12; ++n) of_spot.push_back(std::exp(0.7 * normal(rng)));
        const auto rigid = learn_modes(slots(d), rows(d, 30, 0, 0, rng, 1, of_spot));
        const auto bent = learn_modes(slots(d), rows(d, 30, 0.4, 0.3, rng, 1, of_spot));
        ASSERT_TRUE(rigid && bent);
        none += rigid->modes.empty();
        two += bent->modes.size() == 2;
        // Quiet spots are drawn to the others: said too loud rather than too quiet.
        for (std::size_t n = 0; n < 12; ++n)
            EXPECT_GT(bent->noise_factor * bent->spots[n].noise_factor, 0.7 * of_spot[n])
                << "seed " << seed << " spot " << n;
    }
    EXPECT_EQ(none, 6);
    EXPECT_EQ(two, 6);
}

// Two bends alike: the first mode alone gains next to nothing, the scatter holds the other one.
TEST(ElasticModes, OfTwoBendsAsStrongNeitherHidesTheOther) {
    const Door d = door(10);
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const ElasticModes modes = learnt(d, 25, 0.3, 0.3, seed);
        EXPECT_EQ(modes.modes.size(), 2u) << "seed " << seed;
        EXPECT_LT(modes.noise_factor, 1.3) << "seed " << seed;
    }
}

// 4 mm at one spot of one part are neither a mode nor noise that hides the others.
TEST(ElasticModes, AForeignBodyIsLeftOut) {
    const Door d = door(10);
    for (std::uint64_t seed = 1; seed <= 6; ++seed)
        for (const double bend : {0.0, 0.4}) {
            Rng rng(seed);
            std::normal_distribution<double> n;
            std::vector<ElasticRow> all;
            for (int p = 0; p < 25; ++p) {
                auto spots =
                    measured(d, small_motion(rng, 1, 0.1), {bend * n(rng), 0.6 * bend * n(rng), 0}, rng);
                if (p == 7) spots[3].measured_mm.z() += 4;
                CorrectionOptions options;
                options.reject_outliers = false;
                auto row = elastic_row(slots(d), spots, options, solve_region(spots, options)->displacement);
                row->id = row->part_id = fmt::format("{}", p);
                all.push_back(std::move(*row));
            }
            const auto modes = learn_modes(slots(d), all);
            ASSERT_TRUE(modes);
            EXPECT_EQ(modes->modes.size(), bend > 0 ? 2u : 0u) << "seed " << seed;
            EXPECT_NEAR(modes->noise_factor, 1, 0.25);
            EXPECT_NE(modes->message.english().find("1 measures that the other parts contradict"),
                      std::string::npos)
                << modes->message.english();
        }
}

TEST(ElasticModes, RefusesWhatIsNoLearningSet) {
    const Door d = door(12);
    Rng rng(5);
    std::vector<ElasticRow> r = rows(d, 20, 0.2, 0, rng);
    EXPECT_FALSE(learn_modes(slots(d), {}));
    auto twice = r;
    twice[3].id = twice[4].id;
    EXPECT_FALSE(learn_modes(slots(d), twice));
    auto nan = r;
    nan[0].residual_mm[2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(learn_modes(slots(d), nan));
    auto negative = r;
    for (Eigen::Matrix3d& l : negative[1].seen) l = -l;
    EXPECT_FALSE(learn_modes(slots(d), negative));
    auto other = slots(d);
    other.pop_back();
    EXPECT_FALSE(learn_modes(other, r));
    const auto one = learn_modes(slots(d), std::span(r).first(1));
    ASSERT_TRUE(one);
    EXPECT_TRUE(one->modes.empty());
    EXPECT_FALSE(one->message.empty());
    // Twenty runs of one part are one part.
    for (ElasticRow& row : r) row.part_id = "P1";
    const auto same = learn_modes(slots(d), r);
    ASSERT_TRUE(same);
    EXPECT_TRUE(same->modes.empty());
}

TEST(ElasticSolve, WithoutModesIsTheRigidAnswerBitForBit) {
    const Door d = door(12);
    Rng rng(11);
    const auto spots = measured(d, small_motion(rng, 2, 0.2), {0.3, 0.1, 0}, rng);
    const auto rigid = solve_region(spots, {});
    const auto elastic = solve_elastic(spots, {}, ElasticModes{});
    ASSERT_TRUE(rigid && elastic);
    EXPECT_FALSE(elastic->acted);
    EXPECT_EQ(rigid->displacement.workobject_from_movedworkobject.matrix(),
              elastic->correction.displacement.workobject_from_movedworkobject.matrix());
    EXPECT_EQ(rigid->covariance, elastic->correction.covariance);
    EXPECT_EQ(rigid->sigma_at_spots_mm, elastic->correction.sigma_at_spots_mm);
}

TEST(ElasticSolve, FindsWhatBendsAndWhere) {
    const Door d = door(12);
    const ElasticModes modes = learnt(d, 60, 0.3, 0.2, 2);
    Rng rng(12);
    const Pose truth = small_motion(rng, 2, 0.2);
    const auto spots = measured(d, truth, {0.4, -0.2, 0}, rng, 1e-6);
    const auto elastic = solve_elastic(spots, {}, modes);
    ASSERT_TRUE(elastic);
    ASSERT_TRUE(elastic->acted) << elastic->why.english();
    const auto shape = BeadShape::make(modes, spot_places(d), {true, arc_length(2 * kPi)});
    ASSERT_TRUE(shape) << shape.error().sentence();
    for (double t = 0.05; t < 6.28; t += 0.3) {
        const BeadPoint found = bead_point(*elastic, *shape, bead(d, t));
        const Eigen::Vector3d off = found.place_mm - truth * bent(t, {0.4, -0.2, 0});
        EXPECT_LT(std::abs(off.dot(across(d, t).first)), 0.06) << t;
        EXPECT_LT(std::abs(off.dot(across(d, t).second)), 0.06) << t;
    }
}

TEST(ElasticSolve, AModeTimesMinusOneIsTheSameAnswer) {
    const Door d = door(12);
    ElasticModes modes = learnt(d, 40, 0.3, 0.2, 2);
    Rng rng(13);
    const auto spots = measured(d, small_motion(rng, 2, 0.2), {0.3, 0.1, 0}, rng);
    const auto before = solve_elastic(spots, {}, modes);
    ElasticMode& m = modes.modes.front();
    for (auto& v : m.shape) v = -v;
    m.mean_mm = -m.mean_mm;
    std::swap(m.lowest_mm, m.highest_mm);
    m.lowest_mm = -m.lowest_mm;
    m.highest_mm = -m.highest_mm;
    const auto after = solve_elastic(spots, {}, modes);
    ASSERT_TRUE(before && after && before->acted && after->acted);
    EXPECT_NEAR(before->amplitudes[0].value_mm, -after->amplitudes[0].value_mm, 1e-9);
    EXPECT_TRUE(before->correction.displacement.workobject_from_movedworkobject.isApprox(
        after->correction.displacement.workobject_from_movedworkobject, 1e-9));
}

TEST(ElasticSolve, TurningTheWorkObjectLeavesTheBead) {
    const Pose placed = make_pose(rotation_exp(Eigen::Vector3d(0.4, -1.1, 0.7)), {800, -1500, 300});
    const Door here = door(12), there = door(12, placed);
    Rng a(21), b(21);
    std::vector<ElasticRow> rows_here, rows_there;
    std::normal_distribution<double> n;
    const auto part = [&](const Door& d, const Pose& truth, const Bend& bend, Rng& rng) {
        return measured(d, truth, bend, rng);
    };
    CorrectionOptions options;
    options.reject_outliers = false;
    for (int p = 0; p < 40; ++p) {
        Rng draw(static_cast<std::uint64_t>(p));
        const Pose motion = small_motion(draw, 1, 0.1);
        const Bend bend{0.3 * n(draw), 0.2 * n(draw), 0};
        const auto s = part(here, motion, bend, a);
        const auto t = part(there, placed * motion * placed.inverse(), bend, b);
        for (const auto& [d, spots, list] :
             {std::tuple(&here, &s, &rows_here), std::tuple(&there, &t, &rows_there)}) {
            auto row = elastic_row(slots(*d), *spots, options, solve_region(*spots, options)->displacement);
            row->id = row->part_id = fmt::format("{}", p);
            list->push_back(*row);
        }
    }
    const auto modes_here = learn_modes(slots(here), rows_here),
               modes_there = learn_modes(slots(there), rows_there);
    ASSERT_TRUE(modes_here && modes_there);
    ASSERT_EQ(modes_here->modes.size(), modes_there->modes.size());
    const Pose truth = small_motion(a, 1, 0.1);
    Rng c(5), e(5);
    const auto x = solve_elastic(part(here, truth, {0.3, 0.2, 0}, c), {}, *modes_here);
    const auto y =
        solve_elastic(part(there, placed * truth * placed.inverse(), {0.3, 0.2, 0}, e), {}, *modes_there);
    ASSERT_TRUE(x && y && x->acted && y->acted);
    const BeadArc arc{true, arc_length(2 * kPi)};
    const auto shape_x = BeadShape::make(*modes_here, spot_places(here), arc);
    const auto shape_y = BeadShape::make(*modes_there, spot_places(there), arc);
    ASSERT_TRUE(shape_x && shape_y);
    for (double t = 0; t < 6; t += 0.7) {
        const BeadPoint p = bead_point(*x, *shape_x, bead(here, t)),
                        q = bead_point(*y, *shape_y, bead(there, t));
        EXPECT_LT((placed * p.place_mm - q.place_mm).norm(), 1e-4) << t;
        EXPECT_NEAR(p.covariance_mm2.trace(), q.covariance_mm2.trace(),
                    1e-3 * p.covariance_mm2.trace() + 1e-7);
    }
}

TEST(ElasticSolve, AShapeThatWasNotLearntIsNoticedAndTheRigidAnswerStands) {
    const Door d = door(12);
    const ElasticModes modes = learnt(d, 40, 0.3, 0.2, 2);
    Rng rng(14);
    int noticed = 0;
    for (int i = 0; i < 50; ++i) {
        const auto spots = measured(d, small_motion(rng, 2, 0.2), {0.2, 0.1, 0.3}, rng);
        const auto elastic = solve_elastic(spots, {}, modes);
        const auto rigid = solve_region(spots, {});
        ASSERT_TRUE(elastic && rigid);
        if (elastic->acted) continue;
        ++noticed;
        EXPECT_FALSE(elastic->why.empty());
        EXPECT_EQ(rigid->displacement.workobject_from_movedworkobject.matrix(),
                  elastic->correction.displacement.workobject_from_movedworkobject.matrix());
    }
    EXPECT_EQ(noticed, 50);
}

TEST(ElasticSolve, AnAmplitudeBeyondWhatWasLearntOrTheLimitTurnsTheModesOff) {
    const Door d = door(12);
    const ElasticModes modes = learnt(d, 40, 0.2, 0.15, 2);
    Rng rng(15);
    const auto spots = measured(d, small_motion(rng, 2, 0.2), {1.5, 0, 0}, rng);
    const auto elastic = solve_elastic(spots, {}, modes, {1e-9, 10});
    ASSERT_TRUE(elastic);
    EXPECT_FALSE(elastic->acted);
    const auto within = measured(d, small_motion(rng, 2, 0.2), {0.3, 0, 0}, rng);
    ElasticOptions tight;
    tight.most_added_mm = 0.05;
    const auto limited = solve_elastic(within, {}, modes, tight);
    ASSERT_TRUE(limited);
    EXPECT_FALSE(limited->acted);
    EXPECT_FALSE(limited->why.empty());
    const auto free = solve_elastic(within, {}, modes);
    ASSERT_TRUE(free);
    EXPECT_TRUE(free->acted) << free->why.english();
}

TEST(ElasticSolve, AWrongSpotIsNamedAndOtherSpotsThanLearntTurnTheModesOff) {
    const Door d = door(12);
    const ElasticModes modes = learnt(d, 40, 0.3, 0.2, 2);
    Rng rng(16);
    auto spots = measured(d, small_motion(rng, 2, 0.2), {0.2, 0.1, 0}, rng);
    auto wrong = spots;
    wrong[4].measured_mm.z() += 2;
    const auto named = solve_elastic(wrong, {}, modes);
    ASSERT_TRUE(named);
    ASSERT_TRUE(named->acted) << named->why.english();
    ASSERT_EQ(named->correction.spots.size(), 12u);
    EXPECT_FALSE(named->correction.spots[4].used);

    auto anew = spots;
    anew[2].reference_mm.x() += 0.01;
    EXPECT_FALSE(solve_elastic(anew, {}, modes)->acted);
    auto added = spots;
    added[2].id = "new";
    EXPECT_FALSE(solve_elastic(added, {}, modes)->acted);
    auto removed = spots;
    removed.pop_back();
    EXPECT_TRUE(solve_elastic(removed, {}, modes)->acted);
    auto nan = spots;
    nan[1].measured_mm.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(solve_elastic(nan, {}, modes));
    ElasticModes broken = modes;
    broken.modes.front().shape.pop_back();
    EXPECT_FALSE(solve_elastic(spots, {}, broken));
}

TEST(BeadShape, SigmaGrowsBetweenTheSpots) {
    const Door d = door(12);
    const ElasticModes modes = learnt(d, 40, 0.3, 0.2, 2);
    const auto shape = BeadShape::make(modes, spot_places(d), {true, arc_length(2 * kPi)});
    ASSERT_TRUE(shape);
    double at = 0, between = 0;
    for (std::size_t n = 0; n + 1 < d.t.size(); ++n) {
        at += shape->at(bead(d, d.t[n]))[0].covariance(2, 2);
        between += shape->at(bead(d, 0.5 * (d.t[n] + d.t[n + 1])))[0].covariance(2, 2);
    }
    EXPECT_GT(between, at);
    std::vector<BeadPlace> few = spot_places(d);
    few.pop_back();
    EXPECT_FALSE(BeadShape::make(modes, few, {}));
}

}  // namespace
}  // namespace seamwright
