#pragma once
// What the stored runs of a file tell of how a region's parts bend.
//
// Usable is a run, dry or pushed, that measured the region and was made with the region's spots, sensors and
// calibrations as they are now. Refused ones count too: a bent part is what a rigid correction refuses. Runs of
// one part are one part; runs without a part's name are parts of their own.

#include <string>
#include <vector>

#include "projects/file/project_file.h"
#include "projects/measure/measure.h"

namespace seamwright {

struct StoredShape {
    LearntRun run;
    std::vector<SpotObservation> observations;  // with the travel's covariance
    Displacement displacement;                  // rigid, all spots
};

struct StoredShapes {
    std::string region_id;
    std::vector<ElasticSpot> spots;  // enabled and calibrated spots of the region
    std::vector<StoredShape> shapes;
    CorrectionOptions options;
    int other_setup = 0;  // runs left out: made with other spots or calibrations
    int too_little = 0;   // runs left out: not measured, or too few spots
};

// `region` may be empty where the project has one. Error (usage): an unknown region, several and none named;
// (input): no usable run; (file).
Expected<StoredShapes> stored_shapes(const ProjectFile& file, const std::string& region);

}  // namespace seamwright
