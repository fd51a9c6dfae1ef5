// What an acceptance is, how far it is, and what comes next, from a project's file; the hand-over report tells the same.

#include "projects/acceptance/agenda.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/acceptance/simulated_parts.h"
#include "projects/hand_over/hand_over.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using State = AgendaItem::State;
using testing::HasSubstr;
using testing::Not;

class AcceptanceAgenda : public testing::Test {
  protected:
    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    LiveStudyOptions options;

    void SetUp() override {
        cell->noise_mm = 0.02;
        cell->project.regions.pop_back();
        ASSERT_TRUE(ProjectFile::create(folder / "cell.seam", cell->project));
        auto file = ProjectFile::open(folder / "cell.seam");
        ASSERT_TRUE(file) << file.error().sentence();
        const Project project = file->load().value();
        station.emplace(std::move(*file), project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
    }
    void require(double tolerance_mm) {
        Project project = station->project();
        project.requirements.acceptance.tolerance_mm = tolerance_mm;
        ASSERT_TRUE(station->edit(project));
    }
    StoredAcceptance stored() {
        auto found = stored_acceptance(station->file(), station->project(), "");
        EXPECT_TRUE(found) << found.error().sentence();
        return found.value_or(StoredAcceptance{});
    }
    Agenda agenda() {
        auto found = acceptance_agenda(station->file(), station->project(), stored());
        EXPECT_TRUE(found) << found.error().sentence();
        return found.value_or(Agenda{});
    }
    void measure() {
        auto progress = measure_study(*station, options);
        ASSERT_TRUE(progress) << progress.error().sentence();
    }
    std::string hand_over(Language language) {
        Facts facts;
        EXPECT_TRUE(gather(station->file(), facts));
        HandOverOptions of;
        of.language = language;
        of.now_utc = "2024-06-01T12:34:00.000Z";
        auto page = hand_over_report(station->file(), station->project(), facts, of);
        EXPECT_TRUE(page) << page.error().sentence();
        return page ? page->html() : std::string();
    }
};

TEST_F(AcceptanceAgenda, LeadsFromTheToleranceThroughTheStudies) {
    EXPECT_THAT(stored().lacking.value().sentence(), HasSubstr("the tolerance is not stated"));
    EXPECT_EQ(agenda().next, AgendaStudy::type1);
    require(2);
    EXPECT_THAT(stored().lacking.value().sentence(), HasSubstr("no stored run"));
    EXPECT_TRUE(stored().forecast) << "before anything is measured";
    EXPECT_EQ(agenda().of(AgendaStudy::type1).state, State::not_begun);
    EXPECT_EQ(agenda().of(AgendaStudy::type1).proposed.runs, 50);

    // Cancelled in the middle; what goes on is the same study.
    std::stop_source stop;
    options.runs = 25;
    options.cancel = stop.get_token();
    options.measured = [&, n = 0](const RunRecord&) mutable {
        if (++n == 3) stop.request_stop();
    };
    measure();
    const Agenda begun = agenda();
    const AgendaItem& type1 = begun.of(AgendaStudy::type1);
    EXPECT_EQ(type1.state, State::begun);
    EXPECT_THAT(type1.finding.english(), HasSubstr("3 of 25 runs"));
    EXPECT_EQ(type1.proposed.runs, 25);
    EXPECT_EQ(begun.next, AgendaStudy::type1);
    options = type1.proposed;
    measure();
    const Agenda done = agenda();
    EXPECT_EQ(done.of(AgendaStudy::type1).state, State::done);
    EXPECT_EQ(done.of(AgendaStudy::type1).verdict, AcceptanceVerdict::ok);
    EXPECT_EQ(done.next, AgendaStudy::type3);
    EXPECT_EQ(stored().studies->source.runs, 25);

    // A changed project is another process: nothing of it goes on.
    options.anew = true;
    options.runs = 30;
    std::stop_source again;
    options.cancel = again.get_token();
    options.measured = [&](const RunRecord&) { again.request_stop(); };
    measure();
    EXPECT_TRUE(agenda().of(AgendaStudy::type1).progress);
    Project changed = station->project();
    changed.spots.front().sigma_mm *= 2;
    station->use(changed);
    EXPECT_FALSE(agenda().of(AgendaStudy::type1).progress);
}

TEST_F(AcceptanceAgenda, TheHandOverTellsTheSame) {
    EXPECT_THAT(hand_over(Language::english), HasSubstr("No tolerance is stated, and no study was made."));
    require(2);
    EXPECT_THAT(hand_over(Language::english), HasSubstr("not made"));
    options.runs = 25;
    measure();
    Project project = station->project();
    KeptOffset kept;
    kept.version = 1;
    kept.source = std::string("tracker");
    kept.offset_mm = {0.25, 0, 0};
    project.regions.front().offsets = {kept};
    ASSERT_TRUE(station->edit(project));
    const StoredAcceptance now = stored();
    ASSERT_TRUE(now.studies && now.studies->type1);
    const std::string cg =
        fmt::format("Cg {:.2f}, Cgk {:.2f}", now.studies->type1->cg, now.studies->type1->cgk);
    for (const Language language : {Language::english, Language::german}) {
        const std::string html = hand_over(language),
                          own = acceptance_page(now, "cell.seam", language, "").html();
        EXPECT_THAT(html, HasSubstr(cg));
        EXPECT_THAT(own, HasSubstr(cg));
        const std::string heading = language == Language::english ? "Type 1: capability on a reference part"
                                                                  : "Verfahren 1: Fähigkeit am Referenzteil";
        EXPECT_THAT(html, HasSubstr("<h3>" + heading));
        EXPECT_THAT(own, HasSubstr("<h2>" + heading));
        EXPECT_THAT(html, HasSubstr(language == Language::english ? "Kept offsets" : "Aufbewahrte Offsets"));
        EXPECT_THAT(html, HasSubstr("0.2500"));
    }
    EXPECT_THAT(hand_over(Language::german), Not(HasSubstr("Studies that the data")));
}

TEST_F(AcceptanceAgenda, NamesTheRegionsThereAre) {
    const auto unknown = stored_acceptance(station->file(), station->project(), "nowhere");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().sentence(), HasSubstr("there is no region \"nowhere\""));
    EXPECT_FALSE(SimulatedParts::possible(station->project())) << "no simulated cell";
}

}  // namespace
}  // namespace seamwright
