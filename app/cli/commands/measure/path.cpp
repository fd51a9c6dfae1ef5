// seamwright path: the application path corrected point by point by a run of the project.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "app/cli/command.h"
#include "app/cli/commands/measure/path_arguments.h"
#include "devices/exchange/files.h"
#include "devices/registry.h"
#include "projects/file/project_file.h"
#include "projects/path/corrected_path.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct PathArguments {
    PathSourceArguments source;
    std::string file, report;
    bool look = false;
    std::filesystem::path folder;
    std::int64_t run = 0;
    PathBlendOptions blend;
    PathProgramWords words;
};

json step_json(const PathStep& s) {
    return {{"from_point", s.from + 1}, {"mm", s.mm}, {"deg", s.deg}};
}

json answer_json(const CorrectedByRun& corrected) {
    const PathAnswer& a = corrected.answer;
    const PathFigures figures = figures_of(a);
    json regions = json::array(), refusals = json::array();
    for (const PathRegionFigures& r : figures.regions)
        regions.push_back({{"id", r.id}, {"points", r.points}, {"blended_points", r.blended}});
    for (const PathRefusal& r : a.refusals)
        refusals.push_back({{"region", r.region_id},
                            {"first_point", r.points > 0 ? json(r.point + 1) : json()},
                            {"points", r.points},
                            {"reason", r.reason}});
    return {{"status", a.ok() ? "ok" : "refused"},
            {"run", corrected.run},
            {"points", a.corrected.points.size()},
            {"length_mm", a.corrected.length_mm},
            {"largest_shift_mm", figures.largest_shift_mm},
            {"largest_step_mm", step_json(a.corrected.largest_mm)},
            {"largest_step_deg", step_json(a.corrected.largest_deg)},
            {"unblended_step_mm", a.corrected.unblended_mm},
            {"curvature_change_per_m", a.corrected.curvature_change_per_m},
            {"curvature_change_at_point", a.corrected.curvature_point + 1},
            {"curvature_per_m", a.corrected.curvature_per_m},
            {"largest_sigma_mm", figures.largest_sigma_mm},
            {"regions", regions},
            {"refusals", refusals},
            {"remarks", a.corrected.remarks},
            {"files", json::array()}};
}

std::string answer_text(const json& a) {
    std::string text = fmt::format("{}: {} points, {:.1f} mm, corrected by run {}\n",
                                   a["status"].get<std::string>(), a["points"].get<std::size_t>(),
                                   a["length_mm"].get<double>(), a["run"].get<std::int64_t>());
    text += fmt::format(
        "largest shift {:.3f} mm; largest step between neighbours {:.4f} mm (at point {}) and {:.5f} "
        "degrees; "
        "without blending it were {:.3f} mm\n",
        a["largest_shift_mm"].get<double>(), a["largest_step_mm"]["mm"].get<double>(),
        a["largest_step_mm"]["from_point"].get<std::size_t>(), a["largest_step_deg"]["deg"].get<double>(),
        a["unblended_step_mm"].get<double>());
    text += fmt::format(
        "curvature changes by at most {:.4f} per m (at point {}; the path's own is up to {:.4f} per m)\n"
        "largest sigma at the path {:.4f} mm\n",
        a["curvature_change_per_m"].get<double>(), a["curvature_change_at_point"].get<std::size_t>(),
        a["curvature_per_m"].get<double>(), a["largest_sigma_mm"].get<double>());
    for (const json& r : a["regions"])
        text += fmt::format("  {:<12} {} points, {} in transitions\n", r["id"].get<std::string>(),
                            r["points"].get<int>(), r["blended_points"].get<int>());
    for (const json& r : a["refusals"])
        text += fmt::format("refused: region {}{}: {}\n", r["region"].get<std::string>(),
                            r["points"].get<int>() > 0
                                ? fmt::format(", {} points from point {} on", r["points"].get<int>(),
                                              r["first_point"].get<std::size_t>())
                                : "",
                            r["reason"].get<std::string>());
    for (const json& r : a["remarks"]) text += r.get<std::string>() + "\n";
    for (const json& f : a["files"]) text += f.get<std::string>() + "\n";
    return text;
}

std::string report_html(const PathAnswer& a, const json& figures, const std::string& project) {
    report::Page page("Corrected path: " + project);
    page.verdict(a.ok() ? "ok" : "refused", a.ok() ? report::Tone::good : report::Tone::alarm,
                 a.ok() ? "Run it in the taught frame: the correction is in its points."
                        : "The path was not written.");
    page.paragraph(answer_text(figures));
    const char* colours[3] = {report::colour::kBlue, report::colour::kVermilion, report::colour::kGreen};
    report::Plot shift, step, sigma;
    shift.title = "Shift of the path's points";
    shift.x_label = step.x_label = sigma.x_label = "path length (mm)";
    shift.y_label = "shift (mm, work object)";
    for (int axis = 0; axis < 3; ++axis)
        shift.series.push_back({std::string(1, "XYZ"[axis]), {}, {}, report::Mark::line, colours[axis]});
    step.title = "Step of the correction to the next point";
    step.y_label = "step (mm)";
    step.series.push_back({"step", {}, {}, report::Mark::line, report::colour::kBlue});
    sigma.title = "Sigma at the path, bound";
    sigma.y_label = "sigma (mm)";
    sigma.series.push_back({"sigma", {}, {}, report::Mark::line, report::colour::kPurple});
    const auto& points = a.corrected.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Pose& d = points[i].displacement.workobject_from_movedworkobject;
        const Eigen::Vector3d moved = points[i].workobject_from_tool.translation();
        const Eigen::Vector3d taught = taught_mm(points[i]);
        for (int axis = 0; axis < 3; ++axis) {
            auto& series = shift.series[static_cast<std::size_t>(axis)];
            series.x.push_back(points[i].length_mm);
            series.y.push_back(moved[axis] - taught[axis]);
        }
        if (i + 1 < points.size()) {
            const Pose& next = points[i + 1].displacement.workobject_from_movedworkobject;
            step.series[0].x.push_back(points[i].length_mm);
            step.series[0].y.push_back((next * taught - d * taught).norm());
        }
        sigma.series[0].x.push_back(points[i].length_mm);
        sigma.series[0].y.push_back(points[i].sigma_mm);
    }
    page.figure(report::svg(shift));
    page.figures({report::svg(step), report::svg(sigma)});
    return page.html();
}

Expected<Answer> look(const PathArguments& a) {
    SEAM_TRY(const auto origin, path_origin(a.source));
    SEAM_TRY(auto look, look_at_path(origin));
    Answer out;
    out.json = std::move(look.json);
    out.text = std::move(look.text);
    out.exit_code = look.whole ? kExitOk : kExitVerdict;
    return out;
}

Expected<Answer> correct_path(const PathArguments& a) {
    if (a.look) return look(a);
    if (a.file.empty()) return usage_error("the project is missing", "", "give FILE.seam, or --look");
    if (!a.source.brand.empty()) SEAM_OK(path_notation_from(a.source.brand));
    SEAM_TRY(const auto origin, path_origin(a.source));
    SEAM_TRY(const auto source, read_path_source(origin));
    const std::string brand = a.source.brand.empty() ? source.brand : a.source.brand;
    if (brand.empty() && !a.folder.empty())
        return usage_error("in whose notation the path is to be written is not said", "",
                           "say --brand kuka, abb or ur");
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const auto corrected, correct_by_run(file, a.run, source, a.blend));

    Answer out;
    out.json = answer_json(corrected);
    if (source.program)
        for (const Text& remark : source.program->remarks) out.json["remarks"].push_back(remark);
    const bool ok = corrected.answer.ok();
    out.exit_code = ok ? kExitOk : kExitVerdict;
    if (ok && !a.folder.empty()) {
        SEAM_TRY(const auto files, corrected_path_files(corrected, brand, a.words));
        SEAM_TRY(const auto written, write_program_files(a.folder, files));
        for (const auto& path : written) out.json["files"].push_back(path.string());
    }
    if (!a.report.empty())
        SEAM_OK(write_text_file(a.report, report_html(corrected.answer, out.json, corrected.setup.name)));
    out.text = answer_text(out.json);
    return out;
}

}  // namespace

void add_path(CommandLine& line) {
    auto a = std::make_shared<PathArguments>();
    CLI::App* command = line.add(
        "path",
        "The application path corrected point by point by a run: between regions the correction goes over "
        "without a\nstep. Written in the robot's notation, as CSV and as a program, to be run in the taught "
        "frame; nothing is\nwritten unless the safety gate passed every region and every point keeps its "
        "limits. The path comes from a table, from a robot program or from an edge of the drawing; --look "
        "lists "
        "its points\nand, line by line, what of a program was understood and what was not, and makes "
        "nothing.",
        "seamwright path door_left.seam --path bead.csv --brand kuka --out corrected\n"
        "  seamwright path --look --path bead.src --with '$config.dat'\n"
        "  seamwright path door_left.seam --drawing door.step --edge e12 --offset-mm 2 --stand-off-mm 8 "
        "--brand kuka --out krc\n"
        "  bead.csv: x_mm,y_mm,z_mm,a_deg,b_deg,c_deg[,region]   (abb: x_mm,y_mm,z_mm,q1,q2,q3,q4; ur: "
        "x_m,y_m,z_m,rx_rad,ry_rad,rz_rad)");
    command->add_option("file", a->file, "The project")->type_name("FILE.seam");
    add_path_source_options(*command, a->source);
    command->add_flag("--look", a->look,
                      "Shows the path and makes nothing; exit code 1 where lines are not understood");
    command->add_option(
        "--brand", a->source.brand,
        "Notation of table and written program: kuka | abb | ur; else that of the program that was read");
    command->add_option("--out", a->folder, "Folder for NAME.csv and the program")->type_name("DIR");
    command->add_option("--run", a->run, "Which run (default: the last)")->check(CLI::PositiveNumber);
    command
        ->add_option("--blend-mm", a->blend.blend_mm,
                     "Transition where two regions meet without points between")
        ->check(CLI::Range(1e-3, 1e5))
        ->capture_default_str();
    command->add_flag("--closed", a->blend.closed, "The path goes on from its last point to its first");
    command->add_option("--name", a->words.name, "Of files and program")->capture_default_str();
    command->add_option("--speed-mm-s", a->words.speed_mm_s, "Of the program")
        ->check(CLI::Range(0.1, 2000.0))
        ->capture_default_str();
    command
        ->add_option("--rounding-mm", a->words.rounding_mm, "How far from a point the robot may round it off")
        ->check(CLI::Range(0.0, 100.0))
        ->capture_default_str();
    command->add_option("--report", a->report, "HTML with curves of shift, step and sigma")
        ->type_name("FILE.html");
    line.on(command, [a] { return correct_path(*a); });
}

}  // namespace seamwright::cli
