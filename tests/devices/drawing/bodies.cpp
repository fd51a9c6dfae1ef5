#include "tests/devices/drawing/bodies.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

#include "devices/drawing/step_text.h"
#include "devices/exchange/files.h"

namespace seamwright {

namespace {

// Of the unit in a millimetre.
double per_mm(const std::string& unit) {
    return unit == "M" ? 0.001 : unit == "INCH" ? 1 / 25.4 : 1;
}

}  // namespace

std::string box_step(double x_mm, double y_mm, double z_mm, double round_mm, const char* unit) {
    return *drawing::step_text(
        [&]() -> TopoDS_Shape {
            const TopoDS_Shape box =
                BRepPrimAPI_MakeBox(per_mm(unit) * x_mm, per_mm(unit) * y_mm, per_mm(unit) * z_mm).Shape();
            if (!(round_mm > 0)) return box;
            BRepFilletAPI_MakeFillet round(box);
            for (TopExp_Explorer e(box, TopAbs_EDGE); e.More(); e.Next())
                round.Add(per_mm(unit) * round_mm, TopoDS::Edge(e.Current()));
            return round.Shape();
        },
        unit);
}

std::string cylinder_step(double radius_mm, double height_mm, const char* unit) {
    return *drawing::step_text(
        [&]() -> TopoDS_Shape {
            return BRepPrimAPI_MakeCylinder(per_mm(unit) * radius_mm, per_mm(unit) * height_mm).Shape();
        },
        unit);
}

std::string plate_step(int rows, int columns) {
    return *drawing::step_text([&]() -> TopoDS_Shape {
        BRepBuilderAPI_MakeFace face(gp_Pln(), 0, 10.0 * columns, 0, 10.0 * rows);
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c) {
                const gp_Circ circle(gp_Ax2(gp_Pnt(10.0 * c + 5, 10.0 * r + 5, 0), -gp::DZ()), 3);
                face.Add(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire());
            }
        return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, 5)).Shape();
    });
}

std::string box_iges(double x_mm, double y_mm, double z_mm, const char* unit) {
    const drawing::Quiet quiet;
    IGESControl_Controller::Init();
    const drawing::TemporaryFile file;
    IGESControl_Writer writer(unit, 1);
    writer.AddShape(BRepPrimAPI_MakeBox(x_mm, y_mm, z_mm).Shape());
    writer.ComputeModel();
    writer.Write(file.path().c_str());
    return *read_text_file(file.path());
}

}  // namespace seamwright
