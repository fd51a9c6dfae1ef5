#pragma once
// Where the contour ends or is broken, and how it moves there along the travel: the inside of check_alignment (not for others).

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/alignment/pass_registration.h"

namespace seamwright::alignment {

// Where the contour is broken: its last point before and its first behind, and which points of the profile these are.
struct Break {
    Eigen::Vector2d before, after;
    std::size_t index_before = 0, index = 0;
    bool clear = false;  // no steep flank, whose lines stand as far apart as a narrow one's
    bool sharp = false;  // its points stand close before and behind
    double grain_before_mm = 0, grain_after_mm = 0;  // from either to its next point
};
std::vector<Break> breaks_of(const Profile& p);

// Where the contour begins or ends: at the profile's own ends and on either side of a break.
struct ContourEnd {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    std::size_t index = 0;                            // of its point in the profile
    bool begins = false, clear = true, sharp = true;  // the latter two as of Break
    bool outermost = false;  // of the profile: the contour's end, or that of the field of view
    double grain_mm = 0;     // to its next point
};
std::vector<ContourEnd> ends_of(const Profile& p);

// Where in every profile that end of the contour stands, or that side of a break, on which the reference point lies (within 1.5
// mm): off its place by the registration, in the reference's frame; nothing where it is not seen. Empty: none is as near.
// An end is the last point of a contour, which steps by whole points where the edge moves by less: by up to `grain_mm`.
struct EndOffsets {
    std::vector<std::optional<Eigen::Vector2d>> off;
    double grain_mm = 0;
    bool broken = false;  // the contour has more ends than its two
};
EndOffsets end_offsets(const Reference& reference, std::span<const TravelProfile> pass,
                       const std::vector<std::size_t>& order, const Eigen::Vector2d& point);

// How the end moves on which the reference point lies (within 1.5 mm), by nothing but the last 10 mm of its own piece: along x
// by its last point (of a steep piece along that), across and in its turn by the piece's course. So a piece that is too straight
// to be registered is followed, and what lies beside it (ground that stands still) has no say. Nothing where the reference
// point lies on no end, the piece is too short, or the end may as well be that of the field of view: something is seen beyond it
// in some profile of the pass.
// The last point steps by whole points: by up to `grain_mm` along x, and by what that is along z on the course of the piece.
struct EndMotion {
    std::vector<TravelOffset> offsets;
    Eigen::Vector2d grain_mm = Eigen::Vector2d::Zero();
};
std::optional<EndMotion> follow_end(const Reference& reference, std::span<const TravelProfile> pass,
                                    const std::vector<std::size_t>& order, const Eigen::Vector2d& point);

// How much the two sides of a break in the contour (a gap, a sheet over another) part within the jitter, beyond their noise:
// the most over its breaks.
double parting_mm(const Reference& reference, std::span<const TravelProfile> pass,
                  const Eigen::Vector2d& point, double jitter_mm);

}  // namespace seamwright::alignment
