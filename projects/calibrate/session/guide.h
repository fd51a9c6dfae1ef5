#pragma once
// Leading a person through a session: which pose to take next, and how field of view and orientations are
// covered.

#include "projects/calibrate/session/session.h"

namespace seamwright {

struct NextPose {
    Pose base_from_flange = Pose::Identity();
    bool by_solver = false;  // chosen for what it adds to the solution; else the next of the method's views
};

// Relative to the first capture, which the person has jogged to. `flange_from_sensor`: the mounting as far as
// it is known, from the calibration in use or a drawing; the solved one is taken where there is one. nullopt:
// before the first capture, while the mounting is not known (a turn of the flange would lose the target),
// where the method takes no poses, or when all its views were taken and the solver asks for nothing.
std::optional<NextPose> next_pose(const CalibrationSession& session,
                                  const std::optional<Pose>& flange_from_sensor);

// All that are left as of now, in their order; what the solver asks for changes with every capture.
std::vector<NextPose> next_poses(const CalibrationSession& session,
                                 const std::optional<Pose>& flange_from_sensor);

// Where a simulated robot has its target in view: the first capture's place. nullopt: the method needs no
// target, the settings are not those of a simulated cell.
struct SimulatedStart {
    Pose base_from_flange = Pose::Identity();
    std::string scene;  // of the simulated sensor's parameter "scene"
};
std::optional<SimulatedStart> simulated_start(const CalibrationMethod& method,
                                              const nlohmann::json& cell_settings);

// Where the robot is to go for the next capture: next_pose(), and before the first one where a simulated cell has its
// target.
std::optional<Pose> next_place(const CalibrationSession& session, const Project& project);

// Where no pose is left, what can be kept back for verification: the newest captures, until `wanted` are, as long as
// enough remain to solve with.
std::vector<std::string> to_keep_back(const CalibrationSession& session, int wanted);

// One capture in the picture of orientations: how far the sight line is tilted against the first capture's,
// and the turn about it.
struct ViewMark {
    std::string id;
    Eigen::Vector2d tilt_deg = Eigen::Vector2d::Zero();  // about the first sensor's X and Y
    double turn_deg = 0;
    bool used = true;
};
std::vector<ViewMark> view_marks(const CalibrationSession& session, const Pose& flange_from_sensor);
// The same of a pose that is not taken yet; nullopt before the first capture.
std::optional<ViewMark> view_mark(const CalibrationSession& session, const Pose& flange_from_sensor,
                                  const Pose& base_from_flange);

}  // namespace seamwright
