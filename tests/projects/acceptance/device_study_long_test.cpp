// Over many simulated cells the stated 95 % limits hold what the cell's robot and trigger are in truth.

#include <cstdio>

#include "tests/projects/acceptance/device_study_cell.h"

namespace seamwright {
namespace {

constexpr int kSeeds = 25;

class HeldBySeeds {
  public:
    void add(const char* figure, const Interval& limits, double truth) {
        ++trials_[figure];
        held_[figure] += limits.contains(truth);
    }
    void expect() {
        for (const auto& [figure, n] : trials_) {
            std::printf("  %-24s %d of %d\n", figure, held_[figure], n);
            EXPECT_GE(held_[figure], 0.85 * n) << figure;
        }
    }

  private:
    std::map<const char*, int> trials_, held_;
};

TEST(DeviceStudies, TheLimitsHoldTheSimulatedRobot) {
    HeldBySeeds held;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        StudyCell cell({}, static_cast<std::uint64_t>(seed));
        cell.teach_template("T2");
        cell.teach_template("L2");
        MeasureRobotOptions options;
        options.spot_ids = {"T2", "L2"};
        options.returns = 15;
        options.profiles = 3;
        const auto measured = measure_robot(cell.station(), options);
        ASSERT_TRUE(measured) << seed << ": " << measured.error().sentence();
        for (const SpotRepeatability& r : measured->study.spots) {
            const auto sees = seen_by(*find_spot(cell.project(), r.spot_id),
                                      cell.project().calibrations[0].flange_from_sensor);
            const Eigen::Matrix2d truth = sees * cell.arrivals_at(r.spot_id) * sees.transpose();
            held.add("sigma x of a spot", r.arrival_x.limits_mm, std::sqrt(truth(0, 0)));
            held.add("sigma z of a spot", r.arrival_z.limits_mm, std::sqrt(truth(1, 1)));
            held.add("RP of a spot", r.rp_limits_mm, repeatability_of(truth));
        }
        held.add("RP in space", measured->study.rp_limits_mm, repeatability_of(cell.arrivals_at("L2")));
    }
    held.expect();
}

TEST(DeviceStudies, TheLimitsHoldTheSimulatedTrigger) {
    HeldBySeeds held;
    const StudyTruth truth;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        StudyCell cell(truth, static_cast<std::uint64_t>(1000 + seed));
        cell.teach_template("L2");
        MeasureTriggerOptions options;
        options.spot_id = "L2";
        options.travel_deg = 45;
        options.passes = 5;
        const auto measured = measure_trigger(cell.station(), options);
        ASSERT_TRUE(measured) << seed << ": " << measured.error().sentence();
        ASSERT_TRUE(measured->study) << seed << ": " << measured->unseen.english();
        held.add("latency", measured->study->latency_limits_ms, truth.latency_ms);
        held.add("jitter", measured->study->jitter_limits_ms, truth.jitter_ms());
        held.add("no reversal", measured->study->reversal_limits_mm, 0);
    }
    held.expect();
}

}  // namespace
}  // namespace seamwright
