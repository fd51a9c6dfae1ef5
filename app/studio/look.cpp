#include "app/studio/look.h"

#include <QFont>
#include <QPainter>
#include <QProxyStyle>
#include <QStyleFactory>
#include <QStyleOptionSpinBox>
#include <QToolTip>

#include "widgets/style.h"

namespace seamwright {
namespace {

// Fusion, with the steps of a number side by side and as high as the field: its own are too small for a
// glove; with boxes to tick in the colour of text: its own take the window's and are lost on a dark one; and
// with tabs so narrow that the names of all views stand side by side in the smallest window.
class DeskStyle final : public QProxyStyle {
  public:
    DeskStyle() : QProxyStyle(QStyleFactory::create("Fusion")) {}

    int pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const override {
        return metric == PM_TabBarTabHSpace ? kTabSpace_px : QProxyStyle::pixelMetric(metric, option, widget);
    }

    QRect subControlRect(ComplexControl control, const QStyleOptionComplex* option, SubControl part,
                         const QWidget* widget) const override {
        const auto* spin = qstyleoption_cast<const QStyleOptionSpinBox*>(option);
        if (control != CC_SpinBox || !spin || spin->buttonSymbols == QAbstractSpinBox::NoButtons)
            return QProxyStyle::subControlRect(control, option, part, widget);
        const QRect all = spin->rect.adjusted(1, 1, -1, -1);
        const auto from_right = [&](int number) {
            return QRect(all.right() + 1 - number * kStep_px, all.top(), kStep_px, all.height());
        };
        switch (part) {
            case SC_SpinBoxUp:
                return visualRect(spin->direction, spin->rect, from_right(1));
            case SC_SpinBoxDown:
                return visualRect(spin->direction, spin->rect, from_right(2));
            case SC_SpinBoxEditField:
                return visualRect(spin->direction, spin->rect, all.adjusted(2, 2, -2 * kStep_px - 2, -2));
            default:
                return QProxyStyle::subControlRect(control, option, part, widget);
        }
    }

    QSize sizeFromContents(ContentsType type, const QStyleOption* option, const QSize& size,
                           const QWidget* widget) const override {
        const auto* spin = qstyleoption_cast<const QStyleOptionSpinBox*>(option);
        if (type != CT_SpinBox || !spin || spin->buttonSymbols == QAbstractSpinBox::NoButtons)
            return QProxyStyle::sizeFromContents(type, option, size, widget);
        return size + QSize(2 * kStep_px + 6, 6);
    }

    void drawComplexControl(ComplexControl control, const QStyleOptionComplex* option, QPainter* painter,
                            const QWidget* widget) const override {
        const auto* spin = qstyleoption_cast<const QStyleOptionSpinBox*>(option);
        if (control != CC_SpinBox || !spin || spin->buttonSymbols == QAbstractSpinBox::NoButtons) {
            QProxyStyle::drawComplexControl(control, option, painter, widget);
            return;
        }
        QStyleOptionSpinBox frame = *spin;
        frame.buttonSymbols = QAbstractSpinBox::NoButtons;
        QProxyStyle::drawComplexControl(control, &frame, painter, widget);
        outline(*spin, *painter);
        draw_step(*spin, SC_SpinBoxDown, QAbstractSpinBox::StepDownEnabled, *painter, widget);
        draw_step(*spin, SC_SpinBoxUp, QAbstractSpinBox::StepUpEnabled, *painter, widget);
    }

    void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                       const QWidget* widget) const override {
        if (element != PE_IndicatorCheckBox && element != PE_IndicatorItemViewItemCheck)
            return QProxyStyle::drawPrimitive(element, option, painter, widget);
        const QPalette& palette = option->palette;
        const QColor ink = palette.color(
            option->state & State_Enabled ? QPalette::Active : QPalette::Disabled, QPalette::Text);
        const QRectF box = QRectF(option->rect).adjusted(1, 1, -1, -1);
        const auto at = [&](double x, double y) {
            return QPointF(box.left() + x * box.width(), box.top() + y * box.height());
        };
        painter->save();
        painter->setRenderHint(QPainter::Antialiasing);
        painter->setBrush(palette.base());
        painter->setPen(QPen(ink, option->state & State_MouseOver ? 2 : 1.2));
        painter->drawRoundedRect(box, 2, 2);
        painter->setPen(QPen(ink, 2));
        if (option->state & State_On)
            painter->drawPolyline(QPolygonF{at(0.2, 0.5), at(0.42, 0.75), at(0.8, 0.25)});
        else if (option->state & State_NoChange)
            painter->drawLine(at(0.25, 0.5), at(0.75, 0.5));
        painter->restore();
    }

  private:
    static constexpr int kStep_px = 26, kTabSpace_px = 16;

    // Fusion's own is darker than the window, and lost on a dark one.
    static void outline(const QStyleOptionSpinBox& spin, QPainter& painter) {
        const bool focus = spin.state & State_HasFocus;
        painter.save();
        painter.setRenderHint(QPainter::Antialiasing);
        painter.setBrush(Qt::NoBrush);
        painter.setPen(QPen(focus ? style::selection(spin.palette) : spin.palette.color(QPalette::Mid), 1));
        painter.drawRoundedRect(QRectF(spin.rect).adjusted(0.5, 0.5, -0.5, -0.5), 3, 3);
        painter.restore();
    }

    void draw_step(const QStyleOptionSpinBox& spin, SubControl part, QAbstractSpinBox::StepEnabledFlag step,
                   QPainter& painter, const QWidget* widget) const {
        const QRect rect = subControlRect(CC_SpinBox, &spin, part, widget);
        const bool usable = (spin.state & State_Enabled) && (spin.stepEnabled & step);
        const bool pointed_at = usable && (spin.activeSubControls & part);
        const QPalette& palette = spin.palette;
        painter.save();
        painter.fillRect(rect, pointed_at && (spin.state & State_Sunken) ? palette.mid()
                               : pointed_at                              ? palette.midlight()
                                                                         : palette.button());
        painter.setPen(palette.color(QPalette::Mid));
        painter.drawLine(rect.topLeft(), rect.bottomLeft());
        painter.setPen(
            QPen(palette.color(usable ? QPalette::Active : QPalette::Disabled, QPalette::ButtonText), 2));
        const QPoint middle = rect.center();
        painter.drawLine(middle - QPoint(5, 0), middle + QPoint(5, 0));
        if (part == SC_SpinBoxUp) painter.drawLine(middle - QPoint(0, 5), middle + QPoint(0, 5));
        painter.restore();
    }
};

}  // namespace

void apply_look(QApplication& application, bool dark) {
    QApplication::setStyle(new DeskStyle);  // owned by the application
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
        QPushButton#next_step[quiet="true"] { font-weight: normal; border: 1px solid %2; }
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
        QFrame#trouble[tone="plain"] { border: 2px solid %1; }
        QHeaderView::section { background: %3; border: none; border-bottom: 1px solid %2; padding: 4px 6px; }
        QStatusBar::item { border: none; }
        QMainWindow::separator { width: 6px; height: 6px; background: %2; }
    )")
                                  .arg(accent, line, quiet, button, style::alarm(palette).name()));
}

}  // namespace seamwright
