// The plug is pulled at random moments of a person's work, half of them around a save. What the studio has
// called kept or saved must be there at the next start, and the restore question must be asked exactly when
// the kept edits differ from the saved file, as an own look at both files says.

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <random>
#include <thread>

#include "app/studio/demo_project.h"
#include "tests/app/studio/kill_protocol.h"
#include "widgets/desk/recovery.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kKills = 25;
constexpr std::chrono::milliseconds kPatience{40000};
constexpr int kStartUs = 1200000, kWorkUs = 2000000, kSavingUs = 60000, kSavedUs = 2000;

// The two files as they lie there, read without the desk.
struct OnDisk {
    std::uint64_t saved = 0;
    std::optional<std::uint64_t> kept;
    bool differs = false;  // in anything, also in what is no edit
    std::size_t runs = 0;
    std::uint64_t effective() const { return kept.value_or(saved); }
};
OnDisk look(const fs::path& file) {
    OnDisk disk;
    auto opened = ProjectFile::open(file, FileAccess::read_only);
    EXPECT_TRUE(opened) << opened.error().sentence();
    if (!opened) return disk;
    for (const Error& finding : opened->check()) ADD_FAILURE() << finding.sentence();
    const Project saved = opened->load().value();
    disk.saved = fingerprint(saved);
    disk.runs = opened->runs().value().size();
    if (!fs::exists(recovery_path(file))) return disk;
    auto kept = ProjectFile::open(recovery_path(file), FileAccess::read_only);
    EXPECT_TRUE(kept) << kept.error().sentence();
    if (!kept) return disk;
    const Project edits = kept->load().value();
    disk.kept = fingerprint(edits);
    disk.differs = exact_text(edits) != exact_text(saved) || edits.part.mesh_ply != saved.part.mesh_ply;
    return disk;
}

struct Killed {
    std::vector<KillMessage> said;
    int status = 0;
};

class Plug {
  public:
    Plug(const fs::path& file, const fs::path& folder, int seed) {
        int ends[2];
        EXPECT_EQ(::pipe(ends), 0);
        pid_ = ::fork();
        if (pid_ == 0) {
            ::close(ends[0]);
            ::setenv("SEAMWRIGHT_KILL_FILE", file.c_str(), 1);
            ::setenv("SEAMWRIGHT_KILL_FOLDER", folder.c_str(), 1);
            ::setenv("SEAMWRIGHT_KILL_PIPE", std::to_string(ends[1]).c_str(), 1);
            ::setenv("SEAMWRIGHT_KILL_SEED", std::to_string(seed).c_str(), 1);
            ::execl(SEAMWRIGHT_STUDIO_TO_KILL, SEAMWRIGHT_STUDIO_TO_KILL, "--gtest_brief=1", nullptr);
            ::_exit(127);
        }
        ::close(ends[1]);
        pipe_ = ends[0];
    }
    ~Plug() { ::close(pipe_); }
    Plug(const Plug&) = delete;
    Plug& operator=(const Plug&) = delete;

    // Listens until `end`, or the message `until` has come.
    bool listen(Clock::time_point end, char until = 0) {
        for (;;) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
            if (left <= 0) return false;
            pollfd wait{pipe_, POLLIN, 0};
            if (::poll(&wait, 1, static_cast<int>(left)) <= 0) continue;
            KillMessage message;
            if (::read(pipe_, &message, sizeof message) != sizeof message) return false;  // it ended itself
            said_.push_back(message);
            if (message.kind == until) return true;
        }
    }
    Killed pull() {
        Killed killed;
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, &killed.status, 0);
        KillMessage message;
        while (::read(pipe_, &message, sizeof message) == sizeof message) said_.push_back(message);
        killed.said = std::move(said_);
        return killed;
    }

  private:
    pid_t pid_ = -1;
    int pipe_ = -1;
    std::vector<KillMessage> said_;
};

// What may and what must be on the disk, from what was there at the start and what was said since.
struct Expectation {
    OnDisk start;
    std::uint64_t committed, saved;
    std::vector<std::uint64_t> since;  // made, but not called kept
    std::vector<std::uint64_t> being_saved;
    bool acting = false;  // what is not said yet may be there
    bool asked = false, ready = false;
    bool nothing_since_save = false;
    std::size_t runs;

    explicit Expectation(const OnDisk& disk)
        : start(disk), committed(disk.effective()), saved(disk.saved), runs(disk.runs) {}

    void hear(const KillMessage& m) {
        if (m.kind == kill_message::made || m.kind == kill_message::saving) nothing_since_save = false;
        switch (m.kind) {
            case kill_message::asked:
                EXPECT_TRUE(start.differs) << "asked with nothing to restore";
                asked = true;
                break;
            case kill_message::forgets:
                since = {start.saved};
                break;
            case kill_message::ready:
                EXPECT_EQ(asked, start.differs) << "the question";
                EXPECT_EQ(m.value, since.empty() ? start.effective() : start.saved) << "the answer";
                ready = true;
                break;
            case kill_message::begins:
                acting = true;
                break;
            case kill_message::made:
                since.push_back(m.value);
                break;
            case kill_message::kept:
                commit(m.value);
                break;
            case kill_message::saving:
                being_saved = {since.empty() ? committed : since.back()};
                break;
            case kill_message::saved:
                EXPECT_EQ(m.value, being_saved.at(0));
                commit(saved = m.value);
                being_saved.clear();
                nothing_since_save = true;
                break;
            case kill_message::runs:
                runs = m.value;
                break;
            case kill_message::ended:
                acting = false;
                break;
            default:
                ADD_FAILURE() << "unknown message " << m.kind;
        }
    }
    void commit(std::uint64_t value) {
        committed = value;
        since.clear();
    }
    void meet(const OnDisk& disk) const {
        const auto among = [](std::uint64_t value, const std::vector<std::uint64_t>& list) {
            return std::find(list.begin(), list.end(), value) != list.end();
        };
        // Kept within the action, before it is said: also an undo that comes back to what was saved. Edits that
        // were dropped leave no kept file.
        EXPECT_TRUE(disk.effective() == committed || among(disk.effective(), since) || (acting && disk.kept))
            << "what was committed is lost";
        EXPECT_TRUE(disk.saved == saved || among(disk.saved, being_saved)) << "the saved file";
        EXPECT_GE(disk.runs, runs) << "a run is lost";
        EXPECT_LE(disk.runs, runs + 1);
    }
};

TEST(StudioKilled, NothingCommittedIsLostAndTheQuestionComesWhenThereIsSomethingToRestore) {
    TemporaryFolder folder;
    const fs::path file = folder / "door.seam";
    ASSERT_TRUE(ProjectFile::create(file, demo_project().value()));
    std::mt19937 rng(20);
    std::map<std::string, int> count;
    OnDisk disk = look(file);
    for (int i = 0; i <= kKills && !HasFailure(); ++i) {
        SCOPED_TRACE("kill " + std::to_string(i));
        Plug plug(file, folder.path(), 1000 + i);
        const auto start = Clock::now();
        const bool last = i == kKills;  // only looks
        const auto within = [&](int most_us) {
            return std::chrono::microseconds(rng() % static_cast<unsigned>(most_us));
        };
        if (last) {
            plug.listen(start + kPatience, kill_message::ready);
        } else if (i % 2 == 0) {
            const bool starts = i % 8 == 0;
            if (starts || plug.listen(start + kPatience, kill_message::ready))
                plug.listen(Clock::now() + within(starts ? kStartUs : kWorkUs));
        } else {
            const bool during = i % 4 == 1;
            if (plug.listen(start + kPatience, during ? kill_message::saving : kill_message::saved))
                std::this_thread::sleep_for(within(during ? kSavingUs : kSavedUs));
        }
        const Killed killed = plug.pull();
        ASSERT_TRUE(WIFSIGNALED(killed.status))
            << "the studio ended by itself with " << WEXITSTATUS(killed.status);
        Expectation expected(disk);
        for (const KillMessage& message : killed.said) expected.hear(message);
        ++count[!expected.ready  ? "while starting"
                : expected.asked ? "after the question"
                                 : "without the question"];
        if (!expected.being_saved.empty()) ++count["in the midst of a save"];
        if (expected.nothing_since_save) ++count["right after a save"];
        disk = look(file);
        expected.meet(disk);
        ++count[disk.differs ? "something to restore" : "nothing to restore"];
        if (disk.kept && !disk.differs) ++count["kept as saved"];
        if (fs::exists(file.string() + "-journal") || fs::exists(file.string() + "-wal"))
            ++count["journal left"];
    }
    for (const auto& [what, times] : count) std::printf("%s: %d\n", what.c_str(), times);
    for (const auto& entry : fs::directory_iterator(folder.path()))
        std::printf("left: %s\n", entry.path().filename().c_str());
    // It could have failed.
    EXPECT_GE(count["while starting"], kKills / 16);
    EXPECT_GE(count["after the question"], kKills / 5);
    EXPECT_GE(count["without the question"], kKills / 5);
    EXPECT_GE(count["right after a save"], kKills / 10);
    EXPECT_GE(count["in the midst of a save"], kKills / 16);
}

}  // namespace
}  // namespace seamwright
