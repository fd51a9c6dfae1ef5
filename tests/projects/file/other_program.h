#pragma once
// Another program that has a project file or its devices.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "projects/file/file_use.h"

namespace seamwright {

// Killed at its end, as by a crash.
class OtherProgram {
  public:
    OtherProgram(const std::filesystem::path& file, FileUse::For what) {
        int ready[2];
        EXPECT_EQ(::pipe(ready), 0);
        pid_ = ::fork();
        if (pid_ == 0) {
            const auto use = FileUse::take(file, what);
            const char sign = use ? 'y' : 'n';
            (void)!::write(ready[1], &sign, 1);
            for (;;) ::pause();
        }
        char sign = 0;
        EXPECT_EQ(::read(ready[0], &sign, 1), 1);
        has_it = sign == 'y';
        ::close(ready[0]);
        ::close(ready[1]);
    }
    ~OtherProgram() {
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    OtherProgram(const OtherProgram&) = delete;
    OtherProgram& operator=(const OtherProgram&) = delete;
    pid_t pid() const { return pid_; }
    bool has_it = false;

  private:
    pid_t pid_ = 0;
};

}  // namespace seamwright
