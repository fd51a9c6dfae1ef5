#include "devices/ur/rtde_message.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace seamwright::rtde {
namespace {

constexpr const char* kWhere = "RTDE";

template <class T>
void put(std::string& out, T value) {
    std::uint64_t bits = 0;
    if constexpr (std::is_same_v<T, double>)
        bits = std::bit_cast<std::uint64_t>(value);
    else
        bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = sizeof(T); i-- > 0;) out.push_back(static_cast<char>((bits >> (8 * i)) & 0xff));
}

template <class T>
T get(std::string_view& bytes) {  // precondition: long enough
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits = bits << 8 | static_cast<unsigned char>(bytes[i]);
    bytes.remove_prefix(sizeof(T));
    if constexpr (std::is_same_v<T, double>)
        return std::bit_cast<double>(bits);
    else
        return static_cast<T>(bits);
}

tl::unexpected<Error> wrong_length(std::string_view what, std::size_t got) {
    return device_error(Text("{} of {} bytes is no answer of RTDE", what, got), kWhere);
}

std::string printable(std::string_view text) {
    std::string out(text.substr(0, 200));
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
}

struct KindName {
    Kind kind;
    std::string_view name;
    std::size_t bytes;
};
constexpr std::array<KindName, 10> kKinds = {{{Kind::boolean, "BOOL", 1},
                                              {Kind::uint8, "UINT8", 1},
                                              {Kind::uint32, "UINT32", 4},
                                              {Kind::uint64, "UINT64", 8},
                                              {Kind::int32, "INT32", 4},
                                              {Kind::real, "DOUBLE", 8},
                                              {Kind::vector3, "VECTOR3D", 24},
                                              {Kind::vector6, "VECTOR6D", 48},
                                              {Kind::vector6_int32, "VECTOR6INT32", 24},
                                              {Kind::vector6_uint32, "VECTOR6UINT32", 24}}};

template <class T, std::size_t N>
Value get_array(std::string_view& bytes) {
    std::array<T, N> out;
    for (T& v : out) v = get<T>(bytes);
    return out;
}

}  // namespace

std::string package_bytes(const Package& package) {
    assert(package.payload.size() + kHeaderBytes <= kMostBytes);
    std::string out;
    put(out, static_cast<std::uint16_t>(package.payload.size() + kHeaderBytes));
    put(out, static_cast<std::uint8_t>(package.type));
    return out + package.payload;
}

Expected<std::optional<Package>> take_package(std::string& stream) {
    if (stream.size() < kHeaderBytes) return std::nullopt;
    std::string_view head = stream;
    const std::size_t size = get<std::uint16_t>(head);
    const auto type = static_cast<Type>(get<std::uint8_t>(head));
    if (size < kHeaderBytes || size > kMostBytes)
        return device_error(Text("a package of {} bytes is no answer of RTDE", size), kWhere);
    switch (type) {
        case Type::protocol_version:
        case Type::controller_version:
        case Type::text:
        case Type::data:
        case Type::setup_outputs:
        case Type::setup_inputs:
        case Type::start:
        case Type::pause:
            break;
        default:
            return device_error(Text("a package of type {} is no answer of RTDE", static_cast<int>(type)),
                                kWhere);
    }
    if (stream.size() < size) return std::nullopt;
    Package package{type, stream.substr(kHeaderBytes, size - kHeaderBytes)};
    stream.erase(0, size);
    return package;
}

std::string version_payload(std::uint16_t version) {
    std::string out;
    put(out, version);
    return out;
}

Expected<std::uint16_t> version_of(std::string_view payload) {
    if (payload.size() != 2) return wrong_length("a version", payload.size());
    return get<std::uint16_t>(payload);
}

Expected<bool> accepted_of(std::string_view payload) {
    if (payload.size() != 1 || static_cast<unsigned char>(payload[0]) > 1)
        return wrong_length("an acceptance", payload.size());
    return payload[0] == 1;
}

std::string text_of(std::string_view payload, int protocol_version) {
    if (payload.empty()) return {};
    const std::size_t length = static_cast<unsigned char>(payload[0]);
    if (protocol_version == 1) return printable(payload.substr(1));  // the first byte is the kind of text
    return printable(payload.substr(1, length));
}

std::optional<Kind> kind_from_name(std::string_view name) {
    for (const KindName& k : kKinds)
        if (k.name == name) return k.kind;
    return std::nullopt;
}

std::string_view kind_name(Kind kind) {
    return kKinds[static_cast<std::size_t>(kind)].name;
}

std::size_t kind_bytes(Kind kind) {
    return kKinds[static_cast<std::size_t>(kind)].bytes;
}

std::string outputs_request(const std::vector<std::string>& names, int protocol_version,
                            double frequency_hz) {
    std::string out;
    if (protocol_version >= 2) put(out, frequency_hz);
    return out + fmt::format("{}", fmt::join(names, ","));
}

std::string inputs_request(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ","));
}

Expected<Recipe> recipe_of(std::string_view payload, const std::vector<std::string>& names, bool numbered) {
    Recipe recipe;
    recipe.numbered = numbered;
    recipe.names = names;
    if (numbered) {
        if (payload.empty()) return wrong_length("a recipe", 0);
        recipe.id = get<std::uint8_t>(payload);
    }
    std::vector<std::string> missing, in_use;
    std::size_t n = 0;
    for (bool more = true; more; ++n) {
        const std::size_t comma = payload.find(',');
        const std::string_view type = payload.substr(0, comma);
        more = comma != std::string_view::npos;
        if (more) payload.remove_prefix(comma + 1);
        if (n >= names.size()) continue;
        if (type == "NOT_FOUND") {
            missing.push_back(names[n]);
        } else if (type == "IN_USE") {
            in_use.push_back(names[n]);
        } else if (const auto kind = kind_from_name(type)) {
            recipe.kinds.push_back(*kind);
        } else {
            return device_error(
                Text("the answer names an unknown type \"{}\" for {}", printable(type), names[n]), kWhere);
        }
    }
    if (n != names.size())
        return device_error(Text("the answer has {} types for {} variables", n, names.size()), kWhere);
    if (!in_use.empty())
        return device_error(Text("another program already writes {}", fmt::join(in_use, ", ")), kWhere,
                            "end it, disable EtherNet/IP and PROFINET on those registers, or choose others "
                            "by \"first_register\"");
    if (!missing.empty())
        return device_error(Text("the controller does not know {}", fmt::join(missing, ", ")), kWhere,
                            "its software is too old for this driver (PolyScope 3.4 and later)");
    return recipe;
}

Expected<std::vector<Value>> values_of(std::string_view payload, const Recipe& recipe) {
    std::size_t size = recipe.numbered ? 1 : 0;
    for (const Kind k : recipe.kinds) size += kind_bytes(k);
    if (payload.size() != size)
        return device_error(Text("data of {} bytes came for a recipe of {}", payload.size(), size), kWhere);
    if (recipe.numbered && get<std::uint8_t>(payload) != recipe.id)
        return device_error("data of another recipe came", kWhere);
    std::vector<Value> values;
    values.reserve(recipe.kinds.size());
    for (const Kind k : recipe.kinds) {
        switch (k) {
            case Kind::boolean: {
                const auto v = get<std::uint8_t>(payload);
                if (v > 1) return device_error(Text("{} is neither true nor false", v), kWhere);
                values.emplace_back(v == 1);
                break;
            }
            case Kind::uint8:
                values.emplace_back(get<std::uint8_t>(payload));
                break;
            case Kind::uint32:
                values.emplace_back(get<std::uint32_t>(payload));
                break;
            case Kind::uint64:
                values.emplace_back(get<std::uint64_t>(payload));
                break;
            case Kind::int32:
                values.emplace_back(get<std::int32_t>(payload));
                break;
            case Kind::real:
                values.emplace_back(get<double>(payload));
                break;
            case Kind::vector3:
                values.push_back(get_array<double, 3>(payload));
                break;
            case Kind::vector6:
                values.push_back(get_array<double, 6>(payload));
                break;
            case Kind::vector6_int32:
                values.push_back(get_array<std::int32_t, 6>(payload));
                break;
            case Kind::vector6_uint32:
                values.push_back(get_array<std::uint32_t, 6>(payload));
                break;
        }
    }
    return values;
}

std::string data_payload(const Recipe& recipe, const std::vector<Value>& values) {
    assert(values.size() == recipe.kinds.size());
    std::string out;
    if (recipe.numbered) put(out, recipe.id);
    for (const Value& value : values)
        std::visit(
            [&out](const auto& v) {
                using T = std::decay_t<decltype(v)>;
                if constexpr (std::is_same_v<T, bool>)
                    put(out, static_cast<std::uint8_t>(v));
                else if constexpr (std::is_arithmetic_v<T>)
                    put(out, v);
                else
                    for (const auto& element : v) put(out, element);
            },
            value);
    return out;
}

}  // namespace seamwright::rtde
