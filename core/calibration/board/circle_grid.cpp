// Circle grids: dots by repeated thresholds, then a lattice grown dot by dot, which needs no guess of the
// perspective.

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_detectors.h"
#include "core/calibration/camera/camera.h"

namespace seamwright::detail {
namespace {

// An outline that counts as a dot.

// Its shorter axis over its longer one: flatter, it is another thing.
constexpr double kLeastAxes = 0.25;
constexpr double kLeastAxis_px = 1.2;     // the shorter semi-axis
constexpr double kMostUnelliptic = 0.15;  // relative, its area against the ellipse of its second moments
constexpr double kLeastHullShare = 0.85;  // its area over its hull's: a dot has no dents
// Outlines of one dot at several thresholds.
constexpr double kSameRadius = 0.4;      // of the radius, by which they may differ
constexpr double kAroundDot = 2.5;       // radii around a dot that are looked at in the whole picture
constexpr double kNextDotWithin = 0.33;  // of a step from where it is expected

constexpr double kSoft_px = 0.7;
constexpr double kLargestDot = 0.02;                   // of the picture's area
constexpr std::array kOffsets{6.0, 14.0};              // grey values that a dot is darker than around it
constexpr std::array kLevels{0.35, 0.45, 0.55, 0.65};  // between dark and light, that a dot is cut at
constexpr double kSameCentre = 0.5;                    // of the radius, from one another
constexpr double kOffGrid = 0.25;                      // of the spacing, from the grid's homography
constexpr double kMarkLarger = 1.25;  // than the middling dot of the grid: the orientation mark
constexpr double kLeastSine = 0.5;    // between a grid's two directions
constexpr double kLeastArea_px2 = 12;
constexpr std::size_t kMostSeeds = 60;

struct Dot {
    cv::Point2d centre;
    double radius = 0;
    int seen = 1;
};

// Dark ellipses of one binary image (dots white in it), none larger than `largest_px2`.
void ellipses(const cv::Mat& binary, double largest_px2, std::vector<Dot>& out) {
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(binary, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    for (const auto& c : contours) {
        if (c.size() < 8) continue;
        const cv::Rect box = cv::boundingRect(c);
        if (box.x <= 0 || box.y <= 0 || box.x + box.width >= binary.cols || box.y + box.height >= binary.rows)
            continue;
        const cv::Moments m = cv::moments(c);
        if (m.m00 < kLeastArea_px2 || m.m00 > largest_px2) continue;
        // An ellipse of semi-axes p, q has second moments p^2/4, q^2/4 and area pi p q.
        const double xx = m.mu20 / m.m00, xy = m.mu11 / m.m00, yy = m.mu02 / m.m00;
        const double half = 0.5 * (xx + yy), root = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
        const double p = 2 * std::sqrt(half + root), q = 2 * std::sqrt(std::max(0.0, half - root));
        if (q < kLeastAxes * p || q < kLeastAxis_px) continue;
        if (std::abs(m.m00 / (kPi * p * q) - 1) > kMostUnelliptic) continue;
        std::vector<cv::Point> hull;
        cv::convexHull(c, hull);
        if (m.m00 < kLeastHullShare * cv::contourArea(hull)) continue;
        out.push_back({{m.m10 / m.m00, m.m01 / m.m00}, std::sqrt(p * q), 1});
    }
}

std::vector<Dot> find_dots(const cv::Mat& grey) {
    std::vector<Dot> merged;
    const auto add = [&](const std::vector<Dot>& dots) {
        for (const auto& d : dots) {
            bool known = false;
            for (auto& m : merged) {
                const double apart = cv::norm(d.centre - m.centre);
                if (apart > kSameCentre * m.radius ||
                    std::abs(d.radius - m.radius) > kSameRadius * m.radius + 1)
                    continue;
                m.centre = (m.centre * m.seen + d.centre) * (1.0 / (m.seen + 1));
                m.radius = (m.radius * m.seen + d.radius) / (m.seen + 1);
                ++m.seen;
                known = true;
                break;
            }
            if (!known) merged.push_back(d);
        }
    };
    cv::Mat soft, binary;
    cv::GaussianBlur(grey, soft, {}, kSoft_px);
    const double largest_px2 = kLargestDot * static_cast<double>(grey.total());
    std::vector<Dot> dots;
    for (int threshold = 25; threshold <= 225; threshold += 12) {
        cv::threshold(soft, binary, threshold, 255, cv::THRESH_BINARY_INV);
        dots.clear();
        ellipses(binary, largest_px2, dots);
        add(dots);
    }
    for (const int block : {21, 41, 81}) {
        if (block >= std::min(grey.cols, grey.rows)) continue;
        for (const double offset : kOffsets) {
            cv::adaptiveThreshold(soft, binary, 255, cv::ADAPTIVE_THRESH_GAUSSIAN_C, cv::THRESH_BINARY_INV,
                                  block, offset);
            dots.clear();
            ellipses(binary, largest_px2, dots);
            add(dots);
        }
    }
    std::erase_if(merged, [](const Dot& d) { return d.seen < 3; });
    return merged;
}

// A dot of a reduced picture measured in the whole one, between its own darkness and that around it. What is not found
// again keeps its place.
void measure_in_full(const cv::Mat& full, Dot& dot) {
    const int half = static_cast<int>(std::ceil(kAroundDot * dot.radius)) + 2;
    const cv::Rect around =
        cv::Rect(cvRound(dot.centre.x) - half, cvRound(dot.centre.y) - half, 2 * half + 1, 2 * half + 1) &
        cv::Rect(0, 0, full.cols, full.rows);
    if (around.width < 8 || around.height < 8) return;
    cv::Mat soft, binary;
    cv::GaussianBlur(full(around), soft, {}, kSoft_px);
    double dark = 0, light = 0;
    cv::minMaxLoc(soft, &dark, &light);
    std::vector<Dot> seen, kept;
    for (const double level : kLevels) {
        cv::threshold(soft, binary, dark + level * (light - dark), 255, cv::THRESH_BINARY_INV);
        seen.clear();
        ellipses(binary, static_cast<double>(soft.total()), seen);
        for (Dot& d : seen) {
            d.centre += cv::Point2d(around.tl());
            if (cv::norm(d.centre - dot.centre) < kSameCentre * dot.radius &&
                std::abs(d.radius - dot.radius) < kSameRadius * dot.radius)
                kept.push_back(d);
        }
    }
    if (kept.size() < 2) return;
    dot.centre = {0, 0}, dot.radius = 0;
    for (const Dot& d : kept) {
        dot.centre += d.centre * (1.0 / static_cast<double>(kept.size()));
        dot.radius += d.radius / static_cast<double>(kept.size());
    }
}

using Cell = std::pair<int, int>;
using Lattice = std::map<Cell, std::size_t>;

// Nearest dot to a place within `reach`, not yet taken; npos when none.
std::size_t nearest(const std::vector<Dot>& dots, const std::vector<char>& taken, const cv::Point2d& place,
                    double reach) {
    std::size_t best = static_cast<std::size_t>(-1);
    double least = reach;
    for (std::size_t i = 0; i < dots.size(); ++i) {
        if (taken[i]) continue;
        const double d = cv::norm(dots[i].centre - place);
        if (d < least) least = d, best = i;
    }
    return best;
}

Lattice grow(const std::vector<Dot>& dots, std::size_t seed, const cv::Point2d& a, const cv::Point2d& b) {
    Lattice lattice{{{0, 0}, seed}};
    std::vector<char> taken(dots.size(), 0);
    taken[seed] = 1;
    std::map<Cell, std::pair<cv::Point2d, cv::Point2d>> steps{{{0, 0}, {a, b}}};
    std::deque<Cell> queue{{0, 0}};
    while (!queue.empty()) {
        const Cell c = queue.front();
        queue.pop_front();
        auto [sa, sb] = steps[c];
        const cv::Point2d here = dots[lattice[c]].centre;
        for (const auto& [di, dj] : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const Cell n{c.first + di, c.second + dj};
            if (lattice.count(n)) continue;
            const cv::Point2d step = di ? sa * di : sb * dj;
            const auto found = nearest(dots, taken, here + step, kNextDotWithin * cv::norm(step));
            if (found == static_cast<std::size_t>(-1)) continue;
            lattice[n] = found;
            taken[found] = 1;
            auto s = std::pair(sa, sb);
            (di ? s.first : s.second) = (dots[found].centre - here) * static_cast<double>(di ? di : dj);
            steps[n] = s;
            queue.push_back(n);
        }
    }
    return lattice;
}

// Window of `columns` x `rows` cells that holds most of the lattice; the count through `most`.
Cell best_window(const Lattice& lattice, int columns, int rows, std::size_t& most) {
    int i0 = 1 << 20, i1 = -i0, j0 = i0, j1 = -i0;
    for (const auto& [c, dot] : lattice) {
        i0 = std::min(i0, c.first), i1 = std::max(i1, c.first);
        j0 = std::min(j0, c.second), j1 = std::max(j1, c.second);
    }
    Cell best{i0, j0};
    most = 0;
    for (int i = i0; i <= std::max(i0, i1 - columns + 1); ++i)
        for (int j = j0; j <= std::max(j0, j1 - rows + 1); ++j) {
            std::size_t n = 0;
            for (const auto& [c, dot] : lattice)
                n += c.first >= i && c.first < i + columns && c.second >= j && c.second < j + rows;
            if (n > most) most = n, best = {i, j};
        }
    return best;
}

struct Placed {
    int column, row;
    std::size_t dot;
};

// The middle of a circle's picture is not the picture of its middle: near sides are larger. What lies between the two by
// the plate's homography (the lens' distortion left out: a circle is small) is taken off. With the circle's dual conic D
// (plate) its picture is H D H^T, whose middle is its last column.
void take_off_eccentricity(const std::vector<Dot>& dots, const std::vector<Placed>& placed,
                           FoundBoard& board) {
    std::vector<Eigen::Vector2d> grid;
    for (const Eigen::Vector3d& p : board.object_mm) grid.emplace_back(p.x(), p.y());
    const auto h = homography_dlt(grid, board.pixel);
    if (!h) return;
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Eigen::Vector3d seen = *h * grid[i].homogeneous();
        const Eigen::Vector2d middle = seen.hnormalized();
        // px a mm, of areas
        const Eigen::Matrix2d j =
            (h->topLeftCorner<2, 2>() - middle * h->bottomLeftCorner<1, 2>()) / seen.z();
        const double radius_mm = dots[placed[i].dot].radius / std::sqrt(std::abs(j.determinant()));
        Eigen::Matrix3d dual = -grid[i].homogeneous() * grid[i].homogeneous().transpose();
        dual(0, 0) += radius_mm * radius_mm;
        dual(1, 1) += radius_mm * radius_mm;
        const Eigen::Vector3d ellipse = *h * dual * h->row(2).transpose();
        board.pixel[i] -= ellipse.hnormalized() - middle;
    }
}

std::optional<FoundBoard> as_board(const std::vector<Dot>& dots, std::vector<Placed> placed,
                                   const BoardSpec& spec) {
    // Right-handed as the camera sees it.
    std::vector<Eigen::Vector2d> grid, image;
    const auto fill = [&] {
        grid.clear();
        image.clear();
        for (const auto& p : placed) {
            grid.emplace_back(p.column, p.row);
            image.emplace_back(dots[p.dot].centre.x, dots[p.dot].centre.y);
        }
    };
    fill();
    auto h = homography_dlt(grid, image);
    if (!h) return std::nullopt;
    const Eigen::Vector3d middle(0.5 * (spec.columns - 1), 0.5 * (spec.rows - 1), 1);
    const auto at = [&](double c, double r) {
        return Eigen::Vector2d((*h * Eigen::Vector3d(c, r, 1)).hnormalized());
    };
    const Eigen::Vector2d o = at(middle.x(), middle.y()), x = at(middle.x() + 0.5, middle.y()) - o,
                          y = at(middle.x(), middle.y() + 0.5) - o;
    if (x.x() * y.y() - x.y() * y.x() < 0)
        for (auto& p : placed) p.column = spec.columns - 1 - p.column;
    fill();
    h = homography_dlt(grid, image);
    if (!h) return std::nullopt;
    const double spacing = 2 * std::min(x.norm(), y.norm());
    for (std::size_t i = 0; i < grid.size(); ++i)
        if ((at(grid[i].x(), grid[i].y()) - image[i]).norm() > kOffGrid * spacing) return std::nullopt;

    // The orientation mark: one corner dot much bigger than its fellows, or the only corner cut off by the
    // image's edge.
    std::vector<double> radii;
    for (const auto& p : placed) radii.push_back(dots[p.dot].radius);
    std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2),
                     radii.end());
    const double usual = radii[radii.size() / 2];
    const Cell corners[4] = {
        {0, 0}, {spec.columns - 1, 0}, {spec.columns - 1, spec.rows - 1}, {0, spec.rows - 1}};
    int mark = -1;
    double biggest = kMarkLarger * usual;
    int missing = 0, missing_at = -1;
    for (int k = 0; k < 4; ++k) {
        const auto found = std::find_if(placed.begin(), placed.end(), [&](const Placed& p) {
            return p.column == corners[k].first && p.row == corners[k].second;
        });
        if (found == placed.end()) {
            ++missing;
            missing_at = k;
        } else if (dots[found->dot].radius > biggest) {
            biggest = dots[found->dot].radius;
            mark = k;
        }
    }
    if (mark < 0 && missing == 1) mark = missing_at;
    const bool complete = placed.size() == static_cast<std::size_t>(spec.columns * spec.rows);
    if (mark < 0 && !complete) return std::nullopt;

    FoundBoard board;
    board.detector = complete ? "dots" : "dots, some cut off";
    board.symmetry = mark >= 0 ? 1 : spec.columns == spec.rows ? 4 : 2;
    for (const auto& p : placed) {
        board.index.push_back(p.row * spec.columns + p.column);
        board.pixel.emplace_back(dots[p.dot].centre.x, dots[p.dot].centre.y);
        board.object_mm.emplace_back(p.column * spec.pitch_mm, p.row * spec.pitch_mm, 0);
    }
    take_off_eccentricity(dots, placed, board);
    if (mark > 0) {
        // Brings the mark to (0, 0); on an oblong grid whose mark is on the other diagonal, to row 0.
        if (spec.columns == spec.rows) {
            for (int t = 0; t < 4; ++t) {
                const FoundBoard other = turned(board, spec, t);
                const int corner = corners[mark].second * spec.columns + corners[mark].first;
                int c = corner % spec.columns, r = corner / spec.columns;
                for (int q = 0; q < t; ++q) {
                    const int old = c;
                    c = spec.rows - 1 - r;
                    r = old;
                }
                if (c == 0 && r == 0) return other;
            }
        } else if (corners[mark].second != 0) {
            return turned(board, spec, 2);
        }
    }
    return board;
}

std::optional<FoundBoard> grid_of(const std::vector<Dot>& dots, const BoardSpec& spec) {
    const auto total = static_cast<std::size_t>(spec.columns * spec.rows);
    if (dots.size() + total / 20 + 1 < total) return std::nullopt;
    // Seeds from the middle of all dots outwards.
    cv::Point2d middle(0, 0);
    for (const auto& d : dots) middle += d.centre * (1.0 / static_cast<double>(dots.size()));
    std::vector<std::size_t> seeds(dots.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = i;
    std::sort(seeds.begin(), seeds.end(), [&](std::size_t a, std::size_t b) {
        return cv::norm(dots[a].centre - middle) < cv::norm(dots[b].centre - middle);
    });
    if (seeds.size() > kMostSeeds) seeds.resize(kMostSeeds);
    for (const auto seed : seeds) {
        std::vector<std::pair<double, std::size_t>> near;
        for (std::size_t i = 0; i < dots.size(); ++i)
            if (i != seed) near.emplace_back(cv::norm(dots[i].centre - dots[seed].centre), i);
        const std::size_t keep = std::min<std::size_t>(8, near.size());
        std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(keep), near.end());
        if (keep < 4) return std::nullopt;
        const cv::Point2d a = dots[near[0].second].centre - dots[seed].centre;
        cv::Point2d b(0, 0);
        for (std::size_t k = 1; k < keep; ++k) {
            const cv::Point2d c = dots[near[k].second].centre - dots[seed].centre;
            if (std::abs(a.cross(c)) > kLeastSine * cv::norm(a) * cv::norm(c)) {
                b = c;
                break;
            }
        }
        if (cv::norm(b) == 0) continue;
        const Lattice lattice = grow(dots, seed, a, b);
        if (lattice.size() + total / 20 + 1 < total) continue;
        for (const bool swapped : {false, true}) {
            if (swapped && spec.columns == spec.rows) break;
            std::size_t inside = 0;
            const Cell corner = best_window(lattice, swapped ? spec.rows : spec.columns,
                                            swapped ? spec.columns : spec.rows, inside);
            if (inside + total / 20 + (total > 40 ? 1 : 0) < total) continue;
            std::vector<Placed> placed;
            for (const auto& [c, dot] : lattice) {
                const int i = c.first - corner.first, j = c.second - corner.second;
                const int column = swapped ? j : i, row = swapped ? i : j;
                if (column >= 0 && row >= 0 && column < spec.columns && row < spec.rows)
                    placed.push_back({column, row, dot});
            }
            std::sort(placed.begin(), placed.end(), [](const Placed& p, const Placed& q) {
                return std::pair(p.row, p.column) < std::pair(q.row, q.column);
            });
            if (auto board = as_board(dots, placed, spec)) return board;
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<FoundBoard> find_circles(const cv::Mat& grey, const BoardSpec& spec) {
    for (const cv::Mat& small : reduced(grey)) {
        std::vector<Dot> dots = find_dots(stretched(small, stripe_mask(small), 1.0));
        const double scale = static_cast<double>(grey.cols) / small.cols;
        if (scale > 1) {
            for (Dot& d : dots) {
                d.centre = (d.centre + cv::Point2d(0.5, 0.5)) * scale - cv::Point2d(0.5, 0.5);
                d.radius *= scale;
                measure_in_full(grey, d);
            }
        }
        if (auto board = grid_of(dots, spec)) return board;
    }
    return std::nullopt;
}

}  // namespace seamwright::detail
