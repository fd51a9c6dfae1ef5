#include "widgets/flow_layout.h"

#include <QWidget>
#include <algorithm>

namespace seamwright {

FlowLayout::FlowLayout(QWidget* parent, bool last_to_the_right)
    : QLayout(parent), last_to_the_right_(last_to_the_right) {
    setContentsMargins(0, 0, 0, 0);
    setSpacing(6);
}

FlowLayout::~FlowLayout() {
    for (QLayoutItem* item : items_) delete item;
}

QLayoutItem* FlowLayout::takeAt(int index) {
    return index >= 0 && index < items_.size() ? items_.takeAt(index) : nullptr;
}

QSize FlowLayout::minimumSize() const {
    QSize least;
    for (const QLayoutItem* item : items_)
        if (!item->isEmpty()) least = least.expandedTo(item->sizeHint().expandedTo(item->minimumSize()));
    const QMargins m = contentsMargins();
    return least + QSize(m.left() + m.right(), m.top() + m.bottom());
}

QSize FlowLayout::sizeHint() const {
    QSize all;
    for (const QLayoutItem* item : items_) {
        if (item->isEmpty()) continue;
        const QSize one = item->sizeHint().expandedTo(item->minimumSize());
        all = {all.width() + (all.width() > 0 ? spacing() : 0) + one.width(),
               std::max(all.height(), one.height())};
    }
    const QMargins m = contentsMargins();
    return all + QSize(m.left() + m.right(), m.top() + m.bottom());
}

void FlowLayout::setGeometry(const QRect& rect) {
    QLayout::setGeometry(rect);
    place(rect, true);
}

int FlowLayout::place(const QRect& rect, bool really) const {
    const QRect room = rect.marginsRemoved(contentsMargins());
    QList<std::pair<QLayoutItem*, QRect>> line;
    int x = room.left(), y = room.top(), height = 0;
    const auto end_of_line = [&] {
        const int spare = std::max(0, room.right() + 1 - (x - spacing()));
        for (auto& [item, at] : line) {
            const bool moves = last_to_the_right_ && item != items_.front();
            if (really) item->setGeometry(at.translated(moves ? spare : 0, (height - at.height()) / 2));
        }
        line.clear();
        x = room.left();
        y += height + spacing();
        height = 0;
    };
    for (QLayoutItem* item : items_) {
        if (item->isEmpty()) continue;
        const QSize size = item->sizeHint().expandedTo(item->minimumSize()).boundedTo(item->maximumSize());
        if (!line.isEmpty() && x + size.width() > room.right() + 1) end_of_line();
        line.append({item, QRect(QPoint(x, y), QSize(std::min(size.width(), room.width()), size.height()))});
        x += size.width() + spacing();
        height = std::max(height, size.height());
    }
    if (!line.isEmpty()) end_of_line();
    const QMargins m = contentsMargins();
    return std::max(0, y - spacing() - room.top()) + m.top() + m.bottom();
}

}  // namespace seamwright
