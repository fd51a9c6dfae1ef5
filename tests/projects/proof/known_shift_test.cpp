#include "projects/proof/known_shift.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/measure/measure.h"
#include "projects/proof/checklist.h"
#include "projects/proof/zero_shift.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

// A door whose references are measured, at fewer spots than the default for speed.
class Door : public testing::Test {
  protected:
    TemporaryFolder folder;
    std::filesystem::path path = folder / "door.seam";
    Project project;

    void SetUp() override {
        const nlohmann::json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings);
        ASSERT_TRUE(cell);
        project = door_project(**cell, settings);
        project.requirements.sigma3_mm = 0.5;
        ASSERT_TRUE(ProjectFile::create(path, project));
        auto station = Station::open(path);
        ASSERT_TRUE(station->connect());
        const auto run = station->run({});
        ASSERT_TRUE(run);
        for (std::size_t i = 0; i < run->spots.size(); ++i) {
            project.spots[i].enabled = run->spots[i].status == SpotStatus::measured;
            project.spots[i].reference_mm = run->spots[i].measured_mm;
        }
        ASSERT_TRUE(station->file().save(project));
    }
    static ShiftGrid small() {
        ShiftGrid grid;
        grid.range_mm = grid.step_mm = 4;
        grid.range_deg = grid.step_deg = 0.4;
        return grid;
    }
};

TEST_F(Door, SimulatedPartAndShiftedMovesFindTheSameShifts) {
    auto station = Station::open(path);
    ASSERT_TRUE(station);
    ASSERT_TRUE(station->connect());
    std::vector<KnownShift> proofs;
    for (const ShiftBy by : {ShiftBy::simulated_part, ShiftBy::robot_moves}) {
        KnownShiftOptions options;
        options.by = by;
        options.grid = small();
        int told = 0;
        options.progress = [&](const RunProgress& p) { told = p.done; };
        auto proof = prove_known_shift(*station, options);
        ASSERT_TRUE(proof) << proof.error().sentence();
        EXPECT_EQ(proof->tests.size(), 18u);
        EXPECT_EQ(told, 18);
        const ProvenAccuracy proven = proven_accuracy(*proof, "all");
        EXPECT_EQ(proven.tests, 18);
        std::string refusals;
        for (const ShiftTest& test : proof->tests)
            if (!test.regions[0].ok)
                refusals += shift_name(test, *proof) + ": " + test.regions[0].message.english() + "\n";
        // The end of a contour is lost at single displacements; then a region is refused, never wrong.
        EXPECT_LE(proven.refused, 2) << refusals;
        EXPECT_LT(proven.three_sigma_mm, 0.4);
        EXPECT_GT(proven.three_sigma_mm, 0.005) << "the simulation has noise";
        proofs.push_back(*proof);
        EXPECT_TRUE(station->connected()) << "as it was before";
    }
    // The same physics twice: means of the deviations agree within their scatter.
    const auto a = statistics(proofs[0]), b = statistics(proofs[1]);
    ASSERT_EQ(a.size(), 3u);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i].summary.mean, b[i].summary.mean, 0.03);
    const auto kept = station->file().evidence().value();
    ASSERT_EQ(kept.size(), 2u);
    EXPECT_EQ(exact_text(std::get<KnownShift>(kept[0].what)), exact_text(proofs[0]));
    // Truths of the table: every displacement was measured by a run of its own, named after it.
    for (const ShiftTest& test : proofs[1].tests)
        EXPECT_EQ(station->file().load_run(test.run, false)->part_id,
                  kKnownShiftPrefix + shift_name(test, proofs[1]));
}

TEST_F(Door, ABiasIsFoundAndNotHidden) {
    // References that are 0.5 mm off read as deviations although scatter is small.
    for (Spot& spot : project.spots) spot.reference_mm.z() += 0.5;
    auto station = Station::open(path);
    ASSERT_TRUE(station->edit(project));
    KnownShiftOptions options;
    options.grid = small();
    const auto proof = prove_known_shift(*station, options);
    ASSERT_TRUE(proof) << proof.error().sentence();
    const ProvenAccuracy proven = proven_accuracy(*proof, "all");
    EXPECT_GT(proven.three_sigma_mm, 0.5) << "3 rms counts the mean";
    Facts facts;
    ASSERT_TRUE(gather(station->file(), facts));
    for (const CheckItem& item : checklist(project, facts)) {
        if (item.step != CheckStep::known_shift) continue;
        EXPECT_FALSE(item.done());
    }
}

TEST_F(Door, LimitsOfTheDayDoNotCount) {
    project.regions[0].limits = {0.5, 0.05};
    auto station = Station::open(path);
    ASSERT_TRUE(station->edit(project));
    KnownShiftOptions options;
    options.grid = small();
    const auto proof = prove_known_shift(*station, options);
    ASSERT_TRUE(proof) << proof.error().sentence();
    EXPECT_GT(proven_range(*proof).translation_mm, 3.9) << "the limits may be raised to what was proven";
    EXPECT_EQ(station->project().regions[0].limits.translation_mm, 0.5);
    EXPECT_EQ(station->file().load()->regions[0].limits.translation_mm, 0.5);
}

TEST_F(Door, CancelledLeavesNoEvidence) {
    auto station = Station::open(path);
    std::stop_source stop;
    KnownShiftOptions options;
    options.grid = small();
    options.cancel = stop.get_token();
    options.progress = [&](const RunProgress& p) {
        if (p.done == 2) stop.request_stop();
    };
    const auto proof = prove_known_shift(*station, options);
    ASSERT_FALSE(proof);
    EXPECT_THAT(proof.error().what, testing::HasSubstr("cancelled after 2 of 18"));
    EXPECT_TRUE(station->file().evidence()->empty());
    EXPECT_FALSE(station->connected());
}

TEST_F(Door, ByHandAsksBeforeEachAndCanEnd) {
    auto station = Station::open(path);
    KnownShiftOptions options;
    options.by = ShiftBy::by_hand;
    options.grid = small();
    EXPECT_FALSE(prove_known_shift(*station, options)) << "nobody is there";
    std::vector<Pose> shifts;
    options.place = [&](const ShiftTest& test, const Pose& shift) {
        const Pose& b = project.part.base_from_workobject;
        // The base shift undoes the displacement: shift * b * D = b.
        EXPECT_TRUE((shift * b * test.workobject_from_movedworkobject).isApprox(b, 1e-12));
        shifts.push_back(shift);
        return shifts.size() < 3;
    };
    const auto proof = prove_known_shift(*station, options);
    ASSERT_FALSE(proof);
    EXPECT_EQ(shifts.size(), 3u);
    EXPECT_EQ(station->file().runs()->size(), 3u) << "teaching and two displacements";
}

TEST_F(Door, ZeroShiftReadsZeroAndIsKept) {
    auto station = Station::open(path);
    ASSERT_TRUE(station->connect());
    int runs = 0;
    ZeroShiftOptions options;
    options.runs = 3;
    options.measured = [&](const RunRecord&) { ++runs; };
    const auto zero = measure_zero_shift(*station, options);
    ASSERT_TRUE(zero) << zero.error().sentence();
    EXPECT_EQ(runs, 3);
    ASSERT_EQ(zero->regions.size(), 1u);
    EXPECT_LT(zero->regions[0].worst_mean_mm, 0.3);
    EXPECT_EQ(station->file().evidence()->size(), 1u);
    // Summarised again from the file: the same.
    std::vector<RunRecord> again;
    for (const std::int64_t n : zero->runs) again.push_back(station->file().load_run(n).value());
    EXPECT_EQ(exact_text(summarise_zero_shift(station->project(), again)), exact_text(*zero));
}

TEST(KnownShift, JudgesAgainstTheTruthAndNotAgainstItself) {
    Project project = sample_project();
    project.calibrations[0].flange_from_sensor = Pose::Identity();
    const Pose truth = make_pose(rotation_exp({0, 0.01, 0}), {3, 0, 0});
    RunRecord run;
    RegionRecord& region = run.regions.emplace_back();
    region.region_id = "edge";
    region.gate_passed = true;
    region.correction.emplace();
    region.correction->status = CorrectionStatus::ok;
    region.correction->displacement.workobject_from_movedworkobject = truth;
    auto outcome = judge_shift(project, run, truth);
    ASSERT_EQ(outcome.size(), 1u);
    EXPECT_TRUE(outcome[0].ok);
    EXPECT_EQ(outcome[0].deviations_mm.size(), 15u) << "five enabled spots";
    for (double d : outcome[0].deviations_mm) EXPECT_EQ(d, 0);
    region.correction->displacement.workobject_from_movedworkobject =
        make_pose(Eigen::Matrix3d::Identity(), {0.1, 0, -0.2}) * truth;
    outcome = judge_shift(project, run, truth);
    for (std::size_t i = 0; i < 15; ++i)
        EXPECT_NEAR(outcome[0].deviations_mm[i], i % 3 == 0 ? 0.1 : i % 3 == 1 ? 0 : -0.2, 1e-9);
    EXPECT_NEAR(outcome[0].mean_abs_mm, std::hypot(0.1, 0.2), 1e-9);
    region.gate_passed = false;
    region.refusals = {"stale"};
    EXPECT_FALSE(judge_shift(project, run, truth)[0].ok);
    EXPECT_EQ(judge_shift(project, run, truth)[0].message, "stale");
    region.region_id = "other";
    EXPECT_FALSE(judge_shift(project, run, truth)[0].ok);
    EXPECT_TRUE(judge_shift(project, run, truth)[0].deviations_mm.empty());
}

TEST(KnownShift, GridCoversEveryAxisBothWaysAndTurnsAboutTheMiddle) {
    const Project project = sample_project();
    ShiftGrid grid;
    grid.range_mm = 10, grid.step_mm = 5, grid.range_deg = 1, grid.step_deg = 0.25;
    const auto tests = shift_tests(project, grid);
    ASSERT_TRUE(tests);
    EXPECT_EQ(tests->size(), 3u * (4 + 8 + 4));
    std::vector<Eigen::Vector3d> points = reference_points(project, project.regions[0]);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : points) middle += p / static_cast<double>(points.size());
    double largest_mm = 0, largest_deg = 0;
    for (const ShiftTest& t : *tests) {
        const Pose& d = t.workobject_from_movedworkobject;
        const Eigen::Vector3d moved = d * middle - middle;
        EXPECT_NEAR(moved[t.axis], t.kind == ShiftKind::rotation ? 0 : t.amount, 1e-9);
        EXPECT_NEAR(moved.norm(), std::abs(moved[t.axis]), 1e-9);
        largest_mm = std::max(largest_mm, moved.norm());
        largest_deg = std::max(largest_deg, deg_from_rad(angle_rad(d, Pose::Identity())));
    }
    EXPECT_NEAR(largest_mm, 10, 1e-9);
    EXPECT_NEAR(largest_deg, 1, 1e-9);
    grid.step_mm = 0;
    EXPECT_FALSE(shift_tests(project, grid));
    grid.step_mm = 1e-3;
    EXPECT_FALSE(shift_tests(project, grid)) << "too many";
}

TEST(KnownShift, TheTableIsThatOfChapterFive) {
    KnownShift proof;
    proof.range_mm = 2, proof.range_deg = 1;
    proof.tests = {{ShiftKind::translation, 0, 1, Pose::Identity(), 1, {{"r", true, 0, {0.1, 0.2, 0.3}, ""}}},
                   {ShiftKind::translation,
                    0,
                    2,
                    make_pose(Eigen::Matrix3d::Identity(), {2, 0, 0}),
                    2,
                    {{"r", false, 0, {-0.2}, "too far"}}}};
    const auto lines = statistics(proof);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0].tests, 2);
    EXPECT_EQ(lines[0].refused, 1);
    EXPECT_NEAR(lines[0].summary.mean, 0.1, 1e-12);
    EXPECT_NEAR(lines[0].summary.variance, (0 + 0.01 + 0.04 + 0.09) / 3, 1e-12);
    EXPECT_NEAR(lines[0].summary.three_sigma, 3 * std::sqrt(0.14 / 3), 1e-12);
    EXPECT_NEAR(lines[0].about_truth_mm, 3 * std::sqrt(0.18 / 4), 1e-12);
    EXPECT_EQ(lines[0].summary.minimum, -0.2);
    EXPECT_EQ(proven_range(proof).translation_mm, 0) << "what was refused is not proven";
}

TEST(KnownShift, OnlyASimulatedCellMovesItsPart) {
    TemporaryFolder folder;
    Project project = sample_project();
    project.sensors[0].driver = "replay";
    auto station = Station(ProjectFile::create(folder / "a.seam", project).value(), project);
    const auto proof = prove_known_shift(station, {});
    ASSERT_FALSE(proof);
    EXPECT_THAT(proof.error().what, testing::HasSubstr("simulated"));
}

}  // namespace
}  // namespace seamwright
