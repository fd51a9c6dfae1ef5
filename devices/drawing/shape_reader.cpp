#include "devices/drawing/shape_reader.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
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
#include <fstream>
#include <istream>
#include <streambuf>
#include <string_view>

#include "core/geometry/pose.h"
#include "devices/drawing/apart.h"
#include "devices/drawing/step_text.h"

namespace seamwright::drawing {
namespace {

constexpr double kFarthestMm = 1e5;   // a coordinate beyond it is a wrong unit or no drawing
constexpr int kMostSamples = 20000;   // of one edge
constexpr int kPieces = 128;          // of a curve whose length is looked for
constexpr double kShortestMm = 1e-6;  // an edge that has shrunk to a point
constexpr double kFacetRad = 0.35;    // between two facets of a round face

tl::unexpected<Error> cancelled(const std::string& name) {
    return tl::unexpected(Error{ErrorKind::usage, "cancelled", name, {}, ErrorCode::cancelled});
}

void tell(const DrawingOptions& options, double share, const Text& what) {
    if (options.progress) options.progress(share, what);
}

// The bytes in slices, so that the parser, which asks nobody, can be stopped: a cancelled file just ends.
class SlicedBytes : public std::streambuf {
  public:
    SlicedBytes(std::span<const std::byte> bytes, const DrawingOptions& options)
        : bytes_(bytes), options_(options) {}

  protected:
    int_type underflow() override {
        if (at_ >= bytes_.size() || options_.cancel.stop_requested()) return traits_type::eof();
        tell(options_, 0.4 * static_cast<double>(at_) / static_cast<double>(bytes_.size()), "reading");
        const std::size_t length = std::min(kSlice, bytes_.size() - at_);
        // A stream buffer that is never written to.
        char* first = const_cast<char*>(reinterpret_cast<const char*>(bytes_.data() + at_));
        setg(first, first, first + length);
        at_ += length;
        return traits_type::to_int_type(*first);
    }

  private:
    static constexpr std::size_t kSlice = std::size_t{1} << 18;
    std::span<const std::byte> bytes_;
    const DrawingOptions& options_;
    std::size_t at_ = 0;
};

class Watcher : public Message_ProgressIndicator {
  public:
    Watcher(const DrawingOptions& options, double from, double to, Text what)
        : options_(options), from_(from), to_(to), what_(std::move(what)) {}
    Standard_Boolean UserBreak() override { return options_.cancel.stop_requested(); }
    void Show(const Message_ProgressScope& /*scope*/, const Standard_Boolean /*force*/) override {
        tell(options_, from_ + (to_ - from_) * GetPosition(), what_);
    }

  private:
    const DrawingOptions& options_;
    double from_, to_;
    Text what_;
};

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

std::string lower(std::string word) {
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return word;
}

std::string_view view_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What FILE_SCHEMA names, for the sentence that nothing was found in it.
std::string schema_of(std::string_view text) {
    const std::size_t at = text.find("FILE_SCHEMA");
    if (at == std::string_view::npos) return {};
    const std::size_t open = text.find('\'', at), end = text.find(';', at);
    if (open == std::string_view::npos || open > end) return {};
    const std::size_t close = text.find('\'', open + 1);
    if (close == std::string_view::npos || close - open > 200) return {};
    return std::string(text.substr(open + 1, close - open - 1));
}

Expected<void> check_step(std::string_view text, const std::string& name) {
    const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first == std::string_view::npos || text.substr(first, 12) != "ISO-10303-21")
        return file_error("is no STEP file: it does not begin with ISO-10303-21", name,
                          "export it as STEP (AP203, AP214 or AP242)");
    const std::size_t last = text.rfind("END-ISO-10303-21");
    if (last == std::string_view::npos || last + 4096 < text.size())
        return file_error("is cut off: END-ISO-10303-21 is missing at its end", name, "copy it again");
    return {};
}

constexpr double kPatienceS = 30, kPatienceSPerByte = 10e-6;

// Whatever OpenCASCADE throws.
template <class F>
Expected<Drawing> caught(const std::string& name, const DrawingOptions& options, const F& read) {
    try {
        return read(options);
    } catch (const Standard_Failure& e) {
        return file_error(Text("cannot be read (OpenCASCADE: {})",
                               std::string(e.GetMessageString() ? e.GetMessageString() : "")),
                          name, "export it again from the drawing program");
    } catch (const std::bad_alloc&) {
        return file_error("cannot be read: there is not enough memory for it", name);
    } catch (const std::exception& e) {
        return file_error(Text("cannot be read ({})", std::string(e.what())), name);
    }
}

template <class F>
Expected<Drawing> guarded(std::size_t bytes, const std::string& name, DrawingOptions options, const F& read) {
    const Quiet quiet;
    if (options.patience_s == 0)
        options.patience_s = kPatienceS + kPatienceSPerByte * static_cast<double>(bytes);
    return read_apart(name, options, [&](const DrawingOptions& here) { return caught(name, here, read); });
}

}  // namespace

Expected<Drawing> read_step(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& given) {
    SEAM_OK(check_step(view_of(bytes), name));
    return guarded(bytes.size(), name, given, [&](const DrawingOptions& options) -> Expected<Drawing> {
        STEPControl_Reader reader;
        Interface_Static::SetCVal("xstep.cascade.unit", "MM");
        SlicedBytes buffer(bytes, options);
        std::istream stream(&buffer);
        const IFSelect_ReturnStatus status = reader.ReadStream(name.c_str(), stream);
        if (options.cancel.stop_requested()) return cancelled(name);
        if (status != IFSelect_RetDone)
            return file_error("cannot be read: its entities are not those of a STEP file", name,
                              "export it again from the drawing program");
        const Handle(Watcher) watcher = new Watcher(options, 0.4, 0.6, "building shapes");
        reader.TransferRoots(watcher->Start());
        if (options.cancel.stop_requested()) return cancelled(name);
        const TopoDS_Shape shape = reader.OneShape();
        if (shape.IsNull())
            return file_error(Text("holds no shape (its schema is \"{}\")", schema_of(view_of(bytes))), name,
                              "export the part as a solid or as surfaces (AP203, AP214, AP242)");
        auto drawing = drawing_of(shape, name, options);
        if (!drawing) return drawing;
        drawing->form = "step";
        TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
        reader.FileUnits(lengths, angles, solid_angles);
        drawing->unit = lengths.IsEmpty() ? "millimetre" : lower(lengths.First().ToCString());
        return drawing;
    });
}

Expected<Drawing> read_iges(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& given) {
    const std::string_view text = view_of(bytes);
    const std::size_t last = text.find_last_not_of(" \t\r\n\x1A");
    const std::size_t line = last == std::string_view::npos ? 0 : text.find_last_of("\r\n", last);
    if (text.size() < 80 || text[72] != 'S')
        return file_error("is no IGES file: column 73 of its first line is not S", name,
                          "export it as STEP or IGES");
    if (line == std::string_view::npos || last < line + 73 || text[line + 73] != 'T')
        return file_error("is cut off: it does not end with the line that IGES ends with", name,
                          "copy it again");
    return guarded(bytes.size(), name, given, [&](const DrawingOptions& options) -> Expected<Drawing> {
        // This reader knows files alone.
        const TemporaryFile file;
        if (!file.ok()) return file_error("no file can be made there", file.path());
        {
            std::ofstream out(file.path(), std::ios::binary);
            out.write(text.data(), static_cast<std::streamsize>(text.size()));
            if (!out) return file_error("could not be written", file.path());
        }
        tell(options, 0, "reading");
        IGESControl_Reader reader;
        Interface_Static::SetCVal("xstep.cascade.unit", "MM");
        const IFSelect_ReturnStatus status = reader.ReadFile(file.path().c_str());
        if (options.cancel.stop_requested()) return cancelled(name);
        if (status != IFSelect_RetDone)
            return file_error("cannot be read: its entities are not those of an IGES file", name,
                              "export it again from the drawing program");
        const Handle(Watcher) watcher = new Watcher(options, 0.4, 0.6, "building shapes");
        reader.TransferRoots(watcher->Start());
        if (options.cancel.stop_requested()) return cancelled(name);
        const TopoDS_Shape shape = reader.OneShape();
        if (shape.IsNull())
            return file_error("holds no shape", name, "export the part as a solid or as surfaces");
        auto drawing = drawing_of(shape, name, options);
        if (!drawing) return drawing;
        drawing->form = "iges";
        const Handle(IGESData_IGESModel) model = Handle(IGESData_IGESModel)::DownCast(reader.Model());
        if (!model.IsNull() && !model->GlobalSection().UnitName().IsNull())
            drawing->unit = lower(model->GlobalSection().UnitName()->ToCString());
        return drawing;
    });
}

}  // namespace seamwright::drawing
