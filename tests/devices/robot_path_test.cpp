// Robot programs read back as paths: those that this program writes, parts, and what is none.
#include "devices/robot_path/robot_path.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <random>

#include "core/geometry/notation.h"
#include "devices/registry.h"
#include "tests/devices/robot_programs.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

// ---- what this program writes

// Poses as a file of so many digits holds them lie half its last digit off.
TEST(ProgramPath, WhatOurWritersWriteReadsBackExactly) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> mm(-1500, 1500), deg(-180, 180);
    PathProgramRequest request;
    request.name = "bead";
    request.comment = "path corrected by run 3";
    request.base_from_frame = kuka(812.4, -103.9, 655, 91.2, -1.1, 178.8);
    for (int i = 0; i < 200; ++i)
        request.frame_from_tool.push_back(
            kuka(mm(random), mm(random), mm(random), deg(random), deg(random) / 2, deg(random)));
    for (const char* brand : {"kuka", "abb", "ur"}) {
        const auto files = write_robot_path(brand, request);
        ASSERT_TRUE(files) << files.error().sentence();
        const ProgramPath path = parsed(files->front().name, files->front().text);
        EXPECT_EQ(path.count(LineKind::not_understood), 0U) << brand;
        EXPECT_EQ(path.count(LineKind::left_out), 0U) << brand;
        EXPECT_TRUE(path.remarks.empty()) << path.remarks.front();
        EXPECT_EQ(path.tools.size(), 1U);
        ASSERT_EQ(path.points.size(), request.frame_from_tool.size()) << brand;
        for (std::size_t i = 0; i < path.points.size(); ++i) {
            EXPECT_EQ(path.points[i].motion, ProgramMotion::linear);
            expect_pose(in_base(path.points[i]), request.base_from_frame * request.frame_from_tool[i], brand,
                        5e-4, 5e-7);
        }
        // To the last digit: what was read, written again, is the same file.
        PathProgramRequest again = request;
        for (std::size_t i = 0; i < path.points.size(); ++i) {
            if (std::string(brand) == "ur")
                again.frame_from_tool[i] = request.base_from_frame.inverse() * path.points[i].frame_from_tool;
            else
                again.frame_from_tool[i] = path.points[i].frame_from_tool;
        }
        const auto second = write_robot_path(brand, again);
        ASSERT_TRUE(second);
        const ProgramPath twice = parsed(second->front().name, second->front().text);
        for (std::size_t i = 0; i < path.points.size(); ++i)
            expect_pose(in_base(twice.points[i]), in_base(path.points[i]), brand, 2e-4, 1e-7);
        if (std::string(brand) == "kuka") {
            EXPECT_EQ(second->front().text, files->front().text) << brand;
        }
    }
}

TEST(ProgramPath, MeasuringProgramsReadBackWithTheirModules) {
    ProgramRequest request;
    request.project = "door";
    for (int i = 0; i < 3; ++i) {
        MeasuringMove move;
        move.spot_id = "S" + std::to_string(i + 1);
        move.entry = kuka(100 + i, 200, 300, 10, 20, 30);
        move.trigger = kuka(110 + i, 200, 300, 10, 20, 30);
        move.exit = kuka(120 + i, 200, 300, 10, 20, 30);
        move.stop_at_trigger = i == 1;
        request.moves.push_back(move);
    }
    for (const char* brand : {"kuka", "abb", "ur"}) {
        const auto files = write_robot_program(brand, request);
        ASSERT_TRUE(files) << files.error().sentence();
        std::vector<ProgramText> texts;
        for (const ProgramFile& f : *files) {
            const bool program = f.name == "seamwright_spots.src" || f.name == "SeamwrightSpots.mod" ||
                                 f.name == "seamwright.script";
            if (program)
                texts.insert(texts.begin(), {f.name, f.text});
            else if (program_language_of(f.name))
                texts.push_back({f.name, f.text});
        }
        ProgramPathOptions options;
        if (std::string(brand) == "ur") options.routine = "sw_measure";
        auto path = parse_program_path(texts, options);
        ASSERT_TRUE(path) << brand << path.error().sentence();
        ASSERT_EQ(path->points.size(), 9U) << brand;
        for (std::size_t i = 0; i < 9; ++i) {
            const MeasuringMove& m = request.moves[i / 3];
            expect_pose(in_base(path->points[i]),
                        i % 3 == 0   ? m.entry
                        : i % 3 == 1 ? m.trigger
                                     : m.exit,
                        brand, 5e-4, 5e-7);
        }
    }
}

// ---- names, calls and where they end

// Positions in the base, circles' samples left out.
std::vector<Eigen::Vector3d> corners(const ProgramPath& path) {
    std::vector<Eigen::Vector3d> all;
    for (const ProgramPoint& p : path.points)
        if (p.motion != ProgramMotion::circular) all.emplace_back(in_base(p).translation());
    return all;
}
void expect_corners(const ProgramPath& path, const std::vector<Eigen::Vector3d>& wanted,
                    const std::string& what) {
    EXPECT_EQ(path.count(LineKind::not_understood), 0U) << what;
    const auto got = corners(path);
    ASSERT_EQ(got.size(), wanted.size()) << what;
    for (std::size_t i = 0; i < wanted.size(); ++i)
        EXPECT_LT((got[i] - wanted[i]).norm(), 1e-9) << what << " point " << i << ": " << got[i].transpose();
}
// `text` with every "@" written as `instead`.
std::string with(std::string text, const std::string& instead) {
    for (std::size_t at = 0; (at = text.find('@', at)) != text.npos; at += instead.size())
        text.replace(at, 1, instead);
    return text;
}
const char* const kRapidData =
    "PERS tooldata t1:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n"
    "CONST robtarget p0:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";
std::string rapid(const std::string& routines) {
    return std::string("MODULE m\n") + kRapidData + routines + "ENDMODULE\n";
}
std::string krl(const std::string& statements, const std::string& more = "") {
    return "DEF T()\nDECL INT I,N\nDECL REAL R\nDECL FRAME Q\n$BASE=$NULLFRAME\nQ={X 0,Y 0,Z 0,A 0,B 0,C "
           "0}\n" +
           statements + "END\n" + more;
}
std::string script(const std::string& statements) {
    return "def t():\n" + statements + "end\n";
}

// How the names of a module, a program or a routine are chosen does not matter to any other.
TEST(ProgramPath, NamesOfOneModuleMeanNothingInAnother) {
    const std::vector<Eigen::Vector3d> wanted = {{1, 0, 0}, {500, 700, 0}, {2, 0, 0}};
    for (const std::string name : {"XP", "OTHER"}) {
        const auto data = [](const std::string& list, const std::string& n, const std::string& numbers) {
            return "DEFDAT " + list + "\nDECL E6POS " + n + "={" + numbers +
                   ",Z 0,A 0,B 0,C 0}\nDECL INT K=3\nENDDAT\n";
        };
        const ProgramPath path =
            parsed("main.src",
                   "DEF MAIN()\nDECL INT I\n$BASE=$NULLFRAME\nI=2\nLIN XP\nSUB()\nXP.X=I\nLIN XP\nEND\n"
                   "DEF STEP()\nLIN {X 9}\nEND\n",
                   {},
                   {{"sub.src", with("DEF SUB()\nDECL INT I\nI=7\nK=5\n@.X=K*100\nSTEP()\nEND\n"
                                     "DEF STEP()\nLIN @\nEND\n",
                                     name)},
                    {"Sub.dat", data("SUB", name, "X 1,Y 700")},
                    {"main.dat", data("MAIN", "XP", "X 1,Y 0")}});
        expect_corners(path, wanted, "KRL " + name);
        const auto module = [](const std::string& n, const std::string& x, const std::string& y) {
            return "LOCAL CONST robtarget " + n + ":=[[" + x + "," + y +
                   ",0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";
        };
        expect_corners(
            parsed("m.mod",
                   rapid(module("XP", "1", "0") + "VAR num i:=2;\nPROC main()\nMoveL XP,v,z,t1;\nsub;\n"
                                                  "MoveL Offs(XP,i-1,0,0),v,z,t1;\nENDPROC\nLOCAL PROC "
                                                  "step()\nMoveL p0,v,z,t1;\nENDPROC\n"),
                   {},
                   {{"s.mod", "MODULE s\n" + module(name, "500", "700") +
                                  with("PROC sub()\nVAR num i;\ni:=i+7;\nFOR k FROM 1 TO 2 "
                                       "DO\ni:=k;\nENDFOR\nstep;\nENDPROC\n"
                                       "LOCAL PROC step()\nMoveL @,v,z,t1;\nENDPROC\nENDMODULE\n",
                                       name)}}),
            wanted, "RAPID " + name);
    }
    const auto position = [](int n, double x, double y) {
        return fmt::format(
            "P[{}]{{\nGP1:\nUF : 0, UT : 1,\nX = {} mm, Y = {} mm, Z = 0 mm,\nW = 0 deg, P = 0 deg, R = 0 "
            "deg\n}};\n",
            n, x, y);
    };
    for (const int n : {1, 5})
        expect_corners(parsed("A.LS",
                              "/PROG A\n/MN\n1:L P[1] 9mm/sec FINE ;\n2:  FOR R[1]=2 TO 2 ;\n3:  CALL B "
                              ";\n4:  ENDFOR ;\n5:L P[R[1]] 9mm/sec FINE ;\n/POS\n" +
                                  position(1, 1, 0) + position(2, 2, 0) + "/END\n",
                              {},
                              {{"B.LS", fmt::format("/PROG B\n/MN\n1:  IF R[1]=2,CALL C ;\n/POS\n/END\n")},
                               {"C.LS", fmt::format("/PROG C\n/MN\n1:L P[{}] 9mm/sec FINE ;\n/POS\n{}/END\n",
                                                    n, position(n, 500, 700))}}),
                       wanted, "FANUC");
    for (const std::string name : {"i", "j"})
        expect_corners(
            parsed("t.script",
                   with(script("i = 0.001\ndef sub():\nlocal @ = 0.5\nk = 0.7\nmovel(p[@,k,0,0,0,0])\nend\n"
                               "movel(p[i,0,0,0,0,0])\nsub()\nmovel(p[2*i,0,0,0,0,0])\n"),
                        name)),
            wanted, "URScript " + name);
}

TEST(ProgramPath, WhatAModuleDoesNotSayIsNotTakenFromAnother) {
    const std::string main = "DEF MAIN()\n$BASE=$NULLFRAME\nLIN XP\nSUB()\nLIN XP\nEND\n",
                      point = "E6POS XP={X 1,Y 0,Z 0,A 0,B 0,C 0}\nENDDAT\n",
                      sub = "DEF SUB()\nLIN XP\nEND\n";
    const auto read = [&](const std::string& head, const std::string& decl) {
        return parsed("main.src", main, {}, {{"main.dat", head + "\n" + decl + point}, {"sub.src", sub}});
    };
    const ProgramPath own = read("DEFDAT MAIN", "DECL ");
    EXPECT_EQ(own.points.size(), 2U);
    ASSERT_EQ(own.count(LineKind::not_understood), 1U);
    EXPECT_THAT(own.lines.at(own.lines.size() - 2).why.english(),
                HasSubstr("XP is not known from the program"));
    EXPECT_EQ(read("DEFDAT MAIN PUBLIC", "DECL ").points.size(), 2U);
    EXPECT_EQ(read("DEFDAT MAIN PUBLIC", "DECL GLOBAL ").points.size(), 3U);
    // Neither list is there: each N may be its module's own.
    const ProgramPath bare =
        parsed("main.src", "DEF MAIN()\n$BASE=$NULLFRAME\nN=1\nSUB()\nLIN {X N,Y 0,Z 0,A 0,B 0,C 0}\nEND\n",
               {}, {{"sub.src", "DEF SUB()\nN=2\nEND\n"}});
    EXPECT_THAT(why_at(bare, 5), HasSubstr("is not known from the program"));
    // Two of one name: nobody knows which.
    const auto tell = [](const std::string& x) {
        return "MODULE s" + x + "\nCONST robtarget p:=[[" + x +
               ",0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nENDMODULE\n";
    };
    const std::string asks = rapid("PROC main()\nMoveL p,v,z,t1;\nENDPROC\n");
    EXPECT_EQ(parsed("m.mod", asks, {}, {{"a.mod", tell("1")}, {"b.mod", tell("1")}}).points.size(), 1U);
    EXPECT_EQ(parsed("m.mod", asks, {}, {{"a.mod", tell("1")}, {"b.mod", tell("2")}}).points.size(), 0U);
}

// A call is what its body would be in its place.
TEST(ProgramPath, WhatIsGivenByReferenceComesBack) {
    const std::vector<Eigen::Vector3d> wanted = {{0, 0, 0}, {100, 0, 0}, {300, 0, 0}};
    expect_corners(
        parsed("t.src", krl("LIN Q\nSHIFT(Q,I)\nLIN Q\nTWICE(Q)\nLIN Q\n",
                            "DEF SHIFT(F:OUT,N:OUT)\nDECL FRAME F\nDECL INT N\nF.X=F.X+100\nEND\n"
                            "DEF TWICE(F:OUT)\nDECL FRAME F\nDECL INT N\nSHIFT(F,N)\nSHIFT(F,N)\nEND\n")),
        wanted, "KRL");
    expect_corners(
        parsed("t.src", krl("LIN Q\nSHIFT(Q)\nLIN Q\n", "DEF SHIFT(F:IN)\nDECL FRAME F\nF.X=100\nEND\n")),
        {{0, 0, 0}, {0, 0, 0}}, "KRL, by value");
    expect_corners(
        parsed("m.mod", rapid("VAR robtarget q;\nVAR num n{2}:=[100,200];\nPROC main()\nVAR num "
                              "i:=2;\nq:=p0;\nMoveL q,v,z,t1;\n"
                              "shift q,n{1},i;\nMoveL q,v,z,t1;\nshift q,n{2},i;\nMoveL q,v,z,t1;\nENDPROC\n"
                              "PROC shift(INOUT robtarget f,PERS num by,VAR num "
                              "k)\nk:=1;\nf.trans.x:=q.trans.x+by;\nby:=0;\nENDPROC\n")),
        wanted, "RAPID");
    // What nobody says is not known any more.
    const ProgramPath either = parsed(
        "t.src", krl("SHIFT(Q,N)\nLIN Q\nELSEWHERE(Q)\nLIN Q\n", "DEF SHIFT(F,M)\nDECL FRAME F\nM=1\nEND\n"));
    EXPECT_THAT(why_at(either, 8), HasSubstr("point"));
    EXPECT_THAT(why_at(either, 10), HasSubstr("not understood: Q? is not known"));
    EXPECT_THAT(
        why_at(parsed("m.mod", rapid("PROC main()\nVAR robtarget q;\nq:=p0;\nMoveL q,v,z,t1;\nelsewhere "
                                     "q;\nMoveL p0,v,z,t1;\nMoveL q,v,z,t1;\nENDPROC\n")),
               10),
        HasSubstr("not understood: q? is not known"));
}

TEST(ProgramPath, FunctionsOfTheProgramGiveTheirValues) {
    expect_corners(parsed("t.src", krl("LIN FAR(3)\n",
                                       "DEFFCT FRAME FAR(N:IN)\nDECL INT N\nDECL FRAME F\n"
                                       "F={X 0,Y 0,Z 0,A 0,B 0,C 0}\nF.X=N/2*10\nRETURN F\nENDFCT\n")),
                   {{10, 0, 0}}, "KRL");
    expect_corners(
        parsed("m.mod", rapid("PROC main()\nMoveL far(2),v,z,t1;\nENDPROC\nFUNC robtarget far(num n)\n"
                              "IF n=2 RETURN Offs(p0,5,0,0);\nRETURN p0;\nENDFUNC\n")),
        {{5, 0, 0}}, "RAPID");
    const ProgramPath path =
        parsed("t.script",
               script("def far(n):\nmovel(p[0,0.001,0,0,0,0])\nreturn p[n,0,0,0,0,0]\nend\ndef asks():\nif "
                      "get_standard_digital_in(1):\nreturn 1\nend\nreturn 2\nend\nx = far(0.002)\nmovel(x)\n"
                      "y = asks()\nmovel(p[y,0,0,0,0,0])\n"));
    ASSERT_EQ(path.points.size(), 2U);
    EXPECT_NEAR(path.points[1].frame_from_tool.translation().x(), 2, 1e-9);
    EXPECT_EQ(path.count(LineKind::not_understood), 1U);
    EXPECT_THAT(why_at(path, 15), HasSubstr("not understood"));
    const ProgramPath leaves = parsed("t.src", krl("LIN Q\nIF $IN[1] THEN\nRETURN\nENDIF\nLIN Q\n"));
    EXPECT_THAT(why_at(leaves, 9), HasSubstr("not understood: it hangs on $IN[1]"));
}

TEST(ProgramPath, RapidCountsByInstructions) {
    expect_corners(parsed("m.mod", rapid("PROC main()\nVAR num i;\nVAR num y:=10;\nIncr i;\nAdd y,40;\nMoveL "
                                         "Offs(p0,i,y,0),v,z,t1;\nClear y;\n"
                                         "Decr i;\nDecr i;\nMoveL Offs(p0,i,y,0),v,z,t1;\nENDPROC\n")),
                   {{1, 50, 0}, {-1, 0, 0}}, "RAPID");
}

TEST(ProgramPath, LoopsGoOnAndEndWhereTheyAreTold) {
    expect_corners(
        parsed("t.script",
               script("i = 0\nwhile i < 9:\ni = i + 1\nif i == 2:\ncontinue\nelif i == 4:\nbreak\nend\n"
                      "movel(p[i/1000,0,0,0,0,0])\nend\nmovel(p[0,0,0,0,0,0])\n")),
        {{1, 0, 0}, {3, 0, 0}, {0, 0, 0}}, "URScript");
    // The variable of a loop in RAPID is the loop's own.
    expect_corners(
        parsed(
            "m.mod",
            rapid("PROC main()\nVAR num i:=7;\nFOR i FROM 1 TO 2 DO\nMoveL Offs(p0,i,0,0),v,z,t1;\nENDFOR\n"
                  "MoveL Offs(p0,i,0,0),v,z,t1;\nENDPROC\n")),
        {{1, 0, 0}, {2, 0, 0}, {7, 0, 0}}, "RAPID");
    // What a loop changes through what it calls is not known behind it either.
    const ProgramPath path =
        parsed("m.mod", rapid("VAR num n:=1;\nPROC main()\nWHILE di1=1 DO\nstep;\nIncr n;\nENDWHILE\nMoveL "
                              "Offs(p0,n,0,0),v,z,t1;\nENDPROC\nPROC step()\nn:=n+1;\nENDPROC\n"));
    EXPECT_THAT(why_at(path, 10), HasSubstr("not understood: n is not known"));
}

// What ends the program ends it wherever it stands; what waits for the start key does not.
TEST(ProgramPath, AHaltInARoutineEndsTheProgram) {
    const auto krl_with = [](const std::string& word) {
        return parsed("t.src", krl("LIN Q\nLEAVE()\nLIN Q\n", "DEF LEAVE()\n" + word + "\nEND\n"))
            .points.size();
    };
    EXPECT_EQ(krl_with("HALT"), 2U);
    const auto rapid_with = [](const std::string& word) {
        return parsed("m.mod",
                      rapid("PROC main()\nMoveL p0,v,z,t1;\nFOR i FROM 1 TO 2 DO\nleave;\nENDFOR\nMoveL "
                            "p0,v,z,t1;\nENDPROC\nPROC leave()\n" +
                            word + ";\nENDPROC\n"))
            .points.size();
    };
    EXPECT_EQ(rapid_with("EXIT"), 1U);
    EXPECT_EQ(rapid_with("ExitCycle"), 1U);
    EXPECT_EQ(rapid_with("RETURN"), 2U);
    EXPECT_EQ(rapid_with("Stop"), 2U);
    const auto script_with = [](const std::string& word) {
        return parsed("t.script", script("def leave():\n" + word +
                                         "\nend\nmovel(p[0,0,0,0,0,0])\nleave()\nmovel(p[0,0,0,0,0,0])\n"))
            .points.size();
    };
    EXPECT_EQ(script_with("halt"), 1U);
    EXPECT_EQ(script_with("while True:\nif True:\nhalt\nend\nend"), 1U);
    EXPECT_EQ(script_with("return 1"), 2U);
    const auto tp_with = [](const std::string& word) {
        const std::string move = "L PR[1] 9mm/sec FINE ;\n";
        ProgramPathOptions options;
        options.frames["PR[1]"] = kuka(1, 2, 3);
        return parsed("A.LS", "/PROG A\n/MN\n1:" + move + "2:CALL B ;\n3:" + move + "/END\n", options,
                      {{"B.LS", "/PROG B\n/MN\n1:" + word + " ;\n/END\n"}})
            .points.size();
    };
    EXPECT_EQ(tp_with("ABORT"), 1U);
    EXPECT_EQ(tp_with("PAUSE"), 2U);
    EXPECT_EQ(tp_with("END"), 2U);
}

// KRL: INT and INT is INT, an INT that is given a REAL rounds, and what has no type here is not guessed.
TEST(ProgramPath, KrlCountsInWholeNumbersWhereItsTypesSaySo) {
    const std::vector<std::pair<std::string, double>> laws = {{"Q.X=7/2*10", 30},
                                                              {"Q.X=7/2.0*10", 35},
                                                              {"N=-7\nQ.X=N/2", -3},
                                                              {"N=2.6\nQ.X=N", 3},
                                                              {"R=7\nQ.X=R/2", 3.5},
                                                              {"Q.Y=7\nQ.X=Q.Y/2", 3.5},
                                                              {"Q={X 7,Y 0,Z 0,A 0,B 0,C 0}\nQ.X=Q.X/2", 3.5},
                                                              {"N=7\nR=N\nN=R/2\nQ.X=N+R", 11},
                                                              {"FOR I=5 TO 5\nQ.X=I/2\nENDFOR", 2},
                                                              {"HALF(5,Q)", 2},
                                                              {"WHOLE(5,Q)", 2.5},
                                                              {"Q.X=SQRT(9)/2", 1.5},
                                                              {"Q.X='HB'/2", 5}};
    const std::string more =
        "DEF HALF(M:IN,F:OUT)\nDECL INT M\nDECL FRAME F\nF.X=M/2\nEND\n"
        "DEF WHOLE(M:IN,F:OUT)\nDECL REAL M\nDECL FRAME F\nF.X=M/2\nEND\n";
    for (const auto& [text, x] : laws) {
        const ProgramPath path = parsed("t.src", krl(text + "\nLIN Q\n", more));
        ASSERT_EQ(path.points.size(), 1U) << text;
        EXPECT_NEAR(path.points[0].frame_from_tool.translation().x(), x, 1e-9) << text;
    }
    for (const char* text :
         {"UNSAID=2.5\nQ.X=UNSAID", "UNSAID=7\nQ.X=UNSAID/2", "FOR I=1 TO 3\nENDFOR\nQ.X=I"})
        EXPECT_EQ(parsed("t.src", krl(std::string(text) + "\nLIN Q\n")).points.size(), 0U) << text;
    EXPECT_EQ(parsed("t.src", krl("UNSAID=8\nQ.X=UNSAID/2\nLIN Q\n")).points.size(), 1U);
}

// The robot stays where it is when its frame changes, under the same name too.
TEST(ProgramPath, AFrameThatChangesUnderItsNameLeavesTheRobotWhereItIs) {
    const ProgramPath arc = parsed(
        "m.mod",
        rapid(
            "PERS wobjdata w:=[FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\nPROC main()\nMoveL "
            "p0,v,z,t1\\WObj:=w;\nw.oframe.trans.x:=500;\nMoveC "
            "Offs(p0,0,10,0),Offs(p0,10,0,0),v,z,t1\\WObj:=w;\n"
            "ENDPROC\n"));
    ASSERT_GT(arc.points.size(), 3U);
    // Through the start, (500, 10, 0) and (510, 0, 0) goes one circle.
    const double y = (10 * 10 - 500 * 10) / 20.0;
    const Eigen::Vector3d centre(255, y, 0);
    for (const ProgramPoint& p : arc.points)
        EXPECT_NEAR((in_base(p).translation() - centre).norm(), centre.norm(), 1e-6);
    expect_corners(
        parsed("t.src",
               krl("LIN {X 0,Y 0,Z 0,A 0,B 0,C 0}\nFOR I=1 TO 2\n$BASE=$NULLFRAME\n$BASE.X=100*I\nLIN_REL {Y "
                   "10}\nENDFOR\nBAS(#BASE,0)\n$BASE.Y=$BASE.Y+5\nLIN_REL {Y 10}\n")),
        {{0, 0, 0}, {0, 10, 0}, {0, 20, 0}, {0, 30, 0}}, "KRL");
    // A name of the cell means nothing any more where the program changes what it names.
    const ProgramPath lost =
        parsed("t.src", krl("BAS(#BASE,2)\nLIN Q\n$BASE.X=100\nLIN Q\nBASE_DATA[3].X=5\nBAS(#BASE,3)\nLIN "
                            "Q\nBAS(#BASE,2)\nLIN Q\n$BASE=BASE_DATA[2]:Q\nLIN Q\n"));
    EXPECT_EQ(lost.points.size(), 2U);
    EXPECT_THAT(why_at(lost, 10), HasSubstr("changed here to what the program does not say"));
    EXPECT_THAT(why_at(lost, 13), HasSubstr("not understood: BASE_DATA[3]"));
    EXPECT_THAT(why_at(lost, 17), HasSubstr("not understood"));
}

TEST(ProgramPath, ToolsAreKeptApart) {
    const std::string apt =
        "UNITS/MM\nLOADTL/1\nGOTO/0,0,0,0,0,1\nGOTO/10,0,0\n@\nGOTO/10,50,0\nGOTO/20,50,0\nFINI\n";
    for (const std::string change : {"LOADTL/2", "LOAD/TOOL,2"}) {
        const ProgramPath path = parsed("a.apt", with(apt, change));
        EXPECT_EQ(path.tools.size(), 2U);
        const auto refused = application_path(path, false);
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().sentence(), HasSubstr("the tool changes on the way, from \"LOADTL/1\""));
    }
    EXPECT_TRUE(application_path(parsed("a.apt", with(apt, "LOADTL/1")), false));
    // One that changes under its name is another one.
    const auto tools = [](const std::string& change) {
        return parsed("m.mod",
                      rapid("PROC main()\nMoveL p0,v,z,t1;\n" + change + "\nMoveL p0,v,z,t1;\nENDPROC\n"))
            .tools.size();
    };
    EXPECT_EQ(tools("t1.tframe.trans.z:=0;"), 1U);
    EXPECT_EQ(tools("t1.tframe.trans.z:=5;"), 2U);
}

// ---- whole and broken

TEST(ProgramPath, EveryStatementOfAProgramHasANote) {
    for (const auto& [name, text] :
         std::vector<std::pair<std::string, std::string>>{{"BEAD.SRC", kInline}, {"BEAD.LS", kTp}}) {
        const ProgramPath path = parsed(name, text);
        for (const ProgramLine& l : path.lines) EXPECT_FALSE(l.text.empty()) << l.line;
        if (name == "BEAD.SRC") {
            EXPECT_EQ(path.lines.size(), 26U);
        }
    }
}

TEST(ProgramPath, PartOfAProgramByItsLines) {
    ProgramPathOptions options;
    options.first_line = 26;
    options.last_line = 40;
    const ProgramPath path = parsed("BEAD.SRC", kInline, options, {{"bead.dat", kInlineData}});
    ASSERT_EQ(path.points.size(), 2U);
    EXPECT_EQ(path.points[0].name, "XP2");
    EXPECT_THAT(why_at(path, 25), HasSubstr("left out: outside the lines"));
}

TEST(ProgramPath, WhatIsNoProgramEndsInASentence) {
    const auto refused = [](const std::string& name, const std::string& text) {
        const auto path = parse_program_path({{name, text}});
        EXPECT_FALSE(path) << name;
        return path ? std::string() : path.error().sentence();
    };
    EXPECT_THAT(refused("a.txt", "x"), HasSubstr("ending"));
    EXPECT_THAT(refused("a.src", ""), HasSubstr("no routine of the program moves the robot"));
    EXPECT_THAT(refused("a.src", std::string("DEF A()\0LIN", 11)), HasSubstr("no text"));
    EXPECT_THAT(refused("a.src",
                        "\xFF\xFE"
                        "D\0E\0"),
                HasSubstr("UTF-16"));
    EXPECT_THAT(
        refused("a.mod",
                "MODULE m\nPROC p()\nWHILE 1=1 DO\nx:=x;\nENDWHILE\nMoveL p,v,z,t;\nENDPROC\nENDMODULE"),
        HasSubstr("does not come to an end"));
    EXPECT_THAT(refused("a.script", "def a():\na()\nmovel(p[0,0,0,0,0,0])\nend\n"),
                HasSubstr("does not come to an end"));
    // Arrays that are copied, grown, doubled or nested again and again take time and memory as loops do.
    EXPECT_THAT(refused("a.mod",
                        "MODULE m\nPROC p()\na{100000}:=1;\nFOR i FROM 1 TO 200000 DO\nb:=a;\nENDFOR\n"
                        "MoveL p,v,z,t;\nENDPROC\nENDMODULE"),
                HasSubstr("does not come to an end"));
    EXPECT_THAT(refused("a.mod",
                        "MODULE m\nPROC p()\nFOR i FROM 1 TO 100000 DO\na{i,100000}:=1;\nENDFOR\n"
                        "MoveL p,v,z,t;\nENDPROC\nENDMODULE"),
                HasSubstr("does not come to an end"));
    for (const std::string list : {"[a,a,a,a]", "[a]"})
        EXPECT_THAT(refused("a.script", "def p():\na=[1]\ni=0\nwhile i<40000:\na=" + list +
                                            "\ni=i+1\nend\nmovel(p[0,0,0,0,0,0])\nend\n"),
                    HasSubstr("does not come to an end"))
            << list;
    std::string deep = "DEF a()\n";
    for (int i = 0; i < 100000; ++i) deep += "IF TRUE THEN\n";
    EXPECT_TRUE(parse_program_path({{"a.src", deep + "LIN {X 1,Y 1,Z 1,A 0,B 0,C 0}\n"}}));
    std::string brackets =
        "DEF a()\nLIN P\nX=" + std::string(100000, '(') + "\nY=" + std::string(100000, '-') + "1\nZ=1";
    for (int i = 0; i < 100000; ++i) brackets += "+1";
    EXPECT_TRUE(parse_program_path({{"a.src", brackets + "\n"}}));
    std::string many = "def a():\n while i < 1:\n";
    for (int i = 0; i < 3000; ++i) many += "  movel(p[0,0,0,0,0,0])\n";
    EXPECT_TRUE(parse_program_path({{"a.script", many}}));
}

}  // namespace
}  // namespace seamwright
