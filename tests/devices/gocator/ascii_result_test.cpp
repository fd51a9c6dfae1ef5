#include "devices/gocator/ascii_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace seamwright::gocator {
namespace {

using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

std::map<int, double> values(const std::string& line, const AsciiFormat& format = {}) {
    const auto result = parse_result(line, format);
    EXPECT_TRUE(result) << result.error().sentence();
    return result ? result->value_mm : std::map<int, double>();
}

TEST(GocatorAscii, StandardAsInTheManual) {
    EXPECT_THAT(values("M00,00,V151290,D0,M01,01,V18520,D0"),
                UnorderedElementsAre(Pair(0, 151.29), Pair(1, 18.52)));
    EXPECT_THAT(values("M00,00,V151290,M01,01,V18520"),
                UnorderedElementsAre(Pair(0, 151.29), Pair(1, 18.52)));
    EXPECT_THAT(values("M0a,12,V-3,D1,"), UnorderedElementsAre(Pair(12, -0.003)));
    EXPECT_TRUE(values("").empty());
}

TEST(GocatorAscii, InvalidValuesAreMissing) {
    EXPECT_THAT(values("M00,0,VINVALID,D2,M00,1,V7,D1"), UnorderedElementsAre(Pair(1, 0.007)));
    EXPECT_THAT(values("M00,0,V5,D2"), UnorderedElementsAre()) << "the decision says that there is no value";
    AsciiFormat other;
    other.invalid = "n/a";
    EXPECT_TRUE(values("M00,0,Vn/a,D2", other).empty());
}

TEST(GocatorAscii, CustomAsInTheManual) {
    AsciiFormat format;
    format.pattern = "%time, %value[0], %decision[0]";
    ASSERT_TRUE(check_format(format));
    const auto result = parse_result("1420266101, 151290, 0", format);
    ASSERT_TRUE(result) << result.error().sentence();
    EXPECT_EQ(result->time_us, 1420266101);
    EXPECT_FALSE(result->frame);
    EXPECT_THAT(result->value_mm, UnorderedElementsAre(Pair(0, 151.29)));
    format.pattern = "%decision[3]|%frame|%encoder|X=%value[3]mm";
    const auto second = parse_result("2|17|-5|X=100mm", format);
    ASSERT_TRUE(second) << second.error().sentence();
    EXPECT_EQ(second->frame, 17);
    EXPECT_TRUE(second->value_mm.empty()) << "a decision before its value counts too";
}

TEST(GocatorAscii, HostileLines) {
    for (const char* line : {"M00", "M00,0", "M00,0,", "M00,0,V", "M00,0,Vx", "X00,0,V1", "Mzz,0,V1",
                             "M00,-1,V1", "M00,0,V1e5", "M00,0,V99999999999999999999", "M00,0,V2000000000",
                             "M00,0,V1,Dx", "M00,0,V1,M00,0,V2", "garbage", "V1,D0"})
        EXPECT_FALSE(parse_result(line, {})) << line;
    AsciiFormat format;
    format.pattern = "%frame;%value[0]";
    for (const char* line : {"", "1", ";", "1;", "1;2;3", "x;2", "1,2"})
        EXPECT_FALSE(parse_result(line, format)) << line;
}

TEST(GocatorAscii, FormatsThatCannotBeReadAreRefused) {
    for (const char* pattern : {"%values[0]", "%value[x]", "%value[1", "%", "%%", "%value[-1]"})
        EXPECT_FALSE(check_format({.pattern = pattern})) << pattern;
    const auto together = check_format({.pattern = "%time%frame"});
    ASSERT_FALSE(together);
    EXPECT_THAT(together.error().sentence(), HasSubstr("delimiter between"));
    EXPECT_FALSE(check_format({.pattern = "", .delimiter = ""}));
    EXPECT_FALSE(check_format({.pattern = "", .delimiter = ",", .terminator = ""}));
}

TEST(GocatorAscii, LinesComeWholeWhateverTheSegments) {
    const std::string all = "M00,0,V1\r\nM00,0,V2\r\nM0";
    std::string stream;
    std::vector<std::string> lines;
    for (const char c : all) {
        stream.push_back(c);
        while (true) {
            auto line = take_line(stream, {});
            ASSERT_TRUE(line);
            if (!*line) break;
            lines.push_back(**line);
        }
    }
    EXPECT_EQ(lines, (std::vector<std::string>{"M00,0,V1", "M00,0,V2"}));
    EXPECT_EQ(stream, "M0");
    std::string endless(kLongestLine + 1, 'x');
    EXPECT_FALSE(take_line(endless, {}));
}

}  // namespace
}  // namespace seamwright::gocator
