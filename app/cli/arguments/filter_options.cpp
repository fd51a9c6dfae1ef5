#include "app/cli/arguments/filter_options.h"

namespace seamwright::cli {

void add_filter_options(CLI::App* command, FilterOptions& o) {
    command
        ->add_option("--noise-mm", o.noise_mm,
                     "Standard deviation of a point; 0 = estimated from the profile")
        ->capture_default_str();
    command->add_option("--band", o.band_sigmas, "Acceptance band in predicted standard deviations")
        ->capture_default_str();
    command->add_option("--lookahead", o.lookahead, "Longest burst of outliers, points")
        ->capture_default_str();
    command->add_option("--min-segment", o.min_segment_points, "Shorter pieces are outliers, points")
        ->capture_default_str();
}

}  // namespace seamwright::cli
