#pragma once
// The calibration methods that an engineer is guided through: what each needs, what one capture of it holds,
// and how it is solved. One row a method; sessions, pages and tests read the row and know nothing of the
// method otherwise.

#include <string>
#include <vector>

#include "core/parameter.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

// What is taken when the robot stands still. `files`: this method's data are measured elsewhere and loaded.
// `apex`: of a triangular body, see apex_pair.h. `board_points`: corners of a board in the robot's base,
// through the calibration in use. `board_chain`: one sensor's chain from the plate's place to its laser
// plane; one stand of the robot takes those of all its sensors.
enum class CaptureKind {
    sphere_profile,
    board_and_stripe,
    stripe_line,
    board_pose,
    apex,
    board_points,
    board_chain,
    files
};
// A whole board must be in the picture, taken with the laser off where the sensor can switch it.
bool shows_board(CaptureKind kind);

// What the answer is good for. `sensor`: it can become the sensor's calibration. `record`: kept in the
// project (a plate's place, a lens). `check`: it only judges the calibration in use.
enum class AnswerUse { sensor, record, check };

// A number that a person gives before capturing: where it stands in the method's data.
struct MethodSetting {
    ParameterInfo info;   // name is unique within the method
    const char* pointer;  // JSON pointer: "/board/columns"
};

struct CalibrationMethod {
    std::string id;       // "tcp-sphere", as on the command line
    std::string entries;  // the list in its data: "observations"
    CaptureKind capture = CaptureKind::files;
    AnswerUse use = AnswerUse::sensor;
    int fewest = 1, advised = 1;  // captures
    bool robot = false;           // a robot pose belongs to every capture
    bool model = false;  // its captures are made through the calibration in use (pixel to millimetre)
    Expected<CalibrateOutcome> (*solve)(const nlohmann::json& data,
                                        const std::vector<std::string>& exclude) = nullptr;
    std::vector<MethodSetting> settings;
};

const std::vector<CalibrationMethod>& calibration_methods();
const CalibrationMethod* find_method(const std::string& id);  // nullptr: unknown

// The method's settings at their defaults, as its data hold them.
nlohmann::json default_settings(const CalibrationMethod& method);
// Error (input): out of range.
Expected<void> set_setting(const CalibrationMethod& method, nlohmann::json& settings, const std::string& name,
                           double value);
double setting(const MethodSetting& which, const nlohmann::json& settings);

}  // namespace seamwright
