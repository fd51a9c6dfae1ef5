#pragma once
// One calibration method: what it is called, what its data are, how they are solved, and how a person is led
// through it. Each method is one file of this folder that makes its CalibrationMethod, and one line in
// methods.h; the command line, the guided sessions, the studio and the tests read the row and know nothing of
// a method otherwise.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/pose/convention_detective.h"
#include "core/parameter.h"
#include "projects/calibrate/input/plate_images.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/solution/solution.h"
#include "projects/model/project.h"

namespace seamwright {

using ExcludedIds = std::vector<std::string>;

// What is taken when the robot stands still. `files`: this method's data are measured elsewhere and loaded.
// `apex`: of a triangular body, see apex_pair.h. `board_points`: corners of a board in the robot's base,
// through the calibration in use. `board_chain`: one sensor's chain from the plate's place to its laser
// plane; one stand of the robot takes those of all its sensors. `board_sights`: the board's points in the picture and where
// the camera stands in the robot's base, of all its sensors too. `board_view`: the board's points alone. `touch`: the robot's
// pose alone, when a person says that the tip touches.
enum class CaptureKind {
    sphere_profile,
    board_and_stripe,
    stripe_line,
    board_pose,
    apex,
    board_points,
    board_chain,
    board_sights,
    board_view,
    touch,
    files
};
// A whole board must be in the picture, taken with the laser off where the sensor can switch it.
bool shows_board(CaptureKind kind);
// One stand of the robot takes a capture of each of its calibrated sensors.
bool of_all_sensors(CaptureKind kind);

// What the answer is good for. `sensor`: it can become the sensor's calibration. `record`: kept in the
// project (a plate's place, a lens). `check`: it only judges the calibration in use.
enum class AnswerUse { sensor, record, check };

// A number or a choice that a person gives before capturing: where it stands in the method's data.
struct MethodSetting {
    ParameterInfo info;   // name is unique within the method
    const char* pointer;  // JSON pointer: "/board/columns"
    Text label;           // "Radius of the sphere"
    // Of a choice: what each of info.choices writes; null writes nothing.
    std::vector<nlohmann::json> written = {};
};

// The set-up as the guided page draws it.
enum class SetUpDrawing {
    sphere,
    moved_sphere,
    board_and_stripe,
    board,
    several_sensors,
    plate_in_world,
    triangle,
    plane,
    dotted_plane
};

// A folder of images of a board, as a person points at it.
struct BoardImages {
    std::string folder;
    BoardWords board;
    ExcludedIds exclude;         // names without extension; they are not even read
    ReadProgress progress = {};  // may be empty
};

// The fields that the objects at one place of a method's data may have. `at`: "" the data, "robot" an object in it,
// "passes[].profiles[]" every entry of a list in every entry of another. What is checked where it is read (poses, links, a
// nozzle's target) needs no place of its own.
struct DataFields {
    std::string at;
    std::vector<std::string_view> known;  // as people write them
    std::vector<std::string_view> written =
        {};  // what sessions put beside them: for thumbnails, for captures to come
};

// Poses or lengths of a method's data that may have been written in another unit, at a place as above; a link counts as its
// pose. What answers rest on: without a residual that shows it no unit can be told.
enum class QuantityKind { poses, lengths };
struct DataQuantity {
    std::string at;  // "observations[].base_from_flange"
    QuantityKind kind = QuantityKind::poses;
};

// What the conventions of its poses are judged by.
struct ConventionFits {
    PoseFit fit, screen;
};

struct CalibrationMethod {
    std::string id;  // "tcp-sphere", as on the command line

    // Command line.
    std::string help;    // one line
    std::string usage;   // what may follow the id: "sphere.json --exclude P3"
    std::string layout;  // of its data
    // Data as somebody writes them who starts: small, complete, noisy as real ones. Always the same.
    nlohmann::json (*example)() = nullptr;
    std::vector<DataFields> fields = {};        // of its data, all of them
    std::vector<PoseListPlace> poses = {};      // in its data, the robot's first
    std::vector<DataQuantity> quantities = {};  // of its data; see other_units.h
    bool table = false;                         // its answer can go into a file of a look-up table

    // Solving. Poses in the data are written as usual (pose_json.h); see solve_calibration().
    Expected<CalibrationSolution> (*solve)(const nlohmann::json& data, const ExcludedIds& exclude) = nullptr;
    // The data that a folder of images holds; absent: the method takes no images.
    Expected<nlohmann::json> (*data_of_images)(const BoardImages& images) = nullptr;
    // Its data leave a residual that a convention of poses shows in; absent: they do not.
    Expected<ConventionFits> (*convention_fits)(const nlohmann::json& data,
                                                const ExcludedIds& exclude) = nullptr;

    // Leading a person through it.
    bool guided = true;
    std::string entries = {};  // the list in its data: "observations"
    CaptureKind capture = CaptureKind::files;
    AnswerUse use = AnswerUse::sensor;
    int fewest = 1, advised = 1;  // captures
    bool robot = false;           // a robot pose belongs to every capture
    bool repeatability = false;   // its data take the robot's ("robot":{"sigma_mm","sigma_deg"})
    bool model = false;      // its captures are made through the calibration in use (pixel to millimetre)
    bool keeps_back = true;  // captures can be kept back to verify the answer with
    std::vector<MethodSetting> settings = {};
    nlohmann::json fixed_settings = nlohmann::json::object();  // of its data, where a session begins
    // Adds what comes from the calibration in use (nullptr: none) and from what else the project keeps, oldest
    // first. Error (input): the method cannot do without. Absent: nothing comes.
    Expected<nlohmann::json> (*prepare)(nlohmann::json settings, const Calibration* base,
                                        const std::vector<Calibration>& kept) = nullptr;
    // What people read about it.
    Text title;              // "Sensor on the flange (sphere)"
    Text why;                // one sentence: what it answers
    std::vector<Text> need;  // what to have at hand and what to mind
    Text file;               // what a file of it holds
    SetUpDrawing drawing = SetUpDrawing::board;
};

// With what the method takes over, see CalibrationMethod::prepare, and the repeatability of the robot (nullptr: none) where
// the project holds a measured one and the settings state none.
Expected<nlohmann::json> prepared_settings(const CalibrationMethod& method, nlohmann::json settings,
                                           const Calibration* base, const std::vector<Calibration>& kept,
                                           const RobotSetup* robot);
// The method's settings at their defaults, as its data hold them.
nlohmann::json default_settings(const CalibrationMethod& method);
// Error (input): out of range.
Expected<void> set_setting(const CalibrationMethod& method, nlohmann::json& settings, const std::string& name,
                           double value);
double setting(const MethodSetting& which, const nlohmann::json& settings);

// Settings that several methods have.
MethodSetting number_setting(const char* name, const char* pointer, const char* unit, double minimum,
                             double maximum, double otherwise, int decimals, const char* help, Text label);
MethodSetting choice_setting(const char* name, const char* pointer, std::vector<std::string> choices,
                             std::vector<nlohmann::json> written, const char* help, Text label);
MethodSetting sphere_radius_setting();
std::vector<MethodSetting> board_settings();

// "robot":{"sigma_mm","sigma_deg"?}
DataFields robot_fields();
// CAMERA at this place
DataFields camera_fields(std::string at);
// Error (input): a field that the method does not know and that looks like a known one misspelt, which would silently mean its
// default otherwise. Whatever else stands beside (a remark, where the data come from) is passed over; what is no object or no list where
// one belongs is left to the method.
Expected<void> check_fields(const CalibrationMethod& method, const nlohmann::json& data);

}  // namespace seamwright
