#include "widgets/errors.h"

#include <QCoreApplication>
#include <QRegularExpression>
#include <QStringList>
#include <algorithm>
#include <span>
#include <vector>

#include "widgets/error_texts.h"

namespace seamwright {
namespace {

struct Pattern {
    const char* english;
    QString begin;  // up to the first gap: told apart without the expression
    QRegularExpression shape;
    int letters = 0;                // outside of gaps: the pattern that says most wins
    std::vector<bool> is_sentence;  // per gap: what stands there may be a sentence of the list too
};

std::vector<Pattern> patterns(std::span<const char* const> texts) {
    static const QRegularExpression escaped_gap(QStringLiteral(R"(\\%[1-9])")), gap(QStringLiteral("%[1-9]")),
        article(QStringLiteral(R"((^|\b(the|a|an|no|not)\s+|[:(]\s*)$)"));
    std::vector<Pattern> list;
    for (const char* english : texts) {
        const QString text = QString::fromUtf8(english);
        Pattern pattern;
        pattern.english = english;
        pattern.begin = text.section(gap, 0, 0);
        pattern.letters = static_cast<int>(QString(text).remove(gap).size());
        for (auto it = gap.globalMatch(text); it.hasNext();)
            pattern.is_sentence.push_back(article.match(text.left(it.next().capturedStart())).hasMatch());
        QString shape = QRegularExpression::escape(text);
        shape.replace(escaped_gap, QStringLiteral("(.*)"));
        pattern.shape = QRegularExpression(QRegularExpression::anchoredPattern(shape),
                                           QRegularExpression::DotMatchesEverythingOption);
        list.push_back(std::move(pattern));
    }
    std::stable_sort(list.begin(), list.end(),
                     [](const Pattern& a, const Pattern& b) { return a.letters > b.letters; });
    return list;
}

const std::vector<Pattern>& causes() {
    static const std::vector<Pattern> list = patterns(error_texts());
    return list;
}

const std::vector<Pattern>& places() {
    static const std::vector<Pattern> list = patterns(error_places());
    return list;
}

QString shown(const QString& text, const std::vector<Pattern>& list) {
    for (const Pattern& pattern : list) {
        if (!text.startsWith(pattern.begin)) continue;
        const auto match = pattern.shape.match(text);
        if (!match.hasMatch()) continue;
        QString german = QCoreApplication::translate("Errors", pattern.english);
        // From behind: what is filled in may hold such a sign itself.
        for (int i = match.lastCapturedIndex(); i >= 1; --i) {
            const QString part = match.captured(i);
            const bool sentence = pattern.is_sentence[static_cast<std::size_t>(i) - 1];
            german.replace(QStringLiteral("%") + QString::number(i), sentence ? shown(part, causes()) : part);
        }
        return german;
    }
    return text;
}

}  // namespace

QString shown_cause(const std::string& english) {
    return shown(QString::fromStdString(english), causes());
}

QString shown_error(const Error& error) {
    QString text;
    if (!error.where.empty()) {
        QStringList parts = QString::fromStdString(error.where).split(QStringLiteral(": "));
        for (QString& part : parts) part = shown(part, places());
        text = parts.join(QStringLiteral(": ")) + QStringLiteral(": ");
    }
    text += shown_cause(error.what);
    if (!error.mend.empty()) text += QStringLiteral("; ") + shown_cause(error.mend);
    return text;
}

QString shown_error(const QString& frame, const Error& error) {
    return frame + QStringLiteral(" ") + shown_error(error);
}

}  // namespace seamwright
