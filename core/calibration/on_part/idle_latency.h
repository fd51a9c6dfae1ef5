#pragma once
// A latency that only the noise of a curve speaks for. Private to core/calibration/on_part.
//
// Travel along a straight edge says nothing of the latency: the point is on the edge whenever it was seen. A curve that was
// fitted to noise has slopes, and against these the latency counts as seen; both are then found where they suit one another.
// So the edges are held straight once. Where the data do not speak against that (restricted likelihood, chi squared at
// 99.9 % of one number for each edge's curvature and one for the latency), the answer is the one from straight edges, as a
// mean over the likely curvatures as always. A latency that is then open is held where it began, and the mounting's
// covariance holds what kOnPartOpen_s of it would move.

#include "core/calibration/on_part/refine.h"

namespace seamwright::on_part {

// The answer to go on with: `refined` itself where its latency is real.
Refined without_idle_latency(const Data& data, const Refined& refined,
                             const std::optional<RobotRepeatability>& robot);

}  // namespace seamwright::on_part
