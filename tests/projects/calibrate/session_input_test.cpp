// A session whose devices are renamed, and what is loaded into it from files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "projects/calibrate/session/shot.h"
#include "session_case.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// Captures stay those of their sensor and robot whatever these are called, also where the project has not kept the new name.
TEST_F(Session, ARenamedDeviceKeepsItsCaptures) {
    const MethodId method("tcp-sphere");
    const auto count = [&](const char* sensor, const char* robot, const std::vector<std::string>& robots,
                           const std::vector<std::string>& sensors) {
        return CalibrationSession::open(project, method, SensorId(sensor), RobotId(robot), robots, sensors)
            .value()
            .state()
            .captures.size();
    };
    CalibrationSession first = open();
    capture(first, 2);
    ASSERT_TRUE(CalibrationSession::rename_sensor(project, "A", "left", {"B"}));
    ASSERT_TRUE(CalibrationSession::rename_robot(project, "R1", "big"));
    EXPECT_TRUE(CalibrationSession::exists(project, method, SensorId("left"), {"B", "left"}));
    EXPECT_EQ(count("left", "big", {"big", "R1"}, {"B", "left"}), 2U) << "another robot is called R1 now";
    EXPECT_EQ(count("A", "big", {"big"}, {"A", "B", "left"}), 0U) << "another sensor is called A now";
    EXPECT_FALSE(CalibrationSession::exists(project, method, SensorId("A"), {"A", "left"}));
    // Closed without saving: the sensor is A again.
    EXPECT_TRUE(CalibrationSession::exists(project, method, SensorId("A"), {"A", "B"}));
    EXPECT_EQ(count("A", "R1", {"R1"}, {"A", "B"}), 2U);
    // Renamed once more from there, and back.
    ASSERT_TRUE(CalibrationSession::rename_sensor(project, "A", "right", {"B"}));
    EXPECT_EQ(count("right", "R1", {"R1"}, {"B", "right"}), 2U);
    ASSERT_TRUE(CalibrationSession::rename_sensor(project, "right", "A", {"B"}));
    EXPECT_EQ(count("A", "R1", {"R1"}, {"A", "B"}), 2U);
    // What a sensor of that name has left that is gone is nobody's, and stays on disk.
    auto gone =
        CalibrationSession::open(project, method, SensorId("left"), RobotId("R1"), {"R1"}, {"A", "left"});
    ASSERT_TRUE(gone);
    ASSERT_EQ(gone->state().captures.size(), 0U);
    capture(*gone, 1);
    ASSERT_TRUE(CalibrationSession::rename_sensor(project, "A", "left", {}));
    EXPECT_EQ(count("left", "R1", {"R1"}, {"left"}), 2U);
    int folders = 0;
    for (const auto& one : fs::directory_iterator(CalibrationSession::folder_of(project)))
        folders += fs::exists(one.path() / "session.json");
    EXPECT_EQ(folders, 2);
}

TEST_F(Session, ASensorThatIsGoneWhenItsPictureComesIsNamed) {
    const CalibrationSession s = open();
    CalibrationShot shot;
    shot.sensor_id = "A";
    const ShotCaptures taken = captures_of_shots(s, Project{}, s.state().settings, {shot}, {});
    EXPECT_TRUE(taken.captures.empty());
    ASSERT_EQ(taken.refusals.size(), 1U);
    EXPECT_THAT(taken.refusals[0].sentence(), HasSubstr("sensor A"));
}

// A file is taken whole or not at all, and nothing twice.
TEST_F(Session, AFileWithSomethingUnreadableIsRefusedWhereItIsWrong) {
    const CalibrationMethod& method = *find_method("tcp-sphere");
    const json good = method.example();
    const auto read = [&](const json& data) {
        const fs::path path = folder / "data.json";
        std::ofstream(path) << data;
        return read_captures(method, default_settings(method), nullptr, path, {}, {});
    };
    const auto refused = [&](const char* pointer, const json& wrong, const char* words) {
        json data = good;
        data[json::json_pointer(pointer)] = wrong;
        const auto result = read(data);
        ASSERT_FALSE(result) << pointer;
        EXPECT_THAT(result.error().sentence(), testing::AllOf(HasSubstr("data.json"), HasSubstr(words)));
    };
    refused("/observations", json::array(), "observations");
    refused("/observations/3", "abc", "observations[3]");
    refused("/observations/3/profile/1/0", "1,5", "observations[3].profile[1]");
    refused("/observations/3/profile", nullptr, "observations[3].profile");
    refused("/radius_mm", "abc", "radius_mm");
    // Too few is the session's to say: there may be others.
    json few = good;
    few["observations"] = json::array({good["observations"][0]});
    const auto one = read(few);
    ASSERT_TRUE(one) << one.error().sentence();
    EXPECT_EQ(one->captures.size(), 1U);

    CalibrationSession s = open();
    const auto all = read(good);
    ASSERT_TRUE(all) << all.error().sentence();
    ASSERT_TRUE(add_captures(s, all->captures, all->settings, false));
    const SessionState before = s.state();
    const auto again = add_captures(s, all->captures, all->settings, false);
    ASSERT_FALSE(again) << "counted twice, they would be thought surer than they are";
    EXPECT_THAT(again.error().sentence(), HasSubstr("in the list already"));
    EXPECT_EQ(s.state(), before);
    // What was taken off the list may come back.
    ASSERT_TRUE(s.remove(s.state().captures.front().taken->id));
    EXPECT_FALSE(add_captures(s, all->captures, all->settings, false));
    EXPECT_EQ(s.state().captures.size(), before.captures.size());
}

}  // namespace
}  // namespace seamwright
