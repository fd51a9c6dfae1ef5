#pragma once
// Pieces of the door's rim swept along a straight line or a circle: contours whose true shape is known, to
// tell what a method makes of a straight or a curved contour apart from the door's own shape.

#include <limits>
#include <span>

#include "core/geometry/pose.h"
#include "devices/simulated/scene/mesh.h"

namespace seamwright {

// One piece, lying in front of a sensor as the door lies in front of that of a DoorSpot (door.h): X inboard,
// Y along the contour, the flange's top at z = 0 and the outermost line at x = -15.
struct RimPiece {
    Pose part_from_sensor = Pose::Identity();
    // Of the outermost line, in the sensor's XY plane: positive with the centre inboard (+X), negative with
    // the centre outboard, infinite for a straight line. |radius| above 120 mm: the rim is 60 mm wide.
    double radius_mm = std::numeric_limits<double>::infinity();
    double half_length_mm = 60;  // to both sides of the sensor's plane
};

// All pieces in the part's frame. Along the contour the facets stay within `facet_mm` of the circle.
TriangleMesh swept_rim_mesh(std::span<const RimPiece> pieces, double facet_mm = 5e-4);

}  // namespace seamwright
