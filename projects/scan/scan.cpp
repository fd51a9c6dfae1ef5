#include "projects/scan/scan.h"

#include "projects/measure/measure.h"

namespace seamwright {

ScanResult scan_of_pass(const Project& project, const GapPass& pass) {
    ScanResult scan;
    scan.without_pose = pass.without_pose;
    scan.travel_sigma_mm = pass.travel_sigma_mm;
    scan.sensor_id = pass.sensor_id;
    for (const GapSection& section : pass.sections) {
        const std::size_t before = scan.cloud.size();
        append_profile(scan.cloud, section.profile,
                       project.part.base_from_workobject * section.frame_from_sensor);
        ++(scan.cloud.size() > before ? scan.profiles : scan.without_profile);
    }
    return scan;
}

Expected<ScanResult> scan_of_run(const ProjectFile& file, std::int64_t run_number) {
    SEAM_TRY(auto run, file.load_run(run_number));
    SEAM_TRY(auto setup, file.load_run_setup(run_number));
    ScanResult scan;
    for (const SpotMeasurement& m : run.spots) {
        if (m.capture < 0 || static_cast<std::size_t>(m.capture) >= run.captures.size()) continue;
        const Capture& capture = run.captures[static_cast<std::size_t>(m.capture)];
        SEAM_TRY(auto measurer, SpotMeasurer::make(setup, m.spot_id));
        measurer.measure(capture);
        const Calibration* calibration = calibration_of(setup, measurer.spot());
        const Pose base_from_flange = capture.base_from_flange.value_or(measurer.spot().base_from_flange);
        const std::size_t before = scan.cloud.size();
        append_profile(scan.cloud, measurer.profile(),
                       base_from_flange * (calibration ? calibration->flange_from_sensor : Pose::Identity()));
        ++(scan.cloud.size() > before ? scan.profiles : scan.without_profile);
    }
    if (scan.cloud.empty())
        return input_error(Text("run {} holds no profile", run_number), file.path().string(),
                           "choose a run that measured its spots");
    return scan;
}

void clean(ScanResult& scan, double cell_mm) {
    if (cell_mm > 0) scan.cloud = voxel_grid(scan.cloud, cell_mm);
    const std::vector<char> keep = statistical_inliers(scan.cloud);
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < keep.size(); ++i)
        if (keep[i]) index.push_back(i);
    scan.outliers = scan.cloud.size() - index.size();
    scan.cloud = picked(scan.cloud, index);
}

}  // namespace seamwright
