#pragma once
// A time in whole days, whole hours and what is left of them at its ends (UTC): for the sources of this folder alone.

#include <cstdint>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright::fleet {

// Milliseconds since 1970, the end not in it; it lies within one day.
struct Span {
    std::int64_t from = 0, until = 0;
};

struct Spans {
    std::string first_day = "-infinity",
                end_day = "infinity";  // the last one not in it; the same: no whole day
    // What no whole day holds, at most two; in each the whole hours that follow each other, and what no whole hour holds.
    std::vector<Span> rest_of_days, hours, rest_of_hours;
};

inline constexpr std::int64_t kHourMs = 3'600'000, kDayMs = 24 * kHourMs;

// As utc_now() writes times; empty: without end. Error (usage): no time.
Expected<Spans> spans_of(const std::string& since_utc, const std::string& until_utc);
// "2024-05-01T06:00:00.250Z"
std::string time_text(std::int64_t ms);

}  // namespace seamwright::fleet
