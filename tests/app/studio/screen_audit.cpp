#include "tests/app/studio/screen_audit.h"

#include <qcustomplot.h>

#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QAccessible>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenuBar>
#include <QPainter>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QStyleOptionComboBox>
#include <QTabBar>
#include <QTableView>
#include <QTest>
#include <QTextDocument>
#include <QToolButton>
#include <QTreeView>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace seamwright::audit {
namespace {

// "teach_page > add_spot "Add spot"": where to look.
QString place(const QWidget* w) {
    QString text = w->objectName().isEmpty() ? w->metaObject()->className() : w->objectName();
    if (auto* b = qobject_cast<const QAbstractButton*>(w)) text += " \"" + b->text() + "\"";
    if (auto* l = qobject_cast<const QLabel*>(w)) text += " \"" + l->text().left(60) + "\"";
    if (auto* c = qobject_cast<const QComboBox*>(w)) text += " \"" + c->accessibleName() + "\"";
    if (auto* e = qobject_cast<const QLineEdit*>(w)) text += " \"" + e->accessibleName() + "\"";
    for (const QWidget* up = w->parentWidget(); up; up = up->parentWidget())
        if (!up->objectName().isEmpty() && !up->objectName().startsWith("qt_"))
            return up->objectName() + " > " + text;
    return text;
}

bool inner_part(const QWidget* w) {
    return w->objectName().startsWith("qt_") || qobject_cast<const QScrollBar*>(w) ||
           qobject_cast<const QHeaderView*>(w) || w->inherits("QSplitterHandle") ||
           w->inherits("QTableCornerButton") || w->inherits("QComboBoxPrivateContainer") ||
           w->inherits("QComboBoxListView") || w->inherits("QDockWidgetTitleButton") ||
           (qobject_cast<const QLineEdit*>(w) && qobject_cast<const QAbstractSpinBox*>(w->parentWidget()));
}

const QScrollArea* page_of(const QWidget* w) {
    for (const QWidget* up = w->parentWidget(); up; up = up->parentWidget())
        if (auto* area = qobject_cast<const QScrollArea*>(up)) return area;
    return nullptr;
}

QRect on_window(const QWidget* w) {
    return {w->mapTo(w->window(), QPoint(0, 0)), w->size()};
}

// What a page is scrolled to counts as seen. Docks that stand behind others in a tab group are visible to Qt, and lie
// outside of the window, with the page in them.
bool on_screen(const QWidget* w) {
    if (!w->isVisible() || inner_part(w)) return false;
    if (const QScrollArea* page = page_of(w)) return on_screen(page);
    return w->window()->rect().intersects(on_window(w));
}

int longest_word(const QString& text, const QFontMetrics& font) {
    int most = 0;
    for (const QString& word : text.split(QRegularExpression("\\s+")))
        most = std::max(most, font.horizontalAdvance(word));
    return most;
}

int longest_line(const QString& text, const QFontMetrics& font) {
    int most = 0;
    for (const QString& line : text.split('\n')) most = std::max(most, font.horizontalAdvance(line));
    return most;
}

QString too_small(const QWidget* w, const QString& what, int needs, int has) {
    return QStringLiteral("%1: %2 needs %3 px and has %4").arg(place(w), what).arg(needs).arg(has);
}

void check_table(const QTableView& table, QStringList& found) {
    if (table.horizontalScrollBar()->maximum() > 0)
        found << too_small(&table, "the table", table.horizontalHeader()->length(),
                           table.viewport()->width());
    const QAbstractItemModel& model = *table.model();
    for (int c = 0; c < model.columnCount(); ++c) {
        if (table.isColumnHidden(c)) continue;
        const int has = table.columnWidth(c);
        if (table.horizontalHeader()->isVisible() && table.horizontalHeader()->sectionSizeHint(c) > has)
            found << too_small(&table, "heading " + model.headerData(c, Qt::Horizontal).toString(),
                               table.horizontalHeader()->sectionSizeHint(c), has);
        for (int r = 0; r < model.rowCount(); ++r) {
            const QString text = model.index(r, c).data().toString();
            if (text.isEmpty()) continue;
            QStyleOptionViewItem option;
            option.initFrom(&table);
            option.font = table.font();
            const int margin =
                2 * (table.style()->pixelMetric(QStyle::PM_FocusFrameHMargin, &option, &table) + 1);
            const QRect room(0, 0, has - margin, 10000);
            const QRect needs = table.fontMetrics().boundingRect(
                room, table.wordWrap() ? Qt::TextWordWrap : Qt::TextSingleLine, text);
            if (needs.width() > room.width())
                found << too_small(&table, "\"" + text.left(40) + "\"", needs.width(), room.width());
            if (needs.height() > table.rowHeight(r))
                found << too_small(&table, "the height of \"" + text.left(40) + "\"", needs.height(),
                                   table.rowHeight(r));
        }
    }
}

void check_text(QWidget* w, QStringList& found) {
    const QFontMetrics font = w->fontMetrics();
    if (auto* label = qobject_cast<QLabel*>(w)) {
        if (label->text().isEmpty()) return;
        const QRect room = label->contentsRect();
        if (label->wordWrap()) {
            if (const int needs = longest_word(label->text(), font); needs > room.width())
                found << too_small(w, "a word", needs, room.width());
            if (const int needs = label->heightForWidth(label->width()); needs > label->height())
                found << too_small(w, "the height", needs, label->height());
        } else {
            if (const int needs = longest_line(label->text(), font); needs > room.width())
                found << too_small(w, "the text", needs, room.width());
            if (const int needs = font.height() * static_cast<int>(label->text().count('\n') + 1);
                needs > label->height())
                found << too_small(w, "the height", needs, label->height());
        }
    } else if (auto* button = qobject_cast<QAbstractButton*>(w)) {
        if (button->text().isEmpty()) return;
        if (auto* tool = qobject_cast<QToolButton*>(w))
            if (tool->defaultAction() && tool->defaultAction()->priority() == QAction::LowPriority)
                return;  // an icon
        const int needs = longest_line(button->text(), font) + 12 +
                          (button->icon().isNull() ? 0 : button->iconSize().width() + 4);
        if (needs > button->width()) found << too_small(w, "the word", needs, button->width());
        if (font.height() * (button->text().count('\n') + 1) > button->height())
            found << too_small(w, "the height",
                               static_cast<int>(font.height() * (button->text().count('\n') + 1)),
                               button->height());
    } else if (auto* combo = qobject_cast<QComboBox*>(w)) {
        QStyleOptionComboBox option;
        option.initFrom(combo);
        option.subControls = QStyle::SC_All;
        const int has =
            combo->style()
                ->subControlRect(QStyle::CC_ComboBox, &option, QStyle::SC_ComboBoxEditField, combo)
                .width();
        for (int i = 0; i < combo->count(); ++i)
            if (const int needs = font.horizontalAdvance(combo->itemText(i)); needs > has)
                found << too_small(w, combo->itemText(i), needs, has);
    } else if (auto* line = qobject_cast<QLineEdit*>(w)) {
        const QString text = line->displayText().isEmpty() ? line->placeholderText() : line->displayText();
        QStyleOptionFrame option;
        option.initFrom(line);
        const int has = line->style()->subElementRect(QStyle::SE_LineEditContents, &option, line).width() - 4;
        // What a person names may be longer than any field; numbers may not.
        bool number = false;
        (void)QLocale().toDouble(text, &number);
        if (const int needs = font.horizontalAdvance(text);
            needs > has && (number || line->displayText().isEmpty()))
            found << too_small(w, "\"" + text + "\"", needs, has);
    } else if (auto* spin = qobject_cast<QAbstractSpinBox*>(w)) {
        auto* inside = spin->findChild<QLineEdit*>();
        if (const int needs = font.horizontalAdvance(spin->text()); inside && needs > inside->width())
            found << too_small(w, spin->text(), needs, inside->width());
    } else if (auto* bar = qobject_cast<QProgressBar*>(w)) {
        if (const int needs = font.horizontalAdvance(bar->text()); needs > bar->width())
            found << too_small(w, bar->text(), needs, bar->width());
    } else if (auto* tabs = qobject_cast<QTabBar*>(w)) {
        for (int i = 0; i < tabs->count(); ++i) {
            const QRect tab = tabs->tabRect(i);
            if (font.horizontalAdvance(tabs->tabText(i)) > tab.width() || !tabs->rect().contains(tab))
                found << too_small(w, "tab " + tabs->tabText(i), font.horizontalAdvance(tabs->tabText(i)),
                                   tab.width());
        }
    } else if (auto* table = qobject_cast<QTableView*>(w)) {
        check_table(*table, found);
    } else if (auto* tree = qobject_cast<QTreeView*>(w)) {
        if (tree->horizontalScrollBar()->maximum() > 0)
            found << too_small(w, "the tree", tree->header()->length(), tree->viewport()->width());
        for (int c = 0; c < tree->header()->count(); ++c)
            if (const int needs = static_cast<QAbstractItemView*>(tree)
                                      ->sizeHintForIndex(tree->model()->index(0, c))
                                      .width();
                needs > tree->columnWidth(c))
                found << too_small(w, "a column", needs, tree->columnWidth(c));
    } else if (auto* view = qobject_cast<QAbstractItemView*>(w)) {
        if (view->horizontalScrollBar()->maximum() > 0)
            found << too_small(w, "the list",
                               view->viewport()->width() + view->horizontalScrollBar()->maximum(),
                               view->viewport()->width());
    } else if (auto* edit = qobject_cast<QPlainTextEdit*>(w)) {
        if (edit->horizontalScrollBar()->maximum() > 0)
            found << too_small(w, "the text",
                               edit->viewport()->width() + edit->horizontalScrollBar()->maximum(),
                               edit->viewport()->width());
    } else if (auto* plot = qobject_cast<QCustomPlot*>(w)) {
        for (int i = 0; i < plot->axisRectCount(); ++i)
            for (QCPAxis* axis : plot->axisRect(i)->axes()) {
                if (!axis->visible()) continue;
                const bool level = QCPAxis::orientation(axis->axisType()) == Qt::Horizontal;
                const QSize room = plot->axisRect(i)->size();
                const int has = level ? plot->width() : room.height() + 12;
                if (const int needs = font.horizontalAdvance(axis->label()); needs > has)
                    found << too_small(w, "axis label " + axis->label(), needs, has);
            }
    }
}

// The window as shown, and each page in its whole length.
struct Picture {
    QImage image;
    QPoint origin;
};
Picture picture_of(QWidget* whole) {
    Picture p;
    const qreal ratio = whole->devicePixelRatioF();
    p.image = QImage((QSizeF(whole->size()) * ratio).toSize(), QImage::Format_RGB32);
    p.image.setDevicePixelRatio(ratio);
    p.image.fill(whole->palette().color(QPalette::Window));
    QPainter painter(&p.image);
    whole->render(&painter, {}, {}, QWidget::DrawWindowBackground | QWidget::DrawChildren);
    return p;
}

// Shades within a sixteenth of the scale count as one: a button's ground runs from one to the next, a line of pixels each.
QColor ground_of(const QImage& image, const QRect& part) {
    std::map<QRgb, std::map<QRgb, int>> shades;
    const qreal ratio = image.devicePixelRatio();
    const QRect box =
        QRectF(QPointF(part.topLeft()) * ratio, QSizeF(part.size()) * ratio).toRect() & image.rect();
    for (int y = box.top(); y <= box.bottom(); ++y)
        for (int x = box.left(); x <= box.right(); ++x) {
            const QRgb colour = image.pixel(x, y);
            ++shades[colour & 0xF0F0F0][colour];
        }
    QRgb most = 0;
    int times = 0;
    for (const auto& [about, colours] : shades) {
        int all = 0;
        const auto commonest = std::max_element(
            colours.begin(), colours.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        for (const auto& [colour, n] : colours) all += n;
        if (all > times) most = commonest->first, times = all;
    }
    return QColor::fromRgb(most);
}

// The drawn word may be thinner than its colour: what counts is the colour most unlike the ground.
double best_contrast(const QImage& image, const QRect& part, const QColor& ground) {
    std::set<QRgb> colours;
    const qreal ratio = image.devicePixelRatio();
    const QRect box =
        QRectF(QPointF(part.topLeft()) * ratio, QSizeF(part.size()) * ratio).toRect() & image.rect();
    for (int y = box.top(); y <= box.bottom(); ++y)
        for (int x = box.left(); x <= box.right(); ++x) colours.insert(image.pixel(x, y));
    double best = 1;
    for (const QRgb c : colours) best = std::max(best, contrast(QColor::fromRgb(c), ground));
    return best;
}

constexpr double kLegible = 4.5;

}  // namespace

double contrast(const QColor& a, const QColor& b) {
    const auto luminance = [](const QColor& c) {
        const auto linear = [](double v) {
            return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        };
        return 0.2126 * linear(c.redF()) + 0.7152 * linear(c.greenF()) + 0.0722 * linear(c.blueF());
    };
    const double x = luminance(a), y = luminance(b);
    return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

QList<QWidget*> controls(const QWidget& window) {
    QList<QWidget*> list;
    for (QWidget* w : window.findChildren<QWidget*>()) {
        if (w->window() != &window || !on_screen(w)) continue;
        const bool known = qobject_cast<QAbstractButton*>(w) || qobject_cast<QLineEdit*>(w) ||
                           qobject_cast<QComboBox*>(w) || qobject_cast<QAbstractSpinBox*>(w) ||
                           qobject_cast<QAbstractItemView*>(w) || qobject_cast<QPlainTextEdit*>(w) ||
                           qobject_cast<QTabBar*>(w) || qobject_cast<QAbstractSlider*>(w);
        const bool takes_focus = (w->focusPolicy() & Qt::ClickFocus) && !w->focusProxy();
        if (known || takes_focus) list << w;
    }
    return list;
}

QStringList nameless(const QWidget& window) {
    QStringList found;
    for (QWidget* w : controls(window)) {
        QAccessibleInterface* screen_reader = QAccessible::queryAccessibleInterface(w);
        if (qobject_cast<QTabBar*>(w)) continue;  // each tab bears its dock's name
        if (!screen_reader || screen_reader->text(QAccessible::Name).trimmed().isEmpty())
            found << place(w) + ": no accessible name";
        bool tip = !w->toolTip().isEmpty();
        for (const QWidget* up = w->parentWidget(); up && !tip; up = up->parentWidget())
            tip = up->focusProxy() == w && !up->toolTip().isEmpty();  // the view that this is the surface of
        if (!tip) found << place(w) + ": no tooltip";
    }
    return found;
}

QStringList unreachable(QWidget& window) {
    QApplication::setActiveWindow(&window);
    std::set<const QWidget*> reached;
    QStringList unseen;
    QWidget* first = nullptr;
    for (int i = 0; i < 500; ++i) {
        QWidget* at = window.focusWidget() ? window.focusWidget() : &window;
        QTest::keyClick(at, Qt::Key_Tab);
        QWidget* now = QApplication::focusWidget();
        if (!now) continue;  // what had the focus went away
        if (now == at) {
            unseen << place(now) + ": holds the focus against Tab";
            break;
        }
        if (now == first) break;
        if (!first) first = now;
        reached.insert(now);
        if (!on_screen(now) && !inner_part(now))
            unseen << place(now) + ": takes the focus where nobody sees it";
        for (const QWidget* up = now->parentWidget(); up; up = up->parentWidget())
            if (up->focusProxy() == now) reached.insert(up);
    }
    QStringList found = unseen;
    for (QWidget* w : controls(window)) {
        if (!w->isEnabled() || reached.count(w)) continue;
        if (auto* button = qobject_cast<QAbstractButton*>(w)) {
            bool by_arrows = false;
            if (button->autoExclusive() || button->group())
                for (auto* other : button->parentWidget()->findChildren<QAbstractButton*>())
                    by_arrows = by_arrows || (reached.count(other) && other->group() == button->group() &&
                                              other->autoExclusive() == button->autoExclusive());
            if (by_arrows) continue;
        }
        if (auto* tool = qobject_cast<QToolButton*>(w))
            if (tool->defaultAction() && !tool->defaultAction()->shortcut().isEmpty()) continue;
        if (w->inherits("QMainWindowTabBar")) {  // every dock has its own shortcut
            bool all = true;
            auto* tabs = qobject_cast<QTabBar*>(w);
            for (int i = 0; i < tabs->count(); ++i) {
                bool one = false;
                for (const QAction* a : window.actions())
                    one = one || (!a->shortcut().isEmpty() && a->text().contains(tabs->tabText(i)));
                all = all && one;
            }
            if (all) continue;
        }
        found << place(w) + ": not reached by Tab";
    }
    return found;
}

QStringList cut_off(QWidget& window) {
    QCoreApplication::sendPostedEvents(nullptr,
                                       QEvent::LayoutRequest);  // no news that would change what is looked at
    QStringList found;
    for (QWidget* w : window.findChildren<QWidget*>()) {
        if (w->window() != &window || !on_screen(w)) continue;
        check_text(w, found);
        if (auto* area = qobject_cast<QScrollArea*>(w); area && area->widget()) {
            if (area->widget()->width() > area->viewport()->width())
                found << too_small(w, "the page", area->widget()->width(), area->viewport()->width());
            continue;
        }
        // Within its parent, but for what scrolls.
        const QWidget* parent = w->parentWidget();
        if (!parent || parent->objectName().startsWith("qt_scrollarea") || w->isWindow()) continue;
        const bool scrolls =
            parent->parentWidget() && qobject_cast<const QAbstractScrollArea*>(parent->parentWidget());
        if (!scrolls && w->height() > 0 && !parent->rect().adjusted(-1, -1, 1, 1).contains(w->geometry()) &&
            !qobject_cast<const QTabBar*>(w) && !parent->inherits("QTabBar"))
            found << place(w) + ": leaves its place";
    }
    const QList<QWidget*> all = controls(window);
    for (int i = 0; i < all.size(); ++i)
        for (int k = i + 1; k < all.size(); ++k) {
            const QWidget *a = all[i], *b = all[k];
            if (a->isAncestorOf(b) || b->isAncestorOf(a) || page_of(a) != page_of(b)) continue;
            const QRect common = on_window(a) & on_window(b);
            if (common.width() > 1 && common.height() > 1) found << place(a) + ": covers " + place(b);
        }
    return found;
}

QStringList faint(QWidget& window) {
    QCoreApplication::sendPostedEvents();
    QStringList found;
    std::map<const QWidget*, Picture> pictures;
    const auto examine = [&](QWidget* w, const QRect& part, const QColor& word, const QString& text) {
        const QScrollArea* page = page_of(w);
        QWidget* whole = page ? page->widget() : &window;
        auto it = pictures.find(whole);
        if (it == pictures.end()) it = pictures.emplace(whole, picture_of(whole)).first;
        const QRect box(w->mapTo(whole, part.topLeft()), part.size());
        if (box.width() < 2 || box.height() < 2) return;
        const QColor ground = ground_of(it->second.image, box);
        const double by_palette = contrast(word, ground),
                     drawn = best_contrast(it->second.image, box, ground);
        if (std::min(by_palette, drawn) < kLegible)
            found << QStringLiteral("%1: \"%2\" %3 on %4 is %5 : 1, drawn %6 : 1")
                         .arg(place(w), text.left(30), word.name(), ground.name())
                         .arg(by_palette, 0, 'f', 2)
                         .arg(drawn, 0, 'f', 2);
    };
    for (QWidget* w : window.findChildren<QWidget*>()) {
        if (w->window() != &window || !on_screen(w)) continue;
        const QPalette p = w->palette();
        if (auto* label = qobject_cast<QLabel*>(w); label && !label->text().isEmpty())
            examine(w, label->contentsRect(), p.color(QPalette::WindowText), label->text());
        else if (auto* button = qobject_cast<QAbstractButton*>(w); button && !button->text().isEmpty())
            examine(w, button->rect().adjusted(3, 3, -3, -3),
                    p.color(qobject_cast<QCheckBox*>(w) ? QPalette::WindowText : QPalette::ButtonText),
                    button->text());
        else if (auto* line = qobject_cast<QLineEdit*>(w))
            examine(w, line->rect().adjusted(4, 4, -4, -4),
                    p.color(line->text().isEmpty() ? QPalette::PlaceholderText : QPalette::Text),
                    line->text().isEmpty() ? line->placeholderText() : line->text());
        else if (auto* combo = qobject_cast<QComboBox*>(w); combo && !combo->currentText().isEmpty())
            examine(w, combo->rect().adjusted(4, 4, -24, -4), p.color(QPalette::ButtonText),
                    combo->currentText());
        else if (auto* tabs = qobject_cast<QTabBar*>(w))
            for (int i = 0; i < tabs->count(); ++i)
                examine(w, tabs->tabRect(i).adjusted(3, 3, -3, -3), p.color(QPalette::WindowText),
                        tabs->tabText(i));
        else if (auto* view = qobject_cast<QAbstractItemView*>(w))
            for (int r = 0; r < view->model()->rowCount(); ++r)
                for (int c = 0; c < view->model()->columnCount(); ++c) {
                    const QModelIndex index = view->model()->index(r, c);
                    const QString text = index.data().toString();
                    const QRect box = view->visualRect(index) & view->viewport()->rect();
                    if (text.trimmed().isEmpty() || box.height() < 12 || box.width() < 8) continue;
                    const bool chosen = view->selectionModel()->isSelected(index);
                    QColor word = p.color(chosen ? QPalette::HighlightedText : QPalette::Text);
                    if (const auto own = index.data(Qt::ForegroundRole); own.isValid() && !chosen)
                        word = own.value<QBrush>().color();
                    examine(view->viewport(), box.adjusted(1, 1, -1, -1), word, text);
                }
    }
    return found;
}

QStringList colour_alone(const QWidget& window) {
    QStringList found;
    const QColor usual = window.palette().color(QPalette::WindowText);
    static const QRegularExpression kLetter("\\p{L}{2}");
    for (const QLabel* label : window.findChildren<QLabel*>()) {
        if (!on_screen(label) || label->palette().color(QPalette::WindowText) == usual) continue;
        if (!label->text().isEmpty() && !kLetter.match(label->text()).hasMatch())
            found << place(label) + ": a colour without a word";
    }
    return found;
}

}  // namespace seamwright::audit
