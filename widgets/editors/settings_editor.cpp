#include "widgets/editors/settings_editor.h"

#include <QCheckBox>
#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <cmath>

#include "devices/exchange/json_fields.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/into_view.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

constexpr std::size_t kAlwaysShown = 4;
constexpr int kSettingSigns = 22, kIndent_px = 14;

// As a field shows it; empty for what is absent.
QString text_of(const json& value) {
    if (value.is_null()) return {};
    constexpr std::size_t kSigns = 10;  // that a field has room for; what is not edited keeps all its digits
    if (value.is_number_float() && value.dump().size() > kSigns)
        return QString::number(value.get<double>(), 'g', 6);
    return QString::fromStdString(value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace

struct SettingsEditor::Row {
    SettingInfo info;
    Pointer at;
    bool essential = false;
    QWidget* line = nullptr;  // with its label and its reason
    QLineEdit* text = nullptr;
    QComboBox* choice = nullptr;
    QCheckBox* yes_no = nullptr;
    PoseEditor* pose = nullptr;
    QLabel* problem = nullptr;
    QString reason;
};

struct SettingsEditor::Impl {
    using Row = SettingsEditor::Row;

    QVBoxLayout* box = nullptr;
    QLabel* help = nullptr;
    QPushButton* all = nullptr;
    std::vector<std::unique_ptr<Row>> rows;
    std::vector<std::pair<QLabel*, Pointer>> headings;
    SettingTable table;
    json settings = json::object();

    const json* found(const Pointer& at) const { return settings.contains(at) ? &settings.at(at) : nullptr; }
    // Older names become the present ones, in every object that the table describes.
    static json renamed(const json& settings, const SettingTable& table) {
        const SettingsReader reader(settings, {}, table, UnknownSettings::passed_over);
        json out = settings.is_object() ? reader.json() : json::object();
        for (const SettingInfo& s : table)
            if (!s.fields.empty() && out.contains(s.name) && out[s.name].is_object())
                out[s.name] = renamed(out[s.name], s.fields);
        return out;
    }
    void write(const Pointer& at, const json& value) {
        if (!value.is_null()) {
            settings[at] = value;
            return;
        }
        if (!settings.contains(at)) return;
        settings.at(at.parent_pointer()).erase(at.back());
        // An object that held nothing else goes too.
        for (Pointer up = at.parent_pointer(); !up.empty() && settings.at(up).empty();
             up = up.parent_pointer())
            settings.at(up.parent_pointer()).erase(up.back());
    }
    void show_rows(const Row* focused = nullptr) {
        const bool everything = all->isChecked();
        bool hidden = false;
        for (const auto& row : rows) {
            const bool shown = everything || row->essential || found(row->at) || !row->reason.isEmpty() ||
                               row.get() == focused;
            row->line->setVisible(shown);
            hidden = hidden || !shown;
        }
        for (const auto& [label, at] : headings)
            label->setVisible(std::any_of(rows.begin(), rows.end(), [&, &of = at](const auto& row) {
                return row->at.parent_pointer() == of && !row->line->isHidden();
            }));
        all->setVisible(hidden || everything);
    }
    void refuse(Row& row, const QString& why, const QPalette& palette) const {
        row.reason = why;
        row.problem->setVisible(!why.isEmpty());
        if (why.isEmpty()) return;
        row.problem->setText(SettingsEditor::tr("refused: %1").arg(why));
        QPalette red = row.problem->palette();
        red.setColor(QPalette::WindowText, style::alarm(palette));
        row.problem->setPalette(red);
    }
    // What the field holds, or why it is refused.
    static json typed(const Row& row, QString& why) {
        const QString text = row.text->text().trimmed();
        if (text.isEmpty()) return nullptr;
        const SettingInfo& s = row.info;
        switch (s.kind) {
            case SettingKind::number:
            case SettingKind::whole: {
                const auto number = number_from_text(text);
                if (!number) {
                    why = SettingsEditor::tr("\"%1\" is not a number; give %2 to %3")
                              .arg(text.left(kTypedSigns))
                              .arg(s.low)
                              .arg(s.high);
                } else if (*number < s.low || *number > s.high) {
                    why = SettingsEditor::tr("outside %1 to %2").arg(s.low).arg(s.high);
                } else if (s.kind == SettingKind::whole && *number != std::floor(*number)) {
                    why = SettingsEditor::tr("not a whole number");
                } else {
                    return s.kind == SettingKind::whole ? json(static_cast<std::int64_t>(*number))
                                                        : json(*number);
                }
                return nullptr;
            }
            case SettingKind::list:
            case SettingKind::object: {
                auto value = parse_json(text.toStdString(), {});
                if (!value)
                    why = shown_error(value.error());
                else if (s.kind == SettingKind::list ? !value->is_array() : !value->is_object())
                    why = s.kind == SettingKind::list ? SettingsEditor::tr("not a list: [1, 2]")
                                                      : SettingsEditor::tr("not an object: {\"name\": 1}");
                return why.isEmpty() ? *value : json();
            }
            default:
                return text.toStdString();
        }
    }
    void show_value(Row& row) const {
        const json* value = found(row.at);
        row.reason.clear();
        row.problem->hide();
        if (row.text) {
            row.text->setText(value ? text_of(*value) : QString());
            row.text->setCursorPosition(0);  // the beginning of what is longer than the field
            row.text->setModified(false);
        } else if (row.choice) {
            const QSignalBlocker quiet(row.choice);
            const json& now = value ? *value : row.info.otherwise;
            int index = now.is_string() ? row.choice->findData(text_of(now)) : -1;
            row.choice->setCurrentIndex(index);
        } else if (row.yes_no) {
            const QSignalBlocker quiet(row.yes_no);
            const json& now = value ? *value : row.info.otherwise;
            row.yes_no->setChecked(now.is_boolean() && now.get<bool>());
        } else if (row.pose) {
            const auto pose = value ? parse_pose(*value, {}) : Expected<Pose>(Pose::Identity());
            row.pose->set_pose(pose.value_or(Pose::Identity()));
        }
    }
    static QString help_of(const SettingInfo& s) {
        QString text = shown(Text::chosen(s.help));
        if (s.kind == SettingKind::number || s.kind == SettingKind::whole)
            text += SettingsEditor::tr("; %1 to %2").arg(s.low).arg(s.high);
        if (!s.otherwise.is_null() && s.otherwise != json(""))
            text += SettingsEditor::tr("; %1 if left empty").arg(text_of(s.otherwise));
        return text;
    }
};

SettingsEditor::SettingsEditor(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    impl_->box = new QVBoxLayout;
    impl_->box->setSpacing(4);
    column->addLayout(impl_->box);
    impl_->help = new QLabel(this);
    impl_->help->setWordWrap(true);
    impl_->help->setObjectName("setting_help");
    impl_->help->setMinimumHeight(2 * fontMetrics().lineSpacing());
    impl_->help->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    column->addWidget(impl_->help);
    impl_->all = new QPushButton(tr("All settings of the driver"), this);
    impl_->all->setObjectName("all_settings");
    impl_->all->setToolTip(tr("Also what is left as the driver has it"));
    impl_->all->setCheckable(true);
    impl_->all->setMinimumHeight(style::kTargetPx);
    column->addWidget(impl_->all);
    connect(impl_->all, &QPushButton::toggled, this, [this] { impl_->show_rows(); });
    impl_->show_rows();
}

SettingsEditor::~SettingsEditor() = default;

const json& SettingsEditor::value() const {
    return impl_->settings;
}

bool SettingsEditor::refused() const {
    return std::any_of(impl_->rows.begin(), impl_->rows.end(),
                       [](const auto& row) { return !row->reason.isEmpty(); });
}

void SettingsEditor::show_refused() {
    const auto row =
        std::ranges::find_if(impl_->rows, [](const auto& one) { return !one->reason.isEmpty(); });
    if (row == impl_->rows.end()) return;
    // Only what is typed is refused here.
    (*row)->text->setFocus(Qt::OtherFocusReason);
    bring_into_view((*row)->line);
}

void SettingsEditor::show_all(bool all) {
    impl_->all->setChecked(all);
}

void SettingsEditor::set_value(const json& settings) {
    impl_->settings = Impl::renamed(settings, impl_->table);
    for (const auto& row : impl_->rows) impl_->show_value(*row);
    impl_->show_rows();
}

QLabel* SettingsEditor::heading_for(const SettingInfo& s, int depth) {
    auto* heading = new QLabel(shown_setting(s.name).name, this);
    heading->setToolTip(Impl::help_of(s));
    heading->setContentsMargins(depth * kIndent_px, 6, 0, 0);
    QFont bold = heading->font();
    bold.setBold(true);
    heading->setFont(bold);
    return heading;
}

// The editor of a row's kind; what is written with it goes into the settings.
QWidget* SettingsEditor::editor_of(Row* r) {
    const SettingInfo& s = r->info;
    QWidget* editor = nullptr;
    const auto wrote = [this, r](const json& value) {
        impl_->write(r->at, value);
        impl_->show_rows(r);
        emit edited();
    };
    if (s.kind == SettingKind::choice) {
        editor = r->choice = new QComboBox(r->line);
        for (const std::string& one : s.choices)
            r->choice->addItem(shown_word(one), QString::fromStdString(one));
        connect(r->choice, &QComboBox::activated, this,
                [r, wrote](int index) { wrote(r->choice->itemData(index).toString().toStdString()); });
    } else if (s.kind == SettingKind::yes_no) {
        editor = r->yes_no = new QCheckBox(tr("yes"), r->line);
        connect(r->yes_no, &QCheckBox::clicked, this, [wrote](bool yes) { wrote(yes); });
    } else if (s.kind == SettingKind::pose) {
        editor = r->pose = new PoseEditor(r->line);
        connect(r->pose, &PoseEditor::committed, this, [r, wrote] { wrote(pose_json(r->pose->pose())); });
    } else {
        editor = r->text = new QLineEdit(r->line);
        if (s.kind == SettingKind::number || s.kind == SettingKind::whole)
            r->text->setAlignment(Qt::AlignRight);
        const QString absent = text_of(s.otherwise);
        r->text->setPlaceholderText(absent.isEmpty() ? QStringLiteral("–") : absent);
        connect(r->text, &QLineEdit::editingFinished, this, [this, r, wrote] {
            if (!r->text->isModified()) return;
            r->text->setModified(false);
            QString why;
            const json value = Impl::typed(*r, why);
            impl_->refuse(*r, why, palette());
            if (why.isEmpty())
                wrote(value);
            else
                emit edited();
        });
    }
    return editor;
}

void SettingsEditor::add_row(const SettingInfo& s, const nlohmann::json::json_pointer& at, int depth,
                             bool essential) {
    auto row = std::make_unique<Row>();
    row->info = s;
    row->at = at;
    row->essential = essential;
    row->line = new QWidget(this);
    auto* lines = new QVBoxLayout(row->line);
    lines->setContentsMargins(depth * kIndent_px, 0, 0, 0);
    lines->setSpacing(2);
    auto* across = new QHBoxLayout;
    across->setSpacing(6);
    lines->addLayout(across);
    const ShownSetting name = shown_setting(s.name);
    const QString help = Impl::help_of(s);
    auto* label = new QLabel(name.name, row->line);
    label->setWordWrap(true);
    label->setFixedWidth(fontMetrics().averageCharWidth() * kSettingSigns - depth * kIndent_px);
    QWidget* editor = editor_of(row.get());
    editor->setObjectName("setting" + QString::fromStdString(at.to_string()).replace('/', '_'));
    editor->setMinimumHeight(style::kTargetPx);
    editor->setAccessibleName(name.unit.isEmpty() ? name.name : name.name + ", " + name.unit);
    editor->setAccessibleDescription(help);
    editor->setToolTip(help);
    editor->installEventFilter(this);
    label->setBuddy(editor);
    label->setToolTip(help);
    if (row->pose) {
        lines->addWidget(editor);
        across->addWidget(label);
        across->addStretch(1);
    } else {
        across->addWidget(label);
        across->addWidget(editor, 1);
        auto* unit = new QLabel(name.unit, row->line);
        unit->setMinimumWidth(fontMetrics().averageCharWidth() * 5);
        across->addWidget(unit);
    }
    row->problem = new QLabel(row->line);
    row->problem->setWordWrap(true);
    row->problem->setAccessibleName(tr("Why the value is refused"));
    row->problem->hide();
    lines->addWidget(row->problem);
    impl_->box->addWidget(row->line);
    impl_->rows.push_back(std::move(row));
}

void SettingsEditor::add_rows(const SettingTable& fields, const nlohmann::json::json_pointer& under,
                              int depth) {
    std::size_t n = 0;
    for (const SettingInfo& s : fields) {
        const Pointer at = under / s.name;
        if (s.kind == SettingKind::object && !s.fields.empty()) {
            auto* heading = heading_for(s, depth);
            impl_->box->addWidget(heading);
            impl_->headings.emplace_back(heading, at);
            add_rows(s.fields, at, depth + 1);
            continue;
        }
        const bool named =
            s.kind == SettingKind::text || s.kind == SettingKind::number || s.kind == SettingKind::whole;
        add_row(s, at, depth, depth == 0 && (n++ < kAlwaysShown || (s.otherwise.is_null() && named)));
    }
}

void SettingsEditor::set_table(const SettingTable& table) {
    impl_->table = table;
    impl_->settings = json::object();
    impl_->rows.clear();
    impl_->headings.clear();
    while (QLayoutItem* item = impl_->box->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    impl_->help->clear();
    add_rows(table, Pointer(), 0);
    for (const auto& row : impl_->rows) impl_->show_value(*row);
    impl_->show_rows();
}

bool SettingsEditor::eventFilter(QObject* watched, QEvent* event) {
    auto* widget = qobject_cast<QWidget*>(watched);
    if (event->type() == QEvent::FocusIn && widget)
        impl_->help->setText(widget->accessibleName() + ": " + widget->accessibleDescription());
    // What holds comes back; where it stands there already, the key is for the page.
    if (event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape)
        for (const auto& row : impl_->rows)
            if (row->text && row->text == watched && (row->text->isModified() || !row->reason.isEmpty())) {
                impl_->show_value(*row);
                impl_->show_rows(row.get());
                emit edited();
                return true;
            }
    return QWidget::eventFilter(watched, event);
}

}  // namespace seamwright
