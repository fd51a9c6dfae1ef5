#pragma once
// Profiles with their robot poses as one cloud in the robot's base: base_from_flange(t) * flange_from_sensor * (x, 0, z).

#include "core/cloud/cloud.h"
#include "projects/file/project_file.h"
#include "projects/panel/gap_check.h"

namespace seamwright {

struct ScanResult {
    Cloud cloud;  // base
    std::uint64_t profiles = 0, without_profile = 0, without_pose = 0;
    std::size_t outliers = 0;    // left out by clean()
    double travel_sigma_mm = 0;  // GapPass's
    std::string sensor_id;       // empty: not known
};

// Of a pass along a path (recorded, or driven spot by spot: gap_pass).
ScanResult scan_of_pass(const Project& project, const GapPass& pass);
// Of a stored run: the profile at every spot that was measured. Error (input): no such run, no profile in it.
Expected<ScanResult> scan_of_run(const ProjectFile& file, std::int64_t run);
// Thins to cells of cell_mm (0: not) and leaves statistical outliers out.
void clean(ScanResult& scan, double cell_mm);

}  // namespace seamwright
