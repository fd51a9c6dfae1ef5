#pragma once
// One description of every number that is set at a spot, a sensor, a region or a panel job and as requirement:
// range, unit, decimals, default. What edits or imports one reads it here.

#include <string>
#include <string_view>
#include <vector>

#include "core/parameter.h"
#include "projects/model/project.h"

namespace seamwright {

template <class T>
struct Field {
    ParameterInfo info;
    double (*get)(const T&);
    void (*set)(T&, double);
};

const std::vector<Field<Spot>>& spot_fields();  // entry_mm, exit_mm, speed_mm_s, sigma_mm, jitter_mm,
                                                // weight_x, weight_y, weight_z
const std::vector<Field<Requirements>>& requirement_fields();
const std::vector<Field<AcceptanceRequirements>>& acceptance_fields();
const std::vector<Field<Region>>& region_fields();   // limit_translation_mm, limit_rotation_deg,
                                                     // sigma_limit_mm, sigma_limit_deg
const std::vector<Field<PanelJob>>& panel_fields();  // those of a region, gap_tolerance_mm,
                                                     // flush_tolerance_mm, head_limit_mm, deviation
// What makes profiles of a sensor's frames: the peaks (SensorSetup::peaks) first, scan to steger_sigma_px, which only images
// need, then the stripe model (SensorSetup::filter), noise_mm to as_delivered.
const std::vector<Field<SensorSetup>>& sensor_fields();
inline constexpr std::size_t kPeakFields = 7;

// Error (input): not finite or out of range, with range and unit. Precondition (asserted): `name` is
// described.
Expected<void> set_field(Spot& spot, std::string_view name, double value);
Expected<void> set_field(Region& region, std::string_view name, double value);
Expected<void> set_field(PanelJob& job, std::string_view name, double value);
Expected<void> set_field(SensorSetup& sensor, std::string_view name, double value);
Expected<void> set_field(Requirements& requirements, std::string_view name, double value);

// Every field of a spot, region or panel job, and of a spot its recipe against its kind.
Expected<void> validate_fields(const Spot& spot);
Expected<void> validate_fields(const Region& region);
Expected<void> validate_fields(const PanelJob& job);
// And what two of its fields say together: widths, lookahead and shortest segment.
Expected<void> validate_fields(const SensorSetup& sensor);
Expected<void> validate_fields(const Requirements& requirements);  // with those of the acceptance
Expected<void> validate_fields(const AcceptanceRequirements& requirements);

}  // namespace seamwright
