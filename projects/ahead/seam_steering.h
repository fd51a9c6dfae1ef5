#pragma once
// What is told to a robot that runs along a seam, from what a sensor before the tool has seen.
//
// The frame that was pushed moves the taught path by B (base). A measured point m (base) is looked at from the taught
// part, B^-1 m, and lies off the guide by d(s) in the two directions that a profile tells of: what the frame has not
// found. It is kept in the delay line by its path length s. In every cycle the programmed position p has its foot s
// on the guide, and the offset
//     v = R_B (across(s) d_1(s) + height(s) d_2(s)),   with the rate dv/dt = (dd/ds) ds/dt,
// is wanted on top of B p - p. A part that is where the frame says has v = 0. Nothing depends on the time: override and
// stops change nothing. Along the path nothing is corrected.
//
// A controller that makes no shift along the travel t (EGM, devices/abb/egm.h) has its tool in the plane across t through
// p, not at B p. There belongs the place s' of the moved path that lies in that plane: with q(s') as far off the guide as
// p is,
//     t . (B q(s') + R_B v(s') - p) = 0,   and wanted is the part across t of  B q(s') + R_B v(s') - B p.
// So neither the curve (shift^2 / 2R on a radius of R) nor a turn of B (shift times angle) nor the slope of what was found
// is left over. The tool path is taken to keep its distance off the guide over the shift. The tool needs the measures of
// s', which for a part that lies back lies nearer to the sensor by the shift.
//
// Ended by an alarm, which leads everything back and stops the path, are: a stretch without a feature longer than
// DelayLineOptions::most_gap_mm, seen at the sensor and not only at the tool; a tool that has come behind the newest
// measure; a contour farther off the frame than `limit_mm`, in kBeyond features in a row or asked for by the tool; an
// offset that takes the whole correction at the tool beyond `total_limit_mm`; a sigma of the offset over
// `sigma_limit_mm`; a robot that stays more than `behind_mm` behind what is wanted for `behind_s`.

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/correction/ahead/delay_line.h"
#include "core/correction/ahead/guide.h"
#include "core/correction/ahead/pose_history.h"
#include "devices/cyclic/steering.h"

namespace seamwright {

struct SteeringSetup {
    Pose base_from_reference = Pose::Identity(), flange_from_tcp = Pose::Identity();  // of SteeredLink
    double cycle_s = 0.004;
    // Where the sensor looks: the point of its profile at which the contour was taught.
    Eigen::Vector3d flange_from_looked_at_mm = Eigen::Vector3d::Zero();
    Pose base_from_moved = Pose::Identity();  // B
    bool shifts_along = true;                 // of SteeredLink
    DelayLineOptions line;
    double limit_mm = 3, sigma_limit_mm = 0.1;
    double total_limit_mm = 25;  // of B p - p + v
    double behind_mm = 0.5, behind_s = 2;
};

// Features of a run, and what was told by them.
struct SteeringFigures {
    std::uint64_t stored = 0, implausible = 0, beyond_limit = 0, off_guide = 0, not_found = 0;
    std::uint64_t cycles = 0;        // of the running path
    std::uint64_t cycles_known = 0;  // of them between measures
    double from_mm = 0, to_mm = 0;   // of the tool on the guide
    double known_from_mm = 0;        // the first measure
    double least_ahead_mm = 0;       // of the newest measure before the tool, while it was needed
    double largest_mm = 0;           // offset that the robot has taken
    double largest_sigma_mm = 0;     // of an offset that was wanted
    double largest_behind_mm = 0;    // wanted less taken, between measures
    double half_width_mm = 0;        // of the smoothing, at the end
    std::optional<Text> alarm;       // the first
};

class SeamSteering final : public PathSteering {
  public:
    // `guide` in base, as taught.
    SeamSteering(GuideCurve guide, const SteeringSetup& setup);

    void see(const CyclicPacket& packet, PathPhase phase, std::int64_t heard_ns) override;
    void alarmed(const Text& reason) override;
    Wanted wanted(const CyclicPacket& packet, const Eigen::Vector3d& present_mm) override;

    // For the sensor's thread.
    PathPhase phase() const;
    // Where the flange was; nothing where that is not known, or not yet (`known_until_ns`).
    std::optional<Pose> base_from_flange(std::int64_t time_ns) const;
    bool known_until(std::int64_t time_ns) const;
    // A feature in base, with its covariance.
    void add(const Eigen::Vector3d& point_mm, const Eigen::Matrix3d& covariance_mm2);
    void not_found(Text why);  // a profile without the feature
    void lose(Text why);       // the sensor is gone
    SteeringFigures figures() const;

    static constexpr int kBeyond = 3;

  private:
    Wanted refuse(Text why) const;
    std::optional<Text> lost_at_sensor();
    Wanted on_guide(const Eigen::Vector3d& p, const GuideCurve::Foot& foot,
                    const Eigen::Vector3d& present_mm);
    Eigen::Vector3d moved_tool(const GuideCurve::Foot& foot, double s_mm) const;
    double place_across(const Eigen::Vector3d& p, const GuideCurve::Foot& foot) const;

    const GuideCurve guide_;
    const SteeringSetup setup_;
    const Pose moved_from_base_;
    mutable std::mutex mutex_;  // of what follows; held for microseconds
    PathPhase phase_ = PathPhase::none;
    PoseHistory history_{4096};
    DelayLine line_;
    std::optional<Pose> base_from_flange_;       // the newest
    std::optional<double> tool_mm_, sensor_mm_;  // on the guide, last
    std::optional<double> looking_since_mm_;     // where the sensor was when the path began
    bool sensor_beyond_ = false;
    double step_mm_ = 0;  // of the tool in the last cycle
    int beyond_ = 0;      // features in a row
    double beyond_mm_ = 0;
    double behind_for_s_ = 0;
    Eigen::Vector3d held_ = Eigen::Vector3d::Zero();  // told last, reference frame
    std::optional<Text> lost_, last_failure_;
    SteeringFigures figures_;
};

}  // namespace seamwright
