#pragma once
// What a gap check says: in words, as a table, as a page.

#include <string>

#include "projects/panel/gap_check.h"
#include "projects/report/html.h"

namespace seamwright {

// Verdict, extent and every stretch that the nozzle does not pass, one a line.
std::string gap_text(const GapPass& pass, const GapCheck& check, const GapScanOptions& options);
// path_mm,verdict,width_mm,sigma_mm,flush_mm,yaw_deg,tilt_deg,x_mm,y_mm,z_mm (work object); empty without a width.
std::string gap_csv(const GapScan& scan);
// Width with 3 sigma and what is needed, flush, turn, and the stretches.
report::Page gap_page(const GapPass& pass, const GapCheck& check, const GapScanOptions& options,
                      const std::string& project);

}  // namespace seamwright
