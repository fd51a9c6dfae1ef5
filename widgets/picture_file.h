#pragma once
// Pictures of the screen as files.

#include <QImage>
#include <filesystem>

#include "core/error.h"

namespace seamwright {

// PNG, written as write_text_file() does. Error (file): the file cannot be written.
Expected<void> write_picture(const QImage& image, const std::filesystem::path& png);

}  // namespace seamwright
