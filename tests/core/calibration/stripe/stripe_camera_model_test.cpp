// The stripe camera on scenes with a lens and a centre of their own: camera, plate, laser plane and robot are
// written out here from the textbook, nothing is shared with the solver.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <random>

#include "core/calibration/stripe/stripe_camera.h"

namespace seamwright {
namespace {

struct Lens {
    double f = 1450, cx = 655, cy = 470, k1 = -0.14, k2 = 0.08;
    Eigen::Vector2d see(const Eigen::Vector3d& p) const {
        const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
        const double bent = 1 + k1 * r2 + k2 * r2 * r2;
        return {cx + f * x * bent, cy + f * y * bent};
    }
};

struct ModelScene {
    Lens lens;
    Eigen::Vector3d normal = Eigen::Vector3d(0.8, 0.05, 0.6).normalized();  // of the laser plane
    Eigen::Vector3d on_plane{15, 0, 420};
    Eigen::Isometry3d flange_from_camera, base_from_plate;
    std::vector<StripeObservation> frames;
};

Eigen::Isometry3d motion(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
    Eigen::Isometry3d m = Eigen::Isometry3d::Identity();
    if (turn.norm() > 0) m.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
    m.translation() = shift;
    return m;
}

ModelScene model_scene(unsigned seed, double noise_px, double wave_px = 0) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> u(-1, 1);
    std::normal_distribution<double> n;
    ModelScene s;
    s.flange_from_camera = motion({0.2, -0.4, 0.9}, {60, -40, 130});
    s.base_from_plate = motion({0.1, -0.05, 0.7}, {900, 150, 250});
    const int columns = 11, rows = 8;
    while (s.frames.size() < 10) {
        const Eigen::Isometry3d plate =
            motion({0.5 * u(engine), 0.5 * u(engine), 0.6 * u(engine)}, Eigen::Vector3d::Zero());
        Eigen::Isometry3d camera_from_plate = plate;
        camera_from_plate.translation() =
            Eigen::Vector3d(50 * u(engine), 40 * u(engine), 420 + 60 * u(engine)) -
            plate.linear() * Eigen::Vector3d(75, 52.5, 0);
        StripeObservation o;
        o.id = "view" + std::to_string(s.frames.size());
        o.width = 1280;
        o.height = 960;
        FoundBoard board;
        bool inside = true;
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i) {
                const Eigen::Vector3d at(15 * i, 15 * j, 0);
                Eigen::Vector2d q = s.lens.see(camera_from_plate * at);
                inside = inside && q.x() > 4 && q.y() > 4 && q.x() < 1275 && q.y() < 955;
                // What no camera takes: every sheet lies rolled its own way.
                const double v = 2.0 * j / (rows - 1) - 1, way = s.frames.size() % 2 == 0 ? 1 : -1;
                q += way * wave_px * (4 * v * v * v - 3 * v) * Eigen::Vector2d(1.5, 1);
                board.index.push_back(j * columns + i);
                board.object_mm.push_back(at);
                board.pixel.push_back(q + noise_px * Eigen::Vector2d(n(engine), n(engine)));
            }
        if (!inside) continue;
        const Eigen::Vector3d m = camera_from_plate.linear().col(2);
        const Eigen::Vector3d along = m.cross(s.normal).normalized();
        Eigen::Matrix3d a;
        a << m.transpose(), s.normal.transpose(), along.transpose();
        const Eigen::Vector3d from = a.inverse() * Eigen::Vector3d(m.dot(camera_from_plate.translation()),
                                                                   s.normal.dot(s.on_plane), 0);
        std::map<int, double> lines;
        for (double t = -200; t < 200; t += 0.05) {
            const Eigen::Vector3d p = from + t * along;
            const Eigen::Vector3d on_plate = camera_from_plate.inverse() * p;
            if (on_plate.x() < -15 || on_plate.x() > 165 || on_plate.y() < -15 || on_plate.y() > 120)
                continue;
            const Eigen::Vector2d q = s.lens.see(p);
            if (q.x() > 10 && q.y() >= 0 && q.x() < 1270 && q.y() <= 959)
                lines[static_cast<int>(std::lround(q.y()))] = q.x();
        }
        if (lines.size() < 150) continue;
        o.board = board;
        o.scan = ScanLines::rows;
        for (const auto& [row, x] : lines) o.stripe.emplace_back(x + 0.1 * n(engine), row);
        const Eigen::Isometry3d error = motion(2e-4 * Eigen::Vector3d(n(engine), n(engine), n(engine)),
                                               0.05 * Eigen::Vector3d(n(engine), n(engine), n(engine)));
        o.base_from_flange =
            Pose((s.base_from_plate * camera_from_plate.inverse() * s.flange_from_camera.inverse() * error)
                     .matrix());
        s.frames.push_back(o);
    }
    return s;
}

BoardSpec plain_board() {
    BoardSpec spec;
    spec.columns = 11;
    spec.rows = 8;
    spec.pitch_mm = 15;
    return spec;
}

double degrees(double cosine) {
    return std::acos(std::min(1.0, std::abs(cosine))) * 180 / M_PI;
}

TEST(StripeCameraModel, ACentreAndALensOfItsOwnAreFoundOrKnownToBeUnsure) {
    int inside = 0, asked = 0;
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        SCOPED_TRACE(seed);
        const ModelScene s = model_scene(seed, 0.1);
        const auto r = calibrate_stripe_camera(s.frames, plain_board(), {});
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_TRUE(r->plane && r->flange_from_camera) << r->report.judgement.reason;
        EXPECT_LT(r->rms_px, 0.2);
        const double truth[] = {s.lens.f, s.lens.f, s.lens.cx, s.lens.cy};
        for (std::size_t i = 0; i < 4; ++i) {
            const auto& p = r->report.parameters[i];
            ++asked;
            inside += std::abs(p.value - truth[i]) < 2.5 * p.sigma;
            EXPECT_LT(std::abs(p.value - truth[i]), 4.5 * p.sigma) << p.name;
            EXPECT_GT(p.sigma, 0) << p.name;
        }
        const double off = degrees(r->plane->normal.dot(s.normal));
        EXPECT_LT(off, 4 * r->plane_sigma_deg);
        EXPECT_LT(off, 0.15);
        const Eigen::AngleAxisd turn(
            Eigen::Matrix3d(r->flange_from_camera->linear().transpose() * s.flange_from_camera.linear()));
        const double sigma =
            std::sqrt(r->flange_from_camera_covariance.bottomRightCorner<3, 3>().diagonal().maxCoeff());
        EXPECT_LT(turn.angle(), 4.5 * sigma);
        EXPECT_LT(turn.angle() * 180 / M_PI, 0.2);
    }
    EXPECT_GE(inside, 0.85 * asked);
}

TEST(StripeCameraModel, ThreeViewsLeaveTheCentreAsUnsureAsCamerasAreBuilt) {
    ModelScene s = model_scene(7, 0.1);
    s.frames.resize(4);
    const auto r = calibrate_stripe_camera(s.frames, plain_board(), {});
    ASSERT_TRUE(r) << r.error().sentence();
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& p = r->report.parameters[i];
        const double truth[] = {s.lens.f, s.lens.f, s.lens.cx, s.lens.cy};
        EXPECT_LT(std::abs(p.value - truth[i]), 4 * p.sigma) << p.name;
    }
}

TEST(StripeCameraModel, TenTimesTheCornersNoiseIsNotUsable) {
    const ModelScene s = model_scene(9, 0.1, 1.3);
    const auto r = calibrate_stripe_camera(s.frames, plain_board(), {});
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_FALSE(serves(r->report.judgement.verdict)) << r->report.judgement.reason;
}

}  // namespace
}  // namespace seamwright
