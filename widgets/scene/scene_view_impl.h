#pragma once
// What a SceneView holds. Private to scene_view.cpp and scene_labels.cpp.

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <QPainter>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "widgets/aside.h"
#include "widgets/scene/scene_canvas.h"
#include "widgets/scene/scene_managers.h"
#include "widgets/scene/scene_view.h"

class QAction;
class QLabel;

namespace seamwright {

// Words over the picture in the window's own font.
struct SceneLabels {
    struct Label {
        QPointF at;
        QString text;
        QColor colour;
        bool strong;
    };
    std::vector<Label> labels;
    QString foot;

    void paint(QPainter& painter, const QWidget& owner) const;
};

struct SceneView::Impl {
    SceneView& view;
    SceneCanvas* canvas = nullptr;
    QWidget* toolbar = nullptr;
    QLabel* sentence = nullptr;
    std::map<Layer, std::unique_ptr<LayerManager>> layers;
    std::map<Layer, QAction*> actions;
    std::map<Layer, bool> shown;
    SceneMesh mesh;
    vtkSmartPointer<vtkPolyData> surface = part_surface({});  // of the mesh
    std::vector<SceneSpot> spots;
    std::vector<SceneRegion> regions;
    ScenePath path;
    std::vector<SceneEdge> edges;
    std::vector<std::string> chosen_edges;
    std::string lit_edge;
    std::vector<SceneSpot> proposed;
    std::string held;  // of them
    std::vector<Eigen::Vector3d> picks;
    std::optional<SceneRobot> robot, next_robot;
    Pose part_shift = Pose::Identity();
    std::string spot, region;
    double scale = 20;
    bool part_to_fit = true, spots_to_fit = true;  // when they come
    bool part_is_read = false;                     // beside the window, at the moment
    Aside reading;                                 // last: its end waits

    explicit Impl(SceneView& owner) : view(owner) {}
    LayerManager* manager(Layer layer) {
        const auto found = layers.find(layer);
        return found == layers.end() ? nullptr : found->second.get();
    }
    void make_layers();
    void connect_canvas();
    void restyle();
    void redraw(Layer layer);
    void redraw_all();
    void take_part(SceneMesh part, const vtkSmartPointer<vtkPolyData>& drawn);
    void fit_once();
    SceneLabels words() const;
    void paint_words(QPainter& painter) const { words().paint(painter, *canvas); }
    const SceneEdge* edge_at(const QPointF& at) const;
    const SceneSpot* spot_at(const std::vector<SceneSpot>& among, const QPointF& at) const;
    void changed() {
        if (canvas) canvas->request_render();
    }
};

// The nearest on the screen.

}  // namespace seamwright
