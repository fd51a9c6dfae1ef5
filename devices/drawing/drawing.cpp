#include "devices/drawing/drawing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

#include "core/geometry/pose.h"
#include "core/loaded_object.h"
#include "devices/drawing/shapes_object.h"
#include "devices/exchange/files.h"
#include "devices/simulated/scene/mesh_file.h"

namespace seamwright {
namespace {

constexpr double kSamePlaceMm = 0.01;  // of two edges' ends
constexpr double kSharpDeg = 12;       // a fold below it is none: faces that go on smoothly

std::string ending_of(const std::string& name) {
    std::string ending = std::filesystem::path(name).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

bool within(double value, double low, double high) {
    return value >= low && value <= high;  // false for NaN
}

Expected<void> check(const DrawingOptions& o) {
    if (!within(o.chord_mm, 0.001, 10)) return usage_error("the chord error is not from 0.001 to 10 mm");
    if (!within(o.step_mm, 0.05, 100)) return usage_error("the step along edges is not from 0.05 to 100 mm");
    if (!within(o.sharp_deg, 1, 170) || !within(o.bend_deg, 1, 170))
        return usage_error("an angle of sharp edges is not from 1 to 170 degrees");
    if (!within(o.patience_s, 0, 1e6))
        return usage_error("the patience with a drawing is not from 0 to 1e6 s");
    return {};
}

Expected<Drawing> drawing_of(Expected<TriangleMesh> mesh, const std::string& name,
                             const DrawingOptions& options) {
    if (!mesh) return tl::unexpected(mesh.error());
    Drawing drawing;
    drawing.source = name;
    drawing.form = ending_of(name).substr(1);
    drawing.unit = options.unit == "m" ? "metre" : "millimetre";
    drawing.mesh = std::move(*mesh);
    if (drawing.mesh.box().sizes().maxCoeff() > 1e5)
        return file_error(Text("holds a point beyond {} m", 100.0), name,
                          "look at the unit that the file states");
    if (options.cancel.stop_requested())
        return tl::unexpected(Error{ErrorKind::usage, "cancelled", name, {}, ErrorCode::cancelled});
    drawing.normals.assign(drawing.mesh.vertices.size(), Eigen::Vector3d::Zero());
    DrawingFace face;
    face.id = "f1";
    face.kind = "mesh";
    face.triangles = static_cast<int>(drawing.mesh.triangles.size());
    for (const Eigen::Vector3i& t : drawing.mesh.triangles) {
        const auto at = [&](int k) { return static_cast<std::size_t>(t[k]); };
        const auto& v = drawing.mesh.vertices;
        const Eigen::Vector3d n = (v[at(1)] - v[at(0)]).cross(v[at(2)] - v[at(0)]);
        face.area_mm2 += n.norm() / 2;
        for (int k = 0; k < 3; ++k) drawing.normals[at(k)] += n;
    }
    for (Eigen::Vector3d& n : drawing.normals)
        n = n.norm() > 0 ? Eigen::Vector3d(n.normalized()) : Eigen::Vector3d::UnitZ();
    drawing.faces.push_back(face);
    drawing.edges = sharp_edges(drawing.mesh, options.sharp_deg, options.bend_deg, options.step_mm);
    if (options.progress) options.progress(1, "edges");
    return drawing;
}

Expected<Drawing> read_shapes(const char* reader, std::span<const std::byte> bytes, const std::string& name,
                              const DrawingOptions& options) {
    SEAM_TRY(const auto read,
             loaded_function<decltype(drawing::seamwright_read_step)>(drawing::kShapes, reader));
    Expected<Drawing> drawing;
    read(bytes, name, options, drawing);
    return drawing;
}

// The chain's end or beginning: where it is, and where it goes from there.
struct Tip {
    Eigen::Vector3d place, out;
};

}  // namespace

Expected<Drawing> read_drawing(std::span<const std::byte> bytes, const std::string& name,
                               const DrawingOptions& options) {
    SEAM_OK(check(options));
    if (bytes.empty()) return file_error("is empty", name);
    const std::string ending = ending_of(name);
    if (ending == ".step" || ending == ".stp")
        return read_shapes("seamwright_read_step", bytes, name, options);
    if (ending == ".iges" || ending == ".igs")
        return read_shapes("seamwright_read_iges", bytes, name, options);
    if (ending == ".ply") return drawing_of(mesh_from_ply(bytes, name), name, options);
    return file_error("is neither .step, .stp, .iges, .igs nor .ply", name,
                      "a mesh of another kind is kept as PLY");
}

Expected<Drawing> read_drawing(const std::filesystem::path& path, const DrawingOptions& options) {
    SEAM_OK(check(options));
    const std::string ending = ending_of(path.string());
    if (ending == ".stl" || ending == ".ply" || ending == ".obj")
        return drawing_of(load_mesh(path, options.unit), path.string(), options);
    if (ending != ".step" && ending != ".stp" && ending != ".iges" && ending != ".igs")
        return file_error("is neither .step, .stp, .iges, .igs, .stl, .ply nor .obj", path.string());
    SEAM_TRY(auto text, read_text_file(path, kLargestDrawing));
    return read_drawing(std::as_bytes(std::span(text.data(), text.size())), path.string(), options);
}

const DrawingEdge* find_edge(const Drawing& drawing, const std::string& id) {
    for (const DrawingEdge& edge : drawing.edges)
        if (edge.id == id) return &edge;
    return nullptr;
}

DrawingPoint EdgeChain::at(double arc_mm) const {
    const double length = length_mm();
    if (closed && length > 0) arc_mm -= length * std::floor(arc_mm / length);
    if (!(arc_mm > 0)) return points.front();
    if (arc_mm >= length) return points.back();
    const auto next = std::upper_bound(points.begin(), points.end(), arc_mm,
                                       [](double arc, const DrawingPoint& p) { return arc < p.arc_mm; });
    const DrawingPoint &a = *(next - 1), &b = *next;
    const double h = b.arc_mm - a.arc_mm, s = (arc_mm - a.arc_mm) / h;
    DrawingPoint p = s > 0.5 ? b : a;
    p.arc_mm = arc_mm;
    // Hermite: exact to the fourth order of the step where both tangents are the curve's.
    const double s2 = s * s, s3 = s2 * s;
    p.point_mm = (2 * s3 - 3 * s2 + 1) * a.point_mm + (s3 - 2 * s2 + s) * h * a.tangent +
                 (3 * s2 - 2 * s3) * b.point_mm + (s3 - s2) * h * b.tangent;
    p.tangent = ((1 - s) * a.tangent + s * b.tangent).normalized();
    p.normal_left = ((1 - s) * a.normal_left + s * b.normal_left).normalized();
    p.normal_right = ((1 - s) * a.normal_right + s * b.normal_right).normalized();
    return p;
}

std::pair<double, double> EdgeChain::arcs_of(const Drawing& drawing, const std::string& edge) const {
    double arc = 0;
    for (const Part& part : parts) {
        const double length = find_edge(drawing, part.edge)->points.back().arc_mm;
        if (part.edge == edge) return {arc, arc + length};
        arc += length;
    }
    return {0, arc};
}

namespace {

class ChainWalk {
  public:
    ChainWalk(const Drawing& drawing, double bend_deg)
        : drawing_(drawing), straight_(std::cos(rad_from_deg(bend_deg))) {}

    // The one edge that goes on from there; nullopt: none, several, or one that is in `parts` already.
    std::optional<EdgeChain::Part> next(const EdgeChain::Part& last,
                                        const std::vector<EdgeChain::Part>& parts) const {
        const DrawingEdge& from = *find_edge(drawing_, last.edge);
        if (from.closed) return std::nullopt;
        const Tip tip = end_of(from, last.reversed);
        std::optional<EdgeChain::Part> found;
        for (const DrawingEdge& edge : drawing_.edges) {
            if (edge.id == last.edge || edge.closed || sharp(edge) != sharp(from) ||
                edge.right.empty() != from.right.empty())
                continue;
            for (const bool reversed : {false, true}) {
                const Tip start = end_of(edge, !reversed);
                if ((start.place - tip.place).norm() > kSamePlaceMm || -start.out.dot(tip.out) < straight_)
                    continue;
                if (found) return std::nullopt;
                found = EdgeChain::Part{edge.id, reversed};
            }
        }
        if (found &&
            std::any_of(parts.begin(), parts.end(), [&](const auto& p) { return p.edge == found->edge; }))
            return std::nullopt;
        return found;
    }

  private:
    static bool sharp(const DrawingEdge& edge) { return edge.fold_deg > kSharpDeg; }
    static Tip end_of(const DrawingEdge& edge, bool reversed) {
        if (reversed) return {edge.points.front().point_mm, -edge.points.front().tangent};
        return {edge.points.back().point_mm, edge.points.back().tangent};
    }
    const Drawing& drawing_;
    double straight_;
};

void append(const DrawingEdge& edge, bool reversed, std::vector<DrawingPoint>& points) {
    std::vector<DrawingPoint> more = edge.points;
    const double length = more.back().arc_mm, before = points.empty() ? 0 : points.back().arc_mm;
    if (reversed) {
        std::reverse(more.begin(), more.end());
        for (DrawingPoint& p : more) {
            p.tangent = -p.tangent;
            p.arc_mm = length - p.arc_mm;
            std::swap(p.normal_left, p.normal_right);
        }
    }
    for (DrawingPoint& p : more) p.arc_mm += before;
    points.insert(points.end(), points.empty() ? more.begin() : more.begin() + 1, more.end());
}

}  // namespace

Expected<EdgeChain> tangent_chain(const Drawing& drawing, const std::string& id, double bend_deg) {
    if (!find_edge(drawing, id))
        return input_error(Text("the drawing has no edge \"{}\"", id), drawing.source,
                           "`seamwright drawing` lists its edges");
    const ChainWalk walk(drawing, bend_deg);
    EdgeChain chain;
    chain.parts = {{id, false}};
    while (const auto next = walk.next(chain.parts.back(), chain.parts)) chain.parts.push_back(*next);
    for (;;) {
        const EdgeChain::Part first = chain.parts.front();
        const auto before = walk.next({first.edge, !first.reversed}, chain.parts);
        if (!before) break;
        chain.parts.insert(chain.parts.begin(), {before->edge, !before->reversed});
    }
    for (const EdgeChain::Part& part : chain.parts)
        append(*find_edge(drawing, part.edge), part.reversed, chain.points);
    chain.closed = (chain.points.front().point_mm - chain.points.back().point_mm).norm() < kSamePlaceMm &&
                   chain.points.front().tangent.dot(chain.points.back().tangent) > 0.9;
    return chain;
}

}  // namespace seamwright
