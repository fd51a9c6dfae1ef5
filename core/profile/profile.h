#pragma once
// The profile: what one cut of the laser plane with the part looks like, in the sensor frame.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace seamwright {

inline constexpr std::int32_t kOutlier = -1;  // segment number of an outlier or of "no return"

// Sensor frame: x along the laser line, z height, every point is (x, 0, z), millimetres, in sensor order (the
// order of the camera's lines). A point without return has z = NaN (x may be NaN too). Points are never
// removed; filtering marks them in `segment`.
struct Profile {
    std::vector<double> x_mm, z_mm;     // [n]
    std::vector<float> intensity;       // [n], or empty where the sensor gives none
    std::vector<std::int32_t> segment;  // [n] 0.. or kOutlier after filtering; empty before
    std::size_t size() const { return x_mm.size(); }
    bool filtered() const { return segment.size() == x_mm.size() && !x_mm.empty(); }
    void clear() {
        x_mm.clear();
        z_mm.clear();
        intensity.clear();
        segment.clear();
    }
};

// A profile whose lines may have several candidates (stripe and its reflections), strongest first: the input
// of stripe tracking. Flat [lines * per_line], `count[line]` of them valid.
struct ProfileCandidates {
    int lines = 0, per_line = 1;
    std::vector<std::uint8_t> count;
    std::vector<double> x_mm, z_mm;
    std::vector<float> intensity;
    int index(int line, int candidate) const { return line * per_line + candidate; }
};

}  // namespace seamwright
