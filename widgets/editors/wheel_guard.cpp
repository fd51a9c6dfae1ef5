#include "widgets/editors/wheel_guard.h"

#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QComboBox>
#include <QEvent>
#include <QScrollBar>

namespace seamwright {
namespace {

// The box whose value the wheel would change over this object: itself or, over a part of it, the box around.
QWidget* box_of(QObject* object) {
    for (auto* w = qobject_cast<QWidget*>(object); w && !w->isWindow(); w = w->parentWidget()) {
        if (qobject_cast<QScrollBar*>(w)) return nullptr;
        if (qobject_cast<QAbstractSpinBox*>(w) || qobject_cast<QComboBox*>(w) ||
            qobject_cast<QAbstractSlider*>(w))
            return w;
    }
    return nullptr;
}

}  // namespace

bool WheelGuard::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::Polish) {
        QWidget* box = box_of(watched);
        if (box && box == watched && box->focusPolicy() == Qt::WheelFocus)
            box->setFocusPolicy(Qt::StrongFocus);
    } else if (event->type() == QEvent::Wheel) {
        const QWidget* box = box_of(watched);
        if (box && !box->hasFocus() && !box->isAncestorOf(box->window()->focusWidget())) {
            event->ignore();  // goes on to the form
            return true;
        }
    }
    return QObject::eventFilter(watched, event);
}

}  // namespace seamwright
