#include "core/cloud/edge/cell_ends.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

// Of the line through a sheet's points: scatters from which one weighs nothing (Tukey); variance of b that still tells a
// slope; least scatter, and the least of it in a point's noise.
constexpr double kLineGate = 4.7, kLeastVariance_mm2 = 1e-9;
constexpr double kLeastScatter_mm = 0.01, kLeastOfNoise = 0.5;
constexpr double kMiddle = 0.3;  // of the sheet, from its inner side: where the way outwards begins
constexpr double kGoesOn = 0.9;  // of beyond_mm: a sheet that is seen farther goes on
constexpr double kInner = 0.1;   // of window_mm: a point so far inside of the drawing's edge makes the line
constexpr double kMostVariation = 1.5, kUsualVariation = 0.5;  // v; the latter where no stretches tell it
constexpr double kTowards = 0.05;  // cos of 87 degrees: a sheet that leans away more is not seen from there

struct Beside {
    double b, n;
};

struct Line {
    double at = 0, slope = 0, scatter = 0;
    double off(const Beside& p) const { return p.n - at - slope * p.b; }
};

// Line of most points: from the median, reweighted (Tukey).
Line line_of(const std::vector<Beside>& points, double floor_mm) {
    Line line;
    std::vector<double> values;
    for (const Beside& p : points) values.push_back(p.n);
    line.at = median(values);
    for (int round = 0; round < 8; ++round) {
        values.clear();
        for (const Beside& p : points) values.push_back(std::abs(line.off(p)));
        line.scatter = std::max(floor_mm, kMadToSigma * median(values));
        const double gate = kLineGate * line.scatter;
        double w0 = 0, wb = 0, wn = 0, wbb = 0, wbn = 0;
        for (const Beside& p : points) {
            const double share = line.off(p) / gate;
            if (std::abs(share) >= 1) continue;
            const double w = (1 - share * share) * (1 - share * share);
            w0 += w, wb += w * p.b, wn += w * p.n, wbb += w * p.b * p.b, wbn += w * p.b * p.n;
        }
        const double d = w0 * wbb - wb * wb;
        if (!(w0 > 3) || !(d > kLeastVariance_mm2 * w0 * w0)) break;
        line.slope = (w0 * wbn - wb * wn) / d;
        line.at = (wn - line.slope * wb) / w0;
    }
    return line;
}

constexpr std::size_t kAveraged = 24;  // points at the end
constexpr std::size_t kLag = 6;        // gaps of a long stretch

// b of the sheet's points, from the end inwards; empty: the sheet goes on, or is too thin.
std::vector<double> last_points(std::vector<double> b, const CellOptions& o) {
    std::sort(b.begin(), b.end());
    if (b.size() < 8) return {};
    // From the middle of the sheet outwards to the first tear.
    const double mean = (b.back() - b.front()) / static_cast<double>(b.size() - 1);
    const double tear = std::max(12 * mean, 4 * o.noise_mm);
    auto from = std::lower_bound(b.begin(), b.end(), b.front() + kMiddle * (b.back() - b.front()));
    auto end = b.end();
    for (auto i = from; i + 1 != b.end(); ++i)
        if (*(i + 1) - *i > tear) {
            end = i + 1;
            break;
        }
    b.erase(end, b.end());
    if (b.size() < 8 || b.back() > kGoesOn * o.beyond_mm) return {};
    std::reverse(b.begin(), b.end());
    return b;
}

bool find_end(const std::vector<Beside>& points, const CellOptions& o, CellEnd& out) {
    std::vector<Beside> inner;
    for (const Beside& p : points)
        if (p.b < -kInner * o.window_mm) inner.push_back(p);
    if (inner.size() < 8) inner = points;
    const double floor_mm = std::max(kLeastScatter_mm, kLeastOfNoise * o.noise_mm);
    Line line = line_of(inner, floor_mm);
    const double gate = 5 * line.scatter;
    std::vector<double> along;
    for (const Beside& p : points)
        if (std::abs(line.off(p)) < gate) along.push_back(p.b);
    const std::vector<double> b = last_points(std::move(along), o);
    if (b.empty()) return false;
    std::size_t skipped = 0;  // the last points that noise has mixed
    const double rough = (b.front() - b.back()) / static_cast<double>(b.size() - 1);
    if (!(rough > 0)) return false;
    if (o.noise_mm > rough)
        skipped = std::min(b.size() / 3, static_cast<std::size_t>(2 * o.noise_mm / rough));
    const std::size_t last = b.size() - 1;
    const double gap = (b[skipped] - b[last]) / static_cast<double>(last - skipped);
    if (!(gap > 0)) return false;
    const std::size_t count = std::min(kAveraged, (last - skipped) / 2 + 1);
    double end = 0;
    for (std::size_t i = skipped; i < skipped + count; ++i)
        end += (b[i] + static_cast<double>(i) * gap) / static_cast<double>(count);
    // Variation of long stretches against that of short ones: noise is in both.
    const auto stretch = [&](std::size_t lag) {
        double sum = 0, squares = 0, n = 0;
        for (std::size_t i = skipped; i + lag <= last; ++i) {
            const double s = b[i] - b[i + lag];
            sum += s, squares += s * s, n += 1;
        }
        return n > 2 ? squares / n - sum * sum / (n * n) : 0.0;
    };
    const double growth = (stretch(2 * kLag) - stretch(kLag)) / (static_cast<double>(kLag) * gap * gap);
    const double variation =
        last - skipped > 4 * kLag ? std::clamp(growth, 0.0, kMostVariation) : kUsualVariation;
    out.outward_mm = end + gap / 2 * (1 + variation);
    double g1 = 0, g2 = 0, g3 = 0;
    for (std::size_t i = 0; i < last; ++i) {
        const double g = b[i] - b[i + 1];
        g1 += g, g2 += g * g, g3 += g * g * g;
    }
    out.phase_mm2 = std::max(0.0, g3 / (3 * g1) - std::pow(g2 / (2 * g1), 2));
    out.spacing_mm = gap;
    // The sheet's height where it ends, by its last part: farther in it may bend.
    std::vector<Beside> near;
    for (const Beside& p : points)
        if (p.b > out.outward_mm - o.window_mm / 2 && p.b <= b.front() && std::abs(line.off(p)) < gate)
            near.push_back(p);
    if (near.size() >= 8) line = line_of(near, floor_mm);
    out.normal_mm = line.at + line.slope * out.outward_mm;
    out.slope = line.slope;
    out.points = b.size();
    return std::isfinite(out.normal_mm) && std::abs(out.outward_mm) < o.beyond_mm;
}

}  // namespace

std::vector<CellEnd> cell_ends(const Cloud& cloud, const EdgeCurve& curve, int index,
                               const Pose& base_from_part, const CellOptions& options) {
    constexpr double kCorners = 1.5;  // the corners of the window lie farther off than its sides
    const double reach = kCorners * std::max(options.window_mm, options.beyond_mm);
    const EdgeSearch search(curve, reach);
    const Pose part_from_base = base_from_part.inverse();
    const auto cells = static_cast<std::size_t>(std::max(1.0, curve.length_mm() / options.cell_mm));
    const double length = curve.length_mm() / static_cast<double>(cells);
    constexpr double kCountable = 1e9;  // cells
    std::vector<std::vector<Beside>> members(cells);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto near = search.beside(part_from_base * cloud.points[i]);
        if (!near || near->outward_mm < -options.window_mm || near->outward_mm > options.beyond_mm ||
            std::abs(near->normal_mm) > options.window_mm)
            continue;
        if (curve.sided && cloud.has_towards() &&
            (base_from_part.linear() * near->foot.normal).dot(cloud.towards[i].cast<double>()) < kTowards)
            continue;
        const auto k = static_cast<std::size_t>(std::clamp(near->foot.arc_mm / length, 0.0, kCountable));
        members[std::min(k, cells - 1)].push_back({near->outward_mm, near->normal_mm});
    }
    std::vector<CellEnd> out;
    for (std::size_t k = 0; k < cells; ++k) {
        if (members[k].size() < 8) continue;
        CellEnd end;
        end.curve = index;
        end.foot = at_arc(curve, (static_cast<double>(k) + 0.5) * length);
        if (find_end(members[k], options, end)) out.push_back(end);
    }
    return out;
}

}  // namespace seamwright
