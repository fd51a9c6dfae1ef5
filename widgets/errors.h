#pragma once
// What the layers below refuse, as the person at the desk reads it: place, cause and cure in the language of
// the window where the lists of error_texts.h have them (everything that a day at the desk meets), in English
// where a library or another maker's device speaks. Callable from every thread.

#include <QString>

#include "core/error.h"

namespace seamwright {

// "door.seam: the file does not exist; choose a .seam file", as Error::sentence() puts it.
QString shown_error(const Error& error);

// What did not happen, then why: "The project was not saved. door.seam: ..."
QString shown_error(const QString& frame, const Error& error);

// One part of an error ("the frame is of spot T1"): translated if it is in the list.
QString shown_cause(const std::string& english);

}  // namespace seamwright
