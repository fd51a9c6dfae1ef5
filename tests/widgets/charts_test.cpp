#include <gtest/gtest.h>

#include <QLabel>
#include <QSignalSpy>
#include <QTest>
#include <cmath>
#include <limits>

#include "widgets/charts/histogram.h"
#include "widgets/charts/share_bars.h"
#include "widgets/charts/trend_chart.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

TEST(Capability, FollowsItsFormulae) {
    // 1..5: mean 3, s = sqrt(2.5).
    const ShownCapability c =
        capability({1, 2, 3, 4, 5, std::numeric_limits<double>::quiet_NaN()}, {0.0, 9.0});
    EXPECT_EQ(c.count, 5);
    EXPECT_DOUBLE_EQ(c.mean, 3);
    EXPECT_NEAR(c.standard_deviation, std::sqrt(2.5), 1e-12);
    EXPECT_NEAR(*c.cp, 9 / (6 * std::sqrt(2.5)), 1e-12);
    EXPECT_NEAR(*c.cpk, 3 / (3 * std::sqrt(2.5)), 1e-12);
    const ShownCapability one_sided = capability({1, 2, 3}, {std::nullopt, 5.0});
    EXPECT_FALSE(one_sided.cp);
    EXPECT_NEAR(*one_sided.cpk, 1, 1e-12);
    EXPECT_FALSE(capability({2, 2, 2}, {0.0, 3.0}).cpk);
}

// Biases that cancel when they are put together, as many values as parts.
TEST(Histogram, EverySeriesHasItsOwnMeanAndCount) {
    Histogram chart;
    chart.set_data("shift", "mm",
                   {{"X", {-0.2, -0.1, -0.3}}, {"Y", {0.2, 0.1, std::nan("")}}, {"Z", {0, 0, 0}}},
                   {-1.0, 1.0});
    EXPECT_EQ(chart.shown(0).count, 3);
    EXPECT_NEAR(chart.shown(0).mean, -0.2, 1e-12);
    EXPECT_NEAR(chart.shown(0).standard_deviation, 0.1, 1e-12);
    EXPECT_NEAR(*chart.shown(0).cpk, 0.8 / 0.3, 1e-9);
    EXPECT_EQ(chart.shown(1).count, 2);
    EXPECT_NEAR(chart.shown(1).mean, 0.15, 1e-12);
    EXPECT_EQ(chart.shown(2).mean, 0);
    EXPECT_EQ(chart.shown(3).count, 0);
    const auto* words = chart.findChild<QLabel*>();
    ASSERT_TRUE(words);
    EXPECT_TRUE(words->text().contains("X   n 3   mean -0.200   s 0.100 mm")) << words->text().toStdString();
    EXPECT_TRUE(words->text().contains("Y   n 2   mean 0.150"));
    chart.set_data("one", "mm", std::vector<double>{1, 2, 3}, {});
    EXPECT_EQ(chart.shown().count, 3);
    EXPECT_TRUE(words->text().startsWith("one   n 3")) << words->text().toStdString();
}

TEST(TrendChart, ClickOpensThePartAndLimitsAreCounted) {
    TrendChart chart;
    chart.resize(600, 260);
    chart.set_data("x", "mm", {"1", "2", "3", "4"},
                   {{"x", {0, 0.5, -0.1, std::nan("")}}, {"z", {0, 0, -0.4, 0}}}, {-0.3, 0.3});
    EXPECT_EQ(chart.beyond_limits(), 2);
    chart.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&chart));
    QTest::qWait(50);
    QSignalSpy opened(&chart, &TrendChart::part_opened);
    QTest::mouseClick(chart.focusProxy(), Qt::LeftButton, {},
                      chart.focusProxy()->mapFrom(&chart, chart.to_screen(2, -0.4)).toPoint());
    ASSERT_EQ(opened.size(), 1);
    EXPECT_EQ(opened[0][0].toInt(), 2);
    QTest::keyClick(chart.focusProxy(), Qt::Key_Left);
    QTest::keyClick(chart.focusProxy(), Qt::Key_Return);
    ASSERT_EQ(opened.size(), 2);
    EXPECT_EQ(opened[1][0].toInt(), 1);
}

TEST(ShareBars, SayWhatTheyDraw) {
    ShareBars bars;
    bars.set_data(
        {{"hand-eye A", 75, true}, {"spot's sigma A", 25, false}, {"nothing", std::nan(""), false}});
    EXPECT_EQ(bars.accessibleDescription().section("; ", 0, 1),
              "hand-eye A: 75 % systematic; spot's sigma A: 25 % random");
    EXPECT_EQ(bars.sizeHint().height() % 3, 0);
    bars.resize(400, bars.sizeHint().height());
    const QImage drawn = bars.grab().toImage();
    // Along the middle of the first bar: most of it is filled, of the second a quarter.
    const auto filled = [&](int row, const QColor& colour) {
        int n = 0;
        const int y = (2 * row + 1) * drawn.height() / 6;
        for (int x = 0; x < drawn.width(); ++x) n += drawn.pixelColor(x, y) == colour;
        return n;
    };
    const int first = filled(0, style::segment(1, bars.palette())),
              second = filled(1, style::segment(0, bars.palette()));
    EXPECT_GT(second, 0);
    EXPECT_NEAR(first, 3 * second, 4);
    EXPECT_EQ(filled(2, style::segment(0, bars.palette())), 0);
    bars.resize(60, 20);  // narrower than its words
    bars.grab();
}

}  // namespace
}  // namespace seamwright
