#pragma once
// From no guess to a few places of the sensor that may be right. Private to core/calibration/on_part.
//
// For an assumed attitude of the sensor on the flange (400 of them, evenly over all: super-Fibonacci, Alexa 2022) the
// shift and, for the edges' rough directions, parabolas over them are linear; wrong profiles weigh less (Cauchy), and the
// directions follow from the points. The best are solved on thinned profiles.

#include "core/calibration/on_part/edge_problem.h"

namespace seamwright::on_part {

// Best first, each apart from those before by 3 degrees or more; empty: none. Edges are curves of few knots.
std::vector<State> starts(const Data& data);

// The same from a place that is known.
State start_at(const Data& data, const Pose& mounting, double latency_s, double knot_mm, int most);

}  // namespace seamwright::on_part
