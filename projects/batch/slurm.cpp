#include "projects/batch/slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>

extern char** environ;

namespace seamwright::slurm {
namespace {

struct Said {
    int status = -1;  // of the program; -1: it did not begin or was killed
    std::string out, err;
};

// Waits for the end. What it writes on both channels is little.
Said ask(const std::vector<std::string>& words) {
    Said said;
    std::array<int, 2> out{-1, -1}, err{-1, -1};
    if (::pipe2(out.data(), O_CLOEXEC) != 0) return said;
    if (::pipe2(err.data(), O_CLOEXEC) != 0) {
        ::close(out[0]);
        ::close(out[1]);
        return said;
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, out[1], 1);
    posix_spawn_file_actions_adddup2(&actions, err[1], 2);
    std::vector<char*> arguments;
    std::vector<std::string> copies = words;
    for (std::string& word : copies) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = -1;
    const int begun = ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(out[1]);
    ::close(err[1]);
    const auto all_of = [](int channel) {
        std::string text;
        std::array<char, 4096> piece{};
        for (ssize_t n = 0; (n = ::read(channel, piece.data(), piece.size())) > 0;)
            text.append(piece.data(), static_cast<std::size_t>(n));
        ::close(channel);
        return text;
    };
    said.out = all_of(out[0]);
    said.err = all_of(err[0]);
    if (begun != 0) return said;
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status)) said.status = WEXITSTATUS(status);
    return said;
}

std::string last_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    const auto begin = text.rfind('\n');
    return begin == std::string::npos ? text : text.substr(begin + 1);
}

bool in_path(const std::string& program) {
    const char* const path = std::getenv("PATH");
    std::string folders = path ? path : "";
    for (std::size_t at = 0; at <= folders.size();) {
        const auto end = std::min(folders.find(':', at), folders.size());
        const std::string folder = folders.substr(at, end - at);
        if (!folder.empty() && ::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0)
            return true;
        at = end + 1;
    }
    return false;
}

}  // namespace

Expected<void> check_there() {
    for (const char* program : {"sbatch", "squeue"})
        if (!in_path(program))
            return device_error(Text("the program {} is not there", program), "--engine slurm",
                                "call it on a computer that submits to Slurm, or take --engine script");
    return {};
}

Expected<std::string> submit(const std::filesystem::path& script, const std::vector<int>& tasks,
                             const std::vector<std::string>& more) {
    std::string array;
    for (const int task : tasks) array += (array.empty() ? "" : ",") + std::to_string(task);
    std::vector<std::string> words{"sbatch", "--parsable", "--array=" + array};
    words.insert(words.end(), more.begin(), more.end());
    words.push_back(script.string());
    const Said said = ask(words);
    const std::string id = said.out.substr(0, said.out.find_first_of(";\n"));
    if (said.status != 0 || id.empty())
        return device_error(Text("Slurm refuses the job: {}", last_line(said.err + said.out)),
                            script.string());
    return id;
}

Expected<std::set<int>> living(const std::string& name) {
    const Said said = ask({"squeue", "--noheader", "--array", "--name=" + name,
                           "--user=" + std::to_string(::getuid()), "--format=%K"});
    if (said.status != 0)
        return device_error(Text("Slurm does not answer: {}", last_line(said.err + said.out)), "squeue");
    std::set<int> tasks;
    for (std::size_t at = 0; at < said.out.size();) {
        const auto end = std::min(said.out.find('\n', at), said.out.size());
        int task = -1;
        const auto begin = std::min(said.out.find_first_not_of(' ', at), end);
        if (std::from_chars(said.out.data() + begin, said.out.data() + end, task).ec == std::errc())
            tasks.insert(task);
        at = end + 1;
    }
    return tasks;
}

}  // namespace seamwright::slurm
