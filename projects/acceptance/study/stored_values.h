#pragma once
// Study values from the runs that a project's file holds.
//
// Measurand. The bead runs along the contour at the region's spots: the tangent there is the sensor's travel
// direction, turned into the contour's own where its curve was learnt; the normal is what of the sensor's viewing
// direction (z) stands across it, the binormal is across both. The value of a run is
//     n . (D p - p),    p the spot's reference point, n normal or binormal, work object, mm
// and where the part's displacement is known it has the reference n . (D_true p - p). Value minus reference is
// the deviation of the bead after correction. Studied is the worst of the region's points and directions: that of
// the largest mean square of value minus reference, or minus the part's mean where there is no reference.
//
// Runs. The unmoved part (zero_shift.h) is the reference part of type 1 and stability, its reference 0; any other
// part can be named instead. The newest
// known-shift proof, with the displacements as references, is linearity. All other parts are type 3, by their ids, as live_study.h
// names their rehangs; those measured once or hung less often are left out, and of more runs than the least often
// measured of the rest has the older ones.
// A run whose correction the gate refused is left out, and one made with another setup than the newest of its kind:
// another setup is another measuring process.

#include <string>

#include "projects/acceptance/study/studies.h"
#include "projects/batch/parts.h"
#include "projects/file/project_file.h"

namespace seamwright {

struct StoredStudy {
    StudyValues values;
    StudySource source;
    std::string reference_part;  // the unmoved part, where it was measured; else empty
};

// `region` may be empty where the project has one. Error (usage, input): an unknown region, several and none
// named, no usable run; (file): the file.
// `parts`: what others read of the runs (stored_values_part), collected.
Expected<StoredStudy> stored_values(const ProjectFile& file, const std::string& region,
                                    Parts* parts = nullptr);
// The same of a project that is not saved yet.
Expected<StoredStudy> stored_values(const ProjectFile& file, const Project& project,
                                    const std::string& region, Parts* parts = nullptr);
// What one of several processes reads of the runs, into its part.
Expected<void> stored_values_part(const ProjectFile& file, const std::string& region, Parts& part);

// What is predicted before anything was measured, of the worst of the region's path points and directions; EV of
// parts that lie as taught. Error (input): no calibrated spot, under-determined.
Expected<StudyForecast> forecast_studies(const Project& project, const Region& region);

// Sensor and robot of a spot with their serials, and whether they are simulated.
void name_devices(StudySource& source, const Project& setup, const Spot& spot);

// References of the parts from another instrument, matched by part: mean value of each part of `table`. They make
// the correlation.
void add_references(StudyValues& values, const std::vector<StudyValue>& table);

}  // namespace seamwright
