// NumPy arrays, PLY and PCD as tables of points.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <optional>

#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/point_table.h"

namespace seamwright {
namespace {

static_assert(std::endian::native == std::endian::little);

// A number as it lies in a file: 'f' float, 'i' signed, 'u' unsigned, of `size` bytes.
struct Scalar {
    char kind = 'f';
    std::size_t size = 4;
    bool known() const {
        return kind == 'f'
                   ? size == 4 || size == 8
                   : (kind == 'i' || kind == 'u') && (size == 1 || size == 2 || size == 4 || size == 8);
    }
    double read(const char* from) const {
        const auto as = [from]<class T>(T value) {
            std::memcpy(&value, from, sizeof value);
            return static_cast<double>(value);
        };
        if (kind == 'f') return size == 4 ? as(float()) : as(double());
        if (kind == 'i')
            return size == 1   ? as(std::int8_t())
                   : size == 2 ? as(std::int16_t())
                   : size == 4 ? as(std::int32_t())
                               : as(std::int64_t());
        return size == 1   ? as(std::uint8_t())
               : size == 2 ? as(std::uint16_t())
               : size == 4 ? as(std::uint32_t())
                           : as(std::uint64_t());
    }
};

double finite_or_nan(double value) {
    return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

std::optional<std::size_t> whole(std::string_view text) {
    std::size_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
    return value;
}

// The value of a key of NumPy's header, a Python dictionary.
std::string_view npy_value(std::string_view header, std::string_view key) {
    const auto at = header.find(key);
    if (at == std::string_view::npos) return {};
    auto rest = csv::blanks_off(header.substr(at + key.size()));
    if (!rest.starts_with(":")) return {};
    rest = csv::blanks_off(rest.substr(1));
    if (rest.starts_with("(")) return rest.substr(0, std::min(rest.find(')'), rest.size() - 1) + 1);
    return csv::blanks_off(rest.substr(0, rest.find_first_of(",}")));
}

struct Property {
    std::string name;
    Scalar scalar;
    std::size_t offset = 0;  // bytes from the point's start
};

// Rows of numbers in text, one point a line, from `line_number` + 1 on.
Expected<void> read_ascii(std::string_view text, std::size_t line_number, std::size_t count,
                          PointTable& table, const std::string& where) {
    csv::Lines lines(text);
    std::string_view line;
    while (table.lines.size() < count && lines.next(line)) {
        if (csv::blanks_off(line).empty()) continue;
        const std::string at = fmt::format("{}, line {}", where, line_number + lines.number());
        const auto fields = text_fields(line, ' ');
        if (fields.size() != table.columns.size())
            return input_error(
                Text("has {} numbers where the header names {}", fields.size(), table.columns.size()), at);
        for (std::size_t c = 0; c < fields.size(); ++c) {
            double value = 0;
            if (!text_number(fields[c], false, value))
                return input_error(Text("\"{}\" is no number", csv::shown(fields[c])), at);
            table.columns[c].push_back(value);
        }
        table.lines.push_back(static_cast<std::uint32_t>(line_number + lines.number()));
    }
    if (table.lines.size() < count)
        return input_error(Text("holds {} points where its header names {}", table.lines.size(), count),
                           where, "the file is cut short");
    return {};
}

Expected<void> read_binary(std::string_view bytes, std::size_t count, std::size_t stride,
                           const std::vector<Property>& properties, PointTable& table,
                           const std::string& where) {
    if (stride == 0 || bytes.size() / stride < count)
        return input_error(
            Text("holds {} bytes of points where its header names {} of {}", bytes.size(), count, stride),
            where, "the file is cut short");
    for (std::size_t c = 0; c < properties.size(); ++c) {
        table.columns[c].resize(count);
        for (std::size_t i = 0; i < count; ++i)
            table.columns[c][i] =
                finite_or_nan(properties[c].scalar.read(bytes.data() + i * stride + properties[c].offset));
    }
    return {};
}

Expected<PointTable> read_points(std::string_view bytes, std::size_t line_number, bool binary,
                                 std::size_t count, std::size_t stride,
                                 const std::vector<Property>& properties, const char* kind,
                                 const std::string& where, std::size_t limit) {
    if (count == 0 || properties.empty()) return input_error("holds no points", where);
    if (count > limit) return input_error(Text("there are more than {} points", limit), where);
    PointTable table;
    table.columns.resize(properties.size());
    table.blocks = {0};
    for (const Property& p : properties) table.names.push_back(p.name);
    SEAM_OK(binary ? read_binary(bytes, count, stride, properties, table, where)
                   : read_ascii(bytes, line_number, count, table, where));
    table.understood = fmt::format("{} {}", kind, binary ? "binary" : "ascii");
    return table;
}

}  // namespace

Expected<PointTable> parse_npy(std::string_view bytes, const std::string& where, std::size_t limit) {
    const auto cut_short = [&] { return input_error("the NumPy header is cut short", where); };
    if (bytes.size() < 12) return cut_short();
    const auto byte = [&](std::size_t i) {
        return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
    };
    const bool wide = byte(6) >= 2;
    const std::size_t start = wide ? 12 : 10;
    std::size_t length = byte(8) | byte(9) << 8;
    if (wide) length |= byte(10) << 16 | byte(11) << 24;
    if (length > bytes.size() - start) return cut_short();
    const std::string_view header = bytes.substr(start, length), data = bytes.substr(start + length);
    const std::string_view descr = npy_value(header, "'descr'"), shape_text = npy_value(header, "'shape'");
    if (descr.size() < 4 || descr.front() != '\'' || shape_text.size() < 2)
        return input_error("is an array of records or of an unknown type", where,
                           "save plain numbers: x and z");
    if (descr[1] == '>') return input_error("is big-endian", where, "save it with astype('<f8')");
    const auto size = whole(descr.substr(3, descr.size() - 4));
    const Scalar scalar{descr[2], size.value_or(0)};
    if (!scalar.known())
        return input_error(Text("holds {}, no plain numbers", csv::shown(descr)), where,
                           "save it with astype('<f8')");
    const bool fortran = npy_value(header, "'fortran_order'") == "True";
    std::vector<std::size_t> shape;
    std::size_t total = 1;
    for (const auto& field : text_fields(shape_text.substr(1, shape_text.size() - 2), ',')) {
        if (field.empty()) continue;
        const auto n = whole(field);
        if (!n || *n == 0 || *n > data.size() || total > data.size() / *n)
            return input_error("its shape does not fit its size", where, "the file is cut short");
        total *= *n;
        shape.push_back(*n);
    }
    if (shape.empty() || total > data.size() / scalar.size)
        return input_error("its shape does not fit its size", where, "the file is cut short");
    const bool stack = shape.size() == 3;
    if (shape.size() == 1 || shape.size() > 3)
        return input_error(Text("is an array of {} dimensions", shape.size()), where,
                           "give (n, 2) with x and z, (n, 3) with x, y and z, or (profiles, n, 2)");
    std::size_t profiles = stack ? shape[0] : 1, points = stack ? shape[1] : shape[0];
    std::size_t columns = shape.back();
    bool turned = false;
    if (!(columns == 2 || columns == 3) && !stack && (points == 2 || points == 3)) {
        std::swap(columns, points);
        turned = true;
    }
    if (columns != 2 && columns != 3)
        return input_error(Text("has {} columns", columns), where,
                           "give (n, 2) with x and z, (n, 3) with x, y and z, or (profiles, n, 2)");
    if (profiles * points > limit) return input_error(Text("there are more than {} points", limit), where);
    PointTable table;
    table.names = columns == 2 ? std::vector<std::string>{"x", "z"} : std::vector<std::string>{"x", "y", "z"};
    table.columns.assign(columns, {});
    for (std::size_t p = 0; p < profiles; ++p) {
        table.blocks.push_back(p * points);
        for (std::size_t i = 0; i < points; ++i)
            for (std::size_t c = 0; c < columns; ++c) {
                std::size_t at = 0;
                if (stack)
                    at = fortran ? p + profiles * (i + points * c) : (p * points + i) * columns + c;
                else
                    at = fortran != turned ? c * points + i : i * columns + c;
                table.columns[c].push_back(finite_or_nan(scalar.read(data.data() + at * scalar.size)));
            }
    }
    table.understood = fmt::format("NumPy array {} of {}, columns {}", csv::shown(shape_text),
                                   csv::shown(descr), columns == 2 ? "x, z" : "x, y, z");
    return table;
}

Expected<PointTable> parse_ply_points(std::string_view bytes, const std::string& where, std::size_t limit) {
    csv::Lines lines(bytes);
    std::string_view line;
    std::size_t consumed = 0, count = 0;
    bool ended = false, binary = false, vertex = false, other = false, form = false;
    std::vector<Property> properties;
    std::size_t stride = 0;
    while (lines.number() < 1000 && lines.next(line)) {
        consumed = static_cast<std::size_t>(line.data() - bytes.data()) + line.size();
        const std::string at = fmt::format("{}, line {}", where, lines.number());
        const auto words_ = text_fields(line, ' ');
        if (words_.empty()) continue;
        if (words_[0] == "end_header") {
            ended = true;
            break;
        }
        if (words_[0] == "format") {
            form = true;
            if (words_.size() < 2 || (words_[1] != "ascii" && words_[1] != "binary_little_endian"))
                return input_error("is neither ascii nor binary little-endian", at, "save it as ascii PLY");
            binary = words_[1] != "ascii";
        } else if (words_[0] == "element") {
            if (words_.size() == 3 && words_[1] == "vertex" && !other) {
                vertex = true;
                const auto n = whole(words_[2]);
                if (!n) return input_error("the number of points is no number", at);
                count = *n;
            } else {
                if (!vertex) return input_error("the points do not come first", at, "save the points alone");
                vertex = false;
                other = true;
            }
        } else if (words_[0] == "property" && vertex) {
            static const std::pair<std::string_view, Scalar> types[] = {
                {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}},
                {"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
                {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
                {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}}};
            const auto type = words_.size() == 3
                                  ? std::find_if(std::begin(types), std::end(types),
                                                 [&](const auto& t) { return t.first == words_[1]; })
                                  : std::end(types);
            if (type == std::end(types)) return input_error("is no plain property of a point", at);
            properties.push_back({std::string(words_[2]), type->second, stride});
            stride += type->second.size;
        }
    }
    if (!ended || !form) return input_error("the PLY header is cut short", where);
    const auto newline = bytes.find('\n', consumed);
    const std::string_view data =
        newline == std::string_view::npos ? std::string_view{} : bytes.substr(newline + 1);
    return read_points(data, lines.number(), binary, count, stride, properties, "PLY", where, limit);
}

Expected<PointTable> parse_pcd_points(std::string_view bytes, const std::string& where, std::size_t limit) {
    csv::Lines lines(bytes);
    std::string_view line;
    std::vector<Property> properties;
    std::vector<std::size_t> counts;
    std::optional<std::size_t> points;
    std::string_view data_kind;
    std::size_t consumed = 0;
    const auto list = [&](std::vector<std::string_view> fields) {
        fields.erase(fields.begin());
        return fields;
    };
    while (data_kind.empty() && lines.number() < 1000 && lines.next(line)) {
        consumed = static_cast<std::size_t>(line.data() - bytes.data()) + line.size();
        const std::string at = fmt::format("{}, line {}", where, lines.number());
        const auto fields = text_fields(line, ' ');
        if (fields.empty() || fields[0].starts_with("#")) continue;
        const auto values = list(fields);
        if (values.empty() || values.size() > 4096) return input_error("is no line of a PCD header", at);
        const bool per_field = fields[0] == "SIZE" || fields[0] == "TYPE" || fields[0] == "COUNT";
        if (per_field && values.size() != properties.size())
            return input_error(Text("{} has {} entries for {} fields", csv::shown(fields[0]), values.size(),
                                    properties.size()),
                               at);
        if (fields[0] == "FIELDS") {
            for (const auto& name : values) properties.push_back({std::string(name), {'f', 4}, 0});
            counts.assign(values.size(), 1);
        } else if (per_field) {
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (fields[0] == "TYPE") {
                    properties[i].scalar.kind = values[i] == "F" ? 'f' : values[i] == "I" ? 'i' : 'u';
                    continue;
                }
                const auto n = whole(values[i]);
                if (!n || *n == 0 || *n > 4096) return input_error("is no size", at);
                (fields[0] == "SIZE" ? properties[i].scalar.size : counts[i]) = *n;
            }
        } else if (fields[0] == "POINTS") {
            points = whole(values[0]);
        } else if (fields[0] == "DATA") {
            data_kind = values[0];
        }
    }
    if (data_kind.empty() || !points) return input_error("the PCD header is cut short", where);
    if (data_kind != "ascii" && data_kind != "binary")
        return input_error(Text("its data are {}", csv::shown(data_kind)), where,
                           "save it as DATA ascii or DATA binary");
    std::size_t stride = 0;
    std::vector<Property> plain;  // every field's first value; the rest only takes room
    for (std::size_t i = 0; i < properties.size(); ++i) {
        if (!properties[i].scalar.known()) return input_error("a field is of an unknown type", where);
        if (data_kind == "ascii" && counts[i] != 1)
            return input_error("a field holds several numbers", where, "keep x, y and z");
        properties[i].offset = stride;
        stride += properties[i].scalar.size * counts[i];
        plain.push_back(properties[i]);
    }
    const auto newline = bytes.find('\n', consumed);
    const std::string_view data =
        newline == std::string_view::npos ? std::string_view{} : bytes.substr(newline + 1);
    return read_points(data, lines.number(), data_kind == "binary", *points, stride, plain, "PCD", where,
                       limit);
}

}  // namespace seamwright
