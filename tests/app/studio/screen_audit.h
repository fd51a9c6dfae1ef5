#pragma once
// What an inspector of screens looks for; each function answers one sentence a finding.

#include <QStringList>
#include <QWidget>

namespace seamwright::audit {

// Contrast of two opaque colours, 1 to 21 (WCAG 2.1, relative luminance of sRGB).
double contrast(const QColor& a, const QColor& b);

// Whatever takes mouse or keys and is visible now; scroll bars and Qt's own inner parts are left out.
QList<QWidget*> controls(const QWidget& window);

// Controls without accessible name or tooltip.
QStringList nameless(const QWidget& window);

// Presses Tab until it comes round; enabled controls that neither had the focus then, nor belong to a group
// whose member had it (arrow keys), nor show an action with a shortcut of its own.
QStringList unreachable(QWidget& window);

// Text that does not fit where it stands, tables and pages that would need scrolling sideways, axis labels
// longer than their axis, controls that cover each other or leave the window.
QStringList cut_off(QWidget& window);

// Words of less than 4.5 : 1, by the picture of the window (ground) and the palette of each widget (word),
// plus coloured words of tables and lists.
QStringList faint(QWidget& window);

// Labels whose colour means something and that hold no word.
QStringList colour_alone(const QWidget& window);

}  // namespace seamwright::audit
