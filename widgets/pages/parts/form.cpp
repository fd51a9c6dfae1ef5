#include "widgets/pages/parts/form.h"

#include <QFile>
#include <QHeaderView>
#include <QPainter>
#include <QStyledItemDelegate>
#include <QSvgRenderer>
#include <QTimer>
#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "widgets/flow_layout.h"
#include "widgets/style.h"

namespace seamwright {

QIcon icon(const QString& name, const QPalette& palette) {
    QFile file(":/icons/" + name + ".svg");
    if (!file.open(QIODevice::ReadOnly)) return {};
    const QByteArray drawing = file.readAll();
    QIcon made;
    const auto add = [&](const QColor& colour, QIcon::Mode mode) {
        QByteArray coloured = drawing;
        coloured.replace("currentColor", colour.name().toLatin1());
        QSvgRenderer renderer(coloured);
        for (const int size : {20, 40}) {
            QPixmap pixmap(size, size);
            pixmap.fill(Qt::transparent);
            QPainter painter(&pixmap);
            renderer.render(&painter);
            painter.end();
            made.addPixmap(pixmap, mode);
        }
    };
    add(palette.color(QPalette::WindowText), QIcon::Normal);
    add(palette.color(QPalette::Disabled, QPalette::WindowText), QIcon::Disabled);
    return made;
}

QPushButton* make_button(const QString& name, const QString& icon_name, const QString& text,
                         const QString& tip, const std::function<void()>& clicked) {
    auto* button = new QPushButton(text);
    button->setObjectName(name);
    button->setToolTip(tip);
    button->setAccessibleName(text.isEmpty() ? tip : text);
    button->setMinimumHeight(style::kTargetPx);
    if (!icon_name.isEmpty()) {
        button->setIcon(icon(icon_name, button->palette()));
        button->setProperty("icon_name", icon_name);
    }
    QObject::connect(button, &QPushButton::clicked, button, clicked);
    return button;
}

QLabel* make_heading(const QString& text) {
    auto* label = new QLabel(text);
    QFont font = label->font();
    font.setBold(true);
    label->setFont(font);
    label->setContentsMargins(0, 8, 0, 0);
    label->setWordWrap(true);
    return label;
}

QLabel* make_text(const QString& text) {
    auto* label = new QLabel(text);
    label->setWordWrap(true);
    label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    label->setFocusPolicy(Qt::NoFocus);
    label->setMinimumWidth(100);
    return label;
}

Tone tone_of(Verdict verdict) {
    return verdict == Verdict::good ? Tone::good : verdict == Verdict::usable ? Tone::attention : Tone::alarm;
}

void set_verdict(QLabel& label, const QString& text, Tone tone) {
    label.setText(text);
    QFont font = label.font();
    font.setBold(tone != Tone::plain);
    label.setFont(font);
    const QPalette p = label.parentWidget() ? label.parentWidget()->palette() : QPalette();
    QPalette mine = label.palette();
    mine.setColor(QPalette::WindowText, tone == Tone::good        ? style::good(p)
                                        : tone == Tone::attention ? style::attention(p)
                                        : tone == Tone::alarm     ? style::alarm(p)
                                                                  : style::text(p));
    label.setPalette(mine);
}

QLayout* make_row(std::initializer_list<QWidget*> widgets) {
    auto* row = new FlowLayout;
    for (QWidget* w : widgets) row->addWidget(w);
    return row;
}

void add_field(QVBoxLayout& layout, const QString& label, QWidget* field, const QString& tip) {
    auto* row = new QHBoxLayout;
    auto* name = new QLabel(label);
    name->setBuddy(field);
    name->setFixedWidth(130);
    name->setWordWrap(true);
    row->addWidget(name);
    row->addWidget(field, 1);
    field->setToolTip(tip);
    field->setAccessibleName(label);
    field->setMinimumHeight(style::kTargetPx);
    layout.addLayout(row);
}

// Long tables hold short lines; measuring each row would cost more than it gives.
static void fit_rows(QTableWidget& table) {
    constexpr int kMeasured = 300;
    if (table.rowCount() <= kMeasured) table.resizeRowsToContents();
}

QTableWidget* make_table(const QString& name, const QStringList& header, const QString& tip) {
    auto* table = new QTableWidget(0, static_cast<int>(header.size()));
    table->setObjectName(name);
    table->setHorizontalHeaderLabels(header);
    table->setToolTip(tip);
    table->setAccessibleName(tip);
    table->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table->setSelectionBehavior(QAbstractItemView::SelectRows);
    table->setSelectionMode(QAbstractItemView::SingleSelection);
    table->setTabKeyNavigation(false);
    table->setAlternatingRowColors(true);
    table->setShowGrid(false);
    table->verticalHeader()->hide();
    table->verticalHeader()->setDefaultSectionSize(style::kTargetPx);
    table->verticalHeader()->setMinimumSectionSize(style::kTargetPx);
    // The last column takes what is left, and wraps.
    table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    table->horizontalHeader()->setSectionResizeMode(table->columnCount() - 1, QHeaderView::Stretch);
    // Once all columns have their new widths.
    auto* fit = new QTimer(table);
    fit->setSingleShot(true);
    fit->setInterval(0);
    QObject::connect(fit, &QTimer::timeout, table, [table] { fit_rows(*table); });
    QObject::connect(table->horizontalHeader(), &QHeaderView::sectionResized, fit,
                     qOverload<>(&QTimer::start));
    table->horizontalHeader()->setHighlightSections(false);
    return table;
}

void elide_first_column(QTableWidget& table, int most_px) {
    class Elided : public QStyledItemDelegate {
      public:
        Elided(QObject* parent, int most) : QStyledItemDelegate(parent), most_px_(most) {}
        QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override {
            const QSize whole = QStyledItemDelegate::sizeHint(option, index);
            return {std::min(whole.width(), most_px_), whole.height()};
        }

      protected:
        void initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const override {
            QStyledItemDelegate::initStyleOption(option, index);
            option->features &= ~QStyleOptionViewItem::WrapText;
        }

      private:
        int most_px_;
    };
    table.setItemDelegateForColumn(0, new Elided(&table, most_px));
}

void set_rows(QTableWidget& table, const QVector<QStringList>& rows) {
    const QSignalBlocker quiet(table);
    const int current = table.currentRow();
    table.setRowCount(static_cast<int>(rows.size()));
    for (int r = 0; r < rows.size(); ++r)
        for (int c = 0; c < table.columnCount() && c < rows[r].size(); ++c) {
            auto* item = new QTableWidgetItem(rows[r][c]);
            item->setTextAlignment(c == 0 ? Qt::AlignLeft | Qt::AlignVCenter
                                          : Qt::AlignRight | Qt::AlignVCenter);
            item->setToolTip(rows[r][c]);
            table.setItem(r, c, item);
        }
    if (current >= 0 && current < rows.size()) table.setCurrentCell(current, 0);
    fit_rows(table);
}

QString number(double value, int decimals) {
    if (!std::isfinite(value)) return QStringLiteral("-");
    return QString::number(value, 'f', decimals);
}

std::array<double, 6> six(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    return {pose.translation().x(),
            pose.translation().y(),
            pose.translation().z(),
            abc.a_deg,
            abc.b_deg,
            abc.c_deg};
}

QString frame_text(const std::optional<Pose>& pose, const QString& between) {
    if (!pose) return QStringLiteral("-");
    const auto v = six(*pose);
    QStringList place, turn;
    for (std::size_t i = 0; i < 3; ++i) place << number(v[i], 2), turn << number(v[i + 3], 3);
    return place.join("  ") + between + turn.join("  ");
}

}  // namespace seamwright
