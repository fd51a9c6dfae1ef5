#include "projects/proof/present_names.h"

#include <algorithm>
#include <vector>

namespace seamwright {
namespace {

template <class T>
const T* named(const std::vector<T>& all, const std::string& id) {
    const auto at = std::ranges::find(all, id, &T::id);
    return at == all.end() ? nullptr : &*at;
}

// Nothing went and nothing was renamed or moved: the ordinary case, asked for every spot with every edit.
template <class T>
bool kept(const std::vector<T>& then, const std::vector<T>& now) {
    return then.size() <= now.size() && std::equal(then.begin(), then.end(), now.begin(),
                                                   [](const T& a, const T& b) { return a.id == b.id; });
}

// same(a, b): a of then is b of now.
template <class T, class Same>
std::optional<std::string> today(const std::vector<T>& then, const std::vector<T>& now, const std::string& id,
                                 const Same& same) {
    const T* was = named(then, id);
    if (!was) return id;
    const auto keeps_name = [&](const T& a) {
        const T* b = named(now, a.id);
        return b && same(a, *b);
    };
    if (keeps_name(*was)) return id;
    std::vector<const T*> candidates;
    for (const T& b : now) {
        const T* before = named(then, b.id);
        if (same(*was, b) && !(before && same(*before, b))) candidates.push_back(&b);
    }
    if (!candidates.empty()) {
        // Of several that were the same, the first is the first of today's.
        const auto rank = static_cast<std::size_t>(std::count_if(
            then.data(), was, [&](const T& a) { return !keeps_name(a) && same(a, *candidates.front()); }));
        if (rank < candidates.size()) return candidates[rank]->id;
    }
    const T* is = named(now, id);
    if (!is || std::ranges::any_of(then, [&](const T& a) { return &a != was && same(a, *is); }))
        return std::nullopt;
    return id;
}

constexpr auto kSameDevice = [](const auto& a, const auto& b) {
    return a.driver == b.driver && a.identity == b.identity;
};

template <class Proof>
void rename_regions(std::vector<Proof>& regions, const PresentNames& names, const Project& now) {
    for (Proof& r : regions) {
        if (const auto name = names.region(r.region_id))
            r.region_id = *name;
        else if (named(now.regions, r.region_id))
            r.region_id += "'";
    }
}

}  // namespace

PresentNames::PresentNames(const Project& then, const Project& now)
    : then_(then),
      now_(now),
      devices_kept_(kept(then.sensors, now.sensors) && kept(then.robots, now.robots)),
      spots_kept_(kept(then.spots, now.spots)),
      regions_kept_(kept(then.regions, now.regions)) {}

std::optional<std::string> PresentNames::sensor(const std::string& id) const {
    if (devices_kept_) return id;
    return today(then_.sensors, now_.sensors, id, kSameDevice);
}

std::optional<std::string> PresentNames::robot(const std::string& id) const {
    if (devices_kept_) return id;
    return today(then_.robots, now_.robots, id, kSameDevice);
}

std::optional<std::string> PresentNames::spot(const std::string& id) const {
    if (spots_kept_) return id;
    return today(then_.spots, now_.spots, id, [this](const Spot& a, const Spot& b) {
        constexpr double kExact = 1e-12;
        return a.base_from_flange.isApprox(b.base_from_flange, kExact) && a.type_id == b.type_id &&
               a.feature.kind == b.feature.kind && a.feature.parameters == b.feature.parameters &&
               a.feature.template_reference_mm.isApprox(b.feature.template_reference_mm, kExact) &&
               sensor(a.sensor_id) == b.sensor_id && robot(a.robot_id) == b.robot_id;
    });
}

std::optional<std::string> PresentNames::region(const std::string& id) const {
    if (regions_kept_) return id;
    return today(then_.regions, now_.regions, id, [this](const Region& a, const Region& b) {
        return a.type_id == b.type_id && a.free == b.free &&
               std::equal(a.spot_ids.begin(), a.spot_ids.end(), b.spot_ids.begin(), b.spot_ids.end(),
                          [this](const std::string& was, const std::string& is) { return spot(was) == is; });
    });
}

bool is_pass_of(const Project& now, const Facts& facts, const Evidence& evidence,
                const std::string& spot_id) {
    const auto* pass = std::get_if<FrozenContour>(&evidence.what);
    if (!pass) return false;
    const auto then = facts.setups.find(evidence.setup);
    if (then == facts.setups.end()) return pass->spot_id == spot_id;
    return PresentNames(*then->second, now).spot(pass->spot_id) == spot_id;
}

const Evidence* newest_pass(const Project& now, const Facts& facts, const std::string& spot_id) {
    for (auto e = facts.evidence.rbegin(); e != facts.evidence.rend(); ++e)
        if (is_pass_of(now, facts, *e, spot_id)) return &*e;
    return nullptr;
}

ZeroShift in_present_names(ZeroShift proof, const Project& then, const Project& now) {
    rename_regions(proof.regions, PresentNames(then, now), now);
    return proof;
}

KnownShift in_present_names(KnownShift proof, const Project& then, const Project& now) {
    const PresentNames names(then, now);
    for (ShiftTest& test : proof.tests) rename_regions(test.regions, names, now);
    return proof;
}

}  // namespace seamwright
