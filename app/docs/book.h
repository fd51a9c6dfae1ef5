#pragma once
// The manual as one page for the browser and as a PDF.

#include <QString>
#include <filesystem>

#include "core/error.h"

namespace seamwright {

// Both read the pictures from `pictures`/NAME.png; the HTML names them relative to itself. All or nothing each. Error: a
// picture is missing, a file cannot be written.
Expected<void> write_manual_html(const QString& language, const std::filesystem::path& pictures,
                                 const std::filesystem::path& html);
Expected<void> write_manual_pdf(const QString& language, const std::filesystem::path& pictures,
                                const std::filesystem::path& pdf);

}  // namespace seamwright
