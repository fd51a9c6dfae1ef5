// Eight live profiles of 2048 points at 60 frames/s: processor share, beside QCustomPlot's plain graph. Needs
// a screen (start it as `xvfb-run -a bench_profile_plot`); without one Qt's offscreen platform paints the
// same picture.
#include <benchmark/benchmark.h>
#include <qcustomplot.h>

#include <QApplication>
#include <QGridLayout>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>

#include "widgets/profile/profile_plot.h"
#include "widgets/style.h"

namespace {

using namespace seamwright;

constexpr int kPlots = 8, kPoints = 2048;
constexpr double kFrames_per_s = 60;

std::vector<Profile> profiles() {
    std::vector<Profile> all(16);
    std::mt19937_64 random(1);
    std::normal_distribution<double> noise(0, 0.02);
    for (std::size_t k = 0; k < all.size(); ++k)
        for (int i = 0; i < kPoints; ++i) {
            const double x = -50 + 100.0 * i / kPoints;
            all[k].x_mm.push_back(x);
            all[k].z_mm.push_back((x < -15  ? 0
                                   : x < 12 ? -0.8
                                            : std::max(-14.0, -0.8 - 0.8 * (x - 12))) +
                                  0.02 * static_cast<double>(k) + noise(random));
            all[k].segment.push_back(i % 400 == 7 ? kOutlier : x < -15 ? 0 : x < 12 ? 1 : 2);
        }
    return all;
}

double processor_s() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Counts what is really painted, so that a picture that was skipped is not counted as a fast one.
class Painted : public QObject {
  public:
    int count = 0;
    bool eventFilter(QObject* watched, QEvent* event) override {
        count += event->type() == QEvent::Paint;
        return QObject::eventFilter(watched, event);
    }
};

// Processor time of one picture of all eight, paint events and their way to the screen included.
double ours_s(int frames, double& longest_s, double& painted_per_frame) {
    Painted painted;
    QWidget window;
    auto* grid = new QGridLayout(&window);
    std::vector<ProfilePlot*> plots;
    for (int i = 0; i < kPlots; ++i) {
        plots.push_back(new ProfilePlot);
        plots.back()->focusProxy()->installEventFilter(&painted);
        grid->addWidget(plots.back(), i / 4, i % 4);
    }
    window.resize(1560, 900);
    window.show();
    const auto all = profiles();
    for (ProfilePlot* plot : plots) plot->set_profile(all[0]);
    for (int i = 0; i < 5; ++i) QApplication::processEvents();
    longest_s = 0;
    Feature feature;  // found in every profile: mark, ellipse and numbers are painted too
    feature.status = FeatureStatus::ok;
    feature.point_mm = {-15, -0.4};
    feature.covariance_mm2 = Eigen::Matrix2d::Identity() * 0.01;
    painted.count = 0;
    const double start = processor_s();
    for (int frame = 0; frame < frames; ++frame) {
        const double before = processor_s();
        for (std::size_t i = 0; i < plots.size(); ++i) {
            plots[i]->set_profile(all[(static_cast<std::size_t>(frame) + i) % all.size()]);
            feature.point_mm.x() = -15 + 0.01 * (frame % 7);
            plots[i]->set_feature(feature);
            plots[i]->flush();
        }
        QApplication::processEvents();
        longest_s = std::max(longest_s, processor_s() - before);
    }
    painted_per_frame = painted.count / static_cast<double>(frames);
    return (processor_s() - start) / frames;
}

double peer_s(int frames) {
    QWidget window;
    auto* grid = new QGridLayout(&window);
    std::vector<QCustomPlot*> plots;
    for (int i = 0; i < kPlots; ++i) {
        auto* plot = new QCustomPlot;
        plot->addGraph();
        plot->xAxis->setRange(-55, 55);
        plot->yAxis->setRange(-25, 15);
        plots.push_back(plot);
        grid->addWidget(plot, i / 4, i % 4);
    }
    window.resize(1560, 900);
    window.show();
    const auto all = profiles();
    for (int i = 0; i < 5; ++i) QApplication::processEvents();
    const double start = processor_s();
    for (int frame = 0; frame < frames; ++frame) {
        for (std::size_t i = 0; i < plots.size(); ++i) {
            const Profile& p = all[(static_cast<std::size_t>(frame) + i) % all.size()];
            plots[i]->graph(0)->setData(QVector<double>(p.x_mm.begin(), p.x_mm.end()),
                                        QVector<double>(p.z_mm.begin(), p.z_mm.end()), true);
            plots[i]->replot(QCustomPlot::rpQueuedReplot);
        }
        QApplication::processEvents();
    }
    return (processor_s() - start) / frames;
}

}  // namespace

int main(int argc, char** argv) {
    if (!std::getenv("DISPLAY")) setenv("QT_QPA_PLATFORM", "offscreen", 1);
    QApplication application(argc, argv);
    QApplication::setStyle("Fusion");
    benchmark::Initialize(&argc, argv);
    double longest = 0, painted = 0;
    const double ours = ours_s(600, longest, painted), peer = peer_s(200);
    std::printf(
        "8 plots x 2048 points on %s: %.2f ms of processor a frame, longest %.1f ms; QCustomPlot's graph "
        "%.2f ms\n",
        qPrintable(QGuiApplication::platformName()), 1e3 * ours, 1e3 * longest, 1e3 * peer);
    std::printf("plots painted a frame: %.2f\n", painted);
    std::printf("share of one core at 60 frames/s: %.1f %%\n", 100 * ours * kFrames_per_s);
    std::printf("ratio profile_plot/qcustomplot_graph %.3f\n", ours / peer);
    return 0;
}
