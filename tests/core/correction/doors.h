#pragma once
// Simulated doors: spots around a contour of about 1.0 x 0.7 m, displaced, measured where the edge pierces
// the laser plane.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright::testing_doors {

using Rng = std::mt19937_64;

inline double uniform(Rng& rng, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
}
inline Eigen::Vector3d gaussian(Rng& rng) {
    std::normal_distribution<double> n;
    const double x = n(rng), y = n(rng), z = n(rng);
    return {x, y, z};
}
inline Eigen::Matrix3d any_rotation(Rng& rng) {
    std::normal_distribution<double> n;
    const double w = n(rng), x = n(rng), y = n(rng), z = n(rng);
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

// Spots evenly around a door's contour with jitter; the edge runs along the contour, tilted at random, the
// sensor is turned about the edge at random, and the reference lies anywhere in the sensor's field of view.
inline std::vector<SpotObservation> door(Rng& rng, int spots,
                                         const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
    std::vector<SpotObservation> out;
    for (int n = 0; n < spots; ++n) {
        const double t = 2 * kPi * (n + uniform(rng, -0.3, 0.3)) / spots;
        const Eigen::Vector3d p(500 * std::cos(t), 350 * std::sin(t),
                                60 * std::cos(2 * t) + uniform(rng, -20, 20));
        const Eigen::Vector3d along(-500 * std::sin(t), 350 * std::cos(t), -120 * std::sin(2 * t));
        const Eigen::Vector3d edge = (along.normalized() + 0.4 * gaussian(rng)).normalized();
        SpotObservation s;
        s.id = fmt::format("S{}", n + 1);
        s.reference_mm = Eigen::Vector3d(uniform(rng, -20, 20), 0, uniform(rng, -15, 15));
        const Eigen::Matrix3d r =
            rotation_between(Eigen::Vector3d::UnitY(), edge) *
            Eigen::AngleAxisd(uniform(rng, -kPi, kPi), Eigen::Vector3d::UnitY()).toRotationMatrix();
        s.workobject_from_sensor = make_pose(r, offset + p - r * s.reference_mm);
        out.push_back(s);
    }
    return out;
}

// Turned about the centre of the door, so that the spots move by about `mm` wherever the origin is.
inline Pose random_displacement(Rng& rng, double mm, double deg, const Eigen::Vector3d& centre) {
    const Eigen::Matrix3d r = rotation_exp(rad_from_deg(uniform(rng, 0, deg)) * gaussian(rng).normalized());
    const Eigen::Vector3d t = uniform(rng, 0, mm) * gaussian(rng).normalized();
    return make_pose(r, t + centre - r * centre);
}

// Where the displaced straight edge (through the reference, along the sensor's Y) pierces the plane y = 0.
inline Eigen::Vector3d pierce(const SpotObservation& s, const Pose& displacement) {
    const Pose m = s.workobject_from_sensor.inverse() * displacement * s.workobject_from_sensor;
    const Eigen::Vector3d p = m * s.reference_mm, d = m.linear().col(1);
    return p - d * (p.y() / d.y());
}

// Spots that observe Y see the displaced reference itself, the others the edge.
inline void measure(std::vector<SpotObservation>& spots, const Pose& displacement) {
    for (SpotObservation& s : spots) {
        const Pose& w = s.workobject_from_sensor;
        if (s.weights.y() > 0)
            s.measured_mm = w.inverse() * displacement * w * s.reference_mm;
        else
            s.measured_mm = pierce(s, displacement);
    }
}

inline void add_noise(std::vector<SpotObservation>& spots, Rng& rng, double sigma) {
    for (SpotObservation& s : spots) {
        const Eigen::Vector3d e = sigma * gaussian(rng);
        for (int i = 0; i < 3; ++i) {
            if (s.weights[i] > 0) s.measured_mm[i] += e[i];
        }
    }
}

// A spot at `position` whose edge runs along `edge`.
inline SpotObservation spot(const std::string& id, const Eigen::Vector3d& position,
                            const Eigen::Vector3d& edge) {
    SpotObservation s;
    s.id = id;
    s.workobject_from_sensor = make_pose(rotation_between(Eigen::Vector3d::UnitY(), edge), position);
    return s;
}

}  // namespace seamwright::testing_doors
