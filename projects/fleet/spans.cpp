#include "projects/fleet/spans.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "projects/statistics/production.h"

namespace seamwright::fleet {
namespace {

std::int64_t down_to(std::int64_t ms, std::int64_t unit) {
    return ms - (ms % unit + unit) % unit;
}
std::int64_t up_to(std::int64_t ms, std::int64_t unit) {
    return down_to(ms + unit - 1, unit);
}

// Whole units, and what is left at the ends.
void split(Span all, std::int64_t unit, std::vector<Span>& whole, std::vector<Span>& rest) {
    if (all.from >= all.until) return;
    const Span in{up_to(all.from, unit), down_to(all.until, unit)};
    if (in.from > in.until) return rest.push_back(all);
    if (all.from < in.from) rest.push_back({all.from, in.from});
    if (in.from < in.until) whole.push_back(in);
    if (in.until < all.until) rest.push_back({in.until, all.until});
}

Expected<std::optional<std::int64_t>> time_of(const std::string& utc) {
    if (utc.empty()) return std::optional<std::int64_t>();
    const auto ms = utc_milliseconds(utc);
    if (!ms) return usage_error(Text("\"{}\" is no time", utc), "--since, --until");
    return ms;
}

}  // namespace

std::string time_text(std::int64_t ms) {
    const std::int64_t second = down_to(ms, 1000);
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(second / 1000)),
                       ms - second);
}

Expected<Spans> spans_of(const std::string& since_utc, const std::string& until_utc) {
    SEAM_TRY(const auto since, time_of(since_utc));
    SEAM_TRY(const auto until, time_of(until_utc));
    Spans out;
    std::vector<Span> days;
    if (since && until) {
        out.first_day = out.end_day = "1970-01-01";
        split({*since, *until}, kDayMs, days, out.rest_of_days);
    } else if (since) {
        split({*since, up_to(*since, kDayMs)}, kDayMs, days, out.rest_of_days);
        days = {{up_to(*since, kDayMs), 0}};
    } else if (until) {
        split({down_to(*until, kDayMs), *until}, kDayMs, days, out.rest_of_days);
        days = {{0, down_to(*until, kDayMs)}};
    }
    const auto day = [](std::int64_t ms) { return time_text(ms).substr(0, 10); };
    if (since && !days.empty()) out.first_day = day(days.front().from);
    if (until && !days.empty()) out.end_day = day(days.front().until);
    for (const Span& rest : out.rest_of_days) split(rest, kHourMs, out.hours, out.rest_of_hours);
    return out;
}

}  // namespace seamwright::fleet
