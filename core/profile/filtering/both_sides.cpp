// Every point decided again, seen from both sides.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/profile/filtering/filter_steps.h"

namespace seamwright::contour {
namespace {

constexpr double kSharp = 1.5, kDoubt = 0.4;  // a sharp prediction's variance; share of the limit from which
                                              // a point that needs more is doubtful
constexpr int kUnchecked = 3;  // lines across which a smooth link is taken without looking from both sides

}  // namespace

void run_backward(Workspace& w, const Model& m) {
    const int n = int(w.path.size());
    w.backward.resize(std::size_t(n));
    w.wanted.assign(std::size_t(n), 0);
    for (int k = 0, until = -1; k < n; ++k) {
        const int c = w.path[std::size_t(k)];
        if (!w.nodes[std::size_t(c)].calm || (k > 0 && w.path[std::size_t(k) - 1] != c - 1))
            until = k + kWarmUp;
        w.wanted[std::size_t(k)] = k <= until;
    }
    State state;
    Held held;
    for (int k = n - 1; k >= 0; --k) {
        if (!w.wanted[std::size_t(k)]) continue;
        const Candidate& point = w.candidates[std::size_t(w.path[std::size_t(k)])];
        const int after = k + 1 < n && w.wanted[std::size_t(k) + 1] ? w.path[std::size_t(k) + 1] : -1;
        const int i = after < 0 ? 0 : w.candidates[std::size_t(after)].line - point.line;
        double d2 = 0;
        if (after < 0 || w.nodes[std::size_t(after)].link == Link::start) {
            state = first_point(m, point.x, point.z);
            held.points = 0;
        } else if (!(i == 1 && follow(m, held, state, point.x, point.z, kCalm * m.outlier_cost, d2))) {
            bool fits = false;
            held.points = 0;
            if (state.age >= 2) {
                const Deviation d = deviation(m, state, point.x, point.z, i);
                fits = 0.5 * d.d2 < m.outlier_cost;
                if (fits) accept(m, state, d, i);
                if (fits && i == 1) hold(m, state, d, held);
            }
            if (!fits) accept_any_direction(m, state, point.x, point.z, i);
        }
        w.backward[std::size_t(k)] = state;
    }
}

namespace {

// The same for any S and spread of the spacing.
double distance2(const Model& m, const State& s, double ex, double ez, double S, double along) {
    return squared_distance(m, s, ex, ez, S, along, across_variance(m, s));
}

enum class Verdict : std::uint8_t {
    out,
    doubtful,  // in the band, but only because the predictions are vague
    in
};

// Is the point in the band seen from the states before and after it (either may be missing)? Where both agree
// they count together, sharper than either; beside that a point may continue one side straight on, which is
// how points next to a sharp edge look.
Verdict in_band(const Model& m, const State* before, int i_before, const State* after, int i_after, double x,
                double z) {
    const double limit = 2 * m.outlier_cost, doubt = kDoubt * limit;
    Deviation f, b;
    if (before) f = deviation(m, *before, x, z, i_before);
    if (after) b = deviation(m, *after, x, z, i_after);
    const auto judge = [&](bool accepted, const State& s, double ex, double ez, double along) {
        if (!accepted) return Verdict::out;
        return distance2(m, s, ex, ez, kSharp, along) < doubt ? Verdict::in : Verdict::doubtful;
    };
    if (before && after) {
        const double along = std::min(f.along, b.along);
        const double excess = std::min(before->excess, after->excess);
        if (distance2(m, *before, f.ex - b.ex, f.ez - b.ez, f.p11 + b.p11, along) < limit * excess) {
            const double wf = b.p11 / (f.p11 + b.p11), wb = 1 - wf;
            const double ex = wf * f.ex + wb * b.ex, ez = wf * f.ez + wb * b.ez;
            const bool accepted =
                distance2(m, *before, ex, ez, 1 + wf * f.p11, along) < limit * excess ||
                distance2(m, *before, f.ex, f.ez, 1 + f.straight, f.along) < limit * excess ||
                distance2(m, *after, b.ex, b.ez, 1 + b.straight, b.along) < limit * excess;
            return judge(accepted, *before, ex, ez, along);
        }
    }
    if (before && f.d2 < limit) return judge(true, *before, f.ex, f.ez, f.along);
    return after ? judge(b.d2 < limit, *after, b.ex, b.ez, b.along) : Verdict::out;
}

// Parabola x(t), z(t) through the given points, t = line - line0; `factor` is the variance of its value at t
// = 0 in units of the measuring variance.
struct LocalFit {
    double x = 0, z = 0, vx = 0, vz = 0, ax = 0, az = 0, factor = 0;
    bool ok = false;
};

LocalFit local_fit(const Workspace& w, const int* points, int n, int line0) {
    constexpr int size = 3;
    constexpr double kSingular = 1e-9;
    // Normal equations over t = line - line0, about the prediction at t = 0: 3 x 3 by elimination.
    LocalFit fit;
    double s[5] = {}, bx[3] = {}, bz[3] = {};
    const Candidate& origin = w.candidates[std::size_t(points[0])];
    for (int k = 0; k < n; ++k) {
        const Candidate& p = w.candidates[std::size_t(points[k])];
        const double t = p.line - line0, dx = p.x - origin.x, dz = p.z - origin.z;
        double power = 1;
        for (int j = 0; j < 5; ++j, power *= t) {
            s[j] += power;
            if (j < 3) bx[j] += power * dx, bz[j] += power * dz;
        }
    }
    double a[3][6] = {};  // matrix | x | z | first unit vector, whose solution's first entry is the variance
    for (int r = 0; r < size; ++r) {
        for (int c = 0; c < size; ++c) a[r][c] = s[r + c];
        a[r][3] = bx[r], a[r][4] = bz[r], a[r][5] = r == 0 ? 1 : 0;
    }
    for (int r = 0; r < size; ++r) {
        if (!(a[r][r] > kSingular * s[2 * r])) return fit;
        for (int q = 0; q < size; ++q) {
            if (q == r) continue;
            const double factor = a[q][r] / a[r][r];
            for (int c = r; c < 6; ++c) a[q][c] -= factor * a[r][c];
        }
    }
    fit.x = origin.x + a[0][3] / a[0][0], fit.z = origin.z + a[0][4] / a[0][0];
    fit.vx = a[1][3] / a[1][1], fit.vz = a[1][4] / a[1][1];
    fit.ax = a[2][3] / a[2][2], fit.az = a[2][4] / a[2][2];
    fit.factor = a[0][5] / a[0][0];
    fit.ok = true;
    return fit;
}

}  // namespace

void settle_doubtful(Workspace& w, const Model& m) {
    constexpr int kSide = 4;
    constexpr double kGoodFit = 2.0;
    constexpr double kFarOff = 2.4;  // outliers
    for (const int c : w.doubtful) {
        const Candidate& p = w.candidates[std::size_t(c)];
        const auto contour_of = [&](int k) {
            const int piece = w.piece[std::size_t(k)];
            return piece < 0 ? -1 : w.contour_of_piece[std::size_t(piece)];
        };
        const int contour = contour_of(c);
        int side[2][kSide], count[2] = {0, 0};
        for (int d = 0; d < 2; ++d)
            for (int k = c + (d ? 1 : -1); k >= 0 && k < int(w.candidates.size()) && count[d] < kSide;
                 k += d ? 1 : -1) {
                if (contour_of(k) >= 0 && contour_of(k) != contour) break;
                if (std::abs(w.candidates[std::size_t(k)].line - p.line) > 2 * kShortGap) break;
                if (contour_of(k) == contour && !w.vague[std::size_t(k)]) side[d][count[d]++] = k;
            }
        if (count[0] < 3 || count[1] < 3) continue;
        // More than a burst between them may be a groove or a ridge, of which they know nothing.
        if (w.candidates[std::size_t(side[1][0])].line - w.candidates[std::size_t(side[0][0])].line >
            m.window + 1)
            continue;
        int both[2 * kSide], n = 0;
        for (int d = 0; d < 2; ++d)
            for (int k = 0; k < count[d]; ++k) both[n++] = side[d][k];
        const LocalFit fit = local_fit(w, both, n, p.line);
        if (!fit.ok) continue;
        State s;
        s.vx = fit.vx, s.vz = fit.vz;
        const double along = m.initial_sigma * m.initial_sigma;
        double misfit = 0;
        for (int k = 0; k < n; ++k) {
            const Candidate& q = w.candidates[std::size_t(both[k])];
            const double t = q.line - p.line;
            const double ex = q.x - fit.x - t * (fit.vx + t * fit.ax),
                         ez = q.z - fit.z - t * (fit.vz + t * fit.az);
            misfit += distance2(m, s, ex, ez, 1, along);
        }
        if (misfit > kGoodFit * (n - 3)) continue;
        if (distance2(m, s, p.x - fit.x, p.z - fit.z, 1 + fit.factor, along) > kFarOff * m.outlier_cost)
            w.piece[std::size_t(c)] = -1;
    }
}

int verify(Workspace& w, const Model& m) {
    const int n = int(w.path.size());
    w.piece.assign(w.candidates.size(), -1);
    w.vague.assign(w.candidates.size(), 0);
    w.doubtful.clear();
    const auto put = [&](int c, int number, Verdict verdict) {
        if (verdict == Verdict::out) return false;
        w.piece[std::size_t(c)] = number;
        if (verdict == Verdict::doubtful) w.vague[std::size_t(c)] = 1, w.doubtful.push_back(c);
        return true;
    };
    int piece = 0, contour = 0;
    bool behind_edge = false;  // the smooth piece begins at one
    w.contour_of_piece.assign(1, 0);
    for (int k = -1; k < n; ++k) {
        const int here = k >= 0 ? w.path[std::size_t(k)] : -1;
        const int next = k + 1 < n ? w.path[std::size_t(k) + 1] : -1;
        const int end = next >= 0 ? next : int(w.candidates.size());
        if (here >= 0 && w.nodes[std::size_t(here)].calm && here + 1 == end) {
            w.piece[std::size_t(here)] = piece;
            continue;
        }
        if (k > 0) {
            const bool smooth = w.nodes[std::size_t(w.path[std::size_t(k)])].link == Link::smooth;
            contour += !smooth;
            if (!smooth) behind_edge = w.nodes[std::size_t(w.path[std::size_t(k)])].link == Link::edge;
            if (!smooth ||
                line_difference(w, w.path[std::size_t(k) - 1], w.path[std::size_t(k)]) > kUnchecked) {
                ++piece;
                w.contour_of_piece.push_back(contour);
            }
        }
        const bool next_starts = next >= 0 && w.nodes[std::size_t(next)].link == Link::start;
        if (here >= 0) {
            const Candidate& p = w.candidates[std::size_t(here)];
            const bool starts = k == 0 || w.nodes[std::size_t(here)].link == Link::start;
            const State* before = starts ? nullptr : &w.nodes[std::size_t(w.path[std::size_t(k) - 1])].state;
            const State* after = next < 0 || next_starts ? nullptr : &w.backward[std::size_t(k) + 1];
            const bool any_before = before != nullptr, any_after = after != nullptr;
            if (before && before->age < kMature) before = nullptr;
            if (after && after->age < kMature) after = nullptr;
            // Beside a sharp edge the side beyond it says nothing, and a flank of a few points has no other.
            if (!after && any_after && w.nodes[std::size_t(here)].link == Link::edge) before = nullptr;
            if (!before && any_before && behind_edge && w.backward[std::size_t(k)].age == 2) after = nullptr;
            const int ib = before ? p.line - w.candidates[std::size_t(w.path[std::size_t(k) - 1])].line : 0;
            const int ia = after ? w.candidates[std::size_t(next)].line - p.line : 0;
            if (before || after)
                put(here, piece, in_band(m, before, ib, after, ia, p.x, p.z));
            else
                put(here, piece, Verdict::in);
        }
        // The points left out between here and next.
        const State* before = here >= 0 ? &w.nodes[std::size_t(here)].state : nullptr;
        const State* after = next >= 0 ? &w.backward[std::size_t(k) + 1] : nullptr;
        if (before && before->age < kMature) before = nullptr;
        if (after && after->age < kMature) after = nullptr;
        for (int c = here + 1; c < end; ++c) {
            const Candidate& p = w.candidates[std::size_t(c)];
            const int ib = p.line - (here >= 0 ? w.candidates[std::size_t(here)].line : 0);
            const int ia = (next >= 0 ? w.candidates[std::size_t(next)].line : 0) - p.line;
            const State* const from_left = ib <= kShortGap ? before : nullptr;
            const State* const from_right = ia <= kShortGap ? after : nullptr;
            if (next_starts) {
                if (!(from_left && put(c, piece, in_band(m, from_left, ib, nullptr, 0, p.x, p.z))) &&
                    from_right)
                    put(c, k < 0 ? 0 : piece + 1, in_band(m, nullptr, 0, from_right, ia, p.x, p.z));
            } else if (from_left || from_right) {
                put(c, piece, in_band(m, from_left, ib, from_right, ia, p.x, p.z));
            }
        }
    }
    return n > 0 ? piece + 1 : 0;
}

}  // namespace seamwright::contour
