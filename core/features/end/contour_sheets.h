#pragma once
// The sheets of a profile: pieces of unbroken surface, and what is known of where each of them ends.
//
// The filter joins what one straight line or one sharp edge explains: the two sides of a hole, the sheets of
// a lap whose step is a few pitches high. To a feature that asks where a surface ends these are several. So a
// segment is divided here
//     at a hole: more lines without return in a row than missing returns explain. With the share q of points
//         whose next line has none, n points have a run of k by chance with n q^k; the limit is that at 1e-5
//         and at least six lines. Lines whose return the filter rejected say nothing and do not count.
//     at a step: lines through up to twelve points on either side (six where those are bent), x and z over
//     the line number, miss each
//         other by more than their noise (six sigma) and by more than one spacing, measured across both of
//         them; one or two points may stand in between (the light of an edge falls on both sheets, or interpolation
//         has drawn a line).
//
// Noise model: equal all over the profile, across the contour; the larger of contour_noise_mm and of what the
// lines miss each other by in the median, which sees noise that runs from point to point (resampling). Not
// seen: a step below about eight sigma of the noise; a gap of less than six lines.
//
// Frame and unit: as the profile, mm. No allocation after the first profile of a size.

#include <array>
#include <vector>

#include "core/features/contour/contour_noise.h"
#include "core/features/contour/contour_pitch.h"
#include "core/features/feature_points.h"

namespace seamwright {

// How a sheet ends.
enum class ContourSheetEnd {
    open,     // the surface stops there, as far as a profile can tell
    window,   // it runs on beyond the search window
    field,    // it leaves the sensor's field: its end is not seen
    covered,  // it runs under a higher one
};

struct ContourSheet {
    int first, count;  // in x, z: sensor order
    ContourSheetEnd before, after;
    // The profile's line of the farthest point that stands in a step beside the end, on neither sheet; -1: none does.
    int mixed_before = -1, mixed_after = -1;
};

// The sensor's field along x, where it is known beside what the profile tells. A profile that lists lines
// without return (at its rim, or some at least) tells it by its first and last line; one without any only when it lies evenly about x = 0,
// as a full field does, or where it is known that its sensor lists every line.
struct SensorField {
    double x_min, x_max;
    bool every_line = false;
};

class ContourSheets {
  public:
    // Usable points (finite, not an outlier) inside the window, in sensor order, and the sheets they form.
    // What lies outside of the window decides how the sheets end, but belongs to none.
    void gather(const Profile& profile, const FeatureWindow& window, const SensorField& field);

    const std::vector<double>& x() const { return x_; }
    const std::vector<double>& z() const { return z_; }
    const std::vector<ContourSheet>& sheets() const { return sheets_; }
    double noise_mm() const { return noise_; }
    const ProfileNoise& noise() const { return profile_noise_; }  // without what the profile's shape adds
    double lost_share() const { return lost_share_; }  // of the lines within a sheet, without return

  private:
    // The limits in lines of the profile, which may lie denser than what was measured (ContourNoise).
    struct Lines {
        explicit Lines(double measured_apart = 1, double shared = 1);
        int lines(int measured) const;
        double apart;
        int hole, side, shorter, between;
    };
    struct Side {
        bool ok = false;
        double x, z, vx, vz;  // at the boundary; advance per line, in the order of the lines
        double variance;      // of x and z there, in units of the points'
        double rms;           // across
        double spacing;
    };
    Side side(int from, int to, double at) const;
    void divide(const Profile& profile);
    struct Jump {
        double height = 0, risen = 0;  // of the lines, of the two points themselves
        double lines = 0;              // across both lines; lines of the sensor that it spans
        double spread = 0,
               rms = 0;  // sigma of the height in units of the points'; of the points on the lines
        double longer = 0, shorter = 0;  // spacing of the two
    };
    Jump jump(int i, int between, int points, bool over_hole = false) const;
    double step(const Jump& over_all, int i, int between) const;
    void find_steps();
    void judge_ends(const Profile& profile, const SensorField& field);

    std::vector<double> all_x_, all_z_, scratch_;
    std::vector<int> line_;  // of every usable point
    std::vector<std::int32_t> segment_;
    std::vector<ContourSheet> whole_;    // over the whole profile
    std::vector<std::uint8_t> cut_;      // [points] a step lies behind the point
    std::vector<std::uint8_t> mixed_;    // [points] stands in a step
    using Sums = std::array<double, 9>;  // of k, x, z, k k, k x, k z, x x, x z, z z; k the line
    std::vector<Sums> sums_;
    double first_line_ = 0;       // from which k counts
    std::vector<int> run_;        // [points] how many up to it lie side by side, at most twelve
    std::vector<Jump> jumps_;     // behind every point
    std::vector<double> height_;  // of the steps, per point
    std::vector<double> x_, z_;
    std::vector<ContourSheet> sheets_;
    ContourPitch pitch_;
    double noise_ = 0, lost_share_ = 0;
    ProfileNoise profile_noise_;
    Lines lines_;
};

}  // namespace seamwright
