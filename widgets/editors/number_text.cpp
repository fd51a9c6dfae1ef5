#include <QLocale>
#include <QRegularExpression>
#include <cmath>

#include "widgets/editors/parameter_editor.h"

namespace seamwright {

std::optional<double> number_from_text(const QString& text) {
    QString plain = text.trimmed();
    plain.replace(QChar(0x2212), '-');  // the typographic minus that comes with pasted text
    static const QRegularExpression number(R"(^[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d{1,3})?$)");
    if (!number.match(plain).hasMatch()) return std::nullopt;
    plain.replace(',', '.');
    bool ok = false;
    const double value = QLocale::c().toDouble(plain, &ok);
    if (!ok || !std::isfinite(value)) return std::nullopt;
    return value;
}

QString unit_behind_number(const QString& text) {
    static const QRegularExpression unit(
        QStringLiteral(R"(^[+\-−]?[0-9.,]+\s*(°|[A-Za-zµ]+(/[A-Za-z]+)?)$)"));
    return unit.match(text.trimmed()).captured(1);
}

std::optional<double> number_from_text(const QString& text, const QStringList& units) {
    const QString unit = unit_behind_number(text);
    QString plain = text.trimmed();
    if (!unit.isEmpty() && units.contains(unit)) plain.chop(unit.size());
    return number_from_text(plain);
}

QString text_from_number(double value, int decimals) {
    QString text = QLocale::c().toString(value, 'f', decimals);
    text.remove(',');  // the C locale groups thousands
    if (text.startsWith('-') && QLocale::c().toDouble(text) == 0) text.remove(0, 1);
    return text;
}

}  // namespace seamwright
