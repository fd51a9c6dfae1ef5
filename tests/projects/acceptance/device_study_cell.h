#pragma once
// The simulated door with its station, and what its robot and trigger are in truth.

#include <gtest/gtest.h>

#include "core/profile/taught_profile.h"
#include "projects/acceptance/equipment/measure_robot.h"
#include "projects/acceptance/equipment/measure_trigger.h"
#include "projects/measure/measure.h"
#include "projects/station/teach.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"

namespace seamwright {

struct StudyTruth {
    double repeatability_mm = 0.03, repeatability_deg = 0.002, jitter_mm = 1.5, latency_ms = 4;
    nlohmann::json settings(std::uint64_t seed) const {
        return {{"seed", seed},
                {"robot",
                 {{"repeatability_mm", repeatability_mm},
                  {"repeatability_deg", repeatability_deg},
                  {"trigger_jitter_mm", jitter_mm},
                  {"trigger_latency_ms", latency_ms}}}};
    }
    // Uniform, one sigma.
    double jitter_ms() const { return jitter_mm / 100 * 1000 / std::sqrt(3.0); }
};

class StudyCell {
  public:
    StudyCell(const StudyTruth& truth, std::uint64_t seed)
        : truth_(truth),
          cell_(*SimulatedCell::open(truth.settings(seed))),
          station_(open(door_project(*cell_, truth.settings(seed)))) {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        sensors["A"] = make_simulated_sensor(cell_);
        robots["R1"] = make_simulated_robot(cell_);
        station_.connect(std::move(sensors), std::move(robots));
    }
    // As the demo teaches: the hem around the edge as template, with the edge as its landmark. (The end of a contour
    // errs by the pixel that it falls on, which moves with the robot and stands still with it.)
    void teach_template(const std::string& spot_id) {
        Project project = station_.project();
        Spot& spot = *std::find_if(project.spots.begin(), project.spots.end(),
                                   [&](const Spot& s) { return s.id == spot_id; });
        const auto edge = teach_spot(station_, spot, {});
        ASSERT_TRUE(edge) << edge.error().sentence();
        const double x = edge->spot.reference_mm.x(), z = edge->spot.reference_mm.z();
        spot.feature.kind = "template";
        spot.feature.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
        spot.feature.template_profile = cut_out(edge->mean, x - 1, x + 40);
        spot.feature.template_reference_mm = {x, z};
        ASSERT_TRUE(station_.edit(project));
    }

    Station& station() { return station_; }
    const Project& project() const { return station_.project(); }

    // Covariance of the point that a spot looks at, base: cov(dt + dw x l) of independent equal components, l from
    // the flange to the point.
    Eigen::Matrix3d arrivals_at(const std::string& spot_id) const {
        const Spot& spot = *find_spot(project(), spot_id);
        // The edge, 15 mm before the sensor's origin.
        const Eigen::Vector3d point =
            spot.base_from_flange * cell_->flange_from_sensor() * Eigen::Vector3d(-15, 0, 0);
        const Eigen::Vector3d l = point - spot.base_from_flange.translation();
        const double t = truth_.repeatability_mm, w = truth_.repeatability_deg * kPi / 180;
        return t * t * Eigen::Matrix3d::Identity() +
               w * w * (l.squaredNorm() * Eigen::Matrix3d::Identity() - l * l.transpose());
    }

  private:
    Station open(const Project& project) {
        return Station(ProjectFile::create(folder_ / "door.seam", project).value(), project);
    }
    StudyTruth truth_;
    TemporaryFolder folder_;
    std::shared_ptr<SimulatedCell> cell_;
    Station station_;
};

}  // namespace seamwright
