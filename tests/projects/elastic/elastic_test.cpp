// From stored runs to modes, and what they do to a run and to a path.

#include <gtest/gtest.h>

#include "projects/elastic/region_modes.h"
#include "projects/measure/path.h"
#include "tests/core/elastic/bent_doors.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using namespace bent_doors;

Project bent_project(const Door& d) {
    Project p;
    p.name = "door";
    p.sensors.emplace_back().id = "A";
    p.sensors.back().driver = "simulated";
    p.sensors.back().calibration_id = "C";
    p.robots.emplace_back().id = "R";
    p.robots.back().driver = "simulated";
    Calibration c;
    c.id = "C";
    c.method = "factory";
    c.sensor_id = "A";
    c.robot_id = "R";
    c.verdict = Verdict::good;
    p.calibrations.push_back(c);
    Region region;
    region.id = "door";
    region.frame_name = "F";
    region.sigma_limit_mm = 0.3;
    for (const SpotObservation& o : d.spots) {
        Spot s;
        s.id = o.id;
        s.sensor_id = "A";
        s.robot_id = "R";
        s.base_from_flange = o.workobject_from_sensor;
        s.feature.kind = "contour-end";
        s.reference_mm = o.reference_mm;
        s.sigma_mm = o.sigma_mm;
        s.stop_at_trigger = true;
        p.spots.push_back(s);
        region.spot_ids.push_back(o.id);
    }
    p.regions.push_back(region);
    return p;
}

std::vector<SpotMeasurement> measurements(const std::vector<SpotObservation>& spots) {
    std::vector<SpotMeasurement> out;
    for (const SpotObservation& o : spots) {
        SpotMeasurement m;
        m.spot_id = o.id;
        m.status = SpotStatus::measured;
        m.measured_mm = o.measured_mm;
        m.sigma_mm = o.sigma_mm;
        out.push_back(m);
    }
    return out;
}

RunRecord run_of(const Project& project, const Door& d, const std::string& part, const Pose& truth,
                 const Bend& bend, Rng& rng) {
    RunRecord run;
    run.part_id = part;
    run.started_utc = run.finished_utc = "2026-05-01T10:00:00.000Z";
    run.spots = measurements(measured(d, truth, bend, rng));
    run.regions = correct_regions(project, run.spots);
    for (RegionRecord& r : run.regions) r.gate_passed = r.correction.has_value();
    return run;
}

struct Stored {
    TemporaryFolder folder;
    Door d = door(12);
    Project project = bent_project(d);
    std::filesystem::path path = folder / "door.seam";
    Rng rng{7};
    explicit Stored(int parts, double bend, double twist) {
        auto file = ProjectFile::create(path, project);
        EXPECT_TRUE(file) << (file ? "" : file.error().sentence());
        std::normal_distribution<double> n;
        for (int i = 0; i < parts; ++i) {
            const Bend b{bend * n(rng), twist * n(rng), 0};
            const auto stored = file->append_run(
                run_of(project, d, fmt::format("part {}", i), small_motion(rng, 1, 0.1), b, rng), project);
            EXPECT_TRUE(stored);
        }
    }
};

TEST(RegionModes, AreLearntKeptSwitchedAndBendThePath) {
    Stored s(40, 0.3, 0.2);
    {
        auto file = ProjectFile::open(s.path);
        ASSERT_TRUE(file);
        const auto shapes = stored_shapes(*file, "");
        ASSERT_TRUE(shapes) << shapes.error().sentence();
        EXPECT_EQ(shapes->shapes.size(), 40u);
        auto modes = learn_region(*shapes, "2026-06-01T00:00:00.000Z");
        ASSERT_TRUE(modes) << modes.error().sentence();
        EXPECT_EQ(modes->modes.modes.size(), 2u);
        EXPECT_FALSE(modes->on);
        EXPECT_EQ(modes->learnt_from.size(), 40u);
        put_modes(s.project, *modes);
        ASSERT_TRUE(file->save(s.project));
    }
    const auto file = ProjectFile::open(s.path);
    ASSERT_TRUE(file);
    Project project = *file->load();
    const Pose truth = small_motion(s.rng, 1, 0.1);
    const Bend bend{0.4, 0.2, 0};
    Rng same(3), again(3);
    // Off: as if there were none.
    EXPECT_FALSE(run_of(project, s.d, "x", truth, bend, same).regions[0].modes);
    EXPECT_FALSE(switch_modes(project, "nowhere", true, 1, "now"));
    ASSERT_TRUE(switch_modes(project, "door", true, 1, "now"));
    EXPECT_FALSE(switch_modes(project, "door", true, 1, "now"));
    const RunRecord run = run_of(project, s.d, "x", truth, bend, again);
    ASSERT_TRUE(run.regions[0].modes);
    ASSERT_TRUE(run.regions[0].modes->acted) << run.regions[0].modes->why.english();

    ApplicationPath path;
    std::vector<double> t;
    for (double at = 0.02; at < 6.25; at += 0.05) {
        path.points.emplace_back().frame_from_tool = make_pose(Eigen::Matrix3d::Identity(), contour(at));
        t.push_back(at);
    }
    const auto off_across = [&](const RunRecord& of, const Project& setup) {
        const auto answer = correct_application_path(setup, of, path, PathFrame::workobject, {60, true});
        EXPECT_TRUE(answer) << (answer ? "" : answer.error().sentence());
        EXPECT_TRUE(answer->ok());
        double square = 0;
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double off =
                (answer->path.points[i].frame_from_tool.translation() - truth * bent(t[i], bend))
                    .dot(across(s.d, t[i]).first);
            square += off * off / static_cast<double>(t.size());
        }
        return 3 * std::sqrt(square);
    };
    RunRecord rigid = run;
    rigid.regions[0].modes.reset();
    const double with = off_across(run, project), without = off_across(rigid, project);
    EXPECT_LT(2 * with, without) << with << " " << without;

    // The gate refuses the rigid frame of so bent a part, the path of all points is what it is for; what else is refused holds.
    RunRecord gated = run;
    ASSERT_FALSE(gated.regions[0].correction->consistent);
    gated.regions[0].gate_passed = false;
    gated.regions[0].refusals = {"the spots contradict each other"};
    EXPECT_EQ(off_across(gated, project), with);
    gated.regions[0].refusals.push_back("the part has changed");
    const auto stale = correct_application_path(project, gated, path, PathFrame::workobject, {60, true});
    ASSERT_TRUE(stale);
    EXPECT_FALSE(stale->ok());
    gated.regions[0].refusals.pop_back();
    gated.regions[0].modes->acted = false;
    const auto unknown = correct_application_path(project, gated, path, PathFrame::workobject, {60, true});
    ASSERT_TRUE(unknown);
    EXPECT_FALSE(unknown->ok());

    // Its limit refuses the path.
    Project tight = project;
    tight.elastic[0].most_added_mm = 0.01;
    const auto refused = correct_application_path(tight, run, path, PathFrame::workobject, {60, true});
    ASSERT_TRUE(refused);
    EXPECT_FALSE(refused->ok());
}

TEST(RegionModes, ComparedOnPartsAndSpotsHeldOut) {
    const Stored s(30, 0.3, 0.2);
    const auto file = ProjectFile::open(s.path, FileAccess::read_only);
    ASSERT_TRUE(file);
    const auto shapes = stored_shapes(*file, "door");
    ASSERT_TRUE(shapes);
    const auto c = compare_region(*shapes);
    ASSERT_TRUE(c) << c.error().sentence();
    EXPECT_EQ(c->modes, 2);
    EXPECT_EQ(c->predictions, 30 * 12);
    EXPECT_GT(c->gain(), 1.5);
    EXPECT_GT(c->inside, 0.9);
}

TEST(RegionModes, RunsOfOtherSpotsAreLeftOutAndNoRunIsRefused) {
    Stored s(12, 0, 0);
    auto file = ProjectFile::open(s.path);
    ASSERT_TRUE(file);
    const auto rigid = stored_shapes(*file, "door");
    ASSERT_TRUE(rigid);
    const auto none = learn_region(*rigid, "now");
    ASSERT_TRUE(none);
    EXPECT_TRUE(none->modes.modes.empty());
    put_modes(s.project, *none);
    EXPECT_FALSE(switch_modes(s.project, "door", true, 1, "now"));
    EXPECT_FALSE(stored_shapes(*file, "other"));
    s.project.spots[3].reference_mm.x() += 0.1;
    ASSERT_TRUE(file->save(s.project));
    EXPECT_FALSE(stored_shapes(*file, "door"));
}

}  // namespace
}  // namespace seamwright
