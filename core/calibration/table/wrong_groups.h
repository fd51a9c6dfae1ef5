#pragma once
// Positions of one x or one z that are wrong together: a stage that was set wrongly once. A map that bends follows them, so
// they lie on it like sound ones. Private to core/calibration/table.
//
// Asked of what most sensors are, a camera with a lens before a plane: (u, v) = D(H(x, z)), D the lens by k1 and k2 about a
// centre (then by k3, p1, p2 too), with the group's shift as two unknowns more. A group is wrong where its shift takes eight
// ninths of the squares away, more than chance does, and leaves no more than the pairs' own noise and no second group that a
// shift would mend. Sensors of another kind leave more, and are not asked.

#include <optional>

#include "core/calibration/table/smooth_map.h"

namespace seamwright::lookup_table {

struct WrongGroup {
    bool of_x = true;          // equal x, else equal z
    double at_mm = 0;          // that x or z
    Eigen::Vector2d shift_mm;  // by which they are off
};

// Samples that stand in rows of one x, or one z, three and more in each of four and more; in the order of it.
StageRows stage_rows(const Samples& samples);

// What a stage errs by at each x and at each z, for all samples there alike (mm, as wide as a sigma that is known has to be):
// the residuals' products with the rows, and their squares, are the noise's share and that of the rows of x and of z. Zero
// where chance gives as much, or for a sensor of another kind. `noise_px` as of wrong_group().
std::array<double, 2> row_sigmas_mm(const Samples& samples, int width, int height, double noise_px);

// The worst one. `noise_px`: sigma of a coordinate of a pixel by the map that bends.
std::optional<WrongGroup> wrong_group(const Samples& samples, int width, int height, double noise_px);

}  // namespace seamwright::lookup_table
