#include "app/manual/manual_window.h"

#include <QHBoxLayout>
#include <QPushButton>
#include <QTextBlock>
#include <QUrl>
#include <QVBoxLayout>

#include "app/manual/manual.h"
#include "app/manual/manual_look.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr double kBeside = 1.15;  // of the window's own text: it is read from farther away

// The pages as they are read beside the window.
class ManualText : public QTextBrowser {
  public:
    using QTextBrowser::QTextBrowser;

  protected:
    QVariant loadResource(int type, const QUrl& name) override {
        const QVariant read = QTextBrowser::loadResource(type, name);
        if (!name.path().endsWith(".md")) return read;
        return without_pictures(QString::fromUtf8(read.toByteArray())).toUtf8();
    }
    void doSetSource(const QUrl& name, QTextDocument::ResourceType type) override {
        QTextBrowser::doSetSource(name, type);
        set_manual_look(*document(), kBeside * fontInfo().pointSizeF(), palette());
        moveCursor(QTextCursor::Start);
    }
};

QString page_of(const QUrl& source) {
    return source.fileName().section('.', 0, 0);
}

}  // namespace

ManualWindow::ManualWindow(const QString& language, QWidget* parent)
    : QWidget(parent, Qt::Window),
      language_(language),
      words_(new QLineEdit),
      contents_(new QListWidget),
      text_(new ManualText) {
    setObjectName("manual");
    setWindowTitle(tr("Manual"));
    resize(980, 700);
    words_->setObjectName("manual_words");
    words_->setPlaceholderText(tr("Search the manual"));
    words_->setAccessibleName(words_->placeholderText());
    words_->setToolTip(tr("Only the pages with these words stay in the list"));
    words_->setClearButtonEnabled(true);
    words_->setMinimumHeight(style::kTargetPx);
    contents_->setObjectName("manual_contents");
    contents_->setAccessibleName(tr("Pages of the manual"));
    contents_->setToolTip(contents_->accessibleName());
    text_->setObjectName("manual_text");
    text_->setAccessibleName(tr("The page"));
    text_->setOpenExternalLinks(true);
    auto* back = new QPushButton(tr("Back"));
    back->setObjectName("manual_back");
    back->setToolTip(tr("The page that was read before (Alt+Left)"));
    back->setMinimumHeight(style::kTargetPx);
    back->setEnabled(false);

    auto* beside = new QVBoxLayout;
    beside->addWidget(words_);
    beside->addWidget(contents_, 1);
    beside->addWidget(back);
    auto* box = new QHBoxLayout(this);
    box->addLayout(beside, 1);
    box->addWidget(text_, 3);

    for (const QString& page : manual_pages()) {
        auto* item = new QListWidgetItem(manual_title(page, language_), contents_);
        item->setData(Qt::UserRole, page);
        item->setSizeHint({0, style::kTargetPx});
    }
    connect(contents_, &QListWidget::currentItemChanged, this, [this](const QListWidgetItem* item) {
        if (item && item->data(Qt::UserRole).toString() != page())
            show_page(item->data(Qt::UserRole).toString());
    });
    connect(text_, &QTextBrowser::sourceChanged, this, [this] {
        for (int k = 0; k < contents_->count(); ++k)
            if (contents_->item(k)->data(Qt::UserRole).toString() == page()) contents_->setCurrentRow(k);
        mark();
    });
    connect(text_, &QTextBrowser::backwardAvailable, back, &QPushButton::setEnabled);
    connect(back, &QPushButton::clicked, text_, &QTextBrowser::backward);
    connect(words_, &QLineEdit::textChanged, this, &ManualWindow::search);
    show_page(manual_pages().front());
}

QString ManualWindow::page() const {
    return page_of(text_->source());
}

void ManualWindow::show_page(const QString& page) {
    const QString known = manual_pages().contains(page) ? page : manual_pages().front();
    text_->setSource(QUrl(manual_address(known, language_)), QTextDocument::MarkdownResource);
}

void ManualWindow::search(const QString& words) {
    QListWidgetItem* first = nullptr;
    for (int k = 0; k < contents_->count(); ++k) {
        QListWidgetItem* item = contents_->item(k);
        const QString text = manual_text(item->data(Qt::UserRole).toString(), language_);
        const bool found = text.simplified().contains(words.simplified(), Qt::CaseInsensitive);
        item->setHidden(!found);
        if (found && !first) first = item;
    }
    if (first && contents_->currentItem()->isHidden()) contents_->setCurrentItem(first);
    mark();
}

void ManualWindow::mark() {
    QList<QTextEdit::ExtraSelection> marks;
    const QString words = words_->text().simplified();
    QTextCursor at(text_->document());
    while (!words.isEmpty() && !(at = text_->document()->find(words, at)).isNull()) {
        QTextEdit::ExtraSelection mark;
        mark.cursor = at;
        mark.format.setBackground(style::attention(palette()));
        mark.format.setForeground(palette().base());
        if (marks.isEmpty()) text_->setTextCursor(QTextCursor(at.block()));
        marks.append(mark);
    }
    text_->setExtraSelections(marks);
    if (!marks.isEmpty()) text_->ensureCursorVisible();
}

}  // namespace seamwright
