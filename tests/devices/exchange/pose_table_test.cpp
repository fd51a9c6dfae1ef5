#include "devices/exchange/tables/pose_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/exchange/tables/pose_names.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

Pose turned(double x, double y, double z, double about_z_deg) {
    Pose p = Pose::Identity();
    p.translation() = Eigen::Vector3d(x, y, z);
    p.linear() =
        Eigen::AngleAxisd(about_z_deg * 3.14159265358979 / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return p;
}
const Pose kFirst = turned(800, -50, 600, 90), kSecond = turned(820, 10, 610, -30);

void expect_poses(const std::string& text, const PoseLayout& layout = {}) {
    const auto table = parse_pose_table(text, "poses.txt", layout);
    ASSERT_TRUE(table) << table.error().sentence() << "\n" << text;
    ASSERT_EQ(table->poses.size(), 2u) << text;
    EXPECT_TRUE(table->poses[0].pose.isApprox(kFirst, 1e-6)) << text << table->poses[0].pose.matrix();
    EXPECT_TRUE(table->poses[1].pose.isApprox(kSecond, 1e-6)) << text << table->poses[1].pose.matrix();
}
void expect_no_poses(const std::string& text, const std::string& words, const PoseLayout& layout = {}) {
    const auto table = parse_pose_table(text, "poses.txt", layout);
    ASSERT_FALSE(table) << text;
    EXPECT_THAT(table.error().sentence(), HasSubstr(words)) << text;
    EXPECT_EQ(table.error().sentence().find('\n'), std::string::npos);
}

TEST(PoseTable, EveryFormOfTwoPoses) {
    expect_poses("name,x,y,z,a,b,c\nS1,800,-50,600,90,0,0\nS2,820,10,610,-30,0,0\n");
    expect_poses(
        "file;X [m];Y [m];Z [m];W [deg];P [deg];R "
        "[deg]\nS1;0,8;-0,05;0,6;0;0;90\nS2;0,82;0,01;0,61;0;0;-30\n");
    expect_poses(
        "x,y,z,qw,qx,qy,qz\n800,-50,600,0.70710678118,0,0,0.70710678118\n"
        "820,10,610,0.9659258262890683,0,0,-0.25881904510252074\n");
    expect_poses("800 -50 600 90 0 0\n820 10 610 -30 0 0\n", {"kuka-abc", "", ""});
    expect_poses("800\t-50\t600\t0\t0\t90\n820\t10\t610\t0\t0\t-30\n", {"fanuc-wpr", "", ""});
    expect_poses("S1 800 -50 600 0 0 90\nS2 820 10 610 0 0 -30\n", {"rpy", "", ""});
    expect_poses("1 800 -50 600 0 0 90\n2 820 10 610 0 0 -30\n", {"rpy", "", ""});
    expect_poses("0.8 -0.05 0.6 0 0 1.5707963267948966\n0.82 0.01 0.61 0 0 -0.5235987755982988\n",
                 {"ur-rotvec", "m", ""});
    expect_poses(
        "0.8, -0.05, 0.6, 0, 0, 0.70710678118, 0.70710678118\n"
        "0.82, 0.01, 0.61, 0, 0, -0.25881904510252074, 0.9659258262890683\n",
        {"quat-xyzw", "m", ""});
    const std::string matrices =
        "0 -1 0 800\n1 0 0 -50\n0 0 1 600\n0 0 0 1\n\n0.8660254037844387 0.5 0 820\n-0.5 0.8660254037844387 "
        "0 10\n0 0 1 "
        "610\n0 0 0 1\n";
    expect_poses(matrices);
    expect_poses(
        "0,-1,0,800,1,0,0,-50,0,0,1,600,0,0,0,1\n0.8660254037844387,0.5,0,820,-0.5,0.8660254037844387,0,10,"
        "0,0,1,610,0,0,0,1\n");
    expect_poses(
        "{\"S1\":{\"xyz\":[800,-50,600],\"abc\":[90,0,0]},\"S2\":{\"xyz\":[820,10,610],\"abc\":[-30,0,0]}}");
    expect_poses(
        "/PROG  SCAN\n/ATTR\n/MN\n   1:L P[1] 100mm/sec FINE ;\n/POS\nP[1:\"S1\"]{\n   GP1:\n\tUF : 0, UT : "
        "1,\t\tCONFIG "
        ": 'N U T, 0, 0, 0',\n\tX =   800.000  mm,\tY =   -50.000  mm,\tZ =   600.000  mm,\n\tW =     0.000 "
        "deg,\tP =     "
        "0.000 deg,\tR =    90.000 deg\n};\nP[2]{\n   GP1:\n\tUF : 0, UT : 1,\t\tCONFIG : 'N U T, 0, 0, "
        "0',\n\tX =   "
        "820.000  mm,\tY =    10.000  mm,\tZ =   610.000  mm,\n\tW =     0.000 deg,\tP =     0.000 deg,\tR = "
        "  -30.000 "
        "deg\n};\n/END\n");
}

TEST(PoseTable, UnitsAndConventionsAreAsked) {
    expect_no_poses("800 -50 600 90 0 0\n820 10 610 -30 0 0\n", "--pose-convention");
    expect_no_poses("800 -50 600 1 0 0 0\n", "quat-wxyz or quat-xyzw");
    expect_no_poses("x,y,z,a,b,c\n0.8,-0.05,0.6,90,0,0\n", "--pose-unit");
    expect_no_poses("x,y,z,a,b,c\n800,-50,600,1.57,0,0\n800,-50,600,1.2,0.1,0\n", "--pose-angle");
    expect_no_poses("x,y,z,rx,ry,rz\n800,-50,600,1.57,0,0\n", "--pose-convention");
    expect_no_poses("800 -50 600 90 0 0\n", "--pose-angle", {"ur-rotvec", "", ""});
    expect_no_poses("x,y,z,a,b,c\n800000,-50,600,90,0,0\n", "--pose-unit");
    expect_no_poses("x,y,z,a,b,c\n800,-50,600,90,0,0\n0.81,-0.04,0.62,90,0,0\n790,-60,610,90,0,0\n",
                    "metres among");
}

TEST(PoseTable, HostileTables) {
    expect_no_poses("", "empty");
    expect_no_poses("hello\n", "");
    expect_no_poses("x,y,z,a,b,c\n1,2,3\n", "line 2");
    expect_no_poses("x,y,z,a,b,c\n800,2,3,4,nan,6\n", "line 2");
    expect_no_poses("name,x,y,z,a,b,c\nS1,800,0,0,90,0,0\nS1,800,0,0,90,0,0\n", "twice");
    expect_no_poses("0 -1 0 800\n1 0 0 -50\n0 0 1 600\n", "4x4");
    expect_no_poses("0 1 0 0\n-1 0 0 0\n0 0 1 0\n800 -50 600 1\n", "transposed");
    expect_no_poses("2 0 0 800\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "line 1");
    expect_no_poses("/PROG A\n/POS\nP[1]{ GP1: UF : 0, UT : 1, X = 1 mm", "cut short");
    expect_no_poses("/PROG A\n/POS\nP[1]{ GP1: UF : 0, UT : 1, J1 = 0 deg };", "joint");
    expect_no_poses("/PROG A\n/POS\n/END\n", "no positions");
    expect_no_poses(std::string("\xFF\xFEx\0", 4), "UTF-16");
}

using Frames = std::vector<std::string>;
const std::string kSecondRow = "820,10,610,-30,0,0", kFirstRow = "800,-50,600,90,0,0";

// Both poses, the second before the first, as `first_frame` and the other take them.
void expect_named(const std::string& text, const Frames& frames, const std::string& words,
                  const PoseLayout& layout = {}) {
    const auto table = parse_pose_table(text, "t", layout);
    ASSERT_TRUE(table) << table.error().sentence() << "\n" << text;
    const auto found = poses_of_frames(*table, frames, "t");
    ASSERT_TRUE(found) << found.error().sentence() << "\n" << text;
    EXPECT_TRUE(found->poses[0].isApprox(kFirst, 1e-6)) << text << found->understood;
    EXPECT_TRUE(found->poses[1].isApprox(kSecond, 1e-6)) << text << found->understood;
    EXPECT_THAT(found->understood, HasSubstr(words)) << text;
}
void expect_unnamed(const std::string& text, const Frames& frames, const std::string& words,
                    const PoseLayout& layout = {}) {
    const auto table = parse_pose_table(text, "t", layout);
    ASSERT_TRUE(table) << table.error().sentence() << "\n" << text;
    const auto found = poses_of_frames(*table, frames, "t");
    ASSERT_FALSE(found) << found->understood << "\n" << text;
    EXPECT_THAT(found.error().sentence(), HasSubstr(words)) << text;
}

TEST(PoseTable, PosesFindTheirFrames) {
    const std::string named = "name,x,y,z,a,b,c\nS2," + kSecondRow + "\nS1.csv," + kFirstRow + "\n";
    expect_named(named, {"S1.csv", "S2.csv"}, "by the names in the column \"name\"");
    expect_unnamed(named, {"S1.csv", "S2.csv", "S3.csv"}, "S3.csv");
    expect_named("no,x,y,z,a,b,c\n2," + kSecondRow + "\n1," + kFirstRow + "\n",
                 {"scan_0001.txt", "scan_0002.txt"}, "\"no\"");
    const std::string bare = "800 -50 600 90 0 0\n820 10 610 -30 0 0\n";
    const PoseLayout kuka{"kuka-abc", "", ""};
    expect_named(bare, {"S1.csv", "S2.csv"}, "BY ORDER", kuka);
    expect_named(bare, {"S1.csv", "S2.csv"}, "S2.csv takes t, line 2", kuka);
    expect_unnamed(bare, {"S1.csv", "S2.csv", "S3.csv"}, "2 poses for 3 frames", kuka);
    expect_named("S2 820 10 610 -30 0 0\nS1 800 -50 600 90 0 0\n", {"S1.csv", "S2.csv"}, "by name", kuka);
    expect_named(
        "{\"S2\":{\"xyz\":[820,10,610],\"abc\":[-30,0,0]},\"S1\":{\"xyz\":[800,-50,600],\"abc\":[90,0,0]}}",
        {"S1.csv", "S2.csv"}, "by name");
}

TEST(PoseTable, AColumnOfTheFramesNamesNamesThePosesWhateverItsTitle) {
    for (const char* title :
         {"Punkt", "Messstelle", "Nummer", "Naht", "Bezeichnung", "Stelle", "Spot-ID", "Pose-Name",
          "position", "Point name", "\xE7\x82\xB9", "target", "P", "A", ""}) {
        const std::string first = fmt::format("{},x,y,z,a,b,c\n", title);
        const std::string rows = fmt::format("S4,{}\nS2,{}\n", kSecondRow, kFirstRow);
        expect_named(first + rows, {"S2.csv", "S4.csv"}, title);
        // last, and beside columns that name nothing
        const std::string last = fmt::format("x,y,z,a,b,c,E1,Werkzeug,{0}\n{1},0,T1,S4\n{2},0,T1,S2\n", title,
                                             kSecondRow, kFirstRow);
        if (*title) expect_named(last, {"S2.csv", "S4.csv"}, title);
    }
    // A point "P" before W, P and R.
    expect_named("P,x,y,z,w,p,r\n2,820,10,610,0,0,-30\n1,800,-50,600,0,0,90\n", {"S1.csv", "S2.csv"},
                 "\"P\"");
    // Numbers that are the numbers asked for, as those of the profiles of one file.
    expect_named("Nummer,x,y,z,a,b,c\n8," + kSecondRow + "\n5," + kFirstRow + "\n", {"5", "8"}, "\"Nummer\"");
    // Names in capitals, with blanks, folders and other extensions.
    for (const char* as : {"s1.CSV", " S1 ", "S1.csv", "S1.png", "S 1", "C:\\scans\\S1.csv", "scans/s1"})
        expect_named(fmt::format("Punkt;x;y;z;a;b;c\nS2;820;10;610;-30;0;0\n{};800;-50;600;90;0;0\n", as),
                     {"S1.csv", "S2.csv"}, "Punkt");
    // A running number does not outvote names.
    expect_named("Nr,Punkt,x,y,z,a,b,c\n1,S2," + kSecondRow + "\n2,S1," + kFirstRow + "\n",
                 {"S1.csv", "S2.csv"}, "Punkt");
    // A point's title says that it names: what came before it does not decide.
    expect_named("from,name,x,y,z,a,b,c\nS1,S2," + kSecondRow + "\nS2,S1," + kFirstRow + "\n",
                 {"S1.csv", "S2.csv"}, "\"name\"");
}

TEST(PoseTable, NamesThatDoNotFitAreNotTakenForTheOrder) {
    const auto table = [](const std::string& title, const std::string& one, const std::string& other) {
        return fmt::format("{},x,y,z,a,b,c\n{},{}\n{},{}\n", title, one, kSecondRow, other, kFirstRow);
    };
    const Frames frames{"S1.csv", "S2.csv"};
    expect_unnamed(table("Punkt", "S2", "S7"), frames, "\"Punkt\" names no pose of S1.csv");
    expect_unnamed(table("Punkt", "S2", "S2"), frames, "twice");
    expect_unnamed(table("Punkt", "left", "right"), frames, "\"Punkt\" names no pose of S1.csv");
    expect_unnamed(table("Punkt", "S2", ""), frames, "\"Punkt\" names no pose of S1.csv");
    expect_unnamed(table("Nummer", "2", "3"), frames, "\"Nummer\" names no pose of S1.csv");
    expect_unnamed(table("A1,B1", "S1,S2", "S2,S1"), frames, "\"A1\" and \"B1\" name the poses differently");
    expect_unnamed(table("Nr,Punkt", "1,S2", "2,S7"), frames, "name the poses differently");
    // What names nothing: a speed, a time, a tool for all, a column that is mostly empty.
    for (const auto& [one, other] : {std::pair{"250", "300"},
                                     {"0.5", "1.5"},
                                     {"T1", "T1"},
                                     {"", "noch einmal"},
                                     {"14:03:11", "14:03:19"},
                                     {"2026-11-28T14:03:11Z", "2026-11-28T14:03:19Z"}}) {
        const Frames turned{"S2.csv", "S1.csv"};
        const auto read = parse_pose_table(table("v", one, other), "t", {});
        ASSERT_TRUE(read) << read.error().sentence();
        const auto found = poses_of_frames(*read, turned, "t");
        ASSERT_TRUE(found) << one << found.error().sentence();
        EXPECT_TRUE(found->poses[0].isApprox(kSecond, 1e-6)) << one;
        EXPECT_THAT(found->understood, HasSubstr("BY ORDER")) << one;
    }
    expect_no_poses("x,x,y,z,a,b,c\n1,2,3,4,5,6,7\n", "\"x\" twice");
    expect_no_poses("800 -50 600 1 0 0 0\nS2 -50 600 1 0 0 0\n", "line 2", {"quat-wxyz", "", ""});
}

const std::string kDataList = R"(&ACCESS RVP
&REL 1
DEFDAT  DOOR PUBLIC
;FOLD EXTERNAL DECLARATIONS;%{PE}%MKUKATPBASIS
EXT  BAS (BAS_COMMAND  :IN,REAL  :IN )
;ENDFOLD
DECL E6AXIS XHOME={A1 0.0,A2 -90.0,A3 90.0,A4 0.0,A5 0.0,A6 0.0,E1 0.0}
DECL FDAT FHOME={TOOL_NO 9,BASE_NO 0,IPO_FRAME #BASE,POINT2[] " ",TQ_STATE FALSE}
DECL E6POS XP1={X 800.000,Y -50.0000,Z 6.0E+02,A 90.0000,B 0.0,C 0.0,S 2,T 35,E1 0.0,E2 0.0,E3 0.0,E4 0.0,E5 0.0,E6 0.0}
DECL FDAT FP1={TOOL_NO 3,BASE_NO 1,IPO_FRAME #BASE,POINT2[] " "}
decl e6pos xp2={x 820.0,y 10.0,z 610.0,a -30.0,b 0.0,c 0.0}
DECL FDAT FP2={TOOL_NO 3,BASE_NO 1,IPO_FRAME #BASE,POINT2[] " "}
DECL LDAT LCPDAT1={VEL 2.0,ACC 100.0,APO_DIST 100.0}
ENDDAT
)";

TEST(PoseTable, PointsOfAKukaDataList) {
    expect_poses(kDataList);
    const auto table = parse_pose_table(kDataList, "door.dat", {});
    ASSERT_TRUE(table) << table.error().sentence();
    EXPECT_THAT(table->names.front().cells, testing::ElementsAre("P1", "P2"));
    EXPECT_THAT(table->understood, HasSubstr("BASE_DATA[1], TOOL_DATA[3]"));
    EXPECT_THAT(table->poses[1].at, HasSubstr("line 11"));
    EXPECT_TRUE(poses_of_frames(*table, std::vector<std::string>{"p2.csv", "p1.csv"}, "x"));

    const std::string list =
        "DEFDAT D\nDECL FRAME F={X 1,Y 2,Z 3,A 0,B 0,C 0}\nDECL E6POS SPOT[2]\n"
        "SPOT[1]={X 800,Y -50,Z 600,A 90,B 0,C 0}\nSPOT[2]={E6POS: X 820,Y 10,Z 610,A -30,B 0,C 0}\nENDDAT\n";
    expect_poses(list);
    const auto array = parse_pose_table(list, "d.dat", {});
    EXPECT_THAT(array->names.front().cells, testing::ElementsAre("SPOT[1]", "SPOT[2]"));

    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = kDataList;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    expect_no_poses(with("FP2={TOOL_NO 3", "FP2={TOOL_NO 4"),
                    "is in BASE_DATA[1], TOOL_DATA[4], those before");
    expect_no_poses(with("B 0.0,C 0.0,S", "B 0.0,S"), "C is missing");
    expect_no_poses(with("A 90.0000", "A #RIGHT"), "A is no number");
    expect_no_poses(with("X 800.000", "X 800000"), "exceeds 100 m");
    expect_no_poses(with("xp2", "XP1"), "given twice");
    expect_no_poses(kDataList.substr(0, kDataList.find("z 610")), "does not end");
    expect_no_poses(kDataList.substr(0, kDataList.find("DECL E6POS")) + "ENDDAT\n", "joints alone");
    expect_no_poses("DEFDAT D\nENDDAT\n", "declares no E6POS");
}

// Tool and frame of the points undone: a robot that stands at the flange's poses brings its tool where the file says.
TEST(PoseTable, PointsOfAToolInAUserFrame) {
    PoseLayout layout;
    layout.flange_from_tool = turned(10, -20, 180, 35);
    layout.base_from_user_frame = turned(1000, 300, -40, 120);
    const auto table = parse_pose_table(kDataList, "door.dat", layout);
    ASSERT_TRUE(table) << table.error().sentence();
    const Pose brought =
        layout.base_from_user_frame->inverse() * table->poses[1].pose * *layout.flange_from_tool;
    EXPECT_TRUE(brought.isApprox(kSecond, 1e-6)) << brought.matrix();
    EXPECT_THAT(table->understood,
                HasSubstr("brought from the tool to the flange and from the user frame to the robot's base"));
    for (const std::string text : {"S1,800,-50,600,90,0,0\n", R"([{"xyz":[800,-50,600],"abc":[90,0,0]}])"}) {
        PoseLayout tool{"kuka-abc", "", "", layout.flange_from_tool, {}};
        const auto one = parse_pose_table(text, "t", tool);
        ASSERT_TRUE(one) << one.error().sentence();
        EXPECT_TRUE((one->poses[0].pose * *layout.flange_from_tool).isApprox(kFirst, 1e-6)) << text;
    }
    // Who does not say it is told where the file's own numbers are not zero.
    std::string zero = kDataList;
    for (std::size_t at; (at = zero.find("TOOL_NO 3,BASE_NO 1")) != zero.npos;)
        zero.replace(at, 19, "TOOL_NO 0,BASE_NO 0");
    EXPECT_THAT(parse_pose_table(kDataList, "d.dat", {})->understood, HasSubstr("TAKEN AS THE FLANGE"));
    EXPECT_THAT(parse_pose_table(zero, "d.dat", {})->understood, testing::Not(HasSubstr("TAKEN AS")));
}

const std::string kModule = R"(%%%
  VERSION:1
%%%
MODULE Door
    ! robtarget old:=[[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST jointtarget home:=[[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    CONST robtarget S1:=[[800,-50,600],[0.70710678,0,0,0.70710678],
        [0,-1,0,1],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
    LOCAL PERS robtarget s2:=[[820.0,10,610],[0.965925826,0,0,-0.258819045],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    PROC go(robtarget where)
        MoveL where,v100,fine,tool0;
    ENDPROC
ENDMODULE
)";

TEST(PoseTable, PointsOfAnAbbModule) {
    expect_poses(kModule);
    const auto table = parse_pose_table(kModule, "door.mod", {});
    ASSERT_TRUE(table) << table.error().sentence();
    EXPECT_THAT(table->names.front().cells, testing::ElementsAre("s1", "s2"));
    const std::string rest = "[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    const std::string array = "MODULE M\nCONST robtarget p{2}:=[[[800,-50,600],[0.70710678,0,0,0.70710678]," +
                              rest + ",\n[[820,10,610],[0.965925826,0,0,-0.258819045]," + rest +
                              "];\nENDMODULE\n";
    expect_poses(array);
    EXPECT_THAT(parse_pose_table(array, "m", {})->names.front().cells, testing::ElementsAre("p{1}", "p{2}"));

    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = kModule;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    expect_no_poses(with("[0.70710678,0,0,0.70710678]", "[0,0,0,0]"), "line 7");
    expect_no_poses(with("[0.70710678,0,0,0.70710678]", "[0.7,0,0]"), "is not [[x,y,z]");
    expect_no_poses(with("[800,-50,600]", "[800,-50,height]"), "no number");
    expect_no_poses(with("s2:=", "S1:="), "given twice");
    expect_no_poses(
        "MODULE M\nCONST robtarget p{3}:=[[[800,-50,600],[1,0,0,0]],,[[1,2,3],[1,0,0,0]]];\nENDMODULE\n",
        "p{2} is not");
    expect_no_poses("MODULE M\nCONST robtarget p{2}:=[[[800,,600],[1,0,0,0]],[]];\nENDMODULE\n",
                    "p{1} holds");
    expect_no_poses(kModule.substr(0, kModule.find(",610]")), "does not end");
    expect_no_poses(
        "MODULE M\nCONST jointtarget h:=[[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nVAR robtarget "
        "here;\nENDMODULE\n",
        "joints alone");
}

}  // namespace
}  // namespace seamwright
