#pragma once

#include <QString>

#include "core/calibration/verdict.h"

namespace seamwright {

QString verdict_word(Verdict verdict);  // Verdict::good -> "gut"

}  // namespace seamwright
