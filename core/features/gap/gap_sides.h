#pragma once
// The two parts on either side of a gap, up to where each of them is seen to end.
//
// The filter joins a panel with the ground in the gap over a face that is seen, and over the ramp that a sensor's
// smoothing makes of a step; it takes a narrow gap's few points for outliers. So its pieces are divided where they are
// steeper than 65 degrees (54 where the sensor smooths, or where nothing is known of that) and at holes: more lines
// without return than are missing by chance, or left out by the filter and lower than the contour on either side. What
// goes on from one to the next is put together again. The parts are the two largest sheets with nothing as high as they
// are, and of a third of their size at least, in between. A sheet between them that lies under both, in the lower half of the
// depth that is seen, is the ground: no part reaches it. What else lies between them as high as a panel, beyond a dark streak or
// a step, belongs to a panel: that on its side of the ground, else that whose line it continues. It cannot be told which the
// parts are where neither tells, where a part may be ground itself (a higher sheet of a third of its size on either side, and
// short), and where a ledge or, in flush and without ground, a strip between two breaks lies between them.
//
// The filter judges a point by its spacing and takes the steep end of a rounded rim for outliers or for
// pieces of their own: the last of what is seen of the rim is then missing, and a gap is measured too wide by
// up to the rim's radius. So a part is its sheet and what goes on
// from it towards the gap, whatever the filter said of it. From the part's last points with slope g per line
// a further point is taken where its advance across lies between 0.6 g and f g per line, with a tolerance of
// one spacing and 4.2 sigma sqrt(2): a rim that falls away falls steeper from line to line. f = 1.2 w /
// (sqrt(w + 1) - 1) is the steepest that a circle does after the w lines of which g is the mean. A steeper
// step, up to 1 mm, is taken where the next one falls as well: the face of a square cut (not of a sensor that smooths).
// Points that do not go on so are passed over, two at most (a spark). Where the contour flattens out instead, it has
// reached the ground, and the last steep step to it is taken back.
//
// A sensor that means m lines draws a step over m - 1 of them: where the contour goes on behind a part its last points,
// as many at most, are given back when their step is half of the steepest there, and the edge stands in the middle. Both
// steps down to the ground over like many lines, four at least, and more than the likeness of the noise tells (which sees no
// mean over more than seven), are so many lines.
//
// The lines of one sensor are evenly apart. Merged ones of two heads (double_head.h) are not, in one piece their order is
// that of x, and the heads see the faces of the gap: there the sheets are told by where the points lie (gap_heads.h), and a
// part is walked along what hangs on its sheet.
//
// Frame and unit: as the profile, mm. Noise model: sigma across, from the second differences of each part's
// surface.

#include <algorithm>
#include <vector>

#include "core/features/feature_points.h"

namespace seamwright {

// Points of one part, from the gap inwards.
struct GapPart {
    std::vector<double> x, z;
    double noise_mm = 0;
    double lost_share = 0;      // of its lines, without return or with a spark
    double smoothed_lines = 1;  // that the sensor means
    double drawn_lines = 0;     // between what was measured, of a grid; 0: its points were
    bool face = false;          // that of the gap may be seen: order and spacing along x tell nothing of it
    bool ramp = false;          // of them, drawn of the step behind the edge, follows the last point
    double unsure_lines =
        0;  // steep ones beside the last point, where nothing is known of how the sensor smooths
};

class GapSides {
  public:
    enum class Found { both, no_points, one_surface, unbroken, ambiguous };
    // Pieces shorter than `least` points are no surface; one longer than twice `panel_mm` is no ground. Left and right by x.
    // Allocates nothing after the first profile of a size.
    Found find(const Profile& profile, const FeatureWindow& window, int least, double panel_mm);

    const GapPart& left() const { return parts_[0]; }
    const GapPart& right() const { return parts_[1]; }
    double pitch_mm() const { return pitch_; }  // along x, from line to line
    const ProfileNoise& noise() const { return noise_; }

  private:
    struct Core {
        int first, last;  // of the raw points
    };
    struct Sheet {
        int first, last;              // of points_
        int count;                    // of what the filter took of them
        int piece_first, piece_last;  // up to where the filter joins it with others
    };
    // The line through the last points of a sheet: their mean, and slope.
    struct End {
        double x = 0, z = 0, slope = 0;
        int count = 0;
        double spread = 0;  // sum of (x - mean)^2, mm^2
        double at(double place) const { return z + slope * (place - x); }
        double variance_at(double place) const;  // in units of a point's
    };
    int missing(int i, int j) const;
    int lost(int a, int b) const;
    bool is_hole(int a, int b) const;
    bool interleaved() const;
    int chance_lines() const;
    double lost_share(const Core& before, const Core& after) const;
    End end_of(const Sheet& sheet, bool last, int most) const;
    bool in_line(const Sheet& a, const Sheet& b) const;
    bool goes_on(const Sheet& a, const Sheet& b) const;
    void divide();
    bool lower(const Sheet& b, const Sheet& a) const;
    Found two_cores(int least, double panel_mm, Core& before, Core& after);
    int break_between(const Core& before, const Core& after) const;
    bool rejected(int i) const { return !std::binary_search(raw_.begin(), raw_.end(), i); }  // by the filter
    bool astray(int i, double noise) const;  // rejected, and beside the line of what was not
    double noise_of(int first, int last) const;
    int walked(int from, int step, int stop, double noise, GapPart& part) const;
    int flat_end(int edge, int to_gap, int inmost) const;
    void take_drawn_steps(const Core& before, const Core& after, int& last, int& first);
    bool smooths() const;
    double drawn_lines() const { return noise_.drawn * noise_.measured_apart; }
    bool is_drawn() const { return noise_.drawn > 0.5; }

    FeaturePoints points_;
    std::vector<double> x_, z_;  // all that came back in the window
    std::vector<int> raw_;       // [points_] in x_, z_
    mutable std::vector<double> scratch_;
    mutable std::vector<int> trail_;
    std::vector<Sheet> sheets_;
    GapPart parts_[2];
    ProfileNoise noise_;
    double pitch_ = 0;
    bool interleaved_ = false;
    int chance_lines_ = 0, hole_lines_ = 0;     // without return: more than by chance; a hole of a piece
    int ground_first_ = -1, ground_last_ = -1;  // raw points of what is seen between the parts; -1: nothing
};

}  // namespace seamwright
