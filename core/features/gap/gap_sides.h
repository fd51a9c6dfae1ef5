#pragma once
// The two parts on either side of a gap, up to where each of them is seen to end.
//
// The filter judges a point by its spacing and takes the steep end of a rounded rim for outliers or for
// pieces of their own: the last of what is seen of the rim is then missing, and a gap is measured too wide by
// up to the rim's radius. So a part is its surface (the piece of most points on that side) and what goes on
// from it towards the gap, whatever the filter said of it. From the part's last points with slope g per line
// a further point is taken where its advance across lies between 0.6 g and f g per line, with a tolerance of
// one spacing and 4.2 sigma sqrt(2): a rim that falls away falls steeper from line to line. f = 1.2 w /
// (sqrt(w + 1) - 1) is the steepest that a circle does after the w lines of which g is the mean. A steeper
// step, up to 1 mm, is taken where the next one falls as well: the face of a square cut. Points that
// do not go on so are passed over, two at most (a spark). Where the contour flattens out instead, it has
// reached the ground, and the last steep step to it is taken back.
//
// Frame and unit: as the profile, mm. Noise model: sigma across, from the second differences of each part's
// surface.

#include <vector>

#include "core/features/feature_points.h"

namespace seamwright {

// Points of one part, from the gap inwards.
struct GapPart {
    std::vector<double> x, z;
    double noise_mm = 0;
};

class GapSides {
  public:
    enum class Found { both, no_points, one_surface, unbroken };
    // Pieces shorter than `least` points are no surface. Left and right by x. Allocates nothing after the
    // first profile of a size.
    Found find(const Profile& profile, const FeatureWindow& window, int least);

    const GapPart& left() const { return parts_[0]; }
    const GapPart& right() const { return parts_[1]; }
    double pitch_mm() const { return pitch_; }  // along x, from line to line
    ProfileNoise noise() { return points_.noise(); }

  private:
    struct Core {
        int first, last;  // of the raw points
    };
    bool two_cores(int least, Core& before, Core& after) const;
    int break_between(const Core& before, const Core& after) const;
    double noise_of(int first, int last) const;
    int walked(int from, int step, int stop, double noise) const;

    FeaturePoints points_;
    std::vector<double> x_, z_;  // all that came back in the window
    std::vector<int> raw_;       // [points_] in x_, z_
    mutable std::vector<double> scratch_;
    mutable std::vector<int> trail_;
    GapPart parts_[2];
    double pitch_ = 0;
};

}  // namespace seamwright
