// seamwright propose: spots from the drawing.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "projects/file/project_file.h"
#include "projects/placing/propose.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ProposeArguments {
    std::string file, drawing, region, spots = "4..12", unit;
    double chord_mm = 0.02;
    bool none_lost = false;
    ProposeOptions options;
};

// "4..12" or "8".
Expected<void> read_range(const std::string& text, int& fewest, int& most) {
    const char* const end = text.data() + text.size();
    const auto wrong = [&] {
        return usage_error(Text("\"{}\" is no number of spots", text), "--spots", "write 8 or 4..12");
    };
    const auto first = std::from_chars(text.data(), end, fewest);
    if (first.ec != std::errc()) return wrong();
    most = fewest;
    if (first.ptr == end) return {};
    if (end - first.ptr < 3 || std::string_view(first.ptr, 2) != "..") return wrong();
    const auto second = std::from_chars(first.ptr + 2, end, most);
    if (second.ec != std::errc() || second.ptr != end) return wrong();
    return {};
}

Expected<Drawing> drawing_for(const ProposeArguments& a, const Project& project) {
    DrawingOptions options;
    options.cancel = a.options.cancel;
    options.chord_mm = a.chord_mm;
    options.unit = a.unit;
    if (!a.drawing.empty()) return read_drawing(a.drawing, options);
    if (project.part.mesh_ply.empty())
        return usage_error("the project holds no part to propose spots on", a.file,
                           "name the part's drawing: --drawing FILE");
    return read_drawing(project.part.mesh_ply, "part.ply", options);
}

json number(double v) {
    return std::isfinite(v) ? json(v) : json();
}

Answer answer_of(const Proposal& p, const Project& project, const ProposeArguments& a) {
    Answer answer;
    answer.text =
        fmt::format("edge {}: {} of {} attitudes see a feature, at {} places; {} points of the bead\n",
                    a.options.edge, p.candidates, p.tried, p.places, p.bead.size());
    answer.text += fmt::format("{:<5} {:<12} {:>9} {:>7} {:>8} {:>8}  {:>9} {:>9} {:>9}\n", "spot", "feature",
                               "arc mm", "turned", "s1 mm", "s2 mm", "X", "Y", "Z");
    json spots = json::array();
    for (const ProposedSpot& s : p.spots) {
        answer.text +=
            fmt::format("{:<5} {:<12} {:>9.1f} {:>7.1f} {:>8.4f} {:>8.4f}  {:>9.2f} {:>9.2f} {:>9.2f}\n",
                        s.spot.id, s.spot.feature.kind, s.arc_mm, s.turned_deg, s.sigma_mm.x(),
                        s.sigma_mm.y(), s.point_mm.x(), s.point_mm.y(), s.point_mm.z());
        spots.push_back(
            {{"id", s.spot.id},
             {"feature", s.spot.feature.kind},
             {"arc_mm", s.arc_mm},
             {"turned_deg", s.turned_deg},
             {"sigma_mm", {s.sigma_mm.x(), s.sigma_mm.y()}},
             {"point_mm", {s.point_mm.x(), s.point_mm.y(), s.point_mm.z()}},
             {"reference_mm", {s.spot.reference_mm.x(), s.spot.reference_mm.y(), s.spot.reference_mm.z()}},
             {"base_from_flange", pose_json(s.spot.base_from_flange)}});
    }
    answer.text += fmt::format(
        "{} spots, {:.0f} mm of way: 3 sigma across the bead {:.4f} mm at its worst point{}, wanted {:.4f}\n"
        "no set of {} among these candidates gets below {:.4f} mm{}\n",
        p.spots.size(), p.set.way_mm, p.set.three_sigma_mm,
        a.none_lost ? "" : fmt::format(", {:.4f} with the worst spot lost", p.set.lost_three_sigma_mm),
        a.options.three_sigma_mm, p.spots.size(), p.bound_mm,
        p.bound_of_fewer_mm > 0
            ? fmt::format(", none of {} below {:.4f} mm", p.spots.size() - 1, p.bound_of_fewer_mm)
            : "");
    answer.text += fmt::format(
        "forecast as the safety gate judges it: sigma {:.4f} mm at the worst spot, three of them {:.4f}\n",
        p.sigma_forecast_mm, 3 * p.sigma_forecast_mm);
    answer.text +=
        p.set.enough ? "enough\n" : "not enough: allow more spots (--spots), or name a wider tolerance\n";
    json bead = json::array();
    for (std::size_t i = 0; i < p.bead.size(); ++i)
        bead.push_back(
            {{"point_mm", {p.bead[i].point_mm.x(), p.bead[i].point_mm.y(), p.bead[i].point_mm.z()}},
             {"three_sigma_mm", number(p.along_mm[i])}});
    answer.json = {{"status", p.set.enough ? "ok" : "not_enough"},
                   {"project", project.name},
                   {"edge", a.options.edge},
                   {"spots", spots},
                   {"three_sigma_mm", number(p.set.three_sigma_mm)},
                   {"lost_three_sigma_mm", number(p.set.lost_three_sigma_mm)},
                   {"wanted_three_sigma_mm", a.options.three_sigma_mm},
                   {"bound_three_sigma_mm", p.bound_mm},
                   {"bound_of_fewer_three_sigma_mm", p.bound_of_fewer_mm},
                   {"forecast_sigma_mm", number(p.sigma_forecast_mm)},
                   {"way_mm", p.set.way_mm},
                   {"attitudes", {{"tried", p.tried}, {"seen", p.candidates}, {"places", p.places}}},
                   {"bead", bead}};
    answer.exit_code = p.set.enough ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> propose_command(const ProposeArguments& given) {
    ProposeArguments a = given;
    SEAM_OK(read_range(a.spots, a.options.fewest, a.options.most));
    a.options.one_may_be_lost = !a.none_lost;
    a.options.cancel = stop_on_signal();
    int last = -10;
    a.options.progress = [&](double share, const Text& what) {
        const int percent = static_cast<int>(100 * share);
        if (percent < last + 10) return;
        last = percent;
        fmt::print(stderr, "{} %  {}\n", percent, what.english());
    };
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto drawing, drawing_for(a, project));
    auto proposal = propose_spots(project, drawing, a.options);
    if (!proposal) {
        proposal.error().within(a.file);
        return tl::unexpected(proposal.error());
    }
    return answer_of(*proposal, project, a);
}

}  // namespace

void add_propose(CommandLine& line) {
    auto a = std::make_shared<ProposeArguments>();
    CLI::App* command = line.add("propose",
                                 "Where to put the spots along an edge of the drawing: the fewest that leave "
                                 "the bead known to the wanted 3 sigma, "
                                 "any one of which may be lost, then the shortest way. Says how far a better "
                                 "set could go. Reads the project, "
                                 "changes nothing; exit code 1 where the wanted is not reached.",
                                 "seamwright propose door_left.seam --drawing door.step --edge e12 "
                                 "--three-sigma-mm 0.1 --spots 4..12");
    ProposeOptions& o = a->options;
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command
        ->add_option("--edge", o.edge,
                     "The edge that the bead follows; spots stand along its chain of tangent edges")
        ->required()
        ->type_name("ID");
    command
        ->add_option("--drawing", a->drawing,
                     "STEP, IGES, STL, PLY or OBJ in the work object; else the project's part")
        ->type_name("FILE");
    command->add_option("--unit", a->unit, "Of a mesh: mm or m")->check(CLI::IsMember({"mm", "m"}));
    command->add_option("--chord-mm", a->chord_mm, "Chord error of the drawing's faces")
        ->capture_default_str();
    command->add_option("--three-sigma-mm", o.three_sigma_mm, "Wanted across the bead at its worst point")
        ->capture_default_str();
    command->add_option("--spots", a->spots, "How many: 8 or 4..12")->capture_default_str();
    command->add_flag("--none-lost", a->none_lost, "No spot need be replaceable");
    command->add_option("--sensor", o.sensor_id, "Which sensor; else the project's first");
    command->add_option("--robot", o.robot_id, "Which robot; else the project's first");
    command->add_option("--step-mm", o.step_mm, "Between places; 0: 60 of them along the chain")
        ->capture_default_str();
    command->add_option("--cone-deg", o.cone_deg, "How far the sensor may turn about the edge")
        ->capture_default_str();
    command->add_option("--noise-mm", o.noise_mm, "Of a profile's point, one sigma")->capture_default_str();
    command
        ->add_option("--stand-off-mm", o.optics.stand_off_mm,
                     "Where the calibration has no camera: laser to the middle of its range")
        ->check(CLI::Range(10.0, 5000.0))
        ->capture_default_str();
    command
        ->add_option("--triangulation-deg", o.optics.triangulation_deg, "The same: between laser and camera")
        ->check(CLI::Range(1.0, 80.0))
        ->capture_default_str();
    command->add_option("--field-mm", o.optics.field_mm, "The same: width of the field")
        ->check(CLI::Range(1.0, 5000.0))
        ->capture_default_str();
    command->add_option("--seed", o.seed, "Of the noise and of the search")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    line.on(command, [a] { return propose_command(*a); });
}

}  // namespace seamwright::cli
