#include "projects/path/corrected_path.h"

#include <fmt/format.h>

#include <algorithm>

#include "devices/registry.h"

namespace seamwright {

Expected<CorrectedByRun> correct_by_run(const ProjectFile& file, std::int64_t run, const PathSource& source,
                                        PathBlendOptions blend) {
    if (run == 0) {
        SEAM_TRY(const auto runs, file.runs());
        if (runs.empty())
            return input_error("the project has no run to correct the path by", file.path().string(),
                               "measure with `seamwright run` first");
        run = runs.back().number;
    }
    blend.closed = blend.closed || source.closed;
    SEAM_TRY(const auto record, file.load_run(run, false));
    CorrectedByRun corrected{run, {}, source.frame, blend.closed, {}};
    SEAM_TRY(corrected.setup, file.load_run_setup(run));
    SEAM_TRY(corrected.answer,
             correct_application_path(corrected.setup, record, source.path, source.frame, blend));
    return corrected;
}

Eigen::Vector3d taught_mm(const PathCorrection& point) {
    return point.displacement.workobject_from_movedworkobject.inverse() *
           point.workobject_from_tool.translation();
}

PathFigures figures_of(const PathAnswer& a) {
    PathFigures figures;
    for (const std::string& id : a.region_ids) figures.regions.push_back({id});
    for (const PathCorrection& p : a.corrected.points) {
        const auto from = static_cast<std::size_t>(p.region), to = static_cast<std::size_t>(p.next);
        if (p.share <= 0 || p.share >= 1) {
            ++figures.regions[p.share >= 1 ? to : from].points;
        } else {
            ++figures.regions[from].blended;
            if (to != from) ++figures.regions[to].blended;
        }
        figures.largest_sigma_mm = std::max(figures.largest_sigma_mm, p.sigma_mm);
        figures.largest_shift_mm =
            std::max(figures.largest_shift_mm, (p.workobject_from_tool.translation() - taught_mm(p)).norm());
    }
    return figures;
}

Expected<std::vector<ProgramFile>> corrected_path_files(const CorrectedByRun& corrected,
                                                        const std::string& brand,
                                                        const PathProgramWords& words) {
    SEAM_TRY(const auto notation, path_notation_from(brand));
    std::vector<ProgramFile> files{{words.name + ".csv", path_csv(corrected.answer.path, notation)}};
    PathProgramRequest request;
    request.name = words.name;
    request.comment = fmt::format("{}: path corrected by run {}", corrected.setup.name, corrected.run);
    if (corrected.frame == PathFrame::workobject)
        request.base_from_frame = corrected.setup.part.base_from_workobject;
    request.speed_mm_s = words.speed_mm_s;
    request.rounding_mm = words.rounding_mm;
    for (const ApplicationPoint& p : corrected.answer.path.points)
        request.frame_from_tool.push_back(p.frame_from_tool);
    if (corrected.closed) request.frame_from_tool.push_back(request.frame_from_tool.front());
    SEAM_TRY(auto program, write_robot_path(brand, request));
    files.insert(files.end(), program.begin(), program.end());
    return files;
}

}  // namespace seamwright
