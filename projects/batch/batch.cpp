#include "projects/batch/batch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "projects/batch/slurm.h"
#include "projects/file/project_json.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kLooksWithout =
    4;  // how often a task that is gone is looked for before it has failed: files come late
constexpr int kSilentLooks = 600;  // how often Slurm may not answer
constexpr std::size_t kLogRead = std::size_t{64} << 20;

std::string quoted(const std::string& word) {
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

fs::path part_file(const BatchOptions& o, int task) {
    return o.folder / fmt::format("part-{}.json", task);
}
fs::path log_file(const BatchOptions& o, int task) {
    return o.folder / fmt::format("log-{}.txt", task);
}

json identity_of(const BatchJob& job) {
    return {{"seamwright_batch", 1}, {"job", job.name}, {"what", job.what}, {"tasks", job.tasks}};
}

// Of the job's place and what it is, so that who comes back finds its tasks and nobody else's.
std::string slurm_name(const BatchJob& job, const BatchOptions& options) {
    return fmt::format("seamwright-{}-{:016x}", job.name,
                       std::hash<std::string>{}(options.folder.string() + identity_of(job).dump()));
}

// One who collects at a time.
class Lock {
  public:
    explicit Lock(const fs::path& path) : file_(::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {}
    ~Lock() {
        if (file_ >= 0) ::close(file_);
    }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    bool taken() const { return file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0; }

  private:
    int file_;
};

// A part that cannot be read is as none: its task is run again.
json read_part(const BatchJob& job, const BatchOptions& options, int task) {
    std::error_code error;
    const fs::path path = part_file(options, task);
    if (!fs::exists(path, error)) return nullptr;
    const auto text = read_text_file(path);
    auto part = text ? parse_json(*text, path.string()) : tl::unexpected(text.error());
    if (part && part->is_object() && part->value("part", json()) == task &&
        part->value("of", json()) == job.tasks)
        return std::move(*part);
    fs::remove(path, error);
    return nullptr;
}

// The last thing that a task said.
Text said_by(const fs::path& log) {
    auto text = read_text_file(log, kLogRead);
    if (!text) return "it left no log";
    while (!text->empty() && (text->back() == '\n' || text->back() == ' ')) text->pop_back();
    const auto begin = text->rfind('\n');
    std::string line = utf8_text(begin == std::string::npos ? *text : text->substr(begin + 1));
    if (line.empty()) return "it said nothing";
    return line;
}

Expected<void> write_folder(const BatchJob& job, const BatchOptions& options) {
    const fs::path file = options.folder / "job.json";
    std::error_code error;
    if (fs::exists(file, error)) {
        SEAM_TRY(const auto text, read_text_file(file));
        const auto there = parse_json(text, file.string());
        if (!there || *there != identity_of(job))
            return usage_error("the folder holds another job, or what that reads has changed since",
                               options.folder.string(), "name another folder, or delete this one");
    } else {
        SEAM_OK(write_text_file(file, identity_of(job).dump(1) + "\n"));
    }
    SEAM_OK(write_text_file(options.folder / "task", task_script(job, options, fs::current_path(error))));
    fs::permissions(options.folder / "task",
                    fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec, error);
    return write_text_file(options.folder / "job.sbatch", slurm_script(job, options));
}

class Waiting {
  public:
    Waiting(const BatchJob& job, const BatchOptions& options) : job_(job), o_(options) {
        out_.parts.assign(static_cast<std::size_t>(job.tasks), nullptr);
    }

    Expected<BatchOutcome> run() {
        take_parts();
        if (o_.engine == BatchEngine::script) return finished();
        if (missing().empty()) return finished();
        SEAM_OK(slurm::check_there());
        SEAM_TRY(auto living, slurm::living(name_));
        std::vector<int> begin;
        for (const int task : missing())
            if (!living.contains(task)) begin.push_back(task);
        if (!living.empty()) tell(Text("{} tasks are on their way already", living.size()));
        if (!begin.empty()) {
            for (const int task : begin) {
                std::error_code error;
                fs::remove(log_file(o_, task), error);  // of the time before
            }
            SEAM_TRY(const auto id, slurm::submit(o_.folder / "job.sbatch", begin, o_.sbatch));
            tell(Text("Slurm has {} tasks as job {}", begin.size(), id));
        }
        SEAM_OK(wait());
        return finished();
    }

  private:
    void tell(const Text& text) const {
        if (o_.told) o_.told(text);
    }
    std::vector<int> missing() const {
        std::vector<int> tasks;
        for (int task = 0; task < job_.tasks; ++task)
            if (out_.parts[static_cast<std::size_t>(task)].is_null()) tasks.push_back(task);
        return tasks;
    }
    void take_parts() {
        std::size_t taken = 0;
        for (const int task : missing()) {
            json part = read_part(job_, o_, task);
            if (part.is_null()) continue;
            out_.parts[static_cast<std::size_t>(task)] = std::move(part);
            ++taken;
        }
        if (taken > 0)
            tell(Text("{} of {} tasks are done", static_cast<std::size_t>(job_.tasks) - missing().size(),
                      job_.tasks));
    }

    Expected<void> wait() {
        std::vector<int> without(static_cast<std::size_t>(job_.tasks), 0);
        for (int silent = 0; !o_.cancel.stop_requested();) {
            take_parts();
            if (missing().empty()) return {};
            const auto living = slurm::living(name_);
            if (!living) {
                if (silent++ == 0) tell(living.error().text());
                if (silent > kSilentLooks) return tl::unexpected(living.error());
            } else {
                silent = 0;
                // What ended after it was asked has left its part by the next look.
                bool any = false;
                for (const int task : missing()) {
                    int& looks = without[static_cast<std::size_t>(task)];
                    looks = living->contains(task) ? 0 : looks + 1;
                    any = any || looks < kLooksWithout;
                }
                if (!any) {
                    take_parts();
                    for (const int task : missing())
                        out_.failed.push_back({task, said_by(log_file(o_, task)), log_file(o_, task)});
                    return {};
                }
            }
            std::this_thread::sleep_for(o_.look_every);
        }
        return {};
    }

    BatchOutcome finished() {
        if (out_.failed.empty()) out_.waiting = missing();
        return std::move(out_);
    }

    const BatchJob& job_;
    const BatchOptions& o_;
    std::string name_ = slurm_name(job_, o_);
    BatchOutcome out_;
};

}  // namespace

std::string task_script(const BatchJob& job, const BatchOptions& options, const fs::path& working) {
    std::string command = quoted(options.program.string());
    for (const std::string& word : job.words) command += " " + quoted(word);
    const std::string folder = quoted(options.folder.string());
    return fmt::format(
        "#!/bin/sh\n"
        "# Task $1 of {0} ({1}), from 0 on. All of them that are left, on this computer:\n"
        "#   parallel {2}/task ::: $(seq 0 {3})\n"
        "part={2}/part-$1.json\n"
        "[ -e \"$part\" ] && exit 0\n"
        "exec >{2}/log-$1.txt 2>&1\n"
        "cd {4} || exit 3\n"
        "{5} --task \"$1/{0}\" --task-out \"$part\" </dev/null\n"
        "code=$?\n"
        "[ $code -eq 0 ] || echo \"the task ended with code $code\"\n"
        "exit $code\n",
        job.tasks, job.name, folder, job.tasks - 1, quoted(working.string()), command);
}

std::string slurm_script(const BatchJob& job, const BatchOptions& options) {
    // Slurm reads its own lines without a shell: what it says itself goes beside the logs, a % in the path is doubled.
    std::string said;
    for (const char c : (options.folder / "slurm-").string())
        said += c == '%' ? std::string("%%") : std::string(1, c);
    return fmt::format(
        "#!/bin/sh\n"
        "#SBATCH --job-name={}\n"
        "#SBATCH --cpus-per-task={}\n"
        "#SBATCH --output=\"{}%a.txt\"\n"
        "#SBATCH --open-mode=append\n"
        "exec {}/task \"$SLURM_ARRAY_TASK_ID\"\n",
        slurm_name(job, options), job.threads, said, quoted(options.folder.string()));
}

Expected<void> write_part(const fs::path& path, const json& part) {
    return write_text_file(path, part.dump() + "\n");
}

Expected<BatchOutcome> run_batch(const BatchJob& job, const BatchOptions& given) {
    if (job.tasks < 1 || job.tasks > kMostTasks)
        return usage_error(Text("{} tasks are not possible", job.tasks), "--tasks",
                           Text("give 1 to {}", kMostTasks));
    BatchOptions options = given;
    if (options.engine == BatchEngine::slurm) SEAM_OK(slurm::check_there());
    std::error_code error;
    if (options.program.empty()) options.program = fs::read_symlink("/proc/self/exe", error);
    if (error)
        return file_error(Text("where this program lies is not known: {}", system_text(error)),
                          "/proc/self/exe");
    options.folder = fs::absolute(options.folder, error).lexically_normal();
    for (const char c : options.folder.string())
        if (static_cast<unsigned char>(c) < 0x20 || c == '"' || c == '\\')
            return usage_error("this folder's name cannot stand in a job of Slurm", options.folder.string(),
                               "name one without quotes, backslashes and control characters");
    fs::create_directories(options.folder, error);
    if (error)
        return file_error(Text("the folder cannot be made: {}", system_text(error)), options.folder.string());
    const Lock lock(options.folder / "lock");
    if (!lock.taken())
        return usage_error("somebody else collects this job at the moment", options.folder.string());
    SEAM_OK(write_folder(job, options));
    return Waiting(job, options).run();
}

}  // namespace seamwright
