// seamwright diagnose: which carrier, locator or hinge has moved.

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "devices/capture/capture.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "projects/statistics/diagnosis.h"

namespace seamwright::cli {
namespace {

struct DiagnoseArguments {
    std::string file, fixture, carriers, since, until, html, language = "en";
    bool keep = false, forget = false;
    CarrierDiagnosisOptions options;
};

Expected<void> keep_fixture(const DiagnoseArguments& a, const std::optional<Fixture>& fixture) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    project.fixture = fixture;
    return file.save(project);
}

Expected<Answer> diagnose_command(const DiagnoseArguments& given) {
    DiagnoseArguments a = given;
    const std::string now = utc_now();
    if (a.forget) {
        SEAM_OK(keep_fixture(a, std::nullopt));
        return Answer{{{"status", "ok"}, {"fixture", nullptr}}, "the project has no fixture any more\n"};
    }
    if (!a.fixture.empty()) {
        SEAM_TRY(const auto document, read_json_file(a.fixture));
        SEAM_TRY(a.options.fixture, fixture_from_json(document, a.fixture));
    }
    if (a.keep) SEAM_OK(keep_fixture(a, a.options.fixture));
    if (!a.carriers.empty()) {
        SEAM_TRY(const auto text, read_text_file(a.carriers));
        SEAM_TRY(a.options.carriers, read_carriers(text, a.carriers));
    }
    for (const auto& [text, option, to] : {std::tuple{&a.since, "--since", &a.options.runs.since_utc},
                                           std::tuple{&a.until, "--until", &a.options.runs.until_utc}}) {
        if (text->empty()) continue;
        SEAM_TRY(auto time, time_argument(*text, option, now));
        *to = time;
    }
    a.options.runs.covariances = true;
    SEAM_TRY(const auto production, production_of({a.file}, a.options.runs));
    SEAM_TRY(const auto diagnosis, diagnose_production(production, a.options));
    const auto page_in = [&](Language language) {
        report::Page page(Text("What has moved: {}", production.files.front().project.name).in(language),
                          std::string(code_of(language)));
        write_diagnosis(diagnosis, language, page);
        return page;
    };
    Answer answer;
    answer.json = diagnosis_json(diagnosis);
    answer.text = page_in(Language::english).text();
    if (!a.html.empty()) {
        SEAM_OK(write_text_file(a.html, page_in(*language_from(a.language)).html()));
        answer.json["html"] = a.html;
        answer.text += a.html + " written\n";
    }
    const bool fine = diagnosis.numbers.status == DiagnosisStatus::ok && !diagnosis.changed();
    answer.exit_code = fine ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_diagnose(CommandLine& line) {
    auto a = std::make_shared<DiagnoseArguments>();
    CLI::App* command = line.add(
        "diagnose",
        "Which carrier, locator or hinge has moved, since when and by how much, from where the parts of the "
        "stored runs lay.\nThe carrier comes from the part's name (carrier_pattern of the fixture, a regular "
        "expression whose first group it is) "
        "or from a list.\nThe fixture: {\"elements\": [{\"id\": \"locator 2\", \"at_mm\": [x, y, z], "
        "\"direction\": [0, 1, 0]}, {\"id\": \"pin 1\", \"at_mm\": [..], \"pin_axis\": [0, 0, 1]}, {\"id\": "
        "\"hinge\", \"at_mm\": [..], \"directions\": [[..], ..]}], \"carrier_pattern\": \"-C([0-9]+)$\"}, "
        "work object, six directions in all or more.\nWithout a fixture carriers and cell are told, no "
        "locators. Exit 1: something has moved, or too few cars.",
        "seamwright diagnose door_left.seam --fixture fixture.json --keep\n"
        "  seamwright diagnose door_left.seam --since 14d --carriers parts.csv --html moved.html");
    command->add_option("file", a->file, "Project with runs")->required()->type_name("FILE.seam");
    add_sign_in(command);
    auto* fixture = command->add_option("--fixture", a->fixture, "What holds the part; else the project's")
                        ->type_name("FILE.json");
    auto* keep = command->add_flag("--keep", a->keep, "Keep the fixture in the project")->needs(fixture);
    command->add_flag("--forget", a->forget, "Forget the project's fixture, and diagnose nothing")
        ->excludes(fixture)
        ->excludes(keep);
    command->add_option("--carriers", a->carriers, "Which part was in which carrier: part,carrier")
        ->type_name("FILE.csv");
    command->add_option("--since", a->since, "Runs from then on, as of statistics");
    command->add_option("--until", a->until, "Runs before then");
    command->add_option("--type", a->options.runs.type_id, "Only parts of this type (id)")->type_name("ID");
    command
        ->add_option("--alarm", a->options.alarm,
                     "How often a quiet production may be called moved, each time")
        ->check(CLI::Range(1e-9, 0.5))
        ->capture_default_str();
    command->add_option("--html", a->html, "One self-contained page")->type_name("FILE.html");
    command->add_option("--language", a->language, "en or de, of the page")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(command, [a] { return diagnose_command(*a); });
}

}  // namespace seamwright::cli
