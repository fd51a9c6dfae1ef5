// A robot that something else moves: where its profiles land, and when the following ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "projects/panel/gap_check.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using SteadyClock = std::chrono::steady_clock;
constexpr double kLengthMm = 40, kSpeedMmS = 80;

// Travels kLengthMm along base's Y at kSpeedMmS and then stands; nothing may move it.
struct OwnTravel {
    SteadyClock::time_point begun = SteadyClock::now();
    double speed_mm_s = kSpeedMmS;
    std::atomic<int> asked_to_move = 0;
    double y() const {
        return std::min(kLengthMm,
                        speed_mm_s * std::chrono::duration<double>(SteadyClock::now() - begun).count());
    }
};
class TravellingRobot : public FakeRobot {
  public:
    TravellingRobot(FakeCell& cell, OwnTravel& travel) : FakeRobot(cell), travel_(travel) {}
    Expected<Pose> base_from_flange() override {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        return make_pose(Eigen::Matrix3d::Identity(), {0, travel_.y(), 0});
    }
    Expected<void> move_to(const Pose&) override {
        ++travel_.asked_to_move;
        return {};
    }

  private:
    OwnTravel& travel_;
};
// Sees a slope: z is the place along the robot's way at the exposure, 10 ms after the trigger.
class SlopeSensor : public FakeSensor {
  public:
    SlopeSensor(FakeCell& cell, OwnTravel& travel) : FakeSensor(cell), travel_(travel) {}
    Expected<FramePtr> wait_next(std::chrono::milliseconds) override {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        auto frame = std::make_shared<Frame>();
        const double z = travel_.y();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        for (int i = 0; i < 200; ++i) {
            frame->profile.x_mm.push_back(0.1 * i);
            frame->profile.z_mm.push_back(z);
        }
        return frame;
    }

  private:
    OwnTravel& travel_;
};

class FollowedPassTest : public testing::Test {
  protected:
    FollowedPassTest() : cell(make_fake_cell()) {
        cell->project.part.base_from_workobject = Pose::Identity();
        cell->project.calibrations.front().flange_from_sensor = Pose::Identity();
        auto file = ProjectFile::create(folder / "follow.seam", cell->project);
        station = std::make_unique<Station>(std::move(*file), cell->project);
        connect();
    }
    void connect() {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        sensors[cell->project.sensors.front().id] = std::make_unique<SlopeSensor>(*cell, travel);
        robots[cell->project.robots.front().id] = std::make_unique<TravellingRobot>(*cell, travel);
        station->connect(std::move(sensors), std::move(robots));
        travel.begun = SteadyClock::now();
    }
    FollowedPass options() const {
        FollowedPass o;
        o.step_mm = 1;
        o.rest_s = 0.3;
        return o;
    }
    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell;
    OwnTravel travel;
    std::unique_ptr<Station> station;
};

TEST_F(FollowedPassTest, EachProfileStandsWhereTheRobotWasWhenItWasExposed) {
    const auto pass = followed_pass(*station, options());
    ASSERT_TRUE(pass) << pass.error().sentence();
    ASSERT_GT(pass->sections.size(), 8U);
    EXPECT_EQ(travel.asked_to_move, 0);
    double worst = 0, reached = 0;
    for (const GapSection& s : pass->sections) {
        ASSERT_GT(s.profile.size(), 0U);
        const double stated = s.frame_from_sensor.translation().y();
        worst = std::max(worst, std::abs(stated - s.profile.z_mm.front()));
        reached = std::max(reached, stated);
    }
    // 20 ms of travel are 1.6 mm; the middle of them is exact, but for what a busy machine sleeps longer.
    EXPECT_LT(worst, 1.5 * kSpeedMmS * 0.02);
    EXPECT_GT(reached, 0.8 * kLengthMm);
    EXPECT_GT(pass->travel_sigma_mm, kSpeedMmS * 0.02 / std::sqrt(12.0) * 0.5);
}

TEST_F(FollowedPassTest, ARobotThatDoesNotMoveAndACancelledPassAreErrors) {
    travel.speed_mm_s = 0;
    FollowedPass o = options();
    o.most_s = 0.2;
    const auto still = followed_pass(*station, o);
    ASSERT_FALSE(still);
    EXPECT_THAT(still.error().sentence(), HasSubstr("did not move"));
    std::stop_source stop;
    o.cancel = stop.get_token();
    stop.request_stop();
    EXPECT_FALSE(followed_pass(*station, o));
    o = options();
    o.step_mm = std::nan("");
    EXPECT_FALSE(followed_pass(*station, o));
    o = options();
    o.sensor_id = "nobody";
    EXPECT_FALSE(followed_pass(*station, o));
}

TEST_F(FollowedPassTest, ARobotThatTheProgramDoesNotMoveIsNotDriven) {
    DrivenGapPass drive;
    drive.stands = {Pose::Identity(), make_pose(Eigen::Matrix3d::Identity(), {0, 10, 0})};
    const auto pass = gap_pass(*station, drive);
    ASSERT_FALSE(pass);
    EXPECT_THAT(pass.error().sentence(), HasSubstr("--follow"));
    EXPECT_EQ(travel.asked_to_move, 0);
    drive.stands.pop_back();
    EXPECT_FALSE(gap_pass(*station, drive));
}

}  // namespace
}  // namespace seamwright
