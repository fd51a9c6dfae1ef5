#include <gtest/gtest.h>

#include <QLineEdit>
#include <QSignalSpy>
#include <QTest>

#include "widgets/editors/number_box.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"

namespace seamwright {
namespace {

TEST(NumberText, PointAndCommaWhateverTheLanguage) {
    EXPECT_DOUBLE_EQ(*number_from_text(" 1.5 "), 1.5);
    EXPECT_DOUBLE_EQ(*number_from_text("-1,5"), -1.5);
    EXPECT_DOUBLE_EQ(*number_from_text("2e-3"), 0.002);
    for (const char* bad : {"", "1.000,5", "nan", "inf", "1 2", "0x10", "--1", "1.2.3"})
        EXPECT_FALSE(number_from_text(bad)) << bad;
    EXPECT_EQ(text_from_number(-0.0001, 2), "0.00");
    EXPECT_EQ(text_from_number(12345.678, 2), "12345.68");
}

TEST(NumberBox, TakesPointAndCommaAndShowsThePoint) {
    QLocale::setDefault(QLocale(QLocale::German));
    NumberBox box;
    box.setRange(0.1, 20);
    box.setDecimals(2);
    box.setSuffix(" mm");
    box.setValue(1.5);
    EXPECT_EQ(box.text(), "1.50 mm");
    auto* line = box.findChild<QLineEdit*>();
    const auto type = [&](const char* text) {
        line->selectAll();
        QTest::keyClicks(line, text);
        QTest::keyClick(line, Qt::Key_Return);
        return box.value();
    };
    EXPECT_DOUBLE_EQ(type("2,5"), 2.5);
    EXPECT_EQ(box.text(), "2.50 mm");
    EXPECT_DOUBLE_EQ(type("3.25"), 3.25);
    EXPECT_DOUBLE_EQ(type("10"), 10);
    EXPECT_DOUBLE_EQ(type("x7"), 7) << "letters do not get in";
    type("90");
    EXPECT_LE(box.value(), 20);
    box.stepDown();
    EXPECT_GE(box.value(), 0.1);
    QLocale::setDefault(QLocale::c());
}

TEST(ParameterEditor, CommitsRefusesAndGoesBack) {
    ParameterEditor editor({"window_mm", "mm", 0, 10, 2, 2, "Half width."});
    editor.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&editor));
    auto* line = editor.findChild<QLineEdit*>();
    QSignalSpy committed(&editor, &ParameterEditor::committed);
    line->selectAll();
    QTest::keyClicks(line, "3,25");
    QTest::keyClick(line, Qt::Key_Return);
    ASSERT_EQ(committed.size(), 1);
    EXPECT_DOUBLE_EQ(committed[0][0].toDouble(), 3.25);
    line->selectAll();
    QTest::keyClicks(line, "11");
    QTest::keyClick(line, Qt::Key_Return);
    EXPECT_TRUE(editor.refused());
    EXPECT_TRUE(editor.reason().contains("10.00"));
    EXPECT_DOUBLE_EQ(editor.value(), 3.25);
    EXPECT_EQ(committed.size(), 1);
    QTest::keyClick(line, Qt::Key_Escape);
    EXPECT_FALSE(editor.refused());
    EXPECT_EQ(line->text(), "3.25");
    // Untouched, a value keeps more digits than are shown.
    editor.set_value(1.23456);
    QTest::keyClick(line, Qt::Key_Return);
    EXPECT_DOUBLE_EQ(editor.value(), 1.23456);
}

TEST(PoseText, EveryNotationComesBack) {
    const Pose pose = make_pose(rotation_from_kuka({30, -20, 110}), {12.5, -300, 7});
    for (const auto notation : {PoseNotation::kuka_abc, PoseNotation::fanuc_wpr, PoseNotation::abb_quaternion,
                                PoseNotation::ur_rotvec, PoseNotation::matrix}) {
        const auto back = pose_from_text(text_from_pose(pose, notation), notation);
        ASSERT_TRUE(back) << notation_name(notation).toStdString();
        EXPECT_LT(distance_mm(*back, pose), 1e-3);
        EXPECT_LT(angle_rad(*back, pose), 1e-6);
    }
    const auto pasted = pose_from_text("{X 12.5,Y -300,Z 7,A 30,B -20,C 110}", PoseNotation::kuka_abc);
    ASSERT_TRUE(pasted);
    EXPECT_LT(angle_rad(*pasted, pose), 1e-12);
    EXPECT_FALSE(pose_from_text("1 2 3", PoseNotation::kuka_abc));
    EXPECT_FALSE(pose_from_text("1 0 0 0  0 2 0 0  0 0 1 0  0 0 0 1", PoseNotation::matrix));
}

TEST(PoseEditor, TypedNumbersCommitOnce) {
    PoseEditor editor;
    editor.set_notation(PoseNotation::abb_quaternion);
    editor.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&editor));
    QSignalSpy committed(&editor, &PoseEditor::committed);
    auto* x = editor.findChildren<QLineEdit*>().at(0);
    x->selectAll();
    QTest::keyClicks(x, "42,5");
    QTest::keyClick(x, Qt::Key_Return);
    EXPECT_EQ(committed.size(), 1);
    EXPECT_DOUBLE_EQ(editor.pose().translation().x(), 42.5);
    // Half a turn about X, number by number: not refused on the way.
    editor.activateWindow();
    ASSERT_TRUE(QTest::qWaitForWindowActive(&editor));
    const auto lines = editor.findChildren<QLineEdit*>();
    lines[3]->setFocus();
    lines[3]->selectAll();
    QTest::keyClicks(lines[3], "0");
    lines[4]->setFocus();
    EXPECT_FALSE(editor.refused());
    lines[4]->selectAll();
    QTest::keyClicks(lines[4], "1");
    QTest::keyClick(lines[4], Qt::Key_Return);
    EXPECT_FALSE(editor.refused()) << editor.reason().toStdString();
    EXPECT_NEAR(editor.pose().linear()(1, 1), -1, 1e-12);
}

}  // namespace
}  // namespace seamwright
