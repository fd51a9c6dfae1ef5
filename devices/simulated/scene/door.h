#pragma once
// A car door seen from its inner side, made by formula: the part of the simulated cell.
//
// Work object frame: X along the door (0 = hinge side, 1000 = latch side), Y up (0 .. 750), Z out of the
// inner side towards the sensor. The outline is a rounded, sheared quadrilateral whose radius goes from about
// 130 mm in the corners to nearly straight in the middle of the sides. Across the edge, at the distance t
// inboard of the outermost line:
//     t = 0 .. 2.3     the outer skin's fold, radius 1.15 mm
//     t = 1.15 .. 9    hem flange, 1.5 mm above the inner face of the outer skin
//     t = 9            the flange ends: a step of 0.8 mm down to the inner sheet
//     t = 9 .. 27      sealing land (the bead runs at t = 10.5)
//     t = 27 .. 45     ramp of 14 mm to the inner panel, with embossed beads, a recess, a body line and round
//     holes
// Facets stay within 0.005 mm of the formula across the fold and along the edge.

#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "devices/simulated/scene/mesh.h"

namespace seamwright {

TriangleMesh door_mesh();

// The cross-section above as a polygon, from below the fold to the inner panel; height over the inner face of
// the outer skin.
struct DoorSectionPoint {
    double inboard_mm = 0, height_mm = 0;
};
std::vector<DoorSectionPoint> door_rim_section();
inline constexpr double kDoorFlangeTop_mm = 1.5;

// A point of the outermost edge line and the directions there; all in the work object, unit length.
struct DoorEdge {
    Eigen::Vector3d point_mm;  // on the inner face of the outer skin
    Eigen::Vector3d along, inboard, up;
};
double door_edge_length_mm();
DoorEdge door_edge(double arc_mm);  // from the middle of the latch side, anticlockwise; any number, periodic

// A suggested measuring spot: the sensor's origin 15 mm inboard of the edge at the height of the hem flange,
// X inboard, Y along the edge, Z away from the sheet. Contour in the sensor frame: the edge at x = -15, the
// flange at z = 0 up to its end at x = -6, the sealing land at z = -0.8 up to x = 12, then the ramp.
struct DoorSpot {
    std::string id;  // "T1" .. "T3" top, "L" latch side, "B" bottom, "H" hinge side
    Pose workobject_from_sensor = Pose::Identity();
    double entry_mm = 20, exit_mm = 20;  // of the pass, along the sensor's Y
    Eigen::Vector3d edge_mm =
        Eigen::Vector3d::Zero();  // top of the flange at the outermost line, sensor frame
};
std::vector<DoorSpot> default_door_spots();

// Four regions, one a side: the three spots of the side and the nearest spot of each neighbouring side. The
// neighbours' edges run across, so every region observes all six degrees of freedom; the three alone would
// leave the translation along the edge and the rotation about it open. "latch" and "hinge" take one more:
// without it 3 sigma reaches 0.29 mm, and a part whose profiles come out noisier is refused at 0.3.
struct DoorRegion {
    std::string id;  // "top", "latch", "bottom", "hinge"
    std::vector<std::string> spot_ids;
};
std::vector<DoorRegion> default_door_regions();

// Four spots a side instead of three, in pairs near the side's ends, where a region's bead is known worst,
// and every region with the nearer pair of each neighbouring side: for a bead within a tenth. What limits it
// is the robot's arrivals (0.034 mm at the sensor with the cell's defaults), which only more spots average
// out; the bead of a rigid door then has 3 sigma of 0.074 mm, where the few have 0.09 (a spot's coordinate
// with 0.043 mm). Nearer the corners a contour of less than 300 mm radius would bring the trigger's jitter
// in.
std::vector<DoorSpot> dense_door_spots();
std::vector<DoorRegion> dense_door_regions();

// The sealing bead: a closed polyline on the sealing land, `step_mm` apart, first point not repeated. The
// stretch of a region's own side is where arc positions of its three spots lie; side_of() names it.
std::vector<Eigen::Vector3d> door_bead_path(double step_mm = 10);
std::string door_side_of(const Eigen::Vector3d& point_mm);  // nearest region's id

// Elastic deviation of a real part, added to its points along Z: 0 at the hinge side,
//     dz = bend (x/L)^2 + twist (x/L) (2 y/H - 1),   L = 1000 mm, H = 750 mm (or the box of another mesh).
struct PartBend {
    double bend_mm = 0, twist_mm = 0;
};
double bend_at(const PartBend& bend, const Eigen::AlignedBox3d& box, const Eigen::Vector3d& point_mm);

// Calibration targets, each in its own frame.
TriangleMesh sphere_mesh(double radius_mm);                  // about the origin, facets within 0.002 mm
TriangleMesh plate_mesh(double width_mm, double height_mm);  // z = 0, centred
// A triangular prism lying on z = 0 along Y: base 60 mm, height 30 mm, length 200 mm, on a plate 200 x 200
// mm.
TriangleMesh triangle_body_mesh();

}  // namespace seamwright
