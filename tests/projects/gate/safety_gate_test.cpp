#include "projects/gate/safety_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <type_traits>

#include "tests/projects/gate/gate_request.h"
#include "tests/projects/gate/numeric_members.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(CorrectedFrame, CarriesThePathWithThePart) {
    // A path point sits on the part; the part moves; the same path numbers in the corrected frame must meet
    // it again.
    const Pose base_from_workobject = some_pose(2), base_from_frame = some_pose(1);
    Displacement d;
    d.workobject_from_movedworkobject =
        make_pose(rotation_exp(Eigen::Vector3d(0.02, 0.03, -0.01)), {7, -8, 9});
    const Pose moved = corrected_frame(base_from_workobject, d, base_from_frame);
    std::mt19937 rng(1);
    std::normal_distribution<double> n(0, 300);
    for (int i = 0; i < 20; ++i) {
        const Eigen::Vector3d path_point(n(rng), n(rng), n(rng));
        const Eigen::Vector3d on_part = base_from_workobject.inverse() * (base_from_frame * path_point);
        const Eigen::Vector3d after = base_from_workobject * (d.workobject_from_movedworkobject * on_part);
        EXPECT_LT((moved * path_point - after).norm(), 1e-9);
        const Pose wrong_way = corrected_frame(
            base_from_workobject, Displacement{d.workobject_from_movedworkobject.inverse()}, base_from_frame);
        EXPECT_GT((wrong_way * path_point - after).norm(), 1);
    }
    EXPECT_LT(distance_mm(corrected_frame(base_from_workobject, {}, base_from_frame), base_from_frame), 1e-9);
    // A frame expressed in the work object itself obeys frame * D, the rule of correction.h.
    EXPECT_TRUE(corrected_frame(base_from_workobject, d, base_from_workobject)
                    .isApprox(d.corrected(base_from_workobject), 1e-12));
}

TEST(SafetyGate, PassHoldsTheCorrectedFrame) {
    const GateRequest request = good_request();
    const GateVerdict verdict = pass_gate(request);
    ASSERT_TRUE(verdict.pass);
    EXPECT_TRUE(verdict.reasons.empty());
    EXPECT_EQ(verdict.pass->frame_name(), "BASE[3]");
    EXPECT_TRUE(verdict.pass->base_from_frame().isApprox(corrected_frame(
        request.base_from_workobject, request.correction.displacement, request.region.base_from_frame)));
    EXPECT_FALSE(verdict.pass->spent());
}

// Nobody but the gate can make a pass, and a pass cannot be copied.
static_assert(!std::is_default_constructible_v<GatePass>);
static_assert(!std::is_copy_constructible_v<GatePass>);
static_assert(!std::is_copy_assignable_v<GatePass>);
static_assert(!std::is_aggregate_v<GatePass>);

struct Refusal {
    const char* name;
    std::function<void(GateRequest&)> spoil;
    const char* words;
    friend std::ostream& operator<<(std::ostream& out, const Refusal& r) { return out << r.name; }
};

const double kInf = std::numeric_limits<double>::infinity();

std::vector<Refusal> refusals() {
    using R = GateRequest&;
    return {
        {"UnderDetermined",
         [](R r) {
             r.correction.status = CorrectionStatus::under_determined;
             r.correction.message = "translation along X is not observed";
         },
         "translation along X"},
        {"OverLimitStatus", [](R r) { r.correction.status = CorrectionStatus::over_limit; }, "not ok"},
        {"NotConverged", [](R r) { r.correction.status = CorrectionStatus::not_converged; }, "not ok"},
        {"RequiredSpotMissing", [](R r) { r.spots[1].measured = false; },
         "required spot S2 was not measured"},
        {"SpotNotGiven", [](R r) { r.spots.pop_back(); }, "spot S3 of the region is not known"},
        {"SpotTwice", [](R r) { r.spots.push_back(r.spots[0]); }, "given twice"},
        {"ForeignSpot",
         [](R r) {
             r.spots.push_back(r.spots[0]);
             r.spots.back().id = "S9";
         },
         "S9 is not of this region"},
        {"NothingMeasured",
         [](R r) {
             for (auto& s : r.spots) {
                 s.measured = false;
                 s.required = false;
             }
         },
         "no spot of the region was measured"},
        {"OtherPart", [](R r) { r.spots[2].part_id = "car 0"; }, "measured on part \"car 0\""},
        {"NoPart",
         [](R r) {
             r.part_id.clear();
             for (auto& s : r.spots) s.part_id.clear();
         },
         "which part"},
        {"FromTheDrawing",
         [](R r) { r.spots[0].reference = r.spots[2].reference = ReferenceState::from_drawing; },
         "spots from the drawing are not confirmed: S1, S3"},
        {"FromTheDrawingAndNotEvenMeasured",
         [](R r) {
             r.spots[1].reference = ReferenceState::from_drawing;
             r.spots[1].measured = r.spots[1].required = false;
         },
         "not confirmed: S2; confirm them on the part (`seamwright confirm FILE.seam`, Teach page)"},
        {"Stale", [](R r) { r.spots[0].measured_at_ns = 99; }, "stale"},
        {"FromTheFuture", [](R r) { r.spots[0].measured_at_ns = 201; }, "future"},
        {"NanDisplacement",
         [](R r) { r.correction.displacement.workobject_from_movedworkobject(0, 3) = kNan; }, "finite"},
        {"InfDisplacement",
         [](R r) { r.correction.displacement.workobject_from_movedworkobject(2, 3) = kInf; }, "finite"},
        {"NanCovariance", [](R r) { r.correction.covariance(3, 3) = kNan; }, "finite"},
        {"NanSigma", [](R r) { r.correction.sigma_abc_deg(0) = kNan; }, "finite"},
        {"InfSigma", [](R r) { r.correction.sigma_xyz_mm(1) = kInf; }, "finite"},
        {"NotRigid", [](R r) { r.correction.displacement.workobject_from_movedworkobject.linear() *= 1.001; },
         "no rigid displacement"},
        {"Mirrored",
         [](R r) { r.correction.displacement.workobject_from_movedworkobject.linear().col(0) *= -1; },
         "no rigid displacement"},
        {"TooFar", [](R r) { r.region.limits.translation_mm = 7.0; }, "beyond the limit of 7.000 mm"},
        {"TurnedTooFar", [](R r) { r.region.limits.rotation_deg = 0.6; },
         "beyond the limit of 0.600 degrees"},
        {"NanLimit", [](R r) { r.region.limits.translation_mm = kNan; }, "beyond the limit"},
        {"NanTurnLimit", [](R r) { r.region.limits.rotation_deg = kNan; }, "beyond the limit"},
        {"NoLimit", [](R r) { r.region.limits.translation_mm = kInf; }, "is none"},
        {"NoTurnLimit", [](R r) { r.region.limits.rotation_deg = kInf; }, "is none"},
        {"AbsurdLimit", [](R r) { r.region.limits.translation_mm = 1001; }, "is none"},
        {"AbsurdTurnLimit", [](R r) { r.region.limits.rotation_deg = 46; }, "is none"},
        {"ZeroLimit",
         [](R r) {
             r.region.limits.translation_mm = 0;
             r.correction.displacement.workobject_from_movedworkobject = Pose::Identity();
         },
         "is none"},
        {"NegativeLimit", [](R r) { r.region.limits.rotation_deg = -3; }, "is none"},
        {"NoSigmaLimit", [](R r) { r.region.sigma_limit_mm = kInf; }, "is none"},
        {"AbsurdSigmaLimit", [](R r) { r.region.sigma_limit_mm = 11; }, "is none"},
        {"NoTurnSigmaLimit", [](R r) { r.region.sigma_limit_deg = kInf; }, "is none"},
        {"AbsurdTurnSigmaLimit", [](R r) { r.region.sigma_limit_deg = 11; }, "is none"},
        {"FrameOfTwoRegions",
         [](R r) {
             r.other_frames = {"BASE[2]", "Base[3]"};
         },
         "written by another region"},
        {"TaughtInMetres", [](R r) { r.region.base_from_frame.translation() *= 1e-3; }, "would jump"},
        {"AnotherFrameOnTheController", [](R r) { r.base_from_frame_now->translation().y() += 25.1; },
         "would jump"},
        {"AnotherTurnOnTheController",
         [](R r) {
             r.base_from_frame_now->linear() *= rotation_exp({0, 0, rad_from_deg(3.1)});
         },
         "would jump"},
        {"TurnAboutAFarOrigin",
         [](R r) {
             for (auto& spot : r.spots) spot.point_workobject_mm.x() += 6000;
             r.correction.displacement.workobject_from_movedworkobject =
                 make_pose(rotation_exp({0, 0, rad_from_deg(2)}), Eigen::Vector3d::Zero());
         },
         "the spots move by 2"},
        {"TurnAboutAFarOriginBesideASpotThatWasNeverTaught",
         [](R r) {
             for (auto& spot : r.spots) spot.point_workobject_mm.x() += 6000;
             r.spots[2].measured = r.spots[2].required = false;
             r.spots[2].point_workobject_mm.setZero();
             r.correction.displacement.workobject_from_movedworkobject =
                 make_pose(rotation_exp({0, 0, rad_from_deg(2)}), Eigen::Vector3d::Zero());
         },
         "the spots move by 2"},
        {"TurnAboutAFarOriginOnTheController",
         [](R r) {
             for (auto& spot : r.spots) spot.point_workobject_mm.x() += 6000;
             *r.base_from_frame_now =
                 r.base_from_workobject *
                 make_pose(rotation_exp({0, 0, rad_from_deg(2)}), Eigen::Vector3d::Zero()) *
                 r.base_from_workobject.inverse() * r.region.base_from_frame;
         },
         "on the controller holds the spots 2"},
        {"NoFrameOnTheController", [](R r) { (*r.base_from_frame_now)(0, 0) = kNan; }, "no rigid pose"},
        {"FrameNotRead",
         [](R r) {
             r.base_from_frame_now.reset();
             r.frame_trouble = "no answer in time";
         },
         "cannot be read: no answer in time"},
        {"OldCalibration", [](R r) { r.spots[1].calibrated_utc = "2025-11-21T12:00:00.000Z"; },
         "366 days old, 365 are allowed"},
        {"CalibrationOf1970", [](R r) { r.spots[1].calibrated_utc = "1970-01-01T00:00:00.000Z"; },
         "days old"},
        {"CalibrationOfTomorrow", [](R r) { r.spots[1].calibrated_utc = "2026-11-23T12:00:00.000Z"; },
         "in the future"},
        {"CalibrationBeforeTheCollision", [](R r) { r.spots[1].collided_utc = "2026-02-01T00:00:00.000Z"; },
         "C1 at spot S2 is older than the collision of 2026-02-01"},
        {"CollisionWithoutDate", [](R r) { r.spots[1].collided_utc = "soon"; }, "older than the collision"},
        {"NozzleTooUnsure", [](R r) { r.nozzle_sigma_mm = 0.2; }, "is over the region's limit"},
        {"NozzleNotKnown", [](R r) { r.nozzle_sigma_mm = -0.1; }, "sigma of the nozzle is not known"},
        {"KnockedReference", [](R r) { r.drift_trouble = "stopped by a step"; }, "stopped by a step"},
        {"ProjectChanged", [](R r) { r.project_trouble = "regions R1 was changed"; },
         "regions R1 was changed"},
        {"NozzleStale", [](R r) { r.nozzle_trouble = "nozzle is older"; }, "nozzle is older"},
        {"CalibrationWithoutDate", [](R r) { r.spots[1].calibrated_utc.clear(); }, "has no date"},
        {"CalibrationOfYesterday", [](R r) { r.spots[1].calibrated_utc = "yesterday"; }, "has no date"},
        {"CalibrationOfNoDay", [](R r) { r.spots[1].calibrated_utc = "2026-02-30T00:00:00Z"; },
         "has no date"},
        {"NoClock", [](R r) { r.now_utc.clear(); }, "what time it is"},
        {"AnyAge", [](R r) { r.calibration_age_days = kInf; }, "is no limit"},
        {"CovarianceNotSymmetric", [](R r) { r.correction.covariance(0, 1) = 5e-5; }, "covariance is none"},
        {"CovarianceIndefinite",
         [](R r) { r.correction.covariance(0, 1) = r.correction.covariance(1, 0) = 1.5e-4; },
         "covariance is none"},
        {"CovarianceOfAFixedAxis",
         [](R r) {
             r.correction.covariance(3, 3) = 0;
             r.correction.covariance(0, 3) = r.correction.covariance(3, 0) = 1e-9;
         },
         "covariance is none"},
        {"SigmaMm", [](R r) { r.region.sigma_limit_mm = 0.019; }, "over the region's limit of 0.0190 mm"},
        {"SigmaDeg", [](R r) { r.region.sigma_limit_deg = 0.0015; }, "degrees is over the region's limit"},
        {"SigmaHiddenInCovariance", [](R r) { r.correction.covariance(0, 0) = 100; },
         "over the region's limit"},
        {"CovarianceNotPositive", [](R r) { r.correction.covariance(0, 0) = -1; }, "covariance is none"},
        {"NanSigmaLimit", [](R r) { r.region.sigma_limit_mm = kNan; }, "over the region's limit"},
        {"NoUncertainty",
         [](R r) {
             r.correction.covariance.setZero();
             r.correction.sigma_xyz_mm.setZero();
             r.correction.sigma_abc_deg.setZero();
         },
         "states no uncertainty"},
        {"OtherSensor", [](R r) { r.spots[1].sensor.serial = "777"; }, "the sensor at spot S2"},
        {"OtherRobot", [](R r) { r.spots[1].robot.serial = "777"; }, "the robot at spot S2"},
        {"TwoRobots", [](R r) { r.spots[1].robot.serial = r.spots[1].calibrated_robot.serial = "777"; },
         "different robots"},
        {"CalibrationOfNobody", [](R r) { r.spots[1].sensor = r.spots[1].calibrated_sensor = {}; },
         "the sensor at spot S2"},
        {"Uncalibrated", [](R r) { r.spots[1].calibration_id.clear(); }, "not calibrated"},
        {"PoorCalibration", [](R r) { r.spots[1].calibration_verdict = Verdict::poor; },
         "poor, not good or usable"},
        {"UndeterminedCalibration", [](R r) { r.spots[1].calibration_verdict = Verdict::undetermined; },
         "undetermined"},
        {"WrongMode", [](R r) { r.mode = RobotMode::manual_reduced; }, "required is"},
        {"UnknownMode", [](R r) { r.mode = RobotMode::unknown; }, "required is"},
        {"UnknownModeWhereNoneIsRequired", [](R r) { r.mode = r.required_mode = RobotMode::unknown; },
         "any but stopped, fault and unknown"},
        {"Fault",
         [](R r) {
             r.mode = RobotMode::fault;
             r.required_mode = RobotMode::unknown;
         },
         "required is any but"},
        {"Stopped", [](R r) { r.mode = r.required_mode = RobotMode::stopped; }, "the robot is in mode"},
        {"NoFrameName", [](R r) { r.region.frame_name.clear(); }, "names no frame"},
        {"NoRegionId", [](R r) { r.region.id.clear(); }, "no id"},
        {"NoSpots",
         [](R r) {
             r.region.spot_ids.clear();
             r.spots.clear();
         },
         "has no spots"},
        {"WorkobjectNotRigid", [](R r) { r.base_from_workobject(1, 1) = kNan; }, "work object"},
        {"FrameNotRigid", [](R r) { r.region.base_from_frame(0, 3) = 1e9; }, "taught frame"},
    };
}

class EveryRefusal : public testing::TestWithParam<Refusal> {};

TEST_P(EveryRefusal, IsNamedAndMakesNoPass) {
    GateRequest request = good_request();
    GetParam().spoil(request);
    const GateVerdict verdict = pass_gate(request);
    EXPECT_FALSE(verdict.pass);
    EXPECT_THAT(verdict.reasons, testing::Contains(HasSubstr(GetParam().words)));
}

INSTANTIATE_TEST_SUITE_P(SafetyGate, EveryRefusal, testing::ValuesIn(refusals()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(SafetyGate, EveryNumberThatIsNotFiniteIsRefused) {
    GateRequest request = good_request();
    request.correction.spots = {{"S1", {0.01, 0, 0.02}, true}, {"S2", {0, 0, -0.01}, true}};
    request.spots[2].point_workobject_mm = {100, -50, 20};
    ASSERT_THAT(pass_gate(request).reasons, ElementsAre());
    int tried = 0;
    EXPECT_THAT(passes_with_one_not_finite(
                    request, [](const GateRequest& r) { return !pass_gate(r).pass.has_value(); }, tried),
                ElementsAre());
    EXPECT_EQ(tried, 3 * (2 + 2 + 12 + 12 + 3 * (36 + 6) + 3 + 2 * 3 + 3 * 3 + 12 + 1 + 1 + 12));
}

TEST(SafetyGate, NamesEveryReasonAtOnce) {
    GateRequest request = good_request();
    request.mode = RobotMode::fault;
    request.spots[0].measured = false;
    request.region.limits.translation_mm = 1;
    EXPECT_EQ(pass_gate(request).reasons.size(), 3u);
}

TEST(SafetyGate, WhatMayDifferPasses) {
    GateRequest request = good_request();
    request.spots[1].required = false;
    request.spots[1].measured = false;  // optional spot missing
    request.spots[0].calibration_verdict = Verdict::usable;
    request.required_mode = RobotMode::unknown;
    request.mode = RobotMode::unknown;
    request.tells_mode = false;  // a driver whose protocol has no word for it
    request.spots[2].measured_at_ns = 100;
    // A controller that still holds the frame of the last part, on the other side of the taught one; the age
    // that is allowed.
    Displacement last;
    last.workobject_from_movedworkobject = make_pose(rotation_exp({-0.02, 0.01, 0.03}), {-20, 10, -5});
    request.base_from_frame_now =
        corrected_frame(request.base_from_workobject, last, request.region.base_from_frame);
    request.spots[1].calibrated_utc = "2025-11-22T12:00:00.000Z";
    request.spots[0].calibrated_utc = "2026-11-22";  // a date alone
    request.other_frames = {"BASE[2]", ""};
    EXPECT_THAT(pass_gate(request).reasons, ElementsAre());
    // On the limit is not beyond it.
    request.base_from_frame_now = request.region.base_from_frame;
    request.region.limits.translation_mm =
        request.correction.displacement.workobject_from_movedworkobject.translation().norm();
    EXPECT_TRUE(pass_gate(request).pass);
    // Degrees of freedom that are not free have rows of zeros.
    request.correction.covariance.bottomRightCorner<3, 3>().setZero();
    request.correction.sigma_abc_deg.setZero();
    EXPECT_TRUE(pass_gate(request).pass);
}

}  // namespace
}  // namespace seamwright
