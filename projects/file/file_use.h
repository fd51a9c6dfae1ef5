#pragma once
// Who works with a project file. Two writers lose nothing (SQLite sees to that), but two desks would each
// hold an older state of the document and save over the other's edits, and two programs would command one
// robot.
//
// An advisory lock (flock) on a file beside it, FILE.seam.lock or FILE.seam.devices.lock, that names the
// holder. It ends with the process, however that ends; what a killed one left is taken over. Where no such
// file can be made (a folder that may only be read, a file system without locks) everybody may.

#include <filesystem>

#include "core/error.h"

namespace seamwright {

class FileUse {
  public:
    enum class For { desk, devices };
    // Error (usage): another one has it; says which program, process, computer and since when. Error (file):
    // something else stands in the place of the lock.
    static Expected<FileUse> take(const std::filesystem::path& file, For what);
    FileUse(FileUse&& other) noexcept;
    FileUse& operator=(FileUse&& other) noexcept;
    ~FileUse();

  private:
    FileUse(std::filesystem::path lock, int fd) : lock_(std::move(lock)), fd_(fd) {}
    std::filesystem::path lock_;
    int fd_ = -1;
};

}  // namespace seamwright
