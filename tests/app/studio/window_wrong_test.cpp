// The steps' pages with what people get wrong: every field with what is no number of its own, by keys, in both languages.

#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <fstream>

#include "projects/reuse/exchange.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/editors/number_box.h"

namespace seamwright {
namespace {

class WrongAtTheWindow : public Furniture {
  protected:
    Desk& desk() { return studio->desk(); }
    template <class T>
    QList<T*> seen() {
        QList<T*> all;
        for (T* one : window().findChildren<T*>())
            if (one->isVisible() && one->isEnabled()) all << one;
        return all;
    }
    std::string stored() { return export_project(desk().project(), true).dump(); }
    void show_step(const DeskPerson& me, int step) {
        me.step(step);
        const Project& p = desk().project();
        desk().selection().select_spot(p.spots.front().id);
        desk().selection().select_region(p.regions.front().id);
        QTest::qWait(100);
    }
};

constexpr const char* kWrong[] = {" ",      "abc",    "NaN",   "inf", "1e300", "-1e300",
                                  "0.03 m", "30 qux", "1,2,3", "1;2", "0x10"};

// A number that is refused says so with what to give, changes nothing, stays in its field, and Esc brings the good one back.
TEST_F(WrongAtTheWindow, EveryNumberOfEveryStep) {
    for (const char* language : {"en", "de"}) {
        SCOPED_TRACE(language);
        start(false, language);
        DeskPerson me(window());
        std::ofstream walk(std::filesystem::path(SEAMWRIGHT_SCREENS) /
                           (std::string("wrong_window_") + language + ".txt"));
        int fields = 0;
        for (int step = 1; step <= 8; ++step) {
            show_step(me, step);
            const qsizetype count = seen<ParameterEditor>().size();
            for (qsizetype i = 0; i < count; ++i) {
                const auto editor = [&] { return seen<ParameterEditor>().value(i); };
                if (!editor() || !editor()->findChild<QLineEdit*>()) continue;
                ++fields;
                const std::string name = editor()->info().name;
                SCOPED_TRACE(name);
                const std::string before = stored();
                for (const char* wrong : kWrong) {
                    auto* line = editor()->findChild<QLineEdit*>();
                    me.write(line, wrong);
                    ASSERT_TRUE(editor()) << wrong;
                    walk << step << " " << name << " \"" << wrong
                         << "\": " << editor()->reason().toStdString() << "\n";
                    EXPECT_TRUE(editor()->refused()) << wrong;
                    EXPECT_EQ(editor()->findChild<QLineEdit*>()->text(), wrong);
                    EXPECT_EQ(stored(), before) << wrong;
                }
                if (i == 0) me.picture(QString("wrong_step_%1_%2").arg(step).arg(language));
                auto* line = editor()->findChild<QLineEdit*>();
                line->setFocus();
                QTest::keyClick(line, Qt::Key_Escape);
                EXPECT_FALSE(editor()->refused());
                EXPECT_EQ(stored(), before);
            }
            for (QDoubleSpinBox* spin : seen<QDoubleSpinBox>()) {
                auto* box = dynamic_cast<NumberBox*>(spin);
                if (!box) continue;
                ++fields;
                const double before = box->value();
                for (const char* wrong : kWrong) {
                    me.look_at(box);
                    box->setFocus();
                    box->selectAll();
                    QTest::keyClick(box, Qt::Key_Delete);
                    QTest::keyClicks(box, wrong);
                    QTest::keyClick(box, Qt::Key_Return);
                    walk << step << " " << box->objectName().toStdString() << " \"" << wrong
                         << "\": " << box->reason().toStdString() << "\n";
                    EXPECT_FALSE(box->reason().isEmpty()) << box->objectName().toStdString() << " " << wrong;
                    EXPECT_EQ(box->value(), before);
                }
            }
        }
        EXPECT_GT(fields, 20);
    }
}

// The same of poses, typed and pasted.
TEST_F(WrongAtTheWindow, EveryPoseOfEveryStep) {
    const std::pair<const char*, const char*> pasted[] = {
        {"two rows", "1;2;3;0;0;0\n4;5;6;0;0;0"},
        {"three numbers", "1 2 3"},
        {"no rotation", "1 0 0 0  0 2 0 0  0 0 1 0  0 0 0 1"},
        {"mirrored", "1 0 0 0  0 1 0 0  0 0 -1 0  0 0 0 1"},
        {"transposed", "1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1"},
        {"far", "1e300 0 0 0 0 0"},
        {"angle", "0 0 0 1e300 0 0"},
        {"metres", "1.2 m 0.3 m 0.5 m 0 0 0"},
        {"words", "abc"},
        {"not a number", "NaN 0 0 0 0 0"},
        {"header", "X;Y;Z;A;B;C\n1,5;2,5;3,5"}};
    for (const char* language : {"en", "de"}) {
        SCOPED_TRACE(language);
        start(false, language);
        DeskPerson me(window());
        std::ofstream walk(std::filesystem::path(SEAMWRIGHT_SCREENS) /
                           (std::string("wrong_poses_") + language + ".txt"));
        int poses = 0;
        for (int step = 1; step <= 8; ++step) {
            show_step(me, step);
            const qsizetype count = seen<PoseEditor>().size();
            for (qsizetype i = 0; i < count; ++i) {
                const auto editor = [&] { return seen<PoseEditor>().value(i); };
                const auto line = [&] {
                    for (QLineEdit* one : editor()->findChildren<QLineEdit*>())
                        if (one->isVisible()) return one;
                    return static_cast<QLineEdit*>(nullptr);
                };
                if (!editor() || !line()) continue;
                ++poses;
                SCOPED_TRACE(editor()->objectName().toStdString());
                const std::string before = stored();
                for (const auto& [what, text] : pasted) {
                    me.look_at(line());
                    line()->setFocus();
                    line()->selectAll();
                    QApplication::clipboard()->setText(text);
                    QTest::keyClick(line(), Qt::Key_V, Qt::ControlModifier);
                    QTest::keyClick(line(), Qt::Key_Return);
                    walk << step << " " << editor()->objectName().toStdString() << " " << what << ": "
                         << editor()->reason().toStdString() << "\n";
                    EXPECT_TRUE(editor()->refused()) << what;
                    EXPECT_EQ(stored(), before) << what;
                    QTest::keyClick(line(), Qt::Key_Escape);
                    EXPECT_FALSE(editor()->refused()) << what;
                }
            }
        }
        EXPECT_GT(poses, 2);
    }
}

// The robot does not go by a number that is not the one that stands in the field, on whatever step that is.
TEST_F(WrongAtTheWindow, WhatIsRefusedSomewhereHoldsTheRobot) {
    start(true);
    ASSERT_TRUE(DeskPerson::wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    DeskPerson me(window());
    show_step(me, 5);
    ParameterEditor* limit = nullptr;
    for (ParameterEditor* one : seen<ParameterEditor>())
        if (!limit && one->findChild<QLineEdit*>()) limit = one;
    ASSERT_TRUE(limit);
    me.write(limit->findChild<QLineEdit*>(), "abc");
    ASSERT_TRUE(limit->refused());
    const std::pair<int, const char*> deeds[] = {
        {3, "measure_reference"}, {3, "go_there"}, {4, "start_pass"},  {6, "start_zero"},
        {6, "start_known"},       {8, "measure"},  {8, "measure_push"}};
    for (const auto& [step, deed] : deeds) {
        SCOPED_TRACE(deed);
        me.step(step);
        QTest::qWait(50);
        me.click(deed);
        EXPECT_FALSE(desk().worker().busy());
        EXPECT_EQ(window().step(), Step::regions) << "where it is mended";
        EXPECT_TRUE(me.find<QLabel>("trouble_text")->text().contains("refused"));
        EXPECT_TRUE(me.wait([&] { return !limit->visibleRegion().isEmpty(); }));
    }
    me.picture("wrong_holds");
    QTest::keyClick(limit->findChild<QLineEdit*>(), Qt::Key_Escape);
    me.step(8);
    me.click("measure");
    EXPECT_TRUE(me.wait([&] { return desk().runs()->size() == 1; }));
}

// What the steps look like on the small and on the large screen.
TEST_F(WrongAtTheWindow, EveryStepIsPictured) {
    for (const char* language : {"en", "de"}) {
        start(true, language);
        ASSERT_TRUE(DeskPerson::wait([&] { return desk().station().connected && !desk().worker().busy(); }));
        DeskPerson me(window());
        for (const QSize size : {QSize(1280, 800), QSize(1920, 1080)}) {
            window().resize(size);
            for (int step = 1; step <= 8; ++step) {
                show_step(me, step);
                me.picture(QString("walk_%1_%2_%3").arg(step).arg(language).arg(size.width()));
            }
        }
    }
}

}  // namespace
}  // namespace seamwright
