#include "devices/drawing/drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "devices/drawing/door_step.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/mesh_file.h"
#include "tests/devices/drawing/bodies.h"

namespace seamwright {
namespace {

Expected<Drawing> read(const std::string& text, const std::string& name = "part.step",
                       const DrawingOptions& options = {}) {
    return read_drawing(std::as_bytes(std::span(text.data(), text.size())), name, options);
}

double mesh_volume(const TriangleMesh& mesh) {
    double volume = 0;
    for (const Eigen::Vector3i& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
        volume += at(0).dot(at(1).cross(at(2))) / 6;
    }
    return volume;
}

double length_of_edges(const Drawing& d) {
    double sum = 0;
    for (const DrawingEdge& e : d.edges) sum += e.length_mm;
    return sum;
}

TEST(Drawing, TheEdgesOfABoxAreItsTwelveWithTheirLengthsAndSquareFolds) {
    const auto d = read(box_step(100, 60, 30, 0));
    ASSERT_TRUE(d) << d.error().sentence();
    EXPECT_EQ(d->unit, "millimetre");
    ASSERT_EQ(d->edges.size(), 12u);
    ASSERT_EQ(d->faces.size(), 6u);
    EXPECT_NEAR(length_of_edges(*d), 4 * (100 + 60 + 30), 1e-9);
    EXPECT_NEAR(d->volume_mm3, 100 * 60 * 30, 1e-6);
    EXPECT_NEAR(mesh_volume(d->mesh), 100 * 60 * 30, 1e-6) << "triangles face outwards";
    EXPECT_NEAR((d->box().sizes() - Eigen::Vector3d(100, 60, 30)).norm(), 0, 1e-9);
    for (const DrawingEdge& e : d->edges) {
        EXPECT_EQ(e.kind, "line");
        EXPECT_NEAR(e.fold_deg, 90, 1e-9) << e.id;
        EXPECT_TRUE(e.convex) << e.id;
        EXPECT_FALSE(e.closed);
        for (const DrawingPoint& p : e.points) {
            EXPECT_TRUE(std::isinf(p.radius_mm));
            EXPECT_NEAR(p.tangent.norm(), 1, 1e-9);
            EXPECT_NEAR(p.normal_left.dot(p.tangent), 0, 1e-9);
            // Left of the tangent, seen from outside: a step into the face stays on the box.
            for (const Eigen::Vector3d& into : {Eigen::Vector3d(p.normal_left.cross(p.tangent)),
                                                Eigen::Vector3d(p.tangent.cross(p.normal_right))}) {
                const Eigen::Vector3d q = p.point_mm + into;
                const bool inside =
                    (q.array() > -1e-9).all() && (q.array() < Eigen::Array3d(100, 60, 30) + 1e-9).all();
                EXPECT_TRUE(inside || p.arc_mm < 1 || p.arc_mm > e.length_mm - 1);
            }
            EXPECT_GT(p.normal_left.dot(p.point_mm - Eigen::Vector3d(50, 30, 15)), 0)
                << "out of the material";
        }
    }
    double area = 0;
    for (const DrawingFace& f : d->faces) area += f.area_mm2;
    EXPECT_NEAR(area, 2 * (6000 + 3000 + 1800), 1e-6);
}

TEST(Drawing, ACylinderHasTwoRoundEdgesAndNoSeam) {
    const auto d = read(cylinder_step(20, 50));
    ASSERT_TRUE(d) << d.error().sentence();
    ASSERT_EQ(d->edges.size(), 2u);
    EXPECT_NEAR(d->volume_mm3, kPi * 400 * 50, 1e-3);
    for (const DrawingEdge& e : d->edges) {
        EXPECT_EQ(e.kind, "circle");
        EXPECT_TRUE(e.closed);
        EXPECT_NEAR(e.length_mm, 2 * kPi * 20, 1e-6);
        EXPECT_NEAR(e.fold_deg, 90, 1e-6);
        for (std::size_t i = 0; i + 1 < e.points.size(); ++i) {
            const DrawingPoint &a = e.points[i], &b = e.points[i + 1];
            EXPECT_NEAR(a.radius_mm, 20, 1e-9);
            EXPECT_NEAR(std::hypot(a.point_mm.x(), a.point_mm.y()), 20, 1e-9);
            const Eigen::Vector3d middle = (a.point_mm + b.point_mm) / 2;
            EXPECT_LT(20 - std::hypot(middle.x(), middle.y()), 0.05 + 1e-9) << "stated chord error";
        }
    }
    bool round = false;
    for (const DrawingFace& f : d->faces) round = round || (f.kind == "cylinder" && f.radius_mm == 20);
    EXPECT_TRUE(round);
}

TEST(Drawing, TheTessellationStaysWithinTheStatedChordError) {
    DrawingOptions options;
    for (const double chord : {0.5, 0.05, 0.005}) {
        options.chord_mm = chord;
        const auto d = read(cylinder_step(80, 10), "c.stp", options);
        ASSERT_TRUE(d);
        double worst = 0;
        for (const Eigen::Vector3i& t : d->mesh.triangles)
            for (int k = 0; k < 3; ++k) {
                const Eigen::Vector3d m = (d->mesh.vertices[static_cast<std::size_t>(t[k])] +
                                           d->mesh.vertices[static_cast<std::size_t>(t[(k + 1) % 3])]) /
                                          2;
                const double r = std::hypot(m.x(), m.y());
                const bool on_mantle = std::abs(d->normals[static_cast<std::size_t>(t[0])].z()) < 0.5;
                if (on_mantle) worst = std::max(worst, 80 - r);
            }
        EXPECT_LE(worst, chord * 1.0001);
    }
}

TEST(Drawing, ARoundedBoxGoesOnSmoothlyOverItsRoundings) {
    const auto d = read(box_step(100, 60, 30, 5));
    ASSERT_TRUE(d) << d.error().sentence();
    int rounds = 0;
    for (const DrawingFace& f : d->faces)
        if (f.kind == "cylinder") {
            ++rounds;
            EXPECT_NEAR(f.radius_mm, 5, 1e-9);
        }
    EXPECT_EQ(rounds, 12);
    for (const DrawingEdge& e : d->edges) EXPECT_LT(e.fold_deg, 1e-3) << e.id;
    // 12 quarter cylinders and a whole sphere at the corners.
    const double volume = 90 * 50 * 20 + 2 * 5 * (90 * 50 + 50 * 20 + 90 * 20) + kPi * 25 * (90 + 50 + 20) +
                          4.0 / 3 * kPi * 125;
    EXPECT_NEAR(d->volume_mm3, volume, 1e-6 * volume);
}

TEST(Drawing, InchAndMetreAreReadAsMillimetre) {
    for (const auto& [unit, said] : {std::pair{"INCH", "inch"}, {"M", "metre"}, {"MM", "millimetre"}}) {
        const auto d = read(box_step(100, 60, 30, 0, unit));
        ASSERT_TRUE(d) << d.error().sentence();
        EXPECT_EQ(d->unit, said);
        EXPECT_NEAR((d->box().sizes() - Eigen::Vector3d(100, 60, 30)).norm(), 0, 1e-6) << unit;
        EXPECT_NEAR(length_of_edges(*d), 760, 1e-6);
    }
    for (const char* unit : {"MM", "IN"}) {
        const auto d = read(box_iges(100, 60, 30, unit), "box.igs");
        ASSERT_TRUE(d) << d.error().sentence();
        EXPECT_EQ(d->form, "iges");
        EXPECT_NEAR((d->box().sizes() - Eigen::Vector3d(100, 60, 30)).norm(), 0, 1e-4) << unit;
        EXPECT_FALSE(d->unit.empty());
    }
}

TEST(Drawing, IdsAreTheSameEveryTimeAndRiseInTheFile) {
    const std::string text = box_step(100, 60, 30, 5);
    const auto a = read(text), b = read(text);
    ASSERT_TRUE(a && b);
    ASSERT_EQ(a->edges.size(), b->edges.size());
    for (std::size_t i = 0; i < a->edges.size(); ++i) {
        EXPECT_EQ(a->edges[i].id, b->edges[i].id);
        EXPECT_EQ(a->edges[i].points.front().point_mm, b->edges[i].points.front().point_mm);
    }
}

TEST(Drawing, AMeshGivesItsSharpEdgesAsChains) {
    const auto exact = read(box_step(100, 60, 30, 0));
    ASSERT_TRUE(exact);
    const std::vector<std::byte> ply = ply_bytes(exact->mesh);
    const auto d = read_drawing(ply, "box.ply");
    ASSERT_TRUE(d) << d.error().sentence();
    ASSERT_EQ(d->edges.size(), 12u) << "one a side, not one a triangle";
    for (const DrawingEdge& e : d->edges) {
        EXPECT_NEAR(e.fold_deg, 90, 1e-6);
        EXPECT_TRUE(e.convex);
    }
    EXPECT_NEAR(length_of_edges(*d), 760, 1e-6);

    const auto round = read(cylinder_step(20, 50));
    const auto from_mesh = read_drawing(ply_bytes(round->mesh), "c.ply");
    ASSERT_TRUE(from_mesh);
    ASSERT_EQ(from_mesh->edges.size(), 2u);
    for (const DrawingEdge& e : from_mesh->edges) {
        EXPECT_TRUE(e.closed);
        EXPECT_NEAR(e.length_mm, 2 * kPi * 20, 0.5);
        for (const DrawingPoint& p : e.points)
            EXPECT_TRUE(std::isinf(p.radius_mm) || std::abs(p.radius_mm - 20) < 0.05);
    }
}

TEST(Drawing, TrianglesTurnedTheWrongWayMakeNoEdges) {
    const auto exact = read(box_step(100, 60, 30, 0));
    ASSERT_TRUE(exact);
    TriangleMesh mixed = exact->mesh;
    for (std::size_t t = 0; t < mixed.triangles.size(); t += 3)
        std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
    const auto d = read_drawing(ply_bytes(mixed), "mixed.ply");
    ASSERT_TRUE(d) << d.error().sentence();
    EXPECT_EQ(d->edges.size(), 12u);
    for (const DrawingEdge& e : d->edges) {
        EXPECT_NEAR(e.fold_deg, 90, 1e-6);
        EXPECT_TRUE(e.convex);
    }
}

TEST(Drawing, ChainsFollowTangentEdgesRoundACorner) {
    const auto d = read(box_step(100, 60, 30, 5));
    ASSERT_TRUE(d);
    // The border of a face of a rounded box: four lines that end at corners of their own spheres; no tangent goes on.
    const DrawingEdge* line = nullptr;
    for (const DrawingEdge& e : d->edges)
        if (e.kind == "line" && e.length_mm > 80) line = &e;
    ASSERT_TRUE(line);
    const auto chain = tangent_chain(*d, line->id);
    ASSERT_TRUE(chain);
    EXPECT_GE(chain->length_mm(), line->length_mm);
    const auto [from, to] = chain->arcs_of(*d, line->id);
    EXPECT_NEAR(to - from, line->length_mm, 1e-9);
    EXPECT_FALSE(tangent_chain(*d, "e9999"));
}

TEST(DoorDrawing, LiesWithinAHundredthOfTheFormulaAndChainsRoundTheDoor) {
    const auto text = door_step();
    ASSERT_TRUE(text) << text.error().sentence();
    DrawingOptions options;
    options.chord_mm = 0.05;
    const auto d = read(*text, "door.step", options);
    ASSERT_TRUE(d) << d.error().sentence();
    EXPECT_EQ(d->faces.size(), 32u);
    // Against the formula: every vertex near a section of the rim, in its own plane.
    const auto section = door_rim_section();
    const MeshTree tree(d->mesh);
    double worst = 0;
    int seen = 0;
    for (int i = 0; i < 400; ++i) {
        const DoorEdge e = door_edge(door_edge_length_mm() * (i + 0.37) / 400);
        for (const double t : {2.0, 4.0, 7.5, 11.0, 20.0, 26.0, 35.0, 55.0}) {
            double height = 0;
            for (std::size_t k = 15; k + 1 < section.size(); ++k)
                if (section[k].inboard_mm <= t && section[k + 1].inboard_mm >= t) {
                    const double s =
                        (t - section[k].inboard_mm) / (section[k + 1].inboard_mm - section[k].inboard_mm);
                    height = section[k].height_mm + s * (section[k + 1].height_mm - section[k].height_mm);
                }
            const Eigen::Vector3d p = e.point_mm + t * e.inboard + height * e.up;
            const auto hit = tree.first_hit(p + 20 * e.up, -e.up, 0, 100);
            if (!hit) continue;
            ++seen;
            // The section's polygon cuts its own roundings and the ramp's curve by up to 0.03 mm.
            const double off = std::abs(hit->distance_mm - 20);
            if (t < 26.5) worst = std::max(worst, off);
            EXPECT_LT(off, 0.2) << t << " station " << i;
        }
    }
    EXPECT_GT(seen, 3000);
    EXPECT_LT(worst, 0.1);
    // The flange's end runs round the whole door as one closed chain of four edges.
    double longest = 0;
    std::string id;
    for (const DrawingEdge& e : d->edges)
        if (e.fold_deg > 60 && !e.convex && e.length_mm > longest) longest = e.length_mm, id = e.id;
    ASSERT_FALSE(id.empty());
    const auto chain = tangent_chain(*d, id);
    ASSERT_TRUE(chain);
    EXPECT_TRUE(chain->closed);
    EXPECT_EQ(chain->parts.size(), 4u);
    // Its samples are the curve itself: the foot of the step, as the formula has it.
    for (int i = 0; i < 200; ++i) {
        const DoorEdge e = door_edge(door_edge_length_mm() * (i + 0.37) / 200);
        const Eigen::Vector3d foot =
            e.point_mm + section[28].inboard_mm * e.inboard + section[28].height_mm * e.up;
        const DrawingPoint* nearest = &chain->points.front();
        for (const DrawingPoint& p : chain->points)
            if ((p.point_mm - foot).norm() < (nearest->point_mm - foot).norm()) nearest = &p;
        EXPECT_LT(nearest->tangent.cross(foot - nearest->point_mm).norm(), 0.01) << i;
    }
    EXPECT_NEAR(chain->length_mm(), door_edge_length_mm() - 2 * kPi * 9, 15);
}

}  // namespace
}  // namespace seamwright
