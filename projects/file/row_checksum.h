#pragma once
// The checksums of a project file's rows: a bit that a disk or a cable turned over is noticed before a pose
// or a limit is used. One column a row, `checksum`, over all that the row says.
//
// captures and images have none: their data carries its own (profile_blob.h, the column crc), and their keys
// stand a second time in an index that SQLite holds them against when the file is opened.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "devices/capture/sqlite.h"

namespace seamwright {

struct ChecksummedTable {
    const char* name;
    const char* key;      // what a sentence names a row by
    const char* columns;  // all but the checksum, in order
    int since = 5;        // the first version of the file that has the table, or its checksums
};
std::span<const ChecksummedTable> checksummed_tables();

// Error (file) when a row of the table contradicts its checksum, naming the row; of the rows whose `column`
// is `value` where a column is given.
Expected<void> check_rows(Database& db, std::string_view table, const char* column = nullptr,
                          std::int64_t value = 0);
// Gives the row whose `column` is `value` its checksum: after it was written, where its number is SQLite's.
Expected<void> seal_row(Database& db, std::string_view table, const char* column, std::int64_t value);

}  // namespace seamwright
