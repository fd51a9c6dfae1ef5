// A person works at the real studio until somebody pulls the plug. What happens is said through a pipe,
// always after it has happened, except what is about to begin.
//
// Environment: SEAMWRIGHT_KILL_FILE, _FOLDER, _PIPE (descriptor), _SEED.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <QCheckBox>
#include <QMessageBox>
#include <QTreeWidget>
#include <random>

#include "app/studio/studio.h"
#include "tests/app/studio/kill_protocol.h"
#include "tests/app/studio/person.h"
#include "widgets/editors/parameter_editor.h"

namespace seamwright {
namespace {

constexpr std::size_t kMostSpots = 14;

class Worker {
  public:
    Worker() : pipe_(std::atoi(std::getenv("SEAMWRIGHT_KILL_PIPE"))), rng_(seed()) {}

    void work() {
        // The question comes while the studio is built.
        QTimer look;
        QObject::connect(&look, &QTimer::timeout, &look, [this] { answer_question(); });
        look.start(10);
        StudioOptions options;
        const QString folder = qEnvironmentVariable("SEAMWRIGHT_KILL_FOLDER");
        options.file = qEnvironmentVariable("SEAMWRIGHT_KILL_FILE");
        options.language = "en";
        options.theme = "light";
        options.settings = folder + "/settings.ini";
        options.data = folder;
        Studio studio(*qApp, options);
        look.stop();
        Desk& desk = studio.desk();
        ASSERT_EQ(desk.path().string(), options.file.toStdString());
        const auto say_project = [&](char kind) { say(kind, fingerprint(desk.project())); };
        say_project(kill_message::ready);
        QObject::connect(&desk, &Desk::project_changed, &desk, [&] { say_project(kill_message::made); });
        QObject::connect(&desk, &Desk::recovery_written, &desk, [&] { say_project(kill_message::kept); });
        QObject::connect(&desk, &Desk::runs_changed, &desk,
                         [&] { say(kill_message::runs, desk.runs().value().size()); });
        QObject::connect(&desk, &Desk::trouble, &desk,
                         [](const QString& text) { ADD_FAILURE() << text.toStdString(); });
        DeskPerson me(studio.window());
        ASSERT_TRUE(me.wait([&] { return desk.station().connected; }));
        while (!testing::Test::HasFailure()) act(me, desk, studio.window());
    }

  private:
    static unsigned seed() { return static_cast<unsigned>(std::atoi(std::getenv("SEAMWRIGHT_KILL_SEED"))); }
    int dice(int n) { return static_cast<int>(rng_() % static_cast<unsigned>(n)); }
    void say(char kind, std::uint64_t value = 0) const {
        const KillMessage message{kind, value};
        if (::write(pipe_, &message, sizeof message) != sizeof message) ::_exit(4);
    }
    void answer_question() {
        auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
        if (!box || box->objectName() != "restore_question" || answered_) return;
        answered_ = true;
        say(kill_message::asked);
        QTest::qWait(dice(200));
        const bool restore = dice(4) != 0;
        for (QAbstractButton* button : box->buttons())
            if ((button->objectName() == "restore") == restore) {
                if (!restore) say(kill_message::forgets);
                QTest::mouseClick(button, Qt::LeftButton);
                return;
            }
        ADD_FAILURE() << "the question has no such answer";
    }

    void act(DeskPerson& me, Desk& desk, MainWindow& window) {
        say(kill_message::begins);
        const int chosen = dice(20);
        if (chosen < 4) {
            say(kill_message::saving);
            me.shortcut(Qt::Key_S);
            ASSERT_FALSE(desk.modified());
            say(kill_message::saved, fingerprint(desk.project()));
        } else if (chosen < 6) {
            me.shortcut(Qt::Key_Z);
        } else if (chosen == 6) {
            me.shortcut(Qt::Key_Y);
        } else if (chosen == 7) {
            me.step(1);
            me.click("place_part");
        } else if (chosen == 8) {
            me.step(8);
            if (!desk.worker().busy()) {
                me.click("measure");
                ASSERT_TRUE(me.wait([&] { return desk.worker().busy(); }));
                ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
            }
        } else {
            edit_spot(me, desk, window);
        }
        say(kill_message::ended);
        // Sometimes the next one comes at once, sometimes the studio is looked at in peace.
        QTest::qWait(dice(3) == 0 ? dice(150) : 0);
    }

    void edit_spot(DeskPerson& me, Desk& desk, MainWindow& window) {
        me.step(3);
        auto* tree = me.find<QTreeWidget>("spot_tree");
        ASSERT_TRUE(tree);
        const auto& spots = desk.project().spots;
        ASSERT_FALSE(spots.empty());
        const auto items = tree->findItems(QString::fromStdString(spots[rng_() % spots.size()].id),
                                           Qt::MatchExactly | Qt::MatchRecursive);
        ASSERT_FALSE(items.isEmpty());
        tree->scrollToItem(items[0]);
        QTest::mouseClick(tree->viewport(), Qt::LeftButton, {}, tree->visualItemRect(items[0]).center());
        QApplication::processEvents();
        switch (dice(6)) {
            case 0: {
                auto* box = me.find<QCheckBox>(dice(2) ? "spot_enabled" : "spot_required");
                ASSERT_TRUE(box);
                me.look_at(box);
                box->setFocus();
                QTest::keyClick(box, Qt::Key_Space);
                break;
            }
            case 1:
                me.click(spots.size() < kMostSpots ? "duplicate_spot" : "remove_spot");
                break;
            case 2: {
                const QString name = dice(2) ? "spot_up" : "spot_down";
                if (me.find<QPushButton>(name)->isEnabled()) me.click(name);
                break;
            }
            default:
                for (auto* editor : window.findChildren<ParameterEditor*>())
                    if (editor->isVisible() && editor->info().name == "jitter_mm")
                        me.write(editor->findChild<QLineEdit*>(), QString::number(1 + dice(4000) * 1e-3));
        }
        QApplication::processEvents();
    }

    int pipe_;
    std::mt19937 rng_;
    bool answered_ = false;
};

TEST(StudioToKill, Works) {
    ASSERT_TRUE(std::getenv("SEAMWRIGHT_KILL_PIPE")) << "started by kill_test alone";
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    Worker().work();
}

}  // namespace
}  // namespace seamwright
