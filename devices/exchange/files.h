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

// All or nothing: written beside `path`, flushed to disk and renamed over it, so that a crash leaves either
// the old file or the new one. A link is replaced by a file. Error (file) when the folder is missing or not
// writable.
Expected<void> write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace seamwright
