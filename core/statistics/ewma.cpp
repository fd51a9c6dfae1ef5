#include "core/statistics/ewma.h"

#include <cmath>

namespace seamwright {

Expected<Ewma> ewma_chart(std::span<const double> values, double centre, double sigma,
                          const EwmaOptions& options) {
    if (!(options.lambda > 0 && options.lambda <= 1 && options.width > 0 && std::isfinite(options.width)))
        return input_error("lambda is not within 0 to 1, or the width not above 0", "EWMA");
    if (!(sigma > 0 && std::isfinite(sigma) && std::isfinite(centre)))
        return input_error("the values have no scatter to make limits of", "EWMA");
    Ewma r;
    double z = centre, forgotten = 1;
    for (const double x : values) {
        if (!std::isfinite(x)) return input_error("a value is not finite", "EWMA");
        z += options.lambda * (x - z);
        forgotten *= (1 - options.lambda) * (1 - options.lambda);
        const double half =
            options.width * sigma * std::sqrt(options.lambda / (2 - options.lambda) * (1 - forgotten));
        if (std::abs(z - centre) > half) r.beyond.push_back(r.z.size());
        r.z.push_back(z);
        r.half_width.push_back(half);
    }
    return r;
}

}  // namespace seamwright
