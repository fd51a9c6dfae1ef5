#pragma once
// Files as text: size-limited reading, atomic writing.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kTextFileLimit = std::size_t{256} << 20;  // bytes

// Whole file. Error (file): missing, a folder, unreadable, longer than `limit_bytes`. Devices and pipes are
// read up to the limit. Text is handed over as it is, bytes beyond ASCII included.
Expected<std::string> read_text_file(const std::filesystem::path& path,
                                     std::size_t limit_bytes = kTextFileLimit);

// The only function by which our programs write a file.
//
// A regular file, or a new one: all or nothing, written beside it, flushed to disk and renamed over it, so
// that a crash leaves either the old file or the new one. A link stays: what it leads to is written so. A
// device, a FIFO and a descriptor of this process (/dev/stdout, /dev/fd/3, /proc/self/fd/1) stay too: written
// through, as a shell writes, and a FIFO is waited for until somebody reads it. Error (file) when the folder
// is missing or not writable. Error (input) where a project, a recording or another database (SQLite) stands, which what is
// written here never takes the place of, and of a path that begins as an option does ("--help").
Expected<void> write_text_file(const std::filesystem::path& path, std::string_view text);

// Error (input) where that stands.
Expected<void> check_replaceable(const std::filesystem::path& path);

// Where a file of this name comes to stand: behind the links that the name leads through, which need not lead
// to a file yet. `path` itself where it is no link.
std::filesystem::path behind_links(const std::filesystem::path& path);

}  // namespace seamwright
