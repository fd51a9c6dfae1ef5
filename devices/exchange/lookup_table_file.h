#pragma once
// A sensor's look-up table as a file.
//
// Format (version 1):
//   line 1   JSON on one line, at most 4096 bytes, ended by '\n':
//            {"format":"seamwright-lookup-table","version":1,"u0":px,"v0":px,"step_u":px,"step_v":px,
//             "columns":n,"rows":m}
//   then     columns * rows little-endian IEEE-754 doubles: x in mm, row by row (v slow, u fast)
//   then     columns * rows doubles: z in mm, in the same order
//   last     4 bytes, little-endian: CRC-32 (zlib's) of everything before
// A node is a hole when both of its numbers are NaN. Infinities do not occur. Nothing follows the CRC.

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

inline constexpr int kLookupTableNodes = 16'000'000;  // most nodes of a table file

// Bytes of the file. Error (input): sizes and vectors that disagree, steps not above 0, too many nodes,
// infinities, half a hole.
Expected<std::string> lookup_table_bytes(const LookupTable& table);
// Error (input): anything that differs from the format above; `where` names the source.
Expected<LookupTable> parse_lookup_table(std::string_view bytes, const std::string& where);

// Atomic write (write_text_file). Errors also of kind file.
Expected<void> write_lookup_table(const std::filesystem::path& path, const LookupTable& table);
Expected<LookupTable> read_lookup_table(const std::filesystem::path& path);

}  // namespace seamwright
