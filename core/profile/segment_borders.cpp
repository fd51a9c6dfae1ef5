// Where a segment begins. The cheapest explanation of a step that a few points stand in may be two sharp
// edges, one above the other, or a row of outliers: the pieces in between are too short to know a direction,
// and the border between the segments comes to lie where the direction is known again, several points inside
// of the surface that begins there. A straight line over the first points of a segment, taken backwards, says
// which of the points before it are its own.
//
// And where it ends on a rounding. A rim that turns away from the sensor within a few pitches turns more from point to
// point than the tracker expects, and its last points are cheaper as outliers than as sharp edges. They are told from a
// burst of outliers by lying on one arc that leaves the contour before them along its tangent, turns towards the
// vertical and has a radius of at least kLeastRadius pitches; one point alone must be announced by those before it.

#include <algorithm>
#include <cmath>

#include "core/profile/contour_sequence.h"

namespace seamwright::contour {
namespace {

constexpr int kBorderFit = 8, kBorderFewest = 4;  // points of the line; fewer know none
constexpr int kBorderMost = 12;                   // points that are looked at
constexpr double kBorderShare = 0.5;              // of the points that both sides explain: nothing to decide

constexpr int kArcMost = 6;   // outliers at an end that are looked at
constexpr int kArcLine = 10;  // points of the straight before the arc
constexpr double kArcStarts[] = {0, 0.5, 1, 1.5, 2, 3, 4, 5, 7, 9, 12, 16, 22, 30};  // pitches before the end
constexpr int kArcInside = 40;                                                       // points before the end
constexpr double kLeastRadius = 1.5;  // in pitches: less is an edge
constexpr double kArcBand = 3.5;      // sigma
constexpr double kArcFit = 2.5;       // mean square of the deviations, in sigma
constexpr double kArcSeen = 4;        // squared sigma by which the points before must prefer the arc, or
constexpr double kArcNear = 7;  // sigma, no farther off the straight than a rounding and nearer than dust

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

// An arc beside a straight: signed distance of (s, h) from it, s along the straight from where the arc begins, h across
// towards the arc's side.
double off_arc(double s, double h, double radius) {
    return s <= 0 ? h : radius - std::hypot(s, radius - h);
}

// Of the `count` outliers behind the segment's end `c` how many belong to the arc on which it ends.
int on_the_arc(const Workspace& w, const Model& m, const std::vector<int>& inside, const int* outside,
               int count) {
    const auto at = [&](int k) -> const Candidate& { return w.candidates[std::size_t(k)]; };
    for (int take = count; take > 0; --take)
        for (const double start : kArcStarts) {
            const int back = int(std::ceil(start));
            if (back + kBorderFewest > int(inside.size())) break;
            // The straight before the arc, from its end inwards.
            State line;
            line_through(w, inside.data() + back, std::min<int>(kArcLine, int(inside.size()) - back), line);
            if (!(line.spacing2 > 0)) continue;
            const double spacing = std::sqrt(line.spacing2), ux = line.vx / spacing, uz = line.vz / spacing;
            // The radius is the last point's, whose deviation stands against that of the straight.
            const Candidate& last = at(outside[take - 1]);
            const double from = spacing * (back - start);
            const auto along = [&](const Candidate& p) {
                return ux * (p.x - line.x) + uz * (p.z - line.z) - from;
            };
            const auto across = [&](const Candidate& p) { return ux * (p.z - line.z) - uz * (p.x - line.x); };
            const double side = across(last) < 0 ? -1 : 1, rise = std::abs(across(last)), s = along(last);
            const double radius = rise > 0 ? 0.5 * (s * s + rise * rise) / rise : 0;
            if (!(s > 0) || radius < kLeastRadius * spacing || rise > 1.02 * radius) continue;
            const double turned = side * std::asin(std::min(s / radius, 1.0));
            if (std::abs(uz * std::cos(turned) + ux * std::sin(turned)) < std::abs(uz)) continue;
            double square = 0, worst = 0, straight = 0;
            int n = 0;
            const auto add = [&](const Candidate& p) {
                const double ps = along(p), ph = side * across(p), off = off_arc(ps, ph, radius);
                // Noise across the arc there, and of the straight.
                const double tilt = ps > 0 ? side * std::asin(std::min(ps / radius, 1.0)) : 0;
                const double nx = -uz * std::cos(tilt) - ux * std::sin(tilt),
                             nz = ux * std::cos(tilt) - uz * std::sin(tilt);
                const double lines = (ps + from) / spacing;
                const double variance = (nx * nx * m.sx2 + nz * nz * m.sz2) *
                                        (1 + line.p11 + lines * (2 * line.p12 + lines * line.p22));
                const double e2 = off * off / variance;
                square += e2, worst = std::max(worst, e2), ++n;
                straight += ph * ph / variance;
            };
            for (int k = 0; k < back; ++k) add(at(inside[std::size_t(k)]));
            const bool seen = straight - square > kArcSeen || rise * rise < kArcNear * kArcNear * m.sz2;
            for (int k = 0; k < take; ++k) add(at(outside[k]));
            if (worst < kArcBand * kArcBand && square < kArcFit * n && (seen || take > 1)) return take;
        }
    return 0;
}

// Gives the segment that ends at candidate `c` the outliers next to it on which it rounds off.
void round_off(const Workspace& w, const Model& m, std::vector<std::int32_t>& segment, int c, int step) {
    const int n = int(w.candidates.size());
    const auto of = [&](int k) -> std::int32_t& {
        return segment[std::size_t(w.candidates[std::size_t(k)].line)];
    };
    int outside[kArcMost], count = 0;
    int k = c + step;
    for (int before = c; k >= 0 && k < n && count < kArcMost; before = k, k += step) {
        if (of(k) != kOutlier ||
            std::abs(w.candidates[std::size_t(k)].line - w.candidates[std::size_t(before)].line) > 2)
            break;
        outside[count++] = k;
    }
    if (count == 0) return;
    // Where the segment goes on behind them they are a burst.
    while (k >= 0 && k < n && of(k) == kOutlier) k += step;
    if (k >= 0 && k < n && of(k) == of(c)) return;
    thread_local std::vector<int> inside;
    inside.clear();
    for (int i = c; i >= 0 && i < n && inside.size() < std::size_t(kArcInside); i -= step)
        if (of(i) == of(c)) inside.push_back(i);
    const int taken = on_the_arc(w, m, inside, outside, count);
    for (int i = 0; i < taken; ++i) of(outside[i]) = of(c);
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
    // Of neighbours the one that ends first in the sensor's order takes first.
    last = -1;
    for (int k = 0; k < n; ++k) {
        if (of(k) == kOutlier) continue;
        if (last < 0 || of(last) != of(k)) {
            if (last >= 0) round_off(w, m, segment, last, 1);
            round_off(w, m, segment, k, -1);
        }
        last = k;
    }
    if (last >= 0) round_off(w, m, segment, last, 1);
}

}  // namespace seamwright::contour
