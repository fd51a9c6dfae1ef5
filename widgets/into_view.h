#pragma once
// What a page says below its fold is read only where the page goes there by itself.

#include <QScrollArea>
#include <QTimer>

namespace seamwright {

// Scrolls the areas that `widget` lies in, once the layout has found its place.
inline void bring_into_view(QWidget* widget) {
    QTimer::singleShot(0, widget, [widget] {
        for (QWidget* up = widget->parentWidget(); up; up = up->parentWidget())
            if (auto* area = qobject_cast<QScrollArea*>(up)) area->ensureWidgetVisible(widget);
    });
}

}  // namespace seamwright
