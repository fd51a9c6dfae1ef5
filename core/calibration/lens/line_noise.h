#pragma once
// What points scatter by across their lines, whatever the form of what remains. Private to core/calibration/camera.
//
// Second differences of the distances in the order along the line, a twelfth of its points apart: a form of a few bends
// hardly has any, and neighbours that err alike (a stripe in a smoothed image) are no longer neighbours there. White noise
// of variance s^2 has them of 6 s^2.

#include <Eigen/Core>
#include <vector>

namespace seamwright {

class LineNoise {
  public:
    static constexpr double kStraightTimes = 1.3;  // neighbours that err alike a little stay below
    // Points of one line, which of them are on it, and how far off it they lie.
    void add(const std::vector<Eigen::Vector2d>& points, const std::vector<char>& on,
             const std::vector<double>& off_px);
    double sigma_px() const;  // 0: no line had three points
    double freedom() const;   // as many independent numbers know it as well
    // Points of a third of a line miss it alike where lens or plane is not the model's: the covariance for that, over the
    // one for points that miss it each by itself. One where the lines are as straight as their points let see (`rms_px`
    // within kStraightTimes their scatter, or within chance).
    double form_factor(double rms_px, double points, int lines) const;
    // Neighbours that err alike: the covariance for that over the one for points that err each by itself, one and twice the
    // sum of the autocorrelation up to where it is no more than chance. Per line fitted were two numbers and a share of
    // `unknowns`, which takes some of it away.
    double alike_factor(double unknowns) const;

  private:
    double squares_ = 0, count_ = 0;
    // Products of points so many places apart along a line, and how many; over all lines.
    std::vector<double> products_, pairs_;
    double lines_ = 0;
};

}  // namespace seamwright
