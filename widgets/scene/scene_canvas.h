#pragma once
// VTK's picture inside a QOpenGLWidget, camera and mouse.

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <QElapsedTimer>
#include <QOpenGLWidget>
#include <QTimer>
#include <functional>

#include "core/geometry/pose.h"
#include "widgets/scene/scene_view.h"

namespace seamwright {

// Whether an OpenGL 3.2 core context can be had here; asked once.
bool opengl_available();

class SceneCanvas : public QOpenGLWidget {
  public:
    explicit SceneCanvas(QWidget* parent);
    ~SceneCanvas() override;

    vtkRenderer& renderer() { return *renderer_; }
    void request_render();
    void show_view(SceneView::View view);
    Eigen::Vector3d project(const Eigen::Vector3d& point) const;  // x, y in this widget, depth 0..1 in front
    // Where the ray through a pixel meets the actor.
    std::optional<Eigen::Vector3d> pick(const QPointF& at, vtkActor& actor);
    std::function<void(const QPointF&)> on_click;
    std::function<void()> on_rendered;
    int rendered = 0;
    vtkActor* part = nullptr;  // what the views are fitted to, while it shows

  protected:
    void initializeGL() override;
    void resizeGL(int width, int height) override;
    void paintGL() override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

  private:
    void release();
    vtkNew<vtkGenericOpenGLRenderWindow> window_;
    vtkNew<vtkRenderer> renderer_;
    QTimer timer_;
    QElapsedTimer since_;
    QPointF press_, last_;
    bool ready_ = false, dragged_ = false;
};

}  // namespace seamwright
