#pragma once
// A button and a menu take the sign & for the mark of a key.

#include <QString>

namespace seamwright {

// Shown there as it is written, with the signs of a name.
inline QString with_signs(QString text) {
    return text.replace(QStringLiteral("&"), QStringLiteral("&&"));
}

// What is read there, without the marks.
inline QString without_marks(const QString& text) {
    QString read;
    for (qsizetype i = 0; i < text.size(); ++i) {
        if (text[i] == QLatin1Char('&') && ++i == text.size()) break;
        read += text[i];
    }
    return read;
}

}  // namespace seamwright
