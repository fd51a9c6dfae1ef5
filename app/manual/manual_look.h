#pragma once
// How a page of the manual is set: on the screen and on paper alike.

#include <QPalette>
#include <QTextDocument>

namespace seamwright {

// Type sizes of headings, ruled tables with air in their cells, space between paragraphs. `em_pt`: of the running text.
// The text stays as it is.
void set_manual_look(QTextDocument& document, double em_pt, const QPalette& palette);

}  // namespace seamwright
