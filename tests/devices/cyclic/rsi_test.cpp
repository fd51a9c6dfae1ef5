// The RSI driver before a simulated controller over UDP.

#include "devices/kuka/rsi.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/geometry/notation.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "rsi_settings.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

const Pose kDisplaced = make_pose(rotation_exp({0.004, -0.002, 0.005}), {0.8, -0.6, 0.5});

// B about the taught frame, so that the offset there is small.
Pose written() {
    return make_pose(kDisplaced.linear() * kTaught.linear(),
                     kTaught.translation() + kDisplaced.translation());
}

struct Pair {
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
    SimulatedRsi& robot() { return static_cast<SimulatedRsi&>(*controller); }
    CyclicLink& cyclic() { return static_cast<CyclicLink&>(*link); }
};

Pair open_pair(nlohmann::json more_link = {}, nlohmann::json more_robot = {}) {
    const std::uint16_t port = free_port();
    nlohmann::json settings = link_settings(port),
                   robot = {{"port", port}, {"restart_ms", 300}, {"application", false}};
    if (!more_link.is_null()) settings.update(more_link);
    if (!more_robot.is_null()) robot.update(more_robot);
    DeviceSession session;
    Pair pair;
    auto link = open_kuka_rsi(settings, session, nullptr);
    EXPECT_TRUE(link) << link.error().sentence();
    auto controller = start_kuka_rsi(nullptr, robot, nullptr);
    EXPECT_TRUE(controller) << controller.error().sentence();
    pair.link = std::move(*link);
    pair.controller = std::move(*controller);
    return pair;
}

void expect_on_displaced_path(const SimulatedRsi::Sample& s, const Pose& b, double tolerance_mm) {
    const Pose wanted = b * s.programmed;
    EXPECT_LT((s.corrected.translation() - wanted.translation()).norm(), tolerance_mm);
    EXPECT_LT(deg_from_rad(angle_rad(s.corrected, wanted)), 1e-5);
}

class RsiReference : public testing::TestWithParam<const char*> {};

TEST_P(RsiReference, TheCorrectedPathIsTheDisplacedPath) {
    // A displacement about the base's origin far away: the offset varies along the path.
    Pair pair = open_pair({{"reference", GetParam()}}, {{"reference", GetParam()}});
    ASSERT_TRUE(pair.link->identity());
    EXPECT_EQ(pair.link->identity()->brand, "KUKA");
    ASSERT_TRUE(pair.link->read_frame("PATH"));
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    EXPECT_LT(distance_mm(*pair.link->read_frame("PATH"), written()), 1e-12);
    std::this_thread::sleep_for(milliseconds(30));
    for (const double x : pair.robot().newest().correction) EXPECT_EQ(x, 0) << "staged only";
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_TRUE(pair.robot().released());
    const Pose b = written() * kTaught.inverse();
    std::this_thread::sleep_for(milliseconds(60));
    // A machine that pauses loses an answer, and the robot then keeps the last; in time it is exact.
    auto best = pair.robot().newest();
    for (const auto& s : pair.robot().history())
        if (distance_mm(s.corrected, b * s.programmed) < distance_mm(best.corrected, b * best.programmed))
            best = s;
    expect_on_displaced_path(best, b, 1e-5);
    EXPECT_LT(distance_mm(pair.robot().newest().corrected, b * pair.robot().newest().programmed), 5e-2);
    const auto flange = pair.link->base_from_flange();
    ASSERT_TRUE(flange);
    ASSERT_TRUE(pair.link->confirm(PartVerdict::refused, ""));
    std::this_thread::sleep_for(milliseconds(60));
    EXPECT_FALSE(pair.robot().released());
    for (const double x : pair.robot().newest().correction) EXPECT_EQ(x, 0);
    // Nothing that was in force ever left the limits.
    for (const auto& s : pair.robot().history())
        EXPECT_LE(Eigen::Vector3d(s.correction[0], s.correction[1], s.correction[2]).norm(), 10);
    EXPECT_EQ(pair.robot().stops(), 0u);
    EXPECT_GT(pair.cyclic().server().counters().answers, 20u);
}
INSTANTIATE_TEST_SUITE_P(Both, RsiReference, testing::Values("base", "tool"));

TEST(Rsi, RelativeIncrementsAddUpToTheCorrection) {
    Pair pair = open_pair({{"mode", "relative"}, {"cycle_ms", 12}},
                          {{"mode", "relative"}, {"cycle_ms", 12}, {"speed_mm_s", 0}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    std::this_thread::sleep_for(milliseconds(30));
    expect_on_displaced_path(pair.robot().newest(), written() * kTaught.inverse(), 1e-6);
}

// Each part type may have a frame of its own: the controller holds the correction of those that were written for this part.
TEST(Rsi, FramesOfAnotherTypeSayNothing) {
    Pair pair = open_pair({{"frames",
                            {{"L", {{"base_from_frame", pose_json(kTaught)}}},
                             {"R", {{"base_from_frame", pose_json(kTaught)}}}}}});
    Pose back = written();
    back.translation() = 2 * kTaught.translation() - back.translation();
    for (const auto& [name, frame] : {std::pair{"L", written()}, {"R", back}, {"L", written()}}) {
        ASSERT_TRUE(pair.link->write_frame(name, frame));
        const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
        ASSERT_TRUE(confirmed) << name << ": " << confirmed.error().sentence();
        EXPECT_TRUE(pair.robot().released());
    }
    ASSERT_TRUE(pair.link->write_frame("L", written()));
    ASSERT_TRUE(pair.link->write_frame("R", back));
    const auto refused = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("frames L and R want different corrections"));
}

TEST(Rsi, RefusesBeyondTheLimitsInWords) {
    Pair pair = open_pair({{"max_translation_mm", 2}, {"max_rotation_deg", 0.5}});
    Pose far = kTaught, turned = kTaught;
    far.translation().x() += 2.5;
    turned.linear() = rotation_exp({0, 0, rad_from_deg(0.6)}) * turned.linear();
    EXPECT_THAT(pair.link->write_frame("PATH", far).error().what,
                HasSubstr("2.500 mm is beyond the limit of 2.000"));
    EXPECT_THAT(pair.link->write_frame("PATH", turned).error().what, HasSubstr("0.6000 degrees is beyond"));
    EXPECT_FALSE(pair.link->write_frame("OTHER", kTaught));
    EXPECT_FALSE(pair.link->start_measuring({}));
}

TEST(Rsi, SettingsAreStrict) {
    DeviceSession session;
    for (const nlohmann::json& wrong :
         {nlohmann::json{{"prot", 1}}, nlohmann::json{{"port", 70000}}, nlohmann::json{{"mode", "sum"}},
          nlohmann::json{{"mode", "relative"}, {"reference", "tool"}}, nlohmann::json{{"decimals", 20}},
          nlohmann::json{{"sen_type", "a<b"}}, nlohmann::json{{"listen", 3}}, nlohmann::json{{"cycle_ms", 0}},
          nlohmann::json{{"measuring", {{"driver", "kuka-rsi"}}}},
          nlohmann::json{{"frames", {{"A", {{"pose", 1}}}}}}}) {
        EXPECT_FALSE(open_kuka_rsi(wrong, session, nullptr)) << wrong.dump();
    }
}

// What the alarm says, fault by fault, with the correction in force when the fault begins.
struct Fault {
    ControllerFault fault;
    const char* says;
};
void PrintTo(const Fault& f, std::ostream* out) {
    *out << to_string(f.fault);
}
class RsiFault : public testing::TestWithParam<Fault> {};

TEST_P(RsiFault, IsToldLeavesNothingInForceAndEnds) {
    Pair pair = open_pair({{"max_late", 30}}, {{"late_limit", 40}, {"slow_ms", 60}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    const bool refuses = GetParam().fault == ControllerFault::reject_write;
    if (refuses) pair.controller->set_fault(GetParam().fault);
    auto result = pair.link->confirm(PartVerdict::corrected, "");
    if (!refuses) {
        ASSERT_TRUE(result) << result.error().sentence();
        EXPECT_TRUE(pair.controller->released());
        pair.controller->set_fault(GetParam().fault);
        const auto patience = Clock::now() + milliseconds(3000);
        while (!pair.cyclic().server().alarm() && Clock::now() < patience)
            std::this_thread::sleep_for(milliseconds(5));
        result = pair.link->mode().map([](RobotMode) {});
    }
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr(GetParam().says));
    pair.controller->set_fault(ControllerFault::none);
    const auto deadline = Clock::now() + milliseconds(4000);
    Expected<RobotMode> mode = pair.link->mode();
    while (!mode && Clock::now() < deadline) mode = pair.link->mode();
    ASSERT_TRUE(mode) << mode.error().sentence();
    while (pair.controller->released() && Clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(10));
    EXPECT_FALSE(pair.controller->released());
    // And again.
    Expected<void> again;
    do again = pair.link->confirm(PartVerdict::corrected, "");
    while (!again && Clock::now() < deadline);
    ASSERT_TRUE(again) << again.error().sentence();
}
INSTANTIATE_TEST_SUITE_P(
    All, RsiFault,
    testing::Values(Fault{ControllerFault::silent, "fell silent under a correction"},
                    Fault{ControllerFault::slow, "late or lost"},
                    Fault{ControllerFault::wrong_answer, "repeats old cycle numbers"},
                    Fault{ControllerFault::half_message, "fell silent under a correction"},
                    Fault{ControllerFault::disconnect, "fell silent under a correction"},
                    Fault{ControllerFault::reject_write, "under a correction"},
                    Fault{ControllerFault::out_of_range, "a position that it cannot have"}));

TEST(RsiApplication, RunsOnceItIsReleasedAndIsTakenAtItsEnd) {
    Pair pair = open_pair({}, {{"application", true}, {"path_s", 0.4}, {"restart_ms", 800}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    std::this_thread::sleep_for(milliseconds(60));
    const Pose stands = pair.robot().newest().programmed;
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_LT(distance_mm(pair.robot().history().front().programmed, stands), 1e-9) << "it waits";
    bool ran = false;
    Expected<Permission> permission = Permission::none;
    const auto deadline = Clock::now() + milliseconds(8000);
    while (Clock::now() < deadline) {
        permission = pair.link->permission();
        ASSERT_TRUE(permission) << permission.error().sentence();
        ran = ran || *permission == Permission::running;
        if (*permission == Permission::taken) break;
        std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_TRUE(ran);
    EXPECT_EQ(*permission, Permission::taken);
    pair.link.reset();
    std::this_thread::sleep_for(milliseconds(200));
    EXPECT_TRUE(pair.controller->released()) << "it is the application's";
    EXPECT_TRUE(pair.controller->taken());
}

// Where the robot is on its programmed path once nothing has moved for 200 ms; nothing within `most`.
std::optional<Pose> comes_to_stand(const SimulatedRsi& robot, milliseconds most) {
    Pose before = robot.newest().programmed;
    int still = 0;
    for (const auto until = Clock::now() + most; Clock::now() < until;) {
        std::this_thread::sleep_for(milliseconds(20));
        const Pose now = robot.newest().programmed;
        still = distance_mm(now, before) < 1e-9 ? still + 1 : 0;
        before = now;
        if (still == 10) return now;
    }
    return std::nullopt;
}

bool runs(CyclicLink& link, milliseconds most) {
    for (const auto until = Clock::now() + most; Clock::now() < until;) {
        const auto permission = link.permission();
        if (permission && *permission == Permission::running) return true;
        std::this_thread::sleep_for(milliseconds(2));
    }
    return false;
}

// How the permission goes while the path runs: the program ends, or the robot does what no robot should.
class RsiWithdrawn : public testing::TestWithParam<const char*> {};

TEST_P(RsiWithdrawn, StopsThePathWhichIsNeverTaken) {
    Pair pair = open_pair({{"max_late", 5}}, {{"application", true}, {"path_s", 1.5}, {"restart_ms", 700}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    ASSERT_TRUE(runs(pair.cyclic(), milliseconds(1000)));
    const Pose begin = pair.robot().history().front().programmed;
    const std::string how = GetParam();
    if (how == "program ends") {
        pair.link.reset();
    } else if (how == "verdict") {
        ASSERT_TRUE(pair.link->confirm(PartVerdict::failed, ""));
    } else {
        pair.controller->set_fault(ControllerFault::out_of_range);  // an alarm of the corrector
        std::this_thread::sleep_for(milliseconds(40));
        pair.controller->set_fault(ControllerFault::none);
        EXPECT_FALSE(pair.link->permission());
    }
    const auto stands = comes_to_stand(pair.robot(), milliseconds(900));
    ASSERT_TRUE(stands) << "it ran on";
    EXPECT_GT(distance_mm(*stands, begin), 1) << "in the middle of the path";
    std::this_thread::sleep_for(milliseconds(800));
    EXPECT_FALSE(pair.controller->taken());
    EXPECT_FALSE(pair.controller->released());
    if (!pair.link) return;
    // The program that is started next begins at the beginning, and waits.
    const auto from_begin = [&] { return distance_mm(pair.robot().newest().programmed, begin); };
    for (const auto until = Clock::now() + milliseconds(4000); from_begin() > 1e-9 && Clock::now() < until;)
        std::this_thread::sleep_for(milliseconds(10));
    EXPECT_LT(from_begin(), 1e-9);
    EXPECT_TRUE(comes_to_stand(pair.robot(), milliseconds(1000)));
    ASSERT_FALSE(pair.robot().messages().empty());
    EXPECT_THAT(pair.robot().messages().front(), HasSubstr("the path was stopped"));
    Expected<void> next;
    for (const auto until = Clock::now() + milliseconds(4000); Clock::now() < until;) {
        next = pair.link->confirm(PartVerdict::corrected, "");
        if (next) break;
    }
    ASSERT_TRUE(next) << next.error().sentence();
    EXPECT_TRUE(runs(pair.cyclic(), milliseconds(1000)));
}
INSTANTIATE_TEST_SUITE_P(Ways, RsiWithdrawn, testing::Values("program ends", "verdict", "alarm"),
                         [](const auto& way) {
                             std::string name = way.param;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

}  // namespace
}  // namespace seamwright
