#include "core/features/registration/sheet_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

// Cosine of the steepest surface whose end is an edge: a rounded one ends for the sensor where it gets too steep to be
// seen, which is another place of it at another turn.
constexpr double kSteepest = 0.6;
// Points behind an end that tell its surface's direction; the direction is sure to a tenth where their chord times the
// root of their number is so many sigma.
constexpr int kFewestBehind = 8, kMostBehind = 48;
constexpr double kSureDirection = 35;
// Bent by more than this part of the chord's length, and by more than noise, behind its end: not an edge either.
constexpr double kBow = 0.06, kBowNoise = 4;

// A surface bends away where the direction of its last points differs by so many radian and sigma from that of twice as
// many behind them. The very last one may stand in the jump: without it there must be a bend too, be it less.
constexpr double kLeastBend = 0.25, kSurelyBent = 4, kLeastWithoutLast = 0.15, kBentWithoutLast = 3;
constexpr int kMostOfBend = 24;
// A surface is known not to bend where a turn of this many radian would have shown.
constexpr double kNoBend = 0.5;
// Spacings beyond this many of those before are another surface's.
constexpr double kSameSurface = 4;

// Mean advance from point to point over `many` points inwards from `from`, towards the end; the variance of its direction
// in parts of the noise of a point.
struct Advance {
    double x = 0, z = 0, size = 0, variance = 0;
};
Advance advance(const std::vector<double>& x, const std::vector<double>& z, int from, int inwards, int many) {
    Advance a;
    const double middle = 0.5 * (many - 1), spread = many * (double(many) * many - 1) / 12;
    for (int k = 0, i = from; k < many; ++k, i += inwards) {
        a.x += (middle - k) * x[i] / spread;
        a.z += (middle - k) * z[i] / spread;
    }
    a.size = std::hypot(a.x, a.z);
    a.variance = a.size > 0 ? 1 / (spread * a.size * a.size) : std::numeric_limits<double>::infinity();
    return a;
}

// How the surface that ends at `end` lies before the jump to `beyond`.
struct Bend {
    bool known = false, bent = false;
    double outward = 0, pitch = 0;
};
Bend bend_at(const std::vector<double>& x, const std::vector<double>& z, int end, int beyond, int first,
             int last, double sigma_mm) {
    const int inwards = end - beyond;
    int there = 1;  // points on the surface
    double length = 0;
    for (int i = end; i + inwards >= first && i + inwards <= last && there < 3 * kMostOfBend + 1;
         i += inwards, ++there) {
        const double d = std::hypot(x[i + inwards] - x[i], z[i + inwards] - z[i]);
        if (there > 2 && d > kSameSurface * length / (there - 1)) break;
        length += d;
    }
    Bend bend;
    const double down = z[beyond] > z[end] ? 1 : -1;
    for (int many = 2; many <= kMostOfBend && 3 * many + 1 <= there; many += std::max(1, many / 4)) {
        const Advance behind = advance(x, z, end + (many + 1) * inwards, inwards, 2 * many);
        const double towards = behind.x > 0 ? down : -down;
        const auto turn = [&](const Advance& a) {
            return std::atan2(towards * (behind.x * a.z - behind.z * a.x), behind.x * a.x + behind.z * a.z);
        };
        const auto doubt = [&](const Advance& a) {
            return sigma_mm * std::sqrt(a.variance + behind.variance);
        };
        const Advance with = advance(x, z, end, inwards, many + 1),
                      without = advance(x, z, end + inwards, inwards, many);
        bend.outward = behind.x > 0 ? 1 : -1;
        bend.pitch = std::abs(behind.x);
        bend.known = bend.known || kSurelyBent * doubt(with) < kNoBend;
        bend.bent = turn(with) > std::max(kLeastBend, kSurelyBent * doubt(with)) &&
                    turn(without) > std::max(kLeastWithoutLast, kBentWithoutLast * doubt(without));
        if (bend.bent) break;
    }
    bend.known = bend.known || bend.bent;
    return bend;
}

}  // namespace

SheetOutline outline_at(const std::vector<double>& x, const std::vector<double>& z, int at, int first,
                        int last, double sigma_mm) {
    const Bend before = bend_at(x, z, at, at + 1, first, last, sigma_mm),
               after = bend_at(x, z, at + 1, at, first, last, sigma_mm);
    const bool rising = z[at + 1] > z[at];
    const auto side = [&](int end, int inside) {
        const bool known = inside >= first && inside <= last;
        return SheetOutline::Side{z[end], known ? std::abs(z[end] - z[inside]) : 0};
    };
    SheetOutline outline;
    outline.x = 0.5 * (x[at] + x[at + 1]);
    outline.pitch = 0.5 * (before.pitch + after.pitch);
    outline.open = std::max(outline.pitch, std::abs(x[at + 1] - x[at]));
    const SheetOutline::Side a = side(at, at - 1), b = side(at + 1, at + 2);
    outline.upper = rising ? b : a;
    outline.lower = rising ? a : b;
    // Both surfaces end towards each other; noise may put their last points in any order.
    const double forwards = (before.outward - after.outward) > 0 ? 1 : -1;
    outline.upwards = rising ? forwards : -forwards;
    if (!before.known || !after.known || before.bent == after.bent || before.outward == after.outward)
        return outline;
    outline.nearer = before.bent == rising ? SheetOutline::Nearer::lower : SheetOutline::Nearer::upper;
    return outline;
}

JumpEnd jump_end(const std::vector<double>& x, const std::vector<double>& z, int lower, int upper, int first,
                 int last, double sigma_mm, double most_open) {
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
    JumpEnd end{x[upper], z[upper], double(-step), 0, 0, std::abs(z[upper] - z[lower]), 0, true, false, {}};
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
    if (const double across = std::abs((x[upper] - x[lower]) * end.tx); across <= most_open * end.pitch)
        end.open = std::max(end.pitch, across);
    end.x += 0.5 * end.open * end.tx;
    end.z += 0.5 * end.open * end.tz;
    return end;
}

bool gap_ends(const std::vector<double>& x, const std::vector<double>& z, int before, int first, int last,
              double sigma_mm, double most_open, std::vector<JumpEnd>& ends) {
    constexpr double kLevel = 0.5;  // of its width that a gap's sides may differ in height
    const double dx = x[before + 1] - x[before], dz = z[before + 1] - z[before];
    if (!(std::abs(dz) < kLevel * std::abs(dx))) return false;
    for (const bool left : {true, false}) {
        const int end = left ? before : before + 1, other = left ? before + 1 : before;
        JumpEnd rim = jump_end(x, z, other, end, first, last, sigma_mm, most_open);
        rim.height = std::hypot(dx, dz);
        rim.of_gap = true;
        if (rim.is_edge && rim.pitch > 0) ends.push_back(rim);
    }
    return true;
}

}  // namespace seamwright
