#include "widgets/scene/scene_view.h"

#include <vtkCamera.h>
#include <vtkMatrix4x4.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <QKeyEvent>
#include <QLabel>
#include <QMenu>
#include <QVBoxLayout>
#include <algorithm>

#include "widgets/picture_file.h"
#include "widgets/scene/scene_view_impl.h"
#include "widgets/style.h"
#include "widgets/view_bar.h"

namespace seamwright {
namespace {

// What would give the same picture is not drawn again.
bool same(const Pose& a, const Pose& b) {
    return a.matrix() == b.matrix();
}

bool same(const SceneSpot& a, const SceneSpot& b) {
    return a.id == b.id && same(a.workobject_from_sensor, b.workobject_from_sensor) &&
           a.reference_mm == b.reference_mm && a.enabled == b.enabled && a.field_mm == b.field_mm &&
           a.stand_off_mm == b.stand_off_mm && a.shift_mm == b.shift_mm;
}

bool same(const SceneRegion& a, const SceneRegion& b) {
    return a.id == b.id && a.spot_ids == b.spot_ids && a.weak_direction == b.weak_direction &&
           a.weak_text == b.weak_text;
}

bool same(const std::optional<SceneRobot>& a, const std::optional<SceneRobot>& b) {
    if (!a || !b) return !a && !b;
    constexpr double kSeen = 1e-4;  // mm, and of a rotation matrix: a standing robot's encoders move less
    const auto near = [](const Pose& p, const Pose& q) {
        return (p.matrix() - q.matrix()).cwiseAbs().maxCoeff() < kSeen;
    };
    return near(a->workobject_from_flange, b->workobject_from_flange) &&
           near(a->workobject_from_sensor, b->workobject_from_sensor);
}

template <typename T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const T& x, const T& y) { return same(x, y); });
}

}  // namespace

const SceneSpot* SceneView::Impl::spot_at(const std::vector<SceneSpot>& among, const QPointF& at) const {
    const SceneSpot* nearest = nullptr;
    double best = 18;  // px: a gloved click
    for (const SceneSpot& one : among) {
        const Eigen::Vector3d p = canvas->project(one.workobject_from_sensor * one.reference_mm);
        const double distance = std::hypot(p.x() - at.x(), p.y() - at.y());
        if (p.z() <= 1 && distance < best) best = distance, nearest = &one;
    }
    return nearest;
}

// The nearest on the screen, of several as near the one in front.
const SceneEdge* SceneView::Impl::edge_at(const QPointF& at) const {
    constexpr double kNear_px = 12;
    const SceneEdge* found = nullptr;
    double best = kNear_px, depth = 1;
    if (!shown.at(Layer::edges)) return nullptr;
    for (const SceneEdge& edge : edges) {
        Eigen::Vector3d before(0, 0, 2);
        for (const Eigen::Vector3d& point : edge.points_mm) {
            const Eigen::Vector3d now = canvas->project(point);
            if (before.z() <= 1 && now.z() <= 1) {
                const Eigen::Vector2d a = before.head<2>(), d = now.head<2>() - a, p(at.x(), at.y());
                const double t =
                    d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
                const double off = (p - a - t * d).norm(), z = before.z() + t * (now.z() - before.z());
                if (off < best - 1 || (off < best + 1 && off < kNear_px && z < depth))
                    best = std::min(best, off), depth = z, found = &edge;
            }
            before = now;
        }
    }
    return found;
}

void SceneView::Impl::make_layers() {
    vtkRenderer& renderer = canvas->renderer();
    const auto add = [&](Layer layer, bool lit, double width) {
        layers[layer] = std::make_unique<LayerManager>(renderer, lit, width);
    };
    add(Layer::part, true, 1);
    add(Layer::spots, true, 2);
    add(Layer::sensors, false, 2);
    add(Layer::regions, false, 2);
    add(Layer::corrections, true, 2);
    add(Layer::path, false, 3);
    add(Layer::edges, false, 2);
    add(Layer::robot, true, 2);
    renderer.SetUseDepthPeeling(false);
    canvas->part = &manager(Layer::part)->actor();
    restyle();
}

void SceneView::Impl::restyle() {
    if (!canvas) return;
    const QColor ground = view.palette().color(QPalette::Base);
    canvas->renderer().SetBackground(ground.redF(), ground.greenF(), ground.blueF());
    canvas->renderer().SetBackgroundAlpha(1);
    vtkActor& part = manager(Layer::part)->actor();
    part.GetMapper()->ScalarVisibilityOff();
    const QColor metal = style::is_dark(view.palette()) ? QColor(0x8d98a3) : QColor(0xb4bcc4);
    part.GetProperty()->SetColor(metal.redF(), metal.greenF(), metal.blueF());
    part.GetProperty()->SetAmbient(0.25);
    part.GetProperty()->SetDiffuse(0.75);
    part.GetProperty()->SetSpecular(0.12);
    redraw_all();
}

void SceneView::Impl::redraw(Layer layer) {
    LayerManager* one = manager(layer);
    if (!one) return;
    const QPalette palette = view.palette();
    switch (layer) {
        case Layer::part:
            one->set(surface);
            break;
        case Layer::spots:
            one->set(draw_spots(spots, spot, palette));
            break;
        case Layer::sensors:
            one->set(draw_sensors(spots, spot, palette));
            break;
        case Layer::regions:
            one->set(draw_regions(regions, spots, region, palette));
            break;
        case Layer::corrections:
            one->set(draw_corrections(spots, scale, palette));
            break;
        case Layer::path:
            one->set(draw_path(path, scale, palette));
            break;
        case Layer::edges:
            one->set(draw_edges(edges, chosen_edges, lit_edge, proposed, palette));
            break;
        case Layer::robot:
            one->set(draw_robot(robot, next_robot, palette));
            break;
        case Layer::labels:
            break;
    }
    changed();
}

void SceneView::Impl::redraw_all() {
    for (const Layer layer : {Layer::spots, Layer::sensors, Layer::regions, Layer::corrections, Layer::path,
                              Layer::edges, Layer::robot})
        redraw(layer);
}

void SceneView::Impl::connect_canvas() {
    canvas->on_paint = [this](QPainter& painter) { paint_words(painter); };
    canvas->on_hover = [this](const QPointF& at) {
        if (edges.empty()) return;
        if (!canvas->lasso)
            spot_at(proposed, at) ? canvas->setCursor(Qt::OpenHandCursor) : canvas->unsetCursor();
        const SceneEdge* edge = edge_at(at);
        const std::string id = edge ? edge->id : std::string();
        if (id == lit_edge) return;
        lit_edge = id;
        redraw(Layer::edges);
    };
    canvas->on_click = [this](const QPointF& at) {
        if (const SceneEdge* edge = edge_at(at))
            return emit view.edge_picked(QString::fromStdString(edge->id));
        const SceneSpot* nearest = spot_at(spots, at);
        if (!nearest && view.layer(Layer::part))
            if (const auto hit = canvas->pick(at, manager(Layer::part)->actor()))
                emit view.part_picked(hit->x(), hit->y(), hit->z());
        const std::string id = nearest ? nearest->id : std::string();
        if (id != spot) view.select_spot(id);
        emit view.spot_picked(QString::fromStdString(id));
    };
    canvas->on_grab = [this](const QPointF& at) {
        const SceneSpot* ghost = shown.at(Layer::edges) ? spot_at(proposed, at) : nullptr;
        held = ghost ? ghost->id : std::string();
        return ghost != nullptr;
    };
    canvas->on_drag = [this](const QPointF& at) {
        emit view.proposed_dragged(QString::fromStdString(held), canvas->mapTo(&view, at));
    };
    canvas->on_encircled = [this](const QPolygonF& line) {
        canvas->lasso = false;
        canvas->unsetCursor();
        QStringList ids;
        for (const SceneSpot& one : spots) {
            const Eigen::Vector3d p = canvas->project(one.workobject_from_sensor * one.reference_mm);
            if (p.z() <= 1 && line.containsPoint({p.x(), p.y()}, Qt::OddEvenFill))
                ids << QString::fromStdString(one.id);
        }
        emit view.spots_encircled(ids);
    };
}

SceneView::SceneView(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>(*this)) {
    setObjectName("scene_view");
    setAccessibleName(tr("Part in 3D"));
    setToolTip(
        tr("Drag turns, Shift and drag moves, wheel zooms, a click selects, a drag with the right button "
           "encircles "
           "spots. 1 front, 2 top, 3 iso, F fit."));
    // Before the buttons: Tab goes from the view to the canvas that has its focus, and on from there.
    if (opengl_available()) impl_->canvas = new SceneCanvas(this);
    auto* bar = new ViewBar(this, tr("Part"));
    impl_->toolbar = bar;
    const std::pair<QString, View> views[] = {
        {tr("Front"), View::front}, {tr("Top"), View::top}, {tr("Iso"), View::iso}, {tr("Fit"), View::fit}};
    for (const auto& [word, which] : views)
        connect(bar->add(word, tr("View: %1").arg(word)), &QToolButton::clicked, this,
                [this, which = which] { show_view(which); });
    auto* layers = bar->add(tr("Layers"), tr("What is drawn"));
    auto* menu = new QMenu(layers);
    const std::pair<QString, Layer> names[] = {{tr("Part"), Layer::part},
                                               {tr("Spots"), Layer::spots},
                                               {tr("Sensors and laser planes"), Layer::sensors},
                                               {tr("Regions"), Layer::regions},
                                               {tr("Corrections"), Layer::corrections},
                                               {tr("Path before and after"), Layer::path},
                                               {tr("Edges of the drawing"), Layer::edges},
                                               {tr("Robot"), Layer::robot},
                                               {tr("Labels"), Layer::labels}};
    for (const auto& [word, which] : names) {
        QAction* action = menu->addAction(word);
        action->setCheckable(true);
        action->setChecked(true);
        impl_->shown[which] = true;
        impl_->actions[which] = action;
        connect(action, &QAction::toggled, this, [this, which = which](bool on) { set_layer(which, on); });
    }
    layers->setMenu(menu);
    layers->setPopupMode(QToolButton::InstantPopup);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(impl_->toolbar);
    if (impl_->canvas) {
        impl_->canvas->setAccessibleName(tr("Part in 3D"));
        column->addWidget(impl_->canvas, 1);
        setFocusProxy(impl_->canvas);
        impl_->make_layers();
        impl_->connect_canvas();
        show_view(View::iso);
    } else {
        impl_->sentence = new QLabel(
            tr("No 3D picture: this display offers no OpenGL 3.2. Everything else works; measuring, "
               "correcting and "
               "pushing do not need it. Cure: a graphics driver with OpenGL 3.2, or Mesa's software renderer "
               "(LIBGL_ALWAYS_SOFTWARE=1)."),
            this);
        setFocusPolicy(Qt::StrongFocus);  // else the canvas has it
        impl_->sentence->setWordWrap(true);
        impl_->sentence->setAlignment(Qt::AlignCenter);
        impl_->sentence->setMargin(24);
        column->addWidget(impl_->sentence, 1);
    }
}

SceneView::~SceneView() = default;

void SceneView::set_part_ply(const std::vector<std::byte>& ply) {
    using Surface = vtkSmartPointer<vtkPolyData>;
    const auto read = [ply]() -> Expected<std::pair<SceneMesh, Surface>> {
        SEAM_TRY(auto mesh, mesh_from_ply(ply));
        Surface surface = part_surface(mesh);
        return std::pair(std::move(mesh), std::move(surface));
    };
    impl_->part_is_read = true;
    impl_->reading.run(read, [this](Expected<std::pair<SceneMesh, Surface>> part) {
        const bool readable = part.has_value();
        if (!readable) part.emplace(SceneMesh(), part_surface({}));  // the one before is not this one's
        impl_->take_part(std::move(part->first), part->second);
        emit part_read(readable);
    });
}

void SceneView::set_part(const SceneMesh& mesh) {
    impl_->reading.drop();
    impl_->take_part(mesh, part_surface(mesh));
}

bool SceneView::has_part() const {
    return !impl_->mesh.triangles.empty();
}

void SceneView::Impl::take_part(SceneMesh part, const vtkSmartPointer<vtkPolyData>& drawn) {
    mesh = std::move(part);
    surface = drawn;
    part_is_read = false;
    redraw(Layer::part);
    fit_once();
}

void SceneView::Impl::fit_once() {
    if (part_is_read) return;  // what stands there is the one before
    const bool part = !mesh.points.empty();
    if (part ? !part_to_fit : !spots_to_fit || spots.empty()) return;
    if (part) part_to_fit = false;
    spots_to_fit = false;
    view.show_view(View::iso);
}

void SceneView::expect_another() {
    impl_->part_to_fit = impl_->spots_to_fit = true;
}

void SceneView::set_part_shift(const Pose& workobject_from_part) {
    if (same(impl_->part_shift, workobject_from_part)) return;
    impl_->part_shift = workobject_from_part;
    if (LayerManager* part = impl_->manager(Layer::part)) {
        vtkNew<vtkMatrix4x4> matrix;
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) matrix->SetElement(r, c, workobject_from_part.matrix()(r, c));
        part->actor().SetUserMatrix(matrix);
    }
    impl_->changed();
}

void SceneView::set_spots(const std::vector<SceneSpot>& spots) {
    if (!same(impl_->spots, spots)) {
        impl_->spots = spots;
        for (const Layer layer : {Layer::spots, Layer::sensors, Layer::regions, Layer::corrections})
            impl_->redraw(layer);
    }
    impl_->fit_once();
}

void SceneView::set_regions(const std::vector<SceneRegion>& regions) {
    if (same(impl_->regions, regions)) return;
    impl_->regions = regions;
    impl_->redraw(Layer::regions);
}

void SceneView::set_path(const ScenePath& path) {
    if (impl_->path == path) return;
    impl_->path = path;
    impl_->redraw(Layer::path);
}

void SceneView::set_edges(std::vector<SceneEdge> edges) {
    impl_->edges = std::move(edges);
    impl_->chosen_edges.clear();
    impl_->lit_edge.clear();
    impl_->redraw(Layer::edges);
}

void SceneView::choose_edges(const std::vector<std::string>& ids) {
    if (impl_->chosen_edges == ids) return;
    impl_->chosen_edges = ids;
    impl_->redraw(Layer::edges);
}

void SceneView::set_proposed(const std::vector<SceneSpot>& spots) {
    impl_->proposed = spots;
    if (spots.empty() && impl_->canvas && !impl_->canvas->lasso) impl_->canvas->unsetCursor();
    impl_->redraw(Layer::edges);
}

void SceneView::set_robot(const std::optional<SceneRobot>& robot) {
    if (same(impl_->robot, robot)) return;
    impl_->robot = robot;
    impl_->redraw(Layer::robot);
}

void SceneView::set_next_robot(const std::optional<SceneRobot>& next) {
    const bool appears = next && !impl_->next_robot, goes = !next && impl_->next_robot;
    impl_->next_robot = next;
    impl_->redraw(Layer::robot);
    if (goes) show_view(View::fit);
    if (appears && impl_->canvas) impl_->canvas->fit(impl_->manager(Layer::robot)->actor());
}

void SceneView::set_picks(const std::vector<Eigen::Vector3d>& picks_mm) {
    impl_->picks = picks_mm;
    impl_->changed();
}

void SceneView::set_correction_scale(double factor) {
    impl_->scale = std::clamp(factor, 1.0, 1000.0);
    impl_->redraw(Layer::corrections);
    impl_->redraw(Layer::path);
}

void SceneView::select_spot(const std::string& id) {
    if (impl_->spot == id) return;
    impl_->spot = id;
    impl_->redraw(Layer::spots);
    impl_->redraw(Layer::sensors);
}

void SceneView::select_region(const std::string& id) {
    if (impl_->region == id) return;
    impl_->region = id;
    impl_->redraw(Layer::regions);
}

std::string SceneView::selected_spot() const {
    return impl_->spot;
}

void SceneView::begin_lasso() {
    if (!impl_->canvas) return;
    impl_->canvas->lasso = true;
    impl_->canvas->setCursor(Qt::CrossCursor);
}

void SceneView::show_view(View view) {
    if (impl_->canvas) impl_->canvas->show_view(view);
}

void SceneView::set_layer(Layer layer, bool shown) {
    impl_->shown[layer] = shown;
    impl_->actions[layer]->setChecked(shown);
    if (LayerManager* manager = impl_->manager(layer)) manager->set_shown(shown);
    impl_->changed();
}

bool SceneView::layer(Layer layer) const {
    return impl_->shown.at(layer);
}
void SceneView::set_toolbar_shown(bool shown) {
    impl_->toolbar->setVisible(shown);
}
bool SceneView::has_opengl() const {
    return impl_->canvas != nullptr;
}
int SceneView::pictures_rendered() const {
    return impl_->canvas ? impl_->canvas->rendered : 0;
}

QImage SceneView::picture() {
    if (!impl_->canvas) return {};
    QImage image = impl_->canvas->picture();
    if (image.isNull()) return image;
    QPainter painter(&image);
    impl_->paint_words(painter);
    return image;
}

Expected<void> SceneView::save_picture(const std::filesystem::path& png) {
    const QImage image = picture();
    if (image.isNull()) return device_error("no OpenGL picture", "3D view", "use a display with OpenGL 3.2");
    return write_picture(image, png);
}

QPointF SceneView::to_screen(const Eigen::Vector3d& point_workobject_mm) const {
    if (!impl_->canvas) return {-1, -1};
    const Eigen::Vector3d p = impl_->canvas->project(point_workobject_mm);
    return impl_->canvas->mapTo(this, QPointF(p.x(), p.y()));
}

void SceneView::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && impl_ && impl_->canvas) impl_->restyle();
}

void SceneView::keyPressEvent(QKeyEvent* event) {
    switch (event->key()) {
        case Qt::Key_1:
            show_view(View::front);
            return;
        case Qt::Key_2:
            show_view(View::top);
            return;
        case Qt::Key_3:
            show_view(View::iso);
            return;
        case Qt::Key_F:
            show_view(View::fit);
            return;
        case Qt::Key_Escape:
            select_spot({});
            emit spot_picked({});
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

}  // namespace seamwright
