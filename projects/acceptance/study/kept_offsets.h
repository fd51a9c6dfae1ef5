#pragma once
// Offsets against a better instrument, from a correlation: kept in the region as versions, off until a person
// switches one on. What acts is taken off every displacement of the region (station/measure.h) and is said in each
// run's record, its report and the studies made of it. A switch is taken back by undo_offset().
//
// A correlation of runs on which version a acted finds what is left, along the measurand's direction n. The new
// version is absolute: offset = offset_a + (mean difference) n, its covariance that of the mean along n, and what a
// said across n. (I - n n^T) C_a (I - n n^T) + s^2 / n_parts n n^T.

#include "projects/acceptance/study/studies.h"

namespace seamwright {

// The version that is made of it, appended to the region; it does not act. Error (input): the values are of no stored
// runs or of another region; too few parts; an offset that may be chance; a slope that is not 1, where no offset is
// right for every part.
Expected<int> keep_offset(Region& region, const Acceptance& acceptance, const std::string& now_utc);

// Version 0: none acts. Error (input): there is no such version; it acts already.
Expected<void> switch_offset(Region& region, int version);
// Takes the last switch back. Error (input): there was none.
Expected<void> undo_offset(Region& region);

}  // namespace seamwright
