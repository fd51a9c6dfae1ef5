#include "projects/panel/panel_station.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "devices/exchange/pose_json.h"
#include "devices/simulated/gripper_cell.h"
#include "projects/hand_over/hand_over.h"
#include "projects/measure/fields.h"
#include "projects/panel/panel_measure.h"
#include "projects/proof/replay.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/simulated_truth.h"
#include "projects/station/check.h"
#include "tests/projects/gate/numeric_members.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

nlohmann::json settings() {
    return {{"seed", 3}, {"robot", {{"repeatability_mm", 0.01}, {"repeatability_deg", 0.0005}}}};
}

// The station on a cell that the test can look into.
struct Bench {
    TemporaryFolder folder;
    Project project = simulated_panel_project(settings()).value();
    std::shared_ptr<GripperCell> cell = GripperCell::open(project.robots[0].settings).value();
    Station station;

    Bench() : station(ProjectFile::create(folder / "panel.seam", project).value(), project) {
        connect();
        TeachOptions options;
        options.repeats = 3;
        auto taught = teach_panel(station, project.panel_jobs[0], options);
        EXPECT_TRUE(taught) << taught.error().sentence();
        if (!taught) return;
        project.panel_jobs[0] = *taught;
        EXPECT_TRUE(station.edit(project));
    }
    void connect() {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        for (const SensorSetup& s : project.sensors) sensors[s.id] = make_gripper_sensor(cell, s.id);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = make_gripper_robot(cell);
        station.connect(std::move(sensors), std::move(robots));
    }
    RunRecord run(bool push = true) {
        RunOptions options;
        options.part_id = "car";
        options.push = push;
        auto record = run_panel(station, "panel", options);
        EXPECT_TRUE(record) << record.error().sentence();
        return record.value_or(RunRecord{});
    }
    Pose frame() { return cell->read_frame("panel").value(); }
    void displace(double bend_mm = 0) {
        PartState panel, body;
        panel.workobject_from_movedworkobject =
            make_pose(rotation_exp({0.001, -0.0008, 0.0015}), {0.6, -0.5, 1});
        panel.bend.bend_mm = bend_mm;
        body.workobject_from_movedworkobject =
            make_pose(rotation_exp({-0.0008, 0.0005, -0.001}), {-0.4, 0.3, 2});
        cell->set_parts(panel, body);
    }
    // The largest distance of a place's point on the panel from where the body wants it.
    double off_mm() {
        const Pose relation = cell->relation(*cell->true_flange());
        double worst = 0;
        for (const GripperPlace& place : default_gripper_places()) {
            const Eigen::Vector3d p = place.gripper_from_place.translation();
            const Eigen::Vector3d off = place.gripper_from_place.linear().transpose() * (relation * p - p);
            worst = std::max({worst, std::abs(off.x()), std::abs(off.z())});
        }
        return worst;
    }
};

// All that stands between a panel's numbers and the robot, in the order in which run_panel() asks.
struct PanelRequest {
    PanelJob job;
    PanelFit fit;
    std::vector<PanelMeasurement> after;
};
void numbers(const NumberVisitor& visit, const std::string& path, PanelRequest& v) {
    auto& [job, fit, after] = v;
    numbers(visit, path + "job", job);
    numbers(visit, path + "fit", fit);
    numbers(visit, path + "after", after);
}

bool refuses_panel(const Project& project, const GateRequest& gate, const PanelRequest& r) {
    if (!motion_findings(project, r.job, true).empty()) return true;
    GateRequest request = gate;
    request.region.limits = r.job.limits;
    request.region.sigma_limit_mm = r.job.sigma_limit_mm;
    request.region.sigma_limit_deg = r.job.sigma_limit_deg;
    request.region.base_from_frame = r.job.base_from_frame;
    request.base_from_workobject = r.job.base_from_gripper;
    request.base_from_frame_now = r.job.base_from_frame;
    request.correction = motion_as_correction(r.job, gate.base_from_workobject, r.fit);
    return !pass_gate(request).pass || !beyond_tolerance(r.job, r.fit).empty() ||
           judge_panel(r.job, r.after) != PanelVerdict::in_tolerance ||
           !beyond_tolerance(r.job, r.after).empty();
}

TEST(PanelStation, EveryNumberThatIsNotFiniteIsRefused) {
    Bench bench;
    bench.displace();
    const RunRecord run = bench.run();
    ASSERT_EQ(run.status, RunStatus::ok) << run.message;
    PanelRequest good{bench.project.panel_jobs[0], *run.panel->fit, run.panel->after};
    for (PanelPlace& place : good.job.places) place.reference_profile.clear();
    GateRequest gate;
    gate.region.id = good.job.id;
    gate.region.frame_name = good.job.frame_name;
    gate.base_from_workobject = run.panel->base_from_gripper;
    gate.part_id = "car";
    gate.mode = RobotMode::automatic;
    gate.now_utc = utc_now();
    for (const PanelPlace& place : good.job.places) {
        GateSpot spot;
        spot.id = place.id;
        spot.measured = true;
        spot.part_id = gate.part_id;
        spot.calibration_id = "C";
        spot.calibration_verdict = Verdict::good;
        spot.calibrated_utc = gate.now_utc;
        spot.sensor = spot.calibrated_sensor = {"simulated", "V", "M", "1"};
        spot.robot = spot.calibrated_robot = {"simulated", "B", "M", "2"};
        gate.region.spot_ids.push_back(spot.id);
        gate.spots.push_back(spot);
    }
    const auto refuses = [&](const PanelRequest& r) { return refuses_panel(bench.project, gate, r); };
    ASSERT_FALSE(refuses(good));
    int tried = 0;
    EXPECT_THAT(passes_with_one_not_finite(good, refuses, tried), testing::ElementsAre());
    EXPECT_GT(tried, 3 * 200);
}

TEST(PanelStation, TeachesGapAndFlushAsTheyAre) {
    Bench bench;
    const PanelJob& job = bench.station.project().panel_jobs[0];
    ASSERT_EQ(job.places.size(), 8u);
    for (const PanelPlace& place : job.places) {
        EXPECT_NEAR(place.gap_mm, 4, 0.25) << place.id;
        EXPECT_NEAR(place.flush_mm, 0, 0.05) << place.id;
        EXPECT_GT(place.reference_profile.size(), 100u);
    }
    EXPECT_TRUE(check(bench.station.project()).empty());
}

// The hand-over report's table row of a place, its cells joined by '|'.
std::string report_row(const std::string& html, const std::string& caption, const std::string& place) {
    const auto table = html.find(caption);
    if (table == std::string::npos) return "no table";
    const auto row = html.find("<td>" + place + "</td>", table);
    if (row == std::string::npos) return "no row";
    std::string text = html.substr(row, html.find("</tr>", row) - row);
    for (std::size_t at; (at = text.find("</td>")) != std::string::npos;) text.replace(at, 5, "|");
    for (std::size_t at; (at = text.find("<td")) != std::string::npos;)
        text.erase(at, text.find('>', at) + 1 - at);
    return text;
}

TEST(PanelStation, HandOverReportShowsTheLastPanel) {
    Bench bench;
    const auto report = [&](Language language) {
        Facts facts;
        EXPECT_TRUE(gather(bench.station.file(), facts));
        HandOverOptions options;
        options.language = language;
        auto page = hand_over_report(bench.station.file(), bench.station.project(), facts, options);
        EXPECT_TRUE(page) << page.error().sentence();
        return page ? page->html() : std::string();
    };
    EXPECT_THAT(report(Language::english), HasSubstr("no panel was measured"));
    bench.displace();
    bench.run(false);
    EXPECT_THAT(report(Language::english), HasSubstr("not moved"));
    const RunRecord run = bench.run();
    ASSERT_TRUE(run.panel && run.panel->fit);
    const std::string html = report(Language::english);
    const PanelJob& job = bench.station.project().panel_jobs[0];
    for (std::size_t i = 0; i < job.places.size(); ++i) {
        const PanelPlace& place = job.places[i];
        const PanelMeasurement &before = run.panel->before[i], &after = run.panel->after[i];
        const GapFlushValue& left = run.panel->fit->spots[i].remaining;
        EXPECT_THAT(report_row(html, "Gap and flush of the last panel", place.id),
                    HasSubstr(fmt::format(
                        "{}|{:.3f}|{:.3f}|{:.3f}|{:.3f}|{:.3f}|{:.3f}|{:.3f}|{:.3f}|in tolerance|", place.id,
                        before.gap_mm, before.flush_mm, left.gap_mm, left.flush_mm, after.gap_mm,
                        after.flush_mm, after.gap_mm - place.gap_mm, after.flush_mm - place.flush_mm)));
        EXPECT_THAT(report_row(html, "zero position", place.id),
                    HasSubstr(fmt::format("|yes|{:.3f}|{:.3f}|", place.gap_mm, place.flush_mm)));
    }
    EXPECT_EQ(html.find("not moved"), std::string::npos) << "the newest run, not the dry one before";
    const std::string german = report(Language::german);
    EXPECT_THAT(german, HasSubstr("in Toleranz"));
    EXPECT_EQ(german.find("zero position"), std::string::npos);
    // A tolerance that was changed afterwards makes it stale.
    Project changed = bench.station.project();
    changed.panel_jobs[0].gap_tolerance_mm /= 2;
    ASSERT_TRUE(bench.station.edit(changed));
    EXPECT_THAT(report(Language::english), HasSubstr("the project was changed since"));
}

TEST(PanelStation, MovesThePanelInOneStepAndProvesIt) {
    Bench bench;
    bench.displace();
    const Pose before = bench.frame();
    const RunRecord run = bench.run();
    ASSERT_EQ(run.status, RunStatus::ok) << run.message;
    ASSERT_TRUE(run.panel && run.panel->fit);
    EXPECT_EQ(run.panel->verdict, PanelVerdict::in_tolerance);
    EXPECT_EQ(run.panel->push.status, PushStatus::written);
    EXPECT_LT(bench.off_mm(), 0.1) << "the cell's truth, after one motion from two millimetres off";
    // The frame takes the taught position to where the gripper went.
    const Pose carried = bench.frame() * before.inverse() * bench.project.panel_jobs[0].base_from_gripper;
    EXPECT_LT(distance_mm(carried, run.panel->base_from_moved_gripper), 1e-6);
    // Measured again it asks for nothing.
    for (const PanelMeasurement& m : run.panel->after) {
        ASSERT_EQ(m.status, SpotStatus::measured) << m.message;
        const auto& places = bench.project.panel_jobs[0].places;
        const auto& place = *std::find_if(places.begin(), places.end(),
                                          [&](const PanelPlace& p) { return p.id == m.place_id; });
        EXPECT_NEAR(m.gap_mm, place.gap_mm, 0.2);
        EXPECT_NEAR(m.flush_mm, place.flush_mm, 0.1);
        EXPECT_EQ(m.second_capture >= 0, !place.second_sensor_id.empty());
        if (m.second_capture >= 0) {
            EXPECT_GT(m.head_overlap_mm, 5);
            EXPECT_LT(m.head_disagreement_mm, 0.15);
        }
    }
    // Stored, and computed again bit for bit; with images too.
    RunOptions options;
    options.keep_images = true;
    ASSERT_TRUE(run_panel(bench.station, "panel", options));
    const auto again = replay(bench.folder / "panel.seam", {});
    ASSERT_TRUE(again) << again.error().sentence();
    EXPECT_EQ(again->runs, 2);
    EXPECT_EQ(again->captures, 30);
    EXPECT_TRUE(again->differences.empty())
        << again->differences.front().what << again->differences.front().text;
    for (const Error& found : bench.station.file().check()) ADD_FAILURE() << found.sentence();
    auto exported = export_file(bench.station.file());
    ASSERT_TRUE(exported);
    EXPECT_EQ((*exported)["runs"][0]["panel"]["verdict"], "in_tolerance");
    EXPECT_EQ(import_project(*exported)->panel_jobs.size(), 1u);
}

TEST(PanelStation, ReplayNoticesWhatWasChanged) {
    Bench bench;
    bench.displace();
    RunRecord run = bench.run(false);
    ASSERT_EQ(run.status, RunStatus::ok) << run.message;
    const auto setup = bench.station.file().load_run_setup(run.number);
    ASSERT_TRUE(setup);
    EXPECT_TRUE(compare(run, recompute(run, *setup).value()).empty());
    RunRecord wrong = run;
    wrong.panel->before[2].gap_mm = std::nextafter(wrong.panel->before[2].gap_mm, 99);
    EXPECT_EQ(compare(wrong, recompute(wrong, *setup).value()).size(), 1u);
    wrong = run;
    wrong.panel->fit->gripper_motion.translation().x() += 1e-9;
    const auto found = compare(wrong, recompute(wrong, *setup).value());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_THAT(found[0].what, HasSubstr("panel job"));
}

TEST(PanelStation, ADryRunWritesNothing) {
    Bench bench;
    bench.displace();
    const Pose before = bench.frame();
    const RunRecord run = bench.run(false);
    EXPECT_EQ(run.status, RunStatus::ok) << run.message;
    EXPECT_TRUE(run.panel->gate_passed);
    EXPECT_TRUE(run.panel->after.empty());
    EXPECT_EQ(run.panel->verdict, PanelVerdict::not_verified);
    EXPECT_TRUE(bench.frame().matrix() == before.matrix());
}

TEST(PanelStation, TheGateRefusesAndNothingMoves) {
    Bench bench;
    bench.displace();
    const Pose before = bench.frame();
    const auto refused = [&](auto change, const std::string& why) {
        Project changed = bench.project;
        change(changed);
        bench.station.use(changed);
        const RunRecord run = bench.run();
        EXPECT_EQ(run.status, RunStatus::refused) << why;
        EXPECT_FALSE(run.panel->gate_passed);
        EXPECT_THAT(run.message, HasSubstr(why));
        EXPECT_TRUE(bench.frame().matrix() == before.matrix());
        bench.station.use(bench.project);
    };
    refused([](Project& p) { p.panel_jobs[0].limits.translation_mm = 1; }, "beyond the limit");
    refused([](Project& p) { p.panel_jobs[0].sigma_limit_mm = 0.001; }, "sigma");
    refused([](Project& p) { p.calibrations[3].sensor_identity.serial = "another"; }, "calibrated was");
    refused([](Project& p) { p.calibrations[1].verdict = Verdict::poor; },
            "poor");  // the second head of a place
    refused([](Project& p) { p.robots[0].required_mode = RobotMode::external; }, "mode");
    refused([](Project& p) { p.panel_jobs[0].places[2].gauge.window = {90, 91, -1, 1}; }, "required spot P3");
    // A confirmation that does not come.
    RunOptions options;
    options.push = true;
    bool asked = false;
    options.confirm_push = [&](const RunRecord& judged) {
        asked = true;
        EXPECT_TRUE(judged.panel->push.before);
        return false;
    };
    const auto run = run_panel(bench.station, "panel", options);
    ASSERT_TRUE(run);
    EXPECT_TRUE(asked);
    EXPECT_EQ(run->status, RunStatus::cancelled);
    EXPECT_TRUE(bench.frame().matrix() == before.matrix());
}

TEST(PanelStation, ADeformedPanelIsBestFittedOrRefused) {
    Bench bench;
    bench.displace(0.5);
    const RunRecord run = bench.run();
    ASSERT_EQ(run.status, RunStatus::ok) << run.message;
    // What is measured after the motion is what the fit said would be left.
    double left = 0;
    for (std::size_t i = 0; i < run.panel->after.size(); ++i) {
        const PanelMeasurement& m = run.panel->after[i];
        const PanelPlace& place = bench.project.panel_jobs[0].places[i];
        const GapFlushValue& predicted = run.panel->fit->spots[i].remaining;
        EXPECT_NEAR(m.flush_mm - place.flush_mm, predicted.flush_mm, 0.1) << m.place_id;
        EXPECT_NEAR(m.gap_mm - place.gap_mm, predicted.gap_mm, 0.25) << m.place_id;
        left = std::max(left, std::abs(predicted.flush_mm));
    }
    EXPECT_GT(left, 0.05);
    bench.displace(6);
    const Pose before = bench.frame();
    const RunRecord too_much = bench.run();
    EXPECT_EQ(too_much.status, RunStatus::refused);
    EXPECT_THAT(too_much.message, HasSubstr("best fit leaves"));
    EXPECT_TRUE(bench.frame().matrix() == before.matrix());
}

TEST(PanelStation, TheJobSaysWhetherADeviationIsSharedOrLeftOut) {
    Bench bench;
    bench.displace();
    const RunRecord run = bench.run(false);
    ASSERT_TRUE(run.panel && run.panel->fit) << run.message;
    std::vector<PanelMeasurement> bent = run.panel->before;
    ASSERT_GE(bent.size(), 6u);
    bent[2].panel_mm.z() += 1.5;
    PanelJob job = bench.project.panel_jobs[0];
    EXPECT_EQ(job.deviation, PanelDeviation::share);
    const auto shared = fit_places(bench.project, job, bent);
    job.deviation = PanelDeviation::leave_out;
    const auto alone = fit_places(bench.project, job, bent);
    ASSERT_TRUE(shared && alone);
    EXPECT_TRUE(shared->spots[2].panel_used);
    EXPECT_FALSE(alone->spots[2].panel_used);
    EXPECT_LT(distance_mm(alone->gripper_motion, run.panel->fit->gripper_motion), 0.1);
}

// The body moves between the measurement and the motion: only the measurement afterwards can notice.
TEST(PanelStation, TakesBackAMotionThatDidNotBringThePanelIn) {
    Bench bench;
    bench.displace();
    const Pose before = bench.frame();
    RunOptions options;
    options.push = true;
    options.confirm_push = [&](const RunRecord&) {
        PartState panel, body;
        body.workobject_from_movedworkobject = make_pose(Eigen::Matrix3d::Identity(), {0, 2, 0});
        bench.cell->set_parts(panel, body);
        return true;
    };
    const auto run = run_panel(bench.station, "panel", options);
    ASSERT_TRUE(run);
    EXPECT_EQ(run->status, RunStatus::refused) << run->message;
    EXPECT_EQ(run->panel->verdict, PanelVerdict::out_of_tolerance);
    EXPECT_EQ(run->panel->push.status, PushStatus::restored);
    EXPECT_LT(distance_mm(bench.frame(), before), 1e-9);
    const auto stored = bench.station.file().load_run(run->number);
    ASSERT_TRUE(stored);
    EXPECT_EQ(exact_text(*stored->panel), exact_text(*run->panel));
    EXPECT_TRUE(replay(bench.folder / "panel.seam", {})->differences.empty());
}

TEST(PanelStation, RefusesJobsThatCannotRun) {
    Bench bench;
    EXPECT_FALSE(run_panel(bench.station, "other", {}));
    Project project = bench.project;
    const auto with = [&](auto change) {
        Project changed = project;
        change(changed.panel_jobs[0]);
        bench.station.use(changed);
        return run_panel(bench.station, "panel", {}).has_value();
    };
    EXPECT_FALSE(with([](PanelJob& j) { j.places[1].sensor_id = j.places[0].sensor_id; }));
    EXPECT_FALSE(with([](PanelJob& j) { j.places[1].sensor_id = "nowhere"; }));
    EXPECT_FALSE(with([](PanelJob& j) { j.robot_id = "R9"; }));
    EXPECT_FALSE(with([](PanelJob& j) { j.places.clear(); }));
    EXPECT_FALSE(with([](PanelJob& j) { j.places[0].gauge.surface_mm = -1; }));
    project.panel_jobs[0].head_limit_mm = 7;
    project.panel_jobs[0].places[0].gauge.minimum_points = 1;
    project.panel_jobs[0].gap_tolerance_mm = 0;
    EXPECT_EQ(check(project).size(), 3u);
}

TEST(PanelFields, DescribeEveryLimitAndTolerance) {
    PanelJob job;
    std::set<std::string> names;
    for (const Field<PanelJob>& f : panel_fields()) {
        EXPECT_TRUE(names.insert(f.info.name).second) << f.info.name;
        EXPECT_EQ(f.get(job), f.info.default_value) << f.info.name;
        EXPECT_NE(f.info.unit.empty(), f.info.choices.empty());
        EXPECT_TRUE(set_field(job, f.info.name, f.info.minimum)) << f.info.name;
        EXPECT_EQ(f.get(job), f.info.minimum) << f.info.name << " is set where it is read";
        for (const double bad : {f.info.minimum - 1e-6, f.info.maximum + 1e-6, std::nan("")})
            EXPECT_THAT(set_field(job, f.info.name, bad).error().sentence(), HasSubstr(f.info.unit));
    }
    EXPECT_TRUE(names.count("gap_tolerance_mm") && names.count("flush_tolerance_mm"));
    EXPECT_TRUE(validate_fields(job));
    job.flush_tolerance_mm = 0;
    EXPECT_THAT(validate_fields(job).error().sentence(), HasSubstr("flush_tolerance_mm"));
}

}  // namespace
}  // namespace seamwright
