#pragma once
// Touches of a sphere or a point as a person makes them. Of its own: rotations by angle and axis, nothing of what is
// tried but the types.

#include <random>
#include <string>
#include <vector>

#include "core/calibration/nozzle/nozzle.h"

namespace seamwright::touches {

struct Cell {
    Eigen::Vector3d tip{12, -34, 215};
    Eigen::Vector3d centre{900, 150, 250};
    double radius = 25;
    double hand = 0, robot = 0, robot_turn = 0;  // one standard deviation an axis
    double tilt_deg = 25;                        // of the flange about any axis; 0: never turned
    unsigned seed = 1;

    Eigen::Vector3d normals() { return {normal_(random_), normal_(random_), normal_(random_)}; }
    void reseed(unsigned s) { random_.seed(s); }
    Eigen::Matrix3d attitude() {
        const double most = tilt_deg * 3.14159265358979 / 180;
        const Eigen::Vector3d axis = normals().normalized();
        const double angle = most * uniform_(random_);
        const Eigen::Matrix3d down =
            Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 0.2, 0.1).normalized()).matrix();
        return Eigen::AngleAxisd(angle, axis).matrix() * down;
    }
    // Where the tip really is, the flange's real attitude, and what the robot says of it.
    NozzleTouch reported(const std::string& id, const Eigen::Vector3d& tip_base, const Eigen::Matrix3d& r) {
        NozzleTouch touch;
        touch.id = id;
        const Eigen::Vector3d place = tip_base - r * tip + robot * normals();
        const Eigen::Vector3d turn = robot_turn * normals();
        const double angle = turn.norm();
        const Eigen::Matrix3d off = angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).matrix()
                                              : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        touch.base_from_flange.linear() = off * r;
        touch.base_from_flange.translation() = place;
        return touch;
    }
    NozzleTouch on_sphere(const std::string& id, const Eigen::Vector3d& side) {
        return reported(id, centre + (radius + hand * normal_(random_)) * side.normalized(), attitude());
    }
    NozzleTouch on_point(const std::string& id) {
        return reported(id, centre + hand * normals(), attitude());
    }
    // Upper half of the sphere, around it in turn.
    std::vector<NozzleTouch> sphere(int count) {
        std::vector<NozzleTouch> all;
        for (int i = 0; i < count; ++i) {
            const double round = 2.4 * i, height = i % 4 == 0 ? 2.0 : 0.15 + 0.2 * (i % 3);
            all.push_back(on_sphere("T" + std::to_string(i + 1), {std::cos(round), std::sin(round), height}));
        }
        return all;
    }
    std::vector<NozzleTouch> point(int count) {
        std::vector<NozzleTouch> all;
        for (int i = 0; i < count; ++i) all.push_back(on_point("T" + std::to_string(i + 1)));
        return all;
    }
    NozzleTarget target(bool is_sphere = true) const {
        NozzleTarget t;
        t.place_mm = centre;
        if (is_sphere) t.radius_mm = radius;
        return t;
    }

  private:
    std::mt19937 random_{seed};
    std::normal_distribution<double> normal_;
    std::uniform_real_distribution<double> uniform_{-1, 1};
};

}  // namespace seamwright::touches
