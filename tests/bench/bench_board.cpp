// Finding a checkerboard beside cv::findChessboardCorners and its sector-based sibling, on rendered pictures
// of 1.3 and 20 megapixels; without a board alone, since the quad finder then takes minutes.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <opencv2/calib3d.hpp>

#include "core/calibration/board/board_checker.h"
#include "tests/core/calibration/board/board_scene.h"

namespace seamwright {
namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

test::BoardPicture picture_of(int width, int height, bool board) {
    test::BoardScene s;
    s.width = width, s.height = height, s.focal = 1.2 * width, s.board = board;
    std::mt19937 random(1);
    s = test::posed(s, 30, 0.05 * height, random);
    return test::render(s);
}

void compare(const char* name, test::BoardPicture picture, bool peers) {
    const cv::Mat grey(picture.height, picture.width, CV_8U, picture.pixels.data());
    BoardSpec spec;
    spec.columns = 7, spec.rows = 6, spec.pitch_mm = 10;
    double ours = 1e300;
    bool found = false;
    for (int i = 0; i < 3; ++i) {
        const double t = now_ms();
        found = detail::find_checker(grey, 255, spec).board.has_value();
        ours = std::min(ours, now_ms() - t);
    }
    std::printf("board, %s: ours %.1f ms (%s)\n", name, ours, found ? "found" : "not found");
    if (!peers) return;
    std::vector<cv::Point2f> corners;
    double t = now_ms();
    bool theirs = cv::findChessboardCorners(grey, {7, 6}, corners);
    const double quads = now_ms() - t;
    t = now_ms();
    const bool sectors_found = cv::findChessboardCornersSB(grey, {7, 6}, corners);
    const double sectors = now_ms() - t;
    std::printf("ratio board_vs_quads_%s: %.2fx (OpenCV %.1f ms, %s)\n", name, quads / ours, quads,
                theirs ? "found" : "not found");
    std::printf("ratio board_vs_sectors_%s: %.2fx (OpenCV %.1f ms, %s)\n", name, sectors / ours, sectors,
                sectors_found ? "found" : "not found");
}

// The other patterns, where nothing is to be found: every dictionary and every threshold is tried.
void without(const char* name, test::BoardPicture picture) {
    const StripeImage image{reinterpret_cast<const std::byte*>(picture.pixels.data()), picture.width,
                            picture.height, static_cast<std::size_t>(picture.width), 8};
    for (const BoardPattern pattern :
         {BoardPattern::circles, BoardPattern::charuco, BoardPattern::aprilgrid}) {
        BoardSpec spec;
        spec.pattern = pattern;
        spec.columns = 7, spec.rows = 6, spec.pitch_mm = 10;
        if (pattern == BoardPattern::aprilgrid) spec.marker_mm = 7;
        double ours = 1e300;
        bool found = false;
        for (int i = 0; i < 3; ++i) {
            const double t = now_ms();
            found = find_board(image, spec).board.has_value();
            ours = std::min(ours, now_ms() - t);
        }
        std::printf("%s, %s: %.1f ms (%s)\n", std::string(name_of(pattern)).c_str(), name, ours,
                    found ? "found" : "not found");
    }
}

void BM_board(benchmark::State& state) {
    auto picture = picture_of(1280, 1024, true);
    const cv::Mat grey(picture.height, picture.width, CV_8U, picture.pixels.data());
    BoardSpec spec;
    spec.columns = 7, spec.rows = 6, spec.pitch_mm = 10;
    for (auto _ : state) benchmark::DoNotOptimize(detail::find_checker(grey, 255, spec));
}
BENCHMARK(BM_board)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace seamwright

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    using seamwright::compare;
    using seamwright::picture_of;
    compare("1.3MP", picture_of(1280, 1024, true), true);
    compare("1.3MP_without", picture_of(1280, 1024, false), false);
    compare("20MP", picture_of(5472, 3648, true), false);
    compare("20MP_without", picture_of(5472, 3648, false), false);
    // A chessboard is a picture full of squares, of which none is a marker.
    using seamwright::without;
    without("1.3 MP of clutter", picture_of(1280, 1024, false));
    without("1.3 MP with a chessboard", picture_of(1280, 1024, true));
    without("20 MP of clutter", picture_of(5472, 3648, false));
    without("20 MP with a chessboard", picture_of(5472, 3648, true));
}
