#pragma once
// A report page as PDF: A4, text that can be searched, plots as vectors, page numbers.

#include <filesystem>

#include "core/error.h"
#include "projects/report/html.h"

namespace seamwright {

// All or nothing, replaces an existing file. Works in a program without a screen: where there is no
// QGuiApplication yet, one of the platform "offscreen" is made that lives as long as the program. Call it on
// the program's first thread. Error: the file cannot be written.
Expected<void> write_pdf(const report::Page& page, const std::filesystem::path& path);

}  // namespace seamwright
