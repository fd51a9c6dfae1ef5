#pragma once
// The pictures of the manual: the program's own window on the demo project, at each step.

#include <QString>
#include <filesystem>

#include "core/error.h"

class QApplication;

namespace seamwright {

// Writes FOLDER/NAME.png for every picture that the pages of that language ask for. Half a minute: cell, robot and sensor
// are simulated, as in the demo project. Error: a page asks for a picture that there is not, the window does not get
// ready, a file cannot be written.
Expected<void> take_pictures(QApplication& application, const QString& language,
                             const std::filesystem::path& folder);

}  // namespace seamwright
