#pragma once
// What a page says below its fold is read only where the page goes there by itself.

#include <QScrollArea>
#include <QTimer>

namespace seamwright {

// Scrolls the areas that `widget` lies in, once the layout has found its place: until all of it is seen where it has room (Qt
// itself would do with a list's current row).
inline void bring_into_view(QWidget* widget) {
    QTimer::singleShot(0, widget, [widget] {
        for (QWidget* up = widget->parentWidget(); up; up = up->parentWidget())
            if (auto* area = qobject_cast<QScrollArea*>(up);
                area && area->widget() && area->widget()->isAncestorOf(widget)) {
                area->ensureWidgetVisible(widget);
                const QRect all(widget->mapTo(area->widget(), QPoint(0, 0)), widget->size());
                if (constexpr int kRim = 2; all.height() + 2 * kRim <= area->viewport()->height())
                    area->ensureVisible(all.left(), all.center().y(), 0, all.height() / 2 + kRim);
            }
    });
}

}  // namespace seamwright
