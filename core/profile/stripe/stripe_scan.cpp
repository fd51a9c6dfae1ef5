#include "core/profile/stripe/stripe_scan.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace seamwright::detail {
namespace {

constexpr int kBatch = 1024;            // runs handed over at once: their pixels are still in the cache
constexpr int kSampledRows = 4;         // per tile
constexpr int kDifferenceStep = 2;      // px; neighbours of demosaiced or compressed images are correlated
constexpr double kSecondLane = 1.04;    // the second smallest of four lanes lies below their mean by that
constexpr double kQuantisation = 0.29;  // grey values, 1/sqrt(12): noise of rounding to whole ones
constexpr float kQuietest = 0.5F;       // of the frame's noise: no tile has less
constexpr std::size_t kMedianTiles = 500;
constexpr double kSqrtPi = 1.7724538509055160;

template <class Pixel>
const Pixel* row_of(const StripeImage& image, int y) {
    return reinterpret_cast<const Pixel*>(image.pixels + static_cast<std::size_t>(y) * image.row_bytes);
}

// A camera that clamps noise at black halves it: the true standard deviation over the measured one, as a
// function of mean/measured standard deviation of clamped Gaussian noise (computed by simulation; below 0.7
// it cannot be told).
double clamping(double mean_over_noise) {
    static constexpr double at[] = {0.70, 0.80, 0.98, 1.25, 1.61, 2.04, 2.51};
    static constexpr double factor[] = {2.5, 1.99, 1.40, 1.153, 1.051, 1.013, 1.0};
    if (mean_over_noise >= at[6]) return factor[6];
    if (mean_over_noise <= at[0]) return factor[0];
    for (int i = 1; i < 7; ++i)
        if (mean_over_noise < at[i])
            return factor[i - 1] +
                   (factor[i] - factor[i - 1]) * (mean_over_noise - at[i - 1]) / (at[i] - at[i - 1]);
    return 1.0;
}

// Differences are summed in four lanes of eight pixels: an edge that crosses the tile spoils one or two of
// them.
constexpr int kLanes = 4;

struct TileSums {
    std::uint32_t grey = 0;
    std::uint32_t difference[kLanes] = {};
};

template <class Pixel>
void add_row_portable(const Pixel* row, int count, int pairs, TileSums& sums) {
    for (int i = 0; i < count; ++i) sums.grey += row[i];
    for (int i = 0; i < pairs; ++i) {
        const int d = static_cast<int>(row[i]) - static_cast<int>(row[i + kDifferenceStep]);
        sums.difference[i / (kTile / kLanes)] += static_cast<std::uint32_t>(d < 0 ? -d : d);
    }
}

// Mean absolute difference of the second smallest lane, or of the only one.
double mean_difference(const TileSums& sums, int pairs) {
    if (pairs == kTile) {
        const std::uint32_t* d = sums.difference;
        const std::uint32_t low = std::min(d[0], d[1]), high = std::max(d[0], d[1]);
        const std::uint32_t other_low = std::min(d[2], d[3]), other_high = std::max(d[2], d[3]);
        const std::uint32_t second_of_all = std::min(std::max(low, other_low), std::min(high, other_high));
        return second_of_all / (kSampledRows * double(kTile / kLanes));
    }
    double smallest = 0, second = 0;
    int n = 0;
    constexpr int kLane = kTile / kLanes;
    for (int k = 0; k < kLanes; ++k) {
        const int of_lane = std::min(kLane, pairs - kLane * k);
        if (of_lane < kLane / 2 && (k > 0 || of_lane <= 0)) continue;
        const double mean = sums.difference[k] / (kSampledRows * double(of_lane));
        if (n == 0 || mean < smallest) {
            second = n == 0 ? mean : smallest;
            smallest = mean;
        } else if (n == 1 || mean < second) {
            second = mean;
        }
        ++n;
    }
    return second;
}

// Bits of the 32 pixels that exceed their limits.
template <class Pixel>
std::uint32_t mask_portable(const Pixel* row, const Pixel* limit) {
    bool any = false;
    for (int i = 0; i < 32; ++i) any |= row[i] > limit[i];
    if (!any) return 0;
    std::uint32_t mask = 0;
    for (int i = 0; i < 32; ++i) mask |= static_cast<std::uint32_t>(row[i] > limit[i]) << i;
    return mask;
}

// Collects runs and hands them over in batches.
struct Collector {
    StripeScan& work;
    RunConsumer consume;
    void* context;
    void add(int line, int begin, int end) {
        work.runs.push_back({line, begin, end});
        if (static_cast<int>(work.runs.size()) == kBatch) flush();
    }
    void flush() {
        if (!work.runs.empty()) consume(context, work.runs);
        work.runs.clear();
    }
};

// A change of the candidate bits of 32 neighbouring columns between row y - 1 and row y.
void column_edges(std::uint32_t changed, std::uint32_t mask, int first_column, int y, Collector& collector) {
    while (changed) {
        const int bit = std::countr_zero(changed);
        changed &= changed - 1;
        const int column = first_column + bit;
        if (mask >> bit & 1u) {
            collector.work.begin_of[column] = y;
        } else {
            collector.add(column, collector.work.begin_of[column], y);
        }
    }
}

// Runs of one row out of its candidate bits, 32 at a time; `open` is where an unfinished run began, or -1.
void row_edges(std::uint32_t mask, int first_column, int line, int& open, Collector& collector) {
    if (mask == 0) {
        if (open >= 0) collector.add(line, open, first_column);
        open = -1;
        return;
    }
    int at = 0;
    while (at < 32) {
        const std::uint32_t rest = mask >> at;
        if (open < 0) {
            if (rest == 0) return;
            at += std::countr_zero(rest);
            open = first_column + at;
        } else {
            const int ones = std::countr_one(rest);
            if (at + ones >= 32) return;
            at += ones;
            collector.add(line, open, first_column + at);
            open = -1;
        }
    }
}

template <class Pixel>
std::uint32_t tail_mask(const Pixel* row, const Pixel* limit, int count) {
    std::uint32_t mask = 0;
    for (int i = 0; i < count; ++i) mask |= static_cast<std::uint32_t>(row[i] > limit[i]) << i;
    return mask;
}

template <class Pixel>
void columns_row_portable(const Pixel* row, const Pixel* limit, int blocks, int y, Collector& collector) {
    std::uint32_t* open = collector.work.open_columns.data();
    for (int b = 0; b < blocks; ++b) {
        const std::uint32_t mask = mask_portable(row + 32 * b, limit + 32 * b);
        if (mask != open[b]) {
            column_edges(mask ^ open[b], mask, 32 * b, y, collector);
            open[b] = mask;
        }
    }
}

template <class Pixel>
void rows_row_portable(const Pixel* row, const Pixel* limit, int blocks, int y, int& open,
                       Collector& collector) {
    for (int b = 0; b < blocks; ++b) {
        const std::uint32_t mask = mask_portable(row + 32 * b, limit + 32 * b);
        if (mask != 0 || open >= 0) row_edges(mask, 32 * b, y, open, collector);
    }
}

#if defined(__x86_64__)

__attribute__((target("avx2"))) inline std::uint32_t mask_avx2(const std::uint8_t* row,
                                                               const std::uint8_t* limit) {
    const __m256i pixels = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
    const __m256i limits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(limit));
    // There is no unsigned compare: pixel <= limit exactly where the saturating difference is zero.
    const __m256i not_above = _mm256_cmpeq_epi8(_mm256_subs_epu8(pixels, limits), _mm256_setzero_si256());
    return ~static_cast<std::uint32_t>(_mm256_movemask_epi8(not_above));
}

__attribute__((target("avx2"))) inline std::uint32_t mask_avx2(const std::uint16_t* row,
                                                               const std::uint16_t* limit) {
    const __m256i zero = _mm256_setzero_si256();
    const auto* pixels = reinterpret_cast<const __m256i*>(row);
    const auto* limits = reinterpret_cast<const __m256i*>(limit);
    const __m256i low =
        _mm256_cmpeq_epi16(_mm256_subs_epu16(_mm256_loadu_si256(pixels), _mm256_loadu_si256(limits)), zero);
    const __m256i high = _mm256_cmpeq_epi16(
        _mm256_subs_epu16(_mm256_loadu_si256(pixels + 1), _mm256_loadu_si256(limits + 1)), zero);
    const __m256i packed = _mm256_permute4x64_epi64(_mm256_packs_epi16(low, high), 0xD8);
    return ~static_cast<std::uint32_t>(_mm256_movemask_epi8(packed));
}

// Nonzero where one of 32 pixels exceeds its limit.
__attribute__((target("avx2"))) inline __m256i above_avx2(const std::uint8_t* row,
                                                          const std::uint8_t* limit) {
    return _mm256_subs_epu8(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(row)),
                            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(limit)));
}

__attribute__((target("avx2"))) inline __m256i above_avx2(const std::uint16_t* row,
                                                          const std::uint16_t* limit) {
    const auto* pixels = reinterpret_cast<const __m256i*>(row);
    const auto* limits = reinterpret_cast<const __m256i*>(limit);
    return _mm256_or_si256(_mm256_subs_epu16(_mm256_loadu_si256(pixels), _mm256_loadu_si256(limits)),
                           _mm256_subs_epu16(_mm256_loadu_si256(pixels + 1), _mm256_loadu_si256(limits + 1)));
}

// Whether 128 pixels are all within their limits.
template <class Pixel>
__attribute__((target("avx2"))) inline bool dark_avx2(const Pixel* row, const Pixel* limit) {
    const __m256i above =
        _mm256_or_si256(_mm256_or_si256(above_avx2(row, limit), above_avx2(row + 32, limit + 32)),
                        _mm256_or_si256(above_avx2(row + 64, limit + 64), above_avx2(row + 96, limit + 96)));
    return _mm256_testz_si256(above, above);
}

template <class Pixel>
__attribute__((target("avx2"))) void columns_row_avx2(const Pixel* row, const Pixel* limit, int blocks, int y,
                                                      Collector& collector) {
    std::uint32_t* open = collector.work.open_columns.data();
    for (int b = 0; b < blocks;) {
        if (b + 4 <= blocks) {
            std::uint64_t opened[2];
            std::memcpy(opened, open + b, sizeof opened);
            if ((opened[0] | opened[1]) == 0 && dark_avx2(row + 32 * b, limit + 32 * b)) {
                b += 4;
                continue;
            }
        }
        for (const int end = std::min(b + 4, blocks); b < end; ++b) {
            const std::uint32_t mask = mask_avx2(row + 32 * b, limit + 32 * b);
            if (mask != open[b]) {
                column_edges(mask ^ open[b], mask, 32 * b, y, collector);
                open[b] = mask;
            }
        }
    }
}

template <class Pixel>
__attribute__((target("avx2"))) void rows_row_avx2(const Pixel* row, const Pixel* limit, int blocks, int y,
                                                   int& open, Collector& collector) {
    for (int b = 0; b < blocks;) {
        if (b + 4 <= blocks && open < 0 && dark_avx2(row + 32 * b, limit + 32 * b)) {
            b += 4;
            continue;
        }
        for (const int end = std::min(b + 4, blocks); b < end; ++b) {
            const std::uint32_t mask = mask_avx2(row + 32 * b, limit + 32 * b);
            if (mask != 0 || open >= 0) row_edges(mask, 32 * b, y, open, collector);
        }
    }
}

// The sampled rows of a tile, `rows` their first pixels.
__attribute__((target("avx2"))) void add_rows_avx2(const std::uint8_t* const* rows, TileSums& sums) {
    const __m256i zero = _mm256_setzero_si256();
    __m256i grey = zero, difference = zero;
    for (int k = 0; k < kSampledRows; ++k) {
        const __m256i a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(rows[k]));
        const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(rows[k] + kDifferenceStep));
        const __m256i distance = _mm256_or_si256(_mm256_subs_epu8(a, b), _mm256_subs_epu8(b, a));
        grey = _mm256_add_epi64(grey, _mm256_sad_epu8(a, zero));
        difference = _mm256_add_epi64(difference, _mm256_sad_epu8(distance, zero));
    }
    alignas(32) std::uint64_t g[4], d[4];
    _mm256_store_si256(reinterpret_cast<__m256i*>(g), grey);
    _mm256_store_si256(reinterpret_cast<__m256i*>(d), difference);
    for (int k = 0; k < kLanes; ++k) {
        sums.grey += static_cast<std::uint32_t>(g[k]);
        sums.difference[k] += static_cast<std::uint32_t>(d[k]);
    }
}

__attribute__((target("avx2"))) void add_rows_avx2(const std::uint16_t* const* rows, TileSums& sums) {
    const __m256i low = _mm256_set1_epi32(0xFFFF);
    for (int half = 0; half < 2; ++half) {
        __m256i grey = _mm256_setzero_si256(), difference = grey;
        for (int k = 0; k < kSampledRows; ++k) {
            const std::uint16_t* row = rows[k] + 16 * half;
            const __m256i a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
            const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row + kDifferenceStep));
            const __m256i distance = _mm256_or_si256(_mm256_subs_epu16(a, b), _mm256_subs_epu16(b, a));
            grey =
                _mm256_add_epi32(grey, _mm256_add_epi32(_mm256_and_si256(a, low), _mm256_srli_epi32(a, 16)));
            difference = _mm256_add_epi32(difference, _mm256_add_epi32(_mm256_and_si256(distance, low),
                                                                       _mm256_srli_epi32(distance, 16)));
        }
        alignas(32) std::uint32_t g[8], d[8];  // four of them per lane
        _mm256_store_si256(reinterpret_cast<__m256i*>(g), grey);
        _mm256_store_si256(reinterpret_cast<__m256i*>(d), difference);
        for (int i = 0; i < 8; ++i) {
            sums.grey += g[i];
            sums.difference[2 * half + i / 4] += d[i];
        }
    }
}

#else

template <class Pixel>
void add_rows_avx2(const Pixel* const*, TileSums&) {}
template <class Pixel>
void columns_row_avx2(const Pixel*, const Pixel*, int, int, Collector&) {}
template <class Pixel>
void rows_row_avx2(const Pixel*, const Pixel*, int, int, int&, Collector&) {}

#endif

template <class Pixel>
void measure_tiles(const StripeImage& image, bool avx2, StripeScan& work) {
    for (int ty = 0; ty < work.tile_rows; ++ty) {
        const int y0 = ty * kTile, height = std::min(kTile, image.height - y0);
        const Pixel* rows[kSampledRows];
        for (int k = 0; k < kSampledRows; ++k)
            rows[k] = row_of<Pixel>(image, y0 + height * (2 * k + 1) / (2 * kSampledRows));
        for (int tx = 0; tx < work.tile_columns; ++tx) {
            const int x0 = tx * kTile, width = std::min(kTile, image.width - x0);
            const int pairs = std::clamp(image.width - kDifferenceStep - x0, 0, width);
            TileSums sums;
            const Pixel* at[kSampledRows];
            for (int k = 0; k < kSampledRows; ++k) at[k] = rows[k] + x0;
            if (avx2 && pairs == kTile) {
                add_rows_avx2(at, sums);
            } else {
                for (const Pixel* row : at) add_row_portable(row, width, pairs, sums);
            }
            const int tile = ty * work.tile_columns + tx;
            work.background[tile] = static_cast<float>(sums.grey) / static_cast<float>(kSampledRows * width);
            // Quantisation is noise also where the differences do not show it.
            const double measured =
                std::max(kSecondLane * 0.5 * kSqrtPi * mean_difference(sums, pairs), kQuantisation);
            work.noise[tile] = static_cast<float>(measured * clamping(work.background[tile] / measured));
        }
    }
}

using Four = float __attribute__((vector_size(16)));

struct Smaller {
    static Four of(Four a, Four b) { return a < b ? a : b; }
    static float of(float a, float b) { return a < b ? a : b; }
};
struct Larger {
    static Four of(Four a, Four b) { return a > b ? a : b; }
    static float of(float a, float b) { return a > b ? a : b; }
};

// out[i] = pick of in[k][i] over all k < count, for i < size.
template <class Pick>
void pick_of(const float* const* in, int count, int size, float* out) {
    int i = 0;
    for (; i + 4 <= size; i += 4) {
        Four value, next;
        std::memcpy(&value, in[0] + i, sizeof value);
        for (int k = 1; k < count; ++k) {
            std::memcpy(&next, in[k] + i, sizeof next);
            value = Pick::of(value, next);
        }
        std::memcpy(out + i, &value, sizeof value);
    }
    for (; i < size; ++i) {
        out[i] = in[0][i];
        for (int k = 1; k < count; ++k) out[i] = Pick::of(out[i], in[k][i]);
    }
}

// Running minimum (or maximum) of 2 * reach + 1 tiles along the scan direction, fewer at the border.
template <class Pick>
void running(const std::vector<float>& in, std::vector<float>& out, StripeScan& work, ScanLines scan,
             int reach) {
    const int columns = work.tile_columns, rows = work.tile_rows;
    const int along = scan == ScanLines::columns ? rows : columns;
    reach = std::min(reach, along - 1);
    work.taps.resize(static_cast<std::size_t>(2 * reach + 1));
    const int count = static_cast<int>(work.taps.size());
    if (scan == ScanLines::rows) work.padded.resize(static_cast<std::size_t>(columns + 2 * reach));
    for (int row = 0; row < rows; ++row) {
        const float* from = in.data() + static_cast<std::ptrdiff_t>(row) * columns;
        for (int k = 0; k < count; ++k) {
            // The border repeats its tile, which is within reach anyway.
            const int other = std::clamp(row + k - reach, 0, rows - 1);
            work.taps[k] = scan == ScanLines::rows ? work.padded.data() + k
                                                   : in.data() + static_cast<std::ptrdiff_t>(other) * columns;
        }
        if (scan == ScanLines::rows) {
            std::fill_n(work.padded.begin(), reach, from[0]);
            std::copy_n(from, columns, work.padded.begin() + reach);
            std::fill_n(work.padded.begin() + reach + columns, reach, from[columns - 1]);
        }
        pick_of<Pick>(work.taps.data(), count, columns,
                      out.data() + static_cast<std::ptrdiff_t>(row) * columns);
    }
}

void open_map(std::vector<float>& map, StripeScan& work, ScanLines scan, int reach) {
    running<Smaller>(map, work.scratch, work, scan, reach);
    running<Larger>(work.scratch, map, work, scan, reach);
}

template <class Pixel>
void fill_limits(const StripeImage& image, const ThresholdRule& rule, const StripeScan& work, int tile_row,
                 std::vector<Pixel>& limits) {
    const double top = image.full_scale();
    for (int tx = 0; tx < work.tile_columns; ++tx) {
        const int tile = tile_row * work.tile_columns + tx;
        // A candidate is at or above background + threshold, that is above the next whole grey value below
        // it.
        const double at_least = std::ceil(work.background[tile] + rule.of(work.noise[tile]));
        const auto limit = static_cast<Pixel>(std::clamp(at_least - 1.0, 0.0, top));
        std::fill_n(limits.begin() + static_cast<std::ptrdiff_t>(tx) * kTile, kTile, limit);
    }
}

template <class Pixel>
void scan_image(const StripeImage& image, ScanLines scan, const ThresholdRule& rule, bool avx2,
                StripeScan& work, std::vector<Pixel>& limits, Collector& collector) {
    const int blocks = image.width / 32, rest = image.width % 32;
    limits.resize(static_cast<std::size_t>(work.tile_columns) * kTile);
    std::fill(work.open_columns.begin(), work.open_columns.end(), 0u);
    for (int y = 0; y < image.height; ++y) {
        if (y % kTile == 0) fill_limits(image, rule, work, y / kTile, limits);
        const Pixel* row = row_of<Pixel>(image, y);
        const std::uint32_t tail =
            rest ? tail_mask(row + 32 * blocks, limits.data() + 32 * blocks, rest) : 0u;
        if (scan == ScanLines::columns) {
            if (avx2) {
                columns_row_avx2(row, limits.data(), blocks, y, collector);
            } else {
                columns_row_portable(row, limits.data(), blocks, y, collector);
            }
            if (rest && tail != work.open_columns[blocks]) {
                column_edges(tail ^ work.open_columns[blocks], tail, 32 * blocks, y, collector);
                work.open_columns[blocks] = tail;
            }
        } else {
            int open = -1;
            if (avx2) {
                rows_row_avx2(row, limits.data(), blocks, y, open, collector);
            } else {
                rows_row_portable(row, limits.data(), blocks, y, open, collector);
            }
            if (rest) row_edges(tail, 32 * blocks, y, open, collector);
            if (open >= 0) collector.add(y, open, image.width);
        }
    }
    if (scan == ScanLines::columns) {
        for (int b = 0; b < static_cast<int>(work.open_columns.size()); ++b)
            column_edges(work.open_columns[b], 0u, 32 * b, image.height, collector);
    }
    collector.flush();
}

}  // namespace

bool has_avx2(Kernel kernel) {
#if defined(__x86_64__)
    static const bool available = __builtin_cpu_supports("avx2");
    return available && kernel == Kernel::best;
#else
    (void)kernel;
    return false;
#endif
}

void measure_background(const StripeImage& image, ScanLines scan, double max_width_px, Kernel kernel,
                        StripeScan& work) {
    work.tile_columns = (image.width + kTile - 1) / kTile;
    work.tile_rows = (image.height + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(work.tile_columns) * static_cast<std::size_t>(work.tile_rows);
    work.background.resize(tiles);
    work.noise.resize(tiles);
    work.scratch.resize(tiles);
    work.open_columns.resize(static_cast<std::size_t>(work.tile_columns));
    work.begin_of.resize(static_cast<std::size_t>(work.tile_columns) * kTile);
    work.runs.reserve(kBatch);
    const bool avx2 = has_avx2(kernel);
    if (image.bytes_per_pixel() == 1) {
        measure_tiles<std::uint8_t>(image, avx2, work);
    } else {
        measure_tiles<std::uint16_t>(image, avx2, work);
    }
    // Some hundred tiles are enough for the median; the step is odd, so that it passes through all columns.
    const std::size_t step = tiles / kMedianTiles | 1;
    std::size_t sampled = 0;
    for (std::size_t i = 0; i < tiles; i += step) work.scratch[sampled++] = work.noise[i];
    const auto begin = work.scratch.begin(), middle = begin + static_cast<std::ptrdiff_t>(sampled / 2);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(sampled));
    work.frame_noise = *middle;
    const int reach = static_cast<int>(std::ceil(max_width_px / kTile + 1.0)) / 2 + 1;
    open_map(work.background, work, scan, reach);
    open_map(work.noise, work, scan, reach);
    const float least_noise = kQuietest * work.frame_noise;
    for (float& noise : work.noise) noise = std::max(noise, least_noise);
}

void scan_runs(const StripeImage& image, ScanLines scan, const ThresholdRule& rule, Kernel kernel,
               StripeScan& work, RunConsumer consume, void* context) {
    work.runs.clear();
    Collector collector{work, consume, context};
    const bool avx2 = has_avx2(kernel);
    if (image.bytes_per_pixel() == 1) {
        scan_image<std::uint8_t>(image, scan, rule, avx2, work, work.limit8, collector);
    } else {
        scan_image<std::uint16_t>(image, scan, rule, avx2, work, work.limit16, collector);
    }
}

}  // namespace seamwright::detail
