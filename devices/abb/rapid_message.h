#pragma once
// The messages between us and the RAPID server task.
//
// A RAPID string holds 80 characters, and SocketReceive with \ReadNoOfBytes reads a known number of bytes in
// one instruction. So every message in either direction is three lines of exactly 80 bytes: 79 printable
// ASCII characters, padded with blanks, and a line feed.
//   line 1  NUMBER WORD [FIELD ...]     fields separated by one blank
//   line 2  x y z of a pose in mm, 4 decimals;  or a text
//   line 3  q1 q2 q3 q4 of the pose (w first), 8 decimals
// The number of a request is 1 to 8388607 (exact in RAPID's num) and counts up; the answer bears the same
// number. Events of the controller bear number 0.
//
//   request                           answer
//   n HELLO 2 (protocol version)      n HELLO 2 / serial / model      (1: a module that does not know PERMIT)
//   n MODE                            n MODE AUTO|MANR|MANF|UNDEF ON|OFF|STOP|ESTOP RUN|HALT
//   n POSE                            n POSE             + pose base_from_flange
//   n READ frame                      n READ frame       + pose base_from_frame
//   n WRITE frame                     n WRITE frame      + pose as staged (the request has one too)
//   n MEASURE count signature         n MEASURE count    compares with its program (program_signature())
//   n VERDICT CORRECTED frames + text             n VERDICT CORRECTED    frames written for this part; refused where it
//                                                                        holds another number of them
//   n VERDICT REFUSED|FAILED + text     n VERDICT word
//   n PERMIT                          n PERMIT NONE|GIVEN|TAKEN       what became of VERDICT CORRECTED
//   n MOVE                            n MOVE                 (with a pose; answered when standing there)
//   n PING                            n PING
//   any of them                       n NO word + text of the reason
//   event                             0 TRIGGER count index spot + pose
//   event                             0 START count + part in line 2, its type in line 3
//   event                             0 END count        the measuring program has ended after so many
//   triggers
// Here HELLO's answer has the serial number in line 2 and the type in line 3.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::abb {

inline constexpr std::size_t kLineBytes = 80, kMessageBytes = 3 * kLineBytes;
inline constexpr std::uint32_t kHighestNumber = 8388607;

struct Message {
    std::uint32_t number = 0;
    std::string word;
    std::vector<std::string> fields;
    std::string line2, line3;  // without padding
};

// Refuses other lengths than 240, a missing line feed, characters outside printable ASCII, a number that is
// none. `where` is the peer.
Expected<Message> parse_message(std::string_view bytes, const std::string& where);
// Precondition of the fields: short enough and without blanks; what is too long for its line is cut, what is
// not printable ASCII becomes '?'.
std::string message_bytes(const Message& message);

// Lines 2 and 3.
Expected<Pose> parse_pose_lines(const Message& message, const std::string& where);
void set_pose_lines(Message& message, const Pose& pose);
// A decimal integer without sign, at most `highest`.
std::optional<std::uint32_t> parse_count(std::string_view text, std::uint32_t highest = kHighestNumber);

// May the controller hold this name as an identifier?
bool is_rapid_identifier(std::string_view name);
// As a spot is named in a message and a RAPID string.
bool is_spot_name(std::string_view name);

}  // namespace seamwright::abb
