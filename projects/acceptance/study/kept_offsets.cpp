#include "projects/acceptance/study/kept_offsets.h"

#include <algorithm>

namespace seamwright {

Expected<int> keep_offset(Region& region, const Acceptance& a, const std::string& now_utc) {
    const Text where("region {}: offset", region.id);
    if (!a.correlation) return input_error("there is no correlation", where, "make it: --study correlation");
    if (!a.source.offset || a.source.offset->region_id != region.id)
        return input_error("the values are not of stored runs of this region", where,
                           "an offset is kept of the project's own runs");
    const Correlation& c = *a.correlation;
    if (c.verdict == AcceptanceVerdict::too_little_data)
        return input_error(Text("{} parts prove no offset", c.pairs.size()), where,
                           Text("measure at least {} parts on both", kCorrelationPairs));
    if (!c.line.slope_limits.contains(1))
        return input_error(
            Text("the slope is {:.4f} and not 1, so that no offset is right for all parts", c.line.slope),
            where, "find what errs with the displacement: calibration, scale");
    if (c.offset_limits.contains(0))
        return input_error(Text("the offset of {:.4f} mm may be chance", c.offset_mm), where,
                           "leave it as it is, or measure more parts");
    const Eigen::Vector3d& n = a.source.offset->direction;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
    const double of_mean = c.s_mm * c.s_mm / static_cast<double>(c.pairs.size());
    KeptOffset kept;
    for (const KeptOffset& before : region.offsets) kept.version = std::max(kept.version, before.version);
    ++kept.version;
    kept.utc = now_utc;
    kept.source = Text("correlation of {} parts, {}", c.pairs.size(), a.source.measurand);
    kept.offset_mm = c.offset_mm * n;
    kept.covariance_mm2 = of_mean * n * n.transpose();
    if (const auto& acting = a.source.offset->acting) {
        kept.offset_mm += acting->offset_mm;
        kept.covariance_mm2 += across * acting->covariance_mm2 * across;
    }
    region.offsets.push_back(std::move(kept));
    return region.offsets.back().version;
}

Expected<void> switch_offset(Region& region, int version) {
    const Text where("region {}: offset", region.id);
    const KeptOffset* acting = acting_offset(region);
    if (version != 0 && std::none_of(region.offsets.begin(), region.offsets.end(),
                                     [&](const KeptOffset& kept) { return kept.version == version; }))
        return input_error(Text("there is no version {}", version), where,
                           region.offsets.empty() ? Text("keep one first: --keep-offset")
                                                  : Text("there are {}", region.offsets.size()));
    if ((acting ? acting->version : 0) == version)
        return input_error(version == 0 ? Text("none acts") : Text("version {} acts already", version),
                           where);
    if (region.offset_switches.empty()) region.offset_switches.push_back(0);
    region.offset_switches.push_back(version);
    return {};
}

Expected<void> undo_offset(Region& region) {
    if (region.offset_switches.size() < 2)
        return input_error("no offset was switched", Text("region {}: offset", region.id));
    region.offset_switches.pop_back();
    if (region.offset_switches.size() == 1) region.offset_switches.clear();
    return {};
}

}  // namespace seamwright
