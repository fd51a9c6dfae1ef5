// The acceptance on its page, by mouse and keyboard: from the tolerance to the signed report's file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <QHeaderView>
#include <QLineEdit>
#include <QRegularExpression>
#include <QSpinBox>
#include <QTextBlock>
#include <QTextDocument>
#include <QUndoStack>
#include <fstream>
#include <set>

#include "app/studio/studio.h"
#include "tests/app/studio/person.h"
#include "widgets/desk/acceptance_desk.h"

namespace seamwright {
namespace {

class AcceptWay : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_accept_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;

    void SetUp() override {
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
    }
    ~AcceptWay() override {
        studio.reset();
        std::filesystem::remove_all(folder);
    }
    DeskPerson begin(const QString& language, QSize size = {1280, 800}) {
        StudioOptions o;
        o.language = language;
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString(folder.string());
        studio = std::make_unique<Studio>(*qobject_cast<QApplication*>(QApplication::instance()), o);
        studio->window().resize(size);
        studio->window().show();
        DeskPerson me(studio->window());
        EXPECT_TRUE(DeskPerson::wait([&] { return desk().station().connected && !desk().worker().busy(); }));
        me.step(7);
        return me;
    }
    Desk& desk() { return studio->desk(); }
    static void choose(const DeskPerson& me, int row) {
        auto* list = me.find<QTableWidget>("studies");
        ASSERT_TRUE(list);
        me.look_at(list);
        QTest::mouseClick(list->viewport(), Qt::LeftButton, {},
                          list->visualItemRect(list->item(row, 0)).center());
        QApplication::processEvents();
    }
    static QString state(const DeskPerson& me, int row) {
        auto* list = me.find<QTableWidget>("studies");
        return list && list->item(row, 1) ? list->item(row, 1)->text() : QString();
    }
    static void type(const DeskPerson& me, const QString& spin, int value) {
        if (auto* box = me.find<QSpinBox>(spin))
            me.write(box->findChild<QLineEdit*>(), QString::number(value));
    }
    bool idle() {  // a study is a row of runs
        return QTest::qWaitFor([&] { return !desk().worker().busy(); }, 6 * kPatienceMs);
    }
};

constexpr int kRobot = 0, kTrigger = 1, kType1 = 3, kType3 = 4;

TEST_F(AcceptWay, FromTheToleranceToTheReport) {
    const DeskPerson me = begin("en");
    QStringList troubles;
    QObject::connect(&desk(), &Desk::trouble, &desk(), [&](const QString& why) { troubles << why; });
    EXPECT_EQ(me.text_of("accept_tolerance"), "The tolerance is not stated yet");
    EXPECT_TRUE(me.wait([&] { return me.find<QPushButton>("accept_next")->isEnabled(); }));
    EXPECT_EQ(me.find<QPushButton>("accept_next")->text(), "Next: state the tolerance");
    me.picture("accept_begin");

    // The requirements are edits of the document.
    me.write_parameter("tolerance_mm", "2");
    EXPECT_EQ(desk().project().requirements.acceptance.tolerance_mm, 2);
    desk().undo_stack().undo();
    EXPECT_EQ(desk().project().requirements.acceptance.tolerance_mm, 0);
    desk().undo_stack().redo();
    me.choose("cg_variant", "Cg = 0.15 T / (4 s)");
    EXPECT_EQ(desk().project().requirements.acceptance.cg_share, 0.15);
    EXPECT_EQ(desk().project().requirements.acceptance.cg_width, 4);
    me.write_parameter("grr_accepted_percent", "40");
    EXPECT_EQ(desk().project().requirements.acceptance.grr_accepted_percent, 10);
    ASSERT_EQ(troubles.size(), 1) << "more accepted than refused is refused";
    EXPECT_TRUE(troubles[0].contains("accept less than what is refused")) << troubles[0].toStdString();
    EXPECT_TRUE(me.wait([&] {
        return me.find<QPushButton>("accept_next")->text() == "Next: Type 1, capability, measure 50 runs";
    })) << me.find<QPushButton>("accept_next")->text().toStdString();

    // Type 1: stopped in the middle, and gone on with.
    choose(me, kType1);
    EXPECT_TRUE(me.text_of("study_needs").startsWith("One part that nobody touches"));
    type(me, "study_runs", 25);
    int measured = 0;
    QObject::connect(&desk().worker(), &StationWorker::measured, &desk(), [&](const auto&) {
        if (++measured == 3) me.click("cancel");
    });
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return measured >= 3; }));
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return state(me, kType1).endsWith("of 25 runs"); }))
        << state(me, kType1).toStdString();
    const int before = static_cast<int>(desk().runs()->size());
    EXPECT_TRUE(me.wait([&] {
        return me.find<QPushButton>("accept_next")->text().contains("go on with run");
    })) << me.find<QPushButton>("accept_next")->text().toStdString();
    me.click("accept_next");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return state(me, kType1) == "done"; })) << state(me, kType1).toStdString();
    // What was cancelled, or could not be measured on a busy machine, is measured again, and nothing else.
    std::set<std::string> parts;
    const auto all = desk().runs().value();
    for (const RunSummary& run : all) {
        if (run.status != RunStatus::ok) continue;
        EXPECT_TRUE(parts.insert(run.part_id).second) << run.part_id << " was made twice";
    }
    EXPECT_GE(parts.size(), 20U);
    EXPECT_GT(static_cast<int>(desk().runs()->size()), before);
    EXPECT_TRUE(me.text_of("study_result").contains("Cgk"));
    EXPECT_TRUE(me.text_of("study_forecast").contains("predicted"));
    EXPECT_TRUE(me.text_of("accept_verdict").contains("simulated"));
    me.picture("accept_type1");
    me.look_at(me.find<QLabel>("study_forecast"));
    me.picture("accept_type1_result");

    // Type 3: the simulation puts the parts in; what is no study is refused with a sentence.
    choose(me, kType3);
    type(me, "study_runs", 2);
    type(me, "study_rehangs", 1);
    me.write(me.find<QLineEdit>("study_parts"), "A, A");
    troubles.clear();
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return !troubles.empty(); }));
    EXPECT_TRUE(troubles[0].contains("part \"A\" is named twice")) << troubles[0].toStdString();
    ASSERT_TRUE(idle());
    me.write(me.find<QLineEdit>("study_parts"), "A, B, C, D, E");
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return state(me, kType3) == "done"; })) << state(me, kType3).toStdString();
    EXPECT_TRUE(me.text_of("study_result").contains("Analysis of variance"));
    EXPECT_FALSE(me.text_of("study_result").contains(">0.0000<"));
    me.look_at(me.find<QLabel>("study_result"));
    me.picture("accept_type3");

    // Files.
    const std::filesystem::path pdf = folder / "a.pdf", html = folder / "a.html", dfq = folder / "a.dfq";
    me.answer_file_dialog(QString::fromStdString(pdf.string()));
    me.click("accept_report");
    EXPECT_GT(std::filesystem::file_size(pdf), 20000U);
    me.choose("report_language", "German");
    me.answer_file_dialog(QString::fromStdString(html.string()));
    me.click("accept_report");
    std::stringstream text;
    text << std::ifstream(html).rdbuf();
    EXPECT_THAT(text.str(), testing::HasSubstr("Abnahme des Messprozesses"));
    me.answer_file_dialog(QString::fromStdString(dfq.string()));
    me.click("accept_values");
    EXPECT_TRUE(std::filesystem::exists(dfq));
}

TEST_F(AcceptWay, AKeptOffsetActsAndIsTakenBack) {
    const DeskPerson me = begin("en");
    Region region = desk().project().regions.front();
    KeptOffset kept;
    kept.version = 1;
    kept.utc = "2024-05-01T12:00:00Z";
    kept.source = std::string("a test");
    kept.offset_mm = {0.1, 0, 0};
    region.offsets = {kept};
    ASSERT_TRUE(desk().edit(region));
    desk().selection().select_region(region.id);
    const auto acting = [&] {
        const KeptOffset* now = acting_offset(desk().project().regions.front());
        return now ? now->version : 0;
    };
    ASSERT_TRUE(me.wait([&] { return me.window().findChild<QTableWidget*>("offsets")->rowCount() == 1; }));
    me.click("offset_on");
    EXPECT_EQ(acting(), 1);
    EXPECT_TRUE(me.wait([&] { return me.table("offsets").value(1) == "acts"; }));
    me.look_at(me.find<QTableWidget>("offsets"));
    me.picture("accept_offset");
    desk().undo_stack().undo();
    EXPECT_EQ(acting(), 0);
    desk().undo_stack().redo();
    EXPECT_EQ(acting(), 1);
    me.click("offset_off");
    EXPECT_EQ(acting(), 0);
}

// What they find are edits of the document; the runs before are of another process then.
TEST_F(AcceptWay, RobotAndTriggerAreTakenAndGivenBack) {
    const DeskPerson me = begin("en");
    const auto covariance = [&] { return desk().project().robots.front().arrival_covariance; };
    ASSERT_TRUE(me.wait([&] { return state(me, kRobot) == "not begun"; }));
    choose(me, kRobot);
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return state(me, kRobot) == "done"; })) << state(me, kRobot).toStdString();
    EXPECT_GT(covariance()(0, 0), 0);
    EXPECT_TRUE(me.text_of("study_finding").startsWith("RP ")) << me.text_of("study_finding").toStdString();
    me.look_at(me.find<QLabel>("study_result"));
    me.picture("accept_robot");
    desk().undo_stack().undo();
    EXPECT_EQ(covariance()(0, 0), 0);
    desk().undo_stack().redo();

    choose(me, kTrigger);
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return state(me, kTrigger) == "done"; })) << state(me, kTrigger).toStdString();
    EXPECT_NE(desk().project().robots.front().trigger_latency_ms, 0);
    desk().undo_stack().undo();
    EXPECT_EQ(desk().project().robots.front().trigger_latency_ms, 0);
}

// At the narrow page every number is whole and every column seen.
TEST_F(AcceptWay, NumbersAreWholeAndNoColumnIsCut) {
    const DeskPerson me = begin("de");
    me.write_parameter("tolerance_mm", "1");
    ASSERT_TRUE(me.wait([&] { return me.find<QPushButton>("accept_next")->isEnabled(); }));
    choose(me, kType1);
    type(me, "study_runs", 3);
    me.click("study_deed");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    for (const char* name : {"study_result", "study_forecast"}) {
        ASSERT_TRUE(me.wait([&] {
            const auto* one = me.window().findChild<QLabel*>(name);
            return one && one->isVisible() && !one->text().isEmpty();
        })) << name;
        const auto* label = me.find<QLabel>(name);
        ASSERT_TRUE(label);
        QTextDocument shown;
        QTextOption words;
        words.setWrapMode(QTextOption::WordWrap);
        shown.setDefaultTextOption(words);
        shown.setDefaultFont(label->font());
        shown.setDocumentMargin(0);
        shown.setHtml(label->text());
        shown.setTextWidth(label->width());
        EXPECT_LE(shown.size().width(), label->width() + 1) << name;
        int numbers = 0;
        for (QTextBlock b = shown.begin(); b.isValid(); b = b.next()) {
            const QString text = b.text();
            for (int line = 0; line + 1 < b.layout()->lineCount(); ++line) {
                const QTextLine l = b.layout()->lineAt(line);
                const int end = l.textStart() + l.textLength();
                EXPECT_FALSE(end > 0 && end < text.size() && text[end - 1] == '.' && text[end].isDigit())
                    << text.toStdString();
            }
            numbers += text.contains(QRegularExpression("\\d\\.\\d"));
        }
        EXPECT_GE(numbers, 2) << name;
    }
    me.look_at(me.find<QLabel>("study_result"));
    me.picture("accept_numbers_de");
}

// What was judged of one region is not shown under another's name.
TEST_F(AcceptWay, FiguresGoWithTheirRegion) {
    begin("en");
    Region second = desk().project().regions.front();
    second.id = "second";
    second.frame_name = "BASE_SECOND";
    ASSERT_TRUE(desk().add(second));
    desk().selection().select_region(desk().project().regions.front().id);
    AcceptanceDesk acceptance(desk());
    int judged = 0;
    QObject::connect(&acceptance, &AcceptanceDesk::judged, &acceptance, [&] { ++judged; });
    acceptance.look();
    ASSERT_TRUE(QTest::qWaitFor([&] { return judged > 0 && acceptance.agenda(); }, kPatienceMs));
    desk().selection().select_region("second");
    EXPECT_FALSE(acceptance.agenda());
    EXPECT_FALSE(acceptance.stored());
    acceptance.look();
    EXPECT_TRUE(QTest::qWaitFor([&] { return acceptance.agenda() != nullptr; }, kPatienceMs));
}

// Where the simulation does not put the parts in, the page asks.
TEST_F(AcceptWay, APersonIsAskedForThePart) {
    const DeskPerson me = begin("en");
    auto* asks = me.window().findChild<QWidget*>("place_study_part");
    ASSERT_TRUE(asks);
    EXPECT_FALSE(asks->isVisible());
    emit desk().worker().place_study_part("P3", 2);
    EXPECT_TRUE(asks->isVisible());
    EXPECT_EQ(me.text_of("place_study_text"), "Put in part P3, time 2");
    me.picture("accept_place");
    me.click("study_later");
    EXPECT_FALSE(asks->isVisible());
}

TEST_F(AcceptWay, FitsBothScreensInBothLanguages) {
    for (const QString language : {"en", "de"})
        for (const QSize size : {QSize(1280, 800), QSize(1920, 1080)}) {
            const DeskPerson me = begin(language, size);
            ASSERT_TRUE(me.wait([&] { return !state(me, kType1).isEmpty(); }));
            EXPECT_EQ(state(me, kType1), language == "en" ? "not begun" : "nicht begonnen");
            auto* list = me.find<QTableWidget>("studies");
            EXPECT_LE(list->horizontalHeader()->length(), list->viewport()->width()) << "scrolls sideways";
            me.picture(QString("accept_%1_%2").arg(language).arg(size.width()));
            studio.reset();
        }
}

}  // namespace
}  // namespace seamwright
