#include "core/profile/filter.h"

#include <limits>

#include "core/profile/contour_sequence.h"
#include "core/profile/no_return.h"

namespace seamwright {
namespace {

using namespace contour;

constexpr double kAbsurd = 1e100;    // coordinates beyond are no return: their squares would overflow
constexpr double kSpacingGap = 3.5;  // distance in spacings per line beyond which the contour is interrupted
constexpr int kFitPoints = 6,
              kLongFitPoints = 12;            // of the line at the end of a piece: near, across a long gap
constexpr double kSharp = 1.5, kDoubt = 0.4;  // a sharp prediction's variance; share of the limit from which
                                              // a point that needs more is doubtful
constexpr int kWarmUp = 10;                   // points after which the tracker has forgotten where it began
constexpr int kUnchecked = 3;  // lines across which a smooth link is taken without looking from both sides
constexpr double kRowShare = 0.5;       // two edges as dear as what a burst pays for one, see take_in_rows
constexpr double kLongGapSlope = 0.03;  // uncertainty of direction across longer gaps, rad

Workspace& workspace() {
    thread_local Workspace w;
    return w;
}

bool usable(double v) {
    return std::abs(v) < kAbsurd;
}  // false for NaN

double dot_across(const State& s, double dx, double dz) {
    const double length = std::sqrt(s.vx * s.vx + s.vz * s.vz);
    return length > 0 ? (s.vx * dz - s.vz * dx) / length : std::sqrt(dx * dx + dz * dz);
}

int line_difference(const Workspace& w, int a, int b) {
    return std::abs(w.candidates[std::size_t(b)].line - w.candidates[std::size_t(a)].line);
}

// Rows of points that the cheapest sequence leaves out. There an edge is as dear as it must be for a burst, which would
// come and go with one each, so that a groove or a ridge of a few points, which has three, is cheaper as a row of
// outliers. More than `lookahead` of them are no burst any more: there an edge costs kRowShare of it, and what follows
// itself for min_points points is taken into the path.
void take_in_rows(Workspace& w, const Model& m, int lookahead, int min_points) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const double edge_cost = kRowShare * m.edge_cost;
    const int least = std::max(lookahead + 1, min_points);
    auto& longer = w.longer_path;
    bool any = false;
    for (std::size_t k = 0; k + 1 < w.path.size(); ++k) {
        if (any) longer.push_back(w.path[k]);
        const int a = w.path[k], b = w.path[k + 1];
        if (b - a - 1 < least) continue;
        // As it was found, at the prices of here.
        const double old = m.skip(b - a - 1) + (w.nodes[std::size_t(b)].link == Link::smooth ? 0
                                                : w.nodes[std::size_t(b)].link == Link::edge ? edge_cost
                                                                                             : m.jump_cost);
        const Node a_node = w.nodes[std::size_t(a)];
        w.nodes[std::size_t(a)].cost = 0;
        double ended = 0;  // cheapest cost of ending before the present candidate, after...
        int ended_at = a;
        // The cheapest way to candidate c from those before it back to a, into `node`.
        const auto reach = [&](int c, Node& node) {
            const Candidate& point = w.candidates[std::size_t(c)];
            Deviation best_deviation;
            node.cost = infinite;
            const auto put = [&](double cost, int j, Link link) {
                if (!(cost < node.cost)) return false;
                node.cost = cost, node.previous = j, node.link = link;
                return true;
            };
            put(ended + m.jump_cost, ended_at, Link::start);
            for (int j = c - 1; j >= std::max(a, c - m.window); --j) {
                const Node& from = w.nodes[std::size_t(j)];
                const double cost = from.cost + m.skip(c - j - 1);
                const int i = point.line - w.candidates[std::size_t(j)].line;
                if (i > m.longest_gap) break;
                if (from.state.age >= 2) {
                    const Deviation d = deviation(m, from.state, point.x, point.z, i);
                    if (0.5 * d.d2 < m.outlier_cost && put(cost + 0.5 * d.d2, j, Link::smooth))
                        best_deviation = d;
                }
                if (i > m.edge_window) continue;
                const double ratio = reach_ratio(m, from.state, point.x, point.z, i);
                // After a single point any direction goes on.
                const double turn = from.state.age < 2 ? 0 : edge_cost;
                if (ratio < 1) put(cost + turn + kReachCost * m.outlier_cost * ratio * ratio, j, Link::edge);
            }
            const State& from = w.nodes[std::size_t(node.previous)].state;
            const int i = point.line - w.candidates[std::size_t(node.previous)].line;
            node.calm = false;
            node.state = node.link == Link::start ? first_point(m, point.x, point.z) : from;
            if (node.link == Link::smooth) accept(m, node.state, best_deviation, i);
            if (node.link == Link::edge) {
                accept_any_direction(m, node.state, point.x, point.z, i);
                if (from.age < 2) node.link = Link::smooth;
            }
            ended += m.skip_line;
            if (node.cost < ended) ended = node.cost, ended_at = c;
        };
        for (int c = a + 1; c < b; ++c) reach(c, w.nodes[std::size_t(c)]);
        Node last;
        reach(b, last);
        w.nodes[std::size_t(a)] = a_node;
        int taken = 0;
        for (int c = last.previous; c != a; c = w.nodes[std::size_t(c)].previous) ++taken;
        if (!(last.cost < old) || taken < least) continue;
        if (!any) longer.assign(w.path.begin(), w.path.begin() + std::ptrdiff_t(k) + 1);
        any = true;
        longer.resize(longer.size() + std::size_t(taken));
        for (int c = last.previous, at = int(longer.size()) - 1; c != a;
             c = w.nodes[std::size_t(c)].previous, --at)
            longer[std::size_t(at)] = c;
        w.nodes[std::size_t(b)].link = last.link;
        w.nodes[std::size_t(b)].state = last.state;
        w.nodes[std::size_t(b)].calm = false;
        // The states that follow forget where they came from.
        State state = last.state;
        for (std::size_t q = k + 2; q < w.path.size() && q < k + 2 + kWarmUp; ++q) {
            Node& node = w.nodes[std::size_t(w.path[q])];
            const Candidate& point = w.candidates[std::size_t(w.path[q])];
            const int i = line_difference(w, w.path[q - 1], w.path[q]);
            if (node.link != Link::smooth) break;
            if (state.age < 2) {
                accept_any_direction(m, state, point.x, point.z, i);
            } else {
                const Deviation d = deviation(m, state, point.x, point.z, i);
                if (!(0.5 * d.d2 < m.outlier_cost)) break;
                accept(m, state, d, i);
            }
            node.state = state;
            node.calm = false;
        }
    }
    if (!any) return;
    longer.push_back(w.path.back());
    w.path.swap(longer);
}

// The same tracker along the path from its other end, where anything is to be decided: beside points that are
// not calm, and kWarmUp points before those to learn the contour.
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

// Points that passed only because the predictions were vague (short memory on coarse or steep contours):
// compared with the parabola through their neighbours on both sides, where that fits the neighbours
// themselves.
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

// Decides every point again, seen from both sides, and sets w.piece (number of smooth pieces returned).
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

// Joins pieces to segments, drops the short ones, numbers the rest.
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

}  // namespace

Expected<void> check(const FilterOptions& o) {
    const auto refuse = [](const char* what, const char* where, const char* mend) -> Expected<void> {
        return input_error(what, where, mend);
    };
    if (!(o.noise_mm >= 0) || !std::isfinite(o.noise_mm))
        return refuse("the noise is not a length", "noise_mm", "give 0 (estimate it) or a positive number");
    if (!(o.band_sigmas >= 1 && o.band_sigmas <= 20))
        return refuse("the acceptance band is out of range", "band_sigmas",
                      "give 1 to 20 standard deviations");
    if (o.lookahead < 1 || o.lookahead > 50)
        return refuse("the lookahead is out of range", "lookahead", "give 1 to 50 points");
    if (!(o.average > 0 && o.average <= 1))
        return refuse("the weight of the moving average is out of range", "average",
                      "give a number above 0, at most 1");
    if (!(o.initial_sigma > 0 && o.initial_sigma <= 2))
        return refuse("the initial sigma of the spacing is out of range", "initial_sigma",
                      "give a number above 0, at most 2");
    if (o.min_segment_points < 1)
        return refuse("the shortest segment has no point", "min_segment_points", "give 1 or more");
    return {};
}

Expected<void> filter_profile(Profile& profile, const FilterOptions& options) {
    SEAM_OK(check(options));
    const std::size_t n = profile.x_mm.size();
    if (profile.z_mm.size() != n || (!profile.intensity.empty() && profile.intensity.size() != n))
        return input_error("the columns of the profile differ in length", "x_mm, z_mm, intensity",
                           "give one x, one z and, if any, one intensity per point");
    profile.segment.assign(n, kOutlier);
    if (const auto codes = find_no_return_codes(profile); !codes.empty())
        for (const NoReturnCode& c : codes) erase_no_returns(profile, {c.value});

    Workspace& w = workspace();
    w.candidates.clear(), w.first.clear(), w.path.clear();
    for (std::size_t k = 0; k < n; ++k) {
        if (!usable(profile.x_mm[k]) || !usable(profile.z_mm[k])) continue;
        w.first.push_back(int(w.candidates.size()));
        w.path.push_back(int(w.candidates.size()));
        w.candidates.push_back({profile.x_mm[k], profile.z_mm[k], 0, int(k)});
    }
    w.first.push_back(int(w.candidates.size()));
    if (w.candidates.empty()) return {};
    if (options.as_delivered) {
        for (const auto& c : w.candidates) profile.segment[static_cast<std::size_t>(c.line)] = 0;
        return {};
    }

    const Model rough(estimate_scale(w, w.path, false, options), options);
    cheapest_sequence(w, rough);
    const Model model(estimate_scale(w, w.path, true, options), options);
    take_in_rows(w, model, options.lookahead, options.min_segment_points);
    run_backward(w, model);
    const int pieces = verify(w, model);
    settle_doubtful(w, model);
    number_segments(w, model, pieces, options.min_segment_points, profile);
    settle_borders(w, model, profile.segment);
    return {};
}

}  // namespace seamwright
