// Hand-eye: what it states against the truth, and halves of one data set against each other. The target's poses come
// from noisy corners, so their errors are as unlike in their six directions, and as tied together, as a camera's are.

#include <gtest/gtest.h>

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

void run(const Case& c, int trials, Share& truth, Share& halves) {
    for (int trial = 0; trial < trials; ++trial) {
        Dice dice(static_cast<unsigned>(1000 * c.pairs + 7 * trial + 1));
        const bool fixed = c.mount == Mount::eye_to_hand;
        const Motion camera =
            motion(dice.box(0.8, 0.8, 0.8), fixed ? Vec3(1500, 200, 900) : Vec3(80, -30, 150));
        const Motion target =
            motion(dice.box(0.8, 0.8, 0.8), fixed ? Vec3(20, 40, 110) : Vec3(1200, 100, 300));
        std::optional<HandEyeResult> first;
        for (int half = 0; half < 2; ++half) {
            const auto r = calibrate_hand_eye(c.mount, seen(c, camera, target, c.pairs, dice));
            if (!r || r->status != HandEyeStatus::ok) continue;
            const auto d = off(Motion(r->x.matrix()), camera);
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

}  // namespace
}  // namespace seamwright
