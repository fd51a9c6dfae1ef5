#include "widgets/print/paged.h"

#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QGuiApplication>
#include <QPainter>
#include <QPdfWriter>
#include <QTextDocument>
#include <QTextOption>
#include <clocale>

#include "devices/exchange/files.h"

namespace seamwright {
namespace {

constexpr double kMarginMm = 18, kFooterMm = 8;

void ensure_application() {
    if (QCoreApplication::instance()) return;
    qputenv("QT_QPA_PLATFORM", "offscreen");
    static int argc = 1;
    static char name[] = "seamwright";
    static char* argv[] = {name, nullptr};
    // Offscreen, Qt has something to say about a desktop session that nobody needs here.
    const QtMessageHandler before =
        qInstallMessageHandler([](QtMsgType, const QMessageLogContext&, const QString&) {});
    static QGuiApplication application(argc, argv);
    std::setlocale(LC_NUMERIC, "C");  // Qt has set the desktop's: libraries that parse "1.5" would read 1
    qInstallMessageHandler(before);
}

}  // namespace

Expected<void> write_paged(const std::filesystem::path& pdf, const QString& title,
                           const std::function<void(QTextDocument& document, QSizeF page_px)>& fill) {
    ensure_application();
    QBuffer buffer;
    buffer.open(QIODevice::WriteOnly);
    {
        QPdfWriter writer(&buffer);
        writer.setPageSize(QPageSize(QPageSize::A4));
        writer.setPageMargins(QMarginsF(kMarginMm, kMarginMm, kMarginMm, kMarginMm), QPageLayout::Millimeter);
        writer.setResolution(kPrintedDpi);
        writer.setTitle(title);
        writer.setCreator("Seamwright");
        const double width = writer.width();
        const double footer = kFooterMm * kPrintedDpi / 25.4, height = writer.height() - footer;

        QTextDocument document;
        QTextOption wrapping;
        wrapping.setWrapMode(QTextOption::WordWrap);
        document.setDefaultTextOption(wrapping);
        document.documentLayout()->setPaintDevice(&writer);
        document.setPageSize(QSizeF(width, height));
        fill(document, document.pageSize());

        QPainter painter(&writer);
        const int pages = document.pageCount();
        for (int n = 0; n < pages; ++n) {
            if (n) writer.newPage();
            painter.save();
            painter.translate(0, -n * height);
            document.drawContents(&painter, QRectF(0, n * height, width, height));
            painter.restore();
            painter.setFont(QFont("DejaVu Sans", 7));
            painter.setPen(QColor("#6b7280"));
            const QRectF foot(0, height, width, footer);
            painter.drawText(foot, Qt::AlignLeft | Qt::AlignBottom, title);
            painter.drawText(foot, Qt::AlignRight | Qt::AlignBottom,
                             QString("%1 / %2").arg(n + 1).arg(pages));
        }
    }
    const QByteArray& bytes = buffer.data();
    return write_text_file(pdf, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

}  // namespace seamwright
