#pragma once
// A gap's profile that two heads have seen (double_head.h): the sheets in it, and the faces that hang on them. Private to
// gap_sides.cpp.
//
// In order of x the points of a face lie one above the other, between those of what the other head sees there, and a
// filtered piece may be a panel with its face and the ground, or with the first points of the other panel's face. So here
// neither order nor piece tells what belongs together but where the points lie. A point is level where the main direction of
// those within `reach` of it is less than 50 degrees steep. Level points make a sheet where each lies where the other's slope
// points to: across up to six spacings within a piece, up to 1.8 from one piece to another. What is not level hangs on the
// sheet that it is linked to by the shortest steps, of three times the points' own spacing and 1 mm at most; what lies within
// `reach` of another sheet is that one's (the foot of a face on the ground).
//
// Noise model: the heads may differ; the noise by which sheets are told apart is that which four of five points stay within,
// by what they scatter about their main direction.

#include <vector>

#include "core/features/feature_points.h"

namespace seamwright::gap {

struct LevelSheet {
    int first, last;  // of the points, after arrange()
};

// Working memory; allocates nothing after the first profile of a size.
class HeadsContour {
  public:
    // Brings x, z of `points` into an order in which the sheets stand one after the other, by their least x, each in order of
    // x; what belongs to none stands behind them.
    void arrange(FeaturePoints& points, double noise_mm);
    const std::vector<LevelSheet>& sheets() const { return sheets_; }
    double noise_mm() const { return noise_; }
    // What hangs on the end of the first range of the arranged points, or on the beginning of the second one.
    void share_faces(const FeaturePoints& points, const LevelSheet& before, const LevelSheet& after);
    const std::vector<int>& face(bool of_after) const { return faces_[of_after ? 1 : 0]; }

  private:
    int root(int i);
    void take_slope(const FeaturePoints& points, int i);
    bool beside_another_sheet(const FeaturePoints& points, int i, const LevelSheet& before,
                              const LevelSheet& after) const;

    std::vector<LevelSheet> sheets_;
    std::vector<int> order_, piece_, parent_, place_, faces_[2], loose_, owner_;
    std::vector<double> x_, z_, slope_, scatter_, away_;
    double reach_ = 0, noise_ = 0;
};

}  // namespace seamwright::gap
