// seamwright fit: a scan on the drawing.

#include <fmt/format.h>

#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "core/cloud/edge/edge_fit.h"
#include "devices/drawing/drawing.h"
#include "devices/exchange/cloud/cloud_file.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/scan/drawn_edges.h"
#include "projects/scan/fit_report.h"
#include "projects/scan/scan.h"
#include "widgets/print/pdf.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct FitArguments {
    std::string file, scan, to = "drawing", cloud, mesh, start, pairs, unit, report, pdf, colours,
                            language = "en";
    std::vector<std::string> edges;
    bool take = false, anywhere = false, chain = false;
    FitOptions options;
};

// {"pairs":[{"part":[x,y,z],"base":[x,y,z]}, ..]}
Expected<void> read_pairs(const std::string& path, FitOptions& options) {
    SEAM_TRY(auto document, read_json_file(path));
    SEAM_OK(only_fields(document, {"pairs"}, path));
    SEAM_TRY(auto list, json_array(document, "pairs", path));
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string where = json_path(path + ": pairs", i);
        const json& pair = (*list)[i];
        SEAM_OK(only_fields(pair, {"part", "base"}, where));
        SEAM_TRY(const auto part, json_vector3(pair, "part", where));
        SEAM_TRY(const auto base, json_vector3(pair, "base", where));
        options.pairs_part.push_back(part);
        options.pairs_base.push_back(base);
    }
    if (options.pairs_part.size() < 3)
        return input_error("a pose needs three pairs of points", path,
                           "pick three places of the part that lie far apart");
    return {};
}

struct Part {
    TriangleMesh mesh;
    std::vector<EdgeCurve> edges;  // --to edge
};

// STEP and IGES tessellated; STL, PLY and OBJ as they are.
Expected<Part> part_of_file(const FitArguments& a) {
    std::string kind = std::filesystem::path(a.mesh).extension().string();
    for (char& c : kind)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    Part part;
    if (a.to != "edge" && kind != ".step" && kind != ".stp" && kind != ".iges" && kind != ".igs") {
        SEAM_TRY(part.mesh, load_mesh(a.mesh, a.unit));
        return part;
    }
    DrawingOptions options;
    options.unit = a.unit;
    options.cancel = stop_on_signal();
    SEAM_TRY(auto drawing, read_drawing(a.mesh, options));
    if (a.to == "edge") {
        SEAM_TRY(part.edges, drawn_edges(drawing, a.edges, a.chain));
    }
    part.mesh = std::move(drawing.mesh);
    return part;
}

// The drawing, and of a project where the part is supposed to stand.
Expected<Part> part_to_fit(FitArguments& a) {
    if (a.file.empty()) {
        if (a.cloud.empty() || a.mesh.empty())
            return usage_error("there is nothing to fit", "fit",
                               "give --cloud SCAN.ply --mesh PART.stl, or FILE.seam --scan SCAN.ply");
        return part_of_file(a);
    }
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    if (!a.anywhere && !a.options.start && a.options.pairs_part.empty())
        a.options.start = project.part.base_from_workobject;
    if (!a.mesh.empty()) return part_of_file(a);
    if (project.part.mesh_ply.empty())
        return input_error("the project's part has no drawing", a.file, "give the mesh with --mesh PART.stl");
    Part part;
    if (a.to == "edge") {
        DrawingOptions options;
        options.cancel = stop_on_signal();
        SEAM_TRY(auto drawing, read_drawing(project.part.mesh_ply, "part.ply", options));
        SEAM_TRY(part.edges, drawn_edges(drawing, a.edges, a.chain));
    }
    SEAM_TRY(part.mesh, mesh_from_ply(project.part.mesh_ply, a.file));
    return part;
}

Expected<void> take_pose(const FitArguments& a, const FitReport& report, Answer& answer) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    const Pose before = project.part.base_from_workobject;
    project.part.base_from_workobject = report.fit.base_from_part;
    SEAM_OK(file.save(project));
    const double moved = distance_mm(before, report.fit.base_from_part);
    const Text note("work object taken from a fit of {}: moved by {:.3f} mm and {:.4f} degrees; before: {}",
                    report.scan, moved, deg_from_rad(angle_rad(before, report.fit.base_from_part)),
                    pose_json(before).dump());
    SEAM_OK(file.append_event({0, {}, 0, EventKind::note, project.part.name, note}));
    answer.json["taken"] = true;
    answer.json["base_from_workobject_before"] = pose_json(before);
    answer.text += fmt::format(
        "taken: the work object moved by {:.3f} mm; what it was stands in the file's events\n", moved);
    return {};
}

Expected<void> write_reports(const FitArguments& a, const FitReport& report, const Cloud& cloud,
                             const Surface& surface, Answer& answer) {
    if (!a.colours.empty() && !report.deviation.signed_mm.empty())
        if (auto written =
                write_text_file(a.colours, deviation_svg(report, cloud, surface, *language_from(a.language)));
            !written)
            return written;
    if (a.report.empty() && a.pdf.empty()) return {};
    const report::Page page = fit_page(report, cloud, surface, *language_from(a.language));
    if (!a.report.empty()) {
        SEAM_OK(write_text_file(a.report, page.html()));
        answer.text += a.report + " written\n";
    }
    if (!a.pdf.empty()) {
        SEAM_OK(write_pdf(page, a.pdf));
        answer.text += a.pdf + " written\n";
    }
    return {};
}

// Of a project: the scan that it keeps by this name, else the file.
Expected<Cloud> scan_cloud(const FitArguments& a, const std::string& source) {
    if (!a.file.empty() && a.cloud.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(const auto scans, file.scans());
        for (const StoredScan& s : scans) {
            if (s.name != source) continue;
            SEAM_TRY(const auto scan, file.load_scan(source));
            return parse_cloud({reinterpret_cast<const char*>(scan.cloud_ply.data()), scan.cloud_ply.size()},
                               a.file + ": " + source, "mm");
        }
    }
    return read_cloud(source, a.unit);
}

Expected<void> check_arguments(const FitArguments& a) {
    if (a.to != "drawing" && a.to != "edge")
        return usage_error(Text("a scan is fitted to the drawing or to an edge, not to \"{}\"", a.to), "--to",
                           "give --to drawing or --to edge");
    if (a.to == "edge" && a.edges.empty())
        return usage_error("no edge is named", "--edge", "`seamwright drawing` lists them");
    if (a.to != "edge" && (!a.edges.empty() || a.chain))
        return usage_error("an edge is given, but the scan is fitted to the drawing", "--edge",
                           "give --to edge");
    if (a.take && a.file.empty())
        return usage_error("there is no project to take the pose into", "--take", "give FILE.seam");
    return {};
}

// `ends` of a fit to edges: what its deviation is of.
Expected<void> fit_to(const FitArguments& a, const Cloud& cloud, const Part& part, const Surface& surface,
                      FitReport& report, Cloud& ends) {
    if (a.to == "edge") {
        SEAM_TRY(auto found, fit_edges(cloud, part.edges, surface, a.options));
        report.fit = std::move(found.fit);
        report.deviation = std::move(found.deviation);
        report.normal_rms_mm = found.normal_rms_mm;
        report.spacing_mm = found.spacing_mm;
        report.edges = a.edges;
        ends = std::move(found.ends);
        return {};
    }
    SEAM_TRY(report.fit, fit_surface(cloud, surface, a.options));
    if (report.fit.status != FitStatus::no_fit && report.fit.status != FitStatus::cancelled)
        report.deviation = deviation_map(cloud, surface, report.fit.base_from_part,
                                         {std::max(2 * report.fit.gate_mm, 0.005 * surface.size_mm()),
                                          report.fit.noise_mm, 41, a.options.cancelled});
    return {};
}

Expected<Answer> fit_command(FitArguments& a) {
    SEAM_OK(check_arguments(a));
    if (!a.start.empty()) {
        SEAM_TRY(auto pose, read_pose_argument(a.start, "--start"));
        a.options.start = pose;
    }
    if (!a.pairs.empty()) SEAM_OK(read_pairs(a.pairs, a.options));
    const std::string source = a.cloud.empty() ? a.scan : a.cloud;
    if (source.empty())
        return usage_error("there is nothing to fit", "fit", "give the scan: --scan SCAN.ply");
    SEAM_TRY(auto part, part_to_fit(a));
    SEAM_TRY(auto cloud, scan_cloud(a, source));
    const Surface surface(part.mesh);
    const auto stop = stop_on_signal();
    a.options.cancelled = [stop] { return stop.stop_requested(); };
    FitReport report;
    report.scan = source;
    report.part = a.mesh.empty() ? a.file : a.mesh;
    Cloud ends;
    if (auto fitted = fit_to(a, cloud, part, surface, report, ends); !fitted) {
        Error error = fitted.error();
        error.within(Text(source));
        return tl::unexpected(error);
    }
    const bool ok = report.fit.status == FitStatus::ok;
    Answer answer{fit_json(report), fit_text(report), ok ? kExitOk : kExitVerdict};
    answer.json["taken"] = false;
    SEAM_OK(write_reports(a, report, report.to_edges() ? ends : cloud, surface, answer));
    if (a.take && ok) SEAM_OK(take_pose(a, report, answer));
    return answer;
}

}  // namespace

void add_fit(CommandLine& line) {
    auto a = std::make_shared<FitArguments>();
    CLI::App* command =
        line.add("fit",
                 "Where a part stands: its scan fitted to its drawing, with the sigma of "
                 "noise and of form, the deviation map, and a "
                 "refusal\nthat names the directions that a flat, round or symmetric part "
                 "leaves open. In a project the search begins "
                 "at its work object.\nExit 1 where the fit is refused.",
                 "seamwright fit --cloud scan.ply --mesh part.stl --report fit.html\n"
                 "  seamwright fit door_left.seam --scan door.ply --to drawing --take\n"
                 "  seamwright fit door_left.seam --scan rim.ply --mesh door.step --to edge --edge e12 "
                 "--edge e40");
    command->add_option("file", a->file, "The project")->type_name("FILE.seam");
    add_sign_in(command);
    command
        ->add_option("--scan", a->scan,
                     "One that the project keeps, or a cloud in the robot's base: PLY, PCD, CSV")
        ->type_name("NAME|FILE");
    command->add_option("--cloud", a->cloud, "The same, without a project")->type_name("FILE");
    command
        ->add_option("--mesh", a->mesh,
                     "The drawing: STEP, IGES, STL, PLY, OBJ; of a project, instead of its own")
        ->type_name("FILE");
    command->add_option("--to", a->to, "What the scan is fitted to: drawing or edge")->capture_default_str();
    command
        ->add_option("--edge", a->edges,
                     "With --to edge: an edge of the drawing where the scanned sheet ends; more than one "
                     "close what one leaves open")
        ->type_name("ID");
    command->add_flag("--chain", a->chain, "With --edge: and the tangent edges that it goes on in");
    command->add_option("--unit", a->unit, "Of the files: mm or m")->check(CLI::IsMember({"mm", "m"}));
    command->add_option("--start", a->start, "Where it stands roughly, base_from_workobject")
        ->type_name("POSE");
    command->add_option("--start-mm", a->options.start_mm, "How roughly")
        ->check(CLI::Range(0.1, 10000.0))
        ->capture_default_str();
    command->add_option("--start-deg", a->options.start_deg, "How roughly")
        ->check(CLI::Range(0.1, 180.0))
        ->capture_default_str();
    command
        ->add_option("--pairs", a->pairs,
                     "Three or more picked pairs: {\"pairs\":[{\"part\":[x,y,z],\"base\":[x,y,z]},..]}")
        ->type_name("FILE.json");
    command->add_flag("--anywhere", a->anywhere, "Search everywhere, not about the project's work object");
    command
        ->add_option("--noise-mm", a->options.noise_mm,
                     "Of a point along the normal, one sigma; else estimated")
        ->check(CLI::Range(0.0, 10.0));
    command
        ->add_option("--sigma-limit-mm", a->options.sigma_limit_mm,
                     "A direction whose 3 sigma is beyond counts as open")
        ->check(CLI::Range(0.001, 1000.0))
        ->capture_default_str();
    command->add_option("--seed", a->options.seed, "Of the search")->capture_default_str();
    command->add_option("--report", a->report, "Page with the deviation map")->type_name("FILE.html");
    command->add_option("--pdf", a->pdf, "The same as PDF")->type_name("FILE.pdf");
    command->add_option("--map", a->colours, "The deviation map alone")->type_name("FILE.svg");
    command->add_option("--language", a->language, "en or de, of the page")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    command->add_flag("--take", a->take, "Set the project's work object where the fit is ok");
    line.on(command, [a] { return fit_command(*a); });
}

}  // namespace seamwright::cli
