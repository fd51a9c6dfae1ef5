// Picture baselines: the drawing of fixed content beside the accepted pictures in tests/data/pictures/. A
// pixel differs when a channel is off by more than 48 of 255; fonts and rounding may differ in up to 4 % of
// them. After a wanted change: SEAMWRIGHT_ACCEPT_PICTURES=1 build/bin/test_widgets
// --gtest_filter='Baseline.*', then look at the pictures.
#include <gtest/gtest.h>

#include <QTest>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "widgets/charts/residual_bars.h"
#include "widgets/profile/profile_plot.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

void compare(QWidget& widget, const QString& name) {
    const QString path = QString("%1/%2.png").arg(SEAMWRIGHT_PICTURES, name);
    widget.resize(480, 260);
    widget.setPalette(style::light_palette());
    widget.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&widget));
    QTest::qWait(80);
    const QImage image = widget.grab().toImage().convertToFormat(QImage::Format_RGB32);
    if (std::getenv("SEAMWRIGHT_ACCEPT_PICTURES")) {
        std::filesystem::create_directories(SEAMWRIGHT_PICTURES);
        ASSERT_TRUE(image.save(path));
        return;
    }
    const QImage accepted = QImage(path).convertToFormat(QImage::Format_RGB32);
    ASSERT_EQ(accepted.size(), image.size()) << path.toStdString();
    int different = 0, drawn = 0;
    const QRgb ground = accepted.pixel(accepted.width() - 3, 20);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const QRgb a = image.pixel(x, y), b = accepted.pixel(x, y);
            drawn += b != ground;
            different += std::abs(qRed(a) - qRed(b)) > 48 || std::abs(qGreen(a) - qGreen(b)) > 48 ||
                         std::abs(qBlue(a) - qBlue(b)) > 48;
        }
    EXPECT_GT(drawn, 500);
    EXPECT_LT(different, image.width() * image.height() * 4 / 100);
    EXPECT_LT(different, drawn / 2);  // an empty plot is not near enough
}

TEST(Baseline, Profile) {
    ProfilePlot plot;
    plot.set_toolbar_shown(false);
    Profile p;
    for (int i = 0; i < 1200; ++i) {
        const double x = -40 + i / 15.0;
        p.x_mm.push_back(x);
        p.z_mm.push_back(x < -10 ? 2 : x < 15 ? 6 * std::sin(x / 5) : -4);
        p.segment.push_back(i % 150 == 149 ? kOutlier : x < -10 ? 0 : x < 15 ? 1 : 2);
        if (i % 150 == 149) p.z_mm.back() += 5;
    }
    plot.set_profile(p);
    Feature feature;
    feature.status = FeatureStatus::ok;
    feature.point_mm = {-10, 2};
    feature.covariance_mm2 << 0.5, 0.3, 0.3, 0.4;
    plot.set_feature(feature);
    compare(plot, "profile");
}

TEST(Baseline, ResidualBars) {
    ResidualBars bars;
    bars.set_data({{"S1", {0.1, 0, -0.05}, 0.03, true}, {"S2", {0.4, 0, 0.2}, 0.03, false}});
    compare(bars, "residual_bars");
}

}  // namespace
}  // namespace seamwright
