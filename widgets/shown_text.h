#pragma once
// What the layers below say, in the language of the window. Callable from every thread.

#include <QString>
#include <string_view>

#include "core/error.h"

namespace seamwright {

// Of every window from now on; English until it is set.
void set_shown_language(Language language);

QString shown(const Text& text);

// "door.seam: the file does not exist; choose a .seam file", as Error::sentence() puts it.
QString shown_error(const Error& error);

// What did not happen, then why: "The project was not saved. door.seam: ..."
QString shown_error(const QString& frame, const Error& error);

}  // namespace seamwright
