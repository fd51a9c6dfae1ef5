#include "devices/simulated/scene/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>

#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/mesh_file.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

TriangleMesh random_mesh(int triangles, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> u(-50, 50), s(-8, 8);
    TriangleMesh mesh;
    for (int i = 0; i < triangles; ++i) {
        const Vector3d p(u(rng), u(rng), u(rng));
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(p + Vector3d(s(rng), s(rng), s(rng)));
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

// Plane intersection and edge tests, independent of the tree's algorithm.
std::optional<double> hit_by_hand(const TriangleMesh& mesh, int t, const Vector3d& o, const Vector3d& d) {
    const auto& f = mesh.triangles[static_cast<std::size_t>(t)];
    Vector3d v[3];
    for (int k = 0; k < 3; ++k) v[k] = mesh.vertices[static_cast<std::size_t>(f[k])];
    const Vector3d n = (v[1] - v[0]).cross(v[2] - v[0]);
    const double along = n.dot(d);
    if (std::abs(along) < 1e-12) return std::nullopt;
    const double distance = n.dot(v[0] - o) / along;
    const Vector3d p = o + distance * d;
    for (int k = 0; k < 3; ++k) {
        if (n.dot((v[(k + 1) % 3] - v[k]).cross(p - v[k])) < 0) return std::nullopt;
    }
    return distance;
}

TEST(MeshTree, RaysAgreeWithBruteForce) {
    TriangleMesh mesh = random_mesh(700, 1);
    MeshTree tree(mesh);
    std::mt19937 rng(2);
    std::normal_distribution<double> n;
    int hits = 0;
    for (int round = 0; round < 2; ++round) {
        for (int i = 0; i < 800; ++i) {
            const Vector3d o = 60 * Vector3d(n(rng), n(rng), n(rng));
            Vector3d d = Vector3d(n(rng), n(rng), n(rng)).normalized();
            if (i % 10 == 0)
                d = Vector3d::Unit(i / 10 % 3);  // along an axis: a division by zero in the box test
            double best = 150;
            int which = -1;
            for (int t = 0; t < 700; ++t) {
                const auto h = hit_by_hand(mesh, t, o, d);
                if (h && *h > 1 && *h < best && t != 5) {
                    best = *h;
                    which = t;
                }
            }
            const auto found = tree.first_hit(o, d, 1, 150, 5);
            ASSERT_EQ(found ? found->triangle : -1, which);
            if (found) {
                EXPECT_NEAR(found->distance_mm, best, 1e-9);
                ++hits;
                EXPECT_TRUE(tree.blocked(o, o + d * (best + 2), 5, 1));
                if (best > 4) {
                    EXPECT_FALSE(tree.blocked(o, o + d * (best - 0.5), 5, 1));
                }
            }
        }
        for (auto& v : mesh.vertices) v += Vector3d(0.1 * v.y(), 3 * std::sin(v.x()), 5);  // bent
        tree.move_vertices(mesh.vertices);
    }
    EXPECT_GT(hits, 200);
}

TEST(MeshTree, CutsAgreeWithBruteForce) {
    const TriangleMesh mesh = random_mesh(500, 3);
    const MeshTree tree(mesh);
    std::mt19937 rng(4);
    std::normal_distribution<double> n;
    std::vector<CutSegment> segments;
    for (int i = 0; i < 50; ++i) {
        const Vector3d normal = Vector3d(n(rng), n(rng), n(rng)).normalized();
        const double offset = 10 * n(rng);
        tree.cut(normal, offset, Vector3d::Zero(), 1000, segments);
        std::size_t expected = 0;
        for (const auto& t : mesh.triangles) {
            int above = 0;
            for (int k = 0; k < 3; ++k)
                above += normal.dot(mesh.vertices[static_cast<std::size_t>(t[k])]) >= offset;
            expected += above == 1 || above == 2;
        }
        EXPECT_EQ(segments.size(), expected);
        for (const auto& s : segments) {
            EXPECT_NEAR(normal.dot(s.a), offset, 1e-9);
            EXPECT_NEAR(normal.dot(s.b), offset, 1e-9);
            EXPECT_NEAR(tree.normal(s.triangle).dot(s.b - s.a), 0, 1e-9) << "the cut lies in its triangle";
        }
    }
}

TEST(MeshTree, EmptyAndDegenerate) {
    MeshTree empty{TriangleMesh{}};
    std::vector<CutSegment> segments;
    empty.cut(Vector3d::UnitZ(), 0, Vector3d::Zero(), 10, segments);
    EXPECT_TRUE(segments.empty());
    EXPECT_FALSE(empty.first_hit(Vector3d::Zero(), Vector3d::UnitX(), 0, 100));
    EXPECT_FALSE(empty.blocked(Vector3d::Zero(), Vector3d::UnitX() * 10, -1, 0));
    TriangleMesh same;  // many copies of one triangle: no axis splits them
    same.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 2}};
    for (int i = 0; i < 100; ++i) same.triangles.emplace_back(0, 1, 2);
    same.triangles.emplace_back(3, 3, 3);
    const MeshTree tree(same);
    EXPECT_TRUE(tree.first_hit({0.2, 0.2, 5}, -Vector3d::UnitZ(), 0, 100));
    EXPECT_TRUE(tree.normal(100).isZero());
}

TEST(Door, MeshKeepsToTheFormula) {
    const MeshTree tree(door_mesh());
    const auto box = tree.mesh().box();
    EXPECT_GT(box.sizes().x(), 900);
    EXPECT_LT(box.sizes().x(), 1050);
    EXPECT_GT(box.sizes().y(), 700);
    EXPECT_LT(box.sizes().y(), 780);
    const double length = door_edge_length_mm();
    double worst_flange = 0, worst_land = 0, worst_fold = 0;
    double sharpest = 1e9, flattest = 0;
    for (int i = 0; i < 1500; ++i) {
        const double arc = length * (i + 0.37) / 1500;
        const DoorEdge e = door_edge(arc);
        EXPECT_NEAR(e.along.dot(e.up), 0, 1e-9);
        EXPECT_NEAR(e.along.cross(e.inboard).dot(e.up), 1, 1e-9) << "right-handed";
        const auto off_surface = [&](double t, double height) {
            const Vector3d p = e.point_mm + t * e.inboard + height * e.up;
            const auto hit = tree.first_hit(p + 20 * e.up, -e.up, 0, 40);
            return hit ? std::abs(hit->distance_mm - 20) : 99.0;
        };
        worst_flange = std::max(worst_flange, off_surface(4.3, 1.5));
        worst_land = std::max(worst_land, off_surface(14.1, 0.7));
        const double a = 0.3 + 0.9 * (i % 97) / 97;  // somewhere on the fold's upper outer quarter
        const auto side = tree.first_hit(e.point_mm + 1.15 * e.inboard + 0.35 * e.up +
                                             10 * (-std::cos(a) * e.inboard + std::sin(a) * e.up),
                                         std::cos(a) * e.inboard - std::sin(a) * e.up, 0, 20);
        worst_fold = std::max(worst_fold, side ? std::abs(side->distance_mm - (10 - 1.15)) : 99.0);
        const double turn = door_edge(arc - 5).along.cross(door_edge(arc + 5).along).norm();
        sharpest = std::min(sharpest, 10 / turn);
        flattest = std::max(flattest, 10 / turn);
    }
    EXPECT_LT(worst_flange, 0.01);
    EXPECT_LT(worst_land, 0.01);
    EXPECT_LT(worst_fold, 0.01);
    EXPECT_GT(sharpest, 70) << "the rim of 60 mm must not fold over in the corners";
    EXPECT_GT(flattest, 2000);
    for (const Vector3d& p : door_bead_path(50)) {
        const auto hit = tree.first_hit(p + Vector3d(0, 0, 30), -Vector3d::UnitZ(), 0, 60);
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->distance_mm, 30, 0.02);
    }
}

TEST(Door, EveryRegionObservesSixDegreesOfFreedom) {
    const auto spots = default_door_spots();
    ASSERT_EQ(spots.size(), 12U);
    const auto regions = default_door_regions();
    ASSERT_EQ(regions.size(), 4U);
    for (const auto& region : regions) {
        Matrix6 information = Matrix6::Zero();
        int known = 0, own = 0;
        for (const auto& id : region.spot_ids) {
            for (const auto& spot : spots) {
                if (spot.id != id) continue;
                ++known;
                const Pose& w = spot.workobject_from_sensor;
                own += door_side_of(w.translation()) == region.id;
                for (int axis : {0, 2}) {  // motion of the edge along the sensor's X and Z per unit of D
                    const Vector3d a = w.linear().col(axis), p = w * spot.edge_mm;
                    Vector6 row;
                    row << a, p.cross(a);
                    information += row * row.transpose();
                }
            }
        }
        EXPECT_EQ(known, static_cast<int>(region.spot_ids.size())) << region.id;
        EXPECT_GE(known, 5) << region.id;
        EXPECT_EQ(own, 3) << region.id;
        const Matrix6 covariance = information.inverse() * 0.05 * 0.05;
        for (int k = 3; k < 6; ++k) {
            EXPECT_LT(deg_from_rad(std::sqrt(covariance(k, k))), 0.05) << region.id << " axis " << k - 3;
        }
        // Uncertainty of a point in the middle of the region's own spots, not of the far origin.
        Vector3d middle = Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
            for (const auto& spot : spots) {
                if (spot.id == region.spot_ids[static_cast<std::size_t>(i)])
                    middle += spot.workobject_from_sensor.translation() / 3;
            }
        }
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(middle);
        const Eigen::Matrix3d at_middle = j * covariance * j.transpose();
        EXPECT_LT(std::sqrt(at_middle.diagonal().maxCoeff()), 0.1) << region.id;
    }
}

TEST(MeshFile, ReadsStlPlyAndObj) {
    const TemporaryFolder folder;
    const auto obj = folder.write("a.obj", "v 0 0 0\nv 100 0 0\nv 100 50 0\nv 0 50 0\nf 1 2 3 4\n");
    const auto ply =
        folder.write("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                     "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                     "0 0 0\n100 0 0\n0 50 0\n3 0 1 2\n");
    const auto stl = folder.write(
        "a.STL",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.05 0\n"
        "endloop\nendfacet\nendsolid a\n");
    const auto a = load_mesh(obj, "");
    ASSERT_TRUE(a) << a.error().sentence();
    EXPECT_EQ(a->triangles.size(), 2U);
    EXPECT_NEAR(a->box().sizes().x(), 100, 1e-6);
    const auto b = load_mesh(ply, "mm");
    ASSERT_TRUE(b) << b.error().sentence();
    EXPECT_EQ(b->triangles.size(), 1U);
    const auto suspected = load_mesh(stl, "");
    ASSERT_FALSE(suspected);
    EXPECT_THAT(suspected.error().sentence(), HasSubstr("metres suspected"));
    const auto metres = load_mesh(stl, "m");
    ASSERT_TRUE(metres) << metres.error().sentence();
    EXPECT_NEAR(metres->box().sizes().x(), 100, 1e-3);
    EXPECT_TRUE(load_mesh(stl, "mm"));
    EXPECT_FALSE(load_mesh(stl, "inch"));
}

// A closed box as a binary STL, triangle by triangle.
std::string binary_stl(const Vector3d& size, const std::string& head) {
    static constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    std::string bytes = head;
    bytes.resize(80, ' ');
    const auto put = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(std::uint32_t{12});
    for (const auto& q : kQuads)
        for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            for (int k = 0; k < 3; ++k) put(0.0F);
            for (const int c : t)
                for (int k = 0; k < 3; ++k) put(static_cast<float>((q[c] >> k & 1) != 0 ? size[k] : 0));
            put(std::uint16_t{0});
        }
    return bytes;
}

TEST(MeshFile, ABinaryStlThatEndsBeforeItsTrianglesIsRefused) {
    const TemporaryFolder folder;
    for (const std::string head : {"made by a test", "solid box"}) {
        const std::string whole = binary_stl({100, 60, 30}, head);
        const auto read = load_mesh(folder.write("whole.stl", whole), "mm");
        ASSERT_TRUE(read) << read.error().sentence();
        EXPECT_EQ(read->triangles.size(), 12U);
        // Between triangles, inside of one, by a byte; what follows the last one is nobody's.
        for (const std::size_t left : {84 + 50 * 7, 84 + 50 * 7 + 33, 84 + 50 * 12 - 1, 84, 83}) {
            const auto cut =
                load_mesh(folder.write("cut.stl", whole.substr(0, static_cast<std::size_t>(left))), "mm");
            ASSERT_FALSE(cut) << left;
            EXPECT_THAT(cut.error().sentence(), HasSubstr("is cut short")) << left;
        }
        EXPECT_TRUE(load_mesh(folder.write("more.stl", whole + "\n\n"), "mm"));
    }
}

TEST(MeshFile, ATextStlThatEndsBeforeItsEndIsCutShort) {
    const TemporaryFolder folder;
    const std::string solid =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 0 0\nvertex 0 50 0\n"
        "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 50 0\nvertex -9 0 0\n"
        "endloop\nendfacet\nendsolid a\n";
    EXPECT_TRUE(load_mesh(folder.write("one.stl", solid), "mm"));
    for (const std::string& whole : {solid, solid + solid})
        for (std::size_t off = 5; off < 150; off += 7) {
            const auto cut = load_mesh(folder.write("cut.stl", whole.substr(0, whole.size() - off)), "mm");
            ASSERT_FALSE(cut) << off;
            EXPECT_THAT(cut.error().sentence(), HasSubstr("is cut short")) << off;
        }
}

TEST(MeshFile, TrianglesThatTurnAgainstTheirNeighboursAreTurnedOutwards) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    const auto volume_of = [](const TriangleMesh& mesh) {
        double volume = 0;
        for (const auto& t : mesh.triangles) {
            const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
            volume += at(0).dot(at(1).cross(at(2))) / 6;
        }
        return volume;
    };
    const std::string whole = binary_stl({100, 60, 30}, "box");
    const auto flipped = [&](unsigned which) {
        std::string bytes = whole;
        for (std::size_t t = 0; t < 12; ++t)
            if ((which >> t & 1U) != 0)
                for (std::size_t k = 0; k < 12; ++k)
                    std::swap(bytes[84 + 50 * t + 12 + k], bytes[84 + 50 * t + 24 + k]);
        return load_mesh(folder.write("box.stl", bytes), "mm");
    };
    EXPECT_NEAR(volume_of(*flipped(0)), 180000, 1);
    for (int trial = 0; trial < 20; ++trial)
        EXPECT_NEAR(volume_of(*flipped(1 + random() % 4094)), 180000, 1) << trial;
    // Inwards all over is somebody's intention, or a hollow.
    EXPECT_NEAR(volume_of(*flipped(4095)), -180000, 1);
    // A sheet turns as most of it does.
    const auto sheet = load_mesh(
        folder.write("sheet.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 100 50 0\nf 1 3 2\nf 2 4 3\n"), "mm");
    ASSERT_TRUE(sheet);
    for (const auto& t : sheet->triangles) {
        const auto at = [&](int k) { return sheet->vertices[static_cast<std::size_t>(t[k])]; };
        EXPECT_LT((at(1) - at(0)).cross(at(2) - at(0)).z(), 0);
    }
}

TEST(MeshFile, HostileFilesEndInASentence) {
    const TemporaryFolder folder;
    EXPECT_FALSE(load_mesh(folder.path() / "none.stl", ""));
    EXPECT_FALSE(load_mesh(folder.path(), ""));
    EXPECT_FALSE(load_mesh(folder.write("a.step", "ISO-10303-21;"), ""));
    EXPECT_FALSE(load_mesh(folder.write("empty.stl", ""), ""));
    EXPECT_FALSE(load_mesh(folder.write("text.stl", "this is no mesh\n"), ""));
    EXPECT_FALSE(load_mesh(folder.write("text.ply", "this is no mesh\n"), ""));
    EXPECT_FALSE(load_mesh(folder.write("text.obj", "this is no mesh\n"), ""));
    EXPECT_FALSE(load_mesh(folder.write("flat.obj", "v 0 0 0\nv 10 0 0\nv 20 0 0\nf 1 2 3\n"), ""));
    // What a reader makes of "nan" is its own affair, but no such vertex may come through.
    const auto odd = load_mesh(folder.write("nan.obj", "v nan 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 3\n"), "");
    if (odd) {
        for (const auto& v : odd->vertices) EXPECT_TRUE(v.allFinite());
    }
    EXPECT_FALSE(load_mesh(folder.write("far.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 9\n"), ""));
    const std::string corners = "v 0 0 0\nv 100 0 0\nv 0 100 0\n";
    EXPECT_FALSE(load_mesh(folder.write("back.obj", corners + "f 1 2 -9\n"), ""));
    EXPECT_FALSE(load_mesh(folder.write("huge.obj", corners + "f 1 2 99999999999999999999\n"), ""));
    EXPECT_TRUE(
        load_mesh(folder.write("parts.obj", corners + "f 1/1/1 2//2 3/7\n"), ""));  // of textures nobody asks
    const auto ply = [&](const std::string& vertices, const std::string& faces, const std::string& face) {
        const std::string text =
            "ply\nformat ascii 1.0\nelement vertex " + vertices +
            "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
            "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n100 0 0\n0 100 0\n" + face + "\n";
        const auto bytes = std::as_bytes(std::span(text));
        const auto of_bytes = mesh_from_ply(bytes, "part"),
                   of_file = load_mesh(folder.write("a.ply", text), "mm");
        EXPECT_EQ(of_bytes.has_value(), of_file.has_value());
        return of_file ? std::string() : of_file.error().sentence();
    };
    EXPECT_EQ(ply("3", "1", "3 0 1 2"), "");
    EXPECT_THAT(ply("3", "1", "3 0 1 99999999"), HasSubstr("names a vertex that it does not hold"));
    EXPECT_THAT(ply("3", "1", "3 0 1 -1"), HasSubstr("names a vertex that it does not hold"));
    EXPECT_THAT(ply("-3", "1", "3 0 1 2"), HasSubstr("promises -3 elements"));
    EXPECT_THAT(ply("4000000000", "1", "3 0 1 2"), HasSubstr("promises 4000000000 elements"));
    EXPECT_NE(ply("3", "90", "3 0 1 2"), "");
}

}  // namespace
}  // namespace seamwright
