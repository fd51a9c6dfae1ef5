#include "core/profile/contour_sequence.h"

#include <limits>

#include "core/profile/z_quantum.h"

namespace seamwright::contour {
namespace {

constexpr int kRoughSamples = 256, kSamples = 1024;  // of a first look, and along a path
constexpr double kMedianToSigma = 1 / 0.6744897501960817;
constexpr double kUpper = 0.75, kUpperToSigma = 1 / 1.1503493803760083;  // a quantile of |normal|
constexpr double kSteep = 2;  // slope from which noise of x counts for more than that of z
constexpr std::size_t kFewestSteep = 6;
constexpr double kLeastRun = 1e-12;                               // of its rise: of a steep place along x
constexpr double kLeastSpacing = 1e-9, kLeastSpacing_mm = 1e-12;  // the former of the coordinates
// In outliers: what a point of unknown direction costs more behind lines that are left out.
constexpr double kAfterSkip = 0.5;
constexpr int kSharedLags[] = {3, 5};
constexpr std::size_t kFewestThird = 40;
constexpr double kSharedSeen = 1.4;   // of the noise beside: less is chance
constexpr double kEvenly = 1e-4;      // of the spacing
constexpr double kNoiseFloor = 0.03;  // of the spacing: below it the direction decides, not the noise

double quantile(std::vector<double>& values, double share) {
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// Standard deviation of a coordinate from absolute second differences. The median is blind to a quarter of
// outliers; the upper quantile, trusted only along a cleaned path, sees noise that quantisation hides from
// the median.
double sigma_of(std::vector<double>& differences, bool clean) {
    if (differences.empty()) return 0;
    double sigma = quantile(differences, 0.5) * kMedianToSigma;
    if (clean || sigma == 0) {
        const double upper = quantile(differences, kUpper) * kUpperToSigma;
        sigma = sigma > 0 ? 0.5 * (sigma + upper) : upper;
    }
    return sigma / std::sqrt(6.);
}

// Noise of x that a profile on an exact grid of x hides in z: resampled there, it stands in z times the
// slope. From the steep places of the path alone; 0 where there are too few of them or z shows no more noise
// than on the flat.
double sigma_along_x(Workspace& w, const std::vector<int>& pick, const Scale& scale) {
    auto& a = w.samples_x;
    auto& slopes = w.samples_z;
    a.clear(), slopes.clear();
    const auto at = [&](std::size_t k) -> const Candidate& { return w.candidates[std::size_t(pick[k])]; };
    const auto smooth = [&](std::size_t k) { return w.nodes[std::size_t(pick[k])].link == Link::smooth; };
    // Over every second line: neighbours on the grid share what they were interpolated from.
    for (std::size_t k = 2; k + 2 < pick.size(); ++k) {
        const Candidate &p = at(k - 2), &c = at(k), &q = at(k + 2);
        const double dx = std::abs(q.x - p.x), dz = std::abs(q.z - p.z);
        if (!(dz > kSteep * dx) || c.line - p.line != 2 || q.line - c.line != 2) continue;
        // Up or down all the way: no peak of noise.
        if ((c.z - p.z) * (q.z - c.z) <= 0 || !smooth(k) || !smooth(k + 1) || !smooth(k + 2)) continue;
        slopes.push_back(dz / std::max(dx, kLeastRun * dz));
        a.push_back(std::abs(p.z - 2 * c.z + q.z) / slopes.back());
    }
    if (a.size() < kFewestSteep) return 0;
    const double slope = quantile(slopes, 0.5), sigma = sigma_of(a, true);
    return std::sqrt(std::max(sigma * sigma - scale.sz * scale.sz / (slope * slope), 0.0));
}

// Logarithm of a jump's size in spacings; 0 where there is none.
double jump_size(const Model& m, const Candidate& from, const Candidate& to) {
    const double dx = to.x - from.x, dz = to.z - from.z;
    const double usual = m.scale.spacing * (to.line - from.line) + m.scale.largest();
    return std::log1p(std::sqrt(dx * dx + dz * dz) / usual);
}

}  // namespace

Scale estimate_scale(Workspace& w, const std::vector<int>& pick, bool along_path,
                     const FilterOptions& options) {
    Scale scale;
    const int n = int(pick.size()), samples = along_path ? kSamples : kRoughSamples;
    const auto at = [&](int k) -> const Candidate& {
        return w.candidates[std::size_t(pick[std::size_t(k)])];
    };
    auto& a = w.samples_x;
    auto& b = w.samples_z;

    const int baseline = n >= 24 ? 8 : 1;
    a.clear();
    double magnitude = 0;
    for (int k = 0, step = std::max(1, n / samples); k + baseline < n; k += step) {
        const double dx = at(k + baseline).x - at(k).x, dz = at(k + baseline).z - at(k).z;
        a.push_back(std::sqrt(dx * dx + dz * dz) / (at(k + baseline).line - at(k).line));
        magnitude = std::max({magnitude, std::abs(at(k).x), std::abs(at(k).z)});
    }
    if (!a.empty()) scale.spacing = quantile(a, 0.5);
    scale.spacing = std::max({scale.spacing, kLeastSpacing * magnitude, kLeastSpacing_mm});

    for (const bool strict : {true, false}) {
        a.clear(), b.clear();
        for (int k = 1, step = std::max(1, n / samples); k + 1 < n; k += step) {
            const Candidate &p = at(k - 1), &c = at(k), &q = at(k + 1);
            if (strict && (c.line - p.line != 1 || q.line - c.line != 1)) continue;
            if (along_path && (w.nodes[std::size_t(pick[std::size_t(k)])].link != Link::smooth ||
                               w.nodes[std::size_t(pick[std::size_t(k + 1)])].link != Link::smooth))
                continue;
            a.push_back(std::abs(p.x - 2 * c.x + q.x));
            b.push_back(std::abs(p.z - 2 * c.z + q.z));
        }
        if (a.size() >= 8) break;
    }
    scale.sx = sigma_of(a, along_path);
    scale.sz = sigma_of(b, along_path);
    // On an even grid of x neighbours may share their noise (interpolation, a median) and hide it; points some lines apart do not.
    // By third differences: over so many lines a bend is no line, but nearly an arc.
    const bool evenly = scale.sx < kEvenly * scale.spacing;
    const auto third = [&](int lag) {
        b.clear();
        for (int k = 0, step = std::max(1, n / samples); k + 3 * lag < n; k += step) {
            const Candidate &p = at(k), &c = at(k + lag), &q = at(k + 2 * lag), &r = at(k + 3 * lag);
            const auto broken = [&] {
                for (int i = k + 1; i <= k + 3 * lag; ++i)
                    if (w.nodes[std::size_t(pick[std::size_t(i)])].link != Link::smooth) return true;
                return false;
            };
            if (r.line - p.line == 3 * lag && !broken()) b.push_back(std::abs(p.z - 3 * c.z + 3 * q.z - r.z));
        }
        return b.size() < kFewestThird ? 0.0 : sigma_of(b, along_path);
    };
    if (const double beside = evenly && along_path ? third(1) : 0; beside > 0) {
        double hidden = 1;
        for (const int lag : kSharedLags) hidden = std::max(hidden, third(lag) / beside);
        if (hidden > kSharedSeen) scale.sz *= hidden;
    }
    // Neighbours are rounded alike, which shows no noise and then a step of a whole quantum.
    a.clear(), b.clear();
    for (const int k : pick)
        a.push_back(w.candidates[std::size_t(k)].x), b.push_back(w.candidates[std::size_t(k)].z);
    scale.sz = std::max(scale.sz, 0.5 * z_quantum_mm(a, b));
    if (along_path) scale.sx = std::max(scale.sx, sigma_along_x(w, pick, scale));
    if (options.noise_mm > 0) {
        scale.sx = std::min(scale.sx, options.noise_mm);
        scale.sz = options.noise_mm;
    }
    const double floor = kNoiseFloor * scale.spacing;
    scale.sx = std::max(scale.sx, floor);
    scale.sz = std::max(scale.sz, floor);
    return scale;
}

void line_through(const Workspace& w, const int* points, int n, State& s) {
    const auto at = [&](int k) -> const Candidate& { return w.candidates[std::size_t(points[k])]; };
    const auto inwards = [&](int k) { return double(std::abs(at(k).line - at(0).line)); };
    double mean = 0, mx = 0, mz = 0;
    for (int k = 0; k < n; ++k) mean += inwards(k), mx += at(k).x, mz += at(k).z;
    mean /= n, mx /= n, mz /= n;
    double spread = 0, sx = 0, sz = 0;
    for (int k = 0; k < n; ++k) {
        const double d = inwards(k) - mean;
        spread += d * d;
        sx += d * at(k).x, sz += d * at(k).z;
    }
    s.vx = -sx / spread, s.vz = -sz / spread;  // lines count inwards, the advance points outwards
    s.x = mx + mean * s.vx, s.z = mz + mean * s.vz;
    s.p11 = 1. / n + mean * mean / spread, s.p12 = mean / spread, s.p22 = 1 / spread;
    s.spacing2 = s.vx * s.vx + s.vz * s.vz;
    s.age = n;
}

void cheapest_sequence(Workspace& w, const Model& m) {
    const int lines = int(w.first.size()) - 1;
    w.nodes.resize(w.candidates.size());
    constexpr double infinite = std::numeric_limits<double>::infinity();
    // Cheapest cost of what came before the present line: ending on the last line, or before it with the last
    // left out.
    struct End {
        double cost;
        int node;
    } last{infinite, -1}, skipping{infinite, -1};
    // No node before the last line can be continued for less: a straight line below the concave cost of a
    // gap.
    double older = infinite, cheapest_last = infinite;
    const double growth = (m.skip(m.window) - m.skip(1)) / (m.window - 1);
    Held held;
    int held_for = -1;
    const double calm_d2 = kCalm * m.outlier_cost;
    const auto put = [&](int c, int previous, const State& state, double cost, bool calm) {
        Node& node = w.nodes[std::size_t(c)];
        node.state = state;
        node.cost = cost;
        node.previous = previous;
        node.link = Link::smooth;
        node.calm = calm;
    };
    const auto close_line = [&](int begin, int end) {
        older = std::min(older + growth, cheapest_last + m.skip(1));
        skipping.cost += m.skip_line;
        if (const double cost = last.cost + m.skip_open + m.skip_line; cost < skipping.cost)
            skipping = {cost, last.node};
        last = {infinite, -1};
        cheapest_last = infinite;
        for (int c = begin; c < end; ++c) {
            const double cost = w.nodes[std::size_t(c)].cost;
            cheapest_last = std::min(cheapest_last, cost);
            const double left = w.leave.empty() ? cost : cost + w.leave[std::size_t(c)];
            if (left < last.cost) last = {left, c};
        }
    };
    for (int line = 0; line < lines; ++line) {
        const int begin = w.first[std::size_t(line)], end = w.first[std::size_t(line) + 1];
        const int before = line > 0 ? w.first[std::size_t(line) - 1] : begin;
        const double start_cost = line > 0 ? m.skip_open + line * m.skip_line : 0;
        // No way that leaves a line out, turns sharply or jumps is cheaper than this.
        const double others =
            std::min({older, start_cost, cheapest_last + std::min(m.edge_cost, m.jump_cost)});
        if (end - begin == 1 && begin - before == 1) {
            // One candidate after one candidate that it continues: most of every profile.
            const Node& past = w.nodes[std::size_t(before)];
            const Candidate& point = w.candidates[std::size_t(begin)];
            const int i = point.line - w.candidates[std::size_t(before)].line;
            State state = past.state;
            double d2 = 0;
            if (i == 1 && held_for == before &&
                follow(m, held, state, point.x, point.z, std::min(calm_d2, 2 * (others - past.cost)), d2)) {
                put(begin, before, state, past.cost + 0.5 * d2 + point.cost, past.state.excess < kCalmExcess);
                held_for = begin;
                close_line(begin, end);
                continue;
            }
            if (past.state.age >= 2 && i <= m.longest_gap) {
                const Deviation d = deviation(m, state, point.x, point.z, i);
                const double cost = past.cost + 0.5 * d.d2;
                if (0.5 * d.d2 < m.outlier_cost && cost <= others) {
                    const bool calm = i == 1 && is_calm(m, state, d);
                    accept(m, state, d, i);
                    put(begin, before, state, cost + point.cost, calm);
                    held.points = 0;
                    if (calm) hold(m, state, d, held);
                    held_for = begin;
                    close_line(begin, end);
                    continue;
                }
            }
        }
        for (int c = begin; c < end; ++c) {
            const Candidate& point = w.candidates[std::size_t(c)];
            double best = infinite;
            int from = -1;
            Link link = Link::start;
            Deviation best_deviation;
            const auto try_smooth = [&](int j, double skipped) {
                const Node& node = w.nodes[std::size_t(j)];
                const int i = point.line - w.candidates[std::size_t(j)].line;
                if (i > m.longest_gap) return;
                if (node.state.age < 2) {
                    const double ratio = reach_ratio(m, node.state, point.x, point.z, i);
                    const double cost =
                        node.cost + skipped +
                        (kReachCost * ratio * ratio + (skipped > 0 ? kAfterSkip : 0)) * m.outlier_cost;
                    if (ratio < 1 && cost < best) best = cost, from = j, link = Link::edge;
                    return;
                }
                const Deviation d = deviation(m, node.state, point.x, point.z, i);
                const double cost = node.cost + skipped + 0.5 * d.d2;
                if (0.5 * d.d2 < m.outlier_cost && cost < best)
                    best = cost, from = j, link = Link::smooth, best_deviation = d;
            };
            for (int j = before; j < begin; ++j) try_smooth(j, 0);
            if (!(best <= older && best <= start_cost &&
                  best <= cheapest_last + std::min(m.edge_cost, m.jump_cost))) {
                const double enter = w.enter.empty() ? 0 : w.enter[std::size_t(c)];
                if (start_cost + enter < best) best = start_cost + enter, from = -1, link = Link::start;
                const auto try_jump = [&](double cost, int j) {
                    cost += m.jump_cost + enter;
                    if (!(cost < best)) return;
                    if (m.jump_size_cost > 0)
                        cost += m.jump_size_cost * jump_size(m, w.candidates[std::size_t(j)], point);
                    if (cost < best) best = cost, from = j, link = Link::start;
                };
                try_jump(skipping.cost, skipping.node);
                if (m.jump_size_cost > 0)
                    for (int j = before; j < begin; ++j)
                        try_jump(w.nodes[std::size_t(j)].cost + w.leave[std::size_t(j)], j);
                else
                    try_jump(last.cost, last.node);
                for (int back = 1; back <= m.window && back <= line; ++back) {
                    const double skipped = m.skip(back - 1);
                    const int j0 = w.first[std::size_t(line - back)],
                              j1 = w.first[std::size_t(line - back) + 1];
                    for (int j = j0; j < j1; ++j) {
                        const Node& node = w.nodes[std::size_t(j)];
                        if (node.cost + skipped >= best) continue;
                        if (back > 1) try_smooth(j, skipped);
                        if (node.state.age < 2 || node.cost + skipped + m.edge_cost >= best) continue;
                        const int i = point.line - w.candidates[std::size_t(j)].line;
                        if (i > m.edge_window) continue;
                        const double ratio = reach_ratio(m, node.state, point.x, point.z, i);
                        const double cost =
                            node.cost + skipped + m.edge_cost + kReachCost * m.outlier_cost * ratio * ratio;
                        if (ratio < 1 && cost < best) best = cost, from = j, link = Link::edge;
                    }
                }
            }
            Node& node = w.nodes[std::size_t(c)];
            node.cost = best + point.cost;
            node.previous = from;
            node.link = link;
            node.calm = false;
            if (link == Link::start) {
                node.state = first_point(m, point.x, point.z);
            } else {
                node.state = w.nodes[std::size_t(from)].state;
                const int i = point.line - w.candidates[std::size_t(from)].line;
                if (link == Link::smooth)
                    accept(m, node.state, best_deviation, i);
                else
                    accept_any_direction(m, node.state, point.x, point.z, i);
                if (link == Link::edge && w.nodes[std::size_t(from)].state.age < 2) node.link = Link::smooth;
            }
        }
        close_line(begin, end);
    }
    w.path.clear();
    for (int c = last.cost <= skipping.cost ? last.node : skipping.node; c >= 0;
         c = w.nodes[std::size_t(c)].previous)
        w.path.push_back(c);
    std::reverse(w.path.begin(), w.path.end());
}

}  // namespace seamwright::contour
