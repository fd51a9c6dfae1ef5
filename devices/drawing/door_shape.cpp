#include "devices/drawing/door_shape.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomFill.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <cmath>
#include <vector>

#include "devices/drawing/step_text.h"
#include "devices/simulated/scene/door.h"

namespace seamwright::drawing {
namespace {

constexpr double kStationMm = 15;  // between the sections that the surfaces run through
constexpr double kSewMm = 0.01;

// What of door_rim_section() is one surface: first and last point; round ones are interpolated, others are ruled.
struct Strip {
    std::size_t first, last;
    bool round;
};
// In the order of the section in door.cpp.
constexpr std::array<Strip, 8> kStrips{{{0, 1, false},     // underside
                                        {1, 19, true},     // fold
                                        {19, 23, false},   // flange
                                        {23, 27, true},    // its broken end
                                        {27, 28, false},   // step
                                        {28, 33, false},   // land
                                        {33, 47, true},    // ramp
                                        {47, 49, true}}};  // margin

// Where one side of the door ends and the next begins.
std::vector<double> corners() {
    std::vector<double> arcs;
    const double length = door_edge_length_mm();
    constexpr int kLooks = 4000;
    std::string last = door_side_of(door_edge(0).point_mm);
    for (int i = 1; i <= kLooks; ++i) {
        const std::string side = door_side_of(door_edge(length * i / kLooks).point_mm);
        if (side != last) arcs.push_back(length * i / kLooks);
        last = side;
    }
    return arcs;
}

gp_Pnt section_point(const DoorEdge& edge, const DoorSectionPoint& c) {
    const Eigen::Vector3d p = edge.point_mm + edge.inboard * c.inboard_mm + edge.up * c.height_mm;
    return {p.x(), p.y(), p.z()};
}

// The stations of one side and what the interpolation between them needs: their arcs as parameters, and which way the
// contour goes on at both ends, so that sides meet tangentially.
struct Side {
    double from = 0, to = 0;
    std::vector<DoorEdge> stations;
    Handle(TColStd_HArray1OfReal) parameters;
};

Side side_between(double from, double to) {
    Side side{from, to, {}, {}};
    const int n = static_cast<int>((to - from) / kStationMm) + 1;
    side.parameters = new TColStd_HArray1OfReal(1, n + 1);
    for (int i = 0; i <= n; ++i) {
        side.stations.push_back(door_edge(from + (to - from) * i / n));
        side.parameters->SetValue(i + 1, (to - from) * i / n);
    }
    return side;
}

gp_Vec along(double arc_mm, const DoorSectionPoint& c) {
    constexpr double h = 0.5;
    return {section_point(door_edge(arc_mm - h), c), section_point(door_edge(arc_mm + h), c)};  // over 1 mm
}

Handle(Geom_BSplineCurve) curve_along(const Side& side, const DoorSectionPoint& c) {
    const Handle(TColgp_HArray1OfPnt) points =
        new TColgp_HArray1OfPnt(1, static_cast<int>(side.stations.size()));
    for (std::size_t i = 0; i < side.stations.size(); ++i)
        points->SetValue(static_cast<int>(i) + 1, section_point(side.stations[i], c));
    GeomAPI_Interpolate through(points, side.parameters, Standard_False, 1e-9);
    through.Load(along(side.from, c), along(side.to, c), Standard_False);
    through.Perform();
    return through.Curve();
}

// Skinned: the curves along the side have one set of knots, and across them their poles are interpolated.
Handle(Geom_BSplineSurface)
    strip_surface(const Side& side, const std::vector<DoorSectionPoint>& section, const Strip& strip) {
    if (!strip.round)
        return Handle(Geom_BSplineSurface)::DownCast(GeomFill::Surface(
            curve_along(side, section[strip.first]), curve_along(side, section[strip.last])));
    const int rows = static_cast<int>(strip.last - strip.first) + 1;
    std::vector<Handle(Geom_BSplineCurve)> curves;
    const Handle(TColStd_HArray1OfReal) across = new TColStd_HArray1OfReal(1, rows);
    double length = 0;
    for (std::size_t k = strip.first; k <= strip.last; ++k) {
        curves.push_back(curve_along(side, section[k]));
        if (k > strip.first)
            length += std::hypot(section[k].inboard_mm - section[k - 1].inboard_mm,
                                 section[k].height_mm - section[k - 1].height_mm);
        across->SetValue(static_cast<int>(k - strip.first) + 1, length);
    }
    const int poles = curves.front()->NbPoles();
    std::vector<Handle(Geom_BSplineCurve)> columns;
    for (int j = 1; j <= poles; ++j) {
        const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, rows);
        for (int k = 1; k <= rows; ++k) points->SetValue(k, curves[static_cast<std::size_t>(k) - 1]->Pole(j));
        GeomAPI_Interpolate through(points, across, Standard_False, 1e-9);
        through.Perform();
        columns.push_back(through.Curve());
    }
    const Handle(Geom_BSplineCurve)& first = curves.front(), &last = columns.front();
    TColgp_Array2OfPnt net(1, poles, 1, last->NbPoles());
    for (int j = 1; j <= poles; ++j)
        for (int k = 1; k <= last->NbPoles(); ++k)
            net.SetValue(j, k, columns[static_cast<std::size_t>(j) - 1]->Pole(k));
    return new Geom_BSplineSurface(net, first->Knots(), last->Knots(), first->Multiplicities(),
                                   last->Multiplicities(), first->Degree(), last->Degree());
}

TopoDS_Shape door_shape() {
    BRepBuilderAPI_Sewing sewing(kSewMm);
    const std::vector<DoorSectionPoint> section = door_rim_section();
    const std::vector<double> arcs = corners();
    for (std::size_t side = 0; side < arcs.size(); ++side) {
        const double from = arcs[side];
        const double to = side + 1 < arcs.size() ? arcs[side + 1] : arcs[0] + door_edge_length_mm();
        const Side stretch = side_between(from, to);
        for (const Strip& strip : kStrips)
            sewing.Add(BRepBuilderAPI_MakeFace(strip_surface(stretch, section, strip), 1e-6).Face());
    }
    sewing.Perform();
    return sewing.SewedShape();
}

}  // namespace

Expected<std::string> door_text() {
    return step_text([] { return door_shape(); });
}

}  // namespace seamwright::drawing
