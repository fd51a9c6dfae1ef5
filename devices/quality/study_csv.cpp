#include "devices/quality/study_csv.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/number_text.h"
#include "core/profile/units.h"
#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/profile_layout.h"

namespace seamwright {
namespace {

constexpr const char* kHeader = "the first line must name part,rehang,run,value[,reference]";
enum Column { kPart, kRehang, kRun, kValue, kReference, kColumns };
constexpr std::array<std::string_view, kColumns> kStudyColumns{"part", "rehang", "run", "value", "reference"};

struct StudyTable {
    char separator = ',';
    bool decimal_comma = false;
    std::size_t width = 0;
    std::array<int, kColumns> columns{-1, -1, -1, -1, -1};
    std::array<double, kColumns> mm{1, 1, 1, 1, 1};
};

Expected<StudyTable> header_of(std::string_view line, const std::string& at) {
    StudyTable table;
    table.separator = line.find(';') != std::string_view::npos    ? ';'
                      : line.find('\t') != std::string_view::npos ? '\t'
                                                                  : ',';
    const auto names = text_fields(line, table.separator);
    table.width = names.size();
    for (std::size_t c = 0; c < names.size(); ++c) {
        const ColumnName name = column_name(names[c]);
        for (std::size_t w = 0; w < kColumns; ++w) {
            if (name.name != kStudyColumns[w]) continue;
            if (table.columns[w] >= 0)
                return input_error(Text("the column {} is named twice", kStudyColumns[w]), at);
            table.columns[w] = static_cast<int>(c);
            const std::string& unit = name.unit.empty() ? name.unknown : name.unit;
            if (unit.empty() || w < kValue) continue;
            const auto mm = mm_of_unit(unit);
            if (!mm)
                return input_error(Text("\"{}\" is no unit of length", csv::shown(unit)), at,
                                   "give millimetres");
            table.mm[w] = *mm;
        }
    }
    for (const Column needed : {kPart, kRun, kValue})
        if (table.columns[needed] < 0)
            return input_error(
                Text("the header \"{}\" has no column {}", csv::shown(line), kStudyColumns[needed]), at,
                kHeader);
    return table;
}

// In quotes, two quotes are one.
std::string name_of_field(std::string_view field) {
    std::string text(field);
    for (std::size_t at = 0; (at = text.find("\"\"", at)) != std::string::npos; ++at) text.erase(at, 1);
    return text;
}

class StudyReader {
  public:
    StudyReader(const StudyTable& table, const std::vector<std::string_view>& fields, std::string at)
        : table_(table), fields_(fields), at_(std::move(at)) {}
    std::string_view field(Column column) const {
        const int c = table_.columns[column];
        return c < 0 ? std::string_view{} : csv::trimmed(fields_[static_cast<std::size_t>(c)]);
    }
    Expected<double> millimetres(Column column) const {
        const std::string_view text = field(column), name = kStudyColumns[column];
        double value = 0;
        if (!text_number(text, table_.decimal_comma, value)) {
            const bool comma = !table_.decimal_comma && text.find(',') != std::string_view::npos;
            return input_error(Text("{} = \"{}\" is no number", name, csv::shown(text)), at_,
                               comma ? "separate the columns by semicolons, or write decimal points"
                               : table_.decimal_comma ? "write all numbers with a decimal comma, or none"
                                                      : "");
        }
        value *= table_.mm[column];
        if (!std::isfinite(value)) return input_error(Text("{} is missing", name), at_);
        if (std::abs(value) > 1e6)
            return input_error(Text("{} = {} mm is beyond 1 km", name, value), at_, "give millimetres");
        return value;
    }
    Expected<StudyValue> value() const {
        StudyValue v;
        v.part = name_of_field(field(kPart));
        if (v.part.empty()) return input_error("the part is missing", at_);
        v.rehang = name_of_field(field(kRehang));
        if (v.rehang.empty()) v.rehang = "1";
        const auto run = number_from<long>(field(kRun));
        if (!run) return input_error(Text("run = \"{}\" is no whole number", csv::shown(field(kRun))), at_);
        v.run = *run;
        SEAM_TRY(const auto mm, millimetres(kValue));
        v.value_mm = mm;
        if (!field(kReference).empty()) {
            SEAM_TRY(const auto reference, millimetres(kReference));
            v.reference_mm = reference;
        }
        return v;
    }

  private:
    const StudyTable& table_;
    const std::vector<std::string_view>& fields_;
    std::string at_;
};

}  // namespace

Expected<std::vector<StudyValue>> parse_study_csv(std::string_view text, const std::string& where) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        return input_error("the text is UTF-16", where, "save it as UTF-8 or plain ASCII");
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    csv::Lines lines(text);
    std::string_view line;
    while (lines.next(line))
        if (!csv::blanks_off(line).empty()) break;
    if (csv::blanks_off(line).empty()) return input_error("the file is empty", where, kHeader);
    const auto at = [&] { return fmt::format("{}, line {}", where, lines.number()); };
    SEAM_TRY(auto table, header_of(line, at()));

    // A decimal comma anywhere makes it the decimal sign everywhere.
    csv::Lines ahead = lines;
    if (table.separator != ',')
        while (!table.decimal_comma && ahead.next(line)) {
            const auto fields = text_fields(line, table.separator);
            for (const Column c : {kValue, kReference})
                if (table.columns[c] >= 0 && static_cast<std::size_t>(table.columns[c]) < fields.size() &&
                    fields[static_cast<std::size_t>(table.columns[c])].find(',') != std::string_view::npos)
                    table.decimal_comma = true;
        }
    std::vector<StudyValue> values;
    std::map<std::tuple<std::string, std::string, long>, std::size_t> seen;
    while (lines.next(line)) {
        if (csv::blanks_off(line).empty()) continue;
        const auto fields = text_fields(line, table.separator);
        if (fields.size() != table.width)
            return input_error(Text("has {} fields where the header names {}", fields.size(), table.width),
                               at(),
                               table.separator == ',' && fields.size() > table.width
                                   ? "write decimal points, or separate the columns by semicolons"
                                   : "");
        if (values.size() >= kStudyValueLimit)
            return input_error(Text("there are more than {} values", kStudyValueLimit), at());
        SEAM_TRY(auto value, StudyReader(table, fields, at()).value());
        const auto [first, fresh] =
            seen.emplace(std::tuple(value.part, value.rehang, value.run), lines.number());
        if (!fresh)
            return input_error(
                Text("part {}, rehang {}, run {} stands in line {} already", csv::shown(value.part),
                     csv::shown(value.rehang), value.run, first->second),
                at());
        values.push_back(std::move(value));
    }
    if (values.empty()) return input_error("there are no values", where);
    return values;
}

Expected<std::vector<StudyValue>> read_study_csv(const std::filesystem::path& path) {
    SEAM_TRY(const auto text, read_text_file(path));
    return parse_study_csv(text, path.string());
}

}  // namespace seamwright
