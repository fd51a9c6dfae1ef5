#include "widgets/align/align_canvas.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/median.h"
#include "widgets/align/align_view.h"
#include "widgets/style.h"

namespace seamwright {

namespace {

double value_of(const TravelOffset& offset, int row) {
    return row == 0 ? offset.dx_mm : row == 1 ? offset.dz_mm : offset.dphi_deg;
}

double at_travel(const Eigen::Vector3d& coefficients, double t) {
    return ((coefficients[2] * t + coefficients[1]) * t + coefficients[0]) * t;
}

// The fit's constant, which the curve leaves out: the profile that the others were laid over has noise of its own, and all
// offsets carry it. Median of what the curve leaves.
double constant_of(const AlignmentResult& result, int row, const Eigen::Vector3d& coefficients) {
    std::vector<double> left;
    for (const TravelOffset& offset : result.offsets) {
        const double v = value_of(offset, row);
        if (offset.ok && std::isfinite(v) && offset.travel_mm >= result.curve.valid_from_mm &&
            offset.travel_mm <= result.curve.valid_to_mm)
            left.push_back(v - at_travel(coefficients, offset.travel_mm));
    }
    return left.empty() ? 0 : median(left);
}

// Level, in the corner: a low plot has no room for it along the axis.
void paint_axis_name(QPainter& painter, const QRect& area, const QString& name, const QPalette& palette) {
    const QFontMetrics metrics(painter.font());
    QColor ground = style::plot_ground(palette);
    ground.setAlpha(225);
    painter.fillRect(
        QRect(area.left() + 1, area.top(), metrics.horizontalAdvance(name) + 10, metrics.height()), ground);
    painter.setPen(style::quiet_text(palette));
    painter.drawText(area.adjusted(6, 0, 0, 0), Qt::AlignLeft | Qt::AlignTop, name);
}

}  // namespace

OffsetCanvas::OffsetCanvas(QWidget* parent) : PlotCanvas(parent) {
    setMouseTracking(true);
    setAccessibleName(AlignView::tr("Shift and turn against travel"));
    plotLayout()->clear();
    auto* group = new QCPMarginGroup(this);
    for (int row = 0; row < 3; ++row) {
        auto* area = new QCPAxisRect(this);
        rects_[static_cast<std::size_t>(row)] = area;
        plotLayout()->addElement(row, 0, area);
        area->setMarginGroup(QCP::msLeft | QCP::msRight, group);
        area->setMinimumMargins(QMargins(0, 6, 10, 0));
        area->axis(QCPAxis::atBottom)->setTickLabels(row == 2);
    }
    plotLayout()->setRowSpacing(2);
    apply_style();
}

void OffsetCanvas::apply_style() {
    PlotCanvas::apply_style();
    if (rect_of(2)) rect_of(2)->axis(QCPAxis::atBottom)->setLabel(AlignView::tr("travel (mm), trigger at 0"));
    rebuild();
}

void OffsetCanvas::set_data(const AlignmentResult& result, const AlignmentOptions& options) {
    result_ = result;
    options_ = options;
    if (!dragging_) jitter_mm = options.jitter_mm;
    filled_ = true;
    rebuild();
}

void OffsetCanvas::clear() {
    filled_ = false;
    rebuild();
}

void OffsetCanvas::rebuild() {
    if (!rect_of(2)) return;
    clearPlottables();
    double low = -options_.window_mm, high = options_.window_mm;
    for (const TravelOffset& offset : result_.offsets)
        if (filled_ && std::isfinite(offset.travel_mm)) {
            low = std::min(low, offset.travel_mm);
            high = std::max(high, offset.travel_mm);
        }
    for (int row = 0; row < 3; ++row) {
        QCPAxis* x = rect_of(row)->axis(QCPAxis::atBottom);
        QCPAxis* y = rect_of(row)->axis(QCPAxis::atLeft);
        x->setRange(low - 1, high + 1);
        double reach = row < 2 ? 2.2 * options_.tolerance_mm : 0.05;
        const Eigen::Vector3d& c = row == 0 ? result_.curve.x_coefficients : result_.curve.z_coefficients;
        const double constant = filled_ && row < 2 ? constant_of(result_, row, c) : 0;
        if (filled_) {
            auto* dots = addGraph(x, y);
            dots->setLineStyle(QCPGraph::lsNone);
            const QColor colour = style::segment(row, palette());
            dots->setScatterStyle(
                QCPScatterStyle(QCPScatterStyle::ssDisc, QPen(colour, 1), QBrush(colour), 5));
            auto* unused = addGraph(x, y);
            unused->setLineStyle(QCPGraph::lsNone);
            unused->setScatterStyle(QCPScatterStyle(QCPScatterStyle::ssCross,
                                                    QPen(style::quiet_text(palette()), 1.5), Qt::NoBrush, 6));
            for (const TravelOffset& offset : result_.offsets) {
                if (!std::isfinite(offset.travel_mm)) continue;
                const double v = value_of(offset, row);
                if (!offset.ok || !std::isfinite(v)) {
                    unused->addData(offset.travel_mm, 0);
                    continue;
                }
                dots->addData(offset.travel_mm, v - constant);
                reach = std::max(reach, std::abs(v - constant) * 1.1);
            }
            if (row < 2) {
                // The curve that the verdict rests on.
                auto* fit = addGraph(x, y);
                fit->setPen(QPen(style::text(palette()), 1.5));
                for (int i = 0; i <= 60; ++i) {
                    const double t = std::clamp(low + (high - low) * i / 60, result_.curve.valid_from_mm,
                                                result_.curve.valid_to_mm);
                    fit->addData(t, at_travel(c, t));
                }
            }
        }
        y->setRange(-reach, reach);
    }
    request_replot();
}

void OffsetCanvas::paint_live(QPainter& painter, const QRect&) {
    QColor band = style::good(palette());
    band.setAlpha(style::is_dark(palette()) ? 46 : 34);
    const QString names[3] = {AlignView::tr("dx (mm)"), AlignView::tr("dz (mm)"), AlignView::tr("turn (°)")};
    for (int row = 0; row < 3; ++row) {
        const QRect area = rect_of(row)->rect();
        const QCPAxis* x = rect_of(row)->axis(QCPAxis::atBottom);
        const QCPAxis* y = rect_of(row)->axis(QCPAxis::atLeft);
        const double left = x->coordToPixel(-jitter_mm), right = x->coordToPixel(jitter_mm);
        painter.setClipRect(area);
        // The verdict's field: within the jitter, within the tolerance.
        if (row < 2) {
            const double top = y->coordToPixel(options_.tolerance_mm),
                         bottom = y->coordToPixel(-options_.tolerance_mm);
            painter.fillRect(QRectF(left, top, right - left, bottom - top), band);
            painter.setPen(QPen(style::good(palette()), 1, Qt::DashLine));
            painter.drawLine(QPointF(area.left(), top), QPointF(area.right(), top));
            painter.drawLine(QPointF(area.left(), bottom), QPointF(area.right(), bottom));
        }
        paint_axis_name(painter, area, names[row], palette());
        painter.setPen(QPen(style::selection(palette()), 2));
        for (const double u : {left, right}) {
            painter.drawLine(QPointF(u, area.top()), QPointF(u, area.bottom()));
            if (row != 0) continue;
            painter.setBrush(style::selection(palette()));
            painter.drawRect(QRectF(u - 5, area.top(), 10, 14));
        }
    }
    painter.setClipping(false);
    if (!filled_) {
        painter.setPen(style::quiet_text(palette()));
        const QString text = AlignView::tr(
            "Run the robot from entry to exit: dx, dz and the turn of every profile against "
            "the one at the trigger appear here. A contour that stands still is flat.");
        // Instead of the two lower diagrams; the first stays for its draggable lines.
        const QRect room = rect_of(1)->rect().united(rect_of(2)->rect());
        painter.fillRect(room.adjusted(-1, 0, 1, 0), style::plot_ground(palette()));
        painter.drawText(room.adjusted(6, 0, -6, 0), Qt::AlignCenter | Qt::TextWordWrap, text);
    }
}

bool OffsetCanvas::near_line(const QPointF& at) const {
    const QCPAxis* x = rect_of(0)->axis(QCPAxis::atBottom);
    return std::min(std::abs(at.x() - x->coordToPixel(jitter_mm)),
                    std::abs(at.x() - x->coordToPixel(-jitter_mm))) < 12;
}

void OffsetCanvas::mousePressEvent(QMouseEvent* event) {
    dragging_ = event->button() == Qt::LeftButton && near_line(event->position());
}

void OffsetCanvas::mouseMoveEvent(QMouseEvent* event) {
    setCursor(dragging_ || near_line(event->position()) ? Qt::SplitHCursor : Qt::ArrowCursor);
    if (!dragging_) return;
    const double travel = std::abs(rect_of(0)->axis(QCPAxis::atBottom)->pixelToCoord(event->position().x()));
    drag_to(travel);
}

void OffsetCanvas::drag_to(double half_width_mm) {
    const double rounded = std::clamp(std::round(half_width_mm * 10) / 10, 0.1, options_.window_mm);
    if (rounded == jitter_mm) return;
    jitter_mm = rounded;
    request_live();
    if (on_jitter) on_jitter(jitter_mm);
}

void OffsetCanvas::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Left || event->key() == Qt::Key_Right)
        drag_to(jitter_mm + (event->key() == Qt::Key_Right ? 0.1 : -0.1));
    else
        PlotCanvas::keyPressEvent(event);
}

void OffsetCanvas::mouseReleaseEvent(QMouseEvent* event) {
    if (dragging_) {
        dragging_ = false;
        return;
    }
    if (on_travel && event->button() == Qt::LeftButton)
        on_travel(rect_of(0)->axis(QCPAxis::atBottom)->pixelToCoord(event->position().x()));
}

StackCanvas::StackCanvas(QWidget* parent) : PlotCanvas(parent) {
    setAccessibleName(AlignView::tr("Profiles over travel"));
    axisRect()->setMinimumMargins(QMargins(0, 6, 10, 0));
    apply_style();
}

void StackCanvas::apply_style() {
    PlotCanvas::apply_style();
    rebuild();
}

void StackCanvas::set_pass(std::span<const TravelProfile> pass) {
    pass_.assign(pass.begin(), pass.end());
    frozen_ = 0;
    for (std::size_t i = 0; i < pass_.size(); ++i)
        if (std::abs(pass_[i].travel_mm) < std::abs(pass_[frozen_].travel_mm)) frozen_ = i;
    rebuild();
}

void StackCanvas::set_live(const Profile& profile) {
    live_ = profile;
    if (overlay) request_live();
}

void StackCanvas::rebuild() {
    if (map_) {
        removePlottable(map_);
        map_ = nullptr;
    }
    double x0 = 1e300, x1 = -1e300, z0 = 1e300, z1 = -1e300;
    for (const TravelProfile& one : pass_)
        for (std::size_t i = 0; i < one.profile.size(); ++i) {
            if (!std::isfinite(one.profile.x_mm[i]) || !std::isfinite(one.profile.z_mm[i])) continue;
            if (one.profile.filtered() && one.profile.segment[i] < 0) continue;
            x0 = std::min(x0, one.profile.x_mm[i]);
            x1 = std::max(x1, one.profile.x_mm[i]);
            z0 = std::min(z0, one.profile.z_mm[i]);
            z1 = std::max(z1, one.profile.z_mm[i]);
        }
    xAxis->setLabel(AlignView::tr("x (mm)"));
    if (x1 <= x0) {
        xAxis->setRange(-50, 50);
        yAxis->setRange(-20, 20);
        request_replot();
        return;
    }
    xAxis->setRange(x0, x1);
    if (overlay) {
        const double margin = std::max(0.5, 0.08 * (z1 - z0));
        yAxis->setRange(z0 - margin, z1 + margin);
        request_replot();
        return;
    }
    double y0 = 1e300, y1 = -1e300;
    for (const TravelProfile& one : pass_)
        if (std::isfinite(one.travel_mm)) {
            y0 = std::min(y0, one.travel_mm);
            y1 = std::max(y1, one.travel_mm);
        }
    if (!(y1 > y0)) y1 = y0 + 1;
    yAxis->setRange(y0, y1);
    const int rows = std::clamp(static_cast<int>(pass_.size()), 2, 400), columns = 480;
    map_ = new QCPColorMap(xAxis, yAxis);
    map_->data()->setSize(columns, rows);
    map_->data()->setRange(QCPRange(x0, x1), QCPRange(y0, y1));
    map_->data()->fill(std::numeric_limits<double>::quiet_NaN());
    map_->data()->fillAlpha(0);
    std::vector<double> height(columns);
    for (int row = 0; row < rows; ++row) {
        // The profile nearest to this row's travel.
        const double travel = y0 + (y1 - y0) * row / (rows - 1);
        const TravelProfile* nearest = nullptr;
        for (const TravelProfile& one : pass_)
            if (std::isfinite(one.travel_mm) &&
                (!nearest || std::abs(one.travel_mm - travel) < std::abs(nearest->travel_mm - travel)))
                nearest = &one;
        if (!nearest) continue;
        const Profile& p = nearest->profile;
        int last = -1, last_segment = kOutlier;
        double last_z = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (!std::isfinite(p.x_mm[i]) || !std::isfinite(p.z_mm[i])) continue;
            const int segment = p.filtered() ? p.segment[i] : 0;
            if (segment < 0) continue;
            const int column =
                std::clamp(static_cast<int>((p.x_mm[i] - x0) / (x1 - x0) * columns), 0, columns - 1);
            // Between neighbours of one segment no column stays empty.
            const int from = last >= 0 && segment == last_segment ? std::min(last, column) : column;
            const int to = last >= 0 && segment == last_segment ? std::max(last, column) : column;
            for (int c = from; c <= to; ++c) {
                const double s = to > from ? static_cast<double>(c - from) / (to - from) : 1;
                map_->data()->setCell(
                    c, row,
                    last >= 0 && segment == last_segment ? last_z + s * (p.z_mm[i] - last_z) : p.z_mm[i]);
                map_->data()->setAlpha(c, row, 255);
            }
            last = column;
            last_z = p.z_mm[i];
            last_segment = segment;
        }
    }
    // Cividis (Nunez 2018): even in brightness, the same to colour-blind eyes.
    QCPColorGradient gradient;
    gradient.clearColorStops();
    const QColor stops[] = {QColor(0x00204d), QColor(0x31446b), QColor(0x666970),
                            QColor(0x958f78), QColor(0xcbba69), QColor(0xffea46)};
    for (int i = 0; i < 6; ++i) gradient.setColorStopAt(i / 5.0, stops[i]);
    map_->setGradient(gradient);
    map_->setInterpolate(false);
    map_->setDataRange(QCPRange(z0, z1));
    request_replot();
}

void StackCanvas::paint_live(QPainter& painter, const QRect&) {
    const QRect area = axisRect()->rect();
    paint_axis_name(painter, area, overlay ? AlignView::tr("z (mm)") : AlignView::tr("travel (mm)"),
                    palette());
    if (!overlay) return;
    painter.setClipRect(area);
    std::vector<QRect> rectangles;
    const auto draw = [&](const Profile& profile, const QColor& colour, int thickness) {
        // Axes of their own scale: height is stretched before the strokes are taken.
        const double per_x = area.width() / xAxis->range().size(),
                     per_z = area.height() / yAxis->range().size();
        Profile scaled = profile;
        for (double& z : scaled.z_mm) z *= per_z / per_x;
        decimate(
            scaled,
            {xAxis->range().lower, yAxis->range().upper * per_z / per_x, per_x, area.width(), area.height()},
            strokes_, outliers_);
        rectangles.clear();
        for (const ColumnStroke& stroke : strokes_) {
            const int top = area.top() + static_cast<int>(std::lround(stroke.low)) - thickness / 2;
            rectangles.emplace_back(area.left() + stroke.column, top, 1,
                                    static_cast<int>(std::lround(stroke.high - stroke.low)) + thickness);
        }
        painter.setPen(Qt::NoPen);
        painter.setBrush(colour);
        painter.drawRects(rectangles.data(), static_cast<int>(rectangles.size()));
    };
    QColor faint = style::selection(palette());
    faint.setAlpha(50);
    for (std::size_t i = 0; i < pass_.size(); ++i)
        if (i != frozen_) draw(pass_[i].profile, faint, 1);
    if (!pass_.empty()) draw(pass_[frozen_].profile, style::selection(palette()), 4);
    if (live_.size() > 0) draw(live_, style::attention(palette()), 2);
}

}  // namespace seamwright
