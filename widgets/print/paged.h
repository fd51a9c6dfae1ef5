#pragma once
// A text document on A4 pages: margins, title and page number at the foot of each.

#include <QSizeF>
#include <QString>
#include <filesystem>
#include <functional>

#include "core/error.h"

class QTextDocument;

namespace seamwright {

inline constexpr int kPrintedDpi = 300;

// `fill` writes into an empty document that knows its paper: lengths are pixels of kPrintedDpi, `page_px` is what one page
// holds. All or nothing, replaces an existing file. Works in a program without a screen: where there is no
// QGuiApplication yet, one of the platform "offscreen" is made that lives as long as the program. Call it on the
// program's first thread. Error: the file cannot be written.
Expected<void> write_paged(const std::filesystem::path& pdf, const QString& title,
                           const std::function<void(QTextDocument& document, QSizeF page_px)>& fill);

}  // namespace seamwright
