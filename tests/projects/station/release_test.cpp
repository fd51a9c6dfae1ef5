// From the written frames to the running application: the link is held until the application has the
// permission, and file, robot and verdict say the same, whatever the disk does.

#include "projects/gate/release.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/station/run_release.h"
#include "projects/station/station.h"
#include "projects/station/watch.h"
#include "tests/projects/failing_disk.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

class Releasing : public testing::Test {
  protected:
    void SetUp() override {
        cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
        options.push = true;
        options.part_id = "car 1";
        options.hold = milliseconds(300);
        make();
    }
    void make() {
        station.reset();
        for (const Region& r : cell->project.regions) cell->frames[r.frame_name] = r.base_from_frame;
        cell->permission = Permission::none;
        auto file = ProjectFile::create(path, cell->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), cell->project);
        connect();
    }
    void connect() {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
    }
    RunRecord run() {
        auto record = station->run(options);
        EXPECT_TRUE(record) << record.error().sentence();
        if (!record) return {};
        const RunRecord stored = in_file(record->number);
        EXPECT_EQ(stored.status, record->status);
        EXPECT_EQ(stored.message, record->message);
        EXPECT_EQ(stored.events.size(), record->events.size());
        for (std::size_t i = 0; i < stored.regions.size(); ++i)
            EXPECT_EQ(exact_text(stored.regions[i]), exact_text(record->regions[i]));
        return std::move(*record);
    }
    RunRecord in_file(std::int64_t number) {
        auto file = ProjectFile::open(path, FileAccess::read_only);
        EXPECT_TRUE(file) << file.error().sentence();
        return file->load_run(number).value();
    }
    bool frames_old() const {
        for (const Region& r : cell->project.regions)
            if (distance_mm(cell->frames.at(r.frame_name), r.base_from_frame) > 1e-9) return false;
        return true;
    }
    static std::vector<Release> releases(const RunRecord& run) {
        std::vector<Release> list;
        for (const RegionRecord& r : run.regions) list.push_back(r.push.release);
        return list;
    }
    TemporaryFolder folder;
    const std::filesystem::path path = folder / "cell.seam";
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    RunOptions options;
};

TEST_F(Releasing, TheLinkIsHeldUntilTheApplicationHasThePermission) {
    cell->application = false;
    int looks = 0;
    cell->on_permission = [&] {
        if (++looks == 4) cell->permission = Permission::taken;
    };
    std::vector<Text> told;
    options.progress = [&](const RunProgress& p) { told.push_back(p.text); };
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::ok);
    EXPECT_EQ(record.message, "regions corrected and pushed: 2");
    EXPECT_EQ(looks, 4);
    EXPECT_THAT(releases(record), Each(Release::taken));
    EXPECT_EQ(record.regions[0].push.robot_id, "R1");
    EXPECT_THAT(told, testing::Contains(HasSubstr("robot R1: released, waiting for the application")));
    EXPECT_EQ(told.back(), "robot R1: the application runs in the frames");
    EXPECT_EQ(record.events.back().kind, EventKind::push);
}

TEST_F(Releasing, AnApplicationThatDoesNotBeginInTimeGetsNothing) {
    cell->application = false;
    const auto begun = Clock::now();
    const RunRecord record = run();
    EXPECT_GE(Clock::now() - begun, options.hold);
    EXPECT_EQ(record.status, RunStatus::not_taken);
    EXPECT_THAT(record.message, HasSubstr("nothing is released"));
    EXPECT_THAT(releases(record), Each(Release::not_taken));
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::corrected, PartVerdict::failed)) << "told, not left";
    EXPECT_EQ(cell->permission, Permission::none);
    EXPECT_TRUE(frames_old());
    for (const RegionRecord& r : record.regions) EXPECT_EQ(r.push.status, PushStatus::restored);
}

TEST_F(Releasing, NotWaitedForMeansLookedAtOnce) {
    options.hold = milliseconds(0);
    EXPECT_EQ(run().status, RunStatus::ok) << "that has begun at once";
    cell->application = false;
    EXPECT_EQ(run().status, RunStatus::not_taken);
}

TEST_F(Releasing, AnApplicationThatNeedsTheLinkIsWaitedForToItsEnd) {
    cell->application = false;
    int looks = 0;
    cell->on_permission = [&] {
        ++looks;
        if (looks == 2) cell->permission = Permission::running;
        if (looks == 30) cell->permission = Permission::taken;  // well after `hold`
    };
    EXPECT_EQ(run().status, RunStatus::ok);
    EXPECT_EQ(looks, 30);
}

// A controller that keeps what was written aside until the verdict, and then sets one frame only.
TEST_F(Releasing, AFrameThatTheVerdictDidNotSetIsAnAlarm) {
    for (const bool application : {false, true}) {
        cell->application = application;
        make();
        const Region& second = cell->project.regions[1];
        cell->frames_after_verdict[second.frame_name] = second.base_from_frame;
        const RunRecord record = run();
        EXPECT_EQ(record.status, RunStatus::alarm);
        EXPECT_THAT(record.message, HasSubstr(second.frame_name));
        EXPECT_THAT(record.message, HasSubstr("not the one that was written"));
        EXPECT_THAT(releases(record), Each(application ? Release::taken : Release::withdrawn));
        if (!application) {
            EXPECT_TRUE(frames_old());
            EXPECT_EQ(cell->permission, Permission::none);
        }
        cell->frames_after_verdict.clear();
    }
}

TEST_F(Releasing, AFrameThatIsChangedWhileTheApplicationIsWaitedForTakesThePermissionBack) {
    cell->application = false;
    options.hold = milliseconds(5000);
    const std::string name = cell->project.regions[0].frame_name;
    int looks = 0;
    cell->on_permission = [&] {
        if (++looks == 3) cell->frames[name].translation().x() += 0.2;
    };
    const auto begun = Clock::now();
    const RunRecord record = run();
    EXPECT_LT(Clock::now() - begun, options.hold);
    EXPECT_EQ(record.status, RunStatus::alarm);
    EXPECT_THAT(record.message, HasSubstr(name));
    EXPECT_THAT(releases(record), Each(Release::withdrawn));
    EXPECT_TRUE(frames_old());
    EXPECT_EQ(cell->permission, Permission::none);
}

TEST_F(Releasing, AFrameThatIsChangedAsItIsTakenIsAnAlarm) {
    cell->application = false;
    const std::string name = cell->project.regions[0].frame_name;
    int looks = 0;
    cell->on_permission = [&] {
        if (++looks != 3) return;
        cell->frames[name].translation().x() += 0.2;
        cell->permission = Permission::taken;
    };
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::alarm);
    EXPECT_THAT(record.message, HasSubstr("its application runs"));
    EXPECT_THAT(record.message, HasSubstr(name));
    EXPECT_THAT(releases(record), Each(Release::taken));
}

TEST_F(Releasing, FramesThatCannotBeReadFromTheVerdictOnAreNotCalledCorrected) {
    cell->frames_unread_after_verdict = true;
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::alarm);
    EXPECT_THAT(record.message, HasSubstr("cannot be read"));
}

TEST_F(Releasing, CancelledWhileWaitedFor) {
    cell->application = false;
    options.hold = kHoldForEver;
    std::stop_source stop;
    options.cancel = stop.get_token();
    cell->on_permission = [&] { stop.request_stop(); };
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::not_taken);
    EXPECT_THAT(record.message, HasSubstr("cancelled"));
    EXPECT_THAT(releases(record), Each(Release::withdrawn));
    EXPECT_TRUE(frames_old());
}

TEST_F(Releasing, ARobotThatTakesItBackByItselfIsNotReleased) {
    cell->application = false;
    int looks = 0;
    cell->on_permission = [&] {
        if (++looks == 3) cell->permission = Permission::none;
    };
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::not_taken);
    EXPECT_THAT(releases(record), Each(Release::withdrawn));
    EXPECT_TRUE(frames_old());
}

// The application may begin between the last look and the word that it must not.
TEST_F(Releasing, WhoWasQuickerThanTheWithdrawalKeepsItsFrames) {
    cell->application = false;
    options.hold = milliseconds(0);
    int looks = 0;
    cell->on_permission = [&] {
        if (++looks == 3) cell->permission = Permission::taken;  // the first after the verdict `failed`
    };
    cell->deaf_to = PartVerdict::failed;
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::ok);
    EXPECT_FALSE(frames_old());
}

// The controller has it, its answer is lost, and the application runs: frames under it stay.
TEST_F(Releasing, ALostAcknowledgementOfARunningApplicationMovesNoFrame) {
    cell->deaf_to = PartVerdict::corrected;
    cell->deaf_but_obeys = true;
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::ok);
    EXPECT_THAT(releases(record), Each(Release::taken));
    EXPECT_FALSE(frames_old());
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::corrected));
}

TEST_F(Releasing, ARobotThatNeverAnswersIsAnAlarmAndItsFramesStay) {
    cell->application = false;
    cell->deaf_to = PartVerdict::failed;
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::alarm);
    EXPECT_THAT(record.message, HasSubstr("not sure"));
    EXPECT_THAT(releases(record), Each(Release::given));
    EXPECT_FALSE(frames_old());
}

// What a program leaves behind that ended between "pushed" and the outcome.
TEST_F(Releasing, ALeftReleaseIsAskedForAtTheNextConnect) {
    for (const Permission left : {Permission::none, Permission::given, Permission::taken}) {
        SCOPED_TRACE(std::string(to_string(left)));
        make();
        cell->application = false;
        struct Killed {};
        cell->on_permission = [] { throw Killed(); };
        EXPECT_THROW((void)station->run(options), Killed);
        cell->on_permission = nullptr;
        station.reset();
        EXPECT_EQ(in_file(1).status, RunStatus::pushed);
        EXPECT_THAT(releases(in_file(1)), Each(Release::given));
        cell->permission = left;
        station.emplace(*Station::open(path));
        connect();
        const RunRecord after = in_file(1);
        EXPECT_EQ(after.status, left == Permission::taken ? RunStatus::ok : RunStatus::not_taken);
        EXPECT_THAT(releases(after), Each(left == Permission::taken ? Release::taken : Release::withdrawn));
        EXPECT_EQ(cell->permission, left == Permission::taken ? Permission::taken : Permission::none);
        EXPECT_EQ(after.events.back().subject, "run");
    }
}

TEST_F(Releasing, WatchingGoesOnWithTheNextPartWhenNobodyBegan) {
    cell->application = false;
    cell->starts = {StartSignal{"A", 0}};
    int looks = 0;
    cell->on_permission = [&] {
        ++looks;
        if (looks == 20) cell->starts.push_back(StartSignal{"B", 0});
        if (looks > 40 && cell->permission == Permission::given) cell->permission = Permission::taken;
    };
    WatchOptions watching;
    watching.push = true;
    watching.parts = 2;
    const auto counts = watch(*station, watching);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->parts, 2);
    EXPECT_EQ(counts->refused, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_EQ(in_file(1).status, RunStatus::not_taken);
    EXPECT_THAT(in_file(1).message, HasSubstr("next part"));
    EXPECT_EQ(in_file(2).part_id, "B");
    EXPECT_EQ(in_file(2).status, RunStatus::ok);
}

// Every write of a push fails in turn, once or from then on.
#ifdef SEAMWRIGHT_EVERY_WRITE
constexpr bool kEveryWrite = true;
#else
constexpr bool kEveryWrite = false;
#endif

TEST_F(Releasing, FileRobotAndVerdictAgreeWhateverTheDiskDoes) {
    FailingDisk disk;
    const auto operations = [&](FailingDisk::Counts counts) {
        make();
        disk.count(counts);
        EXPECT_EQ(run().status, RunStatus::ok);
        return disk.counted();
    };
    // Every single one where the application begins, every commit where it does not.
    const std::int64_t writes = operations(FailingDisk::Counts::everything),
                       commits = operations(FailingDisk::Counts::syncs);
    ASSERT_GT(writes, commits);
    ASSERT_GT(commits, 5);
    // Every one in the long test, some of them here.
    const std::int64_t stride = kEveryWrite ? 1 : std::max<std::int64_t>(1, writes / 10);
    int released = 0, refused = 0;
    for (const bool begins : {true, false})
        for (const auto fails : {FailingDisk::Fails::once, FailingDisk::Fails::from_then_on})
            for (std::int64_t k = 1; k <= (begins ? writes : commits); k += begins ? stride : 1) {
                SCOPED_TRACE(testing::Message()
                             << "write " << k << (fails == FailingDisk::Fails::once ? " once" : " on")
                             << (begins ? "" : ", the application does not begin"));
                disk.heal();
                make();
                cell->application = begins;
                options.hold = milliseconds(0);
                disk.fail_at(k, fails, begins ? FailingDisk::Counts::everything : FailingDisk::Counts::syncs);
                const auto record = station->run(options);
                disk.heal();
                station.reset();
                const bool ok = record && record->status == RunStatus::ok;
                auto file = ProjectFile::open(path);
                ASSERT_TRUE(file) << file.error().sentence();
                const auto runs = file->runs();
                ASSERT_TRUE(runs);
                const RunStatus stored = runs->empty() ? RunStatus::interrupted : runs->back().status;
                EXPECT_EQ(cell->permission == Permission::taken, ok);
                if (ok) {
                    EXPECT_FALSE(frames_old());
                    // A file that takes nothing more cannot know that the application began; it must not deny
                    // it.
                    EXPECT_TRUE(stored == RunStatus::ok || stored == RunStatus::pushed) << to_string(stored);
                    EXPECT_TRUE(fails == FailingDisk::Fails::from_then_on || stored == RunStatus::ok);
                    ++released;
                } else {
                    EXPECT_TRUE(frames_old());
                    EXPECT_EQ(cell->permission, Permission::none);
                    EXPECT_NE(stored, RunStatus::ok);
                    ++refused;
                }
                for (const Error& finding : file->check()) ADD_FAILURE() << finding.sentence();
            }
    EXPECT_GT(released, 0);
    EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace seamwright
