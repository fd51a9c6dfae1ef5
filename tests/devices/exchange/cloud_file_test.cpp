// Clouds as files: what is written reads back, what is broken is refused.
#include <gtest/gtest.h>

#include <random>

#include "devices/exchange/cloud/cloud_file.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

Cloud some_cloud(std::size_t count) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(-2000, 2000);
    Cloud c;
    for (std::size_t i = 0; i < count; ++i) {
        c.points.emplace_back(any(random), any(random), any(random));
        c.normals.push_back(Eigen::Vector3f(1, 2, 3).normalized());
        c.towards.push_back(Eigen::Vector3f::UnitZ());
        c.sigma_mm.push_back(0.125F);
    }
    return c;
}

TEST(CloudFile, WhatIsWrittenReadsBack) {
    const TemporaryFolder folder;
    const Cloud cloud = some_cloud(300);
    for (const char* name : {"a.ply", "a.pcd", "a.csv"}) {
        const auto path = folder.path() / name;
        ASSERT_TRUE(write_cloud(path, cloud, "millimetres, robot base"));
        const auto read = read_cloud(path);
        ASSERT_TRUE(read) << read.error().sentence();
        ASSERT_EQ(read->size(), cloud.size()) << name;
        ASSERT_TRUE(read->has_normals() && read->has_towards() && read->has_sigma()) << name;
        for (std::size_t i = 0; i < cloud.size(); ++i) {
            EXPECT_LT((read->points[i] - cloud.points[i]).norm(), 1e-3) << name;
            EXPECT_LT((read->normals[i] - cloud.normals[i]).norm(), 1e-5) << name;
            EXPECT_FLOAT_EQ(read->sigma_mm[i], 0.125F) << name;
        }
    }
    EXPECT_FALSE(write_cloud(folder.path() / "a.xyz9", cloud, ""));
}

TEST(CloudFile, ATableOfThreeNumbersIsACloudAndPointsWithoutNumberAreLeftOut) {
    const auto cloud = parse_cloud("0 0 0\n100 0 1\n0 nan 2\n0 50 3\n", "t");
    ASSERT_TRUE(cloud) << cloud.error().sentence();
    EXPECT_EQ(cloud->size(), 3U);
}

TEST(CloudFile, MetresAreSuspectedAndScaled) {
    const char* text = "x,y,z\n0,0,0\n1.5,0,0\n0,1,0\n";
    EXPECT_FALSE(parse_cloud(text, "t"));
    EXPECT_NEAR(parse_cloud(text, "t", "m")->box().max().x(), 1500, 1e-9);
    EXPECT_NEAR(parse_cloud(text, "t", "mm")->box().max().x(), 1.5, 1e-9);
    EXPECT_FALSE(parse_cloud(text, "t", "inch"));
}

TEST(CloudFile, BrokenFilesAreRefused) {
    const std::string whole = cloud_ply(some_cloud(50), "millimetres");
    for (const std::size_t cut :
         {whole.size() - 1, whole.size() / 2, std::size_t{40}, std::size_t{4}, std::size_t{0}})
        EXPECT_FALSE(parse_cloud(std::string_view(whole).substr(0, cut), "t")) << cut;
    EXPECT_FALSE(parse_cloud("x,z\n1,2\n3,4\n", "t"));
    EXPECT_FALSE(parse_cloud("x,y,z\n1e9,0,0\n3,4,5\n", "t"));
    EXPECT_FALSE(parse_cloud("x,y,z\nnan,nan,nan\n", "t"));
    EXPECT_FALSE(read_cloud("/nowhere/at/all.ply"));
}

}  // namespace
}  // namespace seamwright
