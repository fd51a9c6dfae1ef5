#include "widgets/plot_canvas.h"

#include <QPaintEvent>
#include <algorithm>

#include "widgets/style.h"

namespace seamwright {

namespace {
constexpr int kFrame_ms = 16;
constexpr int kLeastPlot_px = 20;  // below which nothing is drawn that could be read
}  // namespace

PlotCanvas::PlotCanvas(QWidget* parent) : QCustomPlot(parent) {
    setFocusPolicy(Qt::StrongFocus);
    setAttribute(Qt::WA_OpaquePaintEvent);
    setNoAntialiasingOnDrag(true);
    setLocale(QLocale::c());  // numbers as everywhere in the window
    setPlottingHint(QCP::phFastPolylines, true);
    timer_.setSingleShot(true);
    timer_.setTimerType(Qt::PreciseTimer);
    connect(&timer_, &QTimer::timeout, this, [this] { due(); });
    connect(this, &QCustomPlot::afterReplot, this, [this] { keep_picture(); });
    since_.start();
}

void PlotCanvas::style_axis(QCPAxis* axis, const QWidget& owner) {
    const QPalette& palette = owner.palette();
    const QPen line(style::axis(palette), 1);
    axis->setBasePen(line);
    axis->setTickPen(line);
    axis->setSubTickPen(line);
    axis->setTickLength(0, 4);
    axis->setSubTickLength(0, 2);
    axis->setSubTicks(false);
    axis->setTickLabelColor(style::quiet_text(palette));
    axis->setLabelColor(style::quiet_text(palette));
    axis->setTickLabelFont(owner.font());
    axis->setLabelFont(owner.font());
    axis->setNumberFormat("g");
    axis->setNumberPrecision(5);
    axis->setLabelPadding(2);
    axis->setTickLabelPadding(3);
    axis->grid()->setPen(QPen(style::grid(palette), 1));
    axis->grid()->setZeroLinePen(QPen(style::axis(palette), 1, Qt::DotLine));
    axis->grid()->setSubGridVisible(false);
    axis->grid()->setAntialiased(false);
}

void PlotCanvas::apply_style() {
    setBackground(QBrush(style::plot_ground(palette())));
    for (int i = 0; i < axisRectCount(); ++i)
        for (QCPAxis* axis : axisRect(i)->axes()) style_axis(axis, *this);
    request_replot();
}

void PlotCanvas::request_live(const QRegion& region) {
    wanted_ += region;
    if (timer_.isActive()) return;
    timer_.start(std::max(0, kFrame_ms - static_cast<int>(since_.elapsed())));
}

void PlotCanvas::request_replot() {
    replot_wanted_ = true;
    request_live(QRegion());
}

void PlotCanvas::due() {
    since_.restart();
    if (replot_wanted_) {
        replot_wanted_ = false;
        wanted_ = QRegion();
        if (equal_axes) {
            plotLayout()->update(QCPLayoutElement::upPreparation);
            plotLayout()->update(QCPLayoutElement::upMargins);
            plotLayout()->update(QCPLayoutElement::upLayout);
            equalise();
        }
        thin_ticks();
        view_changed();
        const QRect area = equal_axes ? axisRect()->rect() : QRect();
        replot(QCustomPlot::rpRefreshHint);              // ends in keep_picture(), which updates all
        if (equal_axes && axisRect()->rect() != area) {  // other labels, other margins
            equalise();
            view_changed();
            replot(QCustomPlot::rpRefreshHint);
        }
        return;
    }
    const QRegion region = wanted_;
    wanted_ = QRegion();
    if (!region.isEmpty()) update(region);
}

// As many numbers along an axis as find room beside one another.
void PlotCanvas::thin_ticks() {
    for (QCPAxisRect* rect : axisRects()) {
        if (QCPAxis* x = rect->axis(QCPAxis::atBottom)) {
            const int number_px = 10 * QFontMetrics(x->tickLabelFont()).averageCharWidth();
            x->ticker()->setTickCount(std::clamp(rect->width() / std::max(1, number_px), 2, 6));
        }
        if (QCPAxis* y = rect->axis(QCPAxis::atLeft)) {
            const int number_px = 2 * QFontMetrics(y->tickLabelFont()).height();
            y->ticker()->setTickCount(std::clamp(rect->height() / std::max(1, number_px), 1, 5));
        }
    }
}

// The upright axis takes the scale of the level one.
void PlotCanvas::equalise() {
    const QRect area = axisRect()->rect();
    const double half = 0.5 * xAxis->range().size() * area.height() / std::max(1, area.width());
    const double middle = yAxis->range().center();
    yAxis->setRange(middle - half, middle + half);
}

void PlotCanvas::flush() {
    timer_.stop();
    due();
}

void PlotCanvas::keep_picture() {
    const qreal ratio = devicePixelRatioF();
    const QSize size = (QSizeF(this->size()) * ratio).toSize();
    if (picture_.size() != size) picture_ = QPixmap(size);
    picture_.setDevicePixelRatio(ratio);
    if (!picture_.isNull()) {
        picture_.fill(style::plot_ground(palette()));
        QCPPainter painter(&picture_);
        for (const auto& buffer : std::as_const(mPaintBuffers)) buffer->draw(&painter);
    }
    update();
}

void PlotCanvas::paint_live(QPainter&, const QRect&) {}

void PlotCanvas::paintEvent(QPaintEvent* event) {
    QPainter painter(this);
    const QRect area = event->rect();
    const qreal ratio = devicePixelRatioF();
    if (picture_.isNull()) {
        painter.fillRect(area, style::plot_ground(palette()));
    } else {
        painter.setCompositionMode(QPainter::CompositionMode_Source);
        for (const QRect& part : event->region())
            painter.drawPixmap(part.topLeft(), picture_,
                               QRectF(QPointF(part.topLeft()) * ratio, QSizeF(part.size()) * ratio).toRect());
        painter.setCompositionMode(QPainter::CompositionMode_SourceOver);
    }
    paint_live(painter, area);
}

void PlotCanvas::set_equal_view(const QRectF& view) {
    const QRect area = axisRect()->rect();
    const double width_px = std::max(kLeastPlot_px, area.width()),
                 height_px = std::max(kLeastPlot_px, area.height());
    const double mm_per_px = std::max({view.width() / width_px, view.height() / height_px, 1e-6});
    const QPointF middle = view.center();
    xAxis->setRange(middle.x() - mm_per_px * width_px / 2, middle.x() + mm_per_px * width_px / 2);
    yAxis->setRange(middle.y() - mm_per_px * height_px / 2, middle.y() + mm_per_px * height_px / 2);
    request_replot();
}

void PlotCanvas::resizeEvent(QResizeEvent* event) {
    if (!equal_axes) {
        QCustomPlot::resizeEvent(event);
        flush();
        return;
    }
    const int before_px = axisRect()->rect().width();
    const double width_mm = xAxis->range().size();
    const QPointF middle(xAxis->range().center(), yAxis->range().center());
    QCustomPlot::resizeEvent(event);
    plotLayout()->update(QCPLayoutElement::upMargins);
    plotLayout()->update(QCPLayoutElement::upLayout);
    // A plot that has or had no room has no scale to keep: its width stays.
    const bool scaled = std::min(before_px, axisRect()->rect().width()) >= kLeastPlot_px;
    const QSizeF size =
        scaled ? QSizeF(axisRect()->rect().size()) * (width_mm / before_px) : QSizeF(width_mm, 0);
    set_equal_view(
        QRectF(middle.x() - size.width() / 2, middle.y() - size.height() / 2, size.width(), size.height()));
    flush();
}

void PlotCanvas::changeEvent(QEvent* event) {
    QCustomPlot::changeEvent(event);
    if (styling_) return;
    if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange ||
        event->type() == QEvent::StyleChange) {
        styling_ = true;
        apply_style();
        styling_ = false;
    }
}

}  // namespace seamwright
