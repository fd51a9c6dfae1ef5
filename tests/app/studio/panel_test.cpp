// "Fit a panel..." under a person's hands, on the simulated gripper. What is right the simulation's truth says: where panel
// and body stand is set here, and how far one is off the other with the gripper anywhere the cell itself knows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <QAction>
#include <chrono>
#include <fstream>
#include <thread>

#include "app/studio/studio.h"
#include "devices/exchange/pose_json.h"
#include "devices/simulated/gripper_cell.h"
#include "projects/file/project_json.h"
#include "projects/panel/panel_job_file.h"
#include "projects/panel/panel_station.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/app/studio/person.h"
#include "tests/app/studio/screen_audit.h"
#include "widgets/dialogs/panel_dialog.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

constexpr int kLongPatienceMs = 4 * kPatienceMs;
// Of a place on the panel from where the body wants it, after a motion; gap and flush are known to 0.05 mm, the robot to 0.01.
constexpr double kInPlace_mm = 0.3;

struct Off {
    double gap_mm = 0, flush_mm = 0;
};

class PanelWindow : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_panel_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;

    void start(const QString& language = "en") {
        studio.reset();
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        StudioOptions o;
        o.language = language;
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString(folder.string());
        studio = std::make_unique<Studio>(*qApp, o);
        studio->window().resize(1280, 800);
        QApplication::setActiveWindow(&studio->window());
        QApplication::processEvents();
    }
    void SetUp() override { start(); }
    ~PanelWindow() override {
        studio.reset();
        std::filesystem::remove_all(folder);
    }

    Desk& desk() { return studio->desk(); }
    const PanelJob& job() { return desk().project().panel_jobs.front(); }
    static bool wait(const std::function<bool()>& ready) { return QTest::qWaitFor(ready, kLongPatienceMs); }
    bool idle() { return desk().station().connected && !desk().worker().busy(); }

    PanelDialog* opened() {
        studio->window().findChild<QAction*>("panel_fit_dialog")->trigger();
        QApplication::processEvents();
        auto* dialog = studio->window().findChild<PanelDialog*>("panel_dialog");
        EXPECT_TRUE(dialog && dialog->isVisible());
        return dialog;
    }
    static QPushButton* button(PanelDialog& d, const char* name) {
        return d.findChild<QPushButton*>(QString::fromLatin1(name));
    }
    static void click(PanelDialog& d, const char* name) {
        auto* b = button(d, name);
        ASSERT_TRUE(wait([&] { return b->isEnabled() && b->isVisible(); })) << name << ": " << word(d);
        QTest::mouseClick(b, Qt::LeftButton);
        QApplication::processEvents();
    }
    static std::string word(PanelDialog& d, const char* label = "panel_verdict") {
        return d.findChild<QLabel*>(QString::fromLatin1(label))->text().toStdString();
    }
    static bool asked(PanelDialog& d) { return d.findChild<QFrame*>("panel_asking")->isVisible(); }
    static bool under_way(PanelDialog& d) {
        return d.findChild<QProgressBar*>("panel_progress")->isVisible();
    }
    static double cell(PanelDialog& d, const char* table, int row, int column) {
        return d.findChild<QTableWidget*>(QString::fromLatin1(table))
            ->item(row, column)
            ->text()
            .section(' ', 0, 0)
            .toDouble();
    }

    void make_project(bool connected = true) {
        const auto project = simulated_panel_project(
            {{"seed", 4}, {"robot", {{"repeatability_mm", 0.005}, {"repeatability_deg", 0.0002}}}});
        ASSERT_TRUE(project) << project.error().sentence();
        ASSERT_TRUE(desk().create(folder / "panel.seam", *project));
        QApplication::processEvents();
        if (!connected) return;
        desk().worker().connect_devices();
        ASSERT_TRUE(wait([&] { return idle(); }));
    }
    void teach(PanelDialog& d) {
        click(d, "panel_teach");
        ASSERT_TRUE(asked(d));
        click(d, "panel_yes");
        ASSERT_TRUE(wait([&] { return !under_way(d) && is_taught(job()); })) << word(d);
    }
    // Panel slipped in the gripper, body off: as far as servoing and one step are tried elsewhere.
    void displace() {
        const nlohmann::json panel = {
            {"displacement", pose_json(make_pose(rotation_exp({0.001, -0.0008, 0.0015}), {0.6, -0.5, 1}))}};
        const nlohmann::json body = {
            {"displacement", pose_json(make_pose(rotation_exp({-0.0008, 0.0005, -0.001}), {-0.4, 0.3, 2}))}};
        ASSERT_TRUE(desk().edit_project(
            [&](Project& p) {
                for (auto& s : p.sensors) s.settings.update({{"panel", panel}, {"body", body}});
                for (auto& r : p.robots) r.settings.update({{"panel", panel}, {"body", body}});
            },
            "another panel before another body"));
        desk().worker().connect_devices();
        ASSERT_TRUE(wait([&] { return idle(); }));
    }
    // The truth with the gripper there.
    std::vector<Off> truth(const Pose& base_from_gripper) {
        const auto cell = GripperCell::open(desk().project().robots[0].settings);
        EXPECT_TRUE(cell);
        const Pose body_from_panel = (*cell)->relation(base_from_gripper);
        std::vector<Off> all;
        for (const GripperPlace& place : default_gripper_places()) {
            const Eigen::Vector3d p = place.gripper_from_place.translation();
            const Eigen::Vector3d off =
                place.gripper_from_place.linear().transpose() * (body_from_panel * p - p);
            all.push_back({-off.x(), off.z()});
        }
        return all;
    }
    double worst(const Pose& base_from_gripper) {
        double most = 0;
        for (const Off& o : truth(base_from_gripper))
            most = std::max({most, std::abs(o.gap_mm), std::abs(o.flush_mm)});
        return most;
    }
    // Taught, displaced, and to be refused by the job's own limit.
    PanelDialog* displaced_beyond_its_limit() {
        make_project();
        PanelDialog* d = opened();
        teach(*d);
        displace();
        EXPECT_TRUE(
            desk().edit_project([](Project& p) { p.panel_jobs[0].limits.translation_mm = 0.5; }, "limit"));
        return d;
    }
    // All words of the question stand free, and its keys.
    static void reads_question(PanelDialog& d) {
        QTest::qWait(50);
        const auto* places = d.findChild<QTableWidget*>("panel_places");
        const QRect table(places->mapTo(&d, QPoint()), places->size());
        const auto* words = d.findChild<QLabel*>("panel_question");
        EXPECT_GE(words->visibleRegion().boundingRect().height(), words->heightForWidth(words->width()));
        for (const QWidget* w : std::initializer_list<const QWidget*>{words, button(d, "panel_yes")}) {
            const QRect at(w->mapTo(&d, QPoint()), w->size());
            EXPECT_FALSE(table.intersects(at)) << w->objectName().toStdString();
            EXPECT_TRUE(d.rect().contains(at)) << w->objectName().toStdString();
        }
        EXPECT_GE(button(d, "panel_yes")->height(), 32);
        EXPECT_LE(d.height(), 760);
    }
    RunRecord last_run() {
        const auto runs = desk().runs();
        EXPECT_TRUE(runs && !runs->empty());
        return runs && !runs->empty() ? desk().run(runs->back().number).value_or(RunRecord{}) : RunRecord{};
    }
    void picture(PanelDialog& d, const std::string& name) {
        QTest::qWait(100);
        std::filesystem::create_directories(SEAMWRIGHT_SCREENS);
        EXPECT_TRUE(
            d.grab().save(QString(SEAMWRIGHT_SCREENS) + "/panel_" + QString::fromStdString(name) + ".png"));
    }
};

TEST_F(PanelWindow, LeadsFromTeachingToAPanelInPlace) {
    make_project();
    PanelDialog& d = *opened();
    EXPECT_THAT(word(d), HasSubstr("zero position"));
    EXPECT_FALSE(button(d, "panel_measure")->isEnabled()) << "there is nothing to bring it to";
    teach(d);
    EXPECT_EQ(d.findChild<QTableWidget*>("panel_places")->rowCount(), 8);
    for (const PanelPlace& p : job().places)
        EXPECT_NEAR(p.gap_mm, 4, 0.3) << p.id << ": as built, between folds";

    displace();
    click(d, "panel_measure");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    const RunRecord dry = last_run();
    EXPECT_FALSE(dry.push);
    EXPECT_TRUE(dry.panel->after.empty()) << "nothing is moved";
    const auto before = truth(job().base_from_gripper);
    for (int row = 0; row < 8; ++row) {
        EXPECT_NEAR(cell(d, "panel_places", row, 3), before[static_cast<std::size_t>(row)].gap_mm, 0.12)
            << row;
        EXPECT_NEAR(cell(d, "panel_places", row, 5), before[static_cast<std::size_t>(row)].flush_mm, 0.12)
            << row;
    }
    EXPECT_EQ(d.findChild<QTableWidget*>("panel_motion")->rowCount(), 6);
    EXPECT_TRUE(button(d, "panel_fit")->isDefault()) << "the next step";
    EXPECT_EQ(d.findChild<HeadsPlot*>()->curves(), 3) << "P1 has two heads, and what became of them";
    d.findChild<QTableWidget*>("panel_places")->setCurrentCell(1, 0);
    EXPECT_EQ(d.findChild<HeadsPlot*>()->curves(), 1) << "P2 has one";

    // Asked, and declined: nothing is written.
    click(d, "panel_fit");
    ASSERT_TRUE(wait([&] { return asked(d); })) << word(d);
    EXPECT_THAT(word(d, "panel_question"), HasSubstr("panel now"));
    EXPECT_THAT(button(d, "panel_yes")->text().toStdString(), HasSubstr("Push panel to R1"));
    EXPECT_FALSE(button(d, "panel_fit")->isEnabled());
    reads_question(d);
    picture(d, "question");
    click(d, "panel_no");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    EXPECT_EQ(last_run().status, RunStatus::cancelled);
    EXPECT_EQ(last_run().panel->push.status, PushStatus::not_pushed);

    // Asked, and moved.
    EXPECT_GT(worst(job().base_from_gripper), 1);
    d.findChild<QLineEdit*>("panel_part")->setText("CAR-1");
    click(d, "panel_fit");
    ASSERT_TRUE(wait([&] { return asked(d); })) << word(d);
    click(d, "panel_yes");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    const RunRecord run = last_run();
    EXPECT_EQ(run.status, RunStatus::ok) << run.message;
    EXPECT_EQ(run.part_id, "CAR-1");
    EXPECT_LT(worst(run.panel->base_from_moved_gripper), kInPlace_mm) << "the truth";
    EXPECT_THAT(word(d), HasSubstr("CAR-1"));
    for (int row = 0; row < 8; ++row)
        EXPECT_LT(std::abs(cell(d, "panel_places", row, 7)), kInPlace_mm) << "gap left, place " << row;
    EXPECT_EQ(run.panel->verdict, PanelVerdict::in_tolerance);
    picture(d, "in_place");

    // What it was measured with is changed: it goes.
    ASSERT_TRUE(desk().edit_project([](Project& p) { p.panel_jobs[0].gap_tolerance_mm = 0.4; }, "tolerance"));
    QApplication::processEvents();
    EXPECT_EQ(d.findChild<QTableWidget*>("panel_motion")->rowCount(), 0);
    EXPECT_EQ(word(d).find("CAR-1"), std::string::npos);
}

TEST_F(PanelWindow, LearnsServesAndTakesTheFirstFrameBackWhenItIsCancelled) {
    make_project();
    PanelDialog& d = *opened();
    teach(d);
    EXPECT_FALSE(button(d, "panel_servo")->isEnabled()) << "not learnt";
    EXPECT_THAT(word(d, "panel_sensitivity"), HasSubstr("not learnt"));
    click(d, "panel_learn");
    ASSERT_TRUE(asked(d));
    EXPECT_THAT(word(d, "panel_question"), HasSubstr("12 small moves"));
    reads_question(d);
    click(d, "panel_no");
    EXPECT_FALSE(under_way(d));
    click(d, "panel_learn");
    click(d, "panel_yes");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    ASSERT_TRUE(job().sensitivity) << word(d);
    EXPECT_EQ(last_run().panel->push.status, PushStatus::restored) << "the frame is as it was";
    EXPECT_THAT(word(d, "panel_sensitivity"), HasSubstr("off the computed one"));
    EXPECT_EQ(word(d, "panel_sensitivity").find("Learn it anew"), std::string::npos);
    // The panel goes with the gripper, the body stays: a motion along a place's x closes its gap by as much.
    for (const GripperPlace& place : default_gripper_places()) {
        const auto& s = *job().sensitivity;
        const auto at = static_cast<std::size_t>(std::find(s.places.begin(), s.places.end(), place.id) -
                                                 s.places.begin());
        ASSERT_LT(at, s.places.size());
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(s.rows[2 * at][k], -place.gripper_from_place.linear()(static_cast<int>(k), 0), 0.08);
    }
    desk().undo_stack().undo();
    QApplication::processEvents();
    EXPECT_THAT(word(d, "panel_sensitivity"), HasSubstr("not learnt"));
    desk().undo_stack().redo();
    QApplication::processEvents();

    displace();
    // Seen enough after the first move.
    bool seen = false;
    const auto connection =
        QObject::connect(&desk().worker(), &StationWorker::panel_moved, &d, [&](const auto&, int moves) {
            if (moves != 1) return;
            seen = true;
            QTest::mouseClick(button(d, "panel_cancel"), Qt::LeftButton);
        });
    click(d, "panel_servo");
    ASSERT_TRUE(wait([&] { return asked(d); })) << word(d);
    click(d, "panel_yes");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    QObject::disconnect(connection);
    EXPECT_TRUE(seen);
    const RunRecord cancelled = last_run();
    EXPECT_EQ(cancelled.status, RunStatus::cancelled) << cancelled.message;
    EXPECT_EQ(cancelled.panel->push.status, PushStatus::restored);
    EXPECT_THAT(word(d), HasSubstr("cancelled"));

    // The next one finds the taught frame on the controller, and comes to where the body wants it.
    click(d, "panel_servo");
    ASSERT_TRUE(wait([&] { return asked(d); })) << word(d);
    click(d, "panel_yes");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    const RunRecord run = last_run();
    ASSERT_EQ(run.status, RunStatus::ok) << run.message;
    ASSERT_TRUE(run.panel->push.before);
    EXPECT_LT(distance_mm(*run.panel->push.before, job().base_from_frame), 1e-6);
    EXPECT_LT(worst(run.panel->base_from_moved_gripper), kInPlace_mm) << "the truth";
    const auto& moves = d.findChild<MovesPlot*>()->moves();
    ASSERT_GE(moves.size(), 3u);
    EXPECT_LT(moves.back(), 0.2 * moves.front());
    EXPECT_THAT(word(d, "panel_beside"), HasSubstr("One step would leave"));
    picture(d, "served");
}

// A window that is closed ends what it began.
TEST_F(PanelWindow, ClosingItWhileTheQuestionStandsIsANo) {
    make_project();
    PanelDialog* d = opened();
    teach(*d);
    displace();
    click(*d, "panel_fit");
    ASSERT_TRUE(wait([&] { return asked(*d); })) << word(*d);
    click(*d, "panel_close");
    ASSERT_TRUE(wait([&] { return !studio->window().findChild<PanelDialog*>("panel_dialog") && idle(); }));
    EXPECT_EQ(last_run().status, RunStatus::cancelled);
    EXPECT_EQ(last_run().panel->push.status, PushStatus::not_pushed);
}

TEST_F(PanelWindow, SaysWhyAJobIsRefused) {
    PanelDialog& d = *displaced_beyond_its_limit();
    click(d, "panel_fit");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    EXPECT_FALSE(asked(d));
    const RunRecord run = last_run();
    EXPECT_EQ(run.status, RunStatus::refused);
    ASSERT_FALSE(run.panel->refusals.empty());
    EXPECT_THAT(word(d), HasSubstr(run.panel->refusals.front().english()));
    EXPECT_THAT(word(d), HasSubstr("0.5"));

    // A frame that a region writes too is a finding of the project: a sentence, and no run.
    const auto runs = desk().runs()->size();
    ASSERT_TRUE(desk().edit_project([](Project& p) { p.panel_jobs[0].frame_name.clear(); }, "frame"));
    click(d, "panel_fit");
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    EXPECT_THAT(word(d), HasSubstr("names no frame"));
    EXPECT_EQ(desk().runs()->size(), runs);

    // What another deed of the desk fails at is not this window's business.
    const std::string before = word(d);
    desk().worker().drive_gap({});
    ASSERT_TRUE(wait([&] { return idle(); }));
    EXPECT_EQ(word(d), before);
}

// A busy window hears late of a deed before: that its own has ended as well by then is no reason to drop what came of it.
TEST_F(PanelWindow, SaysWhatCameOfADeedThatEndsBeforeTheWindowHearsOfTheOneBefore) {
    PanelDialog& d = *displaced_beyond_its_limit();
    ASSERT_TRUE(wait([&] { return idle() && button(d, "panel_fit")->isEnabled(); }));
    desk().worker().search_cameras();
    QTest::mouseClick(button(d, "panel_fit"), Qt::LeftButton);
    ASSERT_TRUE(under_way(d));
    while (desk().worker().busy()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ASSERT_TRUE(wait([&] { return !under_way(d); }));
    const RunRecord run = last_run();
    ASSERT_FALSE(run.panel->refusals.empty());
    EXPECT_THAT(word(d), HasSubstr(run.panel->refusals.front().english()));
}

TEST_F(PanelWindow, TakesJobsFromFilesAndSaysWhatIsWrongWithThem) {
    const auto made = simulated_panel_project({{"seed", 4}});
    ASSERT_TRUE(made);
    Project without = *made;
    without.panel_jobs.clear();
    ASSERT_TRUE(desk().create(folder / "without.seam", without));
    QApplication::processEvents();
    PanelDialog& d = *opened();
    EXPECT_THAT(word(d), HasSubstr("has no panel job"));
    EXPECT_TRUE(button(d, "panel_file")->isDefault()) << "the next step";
    EXPECT_FALSE(button(d, "panel_measure")->isEnabled());
    const auto file = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name) << text;
        return QString::fromStdString((folder / name).string());
    };

    // The sentences of the command.
    for (const std::string text : {"{\"spots\": 3}", "{\"spots\": [], \"speed\": 1}", "{not json", "{}"}) {
        const QString bad = file("bad.json", text);
        d.take_file(bad);
        EXPECT_EQ(word(d), shown_error(read_panel_measures(bad.toStdString()).error()).toStdString()) << text;
        EXPECT_TRUE(desk().project().panel_jobs.empty());
    }
    nlohmann::json stranger = to_json_document(made->panel_jobs[0], {.profiles = false});
    stranger["robot_id"] = "R9";
    d.take_file(file("stranger.json", stranger.dump()));
    EXPECT_THAT(word(d), HasSubstr("R9"));
    EXPECT_TRUE(desk().project().panel_jobs.empty());

    d.take_file(file("job.json", to_json_document(made->panel_jobs[0], {.profiles = false}).dump()));
    ASSERT_EQ(desk().project().panel_jobs.size(), 1u) << word(d);
    EXPECT_EQ(d.findChild<QComboBox*>("panel_job")->currentText(), "panel");
    EXPECT_EQ(d.findChild<QTableWidget*>("panel_places")->rowCount(), 8);
    desk().undo_stack().undo();
    QApplication::processEvents();
    EXPECT_TRUE(desk().project().panel_jobs.empty());
    EXPECT_THAT(word(d), HasSubstr("has no panel job"));
    EXPECT_EQ(d.findChild<QTableWidget*>("panel_places")->rowCount(), 0);

    // Measures alone: the body stands off by this, so the gripper goes by it.
    const Eigen::Vector3d off(0.4, -0.3, 0.2);
    nlohmann::json spots = nlohmann::json::array();
    for (const GripperPlace& place : default_gripper_places()) {
        const Eigen::Vector3d at =
            Eigen::Vector3d(4, 0, 0) + place.gripper_from_place.linear().transpose() * off;
        spots.push_back({{"id", place.id},
                         {"gripper_from_sensor", pose_json(place.gripper_from_place)},
                         {"panel", {{"reference", {0, 0, 0}}, {"measured", {0, 0, 0}}}},
                         {"body", {{"reference", {4, 0, 0}}, {"measured", {at.x(), at.y(), at.z()}}}}});
    }
    d.take_file(file("measures.json", nlohmann::json{{"spots", spots}}.dump()));
    EXPECT_THAT(word(d), HasSubstr("Nothing is kept"));
    ASSERT_EQ(d.findChild<QTableWidget*>("panel_motion")->rowCount(), 6) << word(d);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(cell(d, "panel_motion", k, 1), off[k], 2e-3) << k;
    for (int k = 3; k < 6; ++k) EXPECT_NEAR(cell(d, "panel_motion", k, 1), 0, 2e-3) << k;
    EXPECT_TRUE(desk().project().panel_jobs.empty());
}

TEST_F(PanelWindow, AnotherProjectLeavesNothingOfThisOne) {
    make_project();
    PanelDialog* d = opened();
    teach(*d);
    click(*d, "panel_measure");
    ASSERT_TRUE(wait([&] { return !under_way(*d); }));
    EXPECT_EQ(d->findChild<QTableWidget*>("panel_motion")->rowCount(), 6);
    click(*d, "panel_measure");  // under way when the project is left
    Project other;
    other.name = "other";
    ASSERT_TRUE(desk().create(folder / "other.seam", other));
    ASSERT_TRUE(wait([&] { return !studio->window().findChild<PanelDialog*>("panel_dialog"); }));
    PanelDialog& again = *opened();
    EXPECT_EQ(again.findChild<QTableWidget*>("panel_places")->rowCount(), 0);
    EXPECT_EQ(again.findChild<QTableWidget*>("panel_motion")->rowCount(), 0);
    EXPECT_THAT(word(again), HasSubstr("has no panel job"));
    EXPECT_EQ(again.findChild<QComboBox*>("panel_job")->count(), 0);
}

// As an inspector looks at it, on the laptop and on the large screen, in both languages.
TEST_F(PanelWindow, IsReadAndReachedOnBothScreensInBothLanguages) {
    for (const char* language : {"en", "de"}) {
        start(language);
        make_project();
        PanelDialog& d = *opened();
        picture(d, std::string("untaught_") + language);
        teach(d);
        click(d, "panel_learn");
        click(d, "panel_yes");
        ASSERT_TRUE(wait([&] { return !under_way(d) && job().sensitivity; })) << word(d);
        displace();
        click(d, "panel_servo");
        ASSERT_TRUE(wait([&] { return asked(d); })) << word(d);
        reads_question(d);
        for (const QSize size : {QSize(1280, 740), QSize(1900, 1000)}) {
            d.resize(size);
            picture(d, "asking_" + std::string(language) + "_" + std::to_string(size.width()));
            for (const QString& one : audit::cut_off(d)) ADD_FAILURE() << one.toStdString();
            EXPECT_LE(d.minimumSizeHint().height(), 760);
        }
        click(d, "panel_yes");
        ASSERT_TRUE(wait([&] { return !under_way(d); }));
        for (const QSize size : {QSize(1280, 740), QSize(1900, 1000)}) {
            d.resize(size);
            picture(d, std::string(language) + "_" + std::to_string(size.width()));
            for (const auto& found : {audit::nameless(d), audit::unreachable(d), audit::cut_off(d),
                                      audit::faint(d), audit::colour_alone(d)})
                for (const QString& one : found)
                    ADD_FAILURE() << language << " " << size.width() << ": " << one.toStdString();
        }
    }
}

}  // namespace
}  // namespace seamwright
