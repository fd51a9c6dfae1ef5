#include "projects/model/run.h"

#include <array>

#include "projects/model/project.h"

namespace seamwright {

const KeptOffset* acting_offset(const Region& region) {
    const int version = region.offset_switches.empty() ? 0 : region.offset_switches.back();
    for (const KeptOffset& offset : region.offsets)
        if (version != 0 && offset.version == version) return &offset;
    return nullptr;
}

Text said_of(const ActingOffset& offset) {
    const Eigen::Vector3d& by = offset.offset_mm;
    return Text("kept offset {} acts: X {:.3f} Y {:.3f} Z {:.3f} mm are taken off", offset.version, by.x(),
                by.y(), by.z());
}

const ActingDrift* acting_drift(const RunRecord& run) {
    for (const RegionRecord& region : run.regions)
        if (region.drift) return &*region.drift;
    return nullptr;
}

Text said_of(const ActingDrift& drift) {
    if (!drift.compensated)
        return drift.why.empty() ? Text("drift watch: {}", drift.text)
                                 : Text("drift watch: {}; nothing is compensated: {}", drift.text, drift.why);
    const Eigen::Vector3d& by = drift.shift_mm;
    return Text("drift watch: {}; compensated as drift of {}: X {:.3f} Y {:.3f} Z {:.3f} mm are taken off",
                drift.text, drift.device_id, by.x(), by.y(), by.z());
}

Text said_of(const ActingModes& modes) {
    if (!modes.acted) return Text("the modes do not act, the part is taken for rigid: {}", modes.why);
    return Text("{} modes act: at most {:.3f} mm are added at a spot", modes.amplitudes_mm.size(),
                modes.largest_added_mm);
}

namespace {

constexpr auto kSpotStatus = std::to_array<std::string_view>(
    {"measured", "not_measured", "damaged_frame", "no_stripe", "no_calibration", "no_feature"});
constexpr auto kPushStatus =
    std::to_array<std::string_view>({"not_pushed", "written", "failed", "restored", "not_restored"});
constexpr auto kEventKind =
    std::to_array<std::string_view>({"note", "refusal", "push_attempt", "push", "alarm", "device"});
constexpr auto kRunStatus = std::to_array<std::string_view>(
    {"interrupted", "pushed", "ok", "refused", "not_taken", "alarm", "device", "cancelled"});
constexpr auto kRelease =
    std::to_array<std::string_view>({"none", "given", "taken", "not_taken", "withdrawn"});

constexpr auto kPanelVerdict =
    std::to_array<std::string_view>({"not_verified", "in_tolerance", "out_of_tolerance"});

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
std::string_view to_string(Release release) {
    return kRelease.at(static_cast<std::size_t>(release));
}
std::optional<Release> release_from(std::string_view name) {
    return find_word<Release>(kRelease, name);
}
std::string_view to_string(EventKind kind) {
    return kEventKind.at(static_cast<std::size_t>(kind));
}
std::string_view to_string(RunStatus status) {
    return kRunStatus.at(static_cast<std::size_t>(status));
}

std::string_view to_string(PanelVerdict verdict) {
    return kPanelVerdict.at(static_cast<std::size_t>(verdict));
}

std::optional<EventKind> event_kind_from(std::string_view name) {
    return find_word<EventKind>(kEventKind, name);
}
std::optional<RunStatus> run_status_from(std::string_view name) {
    return find_word<RunStatus>(kRunStatus, name);
}

}  // namespace seamwright
