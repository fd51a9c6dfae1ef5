#pragma once
// A path corrected by a stored run, what is said of it, and the files that it becomes.

#include <cstdint>
#include <string>
#include <vector>

#include "devices/robot_program.h"
#include "projects/file/project_file.h"
#include "projects/path/path_source.h"

namespace seamwright {

struct CorrectedByRun {
    std::int64_t run = 0;
    Project setup;  // as the run was made with
    PathFrame frame = PathFrame::base;
    bool closed = false;
    PathAnswer answer;
};

// By run `run` of the file, 0: the newest. `blend.closed` is added to what the source says. Error (input): no run, what
// correct_application_path() refuses; (usage) no such run.
Expected<CorrectedByRun> correct_by_run(const ProjectFile& file, std::int64_t run, const PathSource& source,
                                        PathBlendOptions blend);

struct PathRegionFigures {
    std::string id;
    int points = 0, blended = 0;  // by its displacement alone; in a transition from or to it
};
struct PathFigures {
    double largest_shift_mm = 0, largest_sigma_mm = 0;
    std::vector<PathRegionFigures> regions;
};
PathFigures figures_of(const PathAnswer& answer);

// Of point i, work object: as taught.
Eigen::Vector3d taught_mm(const PathCorrection& point);

struct PathProgramWords {
    std::string name = "seamwright_path";  // of files and program
    double speed_mm_s = 100, rounding_mm = 2;
};
// NAME.csv in the brand's notation, and its program; both in the frame in which the path was given. Error (input): the
// brand writes no paths, a name that is none.
Expected<std::vector<ProgramFile>> corrected_path_files(const CorrectedByRun& corrected,
                                                        const std::string& brand,
                                                        const PathProgramWords& words);

}  // namespace seamwright
