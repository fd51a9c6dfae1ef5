#pragma once
// Single step against servoing on the same panels: eight spots around a panel with straight contours,
// landmark noise, random displacements of panel and body (10 mm, about 1 degree). Final error is that of the
// true relation at the spots after the last move.

#include <cstdint>

#include "core/error.h"

namespace seamwright::cli {

struct PanelWay {
    double rms_mm = 0, worst_mm = 0;  // gap and flush against taught, over all panels
    double moves = 0;                 // mean
    double compute_ms = 0;            // mean, without the moves
    int failed = 0;
};
struct PanelComparison {
    int panels = 0, training_moves = 0;
    double noise_mm = 0.03;
    PanelWay single_step, servoing;
};
PanelComparison compare_panel_fitting(int panels, std::uint64_t seed);

}  // namespace seamwright::cli
