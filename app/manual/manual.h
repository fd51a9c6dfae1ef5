#pragma once
// The manual's pages: Markdown in resources/manual/LANGUAGE/NAME.md, built into the program. On a page
//   *Measure*            is a name on the screen, spelled as there, "File > Open" a way through the menus,
//   (teach.md)           leads to another page,
//   (picture:teach)      is a picture of the window at that step; only the printed manual has it.
// Languages are "en" and "de"; of any other the English page is given.

#include <QString>
#include <QStringList>

#include "widgets/desk/steps.h"

namespace seamwright {

const QStringList& manual_pages();  // names, in the order in which they are read
QString manual_page_of(Step step);  // "teach"
// Where the page lies among the program's resources: "qrc:/manual/en/teach.md". Works before any window is there.
QString manual_address(const QString& page, const QString& language);
QString manual_text(const QString& page, const QString& language);  // empty: no such page
QString manual_title(const QString& page, const QString& language);
// Without its pictures: on the screen the window itself stands beside.
QString without_pictures(QString markdown);

}  // namespace seamwright
