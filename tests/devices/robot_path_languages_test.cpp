// Robot programs as their manuals write them, read back as paths: what each language means.
#include <gmock/gmock.h>

#include "devices/exchange/files.h"
#include "devices/registry.h"
#include "tests/devices/robot_programs.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// ---- KRL

TEST(ProgramPath, KrlInlineFormsWithTheirDataListAndConfig) {
    const std::string config =
        "DEFDAT $CONFIG PUBLIC\nDECL FRAME BASE_DATA[32]\nBASE_DATA[1]={FRAME: X 0,Y 0,Z 0,A 0,B 0,C 0}\n"
        "BASE_DATA[2]={FRAME: X 1000.0,Y -500.0,Z 250.0,A 45.0,B 0.0,C 0.0}\nENDDAT\n";
    ProgramPath path = parsed("BEAD.SRC", kInline, {}, {{"bead.dat", kInlineData}, {"$config.dat", config}});
    ASSERT_EQ(path.points.size(), 3U);
    EXPECT_EQ(path.count(LineKind::not_understood), 0U);
    EXPECT_THAT(path.tools, ElementsAre("TOOL_DATA[1]"));
    EXPECT_EQ(path.points[0].motion, ProgramMotion::joint);
    EXPECT_EQ(path.points[0].name, "XP1");
    EXPECT_EQ(path.points[0].line, 25);
    EXPECT_EQ(path.points[0].frame, "BASE_DATA[2]");
    EXPECT_EQ(path.points[2].frame, "BASE_DATA[2]");
    const Pose door = kuka(1000, -500, 250, 45);
    expect_pose(in_base(path.points[0]), door * kuka(10, 20, 30, 90, 0, 180), "P1");
    expect_pose(in_base(path.points[2]), door * kuka(110, 120, 30, 90, 0, 180), "P3");
    EXPECT_THAT(why_at(path, 18), HasSubstr("left out: joint values"));
    EXPECT_THAT(why_at(path, 34), HasSubstr("understood"));
    EXPECT_THAT(why_at(path, 39), HasSubstr("passed over: GUN_OFF is not in the files"));
    // Without the controller's file the frame has its name alone.
    path = parsed("BEAD.SRC", kInline, {}, {{"bead.dat", kInlineData}});
    EXPECT_THAT(path.unknown_frames(), ElementsAre("BASE_DATA[2]"));
    const auto refused = application_path(path, false);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("does not say where BASE_DATA[2] is"));
    const auto own = application_path(path, true);
    ASSERT_TRUE(own);
    expect_pose(own->points[1].frame_from_tool, kuka(110, 20, 30, 90, 0, 180), "own frame");
    ProgramPathOptions options;
    options.frames["BASE_DATA[2]"] = door;
    const auto given =
        application_path(parsed("BEAD.SRC", kInline, options, {{"bead.dat", kInlineData}}), false);
    ASSERT_TRUE(given);
    expect_pose(given->points[1].frame_from_tool, door * kuka(110, 20, 30, 90, 0, 180), "given frame");
    // Without the data list every motion is named.
    const ProgramPath blind = parsed("BEAD.SRC", kInline);
    EXPECT_EQ(blind.points.size(), 0U);
    EXPECT_THAT(why_at(blind, 25), HasSubstr("not understood: XP1 is not known from the program"));
    EXPECT_THAT(why_at(blind, 32), HasSubstr("not understood: XP2"));
}

TEST(ProgramPath, KrlOffsetsRelativeMovesPartialPositionsAndLoops) {
    const ProgramPath path = parsed("t.src", R"(DEF t()
DECL FRAME SHIFT
DECL INT I
$BASE={X 100,Y 0,Z 0,A 90,B 0,C 0}
$TOOL=TOOL_DATA[3]
SHIFT={X 0,Y 0,Z 5,A 0,B 0,C 0}
LIN {X 0,Y 0,Z 0,A 0,B 0,C 90}
LIN {X 10}
LIN_REL {Y 7}
LIN_REL {Z 4} #TOOL
LIN $NULLFRAME:SHIFT C_DIS
FOR I=1 TO 3
  SHIFT.X=I*10
  LIN SHIFT
ENDFOR
IF $IN[3]==TRUE THEN
  LIN {X 99}
ENDIF
LIN {X 1}
END
)");
    ASSERT_GE(path.points.size(), 8U);
    const Pose base = kuka(100, 0, 0, 90);
    const auto at = [&](std::size_t i) { return path.points[i].frame_from_tool; };
    expect_pose(in_base(path.points[0]), base * kuka(0, 0, 0, 0, 0, 90), "absolute");
    expect_pose(at(1), kuka(10, 0, 0, 0, 0, 90), "only X");
    expect_pose(at(2), kuka(10, 7, 0, 0, 0, 90), "relative in base");
    expect_pose(at(3), kuka(10, 7, 0, 0, 0, 90) * kuka(0, 0, 4), "relative in tool");
    expect_pose(at(4), kuka(0, 0, 5), "geometric operator");
    expect_pose(at(7), kuka(30, 0, 5), "loop");
    EXPECT_EQ(path.points[7].line, 14);
    EXPECT_EQ(path.points.size(), 8U);
    EXPECT_THAT(why_at(path, 17), HasSubstr("not understood: it hangs on $IN[3], which only the cell knows"));
    EXPECT_THAT(why_at(path, 19), HasSubstr("not understood"));  // nobody knows where the robot stands
    const auto refused = application_path(path, false);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("2 lines are not understood, the first: LIN {X 99}"));
    EXPECT_THAT(refused.error().sentence(), HasSubstr("t.src, line 17"));
}

TEST(ProgramPath, ACircleLiesWithinItsChordErrorAndEndsWhereItShould) {
    ProgramPathOptions options;
    options.chord_mm = 0.02;
    const ProgramPath path = parsed("c.src", R"(DEF c()
$BASE=$NULLFRAME
LIN {X 100,Y 0,Z 0,A 0,B 0,C 0}
CIRC {X 0,Y 100,Z 0,A 0,B 0,C 0},{X -100,Y 0,Z 0,A 90,B 0,C 0} C_DIS
SCIRC {X 0,Y -100,Z 0,A 0,B 0,C 0},{X 100,Y 0,Z 0,A 0,B 0,C 0}, CA 90
END
)",
                                    options);
    EXPECT_EQ(path.count(LineKind::not_understood), 0U);
    std::size_t half = 0;
    for (std::size_t i = 1; i < path.points.size(); ++i) {
        const Eigen::Vector3d p = path.points[i].frame_from_tool.translation(),
                              q = path.points[i - 1].frame_from_tool.translation();
        EXPECT_NEAR(p.norm(), 100, 1e-9);
        EXPECT_LE(100 - (0.5 * (p + q)).norm(), 0.0201);
        EXPECT_GT(p.x() * q.y() - p.y() * q.x(), -100 * 100 * 2.0);
        if (path.points[i].line == 4) half = i;
    }
    expect_pose(path.points[half].frame_from_tool, kuka(-100, 0, 0, 90), "end of CIRC");
    // The middle of the half circle has half of the turn.
    const auto middle = std::find_if(path.points.begin() + 1, path.points.end(), [](const ProgramPoint& p) {
        return p.frame_from_tool.translation().x() < 1;
    });
    const double share =
        std::atan2(middle->frame_from_tool.translation().y(), middle->frame_from_tool.translation().x()) /
        kPi;
    EXPECT_NEAR(kuka_from_rotation(middle->frame_from_tool.linear()).a_deg, 90 * share, 1e-6);
    // A quarter of the second one: from (-100, 0) towards (0, -100).
    EXPECT_NEAR(path.points.back().frame_from_tool.translation().y(), -100, 1e-9);
}

TEST(ProgramPath, AKrlDataListAloneGivesItsPositionsInOrder) {
    const ProgramPath path = parsed("bead.dat", kInlineData);
    ASSERT_EQ(path.points.size(), 3U);
    EXPECT_EQ(path.points[1].name, "XP2");
    EXPECT_THAT(path.remarks.front().english(), HasSubstr("a data list says no motions"));
}

// ---- RAPID

TEST(ProgramPath, RapidWorkObjectsOffsetsArraysAndCalls) {
    const ProgramPath path = parsed("Bead.mod", R"(%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE Bead
  PERS wobjdata wobjDoor:=[FALSE,TRUE,"",[[1000,0,500],[0.707106781,0,0,0.707106781]],[[10,0,0],[1,0,0,0]]];
  PERS tooldata tNozzle:=[TRUE,[[0,0,200],[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];
  CONST robtarget p10:=[[0,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pEdge{3}:=[[[100,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
    [[200,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],
    [[300,0,0],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]];
  CONST jointtarget jHome:=[[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR num nGap:=5;
  PROC main()
    MoveAbsJ jHome,v1000,z50,tNozzle;
    rBead 2;
    MoveAbsJ jHome\NoEOffs,v1000,z50,tNozzle;
  ENDPROC
  PROC rBead(num n)
    VAR robtarget pHere;
    MoveJ Offs(p10,0,0,50),v500,z10,tNozzle\WObj:=wobjDoor;
    MoveL p10,v100,fine,tNozzle\WObj:=wobjDoor;
    SetDO doGun,1;
    FOR i FROM 1 TO Dim(pEdge,1) DO
      MoveL pEdge{i},v100,z1,tNozzle\WObj:=wobjDoor;
    ENDFOR
    MoveL RelTool(pEdge{3},0,0,-10\Rz:=90),v100,z1,tNozzle\WObj:=wobjDoor;
    pHere:=p10; pHere.trans.z:=nGap*n;
    ArcL pHere,v100,seam1,weld1,z1,tNozzle\WObj:=wobjDoor;
    PDispSet [[1,2,3],[1,0,0,0]];
    TriggL p10,v100,gunOn,z1,tNozzle\WObj:=wobjDoor;
    PDispOff;
    pHere:=CRobT(\Tool:=tNozzle\WObj:=wobjDoor);
    MoveL pHere,v100,z1,tNozzle\WObj:=wobjDoor;
    IF diReady=1 MoveL p10,v100,z1,tNozzle\WObj:=wobjDoor;
    TEST n
      CASE 1: MoveL pEdge{1},v100,z1,tNozzle\WObj:=wobjDoor;
      CASE 2,3: MoveL pEdge{2},v100,z1,tNozzle\WObj:=wobjDoor;
      DEFAULT: Stop;
    ENDTEST
  ERROR
    MoveL p10,v100,fine,tool0;
    RETRY;
  ENDPROC
ENDMODULE
)");
    EXPECT_EQ(path.routine, "main");
    const Pose frame = make_pose(rotation_from_kuka({90, 0, 0}), {1000, 10, 500});
    const Eigen::Matrix3d down = rotation_from_abb({0, 1, 0, 0}, "").value();
    const std::vector<Pose> wanted = {
        make_pose(down, {0, 0, 50}),
        make_pose(down, {0, 0, 0}),
        make_pose(down, {100, 0, 0}),
        make_pose(down, {200, 0, 0}),
        make_pose(down, {300, 0, 0}),
        make_pose(down, {300, 0, 0}) * make_pose(rotation_from_kuka({90, 0, 0}), {0, 0, -10}),
        make_pose(down, {0, 0, 10}),
        make_pose(down, {1, 2, 3}),
        make_pose(down, {200, 0, 0})};
    ASSERT_EQ(path.points.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
        expect_pose(in_base(path.points[i]), frame * wanted[i], "point " + std::to_string(i + 1), 1e-5, 1e-7);
    EXPECT_EQ(path.points[2].name, "pedge[i]");
    EXPECT_EQ(path.points[0].motion, ProgramMotion::joint);
    EXPECT_THAT(path.tools, ElementsAre("tnozzle"));
    EXPECT_THAT(why_at(path, 15), HasSubstr("left out"));
    EXPECT_THAT(why_at(path, 34),
                HasSubstr("not understood: "));  // CRobT: where the robot is only the robot knows
    EXPECT_THAT(why_at(path, 35), HasSubstr("not understood: it hangs on diready"));
    EXPECT_EQ(path.count(LineKind::not_understood), 2U);
}

TEST(ProgramPath, RapidSaysWhichRoutineIsMeantOrAsks) {
    const std::string two =
        "MODULE m\nCONST robtarget p:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
        "PROC left()\nMoveL p,v10,fine,tool0;\nENDPROC\nPROC right()\nMoveL "
        "p,v10,fine,tool0;\nENDPROC\nENDMODULE\n";
    const auto asked = parse_program_path({{"m.mod", two}});
    ASSERT_FALSE(asked);
    EXPECT_THAT(asked.error().sentence(), HasSubstr("2 routines move the robot: left, right"));
    ProgramPathOptions options;
    options.routine = "RIGHT";
    EXPECT_EQ(parsed("m.mod", two, options).points.at(0).line, 7);
    options.routine = "middle";
    EXPECT_FALSE(parse_program_path({{"m.mod", two}}, options));
}

// ---- FANUC

TEST(ProgramPath, FanucMotionsOffsetsRegistersAndFrames) {
    ProgramPathOptions options;
    const Pose uf2 = kuka(1000, 2000, 300, 10, 20, 30);
    options.frames["UF 2"] = uf2;
    const ProgramPath path = parsed("BEAD.LS", kTp, options);
    const Eigen::Matrix3d r = rotation_from_fanuc({180, 0, 30});
    ASSERT_FALSE(path.points.empty());
    expect_pose(in_base(path.points[0]), uf2 * make_pose(r, {100, 0, 10}), "P[2]");
    EXPECT_EQ(path.points[0].line, 12);
    std::vector<ProgramPoint> straight;
    for (const ProgramPoint& p : path.points)
        if (p.motion == ProgramMotion::linear) straight.push_back(p);
    ASSERT_EQ(straight.size(), 4U);
    expect_pose(straight[1].frame_from_tool, make_pose(r, {-95, 0, 8}), "offset");
    expect_pose(straight[2].frame_from_tool, make_pose(r, {-100, 0, 10}) * kuka(5, 0, -2), "tool offset");
    expect_pose(straight[3].frame_from_tool, kuka(5, 5, 5), "P[R[1]]");
    EXPECT_THAT(path.tools, ElementsAre("UT 1"));
    EXPECT_THAT(why_at(path, 11), HasSubstr("left out: joint values"));
    EXPECT_THAT(why_at(path, 14), HasSubstr("point"));
    EXPECT_THAT(why_at(path, 25), HasSubstr("not understood: P[6] is not known from the program"));
    EXPECT_THAT(why_at(path, 28), HasSubstr("not understood: it hangs on"));
    EXPECT_THAT(why_at(path, 30), HasSubstr("not understood: where this relative motion begins"));
    EXPECT_THAT(parsed("BEAD.LS", kTp).unknown_frames(), ElementsAre("UF 2"));
}

// ---- URScript

TEST(ProgramPath, UrScriptAsPolyScopeSavesIt) {
    const ProgramPath path = parsed("bead.script", R"(def bead():
  set_tcp(p[0.0,0.0,0.2,0.0,0.0,0.0])
  set_payload(1.5, [0.0, 0.0, 0.0])
  step_count_1 = 0.0
  thread Step_Counter_Thread():
    while (True):
      step_count_1 = step_count_1 + 1.0
      sync()
    end
  end
  global Plane_1=p[0.5, 0.0, 0.1, 0.0, 0.0, 1.5707963267948966]
  global Waypoint_1_p=p[.1, 0.2, 0.3, 0.0, 3.14159, 0.0]
  global Waypoint_1_q=[-1.6, -1.72, -2.2, -0.8, 1.59, -0.03]
  while (True):
    $ 1 "Robot Program"
    $ 2 "MoveJ"
    movej(Waypoint_1_q, a=1.4, v=1.05)
    movel(Waypoint_1_p, a=1.2, v=0.25, r=0.001)
    movel(pose_trans(Plane_1, p[0.01, 0, 0, 0, 0, 0]), a=1.2, v=0.25)
    set_digital_out(1, True)
    movec(p[0.5,0.1,0.1,0,0,0], pose_add(p[0.4,0.2,0.1,0,0,0], p[0,0,0,0,0,0]), a=1.2, v=0.25, r=0, mode=1)
    local here = get_actual_tcp_pose()
    movep(pose_trans(here, p[0, 0, 0.01, 0, 0, 0]))
    if (get_standard_digital_in(3)):
      movel(Waypoint_1_p)
    end
    i = 0
    while i < 2:
      i = i + 1
      movel(p[0.1*i, 0, 0, d2r(90), 0, 0])
    end
    movej([0,0,0,0,0,0])
  end
end
)");
    EXPECT_EQ(path.routine, "bead");
    EXPECT_EQ(path.count(LineKind::not_understood), 1U);
    EXPECT_THAT(why_at(path, 25), HasSubstr("not understood: it hangs on get_standard_digital_in(3)"));
    EXPECT_THAT(why_at(path, 17), HasSubstr("left out"));
    EXPECT_THAT(why_at(path, 32), HasSubstr("left out"));
    ASSERT_GE(path.points.size(), 6U);
    expect_pose(path.points[0].frame_from_tool, make_pose(rotation_from_ur({0, 3.14159, 0}), {100, 200, 300}),
                "waypoint");
    expect_pose(path.points[1].frame_from_tool, make_pose(rotation_from_kuka({90, 0, 0}), {500, 10, 100}),
                "plane");
    const ProgramPoint& last = path.points.back();
    expect_pose(last.frame_from_tool, make_pose(rotation_from_ur({kPi / 2, 0, 0}), {200, 0, 0}), "loop");
    const auto p = path.points.end() - 3;
    EXPECT_NEAR(p->frame_from_tool.translation().z(), 110, 1e-9);
    EXPECT_THAT(path.remarks.front().english(), HasSubstr("is read once"));
}

TEST(ProgramPath, LinesOfUrScriptOutsideOfAnyProgram) {
    const ProgramPath path = parsed("x.script",
                                    "movel(p[0.1,0.2,0.3,0,0,0])\nmovel(p[0.2,0.2,0.3,0,0,0], 1.2, 0.25, 0, "
                                    "0.01)\nspeedl([0,0,1,0,0,0])\n");
    EXPECT_EQ(path.points.size(), 2U);
    EXPECT_EQ(path.count(LineKind::not_understood), 1U);
}

// ---- APT

TEST(ProgramPath, AptPointsAxesCirclesAndUnits) {
    const std::string text =
        "PARTNO DOOR, LEFT\n$$ a "
        "comment\nUNITS/INCHES\nMULTAX/ON\nLOADTL/1,1\nFROM/0.0,0.0,1.0,0.0,0.0,1.0\nFEDRAT/10.0,IPM\n"
        "GOTO/1.0,0.0,0.0,$\n   "
        "0.0,0.0,1.0\nCIRCLE/0.0,0.0,0.0,0.0,0.0,1.0,1.0\nGOTO/0.0,1.0,0.0\nGODLTA/0.5\nGOTO/"
        "0,2,0,0,0.6,0.8\n"
        "TRANS/1,2,3\nFINI\n";
    const ProgramPath path = parsed("door.apt", text);
    ASSERT_GE(path.points.size(), 5U);
    EXPECT_EQ(path.count(LineKind::not_understood), 1U);
    EXPECT_THAT(why_at(path, 14), HasSubstr("not understood"));
    const auto at = [&](std::size_t i) {
        return Eigen::Vector3d(path.points[i].frame_from_tool.translation());
    };
    EXPECT_LT((at(0) - Eigen::Vector3d(0, 0, 25.4)).norm(), 1e-9);
    EXPECT_LT((at(1) - Eigen::Vector3d(25.4, 0, 0)).norm(), 1e-9);
    for (std::size_t i = 2; i + 2 < path.points.size(); ++i) {
        EXPECT_NEAR(at(i).norm(), 25.4, 1e-9);
        EXPECT_GE(at(i).x(), -1e-9);
    }
    EXPECT_LT((at(path.points.size() - 2) - Eigen::Vector3d(0, 25.4, 12.7)).norm(), 1e-9);
    // z against the axis that the record names, x across it.
    EXPECT_LT((path.points.back().frame_from_tool.linear().col(2) + Eigen::Vector3d(0, 0.6, 0.8)).norm(),
              1e-9);
    EXPECT_NEAR(path.points.back().frame_from_tool.linear().determinant(), 1, 1e-9);
    // Without UNITS nobody knows.
    ProgramPathOptions options;
    const std::string bare = "GOTO/1,0,0,0,0,1\nGOTO/2,0,0,0,0,1\n";
    EXPECT_EQ(parsed("a.cl", bare).count(LineKind::not_understood), 2U);
    options.unit_mm = 1;
    EXPECT_EQ(parsed("a.cl", bare, options).points.size(), 2U);
    // CATIA's circle: a quarter from (0, 5) about (5, 5) to (5, 10), clockwise.
    const ProgramPath catia = parsed("c.aptsource",
                                     "UNITS/MM\nGOTO/0,5,0,0,0,1\nINDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/ "
                                     "5,5,0,$\n 5),ON,(LINE/ 5,5,0,$\n 5,10,0)\n");
    EXPECT_EQ(catia.count(LineKind::not_understood), 0U);
    EXPECT_LT((catia.points.back().frame_from_tool.translation() - Eigen::Vector3d(5, 10, 0)).norm(), 1e-9);
    for (const ProgramPoint& p : catia.points) EXPECT_LE(p.frame_from_tool.translation().x(), 5 + 1e-9);
}

// ---- their files

TEST(ProgramFiles, AllAreWrittenOrNone) {
    const TemporaryFolder folder;
    const auto out = folder.path() / "krc" / "R1";
    const auto text = [&](const char* name) { return read_text_file(out / name).value_or("none"); };
    ASSERT_TRUE(write_program_files(out, {{"a.src", "old a"}, {"b.dat", "old b"}}));
    std::filesystem::create_directory(out / "c.src");
    const auto refused =
        write_program_files(out, {{"a.src", "new a"}, {"b.dat", "new b"}, {"c.src", "new c"}});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("c.src"));
    EXPECT_EQ(text("a.src"), "old a");
    EXPECT_EQ(text("b.dat"), "old b");
    const auto files = [&] { return std::distance(std::filesystem::directory_iterator(out), {}); };
    EXPECT_EQ(files(), 3) << "nothing is left beside them";
    std::filesystem::remove(out / "c.src");
    const auto written = write_program_files(out, {{"a.src", "new a"}, {"c.src", "new c"}});
    ASSERT_TRUE(written) << written.error().sentence();
    EXPECT_THAT(*written, ElementsAre(out / "a.src", out / "c.src"));
    EXPECT_EQ(text("a.src"), "new a");
    EXPECT_EQ(text("c.src"), "new c");
    EXPECT_EQ(files(), 3);
}

}  // namespace
}  // namespace seamwright
