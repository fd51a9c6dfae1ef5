#pragma once
// A laser-stripe sensor on a flange that looks at a sphere on a post above a table.

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/calibration/sphere/tcp_sphere.h"

namespace seamwright::simulation {

struct SphereCell {
    Pose flange_from_sensor = Pose::Identity();
    Eigen::Vector3d centre_base{1250, -310, 640};
    double radius = 12.7;
    double noise_mm = 0.03;
    double step_mm = 0.15;                   // spacing along x
    double half_width_mm = 32;               // of the field of view
    double steepest_deg = 62;                // arc seen either side of the top
    Eigen::Vector3d working_point{0, 0, 0};  // where the sphere stands in the sensor frame, on average
    double tilt_deg = 30, turn_deg = 90;     // spread of the orientations
    double shift_x = 12, shift_y = 0.6, shift_z = 12;  // spread of the sphere in the view; y in radii
    bool table = true, post = true;
    double outliers = 0;  // share of stray points
    double robot_mm = 0, robot_deg = 0;
};

using Random = std::mt19937_64;
inline double uniform(Random& random, double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
}
inline double normal(Random& random, double sigma) {
    return sigma > 0 ? std::normal_distribution<double>(0, sigma)(random) : 0;
}
inline Eigen::Matrix3d any_rotation(Random& random) {
    Eigen::Quaterniond q(normal(random, 1), normal(random, 1), normal(random, 1), normal(random, 1));
    return q.normalized().toRotationMatrix();
}

// Profile with the sphere's centre at `s` in the sensor frame. post_tilt leans the post within the laser
// plane.
inline Profile sphere_profile(const SphereCell& cell, const Eigen::Vector3d& s, Random& random) {
    Profile profile;
    const double rho2 = cell.radius * cell.radius - s.y() * s.y();
    const double rho = rho2 > 0 ? std::sqrt(rho2) : 0;
    const double reach = rho * std::sin(rad_from_deg(cell.steepest_deg));
    const double post_side = uniform(random, -1, 1) > 0 ? 1 : -1;
    for (double x = -cell.half_width_mm; x <= cell.half_width_mm; x += cell.step_mm) {
        const double dx = x - s.x();
        double z = std::numeric_limits<double>::quiet_NaN();
        if (std::abs(dx) <= reach) {
            z = s.z() + std::sqrt(rho2 - dx * dx);
        } else if (cell.post && dx * post_side > reach + 1 && dx * post_side < reach + 5) {
            z = s.z() - 0.4 * cell.radius - 3.0 * (dx * post_side - reach);
        } else if (cell.table && std::abs(dx) > 1.2 * cell.radius) {
            z = s.z() - 2.5 * cell.radius + 0.05 * x;
        }
        double px = x + normal(random, cell.noise_mm);
        z += normal(random, cell.noise_mm);
        if (cell.outliers > 0 && uniform(random, 0, 1) < cell.outliers) z = s.z() + uniform(random, -30, 30);
        profile.x_mm.push_back(px);
        profile.z_mm.push_back(z);
    }
    return profile;
}

inline Pose pose_for_view(const SphereCell& cell, const Eigen::Matrix3d& base_from_sensor,
                          const Eigen::Vector3d& s) {
    return make_pose(base_from_sensor, cell.centre_base - base_from_sensor * s) *
           cell.flange_from_sensor.inverse();
}

inline std::vector<SphereObservation> sphere_observations(const SphereCell& cell, int poses, Random& random) {
    std::vector<SphereObservation> observations;
    for (int i = 0; i < poses; ++i) {
        const double tilt = rad_from_deg(cell.tilt_deg);
        const Eigen::Matrix3d rotation =
            rotation_exp({uniform(random, -tilt, tilt), uniform(random, -tilt, tilt), 0}) *
            rotation_exp({0, 0, rad_from_deg(uniform(random, -cell.turn_deg, cell.turn_deg))});
        const Eigen::Vector3d s =
            cell.working_point + Eigen::Vector3d(uniform(random, -cell.shift_x, cell.shift_x),
                                                 cell.radius * uniform(random, -cell.shift_y, cell.shift_y),
                                                 uniform(random, -cell.shift_z, cell.shift_z));
        SphereObservation observation;
        observation.id = "P" + std::to_string(i + 1);
        observation.profile = sphere_profile(cell, s, random);
        const Pose truth = pose_for_view(cell, rotation, s);
        Vector6 robot;
        for (int k = 0; k < 3; ++k) robot[k] = normal(random, cell.robot_mm);
        for (int k = 3; k < 6; ++k) robot[k] = normal(random, rad_from_deg(cell.robot_deg));
        observation.base_from_flange = retract(truth, robot);
        observations.push_back(std::move(observation));
    }
    return observations;
}

inline SphereCell any_cell(Random& random) {
    SphereCell cell;
    cell.flange_from_sensor =
        make_pose(any_rotation(random),
                  {uniform(random, -150, 150), uniform(random, -150, 150), uniform(random, 0, 250)});
    return cell;
}

}  // namespace seamwright::simulation
