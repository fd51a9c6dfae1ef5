// The invariant of corrector.h for EGM: whatever arrives, no cycle's step is beyond the limit. The robot is
// made by hand in virtual time, after ABB's description; the net between the two loses, delays, exchanges and
// repeats in both directions. EGM does not tell what it took: of the answers alone at most three in a row are
// lost or late, as protocol.h has it (unproven); everything else is without bounds.

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <iostream>
#include <random>
#include <vector>

#include "devices/abb/egm_message.h"
#include "devices/abb/egm_protocol.h"
#include "devices/cyclic/corrector.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

constexpr int kCycleMs = 4, kCommTimeoutCycles = 60, kRampOutCycles = 50;
constexpr double kStep = 20 * 0.004;  // mm
constexpr int kLostAtOnce = 3;

// Takes the newest answer that has come and keeps it where none comes; without any for kCommTimeoutCycles it
// stops, leads its correction out and begins anew.
class EgmLine {
  public:
    explicit EgmLine(std::uint64_t seed) : random_(seed), corrector_(settings(), make_egm_protocol({})) {
        lag_ = random_() % 6;
        seqno_ = seed % 2 ? 0xffffff00u : 1;  // about to wrap
    }
    CyclicCorrector& corrector() { return corrector_; }
    double worst_mm() const { return worst_mm_; }
    int stops() const { return stops_; }
    int restarts() const { return restarts_; }
    int bare() const { return bare_total_; }
    int jumps() const { return jumps_; }
    const Eigen::Vector3d& in_force() const { return in_force_; }

    void run(int cycles, bool calm) {
        for (int i = 0; i < cycles; ++i) {
            if (!calm) disturb();
            cycle(calm);
        }
    }

  private:
    struct Packet {
        std::int64_t due;
        std::vector<std::byte> bytes;
        std::int64_t answer = 0;
    };
    static CyclicSettings settings() {
        CyclicSettings s;
        s.ramp = {20, 2, 100, 10};
        s.max_rotation_deg = 0.5;
        s.max_late = 10;
        return s;
    }
    bool chance(double p) { return static_cast<double>(random_() % 1000000) < p * 1e6; }
    double part(double size) { return size * (static_cast<double>(random_() % 2001) / 1000 - 1); }

    void disturb() {
        if (chance(0.004)) {
            const Pose at = make_pose(Eigen::Matrix3d::Identity(), planned().translation());
            const Pose b = make_pose(rotation_exp(Eigen::Vector3d(part(4e-3), part(4e-3), part(4e-3))),
                                     {part(4), part(4), part(4)});
            if (random_() % 3 == 0)
                corrector_.withdraw();
            else
                corrector_.set_target(at * b * at.inverse());
        }
        if (chance(0.002) && corrector_.state().arrived && !corrector_.state().zero) corrector_.await_path();
        if (chance(0.004)) speed_ = random_() % 4 == 0 ? 0 : static_cast<double>(random_() % 150);
        if (chance(0.002)) losses_ = chance(0.5) ? 0 : 0.02 * static_cast<double>(random_() % 10);
        if (chance(0.002)) bare_ = 1 + static_cast<int>(random_() % (random_() % 3 ? 3 : 150));
        if (chance(0.0005)) dark_ = 2 + static_cast<int>(random_() % (random_() % 4 ? 30 : 400));
        if (chance(0.0005)) {  // the counters jump, the session goes on
            ++jumps_;
            const auto by = static_cast<std::uint32_t>(random_() % 5000);
            seqno_ = random_() % 2   ? seqno_ + by
                     : random_() % 2 ? seqno_ - by
                                     : static_cast<std::uint32_t>(by);
            if (random_() % 2) tm_ms_ = static_cast<std::uint32_t>(random_());
        }
        if (chance(0.0003)) {  // EGMReset, and set up again
            ++restarts_;
            stop();
        }
        if (chance(0.002)) (void)corrector_.take_alarm();
    }

    Pose planned() const {
        const Eigen::Vector3d at(900 + 200 * std::cos(angle_), -200 + 200 * std::sin(angle_), 600);
        return make_pose(rotation_exp({kPi - 0.2, 0.1, 0}), at);
    }
    Eigen::Vector3d travel() const { return {-std::sin(angle_), std::cos(angle_), 0}; }

    void stop() {
        off_ = kRampOutCycles + static_cast<int>(random_() % 200);
        ramp_out_ = in_force_ / kRampOutCycles;
        to_robot_.clear();
    }

    void cycle(bool calm) {
        ++now_;
        const bool off = off_ > 0;
        if (!off) angle_ += (calm ? 40 : speed_) * kCycleMs / 1e3 / 200;
        const Pose p = planned();
        Pose shifted = p;
        if (const auto path = reference_from_path(travel(), p.linear().col(2)))
            shifted.translation() += *path * in_force_;
        shown_.push_front(shifted);
        if (shown_.size() > 32) shown_.pop_back();
        EgmState s;
        s.seqno = ++seqno_;
        s.tm_ms = tm_ms_ += kCycleMs;
        const bool bare = !calm && bare_ > 0;
        if (bare_ > 0) --bare_;
        bare_total_ += bare;
        s.planned = p;
        if (!bare) s.measured = shown_[std::min(lag_, shown_.size() - 1)];
        s.motors_on = s.rapid_running = true;
        s.mci = off ? EgmMci::error : EgmMci::running;
        const bool dark = !calm && dark_ > 0;
        if (dark_ > 0) --dark_;
        const double losses = calm ? 0 : losses_;
        if (!dark && !chance(losses)) {
            std::array<std::byte, 1024> buffer;
            const auto bytes = write_egm_robot(buffer, s);
            const Packet packet{now_ + (chance(losses) ? 1 + static_cast<int>(random_() % 6) : 0),
                                {bytes.begin(), bytes.end()}};
            to_driver_.push_back(packet);
            if (chance(losses / 2)) to_driver_.push_back(packet);
        }
        bool any = false;
        std::vector<Packet> due = take_due(to_driver_);
        if (due.size() > 1 && random_() % 2) std::swap(due.front(), due.back());
        for (const Packet& d : due) {
            if (!corrector_.handle(d.bytes, {.gap = since_ > 125})) continue;
            any = true;
            since_ = 0;
        }
        // The server answers the newest of several.
        if (const auto bytes = corrector_.answer(); !bytes.empty()) {
            // Lost or late, but what the robot has is never older than kLostAtOnce answers.
            ++answers_;
            std::int64_t has = taken_;
            for (const Packet& waiting : to_robot_)
                if (waiting.due <= now_) has = waiting.answer;
            const bool spoilt = answers_ - has <= kLostAtOnce && chance(losses);
            const int late = spoilt ? 1 + static_cast<int>(random_() % kLostAtOnce) : 0;
            if (!spoilt || random_() % 2)
                to_robot_.push_back({now_ + late, {bytes.begin(), bytes.end()}, answers_});
        }
        if (!any && ++since_ == 126) corrector_.silence();
        const Eigen::Vector3d before = in_force_;
        if (off) {
            --off_;
            in_force_ = in_force_.norm() <= 1.5 * ramp_out_.norm() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                                   : Eigen::Vector3d(in_force_ - ramp_out_);
            to_robot_.clear();
            unheard_ = 0;
            taken_ = answers_;
            return;  // its own ramp
        }
        ++unheard_;
        for (const Packet& a : take_due(to_robot_)) {
            const auto correction = parse_egm_path_correction(a.bytes);
            ASSERT_TRUE(correction);
            in_force_ = correction->pos_mm;
            taken_ = a.answer;
            unheard_ = 0;
        }
        worst_mm_ = std::max(worst_mm_, (in_force_ - before).norm());
        if (unheard_ > kCommTimeoutCycles) {
            ++stops_;
            stop();
        }
    }

    std::vector<Packet> take_due(std::vector<Packet>& all) const {
        std::vector<Packet> due;
        std::erase_if(all, [&](const Packet& p) {
            if (p.due > now_) return false;
            due.push_back(p);
            return true;
        });
        return due;
    }

    std::mt19937_64 random_;
    CyclicCorrector corrector_;
    std::vector<Packet> to_driver_, to_robot_;
    std::deque<Pose> shown_;
    Eigen::Vector3d in_force_ = Eigen::Vector3d::Zero(), ramp_out_ = Eigen::Vector3d::Zero();
    std::size_t lag_ = 0;
    std::uint32_t seqno_ = 1, tm_ms_ = 0;
    std::int64_t now_ = 0, answers_ = 0, taken_ = 0;
    int since_ = 0, unheard_ = 0, off_ = 0, dark_ = 0, bare_ = 0;
    int stops_ = 0, restarts_ = 0, bare_total_ = 0, jumps_ = 0;
    double speed_ = 50, losses_ = 0.02, angle_ = 0, worst_mm_ = 0;
};

TEST(EgmNoStep, WhateverArrives) {
    double worst = 0;
    int stops = 0, restarts = 0, bare = 0, jumps = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        EgmLine line(seed);
        line.run(50, true);
        line.run(15000, false);
        worst = std::max(worst, line.worst_mm());
        stops += line.stops();
        restarts += line.restarts();
        bare += line.bare();
        jumps += line.jumps();
        EXPECT_LE(line.worst_mm(), kStep * (1 + 1e-9)) << "seed " << seed;
        // And when all is quiet again, nothing is left in the robot.
        line.run(400, true);
        line.corrector().withdraw();
        line.run(4000, true);
        EXPECT_LT(line.in_force().norm(), 1e-9) << "seed " << seed;
        EXPECT_TRUE(line.corrector().state().zero) << "seed " << seed;
    }
    std::cout << "EGM: largest step " << worst << " of " << kStep << " mm; " << stops << " time-outs, "
              << restarts << " restarts, " << bare << " packets without Cartesian feedback, " << jumps
              << " jumps of the counters\n";
    EXPECT_GT(stops, 5);
    EXPECT_GT(restarts, 10);
    EXPECT_GT(bare, 1000);
    EXPECT_GT(jumps, 10);
    EXPECT_GT(worst, kStep / 4) << "the net was kind";
}

}  // namespace
}  // namespace seamwright
