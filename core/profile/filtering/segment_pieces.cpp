// Pieces that belong to one contour, joined to segments and numbered.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/profile/filtering/filter_steps.h"

namespace seamwright::contour {
namespace {

constexpr double kSpacingGap = 3.5;  // distance in spacings per line beyond which the contour is interrupted
constexpr int kFitPoints = 6,
              kLongFitPoints = 12;      // of the line at the end of a piece: near, across a long gap
constexpr double kLongGapSlope = 0.03;  // uncertainty of direction across longer gaps, rad

double dot_across(const State& s, double dx, double dz) {
    const double length = std::sqrt(s.vx * s.vx + s.vz * s.vz);
    return length > 0 ? (s.vx * dz - s.vz * dx) / length : std::sqrt(dx * dx + dz * dz);
}

// Straight line over the (at most kFitPoints) points of a piece from its end at candidate `c` inwards: for a
// tracker that had no time to learn the direction. Direction of travel as for the tracker that comes from
// inside to `c`.
State end_line(const Workspace& w, int c, int step, int points, const State& fallback) {
    int found[kLongFitPoints], n = 0;
    const int piece = w.piece[std::size_t(c)];
    for (int k = c; k >= 0 && k < int(w.candidates.size()) && n < points; k += step) {
        const int other = w.piece[std::size_t(k)];
        if (other >= 0 && other != piece) break;
        if (other >= 0) found[n++] = k;
    }
    if (n < kMature) return fallback;
    State s = fallback;
    line_through(w, found, n, s);
    return s;
}

// Do the pieces that end at path element ka and begin at kb belong to one contour? They do when one line
// continues the other within its uncertainty, or when both meet between the two points (a sharp edge), and no
// spacing is missing.
bool continuous(const Workspace& w, const Model& m, int ka, int kb) {
    const int ca = w.path[std::size_t(ka)], cb = w.path[std::size_t(kb)];
    const Candidate &a = w.candidates[std::size_t(ca)], &b = w.candidates[std::size_t(cb)];
    State left = w.nodes[std::size_t(ca)].state, right = w.backward[std::size_t(kb)];
    const double n = line_difference(w, ca, cb);
    const bool far = n > kShortGap;
    if (far || left.age < kSettled) left = end_line(w, ca, -1, far ? kLongFitPoints : kFitPoints, left);
    if (far || right.age < kSettled) right = end_line(w, cb, +1, far ? kLongFitPoints : kFitPoints, right);
    const double distance = std::hypot(b.x - a.x, b.z - a.z);
    const double spacing = std::max({left.spacing(), right.spacing(), 0.5 * m.scale.spacing});
    if (!(distance < kSpacingGap * spacing * n + m.band * kReachNoise * m.scale.largest())) return false;
    if (left.age < kMature || right.age < kMature) return n <= kShortGap;

    const auto tolerance = [&](const State& s, const State& other) {
        const double length2 = s.vx * s.vx + s.vz * s.vz;
        const double sigma2 =
            (s.vz * s.vz * m.scale.sx * m.scale.sx + s.vx * s.vx * m.scale.sz * m.scale.sz) / length2;
        const double turn = far ? 0 : kTurn * kTurn * s.spacing2 * n * n * n / 3;
        const double p = s.p11 + n * (2 * s.p12 + n * s.p22) + other.p11;
        return far ? 3 * std::sqrt(sigma2 * p) + kLongGapSlope * n * s.spacing()
                   : m.band * std::sqrt(sigma2 * p + turn);
    };
    const double dx = right.x - left.x, dz = right.z - left.z;
    const bool on_left = std::abs(dot_across(left, dx, dz)) < tolerance(left, right);
    const bool on_right = std::abs(dot_across(right, dx, dz)) < tolerance(right, left);
    if (far) return on_left && on_right;
    if (on_left || on_right) return true;
    // left + alpha v_left = right + beta v_right; v_right points back.
    const double cross = left.vx * right.vz - left.vz * right.vx;
    const double alpha = (dx * right.vz - dz * right.vx) / cross,
                 beta = (dx * left.vz - dz * left.vx) / cross;
    constexpr double kSlack_lines = 0.75;  // beside the noise
    const double slack = kSlack_lines + m.band * m.scale.largest() *
                                            std::sqrt(left.spacing() * right.spacing()) / std::abs(cross);
    return alpha > -slack && alpha < n + slack && beta > -slack && beta < n + slack;
}

}  // namespace

void number_segments(Workspace& w, const Model& m, int pieces, int min_points, Profile& profile) {
    w.pieces.assign(std::size_t(pieces) * 3, 0);  // per piece: points, first and last path element
    int* const points = w.pieces.data();
    int* const head = points + pieces;
    int* const tail = head + pieces;
    for (int p = 0; p < pieces; ++p) head[p] = tail[p] = -1;
    for (const int p : w.piece)
        if (p >= 0) ++points[p];
    for (int k = 0; k < int(w.path.size()); ++k) {
        const int p = w.piece[std::size_t(w.path[std::size_t(k)])];
        if (p < 0) continue;
        if (head[p] < 0) head[p] = k;
        tail[p] = k;
    }
    // Stack of segments: points, last path element, first piece. Pieces of a dropped segment get -1.
    w.segments.clear();
    const auto top = [&](int field) -> int& {
        return w.segments[w.segments.size() - 3 + std::size_t(field)];
    };
    const auto drop_short = [&] {
        if (!w.segments.empty() && top(0) < min_points) {
            w.segments.resize(w.segments.size() - 3);
            return true;
        }
        return false;
    };
    // `head` is reused: index of the segment on the stack at the time, checked against its first piece
    // afterwards.
    for (int p = 0; p < pieces; ++p) {
        const int first = head[p];
        head[p] = -1;
        if (first < 0) continue;
        for (;;) {
            if (!w.segments.empty() && continuous(w, m, top(1), first)) {
                top(0) += points[p], top(1) = tail[p];
                head[p] = top(2);
                break;
            }
            if (drop_short()) continue;
            w.segments.insert(w.segments.end(), {points[p], tail[p], p});
            head[p] = p;
            break;
        }
    }
    while (drop_short()) {
    }
    // head[p] names a segment by its first piece; number those that stayed, in order.
    for (int p = 0; p < pieces; ++p) points[p] = -1;
    int number = 0;
    for (std::size_t s = 0; s < w.segments.size(); s += 3) points[w.segments[s + 2]] = number++;
    for (std::size_t c = 0; c < w.candidates.size(); ++c) {
        const int p = w.piece[c];
        if (p >= 0 && head[p] >= 0) profile.segment[std::size_t(w.candidates[c].line)] = points[head[p]];
    }
}

}  // namespace seamwright::contour
