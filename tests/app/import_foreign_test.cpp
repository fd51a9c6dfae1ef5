// What a stranger's files and options leave open is asked for, and what was passed over is told.
#include "devices/exchange/pose_json.h"
#include "tests/app/import_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string metres(const Pose& pose) {
    Pose p = pose;
    p.translation() /= 1000;
    json j = pose_json(p);
    j.erase("matrix");
    return j.dump();
}

TEST_F(Import, PlacesInMetresAreAskedFor) {
    record([](const auto& p) { return "X,Z\n" + rows_of(p, ","); }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const Pose far = make_pose(Eigen::Matrix3d::Identity(), {900, 20, 300});
    const std::string sensor = metres(cell.flange_from_sensor);
    expect_refused(job("a", {"--set", "side=right", "--flange-from-sensor", sensor}),
                   "--flange-from-sensor: no coordinate is longer than 0.12 mm, which looks like metres");
    for (const char* option : {"--base-from-workobject", "--flange-from-tool", "--base-from-user-frame"})
        expect_refused(edge_job("a", {option, metres(option[2] == 'f' ? cell.flange_from_sensor : far)}),
                       "which looks like metres");
    // A changer's plate; and the answer of a calibration as it is.
    EXPECT_EQ(run(edge_job("thin", {"--flange-from-tool", R"({"xyz":[0,0,8],"abc":[0,0,0]})"})).exit_code, 0);
    const std::string solved =
        write("solved.json",
              json{{"status", "ok"}, {"flange_from_sensor", pose_json(cell.flange_from_sensor)}}.dump());
    EXPECT_EQ(run(job("door", {"--set", "side=right", "--flange-from-sensor", solved})).exit_code, 0);
    expect_motion("door", 0.1);
}

TEST_F(Import, FramesOfAnotherKindAreNotPassedOver) {
    record([](const auto& p) { return "X,Z\n" + rows_of(p, ","); }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    std::filesystem::rename(folder / "car/scan_8.csv", folder / "car/scan_8.xyz");
    expect_refused(edge_job("a", {}), "holds csv frames beside scan_8.xyz");
    expect_refused(edge_job("a", {}, "nowhere.csv"), "does not exist", 3);
    write("scan.docx", "x");
    expect_refused(edge_job("a", {}, "scan.docx"), "is neither a folder nor a file of profiles", 3);
}

}  // namespace
}  // namespace seamwright
