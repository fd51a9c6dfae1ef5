// From the drawing to a confirmed region on the simulated door, and the drawings that are not this part's.

#include "projects/confirm/confirm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "devices/drawing/door_step.h"
#include "projects/measure/measure.h"
#include "projects/placing/take.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

constexpr int kSpots = 8;

const Drawing& door_drawing() {
    static const Drawing drawing = [] {
        const std::string text = *door_step();
        return *read_drawing(std::as_bytes(std::span(text)), "door.step", {});
    }();
    return drawing;
}

std::string step_along_top(const Drawing& drawing) {
    for (const DrawingEdge& e : drawing.edges)
        if (e.fold_deg > 60 && !e.convex && e.length_mm > 300 &&
            door_side_of(e.points[e.points.size() / 2].point_mm) == "top")
            return e.id;
    return {};
}

// The door's left for its right: the plane across X through its middle.
Drawing mirrored(Drawing drawing) {
    const auto point = [](Eigen::Vector3d& p) { p.x() = 1000 - p.x(); };
    const auto direction = [](Eigen::Vector3d& d) { d.x() = -d.x(); };
    for (auto& v : drawing.mesh.vertices) point(v);
    for (auto& t : drawing.mesh.triangles) std::swap(t[1], t[2]);
    for (auto& n : drawing.normals) direction(n);
    for (DrawingEdge& e : drawing.edges)
        for (DrawingPoint& p : e.points) {
            point(p.point_mm);
            direction(p.tangent);
            direction(p.normal_left);
            direction(p.normal_right);
            std::swap(p.normal_left, p.normal_right);
        }
    return drawing;
}

// A cell with the part displaced, and a project of the spots that a drawing gives; devices connected.
class OfflineCell {
  public:
    OfflineCell(const Pose& displacement, const Drawing& drawing)
        : settings_(cell_settings(displacement)),
          cell_(*SimulatedCell::open(settings_)),
          station_(made(drawing)) {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        sensors["A"] = make_simulated_sensor(cell_);
        robots["R1"] = make_simulated_robot(cell_);
        station_.connect(std::move(sensors), std::move(robots));
        cell_->set_mode(RobotMode::manual_reduced);
    }
    Station& station() { return station_; }
    const Region& region() { return station_.project().regions.front(); }
    RunRecord dry_run() {
        cell_->store_program(measuring_program(station_.project(), "R1"));
        cell_->set_mode(RobotMode::automatic);
        RunOptions options;
        options.part_id = "car";
        auto run = station_.run(options);
        EXPECT_TRUE(run) << run.error().sentence();
        cell_->set_mode(RobotMode::manual_reduced);
        return run ? std::move(*run) : RunRecord{};
    }

  private:
    Station made(const Drawing& drawing) {
        Project project = door_project(*cell_, settings_);
        project.spots.resize(1);
        project.regions.front().spot_ids = {project.spots.front().id};
        Project bare = project;  // its first spot's habits, none of its spots
        bare.spots.clear();
        bare.regions.clear();
        ProposeOptions options;
        options.edge = step_along_top(drawing);
        if (options.edge.empty()) options.edge = step_along_top(door_drawing());
        options.fewest = options.most = kSpots;
        options.three_sigma_mm = 0.5;
        options.step_mm = 120;
        options.bead_step_mm = 60;
        options.optics.width = 400;
        const auto proposal = propose_spots(project, drawing, options);
        EXPECT_TRUE(proposal) << proposal.error().sentence();
        TakeOptions taking;
        taking.new_region = "top";
        auto taken = take_proposal(bare, drawing, {}, *proposal, taking);
        EXPECT_TRUE(taken) << taken.error().sentence();
        taken->project.regions.front().sigma_limit_mm = 1;
        taken->project.regions.front().sigma_limit_deg = 0.5;
        return Station(ProjectFile::create(folder_ / "door.seam", taken->project).value(), taken->project);
    }
    nlohmann::json settings_;
    TemporaryFolder folder_;
    std::shared_ptr<SimulatedCell> cell_;
    Station station_;
};

ConfirmOptions quickly() {
    ConfirmOptions options;
    options.repeats = 2;
    return options;
}

TEST(Confirm, UnconfirmedTheRegionMeasuresAndIsRefusedConfirmedItPasses) {
    OfflineCell cell(Pose::Identity(), door_drawing());
    const RunRecord before = cell.dry_run();
    ASSERT_EQ(before.regions.size(), 1u);
    ASSERT_TRUE(before.regions[0].correction) << "it measures";
    EXPECT_LT(before.regions[0].correction->displacement.workobject_from_movedworkobject.translation().norm(),
              1);
    EXPECT_FALSE(before.regions[0].gate_passed);
    ASSERT_EQ(before.regions[0].refusals.size(), 1u) << "and nothing else is the matter";
    EXPECT_THAT(before.regions[0].refusals[0].english(), HasSubstr("not confirmed"));

    const Project drawn = cell.station().project();
    const auto confirmed = confirm_spots(cell.station(), quickly());
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    ASSERT_TRUE(confirmed->ok) << said_of(*confirmed).english();
    EXPECT_EQ(cell.station().project().spots[0].reference_state, ReferenceState::from_drawing)
        << "nothing is taken before somebody saves it";
    ASSERT_EQ(confirmed->regions.size(), 1u);
    EXPECT_TRUE(confirmed->regions[0].judged);
    EXPECT_LT(confirmed->regions[0].largest_mm, 0.3);
    for (std::size_t i = 0; i < drawn.spots.size(); ++i) {
        const Spot &was = drawn.spots[i], &is = confirmed->project.spots[i];
        EXPECT_EQ(is.reference_state, ReferenceState::measured);
        EXPECT_EQ(is.reference_arrivals, 2);
        EXPECT_NE(is.reference_mm, was.reference_mm);
        EXPECT_LT((is.reference_mm - was.reference_mm).norm(), 0.5);
        EXPECT_EQ(is.drawn->reference_mm, was.reference_mm) << "what was drawn stays known";
        if (is.feature.kind == "template") {
            EXPECT_NE(is.feature.template_profile.z_mm, was.feature.template_profile.z_mm);
        }
        EXPECT_TRUE(is.base_from_flange.isApprox(was.base_from_flange, 0));
    }
    ASSERT_TRUE(cell.station().edit(confirmed->project));
    EXPECT_TRUE(unconfirmed_spots(cell.station().project(), cell.region()).empty());
    const RunRecord after = cell.dry_run();
    ASSERT_TRUE(after.regions[0].correction);
    EXPECT_TRUE(after.regions[0].gate_passed)
        << (after.regions[0].refusals.empty() ? "" : after.regions[0].refusals[0].english());
    // Undone as the studio does it: the project of before.
    ASSERT_TRUE(cell.station().edit(drawn));
    EXPECT_FALSE(cell.dry_run().regions[0].gate_passed);
    // Once more there is nothing to do.
    ASSERT_TRUE(cell.station().edit(confirmed->project));
    const auto again = confirm_spots(cell.station(), quickly());
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::input);
}

TEST(Confirm, APartThatStandsElsewhereIsToldApartFromOneThatIsAnother) {
    // 2 mm and 0.1 degree: all spots agree on it.
    OfflineCell near(make_pose(rotation_exp({0, 0, rad_from_deg(0.1)}), {1.2, -1.5, 0.8}), door_drawing());
    const auto moved = confirm_spots(near.station(), quickly());
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_TRUE(moved->ok) << said_of(*moved).english();
    const Pose& d = moved->regions.at(0).displacement.workobject_from_movedworkobject;
    EXPECT_LT((d.translation() - Eigen::Vector3d(1.2, -1.5, 0.8)).norm(), 0.6);
    EXPECT_GT(moved->regions[0].largest_mm, 1.5);
    // 8 mm is too far to be this place of this part.
    OfflineCell far(make_pose(Eigen::Matrix3d::Identity(), {0, 8, 0}), door_drawing());
    const auto off = confirm_spots(far.station(), quickly());
    ASSERT_TRUE(off) << off.error().sentence();
    EXPECT_FALSE(off->ok);
    for (const Spot& spot : off->project.spots)
        EXPECT_EQ(spot.reference_state, ReferenceState::from_drawing) << "all or none";
}

TEST(Confirm, TheDrawingOfTheOtherDoorIsRefused) {
    OfflineCell cell(Pose::Identity(), mirrored(door_drawing()));
    const auto confirmed = confirm_spots(cell.station(), quickly());
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_FALSE(confirmed->ok);
    EXPECT_THAT(said_of(*confirmed).english(), HasSubstr("is not confirmed"));
}

// Known answers, from profiles that this test makes: every spot sees what was drawn, shifted by what the test says.
class JudgedShifts : public testing::Test {
  protected:
    JudgedShifts() : cell_(Pose::Identity(), door_drawing()), project_(cell_.station().project()) {
        for (const Spot& s : project_.spots) ids_.push_back(s.id);
    }
    TaughtSpot shifted(const Spot& drawn, const Eigen::Vector2d& by) {
        TaughtSpot taught;
        taught.spot = drawn;
        taught.spot.reference_state = ReferenceState::measured;
        taught.spot.reference_mm += Eigen::Vector3d(by.x(), 0, by.y());
        taught.spot.reference_arrivals = 5;
        for (double& x : taught.spot.reference_profile.x_mm) x += by.x();
        for (double& z : taught.spot.reference_profile.z_mm) z += by.y();
        taught.mean = taught.spot.reference_profile;
        SpotMeasurement m;
        m.status = SpotStatus::measured;
        m.feature.covariance_mm2 = 1e-4 * Eigen::Matrix2d::Identity();
        taught.measurements = {m};
        return taught;
    }
    Confirmation judge(const std::function<Eigen::Vector2d(const Spot&)>& by) {
        std::vector<Expected<TaughtSpot>> taught;
        for (const Spot& s : project_.spots) taught.push_back(shifted(s, by(s)));
        auto judged = judge_confirmation(project_, ids_, taught, {});
        EXPECT_TRUE(judged) << judged.error().sentence();
        return *judged;
    }
    // What a displacement of the part does in the laser plane of a spot, its edge taken as straight.
    Eigen::Vector2d seen(const Spot& s, const Pose& d) const {
        const Pose w = project_.part.base_from_workobject.inverse() * s.base_from_flange *
                       project_.calibrations[0].flange_from_sensor;
        const Eigen::Vector3d p = w.inverse() * (d * (w * s.reference_mm)) - s.reference_mm;
        Eigen::Vector2d shift(p.x(), p.z());
        if (s.curve) shift -= p.y() * Eigen::Vector2d(s.curve->x_coefficients[0], s.curve->z_coefficients[0]);
        return shift;
    }
    OfflineCell cell_;
    Project project_;
    std::vector<std::string> ids_;
};

TEST_F(JudgedShifts, ARigidOneIsFoundAndOneThatContradictsIsNamed) {
    const Pose d = make_pose(rotation_exp({0.0005, 0, 0.001}), {1, -0.5, 0.4});
    const Confirmation rigid = judge([&](const Spot& s) { return seen(s, d); });
    EXPECT_TRUE(rigid.ok) << said_of(rigid).english();
    ASSERT_TRUE(rigid.regions.at(0).judged);
    EXPECT_LT((rigid.regions[0].displacement.workobject_from_movedworkobject.translation() - d.translation())
                  .norm(),
              0.05);
    for (const SpotConfirmation& s : rigid.spots) EXPECT_LT(s.left_mm, 0.05);
    for (const std::string& wrong : {ids_[1], ids_[4]}) {
        const Confirmation one = judge([&](const Spot& s) -> Eigen::Vector2d {
            return seen(s, d) + (s.id == wrong ? Eigen::Vector2d(2.5, -2) : Eigen::Vector2d(0, 0));
        });
        EXPECT_FALSE(one.ok);
        for (const SpotConfirmation& s : one.spots)
            EXPECT_EQ(s.finding, s.spot_id == wrong ? ConfirmFinding::contradicts : ConfirmFinding::ok)
                << s.spot_id;
        EXPECT_THAT(said_of(one).english(), HasSubstr(wrong));
    }
}

TEST_F(JudgedShifts, TooFarOrAnotherContourIsRefused) {
    const Confirmation far = judge([](const Spot&) { return Eigen::Vector2d(0, 5.2); });
    for (const SpotConfirmation& s : far.spots) EXPECT_EQ(s.finding, ConfirmFinding::shifted_too_far);
    std::vector<Expected<TaughtSpot>> taught;
    for (const Spot& s : project_.spots) taught.push_back(shifted(s, {0, 0}));
    // A bare sheet: nothing of the drawn step in it.
    for (double& z : taught[2]->mean.z_mm) z = taught[2]->spot.reference_mm.z();
    const auto judged = judge_confirmation(project_, ids_, taught, {});
    ASSERT_TRUE(judged);
    EXPECT_FALSE(judged->ok);
    EXPECT_EQ(judged->spots[2].finding, ConfirmFinding::other_contour);
    taught[3] = input_error("the feature was found in 0 of 10 measurements", "spot");
    EXPECT_EQ(judge_confirmation(project_, ids_, taught, {})->spots[3].finding, ConfirmFinding::not_measured);
}

TEST_F(JudgedShifts, HostileArgumentsAreOneSentence) {
    const auto refused = [&](const std::function<void(ConfirmOptions&)>& spoil, const char* words) {
        ConfirmOptions o;
        spoil(o);
        const auto confirmed = confirm_spots(cell_.station(), o);
        ASSERT_FALSE(confirmed) << words;
        EXPECT_THAT(confirmed.error().sentence(), HasSubstr(words));
    };
    refused([](ConfirmOptions& o) { o.spot_ids = {"nobody"}; }, "there is no spot \"nobody\"");
    refused([](ConfirmOptions& o) { o.region_id = "nowhere"; }, "there is no region \"nowhere\"");
    refused([&](ConfirmOptions& o) { o.region_id = "top", o.spot_ids = {ids_[0]}; }, "one or the other");
    refused([](ConfirmOptions& o) { o.shift_limit_mm = std::nan(""); }, "limit of the shift");
    refused([](ConfirmOptions& o) { o.form_mm = 0; }, "differ from its drawing");
    refused([](ConfirmOptions& o) { o.repeats = 0; }, "repeats");
    Project lost = project_;
    Spot moved = lost.spots[0];
    moved.base_from_flange.translation().x() += 1;
    lost.spots[0] = with_reference_of(lost.spots[0], moved);
    ASSERT_TRUE(cell_.station().edit(lost));
    EXPECT_EQ(lost.spots[0].reference_state, ReferenceState::from_drawing)
        << "moved, still nobody has seen it";
    refused([&](ConfirmOptions& o) { o.spot_ids = {ids_[0]}; }, "was lost when its pose");
}

}  // namespace
}  // namespace seamwright
