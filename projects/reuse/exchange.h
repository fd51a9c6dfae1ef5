#pragma once
// The project for other programs: JSON of everything but blobs, profiles as CSV, PLY or PCD; and the other
// way round, a project from a folder of profiles or camera images with robot poses, without any device.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

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
// frame; PLY/PCD: points in base, millimetres). Returns the files written.
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
    Pose flange_from_sensor = Pose::Identity();
    Pose base_from_workobject = Pose::Identity();
    PeakOptions peaks;
    FilterOptions filter;
    double sigma_mm = 0.05;
    CorrectionLimits limits{25.0, 3.0};
};

struct FolderImportResult {
    Project project;
    bool in_pixels = false;          // no calibration: one pixel counts as one unit, nothing can be pushed
    std::vector<std::string> notes;  // spots without feature, frames without pose, ...
};

// One spot per frame (id = file stem), one region of all spots, sensor and robot of the driver `replay` on
// the folder. References come from the reference folder, by equal stem.
Expected<FolderImportResult> import_folder(const FolderImport& options);

}  // namespace seamwright
