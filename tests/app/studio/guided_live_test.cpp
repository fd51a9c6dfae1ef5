// Guided calibrations whose captures are the live picture's.

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/capture.h"
#include "tests/app/studio/guided.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Every method that captures a picture live: from the first capture over a kill and a bad pose to the stored
// calibration. `column`: of the list, where the bad pose stands out.
struct LiveMethod {
    const char* id;
    int poses, column;
    bool used;
};
class GuidedLive : public Guided, public testing::WithParamInterface<LiveMethod> {
  protected:
    // The session's newest capture once more, with its pose mistyped, or taken over an edge of the plate.
    fs::path bad_entry(const CalibrationSession& s) const {
        json data = s.state().settings, entry = s.state().captures.back().taken->entry;
        if (entry.contains("points")) {  // whose places rest on the pose already
            for (json& p : entry["points"]) p["world"][1] = p["world"][1].get<double>() + 8;
            entry["id"] = "typed";
        } else if (entry.contains("base_from_flange")) {
            Pose pose = parse_pose(entry["base_from_flange"], "base_from_flange").value();
            pose.translation() += Eigen::Vector3d(6, -9, 3);
            entry["base_from_flange"] = pose_json(pose);
            entry["id"] = "typed";
        } else if (entry.is_object()) {
            entry["pixel"][1] = entry["pixel"][1].get<double>() + 12;  // on the flank beside the apex
            entry["id"] = "typed";
        } else {
            for (std::size_t i = entry.size() / 2; i < entry.size(); ++i)
                entry[i][1] = entry[i][1].get<double>() + 25;
        }
        data[s.method().entries] = json::array({entry});
        const fs::path path = folder / "bad.json";
        std::ofstream(path) << data;
        return path;
    }
};

TEST_P(GuidedLive, FromTheFirstCaptureToTheStoredCalibration) {
    const auto& [method, poses_of, column, used] = GetParam();
    const int poses = poses_of;
    make_project();
    capture_until_killed(method, 3);
    ASSERT_FALSE(HasFailure());
    Studio studio(*qApp, options());
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();
    me.step(2);
    EXPECT_EQ(me.find<QPushButton>(QString("begin_") + method)->text(), "Go on");
    go_to_page(me, desk, method);
    ASSERT_GE(captures(me), 3) << "what was captured before the kill is there";
    me.click("calibration_set_target");
    for (int i = captures(me); i < poses; ++i) {
        capture(me, desk);
        ASSERT_FALSE(HasFailure());
    }
    ASSERT_TRUE(solved(me, window));

    // One more, which comes back from a file with its pose mistyped.
    capture(me, desk);
    ASSERT_FALSE(HasFailure());
    const auto session =
        CalibrationSession::open(file, MethodId(method), SensorId("A"), RobotId("R1")).value();
    me.find<QTableWidget>("captures")->setCurrentCell(poses, 0);
    me.click("calibration_remove");
    ASSERT_TRUE(me.wait([&] { return captures(me) == poses; }));
    me.answer_file_dialog(QString::fromStdString(bad_entry(session).string()));
    me.click("calibration_load");
    ASSERT_TRUE(me.wait([&] { return captures(me) == poses + 1; }))
        << me.text_of("calibration_said").toStdString();
    ASSERT_TRUE(solved(me, window));
    me.picture(QString("guided_%1_bad").arg(method));
    auto* table = me.find<QTableWidget>("captures");
    const int worst = worst_row(*table, column);
    EXPECT_EQ(worst, poses);
    EXPECT_TRUE(table->item(worst, 4)->text() == "contradicts the others" ||
                table->item(worst, 4)->text() == "stands out")
        << table->item(worst, 4)->text().toStdString();
    press_space(me, table, worst);
    ASSERT_TRUE(me.wait([&] { return table->item(worst, 4)->text() == "left out"; }));
    ASSERT_TRUE(solved(me, window));

    EXPECT_FALSE(me.find<QPushButton>(used ? "calibration_use" : "calibration_keep")->isEnabled());
    capture(me, desk, "calibration_verify");
    ASSERT_TRUE(solved(me, window));
    me.picture(QString("guided_%1").arg(method));
    const QString verdict = me.text_of("calibration_verdict");
    EXPECT_TRUE(verdict == "good" || verdict == "usable") << me.text_of("calibration_reason").toStdString();
    EXPECT_TRUE(me.text_of("calibration_verified").startsWith("confirmed"))
        << me.text_of("calibration_verified").toStdString();
    me.click(used ? "calibration_use" : "calibration_keep");
    ASSERT_EQ(desk.project().calibrations.size(), 2U) << window_text(me);
    const Calibration& made = desk.project().calibrations.back();
    EXPECT_EQ(made.method, method);
    EXPECT_EQ(desk.project().sensors.at(0).calibration_id == made.id, used);
    if (used) {
        EXPECT_LT(difference(made, desk.project().calibrations.front()).largest_mm, 1.0)
            << "over the whole field";
    }
    me.click("calibration_back");
}
INSTANTIATE_TEST_SUITE_P(Methods, GuidedLive,
                         testing::Values(LiveMethod{"stripe-camera", 10, 1, true},
                                         LiveMethod{"hand-eye", 8, 1, true}, LiveMethod{"lens", 9, 3, false},
                                         LiveMethod{"laser-plane", 10, 3, true},
                                         LiveMethod{"lut", 23, 1, true}, LiveMethod{"plate", 6, 1, false}),
                         [](const auto& one) {
                             std::string name = one.param.id;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace seamwright
