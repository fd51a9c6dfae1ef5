// The delivered KRL, executed by the controller's interpreters, before the real drivers over real sockets.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/controllers/kuka/cell_operator.h"
#include "devices/controllers/kuka/controller.h"
#include "devices/exchange/files.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/kvp.h"
#include "devices/kuka/program.h"
#include "devices/net/socket.h"
#include "devices/silence.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

std::vector<MeasuringMove> two_spots() {
    std::vector<MeasuringMove> moves;
    for (int i = 1; i <= 2; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i);
        m.trigger = make_pose(rotation_exp({0.1, 0.2, -0.3}), {800.0 + 30 * i, -200, 600});
        m.entry = m.exit = m.trigger;
        m.entry.translation().y() -= 20;
        m.exit.translation().y() += 20;
        moves.push_back(m);
    }
    moves[1].via = {make_pose(rotation_exp({0.1, 0.2, -0.3}), {840, -190, 620})};
    return moves;
}

class ExecutedKrl : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        static const auto opened = SimulatedCell::open(
            {{"serial", "KRC-4711"},
             {"optics", {{"width", 64}, {"height", 64}}},
             {"robot",
              {{"mode", "external"},
               {"frames", {{"BASE_left", {{"xyz", {900, -450, 500}}, {"abc", {12, -4, 3}}}}}}}}});
        cell = opened.value();
        cell->set_mode(RobotMode::external);
        cell->store_program(two_spots());
        cell->move_to(two_spots()[0].entry);
    }
    bool eki() const { return GetParam() == "kuka-eki"; }
    void start(double time_scale, int timeout_ms = 1000, std::uint16_t port = 0,
               const std::string& programs = "") {
        if (port == 0) port = TcpListener::listen("127.0.0.1", 0)->port();
        const nlohmann::json settings = {{"port", port}, {"time_scale", time_scale}, {"programs", programs}};
        const auto controller_up = [&] {
            auto started =
                eki() ? start_kuka_eki_controller(cell, settings) : start_kuka_kvp_controller(cell, settings);
            ASSERT_TRUE(started) << started.error().sentence();
            controller = std::move(*started);
        };
        if (!eki()) controller_up();
        DeviceSession session;
        auto made = eki() ? open_kuka_eki({{"port", port}, {"timeout_ms", timeout_ms}}, session)
                          : open_kuka_kvp({{"port", port}, {"timeout_ms", timeout_ms}}, session);
        ASSERT_TRUE(made) << made.error().sentence();
        link = std::move(*made);
        if (eki()) controller_up();
        for (const auto until = Clock::now() + std::chrono::seconds(5);
             Clock::now() < until && !link->mode();)
            std::this_thread::sleep_for(milliseconds(20));
        ASSERT_TRUE(link->mode());
    }
    void measure() {
        auto started = link->start_measuring(two_spots());
        ASSERT_TRUE(started) << started.error().sentence();
        for (const MeasuringMove& move : two_spots()) {
            auto trigger = link->wait_trigger(std::chrono::seconds(10));
            ASSERT_TRUE(trigger) << trigger.error().sentence();
            EXPECT_EQ(trigger->spot_id, move.spot_id);
            EXPECT_LT(distance_mm(trigger->base_from_flange.value(), move.trigger), 1e-3);
        }
    }
    bool eventually(Permission wanted) {
        for (const auto until = Clock::now() + std::chrono::seconds(5); Clock::now() < until;) {
            auto now = link->permission();
            if (now && *now == wanted) return true;
            std::this_thread::sleep_for(milliseconds(10));
        }
        return false;
    }
    std::shared_ptr<SimulatedCell> cell;
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
};

TEST_P(ExecutedKrl, TheApplicationTakesThePermissionAndKeepsItWhenTheLinkEnds) {
    start(5);
    EXPECT_EQ(link->permission(), Permission::none);
    cell->arm(true);
    measure();
    ASSERT_FALSE(HasFatalFailure());
    int exposures = 0;
    while (cell->take_exposure()) ++exposures;
    cell->arm(false);
    EXPECT_EQ(exposures, 2) << "a rising edge of the sensor's input at every spot";
    Pose corrected = cell->read_frame("BASE_left").value();
    corrected.translation().x() += 2;
    auto written = link->write_frame("BASE_left", corrected);
    ASSERT_TRUE(written) << written.error().sentence();
    EXPECT_FALSE(controller->released());
    auto told = link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(told) << told.error().sentence();
    ASSERT_TRUE(eventually(Permission::taken));
    link.reset();
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_TRUE(controller->taken());
    EXPECT_TRUE(controller->released());
    EXPECT_EQ(controller->verdict(), PartVerdict::corrected);
    EXPECT_LT(distance_mm(cell->read_frame("BASE_left").value(), corrected), 1e-3);
}

TEST_P(ExecutedKrl, APartAfterTheOtherNeverHasTheLastOnesPermission) {
    start(5);
    for (int part = 0; part < 3; ++part) {
        measure();
        ASSERT_FALSE(HasFatalFailure()) << part;
        EXPECT_EQ(link->permission(), Permission::none);
        EXPECT_FALSE(controller->released());
        ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
        EXPECT_TRUE(eventually(Permission::taken));
    }
    measure();
    ASSERT_TRUE(link->confirm(PartVerdict::refused, ""));
    EXPECT_EQ(link->permission(), Permission::none);
    EXPECT_EQ(controller->verdict(), PartVerdict::refused);
    measure();  // a part without a verdict is given up by the next
    measure();
}

TEST_P(ExecutedKrl, TheLinesCallIsToldOnce) {
    start(5);
    EXPECT_TRUE(is_silence(link->wait_start(milliseconds(50)).error()));
    controller->press_start(PartId("CAR-1"));
    auto called = link->wait_start(std::chrono::seconds(5));
    ASSERT_TRUE(called) << called.error().sentence();
    EXPECT_EQ(called->part_id, "CAR-1");
    EXPECT_TRUE(is_silence(link->wait_start(milliseconds(50)).error()));
    measure();
}

// A robot takes seconds where the answer's time-out is one.
TEST_P(ExecutedKrl, MovesThatTakeSecondsEndWhereTheyWereSent) {
    cell->set_mode(RobotMode::manual_reduced);
    start(1, 800);
    Pose to = two_spots()[0].entry;
    to.translation().z() += 200;
    const auto begun = Clock::now();
    auto moved = link->move_to(to);
    for (int i = 0; i < 20 && !moved; ++i) {  // the operator has just pressed the start key
        std::this_thread::sleep_for(milliseconds(50));
        moved = link->move_to(to);
    }
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_GT(Clock::now() - begun, milliseconds(1900)) << "100 mm/s";
    auto at = link->base_from_flange();
    ASSERT_TRUE(at) << at.error().sentence();
    EXPECT_LT(distance_mm(*at, to), 1e-2);
}

TEST_P(ExecutedKrl, WhereNoProgramWaitsMeasuringIsRefusedAndSaysWhy) {
    cell->set_mode(RobotMode::manual_reduced);  // SEAMWRIGHT is selected
    start(5, 300);
    auto started = link->start_measuring(two_spots());
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().sentence(),
                testing::AnyOf(HasSubstr("SEAMWRIGHT_SPOTS"), HasSubstr("another measuring program")));
}

// The program of a project whose first and third region are not measured: the paths of the others run in their own frames.
TEST_P(ExecutedKrl, RegionsThatAreNotMeasuredShiftNoNumber) {
    TemporaryFolder folder;
    ProgramRequest request;
    request.project = "door";
    request.moves = two_spots();
    request.frames = {{"left", "BASE_left", cell->read_frame("BASE_left").value(), 2}};
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    request.settings = {{"listen", "127.0.0.1"}, {"port", port}};
    const auto files = write_kuka_program(request);
    ASSERT_TRUE(files) << files.error().sentence();
    for (const char* call : {"SW_ACTIVATE(SW_BASE_left)\n", "SW_ACTIVATE(1)\n", "SW_ACTIVATE(3)\n"}) {
        SCOPED_TRACE(call);
        for (const ProgramFile& f : *files) {
            std::string text = f.text;
            if (f.name == "seamwright_spots.src") text.insert(text.find("END\n\n"), call);
            ASSERT_TRUE(write_text_file(folder.path() / f.name, text));
        }
        link.reset();
        controller.reset();
        start(5, 1000, port, folder.path().string());
        measure();
        ASSERT_FALSE(HasFatalFailure());
        const auto confirmed = link->confirm(PartVerdict::corrected, "");
        ASSERT_TRUE(confirmed) << confirmed.error().sentence();
        const auto& robot = dynamic_cast<const krl::KukaCell&>(*controller);
        const auto refuses = [&] {
            return testing::Value(robot.messages(),
                                  testing::Contains(HasSubstr("measures no region of this number")));
        };
        const bool own = call == std::string("SW_ACTIVATE(SW_BASE_left)\n");
        for (int i = 0; i < 100 && !own && !refuses(); ++i) std::this_thread::sleep_for(milliseconds(10));
        EXPECT_EQ(refuses(), !own);
        EXPECT_EQ(own ? eventually(Permission::taken) : link->permission() == Permission::taken, own);
    }
}

// Whatever tool and base the program moves with, the flange is the flange.
TEST_P(ExecutedKrl, TheFlangeIsToldWithoutToolAndBase) {
    start(5);
    for (const auto until = Clock::now() + std::chrono::seconds(3);
         Clock::now() < until && !link->base_from_flange();)
        std::this_thread::sleep_for(milliseconds(20));
    measure();
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    ASSERT_TRUE(eventually(Permission::taken));  // from here on $BASE is the region's frame
    std::this_thread::sleep_for(milliseconds(300));
    auto told = link->base_from_flange();
    ASSERT_TRUE(told) << told.error().sentence();
    EXPECT_LT(distance_mm(*told, cell->reported_flange().value()), 1e-2);
    EXPECT_LT(deg_from_rad(angle_rad(*told, cell->reported_flange().value())), 1e-3);
}

// The measuring program as delivered, then what an application leaves behind it: its own tool, or one that is
// fixed in the cell.
class FlangeAfterAnApplication : public ExecutedKrl {
  protected:
    void leave(const std::string& lines) {
        ProgramRequest request;
        request.project = "door";
        request.moves = two_spots();
        request.frames = {{"left", "BASE_left", cell->read_frame("BASE_left").value()}};
        const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
        request.settings = {{"listen", "127.0.0.1"}, {"port", port}};
        const auto files = write_kuka_program(request);
        ASSERT_TRUE(files) << files.error().sentence();
        for (const ProgramFile& f : *files) {
            std::string text = f.text;
            if (f.name == "seamwright_spots.src") {
                const auto end = text.find("SW_END_PART(20.0)\n");
                ASSERT_NE(end, std::string::npos);
                text.insert(end, lines);
            }
            ASSERT_TRUE(write_text_file(folder.path() / f.name, text));
        }
        start(5, 1000, port, folder.path().string());
    }
    TemporaryFolder folder;
};

TEST_P(FlangeAfterAnApplication, IsTheFlangeWithEveryToolAndBase) {
    leave(
        "$BASE={X 700.0,Y -300.0,Z 120.0,A 33.0,B -12.0,C 7.0}\n"
        "$TOOL={X 12.5,Y -40.0,Z 151.0,A 90.0,B 25.0,C -170.0}\nLIN_REL {Z 3.0}\nWAIT SEC 0\n");
    ASSERT_FALSE(HasFatalFailure());
    for (int part = 0; part < 2; ++part) {
        measure();
        ASSERT_FALSE(HasFatalFailure()) << part;
        std::this_thread::sleep_for(milliseconds(400));
        const auto told = link->base_from_flange();
        ASSERT_TRUE(told) << told.error().sentence();
        EXPECT_LT(distance_mm(*told, cell->reported_flange().value()), 1e-2);
        EXPECT_LT(deg_from_rad(angle_rad(*told, cell->reported_flange().value())), 1e-3);
        EXPECT_GT(distance_mm(*told, two_spots()[1].exit), 2) << "moved with its tool";
    }
}

TEST_P(FlangeAfterAnApplication, IsNotToldWithAFixedToolAndMeasuringGoesOn) {
    leave("$IPO_MODE=#TCP\nPTP $AXIS_ACT\nWAIT SEC 0\n");
    ASSERT_FALSE(HasFatalFailure());
    for (int part = 0; part < 2; ++part) {
        measure();
        ASSERT_FALSE(HasFatalFailure()) << part;
        std::this_thread::sleep_for(milliseconds(400));
        const auto told = link->base_from_flange();
        ASSERT_FALSE(told);
        EXPECT_THAT(told.error().sentence(), HasSubstr("fixed in the cell"));
    }
}

INSTANTIATE_TEST_SUITE_P(Drivers, FlangeAfterAnApplication, testing::Values("kuka-eki", "kuka-kvp"),
                         [](const auto& i) { return i.param == "kuka-eki" ? "eki" : "kvp"; });

// A robot that stands at its spots, turns over them or only passes them.
TEST_P(ExecutedKrl, EntrySpotAndExitMayBeOnePose) {
    auto moves = two_spots();
    for (MeasuringMove& m : moves) {
        m.entry = m.exit = m.trigger;
        m.via.clear();
    }
    for (const bool stops : {false, true}) {
        if (stops) moves.resize(1);  // and the robot stands there already
        for (MeasuringMove& m : moves) m.stop_at_trigger = stops;
        cell->store_program(moves);
        controller.reset();
        link.reset();
        start(5);
        for (int part = 0; part < 2; ++part) {
            auto started = link->start_measuring(moves);
            for (int i = 0; i < 40 && !started; ++i) {
                std::this_thread::sleep_for(milliseconds(50));
                started = link->start_measuring(moves);
            }
            ASSERT_TRUE(started) << started.error().sentence();
            for (const MeasuringMove& move : moves) {
                auto trigger = link->wait_trigger(std::chrono::seconds(5));
                ASSERT_TRUE(trigger) << trigger.error().sentence();
                EXPECT_EQ(trigger->spot_id, move.spot_id);
            }
            EXPECT_TRUE(link->confirm(PartVerdict::refused, ""));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Drivers, ExecutedKrl, testing::Values("kuka-eki", "kuka-kvp"),
                         [](const auto& i) { return i.param == "kuka-eki" ? "eki" : "kvp"; });

}  // namespace
}  // namespace seamwright
