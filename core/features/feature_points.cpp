#include "core/features/feature_points.h"

#include <fmt/format.h>

#include <cmath>

namespace seamwright {
namespace {
constexpr double kEverywhere_mm = 1e5;
}

std::vector<ParameterInfo> with_window(std::vector<ParameterInfo> parameters) {
    auto limit = [](const char* name, double value, const char* help) {
        return ParameterInfo{name, "mm", -kEverywhere_mm, kEverywhere_mm, value, 3, help};
    };
    parameters.push_back(limit("window_x_min_mm", -kEverywhere_mm, "Left limit of the search window."));
    parameters.push_back(limit("window_x_max_mm", kEverywhere_mm, "Right limit of the search window."));
    parameters.push_back(limit("window_z_min_mm", -kEverywhere_mm, "Lower limit of the search window."));
    parameters.push_back(limit("window_z_max_mm", kEverywhere_mm, "Upper limit of the search window."));
    return parameters;
}

Expected<FeatureWindow> FeatureWindow::from(const ParameterValues& values,
                                            const std::vector<ParameterInfo>& infos) {
    FeatureWindow w{parameter(values, infos, "window_x_min_mm"), parameter(values, infos, "window_x_max_mm"),
                    parameter(values, infos, "window_z_min_mm"), parameter(values, infos, "window_z_max_mm")};
    if (!(w.x_min < w.x_max))
        return input_error(Text("the window from x = {} to {} mm is empty", w.x_min, w.x_max),
                           "window_x_min_mm", "give a minimum below the maximum");
    if (!(w.z_min < w.z_max))
        return input_error(Text("the window from z = {} to {} mm is empty", w.z_min, w.z_max),
                           "window_z_min_mm", "give a minimum below the maximum");
    return w;
}

void FeaturePoints::gather(const Profile& profile, const FeatureWindow& window) {
    x.clear();
    z.clear();
    pieces.clear();
    all_x_.clear();
    all_z_.clear();
    all_segment_.clear();
    const bool marked = profile.filtered();
    const std::size_t n = std::min(profile.x_mm.size(), profile.z_mm.size());
    for (std::size_t i = 0; i < n; ++i) {
        const double px = profile.x_mm[i], pz = profile.z_mm[i];
        if (!std::isfinite(px) || !std::isfinite(pz) || (marked && profile.segment[i] == kOutlier)) continue;
        all_x_.push_back(px);
        all_z_.push_back(pz);
        all_segment_.push_back(marked ? profile.segment[i] : 0);
    }
    pitch = contour_pitch(all_x_, all_z_, scratch_);
    bool before_inside = false;
    for (std::size_t i = 0; i < all_x_.size(); ++i) {
        bool joined = i > 0 && all_segment_[i] == all_segment_[i - 1];
        if (joined && !marked) {
            const double dx = all_x_[i] - all_x_[i - 1], dz = all_z_[i] - all_z_[i - 1];
            joined = !pitch.is_gap(dx, dz) && !pitch.is_wall(dx, dz);
        }
        const bool inside = window.contains(all_x_[i], all_z_[i]);
        if (inside) {
            if (!joined || !before_inside) pieces.push_back({static_cast<int>(x.size()), 0, joined, false});
            x.push_back(all_x_[i]);
            z.push_back(all_z_[i]);
            ++pieces.back().count;
        } else if (joined && before_inside) {
            pieces.back().cut_after = true;
        }
        before_inside = inside;
    }
}

}  // namespace seamwright
