#pragma once
// Theme and fonts of the whole program.

#include <QApplication>

namespace seamwright {

// Palette, style sheet and text size (11 pt or the system's, whichever is larger). Icons are made for the
// palette, so windows are built anew after a change.
void apply_look(QApplication& application, bool dark);

}  // namespace seamwright
