#include "widgets/editors/parameter_editor.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {

struct ParameterEditor::Impl {
    QLabel* label = nullptr;
    ParameterInfo info;
    double value = 0;
    QLineEdit* line = nullptr;
    QComboBox* choice = nullptr;
    QLabel* problem = nullptr;
    QString reason;
    std::string of;  // what the value belongs to
};

namespace {

constexpr int kLabelSigns = 22;

QStringList units_of(const ParameterInfo& info) {
    QStringList units{QString::fromStdString(info.unit), shown_word(info.unit)};
    if (info.unit == "deg") units << QStringLiteral("°");
    return units;
}

QString range_text(const ParameterInfo& info) {
    return ParameterEditor::tr("%1 to %2 %3")
        .arg(text_from_number(info.minimum, info.decimals), text_from_number(info.maximum, info.decimals),
             shown_word(info.unit))
        .trimmed();
}

}  // namespace

ParameterEditor::ParameterEditor(const ParameterInfo& info, QWidget* parent)
    : QWidget(parent), impl_(std::make_unique<Impl>()) {
    impl_->info = info;
    impl_->value = info.default_value;
    const QString name = shown_word(info.name);
    const QString help = shown(Text::chosen(info.help));
    setAccessibleName(name);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(2);
    auto* row = new QHBoxLayout;
    row->setSpacing(6);
    column->addLayout(row);
    auto* label = impl_->label = new QLabel(name, this);
    label->setWordWrap(true);
    label->setFixedWidth(fontMetrics().averageCharWidth() * kLabelSigns);
    label->setToolTip(help);
    row->addWidget(label);
    if (!info.choices.empty()) {
        impl_->choice = new QComboBox(this);
        for (const std::string& one : info.choices) impl_->choice->addItem(shown_word(one));
        label->setBuddy(impl_->choice);
        impl_->choice->setMinimumHeight(style::kTargetPx);
        impl_->choice->setAccessibleName(name);
        impl_->choice->setAccessibleDescription(help);
        impl_->choice->setToolTip(help);
        setFocusProxy(impl_->choice);
        row->addWidget(impl_->choice, 1);
        connect(impl_->choice, &QComboBox::currentIndexChanged, this, [this](int index) {
            if (index < 0 || index == std::lround(impl_->value)) return;
            impl_->value = index;
            emit committed(impl_->value);
        });
    } else {
        impl_->line = new QLineEdit(this);
        impl_->line->setMinimumHeight(style::kTargetPx);
        impl_->line->setAlignment(Qt::AlignRight);
        label->setBuddy(impl_->line);
        impl_->line->setAccessibleName(name);
        impl_->line->setAccessibleDescription(help + " " + range_text(info));
        impl_->line->setToolTip(help + "\n" + range_text(info));
        impl_->line->installEventFilter(this);
        setFocusProxy(impl_->line);
        row->addWidget(impl_->line, 1);
        auto* unit = new QLabel(shown_word(info.unit), this);
        unit->setMinimumWidth(fontMetrics().averageCharWidth() * 5);
        row->addWidget(unit);
        impl_->problem = new QLabel(this);
        impl_->problem->setWordWrap(true);
        impl_->problem->setAccessibleName(tr("Why the value is refused"));
        impl_->problem->hide();
        column->addWidget(impl_->problem);
    }
    setToolTip(help);
    set_value(info.default_value);
}

ParameterEditor::~ParameterEditor() = default;

void ParameterEditor::set_name(const QString& name) {
    impl_->label->setText(name);
    setAccessibleName(name);
    if (impl_->line) impl_->line->setAccessibleName(name);
    if (impl_->choice) impl_->choice->setAccessibleName(name);
}

const ParameterInfo& ParameterEditor::info() const {
    return impl_->info;
}
double ParameterEditor::value() const {
    return impl_->value;
}
bool ParameterEditor::refused() const {
    return !impl_->reason.isEmpty();
}
QString ParameterEditor::reason() const {
    return impl_->reason;
}

void ParameterEditor::set_value(double value) {
    const ParameterInfo& info = impl_->info;
    if (!std::isfinite(value)) value = info.default_value;
    impl_->value = std::clamp(value, info.minimum, info.maximum);
    impl_->reason.clear();
    if (impl_->choice) {
        const QSignalBlocker quiet(impl_->choice);
        impl_->value = std::round(impl_->value);
        impl_->choice->setCurrentIndex(static_cast<int>(impl_->value));
        return;
    }
    // What is marked stays marked where the number is the same.
    const QString text = text_from_number(impl_->value, info.decimals);
    if (impl_->line->text() != text) impl_->line->setText(text);
    impl_->line->setModified(false);
    impl_->problem->hide();
}

void ParameterEditor::refresh(double value, const std::string& of) {
    const bool typing = impl_->line && impl_->line->isModified() && impl_->of == of;
    impl_->of = of;
    if (!typing) return set_value(value);
    if (!std::isfinite(value)) value = impl_->info.default_value;
    impl_->value = std::clamp(value, impl_->info.minimum, impl_->info.maximum);
}

bool ParameterEditor::eventFilter(QObject* watched, QEvent* event) {
    if (!impl_->line || watched != impl_->line) return QWidget::eventFilter(watched, event);
    const ParameterInfo& info = impl_->info;
    const auto commit = [this, &info] {
        // What was not touched keeps its full precision.
        if (!impl_->line->isModified()) return;
        const QString typed = impl_->line->text().trimmed();
        const auto number = number_from_text(typed, units_of(info));
        if (!number)
            impl_->reason =
                unit_behind_number(typed).isEmpty() || info.unit.empty()
                    ? tr("\"%1\" is not a number; give %2").arg(typed.left(kTypedSigns), range_text(info))
                    : tr("\"%1\" has another unit; give %2").arg(typed.left(kTypedSigns), range_text(info));
        else if (*number < info.minimum || *number > info.maximum)
            impl_->reason = tr("outside %1").arg(range_text(info));
        else
            impl_->reason.clear();
        if (!impl_->reason.isEmpty()) {
            impl_->problem->setText(tr("refused: %1").arg(impl_->reason));
            QPalette red = impl_->problem->palette();
            red.setColor(QPalette::WindowText, style::alarm(palette()));
            impl_->problem->setPalette(red);
            impl_->problem->show();
            return;
        }
        const bool changed = *number != impl_->value;
        set_value(*number);
        if (changed) emit committed(impl_->value);
    };
    if (event->type() == QEvent::FocusOut) {
        commit();
    } else if (event->type() == QEvent::KeyPress) {
        const int key = static_cast<QKeyEvent*>(event)->key();
        if (key == Qt::Key_Return || key == Qt::Key_Enter) {
            commit();
            impl_->line->selectAll();
            return true;
        }
        if (key == Qt::Key_Escape && (impl_->line->isModified() || refused())) {
            set_value(impl_->value);
            return true;
        }
        if (key == Qt::Key_Up || key == Qt::Key_Down) {
            const double step = std::pow(10.0, 1 - info.decimals) * (key == Qt::Key_Up ? 1 : -1);
            const double from = number_from_text(impl_->line->text()).value_or(impl_->value);
            impl_->line->setText(
                text_from_number(std::clamp(from + step, info.minimum, info.maximum), info.decimals));
            impl_->line->setModified(true);
            commit();
            return true;
        }
    }
    return QWidget::eventFilter(watched, event);
}

}  // namespace seamwright
