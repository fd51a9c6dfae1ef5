// Where a segment begins. The cheapest explanation of a step that a few points stand in may be two sharp
// edges, one above the other, or a row of outliers: the pieces in between are too short to know a direction,
// and the border between the segments comes to lie where the direction is known again, several points inside
// of the surface that begins there. A straight line over the first points of a segment, taken backwards, says
// which of the points before it are its own.

#include <algorithm>
#include <cmath>

#include "core/profile/contour_sequence.h"

namespace seamwright::contour {
namespace {

constexpr int kBorderFit = 8, kBorderFewest = 4;  // points of the line; fewer know none
constexpr int kBorderMost = 12;                   // points that are looked at
constexpr double kBorderShare = 0.5;              // of the points that both sides explain: nothing to decide

// The line at the end of a segment, for points beyond that end.
struct BorderLine {
    const Model& model;
    int line0 = 0;
    State state;
    bool ok() const { return state.age >= kBorderFewest && state.spacing2 > 0; }
    bool explains(const Candidate& p) const {
        const double n = std::abs(p.line - line0);
        const double dx = p.x - state.x - n * state.vx, dz = p.z - state.z - n * state.vz;
        const double off = state.vx * dz - state.vz * dx;
        const double variance = 1 + state.p11 + n * (2 * state.p12 + n * state.p22);
        return off * off < model.band * model.band * variance * across_variance(model, state);
    }
};

// Over the segment's points from candidate `c` inwards, `step` = 1 or -1.
BorderLine border_line(const Workspace& w, const Model& m, const std::vector<std::int32_t>& segment, int c,
                       int step) {
    BorderLine line{m, w.candidates[std::size_t(c)].line, {}};
    const int n = int(w.candidates.size());
    const auto of = [&](int k) { return segment[std::size_t(w.candidates[std::size_t(k)].line)]; };
    int points[kBorderFit], count = 0;
    for (int k = c; k >= 0 && k < n && count < kBorderFit; k += step) {
        if (of(k) == kOutlier) continue;
        if (of(k) != of(c)) break;
        points[count++] = k;
    }
    if (count >= kBorderFewest) line_through(w, points, count, line.state);
    return line;
}

// Gives the segment that ends at candidate `c` the points next to it, in the direction `step`, that its line
// explains and their own segment's does not.
void extend(const Workspace& w, const Model& m, std::vector<std::int32_t>& segment, int c, int step) {
    const int n = int(w.candidates.size());
    const auto of = [&](int k) -> std::int32_t& {
        return segment[std::size_t(w.candidates[std::size_t(k)].line)];
    };
    const BorderLine line = border_line(w, m, segment, c, -step);
    if (!line.ok()) return;
    const std::int32_t own = of(c);
    std::int32_t other = kOutlier;
    int end = c;  // the last one explained
    for (int k = c + step, looked = 0; k >= 0 && k < n && looked < kBorderMost; k += step, ++looked) {
        const std::int32_t s = of(k);
        if (s != kOutlier && other != kOutlier && s != other) break;
        if (s != kOutlier) other = s;
        if (!line.explains(w.candidates[std::size_t(k)])) break;
        end = k;
    }
    if (end == c) return;
    // What the neighbour would have left must know a direction of its own, and not explain the points as well.
    int next = end + step;
    while (next >= 0 && next < n && of(next) == kOutlier) next += step;
    const bool neighbour = next >= 0 && next < n && other != kOutlier && of(next) == other;
    if (other != kOutlier && !neighbour) return;
    if (neighbour) {
        const BorderLine rest = border_line(w, m, segment, next, step);
        if (!rest.ok()) return;
        int both = 0, all = 0;
        for (int k = c + step; k != end + step; k += step)
            ++all, both += rest.explains(w.candidates[std::size_t(k)]);
        if (both > kBorderShare * all) return;
    }
    for (int k = c + step; k != end + step; k += step) of(k) = own;
}

}  // namespace

void settle_borders(const Workspace& w, const Model& m, std::vector<std::int32_t>& segment) {
    const int n = int(w.candidates.size());
    const auto of = [&](int k) { return segment[std::size_t(w.candidates[std::size_t(k)].line)]; };
    int last = -1;  // candidate with a segment
    for (int k = 0; k < n; ++k) {
        if (of(k) == kOutlier) continue;
        if (last >= 0 && of(last) != of(k)) {
            extend(w, m, segment, k, -1);
            // `last` may have changed hands.
            int end = k - 1;
            while (end >= 0 && (of(end) == kOutlier || of(end) == of(k))) --end;
            if (end >= 0) extend(w, m, segment, end, 1);
        }
        last = k;
    }
}

}  // namespace seamwright::contour
