#include "devices/simulated/scene/surfaces_object.h"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkTriangleFilter.h>

namespace seamwright {
namespace {

// Counts the reader's errors; with an observer VTK prints none.
struct Watch {
    vtkNew<vtkCallbackCommand> command;
    int errors = 0;
    Watch() {
        command->SetClientData(this);
        command->SetCallback(
            [](vtkObject*, unsigned long, void* self, void*) { ++static_cast<Watch*>(self)->errors; });
    }
    void on(vtkObject* object) {
        object->AddObserver(vtkCommand::ErrorEvent, command);
        object->AddObserver(vtkCommand::WarningEvent, command);
    }
};

bool take_triangles(vtkPolyData* surface, TriangleMesh& mesh) {
    Watch watch;
    vtkNew<vtkTriangleFilter> triangles;
    watch.on(triangles);
    watch.on(triangles->GetExecutive());
    triangles->SetInputData(surface);
    triangles->PassLinesOff();
    triangles->PassVertsOff();
    triangles->Update();
    const vtkPolyData* none = nullptr;
    vtkPolyData* data = triangles->GetOutput();
    if (watch.errors > 0 || data == none || data->GetNumberOfPolys() == 0) return false;
    mesh.vertices.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        data->GetPoint(static_cast<vtkIdType>(i), mesh.vertices[i].data());
    vtkNew<vtkIdList> cell;
    auto* polygons = data->GetPolys();
    for (polygons->InitTraversal(); polygons->GetNextCell(cell);) {
        if (cell->GetNumberOfIds() != 3) continue;
        Eigen::Vector3i t;
        for (int k = 0; k < 3; ++k) t[k] = static_cast<int>(cell->GetId(k));
        mesh.triangles.push_back(t);
    }
    return true;
}

}  // namespace

bool seamwright_read_stl(const std::string& path, TriangleMesh& mesh) {
    Watch watch;
    vtkNew<vtkSTLReader> reader;
    watch.on(reader);
    watch.on(reader->GetExecutive());
    reader->SetFileName(path.c_str());
    reader->Update();
    return watch.errors == 0 && take_triangles(reader->GetOutput(), mesh);
}

bool seamwright_triangulate(const PolygonSurface& surface, TriangleMesh& mesh) {
    vtkNew<vtkPolyData> data;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Eigen::Vector3d& p : surface.points) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> polygons;
    for (const auto& face : surface.faces) {
        polygons->InsertNextCell(static_cast<int>(face.size()));
        for (const std::int32_t corner : face) polygons->InsertCellPoint(corner);
    }
    data->SetPoints(points);
    data->SetPolys(polygons);
    return take_triangles(data, mesh);
}

}  // namespace seamwright
