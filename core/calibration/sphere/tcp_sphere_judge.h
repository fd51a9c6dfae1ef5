#pragma once
// The verdict on a sphere's calibration.

#include <limits>

#include "core/calibration/sphere/tcp_sphere.h"

namespace seamwright::tcp_sphere {

inline constexpr double kGoodTcp_mm = 0.1, kUsableTcp_mm = 0.5;  // three sigma at the working distance

struct SphereFit {
    double used = 0;  // poses
    bool few_agree = false, robot_stated = false;
    double better_radius = std::numeric_limits<double>::quiet_NaN(), radius = 0;
};

// Sets result.fits.
Judgement judge_sphere(const SphereFit& fit, TcpSphereResult& result);

// What the poses leave open, or cannot decide between.
Judgement undetermined_sphere(const TcpSphereResult& result, bool weak);

}  // namespace seamwright::tcp_sphere
