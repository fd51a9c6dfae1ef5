#include "devices/quality/workbook.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xlsxwriter.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <set>
#include <utility>

#include "core/system_text.h"
#include "devices/exchange/files.h"

namespace seamwright {
namespace {

constexpr std::size_t kMostLines = 1'048'576, kMostColumns = 16'384, kLongestWords = 32'767;

// At most `count` characters of UTF-8.
std::string shortened(const std::string& text, std::size_t count) {
    std::size_t at = 0;
    for (std::size_t seen = 0; at < text.size(); ++at)
        if ((static_cast<unsigned char>(text[at]) & 0xc0) != 0x80 && seen++ == count) break;
    return text.substr(0, at);
}

// Excel compares names of sheets without regard to case.
std::string lowered(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return text;
}

std::string sheet_name(const std::string& wanted, std::set<std::string>& taken) {
    std::string name = wanted.empty() ? "-" : wanted;
    for (char& c : name)
        if (std::string_view("[]:*?/\\'").find(c) != std::string_view::npos ||
            static_cast<unsigned char>(c) < 0x20)
            c = '_';
    std::string tried = shortened(name, 31);
    for (int i = 2; !taken.insert(lowered(tried)).second; ++i)
        tried = fmt::format("{} ({})", shortened(name, 24), i);
    return tried;
}

class Closing {
  public:
    explicit Closing(lxw_workbook* book) : book_(book) {}
    Closing(const Closing&) = delete;
    Closing& operator=(const Closing&) = delete;
    ~Closing() {
        if (book_) workbook_close(book_);
    }
    lxw_workbook* get() const { return book_; }
    lxw_error close() { return workbook_close(std::exchange(book_, nullptr)); }

  private:
    lxw_workbook* book_;
};

void write_sheet(lxw_worksheet* sheet, const Sheet& table, lxw_format* bold) {
    std::vector<std::size_t> width;
    for (std::size_t r = 0; r < table.rows.size(); ++r)
        for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
            const auto row = static_cast<lxw_row_t>(r);
            const auto column = static_cast<lxw_col_t>(c);
            if (width.size() <= c) width.resize(c + 1, 9);
            if (const auto* number = std::get_if<double>(&table.rows[r][c])) {
                if (std::isfinite(*number)) worksheet_write_number(sheet, row, column, *number, nullptr);
            } else if (const auto* words = std::get_if<std::string>(&table.rows[r][c])) {
                if (r < 200) width[c] = std::clamp<std::size_t>(words->size() + 1, width[c], 60);
                worksheet_write_string(sheet, row, column, shortened(*words, kLongestWords).c_str(),
                                       r == 0 ? bold : nullptr);
            }
        }
    for (std::size_t c = 0; c < width.size(); ++c) {
        const auto column = static_cast<lxw_col_t>(c);
        worksheet_set_column(sheet, column, column, static_cast<double>(width[c]), nullptr);
    }
    worksheet_freeze_panes(sheet, 1, 0);
}

}  // namespace

Expected<void> write_workbook(const Workbook& workbook, const std::filesystem::path& path) {
    if (workbook.sheets.empty()) return input_error("the workbook has no sheet", path.string());
    for (const Sheet& sheet : workbook.sheets) {
        std::size_t columns = 0;
        for (const auto& row : sheet.rows) columns = std::max(columns, row.size());
        if (sheet.rows.size() > kMostLines || columns > kMostColumns)
            return input_error(Text("sheet \"{}\" has {} lines of {} columns, Excel holds {} of {}",
                                    sheet.name, sheet.rows.size(), columns, kMostLines, kMostColumns),
                               path.string(), "choose a shorter time");
    }
    SEAM_OK(check_replaceable(path));
    const auto failed = [&](const Text& why) {
        return file_error(Text("the workbook cannot be written: {}", why), path.string(),
                          "choose a folder that can be written to");
    };
    // Beside it first: what is half written never has its name.
    const std::string beside = fmt::format("{}.{}.part", path.string(), getpid());
    // The library says on stderr what it cannot open.
    if (!std::ofstream(beside)) return failed(system_text(errno));
    Closing book(workbook_new(beside.c_str()));
    if (!book.get()) return failed("no memory");
    lxw_format* bold = workbook_add_format(book.get());
    format_set_bold(bold);
    std::set<std::string> taken;
    for (const Sheet& table : workbook.sheets) {
        const std::string name = sheet_name(table.name, taken);
        lxw_worksheet* sheet = workbook_add_worksheet(book.get(), name.c_str());
        if (!sheet) return failed(name);
        write_sheet(sheet, table, bold);
    }
    std::error_code error;
    if (const lxw_error status = book.close(); status != LXW_NO_ERROR) {
        std::filesystem::remove(beside, error);
        return failed(std::string(lxw_strerror(status)));
    }
    std::filesystem::rename(beside, path, error);
    if (error) {
        const Text why = system_text(error);
        std::filesystem::remove(beside, error);
        return failed(why);
    }
    return {};
}

}  // namespace seamwright
