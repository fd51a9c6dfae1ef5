#include "core/features/registration/sheet_ends.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

constexpr double kMostOpen = 3.5;  // pitches
// Cosine of the steepest surface whose end is an edge: a rounded one ends for the sensor where it gets too steep to be
// seen, which is another place of it at another turn.
constexpr double kSteepest = 0.6;
// Points behind an end that tell its surface's direction; the direction is sure to a tenth where their chord times the
// root of their number is so many sigma.
constexpr int kFewestBehind = 8, kMostBehind = 48;
constexpr double kSureDirection = 35;
// Bent by more than this part of the chord's length, and by more than noise, behind its end: not an edge either.
constexpr double kBow = 0.06, kBowNoise = 4;

}  // namespace

JumpEnd jump_end(const std::vector<double>& x, const std::vector<double>& z, int lower, int upper, int first,
                 int last, double sigma_mm) {
    // Behind the upper point, away from the lower one, as far as the surface goes on: eight points, or as many as it takes
    // that noise does not turn their direction.
    const int step = upper - lower;
    int behind = upper, many = 1;
    double length = 0, sum_x = x[upper], sum_z = z[upper], moment_x = 0, moment_z = 0;
    for (int k = 0; behind + step >= first && behind + step <= last; ++k) {
        const double so_far = std::hypot(x[upper] - x[behind], z[upper] - z[behind]);
        if (k >= kFewestBehind &&
            (k >= kMostBehind || so_far * std::sqrt(double(k)) > kSureDirection * sigma_mm))
            break;
        const double d = std::hypot(x[behind + step] - x[behind], z[behind + step] - z[behind]);
        if (k > 0 && d > 4 * length / k) break;
        length += d;
        behind += step;
        sum_x += x[behind], sum_z += z[behind];
        moment_x += many * x[behind], moment_z += many * z[behind];
        ++many;
    }
    JumpEnd end{x[upper], z[upper], double(-step), 0, 0, std::abs(z[upper] - z[lower]), 0};
    const double dx = x[upper] - x[behind], dz = z[upper] - z[behind], d = std::hypot(dx, dz);
    // Advance from point to point towards the end, by least squares.
    const double spread = many * (double(many) * many - 1) / 12, middle = 0.5 * (many - 1);
    const double ax = spread > 0 ? (middle * sum_x - moment_x) / spread : 0,
                 az = spread > 0 ? (middle * sum_z - moment_z) / spread : 0, advance = std::hypot(ax, az);
    const int near = std::clamp(upper - 3 * step, std::min(behind, upper), std::max(behind, upper));
    const double nx = x[upper] - x[near], nz = z[upper] - z[near];
    end.is_edge = std::abs(nx) > kSteepest * std::hypot(nx, nz) || std::abs(ax) > kSteepest * advance;
    // What lies between the two ends of the stretch, across it.
    if (const int between = std::abs(upper - behind) - 1; between >= 2 && d > 0) {
        double off = 0;
        for (int k = behind - step; k != upper; k -= step)
            off += ((x[k] - x[behind]) * dz - (z[k] - z[behind]) * dx) / (d * between);
        if (std::abs(off) > kBow * d + kBowNoise * sigma_mm * std::sqrt(0.5 + 1.0 / between))
            end.is_edge = false;
    }
    if (advance > 0) {
        end.tx = ax / advance;
        end.tz = az / advance;
        end.pitch = advance;
    }
    // Half of the way to the lower side, which is farther than a pitch where a point is missing or stood in the step.
    end.open = end.pitch;
    if (const double across = std::abs((x[upper] - x[lower]) * end.tx); across <= kMostOpen * end.pitch)
        end.open = std::max(end.pitch, across);
    end.x += 0.5 * end.open * end.tx;
    end.z += 0.5 * end.open * end.tz;
    return end;
}

bool gap_ends(const std::vector<double>& x, const std::vector<double>& z, int before, int first, int last,
              double sigma_mm, std::vector<JumpEnd>& ends) {
    constexpr double kLevel = 0.5;  // of its width that a gap's sides may differ in height
    const double dx = x[before + 1] - x[before], dz = z[before + 1] - z[before];
    if (!(std::abs(dz) < kLevel * std::abs(dx))) return false;
    for (const bool left : {true, false}) {
        const int end = left ? before : before + 1, other = left ? before + 1 : before;
        JumpEnd rim = jump_end(x, z, other, end, first, last, sigma_mm);
        rim.height = std::hypot(dx, dz);
        rim.of_gap = true;
        if (rim.is_edge && rim.pitch > 0) ends.push_back(rim);
    }
    return true;
}

}  // namespace seamwright
