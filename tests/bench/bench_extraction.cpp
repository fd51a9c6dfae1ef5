// Extraction of stripe peaks, beside the same job as a loop over cv::Mat::at, and beside what the memory
// delivers.

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "core/profile/stripe/peaks.h"

namespace seamwright {
namespace {

constexpr int kWidth = 2048, kHeight = 1088;

// A part seen by a camera: dim background with noise, a stripe of 6 px full width with a step, a weaker
// reflection on a fifth of the lines. `rows` turns it by 90 degrees in the same format.
template <class Pixel>
cv::Mat part_frame(int type, int full_scale, ScanLines scan) {
    cv::Mat frame(kHeight, kWidth, type);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const double scale = full_scale / 255.0;
    const int lines = scan == ScanLines::columns ? kWidth : kHeight;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const double line = scan == ScanLines::columns ? x : y, at = scan == ScanLines::columns ? y : x;
            const double part = line / lines;
            const double centre = 420 + 120 * std::sin(5 * part) + (part > 0.6 ? 60 : 0);
            const auto hump = [&](double c, double w, double h) {
                const double u = (at - c) / w;
                return std::abs(u) < 6 ? h * std::exp(-0.5 * u * u) : 0.0;
            };
            double grey = 12 + hump(centre, 2.5, 190);
            if (part > 0.3 && part < 0.5) grey += hump(centre + 200, 3, 60);
            grey += std::sqrt(1 + grey / 30) * normal(random);
            frame.at<Pixel>(y, x) =
                static_cast<Pixel>(std::lround(std::clamp(grey * scale, 0.0, double(full_scale))));
        }
    }
    return frame;
}

const cv::Mat& frame_of(int bit_depth, ScanLines scan) {
    static const cv::Mat frames[2][2] = {{part_frame<std::uint8_t>(CV_8U, 255, ScanLines::columns),
                                          part_frame<std::uint8_t>(CV_8U, 255, ScanLines::rows)},
                                         {part_frame<std::uint16_t>(CV_16U, 4095, ScanLines::columns),
                                          part_frame<std::uint16_t>(CV_16U, 4095, ScanLines::rows)}};
    return frames[bit_depth > 8][scan == ScanLines::rows];
}

StripeImage view_of(const cv::Mat& frame, int bit_depth) {
    return {reinterpret_cast<const std::byte*>(frame.data), frame.cols, frame.rows, frame.step[0], bit_depth};
}

// The peer, as one writes it with OpenCV: in every column the highest pixel above a threshold, and the mean
// position about it weighted by the grey value above the threshold. It knows the threshold beforehand, has
// one peak a column, no width and no background.
void opencv_columns(const cv::Mat& frame, std::vector<float>& positions) {
    constexpr int kThreshold = 40;
    positions.resize(static_cast<std::size_t>(frame.cols));
    for (int x = 0; x < frame.cols; ++x) {
        int highest = kThreshold, at = -1;
        for (int y = 0; y < frame.rows; ++y) {
            const int grey = frame.at<std::uint8_t>(y, x);
            if (grey > highest) {
                highest = grey;
                at = y;
            }
        }
        if (at < 0) {
            positions[static_cast<std::size_t>(x)] = std::numeric_limits<float>::quiet_NaN();
            continue;
        }
        int first = at, last = at;
        while (first > 0 && frame.at<std::uint8_t>(first - 1, x) > kThreshold) --first;
        while (last + 1 < frame.rows && frame.at<std::uint8_t>(last + 1, x) > kThreshold) ++last;
        double sum = 0, moment = 0;
        for (int y = first; y <= last; ++y) {
            const double weight = frame.at<std::uint8_t>(y, x) - kThreshold;
            sum += weight;
            moment += weight * y;
        }
        positions[static_cast<std::size_t>(x)] = static_cast<float>(moment / sum);
    }
}

// Reading a buffer far larger than the caches.
double read_once(const std::vector<std::uint64_t>& memory) {
    std::uint64_t a = 0, b = 0, c = 0, d = 0;
    for (std::size_t i = 0; i + 32 <= memory.size(); i += 32) {
        for (std::size_t k = 0; k < 32; k += 4) {
            a += memory[i + k];
            b += memory[i + k + 1];
            c += memory[i + k + 2];
            d += memory[i + k + 3];
        }
    }
    return static_cast<double>(a + b + c + d);
}

void extraction(benchmark::State& state) {
    const int bit_depth = static_cast<int>(state.range(0));
    PeakOptions options;
    options.scan = state.range(1) ? ScanLines::rows : ScanLines::columns;
    options.method = static_cast<PeakMethod>(state.range(2));
    options.per_line = static_cast<int>(state.range(3));
    const cv::Mat& frame = frame_of(bit_depth, options.scan);
    const StripeImage image = view_of(frame, bit_depth);
    StripePeaks peaks;
    for (auto _ : state) {
        benchmark::DoNotOptimize(find_peaks(image, options, peaks).has_value());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * kWidth * kHeight *
                            image.bytes_per_pixel());
}
BENCHMARK(extraction)
    ->ArgNames({"bits", "rows", "method", "peaks"})
    ->Args({8, 0, 0, 1})
    ->Args({8, 0, 0, 3})
    ->Args({8, 0, 1, 3})
    ->Args({8, 0, 2, 3})
    ->Args({8, 1, 0, 3})
    ->Args({12, 0, 0, 3})
    ->Args({12, 1, 0, 3})
    ->Unit(benchmark::kMicrosecond);

void opencv_at(benchmark::State& state) {
    const cv::Mat& frame = frame_of(8, ScanLines::columns);
    std::vector<float> positions;
    for (auto _ : state) {
        opencv_columns(frame, positions);
        benchmark::DoNotOptimize(positions.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * kWidth * kHeight);
}
BENCHMARK(opencv_at)->Unit(benchmark::kMicrosecond);

// Processor seconds of this thread: others on the machine do not count.
double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Best of many runs: what the machine can do when nobody disturbs it.
template <class Job>
double best_seconds(int runs, Job job) {
    double best = 1e9;
    for (int i = 0; i < runs; ++i) {
        const double start = thread_seconds();
        job();
        best = std::min(best, thread_seconds() - start);
    }
    return best;
}

double extraction_seconds(int bit_depth, ScanLines scan, int per_line) {
    PeakOptions options;
    options.scan = scan;
    options.per_line = per_line;
    const StripeImage image = view_of(frame_of(bit_depth, scan), bit_depth);
    StripePeaks peaks;
    return best_seconds(100,
                        [&] { benchmark::DoNotOptimize(find_peaks(image, options, peaks).has_value()); });
}

void print_ratios() {
    std::vector<float> positions;
    const cv::Mat& frame = frame_of(8, ScanLines::columns);
    const double peer = best_seconds(15, [&] { opencv_columns(frame, positions); });
    StripePeaks peaks;
    (void)find_peaks(view_of(frame, 8), {}, peaks);
    int agree = 0;
    for (int x = 0; x < kWidth; ++x)
        agree += peaks.count[x] > 0 && std::abs(peaks.position_px[peaks.index(x, 0)] - positions[x]) < 0.1;
    const std::vector<std::uint64_t> memory(std::size_t(1) << 24, 1);  // 128 MiB
    const double read = best_seconds(8, [&] { benchmark::DoNotOptimize(read_once(memory)); });
    const double bandwidth = memory.size() * 8.0 / read;
    const double one = extraction_seconds(8, ScanLines::columns, 1);
    const double three = extraction_seconds(8, ScanLines::columns, 3);
    const double rows = extraction_seconds(8, ScanLines::rows, 3);
    const double deep = extraction_seconds(12, ScanLines::columns, 3);
    const double bytes = double(kWidth) * kHeight;
    fmt::print(
        "extraction 2048x1088, 8 bit, centre of gravity, columns: {:.3f} ms; cv::Mat::at loop {:.3f} ms "
        "(positions agree within 0.1 px on {} of {} columns)\n",
        one * 1e3, peer * 1e3, agree, kWidth);
    fmt::print("ratio extraction_vs_opencv_at: {:.1f}x\n", peer / one);
    fmt::print("ratio extraction_3_peaks_vs_opencv_at: {:.1f}x\n", peer / three);
    fmt::print("ratio extraction_rows_vs_opencv_at: {:.1f}x\n", peer / rows);
    fmt::print("ratio extraction_12_bit_vs_opencv_at_8_bit: {:.1f}x\n", peer / deep);
    fmt::print("share extraction_of_memory_read_bandwidth: {:.0f} % ({:.1f} of {:.1f} GB/s)\n",
               100 * bytes / one / bandwidth, bytes / one * 1e-9, bandwidth * 1e-9);
}

}  // namespace
}  // namespace seamwright

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    seamwright::print_ratios();
    return 0;
}
