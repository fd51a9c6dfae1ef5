#include "core/calibration/pose/hand_eye/hand_eye_judge.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace hand_eye {
namespace {

constexpr double kGoodHand_mm = 1.0, kGoodHand_deg = 0.3, kUsableHand_mm = 3.0, kUsableHand_deg = 1.0;
constexpr int kFewToCheck = 6;                          // stands: fewer are little to check with
constexpr int kFewestToTellNoise = 4;                   // stands: fewer do not tell what they err by
constexpr double kBumpTold = 1e-3, kBumpLikely = 5e-3;  // chance of a break in the order of the poses
constexpr double kSizeSigmas = 4, kLeastSize = 2e-4;
constexpr double kHarmlessSize_mm =
    0.15;  // at the target: less moves the camera by less than robots and pitches err

}  // namespace

bool size_is_off(double size, double sigma) {
    return std::abs(size - 1) > std::max(kLeastSize, kSizeSigmas * sigma);
}

Judgement judge_hand_eye(const HandEyeEvidence& evidence, HandEyeResult& result) {
    const HoldOut& out = result.report.hold_out;
    const double check_mm = out.folds > 0 ? out.rms_mm : result.rms_mm;
    const double check_deg = out.folds > 0 ? out.rms_deg : result.rms_deg;
    const double sigma_mm = std::sqrt(result.covariance_x.topLeftCorner<3, 3>().diagonal().maxCoeff());
    const Text fit =
        out.folds > 0 ? Text("poses not used fit to {:.2f} mm and {:.3f} degrees rms", check_mm, check_deg)
                      : Text("the poses fit to {:.2f} mm and {:.3f} degrees rms, none was kept to check with",
                             check_mm, check_deg);
    result.fits = check_mm <= kUsableHand_mm && check_deg <= kUsableHand_deg;
    if (wrong_target_size(result.target_size, result.target_size_sigma, evidence.reach_mm))
        return wrong_size_judgement(result.target_size);
    if (evidence.bump && evidence.mistake.empty() && evidence.bump->mm > kHarmlessSize_mm) {
        const double deg = deg_from_rad(evidence.bump->rad);
        if (evidence.bump->chance < kBumpTold)
            return {
                Verdict::poor,
                Text("from '{}' on the camera sees the target {:.2f} mm and {:.3f} degrees elsewhere: it or "
                     "the target moved while the poses were taken",
                     evidence.bumped_at, evidence.bump->mm, deg),
                "fasten both and take the poses again"};
        if (evidence.bump->chance < kBumpLikely)
            result.notices.push_back(Text(
                "the poses from '{}' on fit better with the target {:.2f} mm and {:.3f} degrees elsewhere: "
                "check that neither it nor the camera has moved",
                evidence.bumped_at, evidence.bump->mm, deg));
    }
    if (result.fits && evidence.stands < kFewestToTellNoise && !evidence.robot_stated)
        return {
            Verdict::poor,
            Text("{} different robot poses are too few to tell what they err by; {}", evidence.stands, fit),
            "take more poses, better eight or more, or state the robot's repeatability"};
    if (!result.fits || 3 * sigma_mm > 2 * kUsableHand_mm)
        return {Verdict::poor, fit,
                evidence.mistake.empty()
                    ? Text("check robot poses, the target's size and the camera's intrinsics")
                    : evidence.mistake};
    if (check_mm > kGoodHand_mm || check_deg > kGoodHand_deg || 3 * sigma_mm > kGoodHand_mm ||
        evidence.stands < kFewToCheck)
        return {Verdict::usable,
                evidence.stands < kFewToCheck ? Text("only {:.0f} poses, little to check with; {}",
                                                     static_cast<double>(evidence.stands), fit)
                                              : fit,
                "take more poses with larger rotations, still and well lit"};
    return {Verdict::good, fit, ""};
}

}  // namespace hand_eye

bool wrong_target_size(double size, double sigma, double reach_mm) {
    return hand_eye::size_is_off(size, sigma) && std::abs(size - 1) * reach_mm > hand_eye::kHarmlessSize_mm;
}

Judgement wrong_size_judgement(double size) {
    const double off = 100 * (size - 1);
    return {Verdict::poor,
            off > 0 ? Text("by the robot's motion the target is {:.2f} % larger than stated", off)
                    : Text("by the robot's motion the target is {:.2f} % smaller than stated", -off),
            "check the target's pitch, or the focal length of the camera's calibration"};
}

}  // namespace seamwright
