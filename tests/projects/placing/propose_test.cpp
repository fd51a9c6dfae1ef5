#include "projects/placing/propose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "devices/drawing/door_step.h"
#include "projects/measure/measure.h"
#include "projects/placing/expected_profile.h"
#include "projects/proof/forecast.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

struct World {
    std::shared_ptr<SimulatedCell> cell;
    Project project;
    Drawing drawing;
    std::string edge;                          // the foot of the flange's step along the top
    std::map<std::string, std::string> edges;  // and along each side
};

const World& world() {
    static const World made = [] {
        World w;
        const nlohmann::json settings = cell_settings(Pose::Identity());
        w.cell = *SimulatedCell::open(settings);
        w.project = door_project(*w.cell, settings);
        Matrix6 arrival = Matrix6::Identity() * 9e-4;  // 0.03 mm and 0.002 degree
        arrival.bottomRightCorner<3, 3>() *= 1e-6;
        w.project.robots[0].arrival_covariance = arrival;
        const std::string text = *door_step();
        DrawingOptions options;
        options.chord_mm = 0.05;
        w.drawing = *read_drawing(std::as_bytes(std::span(text.data(), text.size())), "door.step", options);
        for (const DrawingEdge& e : w.drawing.edges)
            if (e.fold_deg > 60 && !e.convex && e.length_mm > 300)
                w.edges[door_side_of(e.points[e.points.size() / 2].point_mm)] = e.id;
        w.edge = w.edges["top"];
        return w;
    }();
    return made;
}

ProposeOptions quick(int fewest, int most, double three_sigma_mm) {
    ProposeOptions o;
    o.edge = world().edge;
    o.fewest = fewest;
    o.most = most;
    o.three_sigma_mm = three_sigma_mm;
    o.step_mm = 90;
    o.bead_step_mm = 60;
    o.optics.width = 400;
    return o;
}

// As the demo's pass would find it: the outermost line seen from the spot.
std::optional<ContourCurve> curve_by_hand(const DoorSpot& door, const Eigen::Vector2d& point_mm) {
    const Pose sensor_from_workobject = door.workobject_from_sensor.inverse();
    std::vector<TravelPoint> travel;
    constexpr int kLooks = 3000;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const bool first : {true, false})
        for (int i = 0; i < kLooks; ++i) {
            const DoorEdge e = door_edge(door_edge_length_mm() * i / kLooks);
            const Eigen::Vector3d p = sensor_from_workobject * (e.point_mm + kDoorFlangeTop_mm * e.up);
            if (first && std::abs(p.y()) < 0.6 && std::abs(p.x() + 15) < 5) middle = p;
            if (!first && std::abs(p.y()) < 20 && std::abs(p.x() + 15) < 20)
                travel.push_back(
                    {p.y(), p.x() - middle.x() + point_mm.x(), p.z() - middle.z() + point_mm.y()});
        }
    auto curve = fit_contour_curve(travel);
    EXPECT_TRUE(curve);
    return curve ? std::optional<ContourCurve>(*curve) : std::nullopt;
}

// The demo's spots of its region "top" as the same bead sees them: expected from the same drawing, same noise.
PlacedSet by_hand(const std::vector<std::string>& ids, const ProposeOptions& o) {
    const World& w = world();
    Project project = w.project;
    const Spot habits = project.spots.front();
    project.spots.clear();
    Region region;
    region.id = "hand";
    const MeshTree tree(w.drawing.mesh);
    const Calibration& calibration = project.calibrations[0];
    const OpticsSettings optics = optics_of(calibration, o.optics);
    for (const DoorSpot& door : default_door_spots()) {
        if (std::find(ids.begin(), ids.end(), door.id) == ids.end()) continue;
        const auto seen =
            expected_feature(tree, door.workobject_from_sensor, optics, project.sensors[0].filter, o.noise_mm,
                             11, {door.edge_mm.x(), door.edge_mm.z()});
        if (!seen) continue;
        Spot spot;
        spot.sigma_mm = habits.sigma_mm;
        spot.jitter_mm = habits.jitter_mm;
        spot.stop_at_trigger = habits.stop_at_trigger;
        spot.id = door.id;
        spot.sensor_id = "A";
        spot.robot_id = "R1";
        spot.base_from_flange = project.part.base_from_workobject * door.workobject_from_sensor *
                                calibration.flange_from_sensor.inverse();
        spot.feature = seen->recipe;
        spot.reference_mm = Eigen::Vector3d(seen->point_mm.x(), 0, seen->point_mm.y());
        spot.reference_profile = seen->profile;
        spot.curve = curve_by_hand(door, seen->point_mm);
        project.spots.push_back(spot);
        region.spot_ids.push_back(spot.id);
    }
    EXPECT_EQ(project.spots.size(), ids.size());
    project.regions = {region};
    PlacingTask task;
    task.bead = *bead_of(w.drawing, o.edge, o.bead_step_mm);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const TaughtBeadPoint& p : task.bead) middle += p.point_mm / static_cast<double>(task.bead.size());
    const auto planned = planned_observations(project, region);
    for (std::size_t i = 0; i < planned.size(); ++i)
        task.candidates.push_back({planned[i], travel_window_mm(project.spots[i]), static_cast<int>(i)});
    task.displacements = required_displacements(project.requirements, middle);
    task.options = correction_options(project, region);
    task.three_sigma_mm = o.three_sigma_mm;
    const auto placing = SpotPlacing::make(task);
    EXPECT_TRUE(placing);
    std::vector<std::size_t> all(planned.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return placing->judge(all);
}

// The proposed spots in a project of their own.
std::pair<Project, Region> taken_of(const Proposal& proposal) {
    std::pair<Project, Region> taken{world().project, {}};
    auto& [project, region] = taken;
    region.id = "taken";
    project.spots.clear();
    for (const ProposedSpot& p : proposal.spots)
        project.spots.push_back(p.spot), region.spot_ids.push_back(p.spot.id);
    return taken;
}

TEST(Propose, IsNeverWorseThanTheSpotsMadeByHandOnAnySide) {
    ASSERT_EQ(world().edges.size(), 4u);
    for (const DoorRegion& region : default_door_regions()) {
        const auto& ids = region.spot_ids;
        ProposeOptions o = quick(static_cast<int>(ids.size()), static_cast<int>(ids.size()), 0.2);
        o.edge = world().edges.at(region.id);
        o.one_may_be_lost = false;
        const PlacedSet hand = by_hand(ids, o);
        const auto proposal = propose_spots(world().project, world().drawing, o);
        ASSERT_TRUE(proposal) << proposal.error().sentence();
        EXPECT_EQ(proposal->spots.size(), ids.size());
        EXPECT_LE(proposal->set.three_sigma_mm, hand.three_sigma_mm) << region.id;
        EXPECT_LE(proposal->bound_mm, proposal->set.three_sigma_mm);
        std::printf(
            "%s, %zu spots: by hand %.4f mm, proposed %.4f mm, bound %.4f mm; %d of %d attitudes see a "
            "feature\n",
            region.id.c_str(), ids.size(), hand.three_sigma_mm, proposal->set.three_sigma_mm,
            proposal->bound_mm, proposal->candidates, proposal->tried);
    }
}

// What is taken keeps the measure that it was chosen by.
TEST(Propose, StaysNearTheBeadWhereItIsToldTo) {
    ProposeOptions o = quick(5, 5, 0.5);
    o.step_mm = 60;
    o.beyond_mm = 200;
    const auto proposal = propose_spots(world().project, world().drawing, o);
    ASSERT_TRUE(proposal) << proposal.error().sentence();
    const DrawingEdge& edge = *find_edge(world().drawing, o.edge);
    for (const ProposedSpot& p : proposal->spots) {
        double nearest = 1e9;
        for (const DrawingPoint& q : edge.points)
            nearest = std::min(nearest, (q.point_mm - p.point_mm).norm());
        EXPECT_LT(nearest, 200 + 5) << p.spot.id;
        EXPECT_EQ(p.spot.reference_state, ReferenceState::from_drawing);
        EXPECT_EQ(p.spot.drawn->edge, o.edge);
    }
    const auto [taken, region] = taken_of(*proposal);
    const auto judged = judge_spots(taken, region, proposal->bead);
    ASSERT_TRUE(judged) << judged.error().sentence();
    EXPECT_NEAR(judged->three_sigma_mm, proposal->set.three_sigma_mm, 1e-6);
    o.beyond_mm = -1;
    EXPECT_FALSE(propose_spots(world().project, world().drawing, o));
    o = quick(4, 12, 0.1);
    o.region_id = "nowhere";
    const auto refused = propose_spots(world().project, world().drawing, o);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().sentence().find("there is no region \"nowhere\""), std::string::npos);
}

TEST(Propose, ASpotIsMovedAndTheForecastFollows) {
    ProposeOptions o = quick(4, 4, 1);
    o.step_mm = 60;
    auto proposal = propose_spots(world().project, world().drawing, o);
    ASSERT_TRUE(proposal) << proposal.error().sentence();
    const std::vector<Eigen::Vector3d> places = places_of(*proposal);
    ASSERT_EQ(static_cast<int>(places.size()), proposal->places);
    const std::string id = proposal->spots[1].spot.id;
    const std::size_t was = proposal->spots[1].place;
    EXPECT_LT((places[was] - proposal->spots[1].point_mm).norm(), 5);
    const auto spot = [&](const Proposal& p) -> const ProposedSpot& {
        return *std::find_if(p.spots.begin(), p.spots.end(),
                             [&](const ProposedSpot& s) { return s.spot.id == id; });
    };
    int moved_to = 0, worse = 0;
    for (std::size_t place = 0; place < places.size(); ++place) {
        const auto moved = move_proposed(*proposal, id, place);
        if (!moved) {
            EXPECT_NE(moved.error().sentence().find("another spot stands there"), std::string::npos);
            continue;
        }
        ++moved_to;
        EXPECT_EQ(spot(*moved).place, place);
        EXPECT_LT((places[place] - spot(*moved).point_mm).norm(), 5);
        // The same numbers as the spots have in a project of their own.
        const auto [taken, region] = taken_of(*moved);
        const auto judged = judge_spots(taken, region, proposal->bead);
        ASSERT_TRUE(judged) << judged.error().sentence();
        EXPECT_NEAR(judged->three_sigma_mm, moved->set.three_sigma_mm, 1e-6);
        EXPECT_NEAR(forecast_region(taken, region)->sigma_mm, moved->sigma_forecast_mm, 1e-9);
        EXPECT_NEAR(moved->set.three_sigma_mm,
                    *std::max_element(moved->along_mm.begin(), moved->along_mm.end()), 1e-9);
        worse += moved->set.three_sigma_mm > proposal->set.three_sigma_mm + 1e-9;
        const auto back = move_proposed(*moved, id, was);
        ASSERT_TRUE(back);
        EXPECT_EQ(back->set.chosen, proposal->set.chosen);
        // Summed in the order of the way, so equal to rounding.
        EXPECT_NEAR(back->set.three_sigma_mm, proposal->set.three_sigma_mm, 1e-9);
        EXPECT_NEAR(back->sigma_forecast_mm, proposal->sigma_forecast_mm, 1e-9);
    }
    EXPECT_EQ(moved_to, proposal->places - 3) << "all places but those of the others";
    EXPECT_GE(worse, moved_to / 2) << "what was proposed is nearly the best";
    EXPECT_FALSE(move_proposed(*proposal, "P99", was));
    EXPECT_FALSE(move_proposed(*proposal, id, places.size()));
    proposal->looked.reset();
    EXPECT_TRUE(places_of(*proposal).empty());
    EXPECT_FALSE(move_proposed(*proposal, id, was));
}

TEST(Propose, SpotsSeeTheirFeatureWhereTheDrawingHasItAndMayBeLost) {
    const auto proposal = propose_spots(world().project, world().drawing, quick(4, 12, 0.35));
    ASSERT_TRUE(proposal) << proposal.error().sentence();
    EXPECT_TRUE(proposal->set.enough)
        << proposal->set.three_sigma_mm << " " << proposal->set.lost_three_sigma_mm;
    EXPECT_LE(proposal->set.lost_three_sigma_mm, 0.35);
    const auto chain = tangent_chain(world().drawing, world().edge);
    const Calibration& calibration = world().project.calibrations[0];
    for (const ProposedSpot& p : proposal->spots) {
        EXPECT_LT((p.point_mm - chain->at(p.arc_mm).point_mm).norm(), 3.1)
            << "the reference lies at the edge";
        EXPECT_TRUE(p.spot.curve) << "the edge bends";
        // The simulated sensor sees on the simulated door what the drawing promised.
        const Pose stands = world().project.part.base_from_workobject.inverse() * p.spot.base_from_flange *
                            calibration.flange_from_sensor;
        const MeshTree door(world().cell->part_mesh());
        const auto seen =
            expected_feature(door, stands, optics_of(calibration, {}), world().project.sensors[0].filter,
                             0.02, 99, Eigen::Vector2d(p.spot.reference_mm.x(), p.spot.reference_mm.z()));
        ASSERT_TRUE(seen) << p.spot.id;
    }
}

TEST(Propose, IsTheSameWhereverTheRobotStands) {
    ProposeOptions o = quick(5, 5, 0.3);
    o.step_mm = 200;
    o.cone_deg = 0;
    Project other = world().project;
    other.part.base_from_workobject =
        make_pose(rotation_exp({0, 0, 1.2}), {-500, 2000, 300}) * other.part.base_from_workobject;
    const auto a = propose_spots(world().project, world().drawing, o);
    const auto b = propose_spots(other, world().drawing, o);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->set.three_sigma_mm, b->set.three_sigma_mm, 1e-6);
    for (std::size_t i = 0; i < a->spots.size(); ++i)
        EXPECT_NEAR((a->spots[i].point_mm - b->spots[i].point_mm).norm(), 0, 1e-6);
}

TEST(Propose, RefusesWithASentence) {
    const World& w = world();
    ProposeOptions o = quick(4, 12, 0.1);
    o.edge = "e99999";
    EXPECT_FALSE(propose_spots(w.project, w.drawing, o));
    o = quick(0, 12, 0.1);
    EXPECT_FALSE(propose_spots(w.project, w.drawing, o));
    o = quick(4, 12, std::nan(""));
    EXPECT_FALSE(propose_spots(w.project, w.drawing, o));
    o = quick(4, 12, 0.1);
    o.noise_mm = -1;
    EXPECT_FALSE(propose_spots(w.project, w.drawing, o));
    Project bare = w.project;
    bare.sensors[0].calibration_id.clear();
    const auto refused = propose_spots(bare, w.drawing, quick(4, 12, 0.1));
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().sentence().find("calibration"), std::string::npos);
    EXPECT_FALSE(propose_spots(Project{}, w.drawing, quick(4, 12, 0.1)));
    std::stop_source stop;
    stop.request_stop();
    o = quick(4, 12, 0.1);
    o.cancel = stop.get_token();
    const auto cancelled = propose_spots(w.project, w.drawing, o);
    ASSERT_FALSE(cancelled);
    EXPECT_EQ(cancelled.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace seamwright
