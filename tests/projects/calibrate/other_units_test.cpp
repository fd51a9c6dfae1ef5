#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/other_units.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// Every "abc" of these poses in radians, every "xyz" times `factor`.
void rewrite(json& value, const std::string& key, bool radians, double factor, bool inside = false) {
    if (value.is_array())
        for (json& one : value) rewrite(one, key, radians, factor, inside);
    if (!value.is_object()) return;
    if (inside && value.contains("abc")) {
        value.erase("matrix");
        if (radians)
            for (json& angle : value["abc"]) angle = angle.get<double>() * kPi / 180;
        for (json& length : value["xyz"]) length = length.get<double>() * factor;
        return;
    }
    for (auto& [name, part] : value.items()) rewrite(part, key, radians, factor, inside || name == key);
}

void scale(json& value, double factor) {
    if (value.is_number()) value = value.get<double>() * factor;
    if (value.is_array())
        for (json& one : value) scale(one, factor);
}

void scale_lengths(json& value, const std::string& key, double factor) {
    if (value.is_array())
        for (json& one : value) scale_lengths(one, key, factor);
    if (!value.is_object()) return;
    for (auto& [name, part] : value.items())
        if (name == key)
            scale(part, factor);
        else
            scale_lengths(part, key, factor);
}

// What the answer, or the refusal, says to do.
std::string cure(const char* id, const json& data) {
    const auto solution = solve_calibration(*find_method(id), data, {});
    if (!solution) return solution.error().sentence();
    EXPECT_FALSE(serves(solution->verdict())) << id;
    EXPECT_EQ(solution->document["cure"], solution->report.judgement.cure.english());
    return solution->report.judgement.cure.english();
}

TEST(OtherUnits, AnglesInRadiansAreNamedByEveryMethodThatTakesRobotPoses) {
    for (const char* id : {"hand-eye", "tcp-sphere", "drift", "stripe-camera", "on-part", "nozzle"}) {
        json data = find_method(id)->example();
        rewrite(data, "base_from_flange", true, 1);
        EXPECT_THAT(cure(id, data), HasSubstr("the angles of base_from_flange are radians")) << id;
    }
}

TEST(OtherUnits, LengthsOfRobotPosesInInchesAreNamed) {
    for (const char* id : {"hand-eye", "tcp-sphere", "drift", "stripe-camera", "on-part", "nozzle"}) {
        json data = find_method(id)->example();
        rewrite(data, "base_from_flange", false, 1 / 25.4);
        EXPECT_THAT(cure(id, data), HasSubstr("the lengths of base_from_flange are inches")) << id;
    }
}

TEST(OtherUnits, LengthsThatTheSensorGaveAreNamed) {
    struct {
        const char *id, *key;
    } methods[] = {{"tcp-sphere", "profile"}, {"drift", "profile"}, {"on-part", "point"}};
    for (const auto& [id, key] : methods)
        for (const auto& [factor, unit] :
             {std::pair{0.001, "metres"}, {1000.0, "micrometres"}, {1 / 25.4, "inches"}}) {
            json data = find_method(id)->example();
            scale_lengths(data, key, factor);
            const std::string said = cure(id, data);
            EXPECT_THAT(said, HasSubstr(unit)) << id;
            if (std::string(id) != "tcp-sphere" || std::string(unit) != "metres")  // told by its own check
                EXPECT_THAT(said, HasSubstr(key)) << id;
        }
}

TEST(OtherUnits, PlacesOfTwoCamerasInMetresAreNamed) {
    json data = find_method("stereo")->example();
    rewrite(data, "world_from_camera", false, 0.001);
    EXPECT_THAT(cure("stereo", data), HasSubstr("look like metres"));
}

// Small angles are not taken for radians: what serves as it is written is left as it is, and what does not serve for another
// reason is told that reason.
TEST(OtherUnits, SmallAnglesAreNoRadians) {
    EXPECT_TRUE(may_be_radians({Pose::Identity(), make_pose(rotation_exp({0.01, 0.02, 0}), {900, 0, 0})}));
    json data = find_method("tcp-sphere")->example();
    for (json& o : data["observations"]) {
        json& pose = o["base_from_flange"];
        pose.erase("matrix");
        for (json& angle : pose["abc"]) angle = 0.5;
    }
    EXPECT_THAT(cure("tcp-sphere", data), Not(HasSubstr("radians")));
}

TEST(OtherUnits, AStaticChainIsAskedForItsAngles) {
    const auto notices = [](const json& data) {
        const auto solution = solve_calibration(*find_method("static"), data, {});
        EXPECT_TRUE(solution);
        return solution ? solution->document["notices"].dump() : "";
    };
    json data = find_method("static")->example();
    EXPECT_THAT(notices(data), Not(HasSubstr("radians")));
    rewrite(data, "camera_from_laser", true, 1);
    EXPECT_THAT(notices(data), HasSubstr("no angle of camera_from_laser"));
}

TEST(Drift, PosesInAnotherConventionAreSuspected) {
    json data = find_method("drift")->example();
    for (json& o : data["observations"]) {
        json& pose = o["base_from_flange"];
        pose.erase("matrix");
        std::swap(pose["abc"][0], pose["abc"][2]);
    }
    EXPECT_THAT(cure("drift", data), HasSubstr("convention"));
}

// A few poses that went to the wrong frame are named; the board's pitch is not blamed.
TEST(StripeCamera, ExchangedRobotPosesAreNamed) {
    const json good = find_method("stripe-camera")->example();
    const auto pose = [](json& data, std::size_t i) -> json& {
        return data["frames"][i]["base_from_flange"];
    };
    const auto notes = [](const json& data) {
        const auto solution = solve_calibration(*find_method("stripe-camera"), data, {});
        EXPECT_TRUE(solution) << (solution ? "" : solution.error().sentence());
        std::vector<std::string> ids;
        if (!solution) return ids;
        for (const json& frame : solution->document["frames"])
            if (frame.contains("note") && frame["note"].dump().find("contradicts") != std::string::npos)
                ids.push_back(frame["id"]);
        return ids;
    };
    EXPECT_THAT(notes(good), testing::IsEmpty());
    for (const auto& [i, k] : {std::pair<std::size_t, std::size_t>{0, 1}, {5, 6}}) {
        json data = good;
        std::swap(pose(data, i), pose(data, k));
        EXPECT_THAT(notes(data), testing::ElementsAre(good["frames"][i]["id"], good["frames"][k]["id"]))
            << i << " " << k;
    }
    json copied = good;
    pose(copied, 3) = pose(copied, 8);
    EXPECT_THAT(notes(copied), testing::ElementsAre(good["frames"][3]["id"]));
}

// A sigma whose square is no number any more would make every answer sure.
TEST(Sigmas, AreBoundedWhereTheDataAreRead) {
    struct {
        const char *id, *pointer;
    } sigmas[] = {{"plate", "/sigma_mm"},
                  {"nozzle", "/target/sigma_mm"},
                  {"nozzle", "/sigma_mm"},
                  {"hand-eye", "/robot/sigma_mm"},
                  {"drift", "/other_sigma_mm"},
                  {"drift", "/radius_mm"},
                  {"drift", "/covariance/2/2"},
                  {"tcp-sphere", "/radius_mm"},
                  {"static", "/sensors/0/world_from_plate/sigma_mm"},
                  {"static", "/sensors/0/world_from_plate/sigma_deg"},
                  {"stereo", "/sigma_px"},
                  {"stereo", "/cameras/0/world_from_camera/sigma_mm"},
                  {"bundle", "/sigma_px"},
                  {"bundle", "/cameras/0/sights/0/weight"},
                  {"bundle", "/cameras/0/world_from_camera/sigma_mm"}};
    for (const auto& [id, pointer] : sigmas)
        for (const double value : {1e300, -1.0}) {
            json data = find_method(id)->example();
            data[json::json_pointer(pointer)] = value;
            const auto refused = solve_calibration(*find_method(id), data, {});
            ASSERT_FALSE(refused) << id << pointer << " " << value;
            EXPECT_LT(refused.error().sentence().size(), 220u) << refused.error().sentence();
        }
    json plate = find_method("plate")->example();
    plate["sigma_mm"] = 0;
    const auto refused = solve_calibration(*find_method("plate"), plate, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("sigma_mm: the sigma is not above 0"));
}

}  // namespace
}  // namespace seamwright
