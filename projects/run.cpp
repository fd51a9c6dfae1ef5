#include "projects/run.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <chrono>

namespace seamwright {
namespace {

constexpr auto kSpotStatus = std::to_array<std::string_view>(
    {"measured", "not_measured", "damaged_frame", "no_stripe", "no_calibration", "no_feature"});
constexpr auto kPushStatus =
    std::to_array<std::string_view>({"not_pushed", "written", "failed", "restored", "not_restored"});
constexpr auto kEventKind =
    std::to_array<std::string_view>({"note", "refusal", "push_attempt", "push", "alarm", "device"});
constexpr auto kRunStatus =
    std::to_array<std::string_view>({"interrupted", "ok", "refused", "alarm", "device", "cancelled"});

template <class E, std::size_t N>
std::optional<E> find_word(const std::array<std::string_view, N>& words, std::string_view name) {
    for (std::size_t i = 0; i < N; ++i)
        if (words[i] == name) return static_cast<E>(i);
    return std::nullopt;
}

}  // namespace

std::string_view to_string(SpotStatus status) {
    return kSpotStatus.at(static_cast<std::size_t>(status));
}
std::string_view to_string(PushStatus status) {
    return kPushStatus.at(static_cast<std::size_t>(status));
}
std::string_view to_string(EventKind kind) {
    return kEventKind.at(static_cast<std::size_t>(kind));
}
std::string_view to_string(RunStatus status) {
    return kRunStatus.at(static_cast<std::size_t>(status));
}

std::optional<SpotStatus> spot_status_from(std::string_view name) {
    return find_word<SpotStatus>(kSpotStatus, name);
}
std::optional<PushStatus> push_status_from(std::string_view name) {
    return find_word<PushStatus>(kPushStatus, name);
}
std::optional<EventKind> event_kind_from(std::string_view name) {
    return find_word<EventKind>(kEventKind, name);
}
std::optional<RunStatus> run_status_from(std::string_view name) {
    return find_word<RunStatus>(kRunStatus, name);
}

StripeImage StoredImage::view() const {
    StripeImage image;
    image.pixels = pixels.data();
    image.width = width;
    image.height = height;
    image.bit_depth = bit_depth;
    image.row_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(image.bytes_per_pixel());
    return image;
}

std::string utc_now() {
    const auto now = std::chrono::system_clock::now();
    const auto ms =
        std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                       ms);
}

}  // namespace seamwright
