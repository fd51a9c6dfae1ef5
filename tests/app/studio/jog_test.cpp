// The robot moved by hand from the window: steps, as long as pressed, and when it stops.

#include <gtest/gtest.h>

#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QMenu>
#include <filesystem>

#include "app/studio/studio.h"
#include "projects/measure/measure.h"
#include "tests/app/studio/person.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

class Jogging : public testing::Test {
  protected:
    void start(const QString& file, const char* language = "en") {
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        StudioOptions o;
        o.file = file;
        o.language = language;
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString((folder / "").string());
        studio = std::make_unique<Studio>(*qApp, o);
        me = std::make_unique<DeskPerson>(studio->window());
        studio->window().resize(1280, 800);
        QApplication::setActiveWindow(&studio->window());
        studio->window().show_step(Step::cell);
        if (!desk().station().connected) me->click("connect");
        ASSERT_TRUE(me->wait([&] { return desk().station().connected && place(); }));
        studio->window().show_step(Step::teach);
        QTest::keyClick(&studio->window(), Qt::Key_F8);
        ASSERT_TRUE(me->wait([&] { return studio->window().views().jog->isVisible(); }));
    }
    Desk& desk() { return studio->desk(); }
    std::optional<Pose> place() {
        const auto& robots = desk().station().robots;
        return robots.empty() ? std::nullopt : robots.front().base_from_flange;
    }
    QPushButton* key(const char* name) { return me->find<QPushButton>(name); }
    // What is asked of the worker is done when it stands still for this long.
    Pose settled() {
        std::optional<Pose> last = place();
        QElapsedTimer still;
        for (still.start(); still.elapsed() < 900; QTest::qWait(30))
            if (const auto now = place(); now && distance_mm(*now, *last) > 1e-9) {
                last = now;
                still.restart();
            }
        return *last;
    }
    void picture(const char* name) {
        studio->window().grab().save(QStringLiteral(SEAMWRIGHT_SCREENS "/%1.png").arg(name));
    }

    TemporaryFolder folder;
    std::unique_ptr<Studio> studio;
    std::unique_ptr<DeskPerson> me;
};

TEST_F(Jogging, APressIsOneStepAlongTheChosenAxes) {
    start({});
    me->choose("jog_frame", "Robot's base");
    me->choose("jog_step", "5 mm, 1°");
    const Pose before = settled();
    me->click("jog_Xplus");
    Pose after = settled();
    EXPECT_LT((after.translation() - before.translation() - Eigen::Vector3d(5, 0, 0)).norm(), 1e-6);
    me->click("jog_Xminus");
    EXPECT_LT(distance_mm(settled(), before), 1e-6) << "back where it was";
    // Three presses in quick succession are three steps.
    for (int i = 0; i < 3; ++i) QTest::mouseClick(key("jog_Zplus"), Qt::LeftButton);
    after = settled();
    EXPECT_LT((after.translation() - before.translation() - Eigen::Vector3d(0, 0, 15)).norm(), 1e-6);
    me->choose("jog_frame", "Sensor");
    const Pose here = settled();
    me->click("jog_Rzplus");
    const Pose turned = settled();
    EXPECT_NEAR(deg_from_rad(angle_rad(turned, here)), 1, 1e-6);
    const Calibration* c = calibration_of(desk().project(), desk().project().spots.front());
    ASSERT_TRUE(c);
    EXPECT_LT(distance_mm(turned * c->flange_from_sensor, here * c->flange_from_sensor), 1e-6)
        << "it turns about the sensor's origin";
    picture("jog");
}

TEST_F(Jogging, ItMovesAsLongAsTheKeyIsPressedAndNoLonger) {
    start({});
    me->choose("jog_frame", "Robot's base");
    me->choose("jog_way", "As long as pressed");
    const Pose before = settled();
    QElapsedTimer pressed;
    pressed.start();
    QTest::mousePress(key("jog_Zplus"), Qt::LeftButton);
    QTest::qWait(1000);
    QTest::mouseRelease(key("jog_Zplus"), Qt::LeftButton);
    const double seconds = static_cast<double>(pressed.elapsed()) / 1000;
    const Pose after = settled();
    const double way = after.translation().z() - before.translation().z();
    EXPECT_GT(way, 4) << "10 mm/s for a second";
    EXPECT_LT(way, 10 * seconds + 1e-6) << "never faster than set";
    EXPECT_LT((after.translation() - before.translation()).head<2>().norm(), 1e-6);
    // The focus goes while the key is down: it stops.
    QTest::mousePress(key("jog_Zplus"), Qt::LeftButton);
    QTest::qWait(300);
    me->find<QComboBox>("jog_frame")->setFocus();
    const Pose stopped = settled();
    QTest::qWait(500);
    EXPECT_LT(distance_mm(settled(), stopped), 1e-9);
    QTest::mouseRelease(key("jog_Zplus"), Qt::LeftButton);
}

TEST_F(Jogging, ARealRobotMovesOnlyWhenSomebodyStandsBesideIt) {
    auto served = serve_cell({}, folder / "cell.seam");
    ASSERT_TRUE(served) << served.error().sentence();
    served->station.reset();
    served->cell->set_mode(
        RobotMode::manual_reduced);  // T1 with the program SEAMWRIGHT, as a KUKA is moved by command
    start(QString::fromStdString((folder / "cell.seam").string()));
    const Pose before = settled();
    EXPECT_FALSE(key("jog_Xplus")->isEnabled());
    auto* consent = me->find<QCheckBox>("jog_consent");
    ASSERT_TRUE(consent);
    me->look_at(consent);
    consent->setFocus();
    QTest::keyClick(consent, Qt::Key_Space);
    ASSERT_TRUE(key("jog_Xplus")->isEnabled());
    me->choose("jog_frame", "Robot's base");
    me->click("jog_Xplus");
    ASSERT_TRUE(me->wait([&] { return place() && distance_mm(*place(), before) > 0.9; }))
        << me->find<QLabel>("jog_message")->text().toStdString();
    EXPECT_LT((settled().translation() - before.translation() - Eigen::Vector3d(1, 0, 0)).norm(), 0.02);
    picture("jog_real");
    // Connected anew without having been disconnected: the next robot there may be another.
    studio->window().show_step(Step::cell);
    me->click("connect");
    ASSERT_TRUE(me->wait([&] { return !consent->isChecked(); })) << "asked again after every connection";
    ASSERT_TRUE(me->wait([&] { return !desk().worker().busy() && place(); }));
    EXPECT_FALSE(key("jog_Xplus")->isEnabled());
    // What was asked to go there meanwhile does not, and says what is missing.
    const Pose there = *place();
    EXPECT_FALSE(desk().go_to(desk().project().robots[0].id, before));
    ASSERT_TRUE(me->wait([&] { return me->window().findChild<QLabel*>("jog_asked")->isVisible(); }));
    EXPECT_LT(distance_mm(settled(), there), 1e-6);
    studio->window().show_step(Step::cell);
    me->click("disconnect");
    ASSERT_TRUE(me->wait([&] { return !desk().station().connected; }));
    EXPECT_FALSE(key("jog_Xplus")->isEnabled());
    me->click("connect");
    ASSERT_TRUE(me->wait([&] { return desk().station().connected && place(); }));
    EXPECT_FALSE(consent->isChecked()) << "asked again after every connection";
    EXPECT_FALSE(key("jog_Xplus")->isEnabled());
}

TEST_F(Jogging, CamerasOnTheWireAreTakenByAClick) {
    auto served = serve_cell({}, folder / "cell.seam");  // a GigE Vision camera on this computer
    ASSERT_TRUE(served) << served.error().sentence();
    served->station.reset();
    start(QString::fromStdString((folder / "cell.seam").string()));
    studio->window().show_step(Step::cell);
    me->click("disconnect");
    ASSERT_TRUE(me->wait([&] { return !desk().station().connected; }));
    const std::size_t before = desk().project().sensors.size();
    me->click("search_cameras");
    ASSERT_TRUE(me->wait([&] { return studio->window().findChild<QMenu*>("cameras"); }));
    auto* menu = studio->window().findChild<QMenu*>("cameras");
    ASSERT_FALSE(menu->actions().isEmpty());
    picture("cameras_found");
    if (!menu->actions().front()->isEnabled())
        GTEST_SKIP() << "this computer answers no broadcast on loopback";
    menu->actions().front()->trigger();
    ASSERT_EQ(desk().project().sensors.size(), before + 1);
    EXPECT_EQ(desk().project().sensors.back().driver, "genicam");
    EXPECT_TRUE(desk().project().sensors.back().settings.contains("address"));
}

}  // namespace
}  // namespace seamwright
