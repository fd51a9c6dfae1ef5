#pragma once
// What people read about each calibration method, translated.

#include <QString>
#include <QStringList>

#include "core/calibration/verdict.h"

namespace seamwright {

struct MethodText {
    QString title;     // "Sensor on the flange (sphere)"
    QString why;       // one sentence: what it answers
    QStringList need;  // what to have at hand and what to mind
    QString file;      // what a file of it holds
};
MethodText method_text(const QString& id);

QString setting_name(const QString& name);  // of MethodSetting::info, "Radius of the sphere"

QString verdict_word(Verdict verdict);  // Verdict::good -> "gut"

}  // namespace seamwright
