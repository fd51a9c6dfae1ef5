#pragma once
// Double heads: two sensors look at one place from two sides, because each sees an edge that hides from the
// other, and their stripes overlap. Their profiles become one profile in one frame.
//
// Frames. Each head stands at sensor_from_head in the frame of the merged profile, "sensor", which lies in
// both laser planes: y of every point there is 0 up to plane_limit_mm and is dropped (a height errs by y
// times the tangent of the contour's slope along the travel). With the first head's own frame as the common
// one, its pose is the identity.
//
// Overlap. The common x axis is divided into cells as wide as the coarser head's pitch. Where both heads see
// the same surface in a cell (nearer than kSameSurfaceMm), the cell becomes one point: the mean of all its
// points weighted with 1 / sigma^2, a point on the surface itself wherever that is straight within a pitch.
// Every measured point enters exactly one point of the merged profile, so that no place counts twice in what
// is fitted to it and neighbours stay independent. Where only one head sees, its points stay as they are.
// Cells do not know an order of the heads: exchanging them gives the same bits.
//
// Segments of the two heads that share at least three cells are one segment afterwards: what one head has in
// two pieces, because something hid the middle, is whole when the other saw it. Segments are numbered by
// their least x and lie one after the other, each in order of x. Points without return and outliers are left
// out, but for what says where the field ends: beyond its first and its last point the profile has as many lines without
// return as the head that saw the point has beyond it (of both the fewer), and one more. A head whose profile does
// not list its lines (lists_every_line(), no_return.h; 64 lines are enough where both heads' lie evenly) adds none. Where the
// field of one head ends amid what the other sees is not told.
//
// Steps. At the step of a lap the heads see the end of one sheet and the beginning of the other at different
// places; in between they show two surfaces that may be nearer than kSameSurfaceMm. Where cells are more than six sigma apart,
// one head goes on with the surface on the left and the other with that on the right, the contour is divided, each head's
// where this head has the step, and the cells are not merged nor compared.
//
// Noise model: independent points, sigma_mm of a head's points in every direction; sigma of a merged point is
// (sum 1 / sigma^2)^(-1/2). Disagreement: in each shared cell the distance of the second head's mean from the
// first's across the contour, d = n . (mean_2 - mean_1), n from the merged points around it, variance
// sigma_1^2 / n_1 + sigma_2^2 / n_2. offset_mm is their weighted mean with its standard deviation: what the
// calibrated relation is off by, here; disagreement_mm their root mean square, noise and all, which is
// limited.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"
#include "core/profile/profile.h"
#include "core/text.h"

namespace seamwright {

inline constexpr double kSameSurfaceMm = 1.0;

struct Head {
    Pose sensor_from_head = Pose::Identity();
    double sigma_mm = 0.03;  // of a point's coordinate
};

struct DoubleHeadOptions {
    double disagreement_limit_mm = 0.15;  // below kSameSurfaceMm
    double plane_limit_mm = 0.5;          // of |y| in the common frame
    double minimum_overlap_mm = 2;        // less proves nothing about the relation
};

enum class DoubleHeadStatus {
    ok,
    no_points,     // a head saw nothing usable
    not_coplanar,  // a point stands off the common laser plane by more than plane_limit_mm
    no_overlap,    // the stripes share less than minimum_overlap_mm
    disagree       // beyond disagreement_limit_mm, or different surfaces in more cells than equal ones
};
std::string_view to_string(DoubleHeadStatus status);

struct DoubleHeadProfile {
    DoubleHeadStatus status = DoubleHeadStatus::no_points;
    Profile profile;               // filtered; what was merged when the status is ok or disagree, else empty
    std::vector<double> sigma_mm;  // of each point; NaN of a line without return
    double overlap_mm = 0;
    int shared_cells = 0;
    double disagreement_mm = 0;
    double offset_mm = 0;  // second minus first, positive towards +z; changes its sign with their order
    double offset_sigma_mm = 0;
    Text message;  // empty when ok
};

// `first`, `second`: filtered profiles in their heads' frames. Refuses (Error) profiles that are not
// filtered, a pose that is none, sigma or limits that are not positive.
Expected<DoubleHeadProfile> merge_heads(const Profile& first, const Head& first_head, const Profile& second,
                                        const Head& second_head, const DoubleHeadOptions& options = {});

}  // namespace seamwright
