#pragma once
// A drawing of the part: what STEP and IGES say exactly, or what can be found in a mesh (STL, PLY, OBJ).
//
// Everything in millimetres, in the drawing's own frame, whatever the file's unit; `unit` says what that was. Faces are
// tessellated so that no triangle lies farther than chord_mm from its surface; edges are sampled so that the straight line
// between two samples does not either, and at least every step_mm. A mesh has no edges of its own: where two of its
// triangles meet under sharp_deg or more, their common side is a piece of an edge, and pieces that go on straight
// (within bend_deg) are one edge.
//
// Ids are "e12" and "f3": the number in the order in which the file is walked, the same every time the same bytes are read.
// Numbers may be missing: seams of closed surfaces and edges that have shrunk to a point are no edges of the part.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/error.h"
#include "devices/simulated/scene/mesh.h"

namespace seamwright {

struct DrawingFace {
    std::string id;    // "f3"
    std::string kind;  // "plane", "cylinder", "cone", "sphere", "torus", "spline", "other"; "mesh" of a mesh
    double area_mm2 = 0;
    double radius_mm = 0;             // of a cylinder, a sphere or a torus' tube; 0: it has none
    int triangle = 0, triangles = 0;  // its share of Drawing::mesh
};

// A sample of an edge. The left face lies on the left of the tangent seen from outside: normal_left x tangent points
// into it. At a free border both normals are those of the only face.
struct DrawingPoint {
    Eigen::Vector3d point_mm, tangent, normal_left, normal_right;  // directions of unit length
    double radius_mm =
        std::numeric_limits<double>::infinity();  // of the edge itself, infinite where it is straight
    double arc_mm = 0;                            // from the first sample
};

struct DrawingEdge {
    std::string id;           // "e12"
    std::string kind;         // "line", "circle", "ellipse", "spline", "other"; "chain" of a mesh
    std::string left, right;  // ids of the faces; right is empty at a free border
    double length_mm = 0;
    bool closed = false;  // the last sample is the first one again
    double fold_deg = 0;  // between the two normals, at the middle: 0 where the faces go on smoothly
    bool convex = false;  // the material's outside lies about the edge; of a fold alone
    std::vector<DrawingPoint> points;  // two or more, arc ascending
};

struct Drawing {
    std::string source;   // where it came from, for people
    std::string form;     // "step", "iges", "stl", "ply", "obj"
    std::string unit;     // of the file: "millimetre", "inch", "metre", ...; what a mesh was taken for
    double chord_mm = 0;  // as asked for; of a mesh 0: it is as it is
    TriangleMesh mesh;
    std::vector<Eigen::Vector3d> normals;  // a vertex of the mesh each, out of the material, unit length
    std::vector<DrawingFace> faces;
    std::vector<DrawingEdge> edges;
    double volume_mm3 = 0;  // of its closed bodies; 0: there are none, or it is a mesh
    Eigen::AlignedBox3d box() const { return mesh.box(); }
};

struct DrawingOptions {
    double chord_mm = 0.05;                // 0.001 to 10
    double step_mm = 2;                    // 0.05 to 100
    std::string unit;                      // of a mesh, as load_mesh() takes it
    double sharp_deg = 20, bend_deg = 40;  // of a mesh
    // For how long STEP and IGES may be read without any progress before they count as damaged: OpenCASCADE goes round in
    // circles over some files. 0: 30 s and 10 s a megabyte.
    double patience_s = 0;
    std::stop_token cancel;
    // 0 to 1 and what is being done; called on the reading thread.
    std::function<void(double share, const Text& what)> progress;
};

inline constexpr std::size_t kLargestDrawing = std::size_t{1} << 30;  // bytes of a file

// By the name's ending: .step .stp .iges .igs .stl .ply .obj. Error (file): missing, another ending, larger than
// kLargestDrawing, not what its ending says, cut off, without end, of a schema that holds no shapes, nothing in it, not finite, beyond
// 100 m; (usage): cancelled, options out of range. One drawing is read at a time; a second caller waits.
Expected<Drawing> read_drawing(const std::filesystem::path& path, const DrawingOptions& options = {});
// The same from the bytes that a project keeps; `name` is that of the file they came from.
Expected<Drawing> read_drawing(std::span<const std::byte> bytes, const std::string& name,
                               const DrawingOptions& options = {});

const DrawingEdge* find_edge(const Drawing& drawing, const std::string& id);

// The sharp edges of a mesh, as above. Triangles that no vertex index joins are joined by place (within 1e-6 of the box).
std::vector<DrawingEdge> sharp_edges(const TriangleMesh& mesh, double sharp_deg, double bend_deg,
                                     double step_mm);

// Edges that follow one another without a bend of more than bend_deg, as one curve.
struct EdgeChain {
    struct Part {
        std::string edge;
        bool reversed = false;
    };
    std::vector<Part> parts;  // in order
    std::vector<DrawingPoint>
        points;  // arc from the chain's beginning; left and right follow the chain's direction
    bool closed = false;
    double length_mm() const { return points.empty() ? 0 : points.back().arc_mm; }
    // Between the samples; arcs beyond the ends are the ends, or go round where it is closed.
    DrawingPoint at(double arc_mm) const;
    // Where an edge of the chain begins and ends, as it runs in the chain. Precondition: it is one of its parts.
    std::pair<double, double> arcs_of(const Drawing& drawing, const std::string& edge) const;
};
// The longest that runs through the edge `id`: on both sides the one edge that goes on straight, none where several do or
// where that edge is of another kind of fold (sharp edges go on in sharp ones, smooth in smooth). Error (input): no such edge.
Expected<EdgeChain> tangent_chain(const Drawing& drawing, const std::string& id, double bend_deg = 8);

}  // namespace seamwright
