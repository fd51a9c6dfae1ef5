// Studies that are made run by run: what stops them, and how they go on.

#include "projects/acceptance/study/live_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/LU>
#include <csignal>

#include "projects/acceptance/study/stored_values.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

class LiveStudy : public testing::Test {
  protected:
    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    LiveStudyOptions options;

    void SetUp() override {
        cell->noise_mm = 0.02;
        cell->project.regions.pop_back();
        ASSERT_TRUE(ProjectFile::create(folder / "cell.seam", cell->project));
        connect();
    }
    // As a program that is started anew finds the file.
    void connect() {
        station.reset();
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
    StudyProgress measure() {
        auto progress = measure_study(*station, options);
        EXPECT_TRUE(progress) << progress.error().sentence();
        return progress.value_or(StudyProgress{});
    }
    std::size_t stored() { return station->file().runs()->size(); }
    // A program that measures until `at`, where SIGKILL hits it.
    void killed(std::function<void()> arm) {
        station.reset();
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            connect();
            arm();
            (void)measure_study(*station, options);
            _exit(0);
        }
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        connect();
    }
};

TEST_F(LiveStudy, AKillBetweenRunsLosesNoneAndMakesNoneTwice) {
    options.runs = 12;
    killed([&] {
        options.measured = [n = 0](const RunRecord&) mutable {
            if (++n == 3) raise(SIGKILL);
        };
    });
    EXPECT_EQ(stored(), 3u);
    const auto found = study_progress(station->file(), station->project(), options);
    ASSERT_TRUE(found && *found);
    EXPECT_EQ((*found)->made(), 3);
    EXPECT_EQ((*found)->next()->missing(), 9);
    EXPECT_THAT((*found)->stopped.english(), HasSubstr("3 of 12 runs are made"));

    // In the middle of the fifth: two spots of it are measured.
    killed([&] {
        cell->on_trigger = [n = 0](const std::string&) mutable {
            if (++n == 8) raise(SIGKILL);
        };
    });
    EXPECT_TRUE(station->file().check().empty());
    const StudyProgress done = measure();
    EXPECT_TRUE(done.resumed);
    EXPECT_TRUE(done.complete()) << done.stopped;
    EXPECT_EQ(done.made(), 12);
    int whole = 0;
    const auto all = station->file().runs().value();
    for (const RunSummary& run : all) whole += run.status == RunStatus::ok;
    EXPECT_EQ(whole, 12);
    auto values = stored_values(station->file(), "");
    ASSERT_TRUE(values) << values.error().sentence();
    EXPECT_EQ(values->values.type1.size(), 12u);
    // Complete: nothing more is measured, unless a new one is asked for.
    const std::size_t runs = stored();
    EXPECT_TRUE(measure().complete());
    EXPECT_EQ(stored(), runs);
    options.anew = true;
    EXPECT_FALSE(measure().resumed);
    EXPECT_EQ(stored(), runs + 12);
}

TEST_F(LiveStudy, PartsAndRehangsGoOnWhereTheyWaited) {
    options.study = Study::type3;
    options.parts = {"P1", "P2", "P3"};
    options.rehangs = 2;
    options.runs = 2;
    std::vector<std::string> placed;
    std::size_t allowed = 2;
    options.place = [&](const std::string& part, int rehang) {
        if (placed.size() == allowed) return false;
        placed.push_back(part + "/" + std::to_string(rehang));
        const double x = part == "P1" ? 1 : part == "P2" ? -1 : 2;
        cell->workobject_from_movedworkobject = make_pose(Eigen::Matrix3d::Identity(), {x, 0.1 * rehang, x});
        return true;
    };
    const StudyProgress waits = measure();
    EXPECT_FALSE(waits.complete());
    EXPECT_EQ(waits.made(), 4);
    ASSERT_NE(waits.next(), nullptr);
    EXPECT_EQ(waits.next()->part, "P3");
    EXPECT_THAT(waits.stopped.english(), HasSubstr("part P3 is waited for"));
    allowed = 100;
    connect();
    EXPECT_TRUE(measure().complete());
    EXPECT_EQ(placed, (std::vector<std::string>{"P1/1", "P2/1", "P3/1", "P1/2", "P2/2", "P3/2"}));
    EXPECT_EQ(stored(), 12u);
    auto values = stored_values(station->file(), "");
    ASSERT_TRUE(values) << values.error().sentence();
    AcceptanceSettings settings;
    settings.tolerance_mm = 2;
    const Study type3[] = {Study::type3};
    const auto a = judge_acceptance(values->values, values->source, settings, type3);
    ASSERT_TRUE(a) << a.error().sentence();
    EXPECT_EQ(a->type3->parts, 3);
    EXPECT_EQ(a->type3->rehangs, 2);
    EXPECT_EQ(a->type3->runs, 2);
    EXPECT_TRUE(a->type3->nested);
}

TEST_F(LiveStudy, CancelledAndRefusedSayWhatIsMissing) {
    options.runs = 6;
    std::stop_source stop;
    options.cancel = stop.get_token();
    std::vector<Text> told;
    options.progress = [&](const RunProgress& p) {
        EXPECT_EQ(p.total, 6);
        told.push_back(p.text);
    };
    options.measured = [&, n = 0](const RunRecord&) mutable {
        if (++n == 2) stop.request_stop();
    };
    const StudyProgress cancelled = measure();
    EXPECT_EQ(cancelled.made(), 2);
    EXPECT_THAT(cancelled.stopped.english(), HasSubstr("cancelled, 2 of 6 runs are made"));
    EXPECT_FALSE(told.empty());
    options.cancel = {};
    options.measured = {};
    // Beyond the region's limits: the gate refuses, and the study does not go on trying until it passes.
    cell->workobject_from_movedworkobject = make_pose(Eigen::Matrix3d::Identity(), {0, 0, 30});
    const StudyProgress refused = measure();
    EXPECT_EQ(refused.made(), 2);
    EXPECT_EQ(refused.refused(), kRefusedInARow);
    EXPECT_THAT(refused.stopped.english(), HasSubstr("the gate refused 3 runs"));
    cell->workobject_from_movedworkobject = Pose::Identity();
    cell->silent_sensor_at = "S2";
    const auto silent = measure_study(*station, options);
    ASSERT_FALSE(silent);
    EXPECT_EQ(silent.error().kind, ErrorKind::device);
    cell->silent_sensor_at.clear();
    const StudyProgress done = measure();
    EXPECT_TRUE(done.complete());
    EXPECT_EQ(done.made(), 6);
    EXPECT_EQ(done.refused(), 3) << "still said";
}

// A changed project is another process; another tolerance is not.
TEST_F(LiveStudy, AChangedProjectBeginsAnew) {
    options.runs = 4;
    std::stop_source stop;
    options.cancel = stop.get_token();
    options.measured = [&](const RunRecord&) { stop.request_stop(); };
    EXPECT_EQ(measure().made(), 1);
    options.cancel = {};
    options.measured = {};
    Project project = station->project();
    project.requirements.acceptance.tolerance_mm = 0.7;
    ASSERT_TRUE(station->edit(project));
    EXPECT_EQ((*study_progress(station->file(), project, options))->made(), 1);
    project.spots[0].sigma_mm = 0.04;
    ASSERT_TRUE(station->edit(project));
    const StudyProgress done = measure();
    EXPECT_TRUE(done.complete());
    EXPECT_EQ(done.other_setup, 1);
    EXPECT_FALSE(done.resumed);
    EXPECT_EQ(stored(), 5u);
}

// The forecast from first principles: what the spots see of a small displacement, by differences, each coordinate
// with the sigma that its spot states.
TEST_F(LiveStudy, TheForecastIsTheStatedCovarianceAtTheWorstPoint) {
    const Project& p = cell->project;
    Matrix6 information = Matrix6::Zero();
    const Pose wo = p.part.base_from_workobject;
    const auto nudge = [](int k, double by) {
        Vector6 d = Vector6::Zero();
        d[k] = by;
        return make_pose(rotation_exp(d.tail<3>()), d.head<3>());
    };
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> directions;  // point, direction
    for (const Spot& spot : p.spots) {
        const Pose w = wo.inverse() * spot.base_from_flange * p.calibrations[0].flange_from_sensor;
        const Eigen::Vector3d point = w * spot.reference_mm;
        for (const int axis : {0, 2}) {
            Vector6 row;
            for (int k = 0; k < 6; ++k) {
                const double h = k < 3 ? 1e-3 : 1e-6;
                row[k] = (w.inverse() * (nudge(k, h) * point) - w.inverse() * (nudge(k, -h) * point))[axis] /
                         (2 * h);
            }
            information += row * row.transpose() / (spot.sigma_mm * spot.sigma_mm);
            directions.emplace_back(point, w.linear().col(axis));
        }
    }
    const Matrix6 covariance = information.inverse();
    double worst = 0;
    for (const auto& [point, direction] : directions) {
        Vector6 g;
        for (int k = 0; k < 6; ++k) {
            const double h = k < 3 ? 1e-3 : 1e-6;
            g[k] = direction.dot(nudge(k, h) * point - nudge(k, -h) * point) / (2 * h);
        }
        worst = std::max(worst, std::sqrt(g.dot(covariance * g)));
    }
    const auto forecast = forecast_studies(p, p.regions[0]);
    ASSERT_TRUE(forecast) << forecast.error().sentence();
    EXPECT_NEAR(forecast->type1_s_mm, worst, 1e-5 * worst);
    // And it stands beside what the runs gave.
    options.runs = 10;
    ASSERT_TRUE(measure().complete());
    const auto values = stored_values(station->file(), "");
    ASSERT_TRUE(values && values->source.forecast);
    EXPECT_LE(values->source.forecast->type1_s_mm, worst * 1.00001);
    EXPECT_GT(values->source.forecast->type1_s_mm, 0);
}

TEST_F(LiveStudy, OptionsThatAreNone) {
    const auto refused = [&](const char* part) {
        const auto progress = measure_study(*station, options);
        ASSERT_FALSE(progress);
        EXPECT_THAT(progress.error().sentence(), HasSubstr(part));
        EXPECT_NE(progress.error().kind, ErrorKind::device);
        EXPECT_EQ(stored(), 0u);
        EXPECT_TRUE(station->file().evidence()->empty()) << "no plan";
    };
    options.runs = 0;
    refused("--runs");
    options.runs = 2;
    options.study = Study::linearity;
    refused("known-shift");
    options.study = Study::vda5;
    refused("type1 and type3");
    options.study = Study::type3;
    refused("0 parts");
    options.parts = {"P1", "P1"};
    refused("twice");
    options.parts = {"P1", ""};
    refused("names no part");
    options.parts = {"P1", "zero shift 2"};
    refused("proofs' own");
    options.rehangs = 2;
    options.parts = {"P1", "P1 (hung 2)"};
    refused("rehang of another");
    options.parts = {"P1", "P2"};
    options.region = "nowhere";
    refused("nowhere");
    options.study = Study::type1;
    options.region.clear();
    refused("not touched");
}

}  // namespace
}  // namespace seamwright
