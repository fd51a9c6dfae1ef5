#include "devices/exchange/tables/pose_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(PoseTable, PosesFindTheirFrames) {
    const auto named =
        parse_pose_table("name,x,y,z,a,b,c\nS2,820,10,610,-30,0,0\nS1.csv,800,-50,600,90,0,0\n", "t", {});
    const std::vector<std::string> frames{"S1.csv", "S2.csv"};
    const auto poses = poses_of_frames(*named, frames, "t");
    ASSERT_TRUE(poses) << poses.error().sentence();
    EXPECT_TRUE((*poses)[0].isApprox(kFirst, 1e-6));
    const std::vector<std::string> more{"S1.csv", "S2.csv", "S3.csv"};
    EXPECT_THAT(poses_of_frames(*named, more, "t").error().sentence(), HasSubstr("S3.csv"));
    const auto numbered =
        parse_pose_table("no,x,y,z,a,b,c\n2,820,10,610,-30,0,0\n1,800,-50,600,90,0,0\n", "t", {});
    const std::vector<std::string> scans{"scan_0001.txt", "scan_0002.txt"};
    EXPECT_TRUE((*poses_of_frames(*numbered, scans, "t"))[0].isApprox(kFirst, 1e-6));
    const auto ordered =
        parse_pose_table("800 -50 600 90 0 0\n820 10 610 -30 0 0\n", "t", {"kuka-abc", "", ""});
    EXPECT_TRUE((*poses_of_frames(*ordered, frames, "t"))[1].isApprox(kSecond, 1e-6));
    EXPECT_THAT(poses_of_frames(*ordered, more, "t").error().sentence(), HasSubstr("2 poses for 3 frames"));
}

}  // namespace
}  // namespace seamwright
