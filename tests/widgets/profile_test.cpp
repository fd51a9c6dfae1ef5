#include <gtest/gtest.h>

#include <QApplication>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QTest>
#include <cmath>
#include <limits>
#include <random>

#include "widgets/profile/camera_view.h"
#include "widgets/profile/decimate.h"
#include "widgets/profile/profile_canvas.h"
#include "widgets/profile/profile_plot.h"

namespace seamwright {
namespace {

Profile wave(std::size_t n) {
    Profile p;
    for (std::size_t i = 0; i < n; ++i) {
        p.x_mm.push_back(-50 + 100.0 * static_cast<double>(i) / static_cast<double>(n - 1));
        p.z_mm.push_back(5 * std::sin(p.x_mm.back() / 7) + (i % 97 == 0 ? 1.5 : 0));
        p.segment.push_back(i % 211 == 0 ? kOutlier : p.x_mm.back() < 0 ? 0 : 1);
    }
    return p;
}

// Every accepted point lies on a stroke of its column and segment, and no stroke reaches beyond its
// neighbours' extremes.
// A plot that was squeezed to nothing comes back with the width it had, and so before anything was measured.
TEST(ProfilePlot, ItsScaleOutlivesHavingNoRoom) {
    ProfilePlot plot;
    plot.setMinimumSize(1, 1);
    plot.resize(600, 300);
    plot.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&plot));
    const double before = plot.view().width();
    for (const QSize size : {QSize(1, 200), QSize(600, 300), QSize(30, 30), QSize(1, 1), QSize(600, 300)}) {
        plot.resize(size);
        QTest::qWait(40);
    }
    EXPECT_LT(plot.view().width(), 3 * before);
    EXPECT_GT(plot.view().width(), before / 3);
    EXPECT_LT(plot.view().height(), 3 * before);
}

TEST(Decimate, StrokesHoldExactlyThePoints) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> height(-8, 8);
    Profile p = wave(2048);
    for (std::size_t i = 0; i < p.size(); i += 5) p.z_mm[i] = height(random);
    p.z_mm[100] = std::numeric_limits<double>::quiet_NaN();
    const TraceScale scale{-50, 10, 3.7, 371, 80};
    std::vector<ColumnStroke> strokes;
    std::vector<int> outliers;
    decimate(p, scale, strokes, outliers);
    EXPECT_LT(strokes.size(), 400U);
    std::size_t marked = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const int column = static_cast<int>(std::floor((p.x_mm[i] + 50) * 3.7));
        if (column >= 371 || !std::isfinite(p.z_mm[i])) continue;
        if (p.segment[i] < 0) {
            ++marked;
            continue;
        }
        const double y = (10 - p.z_mm[i]) * 3.7;
        const bool held = std::any_of(strokes.begin(), strokes.end(), [&](const ColumnStroke& s) {
            return s.column == column && s.segment == p.segment[i] && s.low <= y + 1e-3 && s.high >= y - 1e-3;
        });
        EXPECT_TRUE(held) << i;
    }
    EXPECT_EQ(outliers.size(), marked);
}

TEST(Decimate, ResidualsAreDistancesAcrossTheReference) {
    Profile reference, moved;
    for (int i = 0; i < 400; ++i) {
        const double x = -20 + 0.1 * i;
        for (Profile* p : {&reference, &moved}) p->x_mm.push_back(x);
        reference.z_mm.push_back(0.5 * x);
        moved.z_mm.push_back(0.5 * x + 0.2);
    }
    std::vector<double> residuals;
    residuals_to_reference(moved, reference, residuals);
    ASSERT_GT(residuals.size(), 380U);
    for (const double r : residuals) EXPECT_NEAR(r, 0.2 / std::sqrt(1.25), 1e-9);
}

TEST(ProfilePlot, MouseMeasuresPicksAndDragsAWindow) {
    ProfilePlot plot;
    plot.resize(820, 400);
    plot.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&plot));
    const Profile p = wave(2048);
    plot.set_profile(p);
    plot.set_view({-50, -20, 100, 40});
    QWidget* canvas = plot.focusProxy();
    const auto at = [&](double x, double z) {
        return canvas->mapFrom(&plot, plot.to_screen({x, z})).toPoint();
    };
    // One scale on both axes.
    const QPointF o = plot.to_screen({0, 0}), a = plot.to_screen({10, 10});
    EXPECT_NEAR(a.x() - o.x(), o.y() - a.y(), 1e-9);

    QSignalSpy picked(&plot, &ProfilePlot::point_picked);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at(p.x_mm[1500], p.z_mm[1500]));
    ASSERT_EQ(picked.size(), 1);
    EXPECT_NEAR(picked[0][0].toPointF().x(), p.x_mm[1500], 0.3);

    QSignalSpy measured(&plot, &ProfilePlot::measured);
    plot.set_tool(ProfilePlot::Tool::measure);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at(-10, 0));
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at(20, 15));
    ASSERT_EQ(measured.size(), 1);
    EXPECT_NEAR(measured[0][0].toDouble(), std::hypot(30, 15), 0.4);
    EXPECT_NEAR(measured[0][1].toDouble(), 26.565, 0.6);

    QSignalSpy dragged(&plot, &ProfilePlot::window_dragged);
    plot.set_tool(ProfilePlot::Tool::window);
    QTest::mousePress(canvas, Qt::LeftButton, {}, at(-30, 10));
    // Moves as the window system delivers them while a button is held.
    for (const QPoint to : {at(-20, 0), at(5, -8)}) {
        QMouseEvent move(QEvent::MouseMove, to, canvas->mapToGlobal(to), Qt::NoButton, Qt::LeftButton, {});
        QApplication::sendEvent(canvas, &move);
    }
    QTest::mouseRelease(canvas, Qt::LeftButton, {}, at(5, -8));
    ASSERT_EQ(dragged.size(), 1);
    const QRectF window = dragged[0][0].toRectF();
    EXPECT_NEAR(window.left(), -30, 0.3);
    EXPECT_NEAR(window.top(), -8, 0.3);
    EXPECT_NEAR(window.width(), 35, 0.5);
    const auto* drawn = dynamic_cast<ProfileCanvas*>(canvas);
    ASSERT_TRUE(drawn);
    EXPECT_FALSE(drawn->window) << "it is drawn while it is dragged";
    // One that is given up leaves nothing behind, and is none.
    QTest::mousePress(canvas, Qt::LeftButton, {}, at(-30, 10));
    QMouseEvent move(QEvent::MouseMove, at(-10, 0), canvas->mapToGlobal(at(-10, 0)), Qt::NoButton,
                     Qt::LeftButton, {});
    QApplication::sendEvent(canvas, &move);
    EXPECT_TRUE(drawn->window);
    plot.set_tool(ProfilePlot::Tool::inspect);
    EXPECT_FALSE(drawn->window);
    QTest::mouseRelease(canvas, Qt::LeftButton, {}, at(-10, 0));
    EXPECT_EQ(dragged.size(), 1);

    QSignalSpy clicked(&plot, &ProfilePlot::reference_clicked);
    plot.set_tool(ProfilePlot::Tool::reference);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at(7, 3));
    ASSERT_EQ(clicked.size(), 1);
    EXPECT_NEAR(clicked[0][0].toPointF().y(), 3, 0.3);
}

TEST(ProfilePlot, FrozenKeepsThePictureAndThawsToTheNewest) {
    ProfilePlot plot;
    plot.resize(600, 300);
    plot.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&plot));
    Profile p = wave(500);
    plot.set_profile(p);
    plot.flush();
    QTest::keyClick(plot.focusProxy(), Qt::Key_Space);
    ASSERT_TRUE(plot.frozen());
    QTest::qWait(40);
    const QImage before = plot.grab().toImage();
    for (double& z : p.z_mm) z += 1;
    plot.set_profile(p);
    QTest::qWait(40);
    EXPECT_EQ(plot.grab().toImage(), before);
    plot.set_frozen(false);
    QTest::qWait(40);
    QSignalSpy picked(&plot, &ProfilePlot::point_picked);
    const QPoint at = plot.focusProxy()->mapFrom(&plot, plot.to_screen({p.x_mm[250], p.z_mm[250]})).toPoint();
    QTest::mouseClick(plot.focusProxy(), Qt::LeftButton, {}, at);
    ASSERT_EQ(picked.size(), 1);
    EXPECT_NEAR(picked[0][0].toPointF().y(), p.z_mm[250], 0.4);
}

TEST(CameraView, CountsSaturatedPixelsAtEveryDepth) {
    for (const int depth : {8, 10, 12, 16}) {
        const int width = 32, height = 8, full = (1 << depth) - 1;
        std::vector<std::byte> pixels(static_cast<std::size_t>(width * height) * 2);
        StripeImage image{pixels.data(), width, height,
                          static_cast<std::size_t>(depth > 8 ? 2 * width : width), depth};
        for (int i = 0; i < 5; ++i) {
            pixels[static_cast<std::size_t>(depth > 8 ? 2 * i : i)] = static_cast<std::byte>(full & 255);
            if (depth > 8) pixels[static_cast<std::size_t>(2 * i + 1)] = static_cast<std::byte>(full >> 8);
        }
        const GreyHistogram histogram = grey_histogram(image);
        EXPECT_EQ(histogram.saturated, 5) << depth;
        EXPECT_EQ(histogram.classes[0], width * height - 5) << depth;
        EXPECT_EQ(histogram.maximum, full);
    }
}

}  // namespace
}  // namespace seamwright
