#include "projects/calibrate/methods/methods.h"

#include <algorithm>

#include "projects/calibrate/methods/other_units.h"

namespace seamwright {

const std::vector<CalibrationMethod>& calibration_methods() {
    static const std::vector<CalibrationMethod> methods{
        tcp_sphere_method(), stripe_camera_method(), hand_eye_method(), laser_plane_method(), lut_method(),
        static_method(),     camera_method(),        lens_method(),     plate_method(),       stereo_method(),
        bundle_method(),     drift_method(),         on_part_method(),  nozzle_method()};
    return methods;
}

const CalibrationMethod* find_method(const std::string& id) {
    const auto& list = calibration_methods();
    const auto it = std::find_if(list.begin(), list.end(), [&](const auto& m) { return m.id == id; });
    return it == list.end() ? nullptr : &*it;
}

Expected<CalibrationSolution> solve_calibration(const CalibrationMethod& method, const nlohmann::json& data,
                                                const ExcludedIds& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", Text("see calibrate {} --help", method.id));
    SEAM_OK(check_fields(method, data));
    SEAM_TRY(const auto meant, with_usual_poses(method.poses, data));
    auto solution = method.solve(meant.data(), exclude);
    name_other_unit(method, meant.data(), exclude, solution);
    if (!solution) return solution;
    solution->document["method"] = method.id;
    meant.put(solution->document);
    return solution;
}

}  // namespace seamwright
