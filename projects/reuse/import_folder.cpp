#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "devices/exchange/image_file.h"
#include "devices/exchange/profile_csv.h"
#include "devices/registry.h"
#include "devices/replay/recording.h"
#include "projects/reuse/exchange.h"
#include "projects/station/measure.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSensorId = "A";
constexpr const char* kRobotId = "R1";
constexpr const char* kCalibrationId = "import";

// A frame of a folder, read outside of any driver.
Expected<void> read_frame(const RecordedFrame& recorded, Frame& frame) {
    frame.status = FrameStatus::ok;
    frame.profile.clear();
    frame.image = {};
    frame.base_from_flange = recorded.base_from_flange;
    if (recorded.image) return read_image_file(recorded.file, frame);
    auto profile = read_profile_csv(recorded.file);
    if (!profile) return tl::unexpected(profile.error());
    frame.profile = std::move(*profile);
    return {};
}

// One pixel is one unit: x along the image lines' order, z along the line. Columns: (x, z) = (u, v); rows:
// (v, u).
SensorModel pixel_model(int width, int height, ScanLines scan) {
    SensorModel model;
    model.camera.width = width;
    model.camera.height = height;
    LookupTable table;
    table.step_u = width;
    table.step_v = height;
    table.columns = table.rows = 2;
    const double w = width, h = height;
    if (scan == ScanLines::columns) {
        table.x_mm = {0, w, 0, w};
        table.z_mm = {0, 0, h, h};
    } else {
        table.x_mm = {0, 0, h, h};
        table.z_mm = {0, w, 0, w};
    }
    model.table = table;
    return model;
}

}  // namespace

Expected<FolderImportResult> import_folder(const FolderImport& options) {
    FolderImportResult result;
    Project& project = result.project;
    std::error_code code;
    const fs::path folder = fs::absolute(options.folder, code).lexically_normal();
    auto frames = list_recording(folder, "", true);
    if (!frames) return tl::unexpected(frames.error());
    if (frames->empty()) return input_error("the folder holds no profiles and no images", folder.string());
    std::vector<RecordedFrame> taught = *frames;
    if (options.reference_folder) {
        auto listed =
            list_recording(fs::absolute(*options.reference_folder, code).lexically_normal(), "", true);
        if (!listed) return tl::unexpected(listed.error());
        taught = std::move(*listed);
    } else {
        result.notes.push_back(
            "no reference folder: the folder itself is the taught state, the first run finds no "
            "displacement");
    }
    if (!(options.sigma_mm > 0)) return input_error("sigma must be positive", "sigma_mm");
    if (!pose_from_matrix(options.flange_from_sensor.matrix(), ""))
        return input_error("the pose is not rigid", "flange_from_sensor");

    project.name = options.project_name.empty() ? folder.filename().string() : options.project_name;
    if (project.name.empty()) project.name = folder.parent_path().filename().string();
    project.part.name = project.name;
    project.part.base_from_workobject = options.base_from_workobject;

    SensorSetup sensor;
    sensor.id = kSensorId;
    sensor.driver = "replay";
    sensor.settings = {{"folder", folder.string()}};
    sensor.peaks = options.peaks;
    sensor.filter = options.filter;
    sensor.calibration_id = kCalibrationId;
    RobotSetup robot;
    robot.id = kRobotId;
    robot.driver = "replay";
    robot.settings = {{"folder", folder.string()}};
    {
        DeviceSession session;
        auto opened = open_sensor(sensor.driver, sensor.settings, session);
        if (!opened) return tl::unexpected(opened.error());
        sensor.identity = (*opened)->identity();
        auto linked = open_robot(robot.driver, robot.settings, session);
        if (!linked) return tl::unexpected(linked.error());
        auto identity = (*linked)->identity();
        if (!identity) return tl::unexpected(identity.error());
        robot.identity = *identity;
    }

    Calibration calibration;
    calibration.id = kCalibrationId;
    calibration.sensor_id = kSensorId;
    calibration.robot_id = kRobotId;
    calibration.sensor_identity = sensor.identity;
    calibration.robot_identity = robot.identity;
    calibration.created_utc = utc_now();
    calibration.source = folder.string();
    calibration.flange_from_sensor = options.flange_from_sensor;
    calibration.model = options.model;
    calibration.method = "import";
    calibration.verdict = options.calibration_verdict;
    const bool images = frames->front().image;
    if (images && !options.model) {
        Frame first;
        if (auto read = read_frame(frames->front(), first); !read) return tl::unexpected(read.error());
        calibration.model = pixel_model(first.image.width, first.image.height, options.peaks.scan);
        calibration.method = "pixels";
        calibration.verdict = Verdict::undetermined;
        result.in_pixels = true;
        result.notes.push_back(
            "no calibration: measured in pixels (1 px counts as 1 unit), corrections have no metric meaning "
            "and nothing can be pushed");
    } else if (calibration.verdict == Verdict::undetermined) {
        result.notes.push_back("no verdict on the sensor's calibration was given: nothing can be pushed");
    }
    project.sensors = {sensor};
    project.robots = {robot};
    project.calibrations = {calibration};

    Region region;
    region.id = "all";
    region.limits = options.limits;
    region.frame_name = "path";
    region.base_from_frame = options.base_from_workobject;

    // Taught frames by spot; the first of a spot counts.
    std::map<std::string, const RecordedFrame*> taught_by_spot;
    for (const RecordedFrame& frame : taught) taught_by_spot.emplace(frame.spot_id, &frame);
    std::map<std::string, bool> seen;
    Frame frame;
    int references = 0;
    for (const RecordedFrame& recorded : *frames) {
        if (!seen.emplace(recorded.spot_id, true).second)
            continue;  // a further frame of the spot is a further run
        Spot spot;
        spot.id = recorded.spot_id;
        spot.sensor_id = kSensorId;
        spot.robot_id = kRobotId;
        spot.feature = options.feature;
        spot.sigma_mm = options.sigma_mm;
        spot.required = false;
        spot.base_from_flange = *recorded.base_from_flange;
        spot.enabled = false;
        const auto reference = taught_by_spot.find(spot.id);
        if (reference == taught_by_spot.end()) {
            result.notes.push_back(
                fmt::format("spot {}: not in the reference folder, switched off", spot.id));
            project.spots.push_back(std::move(spot));
            continue;
        }
        spot.base_from_flange = *reference->second->base_from_flange;
        project.spots.push_back(spot);
        auto measurer = SpotMeasurer::make(project, spot.id);
        if (!measurer) return tl::unexpected(measurer.error());
        Spot& taught_spot = project.spots.back();
        if (auto read = read_frame(*reference->second, frame); !read) {
            result.notes.push_back(
                fmt::format("spot {}: {}, switched off", spot.id, read.error().sentence()));
            continue;
        }
        const SpotMeasurement& measured = measurer->measure(frame);
        taught_spot.reference_profile = measurer->profile();
        if (measured.status != SpotStatus::measured) {
            result.notes.push_back(fmt::format("spot {}: {} ({}), switched off", spot.id,
                                               to_string(measured.status), measured.message));
            continue;
        }
        taught_spot.reference_mm = measured.measured_mm;
        taught_spot.enabled = taught_spot.required = true;
        region.spot_ids.push_back(spot.id);
        ++references;
    }
    if (references == 0) {
        Error error{ErrorKind::input, "no feature was found in any frame", folder.string(),
                    "try another feature or other peak settings"};
        if (!result.notes.empty()) error.what += " (" + result.notes.back() + ")";
        return tl::unexpected(error);
    }
    project.regions = {region};
    return result;
}

}  // namespace seamwright
