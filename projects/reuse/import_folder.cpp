#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/profile/units.h"
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

// The taught profile of a template: what the filter leaves of the piece.
Expected<void> cut_template(const FolderImport& options, const Profile& taught, Spot& spot) {
    Profile piece;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    const auto inside = [&](double x) {
        return !options.piece_x_mm || (x >= options.piece_x_mm->x() && x <= options.piece_x_mm->y());
    };
    for (std::size_t i = 0; i < taught.size(); ++i) {
        if (taught.segment[i] == kOutlier || !inside(taught.x_mm[i])) continue;
        piece.x_mm.push_back(taught.x_mm[i]);
        piece.z_mm.push_back(taught.z_mm[i]);
        if (!taught.intensity.empty()) piece.intensity.push_back(taught.intensity[i]);
        piece.segment.push_back(taught.segment[i]);
        sum += Eigen::Vector2d(taught.x_mm[i], taught.z_mm[i]);
    }
    if (piece.size() < 3)
        return input_error(Text("the piece holds {} points of the taught profile", piece.size()),
                           Text("spot {}", spot.id), "give --piece X0,X1 where the contour is");
    spot.feature.template_reference_mm =
        options.template_reference_mm.value_or(sum / static_cast<double>(piece.size()));
    spot.feature.template_profile = std::move(piece);
    return {};
}

Expected<void> check_calibration(const FolderImport& options, bool images, const Frame& first) {
    if (!options.calibration) return {};
    const Calibration& c = *options.calibration;
    const Text where("calibration {}", c.id);
    if (c.method == "pixels")
        return input_error("it measures in pixels", where, "choose one that was solved");
    if (c.flange_from_sensor.isApprox(Pose::Identity(), 0))
        return input_error("it does not say where the sensor sits on the flange", where,
                           "give --flange-from-sensor POSE besides");
    if (!images) return {};
    if (!c.model) return input_error("it holds no model that turns pixels into millimetres", where);
    const CameraModel& camera = c.model->camera;
    if (camera.width > 0 && (camera.width != first.image.width || camera.height != first.image.height))
        return input_error(Text("it was made with images of {} x {}, these have {} x {}", camera.width,
                                camera.height, first.image.width, first.image.height),
                           where, "choose the calibration of this camera at this resolution");
    return {};
}

// The units of a frame's profile, unless the person named one.
Expected<void> check_units(const FolderImport& options, const Frame& frame, const fs::path& file) {
    if (!options.layout.profile.unit.empty() || frame.profile.size() == 0) return {};
    auto ok = check_profile_millimetres(frame.profile, file.string());
    if (!ok) ok.error().mend = Text("{}, or say what they are in with --unit", ok.error().mend);
    return ok;
}

// What the region will be worth with these sigmas, so that nobody learns it from a refused run.
Text forecast_note(const Project& project) {
    const Region& region = project.regions.front();
    const auto plan = plan_region(planned_observations(project, region), correction_options(project, region));
    if (!plan || plan->status != CorrectionStatus::ok) return {};
    return Text("expected of a correction: {:.3f} mm (1 sigma) at the worst spot, limit {:.3g} mm",
                plan->sigma_at_spots_mm, region.sigma_limit_mm);
}

}  // namespace

Expected<FolderImportResult> import_folder(const FolderImport& options) {
    FolderImportResult result;
    Project& project = result.project;
    std::error_code code;
    const fs::path folder = fs::absolute(options.folder, code).lexically_normal();
    RecordingLayout layout = options.layout;
    auto frames = list_recording(folder, "", true, layout, &result.understood);
    if (!frames) return tl::unexpected(frames.error());
    if (frames->empty()) return input_error("the folder holds no profiles and no images", folder.string());
    if (!frames->front().image && frames->front().file.extension() != ".csv")  // may hold points in space
        layout.flange_from_sensor =
            options.calibration ? options.calibration->flange_from_sensor : options.flange_from_sensor;
    std::vector<RecordedFrame> taught = *frames;
    if (options.reference_folder) {
        auto listed = list_recording(fs::absolute(*options.reference_folder, code).lexically_normal(), "",
                                     true, layout, &result.understood);
        if (!listed) return tl::unexpected(listed.error());
        taught = std::move(*listed);
    } else {
        result.notes.push_back(
            "no reference folder: the folder itself is the taught state, the first run finds no "
            "displacement");
    }
    if (!(options.sigma_mm > 0)) return input_error("sigma must be positive", "sigma_mm");
    if (!(options.sigma_limit_mm > 0))
        return input_error("the sigma limit must be positive", "sigma_limit_mm");
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
    if (const nlohmann::json told = recording_layout_json(layout); !told.empty())
        sensor.settings["layout"] = told;
    sensor.peaks = options.peaks;
    sensor.filter = options.filter;
    sensor.calibration_id = kCalibrationId;
    RobotSetup robot;
    robot.id = kRobotId;
    robot.driver = "replay";
    robot.settings = sensor.settings;
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

    Frame first;
    if (auto read = read_recorded(frames->front(), layout, 0, first); !read)
        return tl::unexpected(read.error());
    if (auto ok = check_units(options, first, frames->front().file); !ok) return tl::unexpected(ok.error());
    const bool images = frames->front().image;
    if (auto ok = check_calibration(options, images, first); !ok) return tl::unexpected(ok.error());
    Calibration calibration;
    if (options.calibration) {
        calibration = *options.calibration;
    } else {
        calibration.flange_from_sensor = options.flange_from_sensor;
        calibration.model = options.model;
        calibration.method = "import";
        calibration.verdict = options.calibration_verdict;
        calibration.created_utc = utc_now();
        calibration.source = folder.string();
    }
    calibration.id = kCalibrationId;
    calibration.sensor_id = kSensorId;
    calibration.robot_id = kRobotId;
    calibration.sensor_identity = sensor.identity;
    calibration.robot_identity = robot.identity;
    if (images && !calibration.model) {
        calibration.model = pixel_model(first.image.width, first.image.height, options.peaks.scan);
        calibration.method = "pixels";
        calibration.verdict = Verdict::undetermined;
        result.in_pixels = true;
        result.notes.push_back(
            "no calibration: measured in pixels (1 px counts as 1 unit), corrections have no metric meaning "
            "and nothing can be pushed; with --calibration it is measured in millimetres");
    } else if (calibration.verdict == Verdict::undetermined) {
        result.notes.push_back("no verdict on the sensor's calibration was given: nothing can be pushed");
    }
    project.sensors = {sensor};
    project.robots = {robot};
    project.calibrations = {calibration};

    Region region;
    region.id = "all";
    region.limits = options.limits;
    region.sigma_limit_mm = options.sigma_limit_mm;
    region.frame_name = "path";
    region.base_from_frame = options.base_from_workobject;

    // Taught frames by spot; the first of a spot counts.
    std::map<std::string, const RecordedFrame*> taught_by_spot;
    for (const RecordedFrame& frame : taught) taught_by_spot.emplace(frame.spot_id, &frame);
    std::map<std::string, bool> seen;
    Frame frame;
    int references = 0;
    std::optional<Error> unreadable;
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
            result.notes.push_back(Text("spot {}: not in the reference folder, switched off", spot.id));
            project.spots.push_back(std::move(spot));
            continue;
        }
        spot.base_from_flange = *reference->second->base_from_flange;
        project.spots.push_back(spot);
        Spot& taught_spot = project.spots.back();
        if (auto read = read_recorded(*reference->second, layout, 0, frame); !read) {
            if (!unreadable) unreadable = read.error();
            result.notes.push_back(Text("spot {}: {}, switched off", spot.id, read.error().text()));
            continue;
        }
        if (auto ok = check_units(options, frame, reference->second->file); !ok)
            return tl::unexpected(ok.error());
        // The recorded part in another unit than the taught one; what cannot be read shows in the run.
        if (Frame other; !recorded.image && recorded.file != reference->second->file &&
                         read_recorded(recorded, layout, 0, other))
            if (auto ok = check_units(options, other, recorded.file); !ok) return tl::unexpected(ok.error());
        if (options.feature.kind == "template") {
            StripePeaks peaks;
            Capture capture;
            Profile taught_profile;
            Text message;
            if (capture_frame(frame, options.peaks, calibration.model ? &*calibration.model : nullptr, peaks,
                              capture, message) != SpotStatus::measured) {
                result.notes.push_back(Text("spot {}: {}, switched off", spot.id, message));
                continue;
            }
            if (auto tracked = track_capture(capture, options.filter, taught_profile); !tracked) {
                result.notes.push_back(Text("spot {}: {}, switched off", spot.id, tracked.error().text()));
                continue;
            }
            if (auto cut = cut_template(options, taught_profile, taught_spot); !cut)
                return tl::unexpected(cut.error());
        }
        auto measurer = SpotMeasurer::make(project, spot.id);
        if (!measurer) return tl::unexpected(measurer.error());
        const SpotMeasurement& measured = measurer->measure(frame);
        taught_spot.reference_profile = measurer->profile();
        if (measured.status != SpotStatus::measured) {
            result.notes.push_back(Text("spot {}: {} ({}), switched off", spot.id, to_string(measured.status),
                                        measured.message));
            continue;
        }
        taught_spot.reference_mm = measured.measured_mm;
        taught_spot.enabled = taught_spot.required = true;
        region.spot_ids.push_back(spot.id);
        ++references;
    }
    if (references == 0) {
        if (unreadable) return tl::unexpected(*unreadable);  // file and line of the first
        Error error{ErrorKind::input, "no feature was found in any frame", folder.string(),
                    "try another feature, or see with --look how the files are understood"};
        if (!result.notes.empty()) error.what = Text("{} ({})", error.what, result.notes.back());
        return tl::unexpected(error);
    }
    project.regions = {region};
    if (Text note = forecast_note(project); !note.empty() && !result.in_pixels)
        result.notes.push_back(std::move(note));
    return result;
}

}  // namespace seamwright
