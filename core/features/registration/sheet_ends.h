#pragma once
// Where a sheet ends in a profile: at a step whose wall no sensor sees, at a gap. What such ends tell of a contour's place
// is all that there is where two flats leave it open (a lap, a butt joint).

#include <vector>

namespace seamwright {

// The outline at a jump: the place along x between its two points where the nearer surface ends before the other. Which one
// is nearer is seen where one of them bends away towards the other, as a hem does towards the sheet it hides: its outline is
// known to the two points, whatever the tilt and whichever way z grows. `unknown` where neither does, or both do (a wall
// between two bends).
struct SheetOutline {
    enum class Nearer { unknown, upper, lower };
    struct Side {
        double z = 0;     // of its last point
        double drop = 0;  // of that one below the one before it
    };
    Nearer nearer = Nearer::unknown;
    double x = 0;
    double pitch = 0, open = 0;  // along x: of the points; how far the two are apart
    double upwards = 0;          // +1 where the upper surface lies towards larger x, -1
    Side upper, lower;
};

// The end of the upper surface at a jump (a step whose wall the sensor does not see): the last point plus half of the way
// to where the lower one begins (a pitch, or more where a point is missing or stood in the step), known to a pitch (variance
// pitch^2 / 12). Seen from where z is larger, the upper end is seen whatever the tilt; the lower one may lie in its shadow.
struct JumpEnd {
    double x, z;
    double tx, tz;              // unit, along the upper surface, outwards
    double pitch;               // along the surface
    double height;              // of the jump
    double open;                // along the surface: how far the upper end and the lower beginning are apart
    bool is_edge = true;        // a sharp end; false where the surface bends out of sight
    bool of_gap = false;        // the rim of a gap, `height` its width
    SheetOutline outline = {};  // of no gap
    bool tells() const { return is_edge || outline.nearer != SheetOutline::Nearer::unknown; }
};
// The jump between neighbours `lower` and `upper` (indices, side by side); the surface's direction comes from
// the points behind the upper one within the range [first, last], of noise sigma_mm: eight, or as many as it takes that
// noise does not turn it. Apart along it the two are by most_open pitches at most (ContourPitch::most_open()).
JumpEnd jump_end(const std::vector<double>& x, const std::vector<double>& z, int lower, int upper, int first,
                 int last, double sigma_mm, double most_open);

// At the jump between neighbours `at` and `at` + 1.
SheetOutline outline_at(const std::vector<double>& x, const std::vector<double>& z, int at, int first,
                        int last, double sigma_mm);

// The two rims of a gap between neighbours `before` and `before` + 1, where their surfaces are about level; a rim that
// bends out of sight is none. False where it is no such gap.
bool gap_ends(const std::vector<double>& x, const std::vector<double>& z, int before, int first, int last,
              double sigma_mm, double most_open, std::vector<JumpEnd>& ends);

}  // namespace seamwright
