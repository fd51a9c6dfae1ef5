// Hands that never rest: devices, spots and projects changed in any order while the desk is connected, measures, teaches,
// calibrates, searches. Nothing of it may end the program or leave it waiting.

#include <QMessageBox>
#include <QMetaEnum>
#include <QTimer>
#include <array>
#include <iostream>
#include <random>

#include "devices/registry.h"
#include "tests/app/studio/freeze_watch.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/pages/calibrate_page.h"

namespace seamwright {
namespace {

constexpr int kActs = 120;
constexpr std::chrono::seconds kLongest{40};

class Restless : public Furniture, public testing::WithParamInterface<unsigned> {
  protected:
    std::mt19937 random;
    QTimer dismisser;
    int project = 0;

    Desk& desk() { return studio->desk(); }
    StationWorker& worker() { return desk().worker(); }
    int draw(int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); }
    template <class T>
    std::string any(const std::vector<T>& list, const std::string& none = "nobody") {
        if (list.empty()) return none;
        return list[static_cast<std::size_t>(draw(static_cast<int>(list.size())))].id;
    }
    std::string sensor() { return any(desk().project().sensors); }
    std::string robot() { return any(desk().project().robots); }
    std::string spot() { return any(desk().project().spots); }

    // Any question that stands there is left by Escape.
    void answer_all() {
        QObject::connect(&dismisser, &QTimer::timeout, &dismisser, [] {
            if (auto* box = qobject_cast<QDialog*>(QApplication::activeModalWidget())) box->reject();
        });
        dismisser.start(15);
    }

    void add_sensor() {
        SensorSetup s;
        const auto& all = desk().project().sensors;
        if (!all.empty() && draw(2)) s = all[static_cast<std::size_t>(draw(static_cast<int>(all.size())))];
        s.id = desk().free_id<SensorSetup>("N");
        if (s.driver.empty()) s.driver = "simulated";
        (void)desk().add(s);
    }
    void add_robot() {
        RobotSetup r;
        const auto& all = desk().project().robots;
        if (!all.empty() && draw(2)) r = all[static_cast<std::size_t>(draw(static_cast<int>(all.size())))];
        r.id = desk().free_id<RobotSetup>("Q");
        if (r.driver.empty()) r.driver = draw(2) ? "simulated" : "simulated-gripper";
        (void)desk().add(r);
    }
    template <class Setup, class Drivers>
    void change(const std::vector<Setup>& all, const Drivers& drivers) {
        if (all.empty()) return;
        Setup setup = all[static_cast<std::size_t>(draw(static_cast<int>(all.size())))];
        if (draw(3) == 0)
            setup.driver = drivers[static_cast<std::size_t>(draw(static_cast<int>(drivers.size())))].name;
        else
            setup.settings["seed"] = draw(5);
        (void)desk().edit(setup);
    }
    void change_device() {
        if (draw(2))
            change(desk().project().sensors, sensor_drivers());
        else
            change(desk().project().robots, robot_drivers());
    }
    void change_spot() {
        const Spot* found = find_spot(desk().project(), spot());
        if (!found) return;
        Spot s = *found;
        s.sensor_id = sensor();
        s.robot_id = robot();
        if (draw(3) == 0) s.id = desk().free_id<Spot>("S");
        (void)(find_spot(desk().project(), s.id) ? desk().edit(s) : desk().add(s));
    }
    void move_by_hand() {
        const auto& robots = desk().station().robots;
        if (robots.empty() || !robots.front().base_from_flange) return;
        Pose at = *robots.front().base_from_flange;
        at.translation().z() += draw(3) - 1;
        if (draw(2))
            worker().jog(robots.front().id, at);
        else
            worker().go_to(robots.front().id, at);
    }
    void click(const QString& name) {
        for (QPushButton* b : window().findChildren<QPushButton*>(name))
            if (b->isVisible() && b->isEnabled()) return b->click();
    }
    void guided() {
        window().show_step(Step::calibrate);
        QList<QPushButton*> begin;
        for (auto* b : window().findChildren<QPushButton*>())
            if (b->isVisible() && b->isEnabled() && b->objectName().startsWith("begin_")) begin << b;
        if (!begin.isEmpty()) begin[draw(static_cast<int>(begin.size()))]->click();
    }
    void change_project() {
        switch (draw(4)) {
            case 0:
                (void)desk().create(folder / ("p" + std::to_string(project++) + ".seam"), desk().project());
                break;
            case 1:
                studio->open_demo(draw(2) == 0);
                break;
            case 2:
                studio->create(path("empty.seam"));
                break;
            default:
                (void)desk().save();
                (void)desk().save_as(folder / ("as" + std::to_string(project++) + ".seam"));
        }
    }

    struct Deed {
        const char* name;
        int weight;
        std::function<void()> run;
    };
    std::vector<Deed> all_deeds() {
        return {
            {"add_sensor", 4, [this] { add_sensor(); }},
            {"add_robot", 3, [this] { add_robot(); }},
            {"remove_sensor", 3, [this] { (void)desk().remove<SensorSetup>(sensor()); }},
            {"remove_robot", 3, [this] { (void)desk().remove<RobotSetup>(robot()); }},
            {"rename_sensor", 4,
             [this] {
                 (void)desk().rename<SensorSetup>(sensor(),
                                                  draw(4) ? desk().free_id<SensorSetup>("N") : sensor());
             }},
            {"rename_robot", 4,
             [this] {
                 (void)desk().rename<RobotSetup>(robot(),
                                                 draw(4) ? desk().free_id<RobotSetup>("Q") : robot());
             }},
            {"change_device", 4, [this] { change_device(); }},
            {"undo", 8, [this] { desk().undo_stack().undo(); }},
            {"redo", 4, [this] { desk().undo_stack().redo(); }},
            {"change_spot", 4, [this] { change_spot(); }},
            {"remove_spot", 1, [this] { (void)desk().remove<Spot>(spot()); }},
            {"connect", 6, [this] { worker().connect_devices(); }},
            {"disconnect", 2, [this] { worker().disconnect_devices(); }},
            {"measure", 4, [this] { worker().measure("p", draw(2) == 0, draw(2) == 0); }},
            {"zero_shift", 2, [this] { worker().zero_shift(2); }},
            {"known_shift", 1, [this] { worker().known_shift(ShiftBy::simulated_part, {}); }},
            {"teach", 3,
             [this] {
                 if (const Spot* s = find_spot(desk().project(), spot())) worker().teach(*s, 2);
             }},
            {"find_light", 2,
             [this] {
                 if (const Spot* s = find_spot(desk().project(), spot())) worker().find_light(*s);
             }},
            {"confirm", 2, [this] { worker().confirm(spot()); }},
            {"record_pass", 2,
             [this] {
                 if (const Spot* s = find_spot(desk().project(), spot())) worker().record_pass(*s, 2, {});
             }},
            {"measure_robot", 1, [this] { worker().measure_robot({}); }},
            {"measure_trigger", 1, [this] { worker().measure_trigger({}); }},
            {"move", 4, [this] { move_by_hand(); }},
            {"set_parameter", 2, [this] { worker().set_sensor_parameter(sensor(), "exposure_us", 500); }},
            {"guided", 4, [this] { guided(); }},
            {"capture", 4, [this] { click("calibration_capture"); }},
            {"verify", 1, [this] { click("calibration_verify"); }},
            {"go", 2, [this] { click("calibration_go"); }},
            {"series", 2, [this] { click("calibration_all"); }},
            {"back", 2, [this] { click("calibration_back"); }},
            {"answer", 3, [this] { worker().answer_push(draw(2) == 0); }},
            {"cancel", 3, [this] { worker().cancel(); }},
            {"step", 8,
             [this] { window().show_step(kSteps[static_cast<std::size_t>(draw(kSteps.size()))]); }},
            {"select", 3,
             [this] {
                 desk().selection().select_spot(spot());
                 desk().selection().select_sensor(sensor());
                 desk().selection().select_region(any(desk().project().regions));
             }},
            {"search", 1, [this] { worker().search_cameras(); }},
            {"project", 3, [this] { change_project(); }},
            {"jog_panel", 1, [this] { QTest::keyClick(&window(), Qt::Key_F8); }},
            {"language", 1, [this] { studio->set_language(draw(2) ? "de" : "en"); }},
        };
    }
};

TEST_P(Restless, NothingEndsTheDeskOrLetsItWait) {
    random.seed(GetParam());
    start(true);
    studio->window().show();
    answer_all();
    const auto deeds_there = all_deeds();
    int weights = 0;
    for (const Deed& d : deeds_there) weights += d.weight;
    FreezeWatch watch(3000);
    const auto begun = std::chrono::steady_clock::now();
    for (int n = 0; n < kActs && std::chrono::steady_clock::now() - begun < kLongest; ++n) {
        int at = draw(weights);
        const Deed* deed = &deeds_there.front();
        for (const Deed& d : deeds_there) {
            deed = &d;
            if ((at -= d.weight) < 0) break;
        }
        watch.during(deed->name);
        std::cerr << deed->name << ' ';  // what was done before a crash
        deed->run();
        if (const int rest = draw(5); rest == 0)
            QTest::qWait(draw(300));
        else if (rest < 3)
            QApplication::processEvents();
    }
    std::cerr << '\n';
    worker().cancel();
    EXPECT_TRUE(QTest::qWaitFor(
        [&] {
            worker().answer_push(false);
            return !worker().busy();
        },
        60000));
    // Whatever was left, the demo connects again.
    ASSERT_TRUE(studio->open_demo(true));
    ASSERT_TRUE(QTest::qWaitFor([&] { return desk().station().connected && !worker().busy(); }, 60000));
    watch.during("close");
    window().close();
    EXPECT_FALSE(desk().is_open());
    for (const Freeze& f : watch.freezes()) ADD_FAILURE() << f.ms << " ms during " << f.during.toStdString();
}

INSTANTIATE_TEST_SUITE_P(Seeds, Restless, testing::Range(1U, 7U));

}  // namespace
}  // namespace seamwright
