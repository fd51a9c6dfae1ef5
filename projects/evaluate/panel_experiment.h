#pragma once
// Single step against servoing on the same panels: eight spots around a panel with straight contours,
// landmark noise, random displacements of panel and body (10 mm, about 1 degree). Final error is that of the
// true relation at the spots after the last move.

#include <cstdint>

#include "core/error.h"

namespace seamwright::evaluation {

struct PanelWay {
    double rms_mm = 0, worst_mm = 0;  // gap and flush against taught, over all panels
    double moves = 0;                 // mean
    int fewest_moves = 0, most_moves = 0;
    double within_three_sigma = 0;  // share of gaps and flushes as taught within 3 sigma of a measured one
    double compute_ms = 0;          // mean, without the moves
    int judged = 0, failed = 0;     // panels; a single step that failed moves nothing and is not judged
};
struct PanelComparison {
    int panels = 0, training_moves = 0;
    double noise_mm = 0.03;
    PanelWay single_step, servoing;
};
PanelComparison compare_panel_fitting(int panels, std::uint64_t seed);

}  // namespace seamwright::evaluation
