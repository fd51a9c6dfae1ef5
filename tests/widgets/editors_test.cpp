#include <gtest/gtest.h>

#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QContextMenuEvent>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QSignalSpy>
#include <QTableWidget>
#include <QTest>

#include "widgets/editors/leave_field.h"
#include "widgets/editors/list_habits.h"
#include "widgets/editors/name_editor.h"
#include "widgets/editors/number_box.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/plain_words.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/editors/settings_editor.h"

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
    // What is no number within the range is refused as a whole and in words: no part of it is taken.
    for (const char* text : {"x7", "1e300", "1.234,5", "90", "0.05", "-"}) {
        EXPECT_DOUBLE_EQ(type(text), 10) << text;
        EXPECT_FALSE(box.reason().isEmpty()) << text;
        EXPECT_EQ(box.text(), "10.00 mm") << text;
    }
    EXPECT_DOUBLE_EQ(type("1e1"), 10);
    EXPECT_DOUBLE_EQ(type("2e-1"), 0.2);
    EXPECT_TRUE(box.reason().isEmpty());
    type("1e300");
    EXPECT_TRUE(box.reason().contains("0.10 .. 20.00 mm")) << box.reason().toStdString();
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

// What stands beside the field may be typed into it; another unit is told, with what to give.
TEST(ParameterEditor, TakesItsUnitAndSaysWhatToGive) {
    ParameterEditor editor({"window_mm", "mm", 1, 50, 2, 2, "Half width."});
    ParameterEditor angle({"turn_deg", "deg", -90, 90, 0, 1, "Turn."});
    ParameterEditor bare({"count", "", 1, 50, 2, 0, "How many."});
    for (ParameterEditor* one : {&editor, &angle, &bare}) {
        one->show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(one));
    }
    const auto type = [](ParameterEditor& into, const char* text) {
        auto* line = into.findChild<QLineEdit*>();
        line->selectAll();
        QTest::keyClicks(line, QString::fromUtf8(text));
        QTest::keyClick(line, Qt::Key_Return);
        return into.reason().toStdString();
    };
    EXPECT_EQ(type(editor, "30 mm"), "");
    EXPECT_DOUBLE_EQ(editor.value(), 30);
    EXPECT_EQ(type(editor, "12,5mm"), "");
    EXPECT_DOUBLE_EQ(editor.value(), 12.5);
    EXPECT_EQ(type(angle, "-3,5 deg"), "");
    EXPECT_EQ(type(angle, "-4°"), "");
    EXPECT_DOUBLE_EQ(angle.value(), -4);
    EXPECT_EQ(type(editor, "0.03 m"), "\"0.03 m\" has another unit; give 1.00 to 50.00 mm");
    EXPECT_EQ(type(editor, "abc"), "\"abc\" is not a number; give 1.00 to 50.00 mm");
    EXPECT_EQ(type(editor, "1,2,3"), "\"1,2,3\" is not a number; give 1.00 to 50.00 mm");
    EXPECT_EQ(type(bare, "30 mm"), "\"30 mm\" is not a number; give 1 to 50");
    EXPECT_DOUBLE_EQ(editor.value(), 12.5) << "what was refused is nowhere";
}

// A field takes a number with its unit, a whole pose that is pasted, and nothing that is neither.
TEST(PoseEditor, WhatIsPastedIntoAFieldIsANumberOrAPose) {
    PoseEditor editor;
    editor.set_notation(PoseNotation::kuka_abc);
    editor.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&editor));
    auto* x = editor.findChildren<QLineEdit*>().at(0);
    const auto paste = [&](const char* text) {
        x->selectAll();
        QApplication::clipboard()->setText(QString::fromUtf8(text));
        QTest::keyClick(x, Qt::Key_V, Qt::ControlModifier);
        QTest::keyClick(x, Qt::Key_Return);
        return editor.reason().toStdString();
    };
    EXPECT_EQ(paste("30 mm"), "");
    EXPECT_DOUBLE_EQ(editor.pose().translation().x(), 30);
    EXPECT_EQ(paste("0.03 m"), "X: \"0.03 m\" has another unit; give it in mm");
    EXPECT_EQ(paste("abc"), "X: \"abc\" is not a number");
    EXPECT_EQ(x->text(), "abc") << "and stays there to be mended";
    QTest::keyClick(x, Qt::Key_Escape);
    EXPECT_EQ(paste("X\tY\tZ\tA\tB\tC\n1,5\t2,5\t3,5\t10,5\t20,5\t30,5"), "");
    EXPECT_DOUBLE_EQ(editor.pose().translation().z(), 3.5);
    EXPECT_NE(paste("1;2;3;0;0;0\n4;5;6;0;0;0").find("give one of them"), std::string::npos)
        << "two poses are no matrix";
    EXPECT_NE(paste("1 2 3 1e300 0 0").find("from -360 to 360"), std::string::npos);
    EXPECT_NE(paste("1e300 2 3 0 0 0").find("100 m"), std::string::npos);
    EXPECT_NE(paste("1 2 3").find("a pose of 3 numbers"), std::string::npos);
    EXPECT_DOUBLE_EQ(editor.pose().translation().x(), 1.5) << "refused, it is nowhere";
}

TEST(NameEditor, WhatIsRefusedStaysUntilItIsMendedOrTakenBack) {
    std::string taken;
    NameEditor editor("Name", "tip", [&](const std::string& name) -> Expected<void> {
        if (name == "b") return input_error("it is another's", Text("name {}", name), "choose another");
        taken = name;
        return {};
    });
    editor.refresh("a", "one");
    editor.show();
    QApplication::setActiveWindow(&editor);
    QLineEdit& line = editor.line();
    const auto type = [&](const QString& text) {
        line.setFocus();
        line.selectAll();
        QTest::keyClicks(&line, text);
    };
    const auto said = [&] { return editor.findChild<QLabel*>()->text(); };
    type("b");
    EXPECT_FALSE(leave_field(editor)) << "without a Return";
    EXPECT_TRUE(editor.refused());
    EXPECT_EQ(said(), "refused: name b: it is another's; choose another");
    EXPECT_TRUE(line.hasFocus()) << "where it is mended";
    EXPECT_EQ(taken, "");
    editor.refresh("a", "one");
    EXPECT_EQ(line.text(), "b");
    type(" c ");
    EXPECT_TRUE(leave_field(editor));
    EXPECT_FALSE(editor.refused());
    EXPECT_EQ(taken, "c");
    EXPECT_EQ(line.text(), "c");
    type("b");
    QTest::keyClick(&line, Qt::Key_Return);
    ASSERT_TRUE(editor.refused());
    QTest::keyClick(&line, Qt::Key_Escape);
    EXPECT_FALSE(editor.refused());
    EXPECT_EQ(line.text(), "c");
    type("b");
    QTest::keyClick(&line, Qt::Key_Return);
    editor.refresh("d", "another one");
    EXPECT_FALSE(editor.refused());
    EXPECT_EQ(line.text(), "d");
}

TEST(PlainWords, NoNameIsMarkup) {
    PlainWords words;
    qApp->installEventFilter(&words);
    const QString name = "<b>x</b> & <img src='y.png'>";
    QLabel plain(name), rich("<b>bold</b>");
    rich.setTextFormat(Qt::RichText);
    for (QLabel* label : {&plain, &rich}) label->show();
    EXPECT_EQ(plain.textFormat(), Qt::PlainText);
    EXPECT_EQ(plain.text(), name);
    EXPECT_GE(plain.sizeHint().width(), plain.fontMetrics().horizontalAdvance(name)) << "all its signs";
    EXPECT_EQ(rich.textFormat(), Qt::RichText);
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
    // A thousandth of what is meant is worse than a refusal.
    for (const char* other : {"1.2 m, 0.3 m, 0.5 m, 0, 0, 0", "X 1.2m Y 0.3m Z 0.5m A 0 B 0 C 0",
                              "120 cm 30 cm 50 cm 0 0 0", "1200 300 500 1.57 rad 0 rad 0 rad"})
        EXPECT_FALSE(pose_from_text(other, PoseNotation::kuka_abc)) << other;
    const auto with_units =
        pose_from_text("X: 1200 mm Y: 300 mm Z: 500 mm A: 10 deg B: 0 deg C: 0 deg", PoseNotation::kuka_abc);
    ASSERT_TRUE(with_units) << with_units.error().sentence();
    EXPECT_DOUBLE_EQ(with_units->translation().x(), 1200);
    EXPECT_TRUE(pose_from_text("1200 mm 300 mm 500 mm 0 rad 1.57 rad 0 rad", PoseNotation::ur_rotvec));
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

SettingTable example_settings() {
    using namespace entry;
    return {text("address", "127.0.0.1", "the controller's"),
            whole("port", 54600, 1, 65535, "of the robot"),
            choice("mode", {"absolute", "relative"}, "of the correction"),
            yes_no("trigger", false, "by hardware"),
            formerly("retry_ms", whole("reconnect_ms", 100, 1, 1000, "back-off")),
            object("ramp", {number("speed_mm_s", 20, 1e-3, 1000, "of the ramp")}, "how a correction comes"),
            list("range", nullptr, "of columns"),
            pose("tool", "that it tells")};
}

class SettingsForm : public testing::Test {
  protected:
    void SetUp() override {
        editor.set_table(example_settings());
        editor.show_all(true);
        editor.show();
        ASSERT_TRUE(QTest::qWaitForWindowExposed(&editor));
    }
    QLineEdit* line(const char* name) { return editor.findChild<QLineEdit*>(name); }
    void type(const char* name, const char* text) {
        line(name)->setFocus();
        line(name)->selectAll();
        if (*text == 0) QTest::keyClick(line(name), Qt::Key_Delete);
        QTest::keyClicks(line(name), text);
        QTest::keyClick(line(name), Qt::Key_Return);
    }
    SettingsEditor editor;
    QSignalSpy edited{&editor, &SettingsEditor::edited};
};

TEST_F(SettingsForm, WritesWhatIsTypedAndNothingElse) {
    editor.set_value({{"port", 54601}, {"retry_ms", 250}, {"strange", {1, 2}}});
    EXPECT_EQ(edited.size(), 0);
    EXPECT_EQ(line("setting_port")->text(), "54601");
    EXPECT_EQ(line("setting_reconnect_ms")->text(), "250") << "by its former name";
    EXPECT_EQ(line("setting_address")->text(), "");
    EXPECT_EQ(line("setting_address")->placeholderText(), "127.0.0.1");
    type("setting_port", "4711");
    type("setting_ramp_speed_mm_s", "12,5");
    type("setting_address", "10.0.0.7");
    type("setting_range", "[3, 4]");
    auto* mode = editor.findChild<QComboBox*>("setting_mode");
    mode->setCurrentIndex(1);
    emit mode->activated(1);
    QTest::mouseClick(editor.findChild<QCheckBox*>("setting_trigger"), Qt::LeftButton, {}, {10, 10});
    EXPECT_EQ(editor.value(), nlohmann::json::parse(R"({"port": 4711, "reconnect_ms": 250, "strange": [1, 2],
        "ramp": {"speed_mm_s": 12.5}, "address": "10.0.0.7", "range": [3, 4], "mode": "relative", "trigger": true})"));
    EXPECT_EQ(edited.size(), 6);
    // An empty field is a setting that is left out; an object that held nothing else goes with it.
    type("setting_ramp_speed_mm_s", "");
    type("setting_port", "");
    EXPECT_FALSE(editor.value().contains("ramp"));
    EXPECT_FALSE(editor.value().contains("port"));
    EXPECT_FALSE(editor.refused());
}

TEST_F(SettingsForm, RefusesAndKeepsTheLastGoodOne) {
    editor.set_value({{"port", 5000}});
    for (const char* bad : {"0", "65536", "1.5", "x", "nan", "1e999"}) {
        type("setting_port", bad);
        EXPECT_TRUE(editor.refused()) << bad;
        EXPECT_EQ(editor.value().at("port"), 5000) << bad;
        EXPECT_EQ(line("setting_port")->text(), bad);
    }
    type("setting_port", "6000");
    EXPECT_FALSE(editor.refused());
    for (const char* bad : {"{", "{}", "3", "[1,"}) {
        type("setting_range", bad);
        EXPECT_TRUE(editor.refused()) << bad;
        EXPECT_FALSE(editor.value().contains("range")) << bad;
    }
    editor.set_value({{"port", 7000}});
    EXPECT_FALSE(editor.refused());
}

TEST_F(SettingsForm, EscapeBringsBackWhatIsWritten) {
    editor.set_value({{"port", 5000}});
    type("setting_port", "x");
    ASSERT_TRUE(editor.refused());
    QTest::keyClick(line("setting_port"), Qt::Key_Escape);
    EXPECT_FALSE(editor.refused());
    EXPECT_EQ(line("setting_port")->text(), "5000");
    EXPECT_EQ(editor.value(), nlohmann::json({{"port", 5000}}));
}

TEST_F(SettingsForm, ShowsWhatCounts) {
    editor.show_all(false);
    EXPECT_TRUE(line("setting_port")->isVisible());
    EXPECT_FALSE(line("setting_ramp_speed_mm_s")->isVisible());
    editor.set_value({{"ramp", {{"speed_mm_s", 3}}}});
    EXPECT_TRUE(line("setting_ramp_speed_mm_s")->isVisible());
    // Whatever a file holds: nothing is thrown, nothing is lost.
    for (const char* odd :
         {"[]", "null", "3", R"({"ramp": 3, "port": "x", "tool": [], "mode": 7, "trigger": {}})"}) {
        const auto json = nlohmann::json::parse(odd);
        editor.set_value(json);
        if (json.is_object()) {
            EXPECT_EQ(editor.value(), json);
        }
    }
}

struct HabitsOfATable : testing::Test {
    ListHabits habits;
    QTableWidget table{3, 3};
    QPushButton rename{"Rename"}, remove{"Remove"};
    HabitsOfATable() {
        qApp->installEventFilter(&habits);
        for (int row = 0; row < 3; ++row)
            for (int c = 0; c < 3; ++c)
                table.setItem(row, c, new QTableWidgetItem(QString("%1%2").arg("abc"[row]).arg(c)));
        table.setSelectionBehavior(QAbstractItemView::SelectRows);
        table.setEditTriggers(QAbstractItemView::NoEditTriggers);
        table.show();
        QApplication::setActiveWindow(&table);
        table.setFocus();
    }
};

TEST_F(HabitsOfATable, CopyTakesTheChosenRowsInTheOrderOfTheScreen) {
    EXPECT_TRUE(chosen_rows(table).isEmpty());
    table.item(1, 1)->setText("two\nlines\tand a tab");
    table.setColumnHidden(2, true);
    table.selectionModel()->select(table.model()->index(2, 0),
                                   QItemSelectionModel::Select | QItemSelectionModel::Rows);
    table.selectionModel()->select(table.model()->index(1, 0),
                                   QItemSelectionModel::Select | QItemSelectionModel::Rows);
    QApplication::clipboard()->setText("before");
    QTest::keyClick(&table, Qt::Key_C, Qt::ControlModifier);
    EXPECT_EQ(QApplication::clipboard()->text(), "b0\ttwo lines and a tab\nc0\tc1");
    table.clearSelection();
    QTest::keyClick(&table, Qt::Key_C, Qt::ControlModifier);
    EXPECT_EQ(QApplication::clipboard()->text(), "b0\ttwo lines and a tab\nc0\tc1")
        << "nothing chosen, nothing lost";
}

TEST_F(HabitsOfATable, KeysAndMenuDoWhatTheButtonsDo) {
    bool applies = true;
    add_list_deed(table, rename, Qt::Key_F2, [&] { return applies; });
    add_list_deed(table, remove, QKeySequence::Delete);
    QSignalSpy renamed(&rename, &QPushButton::clicked), removed(&remove, &QPushButton::clicked);
    QTest::keyClick(&table, Qt::Key_F2);
    QTest::keyClick(&table, Qt::Key_Delete);
    EXPECT_EQ(renamed.size(), 1);
    EXPECT_EQ(removed.size(), 1);
    remove.setEnabled(false);
    applies = false;
    QTest::keyClick(&table, Qt::Key_F2);
    QTest::keyClick(&table, Qt::Key_Delete);
    EXPECT_EQ(renamed.size(), 1) << "the deed does not apply";
    EXPECT_EQ(removed.size(), 1) << "its button cannot be pressed";
    QContextMenuEvent asked(QContextMenuEvent::Mouse, {20, 20},
                            table.viewport()->mapToGlobal(QPoint(20, 20)));
    QApplication::sendEvent(table.viewport(), &asked);
    auto* menu = table.findChild<QMenu*>("list_menu");
    ASSERT_TRUE(menu);
    QStringList shown;
    for (const QAction* a : menu->actions()) shown << a->text();
    EXPECT_EQ(shown, (QStringList{"Rename", "Remove", "Copy rows"}));
    menu->close();
}

}  // namespace
}  // namespace seamwright
