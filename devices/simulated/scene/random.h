#pragma once
// Counter-based random numbers: the value depends on seed and counter alone, never on the order of calls.

#include <array>
#include <cmath>
#include <cstdint>

#include "core/geometry/pose.h"

namespace seamwright {

// splitmix64's finaliser: every bit of the key reaches every bit of the answer.
constexpr std::uint64_t hash64(std::uint64_t key) {
    key += 0x9E3779B97F4A7C15ULL;
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9ULL;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBULL;
    return key ^ (key >> 31);
}
constexpr std::uint64_t hash64(std::uint64_t a, std::uint64_t b) {
    return hash64(a ^ hash64(b));
}

// A stream of its own for one purpose of one exposure.
class Random {
  public:
    explicit Random(std::uint64_t seed) : key_(hash64(seed)) {}
    Random(std::uint64_t seed, std::uint64_t stream) : key_(hash64(seed, stream)) {}
    std::uint64_t bits() { return hash64(key_ + counter_++); }
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }  // [0, 1)
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    double normal() {  // Box-Muller
        const double r = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return r * std::cos(2.0 * kPi * uniform());
    }
    Eigen::Vector3d normal3() {
        const double x = normal(), y = normal(), z = normal();
        return {x, y, z};
    }

  private:
    std::uint64_t key_, counter_ = 0;
};

}  // namespace seamwright
