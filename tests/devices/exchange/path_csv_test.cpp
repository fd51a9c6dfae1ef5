// The application path in the robots' notations: round trip, equal meaning, hostile text.

#include "devices/exchange/tables/path_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/geometry/notation.h"
#include "devices/registry.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

ApplicationPath random_path(bool regions) {
    std::mt19937 rng(4);
    std::uniform_real_distribution<double> u(-1, 1);
    ApplicationPath path;
    path.regions_named = regions;
    for (int i = 0; i < 200; ++i) {
        const double x = u(rng), y = u(rng), z = u(rng), a = u(rng), b = u(rng), c = u(rng);
        path.points.push_back(
            {make_pose(rotation_exp(Eigen::Vector3d(a, b, c) * 1.8), Eigen::Vector3d(x, y, z) * 2000),
             regions && i % 3 ? "top" : ""});
    }
    return path;
}

TEST(PathCsv, EveryNotationReadsBackWhatItWrote) {
    for (const std::string_view brand : kPathNotations)
        for (const bool regions : {false, true}) {
            const auto notation = path_notation_from(brand);
            ASSERT_TRUE(notation);
            const ApplicationPath path = random_path(regions);
            const std::string text = path_csv(path, *notation);
            const auto back = parse_path_csv(text, *notation, "P.csv");
            ASSERT_TRUE(back) << back.error().sentence();
            ASSERT_EQ(back->points.size(), path.points.size());
            EXPECT_EQ(back->regions_named, regions);
            for (std::size_t i = 0; i < path.points.size(); ++i) {
                EXPECT_LT(distance_mm(back->points[i].frame_from_tool, path.points[i].frame_from_tool),
                          1e-10);
                EXPECT_LT(angle_rad(back->points[i].frame_from_tool, path.points[i].frame_from_tool), 1e-10);
                EXPECT_EQ(back->points[i].region_id, path.points[i].region_id);
            }
        }
}

TEST(PathCsv, NotationsSayTheSame) {
    // A quarter turn about Z at (100, 200, 300) mm, as each brand's pendant shows it.
    const auto kuka =
        parse_path_csv("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n100,200,300,90,0,0\n", PathNotation::kuka, "k");
    const auto abb = parse_path_csv("x_mm,y_mm,z_mm,q1,q2,q3,q4\n100,200,300,0.70710678,0,0,0.70710678\n",
                                    PathNotation::abb, "a");
    const auto ur =
        parse_path_csv("region,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\r\nR1,0.1,0.2,0.3,0,0,1.5707963267949\r\n",
                       PathNotation::ur, "u");
    ASSERT_TRUE(kuka && abb && ur);
    EXPECT_TRUE(kuka->points[0].frame_from_tool.isApprox(abb->points[0].frame_from_tool, 1e-8));
    EXPECT_TRUE(kuka->points[0].frame_from_tool.isApprox(ur->points[0].frame_from_tool, 1e-10));
    EXPECT_EQ(ur->points[0].region_id, "R1");
    EXPECT_FALSE(kuka->regions_named);
}

TEST(PathCsv, HostileTextIsRefusedWithItsLine) {
    const std::string head = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n";
    const auto refused = [](const std::string& text, PathNotation notation, const std::string& part) {
        const auto r = parse_path_csv(text, notation, "P.csv");
        ASSERT_FALSE(r) << text;
        EXPECT_THAT(r.error().sentence(), HasSubstr(part)) << text;
    };
    refused("", PathNotation::kuka, "empty");
    refused(head, PathNotation::kuka, "no points");
    refused("x_mm,y_mm,z_mm\n1,2,3\n", PathNotation::kuka, "a_deg");
    refused(head + "1,2,3,4,5,6\n", PathNotation::abb, "q1");
    refused(head + "1,2,3,4,5\n", PathNotation::kuka, "line 2");
    refused(head + "1,2,3,4,5,6\n1,2,,4,5,6\n", PathNotation::kuka, "z_mm is missing");
    refused(head + "1,2,nan,4,5,6\n", PathNotation::kuka, "line 2");
    refused(head + "1,2,inf,4,5,6\n", PathNotation::kuka, "infinite");
    refused(head + "1e6,2,3,4,5,6\n", PathNotation::kuka, "100 m");
    refused(head + "1,2,3,1e4,5,6\n", PathNotation::kuka, "degrees");
    refused("x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n900,0,0,0,0,0\n", PathNotation::ur, "metres");
    refused("x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0.9,0,0,90,0,0\n", PathNotation::ur, "radians");
    refused("x_mm,y_mm,z_mm,q1,q2,q3,q4\n1,2,3,1,1,0,0\n", PathNotation::abb, "line 2");
    refused("x_mm;y_mm;z_mm\n", PathNotation::kuka, "semicolons");
    EXPECT_FALSE(path_notation_from("comau"));
}

TEST(PathProgram, HoldsEveryPointInTheBrandsNumbers) {
    PathProgramRequest request;
    request.name = "bead";
    request.comment = "door \"left\"\nEND";
    request.base_from_frame.translation() = Eigen::Vector3d(1, 2, 3);
    for (int i = 0; i < 3; ++i)
        request.frame_from_tool.push_back(
            make_pose(rotation_from_kuka({90, 0, 0}), Eigen::Vector3d(100.5 + 10 * i, -20, 30)));
    const auto kuka = write_robot_path("kuka", request);
    ASSERT_TRUE(kuka) << kuka.error().sentence();
    ASSERT_EQ((*kuka)[0].name, "bead.src");
    const std::string& krl = (*kuka)[0].text;
    EXPECT_THAT(krl, HasSubstr("DEF bead()"));
    EXPECT_THAT(krl, HasSubstr("$BASE={X 1.0000,Y 2.0000,Z 3.0000,A 0.00000"));
    EXPECT_THAT(krl,
                HasSubstr("LIN {X 100.5000,Y -20.0000,Z 30.0000,A 90.00000,B -0.00000,C 0.00000} C_DIS\n"));
    EXPECT_THAT(krl,
                HasSubstr("LIN {X 120.5000,Y -20.0000,Z 30.0000,A 90.00000,B -0.00000,C 0.00000}\nEND\n"));
    EXPECT_THAT(krl, testing::Not(HasSubstr("\nEND\n$")));
    const auto abb = write_robot_path("abb", request);
    ASSERT_TRUE(abb);
    EXPECT_THAT((*abb)[0].text,
                HasSubstr("[100.5000,-20.0000,30.0000],[0.70710678,0.00000000,0.00000000,0.70710678]"));
    EXPECT_THAT((*abb)[0].text, HasSubstr("point{3}"));
    const auto ur = write_robot_path("ur", request);
    ASSERT_TRUE(ur);
    EXPECT_THAT((*ur)[0].text,
                HasSubstr("p[0.1005000, -0.0200000, 0.0300000, 0.00000000, 0.00000000, 1.57079633]"));
    EXPECT_THAT((*ur)[0].text, HasSubstr("r=0.00200)"));
    for (const char* brand : {"kuka", "abb", "ur"}) {
        auto bad = request;
        bad.name = "1 bead";
        EXPECT_FALSE(write_robot_path(brand, bad));
        bad = request;
        bad.frame_from_tool.clear();
        EXPECT_FALSE(write_robot_path(brand, bad));
        bad = request;
        bad.frame_from_tool[1].translation().x() = std::nan("");
        EXPECT_FALSE(write_robot_path(brand, bad));
        bad = request;
        bad.speed_mm_s = 0;
        EXPECT_FALSE(write_robot_path(brand, bad));
    }
    EXPECT_FALSE(write_robot_path("comau", request));
}

}  // namespace
}  // namespace seamwright
