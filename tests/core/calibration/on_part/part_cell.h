#pragma once
// Passes of a sensor over edges, made without a line of what solves them: quaternions and bisection of its own. Frames:
// base, flange, sensor; an edge is a curve in the base.

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/calibration/on_part/on_part.h"

namespace seamwright::part_cell {

using Curve = std::function<Eigen::Vector3d(double)>;  // of about the way along it, mm, around 0

struct Noise {
    double point_mm = 0;                     // of each coordinate
    double pass_mm = 0, pass_deg = 0;        // the robot's, common to a pass
    double profile_mm = 0, profile_deg = 0;  // the robot's, of every profile
};

struct Motion {
    double length_mm = 20;  // along the edge
    double aside_mm = 4;    // S across it
    double turn_deg = 5;    // within the pass, peak to peak
    double speed_mm_s = 50;
    int profiles = 40;
};

class Cell {
  public:
    explicit Cell(unsigned seed) : random_(seed) {
        const Eigen::Quaterniond r = rotation();
        mounting_ = Eigen::Translation3d(uniform(-150, 150), uniform(-150, 150), uniform(80, 250)) * r;
        // The sensor looks down its Z on the part; the edge runs about along its Y.
        look_ = Eigen::Translation3d(uniform(600, 1200), uniform(-500, 500), uniform(200, 600)) * rotation();
    }

    double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
    double normal(double sigma) { return std::normal_distribution<double>(0, 1)(random_) * sigma; }
    Eigen::Quaterniond rotation() {
        return Eigen::Quaterniond(normal(1), normal(1), normal(1), normal(1)).normalized();
    }
    Eigen::Vector3d vector(double sigma) { return {normal(sigma), normal(sigma), normal(sigma)}; }

    // In the nominal sensor's axes, through its origin, along its Y turned by `yaw` about its Z.
    Curve straight(double yaw_deg = 0, double pitch_deg = 0) const {
        const Eigen::Vector3d d = direction(yaw_deg, pitch_deg);
        return [this, d](double u) { return Eigen::Vector3d(look_ * (u * d)); };
    }
    Curve round(double radius_mm, double yaw_deg = 0, double roll_deg = 30) const {
        const Eigen::Vector3d d = direction(yaw_deg, 0);
        const Eigen::Vector3d n = Eigen::AngleAxisd(roll_deg * kDeg, d) * d.unitOrthogonal();
        return [=, this](double u) {
            return Eigen::Vector3d(look_ * (radius_mm * std::sin(u / radius_mm) * d +
                                            radius_mm * (1 - std::cos(u / radius_mm)) * n));
        };
    }
    // Two waves across, of different lengths.
    Curve wavy(double height_mm, double yaw_deg = 0) const {
        const Eigen::Vector3d d = direction(yaw_deg, 0), n = d.unitOrthogonal(), b = d.cross(n);
        return [=, this](double u) {
            return Eigen::Vector3d(look_ * (u * d + height_mm * std::sin(u / 19) * n +
                                            0.7 * height_mm * std::cos(u / 27 + 0.4) * b));
        };
    }

    const Eigen::Isometry3d& mounting() const { return mounting_; }

    // One pass: the sensor leans by `lean` (deg, about its X, Y, Z) against the nominal attitude, stands off by (x, z).
    EdgePass pass(const std::string& id, const std::string& edge, const Curve& curve,
                  const Eigen::Vector3d& lean_deg, const Eigen::Vector2d& off_mm, double sign,
                  const Motion& m, const Noise& noise, double latency_s, bool covariance = false) {
        EdgePass pass{id, edge, {}};
        const Eigen::Isometry3d wrong = small(noise.pass_mm, noise.pass_deg);
        const double phase = uniform(0, 6.28), phase2 = uniform(0, 6.28);
        const double duration = m.length_mm / m.speed_mm_s;
        const auto flange = [&](double t) {
            const double along = sign * (t / duration - 0.5) * m.length_mm;
            const double w = 2 * M_PI / duration;
            const double half = 0.5 * m.turn_deg;
            const Eigen::Vector3d turn(half * std::sin(w * t + phase), half * std::cos(0.8 * w * t + phase2),
                                       half * std::sin(0.7 * w * t + phase2));
            const Eigen::Vector3d across(off_mm.x() + 0.5 * m.aside_mm * std::sin(w * t + phase2), 0,
                                         off_mm.y() + 0.5 * m.aside_mm * std::cos(w * t + phase));
            Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();
            sensor.linear() = look_.linear() * turned(lean_deg + turn);
            sensor.translation() = curve(along) - sensor.linear() * across;
            return Eigen::Isometry3d(sensor * mounting_.inverse());
        };
        for (int k = 0; k < m.profiles; ++k) {
            const double t = duration * k / (m.profiles - 1);
            const Eigen::Isometry3d sensor = flange(t - latency_s) * mounting_;
            const double u = cut(curve, sensor, sign * ((t - latency_s) / duration - 0.5) * m.length_mm);
            const Eigen::Vector3d seen = sensor.inverse() * curve(u);
            EdgeProfile p;
            p.time_s = 100 + t;
            p.point_mm = {seen.x() + normal(noise.point_mm), seen.z() + normal(noise.point_mm)};
            if (covariance) p.covariance_mm2 = noise.point_mm * noise.point_mm * Eigen::Matrix2d::Identity();
            p.base_from_flange = flange(t) * wrong * small(noise.profile_mm, noise.profile_deg);
            pass.profiles.push_back(p);
        }
        return pass;
    }

    // Twelve passes and more: both directions, leaning about X, Y, Z, aside and higher.
    std::vector<EdgePass> passes(const std::vector<Curve>& curves, int count, double lean_deg,
                                 const Motion& m, const Noise& noise, double latency_s,
                                 bool covariance = false) {
        std::vector<EdgePass> list;
        for (int i = 0; i < count; ++i) {
            const auto e = static_cast<std::size_t>(i) % curves.size();
            const Eigen::Vector3d lean(uniform(-lean_deg, lean_deg), uniform(-lean_deg, lean_deg),
                                       uniform(-lean_deg, lean_deg));
            const Eigen::Vector2d off(uniform(-5, 5), uniform(-5, 5));
            list.push_back(pass("P" + std::to_string(i + 1), "e" + std::to_string(e + 1), curves[e], lean,
                                off, (i / static_cast<int>(curves.size())) % 2 ? -1 : 1, m, noise, latency_s,
                                covariance));
        }
        return list;
    }

    static constexpr double kDeg = M_PI / 180;

  private:
    static Eigen::Vector3d direction(double yaw_deg, double pitch_deg) {
        return Eigen::AngleAxisd(yaw_deg * kDeg, Eigen::Vector3d::UnitZ()) *
               (Eigen::AngleAxisd(pitch_deg * kDeg, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitY());
    }
    static Eigen::Matrix3d turned(const Eigen::Vector3d& deg) {
        return (Eigen::AngleAxisd(deg.z() * kDeg, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(deg.y() * kDeg, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(deg.x() * kDeg, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    }
    Eigen::Isometry3d small(double mm, double deg) {
        const Eigen::Vector3d w = vector(deg * kDeg), t = vector(mm);
        Eigen::Isometry3d e = Eigen::Isometry3d::Identity();
        if (w.norm() > 0) e.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
        e.translation() = t;
        return e;
    }
    // Where the curve goes through the laser plane, near `guess`.
    static double cut(const Curve& curve, const Eigen::Isometry3d& sensor, double guess) {
        const Eigen::Isometry3d back = sensor.inverse();
        const auto y = [&](double u) { return (back * curve(u)).y(); };
        double a = guess, b = guess;
        for (double step = 0.5; y(a) * y(b) > 0 && step < 200; step *= 1.5)
            a = guess - step, b = guess + step;
        const double low = y(a);
        for (int i = 0; i < 200 && std::abs(b - a) > 1e-13; ++i) {
            const double c = 0.5 * (a + b);
            (y(c) * low > 0 ? a : b) = c;
        }
        return 0.5 * (a + b);
    }

    std::mt19937 random_;
    Eigen::Isometry3d mounting_ = Eigen::Isometry3d::Identity(), look_ = Eigen::Isometry3d::Identity();
};

}  // namespace seamwright::part_cell
