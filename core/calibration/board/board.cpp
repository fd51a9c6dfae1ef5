#include "core/calibration/board/board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_detectors.h"
#include "core/calibration/camera/camera.h"

namespace seamwright {

Expected<void> validate(const BoardSpec& spec) {
    if (spec.columns < 3 || spec.rows < 3 || spec.columns > 200 || spec.rows > 200)
        return input_error(Text("a board of {}x{} points is not possible", std::to_string(spec.columns),
                                std::to_string(spec.rows)),
                           "board", "give columns x rows between 3 and 200, e.g. 7x6");
    if (!std::isfinite(spec.pitch_mm) || spec.pitch_mm <= 0)
        return input_error("the pitch must be a positive number of millimetres", "pitch_mm", "give e.g. 10");
    if (spec.pitch_mm < 0.2)
        return input_error(Text("a pitch of {} mm looks like metres", std::to_string(spec.pitch_mm)),
                           "pitch_mm", "give the pitch in millimetres (0.01 m = 10 mm)");
    if (spec.pitch_mm > 1000)
        return input_error("a pitch beyond one metre looks like micrometres", "pitch_mm",
                           "give the pitch in millimetres");
    if (spec.pattern == BoardPattern::charuco && spec.marker_mm != 0 &&
        !(spec.marker_mm > 0 && spec.marker_mm < spec.pitch_mm))
        return input_error("the marker must be smaller than its square", "marker_mm",
                           "give e.g. 0.75 of the pitch");
    return {};
}

namespace detail {

cv::Mat grey_of(const StripeImage& image) {
    cv::Mat out;
    if (image.empty()) return out;
    auto* data = const_cast<std::byte*>(image.pixels);
    if (image.bytes_per_pixel() == 1)
        cv::Mat(image.height, image.width, CV_8UC1, data, image.row_bytes).copyTo(out);
    else
        cv::Mat(image.height, image.width, CV_16UC1, data, image.row_bytes)
            .convertTo(out, CV_8U, 255.0 / image.full_scale());
    return out;
}

cv::Mat stripe_mask(const cv::Mat& grey) {
    // The stripe is the long connected piece near saturation. Glints are short and stay as they are.
    cv::Mat bright, labels, stats, centres;
    cv::threshold(grey, bright, 235, 255, cv::THRESH_BINARY);
    const int count = cv::connectedComponentsWithStats(bright, labels, stats, centres, 8);
    cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8U);
    const int least = std::max(grey.cols, grey.rows) / 12;
    for (int i = 1; i < count; ++i) {
        const int w = stats.at<int>(i, cv::CC_STAT_WIDTH), h = stats.at<int>(i, cv::CC_STAT_HEIGHT);
        const int area = stats.at<int>(i, cv::CC_STAT_AREA);
        // Long and thin: its area is a small part of the square over its length.
        const int length = std::max(w, h);
        if (length >= least && area < 0.35 * length * length) mask.setTo(255, labels == i);
    }
    return mask;
}

cv::Mat without_stripe(const cv::Mat& grey, const cv::Mat& stripe) {
    if (cv::countNonZero(stripe) == 0) return grey.clone();
    cv::Mat wide;
    cv::dilate(stripe, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15}));
    // Fill with the blurred surroundings (normalised convolution), so that no new edge arises.
    cv::Mat value, weight;
    grey.convertTo(value, CV_32F);
    cv::Mat keep = (wide == 0);
    keep.convertTo(weight, CV_32F, 1.0 / 255);
    value = value.mul(weight);
    cv::Mat sum, total;
    cv::boxFilter(value, sum, CV_32F, {81, 81});
    cv::boxFilter(weight, total, CV_32F, {81, 81});
    cv::Mat fill = sum / cv::max(total, 1e-3f), fill8, out = grey.clone();
    fill.convertTo(fill8, CV_8U);
    fill8.copyTo(out, wide);
    return out;
}

cv::Mat stretched(const cv::Mat& grey, const cv::Mat& ignore, double gamma) {
    std::array<int, 256> histogram{};
    int total = 0;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x)
            if (ignore.empty() || !ignore.at<std::uint8_t>(y, x)) {
                ++histogram[grey.at<std::uint8_t>(y, x)];
                ++total;
            }
    const auto quantile = [&](double q) {
        int sum = 0;
        for (int i = 0; i < 256; ++i)
            if ((sum += histogram[static_cast<std::size_t>(i)]) > q * total) return i;
        return 255;
    };
    const double low = quantile(0.005), high = std::max<double>(quantile(0.985), low + 4);
    cv::Mat table(1, 256, CV_8U), out;
    for (int i = 0; i < 256; ++i)
        table.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(
            255 * std::pow(std::clamp((i - low) / (high - low), 0.0, 1.0), gamma));
    cv::LUT(grey, table, out);
    return out;
}

}  // namespace detail

namespace {

using detail::grey_of;
using Corners = std::vector<cv::Point2f>;

// Spacing of neighbours, smallest over the board: bounds the window of the sub-pixel search.
double smallest_spacing(const Corners& corners, int columns, int rows) {
    double least = 1e9;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c + 1 < columns; ++c)
            least = std::min(least, cv::norm(corners[static_cast<std::size_t>(r * columns + c + 1)] -
                                             corners[static_cast<std::size_t>(r * columns + c)]));
    for (int r = 0; r + 1 < rows; ++r)
        for (int c = 0; c < columns; ++c)
            least = std::min(least, cv::norm(corners[static_cast<std::size_t>((r + 1) * columns + c)] -
                                             corners[static_cast<std::size_t>(r * columns + c)]));
    return least;
}

// Whether the lattice bends as a wide lens bends it: all cells of one orientation, and along every line the
// spacing changes by less than 40 % from one corner to the next.
bool regular(const Corners& corners, int columns, int rows) {
    const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * columns + c)]; };
    const auto even = [](const cv::Point2f& a, const cv::Point2f& b, const cv::Point2f& c) {
        return cv::norm(a - 2 * b + c) < 0.2 * cv::norm(c - a);
    };
    int left = 0, cells = 0;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            if (c > 0 && c + 1 < columns && !even(at(c - 1, r), at(c, r), at(c + 1, r))) return false;
            if (r > 0 && r + 1 < rows && !even(at(c, r - 1), at(c, r), at(c, r + 1))) return false;
            if (c + 1 == columns || r + 1 == rows) continue;
            const cv::Point2f x = at(c + 1, r) - at(c, r), y = at(c, r + 1) - at(c, r);
            left += x.x * y.y - x.y * y.x > 0;
            ++cells;
        }
    return left == 0 || left == cells;
}

// A lattice that a camera can have made: its homography explains every corner to a fraction of the spacing,
// or to less than the spacing where the lattice is regular (strong distortion).
bool plausible(const Corners& corners, int columns, int rows, const cv::Size& size) {
    std::vector<Eigen::Vector2d> grid, image;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const auto& p = corners[static_cast<std::size_t>(r * columns + c)];
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || p.x < 0 || p.y < 0 || p.x > size.width ||
                p.y > size.height)
                return false;
            grid.emplace_back(c, r);
            image.emplace_back(p.x, p.y);
        }
    const double spacing = smallest_spacing(corners, columns, rows);
    if (spacing < 4) return false;
    const auto h = homography_dlt(grid, image);
    if (!h) return false;
    double worst = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const Eigen::Vector3d q = *h * grid[i].homogeneous();
        worst = std::max(worst, (q.hnormalized() - image[i]).norm());
    }
    return worst < 0.3 * spacing || (worst < spacing && regular(corners, columns, rows));
}

std::optional<Corners> classic(const cv::Mat& image, const cv::Size& pattern, int flags) {
    Corners corners;
    if (!cv::findChessboardCorners(image, pattern, corners, flags)) return std::nullopt;
    return corners;
}

std::optional<Corners> sector_based(const cv::Mat& image, const cv::Size& pattern, int flags) {
    Corners corners;
    if (!cv::findChessboardCornersSB(image, pattern, corners, flags)) return std::nullopt;
    return corners;
}

// Sub-pixel search, each corner with a window that stays inside its own four squares: in a strongly tilted
// view one window for all either wastes the near corners or reaches over the far squares.
void refine_corners(const cv::Mat& image, Corners& corners, int columns, int rows) {
    const Corners rough = corners;
    const auto at = [&](int c, int r) { return rough[static_cast<std::size_t>(r * columns + c)]; };
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            double least = 1e9;
            for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                if (c + dc >= 0 && c + dc < columns && r + dr >= 0 && r + dr < rows)
                    least = std::min(least, cv::norm(at(c + dc, r + dr) - at(c, r)));
            const int window = std::clamp(static_cast<int>(0.4 * least), 2, 11);
            Corners one{at(c, r)};
            cv::cornerSubPix(image, one, {window, window}, {-1, -1},
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
            corners[static_cast<std::size_t>(r * columns + c)] = one[0];
        }
}

// A corner whose neighbours say that it lies elsewhere (the sub-pixel search got stuck on an edge, or the
// rough corner was one of the next square's) is looked for again where they say. What lies right is found at
// the same place again.
void mend_corners(const cv::Mat& image, Corners& corners, int columns, int rows) {
    std::vector<Eigen::Vector2d> grid, found;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const auto& p = corners[static_cast<std::size_t>(r * columns + c)];
            grid.emplace_back(c, r);
            found.emplace_back(p.x, p.y);
        }
    const auto h = homography_dlt(grid, found);
    if (!h) return;
    // Off the plane's homography the lens bends smoothly: what a corner departs more than those around it.
    std::vector<Eigen::Vector2d> plane, off;
    for (std::size_t i = 0; i < grid.size(); ++i) {
        plane.push_back((*h * grid[i].homogeneous()).hnormalized());
        off.push_back(found[i] - plane[i]);
    }
    const auto around = [&](std::size_t i) {
        const int c = static_cast<int>(i) % columns, r = static_cast<int>(i) / columns;
        std::vector<double> u, v;
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                if ((dr == 0 && dc == 0) || c + dc < 0 || c + dc >= columns || r + dr < 0 || r + dr >= rows)
                    continue;
                const auto& o = off[static_cast<std::size_t>((r + dr) * columns + c + dc)];
                u.push_back(o.x());
                v.push_back(o.y());
            }
        const auto middle = [](std::vector<double>& x) {
            const auto at = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
            std::nth_element(x.begin(), at, x.end());
            return *at;
        };
        return Eigen::Vector2d(middle(u), middle(v));
    };
    const double limit = std::max(1.5, 0.04 * smallest_spacing(corners, columns, rows));
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const Eigen::Vector2d expected = plane[i] + around(i);
        if ((found[i] - expected).norm() <= limit) continue;
        Corners one{{static_cast<float>(expected.x()), static_cast<float>(expected.y())}};
        if (!cv::Rect2f(0, 0, static_cast<float>(image.cols), static_cast<float>(image.rows))
                 .contains(one[0]))
            continue;
        const int window = std::clamp(static_cast<int>(limit), 2, 5);
        cv::cornerSubPix(image, one, {window, window}, {-1, -1},
                         {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
        if ((Eigen::Vector2d(one[0].x, one[0].y) - expected).norm() < (found[i] - expected).norm())
            corners[i] = one[0];
    }
}

// Mean grey of the middle of square (c, r) (between corners c, c+1 and r, r+1).
double square_grey(const cv::Mat& image, const Corners& corners, int columns, int c, int r) {
    const auto at = [&](int i, int j) { return corners[static_cast<std::size_t>(j * columns + i)]; };
    const cv::Point2f p = 0.25f * (at(c, r) + at(c + 1, r) + at(c, r + 1) + at(c + 1, r + 1));
    const int x = cvRound(p.x), y = cvRound(p.y);
    double sum = 0;
    int n = 0;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
            if (x + dx >= 0 && y + dy >= 0 && x + dx < image.cols && y + dy < image.rows) {
                sum += image.at<std::uint8_t>(y + dy, x + dx);
                ++n;
            }
    return n ? sum / n : 0;
}

// Brings the order to one convention: right-handed as seen by the camera (x columns, y rows, z away from the
// viewer), and where the colours tell, the square between (0,0) and (1,1) is dark.
int canonical_order(const cv::Mat& image, Corners& corners, int columns, int rows) {
    const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * columns + c)]; };
    const cv::Point2f x = at(columns - 1, 0) - at(0, 0), y = at(0, rows - 1) - at(0, 0);
    if (x.x * y.y - x.y * y.x < 0)
        for (int r = 0; r < rows; ++r)
            std::reverse(corners.begin() + r * columns, corners.begin() + (r + 1) * columns);
    double even = 0, odd = 0;
    int n_even = 0, n_odd = 0;
    for (int r = 0; r + 1 < rows; ++r)
        for (int c = 0; c + 1 < columns; ++c) {
            const double g = square_grey(image, corners, columns, c, r);
            if ((r + c) % 2 == 0)
                even += g, ++n_even;
            else
                odd += g, ++n_odd;
        }
    const bool dark_first = even / n_even < odd / n_odd;
    if ((columns + rows) % 2 == 1) {
        if (!dark_first) std::reverse(corners.begin(), corners.end());
        return 1;
    }
    // Equal parity: a half turn keeps the colours. So does a quarter turn of a square board of an even number
    // of corners; with an odd number it changes them, which tells the quarter turns apart.
    if (columns == rows && columns % 2 == 1 && !dark_first) {
        Corners turned_corners(corners.size());
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < columns; ++c)
                turned_corners[static_cast<std::size_t>(r * columns + c)] = at(r, rows - 1 - c);
        corners = turned_corners;
    }
    return columns == rows && columns % 2 == 0 ? 4 : 2;
}

constexpr std::size_t kSmallImage = 640 * 512;  // px; there every attempt takes well below a second

// Whether a large image may show a board that the cheap attempts missed: black and white squares of similar
// size at half or quarter size, as taken, evened or with its local contrast raised. Small images are always
// worth it.
bool worth_the_effort(const cv::Mat& grey, const cv::Mat& even, const cv::Size& pattern) {
    if (even.total() <= kSmallImage) return true;
    cv::Mat local, small;
    cv::createCLAHE(4.0, {8, 8})->apply(even, local);
    for (const cv::Mat& image : {grey, even, local})
        for (const double scale : {0.5, 0.25}) {
            cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
            if (cv::checkChessboard(small, pattern)) return true;
        }
    return false;
}

std::optional<FoundBoard> find_chessboard(const cv::Mat& grey, const BoardSpec& spec, BoardEffort effort) {
    const cv::Size pattern(spec.columns, spec.rows);
    const cv::Mat stripe = detail::stripe_mask(grey);
    const cv::Mat clean = detail::without_stripe(grey, stripe);
    cv::Mat wide;
    cv::dilate(stripe, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {31, 31}));
    const cv::Mat even = detail::stretched(clean, wide, 1.0);

    struct Attempt {
        const char* name;
        bool plain;  // the image as it came
        double scale;
        double gamma;
        bool equalise;
        bool sector;
        int flags;
    };
    constexpr int kClassic = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
    // Cheap ones first; a half-size image hides texture and noise from the quad finder. Without the fast
    // check the quad finder takes seconds on a large noisy image, so that it runs on the half-size one first.
    static constexpr Attempt attempts[] = {
        {"quads, half size", false, 0.5, 1.0, false, false, kClassic | cv::CALIB_CB_FAST_CHECK},
        {"quads, as taken", true, 1.0, 1.0, false, false, kClassic | cv::CALIB_CB_FAST_CHECK},
        {"quads", false, 1.0, 1.0, false, false, kClassic | cv::CALIB_CB_FAST_CHECK},
        {"quads, half size", false, 0.5, 1.0, false, false, kClassic | cv::CALIB_CB_FAST_CHECK},
        {"sectors, half size", false, 0.5, 1.0, false, true, cv::CALIB_CB_NORMALIZE_IMAGE},
        {"quads, quarter size", false, 0.25, 1.0, false, false, kClassic},
        {"sectors", false, 1.0, 0.7, false, true, cv::CALIB_CB_NORMALIZE_IMAGE},
        {"sectors, as taken", true, 1.0, 1.0, false, true, cv::CALIB_CB_NORMALIZE_IMAGE},
        {"quads, as taken, half size", true, 0.5, 1.0, false, false, kClassic},
        {"quads, local contrast", false, 0.5, 0.7, true, false, kClassic},
        {"quads, as taken, thorough", true, 1.0, 1.0, false, false, kClassic},
        {"sectors, local contrast", false, 1.0, 1.0, true, true,
         cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE},
        {"quads, filtered", false, 1.0, 0.5, true, false, kClassic | cv::CALIB_CB_FILTER_QUADS},
    };
    constexpr double kLeastSpacingFromHalf = 20;  // px
    const bool small_image = grey.total() <= kSmallImage;
    constexpr std::size_t kFirstThorough = 8;  // from here on an attempt may take seconds
    // Quads of a noisy image at full size take up to half a minute when there is no whole board.
    const bool quick = effort == BoardEffort::quick && !small_image;
    for (std::size_t n = 0; n < std::size(attempts); ++n) {
        const Attempt& a = attempts[n];
        if (quick && (a.scale == 1 || n >= kFirstThorough)) continue;
        if (n == kFirstThorough && !worth_the_effort(grey, even, pattern)) break;
        if (a.scale < 1 && std::min(grey.cols, grey.rows) * a.scale < 200) continue;
        if (n == 0 && small_image) continue;
        cv::Mat image = a.plain ? grey : a.gamma == 1.0 ? even : detail::stretched(clean, wide, a.gamma);
        if (a.equalise) {
            cv::Mat local;
            cv::createCLAHE(4.0, {8, 8})->apply(image, local);
            image = local;
        }
        if (a.scale != 1) {
            cv::Mat small;
            cv::resize(image, small, {}, a.scale, a.scale, cv::INTER_AREA);
            image = small;
        }
        auto corners = a.sector ? sector_based(image, pattern, a.flags) : classic(image, pattern, a.flags);
        if (!corners) continue;
        for (auto& p : *corners) {
            p.x = static_cast<float>((p.x + 0.5) / a.scale - 0.5);
            p.y = static_cast<float>((p.y + 0.5) / a.scale - 0.5);
        }
        if (!plausible(*corners, spec.columns, spec.rows, grey.size())) continue;
        // Found at half size, corners of small squares start too far off for the sub-pixel search: the full
        // size has its chance first.
        if (n == 0 && smallest_spacing(*corners, spec.columns, spec.rows) < kLeastSpacingFromHalf) continue;
        cv::Mat soft;
        cv::GaussianBlur(a.plain ? grey : clean, soft, {}, 0.8);
        const Corners rough = *corners;
        refine_corners(soft, *corners, spec.columns, spec.rows);
        mend_corners(soft, *corners, spec.columns, spec.rows);
        const double spacing = smallest_spacing(*corners, spec.columns, spec.rows);
        bool walked = false;
        for (std::size_t i = 0; i < rough.size(); ++i)
            walked |= cv::norm(rough[i] - (*corners)[i]) > 0.4 * spacing;
        if (walked || !plausible(*corners, spec.columns, spec.rows, grey.size())) continue;
        FoundBoard board;
        board.symmetry = canonical_order(a.plain ? grey : clean, *corners, spec.columns, spec.rows);
        board.detector = a.name;
        for (int r = 0; r < spec.rows; ++r)
            for (int c = 0; c < spec.columns; ++c) {
                const int i = r * spec.columns + c;
                board.index.push_back(i);
                board.pixel.emplace_back((*corners)[static_cast<std::size_t>(i)].x,
                                         (*corners)[static_cast<std::size_t>(i)].y);
                board.object_mm.emplace_back(c * spec.pitch_mm, r * spec.pitch_mm, 0);
            }
        return board;
    }
    return std::nullopt;
}

}  // namespace

std::optional<FoundBoard> find_board(const StripeImage& image, const BoardSpec& spec, BoardEffort effort) {
    if (image.empty() || image.width < 32 || image.height < 32 || !validate(spec)) return std::nullopt;
    try {
        const cv::Mat grey = grey_of(image);
        switch (spec.pattern) {
            case BoardPattern::chessboard:
                return find_chessboard(grey, spec, effort);
            case BoardPattern::circles:
                return detail::find_circles(grey, spec);
            case BoardPattern::charuco:
                return detail::find_charuco(grey, spec);
        }
    } catch (const cv::Exception&) {
        // OpenCV refuses some degenerate images by exception: there is no board in them.
    }
    return std::nullopt;
}

FoundBoard turned(const FoundBoard& board, const BoardSpec& spec, int quarter_turns) {
    FoundBoard out = board;
    const int turns = ((quarter_turns % 4) + 4) % 4;
    for (std::size_t i = 0; i < board.index.size(); ++i) {
        int c = board.index[i] % spec.columns, r = board.index[i] / spec.columns;
        if (spec.columns == spec.rows) {
            for (int t = 0; t < turns; ++t) {
                const int old = c;
                c = spec.rows - 1 - r;
                r = old;
            }
        } else if (turns >= 2) {
            c = spec.columns - 1 - c;
            r = spec.rows - 1 - r;
        }
        out.index[i] = r * spec.columns + c;
        out.object_mm[i] = {c * spec.pitch_mm, r * spec.pitch_mm, 0};
    }
    return out;
}

std::vector<Eigen::Vector2d> outline(const FoundBoard& board, const BoardSpec& spec) {
    std::vector<Eigen::Vector2d> flat;
    for (const auto& p : board.object_mm) flat.push_back(p.head<2>());
    const auto h = homography_dlt(flat, board.pixel);
    if (!h) return {};
    const double m = spec.pattern == BoardPattern::charuco ? 0 : spec.pitch_mm;
    const double w = (spec.columns - 1) * spec.pitch_mm, t = (spec.rows - 1) * spec.pitch_mm;
    std::vector<Eigen::Vector2d> out;
    for (const auto& corner : {Eigen::Vector2d(-m, -m), Eigen::Vector2d(w + m, -m),
                               Eigen::Vector2d(w + m, t + m), Eigen::Vector2d(-m, t + m)})
        out.push_back((*h * corner.homogeneous()).hnormalized());
    return out;
}

}  // namespace seamwright
