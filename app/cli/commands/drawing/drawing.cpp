// seamwright drawing: what a drawing of the part holds; and how it comes into a project.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "devices/drawing/drawing.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct DrawingArguments {
    std::string file, edge;
    double shortest_mm = 0;
    DrawingOptions options;
};

json xyz(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

json edge_json(const DrawingEdge& e) {
    const DrawingPoint& middle = e.points[e.points.size() / 2];
    return {{"id", e.id},
            {"kind", e.kind},
            {"length_mm", e.length_mm},
            {"closed", e.closed},
            {"fold_deg", e.fold_deg},
            {"convex", e.convex},
            {"faces", e.right.empty() ? json{e.left} : json{e.left, e.right}},
            {"from_mm", xyz(e.points.front().point_mm)},
            {"to_mm", xyz(e.points.back().point_mm)},
            {"radius_mm", std::isfinite(middle.radius_mm) ? json(middle.radius_mm) : json()}};
}

json points_json(const std::vector<DrawingPoint>& points) {
    json list = json::array();
    for (const DrawingPoint& p : points)
        list.push_back({{"arc_mm", p.arc_mm},
                        {"point_mm", xyz(p.point_mm)},
                        {"tangent", xyz(p.tangent)},
                        {"normal_left", xyz(p.normal_left)},
                        {"normal_right", xyz(p.normal_right)},
                        {"radius_mm", std::isfinite(p.radius_mm) ? json(p.radius_mm) : json()}});
    return list;
}

std::string edge_line(const DrawingEdge& e) {
    return fmt::format("{:<6} {:<8} {:>10.3f} mm  fold {:>6.1f} deg {:<8} {:<6} between {}{}{}\n", e.id,
                       e.kind, e.length_mm, e.fold_deg,
                       e.fold_deg < 1 ? "smooth"
                       : e.convex     ? "convex"
                                      : "concave",
                       e.closed ? "closed" : "", e.left, e.right.empty() ? " (border)" : " and ", e.right);
}

Answer answer_of(const Drawing& d, const DrawingArguments& a) {
    Answer answer;
    const Eigen::AlignedBox3d box = d.box();
    answer.text = fmt::format(
        "{}: {} in {}, {} faces, {} edges, {} triangles within {} mm\n"
        "from ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f}) mm\n",
        a.file, d.form, d.unit, d.faces.size(), d.edges.size(), d.mesh.triangles.size(), d.chord_mm,
        box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z());
    json faces = json::array(), edges = json::array();
    for (const DrawingFace& f : d.faces)
        faces.push_back({{"id", f.id},
                         {"kind", f.kind},
                         {"area_mm2", f.area_mm2},
                         {"radius_mm", f.radius_mm > 0 ? json(f.radius_mm) : json()}});
    for (const DrawingEdge& e : d.edges) {
        if (e.length_mm < a.shortest_mm) continue;
        edges.push_back(edge_json(e));
        answer.text += edge_line(e);
    }
    answer.json = {{"status", "ok"},
                   {"form", d.form},
                   {"unit", d.unit},
                   {"chord_mm", d.chord_mm},
                   {"triangles", d.mesh.triangles.size()},
                   {"volume_mm3", d.volume_mm3},
                   {"box", {{"min_mm", xyz(box.min())}, {"max_mm", xyz(box.max())}}},
                   {"faces", faces},
                   {"edges", edges}};
    return answer;
}

Expected<Answer> drawing_command(const DrawingArguments& given) {
    DrawingArguments a = given;
    a.options.cancel = stop_on_signal();
    int last = -10;
    a.options.progress = [&](double share, const Text& what) {
        const int percent = static_cast<int>(100 * share);
        if (percent < last + 10) return;
        last = percent;
        fmt::print(stderr, "{} %  {}\n", percent, what.english());
    };
    SEAM_TRY(auto drawing, read_drawing(a.file, a.options));
    if (a.edge.empty()) return answer_of(drawing, a);
    SEAM_TRY(auto chain, tangent_chain(drawing, a.edge));
    const DrawingEdge& edge = *find_edge(drawing, a.edge);
    Answer answer;
    answer.text = edge_line(edge) + fmt::format("in a chain of {} edges, {:.3f} mm{}:", chain.parts.size(),
                                                chain.length_mm(), chain.closed ? ", closed" : "");
    json parts = json::array();
    for (const EdgeChain::Part& p : chain.parts) {
        parts.push_back({{"edge", p.edge}, {"reversed", p.reversed}});
        answer.text += " " + p.edge;
    }
    answer.text += "\n";
    answer.json = {{"status", "ok"},
                   {"edge", edge_json(edge)},
                   {"points", points_json(edge.points)},
                   {"chain", {{"parts", parts}, {"length_mm", chain.length_mm()}, {"closed", chain.closed}}}};
    return answer;
}

}  // namespace

void add_drawing(CommandLine& line) {
    auto a = std::make_shared<DrawingArguments>();
    CLI::App* command =
        line.add("drawing",
                 "What a drawing holds: faces, edges, units and box, in millimetres. STEP and IGES are read "
                 "exactly and "
                 "tessellated to a stated chord error; of a mesh (STL, PLY, OBJ) the sharp edges are found.",
                 "seamwright drawing door.step --edge e12 --json -");
    command->add_option("file", a->file, "The drawing")->required()->type_name("FILE.step");
    command->add_option("--edge", a->edge,
                        "One edge with all its points, and the chain of tangent edges it lies in");
    command->add_option("--shortest-mm", a->shortest_mm, "List no shorter edges")->capture_default_str();
    command->add_option("--chord-mm", a->options.chord_mm, "Chord error of faces and edges")
        ->capture_default_str();
    command->add_option("--step-mm", a->options.step_mm, "Longest step along an edge")->capture_default_str();
    command->add_option("--unit", a->options.unit, "Of a mesh: mm or m")->check(CLI::IsMember({"mm", "m"}));
    command
        ->add_option("--sharp-deg", a->options.sharp_deg,
                     "Of a mesh: fold from which two triangles meet in an edge")
        ->capture_default_str();
    line.on(command, [a] { return drawing_command(*a); });
}

}  // namespace seamwright::cli
