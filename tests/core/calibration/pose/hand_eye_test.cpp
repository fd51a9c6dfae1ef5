#include "core/calibration/pose/hand_eye.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "core/calibration/pose/hand_eye/hand_eye_start.h"
#include "tests/core/calibration/pose/hand_eye_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using ::testing::HasSubstr;
using ::testing::Not;

HandEyeResult solve(Mount mount, const std::vector<HandEyePair>& pairs,
                    const std::vector<std::string>& exclude = {}) {
    auto result = calibrate_hand_eye(mount, pairs, exclude);
    EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().sentence());
    return result ? *result : HandEyeResult{};
}

TEST(HandEye, EveryClosedFormGivesTheTruthOfExactData) {
    for (unsigned seed = 0; seed < 30; ++seed) {
        Random random(seed);
        HandEyeCell cell = any_hand_eye_cell(random);
        cell.sigma_mm = cell.sigma_rad = 0;
        const auto pairs = hand_eye_pairs(cell, 6, random);
        std::vector<Pose> a, c;
        for (const auto& pair : pairs) {
            a.push_back(cell.mount == Mount::eye_in_hand ? pair.base_from_flange
                                                         : pair.base_from_flange.inverse());
            c.push_back(pair.camera_from_target);
        }
        const auto forms = hand_eye::closed_forms(a, c);
        EXPECT_EQ(forms.size(), 5u);
        for (const auto& form : forms) {
            EXPECT_LT(distance_mm(form.x, cell.x), 1e-5) << form.name << " seed " << seed;
            EXPECT_LT(angle_rad(form.x, cell.x), 1e-7) << form.name << " seed " << seed;
        }
        const auto result = solve(cell.mount, pairs);
        EXPECT_LT(distance_mm(result.x, cell.x), 1e-6) << seed;
        EXPECT_LT(distance_mm(result.y, cell.y), 1e-6) << seed;
    }
}

TEST(HandEye, ErrorIsNotAboveOpenCvsBestMethod) {
    // Root mean square over trials of each method; ours must not lose to any of the five.
    const cv::HandEyeCalibrationMethod methods[] = {cv::CALIB_HAND_EYE_TSAI, cv::CALIB_HAND_EYE_PARK,
                                                    cv::CALIB_HAND_EYE_HORAUD, cv::CALIB_HAND_EYE_ANDREFF,
                                                    cv::CALIB_HAND_EYE_DANIILIDIS};
    std::array<double, 5> theirs_mm{}, theirs_rad{};
    double ours_mm = 0, ours_rad = 0;
    const int trials = 60;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(static_cast<unsigned>(500 + trial));
        HandEyeCell cell = any_hand_eye_cell(random);
        cell.mount = Mount::eye_in_hand;
        const auto pairs = hand_eye_pairs(cell, 12, random);
        const auto result = solve(cell.mount, pairs);
        ours_mm += std::pow(distance_mm(result.x, cell.x), 2);
        ours_rad += std::pow(angle_rad(result.x, cell.x), 2);
        for (size_t m = 0; m < 5; ++m) {
            const Pose x = opencv_hand_eye(pairs, methods[m]);
            theirs_mm[m] += std::pow(std::min(1e3, distance_mm(x, cell.x)), 2);
            theirs_rad[m] += std::pow(angle_rad(x, cell.x), 2);
        }
    }
    EXPECT_LE(ours_mm, *std::min_element(theirs_mm.begin(), theirs_mm.end()));
    EXPECT_LE(ours_rad, *std::min_element(theirs_rad.begin(), theirs_rad.end()));
}

TEST(HandEye, NamesAndLeavesOutWrongPairs) {
    for (unsigned seed = 40; seed < 60; ++seed) {
        Random random(seed);
        const HandEyeCell cell = any_hand_eye_cell(random);
        auto pairs = hand_eye_pairs(cell, 10, random);
        pairs[3].camera_from_target =
            pairs[3].camera_from_target * make_pose(rotation_exp({0, 0, kPi}), {0, 0, 0});
        pairs[7].base_from_flange.translation() += Eigen::Vector3d(12, -9, 15);
        const auto result = solve(cell.mount, pairs);
        EXPECT_FALSE(result.report.poses[3].used) << seed;
        EXPECT_FALSE(result.report.poses[7].used) << seed;
        EXPECT_EQ(std::count_if(result.report.poses.begin(), result.report.poses.end(),
                                [](const auto& p) { return p.used; }),
                  8)
            << seed;
        EXPECT_THAT(result.notices.front(), HasSubstr("P4, P8"));
        EXPECT_LT(distance_mm(result.x, cell.x), 2.0) << seed;
        // The same as when the user leaves them out.
        const auto without = solve(cell.mount, pairs, {"P4", "P8"});
        EXPECT_LT(distance_mm(result.x, without.x), 1e-3) << seed;
    }
}

TEST(HandEye, DegenerateMotionIsUndeterminedInWords) {
    Random random(7);
    HandEyeCell cell = any_hand_eye_cell(random);
    cell.mount = Mount::eye_in_hand;
    cell.tilt_deg = cell.turn_deg = 0;
    auto result = solve(cell.mount, hand_eye_pairs(cell, 8, random));
    EXPECT_EQ(result.status, HandEyeStatus::undetermined);
    EXPECT_EQ(result.report.judgement.verdict, Verdict::undetermined);
    EXPECT_THAT(result.report.judgement.reason, HasSubstr("one orientation"));
    cell.turn_deg = 60;
    result = solve(cell.mount, hand_eye_pairs(cell, 8, random));
    EXPECT_EQ(result.status, HandEyeStatus::undetermined);
    EXPECT_THAT(result.report.judgement.reason, HasSubstr("only"));
    EXPECT_TRUE(result.report.parameters.empty());
}

TEST(HandEye, RecognisesASwappedMountAndAnInvertedTarget) {
    Random random(9);
    HandEyeCell cell = any_hand_eye_cell(random);
    cell.mount = Mount::eye_in_hand;
    auto pairs = hand_eye_pairs(cell, 10, random);
    const auto swapped = solve(Mount::eye_to_hand, pairs);
    EXPECT_GE(swapped.report.judgement.verdict, Verdict::poor);
    EXPECT_THAT(swapped.report.judgement.cure, HasSubstr("eye_in_hand"));
    for (auto& pair : pairs) pair.camera_from_target = pair.camera_from_target.inverse();
    const auto inverted = solve(Mount::eye_in_hand, pairs);
    EXPECT_GE(inverted.report.judgement.verdict, Verdict::poor);
    EXPECT_THAT(inverted.report.judgement.cure, HasSubstr("inverted"));
}

// Nine equations of places would fit exactly with the turns left free: they do not tell what they err by.
TEST(HandEye, ThreePairsDoNotTellTheirOwnErrors) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        Random random(seed);
        HandEyeCell cell = any_hand_eye_cell(random);
        cell.sigma_mm = 0.03;
        cell.sigma_rad = 1.7e-4;
        const auto pairs = hand_eye_pairs(cell, 3, random);
        const auto r = solve(cell.mount, pairs);
        if (r.status != HandEyeStatus::ok) continue;
        EXPECT_EQ(r.report.judgement.verdict, Verdict::poor) << seed;
        EXPECT_THAT(r.report.judgement.cure, HasSubstr("repeatability")) << seed;
        EXPECT_THAT(r.report.judgement.reason, Not(HasSubstr("not used"))) << seed;
        EXPECT_EQ(r.report.hold_out.folds, 0);
        EXPECT_GE(r.sigma_mm, 0.02) << seed;
        for (int k = 0; k < 3; ++k) EXPECT_GT(std::sqrt(r.covariance_x(k, k)), 0.01) << seed;
        const Vector6 off = difference(cell.x, r.x);
        EXPECT_LT(off.dot(r.covariance_x.ldlt().solve(off)), 60) << seed;
        const auto stated = calibrate_hand_eye(cell.mount, pairs, {}, {0.03, 1e-4});
        ASSERT_TRUE(stated);
        if (3 * std::sqrt(stated->covariance_x.topLeftCorner<3, 3>().diagonal().maxCoeff()) < 6) {
            EXPECT_EQ(stated->report.judgement.verdict, Verdict::usable) << seed;
        }
    }
}

TEST(HandEye, AStandCountsOnceHoweverOftenItIsTaken) {
    Random random(21);
    HandEyeCell cell = any_hand_eye_cell(random);
    cell.mount = Mount::eye_in_hand;
    cell.sigma_mm = 0.05;
    cell.sigma_rad = 2e-4;
    const auto few = hand_eye_pairs(cell, 4, random);
    std::vector<HandEyePair> many;
    for (int again = 0; again < 4; ++again)
        for (HandEyePair pair : few) {
            pair.id += "_" + std::to_string(again);
            pair.camera_from_target.translation() +=
                Eigen::Vector3d(normal(random, 0.001), normal(random, 0.001), normal(random, 0.001));
            many.push_back(pair);
        }
    const auto once = solve(cell.mount, few), often = solve(cell.mount, many);
    EXPECT_EQ(often.report.judgement.verdict, once.report.judgement.verdict);
    EXPECT_EQ(often.report.hold_out.folds, 4);
    EXPECT_THAT(often.report.judgement.reason, HasSubstr("only 4 poses"));
    EXPECT_EQ(often.pairs_used, 16);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(often.covariance_x(k, k) / once.covariance_x(k, k), 1, 0.1) << k;
}

TEST(HandEye, AWrongPitchIsNamedWithWhatItIsOffBy) {
    for (unsigned seed = 70; seed < 80; ++seed) {
        Random random(seed);
        HandEyeCell cell = any_hand_eye_cell(random);
        cell.sigma_mm = 0.03;
        cell.sigma_rad = 2e-4;
        auto pairs = hand_eye_pairs(cell, 10, random);
        const auto honest = solve(cell.mount, pairs);
        EXPECT_EQ(honest.report.judgement.verdict, Verdict::good) << honest.report.judgement.reason;
        EXPECT_LT(std::abs(honest.target_size - 1), 4 * honest.target_size_sigma);
        for (auto& pair : pairs) pair.camera_from_target.translation() *= 1.01;
        const auto wrong = solve(cell.mount, pairs);
        EXPECT_EQ(wrong.report.judgement.verdict, Verdict::poor) << seed;
        EXPECT_THAT(wrong.report.judgement.reason, HasSubstr("smaller than stated")) << seed;
        EXPECT_THAT(wrong.report.judgement.cure, HasSubstr("pitch"));
        EXPECT_NEAR(wrong.target_size, 1 / 1.01, 0.002) << seed;
    }
}

TEST(HandEye, RefusesBadInput) {
    Random random(8);
    const HandEyeCell cell = any_hand_eye_cell(random);
    const auto good = hand_eye_pairs(cell, 6, random);
    const auto expect_error = [&](const std::vector<HandEyePair>& pairs, const char* word) {
        const auto result = calibrate_hand_eye(cell.mount, pairs);
        ASSERT_FALSE(result.has_value()) << word;
        EXPECT_EQ(result.error().kind, ErrorKind::input);
        EXPECT_THAT(result.error().sentence(), HasSubstr(word));
    };
    expect_error({}, "too few");
    expect_error({good.begin(), good.begin() + 2}, "too few");
    auto bad = good;
    for (auto& pair : bad) pair.base_from_flange = good[0].base_from_flange;
    expect_error(bad, "differ");
    bad = good;
    for (auto& pair : bad) pair.camera_from_target.translation() *= 1e-3;
    expect_error(bad, "metres");
    bad = good;
    for (auto& pair : bad) pair.base_from_flange.translation() *= 1e-3;
    expect_error(bad, "metres");
    bad = good;
    bad[2].camera_from_target.linear() *= 1.01;
    expect_error(bad, "P3");
    bad = good;
    bad[1].base_from_flange.matrix()(0, 0) = std::nan("");
    expect_error(bad, "P2");
    bad = good;
    bad.push_back(good[2]);
    bad.back().id = "copy";
    expect_error(bad, "'P3' and 'copy' are the same pair");
    EXPECT_TRUE(calibrate_hand_eye(cell.mount, bad, {"copy"}));
    bad = good;
    bad[1].id = "P1";
    expect_error(bad, "twice");
}

}  // namespace
}  // namespace seamwright
