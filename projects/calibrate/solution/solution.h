#pragma once
// What a calibration answers: the report that every method gives, and what it found, typed. Its document is
// the same as others read it: printed by `seamwright calibrate`, kept in sessions and projects.
//
// Every document holds "method", "status", "verdict" (good | usable | poor | undetermined), "reason", "cure", and of the
// report (core/calibration/calibration.h) "parameters" [{"name","value","unit","sigma"}], "covariance" (their
// order and units), "correlations" [{"first","second","correlation"}], "per_pose"
// [{"id","rms_mm","deg","rms_px","used","contradicts","note"}] and "hold_out"
// {"folds","left_out","rms_mm","max_mm","rms_deg","rms_px"}. A number that does not exist is null; numbers of
// an undetermined answer are null. Poses are written as by pose_json(). "notices" are sentences worth a look.
// What a method adds stands at the head of its file.

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/field_scale.h"
#include "core/calibration/pose/static_chain.h"
#include "core/calibration/sphere/tcp_sphere.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

// Where the sensor (the camera, the laser plane) sits on the flange. Covariance: tangent of pose.h.
struct SensorOnFlange {
    UncertainPose flange_from_sensor;
};
struct CameraOnFlange {
    UncertainPose flange_from_camera;
};
// The camera stands beside the robot and looks at it.
struct CameraBesideRobot {
    UncertainPose base_from_camera;
};
// A camera and, where the data show it, its laser plane and its place on the flange.
struct CameraAndLaser {
    CameraModel camera;
    std::optional<Pose> camera_from_laser;
    std::optional<UncertainPose> flange_from_camera;
};
struct PixelTable {
    LookupTable table;
};
struct PlateInWorld {
    UncertainPose world_from_plate;
};
// Where the nozzle's tip is (core/calibration/nozzle/nozzle.h). `degrees`: of freedom of the covariance, infinite when it
// is stated. `off_programmed_mm`: off the programmed tool, where that is beyond chance; else 0.
struct NozzleOnFlange {
    UncertainPose flange_from_nozzle;
    double degrees = std::numeric_limits<double>::infinity();
    double off_programmed_mm = 0;
};
// One a sensor; without `reference_from_laser` the chain ends in the world, not on the flange.
struct SensorChains {
    struct Chain {
        std::string id;
        std::optional<UncertainPose> reference_from_laser;
        Judgement judgement;
    };
    std::vector<Chain> chains;
};
// monostate: nothing that another step takes over (a lens, a check, an undetermined answer).
using CalibrationFinding =
    std::variant<std::monostate, SensorOnFlange, CameraOnFlange, CameraBesideRobot, CameraAndLaser,
                 PixelTable, PlateInWorld, NozzleOnFlange, SensorChains>;

struct CalibrationSolution {
    CalibrationReport report;  // its judgement is the answer's verdict
    CalibrationFinding found;
    std::optional<FieldScale> scale;      // of the sensor's own millimetres, where the method tells
    std::vector<Text> notices;            // sentences worth a look
    std::vector<Text> degenerate;         // what the poses leave open
    std::vector<PoseProposal> proposals;  // poses that would help most, best first
    nlohmann::json document;

    Verdict verdict() const { return report.judgement.verdict; }
};

// The document again as an answer. Its finding is absent where the document does not hold it whole (a table). Error
// (input): it is no document of an answer.
Expected<CalibrationSolution> solution_from_document(const nlohmann::json& document);

// Puts the report, notices and what the poses leave open into the document, beside a method's own fields.
void finish_document(CalibrationSolution& solution);
// "scale_sigma" [x, z] and "shear_sigma", 1/1, and "scale_shown" into solution and document; a scale that is not told is
// left out.
void put_scale(const FieldScale& scale, CalibrationSolution& solution);
// The same of a judgement alone: "verdict", "reason", "cure".
void put_judgement(const Judgement& judgement, nlohmann::json& document);

nlohmann::json number_json(double value);  // null when not finite
nlohmann::json vector_json(const Eigen::VectorXd& values);
nlohmann::json matrix_json(const Eigen::MatrixXd& matrix);  // rows
// {"xyz_mm":[3],"abc_deg":[3]} of a pose's covariance (KUKA A, B, C).
nlohmann::json pose_sigma_json(const Pose& pose, const Matrix6& covariance);

}  // namespace seamwright
