// seamwright statistics: production in numbers.

#include "app/cli/command.h"
#include "app/cli/commands/production/fleet.h"
#include "devices/capture/capture.h"
#include "devices/exchange/files.h"
#include "projects/fleet/fleet_statistics.h"
#include "projects/statistics/statistics_page.h"
#include "widgets/print/pdf.h"

namespace seamwright::cli {
namespace {

struct StatisticsArguments {
    std::vector<std::string> files;
    std::vector<std::string> stations;
    std::string fleet, since, until, html, pdf, xlsx, dfq, language = "en";
    double tolerance_mm = 0;
    CLI::Option* tolerance = nullptr;
    StatisticsOptions options;
};

Expected<void> write_files(const StatisticsArguments& a, const Statistics& s, Answer& answer) {
    const Language language = *language_from(a.language);
    const auto written = [&](const char* field, const std::string& path, Expected<void> done) {
        if (!done) return done;
        answer.json[field] = path;
        answer.text += path + " written\n";
        return done;
    };
    if (!a.html.empty() || !a.pdf.empty()) {
        const report::Page page = statistics_page(s, language, "Seamwright " SEAMWRIGHT_VERSION);
        if (!a.html.empty()) SEAM_OK(written("html", a.html, write_text_file(a.html, page.html())));
        if (!a.pdf.empty()) SEAM_OK(written("pdf", a.pdf, write_pdf(page, a.pdf)));
    }
    if (!a.xlsx.empty())
        if (auto done = written("xlsx", a.xlsx, write_workbook(statistics_workbook(s, language), a.xlsx));
            !done)
            return done;
    if (!a.dfq.empty()) {
        const auto characteristics = statistics_qdas(s);
        if (characteristics.empty())
            return input_error("nothing here has limits on both sides, which Q-DAS asks for", "--dfq",
                               "state the regions' limits, or give --tolerance-mm");
        SEAM_OK(written("dfq", a.dfq, write_text_file(a.dfq, dfq_text(characteristics))));
    }
    return {};
}

Expected<Statistics> of_fleet(const StatisticsArguments& a) {
    SEAM_TRY(const auto target, FleetTarget::from(a.fleet));
    return fleet_statistics(target, {a.options, a.stations});
}

Expected<Answer> statistics_command(const StatisticsArguments& given) {
    StatisticsArguments a = given;
    const std::string now = utc_now();
    for (const auto& [text, option, to] : {std::tuple{&a.since, "--since", &a.options.runs.since_utc},
                                           std::tuple{&a.until, "--until", &a.options.runs.until_utc}}) {
        if (text->empty()) continue;
        SEAM_TRY(auto time, time_argument(*text, option, now));
        *to = time;
    }
    if (a.tolerance->count() > 0) a.options.tolerance_mm = a.tolerance_mm;
    const std::vector<std::filesystem::path> files(a.files.begin(), a.files.end());
    SEAM_TRY(auto statistics, a.fleet.empty() ? production_statistics(files, a.options) : of_fleet(a));
    Answer answer;
    answer.json = statistics_json(statistics);
    answer.text = statistics_page(statistics, Language::english, "Seamwright " SEAMWRIGHT_VERSION).text();
    SEAM_OK(write_files(a, statistics, answer));
    answer.exit_code = statistics.parts == 0 ? kExitVerdict : kExitOk;
    return answer;
}

}  // namespace

void add_statistics(CommandLine& line) {
    auto a = std::make_shared<StatisticsArguments>();
    CLI::App* command =
        line.add("statistics",
                 "Production in numbers, of the stored runs of one or several projects: how the parts of "
                 "each region lie "
                 "(mean, s, Pp, Ppk, Cp, Cpk with 95 % limits), control charts with Nelson's rules and EWMA, "
                 "trends with "
                 "the day on which they reach a limit, why parts were refused, cycle times. Exit 1: no run "
                 "of production.",
                 "seamwright statistics door_left.seam --since 7d --html week.html --xlsx week.xlsx");
    auto* files = command->add_option("files", a->files, "Projects with runs")->type_name("FILE.seam");
    auto* fleet =
        add_fleet_option(command, "--fleet", a->fleet,
                         "Instead of files: all that stations have published there (`fleet publish`)")
            ->excludes(files);
    command->add_option("--station", a->stations, "With --fleet: only these stations")
        ->needs(fleet)
        ->type_name("NAME");
    command->add_option(
        "--since", a->since,
        "Runs from then on: 2024-05-01, 2024-05-01T06:00 (local time), ...Z (UTC), or 8h, 7d");
    command->add_option("--until", a->until, "Runs before then");
    command->add_option("--region", a->options.region, "Only this region or panel job");
    command->add_option("--type", a->options.runs.type_id, "Only parts of this type (id)")->type_name("ID");
    a->tolerance = command->add_option("--tolerance-mm", a->tolerance_mm,
                                       "T = USL - LSL of the deviation across the bead at path points");
    command->add_option("--subgroup", a->options.subgroup, "Parts that make one point of the control chart")
        ->capture_default_str();
    command->add_option("--html", a->html, "One self-contained page")->type_name("FILE.html");
    command->add_option("--pdf", a->pdf, "A4, needs no screen")->type_name("FILE.pdf");
    command->add_option("--xlsx", a->xlsx, "Summary, refusals, and the values of every run")
        ->type_name("FILE.xlsx");
    command->add_option("--dfq", a->dfq, "Q-DAS ASCII: what has limits")->type_name("FILE.dfq");
    command->add_option("--language", a->language, "en or de, of the files")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(command, [a] { return statistics_command(*a); });
}

}  // namespace seamwright::cli
