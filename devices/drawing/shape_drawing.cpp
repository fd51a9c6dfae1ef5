#include "devices/drawing/shape_drawing.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/pose.h"
#include "devices/drawing/occt_progress.h"

namespace seamwright::drawing {
namespace {

constexpr double kFarthestMm = 1e5;   // a coordinate beyond it is a wrong unit or no drawing
constexpr int kMostSamples = 20000;   // of one edge
constexpr int kPieces = 128;          // of a curve whose length is looked for
constexpr double kShortestMm = 1e-6;  // an edge that has shrunk to a point
constexpr double kFacetRad = 0.35;    // between two facets of a round face

Eigen::Vector3d vector_of(const gp_XYZ& v) {
    return {v.X(), v.Y(), v.Z()};
}

const char* surface_kind(GeomAbs_SurfaceType type) {
    switch (type) {
        case GeomAbs_Plane:
            return "plane";
        case GeomAbs_Cylinder:
            return "cylinder";
        case GeomAbs_Cone:
            return "cone";
        case GeomAbs_Sphere:
            return "sphere";
        case GeomAbs_Torus:
            return "torus";
        case GeomAbs_BezierSurface:
        case GeomAbs_BSplineSurface:
            return "spline";
        default:
            return "other";
    }
}

const char* curve_kind(GeomAbs_CurveType type) {
    switch (type) {
        case GeomAbs_Line:
            return "line";
        case GeomAbs_Circle:
            return "circle";
        case GeomAbs_Ellipse:
            return "ellipse";
        case GeomAbs_BezierCurve:
        case GeomAbs_BSplineCurve:
            return "spline";
        default:
            return "other";
    }
}

double surface_radius(const BRepAdaptor_Surface& surface) {
    switch (surface.GetType()) {
        case GeomAbs_Cylinder:
            return surface.Cylinder().Radius();
        case GeomAbs_Sphere:
            return surface.Sphere().Radius();
        case GeomAbs_Torus:
            return surface.Torus().MinorRadius();
        default:
            return 0;
    }
}

// Out of the material; zero where the surface has none (the tip of a cone).
Eigen::Vector3d normal_at(const BRepAdaptor_Surface& surface, bool reversed, double u, double v) {
    BRepLProp_SLProps properties(surface, u, v, 1, 1e-9);
    if (!properties.IsNormalDefined()) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d n = vector_of(properties.Normal().XYZ());
    return reversed ? Eigen::Vector3d(-n) : n;
}

// Facets' normals where the surface gave none.
void complete_normals(Drawing& drawing, std::size_t first_vertex, std::size_t first_triangle) {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    std::vector<std::size_t> missing;
    for (std::size_t i = first_vertex; i < drawing.normals.size(); ++i)
        if (!(drawing.normals[i].norm() > 0.5)) missing.push_back(i);
    if (missing.empty()) return;
    std::vector<Eigen::Vector3d> sum(drawing.normals.size() - first_vertex, Eigen::Vector3d::Zero());
    for (std::size_t k = first_triangle; k < drawing.mesh.triangles.size(); ++k) {
        const Eigen::Vector3i& t = drawing.mesh.triangles[k];
        const auto& v = drawing.mesh.vertices;
        const Eigen::Vector3d n = (v[at(t[1])] - v[at(t[0])]).cross(v[at(t[2])] - v[at(t[0])]);
        for (int c = 0; c < 3; ++c) sum[at(t[c]) - first_vertex] += n;
    }
    for (const std::size_t i : missing) {
        const Eigen::Vector3d& n = sum[i - first_vertex];
        drawing.normals[i] = n.norm() > 0 ? Eigen::Vector3d(n.normalized()) : Eigen::Vector3d::UnitZ();
    }
}

void add_face(const TopoDS_Face& face, int number, Drawing& drawing) {
    const BRepAdaptor_Surface surface(face, Standard_True);
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    DrawingFace out;
    out.id = "f" + std::to_string(number);
    out.kind = surface_kind(surface.GetType());
    out.radius_mm = surface_radius(surface);
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(face, properties);
    out.area_mm2 = std::abs(properties.Mass());
    out.triangle = static_cast<int>(drawing.mesh.triangles.size());
    TopLoc_Location place;
    const Handle(Poly_Triangulation) net = BRep_Tool::Triangulation(face, place);
    if (!net.IsNull()) {
        const std::size_t first = drawing.mesh.vertices.size(),
                          first_triangle = drawing.mesh.triangles.size();
        for (int i = 1; i <= net->NbNodes(); ++i) {
            drawing.mesh.vertices.push_back(
                vector_of(net->Node(i).Transformed(place.Transformation()).XYZ()));
            Eigen::Vector3d normal = Eigen::Vector3d::Zero();
            if (net->HasUVNodes()) {
                const gp_Pnt2d uv = net->UVNode(i);
                normal = normal_at(surface, reversed, uv.X(), uv.Y());
            }
            drawing.normals.push_back(normal);
        }
        for (int i = 1; i <= net->NbTriangles(); ++i) {
            int a = 0, b = 0, c = 0;
            net->Triangle(i).Get(a, b, c);
            if (reversed) std::swap(b, c);
            const int base = static_cast<int>(first) - 1;
            drawing.mesh.triangles.emplace_back(base + a, base + b, base + c);
        }
        complete_normals(drawing, first, first_triangle);
    }
    out.triangles = static_cast<int>(drawing.mesh.triangles.size()) - out.triangle;
    drawing.faces.push_back(std::move(out));
}

// A face as one of its edges sees it.
struct EdgeSide {
    TopoDS_Face face;
    bool reversed = false;
    bool forward = true;  // the edge runs with the face on its left
    BRepAdaptor_Surface surface;
    Handle(Geom2d_Curve) on_surface;
    Eigen::Vector3d normal(double t) const {
        if (on_surface.IsNull()) return Eigen::Vector3d::Zero();
        const gp_Pnt2d uv = on_surface->Value(t);
        return normal_at(surface, reversed, uv.X(), uv.Y());
    }
};

EdgeSide side_of(const TopoDS_Edge& edge, const TopoDS_Face& face) {
    EdgeSide side;
    side.face = face;
    side.reversed = face.Orientation() == TopAbs_REVERSED;
    side.surface.Initialize(face, Standard_False);
    double first = 0, last = 0;
    side.on_surface = BRep_Tool::CurveOnSurface(edge, face, first, last);
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
        if (e.Current().IsSame(edge)) {
            side.forward = e.Current().Orientation() != TopAbs_REVERSED;
            break;
        }
    return side;
}

// Smallest radius of the curve, looked for at a fixed number of places.
double smallest_radius(const BRepAdaptor_Curve& curve) {
    double smallest = std::numeric_limits<double>::infinity();
    if (curve.GetType() == GeomAbs_Line) return smallest;
    constexpr int kPlaces = 64;
    const double first = curve.FirstParameter(), step = (curve.LastParameter() - first) / kPlaces;
    for (int i = 0; i <= kPlaces; ++i) {
        gp_Pnt p;
        gp_Vec d1, d2;
        curve.D2(first + i * step, p, d1, d2);
        const double bend = d1.Crossed(d2).Magnitude(), speed = d1.Magnitude();
        if (bend > 0) smallest = std::min(smallest, speed * speed * speed / bend);
    }
    return smallest;
}

double speed_at(const BRepAdaptor_Curve& curve, double t) {
    gp_Pnt p;
    gp_Vec d1;
    curve.D1(t, p, d1);
    return d1.Magnitude();
}

// Arc length between two parameters, Gauss-Legendre of five points.
double arc_between(const BRepAdaptor_Curve& curve, double a, double b) {
    constexpr std::array<double, 3> place{0, 0.538469310105683091, 0.906179845938663993};
    constexpr std::array<double, 3> weight{0.568888888888888889, 0.478628670499366468, 0.236926885056189088};
    const double middle = (a + b) / 2, half = (b - a) / 2;
    double sum = weight[0] * speed_at(curve, middle);
    for (std::size_t k = 1; k < 3; ++k)
        sum += weight[k] *
               (speed_at(curve, middle - half * place[k]) + speed_at(curve, middle + half * place[k]));
    return half * sum;
}

// Arc lengths at evenly spaced parameters.
struct ArcTable {
    std::vector<double> parameter, arc;
    ArcTable(const BRepAdaptor_Curve& curve, int pieces) {
        const double first = curve.FirstParameter(), last = curve.LastParameter();
        parameter.push_back(first);
        arc.push_back(0);
        for (int i = 1; i <= pieces; ++i) {
            parameter.push_back(i == pieces ? last : first + (last - first) * i / pieces);
            arc.push_back(arc.back() + arc_between(curve, parameter[parameter.size() - 2], parameter.back()));
        }
    }
    double parameter_at(double s) const {
        const auto next = std::upper_bound(arc.begin() + 1, arc.end() - 1, s);
        const std::size_t i = static_cast<std::size_t>(next - arc.begin());
        const double length = arc[i] - arc[i - 1];
        const double share = length > 0 ? std::clamp((s - arc[i - 1]) / length, 0.0, 1.0) : 0;
        return parameter[i - 1] + share * (parameter[i] - parameter[i - 1]);
    }
};

DrawingPoint sample(const BRepAdaptor_Curve& curve, double t, const EdgeSide& left, const EdgeSide& right) {
    gp_Pnt p;
    gp_Vec d1, d2;
    curve.D2(t, p, d1, d2);
    DrawingPoint out;
    out.point_mm = vector_of(p.XYZ());
    const double speed = d1.Magnitude(), bend = d1.Crossed(d2).Magnitude();
    out.tangent = speed > 0 ? Eigen::Vector3d(vector_of(d1.XYZ()) / speed) : Eigen::Vector3d::Zero();
    if (bend > 1e-12 * speed * speed * speed) out.radius_mm = speed * speed * speed / bend;
    out.normal_left = left.normal(t);
    out.normal_right = right.normal(t);
    return out;
}

// Where tangent or normal are undefined at one sample (a cusp, a cone's tip) the neighbour's stands for it.
bool complete(std::vector<DrawingPoint>& points) {
    const auto mend = [&](auto member) {
        Eigen::Vector3d last = Eigen::Vector3d::Zero();
        for (const DrawingPoint& p : points)
            if ((p.*member).norm() > 0.5) {
                last = p.*member;
                break;
            }
        if (!(last.norm() > 0.5)) return false;
        for (DrawingPoint& p : points)
            if ((p.*member).norm() > 0.5)
                last = p.*member;
            else
                p.*member = last;
        return true;
    };
    return mend(&DrawingPoint::tangent) && mend(&DrawingPoint::normal_left) &&
           mend(&DrawingPoint::normal_right);
}

void judge_fold(DrawingEdge& edge) {
    const DrawingPoint& middle = edge.points[edge.points.size() / 2];
    const double along = middle.normal_left.cross(middle.normal_right).norm();
    edge.fold_deg = deg_from_rad(std::atan2(along, middle.normal_left.dot(middle.normal_right)));
    const Eigen::Vector3d into_left = middle.normal_left.cross(middle.tangent);
    edge.convex = into_left.dot(middle.normal_right) < 0;
}

void add_edge(const TopoDS_Edge& edge, int number, const TopTools_ListOfShape& neighbours,
              const TopTools_IndexedMapOfShape& faces, const DrawingOptions& options, Drawing& drawing) {
    if (BRep_Tool::Degenerated(edge) || neighbours.IsEmpty()) return;
    TopTools_IndexedMapOfShape around;
    for (const TopoDS_Shape& face : neighbours) around.Add(face);
    if (around.Extent() == 1 && neighbours.Extent() > 1) return;  // the seam of a closed face
    if (around.Extent() == 1 && BRep_Tool::IsClosed(edge, TopoDS::Face(around(1)))) return;
    const BRepAdaptor_Curve curve(edge);
    if (Precision::IsInfinite(curve.FirstParameter()) || Precision::IsInfinite(curve.LastParameter())) return;
    const double length = ArcTable(curve, kPieces).arc.back();
    if (!std::isfinite(length) || length < kShortestMm || length > kFarthestMm) return;

    EdgeSide left = side_of(edge, TopoDS::Face(around(1)));
    EdgeSide right = around.Extent() > 1 ? side_of(edge, TopoDS::Face(around(2))) : left;
    const bool two = around.Extent() > 1;
    if (two && !left.forward && right.forward) std::swap(left, right);

    DrawingEdge out;
    out.id = "e" + std::to_string(number);
    out.kind = curve_kind(curve.GetType());
    out.left = "f" + std::to_string(faces.FindIndex(left.face));
    if (two) out.right = "f" + std::to_string(faces.FindIndex(right.face));
    const double step = std::min(options.step_mm, std::sqrt(8 * smallest_radius(curve) * options.chord_mm));
    const int n = std::clamp(static_cast<int>(std::ceil(length / step)) + 1, 2, kMostSamples);
    const ArcTable table(curve, curve.GetType() == GeomAbs_Line ? 1 : std::max(kPieces, 2 * n));
    double before = curve.FirstParameter(), arc = 0;
    for (int i = 0; i < n; ++i) {
        const double t =
            i + 1 == n ? curve.LastParameter() : table.parameter_at(table.arc.back() * i / (n - 1));
        if (i > 0) arc += arc_between(curve, before, t);
        before = t;
        out.points.push_back(sample(curve, t, left, right));
        out.points.back().arc_mm = arc;
        if (!out.points.back().point_mm.allFinite()) return;
    }
    out.length_mm = arc;
    if (!complete(out.points)) return;
    out.closed = (out.points.front().point_mm - out.points.back().point_mm).norm() < 1e-4;
    // A free border with its only face on the right runs the other way.
    if (!two && !left.forward) {
        std::reverse(out.points.begin(), out.points.end());
        for (DrawingPoint& p : out.points) p.tangent = -p.tangent, p.arc_mm = arc - p.arc_mm;
    }
    if (two) judge_fold(out);
    drawing.edges.push_back(std::move(out));
}

}  // namespace

Expected<Drawing> drawing_of(const TopoDS_Shape& shape, const std::string& name,
                             const DrawingOptions& options) {
    Drawing drawing;
    drawing.source = name;
    drawing.chord_mm = options.chord_mm;
    TopTools_IndexedMapOfShape faces, edges;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    TopExp::MapShapes(shape, TopAbs_EDGE, edges);
    if (faces.IsEmpty())
        return file_error("holds no face", name,
                          "export the part as a solid or as surfaces (AP203, AP214, AP242)");
    const Handle(Watcher) watcher = new Watcher(options, 0.6, 0.9, "tessellating");
    IMeshTools_Parameters parameters;
    parameters.Deflection = options.chord_mm;
    parameters.Angle = kFacetRad;
    parameters.InParallel = Standard_False;
    BRepMesh_IncrementalMesh net(shape, parameters, watcher->Start());
    if (options.cancel.stop_requested()) return cancelled(name);
    for (int i = 1; i <= faces.Extent(); ++i) {
        if (options.cancel.stop_requested()) return cancelled(name);
        add_face(TopoDS::Face(faces(i)), i, drawing);
    }
    TopTools_IndexedDataMapOfShapeListOfShape neighbours;
    TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, neighbours);
    for (int i = 1; i <= edges.Extent(); ++i) {
        if (options.cancel.stop_requested()) return cancelled(name);
        if (i % 64 == 0) tell(options, 0.9 + 0.1 * i / edges.Extent(), "edges");
        if (const TopTools_ListOfShape* list = neighbours.Seek(edges(i)))
            add_edge(TopoDS::Edge(edges(i)), i, *list, faces, options, drawing);
    }
    for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
        GProp_GProps properties;
        BRepGProp::VolumeProperties(solid.Current(), properties);
        if (std::isfinite(properties.Mass())) drawing.volume_mm3 += std::abs(properties.Mass());
    }
    if (drawing.mesh.triangles.empty()) return file_error("none of its faces could be tessellated", name);
    for (const Eigen::Vector3d& v : drawing.mesh.vertices)
        if (!v.allFinite() || v.cwiseAbs().maxCoeff() > kFarthestMm)
            return file_error(Text("holds a point beyond {} m", kFarthestMm / 1000), name,
                              "look at the unit that the file states");
    return drawing;
}

}  // namespace seamwright::drawing
