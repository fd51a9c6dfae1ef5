// The interpreter is strict: what a real controller refuses, it refuses.

#include "devices/controllers/kuka/krl/machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/controllers/kuka/eki_channel.h"
#include "devices/controllers/kuka/robot.h"
#include "devices/kuka/program.h"

namespace seamwright::krl {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& file, const std::string& text) {
    try {
        (void)parse_module(file, text);
    } catch (const KrlError& e) {
        return e.what();
    }
    return "";
}
std::string program(const std::string& lines) {
    return "DEF P()\n" + lines + "END\n";
}

TEST(KrlParser, RefusesWhatAControllerDoesNotCompile) {
    EXPECT_EQ(refusal("p.src", program("DECL INT N\nN=1\n")), "");
    EXPECT_THAT(refusal("p.src", program("DECL FRAME POS\n")), HasSubstr("POS is a word of KRL"));
    EXPECT_THAT(refusal("while.src", "DEF while()\nEND\n"), HasSubstr("WHILE is a word of KRL"));
    EXPECT_THAT(refusal("p.src", program("DECL INT A_NAME_OF_TWENTY_FIVE_CHR\n")),
                HasSubstr("24 characters"));
    EXPECT_THAT(refusal("p.src", program("N=1\nDECL INT N\n")), HasSubstr("before the first statement"));
    EXPECT_THAT(refusal("p.src", program("DECL INT N=1\n")), HasSubstr("only data lists"));
    EXPECT_THAT(refusal("p.src", "DEF P()\nQ(1)\nEND\nDEF Q(T[]:IN)\nDECL CHAR T[]\nEND\n"),
                HasSubstr("OUT only"));
    EXPECT_THAT(refusal("p.src", "DEF P()\nEND\nDEF Q(N:IN)\nEND\n"), HasSubstr("N is not declared"));
    EXPECT_THAT(refusal("p.src", program("IF TRUE THEN\n")), HasSubstr("END stands where"));
    EXPECT_THAT(refusal("p.src", program("GIBBERISH HERE\n")), HasSubstr("="));
    EXPECT_THAT(refusal("p.dat", "DEFDAT P\nDECL GLOBAL INT N=1\nENDDAT\n"), HasSubstr("PUBLIC"));
    EXPECT_THAT(refusal("p.dat", "DEFDAT P PUBLIC\nDECL INT N\nN=1\nENDDAT\n"), HasSubstr("CHAR arrays"));
}

class KrlRun : public testing::Test {
  protected:
    // What running P() of `lines` ends with; empty = well. Data: some variables.
    std::string run(const std::string& lines, TaskKind kind = TaskKind::robot) {
        static const auto cell = SimulatedCell::open({{"optics", {{"width", 64}, {"height", 64}}}}).value();
        Machine machine;
        KukaRobot robot(cell, {}, Pose::Identity(), 1);
        std::string failure;
        try {
            machine.load("d.dat",
                         "DEFDAT D PUBLIC\nDECL GLOBAL CHAR TXT[8]\nDECL GLOBAL INT ARR[3]\nDECL GLOBAL "
                         "FRAME FR\nENDDAT\n");
            machine.load("p.src", program(lines));
        } catch (const KrlError& e) {
            return e.what();
        }
        robot.select("P");
        return Task(machine, robot, kind, {}).run("P", failure) == TaskEnd::finished ? "" : failure;
    }
};

TEST_F(KrlRun, WhatIsNotInitialisedIsNotRead) {
    EXPECT_THAT(run("DECL INT N\nDECL INT M\nM=N\n"), HasSubstr("N is not initialised"));
    EXPECT_THAT(run("DECL BOOL B\nB=StrComp(TXT[],\"a\",#CASE_SENS)\n"), HasSubstr("not initialised"));
    EXPECT_THAT(run("DECL REAL R\nR=FR.X\n"), HasSubstr("not initialised"));
    EXPECT_THAT(run("DECL REAL R\nR=$BASE.X\n"), HasSubstr("$BASE is not initialised"));
}

TEST_F(KrlRun, ArraysCountFromOneAndStringsFit) {
    EXPECT_EQ(run("ARR[1]=1\nARR[3]=3\n"), "");
    EXPECT_THAT(run("ARR[0]=1\n"), HasSubstr("outside 1 to 3"));
    EXPECT_THAT(run("ARR[4]=1\n"), HasSubstr("outside 1 to 3"));
    EXPECT_THAT(run("TXT[]=\"nine char\"\n"), HasSubstr("do not fit"));
}

TEST_F(KrlRun, TypesAreKept) {
    EXPECT_THAT(run("DECL INT N\nN=TRUE\n"), HasSubstr("BOOL cannot be assigned to INT"));
    // Comparisons bind last: this asks whether 1 is (1 AND TRUE).
    EXPECT_THAT(run("DECL BOOL B\nB=1==1 AND TRUE\n"), HasSubstr("a BOOL is needed"));
    EXPECT_EQ(run("DECL BOOL B\nB=(1==1) AND TRUE\n"), "");
    EXPECT_THAT(run("NOSUCH(1)\n"), HasSubstr("there is no program NOSUCH"));
    EXPECT_THAT(run("DECL INT N\nN=$NOSUCH\n"), HasSubstr("no system variable"));
}

// An event counts when it comes, not while it lasts; local interrupts end with their program; higher
// priorities interrupt lower ones only.
TEST_F(KrlRun, InterruptsComeWithTheEvent) {
    const std::string ready = "ARR[1]=0\nARR[2]=0\n";
    const std::string sub = "END\nDEF COUNT()\nARR[1]=ARR[1]+1\n";
    const auto expect = [&](const std::string& lines, int count) {
        return ready + "INTERRUPT DECL 10 WHEN $FLAG[1]==TRUE DO COUNT()\n" + lines + "IF ARR[1]<>" +
               std::to_string(count) + " THEN\nWRONG()\nENDIF\n" + sub;
    };
    EXPECT_EQ(run(expect("INTERRUPT ON 10\n$FLAG[1]=TRUE\nWAIT SEC 0.01\n", 1)), "");
    EXPECT_EQ(run(expect("$FLAG[1]=TRUE\nINTERRUPT ON 10\nWAIT SEC 0.01\n", 0)), "") << "it was before";
    EXPECT_EQ(run(expect("$FLAG[1]=TRUE\nWAIT SEC 0.01\n", 0)), "") << "not switched on";
    EXPECT_EQ(run(expect("INTERRUPT ON 10\n$FLAG[1]=TRUE\n$FLAG[1]=FALSE\n$FLAG[1]=TRUE\n", 2)), "");
    EXPECT_EQ(run(expect("INTERRUPT ON 10\nINTERRUPT OFF 10\n$FLAG[1]=TRUE\nWAIT SEC 0.01\n", 0)), "");
    EXPECT_THAT(run("HELP()\nINTERRUPT ON 10\nEND\nDEF HELP()\nINTERRUPT DECL 10 WHEN $FLAG[1] DO HELP()\n"),
                HasSubstr("10 is not declared"));
    EXPECT_EQ(
        run("HELP()\nINTERRUPT ON 10\nEND\nDEF HELP()\nGLOBAL INTERRUPT DECL 10 WHEN $FLAG[1] DO HELP()\n"),
        "");
    EXPECT_THAT(
        run("INTERRUPT DECL 3 WHEN $FLAG[1] DO COUNT()\nINTERRUPT DECL 40 WHEN $FLAG[1] DO COUNT()\n"),
        HasSubstr("40 is no priority"));
    EXPECT_THAT(run("RESUME\n"), HasSubstr("in an interrupt program only"));
    EXPECT_THAT(run("BRAKE\n"), HasSubstr("in an interrupt program only"));
    EXPECT_THAT(run("INTERRUPT DECL 10 WHEN $FLAG[1] DO COUNT\n"), HasSubstr("brackets"));
    EXPECT_THAT(run("INTERRUPT ON 10\n", TaskKind::submit), HasSubstr("the robot interpreter's"));
    EXPECT_THAT(run("INTERRUPT DECL 10 WHEN $FLAG[1] DO COUNT()\nINTERRUPT ON 10\n$FLAG[1]=TRUE\nEND\n"
                    "DEF COUNT()\nRESUME\n"),
                HasSubstr("RESUME: the program that declared"));
}

TEST_F(KrlRun, MotionsWantTheirPreparation) {
    EXPECT_THAT(run("$BASE=$NULLFRAME\n$TOOL=$NULLFRAME\nBAS(#INITMOV,0)\nLIN $NULLFRAME\n"),
                HasSubstr("first motion"));
    EXPECT_THAT(run("BAS(#INITMOV,0)\nPTP $AXIS_ACT\n"), HasSubstr("$BASE or $TOOL"));
    EXPECT_EQ(run("$BASE=$NULLFRAME\n$TOOL=$NULLFRAME\nBAS(#INITMOV,0)\nPTP $AXIS_ACT\nLIN {X 1.0,Y 0.0,Z "
                  "0.0,A 0.0,B 0.0,C 0.0}\n"),
              "");
    EXPECT_THAT(run("HALT\n", TaskKind::submit), HasSubstr("submit interpreter"));
    EXPECT_THAT(run("$BASE=$NULLFRAME\n", TaskKind::submit), HasSubstr("cannot be written"));
}

TEST_F(KrlRun, EthernetKrlWantsItsChannel) {
    EXPECT_THAT(run("DECL EKI_STATUS RET\nRET=EKI_Init(\"Nowhere\")\n"), HasSubstr("no file Nowhere.xml"));
    EXPECT_THAT(run("DECL EKI_STATUS RET\nRET=EKI_Open(\"Seamwright\")\n"), HasSubstr("is not initialised"));
}

std::string configuration() {
    ProgramRequest request;
    request.project = "p";
    const auto files = write_kuka_program(request);
    for (const ProgramFile& f : *files)
        if (f.name == "Seamwright.xml") return f.text;
    return "";
}
std::string configuration_refusal(const std::string& from, const std::string& to) {
    std::string xml = configuration();
    const auto at = xml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    try {
        (void)parse_eki_configuration(xml.replace(at, from.size(), to));
    } catch (const KrlError& e) {
        return e.what();
    }
    return "";
}

TEST(EkiConfiguration, TheDeliveredFileIsTakenAndWrongOnesAreNot) {
    EXPECT_EQ(configuration_refusal("Ping=\"2\"", "Ping=\"2\""), "");
    EXPECT_THAT(configuration_refusal("Ping=\"2\"", "Pong=\"2\""), HasSubstr("does not know ALIVE Pong"));
    EXPECT_THAT(configuration_refusal("Limit=\"64\"", "Limit=\"513\""), HasSubstr("is not 1 to 512"));
    EXPECT_THAT(configuration_refusal("127.0.0.1", "0.0.0.0"), HasSubstr("no address"));
    EXPECT_THAT(configuration_refusal("54600", "0"), HasSubstr("PORT"));
    EXPECT_THAT(configuration_refusal("Type=\"INT\"", "Type=\"INTEGER\""), HasSubstr("is no type"));
    EXPECT_THAT(configuration_refusal("Robot/Pos/@Y", "Robot/Pos/@X"), HasSubstr("stands twice"));
    EXPECT_THAT(configuration_refusal("Display=\"disabled\"", "Display=\"off\""), HasSubstr("Display"));
    EXPECT_THAT(configuration(), HasSubstr("<MESSAGES Logging=\"error\" Display=\"disabled\"/>"));
}

}  // namespace
}  // namespace seamwright::krl
