#pragma once
// Help > About: the program's version, and what it is built on.

#include <QWidget>

namespace seamwright {

void show_about(QWidget* parent);

}  // namespace seamwright
