#include "widgets/editors/pose_editor.h"

#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QGridLayout>
#include <QGuiApplication>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <array>

#include "widgets/editors/parameter_editor.h"
#include "widgets/into_view.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {

namespace {

struct FieldText {
    QString name, unit;
};

std::vector<FieldText> fields_of(PoseNotation notation) {
    const QString mm = PoseEditor::tr("mm"), deg = PoseEditor::tr("deg"), rad = PoseEditor::tr("rad");
    std::vector<FieldText> fields{{"X", mm}, {"Y", mm}, {"Z", mm}};
    switch (notation) {
        case PoseNotation::kuka_abc:
            for (const char* name : {"A", "B", "C"}) fields.push_back({name, deg});
            break;
        case PoseNotation::fanuc_wpr:
            for (const char* name : {"W", "P", "R"}) fields.push_back({name, deg});
            break;
        case PoseNotation::abb_quaternion:
            for (const char* name : {"q1 (w)", "q2 (x)", "q3 (y)", "q4 (z)"}) fields.push_back({name, ""});
            break;
        case PoseNotation::ur_rotvec:
            for (const char* name : {"RX", "RY", "RZ"}) fields.push_back({name, rad});
            break;
        case PoseNotation::matrix:
            fields.clear();
    }
    return fields;
}

}  // namespace

struct PoseEditor::Impl {
    Pose pose = Pose::Identity();
    PoseNotation notation = PoseNotation::kuka_abc;
    QComboBox* choice = nullptr;
    std::array<QLabel*, 7> names{}, units{};
    std::array<QLineEdit*, 7> lines{};
    QPlainTextEdit* matrix = nullptr;
    QLabel* problem = nullptr;
    QString reason;
    bool modified = false;
    std::string of;  // what the pose belongs to

    void show();
    bool take(PoseEditor& editor, const QString& text);
    bool take_typed(PoseEditor& editor);
    bool refuse(PoseEditor& editor, const QString& why);
};

void PoseEditor::Impl::show() {
    const std::vector<FieldText> fields = fields_of(notation);
    const QStringList numbers = text_from_pose(pose, notation).split(' ');
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const bool used = i < fields.size();
        for (QWidget* widget : {static_cast<QWidget*>(names[i]), static_cast<QWidget*>(units[i]),
                                static_cast<QWidget*>(lines[i])})
            widget->setVisible(used);
        if (!used) continue;
        names[i]->setText(fields[i].name);
        units[i]->setText(fields[i].unit);
        // What is marked stays marked where the number is the same.
        if (const QString text = numbers.value(static_cast<int>(i)); lines[i]->text() != text)
            lines[i]->setText(text);
        lines[i]->setAccessibleName(fields[i].name + " " + fields[i].unit);
        lines[i]->setToolTip(PoseEditor::tr("%1 in %2. A whole pose can be pasted here.")
                                 .arg(fields[i].name, notation_name(notation)));
    }
    matrix->setVisible(notation == PoseNotation::matrix);
    if (notation == PoseNotation::matrix) {
        QString text;
        for (int row = 0; row < 4; ++row) text += numbers.mid(row * 4, 4).join("  ") + (row < 3 ? "\n" : "");
        const QSignalBlocker quiet(matrix);
        if (matrix->toPlainText() != text) matrix->setPlainText(text);
    }
    modified = false;
    reason.clear();
    problem->hide();
}

bool PoseEditor::Impl::take_typed(PoseEditor& editor) {
    if (notation == PoseNotation::matrix) return take(editor, matrix->toPlainText());
    QStringList words;
    const auto fields = fields_of(notation);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const QString typed = lines[i]->text().trimmed().left(kTypedSigns);
        QStringList own{fields[i].unit};
        if (fields[i].unit == PoseEditor::tr("deg")) own << QStringLiteral("°");
        const auto number = number_from_text(lines[i]->text(), own);
        if (!number && !fields[i].unit.isEmpty() && !unit_behind_number(typed).isEmpty())
            return refuse(editor, PoseEditor::tr("%1: \"%2\" has another unit; give it in %3")
                                      .arg(fields[i].name, typed, fields[i].unit));
        if (!number)
            return refuse(editor, PoseEditor::tr("%1: \"%2\" is not a number").arg(fields[i].name, typed));
        words << QString::number(*number, 'g', 17);
    }
    return take(editor, words.join(' '));
}

bool PoseEditor::Impl::refuse(PoseEditor& editor, const QString& why) {
    reason = why;
    problem->setText(PoseEditor::tr("refused: %1").arg(reason));
    QPalette red = problem->palette();
    red.setColor(QPalette::WindowText, style::alarm(editor.palette()));
    problem->setPalette(red);
    problem->show();
    bring_into_view(problem);
    return false;
}

// False: refused; the fields stay as typed.
bool PoseEditor::Impl::take(PoseEditor& editor, const QString& text) {
    const auto taken = pose_from_text(text, notation);
    if (!taken) return refuse(editor, shown_error(taken.error()));
    const bool changed = distance_mm(*taken, pose) > 1e-9 || angle_rad(*taken, pose) > 1e-12;
    pose = *taken;
    show();
    if (changed) emit editor.committed();
    return true;
}

PoseEditor::PoseEditor(QWidget* parent) : QWidget(parent), impl_(std::make_unique<Impl>()) {
    setAccessibleName(tr("Pose"));
    setToolTip(tr("Position in mm and orientation in the notation chosen"));
    auto* grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setHorizontalSpacing(6);
    grid->setVerticalSpacing(4);
    impl_->choice = new QComboBox(this);
    impl_->choice->setMinimumHeight(style::kTargetPx);
    impl_->choice->setAccessibleName(tr("Notation of the orientation"));
    impl_->choice->setToolTip(tr("How the orientation is written; the pose itself stays"));
    for (const auto notation : {PoseNotation::kuka_abc, PoseNotation::fanuc_wpr, PoseNotation::abb_quaternion,
                                PoseNotation::ur_rotvec, PoseNotation::matrix})
        impl_->choice->addItem(notation_name(notation));
    grid->addWidget(impl_->choice, 0, 0, 1, 6);
    setFocusProxy(impl_->choice);
    // Position in the left column, orientation in the right one.
    for (int i = 0; i < 7; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const int row = 1 + (i < 3 ? i : i - 3), column = i < 3 ? 0 : 3;
        impl_->names[k] = new QLabel(this);
        impl_->lines[k] = new QLineEdit(this);
        impl_->units[k] = new QLabel(this);
        impl_->lines[k]->setAlignment(Qt::AlignRight);
        impl_->lines[k]->setMinimumHeight(style::kTargetPx);
        impl_->lines[k]->setMinimumWidth(96);
        impl_->lines[k]->installEventFilter(this);
        connect(impl_->lines[k], &QLineEdit::textEdited, this, [this] { impl_->modified = true; });
        grid->addWidget(impl_->names[k], row, column);
        grid->addWidget(impl_->lines[k], row, column + 1);
        grid->addWidget(impl_->units[k], row, column + 2);
    }
    grid->setColumnStretch(1, 1);
    grid->setColumnStretch(4, 1);
    impl_->matrix = new QPlainTextEdit(this);
    impl_->matrix->setAccessibleName(tr("Matrix, 4 rows of 4 numbers, mm"));
    impl_->matrix->setToolTip(tr("Paste or type 12 or 16 numbers, row by row; Ctrl+Enter takes them"));
    impl_->matrix->setTabChangesFocus(true);
    impl_->matrix->setLineWrapMode(QPlainTextEdit::NoWrap);
    impl_->matrix->setMinimumHeight(4 * fontMetrics().height() + 24);
    impl_->matrix->installEventFilter(this);
    connect(impl_->matrix, &QPlainTextEdit::textChanged, this, [this] { impl_->modified = true; });
    grid->addWidget(impl_->matrix, 5, 0, 1, 6);
    impl_->problem = new QLabel(this);
    impl_->problem->setWordWrap(true);
    impl_->problem->setAccessibleName(tr("Why the pose is refused"));
    grid->addWidget(impl_->problem, 6, 0, 1, 6);
    connect(impl_->choice, &QComboBox::currentIndexChanged, this, [this](int index) {
        impl_->notation = static_cast<PoseNotation>(index);
        impl_->show();
        emit notation_changed(impl_->notation);
    });
    impl_->show();
}

PoseEditor::~PoseEditor() = default;

void PoseEditor::set_notation(PoseNotation notation) {
    impl_->choice->setCurrentIndex(static_cast<int>(notation));
}
PoseNotation PoseEditor::notation() const {
    return impl_->notation;
}
Pose PoseEditor::pose() const {
    return impl_->pose;
}
bool PoseEditor::refused() const {
    return !impl_->reason.isEmpty();
}
QString PoseEditor::reason() const {
    return impl_->reason;
}

void PoseEditor::set_pose(const Pose& pose) {
    impl_->pose = pose;
    impl_->show();
}

void PoseEditor::refresh(const Pose& pose, const std::string& of) {
    const bool typing = (impl_->modified || refused()) && impl_->of == of;
    impl_->of = of;
    impl_->pose = pose;
    if (!typing) impl_->show();
}

bool PoseEditor::eventFilter(QObject* watched, QEvent* event) {
    const bool in_matrix = watched == impl_->matrix;
    if (event->type() == QEvent::FocusOut) {
        // A quaternion is none until its last number is typed: it is taken when the focus leaves all fields.
        const QWidget* next = QApplication::focusWidget();
        const bool half_typed =
            impl_->notation == PoseNotation::abb_quaternion && next && next != this && isAncestorOf(next);
        if (impl_->modified && !half_typed) impl_->take_typed(*this);
    } else if (event->type() == QEvent::KeyPress) {
        auto* key = static_cast<QKeyEvent*>(event);
        const bool enter = key->key() == Qt::Key_Return || key->key() == Qt::Key_Enter;
        if (enter && (!in_matrix || (key->modifiers() & Qt::ControlModifier))) {
            if (impl_->modified) impl_->take_typed(*this);
            return true;
        }
        if (key->key() == Qt::Key_Escape && (impl_->modified || refused())) {
            impl_->show();
            return true;
        }
        if (!in_matrix && key->matches(QKeySequence::Paste)) {
            const QString text = QGuiApplication::clipboard()->text();
            if (!is_of_one_field(text)) {
                impl_->take(*this, text);
                return true;
            }
        }
    }
    return QWidget::eventFilter(watched, event);
}

}  // namespace seamwright
