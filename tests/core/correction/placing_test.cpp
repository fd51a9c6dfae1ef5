#include "core/correction/placing/placing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "core/correction/predicted.h"
#include "core/correction/travel.h"

namespace seamwright {
namespace {

// Spots round a rectangle of 900 x 600 mm that bulges, sensors looking from Z, travel along the edge; noise from spot to
// spot, arrivals of the robot, one sensor with a hand-eye and a scale that are not sure.
PlacingTask rectangle(int candidates, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double a, double b) {
        return a + (b - a) * static_cast<double>(random() >> 11) * 0x1.0p-53;
    };
    PlacingTask task;
    for (int i = 0; i < candidates; ++i) {
        const double t = 2 * kPi * (i + 0.3) / candidates;
        const Eigen::Vector3d p(450 * std::cos(t), 300 * std::sin(t), 20 * std::sin(2 * t));
        const Eigen::Vector3d along =
            Eigen::Vector3d(-450 * std::sin(t), 300 * std::cos(t), 40 * std::cos(2 * t)).normalized();
        Eigen::Matrix3d axes;
        axes.col(1) = along;
        axes.col(2) =
            (Eigen::Vector3d(0.2 * uniform(-1, 1), 0.2 * uniform(-1, 1), 1) - along * (along.z() + 0.0))
                .normalized();
        axes.col(2) = (axes.col(2) - along * along.dot(axes.col(2))).normalized();
        axes.col(0) = axes.col(1).cross(axes.col(2));
        PlacingCandidate c;
        c.place = i;
        c.spot.id = "c" + std::to_string(i);
        c.spot.workobject_from_sensor = make_pose(axes, p);
        c.spot.sigma_mm = uniform(0.01, 0.05);
        c.spot.sensor = "A";
        Matrix6 arrival = Matrix6::Identity() * 1e-3;
        arrival.bottomRightCorner<3, 3>() *= 1e-6;
        c.spot.robot_covariance = arrival;
        c.travel_window_mm = 2;
        task.candidates.push_back(c);
        if (i % 2 == 0) task.bead.push_back({p, Eigen::Vector3d(axes.col(2)), Eigen::Vector3d(axes.col(0))});
    }
    SensorPrior prior;
    prior.id = "A";
    prior.hand_eye_covariance = Matrix6::Identity() * 1e-6;
    prior.hand_eye_covariance.topLeftCorner<3, 3>() *= 1e3;
    prior.scale_sigma = {5e-4, 5e-4};
    task.options.sensors = {prior};
    Displacement moved;
    moved.workobject_from_movedworkobject = make_pose(rotation_exp({0.005, -0.01, 0.015}), {8, -6, 5});
    task.displacements.push_back(moved);
    return task;
}

TEST(Placing, SaysWhatTheForecastOfTheSameSpotsSays) {
    PlacingTask task = rectangle(20, 3);
    task.one_may_be_lost = false;
    const auto placing = SpotPlacing::make(task);
    ASSERT_TRUE(placing) << placing.error().sentence();
    for (const FreeDof& free : {kAllFree, FreeDof{true, true, true, false, false, true}}) {
        task.options.free = free;
        const auto of_free = SpotPlacing::make(task);
        ASSERT_TRUE(of_free);
        const std::vector<std::size_t> chosen{0, 3, 9, 13, 17};
        double worst = 0;
        for (const Displacement& d : task.displacements) {
            std::vector<SpotObservation> spots;
            for (const std::size_t c : chosen) {
                SpotObservation o = task.candidates[c].spot;
                o.measured_mm = displaced_measure(o, d);
                add_travel(o, d, task.candidates[c].travel_window_mm);
                spots.push_back(o);
            }
            const auto predicted = predicted_covariance(spots, task.options, d);
            ASSERT_TRUE(predicted);
            for (const TaughtBeadPoint& b : task.bead)
                for (const Eigen::Vector3d& n : {b.normal, b.binormal}) {
                    Vector6 a;
                    a << n, (d.workobject_from_movedworkobject.linear() * b.point_mm).cross(n);
                    worst = std::max(worst, 3 * std::sqrt(a.dot(predicted->sum * a)));
                }
        }
        EXPECT_NEAR(of_free->judge(chosen).three_sigma_mm, worst, 1e-5 * worst);
        const std::vector<double> along = of_free->along_bead(chosen);
        EXPECT_NEAR(*std::max_element(along.begin(), along.end()), worst, 1e-5 * worst);
    }
}

TEST(Placing, ComesWithinFivePercentOfTheBestOfAllSetsAndTheBoundHolds) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        PlacingTask task = rectangle(13, seed);
        task.one_may_be_lost = false;
        const auto placing = SpotPlacing::make(task);
        ASSERT_TRUE(placing);
        for (const int k : {3, 4, 5}) {
            double best = 1e9;
            std::vector<bool> mask(13, false);
            std::fill(mask.begin(), mask.begin() + k, true);
            do {
                std::vector<std::size_t> set;
                for (std::size_t i = 0; i < mask.size(); ++i)
                    if (mask[i]) set.push_back(i);
                best = std::min(best, placing->judge(set).three_sigma_mm);
            } while (std::prev_permutation(mask.begin(), mask.end()));
            const double found = placing->best(k).three_sigma_mm, bound = placing->bound_mm(k);
            EXPECT_LE(found, 1.05 * best) << "seed " << seed << ", " << k << " spots";
            EXPECT_LE(bound, best * (1 + 1e-9)) << "seed " << seed << ", " << k << " spots";
            EXPECT_GT(bound, 0.5 * best)
                << "a bound that says something; seed " << seed << ", " << k << " spots";
            std::printf("seed %d, %d spots: best %.4f, found %.4f, bound %.4f mm\n", static_cast<int>(seed),
                        k, best, found, bound);
        }
    }
}

TEST(Placing, ProposesTheFewestAndAnyOneMayBeLost) {
    PlacingTask task = rectangle(40, 5);
    task.three_sigma_mm = 0.2;
    const auto placing = SpotPlacing::make(task);
    ASSERT_TRUE(placing);
    const PlacedSet set = placing->propose(3, 12);
    ASSERT_TRUE(set.enough) << set.three_sigma_mm << " " << set.lost_three_sigma_mm;
    EXPECT_LE(set.three_sigma_mm, 0.2);
    task.one_may_be_lost = false;
    const auto without = SpotPlacing::make(task);
    for (std::size_t i = 0; i < set.chosen.size(); ++i) {
        std::vector<std::size_t> left = set.chosen;
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_LE(without->judge(left).three_sigma_mm, 0.2);
    }
    const PlacedSet fewer = placing->best(static_cast<int>(set.chosen.size()) - 1);
    EXPECT_FALSE(fewer.enough);
    EXPECT_LE(set.way_mm, placing->best(static_cast<int>(set.chosen.size())).way_mm + 1e-9)
        << "the shortest way";
}

TEST(Placing, IsTheSameInAnotherFrame) {
    const PlacingTask task = rectangle(24, 6);
    PlacingTask turned = task;
    const Pose other = make_pose(rotation_exp({0.4, -1.1, 2.0}), {3000, -1500, 800});
    for (PlacingCandidate& c : turned.candidates) {
        c.spot.workobject_from_sensor = other * c.spot.workobject_from_sensor;
        Matrix6 turn = Matrix6::Zero();
        turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = other.linear();
        c.spot.robot_covariance = turn * *c.spot.robot_covariance * turn.transpose();
    }
    for (TaughtBeadPoint& b : turned.bead)
        b = {other * b.point_mm, other.linear() * b.normal, other.linear() * b.binormal};
    for (Displacement& d : turned.displacements)
        d.workobject_from_movedworkobject = other * d.workobject_from_movedworkobject * other.inverse();
    const auto a = SpotPlacing::make(task), b = SpotPlacing::make(turned);
    ASSERT_TRUE(a && b);
    const PlacedSet one = a->best(6), two = b->best(6);
    EXPECT_NEAR(one.three_sigma_mm, two.three_sigma_mm, 1e-4 * one.three_sigma_mm);
}

TEST(Placing, RefusesWhatIsNone) {
    const PlacingTask good = rectangle(8, 1);
    const auto refused = [&](auto change) {
        PlacingTask task = good;
        change(task);
        return !SpotPlacing::make(task).has_value();
    };
    EXPECT_TRUE(refused([](PlacingTask& t) { t.candidates.clear(); }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.bead.clear(); }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.displacements.clear(); }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.three_sigma_mm = std::nan(""); }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.candidates[2].spot.sigma_mm = std::nan(""); }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.candidates[2].spot.weights = {0.5, 0, 1}; }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.bead[0].normal *= 2; }));
    EXPECT_TRUE(refused([](PlacingTask& t) { t.candidates[1].spot.id = t.candidates[0].spot.id; }));
}

}  // namespace
}  // namespace seamwright
