#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "core/profile/taught_profile.h"
#include "core/profile/units.h"
#include "devices/registry.h"
#include "devices/replay/recording.h"
#include "projects/measure/measure.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/recorded_heights.h"

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

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

// The taught profile of a template: what the filter leaves of the piece.
Expected<void> cut_template(const FolderImport& options, const Profile& taught, Spot& spot) {
    Profile piece = options.piece_x_mm ? cut_out(taught, options.piece_x_mm->x(), options.piece_x_mm->y())
                                       : cut_out(taught, -kAnywhere, kAnywhere);
    if (piece.size() < 3)
        return input_error(Text("the piece holds {} points of the taught profile", piece.size()),
                           Text("spot {}", spot.id), "give --piece X0,X1 where the contour is");
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < piece.size(); ++i) sum += Eigen::Vector2d(piece.x_mm[i], piece.z_mm[i]);
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
    auto ok = check_profile_millimetres(recorded_heights(frame.profile), file.string());
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

// One import, step by step; a step that fails ends it.
class FolderImporter {
  public:
    explicit FolderImporter(const FolderImport& options) : options_(options), layout_(options.layout) {
        std::error_code code;
        folder_ = fs::absolute(options.folder, code).lexically_normal();
    }

    Expected<FolderImportResult> import() {
        for (const auto step :
             {&FolderImporter::check_options, &FolderImporter::list, &FolderImporter::take_devices,
              &FolderImporter::take_calibration, &FolderImporter::take_spots})
            SEAM_OK((this->*step)());
        if (Text note = forecast_note(result_.project); !note.empty() && !result_.in_pixels)
            result_.notes.push_back(std::move(note));
        return std::move(result_);
    }

  private:
    Expected<void> check_options() {
        if (!(options_.sigma_mm > 0)) return input_error("sigma must be positive", "sigma_mm");
        if (!(options_.sigma_limit_mm > 0))
            return input_error("the sigma limit must be positive", "sigma_limit_mm");
        if (!pose_from_matrix(options_.flange_from_sensor.matrix(), ""))
            return input_error("the pose is not rigid", "flange_from_sensor");
        return {};
    }

    Expected<void> list() {
        SEAM_TRY(auto frames, list_recording(folder_, "", true, layout_, &result_.understood));
        if (frames.empty())
            return input_error("the folder holds no profiles and no images", folder_.string());
        frames_ = std::move(frames);
        const RecordedFrame& first = frames_.front();
        if (!first.image && first.file.extension() != ".csv")  // may hold points in space
            layout_.flange_from_sensor =
                options_.calibration ? options_.calibration->flange_from_sensor : options_.flange_from_sensor;
        taught_ = frames_;
        if (options_.reference_folder) {
            std::error_code code;
            SEAM_TRY(auto listed,
                     list_recording(fs::absolute(*options_.reference_folder, code).lexically_normal(), "",
                                    true, layout_, &result_.understood));
            taught_ = std::move(listed);
        } else {
            result_.notes.push_back(
                "no reference folder: the folder itself is the taught state, the first run finds no "
                "displacement");
        }
        return {};
    }

    Expected<void> take_devices() {
        Project& project = result_.project;
        project.name = options_.project_name.empty() ? folder_.filename().string() : options_.project_name;
        if (project.name.empty()) project.name = folder_.parent_path().filename().string();
        project.part.name = project.name;
        project.part.base_from_workobject = options_.base_from_workobject;
        SensorSetup sensor;
        sensor.id = kSensorId;
        sensor.driver = "replay";
        sensor.settings = {{"folder", folder_.string()}};
        if (const nlohmann::json told = recording_layout_json(layout_); !told.empty())
            sensor.settings["layout"] = told;
        sensor.peaks = options_.peaks;
        sensor.filter = options_.filter;
        sensor.calibration_id = kCalibrationId;
        RobotSetup robot;
        robot.id = kRobotId;
        robot.driver = "replay";
        robot.settings = sensor.settings;
        DeviceSession session;
        SEAM_TRY(auto opened, open_sensor(sensor.driver, sensor.settings, session));
        sensor.identity = opened->identity();
        SEAM_TRY(auto linked, open_robot(robot.driver, robot.settings, session));
        SEAM_TRY(auto identity, linked->identity());
        robot.identity = identity;
        project.sensors = {std::move(sensor)};
        project.robots = {std::move(robot)};
        return {};
    }

    Expected<void> take_calibration() {
        Frame first;
        SEAM_OK(read_recorded(frames_.front(), layout_, 0, first));
        SEAM_OK(check_units(options_, first, frames_.front().file));
        tell_of(first);
        const bool images = frames_.front().image;
        SEAM_OK(check_calibration(options_, images, first));
        Calibration calibration;
        if (options_.calibration) {
            calibration = *options_.calibration;
        } else {
            calibration.flange_from_sensor = options_.flange_from_sensor;
            calibration.model = options_.model;
            calibration.method = "import";
            calibration.verdict = options_.calibration_verdict;
            calibration.created_utc = utc_now();
            calibration.source = folder_.string();
        }
        calibration.id = kCalibrationId;
        calibration.sensor_id = kSensorId;
        calibration.robot_id = kRobotId;
        calibration.sensor_identity = result_.project.sensors.front().identity;
        calibration.robot_identity = result_.project.robots.front().identity;
        if (images && !calibration.model) {
            calibration.model = pixel_model(first.image.width, first.image.height, options_.peaks.scan);
            calibration.method = "pixels";
            calibration.verdict = Verdict::undetermined;
            result_.in_pixels = true;
            result_.notes.push_back(
                "no calibration: measured in pixels (1 px counts as 1 unit), corrections have no metric "
                "meaning and nothing can be pushed; with --calibration it is measured in millimetres");
        } else if (calibration.verdict == Verdict::undetermined) {
            result_.notes.push_back(
                "no verdict on the sensor's calibration was given: nothing can be pushed");
        }
        result_.project.calibrations = {std::move(calibration)};
        return {};
    }

    // How the profiles were read, by the first.
    void tell_of(const Frame& first) {
        const RecordedFrame& frame = frames_.front();
        if (frame.image || first.profile.size() == 0) return;
        const std::string name = frame.file.filename().string();
        if (!frame.profile)
            if (const auto read = read_profiles(frame.file, layout_.profile))
                result_.understood.push_back(name + ": " + read->understood);
        if (const auto codes = find_no_return_codes(first.profile); !codes.empty())
            result_.notes.push_back(Text("{}: {}", name, no_return_sentence(codes)));
        std::set<std::string> told;
        std::erase_if(result_.understood, [&](const std::string& line) { return !told.insert(line).second; });
    }

    Expected<void> take_spots() {
        Region region;
        region.id = "all";
        region.limits = options_.limits;
        region.sigma_limit_mm = options_.sigma_limit_mm;
        region.frame_name = "path";
        region.base_from_frame = options_.base_from_workobject;
        // Taught frames by spot; the first of a spot counts.
        std::map<std::string, const RecordedFrame*> taught_by_spot;
        for (const RecordedFrame& frame : taught_) taught_by_spot.emplace(frame.spot_id, &frame);
        std::set<std::string> seen;
        for (const RecordedFrame& recorded : frames_) {
            if (!seen.insert(recorded.spot_id).second) continue;  // a further frame is a further run
            Spot& spot = add_spot(recorded);
            const auto reference = taught_by_spot.find(spot.id);
            if (reference == taught_by_spot.end()) {
                result_.notes.push_back(Text("spot {}: not in the reference folder, switched off", spot.id));
                continue;
            }
            SEAM_TRY(auto taught, teach(spot, recorded, *reference->second));
            if (taught) region.spot_ids.push_back(spot.id);
        }
        if (region.spot_ids.empty()) return nothing_found();
        result_.project.regions = {std::move(region)};
        return {};
    }

    Spot& add_spot(const RecordedFrame& recorded) {
        Spot spot;
        spot.id = recorded.spot_id;
        spot.sensor_id = kSensorId;
        spot.robot_id = kRobotId;
        spot.feature = options_.feature;
        spot.sigma_mm = options_.sigma_mm;
        spot.required = spot.enabled = false;
        spot.base_from_flange = *recorded.base_from_flange;
        result_.project.spots.push_back(std::move(spot));
        return result_.project.spots.back();
    }

    // false, with a note: the spot stays switched off.
    Expected<bool> teach(Spot& spot, const RecordedFrame& recorded, const RecordedFrame& reference) {
        spot.base_from_flange = *reference.base_from_flange;
        if (auto read = read_recorded(reference, layout_, 0, frame_); !read) {
            if (!unreadable_) unreadable_ = read.error();
            result_.notes.push_back(Text("spot {}: {}, switched off", spot.id, read.error().text()));
            return false;
        }
        SEAM_OK(check_units(options_, frame_, reference.file));
        // The recorded part in another unit than the taught one; what cannot be read shows in the run.
        if (Frame other;
            !recorded.image && recorded.file != reference.file && read_recorded(recorded, layout_, 0, other))
            SEAM_OK(check_units(options_, other, recorded.file));
        if (options_.feature.kind == "template") {
            auto cut = cut_from_frame(spot);
            if (!cut || !*cut) return cut;
        }
        SEAM_TRY(auto measurer, SpotMeasurer::make(result_.project, spot.id));
        const SpotMeasurement& measured = measurer.measure(frame_);
        spot.reference_profile = measurer.profile();
        if (measured.status != SpotStatus::measured) {
            result_.notes.push_back(Text("spot {}: {} ({}), switched off", spot.id,
                                         to_string(measured.status), measured.message));
            return false;
        }
        spot.reference_mm = measured.measured_mm;
        spot.enabled = spot.required = true;
        return true;
    }

    Expected<bool> cut_from_frame(Spot& spot) {
        const Calibration& calibration = result_.project.calibrations.front();
        StripePeaks peaks;
        Capture capture;
        Profile taught_profile;
        Text message;
        if (capture_frame(frame_, options_.peaks, calibration.model ? &*calibration.model : nullptr, peaks,
                          capture, message) != SpotStatus::measured) {
            result_.notes.push_back(Text("spot {}: {}, switched off", spot.id, message));
            return false;
        }
        if (auto tracked = track_capture(capture, options_.filter, taught_profile); !tracked) {
            result_.notes.push_back(Text("spot {}: {}, switched off", spot.id, tracked.error().text()));
            return false;
        }
        SEAM_OK(cut_template(options_, taught_profile, spot));
        return true;
    }

    Expected<void> nothing_found() const {
        if (unreadable_) return tl::unexpected(*unreadable_);  // file and line of the first
        Error error{ErrorKind::input, "no feature was found in any frame", folder_.string(),
                    "try another feature, or see with --look how the files are understood"};
        if (!result_.notes.empty()) error.what = Text("{} ({})", error.what, result_.notes.back());
        return tl::unexpected(error);
    }

    const FolderImport& options_;
    RecordingLayout layout_;
    fs::path folder_;
    std::vector<RecordedFrame> frames_, taught_;
    FolderImportResult result_;
    Frame frame_;                      // of the spot that is taught
    std::optional<Error> unreadable_;  // the first
};

}  // namespace

Expected<FolderImportResult> import_folder(const FolderImport& options) {
    return FolderImporter(options).import();
}

}  // namespace seamwright
