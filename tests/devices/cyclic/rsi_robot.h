#pragma once
// An RSI controller in virtual time, after KUKA's description and recorded traffic; it knows nothing of the
// driver. One cycle: a telegram goes out, the answer to it counts if it is there before the next one.
//   - The IPOC is the controller's clock: it goes on whatever happens, sessions included.
//   - Delay D is the number of answers in a row that came late (or the sum since RSI_ON, as some print it).
//   - An answer with another IPOC than the last telegram's is thrown away.
//   - A late answer: with HOLDON 1 the last RKorr is taken once more, with 0 each of its values is zero.
//   - absolute: RKorr is the correction; relative: it is added.
//   - RIst follows the corrected path with the servo lag, RSol is the programmed path.

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "core/geometry/notation.h"
#include "core/geometry/pose.h"
#include "devices/kuka/rsi_telegram.h"

namespace seamwright {

class RsiRobot {
  public:
    using Numbers = std::array<double, 6>;
    bool relative = false, hold_on = true, adds_up_late = false, with_rist = true, with_rsol = true;
    int cycle_ms = 4;
    std::size_t lag_cycles = 0;
    std::optional<bool> path;  // <Path>
    Pose programmed = make_pose(rotation_exp({0, 0, 0.4}), {900, -200, 600});

    const Numbers& in_force() const { return in_force_; }
    std::uint64_t ipoc() const { return ipoc_; }
    std::uint64_t late() const { return late_; }
    void set_ipoc(std::uint64_t ipoc) { ipoc_ = ipoc; }
    void rsi_on() {
        in_force_ = last_ = {};
        late_ = 0;
        shown_.clear();
    }
    static Pose corrected(const Pose& p, const Numbers& c) {
        return make_pose(rotation_from_kuka({c[3], c[4], c[5]}) * p.linear(),
                         p.translation() + Eigen::Vector3d(c[0], c[1], c[2]));
    }
    // The telegram of the next cycle.
    std::string send() {
        ipoc_ += static_cast<std::uint64_t>(cycle_ms);
        shown_.push_front(corrected(programmed, in_force_));
        if (shown_.size() > 64) shown_.pop_back();
        const Pose& actual = shown_[std::min(lag_cycles, shown_.size() - 1)];
        return "<Rob Type=\"KUKA\">" + (with_rist ? frame("RIst", actual) : "") +
               (with_rsol ? frame("RSol", programmed) : "") +
               (path ? fmt::format("<Path>{}</Path>", *path ? 1 : 0) : "") +
               fmt::format("<Delay D=\"{}\"/><Tech T21=\"1.09\"/><IPOC>{}</IPOC></Rob>", late_, ipoc_);
    }
    // Before the next one is sent: what has come. False: it was late.
    bool end_of_cycle(const std::optional<RsiSen>& answer) {
        const bool in_time =
            answer && answer->ipoc == std::to_string(ipoc_) && answer->rkorr && answer->rkorr->usable;
        if (in_time) {
            last_ = answer->rkorr->xyzabc;
            if (!adds_up_late) late_ = 0;
        } else {
            ++late_;
            if (!hold_on) last_ = {};
        }
        for (std::size_t k = 0; k < 6; ++k) in_force_[k] = relative ? in_force_[k] + last_[k] : last_[k];
        return in_time;
    }

  private:
    static std::string frame(const char* name, const Pose& pose) {
        const KukaAbc abc = kuka_from_rotation(pose.linear());
        const Eigen::Vector3d p = pose.translation();
        return fmt::format(
            "<{} X=\"{:.4f}\" Y=\"{:.4f}\" Z=\"{:.4f}\" A=\"{:.4f}\" B=\"{:.4f}\" C=\"{:.4f}\"/>", name,
            p.x(), p.y(), p.z(), abc.a_deg, abc.b_deg, abc.c_deg);
    }
    Numbers in_force_{}, last_{};
    std::uint64_t late_ = 0, ipoc_ = 4208163634;
    std::deque<Pose> shown_;
};

// Largest change from one cycle to the next.
struct StepMeter {
    double mm = 0, deg = 0;
    void add(const RsiRobot::Numbers& a, const RsiRobot::Numbers& b) {
        mm = std::max(mm, (Eigen::Vector3d(b[0], b[1], b[2]) - Eigen::Vector3d(a[0], a[1], a[2])).norm());
        deg = std::max(deg, deg_from_rad(rotation_log(rotation_from_kuka({a[3], a[4], a[5]}).transpose() *
                                                      rotation_from_kuka({b[3], b[4], b[5]}))
                                             .norm()));
    }
};

}  // namespace seamwright
