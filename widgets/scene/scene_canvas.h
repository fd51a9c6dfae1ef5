#pragma once
// VTK's picture inside a plain widget, camera and mouse.
//
// VTK renders into a buffer of a context of its own, and only after request_render(); the widget shows the
// picture that was read back. A QOpenGLWidget would make Qt compose the whole window through OpenGL at every
// repaint of any widget in it, sixty times a second for the live profile: on a machine without a graphics
// card that is more than a core.

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <QElapsedTimer>
#include <QImage>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QPolygonF>
#include <QTimer>
#include <QWidget>
#include <functional>

#include "core/geometry/pose.h"
#include "widgets/scene/scene_view.h"

namespace seamwright {

// Whether an OpenGL 3.2 core context can be had here; asked once.
bool opengl_available();

class SceneCanvas : public QWidget {
  public:
    explicit SceneCanvas(QWidget* parent);
    ~SceneCanvas() override;

    vtkRenderer& renderer() { return *renderer_; }
    void request_render();    // within a sixtieth of a second, as soon as the widget is seen
    const QImage& picture();  // of the scene as it is; null when the driver refuses
    void show_view(SceneView::View view);
    void fit(vtkActor& actor);                                    // from the present direction
    Eigen::Vector3d project(const Eigen::Vector3d& point) const;  // x, y in this widget, depth 0..1 in front
    // Where the ray through a pixel meets the actor.
    std::optional<Eigen::Vector3d> pick(const QPointF& at, vtkActor& actor);
    std::function<void(const QPointF&)> on_click;
    std::function<void(const QPointF&)> on_hover;  // no button pressed
    // Left button pressed: true takes hold of what is there, and until it is released on_drag() has the pointer
    // instead of the camera.
    std::function<bool(const QPointF&)> on_grab;
    std::function<void(const QPointF&)> on_drag;
    // A line drawn around something: with the right button, or with the left one while `lasso` is set.
    std::function<void(const QPolygonF&)> on_encircled;
    bool lasso = false;
    std::function<void(QPainter&)> on_paint;  // over the picture
    int rendered = 0;
    vtkActor* part = nullptr;  // what the views are fitted to, while it shows

  protected:
    void showEvent(QShowEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

  private:
    bool make_current();
    void render();
    QOpenGLContext context_;
    QOffscreenSurface surface_;
    QImage picture_;
    vtkNew<vtkGenericOpenGLRenderWindow> window_;
    vtkNew<vtkRenderer> renderer_;
    QTimer timer_;
    QElapsedTimer since_;
    QPointF press_, last_;
    QPolygonF drawn_;  // the line so far; empty: none is drawn
    bool ready_ = false, stale_ = true, dragged_ = false, held_ = false;
};

}  // namespace seamwright
