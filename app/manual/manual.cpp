#include "app/manual/manual.h"

#include <QFile>
#include <QRegularExpression>

static void link_manual() {
    Q_INIT_RESOURCE(manual_pages);
}

namespace seamwright {

const QStringList& manual_pages() {
    static const QStringList pages{"start", "cell",   "calibrate", "teach",      "align", "regions",
                                   "prove", "accept", "run",       "production", "keys",  "words"};
    return pages;
}

QString manual_page_of(Step step) {
    return manual_pages()[1 + static_cast<int>(step)];
}

QString manual_address(const QString& page, const QString& language) {
    link_manual();
    return QStringLiteral("qrc:/manual/%1/%2.md").arg(language == "de" ? "de" : "en", page);
}

QString manual_text(const QString& page, const QString& language) {
    QFile file(manual_address(page, language).mid(3));  // a file's name has no "qrc"
    if (!file.open(QIODevice::ReadOnly)) return {};
    return QString::fromUtf8(file.readAll());
}

QString manual_title(const QString& page, const QString& language) {
    return manual_text(page, language).section('\n', 0, 0).mid(2);
}

QString without_pictures(QString markdown) {
    static const QRegularExpression picture(QStringLiteral("^!\\[[^\\]]*\\]\\(picture:[^)]*\\)\\n+"),
                                            QRegularExpression::MultilineOption);
    return markdown.remove(picture);
}

}  // namespace seamwright
