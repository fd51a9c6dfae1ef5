#pragma once
// How much light the stripe has in its image, how much would suit it, and one stripe from several exposures.
//
// Light is exposure times gain, in microseconds at 0 dB: t * 10^(gain_db/20). The grey value of a peak above black is
// proportional to it until full scale cuts it off; all of this rests on that and on nothing else of the sensor.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/parameter.h"
#include "core/profile/stripe/stripe_image.h"

namespace seamwright {

// Of the strongest peak of each line; levels in full scales, 0..1.
struct StripeLight {
    int lines = 0;                            // that were asked about
    int lit = 0;                              // of them with a peak
    int saturated = 0;                        // of these with one that is cut off
    double bright = 0, middle = 0, dark = 0;  // 95, 50 and 10 of 100 lit lines lie below; 0 where none is lit
    double width_px = 0;                      // median full width at half height
    double saturated_share() const { return lit > 0 ? static_cast<double>(saturated) / lit : 0; }
};
// `only`: the lines that count, by number (a flag each); empty: all.
StripeLight stripe_light(const StripePeaks& peaks, int full_scale,
                         const std::vector<std::uint8_t>& only = {});

// The grey, as a share of full scale, that `share` of the pixels do not reach; of every 8th pixel of every 8th row. 0 of an
// empty image.
double grey_level(const StripeImage& image, double share);
// Half of the pixels are darker: 1 where the whole image is flooded.
inline double surrounding_level(const StripeImage& image) {
    return grey_level(image, 0.5);
}

// The exposure and gain that a frame was taken with, and what its stripe looked like: kept beside what was measured in it.
struct SeenLight {
    ParameterValues settings;  // as the sensor read them back, "exposure_us": 800
    // Empty where the sensor delivers finished profiles: no stripe was looked at.
    std::optional<double> bright, saturated_share, width_px;
    int exposures = 1;  // merged into one stripe
};

enum class LightVerdict {
    fit,         // bright lines near 0.7 of full scale, at most 2 of 100 cut off
    too_dark,    // and the limits allow no more light
    too_bright,  // and the limits allow no less
    no_stripe    // at no light that was tried
};
std::string_view to_string(LightVerdict verdict);
// What a single frame says, limits apart.
LightVerdict judge_light(const StripeLight& light, double surrounding);

// The factor that brings a stripe's bright lines to 0.7 of full scale: their share where none is cut off, else a step
// down by how many are. Within 1/16..16.
double wanted_light_factor(const StripeLight& light, double surrounding);

// The light at which a stripe is best seen, from frame to frame: proportion where no line is cut off, steps down where
// some are, bisection once both sides are known. From a factor of 1000 off it settles in five frames.
class LightSearch {
  public:
    // Precondition: 0 < lowest <= highest, finite; `start` is brought between them.
    LightSearch(double start, double lowest, double highest);
    double next() const { return next_; }  // the light to expose with
    // What came of it. True: settled, light() and verdict() stand.
    bool seen(const StripeLight& light, double surrounding);
    double light() const { return best_; }  // the best so far
    LightVerdict verdict() const { return verdict_; }

  private:
    double next_, lowest_, highest_, best_;
    double dark_ = 0, glare_ = 0;  // brightest that was too dark, darkest that was too bright; 0: none yet
    LightVerdict verdict_ = LightVerdict::no_stripe;
};

// Lines that some frame shows and that `chosen` shows badly: without a peak, or with one below a tenth of full scale.
// A flag each. Precondition: all have as many lines.
std::vector<std::uint8_t> unserved_lines(const StripePeaks& chosen, int full_scale,
                                         std::span<const StripePeaks> all);

// One stripe from several exposures of a scene that stood still, line by line: the peaks of the exposure with most light whose
// strongest peak is not cut off; where all are, that with least. An exposure with less light whose peak is well lit
// has the word where the brighter one disagrees by more than half a stripe's width (glare of the lines
// beside it). Grey values come out in those of the least light, so that the stripe's brightness goes on over a change of
// exposure. `light`: of each, above 0. Error (usage): none, of different shape, or as many lights as exposures.
Expected<void> merge_exposures(std::span<const StripePeaks> exposures, std::span<const double> light,
                               int full_scale, StripePeaks& merged);

}  // namespace seamwright
