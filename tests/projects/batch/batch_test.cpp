// A job's folder: its scripts do what they say under sh, what is done is kept, and what cannot be is refused.

#include "projects/batch/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "devices/exchange/files.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

class Batch : public testing::Test {
  protected:
    void SetUp() override {
        options.engine = BatchEngine::script;
        options.folder = scratch / "a job's $folder";
        options.program = scratch / "the program";
        // Leaves its words, and its part where the word "well" is among them or the task is an even one.
        std::ofstream(options.program)
            << "#!/bin/sh\n"
               "echo \"$@\"\n"
               "while [ $# -gt 2 ]; do word=$1; shift; "
               "[ \"$word\" = --task ] && task=$1; [ \"$word\" = \"it's well\" ] && well=1; done\n"
               "k=${task%/*}\n"
               "if [ -z \"$well\" ] && [ $((k % 2)) = 1 ]; then echo 'the stripe is gone' >&2; exit 2; fi\n"
               "echo \"{\\\"part\\\": $k, \\\"of\\\": ${task#*/}, \\\"value\\\": $((k * k))}\" >\"$2\"\n";
        fs::permissions(options.program, fs::perms::owner_all);
        job.name = "replay";
        job.what = {{"file", "a.seam"}};
        job.words = {"replay", "a b.seam", "$(false)"};
        job.tasks = 4;
    }
    int task(int k) const {
        std::string command = "'";
        for (const char c : (options.folder / "task").string())
            command += c == '\'' ? std::string("'\\''") : std::string(1, c);
        const int status = std::system((command + "' " + std::to_string(k)).c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    BatchOutcome outcome() const {
        auto done = run_batch(job, options);
        EXPECT_TRUE(done) << done.error().sentence();
        return done ? std::move(*done) : BatchOutcome{};
    }
    std::string refused() const {
        const auto done = run_batch(job, options);
        return done ? std::string("it went well") : done.error().sentence();
    }

    TemporaryFolder scratch;
    BatchJob job;
    BatchOptions options;
};

TEST_F(Batch, ItsScriptMakesPartsThatTheSameCallCollects) {
    EXPECT_THAT(outcome().waiting, ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(task(2), 0);
    EXPECT_EQ(task(1), 2) << "what the program answered";
    EXPECT_THAT(outcome().waiting, ElementsAre(0, 1, 3));
    EXPECT_THAT(*read_text_file(options.folder / "log-2.txt"),
                HasSubstr("replay a b.seam $(false) --task 2/4 --task-out"));
    EXPECT_THAT(*read_text_file(options.folder / "log-1.txt"), HasSubstr("the stripe is gone"));
    EXPECT_FALSE(fs::exists(options.folder / "part-1.json"));
    job.words.push_back("it's well");
    EXPECT_THAT(outcome().waiting, ElementsAre(0, 1, 3))
        << "the words are of the tasks, not of what the job is";
    // What is there is not made again.
    std::ofstream(options.folder / "log-2.txt") << "untouched";
    for (int k = 0; k < 4; ++k) EXPECT_EQ(task(k), 0);
    EXPECT_EQ(*read_text_file(options.folder / "log-2.txt"), "untouched");
    const BatchOutcome done = outcome();
    ASSERT_TRUE(done.complete());
    for (int k = 0; k < 4; ++k) EXPECT_EQ(done.parts[static_cast<std::size_t>(k)]["value"], k * k);
}

TEST_F(Batch, ADamagedPartIsAsNone) {
    outcome();
    for (int k = 0; k < 4; k += 2) EXPECT_EQ(task(k), 0);
    std::ofstream(options.folder / "part-0.json") << "{\"part\": 0, \"of\": 4, \"val";
    std::ofstream(options.folder / "part-1.json") << "{\"part\": \"one\", \"of\": []}";
    std::ofstream(options.folder / "part-3.json") << "[]";
    EXPECT_THAT(outcome().waiting, ElementsAre(0, 1, 3));
    EXPECT_FALSE(fs::exists(options.folder / "part-0.json")) << "so that its task makes it again";
}

TEST_F(Batch, AnotherJobInTheFolderIsRefused) {
    outcome();
    job.what["file"] = "b.seam";
    EXPECT_THAT(refused(), HasSubstr("another job"));
    job.what["file"] = "a.seam";
    job.tasks = 5;
    EXPECT_THAT(refused(), HasSubstr("another job"));
    job.tasks = 4;
    EXPECT_EQ(outcome().waiting.size(), 4u);
    std::ofstream(options.folder / "job.json") << "{";
    EXPECT_THAT(refused(), HasSubstr("another job"));
}

TEST_F(Batch, WhatCannotBeIsSaid) {
    for (const int tasks : {0, -1, kMostTasks + 1}) {
        job.tasks = tasks;
        EXPECT_THAT(refused(), HasSubstr("tasks are not possible"));
    }
    job.tasks = 4;
    options.folder = scratch / "with \"quotes\"";
    EXPECT_THAT(refused(), HasSubstr("cannot stand in a job of Slurm"));
    std::ofstream(scratch / "file") << "x";
    options.folder = scratch / "file" / "folder";
    EXPECT_THAT(refused(), HasSubstr("cannot be made"));
}

// On a computer without Slurm: one sentence, and no folder is left behind.
TEST_F(Batch, WithoutSlurmItSaysSo) {
    options.engine = BatchEngine::slurm;
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", scratch.path().c_str(), 1);
    const auto done = run_batch(job, options);
    ::setenv("PATH", path.c_str(), 1);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::device);
    EXPECT_THAT(done.error().sentence(), HasSubstr("the program sbatch is not there"));
    EXPECT_FALSE(fs::exists(options.folder));
}

TEST_F(Batch, TheJobArrayIsNamedByItsFolderAndWhatItIs) {
    const auto name = [&] {
        const std::string script = slurm_script(job, options);
        const auto at = script.find("--job-name=");
        return script.substr(at, script.find('\n', at) - at);
    };
    job.threads = 3;
    EXPECT_THAT(slurm_script(job, options), HasSubstr("#SBATCH --cpus-per-task=3\n"));
    EXPECT_THAT(slurm_script(job, options), HasSubstr("task \"$SLURM_ARRAY_TASK_ID\"\n"));
    const std::string before = name();
    EXPECT_EQ(name(), before);
    job.what["file"] = "b.seam";
    EXPECT_NE(name(), before);
    job.what["file"] = "a.seam";
    options.folder = scratch / "100% another";
    EXPECT_NE(name(), before);
    EXPECT_THAT(slurm_script(job, options), HasSubstr("100%% another/slurm-%a.txt"));
}

}  // namespace
}  // namespace seamwright
