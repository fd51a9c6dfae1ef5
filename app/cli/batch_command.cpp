#include "app/cli/batch_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/signal_watch.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

Answer incomplete_answer(const BatchArguments& a, const BatchJob& job, const BatchOutcome& outcome) {
    const int left = static_cast<int>(outcome.failed.size() + outcome.waiting.size());
    Answer answer;
    answer.json = {{"status", outcome.failed.empty() ? "waiting" : "failed"},
                   {"folder", a.folder},
                   {"tasks", job.tasks},
                   {"done", job.tasks - left},
                   {"waiting", outcome.waiting},
                   {"failed", json::array()}};
    for (const FailedTask& f : outcome.failed) {
        answer.json["failed"].push_back({{"task", f.task}, {"why", f.why}, {"log", f.log.string()}});
        answer.text +=
            fmt::format("task {} of {} failed: {}; its log: {}\n", f.task, job.tasks, f.why, f.log.string());
    }
    answer.text += fmt::format("{} of {} tasks are done and kept in {}; the same command goes on\n",
                               job.tasks - left, job.tasks, a.folder);
    if (a.engine == "script")
        answer.text += fmt::format("the others, on this computer: parallel {}/task ::: {}\n",
                                   absolute_path(a.folder), fmt::join(outcome.waiting, " "));
    answer.exit_code = outcome.failed.empty() ? kExitVerdict : kExitDevice;
    return answer;
}

}  // namespace

void add_batch_options(CLI::App* command, BatchArguments& a) {
    command
        ->add_option(
            "--engine", a.engine,
            "local: here, on --jobs threads; slurm: as a job array, waits and collects; script: writes the "
            "tasks for GNU parallel or whatever else, and collects when they are done")
        ->check(CLI::IsMember({"local", "slurm", "script"}))
        ->capture_default_str();
    command
        ->add_option(
            "--folder", a.folder,
            "With an engine: the job's folder, under the same path on all computers. What is done there is "
            "kept: after a kill the same command goes on")
        ->type_name("DIR");
    command->add_option("--tasks", a.tasks, "With an engine: into how many it is split, --jobs threads each")
        ->check(CLI::Range(1, kMostTasks))
        ->capture_default_str();
    command
        ->add_option("--sbatch", a.sbatch,
                     "With slurm: a further argument of sbatch, --sbatch=--partition=short")
        ->type_name("ARGUMENT");
    command->add_option("--task", a.task, "What a task is told: which part of how many, 0/8")
        ->type_name("K/N");
    command->add_option("--task-out", a.task_out, "What a task is told: where its part goes")
        ->type_name("FILE");
}

std::string absolute_path(const std::string& file) {
    std::error_code error;
    return fs::absolute(file, error).lexically_normal().string();
}

json file_identity(const std::string& file) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    const auto time = fs::last_write_time(file, error);
    return {{"file", absolute_path(file)},
            {"bytes", error ? std::uintmax_t{0} : size},
            {"changed", error ? 0 : time.time_since_epoch().count()}};
}

Expected<Collected> collect(const BatchArguments& a, BatchJob job) {
    if (a.folder.empty())
        return usage_error("the job needs a folder", "--engine",
                           "give --folder DIR, which all computers see");
    job.tasks = a.tasks;
    job.what["program"] = SEAMWRIGHT_VERSION;
    BatchOptions options;
    options.engine = a.engine == "slurm" ? BatchEngine::slurm : BatchEngine::script;
    options.folder = a.folder;
    options.sbatch = a.sbatch;
    options.cancel = stop_on_signal();
    options.told = [](const Text& text) { fmt::print(stderr, "{}\n", text); };
    SEAM_TRY(auto outcome, run_batch(job, options));
    if (!outcome.complete()) return Collected{{}, incomplete_answer(a, job, outcome)};
    return Collected{std::move(outcome.parts), std::nullopt};
}

Expected<Answer> part_answer(const BatchArguments& a, const json& part) {
    if (a.task_out.empty()) return usage_error("the part needs a file", "--task", "give --task-out FILE");
    SEAM_OK(write_part(a.task_out, part));
    Answer answer;
    answer.json = {{"status", "ok"}, {"task", a.task}, {"file", a.task_out}};
    answer.text = fmt::format("part {} written\n", a.task);
    return answer;
}

}  // namespace seamwright::cli
