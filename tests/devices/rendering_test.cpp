#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "core/profile/stripe/peaks.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SurfaceSettings plain_surface() {
    SurfaceSettings s;
    s.gloss = 0;
    s.dark_share = 0;
    s.mirror = 0;
    return s;
}
NoiseSettings no_noise() {
    NoiseSettings n;
    n.shot = false;
    n.read_electrons = 0;
    n.speckle = 0;
    n.ambient_electrons_per_ms = 0;
    n.stray_probability = 0;
    return n;
}

void add_quad(TriangleMesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c,
              const Vector3d& d) {
    const int n = static_cast<int>(mesh.vertices.size());
    for (const auto& v : {a, b, c, d}) mesh.vertices.push_back(v);
    mesh.triangles.emplace_back(n, n + 1, n + 2);
    mesh.triangles.emplace_back(n, n + 2, n + 3);
}
TriangleMesh floor_mesh() {
    TriangleMesh mesh;
    add_quad(mesh, {-100, -100, 0}, {100, -100, 0}, {100, 100, 0}, {-100, 100, 0});
    return mesh;
}

struct Picture {
    std::vector<std::byte> pixels;
    std::vector<StripeSample> truth;
    StripeImage image;
    double grey(int u, int v) const {
        const auto at =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(u);
        if (image.bit_depth == 8) return std::to_integer<int>(pixels[at]);
        std::uint16_t value;
        std::memcpy(&value, pixels.data() + 2 * at, 2);
        return value;
    }
};

Picture take(StripeRenderer& renderer, const MeshTree& mesh, const Pose& part_from_sensor,
             const Exposure& exposure = {}) {
    Picture p;
    p.pixels.resize(renderer.image_bytes());
    renderer.render(mesh, part_from_sensor, exposure, 1, p.pixels, &p.truth);
    const auto& o = renderer.optics();
    p.image = {p.pixels.data(), o.width, o.height,
               static_cast<std::size_t>(o.width) * (o.bit_depth > 8 ? 2 : 1), o.bit_depth};
    return p;
}

// Measured points (x, z) of the strongest peak of every column.
std::vector<Vector2d> measure(const StripeImage& image, const SensorModel& model) {
    StripePeaks peaks;
    PeakOptions options;
    options.per_line = 1;
    EXPECT_TRUE(find_peaks(image, options, peaks));
    ProfileCandidates candidates;
    to_millimetres(peaks, model, candidates);
    std::vector<Vector2d> points;
    for (int line = 0; line < candidates.lines; ++line) {
        if (candidates.count[static_cast<std::size_t>(line)] == 0) continue;
        const auto i = static_cast<std::size_t>(candidates.index(line, 0));
        points.emplace_back(candidates.x_mm[i], candidates.z_mm[i]);
    }
    return points;
}

double distance_to(const std::vector<std::pair<Vector2d, Vector2d>>& segments, const Vector2d& p) {
    double best = 1e9;
    for (const auto& [a, b] : segments) {
        const Vector2d d = b - a;
        const double s = d.squaredNorm() > 0 ? std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0) : 0;
        best = std::min(best, (a + s * d - p).norm());
    }
    return best;
}

// Every triangle against the laser plane, in the sensor frame.
std::vector<std::pair<Vector2d, Vector2d>> plane_cut(const TriangleMesh& mesh, const Pose& sensor_from_part) {
    std::vector<std::pair<Vector2d, Vector2d>> segments;
    for (const auto& t : mesh.triangles) {
        Vector3d v[3];
        for (int k = 0; k < 3; ++k) v[k] = sensor_from_part * mesh.vertices[static_cast<std::size_t>(t[k])];
        std::vector<Vector2d> ends;
        for (int k = 0; k < 3; ++k) {
            const Vector3d &a = v[k], &b = v[(k + 1) % 3];
            if ((a.y() < 0) == (b.y() < 0)) continue;
            const double s = a.y() / (a.y() - b.y());
            ends.emplace_back(a.x() + s * (b.x() - a.x()), a.z() + s * (b.z() - a.z()));
        }
        if (ends.size() == 2) segments.emplace_back(ends[0], ends[1]);
    }
    return segments;
}

// Share of measured points nearer than `limit` to the true cut of the displaced, bent door; over some spots.
double share_within(const nlohmann::json& settings, double limit, double& median) {
    const auto cell = SimulatedCell::open(settings);
    EXPECT_TRUE(cell);
    const auto spots = default_door_spots();
    std::vector<double> distances;
    TriangleMesh bent = (*cell)->part_mesh();
    const auto box = bent.box();
    for (auto& v : bent.vertices) v.z() += bend_at((*cell)->part().bend, box, v);
    const Pose d = (*cell)->part().workobject_from_movedworkobject;
    for (std::size_t i = 0; i < spots.size(); i += 3) {
        const Pose w =
            spots[i].workobject_from_sensor * make_pose(rotation_exp({0.1, -0.05, 0.02}), {4, 0, -3});
        Frame frame;
        (*cell)->render((*cell)->flange_for(w), i, frame);
        const auto segments = plane_cut(bent, w.inverse() * d);
        const auto points = measure(frame.image, (*cell)->sensor_model());
        EXPECT_GT(points.size(), 500U);
        for (const Vector2d& p : points) distances.push_back(distance_to(segments, p));
    }
    std::sort(distances.begin(), distances.end());
    median = distances[distances.size() / 2];
    return static_cast<double>(std::lower_bound(distances.begin(), distances.end(), limit) -
                               distances.begin()) /
           static_cast<double>(distances.size());
}

const nlohmann::json kMoved = {{"displacement", {{"xyz", {3.0, -2.0, 4.0}}, {"abc", {0.3, -0.2, 0.4}}}},
                               {"bend_mm", 2.0},
                               {"twist_mm", 1.0}};

TEST(Rendering, ProfilesLieOnTheMeshWithoutNoise) {
    double median;
    const double share = share_within({{"part", kMoved},
                                       {"surface", {{"dark_share", 0}, {"mirror", 0}, {"gloss", 0}}},
                                       {"noise",
                                        {{"shot", false},
                                         {"read_electrons", 0},
                                         {"speckle", 0},
                                         {"stray_probability", 0},
                                         {"ambient_electrons_per_ms", 0}}}},
                                      0.01, median);
    EXPECT_GE(share, 0.97) << "the rest are columns that a jump or an end of the contour crosses";
    EXPECT_LT(median, 0.003);
}

TEST(Rendering, ProfilesLieOnTheMeshWithTheStatedNoise) {
    double median;
    const double share =
        share_within({{"part", kMoved}, {"noise", {{"stray_probability", 0}}}}, 0.05, median);
    EXPECT_GE(share, 0.95);
    EXPECT_LT(median, 0.02);
    EXPECT_GT(median, 0.004) << "speckle and shot noise are there";
}

TEST(Rendering, StripeStandsWhereTheModelPutsIt) {
    // Curves seen through the whole field with distortion, levelled and tilted: no systematic offset.
    StripeRenderer renderer(OpticsSettings{}, plain_surface(), no_noise());
    const MeshTree mesh(floor_mesh());
    for (const double height : {-30.0, 0.0, 30.0}) {
        for (const double tilt : {-0.3, 0.0, 0.3}) {
            const Pose part_from_sensor = make_pose(rotation_exp({0.1, tilt, 0.05}), {0, 0, -height});
            const auto picture = take(renderer, mesh, part_from_sensor);
            const auto segments = plane_cut(mesh.mesh(), part_from_sensor.inverse());
            const auto points = measure(picture.image, renderer.model());
            ASSERT_GT(points.size(), 800U);
            double sum = 0;
            std::size_t n = 0;
            for (std::size_t i = 20; i + 20 < points.size(); ++i) {
                const auto on_line = [&](double x) {  // the floor is one straight line in the laser plane
                    const auto& [a, b] = segments.front();
                    return a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x());
                };
                const auto truth = renderer.model().to_pixel({points[i].x(), on_line(points[i].x())});
                const auto seen = renderer.model().to_pixel(points[i]);
                sum += seen->y() - truth->y();
                ++n;
            }
            EXPECT_LT(std::abs(sum / static_cast<double>(n)), 0.01) << height << " " << tilt;
        }
    }
}

TEST(Rendering, AWallShadowsTheLaser) {
    StripeRenderer renderer(OpticsSettings{}, plain_surface(), no_noise());
    TriangleMesh mesh = floor_mesh();
    add_quad(mesh, {15, -60, 0}, {15, 60, 0}, {15, 60, 60}, {15, -60, 60});
    const auto picture = take(renderer, MeshTree(mesh), Pose::Identity());
    const double shadow_end = 15 * 300.0 / (300 - 60);  // laser at (0, 0, 300)
    double last_before = -99, first_behind = 99;
    bool in_shadow = false;
    for (const auto& s : picture.truth) {
        if (s.z_mm > 0.01F) continue;
        in_shadow = in_shadow || (s.x_mm > 15.01F && s.x_mm < shadow_end - 0.05);
        if (s.x_mm < 15) last_before = std::max<double>(last_before, s.x_mm);
        if (s.x_mm > 15.01F) first_behind = std::min<double>(first_behind, s.x_mm);
    }
    EXPECT_FALSE(in_shadow);
    EXPECT_NEAR(last_before, 15, 0.1);
    EXPECT_NEAR(first_behind, shadow_end, 0.1);
    for (const Vector2d& p : measure(picture.image, renderer.model())) {
        if (p.y() < 1) {
            EXPECT_FALSE(p.x() > 15.4 && p.x() < shadow_end - 0.4) << "the picture shows light in the shadow";
        }
    }
}

TEST(Rendering, AScreenHidesTheStripeFromTheCameraOnly) {
    StripeRenderer renderer(OpticsSettings{}, plain_surface(), no_noise());
    // The camera looks from y = -173, z = 300: its ray to (x, 0, 0) passes y = -20 at z = 34.6.
    for (const double top : {30.0, 40.0}) {
        TriangleMesh mesh = floor_mesh();
        add_quad(mesh, {-10, -20, 0}, {10, -20, 0}, {10, -20, top}, {-10, -20, top});
        const auto picture = take(renderer, MeshTree(mesh), Pose::Identity());
        int hidden_zone = 0, outside = 0;
        for (const auto& s : picture.truth) {
            hidden_zone += std::abs(s.x_mm) < 7;
            outside += std::abs(s.x_mm) > 12;
        }
        EXPECT_EQ(hidden_zone > 0, top < 34);
        EXPECT_GT(outside, 500);
    }
}

TEST(Rendering, SaturationIsASymmetricPlateauThatWidensWithExposure) {
    StripeRenderer renderer(OpticsSettings{}, plain_surface(), no_noise());
    const MeshTree mesh(floor_mesh());
    // Tilted, so that the stripe meets the pixels at every phase.
    const Pose part_from_sensor = make_pose(rotation_exp({0, 0.12, 0}), {0, 0, 0});
    int last_width = 0;
    for (const double exposure_us : {1000.0, 4000.0, 16000.0, 64000.0}) {
        Exposure exposure;
        exposure.exposure_us = exposure_us;
        const auto picture = take(renderer, mesh, part_from_sensor, exposure);
        int plateau = 0;
        for (int v = 0; v < picture.image.height; ++v) plateau += picture.grey(640, v) == 255;
        if (exposure_us == 1000) {
            EXPECT_EQ(plateau, 0);
            continue;
        }
        EXPECT_GT(plateau, last_width);
        last_width = plateau;
        const auto points = measure(picture.image, renderer.model());
        ASSERT_GT(points.size(), 1000U);
        double sum = 0;
        for (const auto& p : points) sum += p.y() - p.x() * std::tan(0.12);
        EXPECT_LT(std::abs(sum / static_cast<double>(points.size())), 0.006)
            << "mm; charge runs out alike to both sides";
    }
    EXPECT_GE(last_width, 12);
}

TEST(Rendering, SecondBounceLandsWhereTheMirrorLawSays) {
    SurfaceSettings surface = plain_surface();
    surface.mirror = 1;
    StripeRenderer renderer(OpticsSettings{}, surface, no_noise());
    // A floor tilted about Y and about X throws the light against a wall at x = 40.
    const Vector3d normal = Vector3d(0.45, 0.08, 1).normalized();
    const auto z_at = [&](double x, double y) { return -(normal.x() * x + normal.y() * y) / normal.z(); };
    TriangleMesh mesh;
    add_quad(mesh, {-40, -60, z_at(-40, -60)}, {20, -60, z_at(20, -60)}, {20, 60, z_at(20, 60)},
             {-40, 60, z_at(-40, 60)});
    add_quad(mesh, {40, -80, -60}, {40, 80, -60}, {40, 80, 80}, {40, -80, 80});
    const auto picture = take(renderer, MeshTree(mesh), Pose::Identity());
    int ghosts = 0;
    double worst = 0;
    for (const auto& s : picture.truth) {
        if (!s.ghost) continue;
        ++ghosts;
        const Vector3d p(s.x_mm, 0, s.z_mm), in = (p - Vector3d(0, 0, 300)).normalized();
        const Vector3d out = in - 2 * normal.dot(in) * normal;
        ASSERT_GT(out.x(), 0);
        const Vector3d q = p + out * ((40 - p.x()) / out.x());
        const Vector2d pixel = renderer.model().camera.project(renderer.model().camera_from_laser * q);
        // Spots between two landings carry the source point of the second: less than one landing's spacing
        // off.
        worst = std::max(worst, (pixel - Vector2d(s.u_px, s.v_px)).norm());
    }
    EXPECT_GT(ghosts, 50);
    EXPECT_LT(worst, 6);
    surface.mirror = 0;
    StripeRenderer dull(OpticsSettings{}, surface, no_noise());
    for (const auto& s : take(dull, MeshTree(mesh), Pose::Identity()).truth) EXPECT_FALSE(s.ghost);
}

TEST(Rendering, StrayReflectionsComeAsOftenAsStatedAndMayOutshineTheStripe) {
    NoiseSettings noise = no_noise();
    noise.stray_probability = 0.3;
    OpticsSettings small;
    small.width = 320;
    small.height = 256;
    StripeRenderer renderer(small, plain_surface(), noise);
    const MeshTree mesh(floor_mesh());
    int with = 0, brighter = 0;
    constexpr int kFrames = 400;
    for (int i = 0; i < kFrames; ++i) {
        Exposure exposure;
        exposure.seed = static_cast<std::uint64_t>(i);
        const auto picture = take(renderer, mesh, Pose::Identity(), exposure);
        float real = 0, ghost = 0;
        for (const auto& s : picture.truth)
            (s.ghost ? ghost : real) = std::max(s.ghost ? ghost : real, s.electrons);
        with += ghost > 0;
        brighter += ghost > real;
        if (ghost > 0) {
            const auto& s = picture.truth.back();
            const int u = static_cast<int>(std::lround(s.u_px)), v = static_cast<int>(std::lround(s.v_px));
            if (u > 2 && v > 2 && u < 317 && v < 253) {
                EXPECT_GT(picture.grey(u, v), 10);
            }
        }
    }
    EXPECT_NEAR(with, 0.3 * kFrames, 4 * std::sqrt(0.21 * kFrames));
    EXPECT_GT(brighter, with / 5);
    EXPECT_LT(brighter, with);
}

TEST(Rendering, NoiseIsAsStated) {
    NoiseSettings noise = no_noise();
    noise.shot = true;
    noise.read_electrons = 120;
    noise.ambient_electrons_per_ms = 4000;
    OpticsSettings optics;
    optics.bit_depth = 16;  // rounding far below the noise
    StripeRenderer renderer(optics, plain_surface(), noise);
    const MeshTree nothing{TriangleMesh{}};
    const auto picture = take(renderer, nothing, Pose::Identity());
    const double electrons_per_grey = kFullWellElectrons / 65535;
    double sum = 0, squares = 0, neighbours = 0;
    int n = 0;
    for (int v = 462; v < 562; ++v) {
        for (int u = 590; u < 690; ++u) {
            const double e = (picture.grey(u, v) - 0.01 * 65535) * electrons_per_grey;
            const double e2 = (picture.grey(u + 1, v) - 0.01 * 65535) * electrons_per_grey;
            sum += e;
            squares += e * e;
            neighbours += (e - 4000) * (e2 - 4000);
            ++n;
        }
    }
    const double mean = sum / n, variance = squares / n - mean * mean;
    EXPECT_NEAR(mean, 4000, 5);
    EXPECT_NEAR(variance, 4000 + 120 * 120, 0.05 * (4000 + 120 * 120));
    EXPECT_LT(std::abs(neighbours / n / variance), 0.04) << "white";
}

TEST(Rendering, SpeckleHasItsContrast) {
    NoiseSettings noise = no_noise();
    noise.speckle = 0.3;
    OpticsSettings optics;
    optics.bit_depth = 16;
    StripeRenderer renderer(optics, plain_surface(), noise);
    NoiseSettings quiet = no_noise();
    StripeRenderer smooth(optics, plain_surface(), quiet);
    const MeshTree mesh(floor_mesh());
    const auto a = take(renderer, mesh, Pose::Identity()), b = take(smooth, mesh, Pose::Identity());
    double sum = 0, squares = 0;
    int n = 0;
    for (int u = 100; u < 1100; ++u) {
        for (int v = 0; v < 1024; ++v) {
            const double base = b.grey(u, v) - 0.01 * 65535;
            if (base < 8000) continue;
            const double ratio = (a.grey(u, v) - 0.01 * 65535) / base;
            sum += ratio;
            squares += ratio * ratio;
            ++n;
        }
    }
    ASSERT_GT(n, 2000);
    EXPECT_NEAR(sum / n, 1, 0.02);
    EXPECT_NEAR(std::sqrt(squares / n - (sum / n) * (sum / n)), 0.3, 0.03);
}

TEST(Rendering, DarkPatchesCoverTheirShare) {
    SurfaceSettings surface = plain_surface();
    surface.dark_share = 0.2;
    surface.dark_size_mm = 4;
    StripeRenderer renderer(OpticsSettings{}, surface, no_noise());
    const MeshTree mesh(floor_mesh());
    double dark = 0, all = 0;
    for (int i = 0; i < 60; ++i) {
        const auto picture =
            take(renderer, mesh, make_pose(Eigen::Matrix3d::Identity(), {0, -60.0 + 2 * i, 0}));
        for (const auto& s : picture.truth) {
            const double full = kBrightElectronsPerMs * surface.albedo;
            dark += s.electrons < 0.5 * full * 0.97;
            ++all;
        }
    }
    EXPECT_NEAR(dark / all, 0.2, 0.06);
}

TEST(Rendering, SameSeedSameBytes) {
    OpticsSettings optics;
    StripeRenderer one(optics, SurfaceSettings{}, NoiseSettings{}),
        other(optics, SurfaceSettings{}, NoiseSettings{});
    const MeshTree mesh(triangle_body_mesh());
    const Pose pose = make_pose(rotation_exp({0.05, 0.02, 0.1}), {0, 0, 10});
    Exposure exposure;
    exposure.seed = 7;
    const auto first = take(one, mesh, pose, exposure);
    exposure.seed = 8;
    const auto second = take(one, mesh, pose, exposure);
    exposure.seed = 7;
    EXPECT_EQ(first.pixels, take(one, mesh, pose, exposure).pixels) << "whatever was rendered in between";
    EXPECT_EQ(first.pixels, take(other, mesh, pose, exposure).pixels);
    EXPECT_NE(first.pixels, second.pixels);
}

TEST(Rendering, BitDepthsFillTheirRange) {
    const MeshTree mesh(floor_mesh());
    for (const int depth : {8, 10, 12, 16}) {
        OpticsSettings optics;
        optics.bit_depth = depth;
        optics.width = 200;  // not a multiple of the block
        optics.height = 160;
        StripeRenderer renderer(optics, SurfaceSettings{}, NoiseSettings{});
        Exposure exposure;
        exposure.exposure_us = 20000;
        const auto picture = take(renderer, mesh, Pose::Identity(), exposure);
        double top = 0;
        for (int v = 0; v < 160; ++v) {
            for (int u = 0; u < 200; ++u) top = std::max(top, picture.grey(u, v));
        }
        EXPECT_EQ(top, (1 << depth) - 1);
        EXPECT_GT(measure(picture.image, renderer.model()).size(), 150U);
    }
}

TEST(Rendering, NothingBeforeTheSensorGivesAnEmptyPicture) {
    StripeRenderer renderer(OpticsSettings{}, SurfaceSettings{}, NoiseSettings{});
    const MeshTree mesh(floor_mesh());
    for (const double z : {-400.0, 299.5, 5000.0}) {  // behind the sensor, at the lens, far away
        const auto picture = take(renderer, mesh, make_pose(Eigen::Matrix3d::Identity(), {0, 0, z}));
        EXPECT_TRUE(picture.truth.empty()) << z;
    }
}

TEST(Rendering, TheSphereFitsItsRadius) {
    auto settings =
        nlohmann::json{{"scene", "sphere"}, {"sphere_radius_mm", 20}, {"noise", {{"stray_probability", 0}}}};
    const auto cell = SimulatedCell::open(settings);
    ASSERT_TRUE(cell);
    for (const double off : {0.0, 5.0, -8.0}) {
        const Pose target_from_sensor =
            make_pose(rotation_exp({0, 0, 0.4}), Vector3d(0, 0, 12) + rotation_exp({0, 0, 0.4}).col(1) * off);
        Frame frame;
        (*cell)->render((*cell)->settings().base_from_target * target_from_sensor *
                            (*cell)->flange_from_sensor().inverse(),
                        1, frame);
        const auto points = measure(frame.image, (*cell)->sensor_model());
        ASSERT_GT(points.size(), 300U);
        // The cut is a circle about the sphere's centre at z = -12 in the sensor frame.
        double worst = 0;
        std::vector<double> errors;
        for (const auto& p : points)
            errors.push_back(std::abs((p - Vector2d(0, -12)).norm() - std::sqrt(400 - off * off)));
        std::sort(errors.begin(), errors.end());
        worst = errors[errors.size() * 9 / 10];
        EXPECT_LT(worst, 0.06) << off;
    }
}

}  // namespace
}  // namespace seamwright
