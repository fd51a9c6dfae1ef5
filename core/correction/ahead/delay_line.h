#pragma once
// The delay line by path length: what a sensor before the tool has measured, asked for when the tool is there.
//
// A measure is how far the contour lies off its guide (guide.h) at path length s, in the two directions that a
// profile tells of, with its covariance. Time does not enter: a tool that is slowed, stopped or sped up finds the
// same at the same place. Measures may come in any order; of two within kSamePlaceMm the first one stays.
//
// Between measures: the local line y(s') = o + b (s' - s), least squares with the weights
//     k(|s' - s| / w) / tr C,   k(u) = (1 - u^3)^3   (tricube; Cleveland 1979)
// over the half width w. What runs linearly along the path is given back exactly, whatever the distances of the
// measures, and the answer has no step where a measure enters or leaves the window. Its covariance is
// sum l_i^2 C_i for the line's own weights l_i; noise of the measures counts as independent.
//
// Smoothing is matched to sigma: the mean of n measures over 2 w has sigma / sqrt(n), so that
//     w = pitch / 2 (sigma / wanted)^2, within shortest .. longest
// smooths no more than `wanted_sigma_mm` needs; pitch and sigma are those of the measures themselves.
//
// Implausible: a measure is judged by what its nearest neighbour says (smoothed, covariance P), at the distance d:
//     r^T (P + C + (slope d)^2)^-1 r <= gate^2.
// It is not kept, and leaves a gap; a gap longer than `most_gap_mm` between two measures is a lost stretch. A true
// step of the part is thereby lost first and taken up again behind it, never followed blindly.

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace seamwright {

struct AheadMeasure {
    double s_mm = 0;
    Eigen::Vector2d off_mm = Eigen::Vector2d::Zero();  // across, height
    Eigen::Matrix2d covariance_mm2 = Eigen::Matrix2d::Zero();
};

struct DelayLineOptions {
    double wanted_sigma_mm = 0.02;            // of the smoothed offset
    double shortest_mm = 2, longest_mm = 10;  // half width of the window
    double most_gap_mm = 15;                  // longer without a measure is lost
    double slope = 0.05;                      // standard deviation of the offset's change, mm per mm of path
    double gate = 5;                          // in standard deviations
    std::size_t capacity = 4096;              // the oldest goes when it is full
};

// w of above.
double matched_half_width_mm(double sigma_mm, double pitch_mm, const DelayLineOptions& options);

enum class AheadState {
    nothing,  // no measure at all
    before,   // of the first measure: it holds
    known,
    lost,   // in a gap longer than most_gap_mm: the line across it
    behind  // of the newest measure by more than shortest_mm: it holds
};

struct AheadOffset {
    AheadState state = AheadState::nothing;
    Eigen::Vector2d off_mm = Eigen::Vector2d::Zero();
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // d off / d s
    Eigen::Matrix2d covariance_mm2 = Eigen::Matrix2d::Zero();
    double sigma_mm() const;  // in the worse direction
};

// Allocates nothing after its making. One thread at a time.
class DelayLine {
  public:
    explicit DelayLine(const DelayLineOptions& options);
    // False: implausible (numbers that are not finite too), and not kept.
    bool add(const AheadMeasure& measure);
    AheadOffset at(double s_mm) const;
    void forget_before(double s_mm);  // the tool has passed there
    void clear() { measures_.clear(); }

    bool empty() const { return measures_.empty(); }
    std::size_t size() const { return measures_.size(); }
    double first_mm() const { return measures_.front().s_mm; }
    double newest_mm() const { return measures_.back().s_mm; }  // of the greatest path length
    double half_width_mm() const { return half_width_mm_; }

    static constexpr double kSamePlaceMm = 0.05;

  private:
    std::size_t above(double s_mm) const;  // the first measure beyond s
    AheadOffset line_at(double s_mm) const;

    DelayLineOptions options_;
    std::vector<AheadMeasure> measures_;  // by path length
    double half_width_mm_;
    double mean_pitch_mm_ = 0, mean_variance_ = 0;  // of the newest ones
};

}  // namespace seamwright
