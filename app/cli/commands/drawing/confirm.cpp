// seamwright confirm: spots from the drawing, measured on the part.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "projects/confirm/confirm.h"

namespace seamwright::cli {
namespace {

struct ConfirmArguments {
    std::string file;
    bool all = false, dry_run = false;
    ConfirmOptions options;
};

std::string table_of(const Confirmation& c) {
    std::string text = fmt::format("{:<6} {:<16} {:>18} {:>18} {:>9} {:>8}\n", "spot", "finding",
                                   "shift x mm", "shift z mm", "contour", "left mm");
    const auto with_sigma = [](double value, double sigma) {
        return std::isfinite(value) ? fmt::format("{:.3f} +- {:.3f}", value, sigma) : std::string("-");
    };
    for (const SpotConfirmation& s : c.spots) {
        text += fmt::format("{:<6} {:<16} {:>18} {:>18} {:>9.3f} {:>8}\n", s.spot_id, to_string(s.finding),
                            with_sigma(s.shift_mm.x(), s.sigma_mm.x()),
                            with_sigma(s.shift_mm.y(), s.sigma_mm.y()), s.contour_rms_mm,
                            std::isfinite(s.left_mm) ? fmt::format("{:.3f}", s.left_mm) : "-");
        if (s.finding != ConfirmFinding::ok) text += "       " + s.reason.english() + "\n";
    }
    for (const CommonShift& r : c.regions) {
        const Eigen::Vector3d t = r.displacement.workobject_from_movedworkobject.translation();
        text += r.judged ? fmt::format(
                               "region {}: as a whole {:.3f} {:.3f} {:.3f} mm, up to {:.3f} mm at its spots; "
                               "{:.3f} mm rms are left\n",
                               r.region_id, t.x(), t.y(), t.z(), r.largest_mm, r.rms_mm)
                         : fmt::format("region {}: its displacement as a whole is not known ({})\n",
                                       r.region_id, r.why_not.english());
    }
    return text;
}

Expected<Answer> confirm_command(const ConfirmArguments& a) {
    const bool named = !a.options.spot_ids.empty() || !a.options.region_id.empty();
    if (a.all && named)
        return usage_error("all spots and some of them", "--all", "name spots, a region, or all");
    SEAM_TRY(auto station, open_station(a.file, Deed::teach));
    SEAM_OK(spots_to_confirm(station.project(), a.options));
    SEAM_OK(station.connect());
    ConfirmOptions options = a.options;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    SEAM_TRY(const auto confirmation, confirm_spots(station, options));
    Answer answer;
    answer.json = confirmation_json(confirmation);
    answer.json["taken"] = confirmation.ok && !a.dry_run;
    answer.text = table_of(confirmation);
    if (!confirmation.ok) {
        answer.exit_code = kExitVerdict;
        answer.text += "refused, no spot is confirmed\n";
        return answer;
    }
    if (a.dry_run) {
        answer.text += "plausible; dry run: nothing is taken\n";
        return answer;
    }
    SEAM_OK(station.edit(confirmation.project));
    EventRecord event;
    event.utc = utc_now();
    event.subject = a.options.region_id;
    event.text = said_of(confirmation);
    SEAM_OK(station.file().append_event(event));
    answer.text += fmt::format("{}\n", said_of(confirmation));
    answer.text +=
        "A path taught on this part is right as it is; one from the drawing is off by the region's "
        "displacement.\n";
    return answer;
}

}  // namespace

void add_confirm(CommandLine& line) {
    auto a = std::make_shared<ConfirmArguments>();
    CLI::App* command = line.add("confirm",
                                 "Spots from the drawing, measured on the part as in teaching: how far the "
                                 "part lies from its drawing at each, "
                                 "whether that is plausible, and the measured reference and template in "
                                 "place of the drawn ones. All of them are "
                                 "taken or none; exit code 1 where one is refused. The robot goes to the "
                                 "spots; nothing is written to it.",
                                 "seamwright confirm door_left.seam --region top\n"
                                 "  seamwright confirm door_left.seam --all --dry-run");
    ConfirmOptions& o = a->options;
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command->add_option("--spot", o.spot_ids, "This spot (repeatable)")->type_name("ID");
    command->add_option("--region", o.region_id, "The spots of this region that are not confirmed")
        ->type_name("ID");
    command->add_flag("--all", a->all, "All that are not confirmed, which is the default");
    command->add_option("--repeats", o.repeats, "Arrivals at each spot")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--shift-limit-mm", o.shift_limit_mm, "A spot farther from where it is drawn is refused")
        ->check(CLI::Range(0.1, 15.0))
        ->capture_default_str();
    command
        ->add_option(
            "--form-mm", o.form_mm,
            "By how much a sound part may differ from its drawing at a spot, one sigma, its place aside")
        ->check(CLI::Range(0.01, 2.0))
        ->capture_default_str();
    command->add_flag("--dry-run", a->dry_run, "Measure and judge, take nothing");
    line.on(command, [a] { return confirm_command(*a); });
}

}  // namespace seamwright::cli
