#include "app/docs/book.h"

#include <md4c-html.h>

#include <QImage>
#include <QPalette>
#include <QRegularExpression>
#include <QTextBlock>
#include <QTextCursor>
#include <QTextDocument>
#include <QUrl>

#include "app/manual/manual.h"
#include "app/manual/manual_look.h"
#include "devices/exchange/files.h"
#include "widgets/print/paged.h"

namespace seamwright {
namespace {

constexpr double kPrintedPt = 9.5, kScreenDpi = 96;
constexpr double kPictureShare = 0.85;  // of the page's width

constexpr const char* kStyle = R"css(
body { margin: 0; font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #1e2226; background: #fff; }
nav { position: fixed; top: 0; bottom: 0; width: 15rem; overflow: auto; padding: 1.5rem; background: #f3f5f7; }
nav a { display: block; padding: .3rem 0; color: #0067a3; text-decoration: none; }
main { margin-left: 18rem; padding: 1rem 2rem 6rem; max-width: 52rem; }
section { border-bottom: 1px solid #d4d9de; padding: 1rem 0 2rem; }
h1 { font-size: 1.8rem; } h2 { font-size: 1.25rem; margin-top: 2rem; }
img { max-width: 100%; border: 1px solid #d4d9de; }
table { border-collapse: collapse; margin: 1rem 0; } th, td { border: 1px solid #d4d9de; padding: .35rem .7rem; text-align: left; }
th { background: #f3f5f7; } code { background: #f3f5f7; padding: 0 .2rem; }
@media (max-width: 60rem) { nav { position: static; width: auto; } main { margin-left: 0; } }
@media print { nav { display: none; } main { margin: 0; } }
)css";

QString title_of(const QString& language) {
    return language == "de" ? QStringLiteral("Seamwright: Handbuch") : QStringLiteral("Seamwright: manual");
}

// Pages refer to each other by file name, to pictures by theirs.
QString linked(QString markdown, const QString& pictures) {
    static const QRegularExpression page(QStringLiteral("\\]\\(([a-z]+)\\.md\\)"));
    static const QRegularExpression picture(QStringLiteral("\\]\\(picture:([a-z]+)\\)"));
    markdown.replace(page, QStringLiteral("](#\\1)"));
    return markdown.replace(picture, QStringLiteral("](%1/\\1.png)").arg(pictures));
}

QByteArray html_of(const QString& markdown) {
    const QByteArray text = markdown.toUtf8();
    QByteArray html;
    md_html(
        text.constData(), static_cast<MD_SIZE>(text.size()),
        [](const MD_CHAR* piece, MD_SIZE size, void* to) {
            static_cast<QByteArray*>(to)->append(piece, static_cast<qsizetype>(size));
        },
        &html, MD_DIALECT_GITHUB | MD_FLAG_NOHTML, 0);
    return html;
}

Expected<QImage> picture_of(const QString& name, const std::filesystem::path& pictures) {
    const auto file = pictures / (name.toStdString() + ".png");
    QImage image(QString::fromStdString(file.string()));
    if (image.isNull()) return file_error("there is no such picture", file.string());
    return image;
}

// Names of the pictures that the page asks for.
QStringList pictures_of(const QString& markdown) {
    static const QRegularExpression picture(QStringLiteral("\\(picture:([a-z]+)\\)"));
    QStringList names;
    for (auto found = picture.globalMatch(markdown); found.hasNext();) names << found.next().captured(1);
    return names;
}

}  // namespace

Expected<void> write_manual_html(const QString& language, const std::filesystem::path& pictures,
                                 const std::filesystem::path& html) {
    const QString beside =
        QString::fromStdString(pictures.lexically_relative(html.parent_path()).generic_string());
    QByteArray contents, text;
    for (const QString& page : manual_pages()) {
        const QString markdown = manual_text(page, language);
        for (const QString& name : pictures_of(markdown)) SEAM_OK(picture_of(name, pictures));
        const QByteArray id = page.toUtf8();
        contents +=
            "<a href=\"#" + id + "\">" + manual_title(page, language).toHtmlEscaped().toUtf8() + "</a>\n";
        text += "<section id=\"" + id + "\">\n" + html_of(linked(markdown, beside)) + "</section>\n";
    }
    const QByteArray all = "<!DOCTYPE html>\n<html lang=\"" + language.toUtf8() +
                           "\">\n<head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                           "content=\"width=device-width\">\n<title>" +
                           title_of(language).toUtf8() + "</title>\n<style>" + kStyle +
                           "</style></head>\n<body>\n<nav>\n" + contents + "</nav>\n<main>\n" + text +
                           "</main>\n</body>\n</html>\n";
    return write_text_file(html, std::string_view(all.constData(), static_cast<std::size_t>(all.size())));
}

Expected<void> write_manual_pdf(const QString& language, const std::filesystem::path& pictures,
                                const std::filesystem::path& pdf) {
    QString markdown;
    for (const QString& page : manual_pages()) markdown += manual_text(page, language) + "\n\n";
    std::vector<std::pair<QString, QImage>> images;
    for (const QString& name : pictures_of(markdown)) {
        SEAM_TRY(const QImage image, picture_of(name, pictures));
        images.emplace_back(name, image);
    }
    return write_paged(pdf, title_of(language), [&](QTextDocument& document, QSizeF page_px) {
        document.setDefaultFont(QFont("DejaVu Sans"));
        document.setMarkdown(markdown);  // drops the resources that were there
        for (auto& [name, image] : images)
            document.addResource(
                QTextDocument::ImageResource, QUrl("picture:" + name),
                image.scaledToWidth(static_cast<int>(page_px.width()), Qt::SmoothTransformation));
        set_manual_look(document, kPrintedPt, QPalette(Qt::white));
        document.setDocumentMargin(0);
        QTextCursor all(&document);
        all.beginEditBlock();
        for (QTextBlock block = document.begin(); block.isValid(); block = block.next()) {
            QTextBlockFormat format = block.blockFormat();
            if (format.headingLevel() == 1 && block != document.begin())
                format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
            QTextCursor cursor(block);
            cursor.setBlockFormat(format);
            for (auto piece = block.begin(); !piece.atEnd(); ++piece) {
                QTextImageFormat image = piece.fragment().charFormat().toImageFormat();
                if (!image.isValid()) continue;
                // Widths of pictures are pixels of a screen, whatever the paper's are.
                image.setWidth(kPictureShare * page_px.width() * kScreenDpi / kPrintedDpi);
                cursor.setPosition(piece.fragment().position());
                cursor.setPosition(piece.fragment().position() + piece.fragment().length(),
                                   QTextCursor::KeepAnchor);
                cursor.setCharFormat(image);
                break;
            }
        }
        all.endEditBlock();
    });
}

}  // namespace seamwright
