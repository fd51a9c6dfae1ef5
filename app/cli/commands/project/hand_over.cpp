// seamwright report, reteach: handing over, and taking up again after an exchange.

#include <fmt/format.h>

#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "devices/exchange/files.h"
#include "projects/hand_over/hand_over.h"
#include "projects/reuse/reteach.h"
#include "widgets/print/pdf.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ReportArguments {
    std::string file, html, pdf, language = "en";
};

Expected<Answer> report_command(const ReportArguments& a) {
    if (a.html.empty() && a.pdf.empty())
        return usage_error("nothing to write", "report", "give --html FILE, --pdf FILE, or both");
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    Facts facts;
    SEAM_OK(gather(file, facts));
    HandOverOptions options;
    options.language = *language_from(a.language);
    options.program = "Seamwright " SEAMWRIGHT_VERSION;
    SEAM_TRY(auto page, hand_over_report(file, project, facts, options));
    Answer answer;
    answer.json = {{"status", "ok"}};
    if (!a.html.empty()) {
        SEAM_OK(write_text_file(a.html, page.html()));
        answer.json["html"] = a.html;
        answer.text += a.html + " written\n";
    }
    if (!a.pdf.empty()) {
        SEAM_OK(write_pdf(page, a.pdf));
        answer.json["pdf"] = a.pdf;
        answer.text += a.pdf + " written\n";
    }
    json open = json::array();
    for (const CheckItem& item : checklist(project, facts))
        if (!item.done()) open.push_back(to_string(item.step));
    answer.json["open_steps"] = open;
    return answer;
}

struct ReteachArguments {
    std::string file, sensor, calibration, base_from_workobject;
    bool dry_run = false;
};

Expected<Answer> reteach_command(const ReteachArguments& a) {
    Exchange exchange;
    exchange.sensor_id = a.sensor;
    exchange.calibration_id = a.calibration;
    if (!a.base_from_workobject.empty()) {
        SEAM_TRY(auto pose, read_pose_argument(a.base_from_workobject, "--base-from-workobject"));
        exchange.base_from_workobject = pose;
    }
    SEAM_TRY(auto file, a.dry_run ? ProjectFile::open(a.file, FileAccess::read_only) : open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto retaught, after_exchange(project, exchange));
    Answer answer;
    json spots = json::array();
    for (const MovedSpot& s : retaught.spots) {
        spots.push_back({{"id", s.spot_id}, {"moved_mm", s.moved_mm}, {"turned_deg", s.turned_deg}});
        answer.text += fmt::format("spot {}: flange pose moved by {:.3f} mm and {:.4f} deg\n", s.spot_id,
                                   s.moved_mm, s.turned_deg);
    }
    answer.json = {{"status", "ok"}, {"sensor", a.sensor}, {"calibration", a.calibration}, {"spots", spots}};
    if (a.dry_run) return answer;
    SEAM_OK(file.save(retaught.project));
    const std::string note =
        fmt::format("retaught after an exchange: calibration {} in use, {} spots led along", a.calibration,
                    retaught.spots.size());
    SEAM_OK(file.append_event({0, {}, 0, EventKind::note, a.sensor, note}));
    answer.text += "Saved. Drive every spot slowly once, then repeat the zero shift.\n";
    return answer;
}

}  // namespace

void add_hand_over(CommandLine& line) {
    auto a = std::make_shared<ReportArguments>();
    CLI::App* command = line.add(
        "report",
        "The hand-over report: devices, calibrations, spots, regions, proofs, limits, events, lines to sign.",
        "seamwright report door_left.seam --pdf door_left.pdf --language de");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("--html", a->html, "One self-contained page")->type_name("FILE.html");
    command->add_option("--pdf", a->pdf, "A4, needs no screen")->type_name("FILE.pdf");
    command->add_option("--language", a->language, "en or de")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(command, [a] { return report_command(*a); });

    auto r = std::make_shared<ReteachArguments>();
    CLI::App* reteach =
        line.add("reteach",
                 "After an exchange of sensor or robot: lead the flange so that the sensor stands where it "
                 "stood, with the "
                 "new calibration. References, features and regions stay.",
                 "seamwright calibrate tcp-sphere sphere.json --store door_left.seam --sensor A\n"
                 "  seamwright reteach door_left.seam --sensor A --calibration tcp-sphere-2");
    reteach->add_option("file", r->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(reteach);
    reteach->add_option("--sensor", r->sensor, "Whose spots")->required();
    reteach->add_option("--calibration", r->calibration, "Of the new sensor, or on the new robot")
        ->required();
    reteach
        ->add_option("--base-from-workobject", r->base_from_workobject,
                     "After an exchange of the robot: the part in the new robot's base")
        ->type_name("POSE");
    reteach->add_flag("--dry-run", r->dry_run, "Only show how far the spots' flange poses move");
    line.on(reteach, [r] { return reteach_command(*r); });
}

}  // namespace seamwright::cli
