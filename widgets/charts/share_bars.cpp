#include "widgets/charts/share_bars.h"

#include <QLocale>
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kGapPx = 8, kShortestBarPx = 60;

}  // namespace

ShareBars::ShareBars(QWidget* parent) : QWidget(parent) {
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setAccessibleName(tr("Shares of the variance"));
}

QString ShareBars::figure(const ShareOfWhole& share) {
    return (share.systematic ? tr("%1 % systematic") : tr("%1 % random"))
        .arg(QLocale().toString(share.percent, 'f', 0));
}

int ShareBars::row_height() const {
    return fontMetrics().height() + kGapPx;
}

void ShareBars::set_data(std::vector<ShareOfWhole> shares) {
    shares_ = std::move(shares);
    QStringList lines;
    for (const ShareOfWhole& s : shares_) lines << s.name + QStringLiteral(": ") + figure(s);
    setAccessibleDescription(lines.join(QStringLiteral("; ")));
    setToolTip(lines.join(QChar('\n')));
    updateGeometry();
    update();
}

QSize ShareBars::sizeHint() const {
    return {360, row_height() * static_cast<int>(shares_.size())};
}
QSize ShareBars::minimumSizeHint() const {
    return {200, sizeHint().height()};
}

void ShareBars::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QFontMetrics metrics = fontMetrics();
    int names = 0, figures = 0;
    for (const ShareOfWhole& s : shares_) {
        names = std::max(names, metrics.horizontalAdvance(s.name));
        figures = std::max(figures, metrics.horizontalAdvance(figure(s)));
    }
    names = std::min(names, std::max(0, width() - figures - kShortestBarPx - 2 * kGapPx));
    const int length = std::max(0, width() - names - figures - 2 * kGapPx), row = row_height();
    int top = 0;
    for (const ShareOfWhole& s : shares_) {
        painter.setPen(palette().color(QPalette::WindowText));
        painter.drawText(QRect(0, top, names, row), Qt::AlignRight | Qt::AlignVCenter,
                         metrics.elidedText(s.name, Qt::ElideRight, names));
        painter.drawText(QRect(width() - figures, top, figures, row), Qt::AlignLeft | Qt::AlignVCenter,
                         figure(s));
        const QRect whole(names + kGapPx, top + row / 4, length, row / 2);
        painter.fillRect(whole, palette().color(QPalette::AlternateBase));
        const double share = std::isfinite(s.percent) ? std::clamp(s.percent, 0.0, 100.0) / 100 : 0;
        painter.fillRect(
            QRect(whole.topLeft(), QSize(static_cast<int>(std::lround(share * length)), whole.height())),
            style::segment(s.systematic ? 1 : 0, palette()));
        top += row;
    }
}

}  // namespace seamwright
