#include "widgets/calibrate/method_drawing.h"

#include <QPainter>
#include <QPainterPath>

#include "widgets/style.h"

namespace seamwright {

MethodDrawing::MethodDrawing(QWidget* parent) : QWidget(parent) {
    setAccessibleName(tr("Drawing of the set-up"));
    setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
}

void MethodDrawing::set_drawing(SetUpDrawing what) {
    what_ = what;
    update();
}

// In a field of 100 x 100: the sensor above, its laser fan in the accent, the target below.
void MethodDrawing::paintEvent(QPaintEvent*) {
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    const double scale = std::min(width(), height()) / 100.0;
    p.translate((width() - 100 * scale) / 2, (height() - 100 * scale) / 2);
    p.scale(scale, scale);
    const QPen thin(style::text(palette()), 1.2), bold(style::text(palette()), 2),
        laser(style::alarm(palette()), 1.2), stripe(style::alarm(palette()), 2.4);
    const bool fixed = what_ == SetUpDrawing::several_sensors,
               no_sensor = what_ == SetUpDrawing::plate_in_world;
    QColor fan = style::alarm(palette());
    fan.setAlpha(45);
    if (!no_sensor) {
        p.setPen(bold);
        if (fixed) {
            p.drawLine(QPointF(20, 4), QPointF(80, 4));
        } else {
            p.drawLine(QPointF(50, 2), QPointF(50, 10));
            p.drawLine(QPointF(42, 10), QPointF(58, 10));
        }
        for (const double x : fixed ? std::vector<double>{30, 70} : std::vector<double>{50}) {
            const double w = fixed ? 12 : 15;
            p.setPen(bold);
            p.setBrush(style::plot_ground(palette()));
            p.drawRect(QRectF(x - w, fixed ? 6 : 11, 2 * w, 14));
            p.setPen(laser);
            p.setBrush(fan);
            const double y = fixed ? 20 : 25, half = fixed ? 14 : 24;
            p.drawPolygon(QPolygonF{QPointF(x, y), QPointF(x - half, 72), QPointF(x + half, 72)});
        }
    }
    p.setBrush(style::plot_ground(palette()));
    p.setPen(thin);
    if (what_ == SetUpDrawing::sphere || what_ == SetUpDrawing::moved_sphere) {
        p.drawLine(QPointF(50, 78), QPointF(50, 97));
        p.drawLine(QPointF(36, 97), QPointF(64, 97));
        p.drawEllipse(QPointF(50, 66), 17, 17);
        p.setPen(stripe);
        p.setBrush(Qt::NoBrush);
        p.drawArc(QRectF(34, 51, 32, 14), 0, 180 * 16);
        if (what_ == SetUpDrawing::moved_sphere) {
            p.setPen(QPen(style::attention(palette()), 1.6, Qt::DashLine));
            p.drawEllipse(QPointF(55, 64), 17, 17);
        }
    } else if (what_ == SetUpDrawing::triangle) {
        p.drawPolygon(QPolygonF{QPointF(22, 92), QPointF(50, 62), QPointF(78, 92)});
        p.setPen(stripe);
        p.drawPolyline(QPolygonF{QPointF(27, 87), QPointF(50, 62), QPointF(73, 87)});
    } else if (what_ == SetUpDrawing::plane || what_ == SetUpDrawing::dotted_plane) {
        p.drawPolygon(QPolygonF{QPointF(12, 92), QPointF(26, 72), QPointF(90, 72), QPointF(78, 92)});
        p.setPen(stripe);
        p.drawLine(QPointF(24, 80), QPointF(84, 80));
        if (what_ == SetUpDrawing::dotted_plane) {
            p.setPen(thin);
            for (int i = 0; i < 6; ++i) p.drawEllipse(QPointF(28 + 10 * i, 86), 1.6, 1.6);
        }
    } else {
        // A board: squares in perspective.
        const QPointF a(14, 94), b(30, 68), c(92, 68), d(82, 94);
        const auto at = [&](double u, double v) {
            return (1 - v) * ((1 - u) * b + u * c) + v * ((1 - u) * a + u * d);
        };
        p.drawPolygon(QPolygonF{a, b, c, d});
        p.setBrush(style::text(palette()));
        p.setPen(Qt::NoPen);
        for (int i = 0; i < 7; ++i)
            for (int k = 0; k < 4; ++k)
                if ((i + k) % 2 == 0)
                    p.drawPolygon(QPolygonF{at(i / 7.0, k / 4.0), at((i + 1) / 7.0, k / 4.0),
                                            at((i + 1) / 7.0, (k + 1) / 4.0), at(i / 7.0, (k + 1) / 4.0)});
        p.setPen(stripe);
        if (!no_sensor && what_ != SetUpDrawing::board) p.drawLine(at(0.05, 0.5), at(0.95, 0.5));
        if (no_sensor) {
            // Measured points and the world's axes.
            p.setBrush(style::alarm(palette()));
            for (const QPointF& corner : {a, b, c, d}) p.drawEllipse(corner, 2.5, 2.5);
            p.setPen(bold);
            p.drawLine(QPointF(14, 46), QPointF(14, 14));
            p.drawLine(QPointF(14, 46), QPointF(46, 46));
            p.drawLine(QPointF(14, 46), QPointF(34, 30));
        }
    }
}

}  // namespace seamwright
