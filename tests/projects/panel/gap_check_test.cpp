// The gap check on the simulated cell: known gaps, slanted passes, noise, places where the nozzle sticks.

#include "projects/panel/gap_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "devices/capture/recorder.h"
#include "devices/simulated/scene/gap_part.h"
#include "devices/simulated/scene/profile_cut.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

class GapCheckTest : public testing::Test {
  protected:
    TemporaryFolder folder;
    Project project;
    Pose flange_from_sensor = make_pose(rotation_exp({0.1, 0.2, -0.3}), {20, -10, 120});
    void SetUp() override {
        project.name = "gap";
        project.part.base_from_workobject = make_pose(rotation_exp({0.2, 0.1, 1.1}), {1400, 300, 500});
        SensorSetup sensor;
        sensor.id = "A";
        sensor.driver = "simulated";
        sensor.calibration_id = "C";
        project.sensors.push_back(sensor);
        Calibration c;
        c.id = "C";
        c.sensor_id = "A";
        c.flange_from_sensor = flange_from_sensor;
        project.calibrations.push_back(c);
    }
    struct Pass {
        double from = -60, to = 60, step = 0.5, yaw_deg = 0, noise_mm = 0;
        bool own_poses = true;                         // else the robot's, every fifth profile, by time
        double blind_from = 1, blind_to = 0;           // profiles without return
        double blind_x_from = -1e9, blind_x_to = 1e9;  // of them, only there
        bool blind_lost = false;                       // frames that never came, instead
        unsigned seed = 1;
    };
    Expected<GapCheck> measure(const std::vector<GapStation>& stations, const Pass& pass, double nozzle = 2,
                               double clearance = 0.5) {
        const auto path = folder / ("pass" + std::to_string(number_++) + ".seam");
        const MeshTree part(gap_part_mesh(stations, 0));
        {
            auto recorder = Recorder::create(path);
            const auto sensor = (*recorder)->add_sensor("A", {"simulated", "Seamwright", "S", "1"});
            const auto robot = (*recorder)->add_robot("R", {"simulated", "KUKA", "KR", "2"});
            Random random(pass.seed);
            Frame frame;
            int k = 0;
            for (double y = pass.from; y <= pass.to + 1e-9; y += pass.step, ++k) {
                const Pose at = make_pose(rotation_exp({0, 0, rad_from_deg(pass.yaw_deg)}), {0, y, 0});
                const Pose flange = project.part.base_from_workobject * at * flange_from_sensor.inverse();
                cut_profile(part, at, {}, frame.profile);
                if (pass.noise_mm > 0) add_noise(frame.profile, pass.noise_mm, random);
                if (y >= pass.blind_from && y <= pass.blind_to) {
                    if (pass.blind_lost) continue;
                    for (std::size_t i = 0; i < frame.profile.size(); ++i)
                        if (frame.profile.x_mm[i] > pass.blind_x_from &&
                            frame.profile.x_mm[i] < pass.blind_x_to)
                            frame.profile.z_mm[i] = std::nan("");
                }
                frame.sequence = static_cast<std::uint64_t>(k);
                frame.host_time_ns = 1'000'000'000 + 5'000'000LL * k;
                frame.base_from_flange.reset();
                if (pass.own_poses)
                    frame.base_from_flange = flange;
                else if (k % 5 == 0)
                    (*recorder)->event({*robot, CaptureEventKind::pose, frame.host_time_ns, "", "", flange});
                (*recorder)->frame(*sensor, frame);
            }
            if (auto done = (*recorder)->finish(); !done) return tl::unexpected(done.error());
        }
        auto reader = CaptureReader::open(path);
        if (!reader) return tl::unexpected(reader.error());
        GapScanOptions options;
        options.nozzle_mm = nozzle;
        options.clearance_mm = clearance;
        auto found = gap_pass(project, *reader, RecordedGapPass{});
        if (!found) return tl::unexpected(found.error());
        return check_gap(project, *found, options);
    }

  private:
    int number_ = 0;
};

const std::vector<GapStation> kWide{{-100, 5, 0}, {100, 5, 0}};
const std::vector<GapStation> kPinched{{-100, 5, 0}, {-15, 5, 0}, {0, 2.4, 0}, {15, 5, 0}, {100, 5, 0}};
constexpr double kPitchMm = 100.0 / 1280;

TEST_F(GapCheckTest, KnownWidthIsFoundWithinAPitchAndPasses) {
    const auto r = measure(kWide, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_TRUE(r->scan.passes());
    EXPECT_EQ(r->scan.measured, r->scan.points.size());
    EXPECT_NEAR(r->scan.length_mm, 120, 1e-6);
    for (const GapPoint& p : r->scan.points) {
        EXPECT_NEAR(p.width_mm, 5, 1.5 * kPitchMm);
        EXPECT_NEAR(p.flush_mm, 0, 0.01);
        EXPECT_LT(std::abs(p.yaw_deg), 0.2);
        EXPECT_NEAR(p.middle_mm.x(), 0, kPitchMm);
        EXPECT_NEAR(std::abs(p.along.y()), 1, 1e-4);
    }
}

TEST_F(GapCheckTest, SlantedCutDoesNotMakeTheGapWider) {
    for (const double yaw : {-25.0, 12.0, 25.0}) {
        Pass pass;
        pass.yaw_deg = yaw;
        const auto r = measure(kWide, pass);
        ASSERT_TRUE(r);
        for (const GapPoint& p : r->scan.points) {
            EXPECT_NEAR(p.cut_mm, 5 / std::cos(rad_from_deg(yaw)), 1.5 * kPitchMm);
            EXPECT_NEAR(p.width_mm, 5, 1.5 * kPitchMm);
            EXPECT_NEAR(p.yaw_deg, yaw, 0.3);
        }
    }
}

TEST_F(GapCheckTest, NamesWhereTheNozzleDoesNotPass) {
    for (const bool own_poses : {true, false}) {
        Pass pass;
        pass.own_poses = own_poses;
        const auto r = measure(kPinched, pass);
        ASSERT_TRUE(r) << r.error().sentence();
        EXPECT_FALSE(r->scan.passes());
        EXPECT_NEAR(r->scan.narrowest_mm, 2.4, 0.1);
        const GapStretch* narrow = nullptr;
        for (const GapStretch& s : r->scan.stretches) {
            EXPECT_NE(s.verdict, GapVerdict::not_measured);
            if (s.verdict == GapVerdict::too_narrow && (!narrow || s.narrowest_mm < narrow->narrowest_mm))
                narrow = &s;
        }
        ASSERT_NE(narrow, nullptr);
        // 3 mm are needed; the gap is that wide 3.46 mm before and behind its narrowest place at path 60.
        EXPECT_NEAR(narrow->from_mm, 60 - 3.46, 1.0);
        EXPECT_NEAR(narrow->to_mm, 60 + 3.46, 1.0);
        EXPECT_NEAR(narrow->at_mm, 60, 1.0);
        EXPECT_NEAR(narrow->place_mm.y(), 0, 1.0);
        for (const GapPoint& p : r->scan.points)
            if (std::abs(p.middle_mm.y()) > 6) {
                EXPECT_EQ(p.verdict, GapVerdict::passes)
                    << p.path_mm << " " << p.width_mm << " " << p.sigma_mm;
            }
    }
}

TEST_F(GapCheckTest, StatedSigmaIsHonestUnderNoise) {
    const std::vector<GapStation> tapered{{-100, 3.6, 0}, {100, 5.9, 0}};
    for (const double noise : {0.0, 0.03, 0.06}) {
        double squares = 0, sum = 0;
        int count = 0, outside = 0;
        for (unsigned seed = 1; seed <= 4; ++seed) {
            Pass pass;
            pass.noise_mm = noise;
            pass.seed = seed;
            const auto r = measure(tapered, pass);
            ASSERT_TRUE(r) << r.error().sentence();
            EXPECT_TRUE(r->scan.passes());
            for (const GapPoint& p : r->scan.points) {
                if (p.verdict == GapVerdict::not_measured) continue;
                const double off = p.width_mm - gap_at(tapered, p.middle_mm.y()).width_mm;
                sum += off;
                squares += off * off / (p.sigma_mm * p.sigma_mm);
                outside += std::abs(off) > 3 * p.sigma_mm;
                ++count;
            }
        }
        ASSERT_GT(count, 900);
        // Hardly too wide on average (a fifth of a pitch, where the last of a rim stands between two lines), too
        // narrow by at most two standard deviations of the noise.
        EXPECT_LT(sum / count, 0.2 * kPitchMm) << noise;
        EXPECT_GT(sum / count, -2 * noise - 0.01) << noise;
        const double ratio = std::sqrt(squares / count);
        EXPECT_GT(ratio, 0.5) << noise;
        EXPECT_LT(ratio, 1.6) << noise;
        EXPECT_LT(outside, 0.03 * count) << noise;
    }
}

TEST_F(GapCheckTest, StepOfTheSheetsIsTheFlush) {
    const std::vector<GapStation> stepped{{-100, 4, -0.6}, {0, 4, 0.4}, {100, 4, 1.4}};
    const auto r = measure(stepped, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_TRUE(r->scan.passes());
    for (const GapPoint& p : r->scan.points) {
        ASSERT_NE(p.verdict, GapVerdict::not_measured) << p.path_mm << ": " << p.message;
        EXPECT_NEAR(p.flush_mm, gap_at(stepped, p.middle_mm.y()).flush_mm, 0.02) << p.path_mm;
        EXPECT_NEAR(p.width_mm, 4, 1.5 * kPitchMm) << p.path_mm;
    }
}

TEST_F(GapCheckTest, HolesOfTheScanAreNamedWhenTheyAreLong) {
    for (const bool lost : {false, true}) {
        Pass pass;
        pass.blind_lost = lost;
        pass.blind_from = 10;
        pass.blind_to = 12;
        EXPECT_TRUE(measure(kWide, pass)->scan.passes());
        pass.blind_to = 30;
        const auto r = measure(kWide, pass);
        ASSERT_TRUE(r);
        EXPECT_FALSE(r->scan.passes());
        ASSERT_EQ(r->scan.stretches.size(), 1u);
        EXPECT_EQ(r->scan.stretches[0].verdict, GapVerdict::not_measured);
        EXPECT_NEAR(r->scan.stretches[0].from_mm, 69.5, 1e-6);
        EXPECT_NEAR(r->scan.stretches[0].to_mm, 90.5, 1e-6);
    }
    Pass start;
    start.blind_from = -60;
    start.blind_to = -50;
    const auto r = measure(kWide, start);
    ASSERT_TRUE(r);
    ASSERT_EQ(r->scan.stretches.size(), 1u) << "a hole at the end of the pass is one too";
    EXPECT_NEAR(r->scan.stretches[0].to_mm, 10.5, 1e-6);
}

TEST_F(GapCheckTest, ClosedGapIsNamedHoweverShort) {
    // A clip 2 mm long bridges the gap: shorter than any hole that is let pass.
    const std::vector<GapStation> clipped{{-100, 5, 0}, {9, 5, 0},     {9.01, 0, 0},
                                          {11, 0, 0},   {11.01, 5, 0}, {100, 5, 0}};
    const auto r = measure(clipped, {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_FALSE(r->scan.passes());
    ASSERT_EQ(r->scan.stretches.size(), 1u);
    EXPECT_EQ(r->scan.stretches[0].verdict, GapVerdict::closed);
    EXPECT_NEAR(r->scan.stretches[0].from_mm, 69.5, 0.51);
    EXPECT_NEAR(r->scan.stretches[0].to_mm, 70.5, 0.51);
    EXPECT_NEAR(r->scan.stretches[0].place_mm.y(), 9.5, 0.51);
}

TEST_F(GapCheckTest, DarkPatchBesideANarrowGapIsNotTakenForTheGap) {
    // A patch 8 mm wide that returns nothing, where the gap itself is too narrow.
    const std::vector<GapStation> narrow{{-100, 2.4, 0}, {100, 2.4, 0}};
    Pass pass;
    pass.blind_from = -4;
    pass.blind_to = 4;
    pass.blind_x_from = 15;
    pass.blind_x_to = 23;
    const auto r = measure(narrow, pass);
    ASSERT_TRUE(r) << r.error().sentence();
    for (const GapPoint& p : r->scan.points) {
        EXPECT_EQ(p.verdict, GapVerdict::too_narrow) << p.path_mm;
        EXPECT_NEAR(p.width_mm, 2.4, 1.5 * kPitchMm) << p.path_mm;
    }
}

TEST_F(GapCheckTest, HostileInputIsRefused) {
    EXPECT_THAT(measure(kWide, {}, -1).error().sentence(), HasSubstr("nozzle_mm"));
    EXPECT_THAT(measure(kWide, {}, 2, std::nan("")).error().sentence(), HasSubstr("clearance_mm"));
    EXPECT_FALSE(with_values({}, {{"nozzel_mm", 3}}));
    EXPECT_FALSE(with_values({}, {{"x_min_mm", 5}, {"x_max_mm", 4}}));
    project.sensors[0].calibration_id = "";
    EXPECT_THAT(measure(kWide, {}).error().sentence(), HasSubstr("no calibration"));
    project.sensors.clear();
    EXPECT_THAT(measure(kWide, {}).error().sentence(), HasSubstr("no sensor"));
    EXPECT_FALSE(scan_gap({}, {}));
    GapSection broken;
    broken.frame_from_sensor.linear()(0, 0) = 2;
    EXPECT_FALSE(scan_gap({&broken, 1}, {}));
    GapSection raw;
    raw.profile.x_mm = {0, 1};
    raw.profile.z_mm = {0, 0};
    EXPECT_THAT(scan_gap({&raw, 1}, {}).error().sentence(), HasSubstr("filtered"));
}

TEST_F(GapCheckTest, ProfilesAreTakenWithoutExtrapolatingTheRobot) {
    Pass pass;
    pass.own_poses = false;  // poses with frames 0, 5, .., 240: all but none is left without
    const auto all = measure(kWide, pass);
    ASSERT_TRUE(all);
    EXPECT_EQ(all->scan.points.size(), 241u);
    pass.to = 61;  // the last two frames come after the last pose
    const auto some = measure(kWide, pass);
    ASSERT_TRUE(some);
    EXPECT_EQ(some->scan.points.size(), 241u);
}

// The simulated cell: rendered images, the robot driven from spot to spot, a part that stands off.
TEST(GapCheckOnTheCell, DrivenAlongTheSpotsFindsTheKnownGap) {
    TemporaryFolder folder;
    const std::vector<GapStation> gap{
        {-60, 4.5, 0}, {-15, 4.5, 0}, {5, 2.5, 0.3}, {25, 4.5, 0.3}, {60, 4.5, 0.3}};
    const nlohmann::json settings = {{"seed", 4},
                                     {"optics", {{"width", 800}, {"height", 640}, {"field_mm", 60}}},
                                     {"robot", {{"repeatability_mm", 0.01}, {"repeatability_deg", 0.001}}}};
    auto project = simulated_gap_project(settings, gap, folder / "sheets.ply");
    ASSERT_TRUE(project) << project.error().sentence();
    EXPECT_FALSE(simulated_gap_project(settings, gap, folder / "sheets.ply")) << "nothing is overwritten";
    auto file = ProjectFile::create(folder / "gap.seam", *project);
    ASSERT_TRUE(file) << file.error().sentence();
    Station station(std::move(*file), *project);
    DrivenGapPass drive;
    drive.spot_ids = {"S1", "S4"};
    drive.step_mm = 1.5;
    EXPECT_FALSE(gap_pass(station, drive)) << "not connected";
    ASSERT_TRUE(station.connect());
    const auto pass = gap_pass(station, drive);
    ASSERT_TRUE(pass) << pass.error().sentence();
    EXPECT_EQ(pass->frames, 74u);  // a little over 108 mm between the spots
    GapScanOptions options;
    options.nozzle_mm = 2.5;
    options.clearance_mm = 0.25;
    const auto r = check_gap(*project, *pass, options);
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_FALSE(r->scan.passes());
    EXPECT_GT(r->scan.measured, 70u);
    int widths = 0, outside = 0;
    for (const GapPoint& p : r->scan.points) {
        if (!has_width(p.verdict)) continue;
        const GapStation truth = gap_at(gap, p.middle_mm.y());
        ++widths;
        const double off = p.width_mm - truth.width_mm, pitch = 60.0 / 800;
        // The image's blur carries an edge outward, by about a pixel.
        outside += off > 3 * p.sigma_mm || off < -3 * p.sigma_mm - 2 * pitch;
        EXPECT_NEAR(p.flush_mm, truth.flush_mm, 0.1) << p.path_mm;
        EXPECT_EQ(p.verdict == GapVerdict::passes, p.width_mm - 3 * p.sigma_mm >= 3) << p.path_mm;
        if (truth.width_mm < 2.9) {
            EXPECT_NE(p.verdict, GapVerdict::passes) << p.path_mm;
        }
        if (truth.width_mm > 4.4) {
            EXPECT_EQ(p.verdict, GapVerdict::passes) << p.path_mm << " " << p.width_mm << " " << p.sigma_mm;
        }
    }
    EXPECT_LE(outside, 0.05 * widths) << "never wider than the stated sigma tells";
    ASSERT_EQ(r->spots.size(), 4u);
    EXPECT_EQ(r->spots[0].first, "S1");
    ASSERT_FALSE(r->scan.stretches.empty());
    EXPECT_EQ(r->where(59), "between S2 and S3");
    EXPECT_EQ(r->where(0), "at S1");

    drive.spot_ids = {"S1"};
    EXPECT_FALSE(gap_pass(station, drive));
    drive.spot_ids = {"S1", "S9"};
    EXPECT_FALSE(gap_pass(station, drive));
    drive.spot_ids = {"S1", "S2"};
    drive.step_mm = std::nan("");
    EXPECT_FALSE(gap_pass(station, drive));
    std::stop_source stop;
    stop.request_stop();
    drive.step_mm = 1;
    drive.cancel = stop.get_token();
    EXPECT_THAT(gap_pass(station, drive).error().sentence(), HasSubstr("cancelled"));
}

}  // namespace
}  // namespace seamwright
