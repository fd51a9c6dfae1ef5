#pragma once
// What the layers below refuse, as the person at the desk reads it: cause and cure in the language of the
// window where the list in errors.cpp has them (what a day at the desk meets: files, connecting, teaching,
// measuring, editing), in English where a device or a library speaks.

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
