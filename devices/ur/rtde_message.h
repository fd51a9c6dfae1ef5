#pragma once
// Packages of Universal Robots' Real-Time Data Exchange (RTDE, "RTDE guide" of Universal Robots, port 30004).
//
// A package is: uint16 size of the whole package, uint8 type, payload; integers and doubles big-endian. Names
// of variables travel as one comma-separated list, their types come back as another ("DOUBLE,VECTOR6D"),
// where NOT_FOUND stands for a variable that the controller does not have and IN_USE for an input that
// another client owns. Version 2 of the protocol adds an output frequency to the request and a recipe's
// number to its answer and to every data package of outputs; inputs bear a recipe's number in both.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/error.h"

namespace seamwright::rtde {

enum class Type : std::uint8_t {
    protocol_version = 86,  // 'V'
    controller_version = 118 /* 'v' */,
    text = 77,           // 'M'
    data = 85,           // 'U'
    setup_outputs = 79,  // 'O'
    setup_inputs = 73,   // 'I'
    start = 83,          // 'S'
    pause = 80           // 'P'
};

struct Package {
    Type type = Type::text;
    std::string payload;
};

inline constexpr std::size_t kHeaderBytes = 3, kMostBytes = 4096;

std::string package_bytes(const Package& package);
// Takes the first whole package from the front of `stream`; nothing where it has not come whole. Error
// (device): a size under the header's or over kMostBytes, an unknown type; the stream is beyond repair then.
Expected<std::optional<Package>> take_package(std::string& stream);

// Payloads, written and read; readers refuse a wrong length.
std::string version_payload(std::uint16_t version);
Expected<std::uint16_t> version_of(std::string_view payload);
Expected<bool> accepted_of(std::string_view payload);  // answer to 'V', 'S', 'P': 0 or 1
// What the controller says in words, of either version of the protocol; unprintable signs become '?'.
std::string text_of(std::string_view payload, int protocol_version);

enum class Kind : std::uint8_t {
    boolean,
    uint8,
    uint32,
    uint64,
    int32,
    real,
    vector3,
    vector6,
    vector6_int32,
    vector6_uint32
};
std::optional<Kind> kind_from_name(std::string_view name);
std::string_view kind_name(Kind kind);
std::size_t kind_bytes(Kind kind);

using Value = std::variant<bool, std::uint8_t, std::uint32_t, std::uint64_t, std::int32_t, double,
                           std::array<double, 3>, std::array<double, 6>, std::array<std::int32_t, 6>,
                           std::array<std::uint32_t, 6>>;

// Names, their kinds, and the number that data packages of this list bear.
struct Recipe {
    std::uint8_t id = 0;
    bool numbered = true;  // false: outputs of protocol version 1
    std::vector<std::string> names;
    std::vector<Kind> kinds;
};

std::string outputs_request(const std::vector<std::string>& names, int protocol_version, double frequency_hz);
std::string inputs_request(const std::vector<std::string>& names);
// The answer to either request. Error (device): NOT_FOUND and IN_USE, naming the variables; another number of
// types than of names; an unknown type.
Expected<Recipe> recipe_of(std::string_view payload, const std::vector<std::string>& names, bool numbered);

// Values in the recipe's order. The reader refuses another length or number, and a boolean that is neither 0
// nor 1.
Expected<std::vector<Value>> values_of(std::string_view payload, const Recipe& recipe);
std::string data_payload(const Recipe& recipe,
                         const std::vector<Value>& values);  // precondition: the recipe's kinds

}  // namespace seamwright::rtde
