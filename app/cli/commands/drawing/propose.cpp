// seamwright propose: spots from the drawing, into the project.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "projects/file/project_file.h"
#include "projects/placing/take.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ProposeArguments {
    std::string file, drawing, spots = "4..12", unit;
    double chord_mm = 0.02;
    bool none_lost = false, three_sigma_given = false;
    bool take = false, undo = false;
    TakeOptions taking;
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

// The drawing and the bytes that it was read from.
struct ReadDrawing {
    std::string file;
    Drawing drawing;
};
Expected<ReadDrawing> drawing_for(const ProposeArguments& a, const Project& project) {
    DrawingOptions options;
    options.cancel = a.options.cancel;
    options.chord_mm = a.chord_mm;
    options.unit = a.unit;
    ReadDrawing read;
    if (a.drawing.empty() && project.part.mesh_ply.empty())
        return usage_error("the project holds no part to propose spots on", a.file,
                           "name the part's drawing: --drawing FILE");
    if (a.drawing.empty()) {
        const auto& ply = project.part.mesh_ply;
        read.file.assign(reinterpret_cast<const char*>(ply.data()), ply.size());
        SEAM_TRY(read.drawing, read_drawing(ply, "part.ply", options));
        return read;
    }
    SEAM_TRY(read.file, read_text_file(a.drawing, kLargestDrawing));
    const std::string name = std::filesystem::path(a.drawing).filename().string();
    SEAM_TRY(read.drawing, read_drawing(std::as_bytes(std::span(read.file)), name, options));
    return read;
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

Expected<void> save(ProjectFile& file, const TakenSpots& taken, const Text& said) {
    SEAM_OK(file.save(taken.project));
    EventRecord event;
    event.utc = utc_now();
    event.subject = taken.region_id;
    event.text = said;
    SEAM_OK(file.append_event(event));
    return {};
}

Expected<Answer> undo(const ProposeArguments& a) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(const auto project, file.load());
    SEAM_TRY(const auto out, without_unconfirmed(project, a.options.region_id));
    SEAM_OK(save(file, out, Text("{} spots from the drawing taken out again", out.spot_ids.size())));
    Answer answer;
    answer.json = {{"status", "ok"}, {"removed", out.spot_ids}};
    answer.text = fmt::format("taken out again: {}\n", fmt::join(out.spot_ids, ", "));
    return answer;
}

// What the project itself asks for, where nobody names a figure.
double wanted_by(const Project& project, const std::string& region_id) {
    double wanted = project.requirements.sigma3_mm;
    for (const Region& r : project.regions)
        if (r.id == region_id) wanted = std::min(wanted, 3 * r.sigma_limit_mm);
    return wanted;
}

Expected<Answer> propose_command(const ProposeArguments& given) {
    ProposeArguments a = given;
    if (a.undo) return undo(a);
    if (a.options.edge.empty())
        return usage_error("no edge is named", "--edge", "`seamwright drawing` lists them");
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
    SEAM_TRY(auto file, a.take ? open_to_edit(a.file) : ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    if (!a.options.region_id.empty() && !a.three_sigma_given)
        a.options.three_sigma_mm = wanted_by(project, a.options.region_id);
    SEAM_TRY(const auto read, drawing_for(a, project));
    auto proposal = propose_spots(project, read.drawing, a.options);
    if (!proposal) {
        proposal.error().within(a.file);
        return tl::unexpected(proposal.error());
    }
    Answer answer = answer_of(*proposal, project, a);
    if (!a.take) return answer;
    if (!proposal->set.enough) {
        answer.text += "nothing is taken into the project\n";
        answer.json["taken"] = nullptr;
        return answer;
    }
    a.taking.region_id = a.options.region_id;
    SEAM_TRY(const auto taken,
             take_proposal(project, read.drawing, std::as_bytes(std::span(read.file)), *proposal, a.taking));
    SEAM_OK(
        save(file, taken,
             Text("{} spots from drawing {}, edge {}, not confirmed: {}", taken.spot_ids.size(),
                  read.drawing.source, a.options.edge, fmt::format("{}", fmt::join(taken.spot_ids, ", ")))));
    answer.json["taken"] = {
        {"region", taken.region_id}, {"new_region", taken.new_region}, {"spots", taken.spot_ids}};
    answer.text += fmt::format(
        "{} spots are in region {}, from the drawing and not confirmed: nothing is pushed by them until\n"
        "`seamwright confirm {}` has measured them on the part; --undo takes them out again\n",
        taken.spot_ids.size(), taken.region_id, a.file);
    return answer;
}

}  // namespace

void add_propose(CommandLine& line) {
    auto a = std::make_shared<ProposeArguments>();
    CLI::App* command = line.add("propose",
                                 "Where to put the spots along an edge of the drawing: the fewest that leave "
                                 "the bead known to the wanted 3 sigma, "
                                 "any one of which may be lost, then the shortest way. Says how far a better "
                                 "set could go. Exit code 1 where the wanted is not reached. The project is "
                                 "left as it is, unless the spots are to be taken: then they are in it, from "
                                 "the drawing and not confirmed, with via points over the part.",
                                 "seamwright propose door_left.seam --drawing door.step --edge e12 "
                                 "--three-sigma-mm 0.1 --spots 4..12\n"
                                 "  seamwright propose door_left.seam --drawing door.step --edge e12 "
                                 "--region top --take");
    ProposeOptions& o = a->options;
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command
        ->add_option("--edge", o.edge,
                     "The edge that the bead follows; spots stand along its chain of tangent edges")
        ->type_name("ID");
    command
        ->add_option("--drawing", a->drawing,
                     "STEP, IGES, STL, PLY or OBJ in the work object; else the project's part")
        ->type_name("FILE");
    command->add_option("--unit", a->unit, "Of a mesh: mm or m")->check(CLI::IsMember({"mm", "m"}));
    command->add_option("--chord-mm", a->chord_mm, "Chord error of the drawing's faces")
        ->capture_default_str();
    CLI::Option* three_sigma =
        command
            ->add_option(
                "--three-sigma-mm", o.three_sigma_mm,
                "Wanted across the bead at its worst point; with --region what project and region require")
            ->capture_default_str();
    command
        ->add_option("--region", o.region_id,
                     "Its limits and free degrees hold, and it takes the spots; else a new one")
        ->type_name("ID");
    CLI::Option* take =
        command->add_flag("--take", a->take, "The spots into the project, where they are enough");
    command->add_option("--new-region", a->taking.new_region, "Name of the new region")
        ->type_name("ID")
        ->needs(take);
    command->add_option("--frame", a->taking.frame, "Its frame on the controller; else made of its name")
        ->type_name("NAME")
        ->needs(take);
    command
        ->add_option("--safe-mm", a->taking.safe_mm,
                     "Via points so high over the part; 0: straight from spot to spot")
        ->capture_default_str()
        ->needs(take);
    command
        ->add_flag(
            "--undo", a->undo,
            "Takes the spots out again that nobody has confirmed (of --region), and a region left empty")
        ->excludes(take);
    command->add_option("--spots", a->spots, "How many: 8 or 4..12")->capture_default_str();
    command->add_flag("--none-lost", a->none_lost, "No spot need be replaceable");
    command->add_option("--sensor", o.sensor_id, "Which sensor; else the project's first");
    command->add_option("--robot", o.robot_id, "Which robot; else the project's first");
    command->add_option("--step-mm", o.step_mm, "Between places; 0: 60 of them along the chain")
        ->capture_default_str();
    command
        ->add_option(
            "--beyond-mm", o.beyond_mm,
            "So far beyond the ends of the edge spots may stand on its chain; else all along it. A part that "
            "bends is measured best near its bead")
        ->check(CLI::NonNegativeNumber);
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
    line.on(command, [a, three_sigma] {
        a->three_sigma_given = three_sigma->count() > 0;
        return propose_command(*a);
    });
}

}  // namespace seamwright::cli
