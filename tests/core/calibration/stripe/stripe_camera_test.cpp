#include "core/calibration/stripe/stripe_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tests/core/calibration/camera/camera_scene.h"
#include "tests/devices/real_data.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

BoardSpec board_7x6() {
    BoardSpec s;
    s.columns = 7, s.rows = 6, s.pitch_mm = 10;
    return s;
}

struct Scene {
    CameraModel camera;
    LaserPlane plane;
    Pose flange_from_camera, base_from_target;
    std::vector<StripeObservation> frames;
};

// Frames of a sheet printed with `stretch` and `shear`, robot noise as an industrial robot has it, stripes 15
// to 90 mm beside the board.
Scene scene(unsigned seed, int frames, double stretch, double shear, double robot_mm, double noise_px) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(-1, 1);
    std::normal_distribution<double> n(0, 1);
    Scene s;
    s.camera.fx = s.camera.fy = 2350, s.camera.cx = 650, s.camera.cy = 505, s.camera.k1 = -0.09;
    s.camera.width = 1280, s.camera.height = 1024;
    s.plane.normal = Eigen::Vector3d(0.83, 0.1, 0.55).normalized();
    s.plane.offset_mm = -s.plane.normal.dot(Eigen::Vector3d(25, 0, 300));
    s.flange_from_camera = make_pose(rotation_exp({0.1, -0.7, 0.3}), {120, 80, 200});
    s.base_from_target = make_pose(rotation_exp({0.05, 0.1, 1.2}), {1500, 100, 700});
    PlateShape shape;
    shape.stretch = stretch, shape.shear = shear;
    shape.middle_mm = {30, 25}, shape.half_mm = 30;
    while (static_cast<int>(s.frames.size()) < frames) {
        const Eigen::Matrix3d r = rotation_exp({0.35 * u(random), 0.35 * u(random), 0.5 * u(random)});
        const Pose pose =
            make_pose(r, Eigen::Vector3d(-18 + 12 * u(random), 12 * u(random), 300 + 35 * u(random)) -
                             r * Eigen::Vector3d(30, 25, 0));
        StripeObservation o;
        o.id = "frame" + std::to_string(s.frames.size());
        o.width = 1280, o.height = 1024;
        FoundBoard b;
        bool inside = true;
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 7; ++i) {
                const Eigen::Vector3d nominal(10 * i, 10 * j, 0);
                const Eigen::Vector2d q = s.camera.project(pose * shape.apply(nominal));
                inside &= q.x() > 5 && q.y() > 5 && q.x() < 1275 && q.y() < 1019;
                b.index.push_back(j * 7 + i);
                b.object_mm.push_back(nominal);
                b.pixel.push_back(q + noise_px * Eigen::Vector2d(n(random), n(random)));
            }
        if (!inside) continue;
        o.board = b;
        o.scan = ScanLines::rows;
        // The stripe: plate z = 0 cut with the plane, walked through the image rows.
        const Eigen::Vector3d m = pose.linear().col(2);
        const Eigen::Vector3d along = m.cross(s.plane.normal).normalized();
        Eigen::Matrix3d a;
        a << m.transpose(), s.plane.normal.transpose(), along.transpose();
        const Eigen::Vector3d on =
            a.inverse() * Eigen::Vector3d(m.dot(pose.translation()), -s.plane.offset_mm, 0);
        std::map<int, double> rows;
        for (double t = -150; t < 150; t += 0.02) {
            const Eigen::Vector2d q = s.camera.project(on + t * along);
            if (q.allFinite() && q.x() > 15 && q.y() >= 0 && q.x() < 1265 && q.y() <= 1023)
                rows[static_cast<int>(std::lround(q.y()))] = q.x();
        }
        if (rows.size() < 400) continue;
        for (const auto& [row, x] : rows) o.stripe.emplace_back(x + 0.15 * n(random), row);
        const Pose exact = s.base_from_target * pose.inverse() * s.flange_from_camera.inverse();
        Vector6 error;
        for (int i = 0; i < 3; ++i)
            error(i) = robot_mm * n(random), error(i + 3) = rad_from_deg(0.02) * n(random);
        o.base_from_flange = retract(exact, error);
        s.frames.push_back(o);
    }
    return s;
}

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return deg_from_rad(std::acos(std::min(1.0, std::abs(a.dot(b)))));
}

TEST(StripeCamera, SolvesAStretchedSheet) {
    const Scene s = scene(1, 9, 0.004, 0.004, 0.1, 0.15);
    const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_NE(r->shape_freedom, ShapeFreedom::rigid);
    EXPECT_NEAR(r->shape.stretch, 0.004, 0.001);
    EXPECT_NEAR(r->shape.shear, 0.004, 0.001);
    EXPECT_NEAR(r->camera.fx, 2350, 12);
    EXPECT_LT(angle_deg(r->plane->normal, s.plane.normal), 0.5);
    EXPECT_GT(r->on_plane_share, 0.99);
    EXPECT_LT(distance_mm(*r->flange_from_camera, s.flange_from_camera), 2);
    EXPECT_LT(r->target_spread_mm, 0.5);
    EXPECT_NE(r->report.judgement.verdict, Verdict::poor) << r->report.judgement.reason;
    // The sensor frame is right-handed, its y the plane's normal, its origin on the plane.
    EXPECT_NEAR(r->camera_from_laser.linear().determinant(), 1, 1e-9);
    EXPECT_NEAR(r->plane->normal.dot(r->camera_from_laser.translation()) + r->plane->offset_mm, 0, 1e-9);
}

TEST(StripeCamera, WorksWithoutRobot) {
    Scene s = scene(2, 9, 0, 0, 0.1, 0.1);
    for (auto& f : s.frames) f.base_from_flange.reset();
    const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->flange_from_camera);
    EXPECT_NEAR(r->camera.fx, 2350, 4 * r->report.parameters[0].sigma + 5);
    EXPECT_LT(angle_deg(r->plane->normal, s.plane.normal), 1);
}

TEST(StripeCamera, NamesFramesWhoseLaserMoved) {
    Scene s = scene(3, 9, 0, 0, 0.1, 0.1);
    for (const int k : {2, 6})
        for (auto& p : s.frames[static_cast<std::size_t>(k)].stripe) p.x() += 30;
    const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->frames[2].stripe_used);
    EXPECT_FALSE(r->frames[6].stripe_used);
    EXPECT_THAT(r->frames[2].note, HasSubstr("off the plane"));
    EXPECT_EQ(r->report.judgement.verdict, Verdict::usable);
    EXPECT_THAT(r->report.judgement.reason, HasSubstr("frame6"));
    EXPECT_LT(r->on_plane_share_all, 0.9);
    EXPECT_LT(angle_deg(r->plane->normal, s.plane.normal), 0.5);
}

// A clamp that gives way between two frames: too little to be seen in any one of them.
TEST(StripeCamera, ALaserThatMovedHalfWayIsNamed) {
    for (const double px : {3.0, 12.0}) {
        Scene s = scene(3, 12, 0, 0, 0.1, 0.1);
        for (std::size_t k = 6; k < s.frames.size(); ++k)
            for (auto& p : s.frames[k].stripe) p.x() += px;
        const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
        ASSERT_TRUE(r);
        EXPECT_EQ(r->report.judgement.verdict, Verdict::poor) << r->report.judgement.reason;
        EXPECT_THAT(r->report.judgement.reason, HasSubstr("moved between frame5 and frame6")) << px;
        for (std::size_t k = 6; k < s.frames.size(); ++k)
            EXPECT_TRUE(r->frames[k].stripe_used) << px << " " << k;
    }
}

// Speckle and a plate that lies a little otherwise shift each frame's stripe as a whole.
TEST(StripeCamera, WhatFramesDifferByIsInTheWorkingPoint) {
    const Scene honest = scene(3, 12, 0, 0, 0.1, 0.1);
    Scene shaken = honest;
    std::mt19937 random(5);
    std::normal_distribution<double> n(0, 3);
    for (auto& f : shaken.frames) {
        const double by = n(random);
        for (auto& p : f.stripe) p.x() += by;
    }
    const auto before = calibrate_stripe_camera(honest.frames, board_7x6(), {});
    const auto after = calibrate_stripe_camera(shaken.frames, board_7x6(), {});
    ASSERT_TRUE(before);
    ASSERT_TRUE(after);
    EXPECT_EQ(before->report.judgement.verdict, Verdict::good) << before->report.judgement.reason;
    EXPECT_GT(after->plane_sigma_mm, 2 * before->plane_sigma_mm);
}

TEST(StripeCamera, ReflectionsAndTableStripesStayOut) {
    Scene s = scene(4, 9, 0, 0, 0.1, 0.1);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> u(0, 1);
    for (auto& f : s.frames) {
        const auto clean = f.stripe;
        for (const auto& p : clean)
            if (u(random) < 0.3) f.stripe.emplace_back(1270 * u(random), p.y());
        // The top 150 rows fall on a table 40 px away.
        for (auto& p : f.stripe)
            if (p.y() < 150) p.x() += 40;
    }
    const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(r);
    EXPECT_GT(r->on_plane_share, 0.95);
    EXPECT_LT(angle_deg(r->plane->normal, s.plane.normal), 0.5);
}

TEST(StripeCamera, AHalfTurnedBoardIsPutRight) {
    Scene s = scene(5, 9, 0, 0, 0.1, 0.1);
    const auto spec = board_7x6();
    for (auto& f : s.frames) f.board->symmetry = 2;
    for (const int k : {1, 4, 5})
        s.frames[static_cast<std::size_t>(k)].board =
            turned(*s.frames[static_cast<std::size_t>(k)].board, spec, 2);
    const auto r = calibrate_stripe_camera(s.frames, spec, {});
    ASSERT_TRUE(r);
    EXPECT_LT(r->target_spread_mm, 0.5);
    EXPECT_LT(distance_mm(*r->flange_from_camera, s.flange_from_camera), 2);
}

TEST(StripeCamera, RefusesWhatContradictsItself) {
    const Scene s = scene(6, 8, 0, 0, 0.1, 0.1);
    const auto refused = [](const std::vector<StripeObservation>& o, const BoardSpec& spec,
                            const StripeCameraOptions& options = {}) {
        const auto r = calibrate_stripe_camera(o, spec, options);
        EXPECT_FALSE(r);
        return r ? std::string() : r.error().sentence();
    };
    EXPECT_THAT(refused({}, board_7x6()), HasSubstr("no frame"));
    auto o = s.frames;
    o[3].width = 640;
    EXPECT_THAT(refused(o, board_7x6()), HasSubstr("different sizes"));
    o = s.frames;
    for (auto& f : o) f.board.reset();
    EXPECT_THAT(refused(o, board_7x6()), HasSubstr("no board"));
    o = s.frames;
    for (auto& f : o) f.board = s.frames[0].board;
    EXPECT_THAT(refused(o, board_7x6()), HasSubstr("only 1"));
    StripeCameraOptions x;
    x.exclude = {"frame99"};
    EXPECT_THAT(refused(s.frames, board_7x6(), x), HasSubstr("frame99"));
    auto spec = board_7x6();
    spec.pitch_mm = 0.01;
    EXPECT_THAT(refused(s.frames, spec), HasSubstr("metres"));
    // A pitch of 8 where the sheet has 10, seen by the robot.
    o = s.frames;
    for (auto& f : o)
        for (auto& p : f.board->object_mm) p *= 0.8;
    spec.pitch_mm = 8;
    EXPECT_THAT(refused(o, spec), HasSubstr("10.0"));
    // Robot poses in metres.
    o = s.frames;
    for (auto& f : o) f.base_from_flange->translation() *= 0.001;
    EXPECT_THAT(refused(o, board_7x6()), HasSubstr("metres"));
}

TEST(StripeCamera, FewFramesAreUsableAtMost) {
    const Scene s = scene(7, 8, 0, 0, 0.05, 0.05);
    for (const int n : {3, 4, 5}) {
        const std::vector<StripeObservation> few(s.frames.begin(), s.frames.begin() + n);
        const auto r = calibrate_stripe_camera(few, board_7x6(), {});
        ASSERT_TRUE(r);
        EXPECT_GE(r->report.judgement.verdict, Verdict::usable) << n << r->report.judgement.reason;
    }
    const auto all = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(all);
    EXPECT_EQ(all->report.judgement.verdict, Verdict::good) << all->report.judgement.reason;
    EXPECT_LT(3 * all->working_sigma_mm, 0.5);
    // Where the sensor's middle really is, by what it is said to be known to.
    const Eigen::Vector3d middle = all->camera_from_laser.translation();
    EXPECT_LT((*all->flange_from_camera * middle - s.flange_from_camera * middle).norm(),
              5 * all->working_sigma_mm);
    // Noise that is large: the working point says so.
    const auto rough = calibrate_stripe_camera(scene(7, 8, 0, 0, 1.0, 0.3).frames, board_7x6(), {});
    ASSERT_TRUE(rough);
    EXPECT_GE(rough->report.judgement.verdict, Verdict::usable) << rough->report.judgement.reason;
}

TEST(StripeCamera, APitchOffByAPerCentIsNamed) {
    for (unsigned seed = 10; seed < 14; ++seed) {
        const Scene s = scene(seed, 14, 0, 0, 0.05, 0.05);
        const auto honest = calibrate_stripe_camera(s.frames, board_7x6(), {});
        ASSERT_TRUE(honest);
        EXPECT_EQ(honest->report.judgement.verdict, Verdict::good) << honest->report.judgement.reason;
        auto wrong = s.frames;
        for (auto& f : wrong)
            for (auto& p : f.board->object_mm) p *= 1.01;
        auto spec = board_7x6();
        spec.pitch_mm *= 1.01;
        const auto r = calibrate_stripe_camera(wrong, spec, {});
        ASSERT_TRUE(r);
        EXPECT_EQ(r->report.judgement.verdict, Verdict::poor)
            << seed << ": " << r->target_size << " +- " << r->target_size_sigma;
        EXPECT_THAT(r->report.judgement.reason, HasSubstr("smaller than stated")) << seed;
    }
}

TEST(StripeCamera, ReversedRobotPosesAreNamed) {
    Scene s = scene(8, 9, 0, 0, 0.1, 0.1);
    for (auto& f : s.frames) f.base_from_flange = f.base_from_flange->inverse();
    const auto r = calibrate_stripe_camera(s.frames, board_7x6(), {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->flange_from_camera);
    EXPECT_THAT(r->report.judgement.reason, HasSubstr("reversed"));
    EXPECT_THAT(r->report.judgement.cure, HasSubstr("base_from_flange"));
}

TEST(StripeCamera, ARobotThatScattersBeyondWhatItIsStatedToIsSaid) {
    const Scene s = scene(9, 10, 0, 0, 0.4, 0.05);
    StripeCameraOptions options;
    options.robot = {0.4, rad_from_deg(0.02)};
    auto r = calibrate_stripe_camera(s.frames, board_7x6(), options);
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->robot_contradicts);
    options.robot = {0.05, rad_from_deg(0.02)};
    r = calibrate_stripe_camera(s.frames, board_7x6(), options);
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->robot_contradicts);
    EXPECT_NE(r->report.judgement.verdict, Verdict::good);
}

// --- real frames
// -------------------------------------------------------------------------------------------------

fs::path data() {
    return real_data() / "etna";
}

std::vector<StripeObservation> observe_folder(const fs::path& folder) {
    std::vector<fs::path> images;
    for (const auto& e : fs::directory_iterator(folder))
        if (e.path().extension() == ".png") images.push_back(e.path());
    std::sort(images.begin(), images.end());
    std::vector<StripeObservation> out;
    for (const auto& path : images) {
        cv::Mat grey = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
        StripeFrame frame;
        frame.id = path.stem().string();
        frame.image = {reinterpret_cast<const std::byte*>(grey.data), grey.cols, grey.rows, grey.step, 8};
        std::string text;
        std::getline(std::ifstream(folder / ("pose" + frame.id.substr(5) + ".txt")) >> std::ws, text);
        for (char& c : text)
            if (c == '(' || c == ')' || c == ',') c = ' ';
        std::istringstream numbers(text);
        double x, y, z, qx, qy, qz, qw;
        numbers >> x >> y >> z >> qx >> qy >> qz >> qw;
        frame.base_from_flange = make_pose(Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix(),
                                           1000 * Eigen::Vector3d(x, y, z));
        out.push_back(observe(frame, board_7x6()));
    }
    return out;
}

TEST(StripeCameraReal, EtnaSets) {
    if (!fs::exists(data() / "root")) GTEST_SKIP() << "skipped: no real data";
    std::vector<double> focal;
    for (const char* set : {"root", "calib1", "calib2"}) {
        const auto frames = observe_folder(data() / set);
        const auto r = calibrate_stripe_camera(frames, board_7x6(), {});
        ASSERT_TRUE(r) << set;
        EXPECT_EQ(r->boards_found, 8) << set;
        // The laser of calib1 comes to rest late: its stripes differ from frame to frame, and none is pulled onto the plane.
        EXPECT_GE(r->on_plane_share, std::string(set) == "calib1" ? 0.9 : 0.95) << set;
        EXPECT_LE(r->target_spread_mm, 1.0) << set;
        EXPECT_LE(r->report.judgement.verdict, Verdict::usable) << set << ": " << r->report.judgement.reason;
        focal.push_back(r->camera.fx);
        if (std::string(set) == "root") {
            // profile3d.yaml: third column of R is the normal; t = (0, 0, 0.29626 m) lies on the plane.
            const Eigen::Vector3d theirs(0.7968668937683105, 0.06148913502693176, 0.6010176539421082);
            EXPECT_LT(angle_deg(r->plane->normal, theirs), 1.5);
            EXPECT_NEAR(r->plane_distance_mm / r->plane->normal.z(), 296.26, 3);
        }
        if (std::string(set) == "calib1") {
            // The first two frames were taken before the laser came to rest: their stripes lie 3 and 2 mm
            // off.
            EXPECT_FALSE(r->frames[0].stripe_used);
            EXPECT_FALSE(r->frames[1].stripe_used);
            EXPECT_EQ(r->report.judgement.verdict, Verdict::usable);
        }
    }
    const auto [low, high] = std::minmax_element(focal.begin(), focal.end());
    EXPECT_LT(*high / *low, 1.02);
}

}  // namespace
}  // namespace seamwright
