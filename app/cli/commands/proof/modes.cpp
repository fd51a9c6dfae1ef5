// seamwright modes: how the parts of a region bend, learnt from stored runs; what it would bring; on and off.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "devices/capture/capture.h"
#include "projects/elastic/region_modes.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ModesArguments {
    std::string file, action, region;
    double most_added_mm = 1;
};

json mode_json(const ElasticModes& modes, const ElasticMode& mode) {
    json shape = json::object();
    for (std::size_t n = 0; n < mode.shape.size(); ++n) {
        const Eigen::Vector3d& v = mode.shape[n];
        shape[modes.spots[n].id] = {v.x(), v.y(), v.z()};
    }
    return {{"sigma_mm", std::sqrt(mode.variance_mm2)},
            {"sigma_limits_mm", {std::sqrt(mode.variance_low_mm2), std::sqrt(mode.variance_high_mm2)}},
            {"mean_mm", mode.mean_mm},
            {"learnt_mm", {mode.lowest_mm, mode.highest_mm}},
            {"shape", shape}};
}

json modes_json(const RegionModes& region) {
    const ElasticModes& m = region.modes;
    json modes = json::array(), runs = json::array(), common = json::object();
    for (const ElasticMode& mode : m.modes) modes.push_back(mode_json(m, mode));
    for (const LearntRun& run : region.learnt_from)
        runs.push_back({{"run", run.run}, {"part", run.part_id}, {"utc", run.utc}});
    json noise = json::object();
    for (const ElasticSpot& s : m.spots) {
        common[s.id] = {s.common_mm.x(), s.common_mm.y(), s.common_mm.z()};
        noise[s.id] = m.noise_factor * s.noise_factor;
    }
    return {{"region", region.id},
            {"on", region.on},
            {"learnt_utc", region.learnt_utc},
            {"switched_utc", region.switched_utc},
            {"most_added_mm", region.most_added_mm},
            {"message", m.message.english()},
            {"parts", m.parts},
            {"noise_factor", m.noise_factor},
            {"noise_factor_of_spots", noise},
            {"hold_out_gain", m.gain},
            {"hold_out_gain_sigma", m.gain_sigma},
            {"modes", modes},
            {"common_mm", common},
            {"learnt_from", runs}};
}

std::string modes_text(const RegionModes& region) {
    const ElasticModes& m = region.modes;
    std::string text = fmt::format(
        "region {}: {}; {} runs of {} parts, learnt {}; {}\n", region.id, m.message,
        region.learnt_from.size(), m.parts, region.learnt_utc,
        region.on ? fmt::format("ON since {}, at most {:g} mm", region.switched_utc, region.most_added_mm)
                  : "off");
    for (std::size_t k = 0; k < m.modes.size(); ++k) {
        const ElasticMode& mode = m.modes[k];
        text += fmt::format(
            "mode {}: sigma {:.3f} mm ({:.3f} to {:.3f}), mean {:+.3f}, learnt {:+.3f} to {:+.3f} mm\n",
            k + 1, std::sqrt(mode.variance_mm2), std::sqrt(mode.variance_low_mm2),
            std::sqrt(mode.variance_high_mm2), mode.mean_mm, mode.lowest_mm, mode.highest_mm);
        for (std::size_t n = 0; n < mode.shape.size(); ++n)
            text += fmt::format("    {:<8} X {:+.3f}  Y {:+.3f}  Z {:+.3f}\n", m.spots[n].id,
                                mode.shape[n].x(), mode.shape[n].y(), mode.shape[n].z());
    }
    text += fmt::format("scatter left: {:.2f} times the stated sigma", m.noise_factor);
    constexpr double kNotable = 1.5;  // times that of all spots
    for (const ElasticSpot& s : m.spots)
        if (s.noise_factor > kNotable)
            text += fmt::format(", {} {:.2f}", s.id, m.noise_factor * s.noise_factor);
    return text + "\n";
}

Answer show(const Project& project, const std::string& region) {
    Answer answer;
    answer.json["regions"] = json::array();
    answer.exit_code = kExitVerdict;
    for (const RegionModes& modes : project.elastic) {
        if (!region.empty() && modes.id != region) continue;
        answer.json["regions"].push_back(modes_json(modes));
        answer.text += modes_text(modes);
        answer.exit_code = kExitOk;
    }
    if (answer.text.empty())
        answer.text = "no modes were learnt; learn them: seamwright modes FILE.seam learn\n";
    return answer;
}

Expected<Answer> compare(const ModesArguments& a) {
    SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const StoredShapes shapes, stored_shapes(file, a.region));
    SEAM_TRY(const ModesComparison c, compare_region(shapes));
    Answer answer;
    answer.json = {{"region", c.region_id},
                   {"parts", c.parts},
                   {"modes", c.modes},
                   {"predictions", c.predictions},
                   {"acted", c.acted},
                   {"rigid_three_sigma_mm", c.rigid.three_sigma},
                   {"three_sigma_mm", c.elastic.three_sigma},
                   {"stated_three_sigma_mm", c.stated_three_sigma},
                   {"inside_95", c.inside},
                   {"gain", c.gain()}};
    answer.text = fmt::format(
        "region {}: {} modes; every spot predicted from the other spots, on parts that were not learnt from "
        "({} parts, {} predictions, the modes acted in {})\n"
        "bead between spots, 3 sigma: rigid {:.4f} mm, with modes {:.4f} mm ({:.2f} times better); stated "
        "{:.4f} mm; the noise of the predicted spot is in all of them\n",
        c.region_id, c.modes, c.parts, c.predictions, c.acted, c.rigid.three_sigma, c.elastic.three_sigma,
        c.gain(), c.stated_three_sigma);
    if (c.acted > 0)
        answer.text +=
            fmt::format("where the modes acted, {:.1f} % lie inside the stated 95 %\n", 100 * c.inside);
    answer.exit_code = c.modes > 0 && c.gain() > 1 ? kExitOk : kExitVerdict;
    return answer;
}

Expected<Answer> modes_command(const ModesArguments& a) {
    if (a.action == "compare") return compare(a);
    if (a.action == "show") {
        SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(const Project project, file.load());
        return show(project, a.region);
    }
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(Project project, file.load());
    std::string region = a.region;
    if (a.action == "learn") {
        SEAM_TRY(const StoredShapes shapes, stored_shapes(file, a.region));
        SEAM_TRY(RegionModes modes, learn_region(shapes, utc_now()));
        region = modes.id;
        const bool found = !modes.modes.modes.empty();
        put_modes(project, std::move(modes));
        SEAM_OK(file.save(project));
        Answer answer = show(project, region);
        answer.json["left_out"] = {{"other_setup", shapes.other_setup}, {"too_little", shapes.too_little}};
        if (shapes.other_setup + shapes.too_little > 0)
            answer.text += fmt::format("runs left out: {} of another setup, {} with too little measured\n",
                                       shapes.other_setup, shapes.too_little);
        answer.exit_code = found ? kExitOk : kExitVerdict;
        return answer;
    }
    if (region.empty() && project.elastic.size() == 1) region = project.elastic.front().id;
    if (region.empty() && project.elastic.size() > 1)
        return usage_error("modes of several regions were learnt", a.file, "name one with --region");
    SEAM_OK(switch_modes(project, region, a.action == "on", a.most_added_mm, utc_now()));
    SEAM_OK(file.save(project));
    return show(project, region);
}

}  // namespace

void add_modes(CommandLine& line) {
    auto a = std::make_shared<ModesArguments>();
    CLI::App* command = line.add(
        "modes",
        "How the parts of a region bend. learn: from the stored runs, dry ones too, that were made with the "
        "spots as\nthey are now; nothing acts until a person switches it on. show: what was learnt. compare: "
        "the "
        "bead between\nspots with and without, on parts and spots held out. on, off: whether the region's "
        "correction is solved with\nits modes; where a part leaves what was learnt, the rigid answer stands "
        "and "
        "the run says so. Exit 1: no mode,\nor it brings nothing.",
        "seamwright modes door.seam learn --region top");
    command->add_option("file", a->file, "Project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command->add_option("action", a->action, "learn, show, compare, on or off")
        ->required()
        ->check(CLI::IsMember({"learn", "show", "compare", "on", "off"}));
    command->add_option("--region", a->region, "Of which region [the only one]");
    command
        ->add_option("--most-added-mm", a->most_added_mm,
                     "With on: the largest motion that the modes may add at a spot or a point of the path")
        ->check(CLI::Range(0.001, 20.0))
        ->capture_default_str();
    line.on(command, [a] { return modes_command(*a); });
}

}  // namespace seamwright::cli
