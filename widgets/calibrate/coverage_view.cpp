#include "widgets/calibrate/coverage_view.h"

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "core/geometry/pose.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kColumns = 8, kRows = 6;
constexpr double kOuterDeg = 40;  // edge of the picture of orientations

// A profile shows the whole field and the sphere in it; an image shows only what was found.
const std::vector<Eigen::Vector2d>& found(const EntryPicture& picture) {
    return picture.pixels ? picture.points : picture.outline;
}

}  // namespace

CoverageView::CoverageView(QWidget* parent) : QWidget(parent) {
    setObjectName("coverage");
    setAccessibleName(tr("Coverage of field and orientations"));
    setToolTip(tr(
        "Left: where in the field the target was seen. Right: tilt of the sensor against the first capture, "
        "10 degrees a ring; the tick is the turn about the line of sight."));
    setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
}

void CoverageView::set_data(std::vector<CoverageEntry> entries, std::vector<ViewMark> marks,
                            const std::optional<ViewMark>& next, const QString& selected) {
    entries_ = std::move(entries);
    marks_ = std::move(marks);
    next_ = next;
    selected_ = selected;
    measure();
    setAccessibleDescription(tr("field %1 %").arg(std::lround(100 * share_)));
    update();
}

void CoverageView::measure() {
    pixels_ = false;
    left_ = low_ = 1e9, right_ = high_ = -1e9;
    for (const CoverageEntry& e : entries_) {
        pixels_ = pixels_ || e.picture.pixels;
        if (e.picture.pixels && e.picture.width > 0) {
            left_ = low_ = 0;
            right_ = e.picture.width, high_ = e.picture.height;
            continue;
        }
        for (const auto& p : e.picture.points) {
            left_ = std::min(left_, p.x()), right_ = std::max(right_, p.x());
            low_ = std::min(low_, p.y()), high_ = std::max(high_, p.y());
        }
    }
    if (left_ >= right_ || low_ >= high_) left_ = low_ = 0, right_ = high_ = 1;
    cells_.assign(static_cast<std::size_t>(kColumns * kRows), 0);
    for (const CoverageEntry& e : entries_) {
        if (!e.used) continue;
        for (const auto& p : found(e.picture)) {
            const int c = static_cast<int>((p.x() - left_) / (right_ - left_) * kColumns);
            const int r = static_cast<int>((p.y() - low_) / (high_ - low_) * kRows);
            if (c >= 0 && c < kColumns && r >= 0 && r < kRows)
                ++cells_[static_cast<std::size_t>(r * kColumns + c)];
        }
    }
    share_ = static_cast<double>(std::count_if(cells_.begin(), cells_.end(), [](int n) { return n > 0; })) /
             static_cast<double>(cells_.size());
}

void CoverageView::paint_field(QPainter& painter, const QRectF& box) const {
    QSizeF size(right_ - left_, high_ - low_);
    size.scale(box.size(), Qt::KeepAspectRatio);
    QRectF field(QPointF(), size);
    field.moveCenter(box.center());
    painter.fillRect(field, style::plot_ground(palette()));
    QColor seen = style::good(palette());
    seen.setAlpha(60);
    for (int r = 0; r < kRows; ++r)
        for (int c = 0; c < kColumns; ++c)
            if (cells_[static_cast<std::size_t>(r * kColumns + c)] > 0)
                painter.fillRect(QRectF(field.left() + field.width() * c / kColumns,
                                        field.top() + field.height() * (pixels_ ? r : kRows - 1 - r) / kRows,
                                        field.width() / kColumns, field.height() / kRows),
                                 seen);
    const auto place = [&](const Eigen::Vector2d& p) {
        const double x = (p.x() - left_) / (right_ - left_), y = (p.y() - low_) / (high_ - low_);
        return QPointF(field.left() + x * field.width(),
                       field.top() + (pixels_ ? y : 1 - y) * field.height());
    };
    painter.setPen(Qt::NoPen);
    for (const bool selected : {false, true})
        for (const CoverageEntry& e : entries_) {
            if (e.selected != selected) continue;
            painter.setBrush(selected ? style::attention(palette())
                             : e.used ? style::selection(palette())
                                      : style::grid(palette()));
            for (const auto& p : found(e.picture))
                painter.drawEllipse(place(p), selected ? 1.8 : 1.0, selected ? 1.8 : 1.0);
        }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(style::axis(palette()), 1));
    painter.drawRect(field);
}

void CoverageView::paint_views(QPainter& painter, const QRectF& box) const {
    const QPointF middle = box.center();
    double reach = 25;
    for (const ViewMark& m : marks_) reach = std::max(reach, m.tilt_deg.norm() + 5);
    reach = std::min(std::max(reach, next_ ? next_->tilt_deg.norm() + 5 : 0.0), 4 * kOuterDeg);
    const double radius = std::min(box.width(), box.height()) / 2 - 2, scale = radius / reach;
    painter.setBrush(style::plot_ground(palette()));
    painter.setPen(QPen(style::axis(palette()), 1));
    painter.drawEllipse(middle, radius, radius);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(style::grid(palette()), 1));
    for (double ring = 10; ring < reach; ring += 10) painter.drawEllipse(middle, ring * scale, ring * scale);
    const auto draw = [&](const ViewMark& m, const QColor& colour, bool hollow, double size) {
        const QPointF at = middle + scale * QPointF(m.tilt_deg.y(), -m.tilt_deg.x());
        const double turn = rad_from_deg(m.turn_deg);
        painter.setPen(QPen(colour, 2));
        painter.drawLine(at, at + 2.6 * size * QPointF(std::cos(turn), -std::sin(turn)));
        painter.setBrush(hollow ? QBrush(style::plot_ground(palette())) : QBrush(colour));
        painter.drawEllipse(at, size, size);
    };
    for (const ViewMark& m : marks_)
        draw(m,
             QString::fromStdString(m.id) == selected_ ? style::attention(palette())
             : m.used                                  ? style::selection(palette())
                                                       : style::quiet_text(palette()),
             !m.used, QString::fromStdString(m.id) == selected_ ? 6 : 4);
    if (next_) draw(*next_, style::good(palette()), true, 6);
}

void CoverageView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const double line = painter.fontMetrics().height() + 4;
    const QRectF all = rect();
    const bool views = !marks_.empty();
    const QRectF left(0, line, views ? all.width() * 0.55 : all.width(), all.height() - line);
    paint_field(painter, left.adjusted(2, 2, -6, -2));
    painter.setPen(style::quiet_text(palette()));
    painter.drawText(QRectF(left.left() + 2, 0, left.width(), line), Qt::AlignLeft | Qt::AlignVCenter,
                     tr("Field: %1 % covered").arg(std::lround(100 * share_)));
    if (!views) return;
    const QRectF right(left.right(), line, all.width() - left.width(), all.height() - line);
    paint_views(painter, right.adjusted(2, 2, -2, -2));
    painter.setPen(style::quiet_text(palette()));
    painter.drawText(QRectF(right.left(), 0, right.width(), line), Qt::AlignLeft | Qt::AlignVCenter,
                     tr("Orientations, 10° a ring"));
}

}  // namespace seamwright
