#pragma once
// The project for other programs: JSON of everything but blobs, profiles as CSV, PLY or PCD; and the other
// way round, a project from a folder of profiles or camera images with robot poses, without any device.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/profile/units.h"
#include "core/text.h"
#include "devices/replay/recording_layout.h"
#include "projects/file/project_file.h"

namespace seamwright {

// The whole project without blobs (mesh, raw profiles): poses as {"xyz","abc","matrix"}, numbers exact,
// non-finite ones as "nan", "inf", "-inf".
nlohmann::json export_project(const Project& project, bool with_profiles = false);
// With runs (results, no captures) and events.
Expected<nlohmann::json> export_file(const ProjectFile& file, bool with_profiles = false);
// The reverse of export_project; what export left out is empty. Error: input, naming the place in the
// document.
Expected<Project> import_project(const nlohmann::json& document, const std::string& where = {});

enum class ProfileFormat { csv, ply, pcd };
// Profiles of a run, one file per spot (`<spot>.csv`: x_mm,z_mm[,intensity],valid,segment in the sensor
// frame; PLY/PCD: points in base, millimetres), of a panel's run one per sensor, `<sensor>_before` and `<sensor>_after` the
// motion. Returns the files written.
Expected<std::vector<std::filesystem::path>> export_profiles(const ProjectFile& file, std::int64_t run,
                                                             ProfileFormat format,
                                                             const std::filesystem::path& folder);

struct FolderImport {
    std::filesystem::path folder;  // profile CSVs, or images (png, bmp, tif, jpg, pgm), with poses as the
                                   // replay driver reads them
    std::optional<std::filesystem::path>
        reference_folder;              // taught state; absent = `folder` itself is the taught state
    std::string project_name;          // empty = name of the folder
    FeatureRecipe feature;             // used at every spot
    std::optional<SensorModel> model;  // for images; absent = measured in pixels
    Verdict calibration_verdict = Verdict::undetermined;  // with `model` or for profiles
    // A calibration that was stored or solved before: its model, its place on the flange, covariance and
    // verdict count, and `model`, `calibration_verdict` and `flange_from_sensor` do not.
    std::optional<Calibration> calibration;
    Pose flange_from_sensor = Pose::Identity();
    Pose base_from_workobject = Pose::Identity();
    PeakOptions peaks;
    FilterOptions filter;
    RecordingLayout layout;  // what the files do not say themselves; a named unit is believed
    // Kind template: the taught profile is that of the reference frame, its piece these x (absent: all of
    // it), its landmark this point (absent: the piece's middle).
    std::optional<Eigen::Vector2d> piece_x_mm, template_reference_mm;
    // A robot that repeats to 0.1 mm (ISO 9283: three sigma) puts a coordinate there with 0.03; a region
    // whose spots are spread soundly then keeps its sigma limit below.
    double sigma_mm = 0.03;
    double sigma_limit_mm = 0.1;
    CorrectionLimits limits{25.0, 3.0};
};

struct FolderImportResult {
    Project project;
    bool in_pixels = false;   // no calibration: one pixel counts as one unit, nothing can be pushed
    std::vector<Text> notes;  // spots without feature, frames without pose, ...
    std::vector<std::string> understood;  // how the files were read, a sentence each
};

// What a recording is, before anything is made of it.
struct RecordingLook {
    struct File {
        std::string name, spot_id;
        std::string understood;  // or why it cannot be read
        bool readable = false, image = false;
        ProfileScale scale;                        // of the heights that are some
        Text no_returns;                           // what stands for none; empty: nothing
        std::vector<Eigen::Vector2d> first;        // points
        int width = 0, height = 0, bit_depth = 0;  // of an image
        std::optional<ChannelChoice> channel;
        std::optional<Pose> base_from_flange;
    };
    std::vector<File> files;              // the first `most`
    std::size_t frames = 0;               // in all
    std::vector<std::string> understood;  // of poses and of files with several profiles
    std::string problem;                  // why there are no poses or no frames
};
// Error: there is no such folder or file, or nothing in it.
Expected<RecordingLook> look_at_recording(const std::filesystem::path& source, const RecordingLayout& layout,
                                          std::size_t most = 5);

// One spot per frame (id = file stem), one region of all spots, sensor and robot of the driver `replay` on
// the folder. References come from the reference folder, by equal stem. Error (input) besides what the files
// give: a unit that must be said, a calibration of another image size or without a place on the flange, a
// piece without points.
Expected<FolderImportResult> import_folder(const FolderImport& options);

}  // namespace seamwright
