#pragma once
// The steps of filter_profile behind the cheapest sequence, in their order (not for others).

#include <cstdlib>

#include "core/profile/contour_sequence.h"

namespace seamwright::contour {

inline constexpr int kWarmUp = 10;  // points after which the tracker has forgotten where it began

inline int line_difference(const Workspace& w, int a, int b) {
    return std::abs(w.candidates[std::size_t(b)].line - w.candidates[std::size_t(a)].line);
}

// Rows of points that the cheapest sequence leaves out. There an edge is as dear as it must be for a burst, which would
// come and go with one each, so that a groove or a ridge of a few points, which has three, is cheaper as a row of
// outliers. More than `lookahead` of them are no burst any more: there an edge costs kRowShare of it, and what follows
// itself for min_points points is taken into the path.
void take_in_rows(Workspace& w, const Model& m, int lookahead, int min_points);

// The same tracker along the path from its other end, where anything is to be decided: beside points that are
// not calm, and kWarmUp points before those to learn the contour.
void run_backward(Workspace& w, const Model& m);

// Decides every point again, seen from both sides, and sets w.piece (number of smooth pieces returned).
int verify(Workspace& w, const Model& m);

// Points that passed only because the predictions were vague (short memory on coarse or steep contours):
// compared with the parabola through their neighbours on both sides, where that fits the neighbours
// themselves.
void settle_doubtful(Workspace& w, const Model& m);

// Joins pieces to segments, drops the short ones, numbers the rest.
void number_segments(Workspace& w, const Model& m, int pieces, int min_points, Profile& profile);

}  // namespace seamwright::contour
