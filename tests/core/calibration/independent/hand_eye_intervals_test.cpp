// Hand-eye: what it states against the truth, and halves of one data set against each other. The target's poses come
// from noisy corners, so their errors are as unlike in their six directions, and as tied together, as a camera's are.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <random>

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

// No two cells share their draws: one unlucky set would speak for all of them.
unsigned seed_of(std::initializer_list<double> cell, int trial) {
    std::vector<std::int64_t> words{trial};
    for (const double v : cell) words.push_back(std::llround(1e6 * v));
    std::seed_seq mixed(words.begin(), words.end());
    std::array<unsigned, 1> seed{};
    mixed.generate(seed.begin(), seed.end());
    return seed[0];
}

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
        const bool fixed = c.mount == Mount::eye_to_hand;
        Dice dice(seed_of({fixed ? 1.0 : 0.0, double(c.pairs), c.robot_mm, c.robot_rad, c.corner_px}, trial));
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
            run(c, 100, with, halves, {c.robot_mm, c.robot_rad}, &sigma_with);
            run(c, 100, without, halves, {}, &sigma_without);
            with.print(std::string(name_of(mount)) + " " + std::to_string(pairs) + " pairs, stated, sigma " +
                       std::to_string(sigma_with) + " mm instead of " + std::to_string(sigma_without));
            EXPECT_GE(with.value(), 0.92) << pairs;
            EXPECT_LE(with.value(), 0.985) << pairs;
            if (pairs < 6) {
                EXPECT_LT(sigma_with, sigma_without) << pairs;
            }
        }
}

// A camera and a robot of equal errors in all directions, and the box that their poses come from.
struct PlainCell {
    int pairs;
    double mm, deg, tilt_deg, reach_mm;
};
struct PlainPairs {
    Motion camera;
    std::vector<HandEyePair> list;
};
PlainPairs plain_pairs(const PlainCell& c, Dice& dice, double robot_mm = 0, double robot_deg = 0) {
    PlainPairs made;
    made.camera = motion(dice.box(2, 2, 2), Vec3(60, -20, 150));
    const Motion target = motion(dice.box(0.5, 0.5, 0.5), Vec3(900, 150, 100));
    const double tilt = rad_from_deg(c.tilt_deg);
    for (int i = 0; i < c.pairs; ++i) {
        const Motion view = motion(Vec3::Zero(), Vec3(0, 0, c.reach_mm) + dice.box(50, 50, c.reach_mm / 6)) *
                            motion(dice.box(tilt, tilt, tilt), Vec3::Zero()) *
                            motion(Vec3(kPi, 0, 0), Vec3::Zero());
        const Motion robot = target * view.inverse() * made.camera.inverse() *
                             motion(dice.noise(rad_from_deg(robot_deg)), dice.noise(robot_mm));
        const Motion found = view * motion(dice.noise(rad_from_deg(c.deg)), dice.noise(c.mm));
        made.list.push_back({"p" + std::to_string(i), Pose(robot.matrix()), Pose(found.matrix())});
    }
    return made;
}

// Share of answers whose six numbers together lie in the ellipse of 95 % that they state.
double in_ellipse(const PlainCell& c, int trials) {
    int inside = 0, asked = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Dice dice(seed_of({double(c.pairs), c.mm, c.deg, c.tilt_deg, c.reach_mm}, trial));
        const PlainPairs made = plain_pairs(c, dice);
        const auto r = calibrate_hand_eye(Mount::eye_in_hand, made.list);
        if (!r || r->status != HandEyeStatus::ok) continue;
        const auto d = off(Motion(r->x.matrix()), made.camera);
        inside += d.dot(r->covariance_x.ldlt().solve(d)) < 12.592;
        ++asked;
    }
    EXPECT_GE(asked, trials * 9 / 10);
    return static_cast<double>(inside) / asked;
}

TEST(HandEyeIntervals, TheEllipseOfFewPairsHolds) {
    for (const int pairs : {3, 4, 6, 8})
        for (const auto& [mm, deg, tilt, reach] :
             {std::array{0.03, 0.01, 25.0, 300.0}, {0.03, 0.01, 40.0, 300.0}, {0.1, 0.02, 20.0, 600.0}}) {
            const double share = in_ellipse({pairs, mm, deg, tilt, reach}, 200);
            std::printf("%d pairs, %.2f mm, %.2f deg, %.0f deg tilt: %.3f\n", pairs, mm, deg, tilt, share);
            EXPECT_GE(share, 0.84) << pairs << " pairs, " << mm << " mm";
            EXPECT_LE(share, pairs < 5 ? 1.0 : 0.995) << pairs << " pairs, " << mm << " mm";
        }
}

// The corners of a board: distance and tilt far worse than the rest.
TEST(HandEyeIntervals, FewPairsOfABoardHold) {
    for (const Mount mount : {Mount::eye_to_hand, Mount::eye_in_hand})
        for (const int pairs : {3, 5, 7}) {
            Share all, halves;
            for (const double px : {0.05, 0.2})
                for (const auto& [mm, rad] : {std::pair{0.05, 1e-4}, {0.2, 4e-4}}) {
                    Share truth;
                    run({mount, pairs, mm, rad, px}, 40, truth, halves);
                    EXPECT_GE(truth.value(), 0.88) << pairs << " pairs, " << mm << " mm, " << px << " px";
                    all.add(truth);
                }
            all.print(std::string(name_of(mount)) + " " + std::to_string(pairs) + " pairs");
            EXPECT_GE(all.value(), 0.91) << pairs;
            EXPECT_LE(all.value(), 0.99) << pairs;
        }
}

// The robot's motion is the measure of the target's pitch; robots that err are no reason to doubt it.
TEST(HandEyeIntervals, AWrongPitchShowsAndAnHonestOneDoesNot) {
    int honest = 0, doubted = 0, wrong = 0, seen = 0;
    Share sizes;
    for (const double robot_mm : {0.0, 0.05, 0.1, 0.3})
        for (const int pairs : {5, 8, 12, 20})
            for (int trial = 0; trial < 30; ++trial) {
                Dice dice(seed_of({double(pairs), robot_mm}, trial));
                const RobotRepeatability stated =
                    trial % 2 ? RobotRepeatability{robot_mm, rad_from_deg(0.1 * robot_mm)}
                              : RobotRepeatability{};
                PlainPairs made = plain_pairs({pairs, 0.03, 0.01, 25, 300}, dice, robot_mm, 0.1 * robot_mm);
                const auto r = calibrate_hand_eye(Mount::eye_in_hand, made.list, {}, stated);
                ASSERT_TRUE(r);
                ++honest;
                doubted += r->report.judgement.reason.english().find("than stated") != std::string::npos;
                sizes.add(r->target_size - 1, r->target_size_sigma);
                if (pairs < 8 || robot_mm > 0.1) continue;
                const double share = trial % 3 == 0 ? 1.01 : trial % 3 == 1 ? 0.99 : 1.005;
                for (HandEyePair& p : made.list) p.camera_from_target.translation() *= share;
                const auto w = calibrate_hand_eye(Mount::eye_in_hand, made.list, {}, stated);
                ASSERT_TRUE(w);
                ++wrong;
                const bool named =
                    w->report.judgement.reason.english().find("than stated") != std::string::npos;
                seen += named && w->report.judgement.verdict == Verdict::poor &&
                        std::abs(w->target_size * share - 1) < 0.003;
            }
    sizes.print("size of the target");
    std::printf("honest doubted %d of %d, wrong seen %d of %d\n", doubted, honest, seen, wrong);
    EXPECT_LE(doubted, honest / 100);
    EXPECT_GE(seen, wrong * 95 / 100);
    EXPECT_GE(sizes.value(), 0.92);
    EXPECT_LE(sizes.value(), 0.985);
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
