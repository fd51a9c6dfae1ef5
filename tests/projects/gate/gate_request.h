#pragma once
// A correction that the gate lets pass: what its tests spoil.

#include <cmath>
#include <limits>

#include "projects/gate/safety_gate.h"

namespace seamwright {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline Pose some_pose(double seed) {
    return make_pose(rotation_exp(Eigen::Vector3d(0.3 * seed, -0.2, 0.5 / seed)),
                     Eigen::Vector3d(900 * seed, -300, 450));
}

inline GateRequest good_request() {
    GateRequest r;
    r.region.id = "edge";
    r.region.spot_ids = {"S1", "S2", "S3"};
    r.region.frame_name = "BASE[3]";
    r.region.base_from_frame = some_pose(1);
    r.base_from_workobject = some_pose(2);
    r.correction.status = CorrectionStatus::ok;
    r.correction.displacement.workobject_from_movedworkobject =
        make_pose(rotation_exp(Eigen::Vector3d(0.004, -0.006, 0.008)), Eigen::Vector3d(3, -4, 5));
    r.correction.covariance.diagonal() << 1e-4, 1e-4, 4e-4, 1e-9, 1e-9, 1e-9;
    r.correction.sigma_xyz_mm = {0.01, 0.01, 0.02};
    r.correction.sigma_abc_deg.setConstant(deg_from_rad(std::sqrt(1e-9)));
    for (const char* id : {"S1", "S2", "S3"}) {
        GateSpot s;
        s.id = id;
        s.measured = true;
        s.part_id = "car 1";
        s.measured_at_ns = 150;
        s.calibration_id = "C1";
        s.calibration_verdict = Verdict::good;
        s.calibrated_utc = "2026-01-31T12:00:00.000Z";
        s.sensor = s.calibrated_sensor = {"simulated", "V", "M", "001"};
        s.robot = s.calibrated_robot = {"simulated", "KUKA", "KR", "002"};
        r.spots.push_back(s);
    }
    r.part_id = "car 1";
    r.part_since_ns = 100;
    r.now_ns = 200;
    r.mode = RobotMode::external;
    r.required_mode = RobotMode::external;
    r.now_utc = "2026-11-22T12:00:00.000Z";
    r.base_from_frame_now = r.region.base_from_frame;
    return r;
}

}  // namespace seamwright
