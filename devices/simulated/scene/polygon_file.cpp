#include "devices/simulated/scene/polygon_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>

namespace seamwright {
namespace {

enum class Form { ascii, little, big };

struct Type {
    std::size_t bytes = 0;
    enum class Of { whole, natural, real } of = Of::whole;
};
std::optional<Type> type_of(std::string_view word) {
    using Of = Type::Of;
    struct Named {
        std::string_view name, other;
        Type type;
    };
    static constexpr Named types[] = {
        {"char", "int8", {1, Of::whole}},    {"uchar", "uint8", {1, Of::natural}},
        {"short", "int16", {2, Of::whole}},  {"ushort", "uint16", {2, Of::natural}},
        {"int", "int32", {4, Of::whole}},    {"uint", "uint32", {4, Of::natural}},
        {"float", "float32", {4, Of::real}}, {"double", "float64", {8, Of::real}}};
    for (const Named& t : types)
        if (word == t.name || word == t.other) return t.type;
    return std::nullopt;
}

struct Property {
    std::string name;
    Type type;
    std::optional<Type> count;  // of a list
};
struct Element {
    std::string name;
    std::size_t many = 0;
    std::vector<Property> properties;
};

std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

// The numbers behind the header, one after the other.
class Numbers {
  public:
    Numbers(std::string_view bytes, Form form) : rest_(bytes), form_(form) {}
    std::optional<double> next(const Type& type) { return form_ == Form::ascii ? text() : binary(type); }

  private:
    std::optional<double> text() {
        constexpr std::string_view kSpace = " \t\r\n";
        rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpace), rest_.size()));
        const std::string_view word = rest_.substr(0, rest_.find_first_of(kSpace));
        rest_.remove_prefix(word.size());
        return number_of(word);
    }
    std::optional<double> binary(const Type& type) {
        if (rest_.size() < type.bytes) return std::nullopt;
        std::uint64_t raw = 0;
        for (std::size_t i = 0; i < type.bytes; ++i) {
            const auto byte =
                static_cast<std::uint8_t>(rest_[form_ == Form::little ? i : type.bytes - 1 - i]);
            raw |= std::uint64_t{byte} << (8 * i);
        }
        rest_.remove_prefix(type.bytes);
        if (type.of == Type::Of::natural) return static_cast<double>(raw);
        if (type.of == Type::Of::real)
            return type.bytes == 8
                       ? std::bit_cast<double>(raw)
                       : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
        const auto unused = static_cast<int>(64 - 8 * type.bytes);
        return static_cast<double>(static_cast<std::int64_t>(raw << unused) >> unused);
    }
    std::string_view rest_;
    Form form_;
};

struct Header {
    Form form = Form::ascii;
    std::vector<Element> elements;
    std::size_t bytes = 0;
};
Expected<Header> header_of(std::string_view bytes, const std::string& where) {
    const auto cut = [&] { return file_error("does not begin as a PLY file", where); };
    Header header;
    bool formed = false;
    for (std::size_t line_no = 0;; ++line_no) {
        const std::size_t end = bytes.find('\n', header.bytes);
        if (end == std::string_view::npos) return cut();
        std::string line(bytes.substr(header.bytes, end - header.bytes));
        header.bytes = end + 1;
        if (line.ends_with('\r')) line.pop_back();
        if (line_no == 0 && line != "ply") return cut();
        if (line == "end_header") break;
        std::istringstream words(line);
        std::string word, a, b, c, d;
        words >> word >> a >> b >> c >> d;
        if (word == "format") {
            formed = a == "ascii" || a == "binary_little_endian" || a == "binary_big_endian";
            header.form = a == "ascii" ? Form::ascii : a == "binary_big_endian" ? Form::big : Form::little;
        } else if (word == "element") {
            Element element{a, 0, {}};
            const auto [rest, error] = std::from_chars(b.data(), b.data() + b.size(), element.many);
            if (error != std::errc() || rest != b.data() + b.size() || element.many > bytes.size())
                return file_error(Text("promises {} elements \"{}\", which it cannot hold", b, a), where);
            header.elements.push_back(std::move(element));
        } else if (word == "property") {
            const bool list = a == "list";
            const auto type = type_of(list ? c : a), count = list ? type_of(b) : std::nullopt;
            if (header.elements.empty() || !type || (list && !count)) return cut();
            header.elements.back().properties.push_back({list ? d : b, *type, count});
        }
    }
    if (!formed) return cut();
    return header;
}

}  // namespace

Expected<PolygonSurface> parse_ply(std::string_view bytes, const std::string& where) {
    SEAM_TRY(const Header header, header_of(bytes, where));
    Numbers numbers(bytes.substr(header.bytes), header.form);
    const auto cut_short = [&] { return file_error("is cut short", where); };
    PolygonSurface surface;
    std::vector<double> list;
    for (const Element& element : header.elements) {
        const bool vertices = element.name == "vertex", faces = element.name == "face";
        for (std::size_t i = 0; i < element.many; ++i) {
            Eigen::Vector3d point = Eigen::Vector3d::Zero();
            for (const Property& property : element.properties) {
                std::size_t many = 1;
                if (property.count) {
                    const auto count = numbers.next(*property.count);
                    if (!count || !(*count >= 0) || *count > static_cast<double>(bytes.size()))
                        return cut_short();
                    many = static_cast<std::size_t>(*count);
                }
                list.clear();
                for (std::size_t k = 0; k < many; ++k) {
                    const auto number = numbers.next(property.type);
                    if (!number) return cut_short();
                    list.push_back(*number);
                }
                const bool named =
                    property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
                if (vertices && named && !property.count) point[property.name[0] - 'x'] = list[0];
                if (faces && (property.name == "vertex_indices" || property.name == "vertex_index") &&
                    many >= 3) {
                    for (const double corner : list)
                        if (!(corner >= 0 && corner < static_cast<double>(surface.points.size())) ||
                            corner != std::floor(corner))
                            return file_error("names a vertex that it does not hold", where);
                    surface.faces.emplace_back(list.begin(), list.end());
                }
            }
            if (vertices) surface.points.push_back(point);
        }
    }
    return surface;
}

Expected<PolygonSurface> parse_obj(std::string_view text, const std::string& where) {
    PolygonSurface surface;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        // A long face goes on in the next line.
        for (std::string more; line.ends_with('\\') && std::getline(lines, more);)
            line.back() = ' ', line += more;
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            Eigen::Vector3d point;
            for (double& value : point) {
                const auto number = words >> word ? number_of(word) : std::nullopt;
                if (!number) return file_error("holds a vertex that is none", where);
                value = *number;
            }
            surface.points.push_back(point);
        } else if (word == "f") {
            std::vector<std::int32_t> face;
            while (words >> word) {
                const auto number = number_of(std::string_view(word).substr(0, word.find('/')));
                const double count = static_cast<double>(surface.points.size());
                const double corner = !number ? -1 : *number < 0 ? count + *number : *number - 1;
                if (!(corner >= 0 && corner < static_cast<double>(INT32_MAX)) || corner != std::floor(corner))
                    return file_error("names a vertex that it does not hold", where);
                face.push_back(static_cast<std::int32_t>(corner));
            }
            if (face.size() >= 3) surface.faces.push_back(std::move(face));
        }
    }
    // A face may stand before its vertices.
    for (const auto& face : surface.faces)
        for (const std::int32_t corner : face)
            if (static_cast<std::size_t>(corner) >= surface.points.size())
                return file_error("names a vertex that it does not hold", where);
    return surface;
}

}  // namespace seamwright
