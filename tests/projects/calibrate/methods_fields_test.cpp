#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// The objects of the data; of a list its first and its last entry.
void objects_of(const json& data, const std::string& at, std::vector<std::string>& pointers) {
    if (data.is_object()) {
        pointers.push_back(at);
        for (const auto& [key, value] : data.items()) objects_of(value, at + "/" + key, pointers);
    } else if (data.is_array() && !data.empty()) {
        for (const std::size_t i : std::set<std::size_t>{0, data.size() - 1})
            objects_of(data[i], at + "/" + std::to_string(i), pointers);
    }
}

class EveryMethodsFields : public testing::TestWithParam<std::string> {
  protected:
    const CalibrationMethod& method_ = *find_method(GetParam());
};

TEST_P(EveryMethodsFields, AMisspeltFieldOfAnyObjectIsRefused) {
    std::vector<std::string> pointers;
    objects_of(method_.example(), "", pointers);
    for (const std::string& at : pointers) {
        json data = method_.example();
        json& object = data[json::json_pointer(at)];
        const std::string misspelt = object.begin().key() + "s";
        object[misspelt] = 1;
        const auto refused = solve_calibration(method_, data, {});
        ASSERT_FALSE(refused) << at;
        EXPECT_EQ(refused.error().kind, ErrorKind::input);
        EXPECT_THAT(refused.error().sentence(), HasSubstr(misspelt)) << at;
        EXPECT_THAT(refused.error().sentence(), HasSubstr("is not a known field")) << at;
    }
}

TEST_P(EveryMethodsFields, ARemarkBesideTheDataIsPassedOver) {
    const auto check = [&](const json& data) {
        const auto fields = check_fields(method_, data);
        return fields ? std::string() : fields.error().sentence();
    };
    json data = method_.example();
    EXPECT_EQ(check(data), "");
    for (const char* remark : {"comment", "note", "made_by", "date", "truth"}) data[remark] = "as measured";
    EXPECT_EQ(check(data), "");
}

// What the layout says can be written.
TEST_P(EveryMethodsFields, TheLayoutNamesEveryFieldButThoseOfAForerunner) {
    for (const DataFields& fields : method_.fields)
        for (const std::string_view key : fields.known) {
            if (key == "plate_from_camera" || key == "not_found" || key == "pattern" || key == "marker_mm" ||
                key == "dictionary" || key == "legacy" || fields.at == "points[].points[]" ||
                fields.at.ends_with("camera") || (method_.id == "plate" && fields.at == "points[]"))
                continue;
            EXPECT_THAT(method_.layout, HasSubstr("\"" + std::string(key) + "\"")) << fields.at;
        }
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethodsFields, testing::ValuesIn([] {
                             std::vector<std::string> ids;
                             for (const CalibrationMethod& m : calibration_methods()) ids.push_back(m.id);
                             return ids;
                         }()),
                         [](const auto& tested) {
                             std::string name = tested.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

struct Misspelt {
    const char *method, *pointer;
    json value;
    const char* meant;
};

class MisspeltField : public testing::TestWithParam<Misspelt> {};

TEST_P(MisspeltField, IsRefusedAndTheRightOneNamed) {
    const Misspelt& one = GetParam();
    const CalibrationMethod& method = *find_method(one.method);
    json data = method.example();
    data[json::json_pointer(one.pointer)] = one.value;
    const auto refused = solve_calibration(method, data, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().mend.english(), HasSubstr(one.meant));
}

INSTANTIATE_TEST_SUITE_P(
    All, MisspeltField,
    testing::Values(Misspelt{"hand-eye", "/robots", {{"sigma_mm", 5}}, "robot"},
                    Misspelt{"hand-eye", "/pairs/0/base_from_flnge", 1, "base_from_flange"},
                    Misspelt{"tcp-sphere", "/nominal", nullptr, "nominal_flange_from_sensor"},
                    Misspelt{"drift", "/limit", {{"translation_mm", 0.001}}, "limits"},
                    Misspelt{"drift", "/limits", {{"translation", 0.001}}, "translation_mm"},
                    Misspelt{"drift", "/robot", {{"sigma_mm", 0.1}, {"sigma", 1}}, "sigma_deg"},
                    Misspelt{"static", "/sensors/0/workingpoint", {0, 0, 300}, "working_point"},
                    Misspelt{"static", "/reference_from_worl", nullptr, "reference_from_world"},
                    Misspelt{"on-part", "/latency_s", 0.004, "latency"},
                    Misspelt{"on-part", "/prior", {{"flange_from_senser", 1}}, "flange_from_sensor"},
                    Misspelt{"nozzle", "/tip_radius", 3, "tip_radius_mm"},
                    Misspelt{"lens", "/ful", true, "full"}, Misspelt{"lut", "/step", 8, "step_px"},
                    Misspelt{"lut", "/robot", {{"sigma_mm", 0.1}, {"lever", 1}}, "lever_mm"},
                    Misspelt{"bundle", "/cameras/0/sights/0/weigth", 5, "weight"},
                    Misspelt{"bundle", "/cameras/0/camera/K1", 0.1, "k1"},
                    Misspelt{"bundle", "/sigma", 0.1, "sigma_px"},
                    Misspelt{"on-part", "/pose_convention", "zyx", "passes"}));

TEST(MisspeltFields, AreRefusedWhereTheConventionIsSought) {
    const CalibrationMethod& method = *find_method("hand-eye");
    json data = method.example();
    data["robots"] = {{"sigma_mm", 5}};
    EXPECT_FALSE(detect_pose_convention(method, data, {}));
}

TEST(Static, NamesTheLinkThatItsLayoutNames) {
    const CalibrationMethod& method = *find_method("static");
    json data = method.example();
    data["sensors"][0].erase("camera_from_plate");
    const auto refused = solve_calibration(method, data, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("sensors[0].camera_from_plate"));
}

}  // namespace
}  // namespace seamwright
