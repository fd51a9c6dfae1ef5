// The one shot of a gripper as a session: every sensor's chain, its tick, its name.

#include <gmock/gmock.h>

#include <fstream>

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/answer.h"
#include "session_case.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// A chain each of the sensors A and B.
class OneShot : public Session {
  protected:
    const Pose at_A = make_pose(rotation_exp({0.1, 0.2, -0.3}), {120, -40, 90}),
               at_B = make_pose(rotation_exp({-0.2, 0.1, 0.6}), {-110, 35, 95});
    static json link(const Pose& pose, double sigma_mm) {
        return {{"pose", pose_json(pose)}, {"sigma_mm", sigma_mm}, {"sigma_deg", 0.001}};
    }
    // Ends at `mounting` on a flange that is the reference.
    json chain(const std::string& id, const Pose& mounting, double sigma_mm) const {
        const Pose plate = make_pose(rotation_exp({0.3, -0.1, 0.2}), {900, 100, 400});
        const Pose laser = model(id).camera_from_laser;
        return {{"id", id},
                {"world_from_plate", link(plate, sigma_mm)},
                {"plate_from_camera", link(plate.inverse() * mounting * laser.inverse(), sigma_mm)},
                {"camera_from_laser", link(laser, sigma_mm)}};
    }
    SensorModel model(const std::string& id) const {
        SensorModel m = cell->sensor_model();
        if (id == "B") m.camera_from_laser.translation().x() += 3;
        return m;
    }
    fs::path file(const json& chains) const {
        const fs::path path = folder / "chains.json";
        std::ofstream(path) << json{{"reference_from_world", pose_json(Pose::Identity())},
                                    {"sensors", chains}};
        return path;
    }
    json both() const { return {chain("A", at_A, 0.01), chain("B", at_B, 0.02)}; }
    static Expected<std::string> load(CalibrationSession& s, const fs::path& path) {
        auto read = read_captures(s.method(), s.state().settings, nullptr, path, {}, {});
        if (!read) return tl::unexpected(read.error());
        if (auto ok = s.set_settings(read->settings); !ok) return tl::unexpected(ok.error());
        std::string ids;
        for (CalibrationCapture& c : read->captures) {
            auto id = s.add(std::move(c));
            if (!id) return id;
            ids += *id + " ";
        }
        return ids;
    }
    Project two_sensors() const {
        Project p;
        RobotSetup robot;
        robot.id = "R1";
        robot.identity.model = "gripper robot";
        p.robots = {robot};
        for (const char* id : {"A", "B"}) {
            SensorSetup one;
            one.id = id;
            one.driver = "simulated";
            one.identity.serial = std::string("serial of ") + id;
            one.calibration_id = std::string("before-") + id;
            p.sensors.push_back(one);
            Calibration c;
            c.id = one.calibration_id;
            c.sensor_id = id;
            c.model = model(id);
            p.calibrations.push_back(c);
        }
        return p;
    }
};

TEST_F(OneShot, CalibratesEverySensorWithItsOwn) {
    CalibrationSession s = open("static");
    ASSERT_EQ(load(s, file(both())), "A B ");
    solve(s);
    EXPECT_EQ(s.stage(), SessionStage::use);
    Project p = two_sensors();
    p.calibrations.back().id = "static-3";  // taken
    p.sensors[1].calibration_id = "static-3";
    const auto made = calibrations_of_session(s, p);
    ASSERT_TRUE(made) << made.error().sentence();
    ASSERT_EQ(made->size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        const Calibration& c = made->at(i);
        const std::string id = i == 0 ? "A" : "B";
        EXPECT_EQ(c.id, i == 0 ? "static-4" : "static-5");
        EXPECT_EQ(c.sensor_id, id);
        EXPECT_EQ(c.sensor_identity.serial, "serial of " + id);
        EXPECT_EQ(c.robot_id, "R1");
        EXPECT_EQ(c.robot_identity.model, "gripper robot");
        ASSERT_TRUE(c.model);
        EXPECT_TRUE(c.model->camera_from_laser.isApprox(model(id).camera_from_laser));
        EXPECT_LT(distance_mm(c.flange_from_sensor, i == 0 ? at_A : at_B), 1e-6);
        EXPECT_LT(angle_rad(c.flange_from_sensor, i == 0 ? at_A : at_B), 1e-6);
        EXPECT_THAT(c.result["reason"].get<std::string>(), HasSubstr("sensor " + id));
        // Solved again from what is kept with it: the same, and nothing of the other.
        const auto again = solve_calibration(s.method(), c.raw["data"], c.raw["exclude"]);
        ASSERT_TRUE(again) << again.error().sentence();
        EXPECT_EQ(again->document["sensors"], c.result["sensors"]);
        EXPECT_EQ(c.result["sensors"].size(), 1U);
    }
    EXPECT_GT(made->at(1).covariance(0, 0), 2 * made->at(0).covariance(0, 0));
    ASSERT_TRUE(s.set_used_as({"static-4", "static-5"}));
    EXPECT_EQ(open("static").used_as(), (std::vector<std::string>{"static-4", "static-5"}));
}

TEST_F(OneShot, TheTickLeavesASensorOut) {
    CalibrationSession s = open("static");
    ASSERT_TRUE(load(s, file(both())));
    ASSERT_TRUE(s.leave_out("A", true));
    solve(s);
    const auto made = calibrations_of_session(s, two_sensors());
    ASSERT_TRUE(made) << made.error().sentence();
    ASSERT_EQ(made->size(), 1U) << "though the session is A's";
    EXPECT_EQ(made->front().sensor_id, "B");
}

TEST_F(OneShot, ASensorThatTheProjectDoesNotKnowIsNamed) {
    CalibrationSession s = open("static");
    json chains = both();
    chains.push_back(chain("left door", at_B, 0.01));
    ASSERT_TRUE(load(s, file(chains)));
    solve(s);
    const auto made = calibrations_of_session(s, two_sensors());
    ASSERT_FALSE(made) << "not even those that are known";
    EXPECT_THAT(made.error().sentence(), HasSubstr("left door"));
    ASSERT_TRUE(s.leave_out("left door", true));
    solve(s);
    EXPECT_EQ(calibrations_of_session(s, two_sensors())->size(), 2U);
}

TEST_F(OneShot, ANewChainTakesThePlaceOfTheSensorsOldOne) {
    CalibrationSession s = open("static");
    ASSERT_TRUE(load(s, file(both())));
    solve(s);
    const SessionState before = s.state();
    ASSERT_EQ(load(s, file(json::array({chain("A", at_B, 0.01)}))), "A-2 ");
    ASSERT_EQ(s.state().captures.size(), 2U);
    solve(s);
    const auto made = calibrations_of_session(s, two_sensors());
    ASSERT_TRUE(made) << made.error().sentence();
    ASSERT_EQ(made->size(), 2U);
    EXPECT_EQ(made->at(1).sensor_id, "A");
    EXPECT_LT(distance_mm(made->at(1).flange_from_sensor, at_B), 1e-6);
    ASSERT_TRUE(s.set_state(before));
    solve(s);
    EXPECT_LT(distance_mm(calibrations_of_session(s, two_sensors())->at(0).flange_from_sensor, at_A), 1e-6);
}

TEST_F(OneShot, AChainWithoutANameIsOfTheSessionsSensor) {
    CalibrationSession s = open("static");
    json data = chain("", at_A, 0.01);
    data.erase("id");
    data["reference_from_world"] = pose_json(Pose::Identity());
    const fs::path path = folder / "one.json";
    std::ofstream(path) << data;
    ASSERT_TRUE(load(s, path));
    solve(s);
    const auto made = calibrations_of_session(s, two_sensors());
    ASSERT_TRUE(made) << made.error().sentence();
    EXPECT_EQ(made->at(0).sensor_id, "A");
    const auto twice = load(s, file(json::array({chain("B", at_A, 0.01), chain("B", at_B, 0.01)})));
    ASSERT_FALSE(twice);
    EXPECT_THAT(twice.error().sentence(), HasSubstr("'B' occurs twice"));
}

TEST_F(OneShot, ASessionOfTheFirstVersionIsRead) {
    CalibrationSession s = open("static");
    ASSERT_TRUE(load(s, file(both())));
    const fs::path list = s.folder() / "session.json";
    json data = json::parse(std::ifstream(list));
    data["version"] = 1;
    data["used_as"] = "static-7";
    std::ofstream(list) << data;
    EXPECT_EQ(open("static").used_as(), std::vector<std::string>{"static-7"});
    data["used_as"] = "";
    std::ofstream(list) << data;
    EXPECT_TRUE(open("static").used_as().empty());
}

}  // namespace
}  // namespace seamwright
