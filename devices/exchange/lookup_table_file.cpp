#include "devices/exchange/lookup_table_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"

namespace seamwright {
namespace {

constexpr std::size_t kHeaderLimit = 4096;
constexpr const char* kFormat = "seamwright-lookup-table";

void put(std::string& out, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}

std::uint64_t get(std::string_view bytes, std::size_t at, int count) {
    std::uint64_t value = 0;
    for (int i = count - 1; i >= 0; --i)
        value = (value << 8) | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
}

std::uint32_t crc_of(std::string_view bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

Expected<void> check(const LookupTable& t, const std::string& where) {
    if (t.columns < 2 || t.rows < 2 ||
        static_cast<std::int64_t>(t.columns) * static_cast<std::int64_t>(t.rows) > kLookupTableNodes)
        return input_error(Text("a table of {}x{} nodes is not possible", t.columns, t.rows), where,
                           "2x2 to 16 million nodes in all");
    if (!std::isfinite(t.u0) || !std::isfinite(t.v0) || !std::isfinite(t.step_u) ||
        !std::isfinite(t.step_v) || !(t.step_u > 0) || !(t.step_v > 0))
        return input_error("the table's grid is not made of finite numbers with steps above 0", where);
    const auto nodes = static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    if (t.x_mm.size() != nodes || t.z_mm.size() != nodes)
        return input_error(
            Text("the table holds {} and {} numbers for {} nodes", t.x_mm.size(), t.z_mm.size(), nodes),
            where);
    for (std::size_t i = 0; i < nodes; ++i) {
        if (std::isinf(t.x_mm[i]) || std::isinf(t.z_mm[i]))
            return input_error(Text("node {} is infinite", i), where);
        if (std::isnan(t.x_mm[i]) != std::isnan(t.z_mm[i]))
            return input_error(Text("node {} is half a hole: only one of x and z is a number", i), where);
    }
    return {};
}

}  // namespace

Expected<std::string> lookup_table_bytes(const LookupTable& table) {
    SEAM_OK(check(table, "table"));
    nlohmann::ordered_json header;
    header["format"] = kFormat;
    header["version"] = 1;
    header["u0"] = table.u0;
    header["v0"] = table.v0;
    header["step_u"] = table.step_u;
    header["step_v"] = table.step_v;
    header["columns"] = table.columns;
    header["rows"] = table.rows;
    std::string out = header.dump() + "\n";
    out.reserve(out.size() + 16 * table.x_mm.size() + 4);
    for (const auto* plane : {&table.x_mm, &table.z_mm})
        for (const double v : *plane)
            put(out,
                std::bit_cast<std::uint64_t>(std::isnan(v) ? std::numeric_limits<double>::quiet_NaN() : v),
                8);
    put(out, crc_of(out), 4);
    return out;
}

Expected<LookupTable> parse_lookup_table(std::string_view bytes, const std::string& where) {
    const std::size_t end = bytes.substr(0, kHeaderLimit).find('\n');
    if (end == std::string_view::npos)
        return input_error("this is no look-up table: its first line is missing", where,
                           "give a file that calibrate lut has written");
    SEAM_TRY(auto header, parse_json(bytes.substr(0, end), where));
    SEAM_TRY(auto format, json_string(header, "format", where));
    if (format != kFormat)
        return input_error(Text("this is no look-up table but '{}'", format.substr(0, 60)), where);
    SEAM_TRY(auto version, json_number(header, "version", where));
    if (version != 1)
        return input_error(Text("version {} of the look-up table is not known", version), where,
                           "version 1 can be read");
    if (auto ok = only_fields(
            header, {"format", "version", "u0", "v0", "step_u", "step_v", "columns", "rows"}, where);
        !ok)
        return tl::unexpected(ok.error());
    LookupTable t;
    double columns = 0, rows = 0;
    const std::pair<const char*, double*> fields[] = {{"u0", &t.u0},         {"v0", &t.v0},
                                                      {"step_u", &t.step_u}, {"step_v", &t.step_v},
                                                      {"columns", &columns}, {"rows", &rows}};
    for (const auto& [name, value] : fields) {
        SEAM_TRY(auto number, json_number(header, name, where));
        *value = number;
    }
    for (const double n : {columns, rows})
        if (!(n >= 2 && n <= kLookupTableNodes / 2) || n != std::floor(n))
            return input_error(Text("a table of {}x{} nodes is not possible", columns, rows), where);
    if (columns * rows > kLookupTableNodes)
        return input_error("the table has more than 16 million nodes", where);
    t.columns = static_cast<int>(columns), t.rows = static_cast<int>(rows);
    const auto nodes = static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    const std::size_t expected = end + 1 + 16 * nodes + 4;
    if (bytes.size() != expected)
        return input_error(Text("the file has {} bytes instead of {}", bytes.size(), expected), where,
                           "it was cut off or added to: take the original");
    if (get(bytes, expected - 4, 4) != crc_of(bytes.substr(0, expected - 4)))
        return input_error("the check sum does not fit: the file is damaged", where, "take the original");
    t.x_mm.resize(nodes);
    t.z_mm.resize(nodes);
    std::size_t at = end + 1;
    for (auto* plane : {&t.x_mm, &t.z_mm})
        for (auto& v : *plane) {
            v = std::bit_cast<double>(get(bytes, at, 8));
            at += 8;
        }
    SEAM_OK(check(t, where));
    return t;
}

Expected<void> write_lookup_table(const std::filesystem::path& path, const LookupTable& table) {
    SEAM_TRY(auto bytes, lookup_table_bytes(table));
    return write_text_file(path, bytes);
}

Expected<LookupTable> read_lookup_table(const std::filesystem::path& path) {
    SEAM_TRY(auto bytes, read_text_file(path, std::size_t{16} * kLookupTableNodes + kHeaderLimit + 4));
    return parse_lookup_table(bytes, path.string());
}

}  // namespace seamwright
