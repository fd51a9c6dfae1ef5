#pragma once
// A person at the real window: mouse and keyboard alone.

#include <gtest/gtest.h>

#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMouseEvent>
#include <QPushButton>
#include <QScrollArea>
#include <QTableWidget>
#include <QTest>
#include <QTimer>
#include <filesystem>
#include <functional>

#include "app/studio/main_window.h"
#include "tests/app/studio/freeze_watch.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"

namespace seamwright {

inline constexpr int kPatienceMs = 20000;

// Hands and eyes: finds controls by the names they have on the screen's tree, waits as a person waits.
class DeskPerson {
  public:
    explicit DeskPerson(MainWindow& window, FreezeWatch* watch = nullptr) : window_(window), watch_(watch) {}
    MainWindow& window() const { return window_; }
    // Of every picture: what it finds is a failure.
    void examines(std::function<QStringList()> faults) { faults_ = std::move(faults); }
    // Of the mouse, as a hand without a keyboard would make them: a choice in a list is two, what is written is one.
    int clicks() const { return clicks_; }
    void clicked_too(int clicks = 1) const { clicks_ += clicks; }  // beside these functions

    template <class T>
    T* find(const QString& name) const {
        for (T* w : window_.findChildren<T*>(name))
            if (w->isVisible()) return w;
        ADD_FAILURE() << "there is no visible " << name.toStdString();
        return nullptr;
    }
    void look_at(QWidget* w) const {
        for (QWidget* up = w->parentWidget(); up; up = up->parentWidget())
            if (auto* area = qobject_cast<QScrollArea*>(up)) area->ensureWidgetVisible(w);
        QApplication::processEvents();
    }
    void click(const QString& name) const {
        auto* button = find<QAbstractButton>(name);
        if (!button) return;
        EXPECT_TRUE(wait([&] { return button->isEnabled(); })) << name.toStdString() << " cannot be pressed";
        look_at(button);
        ++clicks_;
        note(name);
        QTest::mouseClick(button, Qt::LeftButton);
        QApplication::processEvents();
    }
    void choose(const QString& name, const QString& text) const {
        auto* box = find<QComboBox>(name);
        if (!box) return;
        look_at(box);
        note(name);
        box->setFocus();
        const int wanted = box->findText(text);
        ASSERT_GE(wanted, 0) << text.toStdString();
        if (box->currentIndex() != wanted) clicks_ += 2;
        while (box->currentIndex() < wanted) QTest::keyClick(box, Qt::Key_Down);
        while (box->currentIndex() > wanted) QTest::keyClick(box, Qt::Key_Up);
        QApplication::processEvents();
    }
    void write(QLineEdit* line, const QString& text) const {
        look_at(line);
        ++clicks_;
        line->setFocus();
        line->selectAll();
        QTest::keyClicks(line, text);
        QTest::keyClick(line, Qt::Key_Return);
        QApplication::processEvents();
    }
    // Into the visible editor of a described setting.
    void write_parameter(const std::string& name, const QString& text) const {
        for (auto* editor : window_.findChildren<ParameterEditor*>())
            if (editor->isVisible() && editor->info().name == name)
                return write(editor->findChild<QLineEdit*>(), text);
        ADD_FAILURE() << "there is no visible setting " << name;
    }
    void write_pose(const QString& name, const Pose& pose) const {
        auto* editor = find<PoseEditor>(name);
        if (!editor) return;
        QLineEdit* first = nullptr;
        for (QLineEdit* line : editor->findChildren<QLineEdit*>())
            if (!first && line->isVisible() && !line->isReadOnly()) first = line;
        ASSERT_TRUE(first);
        look_at(first);
        ++clicks_;
        first->setFocus();
        first->selectAll();
        QApplication::clipboard()->setText(text_from_pose(pose, editor->notation()));
        QTest::keyClick(first, Qt::Key_V, Qt::ControlModifier);
        QTest::keyClick(first, Qt::Key_Return);
        QApplication::processEvents();
        EXPECT_FALSE(editor->refused()) << editor->reason().toStdString();
    }
    // Pastes into the file dialog that the next action opens, as soon as it is there, and again when the list
    // of completions has taken the Return for itself.
    void answer_file_dialog(const QString& path) const {
        auto* timer = new QTimer(&window_);
        QObject::connect(timer, &QTimer::timeout, timer, [timer, path, patience = 60]() mutable {
            auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
            if (!dialog) {
                if (--patience > 0) return;
                ADD_FAILURE() << "no file dialog opened";
                timer->deleteLater();
                return;
            }
            timer->stop();
            auto* line = dialog->findChild<QLineEdit*>("fileNameEdit");
            line->setFocus();
            line->selectAll();
            QApplication::clipboard()->setText(path);
            QTest::keyClick(line, Qt::Key_V, Qt::ControlModifier);
            QTest::keyClick(line, Qt::Key_Return);
            if (dialog->isVisible())
                timer->start();
            else
                timer->deleteLater();
        });
        timer->start(300);
    }
    static void drag(QWidget* on, QPoint from, QPoint to) {
        QTest::mousePress(on, Qt::LeftButton, {}, from);
        for (const QPoint at : {(from + to) / 2, to}) {  // as delivered while a button is held
            QMouseEvent move(QEvent::MouseMove, at, on->mapToGlobal(at), Qt::NoButton, Qt::LeftButton, {});
            QApplication::sendEvent(on, &move);
        }
        QTest::mouseRelease(on, Qt::LeftButton, {}, to);
        QApplication::processEvents();
    }
    void step(int n) const {
        note(QString("step %1").arg(n));
        const auto rails = window_.findChildren<QPushButton*>("rail");
        ASSERT_EQ(rails.size(), static_cast<qsizetype>(kSteps.size()));
        ++clicks_;
        QTest::mouseClick(rails[n - 1], Qt::LeftButton);
        QApplication::processEvents();
    }
    void shortcut(Qt::Key key) const {
        QApplication::setActiveWindow(
            &window_);  // a dialog was; nobody gives it back without a window manager
        QTest::keyClick(&window_, key, Qt::ControlModifier);
        QApplication::processEvents();
    }
    static bool wait(const std::function<bool()>& ready) { return QTest::qWaitFor(ready, kPatienceMs); }
    void picture(const QString& name) const {
        QTest::qWait(150);
        const FreezeWatch::Pause pause(watch_);
        QApplication::sendPostedEvents(nullptr, QEvent::LayoutRequest);  // of a text that has just changed
        std::filesystem::create_directories(SEAMWRIGHT_SCREENS);
        EXPECT_TRUE(window_.grab().save(QString(SEAMWRIGHT_SCREENS) + "/way_" + name + ".png"));
        for (const QString& fault : faults_ ? faults_() : QStringList())
            ADD_FAILURE() << name.toStdString() << ": " << fault.toStdString();
    }
    QString text_of(const QString& name) const {
        auto* label = find<QLabel>(name);
        return label ? label->text() : QString();
    }
    QStringList table(const QString& name) const {
        QStringList cells;
        if (auto* t = find<QTableWidget>(name))
            for (int r = 0; r < t->rowCount(); ++r)
                for (int c = 0; c < t->columnCount(); ++c)
                    cells << (t->item(r, c) ? t->item(r, c)->text() : QString());
        return cells;
    }

  private:
    // Before a deed: nothing asks for an answer but the dialogs that are waited for.
    void note(const QString& deed) const {
        if (const QWidget* modal = QApplication::activeModalWidget(); modal && modal != &window_)
            ADD_FAILURE() << "before " << deed.toStdString() << ", nobody asked for \""
                          << modal->windowTitle().toStdString() << "\"";
        if (watch_) watch_->during(deed);
    }

    MainWindow& window_;
    FreezeWatch* watch_;
    std::function<QStringList()> faults_;
    mutable int clicks_ = 0;
};

}  // namespace seamwright
