#pragma once
// Bent doors: a closed contour that bends and twists out of its plane, cut by the laser planes of spots along it.

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "core/elastic/bead_shape.h"

namespace seamwright::bent_doors {

using Rng = std::mt19937_64;

struct Bend {
    double bend = 0, twist = 0, bulge = 0;  // mm; the last one belongs to no learning
};
inline Eigen::Vector3d contour(double t) {
    return {500 * std::cos(t), 350 * std::sin(t), 40 * std::cos(2 * t)};
}
// Of the part as taught.
inline Eigen::Vector3d bent(double t, const Bend& b) {
    const Eigen::Vector3d p = contour(t);
    const double x = p.x() / 500, y = p.y() / 350;
    const double up = b.bend * x * x + b.twist * x * y + b.bulge * std::sin(3 * t);
    return p + Eigen::Vector3d(0, 0.2 * b.bend * x * x, up);
}

struct Door {
    std::vector<double> t;  // of the spots
    std::vector<SpotObservation> spots;
    Pose workobject_from_door = Pose::Identity();  // the contour stands so in the work object
};

inline Door door(int count, const Pose& placed = Pose::Identity()) {
    Door out;
    out.workobject_from_door = placed;
    for (int n = 0; n < count; ++n) {
        const double t = 2 * kPi * (n + 0.2 * std::sin(5.0 * n)) / count;
        const Eigen::Vector3d p = contour(t), along = (contour(t + 1e-5) - contour(t - 1e-5)).normalized();
        Eigen::Matrix3d axes;
        axes.col(1) = along;
        axes.col(2) = (Eigen::Vector3d::UnitZ() - along.z() * along).normalized();
        axes.col(0) = axes.col(1).cross(axes.col(2));
        SpotObservation s;
        s.id = fmt::format("S{}", n + 1);
        s.reference_mm = Eigen::Vector3d(3, 0, -2);
        s.workobject_from_sensor = placed * make_pose(axes, p - axes * s.reference_mm);
        s.sigma_mm = 0.03;
        out.t.push_back(t);
        out.spots.push_back(s);
    }
    return out;
}

// Where the displaced, bent contour pierces the laser planes, with noise of the stated sigma times `noise`, and times that of
// the spot in `of_spot` where it is given.
inline std::vector<SpotObservation> measured(const Door& door, const Pose& truth, const Bend& bend, Rng& rng,
                                             double noise = 1, const std::vector<double>& of_spot = {}) {
    std::vector<SpotObservation> out = door.spots;
    std::normal_distribution<double> normal;
    for (std::size_t n = 0; n < out.size(); ++n) {
        SpotObservation& s = out[n];
        const Pose sensor_from_door = s.workobject_from_sensor.inverse() * truth * door.workobject_from_door;
        double t = door.t[n];
        for (int i = 0; i < 20; ++i) {
            const double y = (sensor_from_door * bent(t, bend)).y();
            const double dy = ((sensor_from_door * bent(t + 1e-5, bend)).y() -
                               (sensor_from_door * bent(t - 1e-5, bend)).y()) /
                              2e-5;
            t -= y / dy;
        }
        const Eigen::Vector3d p = sensor_from_door * bent(t, bend);
        const double sigma = noise * s.sigma_mm * (of_spot.empty() ? 1 : of_spot[n]);
        s.measured_mm = Eigen::Vector3d(p.x() + sigma * normal(rng), 0, p.z() + sigma * normal(rng));
    }
    return out;
}

inline Pose small_motion(Rng& rng, double mm, double deg) {
    std::normal_distribution<double> n;
    const Eigen::Vector3d t(n(rng), n(rng), n(rng)), w(n(rng), n(rng), n(rng));
    return make_pose(rotation_exp(rad_from_deg(deg) * w), mm * t);
}

inline std::vector<ElasticSpot> slots(const Door& door) {
    std::vector<ElasticSpot> out;
    for (const SpotObservation& s : door.spots)
        out.push_back({s.id, s.workobject_from_sensor, s.reference_mm, s.weights});
    return out;
}

// Parts with independent normal amplitudes of the given sigmas.
inline std::vector<ElasticRow> rows(const Door& door, int parts, double bend, double twist, Rng& rng,
                                    double noise = 1, const std::vector<double>& of_spot = {}) {
    std::normal_distribution<double> n;
    std::vector<ElasticRow> out;
    for (int p = 0; p < parts; ++p) {
        const Bend b{bend * n(rng), twist * n(rng), 0};
        const auto spots = measured(door, small_motion(rng, 1, 0.1), b, rng, noise, of_spot);
        CorrectionOptions options;
        options.reject_outliers = false;
        const auto solved = solve_region(spots, options);
        auto row = elastic_row(slots(door), spots, options, solved->displacement);
        row->id = fmt::format("run {}", p + 1);
        row->part_id = fmt::format("part {}", p + 1);
        out.push_back(std::move(*row));
    }
    return out;
}

inline double arc_length(double t) {
    double sum = 0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i) sum += (contour(t * (i + 1) / kSteps) - contour(t * i / kSteps)).norm();
    return sum;
}
inline BeadPlace bead(const Door& door, double t) {
    return {door.workobject_from_door * contour(t), arc_length(t)};
}
// Directions across the bead as taught, work object: the one out of the door's plane first.
inline std::pair<Eigen::Vector3d, Eigen::Vector3d> across(const Door& door, double t) {
    const Eigen::Vector3d along = (contour(t + 1e-5) - contour(t - 1e-5)).normalized();
    const Eigen::Vector3d up = (Eigen::Vector3d::UnitZ() - along.z() * along).normalized();
    const Eigen::Matrix3d r = door.workobject_from_door.linear();
    return {r * up, r * along.cross(up)};
}
inline std::vector<BeadPlace> spot_places(const Door& door) {
    std::vector<BeadPlace> out;
    for (const double t : door.t) out.push_back(bead(door, t));
    return out;
}

}  // namespace seamwright::bent_doors
