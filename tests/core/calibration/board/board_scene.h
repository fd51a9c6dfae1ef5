#pragma once
// Rendered pictures of a checkerboard with known corners: ray by ray through a lens of its own, so that
// nothing is shared with the detector. Pixel centres lie on whole numbers.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "core/calibration/board/board.h"

namespace seamwright::test {

struct BoardScene {
    int width = 1280, height = 1024;
    int columns = 7, rows = 6;                           // inner corners
    double focal = 1500, k1 = 0;                         // px; radial distortion r (1 + k1 r^2)
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // camera_from_board
    Eigen::Vector3d at{0, 0, 40};                        // the board's middle, in squares
    double light = 1, contrast = 0.85, vignette = 0, blur_px = 0.7, noise = 1;
    double stripe_px = 0, stripe_halo = 0;  // full width; 0: no stripe
    Eigen::Vector2d stripe_through{640, 512};
    double stripe_deg = 80;
    std::vector<std::array<double, 3>> glints;  // u, v, radius
    std::vector<std::array<double, 6>> covers;  // u, v, half width, half height, deg, grey (of 255)
    bool texture = true;                        // something behind the board
    bool board = true;
    double margin = 1;  // white rim, in squares
    unsigned seed = 1;
};

struct BoardPicture {
    std::vector<std::uint8_t> pixels;
    int width = 0, height = 0;
    std::vector<Eigen::Vector2d> corners;  // row * columns + column; the square behind (0, 0) is dark
    std::vector<char> covered;             // under the stripe, a glint or a cover
    StripeImage image() const {
        return {reinterpret_cast<const std::byte*>(pixels.data()), width, height,
                static_cast<std::size_t>(width), 8};
    }
};

namespace scene_detail {

inline double stretched_radius(double k1, double r) {
    return r * (1 + k1 * r * r);
}

// r with r (1 + k1 r^2) = d, by bisection below the fold.
inline double straight_radius(double k1, double d) {
    double low = 0, high = k1 < 0 ? std::sqrt(-1 / (3 * k1)) : d + 1;
    if (stretched_radius(k1, high) < d) return high;
    for (int i = 0; i < 40; ++i) {
        const double mid = 0.5 * (low + high);
        (stretched_radius(k1, mid) < d ? low : high) = mid;
    }
    return 0.5 * (low + high);
}

inline void soften(std::vector<float>& image, int width, int height, double sigma) {
    if (sigma < 0.05) return;
    const int reach = static_cast<int>(std::ceil(3.5 * sigma));
    std::vector<float> kernel;
    float sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma))));
        sum += kernel.back();
    }
    for (float& k : kernel) k /= sum;
    std::vector<float> other(image.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float v = 0;
            for (int i = -reach; i <= reach; ++i)
                v += kernel[static_cast<std::size_t>(i + reach)] *
                     image[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(std::clamp(x + i, 0, width - 1))];
            other[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)] = v;
        }
    std::fill(image.begin(), image.end(), 0.0F);
    for (int y = 0; y < height; ++y)
        for (int i = -reach; i <= reach; ++i) {
            const float k = kernel[static_cast<std::size_t>(i + reach)];
            const float* from = other.data() + static_cast<std::size_t>(std::clamp(y + i, 0, height - 1)) *
                                                   static_cast<std::size_t>(width);
            float* to = image.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
            for (int x = 0; x < width; ++x) to[x] += k * from[x];
        }
}

inline bool under(const std::array<double, 6>& cover, double u, double v) {
    const double a = cover[4] * M_PI / 180, du = u - cover[0], dv = v - cover[1];
    return std::abs(du * std::cos(a) + dv * std::sin(a)) < cover[2] &&
           std::abs(dv * std::cos(a) - du * std::sin(a)) < cover[3];
}

}  // namespace scene_detail

inline Eigen::Vector2d seen_at(const BoardScene& s, double column, double row) {
    const Eigen::Vector3d p =
        s.turn * Eigen::Vector3d(column - 0.5 * (s.columns - 1), row - 0.5 * (s.rows - 1), 0) + s.at;
    const Eigen::Vector2d n = p.head<2>() / p.z();
    const double r = n.norm();
    const double scale = r > 1e-12 ? scene_detail::stretched_radius(s.k1, r) / r : 1;
    return s.focal * scale * n + Eigen::Vector2d(0.5 * (s.width - 1), 0.5 * (s.height - 1));
}

inline BoardPicture render(const BoardScene& s) {
    using namespace scene_detail;
    BoardPicture out;
    out.width = s.width, out.height = s.height;
    const auto w = static_cast<std::size_t>(s.width), h = static_cast<std::size_t>(s.height);
    std::mt19937 random(s.seed);
    std::uniform_real_distribution<double> u(0, 1);
    // The inverse of the lens in a table over the squared radius.
    const Eigen::Vector2d middle(0.5 * (s.width - 1), 0.5 * (s.height - 1));
    const double far2 = (middle + Eigen::Vector2d(1, 1)).squaredNorm() / (s.focal * s.focal);
    std::vector<double> undo(4097, 1);
    for (std::size_t i = 1; i < undo.size(); ++i) {
        const double d = std::sqrt(far2 * static_cast<double>(i) / 4096);
        undo[i] = s.k1 == 0 ? 1 : straight_radius(s.k1, d) / d;
    }
    const Eigen::Matrix3d back = s.turn.transpose();
    const Eigen::Vector3d eye = -back * s.at;
    // Shapes behind the board.
    struct Blob {
        double u, v, a, b, cosine, sine, grey;
        bool has(double pu, double pv) const {
            const double du = pu - u, dv = pv - v;
            return std::abs(du * cosine + dv * sine) < a && std::abs(dv * cosine - du * sine) < b;
        }
    };
    std::vector<Blob> blobs;
    for (int i = 0; s.texture && i < 60; ++i) {
        const double turn = M_PI * u(random);
        blobs.push_back({u(random) * s.width, u(random) * s.height, (0.01 + 0.08 * u(random)) * s.width,
                         (0.005 + 0.04 * u(random)) * s.width, std::cos(turn), std::sin(turn),
                         20 + 200 * u(random)});
    }
    const double white = 205, black = white * (1 - s.contrast);
    // 0: behind the board, 1: white, 2: black
    const auto kind = [&](double pu, double pv) {
        if (!s.board) return 0;
        const Eigen::Vector2d d = (Eigen::Vector2d(pu, pv) - middle) / s.focal;
        const double q = std::min(4095.999, d.squaredNorm() / far2 * 4096);
        const auto i = static_cast<std::size_t>(q);
        const double scale = undo[i] + (q - static_cast<double>(i)) * (undo[i + 1] - undo[i]);
        const Eigen::Vector3d ray = back * Eigen::Vector3d(d.x() * scale, d.y() * scale, 1);
        if (ray.z() * -eye.z() <= 0) return 0;
        const double t = -eye.z() / ray.z();
        const double x = eye.x() + t * ray.x() + 0.5 * (s.columns - 1),
                     y = eye.y() + t * ray.y() + 0.5 * (s.rows - 1);
        const double m = 1 + s.margin;
        if (x < -m || y < -m || x > s.columns - 1 + m || y > s.rows - 1 + m) return 0;
        if (x < -1 || y < -1 || x > s.columns || y > s.rows) return 1;
        return (static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) & 1 ? 1 : 2;
    };
    const auto behind = [&](double pu, double pv) {
        double g = 90;
        for (const auto& b : blobs)
            if (b.has(pu, pv)) g = b.grey;
        return g;
    };
    std::vector<float> image(w * h);
    std::vector<int> above(w + 1), here(w + 1);
    for (std::size_t x = 0; x <= w; ++x) above[x] = kind(static_cast<double>(x) - 0.5, -0.5);
    constexpr int kFine = 8;
    for (std::size_t y = 0; y < h; ++y) {
        for (std::size_t x = 0; x <= w; ++x)
            here[x] = kind(static_cast<double>(x) - 0.5, static_cast<double>(y) + 0.5);
        for (std::size_t x = 0; x < w; ++x) {
            const double px = static_cast<double>(x), py = static_cast<double>(y);
            double share[3] = {0, 0, 0};
            if (above[x] == above[x + 1] && above[x] == here[x] && here[x] == here[x + 1]) {
                share[above[x]] = 1;
            } else {
                for (int j = 0; j < kFine; ++j)
                    for (int i = 0; i < kFine; ++i)
                        share[kind(px + (i + 0.5) / kFine - 0.5, py + (j + 0.5) / kFine - 0.5)] +=
                            1.0 / (kFine * kFine);
            }
            double g = share[1] * white + share[2] * black;
            if (share[0] > 0) g += share[0] * behind(px, py);
            for (const auto& c : s.covers)
                if (under(c, px, py)) g = c[5];
            const double r2 = (Eigen::Vector2d(px, py) - middle).squaredNorm() / middle.squaredNorm();
            image[y * w + x] = static_cast<float>(g * s.light * (1 - s.vignette * r2));
        }
        std::swap(above, here);
    }
    const double sn = std::sin(s.stripe_deg * M_PI / 180), cs = std::cos(s.stripe_deg * M_PI / 180);
    const auto off_stripe = [&](double pu, double pv) {
        return std::abs((pu - s.stripe_through.x()) * sn - (pv - s.stripe_through.y()) * cs);
    };
    // The stripe's light falls on black less than on white.
    if (s.stripe_px > 0)
        for (std::size_t y = 0; y < h; ++y)
            for (std::size_t x = 0; x < w; ++x) {
                const double d = off_stripe(static_cast<double>(x), static_cast<double>(y)) / s.stripe_px;
                if (d > 8) continue;
                const double paper = image[y * w + x] / (white * s.light);
                image[y * w + x] += static_cast<float>(
                    (0.25 + 0.75 * paper) * (500 * std::exp(-2.77 * d * d) + s.stripe_halo * std::exp(-d)));
            }
    for (const auto& g : s.glints)
        for (int y = std::max(0, static_cast<int>(g[1] - 3 * g[2]));
             y < std::min<double>(s.height, g[1] + 3 * g[2]); ++y)
            for (int x = std::max(0, static_cast<int>(g[0] - 3 * g[2]));
                 x < std::min<double>(s.width, g[0] + 3 * g[2]); ++x)
                image[static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x)] += static_cast<float>(
                    400 * std::exp(-2 * ((x - g[0]) * (x - g[0]) + (y - g[1]) * (y - g[1])) / (g[2] * g[2])));
    soften(image, s.width, s.height, s.blur_px);
    std::normal_distribution<float> n(0, 1);
    out.pixels.resize(w * h);
    for (std::size_t i = 0; i < image.size(); ++i) {
        const float sigma = static_cast<float>(s.noise) * std::sqrt(0.3F + std::max(0.0F, image[i]) / 150);
        out.pixels[i] =
            static_cast<std::uint8_t>(std::clamp(image[i] + sigma * n(random) + 0.5F, 0.0F, 255.0F));
    }
    for (int r = 0; s.board && r < s.rows; ++r)
        for (int c = 0; c < s.columns; ++c) {
            const Eigen::Vector2d p = seen_at(s, c, r);
            bool hidden = s.stripe_px > 0 && off_stripe(p.x(), p.y()) < 0.7 * s.stripe_px;
            for (const auto& g : s.glints) hidden |= std::hypot(p.x() - g[0], p.y() - g[1]) < 1.5 * g[2];
            for (const auto& x : s.covers) hidden |= under(x, p.x(), p.y());
            out.corners.push_back(p);
            out.covered.push_back(hidden);
        }
    return out;
}

// Whether each side of the board is seen to end: in two places along it two squares of the outer ring, the line
// behind them and the paper there are in the picture with nothing before them.
inline bool every_end_seen(const BoardScene& s) {
    const double sn = std::sin(s.stripe_deg * M_PI / 180), cs = std::cos(s.stripe_deg * M_PI / 180);
    const auto plain = [&](double column, double row) {
        const Eigen::Vector2d p = seen_at(s, column, row);
        bool clear = p.x() > 3 && p.y() > 3 && p.x() < s.width - 4 && p.y() < s.height - 4;
        clear &= s.stripe_px == 0 || std::abs((p.x() - s.stripe_through.x()) * sn -
                                              (p.y() - s.stripe_through.y()) * cs) > s.stripe_px + 3;
        for (const auto& g : s.glints) clear &= std::hypot(p.x() - g[0], p.y() - g[1]) > 2 * g[2];
        for (const auto& c : s.covers) clear &= !scene_detail::under(c, p.x(), p.y());
        return clear;
    };
    for (int side = 0; side < 4; ++side) {
        const int along = side < 2 ? s.columns : s.rows;
        int places = 0;
        for (int k = 0; k < along; ++k) {
            bool seen = true;
            for (double a = -0.95; a <= 0.96 && seen; a += 0.1)
                for (double b = -0.95; b <= 0.5 && seen; b += 0.1) {
                    const double across = side % 2 == 0 ? -1 - b : (side < 2 ? s.rows : s.columns) + b;
                    seen = side < 2 ? plain(k + a, across) : plain(across, k + a);
                }
            places += seen;
        }
        if (places < 2) return false;
    }
    return true;
}

// A pose at random: tilted by `tilt_deg` about a random axis, turned at will, every corner `rim` px inside.
inline BoardScene posed(BoardScene s, double tilt_deg, double rim, std::mt19937& random) {
    std::uniform_real_distribution<double> u(-1, 1);
    const double size = std::hypot(s.columns + 1, s.rows + 1);
    for (;;) {
        const double a = M_PI * u(random);
        s.turn = (Eigen::AngleAxisd(tilt_deg * M_PI / 180, Eigen::Vector3d(std::cos(a), std::sin(a), 0)) *
                  Eigen::AngleAxisd(M_PI * u(random), Eigen::Vector3d::UnitZ()))
                     .toRotationMatrix();
        const double z = s.focal * size / (std::min(s.width, s.height) * (0.85 + 0.35 * u(random)));
        s.at = {0.3 * z * s.width / s.focal * u(random), 0.3 * z * s.height / s.focal * u(random), z};
        bool inside = true;
        for (int r = -1; r <= s.rows && inside; ++r)
            for (int c = -1; c <= s.columns && inside; ++c) {
                const Eigen::Vector3d ray =
                    s.turn * Eigen::Vector3d(c - 0.5 * (s.columns - 1), r - 0.5 * (s.rows - 1), 0) + s.at;
                inside &= ray.z() > 0.3 * z;
                // No lens folds its picture, as this polynomial does at its rim.
                inside &= 1 + 3 * s.k1 * ray.head<2>().squaredNorm() / (ray.z() * ray.z()) > 0.3;
                if (r < 0 || c < 0 || r == s.rows || c == s.columns) continue;
                const Eigen::Vector2d p = seen_at(s, c, r);
                inside &=
                    p.x() > rim && p.y() > rim && p.x() < s.width - 1 - rim && p.y() < s.height - 1 - rim;
            }
        if (inside) return s;
    }
}

// How far the reported corners lie from the truth, under the turns that look alike; nothing when no reading
// puts every corner within a third of a square: a wrong lattice.
struct CornerErrors {
    std::vector<double> px;  // per corner
    double rms = 0, worst = 0;
};
inline std::optional<CornerErrors> errors_of(const FoundBoard& board, const BoardScene& s,
                                             const BoardPicture& picture) {
    std::optional<CornerErrors> best;
    for (int t = 0; t < 4; ++t) {
        if (t > 0 && board.symmetry == 1) break;
        if (t % 2 == 1 && board.symmetry != 4) continue;
        BoardSpec spec;
        spec.columns = s.columns, spec.rows = s.rows, spec.pitch_mm = 1;
        const FoundBoard b = turned(board, spec, t);
        CornerErrors e;
        bool right = true;
        for (std::size_t i = 0; i < b.index.size() && right; ++i) {
            const int k = b.index[i];
            const Eigen::Vector2d truth = picture.corners.at(static_cast<std::size_t>(k));
            const int c = k % s.columns, r = k / s.columns;
            const double spacing =
                std::min((seen_at(s, c + 1, r) - truth).norm(), (seen_at(s, c, r + 1) - truth).norm());
            e.px.push_back((b.pixel[i] - truth).norm());
            right &= e.px.back() < spacing / 3;
            e.rms += e.px.back() * e.px.back();
            e.worst = std::max(e.worst, e.px.back());
        }
        if (!right || b.index.empty()) continue;
        e.rms = std::sqrt(e.rms / static_cast<double>(e.px.size()));
        if (!best || e.rms < best->rms) best = e;
    }
    return best;
}

}  // namespace seamwright::test
