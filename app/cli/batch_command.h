#pragma once
// How commands are split into tasks that other processes and machines run (projects/batch): --engine, and what a task is told.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "projects/batch/batch.h"
#include "projects/batch/parts.h"

namespace seamwright::cli {

struct BatchArguments {
    std::string engine = "local", folder;
    int tasks = 8;
    std::vector<std::string> sbatch;
    std::string task, task_out;  // of a task

    bool is_task() const { return !task.empty(); }
    bool is_split() const { return engine != "local"; }
};
void add_batch_options(CLI::App* command, BatchArguments& arguments);

// A file that a job reads, as it is: who it is, and whether it has changed.
nlohmann::json file_identity(const std::string& file);
std::string absolute_path(const std::string& file);

// Begins what is missing and waits. The parts when all are there; an Answer that says what is left or failed, exit 1 or 3, otherwise.
struct Collected {
    std::vector<nlohmann::json> parts;
    std::optional<Answer> incomplete;
};
Expected<Collected> collect(const BatchArguments& arguments, BatchJob job);
// A task's answer: its part is in its file.
Expected<Answer> part_answer(const BatchArguments& arguments, const nlohmann::json& part);

}  // namespace seamwright::cli
