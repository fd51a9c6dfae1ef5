#pragma once
// Opening an Aravis camera and its features by our names. For the .cpp files of this folder only.

#include <map>
#include <string>
#include <vector>

#include "core/parameter.h"
#include "devices/genicam/aravis_private.h"
#include "devices/genicam/genicam_settings.h"
#include "devices/profile_source.h"

namespace seamwright {

// The camera under our control. Error (device): nobody answers, another serial number, another program in
// control, a pixel format that cannot be read.
Expected<GPtr<ArvCamera>> open_camera(const GenicamSettings& settings);
SensorIdentity identity_of(ArvCamera* camera);
// IPv4 address; empty for other than GigE Vision.
std::string address_of(ArvCamera* camera);

// All but the trigger, in the order of genicam.h; then the trigger.
Expected<void> apply_settings(ArvCamera* camera, const GenicamSettings& settings);

// Part of the sensor that an image shows, px.
struct ImageField {
    int x = 0, y = 0, width = 0, height = 0;
    bool operator==(const ImageField&) const = default;
};
// A calibration holds for the sensor's own pixels, or for those that the settings name (or `changed`, by set()).
// Error (device): the camera's image begins elsewhere, is binned, thinned or mirrored, and nobody has said so. A cut
// at the far sides moves no pixel; range cameras say their coordinates themselves.
Expected<void> check_field(ArvCamera* camera, const GenicamSettings& settings,
                           const std::map<std::string, double>& changed);

// exposure_us, gain_db, frame_rate_hz, region_x, region_y, region_width, region_height, pixel_format (those
// that can be read), trigger: as far as the camera has them. default_value is the present value. Ends where the camera falls
// silent, and says so.
struct CameraParameters {
    std::vector<ParameterInfo> list;
    bool silent = false;
};
CameraParameters read_parameters(ArvCamera* camera);
// Error (device): silence.
Expected<double> get_parameter(ArvCamera* camera, const std::string& name);
Expected<void> set_parameter(ArvCamera* camera, const std::string& name, double value);
bool changes_stream(const std::string& parameter);  // needs the acquisition stopped

// From the Scan3d features; defaults where there are none. Error: a distance unit that is no length.
Expected<RangeMapping> range_mapping(ArvCamera* camera);

}  // namespace seamwright
