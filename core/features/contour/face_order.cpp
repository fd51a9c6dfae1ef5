#include "core/features/contour/face_order.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

constexpr double kDense = 0.35;      // pitches that a face's points lie apart along x
constexpr double kTurn = 1.5;        // spacings up, and down again
constexpr double kBackwards = 0.02;  // of the neighbours, where segments overlap

// Sorts the points [first, last] by z; stable, without allocation: a face has few of them.
void by_height(int first, int last, bool upwards, std::vector<double>& x, std::vector<double>& z) {
    for (int i = first + 1; i <= last; ++i)
        for (int k = i; k > first; --k) {
            const auto at = static_cast<std::size_t>(k);
            if (upwards ? z[at] >= z[at - 1] : z[at] <= z[at - 1]) break;
            std::swap(z[at], z[at - 1]);
            std::swap(x[at], x[at - 1]);
        }
}

}  // namespace

bool order_faces(const ContourPitch& pitch, std::vector<double>& x, std::vector<double>& z) {
    const int n = static_cast<int>(x.size());
    if (n < 5 || !(pitch.distance > 0) || !(pitch.along_x > 0)) return false;
    const auto dx = [&](int i) {
        return x[static_cast<std::size_t>(i + 1)] - x[static_cast<std::size_t>(i)];
    };
    int forwards = 0, backwards = 0;
    for (int i = 0; i + 1 < n; ++i) {
        forwards += dx(i) > 0;
        backwards += dx(i) < 0;
    }
    if (std::min(forwards, backwards) > kBackwards * n) return false;
    const double turn = kTurn * pitch.distance, wide = kDense * pitch.along_x;
    const auto height = [&](int i) { return z[static_cast<std::size_t>(i)]; };
    // The last point of the tangle that begins with `first`; `first` itself: none does.
    const auto tangled_to = [&](int first) {
        double low = height(first), high = low;
        bool up = false, down = false;
        int last = first;
        while (last + 1 < n &&
               std::abs(x[static_cast<std::size_t>(last + 1)] - x[static_cast<std::size_t>(first)]) < wide) {
            ++last;
            up = up || height(last) - low > turn;
            down = down || high - height(last) > turn;
            low = std::min(low, height(last));
            high = std::max(high, height(last));
        }
        return up && down ? last : first;
    };
    bool changed = false;
    for (int first = 0; first < n; ++first) {
        int last = tangled_to(first);
        if (last == first) continue;
        for (int next = first + 1; next <= last; ++next) last = std::max(last, tangled_to(next));
        const auto [low, high] = std::minmax_element(z.begin() + first, z.begin() + last + 1);
        const auto away = [&](int outside, double from) {
            return outside < 0 || outside >= n ? 0.0 : std::abs(height(outside) - from);
        };
        const bool upwards =
            away(first - 1, *low) + away(last + 1, *high) < away(first - 1, *high) + away(last + 1, *low);
        by_height(first, last, upwards, x, z);
        changed = true;
        first = last;
    }
    return changed;
}

}  // namespace seamwright
