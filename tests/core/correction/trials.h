#pragma once
// Trials of a whole estimation with everything drawn that errs: calibration, reference, robot, noise. Written
// from what happens, not from the linearised terms of the estimator.

#include <Eigen/Cholesky>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "tests/core/correction/doors.h"

namespace seamwright::testing_doors {

template <int N>
Eigen::Matrix<double, N, 1> draw(Rng& rng, const Eigen::Matrix<double, N, N>& covariance) {
    const Eigen::Matrix<double, N, N> root = covariance.llt().matrixL();
    std::normal_distribution<double> normal;
    Eigen::Matrix<double, N, 1> v;
    for (int i = 0; i < N; ++i) v[i] = normal(rng);
    return root * v;
}

// Correlated, with the given sigmas of translation and rotation.
inline Matrix6 some_covariance(Rng& rng, double mm, double deg) {
    Matrix6 mix;
    for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) mix(r, c) = uniform(rng, -1, 1) + (r == c ? 2.0 : 0.0);
    mix.rowwise().normalize();
    Vector6 size;
    size << Eigen::Vector3d::Constant(mm), Eigen::Vector3d::Constant(rad_from_deg(deg));
    return size.asDiagonal() * mix * mix.transpose() * size.asDiagonal();
}

struct World {
    std::vector<SpotObservation> spots;  // as stated: poses, priors; reference without error
    CorrectionOptions options;
};

// A door with two sensors.
struct Sizes {
    double hand_eye_mm = 0.2, hand_eye_deg = 0.15, scale = 0.003, shear = 0.002, reference_mm = 0.04,
           robot_mm = 0.03, robot_deg = 0.01, noise_mm = 0.03;
};
inline World world(Rng& rng, int spots, const Sizes& z = {}) {
    World w;
    w.spots = door(rng, spots, {900, -400, 250});
    for (const char* id : {"A", "B"}) {
        SensorPrior p;
        p.id = id;
        p.hand_eye_covariance = some_covariance(rng, z.hand_eye_mm, z.hand_eye_deg);
        p.scale_sigma = {z.scale, 0.7 * z.scale};
        p.shear_sigma = z.shear;
        w.options.sensors.push_back(p);
    }
    for (std::size_t n = 0; n < w.spots.size(); ++n) {
        SpotObservation& s = w.spots[n];
        s.sensor = n % 3 == 0 ? "B" : "A";
        s.sigma_mm = z.noise_mm;
        const double c = uniform(rng, -0.8, 0.8);
        s.reference_covariance_mm2 =
            (Eigen::Matrix2d() << 1, c, c, 1).finished() * z.reference_mm * z.reference_mm;
        s.robot_covariance = some_covariance(rng, z.robot_mm, z.robot_deg);
    }
    return w;
}

// What all parts have in common.
struct Truth {
    std::vector<Pose> eye;               // by sensor: calibrated_from_true
    std::vector<Eigen::Matrix3d> bent;   // true = bent * read
    std::vector<SpotObservation> spots;  // with the references as taught
};

inline Eigen::Vector3d pierced(const Pose& workobject_from_sensor, const Eigen::Vector3d& point,
                               const Eigen::Vector3d& along) {
    const Eigen::Vector3d p = workobject_from_sensor.inverse() * point,
                          d = workobject_from_sensor.linear().transpose() * along;
    return p - d * (p.y() / d.y());
}

class Trial {
  public:
    // The contour runs along the Y of the sensor as it truly sits, as the residual has it, or along the robot's
    // travel, which is the Y of the sensor as calibrated.
    enum class Contour { along_sensor, along_travel };
    Trial(Rng& rng, const World& w, Contour contour = Contour::along_sensor) : world_(w), contour_(contour) {
        truth_.spots = w.spots;
        for (const SensorPrior& p : w.options.sensors) {
            const Vector6 eta = draw<6>(rng, p.hand_eye_covariance);
            truth_.eye.push_back(make_pose(rotation_exp(eta.tail<3>()), eta.head<3>()));
            std::normal_distribution<double> normal;
            Eigen::Matrix3d bent = Eigen::Matrix3d::Identity();
            bent(0, 0) += p.scale_sigma.x() * normal(rng);
            bent(2, 2) += p.scale_sigma.y() * normal(rng);
            bent(0, 2) += p.shear_sigma * normal(rng);
            truth_.bent.push_back(bent);
        }
        for (std::size_t n = 0; n < w.spots.size(); ++n) {
            SpotObservation& s = truth_.spots[n];
            const Eigen::Vector2d off = draw<2>(rng, *s.reference_covariance_mm2);
            s.reference_mm = read(rng, n, Pose::Identity()) + Eigen::Vector3d(off.x(), 0, off.y());
        }
    }
    // What the spots say of one part.
    const std::vector<SpotObservation>& measure(Rng& rng, const Pose& displacement) {
        for (std::size_t n = 0; n < truth_.spots.size(); ++n) {
            SpotObservation& s = truth_.spots[n];
            const Eigen::Vector3d e = s.sigma_mm * gaussian(rng);
            s.measured_mm = read(rng, n, displacement) + Eigen::Vector3d(e.x(), 0, e.z());
        }
        return truth_.spots;
    }

  private:
    // One arrival of the robot at a spot.
    Eigen::Vector3d read(Rng& rng, std::size_t n, const Pose& displacement) const {
        const SpotObservation& s = world_.spots[n];
        const Pose& w = s.workobject_from_sensor;
        const std::size_t sensor = s.sensor == "A" ? 0 : 1;
        const Vector6 off = draw<6>(rng, *s.robot_covariance);
        Pose there = Pose::Identity();
        there.linear() = rotation_exp(off.tail<3>()) * w.linear();
        there.translation() = w.translation() + off.head<3>();
        const Pose& eye = truth_.eye[sensor];
        const Eigen::Vector3d along = contour_ == Contour::along_sensor
                                          ? Eigen::Vector3d(w.linear() * eye.linear().col(1))
                                          : Eigen::Vector3d(w.linear().col(1));
        const Eigen::Vector3d true_mm =
            pierced(there * eye, displacement * (w * s.reference_mm), displacement.linear() * along);
        return truth_.bent[sensor].inverse() * true_mm;
    }
    const World& world_;
    Contour contour_;
    Truth truth_;
};

}  // namespace seamwright::testing_doors
