#pragma once
// Errors of kind device that callers tell apart: nothing came in time, or the other side went away.

#include "core/error.h"

namespace seamwright {

// `what` of such an Error begins with these words.
inline constexpr const char* kNoAnswer = "no answer in time";
inline constexpr const char* kDisconnected = "the connection was closed by the other side";

inline bool is_silence(const Error& e) {
    return e.what.starts_with(kNoAnswer);
}
inline bool is_disconnect(const Error& e) {
    return e.what.starts_with(kDisconnected);
}

}  // namespace seamwright
