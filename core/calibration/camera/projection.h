#pragma once
// The camera model of camera.h for any number type, automatic derivatives among them. Private to
// core/calibration/camera.

#include <Eigen/Core>

namespace seamwright {

// k: fx, fy, cx, cy, k1, k2, p1, p2, k3. Pixel of the ray (x, y, 1).
template <class K, class T>
Eigen::Matrix<T, 2, 1> pixel_of_ray(const K* k, const T& x, const T& y) {
    const T s = x * x + y * y, xy = x * y;
    const T radial = s * (s * (s * k[8] + k[5]) + k[4]) + 1.0;
    return {(x * radial + xy * k[6] * 2.0 + (s + x * x * 2.0) * k[7]) * k[0] + k[2],
            (y * radial + (s + y * y * 2.0) * k[6] + xy * k[7] * 2.0) * k[1] + k[3]};
}

// Its derivative by (x, y).
template <class K, class T>
Eigen::Matrix<T, 2, 2> pixel_by_ray(const K* k, const T& x, const T& y) {
    const T s = x * x + y * y;
    const T radial = s * (s * (s * k[8] + k[5]) + k[4]) + 1.0;
    const T slope = (s * (s * k[8] * 3.0 + k[5] * 2.0) + k[4]) * 2.0;  // d radial / d s, twice
    const T xx = radial + x * x * slope + y * k[6] * 2.0 + x * k[7] * 6.0;
    const T xy = x * y * slope + x * k[6] * 2.0 + y * k[7] * 2.0;
    const T yy = radial + y * y * slope + y * k[6] * 6.0 + x * k[7] * 2.0;
    Eigen::Matrix<T, 2, 2> out;
    out << xx * k[0], xy * k[0], xy * k[1], yy * k[1];
    return out;
}

}  // namespace seamwright
