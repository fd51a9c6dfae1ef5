#pragma once
// How every fallible function of the house answers.
//
// A bug asserts. Bad input or environment is an Error inside tl::expected. A numerical outcome ("did not
// converge", "under-determined") is no Error but a status inside the result.

#include <string>
#include <tl/expected.hpp>

#include "core/text.h"
#include "core/value_type.h"

namespace seamwright {

// Decides the exit code of the command line: usage and input end with 2, device and file with 3.
enum class ErrorKind { usage, input, device, file };

// What a caller may act upon; the sentence is for people alone.
enum class ErrorCode {
    none,              // only to be told
    silence,           // nothing came in time
    disconnected,      // the other side went away
    in_use,            // another program holds the device
    end_of_recording,  // of a replayed device
    no_such_frame,     // the controller has no frame of that name
    not_ready,         // the robot's program is elsewhere just now; it may be asked again
    cancelled
};

// One clear sentence: what is wrong, where, and how to mend it. `where` and `mend` may be empty.
struct Error {
    SEAM_VALUE_TYPE(Error);
    Error(ErrorKind its_kind, Text its_what, Text its_where = {}, Text its_mend = {},
          ErrorCode its_code = ErrorCode::none);
    ErrorKind kind = ErrorKind::input;
    Text what;   // "the rotation is not orthonormal (off by 0.02)"
    Text where;  // "spots[3].workobject_from_sensor"
    Text mend;   // "give a rotation matrix whose rows have length 1"
    ErrorCode code = ErrorCode::none;
    Text text() const;             // "door.seam: the file does not exist; choose a .seam file"
    std::string sentence() const;  // in English
    // The same, seen from further out: "spot T1: feature: ..."
    void within(const Text& place) { where = joined(place, ": ", where); }
};

template <class T>
using Expected = tl::expected<T, Error>;

tl::unexpected<Error> input_error(Text what, Text where = {}, Text mend = {});
tl::unexpected<Error> usage_error(Text what, Text where = {}, Text mend = {});
tl::unexpected<Error> device_error(Text what, Text where = {}, Text mend = {});
tl::unexpected<Error> device_error(ErrorCode code, Text what, Text where = {}, Text mend = {});
tl::unexpected<Error> file_error(Text what, Text where = {}, Text mend = {});

}  // namespace seamwright

// An Expected that failed ends the function with its error; else the function goes on.
//   SEAM_TRY(const auto pose, read_pose(json));   the value, under a name: pose is a Pose from here on
//   SEAM_OK(write(pose));                         only that it went well
// Two statements each: not the body of an `if` without braces (SEAM_TRY), and one a line.
#define SEAM_TRY(declaration, ...) SEAM_TRY_ON_LINE(__LINE__, declaration, __VA_ARGS__)
#define SEAM_TRY_ON_LINE(line, ...) SEAM_TRY_NAMED(line, __VA_ARGS__)
#define SEAM_TRY_NAMED(line, ...) SEAM_TRY_INTO(seam_try_##line, __VA_ARGS__)
#define SEAM_TRY_INTO(result, declaration, ...)                    \
    auto result = (__VA_ARGS__);                                   \
    if (!result) return tl::unexpected(std::move(result).error()); \
    declaration = *std::move(result)
#define SEAM_OK(...) \
    if (auto seam_ok = (__VA_ARGS__); !seam_ok) return tl::unexpected(std::move(seam_ok).error())
