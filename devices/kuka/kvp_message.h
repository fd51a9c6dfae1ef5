#pragma once
// Messages of KUKAVARPROXY (and servers compatible with it): variables of the controller by name, over TCP
// port 7000.
//
//     request   id uint16 | length uint16 | mode uint8 (0 read, 1 write) | name length uint16 | name
//               and for a write  | value length uint16 | value
//     answer    id uint16 | length uint16 | mode uint8 | value length uint16 | value | status 3 bytes
//
// Numbers are big endian; length counts what follows it, in answers without the three status bytes (some
// servers count them: both are read). The last status byte is 1 when the controller did it, else 0; an unknown
// variable is read as an empty value with a 1 by the published server. Several messages may share a segment in
// answers; requests are sent one by one (kvp_link.cpp). Source: the message table of the project's documentation, its
// server and clients (py_openshowvar among them).

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct KvpRequest {
    std::uint16_t id = 0;
    bool write = false;
    std::string name, value;
};
struct KvpAnswer {
    std::uint16_t id = 0;
    bool write = false;
    std::string value;
    bool done = false;
};

inline constexpr std::size_t kKvpLongestText = 4096;

std::string kvp_bytes(const KvpRequest& request);
std::string kvp_bytes(const KvpAnswer& answer);
// Takes the first whole message off the front of `stream`; nullopt while it is not whole. Error (device):
// lengths that contradict each other or exceed kKvpLongestText; the stream is then broken.
Expected<std::optional<KvpRequest>> take_kvp_request(std::string& stream);
Expected<std::optional<KvpAnswer>> take_kvp_answer(std::string& stream);

// KRL's texts of values. A frame: "{X 1.0, Y 2.0, Z 3.0, A 4.0, B 5.0, C 6.0}" with or without a type
// ("FRAME:", "E6POS:") before and further components (S, T, E1..) behind; mm and degrees. Refuses missing
// components, numbers that are not finite or beyond |1e5| mm, |360| degrees.
Expected<Pose> frame_from_krl(std::string_view text);
std::string krl_from_frame(const Pose& pose);
Expected<bool> bool_from_krl(std::string_view text);         // TRUE, FALSE
Expected<std::int64_t> int_from_krl(std::string_view text);  // 17
std::string string_from_krl(std::string_view text);          // "text" without its quotes
std::string krl_from_string(std::string_view text);          // quotes around; quotes inside become '

}  // namespace seamwright
