#include "widgets/profile/profile_plot.h"

#include <QKeyEvent>
#include <QLabel>
#include <QVBoxLayout>
#include <algorithm>

#include "widgets/profile/profile_canvas.h"
#include "widgets/style.h"
#include "widgets/view_bar.h"

namespace seamwright {

struct ProfilePlot::Impl {
    ProfileCanvas* canvas = nullptr;
    QWidget* toolbar = nullptr;
    QLabel* caption = nullptr;
    QToolButton *freeze = nullptr, *measure = nullptr, *residuals = nullptr, *intensity = nullptr;
    Profile newest;  // arrived while frozen
    std::optional<Feature> newest_feature;
    bool frozen = false, newer = false;
};

ProfilePlot::ProfilePlot(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setObjectName("profile_plot");
    setAccessibleName(tr("Live profile"));
    setToolTip(
        tr("Profile in the sensor frame, mm. Drag moves, wheel zooms, double click or F fits, Space freezes, "
           "M measures."));
    impl_->canvas = new ProfileCanvas(*this, this);
    impl_->canvas->setAccessibleName(tr("Profile, x and z in mm"));
    setFocusProxy(impl_->canvas);
    auto* bar = new ViewBar(this);
    impl_->toolbar = bar;
    impl_->caption = bar->caption();
    impl_->caption->setObjectName("sensor_state");
    impl_->caption->setAccessibleName(tr("Sensor state"));
    auto* fit_button = bar->add(tr("Fit"), tr("Show all points (F)"), false);
    impl_->measure = bar->add(tr("Measure"), tr("Two clicks: distance and angle (M)"), true);
    impl_->residuals =
        bar->add(tr("Residuals"), tr("Histogram of the distances to the reference profile"), true);
    impl_->intensity = bar->add(tr("Intensity"), tr("Brightness of the stripe along x"), true);
    impl_->freeze = bar->add(tr("Freeze"), tr("Hold this profile on the screen (Space)"), true);
    connect(fit_button, &QToolButton::clicked, this, &ProfilePlot::fit);
    connect(impl_->measure, &QToolButton::clicked, this,
            [this](bool on) { set_tool(on ? Tool::measure : Tool::inspect); });
    connect(impl_->residuals, &QToolButton::toggled, this, &ProfilePlot::set_residuals_shown);
    connect(impl_->intensity, &QToolButton::toggled, this, &ProfilePlot::set_intensity_shown);
    connect(impl_->freeze, &QToolButton::toggled, this, &ProfilePlot::set_frozen);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(impl_->toolbar);
    column->addWidget(impl_->canvas, 1);
}

ProfilePlot::~ProfilePlot() = default;

void ProfilePlot::set_profile(const Profile& profile) {
    if (impl_->frozen) {
        impl_->newest = profile;
        impl_->newer = true;
        return;
    }
    impl_->canvas->profile = profile;
    set_stale(false);
    impl_->canvas->profile_changed();
}

void ProfilePlot::set_feature(const std::optional<Feature>& feature) {
    if (impl_->frozen) {
        impl_->newest_feature = feature;
        impl_->newer = true;
        return;
    }
    const bool was = impl_->canvas->feature.has_value();
    impl_->canvas->feature = feature;
    if (was || feature) impl_->canvas->request_live();
}

void ProfilePlot::set_stale(bool stale) {
    if (impl_->canvas->stale == stale) return;
    impl_->canvas->stale = stale;
    impl_->canvas->request_live();
}
bool ProfilePlot::stale() const {
    return impl_->canvas->stale;
}

void ProfilePlot::set_reference(const Profile& profile, const std::optional<Eigen::Vector2d>& reference_mm) {
    impl_->canvas->reference = profile;
    impl_->canvas->reference_point = reference_mm;
    impl_->canvas->marks_changed();
}

void ProfilePlot::clear_reference() {
    set_reference({}, std::nullopt);
}

void ProfilePlot::set_template(const Profile& placed) {
    impl_->canvas->placed_template = placed;
    impl_->canvas->marks_changed();
}

void ProfilePlot::clear_template() {
    set_template({});
}

void ProfilePlot::set_window(const std::optional<QRectF>& window_mm) {
    impl_->canvas->window = window_mm;
    impl_->canvas->request_live();
}

void ProfilePlot::set_caption(const QString& caption) {
    impl_->caption->setText(caption);
    // It never shrinks: the buttons beside it stay where they are while the rate changes.
    impl_->caption->setMinimumWidth(
        std::max(impl_->caption->minimumWidth(), impl_->caption->sizeHint().width()));
}

void ProfilePlot::set_tool(Tool tool) {
    if (impl_->canvas->tool == tool) return;
    impl_->canvas->cancel_tool();
    impl_->canvas->tool = tool;
    impl_->canvas->setCursor(tool == Tool::inspect ? Qt::ArrowCursor : Qt::CrossCursor);
    impl_->measure->setChecked(tool == Tool::measure);
    emit tool_changed(tool);
}

ProfilePlot::Tool ProfilePlot::tool() const {
    return impl_->canvas->tool;
}

void ProfilePlot::set_frozen(bool frozen) {
    if (impl_->frozen == frozen) return;
    impl_->frozen = frozen;
    impl_->freeze->setChecked(frozen);
    impl_->freeze->setText(frozen ? tr("Frozen") : tr("Freeze"));
    if (frozen) {
        impl_->newest_feature = impl_->canvas->feature;
    } else if (impl_->newer) {
        impl_->newer = false;
        impl_->canvas->feature = impl_->newest_feature;
        if (impl_->newest.size() > 0) set_profile(impl_->newest);
        impl_->newest.clear();
        impl_->canvas->request_live();
    }
    emit frozen_changed(frozen);
}

bool ProfilePlot::frozen() const {
    return impl_->frozen;
}

void ProfilePlot::set_residuals_shown(bool shown) {
    impl_->canvas->residuals_shown = shown;
    impl_->residuals->setChecked(shown);
    impl_->canvas->marks_changed();
}

bool ProfilePlot::residuals_shown() const {
    return impl_->canvas->residuals_shown;
}

void ProfilePlot::set_intensity_shown(bool shown) {
    impl_->canvas->intensity_shown = shown;
    impl_->intensity->setChecked(shown);
    impl_->canvas->request_live();
}

void ProfilePlot::set_toolbar_shown(bool shown) {
    impl_->toolbar->setVisible(shown);
}

void ProfilePlot::fit() {
    impl_->canvas->fit();
}

void ProfilePlot::set_view(const QRectF& mm) {
    impl_->canvas->untouched = false;
    impl_->canvas->set_equal_view(mm);
    impl_->canvas->flush();
}

QRectF ProfilePlot::view() const {
    const QCPRange x = impl_->canvas->xAxis->range(), z = impl_->canvas->yAxis->range();
    return {x.lower, z.lower, x.size(), z.size()};
}

QPointF ProfilePlot::to_screen(const QPointF& mm) const {
    return impl_->canvas->mapTo(this, impl_->canvas->pixel(mm));
}

QPointF ProfilePlot::from_screen(const QPointF& pixel) const {
    return impl_->canvas->mm(impl_->canvas->mapFrom(this, pixel));
}

const std::vector<double>& ProfilePlot::residuals_mm() const {
    return impl_->canvas->residuals();
}

void ProfilePlot::flush() {
    impl_->canvas->flush();
}

void ProfilePlot::changeEvent(QEvent* event) {
    QWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && impl_) impl_->canvas->request_live();
}

void ProfilePlot::keyPressEvent(QKeyEvent* event) {
    ProfileCanvas& canvas = *impl_->canvas;
    const QPointF middle = QPointF(canvas.rect().center());
    switch (event->key()) {
        case Qt::Key_F:
            fit();
            return;
        case Qt::Key_Space:
            set_frozen(!impl_->frozen);
            return;
        case Qt::Key_M:
            set_tool(tool() == Tool::measure ? Tool::inspect : Tool::measure);
            return;
        case Qt::Key_Escape:
            set_tool(Tool::inspect);
            return;
        case Qt::Key_Left:
            canvas.pan_by(-0.1, 0);
            return;
        case Qt::Key_Right:
            canvas.pan_by(0.1, 0);
            return;
        case Qt::Key_Up:
            canvas.pan_by(0, 0.1);
            return;
        case Qt::Key_Down:
            canvas.pan_by(0, -0.1);
            return;
        case Qt::Key_Plus:
        case Qt::Key_Equal:
            canvas.zoom_by(1.25, middle);
            return;
        case Qt::Key_Minus:
            canvas.zoom_by(0.8, middle);
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

}  // namespace seamwright
