#include "projects/reuse/mirror.h"

#include <gtest/gtest.h>

#include "core/features/kinds/feature_registry.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/measure/measure.h"
#include "projects/station/check.h"
#include "tests/projects/fake_cell.h"

namespace seamwright {
namespace {

constexpr double kTolerance = 1e-9;

const MirrorPlane kPlanes[] = {{Eigen::Vector3d::UnitX(), 0},
                               {Eigen::Vector3d::UnitY(), 35},
                               {Eigen::Vector3d::UnitZ(), -12},
                               {Eigen::Vector3d(0.3, 1, -0.2).normalized(), 70}};

void expect_equal(const Pose& a, const Pose& b, const std::string& what, double tolerance = kTolerance) {
    EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), tolerance) << what;
}

// A contour with everything the kinds look for: a hollow, a round bead, a corner, ends.
Profile contour(unsigned seed) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> noise(0, 0.01);
    Profile p;
    for (int i = 0; i <= 600; ++i) {
        const double x = -25 + 0.08 * i;
        double z = x < -13 ? 0.01 * (x + 18) * (x + 18) - 0.25 : 0;  // a hollow, lowest at -18
        if (x > -12 && x < -2) z += std::sqrt(std::max(0.0, 36 - (x + 7) * (x + 7))) - std::sqrt(36.0 - 25);
        if (x > 8) z += 0.6 * (x - 8);
        p.x_mm.push_back(x);
        p.z_mm.push_back(z + noise(rng));
        p.intensity.push_back(static_cast<float>(100 + i));
    }
    return p;
}

Profile piece(const Profile& p, double from, double to) {
    Profile out;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.x_mm[i] >= from && p.x_mm[i] <= to) {
            out.x_mm.push_back(p.x_mm[i]);
            out.z_mm.push_back(p.z_mm[i]);
            out.intensity.push_back(p.intensity[i]);
            if (p.filtered()) out.segment.push_back(p.segment[i]);
        }
    return out;
}

// A nose to the left (sign 1) or to the right (-1).
Profile nose(unsigned seed, double sign) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> noise(0, 0.01);
    Profile p;
    for (int i = 0; i <= 120; ++i) {
        const double z = 6 - 0.1 * i;
        p.x_mm.push_back(sign * 0.08 * (z - 1) * (z - 1) + 3 + noise(rng));
        p.z_mm.push_back(z);
    }
    return p;
}

struct Case {
    std::string name;
    FeatureRecipe recipe;
    double from, to;  // the piece of contour it is looked for in
    double nose = 0;  // or one to this side
};

std::vector<Case> cases() {
    std::vector<Case> list;
    auto add = [&](std::string name, std::string kind, ParameterValues values, double from, double to) {
        Case c{std::move(name), {}, from, to};
        c.recipe.kind = std::move(kind);
        c.recipe.parameters = std::move(values);
        list.push_back(std::move(c));
    };
    add("end default", "contour-end", {}, -25, -13);
    add("end left", "contour-end", {{"side", 0}}, -25, -13);
    add("end right", "contour-end", {{"side", 1}, {"fit_length_mm", 3}}, -25, -13);
    add("corner", "corner", {}, 0, 20);
    add("corner given", "corner",
        {{"split", 1}, {"left_from_mm", 1}, {"left_to_mm", 7}, {"right_from_mm", 9.5}, {"right_to_mm", 18}},
        0, 20);
    add("corner given, halves", "corner", {{"split", 1}, {"left_to_mm", 8}, {"right_from_mm", 8}}, 0, 20);
    add("circle", "circle", {}, -11, -3);
    add("circle of known radius", "circle", {{"radius_mm", 6}}, -11, -3);
    add("highest", "extremum", {{"which", 0}}, -11, -3);
    add("lowest", "extremum", {{"which", 1}, {"fit_length_mm", 6}}, -25, -13);
    add("leftmost", "extremum", {{"which", 2}, {"fit_length_mm", 4}}, 0, 0);
    list.back().nose = 1;
    add("rightmost", "extremum", {{"which", 3}, {"fit_length_mm", 4}}, 0, 0);
    list.back().nose = -1;
    add("end in a window", "contour-end", {{"side", 1}, {"window_x_min_mm", -30}, {"window_x_max_mm", -13.5}},
        -25, -14);
    add("corner in a window", "corner", {{"window_x_min_mm", 2}, {"window_x_max_mm", 16}}, -25, 25);
    add("circle in a window", "circle", {{"window_x_min_mm", -11}, {"window_x_max_mm", -3}}, -25, 25);
    add("highest in a half window", "extremum", {{"which", 0}, {"window_x_max_mm", -3}}, -25, 25);
    add("template", "template", {}, -20, 20);
    list.back().recipe.template_profile = piece(contour(1), -15, 3);
    list.back().recipe.template_reference_mm = {-7, 1};
    return list;
}

TEST(Mirror, EveryFeatureKindFindsTheMirroredPoint) {
    std::set<std::string> covered;
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        covered.insert(c.recipe.kind);
        auto recipe = mirrored_recipe(c.recipe);
        ASSERT_TRUE(recipe) << recipe.error().sentence();
        auto finder = make_feature_finder(c.recipe);
        auto mirrored_finder = make_feature_finder(*recipe);
        ASSERT_TRUE(finder) << finder.error().sentence();
        ASSERT_TRUE(mirrored_finder) << mirrored_finder.error().sentence();
        // The registration's set of partners is a robust choice among noisy points and may differ by a few
        // of them; half a micrometre is a twentieth of the noise.
        const double tolerance = c.recipe.kind == "template" ? 5e-4 : kTolerance;
        for (unsigned seed = 2; seed < 8; ++seed) {
            Profile profile = c.nose != 0 ? nose(seed, c.nose) : piece(contour(seed), c.from, c.to);
            Profile mirrored = mirrored_profile(profile);
            ASSERT_TRUE(filter_profile(profile, {}));
            ASSERT_TRUE(filter_profile(mirrored, {}));
            const Feature a = (*finder)->find(profile), b = (*mirrored_finder)->find(mirrored);
            ASSERT_EQ(a.status, FeatureStatus::ok) << a.message;
            ASSERT_EQ(b.status, FeatureStatus::ok) << b.message;
            EXPECT_NEAR(b.point_mm.x(), -a.point_mm.x(), tolerance);
            EXPECT_NEAR(b.point_mm.y(), a.point_mm.y(), tolerance);
            EXPECT_NEAR(b.covariance_mm2(0, 0), a.covariance_mm2(0, 0), tolerance);
            EXPECT_NEAR(b.covariance_mm2(0, 1), -a.covariance_mm2(0, 1), tolerance);
            EXPECT_NEAR(b.covariance_mm2(1, 1), a.covariance_mm2(1, 1), tolerance);
            EXPECT_EQ(a.phi_rad.has_value(), b.phi_rad.has_value());
            if (c.recipe.kind != "template") {
                EXPECT_EQ(a.points_used, b.points_used);
            }
            if (a.phi_rad && c.recipe.kind == "template") {
                EXPECT_NEAR(*b.phi_rad, -*a.phi_rad, 1e-4);
            }
        }
    }
    for (const FeatureKind& kind : feature_kinds()) {
        // What the sensor's own job measures is mirrored there, or not at all.
        if (kind.name == "sensor-point")
            EXPECT_FALSE(mirrored_recipe({"sensor-point", {}, {}, {0, 0}}));
        else
            EXPECT_TRUE(covered.count(std::string(kind.name))) << kind.name << " is not mirrored here";
    }
}

// The fake cell with a spot of every kind of recipe, curves, weights and half-fixed regions.
Project rich_project() {
    Project p = make_fake_cell(8)->project;
    const auto kinds = cases();
    for (std::size_t i = 0; i < p.spots.size(); ++i) {
        Spot& s = p.spots[i];
        s.feature = kinds[i].recipe;
        s.reference_mm = {1.5 + 2.0 * static_cast<double>(i), 0, -2 - static_cast<double>(i % 3)};
        s.reference_profile = contour(20 + static_cast<unsigned>(i));
        if (i % 2) s.curve = ContourCurve{{0.02, 1e-3, -2e-5}, {-0.03, 2e-3, 1e-5}, -20, 18};
        if (i % 3 == 0) s.weights = {1, 0, 0.5};
        s.sigma_mm = 0.02 + 0.005 * static_cast<double>(i);
    }
    p.regions[1].free = {true, true, true, false, false, true};
    return p;
}

TEST(Mirror, CorrectionsAreTheMirroredCorrections) {
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const MirrorPlane& plane : kPlanes) {
        Project project = rich_project();
        const bool oblique = plane.normal.cwiseAbs().maxCoeff() < 0.999;
        if (oblique) {
            auto refused = mirrored_project(project, plane);
            ASSERT_FALSE(refused);
            EXPECT_NE(refused.error().sentence().find("oblique"), std::string::npos);
            project.regions[1].free = {true, true, true, false, false, false};
        }
        auto mirrored = mirrored_project(project, plane);
        ASSERT_TRUE(mirrored) << mirrored.error().sentence();
        for (const Spot& s : mirrored->spots)
            EXPECT_NEAR(s.base_from_flange.linear().determinant(), 1, 1e-12);
        EXPECT_TRUE(check(*mirrored).size() == check(project).size());

        // The finder states its sigma in the mirrored reference profile to some digits only: no matter of this law.
        for (Project* p : {&project, &*mirrored})
            for (Spot& s : p->spots) s.reference_profile.clear();
        int ok[2] = {0, 0};
        for (int trial = 0; trial < 20; ++trial) {
            // Within what the second region may tell in half of the trials.
            Eigen::Vector3d turn = 0.01 * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng));
            if (trial % 2) turn = oblique ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(turn.x(), 0, 0);
            const Pose displacement =
                make_pose(rotation_exp(turn), 4 * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)));
            std::vector<SpotMeasurement> measured, mirror_measured;
            for (std::size_t i = 0; i < project.spots.size(); ++i) {
                const Spot& spot = project.spots[i];
                // Where the displaced reference is seen, in both cells, each from its own geometry.
                auto seen = [&](const Project& p, const Pose& d, const Eigen::Vector3d& slip) {
                    const Pose w = p.part.base_from_workobject.inverse() * p.spots[i].base_from_flange *
                                   p.calibrations[0].flange_from_sensor;
                    return Eigen::Vector3d(w.inverse() * d * w * (p.spots[i].reference_mm + slip));
                };
                const Eigen::Vector3d noise =
                    0.02 * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng));
                SpotMeasurement m;
                m.spot_id = spot.id;
                m.status = trial % 5 == 4 && i == 2 ? SpotStatus::no_feature : SpotStatus::measured;
                m.sigma_mm = spot.sigma_mm;
                // One spot far off in some trials, which has to be found in both.
                const Eigen::Vector3d off =
                    trial % 5 == 3 && i == 5 ? Eigen::Vector3d(2, 0, 1) : Eigen::Vector3d::Zero().eval();
                m.measured_mm = seen(project, displacement, noise + off);
                measured.push_back(m);
                m.measured_mm = seen(*mirrored, mirrored_displacement(plane, displacement),
                                     Eigen::Vector3d(-noise.x() - off.x(), noise.y(), noise.z() + off.z()));
                mirror_measured.push_back(m);
                EXPECT_NEAR(mirror_measured.back().measured_mm.x(), -measured.back().measured_mm.x(), 1e-9);
            }
            const auto left = correct_regions(project, measured);
            const auto right = correct_regions(*mirrored, mirror_measured);
            ASSERT_EQ(left.size(), right.size());
            int solved = 0;
            for (std::size_t k = 0; k < left.size(); ++k) {
                ASSERT_EQ(left[k].correction.has_value(), right[k].correction.has_value());
                if (!left[k].correction) continue;
                ++solved;
                const RegionCorrection &a = *left[k].correction, &b = *right[k].correction;
                EXPECT_EQ(a.status, b.status);
                // Without displacement the covariance is that of the solution that is not given.
                if (a.status == CorrectionStatus::under_determined) continue;
                ++ok[k];
                const Pose& d = a.displacement.workobject_from_movedworkobject;
                expect_equal(b.displacement.workobject_from_movedworkobject, mirrored_displacement(plane, d),
                             left[k].region_id);
                EXPECT_LT((b.covariance - mirrored_covariance(plane, a.covariance)).cwiseAbs().maxCoeff(),
                          kTolerance);
                EXPECT_NEAR(a.rms_mm, b.rms_mm, kTolerance);
                EXPECT_NEAR(a.sigma_at_spots_mm, b.sigma_at_spots_mm, kTolerance);
                ASSERT_EQ(a.spots.size(), b.spots.size());
                for (std::size_t i = 0; i < a.spots.size(); ++i) {
                    EXPECT_EQ(a.spots[i].used, b.spots[i].used) << a.spots[i].id;
                    EXPECT_NEAR(a.spots[i].residual_mm.x(), -b.spots[i].residual_mm.x(), kTolerance);
                    EXPECT_NEAR(a.spots[i].residual_mm.z(), b.spots[i].residual_mm.z(), kTolerance);
                }
                // The path of the mirrored part: a point of the frame lies where the mirror puts it.
                const Eigen::Matrix3d r =
                    Eigen::Matrix3d::Identity() - 2 * plane.normal * plane.normal.transpose();
                const Pose& base = project.part.base_from_workobject;  // what the plane refers to
                for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(120, -40, 300)}) {
                    const Eigen::Vector3d there = base.inverse() * (left[k].base_from_frame * p);
                    const Eigen::Vector3d here = base.inverse() * (right[k].base_from_frame * (r * p));
                    EXPECT_LT((mirrored_point(plane, there) - here).norm(), 1e-8);
                }
            }
            EXPECT_EQ(solved, 2);
        }
        EXPECT_EQ(ok[0], 20);
        EXPECT_GE(ok[1], 10);
    }
}

// Raw profiles through filter, finder and correction: what the sensor of the mirrored cell would see.
TEST(Mirror, FromTheSensorsProfilesToTheCorrection) {
    auto cell = make_fake_cell();
    cell->noise_mm = 0.02;
    cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.004, -0.006, 0.003}), {3, -2, 1.5});
    const MirrorPlane plane = kPlanes[1];
    auto mirrored = mirrored_project(cell->project, plane);
    ASSERT_TRUE(mirrored) << mirrored.error().sentence();
    std::vector<SpotMeasurement> left, right;
    for (const Spot& spot : cell->project.spots) {
        Frame frame;
        frame.profile = cell->cut(spot);
        auto a = SpotMeasurer::make(cell->project, spot.id), b = SpotMeasurer::make(*mirrored, spot.id);
        ASSERT_TRUE(a && b);
        left.push_back(a->measure(frame));
        ASSERT_EQ(left.back().status, SpotStatus::measured) << left.back().message;
        frame.profile = mirrored_profile(frame.profile);
        right.push_back(b->measure(frame));
        ASSERT_EQ(right.back().status, SpotStatus::measured) << right.back().message;
    }
    const auto l = correct_regions(cell->project, left), r = correct_regions(*mirrored, right);
    ASSERT_TRUE(l[0].correction && r[0].correction);
    const Pose& d = l[0].correction->displacement.workobject_from_movedworkobject;
    EXPECT_LT(distance_mm(d, cell->workobject_from_movedworkobject), 0.2);
    expect_equal(r[0].correction->displacement.workobject_from_movedworkobject,
                 mirrored_displacement(plane, d), "displacement");
}

TEST(Mirror, TwiceIsTheOriginal) {
    for (const MirrorPlane& plane : kPlanes) {
        Project project = rich_project();
        project.regions[1].free = kAllFree;
        for (Spot& s : project.spots)
            s.via = {make_pose(rotation_exp({0.2, -0.1, 0.3}), {10, 20, -30}) * s.base_from_flange,
                     s.base_from_flange};
        TriangleMesh mesh;
        mesh.vertices = {{0, 0, 0}, {100, 0, 0}, {0, 80, 0}, {0, 0, 60}};
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        project.part.mesh_ply = ply_bytes(mesh);
        auto once = mirrored_project(project, plane);
        ASSERT_TRUE(once) << once.error().sentence();
        // The same plane lies on the other side of the moved work object.
        auto twice = mirrored_project(*once, {plane.normal, -plane.offset_mm});
        ASSERT_TRUE(twice);
        for (std::size_t i = 0; i < project.spots.size(); ++i) {
            const Spot &a = project.spots[i], &b = twice->spots[i];
            expect_equal(a.base_from_flange, b.base_from_flange, a.id);
            const Spot& image = once->spots[i];
            ASSERT_EQ(image.via.size(), 2U);
            expect_equal(image.via[1], image.base_from_flange, "mirrored as the spot is");
            for (std::size_t k = 0; k < 2; ++k) expect_equal(a.via[k], b.via[k], a.id);
            EXPECT_EQ(a.reference_mm, b.reference_mm);
            EXPECT_EQ(a.reference_profile.x_mm, b.reference_profile.x_mm);
            EXPECT_EQ(a.reference_profile.intensity, b.reference_profile.intensity);
            EXPECT_EQ(a.feature.template_profile.x_mm, b.feature.template_profile.x_mm);
            for (const ParameterInfo& info : feature_kind(a.feature.kind)->parameters)
                EXPECT_EQ(
                    parameter(a.feature.parameters, feature_kind(a.feature.kind)->parameters, info.name),
                    parameter(b.feature.parameters, feature_kind(b.feature.kind)->parameters, info.name))
                    << a.id << " " << info.name;
            if (a.curve) {
                EXPECT_EQ(a.curve->x_coefficients, b.curve->x_coefficients);
            }
        }
        for (std::size_t i = 0; i < project.regions.size(); ++i)
            expect_equal(project.regions[i].base_from_frame, twice->regions[i].base_from_frame, "frame");

        auto volume = [](const std::vector<std::byte>& ply) {
            const auto m = mesh_from_ply(ply, "test");
            EXPECT_TRUE(m);
            double sum = 0;
            for (const auto& t : m->triangles)
                sum += m->vertices[static_cast<std::size_t>(t[0])].dot(
                           m->vertices[static_cast<std::size_t>(t[1])].cross(
                               m->vertices[static_cast<std::size_t>(t[2])])) /
                       6;
            return sum;
        };
        EXPECT_NEAR(volume(project.part.mesh_ply), 100 * 80 * 60 / 6.0, 1);
        EXPECT_NEAR(volume(once->part.mesh_ply), 100 * 80 * 60 / 6.0, 1);  // outside stays outside
    }
}

TEST(Mirror, RefusesWhatItCannotMirror) {
    Project project = make_fake_cell()->project;
    project.sensors[0].calibration_id.clear();
    auto refused = mirrored_project(project, kPlanes[0]);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().sentence().find("calibrat"), std::string::npos);

    for (const char* text : {"", "w", "1,2", "0,0,0", "1,2,3,4", "nan,0,1", "1;0;0"})
        EXPECT_FALSE(parse_mirror_plane(text)) << text;
    auto plane = parse_mirror_plane("0,-2,0", 3);
    ASSERT_TRUE(plane);
    EXPECT_EQ(plane->normal, Eigen::Vector3d(0, -1, 0));
    EXPECT_EQ(plane->offset_mm, 3);
}

}  // namespace
}  // namespace seamwright
