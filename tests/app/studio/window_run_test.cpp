// The Run page at the window: what it shows while a part is measured, when that fails, of a run of the past, and of a push
// that waits for its answer.

#include <QLabel>
#include <QTableWidget>

#include "projects/file/project_file.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/pages/run_page.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

class RunAtTheWindow : public Furniture {
  protected:
    void SetUp() override {
        Furniture::SetUp();
        start(true);
        ASSERT_TRUE(DeskPerson::wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    }
    Desk& desk() { return studio->desk(); }
    QLabel* verdict() { return window().findChild<QLabel*>("run_verdict"); }
    QColor tone() { return verdict()->palette().color(QPalette::WindowText); }
    QTableWidget* spots() { return window().findChild<QTableWidget*>("run_spots"); }
    bool idle() {
        return DeskPerson::wait([&] { return !desk().worker().busy(); });
    }
    void measure(DeskPerson& me) {
        const auto runs = desk().runs()->size();
        me.click("measure");
        ASSERT_TRUE(me.wait([&] { return desk().runs()->size() > runs && !desk().worker().busy(); }));
        QApplication::processEvents();
    }
    // A push that waits for its answer.
    void ask(DeskPerson& me) {
        me.step(8);
        me.click("measure_push");
        auto* confirm = window().findChild<QWidget*>("confirm");
        ASSERT_TRUE(me.wait([&] { return confirm->isVisible(); })) << verdict()->text().toStdString();
    }
};

TEST_F(RunAtTheWindow, AFailedMeasurementLeavesNoResultOfAnEarlierOne) {
    DeskPerson me(window());
    me.step(8);
    measure(me);
    ASSERT_TRUE(verdict()->text().startsWith("Run 1, part run 1: ok")) << verdict()->text().toStdString();
    EXPECT_EQ(tone(), style::good(window().palette()));
    ASSERT_GT(spots()->rowCount(), 0);
    // All lines of it, on entering too.
    window().resize(1180, 660);
    for (const int step : {3, 8}) me.step(step);
    QTest::qWait(100);
    EXPECT_GE(verdict()->height(), verdict()->heightForWidth(verdict()->width()));
    for (const Spot& spot : std::vector<Spot>(desk().project().spots))
        ASSERT_TRUE(desk().set_spot_enabled(spot.id, false));
    ASSERT_TRUE(idle());
    QString told;
    QObject::connect(&desk(), &Desk::trouble, &desk(), [&](const QString& sentence) { told = sentence; });
    auto* measure = me.find<QPushButton>("measure");
    ASSERT_TRUE(measure);
    measure->click();
    EXPECT_EQ(verdict()->text(), "Measuring ...");
    EXPECT_EQ(spots()->rowCount(), 0);
    ASSERT_TRUE(me.wait([&] { return !told.isEmpty() && !desk().worker().busy(); }));
    EXPECT_TRUE(told.contains("no spot is enabled")) << told.toStdString();
    QTest::qWait(100);
    EXPECT_EQ(verdict()->text(), "Not measured.");
    EXPECT_EQ(spots()->rowCount(), 0);
    EXPECT_EQ(me.text_of("gate"), "");
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/run_not_measured.png");
    // One of the past says that it is, and its green is none of now.
    auto* history = me.find<QTableWidget>("history");
    ASSERT_TRUE(history);
    history->setCurrentCell(0, 0);
    me.click("open_run");
    EXPECT_TRUE(verdict()->text().startsWith("Shown: run 1 of ")) << verdict()->text().toStdString();
    EXPECT_EQ(tone(), style::text(window().palette()));
    EXPECT_GT(spots()->rowCount(), 0);
}

TEST_F(RunAtTheWindow, ASpotThatTheCorrectionLeftOutIsNotCalledMeasured) {
    DeskPerson me(window());
    me.step(8);
    // One reference far from where its feature is: the others contradict it.
    Spot wrong = desk().project().spots.front();
    wrong.required = false;
    wrong.reference_mm += Eigen::Vector3d(12, 0, 9);
    ASSERT_TRUE(desk().edit(wrong));
    measure(me);
    const RunRecord run = desk().run(desk().runs()->back().number).value();
    std::string left_out;
    for (const RegionRecord& region : run.regions)
        if (region.correction)
            for (const SpotResidual& s : region.correction->spots)
                if (!s.used) left_out = s.id;
    ASSERT_EQ(left_out, wrong.id) << verdict()->text().toStdString();
    EXPECT_TRUE(verdict()->text().contains("contradict the others: " + QString::fromStdString(left_out)))
        << verdict()->text().toStdString();
    EXPECT_NE(tone(), style::good(window().palette()));
    int said = 0;
    for (int row = 0; row < spots()->rowCount(); ++row) {
        const QString word = spots()->item(row, 3)->text();
        if (spots()->item(row, 0)->text().toStdString() != left_out) {
            EXPECT_EQ(word, "measured");
            continue;
        }
        ++said;
        EXPECT_TRUE(word.startsWith("left out, contradicts by ")) << word.toStdString();
        EXPECT_EQ(spots()->item(row, 3)->foreground().color(), style::alarm(window().palette()));
    }
    EXPECT_EQ(said, 1);
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/run_left_out.png");
}

TEST_F(RunAtTheWindow, AnEditWhileAPushWaitsTakesTheQuestionAway) {
    DeskPerson me(window());
    ask(me);
    auto* run_page = window().findChild<RunPage*>();
    ASSERT_TRUE(run_page->asks());
    me.step(3);
    auto* next = me.find<QPushButton>("next_step");
    ASSERT_TRUE(next);
    EXPECT_EQ(next->accessibleName(), "A push waits for your answer: go to Run");
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/push_waits.png");
    me.click("next_step");
    EXPECT_EQ(window().step(), Step::run);
    EXPECT_TRUE(run_page->asks()) << "looked at, not answered";
    EXPECT_FALSE(next->accessibleName().contains("push waits"));
    Region region = desk().project().regions.front();
    region.limits.translation_mm += 1;
    ASSERT_TRUE(desk().edit(region));
    EXPECT_FALSE(run_page->asks());
    ASSERT_TRUE(idle());
    ASSERT_TRUE(me.wait([&] { return verdict()->text().contains("Measure again."); }))
        << verdict()->text().toStdString();
    const RunRecord run = desk().run(desk().runs()->back().number).value();
    for (const RegionRecord& r : run.regions) EXPECT_NE(r.push.status, PushStatus::written);
    EXPECT_EQ(tone(), style::attention(window().palette()));
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/push_voided.png");
}

}  // namespace
}  // namespace seamwright
