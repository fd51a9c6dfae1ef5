#pragma once
// A job of many tasks, each a process of this program that leaves a part in the job's folder: begun by Slurm, or by whoever runs the
// folder's script.
//
//     FOLDER/job.json     what the job is; a folder holds one
//     FOLDER/task         task K of it: FOLDER/task K (sh)
//     FOLDER/job.sbatch   the job array, for Slurm
//     FOLDER/part-K.json  what task K left, all or nothing
//     FOLDER/log-K.txt    what it said
//
// The folder is the state, all of it: who collects may be killed and goes on with the same command, the tasks do not notice. Tasks
// whose part is there are not run again; of the others those are begun that Slurm does not have already. On other machines the folder,
// the project and this program have to lie under the same paths.

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

inline constexpr int kMostTasks = 1000;  // Slurm's MaxArraySize is 1001 unless it is told otherwise

struct BatchJob {
    std::string name;  // "replay"
    // Of the command and of what it reads: a folder that holds a job of other words is refused.
    nlohmann::json what;
    // Of the program, without its name; a task adds --task K/N --task-out FILE.
    std::vector<std::string> words;
    int tasks = 1;
    int threads = 1;  // of each task
};

enum class BatchEngine {
    slurm,   // begins what is missing, and waits
    script,  // writes the folder; somebody else begins the tasks, GNU parallel for example
};

struct BatchOptions {
    BatchEngine engine = BatchEngine::slurm;
    std::filesystem::path folder;
    std::filesystem::path program;    // this one; empty: as /proc/self/exe says
    std::vector<std::string> sbatch;  // further arguments of sbatch: {"--partition=short"}
    std::stop_token cancel = {};      // stops waiting, not the tasks
    std::function<void(const Text&)> told = {};
    std::chrono::milliseconds look_every{500};
};

struct FailedTask {
    int task = 0;
    Text why;
    std::filesystem::path log;
};

struct BatchOutcome {
    std::vector<nlohmann::json> parts;  // by task, null where there is none
    std::vector<int> waiting;           // not begun, or still running when waiting was stopped
    std::vector<FailedTask> failed;
    bool complete() const { return waiting.empty() && failed.empty(); }
};
// Parts that are there are kept whatever happens. Error (usage): tasks that are none, a folder with another job; (file): the folder;
// (device): no Slurm, or it refuses the job.
Expected<BatchOutcome> run_batch(const BatchJob& job, const BatchOptions& options);

// Of one task: the part as its file.
Expected<void> write_part(const std::filesystem::path& path, const nlohmann::json& part);

// What the folder's files say; for who writes them and for tests.
std::string task_script(const BatchJob& job, const BatchOptions& options,
                        const std::filesystem::path& working);
std::string slurm_script(const BatchJob& job, const BatchOptions& options);

}  // namespace seamwright
