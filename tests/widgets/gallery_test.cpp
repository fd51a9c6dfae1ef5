// Every view with what the simulated cell really delivers, light and dark, as pictures in build/screens/.
#include <gtest/gtest.h>

#include <QApplication>
#include <QLabel>
#include <QMouseEvent>
#include <QScrollArea>
#include <QSignalSpy>
#include <QTest>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <cmath>
#include <filesystem>
#include <random>

#include "core/alignment/alignment.h"
#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "core/profile/stripe/peaks.h"
#include "devices/simulated/cell.h"
#include "widgets/align/align_view.h"
#include "widgets/charts/histogram.h"
#include "widgets/charts/residual_bars.h"
#include "widgets/charts/trend_chart.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/profile/camera_view.h"
#include "widgets/profile/profile_plot.h"
#include "widgets/scene/scene_view.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

struct Cell {
    std::shared_ptr<SimulatedCell> cell;
    Frame frame;
    StripePeaks peaks;
    ProfileCandidates candidates;
    Cell() {
        CellSettings settings = default_cell_settings();
        settings.optics.bit_depth = 12;
        cell = *SimulatedCell::open(settings);
    }
    Profile see(const Pose& workobject_from_sensor, std::uint64_t seed) {
        cell->render(cell->flange_for(workobject_from_sensor), seed, frame);
        EXPECT_TRUE(find_peaks(frame.image, {}, peaks));
        to_millimetres(peaks, cell->sensor_model(), candidates);
        Profile profile;
        EXPECT_TRUE(track_stripe(candidates, {}, profile));
        return profile;
    }
};

Cell& cell() {
    static Cell one;
    return one;
}

Pose shifted(const Pose& pose, double travel_mm) {
    return pose * Pose(Eigen::Translation3d(0, travel_mm, 0));
}

// Shows the widget in both palettes and keeps a picture of each; the two must differ and not be of one
// colour.
void keep_pictures(QWidget& widget, const QString& name, QSize size,
                   const std::function<QImage()>& picture = nullptr) {
    std::filesystem::create_directories(SEAMWRIGHT_SCREENS);
    widget.resize(size);
    QImage images[2];
    for (const bool dark : {false, true}) {
        QApplication::setPalette(dark ? style::dark_palette() : style::light_palette());
        widget.setPalette(QApplication::palette());
        widget.show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(&widget));
        QTest::qWait(120);
        QImage image = picture ? picture() : widget.grab().toImage();
        ASSERT_FALSE(image.isNull());
        image.save(QString("%1/%2-%3.png").arg(SEAMWRIGHT_SCREENS, name, dark ? "dark" : "light"));
        images[dark ? 1 : 0] = image.convertToFormat(QImage::Format_RGB32);
    }
    QSet<QRgb> colours;
    for (int y = 0; y < images[0].height(); y += 3)
        for (int x = 0; x < images[0].width(); x += 3) colours.insert(images[0].pixel(x, y));
    EXPECT_GT(colours.size(), 8);
    EXPECT_NE(images[0], images[1]);
}

TEST(Gallery, LiveProfile) {
    const DoorSpot spot = default_door_spots().front();
    const Profile taught = cell().see(spot.workobject_from_sensor, 1);
    const Profile live = cell().see(shifted(spot.workobject_from_sensor, 3), 2);
    FeatureRecipe recipe;
    recipe.kind = "contour-end";
    const auto finder = make_feature_finder(recipe);
    ASSERT_TRUE(finder);
    ProfilePlot plot;
    plot.set_caption("sensor A   1000 /s   0 dropped");
    plot.set_profile(live);
    plot.set_reference(taught, Eigen::Vector2d(spot.edge_mm.x(), spot.edge_mm.z()));
    const Feature feature = (*finder)->find(live);
    EXPECT_EQ(feature.status, FeatureStatus::ok) << feature.message;
    plot.set_feature(feature);
    plot.set_residuals_shown(true);
    plot.set_intensity_shown(true);
    keep_pictures(plot, "view-profile", {820, 380});
    EXPECT_GT(plot.residuals_mm().size(), 300U);
    plot.set_view({spot.edge_mm.x() - 2, spot.edge_mm.z() - 1.5, 5, 3});
    plot.set_residuals_shown(false);
    plot.set_intensity_shown(false);
    keep_pictures(plot, "view-profile-near", {820, 380});
}

TEST(Gallery, Camera) {
    cell().see(default_door_spots().front().workobject_from_sensor, 3);
    CameraView view;
    view.set_caption("sensor A   1280 x 1024   12 bit");
    view.set_frame(cell().frame.image, &cell().peaks);
    view.set_region(QRect(200, 300, 800, 400));
    keep_pictures(view, "view-camera", {820, 480});
    EXPECT_EQ(view.histogram().pixels, 1280 * 1024);
}

std::vector<TravelProfile> pass_with(double yaw_deg) {
    const Pose at = default_door_spots().front().workobject_from_sensor *
                    Pose(Eigen::AngleAxisd(rad_from_deg(yaw_deg), Eigen::Vector3d::UnitZ()));
    std::vector<TravelProfile> pass;
    for (int travel = -20; travel <= 20; travel += 2)
        pass.push_back({static_cast<double>(travel),
                        cell().see(shifted(at, travel), static_cast<std::uint64_t>(travel + 40))});
    return pass;
}

TEST(Gallery, FrozenContour) {
    AlignmentOptions options;
    AlignView view;
    const auto skew = pass_with(2);
    auto result = check_alignment(skew, options);
    ASSERT_TRUE(result);
    view.set_result(skew, *result, options);
    EXPECT_EQ(view.verdict(), "DRIFTING") << result->yaw_deg;
    EXPECT_NEAR(std::abs(result->yaw_deg), 2, 0.3);
    keep_pictures(view, "view-align-drifting", {1100, 640});
    // The jitter window follows the keys and asks to be judged again.
    double asked = 0;
    QObject::connect(&view, &AlignView::jitter_dragged, [&](double half) { asked = half; });
    for (int i = 0; i < 5; ++i) QTest::keyClick(view.focusProxy(), Qt::Key_Left);
    EXPECT_NEAR(asked, options.jitter_mm - 0.5, 1e-9);
    EXPECT_NEAR(view.jitter_mm(), asked, 1e-9);
    // Cured as the view says.
    const auto straight = pass_with(2 + result->cure_about_z_deg);
    result = check_alignment(straight, options);
    ASSERT_TRUE(result);
    view.set_result(straight, *result, options);
    view.set_stack(AlignView::Stack::overlay);
    view.set_live(straight.front().profile);
    EXPECT_EQ(view.verdict(), "FROZEN") << result->expected_error_mm << " " << result->cure;
    keep_pictures(view, "view-align-frozen", {1100, 640});
}

// Numbers are never cut, however long the words beside them are (German), and however wide the numbers.
TEST(Gallery, FrozenContourShowsItsNumbersWhole) {
    AlignmentOptions options;
    options.tolerance_mm = 12.34;
    options.jitter_mm = 12.5;
    AlignView view;
    const auto skew = pass_with(2);
    auto result = check_alignment(skew, options);
    ASSERT_TRUE(result);
    result->yaw_deg = -12.34;
    result->sigma_yaw_deg = 11.11;
    view.set_result(skew, *result, options);
    for (const QSize size : {QSize(700, 300), QSize(1100, 640)})
        for (const bool longer : {false, true}) {
            for (auto* label : view.findChildren<QLabel*>())
                if (longer && label->text() == "Error from jitter")
                    label->setText("Fehler durch Auslösestreuung");
            view.resize(size);
            view.show();
            QTest::qWait(50);
            auto* panel = view.findChild<QScrollArea*>();
            ASSERT_TRUE(panel);
            const int right = panel->viewport()->mapTo(&view, QPoint(panel->viewport()->width(), 0)).x();
            for (auto* label : panel->findChildren<QLabel*>()) {
                const int end = label->mapTo(&view, QPoint(label->width(), 0)).x();
                EXPECT_LE(end, right) << label->text().toStdString();
                if (!label->wordWrap()) {
                    EXPECT_GE(label->width(), label->fontMetrics().horizontalAdvance(label->text()))
                        << label->text().toStdString();
                }
            }
        }
}

TEST(Gallery, Scene) {
    SceneView view;
    if (!view.has_opengl()) GTEST_SKIP() << "no OpenGL 3.2 on this display";
    const TriangleMesh& part = cell().cell->part_mesh();
    SceneMesh mesh;
    for (const auto& v : part.vertices)
        mesh.points.push_back(
            {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())});
    for (const auto& t : part.triangles) mesh.triangles.push_back({t.x(), t.y(), t.z()});
    view.resize(820, 480);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.set_part(mesh);
    std::vector<SceneSpot> spots;
    for (const DoorSpot& one : default_door_spots()) {
        SceneSpot spot;
        spot.id = one.id;
        spot.workobject_from_sensor = one.workobject_from_sensor;
        spot.reference_mm = one.edge_mm;
        spot.shift_mm = Eigen::Vector3d(2, 1, 0.5);
        spots.push_back(spot);
    }
    view.set_spots(spots);
    const DoorRegion region = default_door_regions().front();
    view.set_regions({{region.id, region.spot_ids, Eigen::Vector3d::UnitX(), "weakest: along X, 0.04 mm"}});
    ScenePath path;
    path.closed = true;
    path.before_mm = door_bead_path();
    for (const auto& p : path.before_mm) path.after_mm.push_back(p + Eigen::Vector3d(2, 1, 0.5));
    view.set_path(path);
    view.show_view(SceneView::View::iso);
    view.select_spot(spots[1].id);
    keep_pictures(view, "view-scene", {820, 480}, [&] { return view.picture(); });
    // Requests are coalesced: a thousand changes do not make a thousand pictures.
    const int before = view.pictures_rendered();
    for (int i = 0; i < 1000; ++i) view.set_correction_scale(10 + i % 7);
    QTest::qWait(100);
    EXPECT_LE(view.pictures_rendered() - before, 8);
    EXPECT_GE(view.pictures_rendered() - before, 1);
    // A line around two spots, with the right button or after begin_lasso(), names them; the part is not turned.
    view.show_view(SceneView::View::front);
    QTest::qWait(80);
    QStringList encircled;
    QObject::connect(&view, &SceneView::spots_encircled, [&](const QStringList& ids) { encircled = ids; });
    const auto around = [&](Qt::MouseButton button) {
        encircled.clear();
        QWidget* on = view.focusProxy();
        const QPointF middle = view.to_screen(spots[2].workobject_from_sensor * spots[2].reference_mm);
        const auto at = [&](double dx, double dy) {
            return on->mapFrom(&view, middle + QPointF(dx, dy)).toPoint();
        };
        QTest::mousePress(on, button, {}, at(-14, -14));
        for (const QPoint p : {at(14, -14), at(14, 14), at(-14, 14)}) {
            QMouseEvent move(QEvent::MouseMove, p, on->mapToGlobal(p), Qt::NoButton, button, {});
            QApplication::sendEvent(on, &move);
        }
        QTest::mouseRelease(on, button, {}, at(-14, 14));
        return middle;
    };
    const QPointF before_lasso = around(Qt::RightButton);
    EXPECT_TRUE(encircled.contains(QString::fromStdString(spots[2].id)));
    EXPECT_LT(encircled.size(), static_cast<qsizetype>(spots.size()));
    view.begin_lasso();
    EXPECT_EQ(around(Qt::LeftButton), before_lasso) << "the view has not been turned";
    EXPECT_TRUE(encircled.contains(QString::fromStdString(spots[2].id)));
    around(Qt::LeftButton);
    EXPECT_TRUE(encircled.isEmpty()) << "once";
    // A click on a spot selects it.
    QString picked;
    QObject::connect(&view, &SceneView::spot_picked, [&](const QString& id) { picked = id; });
    view.show_view(SceneView::View::front);
    QTest::qWait(80);
    const SceneSpot& target = spots[2];
    const QPointF at = view.to_screen(target.workobject_from_sensor * target.reference_mm);
    QWidget* canvas = view.focusProxy();
    QTest::mouseClick(canvas, Qt::LeftButton, {}, canvas->mapFrom(&view, at).toPoint());
    EXPECT_EQ(picked.toStdString(), target.id);
    EXPECT_EQ(view.selected_spot(), target.id);
    QSignalSpy read(&view, &SceneView::part_read);
    view.set_part_ply({std::byte{1}, std::byte{2}});
    ASSERT_TRUE(read.wait());
    EXPECT_FALSE(read.takeFirst().front().toBool());
    EXPECT_FALSE(view.has_part()) << "another part stands there";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n500 0 0\n0 500 0\n3 0 1 "
        "2\n";
    std::vector<std::byte> bytes;
    for (const char c : ply) bytes.push_back(static_cast<std::byte>(c));
    view.set_part_ply({std::byte{1}, std::byte{2}});
    view.set_part_ply(bytes);
    ASSERT_TRUE(read.wait());
    EXPECT_TRUE(read.takeFirst().front().toBool());
    EXPECT_TRUE(read.isEmpty()) << "the newest counts";
    double z = -1;
    QObject::connect(&view, &SceneView::part_picked, [&](double, double, double at_z) { z = at_z; });
    QTest::qWait(60);
    QTest::mouseClick(canvas, Qt::LeftButton, {},
                      canvas->mapFrom(&view, view.to_screen({120, 130, 0})).toPoint());
    EXPECT_NEAR(z, 0, 0.01);
}

// A project without a mesh: its spots fill the view as they come, and every view finds them again.
TEST(Gallery, SceneWithoutAMesh) {
    SceneView view;
    if (!view.has_opengl()) GTEST_SKIP() << "no OpenGL 3.2 on this display";
    view.resize(820, 480);
    view.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&view));
    view.set_part({});
    std::vector<SceneSpot> spots;
    for (const DoorSpot& one : default_door_spots()) {
        SceneSpot spot;
        spot.id = one.id;
        spot.workobject_from_sensor = one.workobject_from_sensor;
        spot.reference_mm = one.edge_mm;
        spots.push_back(spot);
    }
    const auto spread = [&] {
        QRectF box;
        int inside = 0;
        for (const SceneSpot& s : spots) {
            const QPointF at = view.to_screen(s.workobject_from_sensor * s.reference_mm);
            inside += view.rect().contains(at.toPoint());
            box |= QRectF(at - QPointF(1, 1), QSizeF(2, 2));
        }
        return inside == static_cast<int>(spots.size())
                   ? std::max(box.width() / view.width(), box.height() / view.height())
                   : 0.0;
    };
    view.set_spots(spots);
    EXPECT_GT(spread(), 0.3) << "as they come";
    QWidget* canvas = view.focusProxy();
    for (const auto which : {SceneView::View::fit, SceneView::View::front, SceneView::View::iso}) {
        for (int i = 0; i < 12; ++i) {
            QWheelEvent away(QPointF(400, 240), canvas->mapToGlobal(QPointF(400, 240)), {}, QPoint(0, -240),
                             Qt::NoButton, {}, Qt::NoScrollPhase, false);
            QApplication::sendEvent(canvas, &away);
        }
        EXPECT_LT(spread(), 0.2);
        view.show_view(which);
        EXPECT_GT(spread(), 0.3);
    }
}

TEST(Gallery, ChartsAndEditors) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0.02, 0.08);
    QWidget page;
    auto* column = new QVBoxLayout(&page);
    auto* trend = new TrendChart;
    auto* histogram = new Histogram;
    auto* bars = new ResidualBars;
    std::vector<QString> labels;
    TrendSeries x{"x", {}}, z{"z", {}};
    for (int i = 0; i < 60; ++i) {
        labels.push_back(QString::number(1001 + i));
        x.values.push_back(normal(random));
        z.values.push_back(normal(random) - 0.05);
    }
    trend->set_data("Region top", "mm", labels, {x, z}, {-0.2, 0.2});
    histogram->set_data("x", "mm", x.values, {-0.3, 0.3});
    bars->set_data({{"T1", {0.02, 0, -0.05}, 0.03, true},
                    {"T2", {0.31, 0, 0.22}, 0.03, false},
                    {"L", {-0.04, 0, 0.01}, 0.03, true}});
    auto* pose = new PoseEditor;
    pose->set_pose(default_door_spots()[3].workobject_from_sensor);
    auto* parameter =
        new ParameterEditor({"sigma_limit_mm", "mm", 0.001, 10, 0.1, 3, "Largest standard deviation."});
    for (QWidget* one : std::initializer_list<QWidget*>{trend, histogram, bars, pose, parameter})
        column->addWidget(one);
    keep_pictures(page, "view-charts", {820, 960});
    EXPECT_GT(*histogram->shown().cp, 0.5);
}

}  // namespace
}  // namespace seamwright
