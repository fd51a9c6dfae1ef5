#include "devices/exchange/tables/candidates_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

struct Row {
    int line = 0;
    double x = 0, z = 0;
    float intensity = 0;
};

Expected<CandidatesTable> gathered(const std::vector<Row>& rows, int lines, bool intensities, bool pixels,
                                   const std::string& where) {
    if (rows.empty())
        return input_error("there is no candidate", where, "give one row, or one point, for each");
    std::vector<int> count(static_cast<std::size_t>(lines), 0);
    for (const Row& row : rows)
        if (++count[static_cast<std::size_t>(row.line)] > kCandidatesPerLine)
            return input_error(Text("line {} has more than {} candidates", row.line, kCandidatesPerLine),
                               where, "leave out the weak ones");
    CandidatesTable table;
    table.pixels = pixels;
    ProfileCandidates& c = table.candidates;
    c.lines = lines;
    c.per_line = *std::max_element(count.begin(), count.end());
    c.count.assign(count.size(), 0);
    const auto all = count.size() * static_cast<std::size_t>(c.per_line);
    c.x_mm.assign(all, std::numeric_limits<double>::quiet_NaN());
    c.z_mm = c.x_mm;
    if (intensities) c.intensity.assign(all, 0.0F);
    for (const Row& row : rows) {
        const auto at =
            static_cast<std::size_t>(c.index(row.line, c.count[static_cast<std::size_t>(row.line)]++));
        c.x_mm[at] = row.x;
        c.z_mm[at] = row.z;
        if (intensities) c.intensity[at] = row.intensity;
    }
    return table;
}

Expected<int> line_of(double value, const std::string& at) {
    if (!(value >= 0 && value < kCandidateLines) || value != std::floor(value))
        return input_error(Text("no number of a line from 0 to {}", kCandidateLines - 1), at);
    return static_cast<int>(value);
}

}  // namespace

Expected<CandidatesTable> parse_candidates_csv(std::string_view text, const std::string& where) {
    const bool pixels = text.substr(0, text.find('\n')).find("position_px") != std::string_view::npos;
    CsvTable table(text, where, "[,intensity]");
    enum : std::size_t { line, x, z, intensity };
    if (pixels) {
        constexpr std::array<std::string_view, 4> wanted{"index", "position_px", "position_px", "intensity"};
        SEAM_OK(table.header(wanted, 2));
    } else {
        constexpr std::array<std::string_view, 4> wanted{"line", "x_mm", "z_mm", "intensity"};
        SEAM_OK(table.header(wanted, 3));
    }
    std::vector<Row> rows;
    int lines = 0;
    for (;;) {
        SEAM_TRY(const bool more, table.row());
        if (!more) break;
        if (rows.size() >= static_cast<std::size_t>(kCandidateLines) * 8)
            return input_error("there are too many candidates", table.at(), "give one profile a file");
        Row row;
        SEAM_TRY(const double number, table.number(line, pixels ? "index" : "line"));
        SEAM_TRY(row.line, line_of(number, table.at()));
        if (pixels) {
            row.x = row.line;
            SEAM_TRY(row.z, table.number(x, "position_px"));
        } else {
            SEAM_TRY(row.x, table.millimetres(x, "x_mm"));
            SEAM_TRY(row.z, table.millimetres(z, "z_mm"));
        }
        if (!std::isfinite(row.x) || !std::isfinite(row.z))
            return input_error("a candidate without a place", table.at(),
                               "leave the row out: the line has none");
        if (table.has(intensity)) {
            SEAM_TRY(const double grey, table.number(intensity, "intensity"));
            row.intensity = std::isnan(grey) ? 0.0F : static_cast<float>(grey);
        }
        lines = std::max(lines, row.line + 1);
        rows.push_back(row);
    }
    return gathered(rows, lines, table.has(intensity), pixels, where);
}

Expected<CandidatesTable> parse_candidates_json(std::string_view text, const std::string& where) {
    SEAM_TRY(const auto document, parse_json(text, where));
    SEAM_OK(only_fields(document, {"lines"}, where));
    SEAM_TRY(const auto* list, json_array(document, "lines", where));
    if (list->size() > static_cast<std::size_t>(kCandidateLines))
        return input_error(Text("there are more than {} lines", kCandidateLines), where);
    std::vector<Row> rows;
    std::size_t with_intensity = 0;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string at = json_path(json_path(where, "lines"), i);
        if (!(*list)[i].is_array())
            return input_error("not a list of candidates", at, "give [[x,z,intensity],..], or []");
        for (std::size_t k = 0; k < (*list)[i].size(); ++k) {
            SEAM_TRY(const auto values, as_numbers((*list)[i][k], 0, json_path(at, k)));
            if (values.size() != 2 && values.size() != 3)
                return input_error("not a candidate", json_path(at, k), "give [x, z] or [x, z, intensity]");
            if (std::abs(values[0]) > 1e6 || std::abs(values[1]) > 1e6)
                return input_error("a coordinate lies more than a kilometre away", json_path(at, k),
                                   "give millimetres");
            with_intensity += values.size() == 3;
            rows.push_back({static_cast<int>(i), values[0], values[1],
                            values.size() == 3 ? static_cast<float>(values[2]) : 0.0F});
        }
    }
    if (with_intensity != 0 && with_intensity != rows.size())
        return input_error("some candidates have an intensity and some have none", where,
                           "give it for all, or for none");
    return gathered(rows, static_cast<int>(list->size()), with_intensity != 0, false, where);
}

Expected<CandidatesTable> read_candidates(const std::filesystem::path& path) {
    SEAM_TRY(const auto text, read_text_file(path));
    return path.extension() == ".json" ? parse_candidates_json(text, path.string())
                                       : parse_candidates_csv(text, path.string());
}

}  // namespace seamwright
