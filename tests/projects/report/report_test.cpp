#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "projects/report/html.h"
#include "projects/report/svg_bars.h"
#include "projects/report/svg_plot.h"

namespace seamwright::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(AxisTicks, AreRoundAndInside) {
    EXPECT_THAT(axis_ticks(0, 10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(axis_ticks(-0.3, 0.3, 3), ElementsAre(-0.2, 0, 0.2));
    for (double span : {1e-9, 0.07, 3.0, 1e7}) {
        const auto ticks = axis_ticks(-span / 3, span, 6);
        ASSERT_GE(ticks.size(), 3u) << span;
        ASSERT_LE(ticks.size(), 14u) << span;
        EXPECT_GE(ticks.front(), -span / 3 * (1 + 1e-9));
        EXPECT_LE(ticks.back(), span * (1 + 1e-9));
    }
    EXPECT_TRUE(axis_ticks(1, 1, 5).empty());
    EXPECT_TRUE(axis_ticks(0, std::numeric_limits<double>::infinity(), 5).empty());
}

TEST(Svg, GapsAndMissingDataDrawNoNumberThatIsNone) {
    Plot plot;
    plot.title = "a < b & c";
    plot.series = {{"s", {0, 1, 2, 3}, {1, std::nan(""), 3, 4}}};
    const std::string drawing = svg(plot);
    EXPECT_THAT(drawing, HasSubstr("a &lt; b &amp; c"));
    EXPECT_THAT(drawing, Not(HasSubstr("nan")));
    EXPECT_THAT(drawing, Not(HasSubstr("inf")));
    plot.series = {{"s", {0, 1}, {std::nan(""), std::nan("")}}};
    EXPECT_THAT(svg(plot), HasSubstr("no data"));
    plot.series = {{"one point", {5}, {5}, Mark::dots}};
    EXPECT_THAT(svg(plot), Not(HasSubstr("nan")));
}

TEST(SvgBars, OneLineAShareWithItsFigure) {
    const std::string drawing =
        svg_bars("a < b", {{"one & all", 62.5, "#0072B2", "random"}, {"none", std::nan("")}, {"more", 1e9}});
    EXPECT_THAT(drawing, HasSubstr("a &lt; b"));
    EXPECT_THAT(drawing, HasSubstr("one &amp; all"));
    EXPECT_THAT(drawing, HasSubstr("62.5 %, random</text>"));
    EXPECT_THAT(drawing, HasSubstr("0.0 %</text>"));
    EXPECT_THAT(drawing, HasSubstr("100.0 %</text>"));
    EXPECT_THAT(drawing, Not(HasSubstr("nan")));
}

TEST(Page, EscapesEverythingThatUsersWrite) {
    Page page("<script>alert('x')</script>");
    page.heading("a<b>");
    page.paragraph("\"quoted\" & 'more'");
    page.table({{"name", "value"}, {"<i>", "1.5"}});
    page.verdict("<ok>", Tone::good, "because <x>");
    const std::string html = page.html();
    EXPECT_THAT(html, Not(HasSubstr("<script>")));
    EXPECT_THAT(html, Not(HasSubstr("<i>")));
    EXPECT_THAT(html, Not(HasSubstr("<ok>")));
    EXPECT_THAT(html, Not(HasSubstr("http-equiv")));
}

TEST(Page, NumbersStandRightWordsLeft) {
    Page page("t");
    page.table({{"spot", "mm"}, {"S1", "-0.125"}, {"S2", "3"}});
    const std::string html = page.html();
    EXPECT_THAT(html, HasSubstr("<td class=\"n\">-0.125</td>"));
    EXPECT_THAT(html, HasSubstr("<td>S1</td>"));
}

}  // namespace
}  // namespace seamwright::report
