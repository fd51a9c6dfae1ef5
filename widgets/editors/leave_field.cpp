#include "widgets/editors/leave_field.h"

#include <QApplication>
#include <QPointer>

#include "widgets/editors/name_editor.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/editors/settings_editor.h"

namespace seamwright {
namespace {

template <class Editor>
bool refuses(const QWidget* widget) {
    const auto* editor = qobject_cast<const Editor*>(widget);
    return editor && editor->refused();
}

}  // namespace

bool leave_field(QWidget& whole) {
    const QPointer<QWidget> field = QApplication::focusWidget();
    if (!field || !whole.isAncestorOf(field)) return true;
    field->clearFocus();
    bool refused = false;
    for (const QWidget* up = field; up && !refused; up = up->parentWidget())
        refused = refuses<ParameterEditor>(up) || refuses<PoseEditor>(up) || refuses<NameEditor>(up) ||
                  refuses<SettingsEditor>(up);
    if (field) field->setFocus();
    return !refused;
}

}  // namespace seamwright
