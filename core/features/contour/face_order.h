#pragma once
// Faces in a profile that is in the order of x, as the merged profiles of two heads are: of points on a steep face that order
// is their noise's, up and down over the whole face. Here they are put in order along it.
//
// Within a third of the profile's pitch along x a face's points go up and down by one and a half of its spacings: that is no
// contour, which has one height there or climbs one way. All points of such places that overlap are sorted by z, the way round that leaves the shorter
// way from the points before and to those behind. Nothing is done to a profile whose x goes back and forth (its order is a
// sensor's) nor to one without such places.
//
// Unit mm. Faces nearer to each other than a third of a pitch are one.

#include <vector>

#include "core/features/contour/contour_pitch.h"

namespace seamwright {

// True where points changed their places.
bool order_faces(const ContourPitch& pitch, std::vector<double>& x, std::vector<double>& z);

}  // namespace seamwright
