#include "core/features/contour/reduce_contour.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace seamwright {

void reduce_contour(std::span<const double> x_mm, std::span<const double> z_mm, double tolerance_mm,
                    std::vector<int>& kept) {
    assert(x_mm.size() == z_mm.size());
    kept.clear();
    const int n = static_cast<int>(x_mm.size());
    if (n == 0) return;
    // Right ends that still wait, nearest last, in a list of their own: a comb of a million teeth costs heap,
    // not stack.
    kept.push_back(0);
    if (n == 1) return;
    std::vector<int>& out = kept;
    thread_local std::vector<int> waiting;
    waiting.clear();
    waiting.push_back(n - 1);
    int left = 0;
    while (!waiting.empty()) {
        const int right = waiting.back();
        const double ax = x_mm[left], az = z_mm[left];
        const double dx = x_mm[right] - ax, dz = z_mm[right] - az;
        const double length2 = dx * dx + dz * dz;
        double worst = -1;
        int worst_index = -1;
        for (int i = left + 1; i < right; ++i) {
            // Distance to the segment, not to the endless line: on a contour that turns back the line alone
            // would hide a point that lies far behind an end.
            const double px = x_mm[i] - ax, pz = z_mm[i] - az;
            double t = length2 > 0 ? (px * dx + pz * dz) / length2 : 0;
            t = std::clamp(t, 0.0, 1.0);
            const double ex = px - t * dx, ez = pz - t * dz;
            const double d2 = ex * ex + ez * ez;
            if (d2 > worst) {
                worst = d2;
                worst_index = i;
            }
        }
        if (worst > tolerance_mm * tolerance_mm) {
            waiting.push_back(worst_index);
        } else {
            out.push_back(right);
            left = right;
            waiting.pop_back();
        }
    }
}

}  // namespace seamwright
