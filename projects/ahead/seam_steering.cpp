#include "projects/ahead/seam_steering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace seamwright {
namespace {
constexpr double kReachMm = 30;        // of path length, from one cycle to the next
constexpr double kFarOffMm = 100;      // what lies farther off the guide is not on it
constexpr double kPosesApart_s = 0.1;  // more lost packets than that say nothing of between
}  // namespace

SeamSteering::SeamSteering(GuideCurve guide, const SteeringSetup& setup)
    : guide_(std::move(guide)),
      setup_(setup),
      moved_from_base_(setup.base_from_moved.inverse()),
      line_(setup.line) {
    figures_.least_ahead_mm = std::numeric_limits<double>::infinity();
}

void SeamSteering::see(const CyclicPacket& packet, PathPhase phase, std::int64_t heard_ns) {
    const auto& tcp = packet.actual ? packet.actual : packet.programmed;
    const std::lock_guard lock(mutex_);
    phase_ = phase;
    if (!tcp) return;
    base_from_flange_ = setup_.base_from_reference * *tcp * setup_.flange_from_tcp.inverse();
    history_.add(heard_ns, *base_from_flange_);
}

void SeamSteering::alarmed(const Text& reason) {
    const std::lock_guard lock(mutex_);
    phase_ = PathPhase::none;
    if (!figures_.alarm) figures_.alarm = reason;
}

PathPhase SeamSteering::phase() const {
    const std::lock_guard lock(mutex_);
    return phase_;
}

std::optional<Pose> SeamSteering::base_from_flange(std::int64_t time_ns) const {
    const std::lock_guard lock(mutex_);
    return history_.at(time_ns, kPosesApart_s);
}

bool SeamSteering::known_until(std::int64_t time_ns) const {
    const std::lock_guard lock(mutex_);
    return history_.covers(time_ns);
}

void SeamSteering::add(const Eigen::Vector3d& point_mm, const Eigen::Matrix3d& covariance_mm2) {
    const Eigen::Vector3d taught = moved_from_base_ * point_mm;
    const std::lock_guard lock(mutex_);
    const GuideCurve::Foot foot = guide_.foot(taught);
    if (foot.beyond || !(foot.off_mm.norm() < kFarOffMm)) {
        ++figures_.off_guide;
        return;
    }
    if (!(foot.off_mm.norm() <= setup_.limit_mm)) {
        ++figures_.beyond_limit;
        ++beyond_;
        beyond_mm_ = foot.off_mm.norm();
        last_failure_ = Text("the contour lies {:.2f} mm off the frame", beyond_mm_);
        return;
    }
    beyond_ = 0;
    const Eigen::Matrix<double, 3, 2> across = guide_.directions(foot.s_mm).rightCols<2>();
    const Eigen::Matrix3d r = moved_from_base_.linear();
    const Eigen::Matrix2d covariance = across.transpose() * r * covariance_mm2 * r.transpose() * across;
    if (line_.empty()) figures_.known_from_mm = foot.s_mm;
    if (line_.add({foot.s_mm, foot.off_mm, covariance})) {
        ++figures_.stored;
        return;
    }
    ++figures_.implausible;
    last_failure_ = Text("the feature jumped to {:.2f} mm off the frame", foot.off_mm.norm());
}

void SeamSteering::not_found(Text why) {
    const std::lock_guard lock(mutex_);
    ++figures_.not_found;
    last_failure_ = std::move(why);
}

void SeamSteering::lose(Text why) {
    const std::lock_guard lock(mutex_);
    if (!lost_) lost_ = std::move(why);
}

SteeringFigures SeamSteering::figures() const {
    const std::lock_guard lock(mutex_);
    SteeringFigures f = figures_;
    f.half_width_mm = line_.half_width_mm();
    if (!std::isfinite(f.least_ahead_mm)) f.least_ahead_mm = 0;
    return f;
}

SeamSteering::Wanted SeamSteering::refuse(Text why) const {
    Wanted w;
    w.alarm = std::move(why);
    return w;
}

// A stretch that the sensor has gone without a feature will be missing when the tool comes. Precondition: locked.
std::optional<Text> SeamSteering::lost_at_sensor() {
    if (lost_) return Text("online correction: {}", *lost_);
    if (beyond_ >= kBeyond)
        return Text(
            "online correction: the contour lies {:.2f} mm off the frame, beyond the limit of {:.2f} mm",
            beyond_mm_, setup_.limit_mm);
    if (!base_from_flange_) return std::nullopt;
    const Eigen::Vector3d looked_at =
        moved_from_base_ * (*base_from_flange_ * setup_.flange_from_looked_at_mm);
    const GuideCurve::Foot foot =
        sensor_mm_ ? guide_.foot(looked_at, *sensor_mm_, kReachMm) : guide_.foot(looked_at);
    sensor_mm_ = foot.s_mm;
    sensor_beyond_ = foot.beyond;
    if (!looking_since_mm_) looking_since_mm_ = foot.s_mm;
    const double newest =
        line_.empty() ? *looking_since_mm_ : std::max(line_.newest_mm(), *looking_since_mm_);
    const double without = foot.s_mm - newest;
    if (without <= setup_.line.most_gap_mm) return std::nullopt;
    return Text("online correction: the sensor has found no contour for {:.1f} mm of the path ({})", without,
                last_failure_ ? *last_failure_ : Text("no profile came"));
}

SeamSteering::Wanted SeamSteering::wanted(const CyclicPacket& packet, const Eigen::Vector3d& present_mm) {
    if (!packet.programmed) return {held_, Eigen::Vector3d::Zero(), {}};
    const std::lock_guard lock(mutex_);
    if (auto lost = lost_at_sensor()) return refuse(std::move(*lost));
    const Eigen::Vector3d p = setup_.base_from_reference * packet.programmed->translation();
    const GuideCurve::Foot foot = tool_mm_ ? guide_.foot(p, *tool_mm_, kReachMm) : guide_.foot(p);
    step_mm_ = tool_mm_ ? foot.s_mm - *tool_mm_ : 0;
    if (!tool_mm_) figures_.from_mm = foot.s_mm;
    tool_mm_ = figures_.to_mm = foot.s_mm;
    ++figures_.cycles;
    figures_.largest_mm = std::max(figures_.largest_mm, present_mm.norm());
    // Before the guide and behind it nothing is known: what is told stays.
    if (foot.beyond) return {held_, Eigen::Vector3d::Zero(), {}};
    return on_guide(p, foot, present_mm);
}

// Where the frame takes a tool that is as far off the guide at `s_mm` as it is at `foot`; base.
Eigen::Vector3d SeamSteering::moved_tool(const GuideCurve::Foot& foot, double s_mm) const {
    return setup_.base_from_moved *
           (guide_.at(s_mm) + guide_.directions(s_mm).rightCols<2>() * foot.off_mm).eval();
}

// The place that the tool is at, whose controller makes no shift along the travel (s' of above). Each step leaves the
// product of what is missing and the angle between moved and programmed travel. Precondition: locked.
double SeamSteering::place_across(const Eigen::Vector3d& p, const GuideCurve::Foot& foot) const {
    constexpr int kSteps = 4;
    const Eigen::Vector3d travel = guide_.directions(foot.s_mm).col(0);
    double s = foot.s_mm;
    for (int i = 0; i < kSteps; ++i) {
        const Eigen::Vector3d found = guide_.directions(s).rightCols<2>() * line_.at(s).off_mm;
        s -= travel.dot(moved_tool(foot, s) + setup_.base_from_moved.linear() * found - p);
    }
    return s;
}

// Precondition: locked.
SeamSteering::Wanted SeamSteering::on_guide(const Eigen::Vector3d& p, const GuideCurve::Foot& foot,
                                            const Eigen::Vector3d& present_mm) {
    const double s_mm = setup_.shifts_along ? foot.s_mm : place_across(p, foot);
    if (!(s_mm >= 0 && s_mm <= guide_.length_mm())) return {held_, Eigen::Vector3d::Zero(), {}};
    const AheadOffset known = line_.at(s_mm);
    // The sensor has come to the guide's end: there is nothing more to know.
    const bool at_end = known.state == AheadState::behind && sensor_beyond_;
    if (known.state == AheadState::nothing) return {held_, Eigen::Vector3d::Zero(), {}};
    if (known.state == AheadState::behind && !at_end)
        return refuse(Text(
            "online correction: the tool is {:.1f} mm behind the newest measure: the sensor does not run "
            "ahead, or its profiles come too late",
            s_mm - line_.newest_mm()));
    if (known.state == AheadState::lost)
        return refuse(
            Text("online correction: the tool came to a stretch of more than {:.1f} mm without a contour",
                 setup_.line.most_gap_mm));
    const double sigma = known.sigma_mm();
    if (!(sigma <= setup_.sigma_limit_mm))
        return refuse(Text("online correction: sigma of the offset is {:.4f} mm, over the limit of {:.4f} mm",
                           sigma, setup_.sigma_limit_mm));
    if (!(known.off_mm.norm() <= setup_.limit_mm))
        return refuse(
            Text("online correction: the contour lies {:.2f} mm off the frame, beyond the limit of {:.2f} mm",
                 known.off_mm.norm(), setup_.limit_mm));
    line_.forget_before(s_mm);
    figures_.largest_sigma_mm = std::max(figures_.largest_sigma_mm, sigma);
    if (!sensor_beyond_)
        figures_.least_ahead_mm = std::min(figures_.least_ahead_mm, line_.newest_mm() - s_mm);
    const Eigen::Matrix3d to_reference =
        setup_.base_from_reference.linear().transpose() * setup_.base_from_moved.linear();
    const Eigen::Matrix<double, 3, 2> across = to_reference * guide_.directions(s_mm).rightCols<2>();
    Wanted wanted;
    wanted.offset_mm = across * known.off_mm;
    if (!setup_.shifts_along) {
        const Eigen::Matrix3d reference_from_base = setup_.base_from_reference.linear().transpose();
        wanted.offset_mm += reference_from_base * (moved_tool(foot, s_mm) - setup_.base_from_moved * p);
        const Eigen::Vector3d travel = reference_from_base * guide_.directions(foot.s_mm).col(0);
        wanted.offset_mm -= travel.dot(wanted.offset_mm) * travel;
    }
    const Eigen::Vector3d of_frame = setup_.base_from_moved * p - p;
    const double total = (of_frame + setup_.base_from_reference.linear() * wanted.offset_mm).norm();
    if (!(total <= std::max(setup_.total_limit_mm, of_frame.norm())))
        return refuse(Text(
            "online correction: frame and offset together are {:.2f} mm at the tool, beyond the region's "
            "limit of {:.2f} mm",
            total, setup_.total_limit_mm));
    wanted.rate_mm_s = across * known.slope * (step_mm_ / setup_.cycle_s);
    held_ = wanted.offset_mm;
    const double behind = (wanted.offset_mm - present_mm).norm();
    if (known.state == AheadState::known) {
        ++figures_.cycles_known;
        figures_.largest_behind_mm = std::max(figures_.largest_behind_mm, behind);
    }
    behind_for_s_ = behind > setup_.behind_mm ? behind_for_s_ + setup_.cycle_s : 0;
    if (behind_for_s_ > setup_.behind_s)
        return refuse(
            Text("online correction: the robot is {:.2f} mm behind what the sensor found, for {:.1f} s: the "
                 "contour changes faster than the limits of the correction",
                 behind, behind_for_s_));
    return wanted;
}

}  // namespace seamwright
