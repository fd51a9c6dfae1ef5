// Where the robot goes: points, circles, joint values and the frame they stand in.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

constexpr double kStraight_mm =
    1e-3;  // three points whose middle one lies nearer to the chord make no circle

}  // namespace

void Machine::put(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name) {
    const bool outside = now_file_ == 0 && ((options_.first_line > 0 && now_line_ < options_.first_line) ||
                                            (options_.last_line > 0 && now_line_ > options_.last_line));
    if (outside) return note(LineKind::left_out, "outside the lines that were asked for");
    if (path_.points.size() >= kPathPointLimit) {
        too_many_ = true;
        return;
    }
    if (tools_.empty() || tools_.back() != tool_) tools_.push_back(tool_);
    path_.points.push_back({now_line_, sources_[static_cast<std::size_t>(now_file_)].name, name, motion,
                            frame_.name, frame_.pose, frame_from_tool});
    note(LineKind::point);
    ++lines_[static_cast<std::size_t>(now_file_)][now_line_].points;
}

void Machine::move(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name) {
    if (doubt_ > 0) return gap(doubt_why_);
    if (fixed_tool_) return gap("the tool stands fixed in the room here and the robot moves the part");
    if (frame_.changed) return gap(Text("{} is changed here to what the program does not say", frame_.name));
    if (!frame_from_tool.matrix().allFinite() || frame_from_tool.translation().cwiseAbs().maxCoeff() > 1e5)
        return gap("the point lies beyond 100 m");
    put(frame_from_tool, motion, name);
    here_ = frame_from_tool;
}

void Machine::arc(const Pose& via, const Pose& end, const std::string& name, double angle_rad) {
    if (doubt_ > 0) return gap(doubt_why_);
    if (!here_) return gap("where this circle begins is not known");
    const Pose start = *here_;
    const Eigen::Vector3d a = start.translation(), b = via.translation() - a, c = end.translation() - a;
    const Eigen::Vector3d axis = b.cross(c);
    if (!axis.allFinite() || b.norm() < kStraight_mm || c.norm() < kStraight_mm ||
        axis.norm() < kStraight_mm * std::max(b.norm(), c.norm()))
        return gap("its three points lie on one line and make no circle");
    const Eigen::Vector3d n = axis.normalized();
    // Circumcentre of a triangle, seen from its first corner.
    const Eigen::Vector3d centre =
        (b.squaredNorm() * c.cross(axis) + c.squaredNorm() * axis.cross(b)) / (2 * axis.squaredNorm());
    const double radius = centre.norm();
    if (!(radius < 1e5)) return gap("the circle's radius is beyond 100 m");
    const Eigen::Vector3d x = -centre / radius, y = n.cross(x);
    // start -> via -> end runs in the positive sense about n, always.
    double angle = std::atan2((c - centre).dot(y), (c - centre).dot(x));
    if (angle <= 0) angle += 2 * kPi;
    const bool whole = angle_rad == 0;
    if (!whole) {
        if (!(std::abs(angle_rad) < 20 * kPi)) return gap("the circle's angle is beyond ten turns");
        angle = angle_rad;
    }
    const double chord = std::clamp(options_.chord_mm, 1e-4, radius);
    const double step = 2 * std::acos(std::max(0.0, 1 - chord / radius));
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / step - 1e-9)));
    const Eigen::Quaterniond from(start.linear()), to(end.linear());
    for (int i = 1; i <= pieces; ++i) {
        const double share = static_cast<double>(i) / pieces, t = angle * share;
        Pose p = end;
        if (i < pieces || !whole) {
            p.translation() = a + centre + radius * (std::cos(t) * x + std::sin(t) * y);
            p.linear() = i < pieces ? from.slerp(share, to).toRotationMatrix() : end.linear();
        }
        move(p, ProgramMotion::circular, i == pieces ? name : std::string());
    }
}

void Machine::joint_values() {
    if (doubt_ > 0) return gap(doubt_why_);
    note(LineKind::understood);
    joints_.push_back({now_file_, now_line_, path_.points.size()});
    here_.reset();
}

void Machine::settle_joint_values() {
    for (const JointMove& j : joints_) {
        now_file_ = j.file, now_line_ = j.line;
        if (j.before == 0 || j.before == path_.points.size())
            note(LineKind::left_out, "joint values: the way to the path or from it");
        else
            note(LineKind::not_understood,
                 "joint values on the way are no pose without the robot's kinematics");
    }
}

void Machine::set_tool(const std::string& name, const Value& value) {
    constexpr std::size_t kMost = 100;
    auto& all = tool_values_[name];
    const auto at = static_cast<std::size_t>(std::find(all.begin(), all.end(), value) - all.begin());
    if (at == all.size() && at < kMost) all.push_back(value);
    tool_ = at == 0 ? name : fmt::format("{} ({})", name, at + 1);
}

void Machine::set_frame(NamedPose frame) {
    if (doubt_ > 0) frame = {frame.name + "?", std::nullopt, frame_.name == frame.name + "?"};
    const bool same = frame.pose && frame_.pose ? frame.pose->isApprox(*frame_.pose, 1e-12)
                                                : frame.name == frame_.name && !frame.pose && !frame_.pose;
    if (here_ && (!same || frame.changed)) {
        if (frame.pose && frame_.pose)
            here_ = frame.pose->inverse() * *frame_.pose * *here_;
        else
            here_.reset();
    }
    frame_ = std::move(frame);
}

}  // namespace seamwright::program_path
