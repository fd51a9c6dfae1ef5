#pragma once
// Processes that are killed while they write to a project file, and forged files.

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace seamwright {

// `kills` times: a child appends runs and edits to one file and reports each commit through a pipe, SIGKILL
// hits it at a random instant; then the file must open, be sound, and hold every reported run and edit (and
// at most one more). `write_ahead`: with the journal of connected devices (ProjectFile::keep_write_ahead).
void kill_while_appending(int kills, unsigned seed, bool write_ahead);

// Puts the right checksum on a changed blob.
void set_blob_checksum(std::vector<std::byte>& blob);

// Gives every row of a changed project file its checksum.
void seal_all_rows(const std::filesystem::path& path);

// A project file of an older schema version from tests/data/version<N>.sql.
void make_old_version(const std::filesystem::path& path, int version);

}  // namespace seamwright
