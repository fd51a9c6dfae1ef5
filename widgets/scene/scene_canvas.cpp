#include "widgets/scene/scene_canvas.h"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCamera.h>
#include <vtkCellPicker.h>
#include <vtkMatrix4x4.h>
#include <vtkOpenGLState.h>

#include <QMouseEvent>
#include <QOpenGLFramebufferObject>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "widgets/style.h"

namespace seamwright {

namespace {

QSurfaceFormat scene_format() {
    QSurfaceFormat format;
    format.setRenderableType(QSurfaceFormat::OpenGL);
    format.setVersion(3, 2);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setAlphaBufferSize(0);
    format.setSamples(0);
    return format;
}

}  // namespace

bool opengl_available() {
    static const bool available = [] {
        QOpenGLContext context;
        context.setFormat(scene_format());
        if (!context.create()) return false;
        QOffscreenSurface surface;
        surface.setFormat(context.format());
        surface.create();
        if (!surface.isValid() || !context.makeCurrent(&surface)) return false;
        const auto version = context.format().version();
        context.doneCurrent();
        return version >= std::pair<int, int>(3, 2);
    }();
    return available;
}

SceneCanvas::SceneCanvas(QWidget* parent) : QWidget(parent) {
    setAttribute(Qt::WA_OpaquePaintEvent);
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    surface_.setFormat(scene_format());
    surface_.create();
    window_->SetOwnContext(0);
    window_->SetFrameBlitModeToNoBlit();
    window_->SetMultiSamples(0);
    window_->AddRenderer(renderer_);
    timer_.setSingleShot(true);
    connect(&timer_, &QTimer::timeout, this, [this] { update(); });
    since_.start();
}

// VTK's buffers go while the context that made them lives.
SceneCanvas::~SceneCanvas() {
    if (!ready_ || !context_.makeCurrent(&surface_)) return;
    window_->Finalize();
    context_.doneCurrent();
}

void SceneCanvas::request_render() {
    stale_ = true;
    if (!timer_.isActive()) timer_.start(std::max(0, 16 - static_cast<int>(since_.elapsed())));
}

bool SceneCanvas::make_current() {
    if (!context_.isValid()) {
        context_.setFormat(scene_format());
        if (!context_.create()) return false;
    }
    if (!context_.makeCurrent(&surface_)) return false;
    if (!ready_) {
        window_->SetMapped(true);
        window_->SetIsDirect(true);
        window_->SetReadyForRendering(true);
        window_->InitializeFromCurrentContext();
        ready_ = true;
    }
    return true;
}

void SceneCanvas::render() {
    const QSize size = (QSizeF(this->size()) * devicePixelRatioF()).toSize();
    if (size.isEmpty() || !make_current()) return;
    window_->SetSize(size.width(), size.height());
    window_->GetState()->Reset();
    window_->GetState()->Push();
    window_->GetState()->vtkglDepthFunc(0x0203);  // GL_LEQUAL
    window_->SetIsCurrent(true);
    renderer_->ResetCameraClippingRange();
    window_->Render();
    window_->GetState()->Pop();
    {
        QOpenGLFramebufferObject copy(size);
        copy.bind();
        window_->BlitDisplayFramebuffer();
        copy.bind();  // VTK has bound another one for reading
        picture_ = copy.toImage();
        // Alpha is 0 where no surface lies; the ground's colour is there all the same.
        picture_.reinterpretAsFormat(QImage::Format_RGB32);
    }
    context_.doneCurrent();
    picture_.setDevicePixelRatio(devicePixelRatioF());
    stale_ = false;
    since_.restart();
    ++rendered;
}

const QImage& SceneCanvas::picture() {
    if (stale_) render();
    return picture_;
}

// The first picture makes the driver's programs, which takes half a second without a graphics card: while the window is
// still coming, not under somebody's hand.
void SceneCanvas::showEvent(QShowEvent*) {
    if (rendered == 0) picture();
}

void SceneCanvas::resizeEvent(QResizeEvent*) {
    stale_ = true;
}

void SceneCanvas::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    if (picture().isNull())
        painter.fillRect(rect(), palette().base());
    else
        painter.drawImage(rect(), picture_);
    if (on_paint) on_paint(painter);
    if (drawn_.size() > 1) {
        painter.setRenderHint(QPainter::Antialiasing);
        painter.setPen(QPen(style::selection(palette()), 2));
        QColor inside = style::selection(palette());
        inside.setAlpha(40);
        painter.setBrush(inside);
        painter.drawPolygon(drawn_);
    }
}

void SceneCanvas::show_view(SceneView::View view) {
    vtkCamera* camera = renderer_->GetActiveCamera();
    Eigen::Vector3d towards(0, 0, 0), up(0, 1, 0);
    switch (view) {
        case SceneView::View::front:
            towards = {0, 0, 1};
            break;  // the side the sensors look at
        case SceneView::View::back:
            towards = {0, 0, -1};
            break;
        case SceneView::View::top:
            towards = {0, 1, 0};
            up = {0, 0, -1};
            break;
        case SceneView::View::iso:
            towards = {0.55, 0.45, 0.8};
            break;
        case SceneView::View::fit:
            break;
    }
    if (view != SceneView::View::fit) {
        double focus[3];
        camera->GetFocalPoint(focus);
        const double distance = std::max(1.0, camera->GetDistance());
        const Eigen::Vector3d eye =
            Eigen::Vector3d(focus[0], focus[1], focus[2]) + distance * towards.normalized();
        camera->SetPosition(eye.x(), eye.y(), eye.z());
        camera->SetViewUp(up.x(), up.y(), up.z());
    }
    double box[6] = {1, -1, 1, -1, 1, -1};
    if (part && part->GetVisibility()) part->GetBounds(box);
    // A part without a mesh has no bounds; then all that is there counts.
    if (!(box[0] <= box[1])) renderer_->ComputeVisiblePropBounds(box);
    if (box[0] <= box[1]) {
        renderer_->ResetCamera(box);
        camera->Zoom(1.1);
    }
    request_render();
}

void SceneCanvas::fit(vtkActor& actor) {
    double box[6];
    actor.GetBounds(box);
    if (box[0] <= box[1]) renderer_->ResetCamera(box);
    request_render();
}

Eigen::Vector3d SceneCanvas::project(const Eigen::Vector3d& point) const {
    auto* renderer = const_cast<vtkRenderer*>(renderer_.GetPointer());
    const double aspect = width() / static_cast<double>(std::max(1, height()));
    double p[4] = {point.x(), point.y(), point.z(), 1}, out[4];
    renderer->GetActiveCamera()->GetCompositeProjectionTransformMatrix(aspect, 0, 1)->MultiplyPoint(p, out);
    if (!(out[3] > 0)) return {-1e6, -1e6, 2};
    return {(out[0] / out[3] + 1) / 2 * width(), (1 - out[1] / out[3]) / 2 * height(), out[2] / out[3]};
}

std::optional<Eigen::Vector3d> SceneCanvas::pick(const QPointF& at, vtkActor& actor) {
    vtkNew<vtkCellPicker> picker;
    picker->SetTolerance(0);
    picker->PickFromListOn();
    picker->AddPickList(&actor);
    const double ratio = devicePixelRatioF();
    if (!picker->Pick(at.x() * ratio, (height() - at.y()) * ratio, 0, renderer_)) return std::nullopt;
    double p[3];
    picker->GetPickPosition(p);
    return Eigen::Vector3d(p[0], p[1], p[2]);
}

void SceneCanvas::mousePressEvent(QMouseEvent* event) {
    press_ = last_ = event->position();
    dragged_ = false;
    drawn_.clear();
    if (event->button() == Qt::RightButton || (lasso && event->button() == Qt::LeftButton)) drawn_ << press_;
    held_ = event->button() == Qt::LeftButton && drawn_.isEmpty() && on_grab && on_grab(press_);
}

void SceneCanvas::mouseMoveEvent(QMouseEvent* event) {
    if (event->buttons() == Qt::NoButton) {
        if (on_hover) on_hover(event->position());
        return;
    }
    const QPointF at = event->position(), step = at - last_;
    dragged_ = dragged_ || (at - press_).manhattanLength() > 4;
    if (!dragged_) return;
    last_ = at;
    if (held_) return on_drag(at);
    if (!drawn_.isEmpty()) {
        drawn_ << at;
        return update();
    }
    vtkCamera* camera = renderer_->GetActiveCamera();
    const bool move = (event->buttons() & Qt::MiddleButton) ||
                      ((event->buttons() & Qt::LeftButton) && (event->modifiers() & Qt::ShiftModifier));
    if (move) {
        // The point in the middle follows the mouse.
        const double mm_per_px = 2 * camera->GetDistance() *
                                 std::tan(rad_from_deg(camera->GetViewAngle() / 2)) / std::max(1, height());
        double eye[3], focus[3], up[3], look[3];
        camera->GetPosition(eye);
        camera->GetFocalPoint(focus);
        camera->GetViewUp(up);
        camera->GetDirectionOfProjection(look);
        const Eigen::Vector3d y = Eigen::Vector3d(up[0], up[1], up[2]).normalized();
        const Eigen::Vector3d x = Eigen::Vector3d(look[0], look[1], look[2]).cross(y);
        const Eigen::Vector3d shift = mm_per_px * (-step.x() * x + step.y() * y);
        camera->SetPosition(eye[0] + shift.x(), eye[1] + shift.y(), eye[2] + shift.z());
        camera->SetFocalPoint(focus[0] + shift.x(), focus[1] + shift.y(), focus[2] + shift.z());
    } else {
        camera->Azimuth(-0.4 * step.x());
        camera->Elevation(0.4 * step.y());
        camera->OrthogonalizeViewUp();
    }
    request_render();
}

void SceneCanvas::mouseReleaseEvent(QMouseEvent* event) {
    const QPolygonF drawn = std::exchange(drawn_, {});
    if (dragged_ && drawn.size() > 2) {
        update();
        if (on_encircled) on_encircled(drawn);
    }
    const bool held = std::exchange(held_, false);
    if (!held && !dragged_ && event->button() == Qt::LeftButton && on_click) on_click(event->position());
}

void SceneCanvas::wheelEvent(QWheelEvent* event) {
    renderer_->GetActiveCamera()->Dolly(std::pow(1.15, event->angleDelta().y() / 120.0));
    request_render();
    event->accept();
}

}  // namespace seamwright
