#include "core/calibration/sphere/tcp_sphere_judge.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/numbers.h"
#include "core/calibration/statistics.h"
#include "core/numbers.h"

namespace seamwright::tcp_sphere {
namespace {

constexpr double kPoorFit_mm = 0.5;
// A sigma that rests on fewer numbers is known worse than to a fifth: judged is then its upper end, of this probability.
// On fewer than kLeastFreedom it is not known at all.
constexpr double kSigmaKnown = 12, kSigmaAtMost = 0.95, kLeastFreedom = 5;

// What three sigma can be where few numbers tell them; `stated` ones are widened by Student's factor.
double at_most(double stated, double freedom) {
    if (freedom >= kSigmaKnown) return stated;
    const double low = chi_squared_quantile(1 - kSigmaAtMost, freedom) / freedom;
    return stated * std::max(1.0, kNormal95 / student_quantile(kUpper95, freedom) / std::sqrt(low));
}

}  // namespace

Judgement judge_sphere(const SphereFit& fit, TcpSphereResult& result) {
    const double three_sigma = 3 * result.working_sigma_mm,
                 three_at_most = at_most(three_sigma, result.sigma_freedom);
    const double hold_out = result.report.hold_out.rms_mm;
    // With less than six poses left a wrong one among them still fits; leaving it out shows it.
    constexpr double kFewPosesHoldOut_mm = 0.3;
    const double hold_out_limit = fit.used < kTcpSphereFewestPoses ? kFewPosesHoldOut_mm : 2 * kPoorFit_mm;
    const bool bad_fit = result.rms_mm > kPoorFit_mm || hold_out > hold_out_limit;
    result.fits = !std::isfinite(fit.better_radius) && !fit.few_agree && !bad_fit;
    if (std::isfinite(fit.better_radius))
        return {Verdict::poor,
                Text("the profiles fit a radius of {:.3f} mm much better than the given {:.3f} mm",
                     fit.better_radius, fit.radius),
                "check the radius (was the diameter given?)"};
    if (fit.few_agree)
        return {Verdict::poor, "most profiles contradict the solution found from the others",
                "check the robot poses and that the sphere did not move"};
    if (bad_fit)
        return {Verdict::poor,
                Text("the profiles do not fit one sphere: rms {:.2f} mm, {:.2f} mm on poses not used",
                     result.rms_mm, hold_out),
                "check radius, robot poses, tool frame of the robot and that the sphere did not move"};
    const Text more = result.proposals.empty()
                          ? Text("take more poses")
                          : Text("take more poses, first: {}", result.proposals.front().words);
    if (three_sigma > kUsableTcp_mm)
        return {Verdict::poor, Text("three sigma at the working distance are {:.2f} mm", three_sigma), more};
    const Text or_stated = fit.robot_stated ? more : Text("{}; or state the robot's repeatability", more);
    if (result.sigma_freedom < kLeastFreedom)
        return {
            Verdict::poor,
            Text("the {:.0f} poses disagree by more than the sensor's noise and are too few to tell by how "
                 "much",
                 fit.used),
            or_stated};
    if (three_at_most > kUsableTcp_mm)
        return {Verdict::poor,
                Text("three sigma at the working distance are {:.2f} mm, and with so few poses as much as "
                     "{:.2f} mm are not ruled out",
                     three_sigma, three_at_most),
                or_stated};
    if (three_at_most > kGoodTcp_mm)
        return {Verdict::usable,
                Text("three sigma at the working distance are {:.2f} mm, good is {:.1f}", three_sigma,
                     kGoodTcp_mm),
                more};
    if (fit.used < kTcpSphereFewestPoses)
        return {Verdict::usable, Text("only {:.0f} of the poses could be used", fit.used),
                "take more poses that show the sphere"};
    return {Verdict::good, Text("three sigma at the working distance are {:.3f} mm", three_sigma), ""};
}

Judgement undetermined_sphere(const TcpSphereResult& result, bool weak) {
    if (!weak)
        return {Verdict::undetermined,
                "two different sensor positions explain these profiles about equally well",
                "take more poses in other orientations and with the sphere elsewhere in the view"};
    Judgement judgement{Verdict::undetermined,
                        result.degenerate.empty()
                            ? Text("the poses leave a direction open to {:.3g} mm", result.weakest_sigma_mm)
                            : result.degenerate.front(),
                        {}};
    if (!result.proposals.empty())
        judgement.cure = Text("take more poses, first: {}", result.proposals.front().words);
    return judgement;
}

}  // namespace seamwright::tcp_sphere
