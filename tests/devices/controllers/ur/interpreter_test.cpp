// The language as the script manual has it: what is refused at loading, what stops a running program, scopes
// and threads.

#include "devices/controllers/ur/script/interpreter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/simulated/cell.h"

namespace seamwright::urscript {
namespace {

using testing::HasSubstr;

std::shared_ptr<SimulatedCell> script_cell() {
    static const auto shared = SimulatedCell::open({{"optics", {{"width", 64}, {"height", 64}}}}).value();
    return shared;
}

// A program in its controller.
struct ScriptRun {
    ScriptRobot robot{script_cell(), {}, make_pose(rotation_exp({3, 0, 0}), {500, 0, 500})};
    std::optional<Interpreter> interpreter;

    explicit ScriptRun(const std::string& text, InterpreterSettings settings = {}) {
        script_cell()->follow(make_pose(rotation_exp({3, 0, 0}), {500, 0, 500}));
        auto program = compile({{"test.script", text}});
        EXPECT_TRUE(program) << program.error().sentence();
        if (program) interpreter.emplace(std::move(*program), robot, settings);
    }
    void cycles(int count) {
        for (int i = 0; i < count && interpreter && interpreter->running(); ++i) {
            robot.begin_cycle();
            interpreter->cycle();
            robot.end_cycle();
        }
    }
    std::string error() const {
        return interpreter->error() ? interpreter->error()->sentence() : std::string();
    }
    std::string value(const std::string& name) const {
        const Value* v = interpreter->global(name);
        return v ? text_of(*v) : "none";
    }
};

std::string load_error(const std::string& text) {
    const auto program = compile({{"a.script", "x = 1\n"}, {"b.script", text}});
    return program ? std::string() : program.error().sentence();
}

TEST(UrScript, LoadingRefusesWhatTheControllerRefuses) {
    const std::pair<const char*, const char*> cases[] = {
        {"y = z\n", "\"z\" is used before it has a value"},
        {"def f():\n  return later\nend\nlater = 1\n", "\"later\" is used before it has a value"},
        {"f()\ndef f():\nend\n", "there is no function f() above this line"},
        {"def f():\n  local a = 1\nend\ny = a\n", "\"a\" is used before it has a value"},
        {"def while():\nend\n", "\"while\" is no name of a function"},
        {"def end():\nend\n", "\"end\" is no name of a function"},
        {"def sync():\nend\n", "\"sync\" is a function of the language"},
        {"movej = 2\n", "\"movej\" is a function of the language"},
        {"def f():\nend\ndef f():\nend\n", "\"f\" is a function already"},
        {"def f():\nend\nf = 3\n", "\"f\" is a function already"},
        {"def x():\nend\n", "\"x\" is a variable already"},
        {"thread t(a):\nend\n", "a thread takes no parameters"},
        {"thread t():\nend\nt()\n", "t() is a thread: run it"},
        {"def f():\nend\ny = run f()\n", "\"f\" is no thread"},
        {"def f(a):\nend\nf()\n", "f() takes 1 arguments, not 0"},
        {"sleep()\n", "sleep() needs \"t\""},
        {"movel(p[0,0,0,0,0,0], blend=1)\n", "movel() has no argument \"blend\""},
        {"movec(x, x)\n", "the interpreter does not have movec()"},
        {"y = 1 < x < 3\n", "no chains of comparisons"},
        {"y = [1, 2\n", "\",\" is missing before"},
        {"y = []\n", "no empty list"},
        {"y = p[1, 2, 3]\n", "a pose has six numbers"},
        {"if x == 1:\n  y = 2\n", "a block has no end"},
        {"end\n", "closes no block"},
        {"while True\n  sync()\nend\n", "\":\" is missing"},
        {"break\n", "break stands outside a loop"},
        {"y = 3000000000\n", "3000000000 is beyond 32 bits"},
        {"y = \"abc\n", "a string has no end"},
        {"y = 2 ** 3\n", "\"*\" is no value"},
        {"y = x; z = 1\n", "\";\" is no sign of URScript"},
        {"x += 1\n", "\"x\" alone is no statement"},
        {"for i in y:\nend\n", "alone is no statement"}};
    for (const auto& [text, words] : cases) {
        EXPECT_THAT(load_error(text), HasSubstr(words)) << text;
        EXPECT_THAT(load_error(text), HasSubstr("b.script line")) << text;
    }
    EXPECT_THAT(load_error("y = 1\n\ny = z\n"), HasSubstr("b.script line 3"));
}

TEST(UrScript, AFaultStopsTheProgramWithItsLine) {
    const std::pair<const char*, const char*> cases[] = {
        {"y = 1\ny = 2.5\n", "y is a whole number and cannot become a number"},
        {"y = [1, 2]\ny[2] = 3\n", "index 2 is beyond the list of 2"},
        {"y = [1, 2]\ny[0] = 1.5\n", "y holds a whole number and cannot hold a number"},
        {"y = [1, 2]\ny = [1, 2, 3]\n", "is a list of 2 and cannot become one of 3"},
        {"y = [1, True]\n", "a list holds a truth value beside a whole number"},
        {"y = 2147483647\ny = y + 1\n", "beyond 32 bits"},
        {"y = 7 / 2\n", "leaves a rest"},
        {"y = 1 / 0\n", "division by zero"},
        {"if 1:\n  sync()\nend\n", "is no condition"},
        {"y = \"a\" == 1\n", "is compared with"},
        {"y = \"abc\"\nz = y[0]\n", "has no elements"},
        {"while True:\n  y = 1\nend\n", "a loop uses no time"},
        {"enter_critical\nsync()\nexit_critical\n", "in a critical section"},
        {"exit_critical\n", "outside a critical section"},
        {"def f():\n  sync()\nend\ny = f()\n", "nothing is assigned to y"},
        {"def f(a):\n  f(a)\nend\n", ""},
        {"y = str_sub(\"abc\", 3, 1)\n", "str_sub() at 3 of 3 signs"},
        {"y = read_input_integer_register(48)\n", "48 is beyond 0 to 47"},
        {"write_output_integer_register(1, 1.5)\n", "argument 2 is a number and not a whole number"},
        {"movel(p[0.5,0,0.5,3,0,0], v=9)\n", "at 9 m/s"},
        {"movel(p[0.5,0,0.4,3,0,0], r=0.2)\n", "blends overlap"},
        {"movel(p[99,0,0.4,3,0,0])\n", "m away"},
        {"thread t():\n  movel(p[0.5,0.1,0.5,3,0,0])\nend\nh = run t()\nsync()\nsync()\n"
         "movel(p[0.5,0,0.4,3,0,0])\n",
         "another thread moves the robot already"},
        {"thread t():\n  while True:\n    sync()\n  end\nend\ni = 0\nwhile i < 20:\n  h = run t()\n  i = i + "
         "1\nend\n",
         "more than 16 threads"}};
    for (const auto& [text, words] : cases) {
        ScriptRun run(text);
        run.cycles(2000);
        EXPECT_FALSE(run.interpreter->running()) << text;
        EXPECT_THAT(run.error(), HasSubstr(words)) << text;
        EXPECT_THAT(run.error(), HasSubstr(*words == 0 ? "" : "test.script line")) << text;
    }
}

TEST(UrScript, FreeNamesAreTheGlobalsWhereThereIsOne) {
    ScriptRun run(
        "a = 1\nglobal b = 1\nc = 1\n"
        "def f():\n  a = 2\n  local b = 2\n  global d = 7\n  e = 5\n  b = 3\n  return e + b\nend\n"
        "g = f()\nlocal h = 4\ndef k():\n  h = 6\nend\nk()\n");
    run.cycles(10);
    EXPECT_EQ(run.error(), "");
    EXPECT_EQ(run.value("a"), "2");
    EXPECT_EQ(run.value("b"), "1");
    EXPECT_EQ(run.value("d"), "7");
    EXPECT_EQ(run.value("g"), "8");
    EXPECT_EQ(run.value("h"), "6") << "on the first level local is global";
}

TEST(UrScript, ValuesAreCopiedAndReckonedAsThePagesSay) {
    ScriptRun run(
        "l = [1, 2, 3]\nm = l\nm[0] = 9\nq = p[1, 2, 3, 0, 0, 0]\nq[2] = 8\n"
        "s = str_cat(\"ab\", 3)\nt = str_find(\"seam\", \"am\")\nu = str_sub(s, 1, 1)\n"
        "r = -7 % 4\nn = not (1 == 2)\nx = (3 > 2) and (1 >= 1)\n"
        "d = pose_dist(pose_trans(p[1,0,0,0,0,1.5707963267948966], p[1,0,0,0,0,0]), p[1,1,0,0,0,0])\n"
        "i = pose_trans(q, pose_inv(q))\nz = 4 / 2\ny = -2147483648\n");
    run.cycles(10);
    EXPECT_EQ(run.error(), "");
    EXPECT_EQ(run.value("l"), "[1, 2, 3]");
    EXPECT_EQ(run.value("m"), "[9, 2, 3]");
    EXPECT_EQ(run.value("s"), "ab3");
    EXPECT_EQ(run.value("t"), "2");
    EXPECT_EQ(run.value("u"), "b");
    EXPECT_EQ(run.value("n"), "True");
    EXPECT_EQ(run.value("x"), "True");
    EXPECT_EQ(run.value("z"), "2");
    EXPECT_EQ(run.value("y"), "-2147483648");
    EXPECT_NEAR(std::get<double>(run.interpreter->global("d")->is), 0, 1e-12);
    EXPECT_EQ(std::get<PoseValue>(run.interpreter->global("q")->is)[2], 8);
}

TEST(UrScript, ThreadsShareTheCyclesAndAreInterruptedAnywhere) {
    const std::string counting =
        "n = 0\nthread t():\n  local i = 0\n  while i < 50:\n    %\n    i = i + 1\n    sync()\n  end\nend\n"
        "a = run t()\nb = run t()\njoin a\njoin b\nready = True\nwhile True:\n  sync()\nend\n";
    const auto with = [&](const std::string& body) {
        std::string text = counting;
        return text.replace(text.find('%'), 1, body);
    };
    InterpreterSettings torn{7, 1, 6};
    ScriptRun bare(with("n = n + 1"), torn);
    bare.cycles(5000);
    EXPECT_EQ(bare.error(), "");
    EXPECT_EQ(bare.value("ready"), "True");
    EXPECT_NE(bare.value("n"), "100") << "two threads that change one variable lose counts";
    ScriptRun guarded(with("enter_critical\n    n = n + 1\n    exit_critical"), torn);
    guarded.cycles(5000);
    EXPECT_EQ(guarded.error(), "");
    EXPECT_EQ(guarded.value("n"), "100");
}

TEST(UrScript, KilledThreadsTakeTheirChildrenAlong) {
    ScriptRun run(
        "n = 0\nthread child():\n  while True:\n    n = n + 1\n    sync()\n  end\nend\n"
        "thread parent():\n  c = run child()\n  while True:\n    sync()\n  end\nend\n"
        "h = run parent()\nsleep(0.1)\nkill h\nm = n\nsleep(0.1)\nstill = n == m\nwhile True:\n  "
        "sync()\nend\n");
    run.cycles(200);
    EXPECT_EQ(run.error(), "");
    EXPECT_EQ(run.value("still"), "True");
    EXPECT_NE(run.value("m"), "0");
    EXPECT_EQ(run.interpreter->threads(), 1U);
}

TEST(UrScript, MovesTakeTheirTimeAndBlendsKeepTheSpeed) {
    ScriptRun run(
        "movel(p[0.5, 0.1, 0.5, 3, 0, 0], a=1.2, v=0.1)\nfirst = True\n"
        "movel(p[0.5, 0.15, 0.5, 3, 0, 0], a=1.2, v=0.1, r=0.01)\nmovel(p[0.5, 0.2, 0.5, 3, 0, 0], a=1.2, "
        "v=0.1)\n"
        "halt\n");
    int cycles = 0;
    double slowest = 1e9;
    while (run.interpreter->running() && cycles < 5000) {
        run.cycles(1);
        ++cycles;
        const double y = 1000 * run.robot.tcp_pose()[1];
        if (y > 140 && y < 160) slowest = std::min(slowest, run.robot.velocity_mm_s().norm());
    }
    EXPECT_EQ(run.error(), "");
    EXPECT_NEAR(cycles * 0.002, 2.0 + 2 * 0.1 / 1.2, 0.05)
        << "200 mm at 100 mm/s, speeding up and down twice";
    EXPECT_NEAR(slowest, 100, 1) << "the corner is passed at speed";
    EXPECT_NEAR(run.robot.tcp_pose()[1], 0.2, 1e-9);
}

TEST(UrScript, PosesAreOfTheToolThatIsSet) {
    ScriptRun run(
        "set_tcp(p[0, 0, 0.1, 0, 0, 0])\nmovel(p[0.5, 0.02, 0.4, 3, 0, 0], v=1.0)\nat = "
        "get_actual_tcp_pose()\n");
    run.cycles(2000);
    EXPECT_EQ(run.error(), "");
    EXPECT_NEAR(std::get<PoseValue>(run.interpreter->global("at")->is)[2], 0.4, 1e-9);
    EXPECT_NEAR(distance_mm(run.robot.base_from_flange(),
                            pose_of({0.5, 0.02, 0.4, 3, 0, 0}) * pose_of({0, 0, -0.1, 0, 0, 0})),
                0, 1e-6);
}

}  // namespace
}  // namespace seamwright::urscript
