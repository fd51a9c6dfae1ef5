#include "widgets/align/cure_arrow.h"

#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <cmath>

#include "core/geometry/pose.h"
#include "widgets/align/align_view.h"
#include "widgets/style.h"

namespace seamwright {

CureArrow::CureArrow(QWidget* parent) : QWidget(parent) {
    setAccessibleName(AlignView::tr("Rotation that cures the drift"));
    setToolTip(AlignView::tr("Turn the sensor this way, seen along the axis towards the eye"));
    setMinimumHeight(120);
}

void CureArrow::set_cure(double about_z_deg, double about_x_deg, bool needed) {
    about_z_deg_ = about_z_deg;
    about_x_deg_ = about_x_deg;
    needed_ = needed;
    update();
}

// The axis points towards the eye (circle with a dot); positive turns are anticlockwise.
void CureArrow::paint_axis(QPainter& painter, const QRectF& box, const QString& axis, double angle_deg) {
    const bool turns = needed_ && std::abs(angle_deg) >= 0.005;
    const QColor colour = turns ? style::attention(palette()) : style::axis(palette());
    const double radius = std::min(box.width(), box.height() - 22) * 0.36;
    const QPointF middle(box.center().x(), box.top() + 6 + radius * 1.15);
    painter.setPen(QPen(style::quiet_text(palette()), 1.5));
    painter.setBrush(Qt::NoBrush);
    painter.drawEllipse(middle, 5, 5);
    painter.setBrush(style::quiet_text(palette()));
    painter.drawEllipse(middle, 1.5, 1.5);
    painter.drawText(QRectF(middle + QPointF(8, -10), QSizeF(30, 20)), Qt::AlignLeft | Qt::AlignVCenter,
                     axis);
    if (turns) {
        // Length of the arc says how far, from 30 to 150 degrees on a logarithmic scale of the angle.
        const double span = std::clamp(30 + 60 * std::log10(std::abs(angle_deg) / 0.05), 30.0, 150.0) *
                            (angle_deg > 0 ? 1 : -1);
        const QRectF circle(middle - QPointF(radius, radius), QSizeF(2 * radius, 2 * radius));
        const double start = 90 - span / 2, end = 90 + span / 2;
        QPen pen(colour, 4);
        pen.setCapStyle(Qt::FlatCap);
        painter.setPen(pen);
        painter.drawArc(circle, static_cast<int>(start * 16), static_cast<int>(span * 16));
        const double at = rad_from_deg(end);
        const QPointF tip = middle + radius * QPointF(std::cos(at), -std::sin(at));
        const double sign = angle_deg > 0 ? 1 : -1;
        const QPointF ahead = sign * QPointF(-std::sin(at), -std::cos(at));
        const QPointF across(-ahead.y(), ahead.x());
        QPainterPath head;
        head.moveTo(tip + 13 * ahead);
        head.lineTo(tip + 8 * across);
        head.lineTo(tip - 8 * across);
        head.closeSubpath();
        painter.fillPath(head, colour);
    }
    painter.setPen(turns ? style::text(palette()) : style::quiet_text(palette()));
    painter.drawText(box, Qt::AlignHCenter | Qt::AlignBottom,
                     turns ? AlignView::tr("about %1: %2%3°")
                                 .arg(axis, angle_deg > 0 ? QStringLiteral("+") : QString())
                                 .arg(angle_deg, 0, 'f', 2)
                           : AlignView::tr("about %1: none").arg(axis));
}

void CureArrow::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF all = rect();
    const QSizeF half(all.width() / 2, all.height());
    paint_axis(painter, QRectF(all.topLeft(), half), AlignView::tr("Z"), about_z_deg_);
    paint_axis(painter, QRectF(all.topLeft() + QPointF(half.width(), 0), half), AlignView::tr("X"),
               about_x_deg_);
}

}  // namespace seamwright
