// A whole run with a Gocator and a controller on the loopback address: the same correction as the part's
// displacement within the stated sigma.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

TEST(GocatorRun, CorrectsTheDisplacedDoor) {
    TemporaryFolder folder;
    auto served = serve_cell({.driver = "kuka-kvp", .gocator = true}, folder / "run.seam");
    ASSERT_TRUE(served) << served.error().sentence();
    const Pose displaced = make_pose(rotation_exp({0.002, -0.001, 0.003}), {2, -1, 1});
    served->cell->set_part({displaced, {}});
    RunOptions options;
    options.push = true;
    const auto run = served->station->run(options);
    ASSERT_TRUE(run) << run.error().sentence();
    ASSERT_EQ(run->status, RunStatus::ok) << run->message;
    EXPECT_TRUE(served->controller().released());
    const RegionCorrection& correction = *run->regions[0].correction;
    const Pose& found = correction.displacement.workobject_from_movedworkobject;
    Vector6 error;  // tangent of pose.h
    error << found.translation() - displaced.translation(),
        rotation_log(found.linear() * displaced.linear().transpose());
    EXPECT_LT(error.transpose() * correction.covariance.ldlt().solve(error), 22.5) << "chi-square, 6, 1e-3";
    for (const SpotMeasurement& m : run->spots)
        EXPECT_EQ(m.status, SpotStatus::measured) << m.spot_id << m.message;
    const SourceCounters counters = served->station->sensor("A")->counters();
    EXPECT_EQ(counters.lost + counters.damaged + counters.underrun, 0u);
}

}  // namespace
}  // namespace seamwright
