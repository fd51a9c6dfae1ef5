#pragma once
// The exponentially weighted moving average (Roberts 1959), which sees a small lasting shift long before a single value
// leaves the limits:
//     z_i = lambda x_i + (1 - lambda) z_(i-1),   z_0 = centre
//     limits: centre +- L sigma sqrt(lambda / (2 - lambda) (1 - (1 - lambda)^(2 i)))
// lambda 0.2 and L 2.962: of independent normal values every 500th is beyond by chance (Lucas and Saccucci 1990), and a
// shift of one sigma is seen after about 10. Values that follow each other alike are beyond far more often.

#include <cstddef>
#include <span>
#include <vector>

#include "core/error.h"

namespace seamwright {

struct EwmaOptions {
    double lambda = 0.2, width = 2.962;
};
struct Ewma {
    std::vector<double> z, half_width;  // of each value; half_width about the centre
    std::vector<std::size_t> beyond;
};

// Error (input): lambda beyond (0, 1], a width or sigma not above 0, values not finite.
Expected<Ewma> ewma_chart(std::span<const double> values, double centre, double sigma,
                          const EwmaOptions& options = {});

}  // namespace seamwright
