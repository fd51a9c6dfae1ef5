#pragma once
// Another name for a thing of the project.

#include <QWidget>
#include <functional>
#include <string>

#include "core/error.h"

namespace seamwright {

// Asks beside the window and returns at once. `take` gets the name without blanks at its ends; what it refuses is said in the
// dialog, which stays with the name as it was typed.
void ask_name(QWidget* parent, const QString& title, const std::string& name,
              const std::function<Expected<void>(const std::string& name)>& take);

}  // namespace seamwright
