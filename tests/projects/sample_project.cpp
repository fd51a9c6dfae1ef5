#include "tests/projects/sample_project.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>

namespace seamwright {

Project sample_project(unsigned seed) {
    SampleMaker make(seed);
    Project p;
    p.name = "Türe links \"42\"\n";
    p.part = {"door left", "door.stl", {}, make.pose()};
    for (int i = 0; i < 5000; ++i) p.part.mesh_ply.push_back(static_cast<std::byte>(make.rng()() & 0xff));
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.settings = {{"seed", 7}, {"exposure_us", 120.5}, {"list", {1, 2, 3}}};
    sensor.identity = {"simulated", "Seamwright", "S", "0001"};
    sensor.peaks.scan = ScanLines::rows;
    sensor.peaks.method = PeakMethod::steger;
    sensor.peaks.threshold = 0.1 + 0.2;
    sensor.filter.noise_mm = 1.0 / 3.0;
    sensor.calibration_id = "C1";
    p.sensors.push_back(sensor);
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    robot.settings = {{"repeatability_mm", 0.03}};
    robot.identity = {"simulated", "KUKA", "KR", "0002"};
    robot.required_mode = RobotMode::external;
    p.robots.push_back(robot);
    Calibration c;
    c.id = "C1";
    c.method = "tcp-sphere";
    c.sensor_id = "A";
    c.robot_id = "R1";
    c.sensor_identity = sensor.identity;
    c.robot_identity = robot.identity;
    c.created_utc = "2024-01-02T03:04:05.678Z";
    c.source = std::string("ball");
    c.model.emplace();
    c.model->camera = {1000.1, 1000.2, 640.3, 512.4, 0.01, -0.02, 1e-5, -2e-5, 0.003, 1280, 1024};
    c.model->camera_from_laser = make.pose();
    c.model->table = LookupTable{0.5, 0.25, 8, 4, 2, 2, {1, 2, 3, std::nan("")}, {4, 5, 6, std::nan("")}};
    c.flange_from_sensor = make.pose();
    for (int i = 0; i < 36; ++i) c.covariance(i / 6, i % 6) = make.number(1e-3);
    c.verdict = Verdict::good;
    c.raw = {{"radius_mm", 12.7}, {"observations", nlohmann::json::array({1.5, 2.5})}};
    c.result = {{"rms_mm", 0.02}};
    p.calibrations.push_back(c);
    for (int i = 0; i < 6; ++i) {
        Spot s;
        s.id = "S" + std::to_string(i + 1);
        s.sensor_id = "A";
        s.robot_id = "R1";
        s.enabled = i != 5;
        s.required = i != 4;
        s.base_from_flange = make.pose();
        s.entry_mm = 10 + i;
        s.exit_mm = 12 + i;
        s.speed_mm_s = 80 + i;
        s.stop_at_trigger = i % 2;
        for (int k = 0; k < i % 3; ++k) s.via.push_back(make.pose());
        s.feature.kind = i % 2 ? "template" : "contour-end";
        s.feature.parameters = {{"window_left_mm", -1.0 / 3.0}, {"tiny", 5e-324}};
        s.feature.template_profile = make.profile(50, i % 2);
        s.feature.template_reference_mm = {make.number(), -0.0};
        s.reference_mm = {make.number(), 0, make.number()};
        s.reference_profile = make.profile(200);
        s.weights = {1, 0, 0.5};
        s.sigma_mm = 0.03;
        s.jitter_mm = 2.5;
        if (i % 3 == 0) s.curve = ContourCurve{{0.1, 0.02, 1e-9}, {0.3, 0.04, -1e-300}, -20, 19.5};
        p.spots.push_back(s);
    }
    Region r;
    r.id = "edge";
    r.spot_ids = {"S1", "S2", "S3", "S4", "S5"};
    r.free = {true, true, true, false, true, true};
    r.limits = {std::numeric_limits<double>::infinity(), 2.5};
    r.sigma_limit_mm = 0.2;
    r.frame_name = "BASE_DATA[7]";
    r.base_from_frame = make.pose();
    r.offsets = {{1, "2024-05-01T12:00:00.000Z", "cmm.csv", {0.1, -1.0 / 3, 0}},
                 {2, "2024-05-02T12:00:00.000Z", "tracker.csv", {0, 0, 0.25}}};
    r.offsets[1].covariance_mm2(2, 2) = 1e-4;
    r.offset_switches = {1, 0, 2};
    p.regions.push_back(r);
    p.requirements.acceptance.tolerance_mm = 1.0 / 3;
    p.requirements.acceptance.cg_width = 4;
    PanelJob job;
    job.id = "fit \u00fc";
    job.robot_id = "R1";
    for (int i = 0; i < 3; ++i) {
        PanelPlace place;
        place.id = "P" + std::to_string(i + 1);
        place.sensor_id = "A";
        place.second_sensor_id = i == 1 ? "B" : "";
        place.enabled = i != 2;
        place.required = i != 2;
        place.gauge.reference = GapFlushSettings::Reference::right;
        place.gauge.gap_by = GapBy::edge_distance;
        place.gauge.window = {-1.0 / 3.0, 25, -4, 5};
        place.gauge.surface_mm = 4.5;
        place.gauge.edge_skip_mm = 1.25;
        place.gauge.minimum_points = 12;
        place.panel_reference_mm = {make.number(), 0, make.number()};
        place.body_reference_mm = {make.number(), 0, make.number()};
        place.gap_mm = make.number(3);
        place.flush_mm = make.number(1);
        place.surface_deg = make.number(20);
        place.reference_profile = make.profile(100);
        place.weights = {1, 0, 0.25};
        place.sigma_mm = 0.04;
        job.places.push_back(place);
    }
    job.base_from_gripper = make.pose();
    job.limits = {12.5, std::numeric_limits<double>::infinity()};
    job.sigma_limit_mm = 0.15;
    job.sigma_limit_deg = 0.025;
    job.gap_tolerance_mm = 0.7;
    job.flush_tolerance_mm = 0.4;
    job.head_limit_mm = 0.2;
    job.deviation = PanelDeviation::leave_out;
    job.frame_name = "BASE_DATA[9]";
    job.base_from_frame = make.pose();
    p.panel_jobs.push_back(job);
    p.line = {{"plc", "modbus-server", true, {{"port", 1502}, {"start", "line"}}, {1, 7}},
              {"broker", "mqtt", false, {{"address", "10.0.0.9"}}, {}}};
    RegionModes bends;
    bends.id = p.regions[0].id;
    bends.on = true;
    bends.learnt_utc = "2026-05-01T10:00:00.000Z";
    bends.switched_utc = "2026-05-02T10:00:00.000Z";
    bends.most_added_mm = 0.7;
    bends.modes.spots.push_back({"S1", make.pose(), Eigen::Vector3d(1, 2, 3)});
    bends.modes.spots[0].seen = Eigen::Vector3d(400, 0, 1.0 / 3).asDiagonal();
    bends.modes.modes.push_back({{Eigen::Vector3d(0.1, 0, 1)}, 0.09, 0.05, 0.2, 0.01, -0.5, 0.6});
    bends.modes.noise_factor = 1.1;
    bends.modes.rows = 30;
    bends.modes.parts = 28;
    bends.modes.gain = {12.5, -0.1};
    bends.modes.gain_sigma = {1.5, 0.2};
    bends.modes.message = Text("{} modes from {} parts", 1, 28);
    bends.learnt_from = {{7, "door 7", "2026-04-30T08:00:00.000Z"}};
    p.elastic = {bends};
    DriftWatch& drift = p.drift.emplace();
    drift.spot_ids = {"W1"};
    drift.every_parts = 20;
    drift.every_minutes = 45.5;
    drift.limit_mm = 1.0 / 7;
    drift.pause_minutes = 12.25;
    drift.compensate = true;
    drift.drifts = DriftOf::robot;
    drift.most_mm = 0.4;
    drift.switched_utc = "2026-06-01T10:00:00.000Z";
    drift.learnt = LearntDrift{"2026-06-01T09:00:00.000Z",
                               3,
                               42,
                               40,
                               37,
                               812.5,
                               0xfedcba98u,
                               {{"W1", 2, 0.1, 0.01, 0.03, -1.0 / 3}}};
    drift.set_aside = {{43, 44, "2026-06-02T09:00:00.000Z", "Ada", "tightened"}};
    return p;
}

RunRecord sample_run(unsigned seed, int captures, int points) {
    SampleMaker make(seed);
    RunRecord run;
    run.part_id = "car " + std::to_string(seed);
    run.started_utc = "2024-05-01T12:00:00.000Z";
    run.finished_utc = "2024-05-01T12:00:09.999Z";
    run.push = seed % 2;
    run.status = RunStatus::refused;
    run.message = "refused";
    for (int i = 0; i < captures; ++i) {
        Capture c;
        if (i % 3 == 1) {
            c = make.image_capture("S2", points);
            if (i % 2) c.image = StoredImage{7, 5, 10, std::vector<std::byte>(70, std::byte{3})};
        } else if (i % 3 == 2) {
            c.spot_id = "S3";
            c.status = FrameStatus::incomplete;
        } else {
            c.spot_id = "S1";
            c.sensor_id = "A";
            c.profile = make.profile(points, false);
        }
        run.captures.push_back(c);
        SpotMeasurement m;
        m.spot_id = c.spot_id;
        m.status = c.status == FrameStatus::ok ? SpotStatus::measured : SpotStatus::damaged_frame;
        m.feature.status = FeatureStatus::ok;
        m.feature.point_mm = {make.number(), make.number()};
        m.feature.covariance_mm2 << 1e-4, 1e-5, 1e-5, 2e-4;
        if (i % 2) m.feature.phi_rad = make.number(0.1);
        m.measured_mm = {make.number(), make.number(), make.number()};
        m.sigma_mm = 0.05;
        m.part_id = run.part_id;
        m.host_time_ns = 1234567890123456789;
        m.capture = i;
        run.spots.push_back(m);
    }
    RegionRecord region;
    region.region_id = "edge";
    region.correction.emplace();
    region.correction->status = CorrectionStatus::under_determined;
    region.correction->displacement.workobject_from_movedworkobject = make.pose();
    region.correction->sigma_xyz_mm = {0.1, std::numeric_limits<double>::infinity(), 0.3};
    region.correction->unobservable = {"translation along Y"};
    region.correction->spots = {{"S1", {0.01, 0, 0.02}, true}, {"S2", {3, 0, 2}, false}};
    region.base_from_frame = make.pose();
    region.refusals = {"because"};
    region.push.before = make.pose();
    run.regions.push_back(region);
    run.events.push_back({0, "2024-05-01T12:00:01.000Z", 0, EventKind::refusal, "edge", "because"});
    return run;
}

PanelRecord sample_panel_record(unsigned seed) {
    SampleMaker make(seed);
    PanelRecord panel;
    panel.job_id = "fit \u00fc";
    for (auto* list : {&panel.before, &panel.after})
        for (int i = 0; i < 3; ++i) {
            PanelMeasurement m;
            m.place_id = "P" + std::to_string(i + 1);
            m.status = i == 2 ? SpotStatus::no_feature : SpotStatus::measured;
            m.message = i == 2 ? "no gap" : "";
            m.panel_mm = {make.number(), 0, make.number()};
            m.body_mm = {make.number(), 0, make.number()};
            m.sigma_mm = 0.05;
            m.gap_mm = make.number(3);
            m.flush_mm = std::numeric_limits<double>::infinity();
            m.gap_flush_covariance << 1, 0.5, 0.5, 2;
            m.head_disagreement_mm = make.number(0.1);
            m.head_offset_mm = make.number(0.1);
            m.head_overlap_mm = 12;
            m.part_id = "car";
            m.host_time_ns = 1234567890123456789;
            m.capture = i;
            m.second_capture = i == 1 ? 3 : -1;
            list->push_back(m);
        }
    if (seed % 2 == 0)
        panel.servo =
            PanelServo{ServoingStatus::settled, {{make.pose(), 0.25}, {make.pose(), 1.0 / 3.0}}, make.pose()};
    panel.fit.emplace();
    panel.fit->status = CorrectionStatus::over_limit;
    panel.fit->gripper_motion = make.pose();
    panel.fit->single_step = make.pose();
    panel.fit->covariance(2, 3) = 1.0 / 3.0;
    panel.fit->sigma_xyz_mm = {0.1, std::numeric_limits<double>::infinity(), 0.3};
    panel.fit->panel.displacement.workobject_from_movedworkobject = make.pose();
    panel.fit->spots.push_back(
        {"P1", {4, 0.5}, {0.1, std::nan("")}, {0.01, 0.02}, {0.1, 0, 0.2}, true, false});
    panel.fit->unobservable = {"translation along Y"};
    panel.base_from_gripper = make.pose();
    panel.base_from_moved_gripper = make.pose();
    panel.base_from_frame = make.pose();
    panel.gate_passed = true;
    panel.refusals = {"because"};
    panel.push.before = make.pose();
    panel.push.status = PushStatus::written;
    panel.verdict = PanelVerdict::out_of_tolerance;
    return panel;
}

Evidence sample_evidence(int kind) {
    Evidence e;
    if (kind == 0) {
        FrozenContour f;
        f.spot_id = "S2";
        f.status = AlignmentStatus::frozen;
        f.yaw_deg = 1.0 / 3.0;
        f.radius_mm = std::numeric_limits<double>::infinity();
        f.offsets = {{-5, 0.01, -0.02, 0.003, 0.004, true}, {5, -0.01, 0.02, 0, 0, false}};
        e.what = f;
    } else if (kind == 1) {
        ZeroShift z;
        z.runs = {4, 5, 6};
        z.regions = {{"edge", {1e-9, 2, 3, 4, 5, 6}, {0.1, 0, 0, 0, 0, 0}, {}, 0.25}};
        e.what = z;
    } else if (kind == 2) {
        KnownShift k;
        k.realised_by = ShiftBy::by_hand;
        k.range_mm = 10;
        k.tests = {{ShiftKind::both,
                    2,
                    -7.5,
                    make_pose(rotation_exp({0, 0, 0.01}), {1, 2, 3}),
                    9,
                    {{"edge", false, std::nan(""), {}, "too few spots"}}}};
        e.what = k;
    } else if (kind == 3) {
        e.what = HeadlessRun{12, "car", true, "line-pc"};
    } else if (kind == 4) {
        RobotReturns r;
        r.robot_id = "R1";
        r.spots.resize(1);
        r.spots[0] = {"S1", {}, true, false, {0.1, 1.0 / 9}, {{{1.0 / 3, 2}, {3, 4}}, {{5, 6}}}};
        r.spots[0].sees << 1, 2, 3, 4, 5, 1.0 / 7;
        r.not_found = 2;
        r.replaced_covariance(0, 0) = 1e-3;
        e.what = r;
    } else if (kind == 6) {
        e.what = StudyPlan{"type3", "edge", {"car 1", "T\u00fcr 2"}, 2, 3, 17};
    } else {
        e.what = TriggerPasses{"S1",
                               45,
                               {-0.7, 0.1},
                               0.001,
                               {{-50, true, 1.0 / 3}, {0, false, 2}},
                               1,
                               3.5,
                               {{"S1", 3}, {"S2", 2.5}}};
    }
    return e;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
bool same_bits(const Profile& a, const Profile& b) {
    return same_bits(a.x_mm, b.x_mm) && same_bits(a.z_mm, b.z_mm) && a.intensity == b.intensity &&
           a.segment == b.segment;
}
bool same_bits(const Capture& a, const Capture& b) {
    const auto image = [](const Capture& c) {
        return c.image ? std::tuple(c.image->width, c.image->height, c.image->bit_depth, c.image->pixels)
                       : std::tuple(0, 0, 0, std::vector<std::byte>());
    };
    return a.spot_id == b.spot_id && a.sensor_id == b.sensor_id && a.status == b.status &&
           a.sequence == b.sequence && a.device_time_ns == b.device_time_ns &&
           a.host_time_ns == b.host_time_ns &&
           a.base_from_flange.has_value() == b.base_from_flange.has_value() &&
           (!a.base_from_flange || a.base_from_flange->matrix() == b.base_from_flange->matrix()) &&
           same_bits(a.profile, b.profile) && a.candidates.lines == b.candidates.lines &&
           (!a.candidates.lines ||
            (a.candidates.per_line == b.candidates.per_line && a.candidates.count == b.candidates.count &&
             same_bits(a.candidates.x_mm, b.candidates.x_mm) &&
             same_bits(a.candidates.z_mm, b.candidates.z_mm) &&
             a.candidates.intensity == b.candidates.intensity)) &&
           image(a) == image(b);
}

}  // namespace seamwright
