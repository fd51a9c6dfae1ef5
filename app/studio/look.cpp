#include "app/studio/look.h"

#include <QFont>
#include <QToolTip>

#include "widgets/style.h"

namespace seamwright {

void apply_look(QApplication& application, bool dark) {
    QApplication::setStyle("Fusion");
    const QPalette palette = dark ? style::dark_palette() : style::light_palette();
    QApplication::setPalette(palette);
    QToolTip::setPalette(palette);
    QFont font = application.font();
    if (font.pointSizeF() < style::kTextPt) font.setPointSizeF(style::kTextPt);
    application.setFont(font);
    const QString accent = style::selection(palette).name(), line = palette.color(QPalette::Mid).name(),
                  quiet = palette.color(QPalette::AlternateBase).name(),
                  button = palette.color(QPalette::Button).name();
    application.setStyleSheet(QStringLiteral(R"(
        QToolTip { border: 1px solid %2; padding: 4px; }
        QPushButton { min-height: 30px; padding: 0 10px; border: 1px solid %2; border-radius: 4px; background: %4; }
        QPushButton:hover { border-color: %1; }
        QPushButton:focus, QLineEdit:focus, QPlainTextEdit:focus, QToolButton:focus,
        QTableView:focus, QTreeView:focus, QListView:focus, QCheckBox:focus { border: 2px solid %1; }
        QPushButton#next_step { font-weight: bold; border: 2px solid %1; text-align: left; min-height: 40px; }
        QPushButton[next="true"] { font-weight: bold; border: 2px solid %1; }
        QPushButton#rail { text-align: left; border: none; background: transparent; padding: 0 6px; }
        QPushButton#rail:hover { background: %3; }
        QPushButton#rail:focus { border: 2px solid %1; }
        QPushButton#rail:checked { background: %3; border-left: 4px solid %1; font-weight: bold; }
        QLineEdit { min-height: 30px; border: 1px solid %2; border-radius: 3px; padding: 0 4px;
                    background: palette(base); }
        QComboBox, QAbstractSpinBox { min-height: 32px; }
        QPlainTextEdit, QTableView, QTreeView, QListView { border: 1px solid %2; background: palette(base); }
        QToolButton { min-width: 32px; min-height: 32px; }
        QTabBar::tab { min-height: 32px; padding: 0 12px; }
        QMenu::item { min-height: 30px; padding: 2px 24px 2px 12px; }
        QMenu::item:selected { background: palette(highlight); color: palette(highlighted-text); }
        QMenuBar::item { padding: 6px 10px; }
        QFrame#card { border: 1px solid %2; border-radius: 4px; background: %3; }
        QFrame#trouble { border: 2px solid %5; border-radius: 4px; background: palette(base); }
        QHeaderView::section { background: %3; border: none; border-bottom: 1px solid %2; padding: 4px 6px; }
        QStatusBar::item { border: none; }
        QMainWindow::separator { width: 6px; height: 6px; background: %2; }
    )")
                                  .arg(accent, line, quiet, button, style::alarm(palette).name()));
}

}  // namespace seamwright
