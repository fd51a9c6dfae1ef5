#pragma once
// The deviation map: how far every point of a scan lies off the part.

#include <functional>

#include "core/cloud/surface.h"

namespace seamwright {

struct DeviationOptions {
    double most_mm = 10;  // further off: none of this part
    double noise_mm = 0;
    int bins = 41;  // of the histogram, odd: the middle one is about 0
    std::function<bool()> cancelled;
};

struct HistogramBin {
    double from_mm = 0, to_mm = 0;
    std::size_t count = 0;
};

struct DeviationMap {
    std::vector<float>
        signed_mm;  // one a point, outside positive; NaN: beyond most_mm or beyond the sheet's border
    std::size_t counted = 0;
    double mean_mm = 0, rms_mm = 0;
    double three_sigma_mm = 0;  // of the scatter about the mean
    // The worst place: the neighbourhood (not the point: that is noise) with the largest mean deviation, in the part's
    // frame and in base.
    Eigen::Vector3d worst_part_mm = Eigen::Vector3d::Zero(), worst_base_mm = Eigen::Vector3d::Zero();
    double worst_mm = 0;  // signed
    std::vector<HistogramBin> histogram;
    double share_seen = 0;  // of the part's area that has points near; of a sheet with two sides, of both
    bool cancelled = false;
};

DeviationMap deviation_map(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                           const DeviationOptions& options);

// Of signed_mm as they stand; nothing where there are none.
void make_histogram(DeviationMap& map, int bins);

}  // namespace seamwright
