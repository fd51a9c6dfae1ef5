// The contour end at the door's rendered rim: a fold of 1.15 mm radius, whose last returns stand in grazing
// light.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "core/profile/stripe/peaks.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Eigen::Vector2d;

// Where the end is found less the outermost place that was lit, and its covariance.
struct Found {
    Vector2d offset_mm;
    Eigen::Matrix2d covariance_mm2;
};

TEST(RimEnd, OfADisplacedDoorRepeatsWithinItsCovariance) {
    CellSettings settings = default_cell_settings();
    // A stray reflection as bright as the rim is a contour of its own: which one is the part's is not the
    // contour end's question.
    settings.noise.stray_probability = 0;
    const auto cell = SimulatedCell::open(settings).value();
    const DoorSpot spot = default_door_spots().at(11);
    const Eigen::Vector3d rim = spot.workobject_from_sensor * spot.edge_mm;
    const auto finder = make_feature_finder({"contour-end", {{"side", 0}}, {}, Vector2d::Zero()}).value();
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    Frame frame;
    std::vector<StripeSample> lit;
    StripePeaks peaks;
    ProfileCandidates candidates;
    Profile profile;
    const auto find = [&](double mm, double deg, std::uint64_t number) {
        const auto some = [&](double most) {
            return Eigen::Vector3d(most * unit(engine), most * unit(engine), most * unit(engine));
        };
        const Eigen::Matrix3d turn = rotation_exp(some(rad_from_deg(deg)));
        PartState part;
        part.workobject_from_movedworkobject = make_pose(turn, rim - turn * rim + some(mm));
        cell->set_part(part);
        cell->render(cell->flange_for(spot.workobject_from_sensor), number, frame, &lit);
        EXPECT_TRUE(find_peaks(frame.image, {}, peaks));
        to_millimetres(peaks, cell->sensor_model(), candidates);
        EXPECT_TRUE(track_stripe(candidates, {}, profile));
        const Feature f = finder->find(profile);
        EXPECT_EQ(f.status, FeatureStatus::ok) << f.message;
        Vector2d outermost(1e9, 0);
        for (const StripeSample& s : lit)
            if (!s.ghost && s.x_mm < outermost.x()) outermost = {s.x_mm, s.z_mm};
        return Found{f.point_mm - outermost, f.covariance_mm2};
    };
    // As taught: what the grazing light takes of the rim.
    std::vector<double> x, z;
    for (std::uint64_t i = 0; i < 15; ++i) {
        const Found f = find(0, 0, i);
        x.push_back(f.offset_mm.x());
        z.push_back(f.offset_mm.y());
    }
    std::nth_element(x.begin(), x.begin() + 7, x.end());
    std::nth_element(z.begin(), z.begin() + 7, z.end());
    const Vector2d taught(x[7], z[7]);
    EXPECT_LT(taught.norm(), 0.25);

    constexpr int kParts = 200;
    double nees = 0, covered = 0, z_stated = 0, z_error = 0;
    for (std::uint64_t i = 0; i < kParts; ++i) {
        const Found f = find(4, 1, 100 + i);
        const Vector2d e = f.offset_mm - taught;
        const double one = e.dot(f.covariance_mm2.ldlt().solve(e));
        nees += 0.5 * one / kParts;
        covered += (one < 5.991) / double(kParts);
        z_stated += f.covariance_mm2(1, 1) / kParts;
        z_error += e.y() * e.y() / kParts;
        EXPECT_LT(one, 25) << "never five sigma: part " << i;
    }
    RecordProperty("nees", std::to_string(nees));
    RecordProperty("covered", std::to_string(covered));
    RecordProperty("z_stated_mm", std::to_string(std::sqrt(z_stated)));
    RecordProperty("z_error_mm", std::to_string(std::sqrt(z_error)));
    EXPECT_GE(covered, 0.9);
    EXPECT_LT(nees, 1.5);
    EXPECT_GT(nees, 0.2) << "too unsure";
    EXPECT_LT(std::sqrt(z_error), 0.08);
    EXPECT_LT(std::sqrt(z_stated), 0.13);
}

}  // namespace
}  // namespace seamwright
