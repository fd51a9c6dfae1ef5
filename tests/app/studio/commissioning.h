#pragma once
// What a commissioning engineer does at the pages, and how many clicks it took.

#include <gtest/gtest.h>

#include <QListWidget>
#include <QRegularExpression>
#include <QTreeWidget>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "projects/measure/measure.h"
#include "tests/app/studio/person.h"
#include "widgets/profile/profile_plot.h"

namespace seamwright {

// Of the door's suggested spots the one nearest to a place that the page names, its edge along `edge`.
inline std::size_t nearest_spot(const Eigen::Vector3d& place_mm, const Eigen::Vector3d& edge,
                                const std::set<std::size_t>& taken) {
    const auto doors = default_door_spots();
    std::size_t best = doors.size();
    double least = 1e9;
    for (std::size_t i = 0; i < doors.size(); ++i) {
        const Pose& w = doors[i].workobject_from_sensor;
        if (taken.count(i) || std::abs(w.linear().col(1).dot(edge)) < 0.9) continue;
        if (const double far = (w.translation() - place_mm).norm(); far < least) least = far, best = i;
    }
    return best;
}

// What a person at the pages does at a spot: pose, feature by pointing, reference, and the pass until the
// contour stands still.
class Teacher {
  public:
    Teacher(DeskPerson& me, Desk& desk, const SimulatedCell& cell) : me_(me), desk_(desk), cell_(cell) {}

    void add(const DoorSpot& door, bool by_template) {
        me_.step(3);
        const std::size_t before = desk_.project().spots.size();
        int clicks = me_.clicks();
        me_.click("add_spot");
        clicks = me_.clicks() - clicks;
        ASSERT_EQ(desk_.project().spots.size(), before + 1);
        me_.write_pose("spot_pose", cell_.flange_for(door.workobject_from_sensor));
        look(before, by_template);
        clicks += look_clicks_;
        int& first = by_template ? template_clicks_ : end_clicks_;
        if (first == 0) first = clicks;
        freeze(before);
    }
    // Of the first spot of a kind, from "add" to its reference, where the robot stands there already.
    int clicks(bool by_template) const { return by_template ? template_clicks_ : end_clicks_; }
    // An earlier spot, taught once more by a template.
    void by_template(std::size_t k) {
        me_.step(3);
        choose(k);
        look(k, true);
        freeze(k);
    }

    // Every spot that is not in the region yet.
    void group() {
        for (; grouped_ < static_cast<int>(desk_.project().spots.size()); ++grouped_) {
            auto* list = me_.find<QListWidget>("region_spots");
            ASSERT_TRUE(list);
            me_.look_at(list);
            list->setFocus();
            list->setCurrentRow(grouped_);
            QTest::keyClick(list, Qt::Key_Space);
            me_.clicked_too();
            QApplication::processEvents();
        }
        ASSERT_EQ(desk_.project().regions.at(0).spot_ids.size(), desk_.project().spots.size());
    }
    // What the region's page says, until it is sure enough. `taken`: of the door's suggested spots.
    void follow_advice(std::set<std::size_t>& taken) {
        const auto sure = [&] {
            return desk_.checks().at(static_cast<std::size_t>(CheckStep::observable)).done();
        };
        const auto doors = default_door_spots();
        for (int cure = 0; cure < 4 && !sure(); ++cure) {
            me_.picture(QString("07_region_%1").arg(cure));
            const QString say = me_.text_of("plan_verdict"), advice = me_.text_of("plan_advice");
            ASSERT_TRUE(say.startsWith("nicht sicher genug")) << say.toStdString();
            std::cout << "region: " << say.toStdString() << "\n";
            const QRegularExpression place(
                R"re(eine Messstelle ergänzen .*\((-?\d+), (-?\d+), (-?\d+)\) mm .* entlang ([XYZ])$)re"),
                feature(R"re(Messstelle S(\d+): ihr Merkmal ist .* mit einer Vorlage einlernen$)re");
            // A spot whose feature is known badly is mended before another is added: what is just sure enough by a spot more is
            // refused by the gate now and then. Then the first place that the door allows: no edge of it runs along Z.
            bool followed = false;
            const QStringList lines = advice.split('\n').mid(1);
            for (const QString& line : lines)
                if (const auto k = feature.match(line); k.hasMatch() && !followed) {
                    by_template(k.captured(1).toUInt() - 1);
                    std::cout << line.toStdString() << "\n";
                    followed = true;
                }
            for (const QString& line : lines) {
                const auto m = place.match(line);
                if (!m.hasMatch() || followed) continue;
                const Eigen::Vector3d at(m.captured(1).toDouble(), m.captured(2).toDouble(),
                                         m.captured(3).toDouble());
                const std::size_t i =
                    nearest_spot(at, Eigen::Vector3d::Unit(m.captured(4)[0].unicode() - 'X'), taken);
                if (i >= doors.size()) continue;
                taken.insert(i);
                add(doors[i], true);
                std::cout << line.toStdString() << "\n";
                followed = true;
            }
            ASSERT_TRUE(followed) << "nothing that a person could do: " << advice.toStdString();
            if (testing::Test::HasFatalFailure()) return;
            me_.step(5);
            group();
            if (testing::Test::HasFatalFailure()) return;
        }
    }

    // The part that stands there, on the page that measures: what would be written is shown, and pushed by its button.
    void push(const char* picture) {
        const auto asked = [&] {
            auto* confirm = me_.window().findChild<QWidget*>("confirm");
            return confirm && confirm->isVisible();
        };
        me_.click("measure_push");
        ASSERT_TRUE(me_.wait([&] { return asked() || desk_.worker().busy(); }));
        ASSERT_TRUE(me_.wait([&] { return asked() || !desk_.worker().busy(); }));
        ASSERT_TRUE(asked()) << me_.text_of("run_verdict").toStdString() << " "
                             << me_.text_of("gate").toStdString();
        me_.picture(picture);
        me_.click("push");
        ASSERT_TRUE(me_.wait([&] { return !desk_.worker().busy(); }));
        QTest::qWait(100);
    }

  private:
    std::string id(std::size_t k) const { return desk_.project().spots.at(k).id; }
    void choose(std::size_t k) {
        auto* tree = me_.find<QTreeWidget>("spot_tree");
        ASSERT_TRUE(tree);
        const auto items =
            tree->findItems(QString::fromStdString(id(k)), Qt::MatchExactly | Qt::MatchRecursive);
        ASSERT_FALSE(items.isEmpty());
        tree->scrollToItem(items[0]);
        QTest::mouseClick(tree->viewport(), Qt::LeftButton, {}, tree->visualItemRect(items[0]).center());
    }
    void measure_reference() {
        bool ended = false;
        QObject over;
        QObject::connect(&desk_.worker(), &StationWorker::taught, &over, [&] { ended = true; });
        QObject::connect(&desk_.worker(), &StationWorker::failed, &over, [&](const QString& why) {
            ended = true;
            ADD_FAILURE() << why.toStdString();
        });
        me_.click("measure_reference");
        ASSERT_TRUE(me_.wait([&] { return ended; }));
        QApplication::processEvents();  // the page takes what was measured
    }
    void look(std::size_t k, bool by_template) {
        const std::string sensor = desk_.project().spots[k].sensor_id;
        me_.click("go_there");
        ASSERT_TRUE(me_.wait([&] { return !desk_.worker().busy(); }));
        const auto arrived = std::chrono::steady_clock::now().time_since_epoch();
        ASSERT_TRUE(me_.wait([&] {  // the picture is of the new place
            const auto live = desk_.live().latest(sensor);
            return live && live->profile.size() > 100 &&
                   std::chrono::nanoseconds(live->frame->host_time_ns) > arrived;
        })) << "the live profile of spot "
            << id(k);
        QTest::qWait(100);  // it is drawn
        const int before = me_.clicks();
        auto* plot = me_.window().views().profile;
        const auto on_plot = [&](double x, double z) {
            return plot->focusProxy()->mapFrom(plot, plot->to_screen({x, z})).toPoint();
        };
        const auto live = desk_.live().latest(sensor);
        double left = 1e9, left_z = 0, right = -1e9, low = 1e9, high = -1e9;
        for (std::size_t p = 0; p < live->profile.size(); ++p) {
            const double x = live->profile.x_mm[p], z = live->profile.z_mm[p];
            if (!std::isfinite(x + z) || live->profile.segment[p] == kOutlier) continue;
            if (x < left) left = x, left_z = z;
            right = std::max(right, x), low = std::min(low, z), high = std::max(high, z);
        }
        if (by_template) {
            me_.choose("feature_kind", "Vorlage");
            me_.click("template_window");
            me_.picture(QString("05_template_%1").arg(k + 1));
            me_.drag(plot->focusProxy(), on_plot(left - 1, high + 1),
                     on_plot(std::min(left + 42, right), low - 1));
            me_.clicked_too();
            ASSERT_GT(desk_.project().spots[k].feature.template_profile.size(), 50U);
        } else {
            me_.choose("feature_kind", "Konturende");
            me_.click("pick");
            QTest::mouseClick(plot->focusProxy(), Qt::LeftButton, {}, on_plot(left, left_z));
            me_.clicked_too();
        }
        measure_reference();
        look_clicks_ = me_.clicks() - before;
        ASSERT_GT(desk_.project().spots[k].reference_profile.size(), 0U)
            << me_.text_of("reference").toStdString();
        me_.picture(QString("05_taught_%1").arg(k + 1));
    }
    // Turned as the page says until the contour stands still.
    void freeze(std::size_t k) {
        me_.step(4);
        choose(k);
        for (int turn = 0; turn < 4; ++turn) {
            me_.click("start_pass");
            ASSERT_TRUE(me_.wait([&] { return desk_.worker().busy(); }));
            ASSERT_TRUE(me_.wait([&] { return !desk_.worker().busy(); }));
            QApplication::processEvents();
            if (me_.text_of("align_verdict") == "STEHT STILL") break;
            // A reflection in one of the pass's frames looks so: a person runs it again.
            if (me_.text_of("align_verdict") == "FORM ÄNDERT SICH") continue;
            ASSERT_EQ(me_.text_of("align_verdict"), "DRIFTET") << me_.text_of("align_numbers").toStdString();
            me_.picture(QString("06_drifting_%1_%2").arg(k + 1).arg(turn));
            me_.click("adopt_pose");
            me_.step(3);
            me_.click("go_there");
            measure_reference();
            me_.step(4);
        }
        ASSERT_EQ(me_.text_of("align_verdict"), "STEHT STILL") << me_.text_of("align_numbers").toStdString();
        me_.picture(QString("06_frozen_%1").arg(k + 1));
        me_.click("accept_pass");
        ASSERT_TRUE(desk_.project().spots[k].curve);
    }

    DeskPerson& me_;
    Desk& desk_;
    const SimulatedCell& cell_;
    int grouped_ = 0, look_clicks_ = 0, end_clicks_ = 0, template_clicks_ = 0;
};

// The start has its own measure (bench_studio): the window stands, the demo's sensor is live and everything is painted once.
inline bool come_up(Desk& desk) {
    const auto live = [&] {
        return desk.station().connected && !desk.station().sensors.empty() &&
               desk.live().latest(desk.station().sensors.front().id);
    };
    if (!QTest::qWaitFor(live, 10'000)) return false;
    QTest::qWait(500);
    return true;
}

// What a hand feels. A machine that shares its processors with others may be given more (SEAMWRIGHT_FREEZE_MS).
inline double freeze_ms() {
    const char* given = std::getenv("SEAMWRIGHT_FREEZE_MS");
    return given ? std::atof(given) : 100;
}

// How many clicks each chapter took, and how many it may: what a hand in a glove does a hundred times.
struct Chapter {
    const char* name;
    int clicks, most;
};
inline void print(const std::vector<Chapter>& chapters, const std::vector<Freeze>& freezes) {
    std::printf("%-44s %6s %5s\n", "clicks", "took", "most");
    for (const Chapter& c : chapters) {
        std::printf("%-44s %6d %5d\n", c.name, c.clicks, c.most);
        EXPECT_LE(c.clicks, c.most) << c.name;
    }
    double longest = 0;
    for (const Freeze& f : freezes) {
        longest = std::max(longest, f.ms);
        EXPECT_LT(f.ms, freeze_ms()) << f.during.toStdString();
        if (f.ms >= freeze_ms() / 2) std::printf("  %-40s %.0f ms\n", f.during.toUtf8().constData(), f.ms);
    }
    std::printf("the event loop never stood still for longer than %.0f ms\n", longest);
}

}  // namespace seamwright
