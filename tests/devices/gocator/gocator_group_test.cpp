// Contours of an exposure: the sensor's own one is taken, whatever a job's tools send beside it.

#include "devices/gocator/gocator_group.h"

#include <gtest/gtest.h>

#include <cstring>

namespace seamwright {
namespace {

// One contour at height z, of a step; without one as older firmware says it, in 32 bytes of attributes.
gdp::Message contour(double z_mm, std::optional<gdp::Step> step, bool last = false) {
    Profile profile;
    for (int i = 0; i < 5; ++i) profile.x_mm.push_back(i), profile.z_mm.push_back(z_mm);
    std::string content = gdp::points_content(profile);
    constexpr std::size_t kStep = 34, kOlderAttributes = 32;
    if (step) {
        const auto value = static_cast<std::int32_t>(*step);
        std::memcpy(content.data() + kStep, &value, sizeof value);
    } else {
        content.erase(2 + kOlderAttributes, 8);
        content[0] = kOlderAttributes;
    }
    return {static_cast<std::uint16_t>(gdp::Type::points), last, content};
}

gdp::Message stamp() {
    return {static_cast<std::uint16_t>(gdp::Type::stamp), false, gdp::stamps_content({{7, 1000, 0, 815}})};
}

GocatorGroup group_of(const std::vector<gdp::Message>& messages) {
    GocatorGroup group;
    for (const auto& message : messages) group.take(message, 0);
    return group;
}

TEST(GocatorGroup, TheSensorsContourIsTakenNotATools) {
    using gdp::Step;
    for (const auto own :
         {std::optional<Step>(), std::optional(Step::profile), std::optional(Step::raw_profile)})
        for (const bool first : {false, true})
            for (const Step other : {Step::tool, Step::section}) {
                const auto a = contour(1, own), b = contour(1.3, other);
                const GocatorGroup group = group_of({stamp(), first ? a : b, first ? b : a});
                EXPECT_FALSE(group.unclear());
                ASSERT_EQ(group.profiles.size(), 1u);
                EXPECT_NEAR(group.profiles[0].z_mm[2], 1, 1e-3);
            }
    // Raw beside processed: the processed one is what the sensor shows.
    for (const bool first : {false, true}) {
        const auto a = contour(1, Step::profile), b = contour(1.3, Step::raw_profile);
        const GocatorGroup group = group_of({stamp(), first ? a : b, first ? b : a});
        EXPECT_FALSE(group.unclear());
        EXPECT_NEAR(group.profiles.at(0).z_mm[2], 1, 1e-3);
    }
}

TEST(GocatorGroup, TwoThatStandEquallyWellAreNone) {
    using gdp::Step;
    EXPECT_TRUE(group_of({stamp(), contour(1, Step::profile), contour(1.3, Step::profile)}).unclear());
    EXPECT_TRUE(group_of({stamp(), contour(1, {}), contour(1.3, {})}).unclear());
    EXPECT_TRUE(group_of({contour(1, Step::profile)}).unclear()) << "without a stamp";
    const GocatorGroup tool = group_of({stamp(), contour(1, Step::tool)});
    EXPECT_FALSE(tool.unclear());
    EXPECT_TRUE(tool.profiles.empty());
}

}  // namespace
}  // namespace seamwright
