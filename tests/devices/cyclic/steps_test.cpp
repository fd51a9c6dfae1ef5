// The invariant of corrector.h: whatever arrives, no cycle's step is beyond the limit, and the robot holds
// what the driver says or there is an alarm. The robot is rsi_robot.h; the net between the two loses, delays,
// exchanges and repeats in both directions.

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "devices/cyclic/corrector.h"
#include "devices/kuka/rsi_protocol.h"
#include "devices/net/socket.h"
#include "rsi_robot.h"

namespace seamwright {
namespace {

constexpr double kSpeed_mm_s = 20, kSpeed_deg_s = 2;
constexpr double kTolerance_mm = 0.2;
constexpr double kStepMm = kSpeed_mm_s * 0.004, kStepDeg = kSpeed_deg_s * 0.004;

CyclicSettings corrector_settings() {
    CyclicSettings s;
    s.ramp = {kSpeed_mm_s, kSpeed_deg_s, 100, 10};
    s.max_late = 10;
    return s;
}

struct Kind {
    bool relative, adds_up_late, wrong_hold_on;
};
void PrintTo(const Kind& k, std::ostream* out) {
    *out << (k.relative ? "relative" : "absolute") << (k.adds_up_late ? ", D adds up" : ", D is a run length")
         << (k.wrong_hold_on ? ", HOLDON the wrong way round" : "");
}

// One robot, one net, one driver, cycle by cycle.
class Line {
  public:
    Line(const Kind& kind, std::uint64_t seed)
        : random_(seed), corrector_(corrector_settings(), make_rsi_protocol({.relative = kind.relative}, 4)) {
        robot_.relative = kind.relative;
        robot_.hold_on = kind.relative == kind.wrong_hold_on;
        robot_.adds_up_late = kind.adds_up_late;
        robot_.lag_cycles = random_() % 6;
    }

    void run(int cycles, bool calm = false) {
        for (int i = 0; i < cycles; ++i) {
            if (!calm) disturb();
            cycle(calm);
        }
    }
    void withdraw() { corrector_.set_target(Pose::Identity()); }
    void command() {
        const auto part = [&](double size) {
            return size * (static_cast<double>(random_() % 2001) / 1000 - 1);
        };
        // About the robot's place: a turn about the base's origin would be too far there.
        const Pose at = make_pose(Eigen::Matrix3d::Identity(), robot_.programmed.translation());
        const Pose b = make_pose(rotation_exp(Eigen::Vector3d(part(0.01), part(0.01), part(0.01))),
                                 {part(4), part(4), part(4)});
        corrector_.set_target(random_() % 3 == 0 ? Pose::Identity() : Pose(at * b * at.inverse()));
    }

    RsiRobot robot_;
    StepMeter steps_;
    double worst_belief_mm_ = 0;
    int restarts_ = 0, silences_ = 0, late_ = 0, alarms_ = 0;
    CyclicCorrector& corrector() { return corrector_; }

  private:
    bool chance(double p) { return static_cast<double>(random_() % 1000000) < p * 1e6; }

    void disturb() {
        if (chance(0.004)) command();
        if (chance(0.004)) speed_ = random_() % 3 == 0 ? 0 : static_cast<double>(random_() % 150);
        if (chance(0.002)) losses_ = chance(0.5) ? 0 : 0.02 * static_cast<double>(random_() % 10);
        if (quiet_ > 0) return;
        if (chance(0.0006)) {  // nothing passes the net, the controller goes on
            lost_cycles_ = 2 + static_cast<int>(random_() % (random_() % 4 == 0 ? 400 : 30));
            ++silences_;
        } else if (chance(0.0004)) {  // RSI is switched off and on: the controller stands, its clock goes on
            lost_cycles_ = 0;
            off_cycles_ = 10 + static_cast<int>(random_() % 300);
            ++restarts_;
        } else if (chance(0.0003)) {  // both stand, as when a virtual machine is held
            held_cycles_ = 150 + static_cast<int>(random_() % 100);
        } else if (chance(0.0003)) {  // the clock is set, the session goes on
            const std::uint64_t by = 4 * (1 + random_() % 3000);
            robot_.set_ipoc(random_() % 2   ? robot_.ipoc() + by
                            : random_() % 2 ? robot_.ipoc() - by
                                            : random_() % 1000);
        }
    }

    void cycle(bool calm) {
        ++now_;
        if (held_cycles_ > 0) {
            --held_cycles_;
            arrived_late();
            return;
        }
        if (off_cycles_ > 0) {
            to_driver_.clear();
            to_robot_.clear();
            arrived_late();
            if (--off_cycles_ > 0) {
                robot_.set_ipoc(robot_.ipoc() + 4);
                return;
            }
            robot_.rsi_on();
            last_in_force_ = robot_.in_force();
            quiet_ = 200;  // RSI_ON is only taken at rest
            if (random_() % 3 == 0) robot_.set_ipoc(random_() % 1000000);
            if (random_() % 2) other_peer_ = since_ > 125;
        }
        if (quiet_ > 0) --quiet_;
        const double speed = quiet_ > 0 || calm ? 0 : speed_;
        angle_ += speed * 0.004 / 200;
        robot_.programmed.translation() =
            Eigen::Vector3d(900 + 200 * std::cos(angle_), -200 + 200 * std::sin(angle_), 600);
        const bool lost = lost_cycles_ > 0;
        if (lost) --lost_cycles_;
        const double losses = calm ? 0 : losses_;
        const auto in_force_then = robot_.in_force();
        const std::string telegram = robot_.send();
        if (!lost && !chance(losses)) {
            const int delay = chance(losses) ? 1 + static_cast<int>(random_() % 4) : 0;
            to_driver_.push_back({now_ + delay, telegram, in_force_then, robot_.ipoc()});
            if (chance(losses / 2))
                to_driver_.push_back({now_ + delay, telegram, in_force_then, robot_.ipoc()});
        }
        deliver(lost, losses);
        // What reaches the robot in this cycle: of several the one that counts is looked for, as it does.
        std::optional<RsiSen> answer;
        std::erase_if(to_robot_, [&](const Packet& p) {
            if (p.due > now_) return false;
            auto sen = parse_rsi_sen(bytes_of(p.text));
            EXPECT_TRUE(sen);
            if (sen && sen->ipoc == std::to_string(robot_.ipoc())) answer = *sen;
            return true;
        });
        const bool in_time = robot_.end_of_cycle(answer);
        late_ += !in_time;
        steps_.add(last_in_force_, robot_.in_force());
        last_in_force_ = robot_.in_force();
    }

    void deliver(bool lost, double losses) {
        bool any = false;
        std::vector<Packet> due;
        std::erase_if(to_driver_, [&](const Packet& p) {
            if (p.due > now_) return false;
            due.push_back(p);
            return true;
        });
        if (due.size() > 1 && random_() % 2) std::swap(due.front(), due.back());
        const bool together = random_() % 2;
        for (const Packet& p : due) {
            const CyclicArrival arrival{.gap = since_ > 125, .other_peer = std::exchange(other_peer_, false)};
            ASSERT_TRUE(corrector_.handle(bytes_of(p.text), arrival));
            any = true;
            since_ = 0;
            if (corrector_.state().packet.number == p.ipoc) compare(p.in_force);
            if (!together || &p == &due.back()) answer(lost, losses);
        }
        if (!any) arrived_late();
    }

    void answer(bool lost, double losses) {
        const auto bytes = corrector_.answer();
        if (bytes.empty() || lost || chance(losses)) return;
        const int delay = chance(losses) ? 1 + static_cast<int>(random_() % 4) : 0;
        to_robot_.push_back(
            {now_ + delay, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), {}, 0});
    }

    void arrived_late() {
        if (++since_ == 126) corrector_.silence();
    }

    void compare(const RsiRobot::Numbers& in_force) {
        const auto& held = corrector_.state().held;
        const Eigen::Vector3d truth(in_force[0], in_force[1], in_force[2]);
        const double off = (held.mm - truth).norm();
        if (corrector_.alarm()) {
            ++alarms_;
            if (off < 1e-6 && random_() % 50 == 0) (void)corrector_.take_alarm();
            return;
        }
        worst_belief_mm_ = std::max(worst_belief_mm_, off);
    }

    struct Packet {
        std::int64_t due;
        std::string text;
        RsiRobot::Numbers in_force;
        std::uint64_t ipoc;
    };
    std::mt19937_64 random_;
    CyclicCorrector corrector_;
    std::vector<Packet> to_driver_, to_robot_;
    RsiRobot::Numbers last_in_force_{};
    std::int64_t now_ = 0;
    int since_ = 0, lost_cycles_ = 0, off_cycles_ = 0, held_cycles_ = 0, quiet_ = 0;
    double speed_ = 50, losses_ = 0.02, angle_ = 0;
    bool other_peer_ = false;
};

class NoStep : public testing::TestWithParam<Kind> {};

TEST_P(NoStep, WhateverArrives) {
    StepMeter worst;
    double belief = 0;
    int restarts = 0, silences = 0, late = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        Line line(GetParam(), seed);
        line.run(50, true);
        line.run(15000);
        worst.mm = std::max(worst.mm, line.steps_.mm);
        worst.deg = std::max(worst.deg, line.steps_.deg);
        belief = std::max(belief, line.worst_belief_mm_);
        restarts += line.restarts_;
        silences += line.silences_;
        late += line.late_;
        ASSERT_LE(line.steps_.mm, kStepMm * (1 + 1e-6) + 2e-7) << "seed " << seed;
        // Sums of A, B, C that are not what we reckon with turn by a little more.
        ASSERT_LE(line.steps_.deg, kStepDeg * (GetParam().wrong_hold_on ? 1.01 : 1 + 1e-6) + 3e-7)
            << "seed " << seed;
        if (!GetParam().wrong_hold_on) {
            ASSERT_LE(line.worst_belief_mm_, GetParam().relative ? kTolerance_mm : kStepMm)
                << "seed " << seed;
        }
        // And when all is quiet again, nothing is left in the robot. Led back at the ramp's speed.
        line.run(400, true);
        line.withdraw();
        line.run(4000, true);
        EXPECT_TRUE(line.corrector().state().zero) << "seed " << seed;
        for (const double x : line.robot_.in_force())
            ASSERT_NEAR(x, 0, GetParam().relative ? kTolerance_mm : 1e-6) << "seed " << seed;
    }
    std::cout << testing::PrintToString(GetParam()) << ": largest step " << worst.mm << " of " << kStepMm
              << " mm, " << worst.deg << " of " << kStepDeg << " deg; belief off by " << belief << " mm; "
              << late << " late, " << silences << " silences, " << restarts << " restarts\n";
    EXPECT_GT(restarts, 8);
    EXPECT_GT(silences, 8);
}
INSTANTIATE_TEST_SUITE_P(Robots, NoStep,
                         testing::Values(Kind{false, false, false}, Kind{false, true, false},
                                         Kind{true, false, false}, Kind{true, true, false},
                                         Kind{true, false, true}));

// One robot before the corrector, without a net between them.
struct Direct {
    RsiRobot robot;
    CyclicCorrector corrector;
    StepMeter steps;
    std::optional<bool> released;  // by the newest answer
    explicit Direct(bool relative = false)
        : corrector(corrector_settings(), make_rsi_protocol({.relative = relative}, 4)) {
        robot.relative = relative;
        robot.hold_on = !relative;
    }
    // Whether the telegram and the answer arrive.
    void cycle(bool telegram = true, bool answer = true) {
        const auto before = robot.in_force();
        const std::string text = robot.send();
        std::optional<RsiSen> sen;
        released.reset();
        if (telegram && corrector.handle(bytes_of(text))) {
            const auto bytes = corrector.answer();
            if (!bytes.empty() && answer) sen = *parse_rsi_sen(bytes);
            if (sen) released = sen->release;
        }
        robot.end_of_cycle(sen);
        steps.add(before, robot.in_force());
    }
    void cycles(int n) {
        while (n-- > 0) cycle();
    }
    void move_to(double z_mm) { corrector.set_target(make_pose(Eigen::Matrix3d::Identity(), {0, 0, z_mm})); }
};

TEST(RobotThatDrops, TheCorrectionAtALateAnswerIsNotGivenItBackInOneStep) {
    Direct d;
    d.robot.hold_on = false;  // configured the wrong way round
    d.robot.lag_cycles = 2;
    d.cycles(20);
    d.move_to(3);
    d.cycles(400);
    ASSERT_NEAR(d.robot.in_force()[2], 3, 1e-6);
    d.robot.lag_cycles = 0;
    d.cycles(10);
    d.cycle(true, false);
    ASSERT_EQ(d.robot.in_force()[2], 0) << "by itself";
    d.steps = {};
    d.cycles(500);
    EXPECT_LE(d.steps.mm, kStepMm);
    ASSERT_TRUE(d.corrector.alarm());
    EXPECT_EQ(d.robot.in_force()[2], 0);
}

TEST(RobotThatDoesNotFollow, IsTold) {
    for (const double share : {0.0, 0.5}) {
        Direct d;
        d.cycles(20);
        d.move_to(2);
        StepMeter told;
        RsiRobot::Numbers last{};
        std::uint64_t steady = 0;
        for (int i = 0; i < 600; ++i) {
            // RIst is what an inner part makes of RKorr: nothing, or half.
            RsiRobot shows;
            shows.set_ipoc(d.robot.ipoc());
            RsiSen half;
            half.ipoc = std::to_string(d.robot.ipoc());
            half.rkorr = RsiFrame{};
            half.rkorr->xyzabc[2] = share * last[2];
            (void)shows.end_of_cycle(half);
            const std::string text = shows.send();
            d.robot.set_ipoc(shows.ipoc());
            ASSERT_TRUE(d.corrector.handle(bytes_of(text)));
            const auto bytes = d.corrector.answer();
            ASSERT_FALSE(bytes.empty());
            const auto now = parse_rsi_sen(bytes)->rkorr->xyzabc;
            told.add(last, now);
            last = now;
            if (!d.corrector.alarm() && std::abs(last[2]) > 0)
                steady = std::max(steady, d.corrector.state().steady);
        }
        EXPECT_EQ(steady, 0u) << share;
        ASSERT_TRUE(d.corrector.alarm()) << share;
        EXPECT_NE(d.corrector.alarm()->english().find("does not follow"), std::string::npos)
            << *d.corrector.alarm();
        EXPECT_LE(told.mm, kStepMm) << share;
        EXPECT_EQ(last[2], 0) << "led back";
    }
}

TEST(RobotFoundCorrected, IsLedBackFromThere) {
    for (const bool relative : {false, true}) {
        Direct first(relative);
        first.cycles(20);
        first.move_to(3);
        first.cycles(400);
        ASSERT_NEAR(first.robot.in_force()[2], 3, 1e-6);
        // Another driver comes to the same robot.
        Direct second(relative);
        second.robot = first.robot;
        second.cycles(10);
        ASSERT_TRUE(second.corrector.alarm());
        EXPECT_NE(second.corrector.alarm()->english().find("found with a correction of 3.000 mm"),
                  std::string::npos);
        second.cycles(600);
        EXPECT_LE(second.steps.mm, kStepMm) << relative;
        EXPECT_NEAR(second.robot.in_force()[2], 0, 1e-3) << relative;
    }
}

// A robot that is met on its way shows its servo's lag beside what it holds: what lag explains is no correction, and nothing is
// told before that is known.
TEST(RobotFoundMoving, ItsLagIsNoCorrection) {
    for (const bool relative : {false, true})
        for (const std::size_t lag : {0U, 3U, 6U, 15U})
            for (const double speed_mm_s : {15., 100., 300.})
                for (const double held_mm : {0., 3.})
                    for (const int moves_for : {1, 12, 1000}) {  // cycles; then it stands
                        const std::string where =
                            fmt::format("relative {}, lag {}, {} mm/s, held {}, {} cycles", relative, lag,
                                        speed_mm_s, held_mm, moves_for);
                        Direct first(relative);
                        first.robot.lag_cycles = lag;
                        first.cycles(40);
                        first.move_to(held_mm);
                        first.cycles(400);
                        ASSERT_NEAR(first.robot.in_force()[2], held_mm, 1e-6) << where;
                        const auto along = [&](Direct& d, int cycles, int moving) {
                            for (int i = 0; i < cycles; ++i) {
                                if (i < moving) d.robot.programmed.translation().x() += 0.004 * speed_mm_s;
                                d.cycle();
                            }
                        };
                        along(first, 60, 60);
                        ASSERT_FALSE(first.corrector.alarm()) << where;
                        Direct second(relative);
                        second.robot = first.robot;
                        along(second, 700, moves_for);
                        EXPECT_LE(second.steps.mm, kStepMm) << where;
                        EXPECT_EQ(second.corrector.alarm().has_value(), held_mm > 0) << where;
                        EXPECT_NEAR(second.robot.in_force()[0], 0, 1e-9) << where;
                        EXPECT_NEAR(second.robot.in_force()[2], 0, 1e-3) << where;
                    }
}

// The release falls in the same cycle in which the permission goes, whatever takes it, and what becomes of
// <Path> afterwards is not told as the end of a path, neither of this permission nor of the next.
TEST(PathPermission, GoesAtOnceAndAStoppedPathIsNoPathThatIsOver) {
    for (const bool by_alarm : {false, true}) {
        Direct d;
        d.robot.path = false;
        d.cycles(20);
        d.move_to(1);
        d.cycles(200);
        d.corrector.await_path();
        d.cycles(2);
        EXPECT_EQ(d.released, true);
        d.robot.path = true;
        d.cycles(50);
        ASSERT_EQ(d.corrector.state().path, PathPhase::running);
        if (by_alarm)
            d.robot.programmed.translation().x() += 100;  // a jump
        else
            d.corrector.withdraw();
        d.steps = {};
        d.cycle();
        EXPECT_EQ(d.corrector.alarm().has_value(), by_alarm);
        EXPECT_EQ(d.released, false) << by_alarm;
        EXPECT_EQ(d.corrector.state().path, PathPhase::none);
        d.cycles(300);
        EXPECT_LE(d.steps.mm, kStepMm);
        // Confirmed anew while the old path is not yet stopped.
        (void)d.corrector.take_alarm();
        d.move_to(1);
        d.cycles(300);
        d.corrector.await_path();
        d.cycles(5);
        EXPECT_EQ(d.corrector.state().path, PathPhase::waiting);
        d.robot.path = false;
        d.cycles(5);
        EXPECT_EQ(d.corrector.state().path, PathPhase::waiting);
        d.robot.path = true;
        d.cycles(5);
        EXPECT_EQ(d.corrector.state().path, PathPhase::running);
        d.robot.path = false;
        d.cycles(5);
        EXPECT_EQ(d.corrector.state().path, PathPhase::over);
        EXPECT_EQ(d.released, false);
    }
}

TEST(Packets, WithoutRIstOrRSolAreNotPositionZero) {
    for (const bool rist : {false, true}) {
        Direct d;
        d.robot.with_rist = rist;
        d.robot.with_rsol = false;
        d.cycles(5);
        // About a far origin: at position 0 the shift would be 8.73 mm.
        const Pose at = make_pose(Eigen::Matrix3d::Identity(), {1000, 0, 0});
        const Pose turn = make_pose(rotation_exp({0, 0, rad_from_deg(0.5)}), Eigen::Vector3d::Zero());
        d.corrector.set_target(at * turn * at.inverse());
        d.cycles(600);
        for (const double x : d.robot.in_force()) EXPECT_EQ(x, 0);
        EXPECT_TRUE(d.corrector.alarm());
        EXPECT_NE(d.corrector.alarm()->english().find(rist ? "RSol" : "RIst"), std::string::npos);
    }
}

}  // namespace
}  // namespace seamwright
