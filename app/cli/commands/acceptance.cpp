// seamwright acceptance: is the measuring process good enough for the tolerance?

#include <fmt/format.h>

#include "app/cli/command.h"
#include "devices/exchange/files.h"
#include "devices/quality/qdas.h"
#include "devices/quality/study_csv.h"
#include "projects/acceptance/acceptance_json.h"
#include "projects/acceptance/acceptance_page.h"
#include "projects/acceptance/device_studies.h"
#include "projects/acceptance/stored_values.h"
#include "widgets/print/pdf.h"

namespace seamwright::cli {
namespace {

struct AcceptanceArguments {
    std::string file, data, references, study = "all", region, dfq, html, pdf, language = "en";
    double reference_mm = 0;
    CLI::Option* reference = nullptr;
    CLI::Option* tolerance = nullptr;
    AcceptanceSettings settings;
};

Expected<StoredStudy> values_of(const AcceptanceArguments& a) {
    if (a.file.empty() == a.data.empty())
        return usage_error("one of a project and --data is needed", "acceptance",
                           "give FILE.seam or --data values.csv");
    StoredStudy study;
    if (!a.file.empty()) {
        auto file = ProjectFile::open(a.file, FileAccess::read_only);
        if (!file) return tl::unexpected(file.error());
        auto stored = stored_values(*file, a.region);
        if (!stored) return stored;
        study = std::move(*stored);
    } else {
        if (!a.region.empty()) return usage_error("--region belongs to a project", "acceptance");
        auto table = read_study_csv(a.data);
        if (!table) return tl::unexpected(table.error());
        study.values = StudyValues::of(*table);
        study.source.file = std::filesystem::path(a.data).filename().string();
    }
    if (!a.references.empty()) {
        auto table = read_study_csv(a.references);
        if (!table) return tl::unexpected(table.error());
        add_references(study.values, *table);
    }
    return study;
}

QdasStudy qdas_of(const Acceptance& a) {
    const StudySource& s = a.source;
    QdasStudy q;
    q.part_number = s.part_name.empty() ? s.file : s.part_name;
    q.part_name = s.part_name;
    q.machine_number = s.robot_serial;
    q.machine_name = s.robot;
    q.gauge_number = s.sensor_serial;
    q.gauge_name = s.sensor;
    q.characteristic_number = "1";
    q.characteristic_name = s.measurand.empty() ? "deviation across the bead"
                                                : fmt::format("deviation across the bead, {}{}",
                                                              s.measurand.in(Language::english),
                                                              s.simulated ? " (simulated)" : "");
    q.nominal_mm = a.settings.nominal_mm;
    q.lower_mm = q.nominal_mm - a.settings.tolerance_mm / 2;
    q.upper_mm = q.nominal_mm + a.settings.tolerance_mm / 2;
    q.values = a.values.all();
    return q;
}

// Those of the robot and its trigger that the file holds.
struct StoredDeviceStudies {
    std::optional<MeasuredRobot> robot;
    std::optional<MeasuredTrigger> trigger;
    void write(report::Page& page, Language language) const {
        if (robot) add_chapter(page, language, *robot);
        if (trigger) add_chapter(page, language, *trigger);
    }
    void write(nlohmann::json& answer) const {
        if (robot) answer["robot"] = robot_study_json(*robot);
        if (trigger) answer["trigger"] = trigger_study_json(*trigger);
    }
};

// `study` robot, trigger or all. Error (input): the one that is asked for is not stored.
Expected<StoredDeviceStudies> device_studies_of(const AcceptanceArguments& a) {
    StoredDeviceStudies studies;
    if (a.file.empty()) return studies;
    auto file = ProjectFile::open(a.file, FileAccess::read_only);
    if (!file) return tl::unexpected(file.error());
    if (a.study != "trigger") {
        auto robot = stored_robot_study(*file, {});
        if (!robot) return tl::unexpected(robot.error());
        studies.robot = std::move(*robot);
        if (a.study == "robot" && !studies.robot)
            return input_error("no study of the robot is stored", a.file,
                               "make it: seamwright measure-robot");
    }
    if (a.study != "robot") {
        auto trigger = stored_trigger_study(*file);
        if (!trigger) return tl::unexpected(trigger.error());
        studies.trigger = std::move(*trigger);
        if (a.study == "trigger" && !studies.trigger)
            return input_error("no study of the trigger is stored", a.file,
                               "make it: seamwright measure-trigger");
    }
    return studies;
}

// The page as HTML and PDF where they are asked for.
Expected<void> write_page(const AcceptanceArguments& a, const report::Page& page, Answer& answer) {
    const auto written = [&](const char* field, const std::string& path) {
        answer.json[field] = path;
        answer.text += path + " written\n";
    };
    if (!a.html.empty()) {
        if (auto done = write_text_file(a.html, page.html()); !done) return done;
        written("html", a.html);
    }
    if (!a.pdf.empty()) {
        if (auto done = write_pdf(page, a.pdf); !done) return done;
        written("pdf", a.pdf);
    }
    return {};
}

Expected<Answer> device_study_command(const AcceptanceArguments& a) {
    if (a.file.empty()) return usage_error("it is of a project", "--study", "give FILE.seam");
    if (!a.dfq.empty()) return usage_error("it has no values for Q-DAS", "--study", "leave --dfq out");
    auto studies = device_studies_of(a);
    if (!studies) return tl::unexpected(studies.error());
    const auto page = [&](Language language) {
        report::Page of(
            Text("Acceptance of the measuring process: {}", std::filesystem::path(a.file).filename().string())
                .in(language),
            std::string(code_of(language)));
        studies->write(of, language);
        return of;
    };
    Answer answer;
    answer.json = {{"status", "ok"}};
    studies->write(answer.json);
    answer.text = page(Language::english).text();
    if (auto done = write_page(a, page(*language_from(a.language)), answer); !done)
        return tl::unexpected(done.error());
    return answer;
}

Expected<Answer> acceptance_command(const AcceptanceArguments& given) {
    AcceptanceArguments a = given;
    if (a.study == "robot" || a.study == "trigger") return device_study_command(a);
    if (a.tolerance->count() == 0)
        return usage_error("--tolerance-mm is required", "acceptance", "give T = USL - LSL, the customer's");
    if (a.reference->count() > 0) a.settings.reference_mm = a.reference_mm;
    auto study = values_of(a);
    if (!study) return tl::unexpected(study.error());
    if (a.settings.part.empty()) a.settings.part = study->reference_part;
    std::vector<Study> studies(std::begin(kStudies), std::end(kStudies));
    if (const auto one = study_from(a.study)) studies = {*one};
    auto acceptance =
        judge_acceptance(std::move(study->values), std::move(study->source), a.settings, studies);
    if (!acceptance) return tl::unexpected(acceptance.error());
    StoredDeviceStudies devices;
    if (a.study == "all") {
        auto stored = device_studies_of(a);
        if (!stored) return tl::unexpected(stored.error());
        devices = std::move(*stored);
    }
    AcceptancePageOptions options;
    options.program = "Seamwright " SEAMWRIGHT_VERSION;
    options.more = [&](report::Page& page, Language language) { devices.write(page, language); };
    Answer answer;
    answer.json = acceptance_json(*acceptance);
    devices.write(answer.json);
    answer.text = acceptance_page(*acceptance, options).text();
    answer.exit_code = acceptance->verdict() == AcceptanceVerdict::ok ? kExitOk : kExitVerdict;
    if (!a.dfq.empty()) {
        if (auto done = write_text_file(a.dfq, dfq_text(qdas_of(*acceptance))); !done)
            return tl::unexpected(done.error());
        answer.json["dfq"] = a.dfq;
        answer.text += a.dfq + " written\n";
    }
    options.language = *language_from(a.language);
    if (auto done = write_page(a, acceptance_page(*acceptance, options), answer); !done)
        return tl::unexpected(done.error());
    return answer;
}

}  // namespace

void add_acceptance(CommandLine& line) {
    auto a = std::make_shared<AcceptanceArguments>();
    CLI::App* command = line.add(
        "acceptance",
        "Acceptance of the measuring process (AIAG MSA, VDA 5, ISO 22514-7): Cg and Cgk, GR&R, linearity, "
        "stability, correlation, uncertainty, each with 95 % limits, of the deviation across the bead at a "
        "region's worst path point from the project's stored runs, or of any values.",
        "seamwright acceptance door_left.seam --tolerance-mm 1 --pdf acceptance.pdf --dfq door_left.dfq\n"
        "  seamwright acceptance --data values.csv --study type1 --tolerance-mm 1 --reference 0\n"
        "values.csv has the columns part,rehang,run,value[,reference] in any order; millimetres.");
    AcceptanceSettings& s = a->settings;
    command->add_option("file", a->file, "The project whose stored runs are studied")->type_name("FILE.seam");
    command->add_option("--data", a->data, "Values from elsewhere instead")->type_name("FILE.csv");
    command
        ->add_option(
            "--study", a->study,
            "Which study; robot and trigger: as measure-robot and measure-trigger stored them; all: each "
            "that the data allow")
        ->check(CLI::IsMember(
            {"type1", "type3", "linearity", "stability", "correlation", "vda5", "robot", "trigger", "all"}))
        ->capture_default_str();
    a->tolerance = command->add_option("--tolerance-mm", s.tolerance_mm,
                                       "T = USL - LSL, the customer's requirement; not of robot and trigger");
    command->add_option("--nominal", s.nominal_mm, "Middle of the tolerance, mm")->capture_default_str();
    command->add_option("--region", a->region, "Of the project; may be left out where there is one");
    a->reference = command->add_option("--reference", a->reference_mm, "Of the type 1 part, mm");
    command
        ->add_option("--references", a->references,
                     "Parts measured by a CMM or tracker, in the columns of --data, matched by part: the "
                     "correlation")
        ->type_name("FILE.csv");
    command->add_option("--part", s.part, "Reference part of type 1 and stability, where there are several");
    command->add_option("--share", s.share, "Share of the tolerance in Cg and Cgk")->capture_default_str();
    command->add_option("--width", s.width, "Standard deviations in Cg (%GRR always takes 6)")
        ->capture_default_str();
    command->add_option("--required", s.required, "Limit of Cg and Cgk")->capture_default_str();
    command->add_option("--subgroup", s.subgroup, "Runs of a subgroup of the stability chart")
        ->capture_default_str();
    command->add_option("--reference-u-mm", s.reference_u_mm, "Standard uncertainty of the reference (VDA 5)")
        ->capture_default_str();
    command->add_option("--resolution-mm", s.resolution_mm, "Of the measuring system (VDA 5)")
        ->capture_default_str();
    command->add_option("--dfq", a->dfq, "The values as Q-DAS ASCII")->type_name("FILE.dfq");
    command->add_option("--html", a->html, "The report, one self-contained page")->type_name("FILE.html");
    command->add_option("--pdf", a->pdf, "The report, A4, needs no screen")->type_name("FILE.pdf");
    command->add_option("--language", a->language, "Of the report: en or de")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(command, [a] { return acceptance_command(*a); });
}

}  // namespace seamwright::cli
