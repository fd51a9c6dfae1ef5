#include "core/calibration/bundle/bundle_units.h"

#include <array>

namespace seamwright::bundle {

Text other_unit(const std::vector<PlacedCamera>& cameras, const std::vector<BundleSight>& sights,
                const BundleOptions& options) {
    constexpr std::array<std::pair<double, const char*>, 2> kUnits{{{1000, "metres"}, {25.4, "inches"}}};
    BundleOptions freely = options;
    freely.start.reset();
    const auto fits = [&](const std::vector<PlacedCamera>& placed, const std::vector<BundleSight>& seen) {
        const auto solved = locate_as_given(placed, seen, freely);
        return solved && solved->determined && serves(solved->report.judgement.verdict);
    };
    for (const auto& [factor, unit] : kUnits) {
        std::vector<BundleSight> seen = sights;
        for (BundleSight& s : seen) s.object_mm *= factor;
        if (fits(cameras, seen))
            return Text("the features' places on the object are {}: write millimetres", Text(unit));
        std::vector<PlacedCamera> placed = cameras;
        for (PlacedCamera& c : placed) c.world_from_camera.pose.translation() *= factor;
        if (fits(placed, sights))
            return Text("the places of the cameras are {}: write millimetres", Text(unit));
    }
    return {};
}

}  // namespace seamwright::bundle
