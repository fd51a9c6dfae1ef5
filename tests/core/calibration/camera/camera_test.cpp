#include "core/calibration/camera/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "tests/core/calibration/camera/camera_scene.h"
#include "tests/core/calibration/independent/plain_world.h"

namespace seamwright {
namespace {

using test::camera_640;
using test::plate;
using test::view_of;
using test::views_of;
using testing::HasSubstr;

constexpr CameraFreedom kFull{true, true, 3, true};

CameraOptions excluding(const std::string& id) {
    CameraOptions o;
    o.exclude = {id};
    return o;
}

TEST(CameraCalibration, ExactDataGivesTheTruth) {
    std::mt19937 random(1);
    const auto truth = camera_640();
    const auto r = calibrate_camera(views_of(truth, 8, random, 30, 0), {{}, kFull, 6});
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->camera.fx, truth.fx, 1e-4);
    EXPECT_NEAR(r->camera.fy, truth.fy, 1e-4);
    EXPECT_NEAR(r->camera.cx, truth.cx, 1e-4);
    EXPECT_NEAR(r->camera.cy, truth.cy, 1e-4);
    EXPECT_NEAR(r->camera.k1, truth.k1, 1e-5);
    EXPECT_NEAR(r->camera.p1, truth.p1, 1e-7);
    EXPECT_LT(r->rms_px, 1e-6);
}

// cv::calibrateCamera minimises the same sum: the same answer, independently programmed.
TEST(CameraCalibration, AgreesWithOpenCV) {
    std::mt19937 random(2);
    const auto data = views_of(camera_640(), 10, random, 30, 0.2);
    const auto r = calibrate_camera(data, {{}, kFull, 0});
    ASSERT_TRUE(r);
    std::vector<std::vector<cv::Point3f>> object;
    std::vector<std::vector<cv::Point2f>> image;
    for (const auto& v : data.views) {
        object.emplace_back();
        image.emplace_back();
        for (std::size_t i = 0; i < v.pixel.size(); ++i) {
            object.back().emplace_back(v.object_mm[i].x(), v.object_mm[i].y(), v.object_mm[i].z());
            image.back().emplace_back(v.pixel[i].x(), v.pixel[i].y());
        }
    }
    cv::Mat k, d;
    std::vector<cv::Mat> rv, tv;
    const double rms = cv::calibrateCamera(object, image, {640, 480}, k, d, rv, tv);
    EXPECT_LE(r->rms_px, rms * (1 + 1e-6));
    EXPECT_NEAR(r->camera.fx, k.at<double>(0, 0), 0.02);
    EXPECT_NEAR(r->camera.fy, k.at<double>(1, 1), 0.02);
    EXPECT_NEAR(r->camera.cx, k.at<double>(0, 2), 0.02);
    EXPECT_NEAR(r->camera.k1, d.at<double>(0), 1e-3);
}

TEST(CameraCalibration, ModelChoiceKeepsTheTruthInside) {
    std::mt19937 random(3);
    const auto truth = camera_640();
    const auto r = calibrate_camera(views_of(truth, 12, random, 35, 0.15), {});
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->freedom.centre);
    EXPECT_GE(r->freedom.radial, 2);
    EXPECT_NEAR(r->camera.fx, truth.fx, 4 * r->report.parameters[0].sigma);
    EXPECT_NEAR(r->camera.cy, truth.cy, 4 * r->report.parameters[3].sigma);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason;
    EXPECT_NEAR(r->sigma_px, 0.15, 0.01);
    EXPECT_GT(r->report.hold_out.rms_px, 0.15);
}

TEST(CameraCalibration, NamesAWrongPoint) {
    std::mt19937 random(4);
    auto data = views_of(camera_640(), 8, random, 30, 0.1);
    data.views[2].pixel[17] += Eigen::Vector2d(6, -4);
    const auto r = calibrate_camera(data, {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->point_used[2][17]);
    EXPECT_THAT(r->report.poses[2].note, HasSubstr("17"));
    EXPECT_NEAR(r->camera.fx, 540, 2);
}

// A plate that is bowed by a millimetre and given as flat: named, with the share of the residuals that the bow explains.
TEST(CameraCalibration, ABowedPlateIsNamedWithWhatItTakesAway) {
    constexpr double kNoise_px = 0.1;
    std::mt19937 random(7);
    const auto camera = camera_640();
    auto bowed = plate(9, 6, 25);
    for (auto& p : bowed) p.z() = 1 - std::pow((p.x() - 100) / 100, 2);
    CameraData data;
    data.width = camera.width, data.height = camera.height;
    for (int i = 0; i < 10; ++i) {
        data.views.push_back(view_of(camera, bowed, random, 35, 420, kNoise_px, "v" + std::to_string(i)));
        for (auto& p : data.views.back().object_mm) p.z() = 0;
    }
    const auto r = calibrate_camera(data, {});
    ASSERT_TRUE(r);
    const Text& reason = r->report.judgement.reason;
    ASSERT_THAT(reason.english(), HasSubstr("the plate is not as stated"));
    EXPECT_EQ(r->report.judgement.verdict, Verdict::poor) << "the focal length is many sigma off";
    ASSERT_EQ(reason.arguments().size(), 4u);
    EXPECT_NEAR(std::get<double>(reason.arguments()[2]), 1, 0.15) << "bow, mm";
    // What is left is the noise: of ten times 54 corners, less the parameters' share.
    EXPECT_NEAR(std::get<double>(reason.arguments()[3]), 100 * (1 - kNoise_px * std::sqrt(2.0) / r->rms_px),
                6)
        << reason.english() << ", rms " << r->rms_px;
}

// A plate of 80 x 60 mm before a camera of the textbook; `shape` is what it is instead of flat and square.
CameraData plain_views(plain::Dice& dice, const plain::Lens& lens, int views, double noise_px,
                       const std::function<plain::Vec3(const plain::Vec3&)>& shape,
                       const std::function<plain::Vec2(const plain::Vec2&, int view)>& bias = {},
                       const std::vector<double>& bow_mm = {}) {
    CameraData data;
    data.width = lens.width, data.height = lens.height;
    for (int tried = 0; static_cast<int>(data.views.size()) < views && tried < 20000; ++tried) {
        const plain::Motion m =
            plain::motion({0, 0, dice.u(-3.1, 3.1)}, {dice.u(-60, 60), dice.u(-45, 45), dice.u(250, 400)}) *
            plain::motion({dice.u(-0.5, 0.5), dice.u(-0.5, 0.5), 0}, plain::Vec3::Zero());
        CameraPoints v;
        v.id = "V" + std::to_string(data.views.size() + 1);
        for (int i = 0; i < 63; ++i) {
            const plain::Vec3 at(10.0 * (i % 9), 10.0 * (i / 9), 0);
            plain::Vec3 true_at = shape(at) - plain::Vec3(40, 30, 0);
            if (!bow_mm.empty())
                true_at.z() += bow_mm[data.views.size()] * (1 - true_at.squaredNorm() / 1600);
            plain::Vec2 q = lens.see(m * true_at);
            if (bias) q += bias(q, static_cast<int>(data.views.size()));
            if (!lens.has(q, 3)) break;
            v.object_mm.push_back(at);
            v.pixel.push_back(q + noise_px * plain::Vec2(dice.n(), dice.n()));
        }
        if (v.pixel.size() == 63) data.views.push_back(v);
    }
    return data;
}
double worst_in_sigmas(const CameraResult& r, const plain::Lens& lens) {
    const double truth[] = {lens.fx, lens.fy, lens.cx, lens.cy};
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i)
        worst =
            std::max(worst, std::abs(r.report.parameters[i].value - truth[i]) / r.report.parameters[i].sigma);
    return worst;
}

TEST(CameraCalibration, APlateThatIsNotAsStatedServesWithinItsSigmasOrNotAtAll) {
    for (unsigned seed = 1; seed <= 6; ++seed)
        for (const auto& plate : {std::pair{0.1, 0.0}, {0.3, 0.0}, {1.0, 0.0}, {0.0, 0.005}}) {
            const double bow_mm = plate.first, stretch = plate.second;
            plain::Dice dice(seed);
            const plain::Lens lens = plain::any_lens(dice);
            const auto shape = [&](const plain::Vec3& p) {
                const double r2 = std::pow((p.x() - 40) / 50, 2) + std::pow((p.y() - 30) / 50, 2);
                return plain::Vec3(p.x(), p.y() * (1 + stretch), bow_mm * (1 - r2));
            };
            const auto r = calibrate_camera(plain_views(dice, lens, 12, 0.1, shape), {});
            ASSERT_TRUE(r) << r.error().sentence();
            const Judgement& j = r->report.judgement;
            EXPECT_THAT(j.reason.english(), HasSubstr("not as stated"))
                << seed << " " << bow_mm << " " << stretch;
            if (serves(j.verdict)) {
                EXPECT_LT(worst_in_sigmas(*r, lens), 3.5) << seed << " " << bow_mm << " " << stretch;
            }
            if (bow_mm > 0.2) {
                EXPECT_EQ(j.verdict, Verdict::poor) << seed << " " << bow_mm;
            }
        }
}

// Sound plates, corners that err alike too: blur of a view, light from one side, a lens beyond the model's terms.
TEST(CameraCalibration, ASoundPlateIsNotDoubtedForItsCorners) {
    int doubted = 0, asked = 0;
    for (unsigned seed = 1; seed <= 5; ++seed)
        for (int kind = 0; kind < 4; ++kind)
            for (const int views : {6, 14}) {
                plain::Dice dice(500 + seed);
                const plain::Lens lens = plain::any_lens(dice);
                std::vector<plain::Vec2> light;
                for (int i = 0; i < views; ++i) light.emplace_back(0.3 * dice.n(), 0.3 * dice.n());
                const auto bias = [&](const plain::Vec2& q, int view) -> plain::Vec2 {
                    const plain::Vec2 w = (q - plain::Vec2(640, 480)) / 640;
                    if (kind == 1) return 0.3 * light[static_cast<std::size_t>(view)] * w.x();
                    if (kind == 2) return 0.1 * w * std::pow(w.squaredNorm(), 3);
                    if (kind == 3)
                        return 0.05 *
                               plain::Vec2(std::sin(q.x() / 25 + view), std::cos(q.y() / 35 + 2 * view));
                    return plain::Vec2::Zero();
                };
                const auto data = plain_views(
                    dice, lens, views, 0.08, [](const plain::Vec3& p) { return p; }, bias);
                const auto r = calibrate_camera(data, {});
                ASSERT_TRUE(r) << r.error().sentence();
                ++asked;
                const bool said =
                    r->report.judgement.reason.english().find("not as stated") != std::string::npos;
                doubted += said;
            }
    EXPECT_LE(doubted, asked / 30);
}

// A thin plate that is held otherwise in each view: the camera knows less by that, and it is said. Plates that are stiff,
// read by corners of several kinds, are not blamed.
TEST(CameraCalibration, APlateThatBendsFromViewToViewIsNamed) {
    enum Kind { bends, white, heavy, border };
    for (const Kind kind : {bends, white, heavy, border}) {
        int named = 0, asked = 0;
        double nees = 0;
        for (unsigned seed = 1; seed <= 12; ++seed) {
            plain::Dice dice(900 + seed);
            const plain::Lens lens = plain::any_lens(dice);
            const int views = kind == bends ? 12 : 6 + static_cast<int>(seed);
            std::vector<double> bow;
            for (int i = 0; i < views; ++i) bow.push_back(kind == bends ? 0.25 * dice.n() : 0);
            auto data = plain_views(
                dice, lens, views, 0, [](const plain::Vec3& p) { return p; }, {}, bow);
            std::student_t_distribution<double> t(3);
            for (auto& v : data.views)
                for (auto& q : v.pixel) {
                    const double out = (q - plain::Vec2(640, 480)).norm() / 800;
                    const double sigma = kind == border ? 0.06 * (1 + 4 * out * out) : 0.1;
                    for (double* x : {&q.x(), &q.y()})
                        *x += sigma * (kind == heavy ? t(dice.engine) / std::sqrt(3.0) : dice.n());
                }
            const auto r = calibrate_camera(data, {{}, CameraFreedom{true, true, 2, true}, 6});
            ASSERT_TRUE(r) << r.error().sentence();
            ++asked;
            named += r->report.judgement.reason.english().find("bends otherwise") != std::string::npos;
            const Eigen::Vector2d e(r->camera.cx - lens.cx, r->camera.cy - lens.cy);
            nees += e.dot(r->report.covariance.block<2, 2>(2, 2).inverse() * e) / 2 / 12;
        }
        std::printf("kind %d: %d of %d named, NEES of the centre %.2f\n", kind, named, asked, nees);
        if (kind == bends) {
            EXPECT_GE(named, 6);
        } else {
            EXPECT_EQ(named, 0);
        }
        EXPECT_LT(nees, 2.2) << kind;
    }
}

TEST(CameraCalibration, ParallelPlatesAreUndetermined) {
    std::mt19937 random(5);
    const auto camera = camera_640();
    CameraData data;
    data.width = 640, data.height = 480;
    std::normal_distribution<double> n(0, 0.1);
    for (int i = 0; i < 6; ++i) {
        CameraPoints v;
        v.id = std::to_string(i);
        const Pose pose = make_pose(Eigen::Matrix3d::Identity(), {-100.0 + 4 * i, -60, 400.0 + 5 * i});
        for (const auto& p : plate(9, 6, 25)) {
            v.object_mm.push_back(p);
            v.pixel.push_back(camera.project(pose * p) + Eigen::Vector2d(n(random), n(random)));
        }
        data.views.push_back(v);
    }
    const auto r = calibrate_camera(data, {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::undetermined) << r->report.judgement.reason;
    EXPECT_EQ(r->report.covariance.size(), 0);
    EXPECT_FALSE(r->report.judgement.cure.empty());
}

TEST(CameraCalibration, ABodyNeedsOneViewOnly) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<Eigen::Vector3d> body;
    for (int i = 0; i < 60; ++i) body.emplace_back(80 * u(random), 80 * u(random), 80 * u(random));
    CameraModel camera = camera_640();
    camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
    CameraData data;
    data.width = 640, data.height = 480;
    data.views.push_back(view_of(camera, body, random, 40, 420, 0, "body"));
    const auto r = calibrate_camera(data, {{}, CameraFreedom{true, true, 0, false}, 6});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_NEAR(r->camera.fx, camera.fx, 1e-3);
    EXPECT_NEAR(r->camera.cx, camera.cx, 1e-3);
}

TEST(CameraCalibration, BadInputIsOneSentence) {
    std::mt19937 random(7);
    const auto good = views_of(camera_640(), 6, random, 30, 0.1);
    const auto refused = [](const CameraData& d, const CameraOptions& o = {}) {
        const auto r = calibrate_camera(d, o);
        EXPECT_FALSE(r);
        return r ? std::string() : r.error().sentence();
    };
    EXPECT_THAT(refused({}), HasSubstr("pixels"));
    auto d = good;
    d.views.clear();
    EXPECT_THAT(refused(d), HasSubstr("no view"));
    d = good;
    d.views.resize(1);
    EXPECT_THAT(refused(d), HasSubstr("too few"));
    d = good;
    for (auto& v : d.views) v.pixel = good.views[0].pixel, v.object_mm = good.views[0].object_mm;
    EXPECT_THAT(refused(d), HasSubstr("too few"));
    d = good;
    d.views[3].pixel[5].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refused(d), HasSubstr("finite"));
    d = good;
    d.views[3].pixel[5].x() = 1e300;
    EXPECT_THAT(refused(d), HasSubstr("outside"));
    d = good;
    d.views[1].pixel.pop_back();
    EXPECT_THAT(refused(d), HasSubstr("one pixel per point"));
    d = good;
    for (auto& v : d.views)
        for (auto& p : v.object_mm) p *= 0.001;
    EXPECT_THAT(refused(d), HasSubstr("metres"));
    d = good;
    for (auto& p : d.views[0].object_mm) p.y() = 0;
    EXPECT_THAT(refused(d), HasSubstr("one line"));
    EXPECT_THAT(refused(good, excluding("nobody")), HasSubstr("nobody"));
    d = good;
    d.views[1].id = d.views[0].id;
    EXPECT_FALSE(refused(d).empty());
}

TEST(CameraCalibration, ExcludedAndDoubledViewsTakeNoPart) {
    std::mt19937 random(8);
    auto data = views_of(camera_640(), 8, random, 30, 0.1);
    auto bad = data.views[0];
    bad.id = "bad";
    for (auto& p : bad.pixel) p = {640 - p.x(), 0.5 * p.y()};
    data.views.push_back(bad);
    data.views.push_back(data.views[1]);
    data.views.back().id = "twin";
    const auto r = calibrate_camera(data, excluding("bad"));
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->report.poses[8].used);
    EXPECT_FALSE(r->report.poses[9].used);
    EXPECT_THAT(r->report.poses[9].note, HasSubstr("v1"));
    EXPECT_NEAR(r->camera.fx, 540, 2);
}

TEST(LocateTarget, FindsThePoseAndItsCovariance) {
    std::mt19937 random(9);
    const auto camera = camera_640();
    int inside = 0;
    for (int i = 0; i < 300; ++i) {
        Pose truth;
        const auto view = view_of(camera, plate(7, 6, 10), random, 45, 300, 0.2, "t", &truth);
        const auto t = locate_target(camera, view);
        ASSERT_TRUE(t);
        const Vector6 e = difference(t->camera_from_target, truth);
        EXPECT_LT(e.head<3>().norm(), 3) << i;
        const double q = e.dot(t->covariance.ldlt().solve(e));
        inside += q < 12.59;  // 95 % of chi-squared with 6 degrees of freedom
    }
    EXPECT_GT(inside, 275);
}

TEST(Homography, RefusesTheDegenerate) {
    EXPECT_FALSE(homography_dlt({{0, 0}, {1, 0}, {2, 0}}, {{0, 0}, {1, 0}, {2, 0}}));
    EXPECT_FALSE(
        homography_dlt({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}}, {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}}));
}

}  // namespace
}  // namespace seamwright
