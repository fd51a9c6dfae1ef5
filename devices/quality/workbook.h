#pragma once
// Tables as an Excel workbook (*.xlsx, by libxlsxwriter): a sheet a table, the first line its head in bold and frozen.

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/error.h"

namespace seamwright {

// Blank, a number, or words; numbers that are not finite stay blank. Words are never read as a formula.
using Cell = std::variant<std::monostate, double, std::string>;
struct Sheet {
    std::string
        name;  // cut to 31 letters, signs that Excel forbids become '_'; made different from the others
    std::vector<std::vector<Cell>> rows;
};
struct Workbook {
    std::vector<Sheet> sheets;
};

// All or nothing, replaces an existing file. Error (input): no sheet, more lines or columns than a sheet has; (file):
// it cannot be written.
Expected<void> write_workbook(const Workbook& workbook, const std::filesystem::path& path);

}  // namespace seamwright
