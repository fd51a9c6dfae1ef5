#include "widgets/editors/leave_field.h"

#include <QApplication>
#include <QPointer>

#include "widgets/editors/name_editor.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/editors/settings_editor.h"
#include "widgets/into_view.h"

namespace seamwright {
namespace {

template <class Editor>
bool refuses(QWidget* widget) {
    const auto* editor = qobject_cast<Editor*>(widget);
    return editor && editor->refused();
}

bool is_refused(QWidget* widget) {
    return refuses<ParameterEditor>(widget) || refuses<PoseEditor>(widget) || refuses<NameEditor>(widget) ||
           refuses<SettingsEditor>(widget);
}

}  // namespace

QWidget* refused_field(QWidget& whole, bool settings) {
    const auto is_setting = [](QWidget* widget) {
        while (widget && !qobject_cast<SettingsEditor*>(widget)) widget = widget->parentWidget();
        return widget != nullptr;
    };
    for (QWidget* widget : whole.findChildren<QWidget*>())
        if (is_refused(widget) && widget->isVisibleTo(&whole) && (settings || !is_setting(widget)))
            return widget;
    return nullptr;
}

bool leave_field(QWidget& whole) {
    const QPointer<QWidget> field = QApplication::focusWidget();
    if (!field || !whole.isAncestorOf(field)) return true;
    field->clearFocus();
    QWidget* refused = field;
    while (refused && !is_refused(refused)) refused = refused->parentWidget();
    if (field) field->setFocus();
    if (auto* form = qobject_cast<SettingsEditor*>(refused))
        form->show_refused();  // it may be another of its fields
    else if (refused)
        bring_into_view(refused);
    return !refused;
}

}  // namespace seamwright
