#pragma once
// Errors of kind device that callers tell apart: nothing came in time, the other side went away, or another
// program holds the device.

#include "core/error.h"

namespace seamwright {

// Their words, beside their codes: `what` of such an Error begins so.
inline constexpr const char* kNoAnswer = "no answer in time";
inline constexpr const char* kDisconnected = "the connection was closed by the other side";

inline constexpr const char* kInUse = "another program controls the camera";

inline bool is_in_use(const Error& e) {
    return e.code == ErrorCode::in_use;
}
inline bool is_silence(const Error& e) {
    return e.code == ErrorCode::silence;
}
// For a call that waits for an event, whose own silence only says that the event has not come.
inline Error fell_silent(Error e) {
    if (is_silence(e)) {
        e.what = Text("the controller is silent: {}", e.what);
        e.code = ErrorCode::none;
    }
    return e;
}
inline bool is_disconnect(const Error& e) {
    return e.code == ErrorCode::disconnected;
}

}  // namespace seamwright
