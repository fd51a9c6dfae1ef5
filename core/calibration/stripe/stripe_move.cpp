#include "core/calibration/stripe/stripe_move.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/f_test.h"

namespace seamwright::detail {
namespace {

constexpr double kNumbers = 2, kPlane = 3;  // of a frame; unknowns

struct PlaneOf {
    Eigen::Vector3d moves = Eigen::Vector3d::Zero();
    double squares = 0;  // weighted, that remain
};

PlaneOf plane_of(const std::vector<StripeOff>& frames, std::size_t from, std::size_t to, double between_mm2) {
    // Stripes on one line leave a tilt open: it stays where it is.
    Eigen::Matrix3d normal = Eigen::Vector3d(1, 1, 1e-6).asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto weight = [&](const StripeOff& f) -> Eigen::Matrix2d {
        return (f.noise_mm2 + between_mm2 * Eigen::Matrix2d::Identity()).inverse();
    };
    for (std::size_t k = from; k < to; ++k) {
        const Eigen::Matrix<double, 3, 2> a = frames[k].by_plane.transpose() * weight(frames[k]);
        normal += a * frames[k].by_plane;
        right -= a * frames[k].off_mm;
    }
    PlaneOf out;
    out.moves = normal.ldlt().solve(right);
    for (std::size_t k = from; k < to; ++k) {
        const Eigen::Vector2d left = frames[k].off_mm + frames[k].by_plane * out.moves;
        out.squares += left.dot(weight(frames[k]) * left);
    }
    return out;
}

// The variance under which what remains is what `freedom` numbers leave.
template <class Squares>
double variance_for(const Squares& squares, double freedom) {
    if (!(freedom > 0) || squares(0.0) <= freedom) return 0;
    double low = 0, high = 1e-6;
    while (squares(high) > freedom && high < 1e6) high *= 4;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (squares(middle) > freedom ? low : high) = middle;
    }
    return high;
}

}  // namespace

double between_frames_mm(const std::vector<StripeOff>& frames) {
    return std::sqrt(variance_for([&](double v) { return plane_of(frames, 0, frames.size(), v).squares; },
                                  kNumbers * static_cast<double>(frames.size()) - kPlane));
}

std::optional<LaserMove> find_move(const std::vector<StripeOff>& frames) {
    constexpr std::size_t kFewest = 6, kFewestOfPart = 3;
    constexpr double kHarmless_mm = 0.1;
    const std::size_t count = frames.size();
    if (count < kFewest) return std::nullopt;
    const double freedom = kNumbers * static_cast<double>(count) - 2 * kPlane;
    const auto apart = [&](std::size_t first_after, double v) {
        return plane_of(frames, 0, first_after, v).squares + plane_of(frames, first_after, count, v).squares;
    };
    const auto best_of = [&](double v) {
        std::size_t best = kFewestOfPart;
        for (std::size_t k = best; k + kFewestOfPart <= count; ++k)
            if (apart(k, v) < apart(best, v)) best = k;
        return best;
    };
    const double between = variance_for([&](double v) { return apart(best_of(v), v); }, freedom);
    const std::size_t best = best_of(between);
    const double breaks = static_cast<double>(count - 2 * kFewestOfPart + 1);
    const double chance = breaks * freed_chance(plane_of(frames, 0, count, between).squares,
                                                apart(best, between), kPlane, freedom);
    if (!(chance < kNoAccident)) return std::nullopt;
    // One frame that contradicts all others is as much of an explanation, if it is as good.
    constexpr double kAsGood = 2;
    for (std::size_t k = 0; k < count; ++k) {
        std::vector<StripeOff> others = frames;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        if (plane_of(others, 0, count - 1, between).squares < kAsGood * apart(best, between))
            return std::nullopt;
    }
    const Eigen::Vector3d step =
        plane_of(frames, best, count, between).moves - plane_of(frames, 0, best, between).moves;
    double sum = 0;
    for (const StripeOff& f : frames) sum += std::pow(f.by_plane.row(0).dot(step), 2);
    const LaserMove move{best, std::sqrt(sum / static_cast<double>(count))};
    if (!(move.apart_mm > kHarmless_mm)) return std::nullopt;
    return move;
}

}  // namespace seamwright::detail
