#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPoints.h>
#include <vtkPolyDataNormals.h>

#include <algorithm>
#include <string_view>

#include "widgets/scene/scene_managers.h"

namespace seamwright {

vtkSmartPointer<vtkPolyData> part_surface(const SceneMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points.size()));
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), mesh.points[i][0], mesh.points[i][1], mesh.points[i][2]);
    vtkNew<vtkCellArray> cells;
    for (const auto& triangle : mesh.triangles) {
        const vtkIdType corners[3] = {triangle[0], triangle[1], triangle[2]};
        cells->InsertNextCell(3, corners);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(data);
    normals->SetFeatureAngle(30);
    normals->ConsistencyOff();
    normals->SplittingOn();
    normals->Update();
    return normals->GetOutput();
}

Expected<SceneMesh> mesh_from_ply(const std::vector<std::byte>& ply) {
    SceneMesh mesh;
    if (ply.empty()) return mesh;
    const std::string_view head(reinterpret_cast<const char*>(ply.data()),
                                std::min<std::size_t>(ply.size(), 4));
    if (!head.starts_with("ply")) return input_error("is no PLY", "part mesh", "give a PLY file's bytes");
    vtkNew<vtkPLYReader> reader;
    int errors = 0;
    vtkNew<vtkCallbackCommand> watch;
    watch->SetClientData(&errors);
    watch->SetCallback([](vtkObject*, unsigned long, void* count, void*) { ++*static_cast<int*>(count); });
    reader->AddObserver(vtkCommand::ErrorEvent, watch);
    reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, watch);
    reader->ReadFromInputStringOn();
    reader->SetInputString(std::string(reinterpret_cast<const char*>(ply.data()), ply.size()));
    reader->Update();
    vtkPolyData* data = reader->GetOutput();
    if (errors > 0 || !data || data->GetNumberOfPolys() == 0)
        return input_error("holds no readable triangles", "part mesh", "import the part again");
    mesh.points.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        double p[3];
        data->GetPoint(static_cast<vtkIdType>(i), p);
        for (std::size_t k = 0; k < 3; ++k) mesh.points[i][k] = static_cast<float>(p[k]);
    }
    vtkCellArray* cells = data->GetPolys();
    cells->InitTraversal();
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    while (cells->GetNextCell(count, corners))
        for (vtkIdType k = 2; k < count; ++k)
            mesh.triangles.push_back({static_cast<int>(corners[0]), static_cast<int>(corners[k - 1]),
                                      static_cast<int>(corners[k])});
    return mesh;
}

}  // namespace seamwright
