// seamwright replay: stored runs again from their raw data.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/batch_command.h"
#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "projects/proof/replay.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ReplayArguments {
    std::vector<std::string> files;
    std::int64_t run = 0;
    int jobs = 1;
    BatchArguments batch;
};

// Of each file; "differences" by run.
Expected<json> replay_files(const ReplayArguments& a, Portion portion) {
    json files = json::array();
    for (const std::string& file : a.files) {
        ReplayOptions options;
        options.run = a.run;
        options.jobs = a.jobs;
        options.portion = portion;
        options.cancel = stop_on_signal();
        SEAM_TRY(auto result, replay(file, options));
        json list = json::array();
        for (const ReplayDifference& d : result.differences)
            list.push_back({{"run", d.run}, {"what", d.what}, {"text", d.text}, {"size_mm", d.size_mm}});
        files.push_back({{"file", file},
                         {"runs", result.runs},
                         {"captures", result.captures},
                         {"cancelled", result.cancelled},
                         {"differences", list}});
    }
    return files;
}

Answer replay_answer(json files) {
    Answer answer;
    answer.json = {{"status", "ok"}};
    std::int64_t runs = 0, captures = 0;
    std::size_t differences = 0;
    for (const json& file : files) {
        for (const json& d : file["differences"])
            answer.text += fmt::format("{} run {} {}: {}\n", file["file"].get<std::string>(), d["run"].dump(),
                                       d["what"].get<std::string>(), d["text"].get<std::string>());
        runs += file["runs"].get<std::int64_t>();
        captures += file["captures"].get<std::int64_t>();
        differences += file["differences"].size();
        if (file["cancelled"] == true) answer.exit_code = kExitVerdict;
    }
    if (differences) answer.exit_code = kExitVerdict;
    answer.json["status"] = differences ? "differs" : answer.exit_code ? "cancelled" : "ok";
    answer.json["files"] = std::move(files);
    answer.json["runs"] = runs;
    answer.json["captures"] = captures;
    answer.text +=
        fmt::format("{} runs, {} captures computed again: {}\n", runs, captures,
                    differences ? fmt::format("{} differences", differences) : "bit for bit as stored");
    return answer;
}

// How many runs each file has to be computed again.
Expected<json> runs_of(const ReplayArguments& a) {
    json counts = json::array();
    for (const std::string& name : a.files) {
        SEAM_TRY(const auto file, ProjectFile::open(name, FileAccess::read_only));
        SEAM_TRY(const auto runs, file.runs());
        counts.push_back(
            a.run == 0 ? runs.size()
                       : static_cast<std::size_t>(std::ranges::count(runs, a.run, &RunSummary::number)));
    }
    return counts;
}

// The parts of all tasks as if one had made them. Error (file): a run came in between.
Expected<json> joined(const ReplayArguments& a, const std::vector<json>& parts, const json& counts) {
    json files = json::array();
    for (std::size_t f = 0; f < a.files.size(); ++f) {
        json one = {{"file", a.files[f]}, {"cancelled", false}};
        std::int64_t runs = 0, captures = 0;
        std::vector<json> list;
        for (const json& part : parts) {
            const json& of = part.at("files").at(f);
            runs += of.at("runs").get<std::int64_t>();
            captures += of.at("captures").get<std::int64_t>();
            for (const json& d : of.at("differences")) list.push_back(d);
        }
        if (counts.at(f) != runs)
            return file_error("runs came while they were computed again", a.files[f],
                              "name another folder, and begin again");
        std::ranges::stable_sort(list, {}, [](const json& d) { return d.at("run").get<std::int64_t>(); });
        one["runs"] = runs;
        one["captures"] = captures;
        one["differences"] = list;
        files.push_back(std::move(one));
    }
    return files;
}

Expected<Answer> replay_command(const ReplayArguments& a) {
    if (a.batch.is_task()) {
        SEAM_TRY(const auto portion, portion_from(a.batch.task, "--task"));
        SEAM_TRY(auto files, replay_files(a, portion));
        for (const json& file : files)
            if (file["cancelled"] == true)
                return device_error("the task was stopped before its end", file["file"].get<std::string>());
        return part_answer(a.batch,
                           {{"part", portion.number}, {"of", portion.of}, {"files", std::move(files)}});
    }
    if (!a.batch.is_split()) return replay_files(a, {}).map(replay_answer);
    SEAM_TRY(auto counts, runs_of(a));
    BatchJob job;
    job.name = "replay";
    job.what = {{"run", a.run}, {"runs", counts}, {"files", json::array()}};
    job.threads = a.jobs;
    job.words = {"replay", "--jobs", std::to_string(a.jobs), "--run", std::to_string(a.run)};
    for (const std::string& file : a.files) {
        job.what["files"].push_back(file_identity(file));
        job.words.push_back(absolute_path(file));
    }
    SEAM_TRY(auto collected, collect(a.batch, std::move(job)));
    if (collected.incomplete) return std::move(*collected.incomplete);
    try {
        return joined(a, collected.parts, counts).map(replay_answer);
    } catch (const json::exception&) {
        return file_error("a part is damaged, or of another computation", a.batch.folder,
                          "delete it: it is made again");
    }
}

}  // namespace

void add_replay(CommandLine& line) {
    auto a = std::make_shared<ReplayArguments>();
    CLI::App* command =
        line.add("replay", "Compute stored runs again from their raw data and compare bit for bit.",
                 "seamwright replay door_left.seam --jobs 2");
    command->add_option("files", a->files, "Projects")->required()->type_name("FILE.seam");
    command->add_option("--run", a->run, "Only this run");
    command->add_option("--jobs", a->jobs, "Threads")->check(CLI::Range(1, 256))->capture_default_str();
    add_batch_options(command, a->batch);
    line.on(command, [a] { return replay_command(*a); });
}

}  // namespace seamwright::cli
