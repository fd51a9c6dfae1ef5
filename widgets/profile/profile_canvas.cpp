#include "widgets/profile/profile_canvas.h"

#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/pose.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {

namespace {

constexpr int kIntensity_px = 42;
constexpr QSize kResidualBox(220, 118);

double nice_error(double value) {
    return std::sqrt(std::max(0.0, value));
}

}  // namespace

ProfileCanvas::ProfileCanvas(ProfilePlot& plot, QWidget* parent) : PlotCanvas(parent), plot_(plot) {
    equal_axes = true;
    setMouseTracking(true);
    xAxis->setLabel(ProfilePlot::tr("x (mm)"));
    yAxis->setLabel(ProfilePlot::tr("z (mm)"));
    xAxis->setRange(-50, 50);
    yAxis->setRange(-25, 25);
    axisRect()->setMinimumMargins(QMargins(0, 8, 10, 0));
    apply_style();
}

TraceScale ProfileCanvas::scale() const {
    const QRect area = axisRect()->rect();
    return {xAxis->range().lower, yAxis->range().upper, area.width() / xAxis->range().size(), area.width(),
            area.height()};
}

QPointF ProfileCanvas::pixel(const QPointF& mm) const {
    const QRect area = axisRect()->rect();
    const TraceScale s = scale();
    return {area.left() + (mm.x() - s.x_left_mm) * s.px_per_mm,
            area.top() + (s.z_top_mm - mm.y()) * s.px_per_mm};
}

QPointF ProfileCanvas::mm(const QPointF& pixel) const {
    const QRect area = axisRect()->rect();
    const TraceScale s = scale();
    return {s.x_left_mm + (pixel.x() - area.left()) / s.px_per_mm,
            s.z_top_mm - (pixel.y() - area.top()) / s.px_per_mm};
}

void ProfileCanvas::make_trace(const Profile& shown, Trace& trace) const {
    const TraceScale s = scale();
    decimate(shown, s, trace.strokes, trace.outliers);
    int low = s.height_px, high = -1, left = s.width_px, right = -1;
    for (const ColumnStroke& stroke : trace.strokes) {
        low = std::min(low, static_cast<int>(stroke.low));
        high = std::max(high, static_cast<int>(stroke.high));
        left = std::min(left, stroke.column);
        right = std::max(right, stroke.column);
    }
    trace.dense = right <= left || static_cast<int>(trace.strokes.size()) * 4 > right - left + 1;
    for (const int i : trace.outliers) {
        const auto k = static_cast<std::size_t>(i);
        const int u = static_cast<int>((shown.x_mm[k] - s.x_left_mm) * s.px_per_mm);
        const int v = static_cast<int>(
            std::clamp((s.z_top_mm - shown.z_mm[k]) * s.px_per_mm, -10.0, s.height_px + 10.0));
        low = std::min(low, v);
        high = std::max(high, v);
        left = std::min(left, u);
        right = std::max(right, u);
    }
    const QRect area = axisRect()->rect();
    trace.bounds = right < left ? QRect()
                                : (QRect(QPoint(area.left() + left - 5, area.top() + low - 5),
                                         QPoint(area.left() + right + 5, area.top() + high + 5)) &
                                   area);
}

void ProfileCanvas::view_changed() {
    make_trace(profile, live_);
    make_trace(reference, below_);
    make_trace(placed_template, template_);
}

void ProfileCanvas::profile_changed() {
    if (untouched && !fitted_once_ && isVisible() && !bounds().isNull()) {
        fit();
        fitted_once_ = true;
    }
    make_trace(profile, live_);
    QRegion region(last_painted_ | live_.bounds);
    if (intensity_shown) {
        const QRect area = axisRect()->rect();
        region += QRect(area.left(), area.bottom() - kIntensity_px - 20, area.width(), kIntensity_px + 21);
    }
    if (residuals_shown) {
        residuals_to_reference(profile, reference, residuals_);
        region += QRect(axisRect()->rect().topRight() - QPoint(kResidualBox.width() + 8, -8), kResidualBox);
    }
    request_live(region);
}

void ProfileCanvas::marks_changed() {
    make_trace(reference, below_);
    make_trace(placed_template, template_);
    if (residuals_shown) residuals_to_reference(profile, reference, residuals_);
    request_live();
}

QRectF ProfileCanvas::bounds() const {
    double x0 = 1e300, x1 = -1e300, z0 = 1e300, z1 = -1e300;
    const auto take = [&](const Profile& p) {
        const bool filtered = p.filtered();
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (!std::isfinite(p.x_mm[i]) || !std::isfinite(p.z_mm[i]) || (filtered && p.segment[i] < 0))
                continue;
            x0 = std::min(x0, p.x_mm[i]);
            x1 = std::max(x1, p.x_mm[i]);
            z0 = std::min(z0, p.z_mm[i]);
            z1 = std::max(z1, p.z_mm[i]);
        }
    };
    take(profile);
    take(reference);
    return x1 < x0 ? QRectF() : QRectF(x0, z0, std::max(0.1, x1 - x0), std::max(0.1, z1 - z0));
}

void ProfileCanvas::fit() {
    QRectF all = bounds();
    if (all.isNull()) all = QRectF(-50, -25, 100, 50);
    const double margin = 0.05 * std::max(all.width(), all.height());
    set_equal_view(all.adjusted(-margin, -margin, margin, margin));
    flush();
}

void ProfileCanvas::pan_by(double share_x, double share_y) {
    untouched = false;
    const double mm_x = share_x * xAxis->range().size(), mm_y = share_y * yAxis->range().size();
    xAxis->setRange(xAxis->range().lower + mm_x, xAxis->range().upper + mm_x);
    yAxis->setRange(yAxis->range().lower + mm_y, yAxis->range().upper + mm_y);
    request_replot();
}

void ProfileCanvas::zoom_by(double factor, const QPointF& about_px) {
    untouched = false;
    const double size = xAxis->range().size() / factor;
    if (size < 0.01 || size > 1e5) return;
    const QPointF about = mm(about_px);
    xAxis->scaleRange(1 / factor, about.x());
    yAxis->scaleRange(1 / factor, about.y());
    request_replot();
}

void ProfileCanvas::cancel_tool() {
    measure_from_.reset();
    measure_to_.reset();
    measuring_ = false;
    press_px_.reset();
    window.reset();
    request_live();
}

void ProfileCanvas::paint_thin(QPainter& painter, const Trace& trace, const QColor& colour, int thickness) {
    const QRect area = axisRect()->rect();
    if (!trace.dense) {
        lines_.clear();
        for (std::size_t i = 1; i < trace.strokes.size(); ++i) {
            const ColumnStroke &a = trace.strokes[i - 1], &b = trace.strokes[i];
            if (a.segment != b.segment) continue;
            lines_.emplace_back(area.left() + a.column, area.top() + a.high, area.left() + b.column,
                                area.top() + b.high);
        }
        painter.setPen(QPen(colour, thickness));
        painter.drawLines(lines_.data(), static_cast<int>(lines_.size()));
        return;
    }
    rectangles_.clear();
    for (const ColumnStroke& stroke : trace.strokes) {
        const int top = area.top() + static_cast<int>(std::lround(stroke.low));
        const int bottom = area.top() + static_cast<int>(std::lround(stroke.high));
        rectangles_.emplace_back(area.left() + stroke.column, top - thickness / 2, 1,
                                 bottom - top + thickness);
    }
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour);
    painter.drawRects(rectangles_.data(), static_cast<int>(rectangles_.size()));
}

void ProfileCanvas::paint_trace(QPainter& painter, const Profile& shown, const Trace& trace) {
    const QRect area = axisRect()->rect();
    const QPalette& colours = palette();
    painter.setPen(Qt::NoPen);
    const TraceScale s = scale();
    if (trace.dense) {
        std::size_t i = 0;
        while (i < trace.strokes.size()) {
            const int segment = trace.strokes[i].segment;
            rectangles_.clear();
            for (; i < trace.strokes.size() && trace.strokes[i].segment == segment; ++i) {
                const ColumnStroke& stroke = trace.strokes[i];
                const int top = area.top() + static_cast<int>(std::lround(stroke.low)) - 1;
                const int bottom = area.top() + static_cast<int>(std::lround(stroke.high)) + 1;
                rectangles_.emplace_back(area.left() + stroke.column, top, 1, bottom - top);
            }
            painter.setBrush(style::segment(segment, colours));
            painter.drawRects(rectangles_.data(), static_cast<int>(rectangles_.size()));
        }
    } else {
        painter.setRenderHint(QPainter::Antialiasing);
        const bool filtered = shown.filtered();
        std::optional<QPointF> before;
        int last = kOutlier;
        for (std::size_t i = 0; i < shown.size(); ++i) {
            const int segment = filtered ? shown.segment[i] : 0;
            if (segment < 0 || !std::isfinite(shown.x_mm[i]) || !std::isfinite(shown.z_mm[i])) continue;
            const QPointF at = pixel({shown.x_mm[i], shown.z_mm[i]});
            const bool near = at.x() > area.left() - 2000 && at.x() < area.right() + 2000;
            if (near) {
                const QColor colour = style::segment(segment, colours);
                if (before && last == segment) {
                    painter.setPen(QPen(colour, 1.5));
                    painter.drawLine(*before, at);
                }
                if (area.contains(at.toPoint())) {
                    painter.setPen(Qt::NoPen);
                    painter.setBrush(colour);
                    painter.drawEllipse(at, 2.6, 2.6);
                }
            }
            before = at;
            last = segment;
        }
        painter.setRenderHint(QPainter::Antialiasing, false);
    }
    if (trace.outliers.empty()) return;
    lines_.clear();
    for (const int i : trace.outliers) {
        const auto k = static_cast<std::size_t>(i);
        const double u = std::floor(area.left() + (shown.x_mm[k] - s.x_left_mm) * s.px_per_mm);
        const double v = std::floor(area.top() + (s.z_top_mm - shown.z_mm[k]) * s.px_per_mm);
        if (v < area.top() - 3 || v > area.bottom() + 3) continue;
        lines_.emplace_back(u - 2, v - 2, u + 2, v + 2);
        lines_.emplace_back(u - 2, v + 2, u + 2, v - 2);
    }
    painter.setPen(style::outlier(colours));
    painter.drawLines(lines_.data(), static_cast<int>(lines_.size()));
}

void ProfileCanvas::paint_intensity(QPainter& painter) {
    if (profile.intensity.size() != profile.size() || profile.size() == 0) return;
    const QRect area = axisRect()->rect();
    const TraceScale s = scale();
    float maximum = 1;
    for (const float value : profile.intensity)
        if (std::isfinite(value)) maximum = std::max(maximum, value);
    std::vector<int> column(static_cast<std::size_t>(std::max(1, area.width())), -1);
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!std::isfinite(profile.x_mm[i]) || !std::isfinite(profile.intensity[i])) continue;
        const double u = (profile.x_mm[i] - s.x_left_mm) * s.px_per_mm;
        if (!(u >= 0 && u < area.width())) continue;
        int& height = column[static_cast<std::size_t>(u)];
        height = std::max(height, static_cast<int>(kIntensity_px * 0.9F * profile.intensity[i] / maximum));
    }
    rectangles_.clear();
    for (std::size_t c = 0; c < column.size(); ++c)
        if (column[c] >= 0)
            rectangles_.emplace_back(area.left() + static_cast<int>(c), area.bottom() - column[c], 1,
                                     column[c] + 1);
    QColor colour = style::quiet_text(palette());
    colour.setAlpha(110);
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour);
    painter.drawRects(rectangles_.data(), static_cast<int>(rectangles_.size()));
    painter.setPen(style::quiet_text(palette()));
    painter.drawText(QRect(area.left(), area.bottom() - kIntensity_px - 20, area.width() - 6, 20),
                     Qt::AlignRight | Qt::AlignBottom,
                     ProfilePlot::tr("intensity, up to %1").arg(static_cast<double>(maximum), 0, 'f', 0));
}

void ProfileCanvas::paint_marks(QPainter& painter) {
    const QPalette& colours = palette();
    painter.setRenderHint(QPainter::Antialiasing);
    if (window) {
        const QPointF a = pixel({window->left(), window->top()}),
                      b = pixel({window->right(), window->bottom()});
        QColor fill = style::selection(colours);
        fill.setAlpha(24);
        painter.setPen(QPen(style::selection(colours), 1.5, Qt::DashLine));
        painter.setBrush(fill);
        painter.drawRect(QRectF(a, b).normalized());
    }
    painter.setBrush(Qt::NoBrush);
    if (reference_point) {
        const QPointF at = pixel({reference_point->x(), reference_point->y()});
        painter.setPen(QPen(style::text(colours), 1.5));
        painter.drawLine(at - QPointF(9, 0), at + QPointF(9, 0));
        painter.drawLine(at - QPointF(0, 9), at + QPointF(0, 9));
        const bool room_below = at.y() + 22 < axisRect()->rect().bottom();
        painter.drawText(at + QPointF(room_below ? 8 : 12, room_below ? 18 : -12),
                         ProfilePlot::tr("reference"));
    }
    if (feature && feature->status == FeatureStatus::ok && feature->point_mm.allFinite()) {
        const QPointF at = pixel({feature->point_mm.x(), feature->point_mm.y()});
        const Eigen::Matrix2d& c = feature->covariance_mm2;
        // Axes of the covariance in closed form.
        const double mean = 0.5 * (c(0, 0) + c(1, 1)), half = 0.5 * (c(0, 0) - c(1, 1));
        const double root = std::hypot(half, c(0, 1));
        const double angle = 0.5 * std::atan2(2 * c(0, 1), c(0, 0) - c(1, 1));
        const double px = scale().px_per_mm;
        const double major = 2 * nice_error(mean + root) * px, minor = 2 * nice_error(mean - root) * px;
        painter.setPen(QPen(style::alarm(colours), 2));
        if (major >= 3 && major < 4000) {
            painter.save();
            painter.translate(at);
            painter.rotate(-deg_from_rad(angle));
            painter.drawEllipse(QPointF(0, 0), major, std::max(minor, 0.7));
            painter.restore();
        }
        painter.drawEllipse(at, 7, 7);
        painter.drawLine(at - QPointF(13, 0), at - QPointF(7, 0));
        painter.drawLine(at + QPointF(7, 0), at + QPointF(13, 0));
        painter.drawLine(at - QPointF(0, 13), at - QPointF(0, 7));
        painter.drawLine(at + QPointF(0, 7), at + QPointF(0, 13));
        const QString label = ProfilePlot::tr("x %1 ± %2   z %3 ± %4 mm (2 sigma)")
                                  .arg(feature->point_mm.x(), 0, 'f', 2)
                                  .arg(2 * nice_error(c(0, 0)), 0, 'f', 2)
                                  .arg(feature->point_mm.y(), 0, 'f', 2)
                                  .arg(2 * nice_error(c(1, 1)), 0, 'f', 2);
        // In the corner, where no contour runs below it for long.
        const QFontMetrics metrics(painter.font());
        const QRect corner = axisRect()->rect();
        const QRectF box(corner.left() + 4, corner.top() + 2, metrics.horizontalAdvance(label) + 12,
                         metrics.height() + 4);
        QColor ground = style::plot_ground(colours);
        ground.setAlpha(225);
        painter.fillRect(box, ground);
        painter.drawText(box, Qt::AlignCenter, label);
    } else if (feature) {
        painter.setPen(style::alarm(colours));
        const QString why =
            feature->message.empty() ? shown_word(to_string(feature->status)) : shown(feature->message);
        painter.drawText(QRectF(axisRect()->rect()).adjusted(8, 6, -8, -6), Qt::AlignTop | Qt::AlignLeft,
                         ProfilePlot::tr("no feature: %1").arg(why));
    }
    painter.setRenderHint(QPainter::Antialiasing, false);
}

void ProfileCanvas::paint_measure(QPainter& painter) {
    if (!measure_from_ || !measure_to_) return;
    const QPointF a = pixel(*measure_from_), b = pixel(*measure_to_);
    const QColor colour = style::selection(palette());
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QPen(colour, 2));
    painter.drawLine(a, b);
    painter.setBrush(style::plot_ground(palette()));
    painter.drawEllipse(a, 4, 4);
    painter.drawEllipse(b, 4, 4);
    const QPointF d = *measure_to_ - *measure_from_;
    const QString label = ProfilePlot::tr("%1 mm   %2°   (dx %3, dz %4)")
                              .arg(std::hypot(d.x(), d.y()), 0, 'f', 2)
                              .arg(deg_from_rad(std::atan2(d.y(), d.x())), 0, 'f', 1)
                              .arg(d.x(), 0, 'f', 2)
                              .arg(d.y(), 0, 'f', 2);
    const QFontMetrics metrics(painter.font());
    QRectF box((a + b) / 2 + QPointF(10, -metrics.height() - 12),
               QSizeF(metrics.horizontalAdvance(label) + 12, metrics.height() + 6));
    const QRectF area = axisRect()->rect();
    box.moveLeft(
        std::clamp(box.left(), area.left() + 2, std::max(area.left() + 2, area.right() - box.width())));
    box.moveTop(
        std::clamp(box.top(), area.top() + 2, std::max(area.top() + 2, area.bottom() - box.height())));
    painter.fillRect(box, style::plot_ground(palette()));
    painter.drawText(box, Qt::AlignCenter, label);
    painter.setRenderHint(QPainter::Antialiasing, false);
}

void ProfileCanvas::paint_residuals(QPainter& painter) {
    const QRect box(axisRect()->rect().topRight() - QPoint(kResidualBox.width() + 8, -8), kResidualBox);
    QColor ground = style::plot_ground(palette());
    ground.setAlpha(235);
    painter.fillRect(box, ground);
    painter.setPen(style::grid(palette()));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(box.adjusted(0, 0, -1, -1));
    painter.setPen(style::text(palette()));
    const int line = QFontMetrics(painter.font()).height();
    if (residuals_.size() < 5) {
        painter.drawText(box, Qt::AlignCenter, ProfilePlot::tr("residuals:\nno reference here"));
        return;
    }
    double mean = 0, square = 0;
    for (const double r : residuals_) mean += r;
    mean /= static_cast<double>(residuals_.size());
    for (const double r : residuals_) square += (r - mean) * (r - mean);
    const double deviation = std::sqrt(square / static_cast<double>(residuals_.size() - 1));
    painter.drawText(
        box.adjusted(6, 2, -4, 0), Qt::AlignTop | Qt::AlignLeft,
        ProfilePlot::tr("to reference %1 ± %2 mm").arg(mean, 0, 'f', 3).arg(deviation, 0, 'f', 3));
    constexpr int kClasses = 41;
    std::array<int, kClasses> count{};
    const double reach = std::max(4 * deviation, 1e-6);
    for (const double r : residuals_) {
        const int c = static_cast<int>(std::floor((r - mean + reach) / (2 * reach) * kClasses));
        ++count[static_cast<std::size_t>(std::clamp(c, 0, kClasses - 1))];
    }
    const int highest = *std::max_element(count.begin(), count.end());
    const QRect bars = box.adjusted(8, line + 6, -8, -line - 4);
    painter.setPen(Qt::NoPen);
    painter.setBrush(style::selection(palette()));
    for (int c = 0; c < kClasses; ++c) {
        const int height = bars.height() * count[static_cast<std::size_t>(c)] / std::max(1, highest);
        const int left = bars.left() + bars.width() * c / kClasses;
        const int right = bars.left() + bars.width() * (c + 1) / kClasses;
        painter.drawRect(QRect(left, bars.bottom() - height + 1, std::max(1, right - left - 1), height));
    }
    painter.setPen(style::quiet_text(palette()));
    painter.drawText(box.adjusted(8, 0, -8, -2), Qt::AlignBottom | Qt::AlignLeft,
                     QString::number(mean - reach, 'f', 2));
    painter.drawText(box.adjusted(8, 0, -8, -2), Qt::AlignBottom | Qt::AlignRight,
                     QString::number(mean + reach, 'f', 2));
}

void ProfileCanvas::paint_live(QPainter& painter, const QRect&) {
    const QRect area = axisRect()->rect();
    painter.setClipRect(area, Qt::IntersectClip);
    if (intensity_shown) paint_intensity(painter);
    QColor beneath = style::quiet_text(palette());
    beneath.setAlpha(150);
    if (reference.size() > 0) paint_thin(painter, below_, beneath, 1);
    if (placed_template.size() > 0) {
        QColor wide = style::attention(palette());
        wide.setAlpha(90);
        paint_thin(painter, template_, wide, 7);
    }
    if (stale)
        paint_thin(painter, live_, style::axis(palette()), 1);
    else
        paint_trace(painter, profile, live_);
    last_painted_ = live_.bounds;
    paint_marks(painter);
    paint_measure(painter);
    if (residuals_shown) paint_residuals(painter);
}

void ProfileCanvas::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton && event->button() != Qt::MiddleButton) return;
    press_px_ = event->position();
    press_button_ = event->button();
    press_mm_ = mm(event->position());
    press_x_ = xAxis->range();
    press_y_ = yAxis->range();
    dragged_ = false;
}

void ProfileCanvas::mouseMoveEvent(QMouseEvent* event) {
    const QPointF at = event->position();
    if (measuring_ && measure_from_) {
        measure_to_ = mm(at);
        request_live();
    }
    if (!press_px_) return;
    if ((at - *press_px_).manhattanLength() > 4) dragged_ = true;
    if (!dragged_) return;
    if (tool == ProfilePlot::Tool::window && press_button_ == Qt::LeftButton) {
        const QPointF to = mm(at);
        window = QRectF(*press_mm_, to).normalized();
        request_live();
        return;
    }
    if (tool == ProfilePlot::Tool::measure && measuring_) return;
    untouched = false;
    const double per_px = press_x_.size() / std::max(1, axisRect()->rect().width());
    const QPointF shift = (at - *press_px_) * per_px;
    xAxis->setRange(press_x_.lower - shift.x(), press_x_.upper - shift.x());
    yAxis->setRange(press_y_.lower + shift.y(), press_y_.upper + shift.y());
    request_replot();
}

void ProfileCanvas::mouseReleaseEvent(QMouseEvent* event) {
    if (!press_px_) return;
    const bool click = !dragged_;
    press_px_.reset();
    const QPointF at = mm(event->position());
    if (tool == ProfilePlot::Tool::window) {
        // It is seen while it is dragged; what was made of it is somebody else's to show.
        const auto dragged = std::exchange(window, std::nullopt);
        request_live();
        if (!click && dragged) emit plot_.window_dragged(*dragged);
        return;
    }
    if (!click || event->button() != Qt::LeftButton) return;
    if (tool == ProfilePlot::Tool::reference) {
        emit plot_.reference_clicked(at);
        return;
    }
    if (tool == ProfilePlot::Tool::measure) {
        if (!measuring_) {
            measure_from_ = measure_to_ = at;
            measuring_ = true;
        } else {
            measure_to_ = at;
            measuring_ = false;
            const QPointF d = *measure_to_ - *measure_from_;
            emit plot_.measured(std::hypot(d.x(), d.y()), deg_from_rad(std::atan2(d.y(), d.x())));
        }
        request_live();
        return;
    }
    const int index = nearest_point(profile, at.x(), at.y(), 24 / scale().px_per_mm);
    if (index < 0) return;
    const auto k = static_cast<std::size_t>(index);
    emit plot_.point_picked(QPointF(profile.x_mm[k], profile.z_mm[k]), index);
}

void ProfileCanvas::mouseDoubleClickEvent(QMouseEvent* event) {
    if (tool == ProfilePlot::Tool::inspect)
        fit();
    else
        mousePressEvent(event);  // two quick clicks of a tool are two clicks
}

// Until somebody moves the picture, it shows all.
void ProfileCanvas::resizeEvent(QResizeEvent* event) {
    PlotCanvas::resizeEvent(event);
    if (untouched && !bounds().isNull()) fit();
}

void ProfileCanvas::wheelEvent(QWheelEvent* event) {
    zoom_by(std::pow(1.2, event->angleDelta().y() / 120.0), event->position());
    event->accept();
}

}  // namespace seamwright
