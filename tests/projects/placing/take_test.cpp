// Proposed spots in a project: regions, names, via points, programs; and out again.

#include "projects/placing/take.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "projects/station/program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Made {
    std::shared_ptr<SimulatedCell> cell;
    Project project;  // with a taught spot and its region
    Drawing drawing;
    Proposal proposal;  // as if proposed: three of the door's spots
    std::vector<std::byte> file = {std::byte{'s'}, std::byte{'t'}};
};

Made made() {
    Made m;
    const nlohmann::json settings = cell_settings(Pose::Identity());
    m.cell = *SimulatedCell::open(settings);
    m.project = door_project(*m.cell, settings);
    m.drawing.source = "door.step";
    m.drawing.mesh.vertices = {{0, 0, 0}, {1000, 0, 40}, {0, 750, 0}};
    std::vector<Spot> spots = std::move(m.project.spots);
    m.project.spots = {spots.at(0)};
    m.project.regions.at(0).spot_ids = {spots.at(0).id};
    for (std::size_t i = 1; i < 4; ++i) {
        ProposedSpot p;
        p.spot = spots.at(i);
        p.spot.id = "P" + std::to_string(i);
        p.spot.drawn = DrawingOrigin{"", 0, 0, "e12", 10.0 * static_cast<double>(i), {}};
        m.proposal.spots.push_back(p);
    }
    return m;
}

TEST(TakeProposal, MakesARegionOfSpotsThatNobodyHasConfirmed) {
    const Made m = made();
    const auto taken = take_proposal(m.project, m.drawing, m.file, m.proposal, {});
    ASSERT_TRUE(taken) << taken.error().sentence();
    EXPECT_TRUE(taken->new_region);
    EXPECT_EQ(taken->region_id, "drawing e12");
    ASSERT_EQ(taken->project.regions.size(), 2u);
    const Region& region = taken->project.regions[1];
    EXPECT_EQ(region.frame_name, "BASE_drawing_e12");
    EXPECT_TRUE(region.base_from_frame.isApprox(m.project.part.base_from_workobject));
    EXPECT_THAT(region.spot_ids, ElementsAre("P1", "P2", "P3"));
    EXPECT_EQ(unconfirmed_spots(taken->project, region), region.spot_ids);
    EXPECT_TRUE(unconfirmed_spots(taken->project, taken->project.regions[0]).empty());
    for (const std::string& id : region.spot_ids) {
        const Spot& spot = *find_spot(taken->project, id);
        EXPECT_EQ(spot.reference_state, ReferenceState::from_drawing);
        EXPECT_EQ(spot.drawn->name, "door.step");
        EXPECT_EQ(spot.drawn->bytes, 2u);
        EXPECT_EQ(spot.drawn->crc32, 0x12a38defu) << "of the two bytes";
    }
    // A second one finds the names taken, and says so or takes another.
    EXPECT_FALSE(take_proposal(taken->project, m.drawing, m.file, m.proposal, {}));
    Made again = made();
    for (ProposedSpot& p : again.proposal.spots) p.spot.id += "b";
    EXPECT_EQ(take_proposal(taken->project, m.drawing, m.file, again.proposal, {})->region_id,
              "drawing e12 2");
}

TEST(TakeProposal, TheSensorTravelsOverThePart) {
    const Made m = made();
    TakeOptions options;
    options.safe_mm = 60;
    const auto taken = take_proposal(m.project, m.drawing, m.file, m.proposal, options);
    ASSERT_TRUE(taken);
    const Pose& flange_from_sensor = m.project.calibrations[0].flange_from_sensor;
    Eigen::Vector3d up = Eigen::Vector3d::Zero();  // base
    for (const std::string& id : taken->spot_ids)
        up += (find_spot(taken->project, id)->base_from_flange * flange_from_sensor).linear().col(2);
    up.normalize();
    const auto height = [&](const Pose& base_from_flange) {
        return up.dot((base_from_flange * flange_from_sensor).translation());
    };
    double top = -1e9;
    for (const Eigen::Vector3d& v : m.drawing.mesh.vertices)
        top = std::max(top, up.dot(m.project.part.base_from_workobject * v));
    for (const std::string& id : taken->spot_ids)
        top = std::max(top, height(find_spot(taken->project, id)->base_from_flange));
    for (const std::string& id : taken->spot_ids) {
        const Spot& spot = *find_spot(taken->project, id);
        ASSERT_EQ(spot.via.size(), 2u) << "up from the spot before, down to this one";
        for (const Pose& via : spot.via) EXPECT_NEAR(height(via), top + 60, 1e-6) << id;
        EXPECT_TRUE(spot.via.back().linear().isApprox(spot.base_from_flange.linear(), 1e-12));
    }
    for (const ProgramWriter& brand : program_writers()) {
        const auto request = program_request(taken->project, RobotId("R1"));
        ASSERT_TRUE(request) << request.error().sentence();
        const auto files = write_robot_program(std::string(brand.name), *request);
        ASSERT_TRUE(files) << brand.name << ": " << files.error().sentence();
        std::string all;
        for (const auto& file : *files) all += file.text;
        EXPECT_THAT(all, HasSubstr("P3")) << brand.name;
    }
    options.safe_mm = 0;
    const auto straight = take_proposal(m.project, m.drawing, m.file, m.proposal, options);
    for (const Spot& spot : straight->project.spots) EXPECT_TRUE(spot.via.empty());
}

TEST(TakeProposal, JoinsARegionThatIsThere) {
    const Made m = made();
    TakeOptions options;
    options.region_id = "all";
    const auto taken = take_proposal(m.project, m.drawing, m.file, m.proposal, options);
    ASSERT_TRUE(taken);
    EXPECT_FALSE(taken->new_region);
    ASSERT_EQ(taken->project.regions.size(), 1u);
    EXPECT_EQ(taken->project.regions[0].spot_ids.size(), 4u);
    EXPECT_EQ(taken->project.regions[0].frame_name, "path");
    EXPECT_THAT(unconfirmed_spots(taken->project, taken->project.regions[0]), ElementsAre("P1", "P2", "P3"));
    const auto out = without_unconfirmed(taken->project, "all");
    ASSERT_TRUE(out);
    EXPECT_EQ(out->project.spots.size(), 1u);
    EXPECT_EQ(out->project.regions[0].spot_ids, m.project.regions[0].spot_ids);
}

TEST(TakeProposal, GoesOutAgainAndLeavesWhatWasConfirmed) {
    const Made m = made();
    auto taken = take_proposal(m.project, m.drawing, m.file, m.proposal, {});
    ASSERT_TRUE(taken);
    const auto out = without_unconfirmed(taken->project, "");
    ASSERT_TRUE(out);
    EXPECT_THAT(out->spot_ids, ElementsAre("P1", "P2", "P3"));
    EXPECT_EQ(out->project.spots.size(), 1u);
    EXPECT_EQ(out->project.regions.size(), 1u) << "the region had no other spot";
    taken->project.spots[2].reference_state = ReferenceState::measured;
    const auto some = without_unconfirmed(taken->project, "drawing e12");
    ASSERT_TRUE(some);
    EXPECT_EQ(some->project.spots.size(), 2u);
    EXPECT_THAT(some->project.regions.at(1).spot_ids, ElementsAre("P2"));
    EXPECT_FALSE(without_unconfirmed(m.project, ""));
    EXPECT_FALSE(without_unconfirmed(m.project, "nowhere"));
}

TEST(TakeProposal, RefusesWithASentence) {
    const Made m = made();
    const auto refused = [&](const TakeOptions& o, const char* words) {
        const auto taken = take_proposal(m.project, m.drawing, m.file, m.proposal, o);
        ASSERT_FALSE(taken) << words;
        EXPECT_THAT(taken.error().sentence(), HasSubstr(words));
    };
    TakeOptions o;
    o.region_id = "nowhere";
    refused(o, "there is no region \"nowhere\"");
    o = {};
    o.new_region = "all";
    refused(o, "there is a region \"all\" already");
    o = {};
    o.frame = "PATH";
    refused(o, "frame PATH is written by another region");
    o = {};
    o.region_id = "all";
    o.frame = "OTHER";
    refused(o, "keeps its name and its frame");
    for (const double bad : {-1.0, 0.5, 3000.0, std::nan("")}) {
        o = {};
        o.safe_mm = bad;
        refused(o, "the safe plane");
    }
    EXPECT_FALSE(take_proposal(m.project, m.drawing, m.file, Proposal{}, {}));
}

}  // namespace
}  // namespace seamwright
