#pragma once
// What every kind of feature begins with: the profile's usable points inside the search window.

#include <string>
#include <string_view>
#include <vector>

#include "core/features/contour/contour_noise.h"
#include "core/features/contour/contour_pitch.h"
#include "core/features/feature.h"

namespace seamwright {

// The window's four parameters, for the head of a kind's list. Their defaults mean "the whole profile".
std::vector<ParameterInfo> with_window(std::vector<ParameterInfo> parameters);

struct FeatureWindow {
    double x_min, x_max, z_min, z_max;
    // Refuses a window whose minimum is not below its maximum.
    static Expected<FeatureWindow> from(const ParameterValues& values,
                                        const std::vector<ParameterInfo>& infos);
    bool contains(double x, double z) const { return x >= x_min && x <= x_max && z >= z_min && z <= z_max; }
};

// Usable points (finite, not an outlier) in sensor order, in pieces without a break. Pieces follow the
// profile's segments; in a profile that was not filtered they end where neighbours lie more than six pitches
// apart. A return missing in between does not end a piece unless the gap is that wide.
struct FeaturePoints {
    struct Piece {
        int first, count;            // in x, z
        bool cut_before, cut_after;  // the contour goes on there, outside of the window
    };
    std::vector<double> x, z;
    std::vector<Piece> pieces;
    ContourPitch pitch;

    void gather(const Profile& profile, const FeatureWindow& window);
    // Of the whole profile that was gathered last.
    ProfileNoise noise(SharedOver over) { return profile_noise(all_x_, all_z_, scratch_, over); }

  private:
    std::vector<double> all_x_, all_z_, scratch_;
    std::vector<std::int32_t> all_segment_;
};

}  // namespace seamwright
