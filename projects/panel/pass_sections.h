#pragma once
// What every way to make a pass of gap_check.h has in common: frames and poses become sections.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "projects/measure/measure.h"
#include "projects/panel/gap_check.h"
#include "projects/station/acquire.h"

namespace seamwright::passing {

// One sensor's frames become sections.
class Sections {
  public:
    static Expected<Sections> make(const Project& project, const std::string& sensor_id) {
        const SensorSetup* sensor = find_sensor(project, sensor_id);
        if (!sensor) return input_error(Text("the project has no sensor \"{}\"", sensor_id), project.name);
        const Calibration* calibration = calibration_of(project, sensor_id);
        if (!calibration)
            return input_error(Text("sensor {} has no calibration", sensor_id), project.name,
                               "calibrate it first");
        Sections s;
        s.sensor_ = *sensor;
        s.calibration_ = *calibration;
        s.workobject_from_base_ = project.part.base_from_workobject.inverse();
        s.pass.sensor_id = sensor_id;
        return s;
    }
    const Calibration& calibration() const { return calibration_; }

    void add(const Frame& frame, const Pose& base_from_flange) {
        Text message;
        const auto status =
            capture_frame(frame, sensor_.peaks, calibration_.model ? &*calibration_.model : nullptr, peaks_,
                          capture_, message);
        add(capture_, base_from_flange, status == SpotStatus::measured);
    }
    // An image that the capture kept is measured as on the day.
    void add(const Capture& c, const Pose& base_from_flange) {
        const auto& count = c.candidates.count;
        const bool candidates = std::any_of(count.begin(), count.end(), [](auto n) { return n > 0; });
        if (c.status == FrameStatus::ok && c.profile.size() == 0 && c.image) {
            Frame frame;
            frame.status = c.status;
            frame.image = c.image->view();
            return add(frame, base_from_flange);
        }
        add(c, base_from_flange, c.profile.size() > 0 || candidates);
    }
    GapPass pass;

  private:
    void add(const Capture& c, const Pose& base_from_flange, bool any) {
        GapSection& s = pass.sections.emplace_back();
        s.frame_from_sensor = workobject_from_base_ * base_from_flange * calibration_.flange_from_sensor;
        if (c.status != FrameStatus::ok) {
            ++pass.damaged;
        } else if (!any || !track_capture(c, sensor_.filter, s.profile)) {
            ++pass.without_profile;
            s.profile.clear();
        }
    }
    SensorSetup sensor_;
    Calibration calibration_;
    Pose workobject_from_base_;
    StripePeaks peaks_;
    Capture capture_;
};

struct PassDevices {
    std::string sensor_id, robot_id;
};
// The named ones; of a project with one of them alone that one. Error: none, several, unknown, no calibration.
Expected<PassDevices> devices_of(const Project& project, const std::string& sensor_id,
                                 const std::string& robot_id);

}  // namespace seamwright::passing
