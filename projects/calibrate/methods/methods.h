#pragma once
// `seamwright calibrate METHOD DATA`: the data as JSON in, the result as JSON out. One function a method;
// files, flags and messages belong to the caller.
//
// Every result holds "status", "verdict" (good | usable | poor | undetermined), "reason", "cure", and of the
// report (core/calibration/calibration.h) "parameters" [{"name","value","unit","sigma"}], "covariance" (their
// order and units), "correlations" [{"first","second","correlation"}], "per_pose"
// [{"id","rms_mm","deg","rms_px","used","contradicts","note"}] and "hold_out"
// {"folds","left_out","rms_mm","max_mm","rms_deg","rms_px"}. A number that does not exist is null; numbers of
// an undetermined answer are null. Poses are written as by pose_json(). "notices" are sentences worth a look.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct CalibrateOutcome {
    nlohmann::json result;
    int exit_code = 0;  // 0 good or usable, 1 poor or undetermined
};

int exit_code_for(Verdict verdict);
Verdict verdict_of(const nlohmann::json& result);  // undetermined where it holds none
nlohmann::json number_json(double value);          // null when not finite
nlohmann::json vector_json(const Eigen::VectorXd& values);
nlohmann::json matrix_json(const Eigen::MatrixXd& matrix);  // rows
// Adds the report's fields and the verdict to `result`.
void add_report(const CalibrationReport& report, nlohmann::json& result);
// {"xyz_mm":[3],"abc_deg":[3]} of a pose's covariance (KUKA A, B, C).
nlohmann::json pose_sigma_json(const Pose& pose, const Matrix6& covariance);

// "id" as text, a number as its text, absent: the entry's index ("0", "1", ...).
Expected<std::string> entry_id(const nlohmann::json& entry, std::size_t index, const std::string& where);

// {"radius_mm":r or null,"observations":[{"id","base_from_flange":POSE,"profile":[[x,z],..]}],
//  "nominal_flange_from_sensor":POSE?}; z null = no return.
// ->
// {"status","flange_from_sensor","centre_base_mm","radius_mm","rms_mm","noise_mm","sigma":{"xyz_mm","abc_deg","centre_mm",
//     "radius_mm","working_mm"},"covariance_pose" 6x6 (mm,
//     rad),"mirrored","degenerate","proposals":[{"words","base_from_flange", "sigma_mm"}],...}
Expected<CalibrateOutcome> calibrate_tcp_sphere_json(const nlohmann::json& data,
                                                     const std::vector<std::string>& exclude);

// {"mount":"eye_in_hand|eye_to_hand","pairs":[{"id"?,"base_from_flange":POSE,"camera_from_target":POSE}]}
// -> {"status","flange_from_camera" | "base_from_camera","base_from_target" |
// "flange_from_target","rms_mm","rms_deg","sigma",...}
Expected<CalibrateOutcome> calibrate_hand_eye_json(const nlohmann::json& data,
                                                   const std::vector<std::string>& exclude);

// {"points":[{"id"?,"plate":[3],"world":[3]} or {"id"?,"points":[{"plate","world"},..]} (measured in one
// stand, left out together)],"sigma_mm"?} ->
// {"status","world_from_plate","rms_mm","sigma","scale","mirrored",...}
Expected<CalibrateOutcome> calibrate_plate_json(const nlohmann::json& data,
                                                const std::vector<std::string>& exclude);

// {"sensors":[{"id"?,"world_from_plate":LINK,"plate_from_camera":LINK (or
// "camera_from_plate"),"camera_from_laser":LINK,
//  "working_point":[3]?}],"reference_from_world":LINK?}; one sensor may stand at the top level.
// LINK = POSE, or {"pose":POSE,"covariance":6x6 (mm, rad)}, or {"pose":POSE,"sigma_mm","sigma_deg"}.
// -> {"sensors":[{"id","world_from_laser" (or
// "reference_from_laser"),"sigma","covariance","working_sigma_mm","shares","verdict",..}],..}
Expected<CalibrateOutcome> calibrate_static_json(const nlohmann::json& data,
                                                 const std::vector<std::string>& exclude);

// {"flange_from_sensor":POSE
// (stored),"observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..],"centre_base_mm":[3],
//  "radius_mm"}],"other_sigma_mm"?,"limits":{"translation_mm","rotation_deg"}?}: centre and radius may stand
//  once at the top; or
// {"measurements":[{"id"?,"base_from_flange":POSE,"measured_flange":[3],"known_base":[3],"sigma_mm"?}],"limits"?}
// (plate points).
// ->
// {"status":"holds|drifted|undetermined","change":POSE,"change_mm","change_deg","sigma_mm","sigma_deg","chi_squared",
//     "chi_squared_limit","not_determined",...}
Expected<CalibrateOutcome> check_drift_json(const nlohmann::json& data,
                                            const std::vector<std::string>& exclude);

// Folder of images that show a chessboard ("7x6" inner corners) and the stripe; robot poses beside them
// (poseNNNN.txt, .yaml, .json as read_pose_file() reads them) give the hand-eye. `exclude` names images
// without extension; they are not even read.
// -> {"status","images","boards_found","camera","reprojection_rms_px","laser_plane":{"normal","distance_mm"},
//     "camera_from_laser","on_plane_share" (frames that share the
//     plane),"on_plane_share_all_frames","plane_rms_mm",
//     "hand_eye":{"flange_from_camera","target_spread_mm",..},"plate":{"shape","stretch","shear","bow_mm"},"frames":[..],...}
Expected<CalibrateOutcome> calibrate_stripe_camera_folder(const std::string& directory,
                                                          const std::string& board, double pitch_mm,
                                                          const std::vector<std::string>& exclude);

// The same from frames that were looked at before (stripe_frames.h); `exclude` leaves them out of the
// solution.
Expected<CalibrateOutcome> calibrate_stripe_camera_json(const nlohmann::json& data,
                                                        const std::vector<std::string>& exclude);

// {"size":[w,h],"views":[{"id"?,"points":[{"object":[3],"pixel":[2]}]}]} ->
// {"status","camera","reprojection_rms_px","sigma_px","covered_share","views":[{"id","camera_from_target","sigma"}],...}
Expected<CalibrateOutcome> calibrate_camera_json(const nlohmann::json& data,
                                                 const std::vector<std::string>& exclude);
// The same from a folder of images; `pattern` is chessboard, circles or charuco. Adds "images",
// "boards_found", "not_found".
Expected<CalibrateOutcome> calibrate_camera_folder(const std::string& directory, const std::string& board,
                                                   double pitch_mm, const std::string& pattern,
                                                   const std::vector<std::string>& exclude);

// {"camera":{fx,fy,cx,cy,k1,k2,..},"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}]} ->
// {"status","camera_from_laser","rms_px","sigma","covariance_pose",...}
Expected<CalibrateOutcome> calibrate_laser_plane_json(const nlohmann::json& data,
                                                      const std::vector<std::string>& exclude);

// {"size":[w,h],"lines":[[[u,v],..],..],"full"?} -> {"status","lens" (camera with f = half the
// diagonal),"centre_px","K1","K2" (px),
//     "straightness_before_px","straightness_after_px","corner_shift_px","corner_sigma_px",...}; lines are
//     excluded by number.
Expected<CalibrateOutcome> calibrate_lens_json(const nlohmann::json& data,
                                               const std::vector<std::string>& exclude);

// {"size":[w,h],"step_px"?,"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}]} ->
// {"status","table":{"u0","v0","step_u","step_v","columns","rows","holes"},"covered_share","forward_rms_mm",
//     "forward_max_mm","backward_rms_px","backward_max_px","unsupported_pairs","noise_px","noise_mm",
//     "interpolation_mm","sigma":{"rms_mm","worst_mm"},"wrong_pairs":[id,..],"table_file",...}
// The table itself goes to `table_path` (devices/exchange/lookup_table_file.h) when one is given and the
// verdict is good or usable; "table_file" is then its path, else null.
Expected<CalibrateOutcome> calibrate_lut_json(const nlohmann::json& data,
                                              const std::vector<std::string>& exclude,
                                              const std::string& table_path = {});

}  // namespace seamwright
