// seamwright acceptance: is the measuring process good enough for the tolerance?

#include <fmt/format.h>

#include "app/cli/batch_command.h"
#include "app/cli/command.h"
#include "app/cli/commands/proof/acceptance_live.h"
#include "app/cli/sign_in.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/quality/study_csv.h"
#include "projects/acceptance/equipment/device_studies.h"
#include "projects/acceptance/equipment/sensor_check.h"
#include "projects/acceptance/pages/acceptance_json.h"
#include "projects/acceptance/pages/acceptance_page.h"
#include "projects/acceptance/pages/acceptance_workbook.h"
#include "projects/acceptance/stored_acceptance.h"
#include "projects/acceptance/study/stored_values.h"
#include "projects/measure/fields.h"
#include "widgets/print/pdf.h"

namespace seamwright::cli {
namespace {

struct AcceptanceArguments {
    std::string file, data, references, sensor_data, study = "all", region, dfq, xlsx, html, pdf,
                                                     language = "en";
    double reference_mm = 0;
    CLI::Option* reference = nullptr;
    std::map<std::string, CLI::Option*> required;  // by the names of acceptance_fields()
    AcceptanceSettings settings;
    LiveArguments live;
    BatchArguments batch;
    CLI::Option *runs = nullptr, *switch_offset = nullptr;
    OffsetSwitch offset;
    bool keep_requirements = false, keep_offset = false;
};

// The project's requirements, and over them what was given with the command.
Expected<AcceptanceSettings> settings_of(const AcceptanceArguments& a) {
    AcceptanceRequirements required;
    if (!a.file.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(auto project, file.load());
        required = project.requirements.acceptance;
    }
    AcceptanceSettings settings = a.settings;
    const AcceptanceRequirements given = requirements_of(a.settings);
    require(settings, required);
    const auto is_given = [&](const std::string& name) { return a.required.at(name)->count() > 0; };
    for (const auto& field : acceptance_fields()) {
        // One limit for both, unless Cgk has its own.
        const bool both = field.info.name == "cgk" && !is_given("cgk") && is_given("cg");
        if (!both && !is_given(field.info.name)) continue;
        field.set(required, both ? given.cg : field.get(given));
        settings.from[field.info.name] = RequirementFrom::given;
    }
    const auto from = settings.from;
    require(settings, required);
    settings.from = from;
    if (required.tolerance_mm == 0 && !is_given("tolerance_mm"))
        return usage_error("--tolerance-mm is required", "acceptance",
                           "give T = USL - LSL, the customer's; --keep-requirements keeps it in the project");
    if (a.reference->count() > 0) settings.reference_mm = a.reference_mm;
    return settings;
}

Expected<StoredStudy> values_of(const AcceptanceArguments& a, Parts* parts) {
    StoredStudy study;
    if (!a.file.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        auto stored = stored_values(file, a.region, parts);
        if (!stored) return stored;
        study = std::move(*stored);
    } else {
        if (!a.region.empty()) return usage_error("--region belongs to a project", "acceptance");
        SEAM_TRY(auto table, read_study_csv(a.data));
        study.values = StudyValues::of(table);
        study.source.file = std::filesystem::path(a.data).filename().string();
    }
    if (!a.references.empty()) {
        SEAM_TRY(auto table, read_study_csv(a.references));
        add_references(study.values, table);
    }
    return study;
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
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    if (a.study != "trigger") {
        SEAM_TRY(auto robot, stored_robot_study(file, {}));
        studies.robot = std::move(robot);
        if (a.study == "robot" && !studies.robot)
            return input_error("no study of the robot is stored", a.file,
                               "make it: seamwright measure-robot");
    }
    if (a.study != "robot") {
        SEAM_TRY(auto trigger, stored_trigger_study(file));
        studies.trigger = std::move(trigger);
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
        SEAM_OK(write_text_file(a.html, page.html()));
        written("html", a.html);
    }
    if (!a.pdf.empty()) {
        SEAM_OK(write_pdf(page, a.pdf));
        written("pdf", a.pdf);
    }
    return {};
}

// None without --sensor-data.
Expected<std::optional<SensorCheck>> sensor_of(const AcceptanceArguments& a) {
    if (a.sensor_data.empty()) return std::optional<SensorCheck>();
    SEAM_TRY(auto data, read_json_file(a.sensor_data));
    std::optional<Project> project;
    if (!a.file.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(auto loaded, file.load());
        project = std::move(loaded);
    }
    SEAM_TRY(auto check, sensor_check(data, a.sensor_data, project ? &*project : nullptr));
    return std::optional(std::move(check));
}

Expected<Answer> sensor_command(const AcceptanceArguments& a) {
    if (!a.dfq.empty() || !a.xlsx.empty())
        return usage_error("it has no values for Q-DAS or Excel", "--study", "leave --dfq and --xlsx out");
    SEAM_TRY(auto check, sensor_of(a));
    if (!check)
        return usage_error("the artefacts are not named", "--study sensor",
                           "give --sensor-data FILE.json: their certificate, and points or profiles");
    const auto page = [&](Language language) {
        report::Page of(Text("Acceptance of the measuring process: {}",
                             std::filesystem::path(a.sensor_data).filename().string())
                            .in(language),
                        std::string(code_of(language)));
        add_chapter(of, language, *check);
        return of;
    };
    const AcceptanceVerdict verdict = check->study.verdict;
    Answer answer;
    // Without a permitted error nothing is judged, and nothing is not ok.
    const bool judged = verdict != AcceptanceVerdict::too_little_data;
    answer.json = {{"status", judged ? to_string(verdict) : "not_judged"},
                   {"sensor", sensor_check_json(*check)}};
    answer.text = page(Language::english).text();
    answer.exit_code = verdict == AcceptanceVerdict::ok || !judged ? kExitOk : kExitVerdict;
    SEAM_OK(write_page(a, page(*language_from(a.language)), answer));
    return answer;
}

Expected<Answer> device_study_command(const AcceptanceArguments& a) {
    if (a.file.empty()) return usage_error("it is of a project", "--study", "give FILE.seam");
    if (!a.dfq.empty() || !a.xlsx.empty())
        return usage_error("it has no values for Q-DAS or Excel", "--study", "leave --dfq and --xlsx out");
    SEAM_TRY(auto studies, device_studies_of(a));
    const auto page = [&](Language language) {
        report::Page of(
            Text("Acceptance of the measuring process: {}", std::filesystem::path(a.file).filename().string())
                .in(language),
            std::string(code_of(language)));
        studies.write(of, language);
        return of;
    };
    Answer answer;
    answer.json = {{"status", "ok"}};
    studies.write(answer.json);
    answer.text = page(Language::english).text();
    SEAM_OK(write_page(a, page(*language_from(a.language)), answer));
    return answer;
}

// What a split acceptance does: the tasks read the stored runs, who collects judges them.
BatchJob acceptance_job(const AcceptanceArguments& a) {
    BatchJob job;
    job.name = "acceptance";
    job.what = {{"file", file_identity(a.file)}, {"region", a.region}};
    job.words = {"acceptance", absolute_path(a.file)};
    if (!a.region.empty()) job.words.insert(job.words.end(), {"--region", a.region});
    return job;
}

Expected<Answer> acceptance_task(const AcceptanceArguments& a) {
    SEAM_TRY(const auto portion, portion_from(a.batch.task, "--task"));
    SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
    Parts part(portion);
    SEAM_OK(stored_values_part(file, a.region, part));
    return part_answer(a.batch, part.json());
}

Expected<Answer> acceptance_command(const AcceptanceArguments& given) {
    AcceptanceArguments a = given;
    if (a.batch.is_task()) return acceptance_task(a);
    if (a.batch.is_split() && (a.file.empty() || a.runs->count() > 0 || a.study == "robot" ||
                               a.study == "trigger" || a.study == "sensor"))
        return usage_error("only what is judged of stored runs is split", "--engine", "leave it out");
    if (a.switch_offset->count() > 0 || a.offset.undo) {
        if (a.file.empty()) return usage_error("it is of a project", "--switch-offset", "give FILE.seam");
        return switch_offset_command(a.file, a.region, a.offset);
    }
    if (a.study == "robot" || a.study == "trigger") return device_study_command(a);
    if (a.study == "sensor") return sensor_command(a);
    if (!a.sensor_data.empty() && a.study != "all")
        return usage_error("it is of the study sensor", "--sensor-data", "give --study sensor or all");
    if (a.file.empty() && (a.runs->count() > 0 || a.keep_requirements || a.keep_offset))
        return usage_error("it is of a project", "acceptance", "give FILE.seam");
    if (a.file.empty() == a.data.empty())
        return usage_error("one of a project and --data is needed", "acceptance",
                           "give FILE.seam or --data values.csv");
    if (a.keep_offset && a.study != "correlation")
        return usage_error("an offset is of a correlation", "--keep-offset", "give --study correlation");
    SEAM_TRY(auto settings, settings_of(a));
    a.settings = std::move(settings);
    SEAM_OK(check_settings(a.settings));
    if (a.keep_requirements) SEAM_OK(keep_requirements(a.file, requirements_of(a.settings)));
    std::optional<StudyProgress> progress;
    if (a.runs->count() > 0) {
        const auto one = study_from(a.study);
        if (!one) return usage_error("one study at a time is measured", "--runs", "name it with --study");
        a.live.file = a.file;
        a.live.region = a.region;
        a.live.part = a.settings.part;
        SEAM_TRY(auto measured, measure_live(a.live, *one, a.settings));
        if (!measured.complete()) return incomplete_answer(measured);
        progress = std::move(measured);
    }
    std::optional<Parts> parts;
    if (a.batch.is_split()) {
        SEAM_TRY(auto collected, collect(a.batch, acceptance_job(a)));
        if (collected.incomplete) return std::move(*collected.incomplete);
        SEAM_TRY(parts, Parts::collected(collected.parts));
    }
    SEAM_TRY(auto study, values_of(a, parts ? &*parts : nullptr));
    if (a.settings.part.empty()) a.settings.part = study.reference_part;
    std::vector<Study> studies(std::begin(kStudies), std::end(kStudies));
    if (const auto one = study_from(a.study)) studies = {*one};
    auto acceptance = judge_acceptance(std::move(study.values), std::move(study.source), a.settings, studies);
    if (!acceptance) return tl::unexpected(acceptance.error());
    StoredDeviceStudies devices;
    if (a.study == "all") {
        SEAM_TRY(auto stored, device_studies_of(a));
        devices = std::move(stored);
    }
    SEAM_TRY(auto sensor, sensor_of(a));
    AcceptancePageOptions options;
    options.program = "Seamwright " SEAMWRIGHT_VERSION;
    options.more = [&](report::Page& page, Language language) {
        devices.write(page, language);
        if (sensor) add_chapter(page, language, *sensor);
    };
    Answer answer;
    answer.json = acceptance_json(*acceptance);
    if (progress) answer.json["plan"] = study_progress_json(*progress);
    devices.write(answer.json);
    if (sensor) answer.json["sensor"] = sensor_check_json(*sensor);
    answer.text = acceptance_page(*acceptance, options).text();
    answer.exit_code = acceptance->verdict() == AcceptanceVerdict::ok ? kExitOk : kExitVerdict;
    if (a.keep_offset) SEAM_OK(keep_offset_of(a.file, *acceptance, answer));
    if (!a.dfq.empty()) {
        SEAM_OK(write_text_file(a.dfq, dfq_text(qdas_study(*acceptance))));
        answer.json["dfq"] = a.dfq;
        answer.text += a.dfq + " written\n";
    }
    options.language = *language_from(a.language);
    if (!a.xlsx.empty()) {
        SEAM_OK(write_workbook(acceptance_workbook(*acceptance, options.language), a.xlsx));
        answer.json["xlsx"] = a.xlsx;
        answer.text += a.xlsx + " written\n";
    }
    SEAM_OK(write_page(a, acceptance_page(*acceptance, options), answer));
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
    add_sign_in(command);
    command->add_option("--data", a->data, "Values from elsewhere instead")->type_name("FILE.csv");
    command
        ->add_option(
            "--study", a->study,
            "Which study; robot and trigger: as measure-robot and measure-trigger stored them; sensor: of "
            "--sensor-data; all: each that the data allow")
        ->check(CLI::IsMember({"type1", "type3", "linearity", "stability", "correlation", "vda5", "robot",
                               "trigger", "sensor", "all"}))
        ->capture_default_str();
    const auto requirement = [&](const char* field, const char* flag, auto& value, const char* help) {
        a->required[field] = command->add_option(flag, value, help)->capture_default_str();
    };
    requirement("tolerance_mm", "--tolerance-mm", s.tolerance_mm,
                "T = USL - LSL, the customer's requirement, over the project's; not of robot and trigger");
    requirement("nominal_mm", "--nominal", s.nominal_mm, "Middle of the tolerance, mm");
    command->add_option("--region", a->region, "Of the project; may be left out where there is one");
    a->reference = command->add_option("--reference", a->reference_mm, "Of the type 1 part, mm");
    command
        ->add_option("--references", a->references,
                     "Parts measured by a CMM or tracker, in the columns of --data, matched by part: the "
                     "correlation")
        ->type_name("FILE.csv");
    command
        ->add_option(
            "--sensor-data", a->sensor_data,
            "Spheres and planes with what their certificate says, in the spirit of VDI/VDE 2634-2; of "
            "spheres without points the profiles that the project's calibrations keep are taken")
        ->type_name("FILE.json");
    command->add_option("--part", s.part, "Reference part of type 1 and stability, where there are several");
    requirement("cg_share", "--share", s.share, "Share of the tolerance in Cg and Cgk");
    requirement("cg_width", "--width", s.width, "Standard deviations in Cg (%GRR always takes 6)");
    requirement("cg", "--required", s.required, "Limit of Cg and Cgk");
    a->required["cgk"] =
        command->add_option("--required-cgk", s.required_cgk, "Limit of Cgk, where it is another");
    requirement("grr_accepted_percent", "--grr-accepted", s.grr_accepted_percent,
                "%GRR of the tolerance up to which type 3 is accepted");
    requirement("grr_refused_percent", "--grr-refused", s.grr_refused_percent,
                "%GRR of the tolerance beyond which it is not");
    requirement("ndc", "--ndc", s.ndc, "Distinct categories that type 3 must tell apart");
    requirement("system_percent", "--system-percent", s.system_percent, "Limit of Q of the system (VDA 5)");
    requirement("process_percent", "--process-percent", s.process_percent,
                "Limit of Q of the process (VDA 5)");
    command->add_flag("--keep-requirements", a->keep_requirements,
                      "Keep the requirements of this command in the project, for those to come");
    command->add_option("--subgroup", s.subgroup, "Runs of a subgroup of the stability chart")
        ->capture_default_str();
    command->add_option("--reference-u-mm", s.reference_u_mm, "Standard uncertainty of the reference (VDA 5)")
        ->capture_default_str();
    command->add_option("--resolution-mm", s.resolution_mm, "Of the measuring system (VDA 5)")
        ->capture_default_str();
    command->add_option("--dfq", a->dfq, "The values as Q-DAS ASCII")->type_name("FILE.dfq");
    command->add_option("--xlsx", a->xlsx, "Every index with its limits, the ANOVA table and the values")
        ->type_name("FILE.xlsx");
    command->add_option("--html", a->html, "The report, one self-contained page")->type_name("FILE.html");
    command->add_option("--pdf", a->pdf, "The report, A4, needs no screen")->type_name("FILE.pdf");
    command->add_option("--language", a->language, "Of the report: en or de")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    a->runs =
        command->add_option("--runs", a->live.runs,
                            "Measure the study now: so many runs, of type 3 of each part and rehang. What is "
                            "stored is not measured "
                            "again: after a crash or a cancel the same command goes on where it stopped");
    command
        ->add_option("--parts", a->live.parts,
                     "With --runs: the parts of type 3 and of the correlation, in their order")
        ->delimiter(',')
        ->needs(a->runs)
        ->type_name("A,B,..");
    command->add_option("--rehangs", a->live.rehangs, "With --runs: how often each part is put in")
        ->needs(a->runs)
        ->capture_default_str();
    command->add_flag("--anew", a->live.anew, "With --runs: begin again, whatever was measured")
        ->needs(a->runs);
    command
        ->add_flag("--unattended", a->live.unattended,
                   "With --runs: the parts are changed without a word from here")
        ->needs(a->runs);
    command
        ->add_flag(
            "--simulated-parts", a->live.simulated_parts,
            "With --runs on a simulated cell: the simulation puts the parts in, each where its name draws it")
        ->needs(a->runs);
    auto* keep =
        command->add_flag("--keep-offset", a->keep_offset,
                          "Keep the correlation's offset in the project as a new version; it does not "
                          "act until it is switched on");
    a->switch_offset = command
                           ->add_option("--switch-offset", a->offset.version,
                                        "Let this version of the region's kept offsets act on every run from "
                                        "here on; 0: none")
                           ->excludes(keep)
                           ->excludes(a->runs)
                           ->type_name("VERSION");
    command->add_flag("--undo-offset", a->offset.undo, "Take the last switch of the region's offsets back")
        ->excludes(keep)
        ->excludes(a->runs)
        ->excludes(a->switch_offset);
    add_batch_options(command, a->batch);
    line.on(command, [a] { return acceptance_command(*a); });
}

}  // namespace seamwright::cli
