// Hand-eye: what it states against the truth, and halves of one data set against each other. The target's poses come
// from noisy corners, so their errors are as unlike in their six directions, and as tied together, as a camera's are.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/calibration/pose/hand_eye.h"
#include "tests/core/calibration/independent/plain_world.h"

namespace seamwright {
namespace {

using namespace plain;

struct Case {
    Mount mount;
    int pairs;
    double robot_mm, robot_rad, corner_px;
};

std::vector<HandEyePair> seen(const Case& c, const Motion& camera, const Motion& target, int count,
                              Dice& dice) {
    const bool fixed = c.mount == Mount::eye_to_hand;
    Lens lens;
    const Board board;
    std::vector<HandEyePair> list;
    while (static_cast<int>(list.size()) < count) {
        Motion view = motion(dice.box(0.6, 0.6, 0.8), Vec3::Zero());
        view.translation() = Vec3(0, 0, fixed ? 1100 : 480) +
                             (fixed ? dice.box(200, 150, 150) : dice.box(50, 40, 60)) -
                             view.linear() * board.middle();
        std::vector<Vec2> pixel;
        bool inside = true;
        for (int i = 0; i < board.count(); ++i) {
            pixel.push_back(lens.see(view * board.at(i)) + c.corner_px * Vec2(dice.n(), dice.n()));
            inside &= lens.has(pixel.back(), 3);
        }
        if (!inside) continue;
        const Motion a = target * (camera * view).inverse();
        const Motion robot =
            (fixed ? a.inverse() : a) * motion(dice.noise(c.robot_rad), dice.noise(c.robot_mm));
        list.push_back({"p" + std::to_string(list.size()), Pose(robot.matrix()),
                        Pose(board_pose(lens, board, pixel, view).matrix())});
    }
    return list;
}

// `robot`: as the data state it.
void run(const Case& c, int trials, Share& truth, Share& halves, const RobotRepeatability& robot = {},
         double* mean_sigma_mm = nullptr) {
    double sigmas = 0;
    int solved = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Dice dice(static_cast<unsigned>(1000 * c.pairs + 7 * trial + 1));
        const bool fixed = c.mount == Mount::eye_to_hand;
        const Motion camera =
            motion(dice.box(0.8, 0.8, 0.8), fixed ? Vec3(1500, 200, 900) : Vec3(80, -30, 150));
        const Motion target =
            motion(dice.box(0.8, 0.8, 0.8), fixed ? Vec3(20, 40, 110) : Vec3(1200, 100, 300));
        std::optional<HandEyeResult> first;
        for (int half = 0; half < 2; ++half) {
            const auto r = calibrate_hand_eye(c.mount, seen(c, camera, target, c.pairs, dice), {}, robot);
            if (!r || r->status != HandEyeStatus::ok) continue;
            const auto d = off(Motion(r->x.matrix()), camera);
            sigmas += std::sqrt(r->covariance_x.topLeftCorner<3, 3>().trace() / 3);
            ++solved;
            for (int k = 0; k < 6; ++k) truth.add(d[k], std::sqrt(r->covariance_x(k, k)));
            if (first) {
                const auto e = off(Motion(r->x.matrix()), Motion(first->x.matrix()));
                for (int k = 0; k < 6; ++k)
                    halves.add(e[k], std::sqrt(r->covariance_x(k, k) + first->covariance_x(k, k)));
            } else {
                first = *r;
            }
        }
    }
    if (mean_sigma_mm) *mean_sigma_mm = sigmas / std::max(solved, 1);
}

TEST(HandEyeIntervals, HoldTheTruthAndTheOtherHalf) {
    constexpr int kTrials = 60;  // of twelve values together: a cell's share is known to some two hundredths
    for (const Mount mount : {Mount::eye_to_hand, Mount::eye_in_hand})
        for (const int pairs : {8, 15}) {
            Share all, all_halves;
            for (const double px : {0.05, 0.2})
                for (const auto& [mm, rad] : {std::pair{0.05, 1e-4}, {0.2, 4e-4}, {0.5, 1e-3}}) {
                    Share truth, halves;
                    run({mount, pairs, mm, rad, px}, kTrials, truth, halves);
                    truth.print(std::string(name_of(mount)) + " " + std::to_string(pairs) + " pairs, robot " +
                                std::to_string(mm).substr(0, 4) + " mm, " + std::to_string(px).substr(0, 4) +
                                " px");
                    EXPECT_GE(truth.value(), 0.91) << mm << " mm, " << px << " px";
                    EXPECT_LE(truth.value(), 0.985) << mm << " mm, " << px << " px";
                    all.add(truth);
                    all_halves.add(halves);
                }
            all.print("  all against the truth");
            all_halves.print("  halves");
            EXPECT_GE(all.value(), 0.93);
            EXPECT_LE(all.value(), 0.97);
            EXPECT_GE(all_halves.value(), 0.93);
            EXPECT_LE(all_halves.value(), 0.97);
        }
}

// What the robot repeats is known from its own study: from few pairs it says more than their scatter does.
TEST(HandEyeIntervals, AStatedRepeatabilityHoldsAndIsWorthPairs) {
    for (const Mount mount : {Mount::eye_to_hand, Mount::eye_in_hand})
        for (const int pairs : {4, 5, 8}) {
            const Case c{mount, pairs, 0.2, 4e-4, 0.05};
            Share with, without, halves;
            double sigma_with = 0, sigma_without = 0;
            run(c, 200, with, halves, {c.robot_mm, c.robot_rad}, &sigma_with);
            run(c, 200, without, halves, {}, &sigma_without);
            with.print(std::string(name_of(mount)) + " " + std::to_string(pairs) + " pairs, stated, sigma " +
                       std::to_string(sigma_with) + " mm instead of " + std::to_string(sigma_without));
            EXPECT_GE(with.value(), 0.93) << pairs;
            EXPECT_LE(with.value(), 0.985) << pairs;
            if (pairs < 6) {
                EXPECT_LT(sigma_with, sigma_without) << pairs;
            }
        }
}

// Pairs without a fault do not promise what the robot cannot do.
TEST(HandEyeIntervals, NeverSurerThanTheStatedRobot) {
    Dice dice(5);
    const Motion camera = motion(dice.box(0.8, 0.8, 0.8), Vec3(80, -30, 150));
    const Motion target = motion(dice.box(0.8, 0.8, 0.8), Vec3(1200, 100, 300));
    const Case exact{Mount::eye_in_hand, 10, 0, 0, 0};
    const auto pairs = seen(exact, camera, target, exact.pairs, dice);
    const auto bare = calibrate_hand_eye(exact.mount, pairs);
    const auto stated = calibrate_hand_eye(exact.mount, pairs, {}, {0.3, 1e-3});
    ASSERT_TRUE(bare && stated);
    const auto sigma = [](const HandEyeResult& r) {
        return std::sqrt(r.covariance_x.topLeftCorner<3, 3>().trace() / 3);
    };
    EXPECT_LT(sigma(*bare), 1e-3);
    EXPECT_GT(sigma(*stated), 0.3 / std::sqrt(10.0));
    for (const double bad : {-0.1, 11.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_FALSE(calibrate_hand_eye(exact.mount, pairs, {}, {bad, 0})) << bad;
        EXPECT_FALSE(calibrate_hand_eye(exact.mount, pairs, {}, {0.1, bad})) << bad;
    }
}

}  // namespace
}  // namespace seamwright
