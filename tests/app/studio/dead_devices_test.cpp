// What the window says of a sensor or a robot that is not there any more: never that it lives.

#include <gtest/gtest.h>

#include <QLabel>
#include <filesystem>

#include "app/studio/studio.h"
#include "tests/app/studio/person.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"
#include "widgets/profile/profile_canvas.h"

namespace seamwright {
namespace {

class DeadDevices : public testing::Test {
  protected:
    void SetUp() override {
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        auto made = serve_cell({}, folder / "cell.seam");
        ASSERT_TRUE(made) << made.error().sentence();
        served.emplace(std::move(*made));
        served->station.reset();
        StudioOptions o;
        o.file = QString::fromStdString((folder / "cell.seam").string());
        o.language = "en";
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString((folder / "").string());
        studio = std::make_unique<Studio>(*qApp, o);
        me = std::make_unique<DeskPerson>(studio->window());
        studio->window().resize(1280, 800);
        studio->window().show_step(Step::cell);
        me->click("connect");
        ASSERT_TRUE(me->wait([&] { return desk().station().connected; })) << desk().station().trouble;
        ASSERT_TRUE(me->wait([&] { return state().contains("/s") && plot().size() > 0; }));
        ASSERT_TRUE(me->wait([&] { return status().contains("robot R1") && status().contains("ok"); }));
        ASSERT_FALSE(studio->window().views().profile->stale());
    }
    Desk& desk() { return studio->desk(); }
    const Profile& plot() {
        return dynamic_cast<ProfileCanvas&>(*studio->window().views().profile->focusProxy()).profile;
    }
    QString state() { return studio->window().findChild<QLabel*>("sensor_state")->text(); }
    QString status() {
        QString all;
        for (const char* name : {"status_sensors", "status_robots"})
            all += studio->window().findChild<QLabel*>(name)->text() + " ";
        return all;
    }
    // All the time for so long, the window living on meanwhile.
    template <class Holds>
    void holds_for(int ms, Holds holds) {
        QElapsedTimer timer;
        for (timer.start(); timer.elapsed() < ms; QTest::qWait(50)) {
            ASSERT_TRUE(holds()) << state().toStdString() << " | " << status().toStdString();
        }
    }
    void picture(const char* name) {
        studio->window().grab().save(QStringLiteral(SEAMWRIGHT_SCREENS "/%1.png").arg(name));
    }

    TemporaryFolder folder;
    std::optional<ServedCell> served;
    std::unique_ptr<Studio> studio;
    std::unique_ptr<DeskPerson> me;
};

TEST_F(DeadDevices, ASensorThatDiesIsNotShownAlive) {
    served->sensor.reset();
    ASSERT_TRUE(me->wait([&] {
        return state().contains("no frame since") && status().contains("sensor A no frame");
    })) << state().toStdString();
    EXPECT_TRUE(studio->window().views().profile->stale());
    picture("dead_sensor");
    holds_for(5000, [&] {
        return !state().contains("/s ") && !status().contains("sensor A ok") &&
               studio->window().views().profile->stale();
    });
    EXPECT_TRUE(status().contains("robot R1") && status().contains("ok")) << status().toStdString();
}

TEST_F(DeadDevices, ARobotThatDiesIsNotCalledOk) {
    served->robot.reset();
    const auto gone = [&] { return status().contains("R1 silent") || status().contains("R1 no answer"); };
    ASSERT_TRUE(me->wait(gone)) << status().toStdString();
    holds_for(4000, gone);
    EXPECT_TRUE(status().contains("sensor A ok")) << status().toStdString();
}

TEST_F(DeadDevices, NothingStaysOfADisconnectedSensorOrAnotherProject) {
    desk().worker().disconnect_devices();
    ASSERT_TRUE(me->wait([&] {
        return state().contains("not connected") && status().contains("not connected");
    })) << state().toStdString()
        << status().toStdString();
    EXPECT_EQ(plot().size(), 0U);
    EXPECT_EQ(studio->window().views().camera->histogram().pixels, 0);
    EXPECT_FALSE(status().contains("R1")) << status().toStdString();
    picture("disconnected");

    me->click("connect");
    ASSERT_TRUE(me->wait([&] { return state().contains("/s") && plot().size() > 0; }));
    studio->create(QString::fromStdString((folder / "empty.seam").string()));
    ASSERT_TRUE(me->wait([&] { return plot().size() == 0; }));
    EXPECT_FALSE(state().contains("/s")) << state().toStdString();
    EXPECT_FALSE(status().contains("ok")) << status().toStdString();
}

}  // namespace
}  // namespace seamwright
