#include "core/calibration/board/board_saddles.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/numbers.h"

namespace seamwright::detail {

using Eigen::Vector2d;

cv::Mat softened_root(const cv::Mat& grey, double full_scale) {
    constexpr double kFullGrey = 255.0;    // the root's scale, whatever the camera's
    constexpr double kOwnNoise = 4.0;      // grey values, added under the root
    constexpr double kSoftening_px = 1.2;  // narrow against a square, wide enough for second differences
    // Below some grey values the noise is the camera's own and even already.
    cv::Mat root;
    grey.convertTo(root, CV_32F, kFullGrey / full_scale, kOwnNoise);
    cv::sqrt(root, root);
    cv::GaussianBlur(root, root, {7, 7}, kSoftening_px);
    return root;
}

namespace {

float between(const cv::Mat& image, double x, double y) {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const float fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
    const float *a = image.ptr<float>(iy) + ix, *b = image.ptr<float>(iy + 1) + ix;
    return (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
}

constexpr int kRing = 32;

// Of the ring's contrast: opposite places differ by more where there is no saddle.
constexpr float kMostUnlike = 0.8F;
constexpr double kMostAskew_rad = 0.5;     // by which an edge may bend between the ring's two crossings
constexpr double kLeastBetween_rad = 0.4;  // edges closer in direction than this are one

struct Ring {
    std::array<double, kRing> cosine, sine;
    explicit Ring(double radius) {
        for (std::size_t i = 0; i < kRing; ++i) {
            const double a = 2 * M_PI * static_cast<double>(i) / kRing;
            cosine[i] = radius * std::cos(a);
            sine[i] = radius * std::sin(a);
        }
    }
};

// The edges through a point by the grey values on a circle around it.
std::optional<Saddle> edges_through(const cv::Mat& soft, const Ring& ring, const Vector2d& at) {
    std::array<float, kRing> v;
    float low = 1e30F, high = -1e30F;
    for (std::size_t i = 0; i < kRing; ++i) {
        v[i] = between(soft, at.x() + ring.cosine[i], at.y() + ring.sine[i]);
        low = std::min(low, v[i]);
        high = std::max(high, v[i]);
    }
    const float middle = 0.5F * (low + high);
    float size = 0, unlike = 0;
    for (std::size_t i = 0; i < kRing; ++i) {
        size += std::abs(v[i] - middle);
        if (i < kRing / 2) unlike += 2 * std::abs(v[i] - v[i + kRing / 2]);
    }
    if (unlike > kMostUnlike * size) return std::nullopt;
    std::array<double, 4> turn{};
    int turns = 0, first_rise = -1;
    for (std::size_t i = 0; i < kRing; ++i) {
        const float a = v[i] - middle, b = v[(i + 1) % kRing] - middle;
        if ((a < 0) == (b < 0)) continue;
        if (turns == 4) return std::nullopt;
        if (a < 0 && first_rise < 0) first_rise = turns;
        turn[static_cast<std::size_t>(turns++)] =
            2 * M_PI / kRing * (static_cast<double>(i) + static_cast<double>(a / (a - b)));
    }
    if (turns != 4 || first_rise < 0) return std::nullopt;
    const auto crossing = [&](int k) {
        return turn[static_cast<std::size_t>((first_rise + k) % 4)] + (first_rise + k >= 4 ? 2 * M_PI : 0);
    };
    const double rise = 0.5 * (crossing(0) + crossing(2) - M_PI),
                 fall = 0.5 * (crossing(1) + crossing(3) - M_PI);
    if (std::abs(crossing(2) - crossing(0) - M_PI) > kMostAskew_rad ||
        std::abs(crossing(3) - crossing(1) - M_PI) > kMostAskew_rad)
        return std::nullopt;
    if (fall - rise < kLeastBetween_rad || fall - rise > M_PI - kLeastBetween_rad) return std::nullopt;
    Saddle s;
    s.at = at;
    s.first = {std::cos(rise), std::sin(rise)};
    s.second = {std::cos(fall), std::sin(fall)};
    s.contrast = 2 * static_cast<double>(size) / kRing;
    return s;
}

}  // namespace

std::vector<Saddle> find_saddles(const cv::Mat& soft, double radius_px) {
    const int w = soft.cols, h = soft.rows, rim = static_cast<int>(std::ceil(radius_px)) + 2;
    std::vector<Saddle> out;
    if (w < 4 * rim || h < 4 * rim) return out;
    cv::Mat response(soft.size(), CV_32F, cv::Scalar(0));
    for (int y = 1; y + 1 < h; ++y) {
        const float *a = soft.ptr<float>(y - 1), *b = soft.ptr<float>(y), *c = soft.ptr<float>(y + 1);
        float* r = response.ptr<float>(y);
        for (int x = 1; x + 1 < w; ++x) {
            const float xx = b[x - 1] - 2 * b[x] + b[x + 1], yy = a[x] - 2 * b[x] + c[x];
            const float xy = 0.25F * (a[x - 1] - a[x + 1] - c[x - 1] + c[x + 1]);
            r[x] = xy * xy - xx * yy;
        }
    }
    constexpr float kLeastResponse = 3e-4F;  // the threshold's lower limit, of a picture without noise
    // ... and its upper one: a saddle this strong is never lost for noise
    constexpr float kMostResponse = 0.02F;
    constexpr float kNoiseTimes = 6;  // the noise, above which a peak is looked at
    // The noise: what half of the places with a saddle's sign have at most.
    std::vector<float> some;
    for (int y = rim; y < h - rim; y += 7)
        for (int x = rim; x < w - rim; x += 7)
            if (const float r = response.at<float>(y, x); r > 0) some.push_back(r);
    if (some.empty()) return out;
    std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2), some.end());
    const float least = std::clamp(kNoiseTimes * some[some.size() / 2], kLeastResponse, kMostResponse);
    struct Peak {
        float response;
        int x, y;
    };
    std::vector<Peak> peaks;
    for (int y = rim; y < h - rim; ++y) {
        const float *a = response.ptr<float>(y - 1), *b = response.ptr<float>(y),
                    *c = response.ptr<float>(y + 1);
        for (int x = rim; x < w - rim; ++x) {
            const float r = b[x];
            if (r < least || r < b[x - 1] || r <= b[x + 1] || r < a[x] || r <= c[x] || r < a[x - 1] ||
                r < a[x + 1] || r <= c[x - 1] || r <= c[x + 1])
                continue;
            peaks.push_back({r, x, y});
        }
    }
    constexpr std::size_t kMost = 20000;
    if (peaks.size() > kMost) {
        std::nth_element(peaks.begin(), peaks.begin() + kMost, peaks.end(),
                         [](const Peak& a, const Peak& b) { return a.response > b.response; });
        peaks.resize(kMost);
    }
    const Ring ring(radius_px);
    for (const Peak& p : peaks) {
        // The saddle of the quadratic through the nine values.
        const float *a = soft.ptr<float>(p.y - 1) + p.x, *b = soft.ptr<float>(p.y) + p.x,
                    *c = soft.ptr<float>(p.y + 1) + p.x;
        const double xx = b[-1] - 2 * b[0] + b[1], yy = a[0] - 2 * b[0] + c[0],
                     xy = 0.25 * (a[-1] - a[1] - c[-1] + c[1]);
        const double gx = 0.5 * (b[1] - b[-1]), gy = 0.5 * (c[0] - a[0]);
        const double det = xx * yy - xy * xy;
        const double dx = (xy * gy - yy * gx) / det, dy = (xy * gx - xx * gy) / det;
        constexpr double kFarthest_px = 1.5;  // of the parabola's saddle from the pixel
        if (!(std::abs(dx) < kFarthest_px && std::abs(dy) < kFarthest_px)) continue;
        if (auto s = edges_through(soft, ring, {p.x + dx, p.y + dy})) out.push_back(*s);
    }
    return out;
}

namespace {

// erf(z / sqrt 2) and its derivative from a table: within 1e-6 and 1e-5.
struct Step {
    float value, slope;
};
class StepTable {
  public:
    StepTable() {
        for (int i = 0; i <= kCount; ++i) {
            const double z = kReach * i / kCount;
            table_[static_cast<std::size_t>(i)] = {
                static_cast<float>(std::erf(z / std::sqrt(2.0))),
                static_cast<float>(std::sqrt(2 / M_PI) * std::exp(-0.5 * z * z))};
        }
    }
    Step at(float z) const {
        const float a = std::abs(z);
        if (a >= kReach) return {z < 0 ? -1.0F : 1.0F, 0};
        const float q = a * (kCount / kReach);
        const int i = static_cast<int>(q);
        const float f = q - static_cast<float>(i);
        const Step &s = table_[static_cast<std::size_t>(i)], &t = table_[static_cast<std::size_t>(i) + 1];
        const float v = s.value + f * (t.value - s.value);
        return {z < 0 ? -v : v, s.slope + f * (t.slope - s.slope)};
    }

  private:
    static constexpr int kCount = 1024;
    static constexpr float kReach = 5;
    std::array<Step, kCount + 2> table_{};
};

const StepTable& steps() {
    static const StepTable table;
    return table;
}

// What a fit of a corner takes for sound.
constexpr double kMostForeignSound = 0.2;  // of the window's pixels
constexpr double kMostNoiseSound = 0.4;    // of half the contrast
constexpr double kMostSigma_px = 0.5;      // of the corner

// The fit's course.

// Of half the window: the blur a fit starts from, and what lies nearer to an edge has no level.
constexpr double kNearEdge = 0.15;
constexpr double kLeastStartBlur_px = 0.7;
constexpr double kMostStartBlur_px = 2.0;
// Grey values per root of a grey value, 8 bit: four times this above paper is no noise.
constexpr double kShotNoise8 = 0.25;
constexpr double kShotNoise16 = 4.0;  // ... 16 bit
// Of the window's pixels: under more stripe or glint there is no corner to measure.
constexpr double kMostOutshining = 0.4;
constexpr double kDampingStart = 1e-3;
constexpr double kMostDamping = 1e4;   // no better step is to be found
constexpr double kRidge = 1e-9;        // keeps a window without some parameter solvable
constexpr double kLeastBlur_px = 0.3;  // narrower than a pixel's own width is not told
constexpr double kMostBlur = 0.6;      // of half the window
constexpr double kSettled_px = 1e-3;   // move of the corner below which a fit has settled
constexpr double kSettledCost = 1e-3;  // relative gain in cost below which it has
constexpr double kDampingDown = 0.15;
constexpr double kLeastScale = 0.02;   // of half the contrast: the noise is not taken for smaller
constexpr double kRounding = 0.5;      // grey values, that the noise is at least where pixels are weighed
constexpr double kLeastFreedom = 3.0;  // pixels' weight beyond the nine numbers, in their variance
constexpr double kLeastSeen = 12;      // pixels' weight that the nine numbers are solved from
// Noise scales at which the biweight's weight ends: 95 % efficient on normal noise.
constexpr double kTukey = 4.7;
constexpr double kCleanReach = 0.6;      // of that reach: nothing in the window asks for weights
constexpr double kForeignWeight = 0.05;  // a pixel of less weight counts as foreign
// Between an edge's start and its fit (37 degrees): beyond, the edges have changed places.
constexpr double kLeastTurnCosine = 0.8;

struct WindowPixel {
    float x, y, grey, weight;
};

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
// Parameters: x, y, angle of the first edge, of the second, a, b, gx, gy, s.

struct Sum {
    Matrix9 normal;
    Vector9 right;
    double cost = 0, weight = 0;
};

void accumulate(const std::vector<WindowPixel>& window, const Vector9& p, double bend1, double bend2,
                std::vector<float>& residual, Sum& sum) {
    const StepTable& table = steps();
    const float px = static_cast<float>(p(0)), py = static_cast<float>(p(1));
    const float c1 = static_cast<float>(std::cos(p(2))), s1 = static_cast<float>(std::sin(p(2)));
    const float c2 = static_cast<float>(std::cos(p(3))), s2 = static_cast<float>(std::sin(p(3)));
    const float a = static_cast<float>(p(4)), b = static_cast<float>(p(5)), gx = static_cast<float>(p(6)),
                gy = static_cast<float>(p(7)), inverse = static_cast<float>(1 / p(8));
    const float h1 = static_cast<float>(0.5 * bend1), h2 = static_cast<float>(0.5 * bend2);
    std::array<float, 45> n{};
    std::array<float, 9> r{};
    double cost = 0, weight = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
        const WindowPixel& q = window[i];
        const float x = q.x - px, y = q.y - py;
        // Along and across each edge; the normals point into the bright sector.
        const float t1 = c1 * x + s1 * y, t2 = c2 * x + s2 * y;
        const float u = (c1 * y - s1 * x - h1 * t1 * t1) * inverse,
                    v = (s2 * x - c2 * y - h2 * t2 * t2) * inverse;
        const Step e = table.at(u), f = table.at(v);
        const float off = q.grey - (a + gx * x + gy * y + b * e.value * f.value);
        residual[i] = off;
        if (q.weight <= 0) continue;
        cost += static_cast<double>(q.weight * off * off);
        weight += static_cast<double>(q.weight);
        const float du = b * e.slope * f.value * inverse, dv = b * e.value * f.slope * inverse;
        const std::array<float, 9> j{
            du * s1 - dv * s2 - gx, -du * c1 + dv * c2 - gy, -du * t1, dv * t2, 1, e.value * f.value, x, y,
            -(du * u + dv * v)};
        std::size_t k = 0;
        for (std::size_t m = 0; m < 9; ++m) {
            const float wj = q.weight * j[m];
            r[m] += wj * off;
            for (std::size_t l = 0; l <= m; ++l) n[k++] += wj * j[l];
        }
    }
    sum.cost = cost;
    sum.weight = weight;
    std::size_t k = 0;
    for (int m = 0; m < 9; ++m) {
        sum.right(m) = static_cast<double>(r[static_cast<std::size_t>(m)]);
        for (int l = 0; l <= m; ++l) sum.normal(m, l) = sum.normal(l, m) = static_cast<double>(n[k++]);
    }
}

float middle_of(std::vector<float>& values) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

bool gather(const cv::Mat& grey, int cx, int cy, int half, std::vector<WindowPixel>& window) {
    if (cx - half < 0 || cy - half < 0 || cx + half >= grey.cols || cy + half >= grey.rows) return false;
    window.clear();
    for (int y = -half; y <= half; ++y)
        for (int x = -half; x <= half; ++x) {
            // Round, so that no direction of an edge counts more than another.
            if (x * x + y * y > half * half + half) continue;
            const float g = grey.depth() == CV_8U
                                ? static_cast<float>(grey.at<std::uint8_t>(cy + y, cx + x))
                                : static_cast<float>(grey.at<std::uint16_t>(cy + y, cx + x));
            window.push_back({static_cast<float>(x), static_cast<float>(y), g, 1});
        }
    return true;
}

}  // namespace

bool sound(const CornerFit& fit) {
    return fit.foreign < kMostForeignSound && fit.noise < kMostNoiseSound * fit.half_contrast &&
           fit.sigma_px < kMostSigma_px;
}

std::optional<CornerFit> fit_corner(const cv::Mat& grey, const CornerStart& start) {
    if (!start.at.allFinite()) return std::nullopt;
    const int cx = static_cast<int>(std::lround(start.at.x())),
              cy = static_cast<int>(std::lround(start.at.y()));
    static thread_local std::vector<WindowPixel> window;
    static thread_local std::vector<float> residual, trial_residual, bright, dark, size;
    int half = start.half_px;
    while (half >= 2 && !gather(grey, cx, cy, half, window)) half = half > 4 ? half - 2 : half - 1;
    if (half < 2) return std::nullopt;
    Vector9 p;
    p << start.at.x() - cx, start.at.y() - cy, std::atan2(start.first.y(), start.first.x()),
        std::atan2(start.second.y(), start.second.x()), 0, 0, 0, 0,
        std::clamp(kNearEdge * half, kLeastStartBlur_px, kMostStartBlur_px);
    // Levels by the medians of the sectors, away from the edges.
    bright.clear();
    dark.clear();
    for (const WindowPixel& q : window) {
        const double x = q.x - p(0), y = q.y - p(1);
        const double u = start.first.x() * y - start.first.y() * x,
                     v = start.second.y() * x - start.second.x() * y;
        if (std::min(std::abs(u), std::abs(v)) < kNearEdge * half) continue;
        (u * v > 0 ? bright : dark).push_back(q.grey);
    }
    if (bright.size() < 4 || dark.size() < 4) return std::nullopt;
    const double white = middle_of(bright), black = middle_of(dark);
    if (!(white > black)) return std::nullopt;
    p(4) = 0.5 * (white + black);
    p(5) = 0.5 * (white - black);
    // What outshines the paper is a stripe or a glint, and so is what lies beside it.
    const double limit =
        white + std::max(0.5 * (white - black), 4 * std::sqrt(std::max(white, 1.0)) *
                                                    (grey.depth() == CV_8U ? kShotNoise8 : kShotNoise16));
    std::size_t out_shining = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
        if (window[i].grey <= limit) continue;
        ++out_shining;
        for (WindowPixel& q : window)
            if (std::abs(q.x - window[i].x) <= 2 && std::abs(q.y - window[i].y) <= 2) q.weight = 0;
    }
    const auto n = static_cast<double>(window.size());
    if (static_cast<double>(out_shining) > kMostOutshining * n) return std::nullopt;
    residual.resize(window.size());
    trial_residual.resize(window.size());
    Sum sum, trial;
    double damping = kDampingStart;
    const double largest = 0.5 * half;
    const auto solve = [&](int rounds) {
        accumulate(window, p, start.bend1, start.bend2, residual, sum);
        for (int i = 0; i < rounds; ++i) {
            if (sum.weight < kLeastSeen) return false;
            Matrix9 m = sum.normal;
            m.diagonal() *= 1 + damping;
            m.diagonal().array() += kRidge;
            const Vector9 move = m.ldlt().solve(sum.right);
            Vector9 next = p + move;
            next(8) = std::clamp(next(8), kLeastBlur_px, kMostBlur * half);
            if (!next.allFinite() || next.head<2>().norm() > largest) return false;
            accumulate(window, next, start.bend1, start.bend2, trial_residual, trial);
            if (trial.cost > sum.cost) {
                damping = std::max(kDampingStart, damping * 8);
                if (damping > kMostDamping) return true;
                continue;
            }
            const bool settled =
                move.head<2>().norm() < kSettled_px && sum.cost - trial.cost < kSettledCost * sum.cost;
            p = next;
            damping *= kDampingDown;
            std::swap(sum, trial);
            residual.swap(trial_residual);
            if (settled) break;
        }
        return true;
    };
    double foreign = 0, scale = 0;
    for (int round = 0; round < 3; ++round) {
        if (!solve(round == 0 ? 12 : 3)) return std::nullopt;
        size.clear();
        for (std::size_t i = 0; i < window.size(); ++i) size.push_back(std::abs(residual[i]));
        scale = std::max(kMadToSigma * middle_of(size), kLeastScale * p(5));
        if (round == 2) break;
        // The pixel's own rounding is noise as well.
        const double reach = kTukey * std::max(scale, kRounding);
        if (round == 0 && *std::max_element(size.begin(), size.end()) < kCleanReach * reach) break;
        foreign = 0;
        for (std::size_t i = 0; i < window.size(); ++i) {
            const double z = residual[i] / reach;
            const bool masked = window[i].grey > limit;
            const double weight = masked || std::abs(z) >= 1 ? 0 : (1 - z * z) * (1 - z * z);
            window[i].weight = static_cast<float>(weight);
            foreign += weight < kForeignWeight;
        }
        foreign /= n;
    }
    CornerFit fit;
    fit.at = {cx + p(0), cy + p(1)};
    fit.first = {std::cos(p(2)), std::sin(p(2))};
    fit.second = {std::cos(p(3)), std::sin(p(3))};
    fit.half_contrast = p(5);
    fit.blur_px = p(8);
    fit.foreign = foreign;
    fit.noise = std::sqrt(sum.cost / std::max(sum.weight, 1.0));
    // The edges may have turned, not changed places.
    if (p(5) <= 0 || fit.first.dot(start.first) < kLeastTurnCosine ||
        fit.second.dot(start.second) < kLeastTurnCosine)
        return std::nullopt;
    const Eigen::LDLT<Matrix9> ldlt(sum.normal + kRidge * Matrix9::Identity());
    const double variance = sum.cost / std::max(sum.weight - 9, kLeastFreedom);
    Vector9 unit = Vector9::Zero();
    unit(0) = 1;
    const double xx = ldlt.solve(unit)(0);
    unit(0) = 0, unit(1) = 1;
    const double yy = ldlt.solve(unit)(1);
    fit.sigma_px = std::sqrt(std::max(0.0, 0.5 * (xx + yy) * variance));
    if (!std::isfinite(fit.sigma_px)) return std::nullopt;
    return fit;
}

}  // namespace seamwright::detail
