#pragma once
// What Seamwright and its URScript module (resources/robot/ur/seamwright.script) say to each other in RTDE's
// registers.
//
// Integer and double registers from `first_register` on (24: the first of those that the RTDE guide leaves to
// RTDE clients; 24 to 47 there are). A request is one data package: number, command, arguments, pose; the
// controller takes a package as a whole. The module does what it asks and then sets kAnswered to the
// request's number, last of all. So a frame is never half written, and an answer is never taken for that of
// another request.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright::ur {

inline constexpr int kFirstRegister = 24, kLastRegister = 47;
// In kModule while the module runs; one of before part types leaves kType to others.
inline constexpr std::int32_t kModuleVersion = 530202, kModuleWithoutTypes = 530201;
inline bool is_module(std::int32_t version) {
    return version == kModuleVersion || version == kModuleWithoutTypes;
}
inline constexpr int kMostSpots = 64, kMostFrames = 32;

// Integer registers that the module writes, counted from the first.
enum Output : int {
    kModule,
    kAnswered,
    kStatus,
    kSignatureHigh,  // of the measuring program (program_signature())
    kSignatureLow,
    kFired,              // triggers of the present part
    kCall,               // the number of the line's call for a part, 0 = none
    kPart,               // its id in 4 registers, part_registers()
    kState = kPart + 4,  // Permitted + 10 * Phase
    kType,               // the part's type, as its id
    kOutputs = kType + 4
};
// Of the permission to run paths, and what the robot program is at.
enum class Permitted : std::int32_t { no, given, taken, used_up };
enum class Phase : std::int32_t { elsewhere, waits_for_start, measures, waits_for_verdict };
struct State {
    Permitted permitted = Permitted::no;
    Phase phase = Phase::elsewhere;
};
std::optional<State> state_from(std::int32_t number);
// And those that Seamwright writes. The pose of a request and of its answer: 6 doubles, metres and rotation
// vector.
//
// kSession differs from connection to connection and kBeat counts on while one lasts, five times a second or
// more often: without them for a second the module takes back what the robot program has not yet taken. A
// request that changes something is done with the first beat after it, on the same connection, and dropped
// where none comes within a second: nobody waits for it any more. Command 0 takes a request back.
enum Input : int { kNumber, kCommand, kArgument, kHigh, kLow, kSession, kBeat, kInputs };

enum class Command : std::int32_t {
    read = 1,     // argument: frame; answers its pose
    write = 2,    // argument: frame, with its pose; takes the permission back; answers the pose as written
    measure = 3,  // high, low: signature; starts the program or lets it go on
    trigger = 4,  // argument: number from 1; answers the pose at that trigger
    verdict = 5,  // argument: 1 corrected, 2 refused, 3 failed
    move = 6,     // with a pose; answered when the robot stands there
    taken = 7     // argument: number of the call that was heard
};

enum class Status : std::int32_t {
    done = 0,
    no_frame = 1,
    other_program = 2,
    running = 3,       // the measuring program runs already
    in_use = 4,        // a path runs in the frames: no write
    not_teaching = 5,  // moves want the program sw_teach() to run
    not_waiting = 6,   // no robot program stands in sw_measure()
    unknown_command = 7
};
// The refusal in words; empty for `done`.
std::string_view refusal(std::int32_t status);

// Registers hold no text. A frame's name travels as its FNV-1a hash of 32 bits (two names of one program with
// the same hash are refused when the program is written), a program's signature as its two halves, a part's
// id as up to 16 characters, 4 a register: (position in part_alphabet() + 1) times 96^0 to 96^3, 0 = end.
// Characters outside the alphabet are left out.
std::int32_t frame_number(std::string_view name);
std::pair<std::int32_t, std::int32_t> signature_numbers(std::string_view signature);
std::string_view part_alphabet();  // printable ASCII without " and backslash
std::array<std::int32_t, 4> part_registers(std::string_view part_id);
std::string part_from_registers(const std::array<std::int32_t, 4>& registers);

// Metres and rotation vector on the wire. Error (device): not finite, beyond 100 m, a rotation vector over 4
// pi.
std::array<double, 6> ur_pose(const Pose& pose);
Expected<Pose> pose_from_ur(const std::array<double, 6>& pose, const std::string& where);

}  // namespace seamwright::ur
