#pragma once
// The fast half of the extraction: which pixels may belong to a stripe at all.
//
// Background and noise are measured on tiles of kTile x kTile pixels (mean grey value of four sampled rows;
// mean absolute difference of pixels two apart, which is 2 sigma/sqrt(pi) for independent Gaussian noise). A
// grey-value opening along the scan direction, longer than the widest stripe, then takes the stripe itself
// out of both maps and leaves uneven light, shadows and halos in. A pixel is a candidate when it exceeds its
// tile's background by the threshold. Candidates are joined to runs along the scan direction. Columns are
// scanned row by row, many columns at a time, and only rows where a run begins or ends in some column cost
// more than a compare.
//
// The AVX2 and the portable kernels do the same integer arithmetic: their results are identical.

#include <cstdint>
#include <vector>

#include "core/profile/stripe/stripe_image.h"

namespace seamwright::detail {

// `careful` is the portable kernel with every lobe measured on its own (lobe.h), the reference of the others.
enum class Kernel { best, portable, careful };

// Whether `kernel` means AVX2 on this machine.
bool has_avx2(Kernel kernel);

inline constexpr int kTile = 32;  // px

// A run of candidate pixels [begin, end) along image line `line`.
struct Run {
    int line, begin, end;
};

// Working memory, sized by the first frame and kept.
struct StripeScan {
    int tile_columns = 0, tile_rows = 0;
    std::vector<float> background, noise;  // [tile_rows * tile_columns] grey values, after the opening
    std::vector<float> scratch;            // the same size
    std::vector<const float*> taps;        // rows of a running minimum
    std::vector<float> padded;             // a row with its ends repeated
    float frame_noise = 0;                 // median of the tiles, grey values
    std::vector<std::uint8_t> limit8;      // the limits of one row of tiles, one per pixel column, padded
    std::vector<std::uint16_t> limit16;
    std::vector<std::uint32_t> open_columns;  // bit set: a run is open in this column
    std::vector<std::int32_t> begin_of;       // where it began
    std::vector<Run> runs;                    // one batch
    int tile_of(int x, int y) const { return (y / kTile) * tile_columns + x / kTile; }
};

// Fills the tile maps. Stripes up to `max_width_px` do not show in them.
void measure_background(const StripeImage& image, ScanLines scan, double max_width_px, Kernel kernel,
                        StripeScan& work);

// Threshold above background of a tile, grey values.
struct ThresholdRule {
    double fixed = 0;         // used when above 0, else
    double noise_factor = 4;  // max(noise_factor * noise, floor)
    double floor = 2;
    double of(float noise) const {
        const double automatic = noise_factor * noise;
        return fixed > 0 ? fixed : (automatic > floor ? automatic : floor);
    }
};

// Calls `consume(context, runs)` with batches of runs. Within a line the runs come in ascending order.
using RunConsumer = void (*)(void* context, const std::vector<Run>& runs);
void scan_runs(const StripeImage& image, ScanLines scan, const ThresholdRule& rule, Kernel kernel,
               StripeScan& work, RunConsumer consume, void* context);

}  // namespace seamwright::detail
