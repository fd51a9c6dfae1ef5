// The files that are delivered, executed.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/controllers/ur/script/interpreter.h"
#include "devices/controllers/ur/script/lexer.h"
#include "devices/simulated/cell.h"
#include "devices/ur/module.h"
#include "devices/ur/program.h"

namespace seamwright::urscript {
namespace {

using testing::HasSubstr;

std::shared_ptr<SimulatedCell> delivered_cell() {
    static const auto shared = SimulatedCell::open({{"optics", {{"width", 64}, {"height", 64}}}}).value();
    return shared;
}

MeasuringMove spot(const std::string& id, double y_mm) {
    MeasuringMove m;
    m.spot_id = id;
    m.entry = m.trigger = m.exit = make_pose(rotation_exp({3, 0.1, 0.2}), {600, y_mm, 500});
    m.entry.translation().x() -= 20;
    m.exit.translation().x() += 20;
    m.speed_mm_s = 100;
    return m;
}

struct DeliveredRun {
    std::vector<Source> sources;
    std::optional<ScriptRobot> robot;
    std::optional<Interpreter> interpreter;
    std::int32_t request_number = 1000;
    int cycle = 0;

    DeliveredRun(const ProgramRequest& request, const std::string& application, const Pose& start) {
        auto files = write_ur_program(request);
        EXPECT_TRUE(files) << files.error().sentence();
        for (const ProgramFile& file : *files) sources.push_back({file.name, file.text});
        sources.push_back({"application", application});
        auto program = compile(sources);
        EXPECT_TRUE(program) << program.error().sentence();
        delivered_cell()->follow(start);
        robot.emplace(delivered_cell(), ScriptRobotSettings{}, start);
        if (program) interpreter.emplace(std::move(*program), *robot, InterpreterSettings{3, 5, 60});
    }
    void cycles(int count) {
        for (int i = 0; i < count && interpreter->running(); ++i, ++cycle) {
            robot->inputs.ints[24 + ur::kBeat] = beats ? cycle / 10 : robot->inputs.ints[24 + ur::kBeat];
            robot->begin_cycle();
            interpreter->cycle();
            robot->end_cycle();
        }
    }
    // The status that the module answers; -100 where none comes.
    int ask(ur::Command command, std::int32_t argument = 0, std::int32_t high = 0, std::int32_t low = 0) {
        auto& in = robot->inputs.ints;
        in[24 + ur::kNumber] = ++request_number;
        in[24 + ur::kCommand] = static_cast<std::int32_t>(command);
        in[24 + ur::kArgument] = argument;
        in[24 + ur::kHigh] = high;
        in[24 + ur::kLow] = low;
        for (int i = 0; i < 2000; ++i) {
            cycles(1);
            if (robot->outputs.ints[24 + ur::kAnswered] == request_number)
                return robot->outputs.ints[24 + ur::kStatus];
        }
        return -100;
    }
    int measure(const ProgramRequest& request) {
        const auto [high, low] = ur::signature_numbers(program_signature(request.moves));
        return ask(ur::Command::measure, 0, high, low);
    }
    ur::State state() const { return ur::state_from(robot->outputs.ints[24 + ur::kState]).value(); }
    bool beats = true;
};

ProgramRequest delivered_request() {
    ProgramRequest r;
    r.project = "door";
    r.moves = {spot("S1", 0), spot("S2", 60)};
    r.moves[1].stop_at_trigger = true;
    r.frames = {{"left", "BASE_left", make_pose(rotation_exp({0.1, 0.2, 0.3}), {900, -450, 500})}};
    return r;
}

const char* const kApplication =
    "taken = 0\nwhile True:\n  sw_measure()\n  if sw_take():\n    taken = taken + 1\n    f = sw_activate(1)\n"
    "    sleep(1.0)\n    sw_finish()\n  end\nend\n";

TEST(UrDelivered, ThePermissionDiesWithTheClientUnlessItIsTaken) {
    const ProgramRequest r = delivered_request();
    const std::string waiting =
        "go = False\nthread listen():\n  while True:\n    if read_input_boolean_register(64):\n      go = "
        "True\n    "
        "end\n    sync()\n  end\nend\nh = run listen()\nwhile True:\n  sw_measure()\n  while not go:\n    "
        "sync()\n  end\n"
        "  if sw_take():\n    sleep(3.0)\n    sw_finish()\n  end\n  go = False\nend\n";
    for (const bool take : {false, true}) {
        SCOPED_TRACE(take);
        DeliveredRun run(r, waiting, r.moves[0].entry);
        run.cycles(50);
        ASSERT_EQ(run.measure(r), 0);
        EXPECT_EQ(run.ask(ur::Command::verdict, 1), 3) << "not all spots are passed";
        run.cycles(4000);
        EXPECT_EQ(run.robot->outputs.ints[24 + ur::kFired], 2);
        ASSERT_EQ(run.ask(ur::Command::verdict, 1), 0);
        run.cycles(2000);
        EXPECT_EQ(run.state().permitted, ur::Permitted::given) << "held while the client lives";
        if (take) {
            run.robot->inputs.bits[64] = true;
            run.cycles(50);
            EXPECT_EQ(run.state().permitted, ur::Permitted::taken);
            EXPECT_EQ(run.ask(ur::Command::verdict, 3), 4) << "a path runs";
            EXPECT_EQ(run.ask(ur::Command::write, ur::frame_number("BASE_left")), 4);
        }
        run.beats = false;
        run.cycles(700);
        EXPECT_EQ(run.state().permitted, take ? ur::Permitted::taken : ur::Permitted::no);
        if (!take) {
            run.robot->inputs.bits[64] = true;
            run.cycles(1000);
            EXPECT_NE(run.state().permitted, ur::Permitted::taken) << "the application stands";
        }
        EXPECT_FALSE(run.interpreter->error()) << run.interpreter->error()->sentence();
    }
}

TEST(UrDelivered, AnotherConnectionDoesNotInheritThePermission) {
    const ProgramRequest r = delivered_request();
    DeliveredRun run(r, "while True:\n  sync()\nend\n", r.moves[0].entry);
    run.cycles(50);
    ASSERT_EQ(run.ask(ur::Command::verdict, 1), 0);
    EXPECT_EQ(run.state().permitted, ur::Permitted::given);
    run.robot->inputs.ints[24 + ur::kSession] = 4711;
    run.cycles(20);
    EXPECT_EQ(run.state().permitted, ur::Permitted::no);
}

// What stands in the registers when a paused program goes on, or when its sender has died, is not done.
TEST(UrDelivered, ARequestWhoseSenderIsGoneIsNotDone) {
    const ProgramRequest r = delivered_request();
    for (const bool another_connects : {false, true}) {
        SCOPED_TRACE(another_connects);
        const Pose start = r.moves[0].entry;
        DeliveredRun run(r, "sw_teach()\n", start);
        run.cycles(50);
        Pose far = start;
        far.translation().z() += 50;
        const auto pose = ur::ur_pose(far);
        for (std::size_t i = 0; i < 6; ++i) run.robot->inputs.reals[24 + i] = pose[i];
        run.beats = false;
        EXPECT_EQ(run.ask(ur::Command::move), -100);
        if (another_connects) {
            run.robot->inputs.ints[24 + ur::kSession] = 4711;
            run.beats = true;
        }
        run.cycles(1000);
        EXPECT_LT(distance_mm(run.robot->base_from_flange(), start), 1e-6);
        run.beats = true;
        EXPECT_EQ(run.ask(ur::Command::move), 0) << "who is there is obeyed";
        EXPECT_LT(distance_mm(run.robot->base_from_flange(), far), 1e-6);
        EXPECT_FALSE(run.interpreter->error()) << run.interpreter->error()->sentence();
    }
}

// Whatever moment they come at, the program's taking and the client's loss or its taking back end in one of
// two: taken and running, or standing.
TEST(UrDelivered, TakingAndTakingBackDoNotRace) {
    const ProgramRequest r = delivered_request();
    int ran = 0, stood = 0;
    for (int delay = 0; delay < 60; ++delay) {
        DeliveredRun run(
            r,
            "ran = 0\nwhile sw_permission == 0:\n  sync()\nend\nif sw_take():\n  f = sw_activate(1)\n  ran = "
            "1\n  sleep(10)\nelse:\n  ran = 2\nend\nwhile True:\n  sync()\nend\n",
            r.moves[0].entry);
        run.cycles(50);
        ASSERT_EQ(run.ask(ur::Command::verdict, 1), 0);
        run.cycles(delay / 4);
        const int back = run.ask(ur::Command::verdict, 3);
        run.cycles(100);
        const Value* value = run.interpreter->global("ran");
        ASSERT_TRUE(value);
        const bool runs = *value == Value{std::int32_t{1}};
        EXPECT_EQ(back, runs ? 4 : 0) << "the client is told what came of it";
        EXPECT_EQ(run.state().permitted == ur::Permitted::taken, runs);
        (runs ? ran : stood) += 1;
        EXPECT_FALSE(run.interpreter->error());
    }
    EXPECT_GT(ran, 0);
}

TEST(UrDelivered, AStartIsRefusedWhereNoProgramWaitsAndRepeatedWhereNoVerdictCame) {
    const ProgramRequest r = delivered_request();
    DeliveredRun run(r, kApplication, r.moves[0].entry);
    run.cycles(50);
    ASSERT_EQ(run.measure(r), 0);
    EXPECT_EQ(run.measure(r), 3);
    run.cycles(4000);
    EXPECT_EQ(run.state().phase, ur::Phase::waits_for_verdict);
    ASSERT_EQ(run.measure(r), 0) << "a desk that came back measures the part again";
    run.cycles(4000);
    ASSERT_EQ(run.ask(ur::Command::verdict, 1), 0);
    run.cycles(100);
    EXPECT_EQ(run.state().permitted, ur::Permitted::taken);
    EXPECT_EQ(run.measure(r), 6) << "the path runs";
    run.cycles(1000);
    EXPECT_EQ(run.state().permitted, ur::Permitted::used_up);
    EXPECT_EQ(run.state().phase, ur::Phase::waits_for_start);
    ASSERT_EQ(run.measure(r), 0);
    EXPECT_EQ(run.state().permitted, ur::Permitted::no);
    EXPECT_FALSE(run.interpreter->error());
}

TEST(UrDelivered, WithoutPermissionTheProgramHalts) {
    const ProgramRequest r = delivered_request();
    DeliveredRun run(r, "sync()\nf = sw_activate(1)\nran = True\n", r.moves[0].entry);
    run.cycles(200);
    ASSERT_TRUE(run.robot->popup);
    EXPECT_THAT(*run.robot->popup, HasSubstr("has not released this part"));
    run.robot->popup.reset();  // somebody closes it
    run.cycles(10);
    EXPECT_FALSE(run.interpreter->running());
    EXPECT_FALSE(run.interpreter->error());
    EXPECT_FALSE(run.interpreter->global("ran"));
}

// The first region's spots are disabled: nobody's path runs in another's frame.
TEST(UrDelivered, RegionsThatAreNotMeasuredShiftNoNumber) {
    ProgramRequest r = delivered_request();
    r.frames[0].number = 2;
    for (const char* number : {"sw_BASE_left", "2", "1", "3", "0"}) {
        SCOPED_TRACE(number);
        const bool own = number == std::string("sw_BASE_left") || number == std::string("2");
        DeliveredRun run(r,
                         fmt::format("while sw_permission == 0:\n  sync()\nend\nf = sw_activate({})\nx = "
                                     "f[0]\nwhile True:\n  sync()\nend\n",
                                     number),
                         r.moves[0].entry);
        run.cycles(50);
        ASSERT_EQ(run.ask(ur::Command::verdict, 1), 0);
        run.cycles(50);
        EXPECT_EQ(run.robot->popup.has_value(), !own);
        const Value* x = run.interpreter->global("x");
        ASSERT_EQ(x != nullptr, own);
        if (own) {
            EXPECT_EQ(*x, Value{0.9});
        }
        EXPECT_FALSE(run.interpreter->error()) << run.interpreter->error()->sentence();
    }
}

TEST(UrDelivered, TheWayLeadsOverThePointsBetween) {
    ProgramRequest r = delivered_request();
    const Pose start = make_pose(rotation_exp({3, 0.1, 0.2}), {550, -50, 550});
    r.moves[0].via = {make_pose(rotation_exp({3, 0.1, 0.2}), {560, -20, 620})};
    r.moves[1].via = {make_pose(rotation_exp({3, 0.1, 0.2}), {650, 20, 640}),
                      make_pose(rotation_exp({3, 0.1, 0.2}), {560, 50, 630})};
    DeliveredRun run(r, kApplication, start);
    run.cycles(50);
    ASSERT_EQ(run.measure(r), 0);
    std::vector<Pose> wanted = {r.moves[0].via[0], r.moves[0].entry,   r.moves[0].trigger,
                                r.moves[0].exit,   r.moves[1].via[0],  r.moves[1].via[1],
                                r.moves[1].entry,  r.moves[1].trigger, r.moves[1].exit};
    std::size_t next = 0;
    std::vector<double> speeds;
    for (int i = 0; i < 8000 && next < wanted.size(); ++i) {
        run.cycles(1);
        if (distance_mm(run.robot->base_from_flange(), wanted[next]) > 1) continue;
        speeds.push_back(run.robot->velocity_mm_s().norm());
        ++next;
    }
    ASSERT_EQ(next, wanted.size()) << "in this order";
    EXPECT_GT(speeds[4], 200) << "passed without a stop";
    EXPECT_GT(speeds[5], 200);
    EXPECT_FALSE(run.interpreter->error()) << run.interpreter->error()->sentence();
}

TEST(UrDelivered, HostileNamesStayComments) {
    ProgramRequest r = delivered_request();
    for (const char* name :
         {"x\nhalt", "\" end", "@PASSES@", "@MODULE@ @FIRST@", "end", "#", "\xc3\xa4", "while True:\n"}) {
        r.project = name;
        r.moves[0].spot_id = name;
        r.frames[0].name = r.frames[0].region_id = name;
        DeliveredRun run(r, kApplication, r.moves[0].entry);
        run.cycles(50);
        ASSERT_EQ(run.measure(r), 0) << name;
        run.cycles(4000);
        EXPECT_EQ(run.robot->outputs.ints[24 + ur::kFired], 2) << name;
    }
}

// A path bears the name that a person gives it.
TEST(UrDelivered, NoPathIsCalledAsSomethingOfTheLanguage) {
    PathProgramRequest path;
    path.frame_from_tool = {Pose::Identity()};
    std::vector<std::string> names = {"while",  "end",       "return", "True", "thread",
                                      "global", "sw_frames", "sec",    "P"};
    for (const std::string_view function : functions_of_the_language()) names.emplace_back(function);
    for (const std::string& name : names) {
        path.name = name;
        EXPECT_FALSE(write_ur_path(path)) << name;
    }
    for (const char* name : {"v", "bead_1", "seamwright_path"}) {
        path.name = name;
        const auto files = write_ur_path(path);
        ASSERT_TRUE(files) << files.error().sentence();
        const auto program = compile({{"path", files->front().text}, {"call", path.name + "()\n"}});
        EXPECT_TRUE(program) << name << ": " << program.error().sentence();
    }
}

TEST(UrDelivered, AWrittenPathIsDriven) {
    PathProgramRequest path;
    path.comment = "bead\nhalt";
    path.base_from_frame = make_pose(rotation_exp({0.1, 0.2, 0.3}), {500, 100, 400});
    for (int i = 0; i < 40; ++i)
        path.frame_from_tool.push_back(
            make_pose(rotation_exp({3, 0, 0.01 * i}), {5.0 * i, 10 * std::sin(0.3 * i), 0}));
    path.frame_from_tool.push_back(path.frame_from_tool.back());  // twice the same point
    path.rounding_mm = 2;
    auto files = write_ur_path(path);
    ASSERT_TRUE(files) << files.error().sentence();
    auto program =
        compile({{files->front().name, files->front().text},
                 {"call", "set_tcp(p[0, 0, 0.1, 0, 0, 0])\n" + path.name + "()\ndone = True\nsync()\n"}});
    ASSERT_TRUE(program) << program.error().sentence();
    const Pose tool = pose_of({0, 0, 0.1, 0, 0, 0});
    const Pose start = path.base_from_frame * path.frame_from_tool[0] * tool.inverse();
    delivered_cell()->follow(start);
    ScriptRobot robot(delivered_cell(), {}, start);
    Interpreter interpreter(std::move(*program), robot);
    std::vector<double> nearest(path.frame_from_tool.size(), 1e9);
    int cycles = 0;
    for (; interpreter.running() && cycles < 20000; ++cycles) {
        robot.begin_cycle();
        for (std::size_t i = 0; i < nearest.size(); ++i)
            nearest[i] = std::min(nearest[i], distance_mm(robot.base_from_flange() * tool,
                                                          path.base_from_frame * path.frame_from_tool[i]));
        interpreter.cycle();
        robot.end_cycle();
    }
    EXPECT_FALSE(interpreter.error()) << interpreter.error()->sentence();
    for (const double d : nearest) EXPECT_LT(d, 0.5);
    EXPECT_LT(cycles * 0.002, 4.5) << "230 mm at 100 mm/s: the corners are not stops";
}

}  // namespace
}  // namespace seamwright::urscript
