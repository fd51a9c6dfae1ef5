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

}  // namespace

bool leave_field(QWidget& whole) {
    const QPointer<QWidget> field = QApplication::focusWidget();
    if (!field || !whole.isAncestorOf(field)) return true;
    field->clearFocus();
    QWidget* refused = field;
    while (refused && !refuses<ParameterEditor>(refused) && !refuses<PoseEditor>(refused) &&
           !refuses<NameEditor>(refused) && !refuses<SettingsEditor>(refused))
        refused = refused->parentWidget();
    if (field) field->setFocus();
    if (auto* form = qobject_cast<SettingsEditor*>(refused))
        form->show_refused();  // it may be another of its fields
    else if (refused)
        bring_into_view(refused);
    return !refused;
}

}  // namespace seamwright
