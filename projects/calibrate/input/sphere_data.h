#pragma once
// Observations of a sphere as they stand in tcp-sphere and drift data.

#include <nlohmann/json.hpp>

#include "core/calibration/sphere/tcp_sphere.h"

namespace seamwright {

// {"id"?,"base_from_flange":POSE,"profile":[[x,z],..]}; null for a point or its z = no return.
Expected<SphereObservation> parse_sphere_observation(const nlohmann::json& entry, std::size_t index,
                                                     const std::string& where);

// The data of tcp-sphere.
struct SphereData {
    std::vector<SphereObservation> observations;
    TcpSphereOptions options;
};
Expected<SphereData> parse_sphere_data(const nlohmann::json& data, const std::vector<std::string>& exclude);

}  // namespace seamwright
