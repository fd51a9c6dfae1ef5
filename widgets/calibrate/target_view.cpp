#include "widgets/calibrate/target_view.h"

#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <cmath>

#include "widgets/style.h"

namespace seamwright {

QImage small_picture(const StripeImage& image, int longest) {
    if (image.empty()) return {};
    const int step = std::max(1, (std::max(image.width, image.height) + longest - 1) / longest);
    QImage small(std::max(1, image.width / step), std::max(1, image.height / step),
                 QImage::Format_Grayscale8);
    const int bytes = image.bytes_per_pixel();
    for (int v = 0; v < small.height(); ++v) {
        uchar* out = small.scanLine(v);
        const std::byte* row = image.pixels + static_cast<std::size_t>(v * step) * image.row_bytes;
        for (int u = 0; u < small.width(); ++u) {
            const std::byte* at = row + static_cast<std::size_t>(u * step * bytes);
            const int grey = bytes == 1 ? std::to_integer<int>(at[0])
                                        : (std::to_integer<int>(at[0]) + 256 * std::to_integer<int>(at[1])) >>
                                              (image.bit_depth - 8);
            out[u] = static_cast<uchar>(std::min(grey, 255));
        }
    }
    return small;
}

void paint_entry(QPainter& painter, const QRectF& box, const EntryPicture& entry, const QImage& background,
                 const QPalette& palette, bool used) {
    painter.save();
    painter.setClipRect(box);
    // Extent of what is shown, then one scale for both axes.
    double left = 0, right = entry.width, low = 0, high = entry.height;
    if (!entry.pixels || entry.width == 0) {
        left = low = 1e9, right = high = -1e9;
        for (const auto& p : entry.points) {
            left = std::min(left, p.x()), right = std::max(right, p.x());
            low = std::min(low, p.y()), high = std::max(high, p.y());
        }
        if (left > right) left = low = 0, right = background.width(), high = background.height();
    }
    const double scale =
        std::min(box.width() / std::max(1e-6, right - left), box.height() / std::max(1e-6, high - low)) *
        (entry.pixels ? 1.0 : 0.92);
    const QPointF middle = box.center();
    const auto place = [&](const Eigen::Vector2d& p) {
        const double x = p.x() - (left + right) / 2, y = p.y() - (low + high) / 2;
        return middle + scale * QPointF(x, entry.pixels ? y : -y);
    };
    if (!background.isNull()) {
        QSizeF size(background.size());
        size.scale(box.size(), Qt::KeepAspectRatio);
        QRectF target(QPointF(), size);
        target.moveCenter(middle);
        painter.drawImage(target, background);
    }
    const bool thumbnail = box.height() < 100;
    painter.setRenderHint(QPainter::Antialiasing);
    const QColor point = used ? style::selection(palette) : style::quiet_text(palette);
    painter.setPen(Qt::NoPen);
    painter.setBrush(point);
    const double r = thumbnail ? 0.8 : 1.3;
    for (const auto& p : entry.points) painter.drawEllipse(place(p), r, r);
    if (entry.outline.size() > 1) {
        QPainterPath path(place(entry.outline.front()));
        for (const auto& p : entry.outline) path.lineTo(place(p));
        // A board is a closed polygon of its four sides; arcs and lines end where they end.
        if (entry.outline.size() <= 8) path.closeSubpath();
        painter.setBrush(Qt::NoBrush);
        QPen pen(used ? style::good(style::dark_palette()) : style::quiet_text(palette), thumbnail ? 1.5 : 3);
        pen.setJoinStyle(Qt::RoundJoin);
        painter.setPen(pen);
        painter.drawPath(path);
    }
    painter.restore();
}

TargetView::TargetView(QWidget* parent) : QWidget(parent) {
    setObjectName("target_view");
    setAccessibleName(tr("Live picture with the target"));
    setToolTip(tr("What the sensor sees of the target; the outline is what would be captured"));
    QSizePolicy policy(QSizePolicy::Preferred, QSizePolicy::Fixed);
    setSizePolicy(policy);
}

void TargetView::set_live(const EntryPicture& entry, const QImage& background, bool seen,
                          const QString& words) {
    entry_ = entry;
    background_ = background;
    seen_ = seen;
    words_ = words;
    setAccessibleDescription(words);
    update();
}

void TargetView::set_ring(double filled, bool shown) {
    if (filled == ring_ && shown == ring_shown_) return;
    ring_ = filled;
    ring_shown_ = shown;
    update();
}

void TargetView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF all = rect();
    painter.fillRect(all, style::plot_ground(palette()));
    const int line = painter.fontMetrics().height();
    const QRectF words = painter.fontMetrics().boundingRect(QRectF(8, 0, all.width() - 16, 4 * line).toRect(),
                                                            Qt::TextWordWrap | Qt::AlignLeft, words_);
    const QRectF foot(0, all.height() - words.height() - 8, all.width(), words.height() + 8);
    paint_entry(painter, QRectF(4, 4, all.width() - 8, foot.top() - 8), entry_, background_, palette());
    QFont font = painter.font();
    font.setBold(seen_);
    painter.setFont(font);
    painter.setPen(seen_ ? style::good(palette()) : style::attention(palette()));
    painter.drawText(foot.adjusted(8, 4, -8, -4), Qt::TextWordWrap | Qt::AlignLeft | Qt::AlignBottom, words_);
    if (!ring_shown_) return;
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF ring(all.width() - 60, 12, 44, 44);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(style::axis(palette()), 6));
    painter.drawEllipse(ring);
    QPen pen(style::good(palette()), 6);
    pen.setCapStyle(Qt::FlatCap);
    painter.setPen(pen);
    painter.drawArc(ring, 90 * 16, -static_cast<int>(360 * 16 * ring_));
}

}  // namespace seamwright
