#pragma once
// A Slurm of a test's own: munged, slurmctld and slurmd of this computer as its one node, with keys, state, logs, ports and socket in a
// folder of its own; gone with the object. SLURM_CONF names it to the programs that are called meanwhile.

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace seamwright {

class SlurmServer {
  public:
    // nullptr: Slurm is not installed, or this user may start none; `why` says which.
    static std::unique_ptr<SlurmServer> start(int cpus, std::string& why);
    ~SlurmServer();
    SlurmServer(const SlurmServer&) = delete;
    SlurmServer& operator=(const SlurmServer&) = delete;

    const std::filesystem::path& folder() const { return folder_; }
    void kill_controller();  // -9; jobs go on
    bool resume_controller();
    // What a shell command prints.
    static std::string ask(const std::string& command);

  private:
    SlurmServer() = default;
    pid_t begin(const std::vector<std::string>& words, const std::string& log) const;
    bool answers() const;
    static void end(pid_t& child, int signal);
    std::filesystem::path folder_;
    pid_t munge_ = -1, controller_ = -1, node_ = -1;
};

}  // namespace seamwright
