// The stated 95 % limits of a robot's repeatability and of a trigger's latency and jitter hold the truth.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "tests/core/acceptance/robot_trigger_data.h"

namespace seamwright {
namespace {

class HeldShare {
  public:
    void add(const std::string& index, const Interval& limits, double truth) {
        ++trials_[index];
        held_[index] += limits.contains(truth);
    }
    void expect(double low, double high) {
        for (const auto& [index, n] : trials_) {
            const double share = static_cast<double>(held_[index]) / n;
            std::printf("  %-44s %.4f of %d\n", index.c_str(), share, n);
            EXPECT_GE(share, low) << index;
            EXPECT_LE(share, high) << index;
        }
    }

  private:
    std::map<std::string, int> trials_, held_;
};

TEST(RobotCoverage, RepeatabilityAndItsCovariance) {
    HeldShare held;
    std::mt19937_64 random(21);
    Eigen::Matrix3d c = Eigen::Vector3d(0.0004, 0.0016, 0.0009).asDiagonal();
    c(0, 1) = c(1, 0) = 0.0003;
    const std::vector<Eigen::Matrix<double, 2, 3>> views{looking(0, 0), looking(1.1, 0.2), looking(2.2, -0.3),
                                                         looking(0.5, 1.2)};
    for (const int n : {10, 30})
        for (const double noise : {0.005, 0.03})
            for (int trial = 0; trial < 400; ++trial) {
                std::vector<SpotReturns> spots;
                for (const auto& view : views)
                    spots.push_back(simulated_returns("S", view, c, noise, n, 5, random));
                const auto study = robot_study(spots);
                ASSERT_TRUE(study);
                const std::string name =
                    " n " + std::to_string(n) + " noise " + std::to_string(noise).substr(0, 5);
                for (std::size_t i = 0; i < views.size(); ++i) {
                    const Eigen::Matrix2d seen = views[i] * c * views[i].transpose();
                    const SpotRepeatability& r = study->spots[i];
                    held.add("x" + name, r.arrival_x.limits_mm, std::sqrt(seen(0, 0)));
                    held.add("z" + name, r.arrival_z.limits_mm, std::sqrt(seen(1, 1)));
                    held.add("RP of a spot" + name, r.rp_limits_mm, repeatability_of(seen));
                    held.add("RP with noise" + name, r.rp_measured_limits_mm,
                             repeatability_of(seen + noise * noise / 5 * Eigen::Matrix2d::Identity()));
                }
                for (int a = 0; a < 3; ++a)
                    held.add("base axis" + name, study->axes[a].limits_mm, std::sqrt(c(a, a)));
                held.add("RP in space" + name, study->rp_limits_mm, repeatability_of(c));
            }
    held.expect(0.93, 0.98);
}

TEST(TriggerCoverage, LatencyAndJitter) {
    HeldShare held;
    std::mt19937_64 random(22);
    for (const int each : {3, 10})
        for (const double half_ms : {0.5, 5.0, 15.0})
            for (int trial = 0; trial < 400; ++trial) {
                const auto study = trigger_study(
                    simulated_passes({25, 50, 100}, each, 12, half_ms, 0.05, 0.02, 1, random), 0);
                ASSERT_TRUE(study);
                const std::string name =
                    " each " + std::to_string(each) + " half " + std::to_string(half_ms).substr(0, 4) + " ms";
                held.add("latency" + name, study->latency_limits_ms, 12);
                held.add("jitter" + name, study->jitter_limits_ms, half_ms / std::sqrt(3));
                held.add("reversal" + name, study->reversal_limits_mm, 0.02);
            }
    held.expect(0.93, 1.0);
}

}  // namespace
}  // namespace seamwright
