// What copies, moves and destroys the model's large types (core/value_type.h).

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

SEAM_VALUE_TYPE_MEMBERS(DriftWatch)
SEAM_VALUE_TYPE_MEMBERS(DriftPoint)
SEAM_VALUE_TYPE_MEMBERS(ActingDrift)
SEAM_VALUE_TYPE_MEMBERS(RegionModes)
SEAM_VALUE_TYPE_MEMBERS(ActingModes)
SEAM_VALUE_TYPE_MEMBERS(PanelPlace)
SEAM_VALUE_TYPE_MEMBERS(PanelJob)
SEAM_VALUE_TYPE_MEMBERS(SensorSetup)
SEAM_VALUE_TYPE_MEMBERS(RobotSetup)
SEAM_VALUE_TYPE_MEMBERS(Calibration)
SEAM_VALUE_TYPE_MEMBERS(Spot)
SEAM_VALUE_TYPE_MEMBERS(Region)
SEAM_VALUE_TYPE_MEMBERS(Project)
SEAM_VALUE_TYPE_MEMBERS(SpotMeasurement)
SEAM_VALUE_TYPE_MEMBERS(RegionRecord)
SEAM_VALUE_TYPE_MEMBERS(PanelMeasurement)
SEAM_VALUE_TYPE_MEMBERS(PanelRecord)
SEAM_VALUE_TYPE_MEMBERS(RunRecord)

}  // namespace seamwright
