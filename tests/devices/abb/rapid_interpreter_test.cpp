// The interpreter against RAPID as the manuals have it: what a controller does not load is refused with file
// and line, and what it executes is executed as there. Then the delivered and the written modules themselves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abb_resources.h"
#include "core/geometry/pose.h"
#include "devices/abb/program.h"
#include "devices/controllers/abb/controller.h"
#include "devices/controllers/abb/rapid/rapid_language.h"
#include "devices/controllers/abb/rapid/rapid_system.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

std::string loads(const std::string& data, const std::string& routines = "") {
    auto ok = check_rapid(
        {{"M.mod", "MODULE M\n" + data + "\nPROC main()\nENDPROC\n" + routines + "\nENDMODULE\n"}});
    return ok ? "" : ok.error().what.english();
}
std::string body(const std::string& text, const std::string& data = "") {
    return loads(data, "PROC p()\n" + text + "\nENDPROC");
}

TEST(RapidLoader, RefusesReservedWordsInAnyCase) {
    EXPECT_THAT(loads("VAR robtarget to;"),
                HasSubstr("M.mod, line 2: syntax error at to: to is a reserved word"));
    for (const char* word : {"TO", "While",
                             "END"
                             "IF",
                             "from", "Step", "task", "Test", "with", "xor", "undo", "MOD"})
        EXPECT_THAT(loads("VAR num " + std::string(word) + ";"), HasSubstr("reserved word")) << word;
    EXPECT_EQ(loads("VAR num end;"), "") << "END alone is none of RAPID's";
    EXPECT_THAT(loads("", "PROC return()\nENDPROC"), HasSubstr("reserved word"));
}

TEST(RapidLoader, RefusesNamesOfTheSystemAndTwoOfOneName) {
    EXPECT_THAT(loads("VAR num robtarget;"), HasSubstr("belongs to the system"));
    EXPECT_THAT(loads("VAR num tool0;"), HasSubstr("belongs to the system"));
    EXPECT_THAT(body("VAR num MoveL;"), HasSubstr("belongs to the system"));
    EXPECT_THAT(loads("VAR num a;\nLOCAL VAR bool A;"), HasSubstr("declared twice"));
    EXPECT_THAT(loads("VAR num a;", "PROC a()\nENDPROC"), HasSubstr("declared twice"));
    EXPECT_THAT(loads("VAR num m;"), HasSubstr("declared twice")) << "the module is called so";
    EXPECT_FALSE(check_rapid(
        {{"A.mod", "MODULE A\nVAR num x;\nENDMODULE"}, {"B.mod", "MODULE B\nVAR num X;\nENDMODULE"}}));
    EXPECT_TRUE(check_rapid(
        {{"A.mod", "MODULE A\nLOCAL VAR num x;\nENDMODULE"}, {"B.mod", "MODULE B\nVAR num X;\nENDMODULE"}}));
}

TEST(RapidLoader, KnowsTheLimits) {
    EXPECT_EQ(loads("VAR num " + std::string(32, 'a') + ";"), "");
    EXPECT_THAT(loads("VAR num " + std::string(33, 'a') + ";"), HasSubstr("more than 32"));
    EXPECT_EQ(loads("CONST string s:=\"" + std::string(80, 'x') + "\";"), "");
    EXPECT_THAT(loads("CONST string s:=\"" + std::string(81, 'x') + "\";"), HasSubstr("holds 80 characters"));
    EXPECT_EQ(loads("CONST string s:=\"" + std::string(79, 'x') + "\\0A\";"), "")
        << "a code is one character";
    EXPECT_THAT(loads("CONST string s:=\"a\\b\";"), HasSubstr("two hexadecimal digits"));
}

TEST(RapidLoader, ChecksDeclarations) {
    EXPECT_THAT(loads("CONST num a;"), HasSubstr("wants a value"));
    EXPECT_THAT(loads("LOCAL PERS num a;"), HasSubstr("wants an initial value"));
    EXPECT_EQ(loads("PERS num a;"), "");
    EXPECT_THAT(loads("CONST num b:=1;\nPERS num a:=b;"), HasSubstr("is a literal"));
    EXPECT_THAT(loads("PERS num a{3}:=[1,2];"), HasSubstr("2 elements stand where 3 are wanted"));
    EXPECT_THAT(loads("PERS pose a:=[[1,2,3],[1,0,0]];"), HasSubstr("3 components stand where orient has 4"));
    EXPECT_THAT(loads("PERS socketdev a;"), HasSubstr("VAR only"));
    EXPECT_THAT(loads("VAR string a:=1;"), HasSubstr("string is wanted, this is num"));
    EXPECT_THAT(body("PERS num a:=1;"), HasSubstr("not in a routine"));
    EXPECT_THAT(body("TPWrite \"a\";\nVAR num a;"), HasSubstr("before its instructions"));
    EXPECT_THAT(loads("", "PROC p()\nENDPROC\nVAR num late;"), HasSubstr("before the routines"));
}

TEST(RapidLoader, ChecksArguments) {
    const std::string data =
        "PERS tooldata t:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"
        "CONST robtarget q:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];\n"
        "VAR tooldata v;\nVAR bool late;\nPERS num n:=0;\nVAR triggdata trigger;";
    EXPECT_EQ(body("MoveL q,v100,fine,t\\WObj:=wobj0;", data), "");
    EXPECT_THAT(body("MoveL q,v100,fine,v\\WObj:=wobj0;", data),
                HasSubstr("argument tool of MoveL: a PERS is wanted"));
    EXPECT_THAT(body("MoveL q,v100,fine;", data), HasSubstr("the argument tool of MoveL is missing"));
    EXPECT_THAT(body("MoveL q,100,fine,t;", data), HasSubstr("speeddata is wanted, this is num"));
    EXPECT_THAT(body("MoveL q v100,fine,t;", data), HasSubstr(", is missing"));
    EXPECT_THAT(body("MoveL q,v100,fine,t\\Wobject:=wobj0;", data), HasSubstr("no argument \\wobject"));
    EXPECT_THAT(body("ConfL\\On\\Off;", data), HasSubstr("exclude each other"));
    EXPECT_THAT(body("TriggIO trigger,0\\DOp:=no_signal,1;", data), HasSubstr("there is no data no_signal"));
    EXPECT_THAT(body("n:=TRUE;", data), HasSubstr("num is wanted, this is bool"));
    EXPECT_THAT(body("q.trans.x:=1;", data), HasSubstr("neither VAR nor PERS"));
    EXPECT_THAT(body("IF n THEN\nENDIF", data), HasSubstr("bool is wanted"));
    EXPECT_THAT(body("late:=late AND NOT late;", data), HasSubstr("syntax error"))
        << "NOT begins an expression";
    EXPECT_EQ(body("late:=late AND (NOT late);", data), "");
    EXPECT_THAT(body("Incr n;", data), HasSubstr("there is no routine incr"))
        << "what it does not know is an error";
    EXPECT_THAT(body("RETRY;", data), HasSubstr("error handler only"));
}

TEST(RapidLoader, TasksShareAPersistentOfOneType) {
    const auto both = [](const std::string& a, const std::string& b) {
        auto ok = check_rapid({{"A.mod", "MODULE A\n" + a + "\nENDMODULE"}},
                              {{"B.mod", "MODULE B\n" + b + "\nENDMODULE"}});
        return ok ? "" : ok.error().what.english();
    };
    EXPECT_EQ(both("PERS num x:=1;", "PERS num x;"), "");
    EXPECT_EQ(both("PERS num x:=1;", "PERS num x:=1;"), "");
    EXPECT_THAT(both("PERS num x:=1;", "PERS num x:=2;"), HasSubstr("another initial value"));
    EXPECT_THAT(both("PERS num x:=1;", "PERS bool x;"), HasSubstr("PERS x is bool here and num in A.mod"));
    EXPECT_THAT(both("PERS num x{3};", "PERS num x{4};"), HasSubstr("num{4} here and num{3}"));
    EXPECT_EQ(both("LOCAL PERS num x:=1;", "PERS bool x;"), "");
}

// Executes `text` as the main of a task of its own and answers its TPWrites, then why it stands.
std::string executed(const std::string& text, const std::string& routines = "",
                     const std::string& data = "") {
    rapid::Machine machine(
        rapid::make_instruction_set(rapid::instruction_set_text(), rapid::RapidRobot::signals()),
        rapid::general_natives(), [] { return true; });
    try {
        machine.add("T",
                    {{"M.mod", "MODULE M\n" + data + "\nPROC main()\n" + text + "\nEXIT;\nENDPROC\n" +
                                   routines + "\nENDMODULE\n"}},
                    "main", true);
    } catch (const rapid::LoadError& e) {
        return e.what();
    }
    machine.start();
    for (int i = 0; i < 5000 && machine.task("t")->running(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    machine.stop();
    std::string all;
    for (const std::string& m : machine.messages()) all += (all.empty() ? "" : "|") + m.substr(3);
    return all;
}

TEST(RapidMachine, ALoopWithoutStepCountsDownWhereItBeginsAboveItsEnd) {
    EXPECT_EQ(executed("VAR string s:=\"\";\nFOR i FROM 1 TO 0 DO\ns:=s+NumToStr(i,0);\nENDFOR\nTPWrite s;"),
              "10|EXIT");
    EXPECT_EQ(executed("VAR string s:=\"\";\nFOR i FROM 1 TO 3 DO\ns:=s+NumToStr(i,0);\nENDFOR\nTPWrite s;"),
              "123|EXIT");
}

TEST(RapidMachine, NumbersAreSingleAndStringsEnd) {
    EXPECT_EQ(executed("VAR num n:=0.1;\nTPWrite DnumToStr(NumToDnum(n),12);"), "0.100000001490|EXIT");
    EXPECT_THAT(executed("TPWrite NumToStr(1,8);"), HasSubstr("8 decimals are asked for"));
    EXPECT_THAT(executed("VAR string s:=\"" + std::string(80, 'x') + "\";\ns:=s+\"y\";"),
                HasSubstr("81 characters is too long"));
    EXPECT_THAT(executed("TPWrite StrPart(\"abc\",2,0);"), HasSubstr("not a whole number from 1"));
    EXPECT_EQ(executed("TPWrite StrPart(\"abcd\",2,2)+NumToStr(StrFind(\"ab c\",1,\" \"),0);"), "bc3|EXIT");
    EXPECT_EQ(executed("VAR num n;\nVAR bool b;\nb:=StrToVal(\"1.5x\",n);\nIF NOT b TPWrite "
                       "\"no\";\nb:=StrToVal(\" -2.5E1\",n);\n"
                       "TPWrite ValToStr(n);"),
              "no|-25|EXIT");
    EXPECT_THAT(executed("VAR num a{3};\nVAR num i:=0;\na{i}:=1;"),
                HasSubstr("M.mod, line 6: the index 0 is not within 1 and 3"));
}

TEST(RapidMachine, ErrorsGoToTheHandlerOfTheirRoutineOnly) {
    const std::string fails = "PROC fails()\nWaitUntil FALSE\\MaxTime:=0.01;\n%ENDPROC";
    const auto with = [&](const std::string& handler) {
        std::string text = fails;
        text.replace(text.find('%'), 1, handler);
        return text;
    };
    EXPECT_EQ(executed("fails;\nTPWrite \"on\";", with("ERROR\nIF ERRNO=ERR_WAIT_MAXTIME TRYNEXT;\n")),
              "on|EXIT");
    EXPECT_EQ(executed("fails;\nTPWrite \"on\";", with("TPWrite \"not reached\";\nERROR\nRETURN;\n")),
              "on|EXIT");
    // No handler: the caller's is not asked.
    EXPECT_THAT(
        executed("catches;",
                 with("") + "\nPROC catches()\nfails;\nERROR\nTPWrite \"caught\";\nTRYNEXT;\nENDPROC"),
        AllOf(HasSubstr("the task stands"), Not(HasSubstr("caught"))));
    EXPECT_EQ(
        executed("catches;", with("ERROR\nRAISE;\n") +
                                 "\nPROC catches()\nfails;\nERROR\nTPWrite \"caught\";\nTRYNEXT;\nENDPROC"),
        "caught|EXIT");
    EXPECT_THAT(executed("fails;", with("ERROR\nTPWrite \"seen\";\n")),
                HasSubstr("its error handler ends without treating it"));
    EXPECT_THAT(executed("fails;", with("ERROR\nRETRY;\n")), HasSubstr("tried too often"));
}

TEST(RapidMachine, TestAndSetDecidesOnce) {
    EXPECT_EQ(executed("IF TestAndSet(b) TPWrite \"mine\";\nIF TestAndSet(b) TPWrite \"twice\";", "",
                       "PERS bool b:=FALSE;"),
              "mine|EXIT");
}

TEST(RapidMachine, WaitUntilTellsByItsFlag) {
    EXPECT_EQ(
        executed(
            "VAR bool late;\nWaitUntil FALSE\\MaxTime:=0.01\\TimeFlag:=late;\nIF late TPWrite \"late\";"),
        "late|EXIT");
    EXPECT_EQ(executed("VAR bool late:=TRUE;\nWaitUntil TRUE\\MaxTime:=1\\TimeFlag:=late;\nIF NOT late "
                       "TPWrite \"came\";"),
              "came|EXIT");
}

ProgramRequest project(int spots) {
    ProgramRequest r;
    r.project = "door";
    for (int i = 0; i < spots; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i + 1);
        m.trigger = make_pose(rotation_exp({0.1, 0.2, 0.3}), {800, 10.0 * i, 600});
        m.entry = m.exit = m.trigger;
        m.via = {m.trigger};
        r.moves.push_back(m);
    }
    r.frames = {{"left", "BASE_left", Pose::Identity()}};
    return r;
}

Expected<void> loads_with(const std::vector<ProgramFile>& files, const std::vector<ProgramFile>& more = {}) {
    std::vector<ProgramFile> motion = more, server;
    for (const ProgramFile& f : files) (f.name == "SeamwrightServer.mod" ? server : motion).push_back(f);
    return check_rapid(motion, server);
}

TEST(RapidDelivered, AControllerLoadsWhatIsWritten) {
    for (const int spots : {0, 1, 64}) {
        auto files = write_abb_program(project(spots));
        ASSERT_TRUE(files) << files.error().sentence();
        const auto loaded = loads_with(*files);
        EXPECT_TRUE(loaded) << loaded.error().sentence();
    }
    // The name that was there.
    std::string spoilt(resources::Seamwright_mod);
    spoilt.replace(spoilt.find("VAR robtarget goal;"), 19, "VAR robtarget to;");
    const auto refused = check_rapid({{"Seamwright.mod", spoilt}});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("to is a reserved word"));
}

TEST(RapidDelivered, TheMovesCarryTheLoadOfTheProject) {
    auto request = project(2);
    request.settings = {{"load", {{"mass_kg", 12.5}, {"centre_mm", {0, 10, 150}}}}};
    auto files = write_abb_program(request);
    ASSERT_TRUE(files) << files.error().sentence();
    EXPECT_THAT((*files)[2].text, HasSubstr("[12.500,[0.000,10.000,150.000],[1,0,0,0]"));
    EXPECT_TRUE(loads_with(*files));
    request.settings = {{"tool", "gun"}};
    files = write_abb_program(request);
    ASSERT_TRUE(files);
    EXPECT_THAT(loads_with(*files).error().what, HasSubstr("there is no data gun")) << "the plant's own";
    const ProgramFile plant{
        "Plant.mod",
        "MODULE Plant\nPERS tooldata gun:=[TRUE,[[0,0,0],[1,0,0,0]],[7,[0,0,1],[1,0,0,0],0,0,0]];\n"
        "ENDMODULE\n"};
    const auto loaded = loads_with(*files, {plant});
    EXPECT_TRUE(loaded) << loaded.error().sentence();
    for (const char* settings : {R"({"tool": "while"})", R"({"tool": "a b"})", R"({"load": {"mass_kg": -1}})",
                                 R"({"tool": "gun", "load": {"mass_kg": 1}})", R"({"load": {"mass": 1}})"}) {
        request.settings = nlohmann::json::parse(settings);
        EXPECT_FALSE(write_abb_program(request)) << settings;
    }
}

TEST(RapidDelivered, EgmComesWithItsModule) {
    auto request = project(1);
    request.driver = "abb-egm";
    request.settings = {{"cycle_ms", 24}, {"port", 6510}, {"measuring", {{"settings", {{"port", 2222}}}}}};
    auto files = write_abb_program(request);
    ASSERT_TRUE(files) << files.error().sentence();
    ASSERT_EQ(files->size(), 4u);
    EXPECT_THAT((*files)[0].text, HasSubstr("2222")) << "the port of the measuring driver";
    EXPECT_EQ((*files)[3].name, "SeamwrightEgm.mod");
    EXPECT_THAT((*files)[3].text, HasSubstr("SampleRate:=24;"));
    const auto loaded = loads_with(*files);
    EXPECT_TRUE(loaded) << loaded.error().sentence();
    request.settings["cycle_ms"] = 10;
    const auto refused = write_abb_program(request);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("no sample rate of 10 ms"));
}

// Whatever somebody calls a path or a work object: it is refused, or a controller loads it.
TEST(RapidDelivered, NoNameOfTheUserBreaksAProgram) {
    int written = 0;
    for (const char* name : {"while",     "END",    "to",       "return",     "TO",
                             "robtarget", "tool0",  "v100",     "Z5",         "fine",
                             "MoveL",     "swGone", "SW_Take",  "Seamwright", "seamwrightspots",
                             "num",       "num1",   "point",    "frame",      "speed",
                             "tool",      "i",      "rounding", "main",       "s01_entry",
                             "bead",      "left_1", "Task",     "ERRNO",      "StrPart",
                             "load0"}) {
        PathProgramRequest path;
        path.name = name;
        path.frame_from_tool = {Pose::Identity()};
        const auto files = write_abb_path(path);
        auto request = project(1);
        request.frames = {{"left", name, Pose::Identity()}};
        const auto program = write_abb_program(request);
        written += (files ? 1 : 0) + (program ? 1 : 0);
        if (files) {
            const auto loaded = check_rapid(*files);
            EXPECT_TRUE(loaded) << name << ": " << loaded.error().sentence();
        }
        if (program) {
            const auto loaded = loads_with(*program);
            EXPECT_TRUE(loaded) << name << ": " << loaded.error().sentence();
        }
    }
    EXPECT_GE(written, 6);
    PathProgramRequest path;
    path.frame_from_tool = {Pose::Identity()};
    const auto unnamed = write_abb_path(path);
    ASSERT_TRUE(unnamed) << unnamed.error().sentence();
    EXPECT_TRUE(check_rapid(*unnamed));
    path.name = "bead";
    for (int count = 1; count <= 3; ++count) {
        path.frame_from_tool.assign(static_cast<std::size_t>(count), Pose::Identity());
        path.comment = "\"; ENDMODULE\nMODULE x";
        const auto loaded = check_rapid(*write_abb_path(path));
        EXPECT_TRUE(loaded) << loaded.error().sentence();
    }
}

}  // namespace
}  // namespace seamwright
