#pragma once
// The acceptance as an Excel workbook: every index with its 95 % limits and verdict, the ANOVA table of type 3, and the values
// that were judged.

#include "devices/quality/workbook.h"
#include "projects/acceptance/study/studies.h"

namespace seamwright {

Workbook acceptance_workbook(const Acceptance& acceptance, Language language);

}  // namespace seamwright
