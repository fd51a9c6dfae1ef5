// Where a segment begins. The cheapest explanation of a step that a few points stand in may be two sharp
// edges, one above the other, or a row of outliers: the pieces in between are too short to know a direction,
// and the border between the segments comes to lie where the direction is known again, several points inside
// of the surface that begins there. A straight line over the first points of a segment, taken backwards, says
// which of the points before it are its own.
//
// And where it ends on a rounding. A rim that turns away from the sensor within a few pitches turns more from point to
// point than the tracker expects, and its last points are cheaper as outliers than as sharp edges; or one of them is,
// and the next ones are found again. They are told from a burst of outliers by lying on one arc that leaves the contour
// before them along its tangent, turns towards the vertical and has a radius of at least kLeastRadius pitches. One point
// alone must be announced by those before it or be the last that is seen: an outlier falls just there, and just so
// near, far more rarely than a contour rounds off where it goes out of sight.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/profile/contour_sequence.h"

namespace seamwright::contour {
namespace {

constexpr int kBorderFit = 8, kBorderFewest = 4;  // points of the line; fewer know none
constexpr int kBorderMost = 12;                   // points that are looked at
constexpr double kBorderShare = 0.5;              // of the points that both sides explain: nothing to decide

constexpr int kArcMost = 6;   // outliers at an end that are looked at
constexpr int kArcLine = 10;  // points of the straight before the arc
constexpr double kArcStarts[] = {0, 0.5, 1,  1.5, 2,  3,  4,  5,  7,
                                 9, 12,  16, 20,  25, 30, 36, 43, 50};  // pitches before the end
constexpr int kArcInside = 60;                                          // points before the end
constexpr double kLeastRadius = 1.5;                                    // in pitches: less is an edge
constexpr double kArcBand = 3.5;                                        // sigma
constexpr double kArcFit = 2.5;      // mean square of the deviations, in sigma
constexpr int kArcBurst = 3;         // outliers among the points on an arc
constexpr double kArcHopeless = 25;  // the same from which a first guess is given up
constexpr double kArcSeen = 4;       // squared sigma by which the points before must prefer the arc, or
constexpr int kOpenLines = 2;        // missing returns behind a rim
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
    return s <= 0 || h > radius
               ? h
               : radius - std::sqrt(s * s + (radius - h) * (radius - h));  // not on the circle's far side
}

// Of the `count` points behind the segment's end inside.front() how many belong to the arc on which it ends: 0, or more
// than `least`. `open`: nothing is seen behind them. `fitting` says which of them lie on it: all but a burst.
int on_the_arc(const Workspace& w, const Model& m, const std::vector<int>& inside, const int* outside,
               int count, int least, bool open, bool* fitting) {
    const auto at = [&](int k) -> const Candidate& { return w.candidates[std::size_t(k)]; };
    // The straights before the arc, from their ends inwards.
    constexpr int kStarts = int(std::size(kArcStarts));
    State lines[kStarts];
    int starts = 0;
    for (; starts < kStarts; ++starts) {
        const int back = int(std::ceil(kArcStarts[starts]));
        if (back + kBorderFewest > int(inside.size())) break;
        line_through(w, inside.data() + back, std::min<int>(kArcLine, int(inside.size()) - back),
                     lines[starts]);
    }
    for (int take = count; take > least; --take)
        for (int number = 0; number < starts; ++number) {
            const double start = kArcStarts[number];
            const int back = int(std::ceil(start)), all = std::min(back + kArcLine, int(inside.size()));
            const State& line = lines[number];
            if (!(line.spacing2 > 0)) continue;
            const double spacing = std::sqrt(line.spacing2), from = spacing * (back - start);
            double x = line.x, z = line.z, ux = line.vx / spacing, uz = line.vz / spacing;
            const Candidate& last = at(outside[take - 1]);
            double radius = 0, side = 1;
            struct Off {
                double off, shift, turn,
                    variance;  // of the contour; its derivatives by the straight's; of the noise
            };
            const auto off_of = [&](const Candidate& p) {
                const double l = ux * (p.x - x) + uz * (p.z - z),
                             h = side * (ux * (p.z - z) - uz * (p.x - x));
                const double s = l - from, sine = s > 0 ? std::min(s / radius, 1.0) : 0,
                             cosine = std::sqrt(1 - sine * sine);
                // The contour's normal there.
                const double nx = -uz * cosine - side * ux * sine, nz = ux * cosine - side * uz * sine;
                return Off{off_arc(s, h, radius), side * cosine, side * cosine * l,
                           nx * nx * m.sx2 + nz * nz * m.sz2};
            };
            // The straight alone knows little of its direction some points ahead; with the points on the arc it does.
            // The radius is the last point's, whose deviation stands against that of the rest.
            double c00 = 0, c01 = 0, c11 = 0, square = 0;
            bool fits = true;
            for (int round = 0; round < 3 && fits; ++round) {
                const double s = ux * (last.x - x) + uz * (last.z - z) - from,
                             across = ux * (last.z - z) - uz * (last.x - x), rise = std::abs(across);
                side = across < 0 ? -1 : 1;
                radius = rise > 0 ? 0.5 * (s * s + rise * rise) / rise : 0;
                fits = s > 0 && radius >= kLeastRadius * spacing && rise <= 1.02 * radius;
                if (!fits) break;
                const double turned = side * std::asin(std::min(s / radius, 1.0));
                fits = std::abs(uz * std::cos(turned) + ux * std::sin(turned)) >= std::abs(uz);
                // Most guesses miss the points before the end by far; the straight ahead is known by its covariance.
                if (fits && round == 0)
                    for (int k : {0, back / 2}) {
                        if (k >= back) break;
                        const Off o = off_of(at(inside[std::size_t(k)]));
                        const double ahead = o.turn * o.turn / spacing / spacing;
                        fits = fits && o.off * o.off < kArcHopeless * o.variance *
                                                           (1 + line.p11 + 2 * line.p12 * std::sqrt(ahead) +
                                                            ahead * line.p22);
                    }
                double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0;
                square = 0;
                for (int k = 0; k < all && fits; ++k) {
                    const Off o = off_of(at(inside[std::size_t(k)]));
                    const double weight = 1 / o.variance;
                    a00 += weight * o.shift * o.shift, a01 += weight * o.shift * o.turn,
                        a11 += weight * o.turn * o.turn;
                    b0 += weight * o.shift * o.off, b1 += weight * o.turn * o.off;
                    square += weight * o.off * o.off;
                }
                const double determinant = a00 * a11 - a01 * a01;
                fits = fits && determinant > 1e-9 * a00 * a11 && square < kArcHopeless * all;
                if (!fits || round == 2) break;
                c00 = a11 / determinant, c01 = -a01 / determinant, c11 = a00 / determinant;
                const double shift = c00 * b0 + c01 * b1, turn = c01 * b0 + c11 * b1;
                x -= shift * uz, z += shift * ux;
                const double length = std::sqrt(1 + turn * turn), vx = ux - turn * uz, vz = uz + turn * ux;
                ux = vx / length, uz = vz / length;
            }
            if (!fits) continue;
            // One point alone must be announced by those before it, lie nearer than dust can be told, or be the last
            // that is seen.
            bool seen = take > 1 || (open && take == count);
            if (!seen) {
                const double rise = ux * (last.z - z) - uz * (last.x - x);
                seen = rise * rise < kArcNear * kArcNear * m.sz2;
            }
            if (!seen) {
                State whole;
                line_through(w, inside.data(), all, whole);
                double straight = 0;
                for (int k = 0; k < all; ++k) {
                    const Candidate& p = at(inside[std::size_t(k)]);
                    const double off = whole.vx * (p.z - whole.z) - whole.vz * (p.x - whole.x);
                    straight += off * off / across_variance(m, whole);
                }
                seen = straight - square > kArcSeen;
            }
            if (!seen) continue;
            double worst = 0;
            for (int k = 0; k < back; ++k) {
                const Off o = off_of(at(inside[std::size_t(k)]));
                worst = std::max(worst, o.off * o.off / o.variance);
            }
            // A burst on the arc leaves the others on it.
            int burst = 0;
            for (int k = 0; k < take; ++k) {
                const Off o = off_of(at(outside[k]));
                const double e2 =
                    o.off * o.off /
                    (o.variance + o.shift * (o.shift * c00 + 2 * o.turn * c01) + o.turn * o.turn * c11);
                fitting[k] = e2 < kArcBand * kArcBand;
                fitting[k] ? square += e2 : ++burst;
            }
            if (burst > 0 && (burst > kArcBurst || take - burst < 2)) continue;
            if (worst < kArcBand * kArcBand && square < kArcFit * (all + take - burst)) return take;
        }
    return 0;
}

// Gives the segment that ends at candidate `c` the outliers next to it, or among its last points, on which it rounds off.
void round_off(const Workspace& w, const Model& m, std::vector<std::int32_t>& segment, int c, int step) {
    const int n = int(w.candidates.size());
    const auto of = [&](int k) -> std::int32_t& {
        return segment[std::size_t(w.candidates[std::size_t(k)].line)];
    };
    const auto lines_apart = [&](int a, int b) {
        return std::abs(w.candidates[std::size_t(b)].line - w.candidates[std::size_t(a)].line);
    };
    int outside[kArcMost], count = 0;
    bool fitting[kArcMost];
    const std::int32_t own = of(c);
    // Outliers behind the end, and whether anything is seen behind them.
    int end = c, k = c + step;
    for (; k >= 0 && k < n && of(k) == kOutlier && lines_apart(end, k) <= 2; k += step) end = k;
    const int behind = k;
    while (k >= 0 && k < n && of(k) == kOutlier) k += step;
    const int lines_left = step > 0 ? int(segment.size()) - 1 - w.candidates[std::size_t(end)].line
                                    : w.candidates[std::size_t(end)].line;
    const bool open = (behind >= 0 && behind < n ? lines_apart(end, behind) - 1 : lines_left) >= kOpenLines;
    // Where the segment goes on behind them they are a burst.
    const bool burst = !open && k >= 0 && k < n && of(k) == own;
    thread_local std::vector<int> inside;
    const auto take_from = [&](int from, int least) {
        count = 0;
        for (int i = from + step; i != end + step && count < kArcMost; i += step) outside[count++] = i;
        inside.clear();
        for (int i = from; i >= 0 && i < n && inside.size() < std::size_t(kArcInside); i -= step)
            if (of(i) == own) inside.push_back(i);
        const int taken =
            on_the_arc(w, m, inside, outside, count, least, open && outside[count - 1] == end, fitting);
        for (int i = 0; i < taken; ++i)
            if (fitting[i]) of(outside[i]) = own;
        return taken > 0;
    };
    if (!burst && end != c && take_from(c, 0)) return;
    // A point among the last ones may have been given up for a sharp turn, and the next ones found again.
    for (int i = c - step, looked = 1; i >= 0 && i < n && looked < kArcMost; i -= step, ++looked) {
        if (of(i) != kOutlier) continue;
        int from = i;
        while (from >= 0 && from < n && of(from) == kOutlier) from -= step;
        if (from < 0 || from >= n || of(from) != own || lines_apart(from, c) > kArcMost) return;
        // On the straight there was no turn.
        const BorderLine before = border_line(w, m, segment, from, -step);
        if (!before.ok() || before.explains(w.candidates[std::size_t(c)])) return;
        end = c;
        if (take_from(from, std::abs(i - from))) return;
    }
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
    // The rims of a hole may belong to one segment.
    last = -1;
    bool gap = false;
    for (int k = 0; k < n; ++k) {
        gap |=
            k > 0 && w.candidates[std::size_t(k)].line - w.candidates[std::size_t(k) - 1].line > kOpenLines;
        if (of(k) == kOutlier) continue;
        if (last < 0 || gap || of(last) != of(k)) {
            if (last >= 0) round_off(w, m, segment, last, 1);
            round_off(w, m, segment, k, -1);
        }
        last = k;
        gap = false;
    }
    if (last >= 0) round_off(w, m, segment, last, 1);
}

}  // namespace seamwright::contour
