#pragma once
// The only code that touches VTK's actors: one manager a layer, values in, one or two actors out.

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <QColor>
#include <QPalette>
#include <optional>
#include <vector>

#include "widgets/scene/scene_view.h"

namespace seamwright {

// Lines and triangles with a colour each, in one mesh for one actor.
class ScenePainter {
  public:
    ScenePainter();
    void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const QColor& colour);
    void triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                  const QColor& colour);
    // A shaft with a four-sided head, `thickness` across the shaft.
    void arrow(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double thickness,
               const QColor& colour);
    // Open at both ends, as wide as the two radii.
    void tube(const Eigen::Vector3d& a, double a_radius, const Eigen::Vector3d& b, double b_radius,
              const QColor& colour);
    void axes(const Pose& pose, double length, double thickness, int alpha = 255);
    void ball(const Eigen::Vector3d& centre, double radius, const QColor& colour);
    void box(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high, const QColor& colour);
    vtkSmartPointer<vtkPolyData> take();

  private:
    vtkIdType point(const Eigen::Vector3d& p);
    void colour(std::vector<unsigned char>& colours, const QColor& colour);
    vtkSmartPointer<vtkPolyData> data_;
    std::vector<unsigned char> line_colours_, face_colours_;
};

class LayerManager {
  public:
    LayerManager(vtkRenderer& renderer, bool lit, double line_width);
    void set(const vtkSmartPointer<vtkPolyData>& data);
    void set_shown(bool shown);
    bool shown() const { return shown_; }
    vtkActor& actor() { return *actor_; }

  private:
    vtkSmartPointer<vtkActor> actor_;
    bool shown_ = true;
};

// What a layer looks like.
vtkSmartPointer<vtkPolyData> draw_spots(const std::vector<SceneSpot>& spots, const std::string& selected,
                                        const QPalette& palette);
vtkSmartPointer<vtkPolyData> draw_sensors(const std::vector<SceneSpot>& spots, const std::string& selected,
                                          const QPalette& palette);
vtkSmartPointer<vtkPolyData> draw_regions(const std::vector<SceneRegion>& regions,
                                          const std::vector<SceneSpot>& spots, const std::string& selected,
                                          const QPalette& palette);
vtkSmartPointer<vtkPolyData> draw_corrections(const std::vector<SceneSpot>& spots, double scale,
                                              const QPalette& palette);
// Where the corrected points are drawn: as far from the taught ones as `scale` times the truth, where both are as many.
std::vector<Eigen::Vector3d> drawn_path(const ScenePath& path, double scale);
// The point that moves most; nullopt: before and after are not as many.
struct WorstPathPoint {
    std::size_t point = 0;
    double shift_mm = 0, sigma_mm = 0;
};
std::optional<WorstPathPoint> worst_of(const ScenePath& path);
vtkSmartPointer<vtkPolyData> draw_path(const ScenePath& path, double scale, const QPalette& palette);
// Edges of the drawing, those that are chosen and the one under the pointer apart; ghosts of proposed spots with the
// direction their sensor looks from.
vtkSmartPointer<vtkPolyData> draw_edges(const std::vector<SceneEdge>& edges,
                                        const std::vector<std::string>& chosen, const std::string& lit,
                                        const std::vector<SceneSpot>& proposed, const QPalette& palette);
vtkSmartPointer<vtkPolyData> draw_robot(const std::optional<SceneRobot>& robot,
                                        const std::optional<SceneRobot>& next, const QPalette& palette);
// Where a region's weak direction arrow stands: centroid of its spots' references, and half the arrow's
// length.
struct WeakArrow {
    Eigen::Vector3d centre, tip;
};
std::optional<WeakArrow> weak_arrow(const SceneRegion& region, const std::vector<SceneSpot>& spots);

// Lit mesh with smooth normals across edges below 30 degrees.
vtkSmartPointer<vtkPolyData> part_surface(const SceneMesh& mesh);
Expected<SceneMesh> mesh_from_ply(const std::vector<std::byte>& ply);

}  // namespace seamwright
