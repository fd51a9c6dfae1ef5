#include "projects/gate/safety_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/correction/sigma.h"
#include "devices/capture/capture.h"

namespace seamwright {

// The only maker of passes.
struct GateKeeper {
    static GatePass pass(const GateRequest& request) {
        GatePass pass;
        pass.region_id_ = request.region.id;
        pass.frame_name_ = request.region.frame_name;
        pass.base_from_frame_ = corrected_frame(request.base_from_workobject, request.correction.displacement,
                                                request.region.base_from_frame);
        pass.base_from_frame_now_ = request.base_from_frame_now;
        return pass;
    }
};

namespace {

class Reasons {
  public:
    explicit Reasons(std::vector<Text>& list) : list_(list) {}
    void refuse_unless(bool ok, const char* text) {
        if (!ok) list_.emplace_back(text);
    }
    template <class... Args>
    requires(sizeof...(Args) > 0) void refuse_unless(bool ok, fmt::format_string<Args...> text,
                                                     Args&&... args) {
        if (!ok) list_.push_back(Text(text, std::forward<Args>(args)...));
    }

  private:
    std::vector<Text>& list_;
};

bool rigid(const Pose& pose) {
    // A frame that is 100 m away is as wrong as one that is sheared; both end here.
    return pose_from_matrix(pose.matrix(), "", 1e-6).has_value();
}

std::string name_of(const SensorIdentity& id) {
    return fmt::format("{} {} {} {}", id.driver, id.vendor, id.model, id.serial);
}
std::string name_of(const RobotIdentity& id) {
    return fmt::format("{} {} {} {}", id.driver, id.brand, id.model, id.serial);
}

// The displacement that leads from the taught frame to this one, in the work object: corrected_frame() turned
// round.
Pose displacement_to(const GateRequest& request, const Region& region, const Pose& base_from_frame) {
    return request.base_from_workobject.inverse() * base_from_frame * region.base_from_frame.inverse() *
           request.base_from_workobject;
}

// How far the spots move by a displacement, and how far the limits let them: as a shift and a turn about some point of the part.
// The work object's origin may lie metres away, where a turn that throws the part aside shifts nothing. Of the measured spots: where
// another one lies may not be known.
double spots_move_mm(const GateRequest& request, const Pose& d) {
    double most = 0;
    for (const GateSpot& spot : request.spots)
        if (spot.measured)
            most = std::max(most, (d * spot.point_workobject_mm - spot.point_workobject_mm).norm());
    return most;
}
double spots_may_move_mm(const GateRequest& request, const Region& region) {
    double spread = 0;
    for (const GateSpot& a : request.spots)
        for (const GateSpot& b : request.spots)
            if (a.measured && b.measured)
                spread = std::max(spread, (a.point_workobject_mm - b.point_workobject_mm).norm());
    return region.limits.translation_mm + rad_from_deg(region.limits.rotation_deg) * spread;
}

void judge_age(const GateRequest& request, const GateSpot& spot, Reasons& reasons) {
    constexpr double kClocksDifferDays = 1.0 / 24;  // of two computers
    const auto made = utc_seconds(spot.calibrated_utc), now = utc_seconds(request.now_utc);
    if (!made || !now) {
        reasons.refuse_unless(now.has_value(), "what time it is now is not known");
        reasons.refuse_unless(made.has_value(), "calibration {} at spot {} has no date ({})",
                              spot.calibration_id, spot.id,
                              spot.calibrated_utc.empty() ? Text("none") : Text(spot.calibrated_utc));
        return;
    }
    const double age_days = static_cast<double>(*now - *made) / 86400;
    reasons.refuse_unless(age_days >= -kClocksDifferDays,
                          "calibration {} at spot {} carries a date in the future ({})", spot.calibration_id,
                          spot.id, spot.calibrated_utc);
    reasons.refuse_unless(age_days <= request.calibration_age_days,
                          "calibration {} at spot {} is {:.0f} days old, {:.0f} are allowed",
                          spot.calibration_id, spot.id, age_days, request.calibration_age_days);
}

// What was calibrated before a collision is not known to hold.
void judge_collision(const GateSpot& spot, Reasons& reasons) {
    if (spot.collided_utc.empty()) return;
    const auto made = utc_seconds(spot.calibrated_utc), collided = utc_seconds(spot.collided_utc);
    reasons.refuse_unless(made && collided && *made >= *collided,
                          "calibration {} at spot {} is older than the collision of {}", spot.calibration_id,
                          spot.id, spot.collided_utc);
}

void judge_spots(const GateRequest& request, Reasons& reasons) {
    for (const std::string& id : request.region.spot_ids) {
        const auto count = std::count_if(request.spots.begin(), request.spots.end(),
                                         [&](const GateSpot& spot) { return spot.id == id; });
        reasons.refuse_unless(count == 1, "spot {} of the region is {}", id,
                              count ? "given twice" : "not known");
    }
    std::string unconfirmed, of_other_type;
    for (const GateSpot& spot : request.spots) {
        if (spot.reference == ReferenceState::measured) continue;
        std::string& list = spot.reference == ReferenceState::from_type ? of_other_type : unconfirmed;
        list += (list.empty() ? "" : ", ") + spot.id;
    }
    reasons.refuse_unless(
        of_other_type.empty(),
        "the references of spots are another part type's: {}; teach them on a part of this type",
        of_other_type);
    reasons.refuse_unless(
        unconfirmed.empty(),
        "spots from the drawing are not confirmed: {}; confirm them on the part (`seamwright "
        "confirm FILE.seam`, Teach page)",
        unconfirmed);
    bool any = false;
    for (const GateSpot& spot : request.spots) {
        const auto& ids = request.region.spot_ids;
        reasons.refuse_unless(std::find(ids.begin(), ids.end(), spot.id) != ids.end(),
                              "spot {} is not of this region", spot.id);
        if (!spot.measured) {
            reasons.refuse_unless(!spot.required, "required spot {} was not measured", spot.id);
            continue;
        }
        any = true;
        reasons.refuse_unless(spot.part_id == request.part_id,
                              "spot {} was measured on part \"{}\", not on \"{}\"", spot.id, spot.part_id,
                              request.part_id);
        reasons.refuse_unless(spot.measured_at_ns >= request.part_since_ns,
                              "spot {} is stale: measured {:.1f} s before the part came", spot.id,
                              1e-9 * static_cast<double>(request.part_since_ns - spot.measured_at_ns));
        reasons.refuse_unless(spot.measured_at_ns <= request.now_ns, "spot {} carries a time in the future",
                              spot.id);
        if (spot.calibration_id.empty()) {
            reasons.refuse_unless(false, "the sensor of spot {} is not calibrated", spot.id);
            continue;
        }
        reasons.refuse_unless(serves(spot.calibration_verdict),
                              "calibration {} at spot {} is {}, not good or usable", spot.calibration_id,
                              spot.id, name_of(spot.calibration_verdict));
        judge_age(request, spot, reasons);
        judge_collision(spot, reasons);
        reasons.refuse_unless(!spot.calibrated_sensor.driver.empty() && spot.sensor == spot.calibrated_sensor,
                              "the sensor at spot {} is [{}], calibrated was [{}]", spot.id,
                              name_of(spot.sensor), name_of(spot.calibrated_sensor));
        reasons.refuse_unless(!spot.calibrated_robot.driver.empty() && spot.robot == spot.calibrated_robot,
                              "the robot at spot {} is [{}], calibrated was [{}]", spot.id,
                              name_of(spot.robot), name_of(spot.calibrated_robot));
    }
    reasons.refuse_unless(any, "no spot of the region was measured");
    for (const GateSpot& spot : request.spots)
        reasons.refuse_unless(spot.robot == request.spots.front().robot,
                              "spots {} and {} belong to different robots, one frame cannot serve both",
                              request.spots.front().id, spot.id);
}

// Every number of the request; what enters no comparison of its own would still come from a computation that
// went wrong.
bool all_finite(const GateRequest& request) {
    const RegionCorrection& c = request.correction;
    bool finite = c.displacement.workobject_from_movedworkobject.matrix().allFinite() &&
                  c.covariance.allFinite() && c.covariance_random.allFinite() &&
                  c.covariance_systematic.allFinite() && c.sigma_random.xyz_mm.allFinite() &&
                  c.sigma_random.abc_deg.allFinite() && c.sigma_systematic.xyz_mm.allFinite() &&
                  c.sigma_systematic.abc_deg.allFinite() && c.sigma_xyz_mm.allFinite() &&
                  c.sigma_abc_deg.allFinite() && std::isfinite(c.sigma_at_spots_mm) &&
                  std::isfinite(c.rms_mm) && std::isfinite(c.variance_factor);
    for (const SpotResidual& spot : c.spots) finite = finite && spot.residual_mm.allFinite();
    for (const GateSpot& spot : request.spots) finite = finite && spot.point_workobject_mm.allFinite();
    return finite;
}

// Symmetric and without a negative variance in any direction, to rounding. Judged by correlations:
// millimetres and radians do not compare.
bool is_covariance(const Matrix6& c) {
    constexpr double kRounding = 1e-6;
    if (!c.allFinite() || c.diagonal().minCoeff() < 0) return false;
    Matrix6 correlation = Matrix6::Identity();
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k) {
            if (i == k) continue;
            const double scale = std::sqrt(c(i, i)) * std::sqrt(c(k, k));
            if (scale > 0)
                correlation(i, k) = c(i, k) / scale;
            else if (c(i, k) != 0)
                return false;
        }
    if (!((correlation - correlation.transpose()).cwiseAbs().maxCoeff() <= kRounding)) return false;
    const Eigen::SelfAdjointEigenSolver<Matrix6> solver(correlation, Eigen::EigenvaluesOnly);
    return solver.info() == Eigen::Success && solver.eigenvalues().minCoeff() >= -kRounding;
}

void judge_limits(const GateRequest& request, Reasons& reasons) {
    const Region& region = request.region;
    for (const Text& finding : limits_that_are_none(region)) reasons.refuse_unless(false, "{}", finding);
    reasons.refuse_unless(request.calibration_age_days > 0 && std::isfinite(request.calibration_age_days),
                          "the age that a calibration may have, {} days, is no limit",
                          request.calibration_age_days);
    for (const std::string& other : request.other_frames)
        reasons.refuse_unless(!same_frame(other, region.frame_name),
                              "frame {} is written by another region or panel job too", region.frame_name);
}

// Expects finite poses.
void judge_jump(const GateRequest& request, Reasons& reasons) {
    if (!request.frame_trouble.empty()) {
        reasons.refuse_unless(false, "the frame that the controller holds cannot be read: {}",
                              request.frame_trouble);
        return;
    }
    if (!request.base_from_frame_now) return;
    const Pose& now = *request.base_from_frame_now;
    if (!rigid(now)) {
        reasons.refuse_unless(false, "the frame that the controller holds is no rigid pose");
        return;
    }
    const Region& region = request.region;
    for (const Region& other : request.frame_of_other_types) {
        if (!limits_that_are_none(other).empty() || !rigid(other.base_from_frame)) continue;
        const Pose theirs = displacement_to(request, other, now);
        if (theirs.translation().norm() <= other.limits.translation_mm &&
            deg_from_rad(angle_rad(theirs, Pose::Identity())) <= other.limits.rotation_deg &&
            spots_move_mm(request, theirs) <= spots_may_move_mm(request, other))
            return;  // as their last part left it
    }
    const Pose d = displacement_to(request, region, now);
    const double length = d.translation().norm(), turn = deg_from_rad(angle_rad(d, Pose::Identity()));
    const Pose target = corrected_frame(request.base_from_workobject, request.correction.displacement,
                                        region.base_from_frame);
    double jump = distance_mm(target, now);
    for (const GateSpot& spot : request.spots) {
        const Eigen::Vector3d in_frame =
            region.base_from_frame.inverse() * (request.base_from_workobject * spot.point_workobject_mm);
        jump = std::max(jump, (target * in_frame - now * in_frame).norm());
    }
    reasons.refuse_unless(
        length <= region.limits.translation_mm && turn <= region.limits.rotation_deg && std::isfinite(jump),
        "frame {} on the controller is {:.3f} mm and {:.3f} degrees off the taught one, beyond the region's "
        "limits of {:.3f} mm and {:.3f} degrees: the path would jump by {:.1f} mm (compare units, robot and "
        "the taught frame)",
        region.frame_name, length, turn, region.limits.translation_mm, region.limits.rotation_deg, jump);
    const double moved = spots_move_mm(request, d), may = spots_may_move_mm(request, region);
    reasons.refuse_unless(
        length > region.limits.translation_mm || moved <= may,
        "frame {} on the controller holds the spots {:.1f} mm off the taught ones, the region's limits "
        "allow {:.1f} mm (compare units, robot and the taught frame)",
        region.frame_name, moved, may);
}

void judge_correction(const GateRequest& request, Reasons& reasons) {
    const RegionCorrection& correction = request.correction;
    const Region& region = request.region;
    reasons.refuse_unless(correction.status == CorrectionStatus::ok, "the correction is not ok ({})",
                          correction.message.empty() ? "no message" : correction.message);
    const Pose& d = correction.displacement.workobject_from_movedworkobject;
    const bool finite = all_finite(request);
    reasons.refuse_unless(finite, "the correction holds a value that is not a finite number");
    if (!finite) return;
    if (!rigid(d)) {
        reasons.refuse_unless(false, "the correction is no rigid displacement");
        return;
    }
    reasons.refuse_unless(is_covariance(correction.covariance),
                          "the correction's covariance is none (not symmetric, or a negative variance)");

    // Every comparison is written so that NaN refuses.
    const double length = d.translation().norm();
    const double turn = deg_from_rad(angle_rad(d, Pose::Identity()));
    reasons.refuse_unless(length <= region.limits.translation_mm,
                          "the displacement of {:.3f} mm is beyond the limit of {:.3f} mm", length,
                          region.limits.translation_mm);
    reasons.refuse_unless(turn <= region.limits.rotation_deg,
                          "the rotation of {:.3f} degrees is beyond the limit of {:.3f} degrees", turn,
                          region.limits.rotation_deg);

    const double moved = spots_move_mm(request, d), may = spots_may_move_mm(request, region);
    reasons.refuse_unless(
        length > region.limits.translation_mm || moved <= may,
        "the spots move by {:.1f} mm, the region's limits allow {:.1f} mm there (the work object's "
        "origin lies far from the part: a turn about it moves the part)",
        moved, may);

    // Where the path runs, not at the work object's origin, which may lie metres away and says nothing about
    // the bead.
    double sigma_mm = request.spots.empty() ? worst_sigma(correction.covariance.topLeftCorner<3, 3>()) : 0.0;
    bool sigma_known = true;
    for (const GateSpot& spot : request.spots) {
        const double at_spot = sigma_at_mm(correction.covariance, d, spot.point_workobject_mm);
        sigma_known = sigma_known && std::isfinite(at_spot);
        sigma_mm = std::max(sigma_mm, at_spot);
    }
    reasons.refuse_unless(request.nozzle_sigma_mm >= 0 && std::isfinite(request.nozzle_sigma_mm),
                          "the sigma of the nozzle is not known");
    reasons.refuse_unless(request.drift_trouble.empty(), "{}", request.drift_trouble);
    reasons.refuse_unless(request.project_trouble.empty(), "{}", request.project_trouble);
    reasons.refuse_unless(request.nozzle_trouble.empty(), "{}", request.nozzle_trouble);
    if (request.nozzle_sigma_mm > 0) sigma_mm = std::hypot(sigma_mm, request.nozzle_sigma_mm);
    const double turn_sigma = deg_from_rad(worst_sigma(correction.covariance.bottomRightCorner<3, 3>()));
    const double sigma_deg = std::max(turn_sigma, correction.sigma_abc_deg.cwiseAbs().maxCoeff());
    reasons.refuse_unless(sigma_known && std::isfinite(sigma_mm) && std::isfinite(turn_sigma),
                          "sigma at the spots is not known");
    reasons.refuse_unless(sigma_mm <= region.sigma_limit_mm,
                          "sigma of {:.4f} mm is over the region's limit of {:.4f} mm", sigma_mm,
                          region.sigma_limit_mm);
    reasons.refuse_unless(sigma_deg <= region.sigma_limit_deg,
                          "sigma of {:.4f} degrees is over the region's limit of {:.4f} degrees", sigma_deg,
                          region.sigma_limit_deg);
    reasons.refuse_unless(
        correction.consistent,
        "the spots contradict each other beyond their stated sigma (variance factor {:.1f})",
        correction.variance_factor);
    // A free direction known without any error was never estimated.
    reasons.refuse_unless(sigma_mm > 0 || sigma_deg > 0, "the correction states no uncertainty");
    if (rigid(request.base_from_workobject) && rigid(region.base_from_frame)) judge_jump(request, reasons);
}

bool mode_allowed(const GateRequest& request) {
    if (request.mode == RobotMode::stopped || request.mode == RobotMode::fault) return false;
    if (request.required_mode != RobotMode::unknown) return request.mode == request.required_mode;
    return request.mode != RobotMode::unknown || !request.tells_mode;
}

}  // namespace

Pose corrected_frame(const Pose& base_from_workobject, const Displacement& displacement,
                     const Pose& base_from_frame) {
    const Pose workobject_from_frame = base_from_workobject.inverse() * base_from_frame;
    return base_from_workobject * displacement.corrected(Pose::Identity()) * workobject_from_frame;
}

bool same_frame(const std::string& a, const std::string& b) {
    return !a.empty() &&
           std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::vector<Text> limits_that_are_none(const Region& region) {
    std::vector<Text> findings;
    const auto judge = [&](double value, double most, const char* what, const char* unit) {
        if (!(value > 0 && value <= most))
            findings.push_back(
                Text("the limit of {}, {} {}, is none (above 0, up to {})", what, value, unit, most));
    };
    judge(region.limits.translation_mm, kMostTranslationMm, "translation", "mm");
    judge(region.limits.rotation_deg, kMostRotationDeg, "rotation", "degrees");
    judge(region.sigma_limit_mm, kMostSigmaMm, "sigma", "mm");
    judge(region.sigma_limit_deg, kMostSigmaDeg, "sigma", "degrees");
    return findings;
}

GatePass::GatePass(GatePass&& other) noexcept
    : region_id_(std::move(other.region_id_)),
      frame_name_(std::move(other.frame_name_)),
      base_from_frame_(other.base_from_frame_),
      base_from_frame_now_(other.base_from_frame_now_),
      spent_(std::exchange(other.spent_, true)) {}

GateVerdict pass_gate(const GateRequest& request) {
    GateVerdict verdict;
    Reasons reasons(verdict.reasons);
    reasons.refuse_unless(!request.region.id.empty(), "the region has no id");
    reasons.refuse_unless(!request.region.frame_name.empty(), "the region names no frame on the controller");
    reasons.refuse_unless(!request.region.spot_ids.empty(), "the region has no spots");
    reasons.refuse_unless(!request.part_id.empty(), "it is not known which part stands there");
    reasons.refuse_unless(rigid(request.base_from_workobject), "the work object's frame is no rigid pose");
    reasons.refuse_unless(rigid(request.region.base_from_frame),
                          "the taught frame of the region is no rigid pose");
    reasons.refuse_unless(mode_allowed(request), "the robot is in mode {}, required is {}",
                          to_string(request.mode),
                          request.required_mode != RobotMode::unknown ? to_string(request.required_mode)
                          : request.tells_mode                        ? "any but stopped, fault and unknown"
                                                                      : "any but stopped and fault");
    judge_limits(request, reasons);
    judge_spots(request, reasons);
    judge_correction(request, reasons);
    if (!verdict.reasons.empty()) return verdict;
    GatePass pass = GateKeeper::pass(request);
    reasons.refuse_unless(rigid(pass.base_from_frame()), "the corrected frame is no rigid pose");
    if (verdict.reasons.empty()) verdict.pass.emplace(std::move(pass));
    return verdict;
}

}  // namespace seamwright
