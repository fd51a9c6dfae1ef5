#pragma once
// Slurm's programs, as they are called and what they answer.

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright::slurm {

// Error (device): sbatch or squeue is not in PATH.
Expected<void> check_there();
// The number of the job. Error (device): it is refused, in Slurm's words.
Expected<std::string> submit(const std::filesystem::path& script, const std::vector<int>& tasks,
                             const std::vector<std::string>& more);
// The tasks of this user's arrays of that name that wait or run. Error (device): Slurm does not answer, which passes.
Expected<std::set<int>> living(const std::string& name);

}  // namespace seamwright::slurm
